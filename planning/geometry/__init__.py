"""Exact distances, clearance of segments, inside tests and line of sight against triangles, in float64."""
