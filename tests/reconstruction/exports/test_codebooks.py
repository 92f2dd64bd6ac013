"""Codebooks and palettes: nearer than what is simpler, whatever the numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.cluster.vq import kmeans2

from planning.base.progress import QUIET
from reconstruction.exports.sog import CODES, codebook, nearest_codes, palette


@settings(max_examples=30, deadline=None)
@given(hnp.arrays(np.float32, st.integers(1, 400), elements=st.floats(-(2.0**100), 2.0**100, width=32)))
def test_every_number_has_its_nearest_code(values):
    codes = codebook(values)
    assert codes.shape == (CODES,)
    assert (np.diff(codes) >= 0.0).all()
    errors = np.abs(codes[nearest_codes(values, codes)] - values)
    best = np.abs(codes[None, :] - values[:, None].astype(float)).min(axis=1)
    scale = float(np.abs(values).max())
    np.testing.assert_allclose(errors, best, atol=1e-9 * max(scale, 1e-30))
    if len(np.unique(values)) == 1:
        assert errors.max() <= 1e-6 * scale


@pytest.mark.parametrize("seed", range(3))
def test_codes_are_nearer_than_even_and_than_equally_frequent_ones(seed):
    values = np.random.default_rng(seed).standard_t(3, 20_000)
    even = np.linspace(values.min(), values.max(), CODES)
    often = np.quantile(values, np.linspace(0.0, 1.0, CODES))
    errors = [float(np.square(values - codes[nearest_codes(values, codes)]).mean()) for codes in (even, often)]
    codes = codebook(values)
    found = float(np.square(values - codes[nearest_codes(values, codes)]).mean())
    assert found < 0.8 * min(errors)


def test_a_palette_in_two_steps_is_nearly_as_good_as_in_one():
    rng = np.random.default_rng(0)
    middles = rng.normal(size=(40, 9)).astype(np.float32)
    vectors = middles[rng.integers(0, 40, 4000)] + rng.normal(0.0, 0.2, (4000, 9)).astype(np.float32)
    found = palette(vectors, 100, 0, QUIET)
    assert len(found.colours) <= 100
    error = float(np.square(vectors - found.colours[found.labels(vectors)]).mean())
    plain, labels = kmeans2(vectors, vectors[rng.choice(4000, 100, replace=False)].copy(), iter=10, minit="matrix")
    assert error < 1.3 * float(np.square(vectors - plain[labels]).mean())
    assert error < 0.1 * float(vectors.var(axis=0).mean())


@settings(max_examples=25, deadline=None)
@given(
    n=st.integers(1, 120), size=st.integers(1, 150), d=st.integers(1, 6), same=st.booleans(), seed=st.integers(0, 99)
)
def test_palettes_of_any_size_have_a_colour_for_all(n, size, d, same, seed):
    rng = np.random.default_rng(seed)
    vectors = np.ones((n, d), np.float32) if same else rng.normal(size=(n, d)).astype(np.float32)
    found = palette(vectors, size, seed, QUIET)
    assert 1 <= len(found.colours) <= min(n, size)
    assert found.starts[-1] == len(found.colours)
    labels = found.labels(vectors)
    assert ((labels >= 0) & (labels < len(found.colours))).all()
    assert np.isfinite(found.colours).all()
    if same:
        assert np.array_equal(found.colours[labels], vectors)
    again = palette(vectors, size, seed, QUIET)
    assert np.array_equal(found.colours, again.colours)


def test_vectors_that_are_all_different_are_kept_where_there_is_room():
    vectors = np.random.default_rng(0).normal(size=(50, 4)).astype(np.float32)
    found = palette(vectors, 50, 0, QUIET)
    assert np.array_equal(found.colours[found.labels(vectors)], vectors)
