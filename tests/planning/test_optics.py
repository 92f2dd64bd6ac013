"""Optics of photos: closed forms, published worked examples, properties, and values that are no lens."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.optics import (
    CameraControls,
    Lens,
    clear_sky_ev,
    exposure_value,
    sharpest_f_number,
    shutter_text,
    shutter_within,
    smear_px,
)

lenses = st.builds(Lens, st.floats(2.0, 200.0), st.floats(1.0, 22.0), st.floats(5e-4, 0.03))
distances = st.floats(1.0, 1e4) | st.just(math.inf)
reals = st.floats(0.0, 100.0)


FOOT_M = 0.3048


@pytest.mark.parametrize(
    ("focal_length_mm", "f_number", "hyperfocal_ft"),
    [(11.0, 4.0, 5.00), (11.0, 8.0, 2.52), (12.0, 4.0, 5.94), (12.0, 8.0, 2.99), (12.0, 16.0, 1.52), (14.0, 4.0, 8.08)],
)
def test_hyperfocal_distances_are_those_of_a_published_table(
    focal_length_mm: float, f_number: float, hyperfocal_ft: float
) -> None:
    """naturelyrics.com, hyperfocal distance chart for crop cameras, c = 0.02 mm, in feet."""
    found_m = Lens(focal_length_mm, f_number, 0.02).hyperfocal_m
    assert found_m / FOOT_M == pytest.approx(hyperfocal_ft, abs=0.006)


def test_hyperfocal_distances_are_those_of_published_examples() -> None:
    """50 mm at f/8: Wikipedia, Hyperfocal distance, c = 0.03 mm; cabbagetownphoto.com, f^2 / (N c), c = 0.026 mm."""
    assert Lens(50.0, 8.0, 0.03).hyperfocal_m == pytest.approx(10.467, abs=0.0005)
    assert Lens(50.0, 8.0, 0.026).hyperfocal_m - 0.050 == pytest.approx(12.019, abs=0.0005)


@pytest.mark.parametrize(
    ("focal_length_mm", "f_number", "focus_ft", "nearest_ft", "farthest_ft"),
    [(12.0, 4.0, 6.0, 2.99, math.inf), (12.0, 16.0, 1.5, 0.75, 140.6), (12.0, 22.627, 1.0, 0.52, 12.5)],
)
def test_depth_of_field_is_that_of_a_published_table(
    focal_length_mm: float, f_number: float, focus_ft: float, nearest_ft: float, farthest_ft: float
) -> None:
    """The same chart; its f/22 is the square root of 512."""
    nearest_m, farthest_m = Lens(focal_length_mm, f_number, 0.02).sharp_between_m(focus_ft * FOOT_M)
    assert nearest_m / FOOT_M == pytest.approx(nearest_ft, abs=0.006)
    assert farthest_m / FOOT_M == pytest.approx(farthest_ft, rel=3e-3)


@given(lenses)
def test_focused_at_the_hyperfocal_distance_all_from_half_of_it_on_is_sharp(lens: Lens) -> None:
    at = lens.hyperfocal_m
    if at * 1000.0 <= 2.0 * lens.focal_length_mm:  # a macro lens of enormous pixels
        return
    nearest, farthest = lens.sharp_between_m(at)
    assert nearest == pytest.approx(at / 2.0, rel=1e-9)
    assert farthest > 1e6 * at
    assert lens.defocus_px(at, math.inf) == pytest.approx(1.0, rel=1e-9)
    assert lens.sharp_between_m(at * 1.001)[1] == math.inf


@given(lenses, distances)
def test_the_ends_of_what_is_sharp_are_out_of_focus_by_a_pixel(lens: Lens, focus_m: float) -> None:
    for end in lens.sharp_between_m(focus_m):
        if math.isfinite(end) and 1000.0 * end > 1.001 * lens.focal_length_mm:
            assert lens.defocus_px(focus_m, end) == pytest.approx(1.0, rel=1e-6)


@given(lenses, distances, distances)
def test_defocus_is_that_of_the_textbook(lens: Lens, focus_m: float, distance_m: float) -> None:
    """Ray's c = f^2 |d - s| / (N d (s - f)) where both are finite, taken as written, in another order of operations."""
    found = lens.defocus_px(focus_m, distance_m)
    assert found >= 0.0
    if math.isfinite(focus_m) and math.isfinite(distance_m):
        f, s, d = lens.focal_length_mm, 1e3 * focus_m, 1e3 * distance_m
        textbook = f * f * abs(d - s) / (lens.f_number * d * (s - f)) / lens.pixel_mm
        assert found == pytest.approx(textbook, rel=1e-6, abs=1e-9)
    else:
        far = lens.defocus_px(min(focus_m, 1e9), min(distance_m, 1e9))
        assert found == pytest.approx(far, rel=1e-5, abs=1e-4)


def test_differences_of_far_distances_lose_no_digits() -> None:
    """In single precision the textbook's |d - s| has lost most of them at 1 km; reciprocals have not."""
    focus_m, distance_m = 1000.0, 1000.0003
    exact = Lens(35.0, 8.0, 0.004).defocus_px(focus_m, distance_m)
    f, n, c = np.float32(0.035), np.float32(8.0), np.float32(4e-6)
    s, d = np.float32(focus_m), np.float32(distance_m)
    textbook = f * f * abs(d - s) / (n * d * (s - f)) / c
    assert abs(float(textbook) / exact - 1.0) > 0.01, "which is why it is not computed so"
    assert Lens(35.0, 8.0, 0.004).defocus_px(1e9, math.inf) == pytest.approx(35.0**2 / (8.0 * 0.004) / 1e12, rel=1e-6)


@given(lenses, distances, distances, st.floats(1.1, 4.0))
def test_stopping_down_sharpens_in_proportion(lens: Lens, focus_m: float, distance_m: float, factor: float) -> None:
    stopped = Lens(lens.focal_length_mm, factor * lens.f_number, lens.pixel_mm)
    assert stopped.defocus_px(focus_m, distance_m) * factor == pytest.approx(lens.defocus_px(focus_m, distance_m))


def test_a_focus_on_the_pane_blurs_the_mirror_image_that_lies_behind_it() -> None:
    """35 mm, f/8, pixels of 4.38 um: focused on a pane at 10 m, a building 30 m in front of it lies at 40 m."""
    lens = Lens(35.0, 8.0, 0.00438)
    assert lens.defocus_px(10.0, 10.0) == 0.0
    assert lens.defocus_px(10.0, 40.0) == pytest.approx(2.63, abs=0.01)
    assert lens.defocus_px(10.0, math.inf) == pytest.approx(3.51, abs=0.01)
    assert lens.defocus_px(20.0, 10.0) == pytest.approx(lens.defocus_px(20.0, math.inf), rel=1e-9), "the best for both"


@given(reals, reals, reals, st.floats(1e-4, 1.0), st.floats(1e-5, 1e-2), st.floats(0.0, 50.0))
def test_smear_is_linear_in_time_and_speed_and_nothing_at_a_hover(
    time_s: float, speed: float, turn: float, gsd_m: float, angle: float, factor: float
) -> None:
    once = smear_px(time_s, speed, turn, gsd_m, angle)
    assert smear_px(factor * time_s, speed, turn, gsd_m, angle) == pytest.approx(factor * once)
    assert smear_px(time_s, factor * speed, factor * turn, gsd_m, angle) == pytest.approx(factor * once)
    assert smear_px(time_s, 0.0, 0.0, gsd_m, angle) == 0.0
    assert smear_px(0.0, speed, turn, gsd_m, angle) == 0.0


def test_smear_is_that_of_the_rule_of_thumb() -> None:
    """5 m/s at 1/500 s and 5 mm pixels is two pixels; sight lines to the sky move with the turn alone."""
    assert smear_px(1 / 500, 5.0, 0.0, 0.005, 0.0003) == pytest.approx(2.0)
    assert smear_px(0.01, 5.0, 0.03, math.inf, 0.0003) == pytest.approx(1.0)
    assert float(np.float32(1 / 500) * np.float32(5.0) / np.float32(0.005)) == pytest.approx(
        smear_px(1 / 500, 5.0, 0.0, 0.005, 0.0003), rel=1e-6
    )


def test_sunny_sixteen_is_an_exposure_value_of_fifteen() -> None:
    """f/16 and 1/100 s at ISO 100 is EV 14.64; with the third stop that the rule forgives it is 15."""
    assert exposure_value(16.0, 1 / 128, 100) == pytest.approx(15.0)
    assert exposure_value(1.0, 1.0, 100) == 0.0
    assert exposure_value(8.0, 1 / 500, 400) == pytest.approx(exposure_value(8.0, 1 / 125, 100))


def test_a_clear_sky_gives_the_exposure_values_that_photographers_know() -> None:
    """Sunny 16 holds with the sun high; low sun takes two to three stops."""
    assert clear_sky_ev(math.radians(60.0)) == pytest.approx(15.0, abs=0.1)
    assert clear_sky_ev(math.radians(10.0)) == pytest.approx(12.5, abs=0.2)
    assert clear_sky_ev(math.radians(1.0)) == clear_sky_ev(-0.5) == -math.inf
    values = [clear_sky_ev(math.radians(each)) for each in range(3, 91)]
    assert values == sorted(values)


def test_the_disc_of_airy_is_three_pixels_where_stopping_down_ends() -> None:
    assert 2.44 * 0.00055 * sharpest_f_number(0.00328) == pytest.approx(3.0 * 0.00328)


def test_shutter_times_are_named_as_cameras_name_them_and_never_rounded_to_longer_ones() -> None:
    assert [shutter_text(each) for each in (0.002, 1 / 8000, 0.5, 2.0)] == ["1/500 s", "1/8000 s", "0.5 s", "2 s"]
    assert shutter_within(0.0021) == 1 / 500
    assert shutter_within(1 / 500) == 1 / 500
    assert shutter_within(1e-6) == 1e-6
    assert shutter_within(math.inf) == 1.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Lens(50.0, 0.0, 0.03), "f_number: expected a number above 0, got 0"),
        (lambda: Lens(math.nan, 8.0, 0.03), "focal_length_mm: expected a number above 0, got nan"),
        (lambda: Lens(math.inf, 8.0, 0.03), "focal_length_mm: expected a number above 0, got inf"),
        (lambda: Lens(50.0, 8.0, 0.03).defocus_px(0.0, 5.0), "focus_m: expected a number above 0, got 0"),
        (lambda: Lens(50.0, 8.0, 0.03).defocus_px(5.0, -1.0), "distance_m: expected a number above 0, got -1"),
        (lambda: Lens(50.0, 8.0, 0.03).defocus_px(5.0, math.nan), "distance_m: expected a number above 0, got nan"),
        (lambda: Lens(50.0, 8.0, 0.03).sharp_between_m(0.05), "focus_m: expected more than the focal length of 50 mm"),
        (lambda: smear_px(-1.0, 1.0, 0.0, 0.01, 0.001), "time_s: expected 0 or more, got -1"),
        (lambda: smear_px(math.inf, 0.0, 0.0, 0.01, 0.001), "time_s: expected 0 or more, got inf"),
        (lambda: smear_px(1.0, math.nan, 0.0, 0.01, 0.001), "speed_m_s: expected 0 or more, got nan"),
        (lambda: smear_px(1.0, 1.0, 0.0, 0.0, 0.001), "gsd_m: expected a number above 0, got 0"),
        (lambda: exposure_value(8.0, 0.0, 100), "shutter_s: expected a number above 0, got 0"),
        (lambda: exposure_value(8.0, 0.01, math.nan), "iso: expected a number above 0, got nan"),
        (lambda: shutter_within(math.nan), "longest_s: expected a number above 0, got nan"),
        (lambda: CameraControls((2.8, 11), (100, 6400)), "expected the times of a shutter, got none"),
        (lambda: CameraControls((11, 2.8), (100, 6400), (0.001, 1)), "aperture: expected \\[lowest, highest\\]"),
        (lambda: CameraControls((math.nan, 8), (100, 6400), (0.001, 1)), "aperture: expected \\[lowest, highest\\]"),
    ],
)
def test_what_is_no_lens_and_no_exposure_is_refused_in_words(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


def test_circles_of_many_points_are_those_of_each_and_the_nearest_that_has_no_image_is_named() -> None:
    lens = Lens(35.0, 8.0, 0.004)
    focuses_m, distances_m = np.array([[5.0], [math.inf]]), np.array([2.0, 7.0, math.inf])
    together = lens.defocus_px(focuses_m, distances_m)
    alone = [[lens.defocus_px(at, to) for to in distances_m.tolist()] for at in focuses_m[:, 0].tolist()]
    np.testing.assert_array_equal(together, alone)
    with pytest.raises(ValueError, match=r"distance_m: .* more than the focal length of 35 mm, got 0\.03 m"):
        lens.defocus_px(focuses_m, np.array([2.0, 0.03]))
    with pytest.raises(ValueError, match="distance_m: expected a number above 0, got nan"):
        lens.defocus_px(focuses_m, np.array([2.0, math.nan]))
