"""SSIM of all rows with all rows as one product, and the posterior built on it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reconstruction.panels.search.grid import C1, C2, Rows, normalised_intensity, posterior, softmax

Array = NDArray[np.float64]


def similarity_matrix(picture: NDArray[np.generic]) -> NDArray[np.float32]:
    """HSIM of a grey picture, shape (n, n) for n rows (Eq. 3)."""
    rows = Rows.of(picture)
    return rows.similarity(0, len(rows.means))


def ssim_by_the_book(a: Array, b: Array) -> float:
    """Eq. 3 for one pair of rows."""
    mu_a, mu_b = a.mean(), b.mean()
    covariance = ((a - mu_a) * (b - mu_b)).mean()
    return float((2 * mu_a * mu_b + C1) * (2 * covariance + C2) / ((mu_a**2 + mu_b**2 + C1) * (a.var() + b.var() + C2)))


@given(seed=st.integers(0, 1000), n=st.integers(1, 12), k=st.integers(1, 40))
def test_matrix_product_equals_the_double_loop(seed: int, n: int, k: int) -> None:
    picture = np.random.default_rng(seed).integers(0, 256, (n, k)).astype(float)
    slow = np.array([[ssim_by_the_book(a, b) for b in picture] for a in picture])
    rows = Rows.of(picture, precision=np.float64)
    assert np.allclose(rows.similarity(0, n), slow, atol=1e-12)


@settings(max_examples=15)
@given(seed=st.integers(0, 200))
def test_single_precision_differs_by_a_millionth_on_bright_even_rows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    picture = np.clip(250.0 + rng.normal(0.0, 1.0, (20, 5280)), 0, 255)
    double = Rows.of(picture, precision=np.float64).similarity(0, 20)
    assert np.abs(similarity_matrix(picture) - double).max() < 3e-6


def test_rows_of_one_colour_are_finite_and_alike() -> None:
    picture = np.array([[0.0] * 9, [0.0] * 9, [255.0] * 9])
    matrix = similarity_matrix(picture)
    assert np.isfinite(matrix).all()
    assert matrix[0, 1] == pytest.approx(1.0)
    assert matrix[0, 2] < 0.01


def test_samples_are_means_of_all_pixels_of_their_part() -> None:
    picture = np.arange(24.0).reshape(2, 12)
    sampled = Rows.of(picture, n_samples=3, precision=np.float64)
    by_hand = Rows.of(picture.reshape(2, 3, 4).mean(axis=2), precision=np.float64)
    assert np.allclose(sampled.centred, by_hand.centred)


def test_pictures_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match="shape"):
        Rows.of(np.zeros((0, 4)))
    with pytest.raises(ValueError, match="finite"):
        Rows.of(np.full((2, 2), np.nan))


def test_softmax_of_huge_powers_is_finite_and_sums_to_one() -> None:
    weights = softmax(np.array([[1000.0, 999.0], [-1000.0, -1000.0]]), 20.0)
    assert np.allclose(weights.sum(axis=1), 1.0)
    assert weights[0, 0] > 0.999


def test_histogram_without_lines_stays_zero() -> None:
    assert normalised_intensity(np.zeros(5)).tolist() == [0.0] * 5


def test_posterior_in_blocks_equals_the_whole_matrix() -> None:
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 256, (1300, 30)).astype(float)
    intensity = rng.uniform(0.0, 40.0, 1300)
    whole = softmax(similarity_matrix(picture), 20.0) @ normalised_intensity(intensity)
    assert np.allclose(posterior(Rows.of(picture), intensity, 20.0), whole, atol=1e-6)


def test_a_row_without_line_inherits_from_rows_that_look_like_it() -> None:
    rng = np.random.default_rng(2)
    frame, glass = rng.uniform(0, 255, 60), rng.uniform(0, 255, (20, 60))
    picture = glass.copy()
    picture[[3, 9, 15]] = frame
    intensity = np.zeros(20)
    intensity[[3, 9]] = 50.0
    found = posterior(Rows.of(picture), intensity, 20.0)
    assert found[15] > 0.6
    assert np.delete(found, [3, 9, 15]).max() < 0.2


def test_histogram_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match=r"shape \(4,\)"):
        posterior(Rows.of(np.ones((4, 3))), np.ones(5), 20.0)
