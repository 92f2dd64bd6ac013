"""Edges to a fraction of a pixel, and frames measured through their blur."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reconstruction.panels.search.edges import (
    coverage_of_edges,
    edges_of_segments,
    measured_edge,
    noise_of,
    regressed_width,
    unbiased_edges,
    vertical_edges,
)
from reconstruction.panels.search.evidence import local_maxima

Picture = NDArray[np.float32]
FINE = 20


def profile(
    first: float,
    last: float,
    seed: int = 0,
    blur: float = 1.0,
    noise: float = 2.0,
    rows: int = 400,
    shadow: float = 1.0,
) -> Picture:
    """A frame of grey 60 from `first` to `last` with another glass beside it every 25 rows; in shadow further down."""
    rng = np.random.default_rng(seed)
    width = 40
    fine = np.empty((rows, width * FINE), np.float32)
    for start in range(0, rows, 25):
        fine[start : start + 25, : round(first * FINE)] = rng.uniform(30, 230)
        fine[start : start + 25, round(last * FINE) :] = rng.uniform(30, 230)
    frame = np.where(np.arange(rows) < rows / 2, 180.0, 180.0 * shadow).astype(np.float32)
    fine[:, round(first * FINE) : round(last * FINE)] = frame[:, None]
    fine = np.asarray(cv2.GaussianBlur(fine, (0, 0), sigmaX=blur * FINE, sigmaY=0.01))
    picture = fine.reshape(rows, width, FINE).mean(axis=2)
    return (picture + rng.normal(0.0, noise, picture.shape)).astype(np.float32)


@settings(max_examples=25)
@given(x=st.floats(15.0, 22.0), seed=st.integers(0, 50))
def test_one_edge_is_found_to_a_twentieth_of_a_pixel(x: float, seed: int) -> None:
    edges = vertical_edges(profile(x, 39.9, seed))
    place, sigma, n = measured_edge(edges, x + 0.7, slice(0, 400))
    assert n > 250
    assert abs(place - round(x * FINE) / FINE) < 0.06
    assert 0.0 < sigma < 0.05


@pytest.mark.few(5)
@pytest.mark.parametrize("shadow", [1.0, 0.6])
@pytest.mark.parametrize("width", [1.5, 2.5, 4.0, 7.0])
@pytest.mark.parametrize("blur", [0.6, 1.2])
def test_width_by_regression_does_not_depend_on_blur_or_shadow(width: float, blur: float, shadow: float) -> None:
    errors = []
    for seed in range(5):
        picture = profile(18.0, 18.0 + width, seed, blur, shadow=shadow)
        errors.append(regressed_width(picture, 17.6, 18.4 + width, slice(0, 400)) - width)
    assert abs(float(np.median(errors))) < 0.25


def test_gradients_of_thin_profiles_are_too_wide_and_are_put_right_together() -> None:
    pictures = [profile(18.0, 20.0, seed, 1.0) for seed in range(5)]
    measured, regressed = [], []
    for picture in pictures:
        edges = vertical_edges(picture)
        ends = [measured_edge(edges, x, slice(0, 400))[0] for x in (17.6, 20.4)]
        measured.append(ends)
        regressed.append(regressed_width(picture, ends[0], ends[1], slice(0, 400)))
    raw = np.array(measured)
    assert np.median(np.diff(raw, axis=1)) > 2.5
    assert np.diff(unbiased_edges(raw, np.array(regressed)), axis=1) == pytest.approx(2.0, abs=0.25)


def test_profiles_whose_regression_is_not_known_are_left_alone() -> None:
    edges = np.array([[10.0, 14.0], [50.0, 54.0], [90.0, 90.0]])
    assert unbiased_edges(edges, np.full(3, np.nan)).tolist() == edges.tolist()
    assert np.isnan(regressed_width(np.zeros((40, 20), np.float32), 1.0, 3.0, slice(0, 40)))


def test_medians_ignore_a_reflection_beside_the_edge() -> None:
    picture = profile(20.0, 39.9, 3)
    shifted = picture.copy()
    shifted[:150, 21:23] = 20.0
    place, _, _ = measured_edge(vertical_edges(shifted), 20.0, slice(0, 400))
    assert place == pytest.approx(20.0, abs=0.1)


@pytest.mark.parametrize("grey", [0, 128, 255])
def test_even_pictures_have_no_edges(grey: int) -> None:
    assert not vertical_edges(np.full((50, 60), grey, np.float32)).is_edge.any()


def test_noise_alone_covers_little() -> None:
    noise = np.random.default_rng(0).normal(128.0, 8.0, (400, 300)).astype(np.float32)
    assert coverage_of_edges(vertical_edges(noise), 16).mean() < 0.05


@given(sigma=st.floats(0.5, 20.0), seed=st.integers(0, 100))
def test_noise_is_measured_to_a_tenth(sigma: float, seed: int) -> None:
    values = np.random.default_rng(seed).normal(0.0, sigma, 20_000)
    assert noise_of(values) == pytest.approx(sigma, rel=0.1)


def test_pictures_narrower_than_the_filter_have_no_edges() -> None:
    assert not vertical_edges(np.zeros((5, 2), np.float32)).is_edge.any()
    place, sigma, n = measured_edge(vertical_edges(np.zeros((5, 2), np.float32)), 50.0, slice(0, 5))
    assert np.isnan([place, sigma]).all()
    assert n == 0


def test_edges_outside_the_photo_do_not_count() -> None:
    picture = profile(20.0, 39.9)
    valid = np.ones(picture.shape, bool)
    valid[:, 20:] = False
    assert not vertical_edges(picture, valid).is_edge.any()


@given(x0=st.floats(5.0, 20.0), lean=st.floats(-0.5, 0.5))
def test_segments_are_drawn_where_they_run(x0: float, lean: float) -> None:
    edges = edges_of_segments(np.array([[x0 + lean, 30.0, x0, 2.0]]), 40, 40, 2.0)
    row, column = np.nonzero(edges.is_edge)
    assert row.tolist() == list(range(2, 30))
    x = column + 0.5 + edges.offset_px[row, column]
    assert np.allclose(x, x0 + lean * (row + 0.5 - 2.0) / 28.0, atol=1e-5)


def test_segments_of_other_directions_are_left_out() -> None:
    assert not edges_of_segments(np.array([[5.0, 5.0, 30.0, 6.0], [5.0, 5.0, 9.0, 30.0]]), 40, 40, 2.0).is_edge.any()


@given(vertex=st.floats(5.0, 30.0))
def test_peak_of_a_parabola_is_found_exactly(vertex: float) -> None:
    x = np.arange(40) + 0.5
    positions, _ = local_maxima(-((x - vertex) ** 2), 0.1)
    assert positions.tolist() == pytest.approx([vertex], abs=1e-6)


def test_small_ripples_are_no_peaks_and_the_ends_may_be() -> None:
    values = np.array([5.0, 1.0, 1.05, 1.0, 4.0, 1.0, 6.0])
    positions, heights = local_maxima(values, 0.2)
    assert heights.tolist() == [5.0, 4.0, 6.0]
    assert positions[0] == 0.5


def test_edges_that_end_at_a_profile_do_not_run_into_it() -> None:
    picture = np.full((200, 120), 60.0, np.float32)
    picture[:, 60:] = 190.0
    picture[95:105] = 60.0  # a profile as dark as the darker side
    seen = vertical_edges(picture).is_edge[:, 58:62].any(axis=1)
    assert seen[:93].all()
    assert seen[107:].all()
    assert not seen[98:102].any()


def test_faint_edges_rise_above_the_noise_and_noise_alone_does_not() -> None:
    rng = np.random.default_rng(3)
    noise = rng.normal(100.0, 4.0, (400, 120)).astype(np.float32)
    faint = noise.copy()
    faint[:, 60:] += 9.0
    found, chance = (vertical_edges(grey).is_edge[:, 58:62].any(axis=1).mean() for grey in (faint, noise))
    assert found > 0.5
    assert chance < 0.1
