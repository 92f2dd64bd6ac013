"""Use cases of sites: where they come from, edits, findings, the sun over them."""
