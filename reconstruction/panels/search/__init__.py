"""Glass panels in photos: lines, their repetition, the grid that follows (paper 3.1)."""
