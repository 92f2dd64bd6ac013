"""A training method: 2DGS with one tint for everything, learned with the rest. torch is loaded when it is used."""

from groundstation.api import Method


def shader(config, surroundings):
    from reflight_tinted.shading import Tinted

    return Tinted()


TINTED = Method("Tinted 2DGS", "an example", "flat discs whose colours share one tint", shader=shader)
