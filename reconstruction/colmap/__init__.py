"""COLMAP models: reading, writing, georeferencing, and refinement of poses with pycolmap where it is installed."""
