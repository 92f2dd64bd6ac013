"""Diagonal blocks of the inverse of a sparse normal matrix, without the rest of the inverse.

Blocks are ordered so that each is linked to near ones only (E. Cuthill and J. McKee, 1969), and cut into segments of
which each is linked to the next alone: a block tridiagonal matrix. Its inverse's diagonal follows from an elimination
forwards and a recursion backwards (K. Takahashi, J. Fagan and M. Chin, 1973). A few unknowns that everything is linked
to, such as focal lengths, stand in a border of their own.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.csgraph import reverse_cuthill_mckee

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

Array = NDArray[np.float64]

MAX_SEGMENT = 6000
"""Unknowns of a segment: about five dense matrices of this size are held at a time, 1.4 GB, and inverting takes some
20 s on two cores."""


class TooLargeError(Exception):
    """Everything is linked to everything: a segment has more than `MAX_SEGMENT` unknowns, as many as `args` says."""


def inverse_blocks(normal: sparse.csr_array, size: int, n_blocks: int, monitor: Monitor = QUIET) -> Array:
    """Diagonal blocks of the inverse, shape (n_blocks, size, size).

    Parameters
    ----------
    normal
        Symmetric and positive definite; its first `size * n_blocks` unknowns are the blocks', the others the border.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is not positive definite: something is fixed by nothing.
    TooLargeError
        A segment would be too large.
    """
    order, ends = _segments(_links(normal, size, n_blocks))
    lengths = [size * (end - start) for start, end in pairwise([0, *ends])]
    if max(lengths) > MAX_SEGMENT:
        raise TooLargeError(max(lengths))
    unknowns = (size * order[:, None] + np.arange(size)).ravel()
    n = size * n_blocks
    inner = normal[:n, :n][unknowns][:, unknowns].tocsr()
    cuts = [slice(size * start, size * end) for start, end in pairwise([0, *ends])]
    border = normal[:n, n:].toarray()[unknowns]
    factors, forward = _eliminated(inner, cuts, border, monitor)
    solved, blocks = np.empty_like(border), np.empty((n_blocks, size, size))
    later: tuple[slice, Array] | None = None
    for cut, factor in zip(reversed(cuts), reversed(factors), strict=True):
        monitor.report(say("inverting normal equations"), n - cut.stop, n)
        inverse = cho_solve(factor, np.eye(cut.stop - cut.start))
        if later is None:
            solved[cut] = cho_solve(factor, forward[cut])
        else:
            following, below = later
            link = inner[cut, following].toarray()
            solved[cut] = cho_solve(factor, forward[cut] - link @ solved[following])
            carried = cho_solve(factor, link)
            inverse = inverse + carried @ below @ carried.T
        for number in range(cut.start // size, cut.stop // size):
            at = size * number - cut.start
            blocks[order[number]] = inverse[at : at + size, at : at + size]
        later = cut, inverse
    if border.shape[1]:
        left = normal[n:, n:].toarray() - border.T @ solved
        spread = cho_solve(cho_factor(0.5 * (left + left.T)), solved.T).T
        each = np.empty((n_blocks, size, border.shape[1]))
        each_spread = np.empty_like(each)
        each[order], each_spread[order] = solved.reshape(each.shape), spread.reshape(each.shape)
        blocks += each_spread @ each.transpose(0, 2, 1)
    return np.asarray(0.5 * (blocks + blocks.transpose(0, 2, 1)), np.float64)


def _links(normal: sparse.csr_array, size: int, n_blocks: int) -> sparse.csr_array:
    """Which blocks are linked, shape (n_blocks, n_blocks)."""
    inner = normal[: size * n_blocks, : size * n_blocks].tocoo()
    shape = (n_blocks, n_blocks)
    return sparse.csr_array((np.ones(inner.nnz, np.int8), (inner.row // size, inner.col // size)), shape=shape)


def _segments(links: sparse.csr_array) -> tuple[NDArray[np.int64], list[int]]:
    """Order of the blocks, and where in it each segment ends: as far as the blocks before it reach."""
    order = np.asarray(reverse_cuthill_mckee(links, symmetric_mode=True), np.int64)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    pairs = links.tocoo()
    reach = np.arange(len(order))
    np.maximum.at(reach, place[pairs.row], place[pairs.col])
    ends, end = [], 1
    while True:
        ends.append(end)
        if end == len(order):
            return order, ends
        start = ends[-2] if len(ends) > 1 else 0
        end = max(end + 1, int(reach[start:end].max()) + 1)


def _eliminated(
    inner: sparse.csr_array, cuts: list[slice], border: Array, monitor: Monitor
) -> tuple[list[tuple[Array, bool]], Array]:
    """Cholesky factors of the segments with all before them eliminated, and the border after the same steps."""
    factors: list[tuple[Array, bool]] = []
    forward = border.copy()
    before: slice | None = None
    for cut in cuts:
        monitor.report(say("inverting normal equations"), cut.start, inner.shape[0])
        own = inner[cut, cut].toarray()
        if before is not None:
            link = inner[before, cut].toarray()
            carried = cho_solve(factors[-1], link)
            own = own - link.T @ carried
            forward[cut] -= carried.T @ forward[before]
        factors.append(cho_factor(0.5 * (own + own.T)))
        before = cut
    return factors, forward
