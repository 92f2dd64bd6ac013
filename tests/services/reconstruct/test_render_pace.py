import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.reconstruct.guided_camera import ADDED, PicturePace

sizes = st.floats(1e3, 1e7)
times = st.floats(0.0, 100.0)


def test_before_the_first_picture_nothing_is_known():
    assert PicturePace().pixels_within(0.1) is None
    assert PicturePace().seconds_of(1e6) == 0.0


def test_one_picture_says_what_a_pixel_takes():
    pace = PicturePace()
    pace.took(100_000, 0.2)
    assert pace.pixels_within(0.1) == pytest.approx(50_000)


@given(st.floats(0.0, 1.0), st.floats(1e-8, 1e-5), sizes, st.floats(1.5, 100.0), st.booleans(), st.floats(0.01, 1.0))
def test_two_sizes_tell_what_cannot_be_avoided(fixed, each, pixels, times_as_many, large_first, within):
    order = (times_as_many * pixels, pixels) if large_first else (pixels, times_as_many * pixels)
    pace = PicturePace()
    for size in order:
        pace.took(size, fixed + each * size)
    expected = max(within - fixed, ADDED * fixed) / each
    assert pace.pixels_within(within) == pytest.approx(expected, rel=1e-3, abs=1e-6 * max(order))
    assert pace.seconds_of(3.0 * pixels) == pytest.approx(fixed + each * 3.0 * pixels, rel=1e-6)


@given(st.lists(st.tuples(sizes, times), min_size=1, max_size=20), st.floats(0.001, 10.0))
def test_whatever_came_the_wish_is_a_number_above_zero(pictures, within):
    pace = PicturePace()
    for pixels, seconds in pictures:
        pace.took(pixels, seconds)
    found = pace.pixels_within(within)
    assert found is not None
    assert found > 0.0
    assert not math.isnan(found)


def test_pictures_of_large_models_do_not_get_smaller_and_smaller():
    pace, pixels = PicturePace(), 600_000.0
    for _ in range(30):
        pace.took(pixels, 0.2 + 4e-7 * pixels)
        pixels = max(7_000.0, pace.pixels_within(0.12) or 0.0)
    assert pixels > 100_000
