"""Layers as pictures: what is nothing, what the ends of colours stand for, and panels that differ."""

import numpy as np
import pytest

from groundstation.services.reconstruct.render_queue import NOTHING, coloured
from reconstruction.training.layers import LAYERS, PICTURE


@pytest.mark.parametrize("layer", [PICTURE, *LAYERS])
def test_every_layer_has_colours_even_of_values_that_are_none(layer):
    is_wide = layer in (PICTURE, "diffuse", "reflection", "mirrored", "normals")
    values = np.full((4, 6, 3) if is_wide else (4, 6), np.nan if layer != "panels" else -1.0, np.float32)
    with np.errstate(all="raise"):
        picture, _ = coloured(layer, values)
    assert picture.shape == (4, 6, 3)
    assert picture.dtype == np.uint8


def test_depths_have_the_colours_of_their_range_and_nothing_is_grey():
    values = np.linspace(3.0, 9.0, 600, dtype=np.float32).reshape(20, 30)
    values[0, 0] = np.inf
    picture, scale = coloured("depth", values)
    assert scale == pytest.approx((3.13, 8.88), abs=0.02)
    assert (picture[0, 0] == NOTHING).all()
    # Viridis: violet at the low end, yellow at the high one.
    assert picture[0, 1, 2] > picture[0, 1, 1]
    assert picture[-1, -1, 0] > 200
    assert picture[-1, -1, 2] < 100


def test_a_flat_depth_has_a_range_and_none_has_no_scale():
    _, scale = coloured("depth", np.full((3, 3), 5.0, np.float32))
    assert scale[1] > scale[0]
    _, scale = coloured("depth", np.full((3, 3), np.inf, np.float32))
    assert scale is None


def test_normals_are_centred_and_what_has_none_is_grey():
    values = np.zeros((2, 2, 3), np.float32)
    values[0, 0] = (1.0, 0.0, -1.0)
    picture, _ = coloured("normals", values)
    assert picture[0, 0].tolist() == [255, 128, 0]
    assert (picture[1, 1] == NOTHING).all()


def test_neighbouring_panels_differ():
    picture, _ = coloured("panels", np.array([[-1.0, 0.0, 1.0, 2.0]], np.float32))
    assert (picture[0, 0] == NOTHING).all()
    seen = picture[0, 1:].astype(int)
    assert min(np.abs(seen[i] - seen[j]).max() for i in range(3) for j in range(i)) > 60
