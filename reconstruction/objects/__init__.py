"""The model as objects: a scene of facades, their panels and the Gaussians of each (paper 3.4)."""
