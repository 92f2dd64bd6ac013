"""The 2-D map and what is drawn on it."""
