"""Widgets of the Fly tab."""
