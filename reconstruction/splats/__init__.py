"""Gaussian splats: flat discs in space that are blended into pictures, and learned from pictures."""
