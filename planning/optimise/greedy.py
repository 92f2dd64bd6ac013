"""Greedy view selection with a certificate, then improvement: the default method.

The paper's fitness (Eq. 10) is monotone submodular, so greedy reaches at least 1 - 1/e of the best that its candidates
allow. With a given number of views that do not reach everything, the choice is improved by rounds of exchange and
refining (`planning.optimise.improve`); views left over when everything is covered are spent on a second and third view
of each section and on finer sections.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel, Elements
from planning.coverage.sections import SectionGrid
from planning.optimise import cover_kernel as kernel
from planning.optimise.bounds import dual_bound
from planning.optimise.candidates import Pool, candidate_pool, join_pools
from planning.optimise.improve import Exchange, cover_state, improve_views
from planning.optimise.locked import NONE_LOCKED, covered_by
from planning.optimise.problem import Goal, ViewProblem, ViewSet, concatenate, take
from planning.plan import ViewpointArrays
from planning.progress import Monitor, Stop, Trace
from planning.request import GreedyParameters

Array = NDArray[np.float64]

SPARE_STAGES = ((1, 2), (2, 1), (1, 3), (3, 1), (2, 2), (1, 4))
"""What spare views are spent on, in this order: (division of the section step, wanted views per section)."""


def greedy(
    problem: ViewProblem,
    goal: Goal,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: GreedyParameters = GreedyParameters(),
    locked: ViewpointArrays = NONE_LOCKED,
) -> ViewSet:
    """Choose views greedily, then improve them. Trace values are covered elements.

    Views that are `locked` come first in the result, as they are; they count as views and for what is covered, and
    the others are chosen for what they leave.

    Raises
    ------
    InfeasibleError
        There is no allowed viewpoint that sees anything.
    """
    monitor.report("trying viewpoints", 0, 1)
    pool = candidate_pool(problem, seed, parameters.n_candidates)
    weights = element_weights(problem.model, parameters.solid_angle_weights)
    covered = covered_by(problem.model, locked)
    coverable = (np.bincount(pool.elements.items, minlength=len(weights)) > 0) | (covered > 0)
    everything = float(weights[coverable].sum())
    if goal.share is not None:
        target = goal.share * everything
        found = _fewest_views(pool, weights, covered, target, seed, stop, trace, monitor, parameters)
        return ViewSet(concatenate([locked, found]))
    assert goal.n_views is not None  # Goal's own check
    n_free = goal.n_views - len(locked.heading_rad)
    chosen, value = choose_greedily(pool, weights, n_free, np.inf, trace, monitor, covered)
    bound = everything
    if value < everything - 1e-9 and len(chosen) == n_free:
        if parameters.certify:
            monitor.report("bounding the optimum", 0, 1)
            bound = _bound(pool.elements, weights, covered, n_free, value, stop)
        if parameters.improve and n_free > 0:
            views = improve_views(problem, pool, chosen, weights, seed, stop, trace, monitor, locked)
            views = take(views, needed(problem.model.elements(views), weights, covered))
            n_needed = len(views.heading_rad)
            pool = join_pools(Pool(views, problem.model.elements(views)), pool)
            chosen = np.arange(n_needed)
    chosen = spend_spare_views(problem.model, pool, chosen, n_free, monitor, locked)
    return ViewSet(concatenate([locked, take(pool.views, chosen)]), bound)


def _bound(
    elements: Elements, weights: Array, covered: NDArray[np.int32], n_views: int, known: float, stop: Stop
) -> float:
    """Bound on the weight that so many candidates can cover together with what is covered all the same."""
    given = float(weights[covered > 0].sum())
    if n_views == 0:
        return given
    return given + dual_bound(elements, np.where(covered > 0, 0.0, weights), n_views, known - given, stop=stop)


def needed(elements: Elements, weights: Array, covered: NDArray[np.int32] | None = None) -> NDArray[np.bool_]:
    """Which views are left when those are dropped, one after the other, without which nothing is lost."""
    state = cover_state(elements, weights, covered)
    kept = np.ones(len(elements.starts) - 1, np.bool_)
    for view in range(len(kept)):
        kernel.add_elements(state, elements.of(view))
    for view in range(len(kept)):
        if kernel.loss_of(state, elements.of(view)) <= 1e-9:
            kernel.remove_elements(state, elements.of(view))
            kept[view] = False
    return kept


def choose_greedily(
    pool: Pool,
    weights: Array,
    n_wanted: int,
    enough: float,
    trace: Trace,
    monitor: Monitor,
    covered: NDArray[np.int32] | None = None,
) -> tuple[NDArray[np.int64], float]:
    """Numbers of the candidates chosen, in order, and the weight that is covered with them (and `covered` without).

    Ends at `n_wanted` candidates, at a weight of `enough`, or when nothing is left to gain. It is quick, and the first
    answer of an anytime method, so nothing stops it but cancelling.
    """
    state = cover_state(pool.elements, weights, covered)
    chosen = np.zeros(min(n_wanted, len(state.gains)), np.int64)
    n_chosen = 0
    while n_chosen < len(chosen):
        monitor.report("choosing views", n_chosen, len(chosen))
        slice_end = min(len(chosen), n_chosen + max(8, n_chosen // 4))
        n_now = int(kernel.greedy_steps(state, chosen, n_chosen, slice_end, enough))
        trace.record(int(np.count_nonzero(state.counts)))
        ended = n_now < slice_end
        n_chosen = n_now
        if ended:
            break
    return chosen[:n_chosen], float(kernel.objective(state))


def _fewest_views(
    pool: Pool,
    weights: Array,
    covered: NDArray[np.int32],
    target: float,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: GreedyParameters,
) -> ViewpointArrays:
    """Fewest views found that bring what is covered to the weight `target`.

    Greedy, then views are taken away while exchange makes up for them.
    """
    enough = target - 1e-9
    chosen, value = choose_greedily(pool, weights, len(pool.views.heading_rad), enough, trace, monitor, covered)
    if parameters.improve and value >= enough:
        exchange = Exchange(pool.elements, weights, chosen, seed, covered)
        while len(chosen) > 1 and not stop():
            exchange.drop_least_useful()
            monitor.report("saving views", len(pool.views.heading_rad) - len(exchange.chosen), 0)
            exchange.run(stop, enough=enough)
            if exchange.value() < enough:
                break
            chosen = exchange.chosen.copy()
    return take(pool.views, chosen)


def element_weights(model: CoverageModel, by_solid_angle: bool) -> Array:
    """Weight of each element: 1, or its section's solid angle relative to the mean."""
    if not by_solid_angle:
        return np.ones(model.n_elements)
    solid_angles = model.grid.solid_angles_sr()
    return np.tile(solid_angles / solid_angles.mean(), len(model.frames))


def spend_spare_views(
    model: CoverageModel,
    pool: Pool,
    chosen: NDArray[np.int64],
    n_views: int,
    monitor: Monitor,
    locked: ViewpointArrays = NONE_LOCKED,
) -> NDArray[np.int64]:
    """Numbers of the chosen candidates and of further ones, until there are `n_views` or nothing is left to gain.

    Further ones bring more views of each section, then finer sections (`SPARE_STAGES`); what the `locked` views show
    counts as shown.
    """
    for division, depth in SPARE_STAGES:
        n_spare = n_views - len(chosen)
        if n_spare <= 0:
            break
        monitor.report("spending spare views", len(chosen), n_views)
        finer = replace(model, grid=SectionGrid(model.grid.step_deg / division))
        elements = pool.elements if division == 1 else finer.elements(pool.views)
        state = cover_state(elements, np.ones(finer.n_elements), covered_by(finer, locked))
        state.depth[0] = depth
        for candidate in chosen:
            kernel.add_elements(state, elements.of(candidate))
        kernel.refresh_gains(state)
        state.gains[chosen] = -np.inf
        added = np.zeros(n_spare, np.int64)
        n_added = kernel.greedy_steps(state, added, 0, n_spare, np.inf)
        chosen = np.concatenate([chosen, added[:n_added]])
    return chosen
