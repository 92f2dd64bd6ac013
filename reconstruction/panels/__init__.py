"""Panels: looked for in photos, rectified, and solved for in three dimensions."""
