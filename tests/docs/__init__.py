"""The docs: pages that are generated from the code, the site that is made of all pages, and tests of both."""
