"""Blocks of an inverse against the whole inverse."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from reconstruction.colmap import refine
from reconstruction.colmap.refine import TooLargeError, inverse_blocks


def normal_matrix(n_blocks, size, n_border, reach, seed, weakest=1e-3):
    """Of blocks that are linked to some of the `reach` next ones, in an order of chance, and a border linked to all."""
    rng = np.random.default_rng(seed)
    rows = []
    for first in range(n_blocks):
        for second in range(first, min(n_blocks, first + reach + 1)):
            if second > first and rng.random() < 0.3:
                continue
            row = np.zeros((size + 1, size * n_blocks + n_border))
            for block in (first, second):
                row[:, size * block : size * (block + 1)] = rng.normal(size=(size + 1, size))
            row[:, size * n_blocks :] = rng.normal(size=(size + 1, n_border))
            rows.append(row)
    jacobian = np.concatenate(rows)
    mixed = (size * rng.permutation(n_blocks)[:, None] + np.arange(size)).ravel()
    order = np.concatenate([mixed, size * n_blocks + np.arange(n_border)]).astype(int)
    return (jacobian.T @ jacobian + weakest * np.eye(jacobian.shape[1]))[np.ix_(order, order)]


@given(
    n_blocks=st.integers(1, 25),
    size=st.integers(1, 6),
    n_border=st.integers(0, 3),
    reach=st.integers(0, 30),
    seed=st.integers(0, 1000),
)
@settings(max_examples=60, deadline=None)
def test_blocks_are_those_of_the_whole_inverse(n_blocks, size, n_border, reach, seed):
    normal = normal_matrix(n_blocks, size, n_border, reach, seed)
    expected = np.linalg.inv(normal)
    found = inverse_blocks(sparse.csr_array(normal), size, n_blocks)
    for i in range(n_blocks):
        at = slice(size * i, size * (i + 1))
        np.testing.assert_allclose(found[i], expected[at, at], rtol=1e-6, atol=1e-9 * np.abs(expected).max())


@pytest.mark.slow
def test_a_chain_that_is_held_at_one_end_only_is_solved_to_its_other_end():
    """Each block knows its distance to the next to 1e-3: after 2000 the standard deviation is the root of 2000 times
    that, and the condition number some 1e7."""
    n, sigma = 2000, 1e-3
    chain = sparse.diags_array([[-1.0] * (n - 1), [2.0] * (n - 1) + [1.0], [-1.0] * (n - 1)], offsets=[-1, 0, 1])
    found = inverse_blocks(sparse.csr_array(chain / sigma**2), 1, n).ravel()
    np.testing.assert_allclose(np.sqrt(found), sigma * np.sqrt(np.arange(1, n + 1)), rtol=1e-9)


def test_what_nothing_fixes_is_refused():
    normal = normal_matrix(8, 2, 1, 2, 0, weakest=0.0)
    normal[4:6] = normal[:, 4:6] = 0.0
    with pytest.raises(np.linalg.LinAlgError):
        inverse_blocks(sparse.csr_array(normal), 2, 8)
    border = normal_matrix(8, 2, 1, 2, 0)
    border[-1] = border[:, -1] = 0.0
    with pytest.raises(np.linalg.LinAlgError):
        inverse_blocks(sparse.csr_array(border), 2, 8)


def test_more_than_fits_into_memory_is_refused_before_it_is_tried(monkeypatch):
    monkeypatch.setattr(refine, "MAX_SEGMENT", 10)
    with pytest.raises(TooLargeError, match=r"\d\d"):
        inverse_blocks(sparse.csr_array(normal_matrix(12, 2, 0, 12, 0)), 2, 12)
    inverse_blocks(sparse.csr_array(normal_matrix(100, 2, 0, 1, 0)), 2, 100)
