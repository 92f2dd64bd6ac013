"""Widgets of the Plan tab."""
