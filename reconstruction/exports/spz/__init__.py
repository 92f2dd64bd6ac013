"""SPZ files (Niantic)."""
