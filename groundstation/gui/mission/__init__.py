"""Widgets of the Mission tab."""
