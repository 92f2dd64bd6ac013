"""Greedy view selection with a certificate, then improvement: the default method.

The paper's fitness (Eq. 10) is monotone submodular, so greedy reaches at least 1 - 1/e of the best that its candidates
allow. With a given number of views that do not reach everything, the choice is improved by rounds of exchange and
refining (`planning.optimise.improve`); views left over when everything is covered are spent on a second and third view
of each section and on finer sections.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel, Elements
from planning.coverage.sections import SectionGrid
from planning.optimise import cover_kernel as kernel
from planning.optimise.bounds import dual_bound
from planning.optimise.candidates import N_CANDIDATES, Pool, candidate_pool, join_pools
from planning.optimise.improve import Exchange, cover_state, improve_views
from planning.optimise.problem import Goal, ViewProblem, ViewSet, take
from planning.progress import Monitor, Stop, Trace

Array = NDArray[np.float64]

SPARE_STAGES = ((1, 2), (2, 1), (1, 3), (3, 1), (2, 2), (1, 4))
"""What spare views are spent on, in this order: (division of the section step, wanted views per section)."""


@dataclass(frozen=True, slots=True)
class GreedyParameters:
    """Settings of the greedy method.

    Parameters
    ----------
    n_candidates
        Well-spread candidates; witnesses of rarely seen sections come on top.
    solid_angle_weights
        Weight sections by their solid angle instead of equally.
    improve
        Exchange candidates and refine poses after the greedy choice.
    certify
        Compute the dual bound for the number of views (about a second).
    """

    n_candidates: int = N_CANDIDATES
    solid_angle_weights: bool = False
    improve: bool = True
    certify: bool = True

    def __post_init__(self) -> None:
        if self.n_candidates < 1:
            raise ValueError(f"n_candidates: expected 1 or more, got {self.n_candidates}")


def greedy(
    problem: ViewProblem,
    goal: Goal,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: GreedyParameters = GreedyParameters(),
) -> ViewSet:
    """Choose views greedily, then improve them. Trace values are covered elements.

    Raises
    ------
    InfeasibleError
        There is no allowed viewpoint that sees anything.
    """
    monitor.report("trying viewpoints", 0, 1)
    pool = candidate_pool(problem, seed, parameters.n_candidates)
    weights = element_weights(problem.model, parameters.solid_angle_weights)
    coverable = np.bincount(pool.elements.items, minlength=len(weights)) > 0
    everything = float(weights[coverable].sum())
    if goal.share is not None:
        return _fewest_views(pool, weights, goal.share * everything, seed, stop, trace, monitor, parameters)
    assert goal.n_views is not None  # Goal's own check
    chosen, value = choose_greedily(pool, weights, goal.n_views, np.inf, trace, monitor)
    bound = everything
    if value < everything - 1e-9 and len(chosen) == goal.n_views:
        if parameters.certify:
            monitor.report("bounding the optimum", 0, 1)
            bound = dual_bound(pool.elements, weights, goal.n_views, value, stop=stop)
        if parameters.improve:
            views = improve_views(problem, pool, chosen, weights, seed, stop, trace, monitor)
            views = take(views, needed(problem.model.elements(views), weights))
            n_needed = len(views.heading_rad)
            pool = join_pools(Pool(views, problem.model.elements(views)), pool)
            chosen = np.arange(n_needed)
    chosen = spend_spare_views(problem.model, pool, chosen, goal.n_views, monitor)
    return ViewSet(take(pool.views, chosen), bound)


def needed(elements: Elements, weights: Array) -> NDArray[np.bool_]:
    """Which views are left when those are dropped, one after the other, without which nothing is lost."""
    state = cover_state(elements, weights)
    kept = np.ones(len(elements.starts) - 1, np.bool_)
    for view in range(len(kept)):
        kernel.add_elements(state, elements.of(view))
    for view in range(len(kept)):
        if kernel.loss_of(state, elements.of(view)) <= 1e-9:
            kernel.remove_elements(state, elements.of(view))
            kept[view] = False
    return kept


def choose_greedily(
    pool: Pool, weights: Array, n_wanted: int, enough: float, trace: Trace, monitor: Monitor
) -> tuple[NDArray[np.int64], float]:
    """Numbers of the candidates chosen, in order, and the weight that they cover.

    Ends at `n_wanted` candidates, at a weight of `enough`, or when nothing is left to gain. It is quick, and the first
    answer of an anytime method, so nothing stops it but cancelling.
    """
    state = cover_state(pool.elements, weights)
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
    target: float,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: GreedyParameters,
) -> ViewSet:
    """Fewest views found that cover the weight `target`: greedy, then views are taken away while exchange makes up."""
    enough = target - 1e-9
    chosen, value = choose_greedily(pool, weights, len(pool.views.heading_rad), enough, trace, monitor)
    if parameters.improve and value >= enough:
        exchange = Exchange(pool.elements, weights, chosen, seed)
        while len(chosen) > 1 and not stop():
            exchange.drop_least_useful()
            monitor.report("saving views", len(pool.views.heading_rad) - len(exchange.chosen), 0)
            exchange.run(stop, enough=enough)
            if exchange.value() < enough:
                break
            chosen = exchange.chosen.copy()
    return ViewSet(take(pool.views, chosen))


def element_weights(model: CoverageModel, by_solid_angle: bool) -> Array:
    """Weight of each element: 1, or its section's solid angle relative to the mean."""
    if not by_solid_angle:
        return np.ones(model.n_elements)
    solid_angles = model.grid.solid_angles_sr()
    return np.tile(solid_angles / solid_angles.mean(), len(model.frames))


def spend_spare_views(
    model: CoverageModel, pool: Pool, chosen: NDArray[np.int64], n_views: int, monitor: Monitor
) -> NDArray[np.int64]:
    """Numbers of the chosen candidates and of further ones, until there are `n_views` or nothing is left to gain.

    Further ones bring more views of each section, then finer sections (`SPARE_STAGES`).
    """
    for division, depth in SPARE_STAGES:
        n_spare = n_views - len(chosen)
        if n_spare <= 0:
            break
        monitor.report("spending spare views", len(chosen), n_views)
        finer = replace(model, grid=SectionGrid(model.grid.step_deg / division))
        elements = pool.elements if division == 1 else finer.elements(pool.views)
        state = cover_state(elements, np.ones(finer.n_elements))
        state.depth[0] = depth
        for candidate in chosen:
            kernel.add_elements(state, elements.of(candidate))
        kernel.refresh_gains(state)
        state.gains[chosen] = -np.inf
        added = np.zeros(n_spare, np.int64)
        n_added = kernel.greedy_steps(state, added, 0, n_spare, np.inf)
        chosen = np.concatenate([chosen, added[:n_added]])
    return chosen
