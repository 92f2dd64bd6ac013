"""Mirrored light by direction and place: environment maps, harmonics, and the Reflection MLP."""
