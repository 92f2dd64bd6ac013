"""Vanishing points: finite, at infinity, several, with outliers, and as sure as they say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from reconstruction.panels.search.vanishing import VanishingPoint, vanishing_points

Array = NDArray[np.float64]
W, H = 1600, 1200


def towards(point: Array, n: int, rng: np.random.Generator, noise_px: float = 0.5) -> Array:
    """Segments of 40 to 200 px that run to a homogeneous point, shape (n, 4), their ends off by noise across them."""
    middles = rng.uniform([100, 100], [W - 100, H - 100], (n, 2))
    direction = point[:2] - point[2] * middles
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    half = rng.uniform(20.0, 100.0, (n, 1)) * direction
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    a = middles - half + across * rng.normal(0.0, noise_px, (n, 1))
    b = middles + half + across * rng.normal(0.0, noise_px, (n, 1))
    return np.column_stack([a, b])


def off_deg(found: VanishingPoint, truth: Array) -> float:
    """Largest difference of direction to both points over the picture, degrees."""
    x, y = np.meshgrid([0.0, W / 2, W], [0.0, H / 2, H])
    places = np.column_stack([x.ravel(), y.ravel()])
    a, b = (p[:2] - p[2] * places for p in (found.point, truth))
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float(np.degrees(np.arctan2(np.abs(cross), np.abs((a * b).sum(axis=1)))).max())


POINTS = {
    "far": np.array([9000.0, 800.0, 1.0]),
    "near": np.array([2600.0, 500.0, 1.0]),
    "at infinity": np.array([1.0, 0.02, 0.0]),
    "below": np.array([700.0, 6000.0, 1.0]),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", POINTS)
def test_points_are_found_among_as_many_outliers(name: str) -> None:
    rng = np.random.default_rng(5)
    angles = rng.uniform(0.0, np.pi, 60)
    clutter = np.concatenate([towards(np.array([np.cos(t), np.sin(t), 0.0]), 1, rng) for t in angles])
    segments = np.concatenate([towards(POINTS[name], 60, rng), clutter])
    found = vanishing_points(segments, W, H)[0]
    assert off_deg(found, POINTS[name]) < 0.5
    assert (found.members < 60).mean() > 0.8


def test_two_facades_and_their_verticals_are_three_points() -> None:
    rng = np.random.default_rng(1)
    truth = [np.array([4000.0, 500.0, 1.0]), np.array([-3500.0, 650.0, 1.0]), np.array([900.0, 20000.0, 1.0])]
    segments = np.concatenate([towards(point, n, rng) for point, n in zip(truth, (90, 60, 80), strict=True)])
    found = vanishing_points(segments, W, H)
    assert len(found) >= 3
    for point in truth:
        assert min(off_deg(candidate, point) for candidate in found) < 0.5
    assert sum(candidate.is_vertical for candidate in found[:3]) == 1


@pytest.mark.slow
@given(seed=st.integers(0, 30))
def test_the_same_seed_gives_the_same_points(seed: int) -> None:
    segments = towards(POINTS["far"], 30, np.random.default_rng(seed))
    first, second = (vanishing_points(segments, W, H, seed) for _ in range(2))
    assert [p.point.tolist() for p in first] == [p.point.tolist() for p in second]


@pytest.mark.slow
def test_covariance_tells_the_spread_over_noise() -> None:
    """Two-sided: the mean of the squared normalised error is that of two degrees of freedom, 2."""
    truth = POINTS["far"]
    sphere = np.array([(truth[0] - W / 2) / W, (truth[1] - H / 2) / W, 1.0])
    sphere /= np.linalg.norm(sphere)
    scores = []
    for seed in range(40):
        found = vanishing_points(towards(truth, 80, np.random.default_rng(seed)), W, H)[0]
        x, y, w = found.point
        unit = np.array([(x - W / 2 * w) / W, (y - H / 2 * w) / W, w])
        unit /= np.linalg.norm(unit)
        error = unit * np.sign(unit @ sphere) - sphere
        scores.append(float(error @ np.linalg.pinv(found.covariance, rcond=1e-9) @ error))
    assert 1.0 < np.mean(scores) < 4.0


@pytest.mark.parametrize("n", [0, 1, 5])
def test_too_few_segments_give_no_point(n: int) -> None:
    assert vanishing_points(towards(POINTS["far"], n, np.random.default_rng(0)), W, H) == ()


def test_segments_on_one_line_give_finite_numbers() -> None:
    x = np.arange(0.0, 800.0, 50.0)
    segments = np.column_stack([x, np.full_like(x, 300.0), x + 40.0, np.full_like(x, 300.0)])
    for point in vanishing_points(segments, W, H):
        assert np.isfinite(point.point).all()
        assert np.isfinite(point.covariance).all()
