"""Panels in 3-D: grids found in photos, brought together on the surface of the facade (paper 3.1.2)."""
