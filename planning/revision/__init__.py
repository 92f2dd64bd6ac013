"""Editing a plan by hand: viewpoints are moved, added, deleted, locked; route, coverage and checks follow at once."""
