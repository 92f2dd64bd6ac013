"""The similarity between two sets of points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.colmap.georeference import Similarity, are_on_a_line, fit, fit_robustly, spread
from reconstruction.colmap.record import rotation_of


def known(seed):
    rng = np.random.default_rng(seed)
    rotation = rotation_of(tuple(rng.normal(size=4)))
    return Similarity(float(rng.uniform(0.01, 100.0)), rotation, rng.normal(0.0, 1000.0, 3)), rng


def assert_same(one, other, rel=1e-9):
    assert one.scale == pytest.approx(other.scale, rel=rel)
    np.testing.assert_allclose(one.rotation, other.rotation, atol=rel)
    np.testing.assert_allclose(one.translation, other.translation, rtol=1e-6, atol=1e-6)


@given(st.integers(0, 500), st.integers(3, 30))
def test_exact_points_give_the_similarity_exactly(seed, n):
    truth, rng = known(seed)
    a = rng.normal(size=(n, 3))
    assert_same(fit(a, truth(a)), truth, 1e-6)
    assert_same(truth.inverse().inverse(), truth)
    np.testing.assert_allclose(truth.inverse()(truth(a)), a, atol=1e-9)


def test_points_in_a_plane_never_give_a_mirror_image():
    truth, rng = known(3)
    flat = rng.normal(size=(8, 3)) * [5.0, 3.0, 0.0]
    found = fit(flat, truth(flat))
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    assert_same(found, truth, 1e-8)


def test_no_other_similarity_fits_noisy_points_better():
    truth, rng = known(4)
    a = rng.normal(size=(20, 3))
    b = truth(a) + rng.normal(0.0, 0.1, (20, 3)) * truth.scale
    weights = rng.uniform(0.5, 2.0, 20)
    best = fit(a, b, weights)

    def cost(s):
        return float(weights @ ((s(a) - b) ** 2).sum(axis=1))

    for _ in range(200):
        turn = rotation_of((1.0, *rng.normal(0.0, 1e-3, 3)))
        other = Similarity(
            best.scale * (1.0 + rng.normal(0.0, 1e-3)), turn @ best.rotation, best.translation + rng.normal(0, 1e-3, 3)
        )
        assert cost(best) <= cost(other)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.0, 0.2, 0.45])
def test_outliers_are_found_and_do_no_harm(share):
    truth, rng = known(5)
    n = 40
    a = rng.normal(size=(n, 3)) * [10.0, 4.0, 1.0]
    b = truth(a) + rng.normal(0.0, 0.02, (n, 3))
    wrong = np.arange(n) < round(share * n)
    b[wrong] += rng.normal(0.0, 30.0, (int(wrong.sum()), 3)) + 5.0
    found, inlier = fit_robustly(a, b, np.full(n, 0.02))
    assert (inlier == ~wrong).mean() >= 0.95
    assert not (inlier & wrong).any()
    assert np.abs(found(a) - truth(a)).max() < 0.05


def test_standard_deviations_that_are_too_small_are_not_believed():
    truth, rng = known(6)
    a = rng.normal(size=(30, 3)) * 10.0
    b = truth(a) + rng.normal(0.0, 0.5, (30, 3))
    _, inlier = fit_robustly(a, b, np.full(30, 0.001))
    assert inlier.mean() > 0.9


def test_points_on_a_line_are_told_and_a_known_rotation_helps():
    truth, rng = known(7)
    line = np.outer(np.linspace(0.0, 30.0, 9), [1.0, 0.3, 0.0]) + rng.normal(0.0, 0.05, (9, 3))
    assert are_on_a_line(line)
    assert not are_on_a_line(line + np.outer(np.arange(9) % 2, [0.0, 0.0, 3.0]))
    found, _ = fit_robustly(line, truth(line), np.full(9, 0.02), truth.rotation)
    assert_same(found, truth, 1e-8)
    assert (spread(np.zeros((1, 3))) == 0.0).all()


def test_wrong_calls_are_refused():
    with pytest.raises(ValueError, match="one shape"):
        fit(np.zeros((3, 3)), np.zeros((4, 3)))
    with pytest.raises(ValueError, match="one place"):
        fit(np.ones((3, 3)), np.zeros((3, 3)))
