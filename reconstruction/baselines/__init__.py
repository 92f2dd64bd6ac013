"""Shading of published methods for reflective scenes, to compare with: from their papers, on plain tensors."""
