"""Candidate views: well-spread ones, and witnesses aimed at sections that those do not cover."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.base.progress import Stop, never
from planning.coverage.model import Elements
from planning.coverage.positions import aimed_views, rounded, spread_positions
from planning.coverage.reach_kernel import REACHABLE
from planning.coverage.reachability import keeps_margins
from planning.coverage.sections import PanelFrames
from planning.parameters import N_CANDIDATES
from planning.plan import ViewpointArrays
from planning.viewpoints.problem import ViewProblem, concatenate, nothing_to_see, take

Array = NDArray[np.float64]


MAX_ENTRIES = 60_000_000
"""Covered elements of all candidates together: bounds memory to about 600 MB; candidates are thinned beyond it."""

WITNESS_COVERS_WANTED = 3
"""Sections that fewer spread candidates cover get a candidate of their own."""

VIEWS_PER_BLOCK = 4000
"""Spread candidates looked at between two looks at the clock."""

FEWEST_AROUND, MOST_AROUND, MAX_AROUND = 1, 24, 4000
"""Places tried around each of these candidates, and for all together, at a time. Where sections are seen from a narrow
strip only, one place that several share is found in place of one for each, and these may be too close together."""

AROUND_M = (0.02, 4.0)
"""How far they are moved at first."""

N_STRETCHES, STRETCH = 4, 1.5
"""How often further places are tried on lines through known ones, and how far (of the distance between these)."""


class Pool(NamedTuple):
    """Candidate views and the elements each covers."""

    views: ViewpointArrays
    elements: Elements


def candidate_pool(problem: ViewProblem, seed: int, n_candidates: int = N_CANDIDATES, stop: Stop = never) -> Pool:
    """Views to choose from, rounded as plan files hold them, so that what is chosen is what is flown.

    All can be flown to from home. When `stop` asks for an end, views not yet looked at are left out; where it does so
    before views for the sections that spread ones do not show are looked at, there are none of these, and where it does
    so from the start, few of the others.

    Raises
    ------
    InfeasibleError
        None of them covers anything.
    """
    rng, is_late = np.random.default_rng(seed), stop()
    spread = spread_candidates(problem, min(n_candidates, VIEWS_PER_BLOCK) if is_late else n_candidates, rng)
    spread, spread_elements = _elements_until(problem, spread, stop)
    if len(spread_elements.items) > MAX_ENTRIES:
        kept = np.arange(len(spread.heading_rad)) < len(spread.heading_rad) * MAX_ENTRIES / len(spread_elements.items)
        spread = take(spread, kept)
        spread_elements = problem.model.elements(spread)
    pool = Pool(spread, spread_elements)
    if not stop() or len(spread_elements.items) == 0:
        times_covered = np.bincount(spread_elements.items, minlength=problem.model.n_elements)
        witnesses = witness_candidates(problem, times_covered < WITNESS_COVERS_WANTED, rng)
        pool = join_pools(pool, Pool(*_elements_until(problem, witnesses, stop)))
    useful = np.diff(pool.elements.starts) > 0
    if not useful.any():
        raise nothing_to_see()
    # Witnesses of several sections may be one pose, and a second photo of it would not be flown.
    _, first = np.unique(np.column_stack(pool.views), axis=0, return_index=True)
    useful[np.setdiff1d(np.arange(len(useful)), first)] = False
    return keep(pool, useful)


def _elements_until(problem: ViewProblem, views: ViewpointArrays, stop: Stop) -> tuple[ViewpointArrays, Elements]:
    """The first of the views, in blocks, until `stop`, and what they cover."""
    n_views = len(views.heading_rad)
    parts: list[Pool] = []
    for start, end in chunks(n_views, VIEWS_PER_BLOCK):
        if parts and stop():
            break
        part = take(views, np.arange(start, end))
        parts.append(Pool(part, problem.model.elements(part)))
    if len(parts) <= 1:
        return parts[0] if parts else Pool(views, problem.model.elements(views))
    counts = np.concatenate([np.diff(part.elements.starts) for part in parts])
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    items = np.concatenate([part.elements.items for part in parts])
    return Pool(concatenate([part.views for part in parts]), Elements(starts, items))


def spread_candidates(problem: ViewProblem, n: int, rng: np.random.Generator) -> ViewpointArrays:
    """About `n` flyable views from spread positions, each aimed at a panel that faces it."""
    positions = spread_positions(problem.space, problem.model.frames, 2 * n, rng)[:n]
    positions = positions[problem.flyable(positions)]
    camera, targets = problem.model.camera, facing_targets(problem.model.frames, positions, rng)
    return rounded(aimed_views(positions, targets, camera), camera)


def facing_targets(frames: PanelFrames, positions_enu_m: Array, rng: np.random.Generator, n_tries: int = 8) -> Array:
    """For each position the centroid of a random panel, of one that faces it if `n_tries` draws find one."""
    n = len(positions_enu_m)
    target = rng.integers(0, len(frames), n)
    for _ in range(n_tries):
        rays = positions_enu_m - frames.centroids[target]
        away = np.einsum("nk,nk->n", rays, frames.normals[target]) <= 0.0
        target[away] = rng.integers(0, len(frames), int(away.sum()))
    return frames.centroids[target]


def witness_candidates(problem: ViewProblem, is_open: NDArray[np.bool_], rng: np.random.Generator) -> ViewpointArrays:
    """Flyable views of the reachable elements where `is_open`, at their witnesses and around, aimed at their panels."""
    reachability = problem.reachability
    element = np.flatnonzero((reachability.verdicts.reshape(-1) == REACHABLE) & is_open)
    positions = reachability.witnesses_enu_m.reshape(-1, 3)[element]
    positions, number = places_around(problem, element, positions, rng, MAX_AROUND // 4)
    flyable = problem.flyable(positions)
    panel = element[number[flyable]] // problem.model.grid.n_sections
    camera, targets = problem.model.camera, problem.model.frames.centroids[panel]
    return rounded(aimed_views(positions[flyable], targets, camera), camera)


def places_around(
    problem: ViewProblem,
    elements: NDArray[np.int64],
    seen_from_enu_m: Array,
    rng: np.random.Generator,
    n_most: int = MAX_AROUND,
    stop: Stop = never,
) -> tuple[Array, NDArray[np.int64]]:
    """Places from which elements are seen, if nothing is between: those given, and further allowed ones around them.

    Parameters
    ----------
    seen_from_enu_m
        A place for each of the elements, shape (k, 3).
    n_most
        Places tried at a time, about.
    stop
        Asked before each time.

    Returns
    -------
    places, number
        Shape (n, 3), and of the element that each is for, shape (n,).
    """
    n_each = min(MOST_AROUND, max(FEWEST_AROUND, n_most // max(1, len(elements))))
    panel, section = np.divmod(elements, problem.model.grid.n_sections)
    places, number = seen_from_enu_m, np.arange(len(elements))
    for is_first in (True, *(N_STRETCHES * (False,))):
        if stop():
            break
        of = np.repeat(np.arange(len(elements)), n_each)
        if is_first:
            low, high = np.log(AROUND_M)
            scale = np.exp(rng.uniform(low, high, (len(of), 1)))
            tried = seen_from_enu_m[of] + rng.normal(size=(len(of), 3)) * scale / np.sqrt(3.0)
        else:
            # Along lines through two known places: these places fill strips and wedges that are much thinner than long.
            known = np.bincount(number, minlength=len(elements))
            start = np.concatenate([[0], np.cumsum(known)[:-1]])
            a, b = (places[start[of] + (rng.random(len(of)) * known[of]).astype(np.int64)] for _ in range(2))
            tried = a + rng.normal(size=(len(of), 1)) * STRETCH * (b - a)
        kept = keeps_margins(problem.model, tried, panel[of], section[of])
        kept[kept] = problem.space.is_allowed(tried[kept])
        places, number = np.concatenate([places, tried[kept]]), np.concatenate([number, of[kept]])
        order = np.argsort(number, kind="stable")
        places, number = places[order], number[order]
    return places, number


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
