"""Candidate views: well-spread ones, and witnesses aimed at sections that those do not cover."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import Elements
from planning.coverage.sections import PanelFrames
from planning.optimise.problem import ViewProblem, concatenate, nothing_to_see, take
from planning.plan import ViewpointArrays
from planning.positions import aimed_views, spread_positions
from planning.reach_kernel import REACHABLE
from planning.request import N_CANDIDATES

Array = NDArray[np.float64]


MAX_ENTRIES = 60_000_000
"""Covered elements of all candidates together: bounds memory to about 600 MB; candidates are thinned beyond it."""

WITNESS_COVERS_WANTED = 3
"""Sections that fewer spread candidates cover get a candidate of their own."""


class Pool(NamedTuple):
    """Candidate views and the elements each covers."""

    views: ViewpointArrays
    elements: Elements


def candidate_pool(problem: ViewProblem, seed: int, n_candidates: int = N_CANDIDATES) -> Pool:
    """Views to choose from; all can be flown to from home.

    Raises
    ------
    InfeasibleError
        None of them covers anything.
    """
    rng = np.random.default_rng(seed)
    spread = spread_candidates(problem, n_candidates, rng)
    spread_elements = problem.model.elements(spread)
    if len(spread_elements.items) > MAX_ENTRIES:
        kept = np.arange(len(spread.heading_rad)) < len(spread.heading_rad) * MAX_ENTRIES / len(spread_elements.items)
        spread = take(spread, kept)
        spread_elements = problem.model.elements(spread)
    times_covered = np.bincount(spread_elements.items, minlength=problem.model.n_elements)
    witnesses = witness_candidates(problem, times_covered < WITNESS_COVERS_WANTED)
    pool = join_pools(Pool(spread, spread_elements), Pool(witnesses, problem.model.elements(witnesses)))
    useful = np.diff(pool.elements.starts) > 0
    if not useful.any():
        raise nothing_to_see()
    return keep(pool, useful)


def spread_candidates(problem: ViewProblem, n: int, rng: np.random.Generator) -> ViewpointArrays:
    """About `n` flyable views from spread positions, each aimed at a panel that faces it."""
    positions = spread_positions(problem.space, problem.model.frames, 2 * n, rng)[:n]
    positions = positions[problem.flyable(positions)]
    return aimed_views(positions, facing_targets(problem.model.frames, positions, rng), problem.model.camera)


def facing_targets(frames: PanelFrames, positions_enu_m: Array, rng: np.random.Generator, n_tries: int = 8) -> Array:
    """For each position the centroid of a random panel, of one that faces it if `n_tries` draws find one."""
    n = len(positions_enu_m)
    target = rng.integers(0, len(frames), n)
    for _ in range(n_tries):
        rays = positions_enu_m - frames.centroids[target]
        away = np.einsum("nk,nk->n", rays, frames.normals[target]) <= 0.0
        target[away] = rng.integers(0, len(frames), int(away.sum()))
    return frames.centroids[target]


def witness_candidates(problem: ViewProblem, wanted: NDArray[np.bool_]) -> ViewpointArrays:
    """Flyable witness views of the reachable elements where `wanted`, aimed at their panels."""
    reachability = problem.reachability
    element = np.flatnonzero((reachability.verdicts.reshape(-1) == REACHABLE) & wanted)
    positions = reachability.witnesses_enu_m.reshape(-1, 3)[element]
    panel = element // problem.model.grid.n_sections
    flyable = problem.flyable(positions)
    return aimed_views(positions[flyable], problem.model.frames.centroids[panel[flyable]], problem.model.camera)


def join_pools(first: Pool, second: Pool) -> Pool:
    """Both pools, the first in front."""
    starts = np.concatenate([first.elements.starts, second.elements.starts[1:] + first.elements.starts[-1]])
    items = np.concatenate([first.elements.items, second.elements.items])
    return Pool(concatenate([first.views, second.views]), Elements(starts, items))


def keep(pool: Pool, kept: NDArray[np.bool_]) -> Pool:
    """Part of a pool."""
    counts = np.diff(pool.elements.starts)
    items = pool.elements.items[np.repeat(kept, counts)]
    starts = np.concatenate([[0], np.cumsum(counts[kept])]).astype(np.int64)
    return Pool(take(pool.views, kept), Elements(starts, items))
