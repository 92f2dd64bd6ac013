"""Widgets of the Site tab: the tree of things, their properties, tools for drawing, and the import dialog."""
