"""The joint model of splats and mirrored light, and its training (paper 3.3)."""
