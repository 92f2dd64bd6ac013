"""Mirrored light as a radiance grid."""
