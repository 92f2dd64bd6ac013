"""Widgets and dialogs that no tab owns."""
