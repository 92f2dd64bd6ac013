"""Panes by a small network: where the lines of a grid alone do not tell, in close-ups, clutter and white light."""
