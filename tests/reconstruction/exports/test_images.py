"""Bytes as images: every bit comes back, of transparent pixels, too."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.exports.sog import image_of, image_size, rows_as_image, values_of

HERE = Path("model.sog")


@settings(max_examples=25, deadline=None)
@given(size=st.tuples(st.integers(1, 40), st.integers(1, 40)), seed=st.integers(0, 999), alpha=st.sampled_from([0, 1]))
def test_every_bit_comes_back(size, seed, alpha):
    rng = np.random.default_rng(seed)
    values = rng.integers(0, 256, (*size, 4), np.uint8)
    values[rng.random(size) < 0.5, 3] = alpha
    assert np.array_equal(values_of(image_of(values), "a", HERE, 1600), values)


def test_even_where_all_is_opaque_or_transparent():
    for alpha in (0, 255):
        values = np.random.default_rng(0).integers(0, 256, (16, 8, 4), np.uint8)
        values[..., 3] = alpha
        assert np.array_equal(values_of(image_of(values), "a", HERE, 1600), values)


@pytest.mark.parametrize("n", [1, 2, 15, 16, 17, 1000, 65_537])
def test_images_are_just_large_enough(n):
    width, height = image_size(n)
    assert width % 4 == height % 4 == 0
    assert n <= width * height < n + 4 * (width + height) + 32


def test_rows_are_pixels_from_the_top_left():
    rows = np.arange(60, dtype=np.uint8).reshape(20, 3)
    found = values_of(rows_as_image(rows, 7), "a", HERE, 1600).reshape(-1, 4)
    assert np.array_equal(found[:20, :3], rows)
    assert (found[:, 3] == 7).all()


def test_images_that_are_too_large_are_not_decoded():
    content = image_of(np.zeros((64, 64, 4), np.uint8))
    with pytest.raises(InputError, match=r"model\.sog: a has 64 x 64 pixels; expected at most 100"):
        values_of(content, "a", HERE, 100)
    extended = b"RIFF\x20\0\0\0WEBPVP8X\x0a\0\0\0" + b"\x10\0\0\0" + b"\xff\xff\xff" * 2
    with pytest.raises(InputError, match="16777216 x 16777216"):
        values_of(extended, "a", HERE, 1 << 30)
