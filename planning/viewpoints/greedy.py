"""Greedy view selection with a certificate, then improvement: the default method.

The paper's fitness (Eq. 10) is monotone submodular, so greedy reaches at least 1 - 1/e of the best that its candidates
allow. With a given number of views that do not reach everything, the choice is improved by rounds of exchange and
refining (`planning.viewpoints.improve`); views left over when everything is covered are spent on a second and third
view of each section and on finer sections.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from planning.base.jit import kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.coverage.image_error import ImageErrorModel
from planning.coverage.model import CoverageModel, Elements, element_weights
from planning.coverage.sections import SectionGrid
from planning.parameters import GreedyParameters
from planning.plan import ViewpointArrays
from planning.viewpoints import cover_kernel
from planning.viewpoints.candidates import Pool, candidate_pool, join_pools, keep
from planning.viewpoints.improve import Exchange, cover_state, improve_views
from planning.viewpoints.least_error import choose_for_least_error, error_state, least_error
from planning.viewpoints.problem import NONE_LOCKED, Goal, ViewProblem, ViewSet, concatenate, covered_by, take
from planning.viewpoints.spacing import ANYWHERE, SpacingRule, rounding_spacing_m, spaced_views, spacing_rule

Array = NDArray[np.float64]


# Upper bounds on what N of the candidates can cover, and the exact optimum on small scenes.
#
# Three, from cheap to exact: greedy's own (f(S) + the N largest marginal gains, any S), the Lagrangian dual of the
# integer programme, and the integer programme itself (HiGHS). All hold for the given candidates; refined poses are not
# candidates and may cover more, up to the number of reachable sections.

DUAL_STEPS = 150


@kernel
def _scores(starts: NDArray[np.int64], items: NDArray[np.int32], prices: Array, scores: Array) -> None:
    """Sum of the prices of each candidate's elements."""
    for c in range(len(scores)):
        total = 0.0
        for i in range(starts[c], starts[c + 1]):
            total += prices[items[i]]
        scores[c] = total


@kernel
def _cover_counts(
    starts: NDArray[np.int64], items: NDArray[np.int32], chosen: NDArray[np.int64], counts: Array
) -> None:
    counts[:] = 0.0
    for c in chosen:
        for i in range(starts[c], starts[c + 1]):
            counts[items[i]] += 1.0


def dual_bound(
    elements: Elements, weights: Array, n_views: int, known: float, n_steps: int = DUAL_STEPS, stop: Stop = never
) -> float:
    """Lagrangian bound on the weight that `n_views` candidates can cover.

    With prices 0 <= p_e <= w_e for the constraint "an element counts only when a chosen view covers it", every p gives
    the bound sum (w_e - p_e) + the sum of the N largest candidate scores sum p_e. Subgradient steps (Polyak's length,
    towards `known`, the value of a solution at hand) lower it; the best one is returned.
    """
    coverable = np.bincount(elements.items, minlength=len(weights)) > 0
    best = float(weights[coverable].sum())
    n_candidates = len(elements.starts) - 1
    n_views = min(n_views, n_candidates)
    prices = np.where(coverable, 0.5 * weights, 0.0)
    scores, counts = np.empty(n_candidates), np.empty(len(weights))
    length, since_better = 1.0, 0
    for _ in range(n_steps):
        if stop():
            break
        _scores(elements.starts, elements.items, prices, scores)
        chosen = np.argpartition(-scores, n_views - 1)[:n_views] if n_views < n_candidates else np.arange(n_candidates)
        bound = float((weights - prices)[coverable].sum() + scores[chosen].sum())
        since_better = since_better + 1 if bound >= best - 1e-9 else 0
        best = min(best, bound)
        if since_better >= 8:
            length, since_better = 0.5 * length, 0
        _cover_counts(elements.starts, elements.items, chosen, counts)
        slope = np.where(coverable, counts - 1.0, 0.0)
        # Steps that only push prices against their limits say nothing.
        slope[(prices <= 0.0) & (slope > 0.0)] = 0.0
        slope[(prices >= weights) & (slope < 0.0)] = 0.0
        square = float(slope @ slope)
        if square <= 0.0 or bound <= known:
            break
        prices = np.clip(prices - length * (bound - known) / square * slope, 0.0, weights)
    return best


NOTHING = np.zeros(0, np.int64)
NO_ELEMENTS = np.zeros(0, np.int32)

NEAR_SPACINGS = 3.0
"""What views within so many spacings of a place alone cover may be seen from elsewhere, to make room there."""

CHOICE = 2
"""Candidates for each view that is wanted, at least, however late it is."""

IDLE_ROUNDS = 6
"""Further candidates for what views too close to others would show are tried until so many rounds bring nothing."""

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
    spacing_m: float = 0.0,
    error: ImageErrorModel | None = None,
) -> ViewSet:
    """Choose views greedily, then improve them. Trace values are covered elements.

    Views that are `locked` come first in the result, as they are; they count as views and for what is covered, and
    the others are chosen for what they leave. Two views stand at one place, or at least `spacing_m` apart. A number of
    views is chosen for the least of `error` where that is given, a share of sections never.

    Raises
    ------
    InfeasibleError
        There is no allowed viewpoint that sees anything.
    """
    monitor.report(say("trying viewpoints"), 0, 1)
    pool = candidate_pool(problem, seed, parameters.n_candidates, stop)
    weights = element_weights(problem.model, parameters.solid_angle_weights)
    covered = covered_by(problem.model, locked)
    coverable = (np.bincount(pool.elements.items, minlength=len(weights)) > 0) | (covered > 0)
    everything = float(weights[coverable].sum())
    choice = Choice(problem, weights, covered, locked, rounding_spacing_m(spacing_m), seed, stop, trace, monitor)
    if goal.share is not None:
        sharp = _fewest_sharp_views(choice, pool, goal.share, parameters)
        with_present_views = choice.with_present_views(sharp)
        found = _fewest_views(with_present_views, pool, goal.share * everything, parameters)
        return ViewSet(concatenate([with_present_views.locked, found]))
    assert goal.n_views is not None  # Goal's own check
    n_free = goal.n_views - len(locked.heading_rad)
    if error is not None:
        return choice.for_least_error(pool, n_free, error, parameters)
    pool, chosen, value = choice.greedily(pool, n_free, np.inf)
    bound = everything
    if value < everything - 1e-9 and len(chosen) == n_free and parameters.certify:
        monitor.report(say("bounding the optimum"), 0, 1)
        bound = _bound(pool.elements, weights, covered, n_free, value, stop)
    if value < everything - 1e-9 and len(chosen) > 0 and parameters.improve:
        views = improve_views(problem, pool, chosen, weights, seed, stop, trace, monitor, locked, choice.spacing_m)
        views = take(views, necessary_views(problem.model.elements(views), weights, covered))
        pool = join_pools(Pool(views, problem.model.elements(views)), pool)
        pool, chosen, _ = choice.greedily(pool, n_free, np.inf, np.arange(len(views.heading_rad)))
    chosen = spend_spare_views(problem.model, pool, chosen, n_free, monitor, locked, choice.spacing_m)
    return ViewSet(concatenate([locked, take(pool.views, chosen)]), bound)


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """What every choice of one plan has in common.

    Parameters
    ----------
    covered
        How many of the `locked` views cover each element.
    spacing_m
        As in `SpacingRule`.
    """

    problem: ViewProblem
    weights: Array
    covered: NDArray[np.int32]
    locked: ViewpointArrays
    spacing_m: float
    seed: int
    stop: Stop
    trace: Trace
    monitor: Monitor

    def with_present_views(self, views: ViewpointArrays) -> Choice:
        """The choice of further views where some are there in any case, too."""
        if len(views.heading_rad) == 0:
            return self
        locked = concatenate([self.locked, views])
        covered = covered_by(self.problem.model, locked)
        self.trace.record(int(np.count_nonzero(covered)))
        return replace(self, locked=locked, covered=covered)

    def of_sharp_views(self) -> Choice:
        """The choice where only sharp views count; this one where all are. It leaves no trace."""
        model = self.problem.model.of_sharp_views()
        if model is self.problem.model:
            return self
        return replace(
            self,
            problem=replace(self.problem, model=model),
            covered=covered_by(model, self.locked),
            trace=Trace(self.trace.clock),
        )

    def greedily(
        self, pool: Pool, n_wanted: int, enough: float, first: NDArray[np.int64] = NOTHING
    ) -> tuple[Pool, NDArray[np.int64], float]:
        """Candidates, the numbers of those chosen, and what is covered with them; those of `first` are a beginning.

        Where the views for an element would stand too close to others, further candidates are tried for it: the pool
        returned holds these, too, behind those given.
        """
        chosen, value = self._chosen(pool, first, n_wanted, enough)
        rng, idle, shown_by = np.random.default_rng(self.seed + 2), 0, _shown_by(pool, len(self.weights))
        while self.spacing_m > 0.0 and len(chosen) < n_wanted and value < enough - 1e-9 and idle < IDLE_ROUNDS:
            lost = self._lost(pool, chosen, shown_by)
            if len(lost) == 0 or self.stop():
                break
            self.monitor.report(say("choosing views"), len(chosen), n_wanted)
            pool = self._with_more_places(pool, chosen, lost, shown_by, rng)
            apart, seed = spacing_rule(pool.views, self.locked, self.spacing_m), self.seed + len(pool.views.heading_rad)
            exchange = Exchange(pool.elements, self.weights, chosen, seed, self.covered, apart)
            # As many views more as there are open elements: with room for any number the search would be another one.
            exchange.make_room(lost, min(n_wanted, len(chosen) + len(lost)), self.stop)
            before = value
            chosen, value = exchange.chosen, exchange.value()
            self.trace.record(exchange.n_covered())
            idle = 0 if value > before + 1e-9 else idle + 1
        return pool, chosen, value

    def for_least_error(
        self, pool: Pool, n_wanted: int, error: ImageErrorModel, parameters: GreedyParameters
    ) -> ViewSet:
        """The locked views and those after which the expected error is least, with the bounds of both objectives."""
        apart = spacing_rule(pool.views, self.locked, self.spacing_m)
        state = error_state(error, pool.views, self.locked, apart, self.monitor, self.stop, CHOICE * n_wanted)
        at_first = least_error(state, error, n_wanted)
        chosen = choose_for_least_error(state, n_wanted, self.monitor, self.stop)
        is_cut_short = self.stop()
        views = concatenate([self.locked, take(pool.views, chosen)])
        covered = self.covered + np.bincount(
            np.concatenate([NO_ELEMENTS, *(pool.elements.of(each) for each in chosen)]), minlength=len(self.weights)
        )
        self.trace.record(int(np.count_nonzero(covered)))
        if not parameters.certify:
            return ViewSet(views, is_cut_short=is_cut_short)
        self.monitor.report(say("bounding the optimum"), 0, 1)
        # Each holds by itself: the one from nothing is closer for few views, the one from the views chosen for many.
        least = max(at_first, least_error(state, error, n_wanted))
        known = float(self.weights[covered > 0].sum())
        bound = _bound(pool.elements, self.weights, self.covered, len(chosen), known, self.stop)
        return ViewSet(views, bound, least, is_cut_short)

    def _with_more_places(
        self,
        pool: Pool,
        chosen: NDArray[np.int64],
        lost: NDArray[np.int64],
        shown_by: NDArray[np.int64],
        rng: np.random.Generator,
    ) -> Pool:
        """With further candidates for the lost elements, and for what chosen views close to those alone cover."""
        seen_from = pool.views.positions_enu_m[shown_by[lost]]
        counts = self.covered + np.bincount(
            np.concatenate([NO_ELEMENTS, *(pool.elements.of(c) for c in chosen)]), minlength=len(self.weights)
        )
        positions = pool.views.positions_enu_m[chosen]
        near = np.flatnonzero(cdist(positions, seen_from).min(axis=1, initial=np.inf) < NEAR_SPACINGS * self.spacing_m)
        alone = [(e, positions[k]) for k in near for e in pool.elements.of(chosen[k]) if counts[e] == 1]
        elements = np.concatenate([lost, np.array([e for e, _ in alone], np.int64)])
        places = np.concatenate([seen_from, np.array([place for _, place in alone]).reshape(-1, 3)])
        views = spaced_views(self.problem, elements, places, positions, rng, self.stop)
        return join_pools(pool, Pool(views, self.problem.model.elements(views)))

    def _chosen(
        self, pool: Pool, chosen: NDArray[np.int64], n_wanted: int, enough: float
    ) -> tuple[NDArray[np.int64], float]:
        apart = spacing_rule(pool.views, self.locked, self.spacing_m)
        return choose_greedily(
            pool, self.weights, n_wanted, enough, self.trace, self.monitor, self.covered, apart, chosen
        )

    def _lost(self, pool: Pool, chosen: NDArray[np.int64], shown_by: NDArray[np.int64]) -> NDArray[np.int64]:
        """Elements that some candidate covers and no chosen one."""
        is_covered = self.problem.model.covered(take(pool.views, chosen)) | (self.covered > 0)
        return np.flatnonzero((shown_by >= 0) & ~is_covered)


def _shown_by(pool: Pool, n_elements: int) -> NDArray[np.int64]:
    """A candidate that covers each element, -1 where there is none; shape (n_elements,)."""
    candidates = np.repeat(np.arange(len(pool.views.heading_rad)), np.diff(pool.elements.starts))
    shown_by = np.full(n_elements, -1, np.int64)
    shown_by[pool.elements.items] = candidates
    return shown_by


def most_covering(model: CoverageModel, views: ViewpointArrays, n_views: int, n_locked: int) -> ViewpointArrays:
    """So many of the views, the locked ones in front, chosen greedily by what they cover; then those chosen first.

    All of them where they are no more.
    """
    if len(views.heading_rad) <= n_views:
        return views
    locked = take(views, np.arange(n_locked))
    pool = Pool(views, model.elements(views))
    weights, covered = np.ones(model.n_elements), covered_by(model, locked)
    chosen, _ = choose_greedily(pool, weights, max(0, n_views - n_locked), np.inf, Trace(), QUIET, covered)
    first = np.concatenate([np.arange(n_locked), chosen[chosen >= n_locked]])
    others = np.setdiff1d(np.arange(len(views.heading_rad)), first)
    return take(views, np.sort(np.concatenate([first, others])[: max(n_views, n_locked)]))


def _bound(
    elements: Elements, weights: Array, covered: NDArray[np.int32], n_views: int, known: float, stop: Stop
) -> float:
    """Bound on the weight that so many candidates can cover together with what is covered all the same."""
    covered_weight = float(weights[covered > 0].sum())
    if n_views == 0:
        return covered_weight
    return covered_weight + dual_bound(
        elements, np.where(covered > 0, 0.0, weights), n_views, known - covered_weight, stop=stop
    )


def necessary_views(elements: Elements, weights: Array, covered: NDArray[np.int32] | None = None) -> NDArray[np.bool_]:
    """Which views are left when those are dropped, one after the other, without which nothing is lost."""
    state = cover_state(elements, weights, covered)
    kept = np.ones(len(elements.starts) - 1, np.bool_)
    for view in range(len(kept)):
        cover_kernel.add_elements(state, elements.of(view))
    for view in range(len(kept)):
        if cover_kernel.loss_of(state, elements.of(view)) <= 1e-9:
            cover_kernel.remove_elements(state, elements.of(view))
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
    spacing: SpacingRule = ANYWHERE,
    first: NDArray[np.int64] = NOTHING,
) -> tuple[NDArray[np.int64], float]:
    """Numbers of the candidates chosen, in order, and the weight that is covered with them (and `covered` without).

    Those of `first` are chosen in any case, and come first.

    Ends at `n_wanted` candidates, at a weight of `enough`, or when nothing is left to gain. It is quick, and the first
    answer of an anytime method, so nothing stops it but cancelling.
    """
    state = cover_state(pool.elements, weights, covered, spacing)
    chosen = np.zeros(max(len(first), min(n_wanted, len(state.gains))), np.int64)
    n_chosen = len(first)
    chosen[:n_chosen] = first
    for candidate in first:
        cover_kernel.add_elements(state, pool.elements.of(candidate))
    while n_chosen < len(chosen):
        monitor.report(say("choosing views"), n_chosen, len(chosen))
        slice_end = min(len(chosen), n_chosen + max(8, n_chosen // 4))
        n_now = int(cover_kernel.greedy_steps(state, chosen, n_chosen, slice_end, enough))
        trace.record(int(np.count_nonzero(state.counts)))
        ended = n_now < slice_end
        n_chosen = n_now
        if ended:
            break
    return chosen[:n_chosen], float(cover_kernel.objective(state))


def _fewest_sharp_views(choice: Choice, pool: Pool, share: float, parameters: GreedyParameters) -> ViewpointArrays:
    """Fewest views found that cover sharply the share of what candidates cover sharply.

    None where all views are sharp, and where the time is up: then one choice has to do.
    """
    sharp = choice.of_sharp_views()
    if sharp is choice or choice.stop():
        return NONE_LOCKED
    near = Pool(pool.views, sharp.problem.model.elements(pool.views))
    near = keep(near, np.diff(near.elements.starts) > 0)
    if len(near.views.heading_rad) == 0:
        return NONE_LOCKED
    coverable = (np.bincount(near.elements.items, minlength=len(sharp.weights)) > 0) | (sharp.covered > 0)
    return _fewest_views(sharp, near, share * float(sharp.weights[coverable].sum()), parameters)


def _fewest_views(choice: Choice, pool: Pool, target: float, parameters: GreedyParameters) -> ViewpointArrays:
    """Fewest views found that bring what is covered to the weight `target`.

    Greedy, then views are taken away while exchange makes up for them.
    """
    enough = target - 1e-9
    pool, chosen, value = choice.greedily(pool, len(pool.views.heading_rad), enough)
    if parameters.improve and value >= enough:
        apart = spacing_rule(pool.views, choice.locked, choice.spacing_m)
        exchange = Exchange(pool.elements, choice.weights, chosen, choice.seed, choice.covered, apart)
        while len(chosen) > 1 and not choice.stop():
            exchange.drop_least_useful()
            choice.monitor.report(say("saving views"), len(pool.views.heading_rad) - len(exchange.chosen), 0)
            exchange.run(choice.stop, enough=enough)
            if exchange.value() < enough:
                break
            chosen = exchange.chosen.copy()
    return take(pool.views, chosen)


def spend_spare_views(
    model: CoverageModel,
    pool: Pool,
    chosen: NDArray[np.int64],
    n_views: int,
    monitor: Monitor,
    locked: ViewpointArrays = NONE_LOCKED,
    spacing_m: float = 0.0,
) -> NDArray[np.int64]:
    """Numbers of the chosen candidates and of further ones, until there are `n_views` or nothing is left to gain.

    Further ones bring a sharp view of each section, then more views of each, then finer sections (`SPARE_STAGES`); what
    the `locked` views show counts as shown. Another photo from a place that has one is no further view.
    """
    for finer, depth in _spare_stages(model):
        n_spare = n_views - len(chosen)
        if n_spare <= 0:
            break
        monitor.report(say("spending spare views"), len(chosen), n_views)
        elements = pool.elements if finer is model else finer.elements(pool.views)
        present_enu_m = np.concatenate([locked.positions_enu_m, pool.views.positions_enu_m[chosen]])
        spacing = SpacingRule(pool.views.positions_enu_m, present_enu_m, spacing_m)
        state = cover_state(elements, np.ones(finer.n_elements), covered_by(finer, locked), spacing)
        state.depth[0] = depth
        for candidate in chosen:
            cover_kernel.add_elements(state, elements.of(candidate))
        cover_kernel.refresh_gains(state)
        state.gains[_at_places(pool.views.positions_enu_m, present_enu_m)] = -np.inf
        added = np.zeros(n_spare, np.int64)
        n_added = cover_kernel.greedy_steps(state, added, 0, n_spare, np.inf)
        chosen = np.concatenate([chosen, added[:n_added]])
    return chosen


def _spare_stages(model: CoverageModel) -> Iterator[tuple[CoverageModel, int]]:
    """What spare views are spent on, in this order: what counts, and how many views of each element are wanted."""
    sharp = model.of_sharp_views()
    if sharp is not model:
        yield sharp, 1
    for division, depth in SPARE_STAGES:
        yield (model if division == 1 else replace(model, grid=SectionGrid(model.grid.step_deg / division))), depth


def _at_places(positions_enu_m: Array, places_enu_m: Array) -> NDArray[np.bool_]:
    """Whether each position, shape (n, 3), is one of the places, shape (k, 3)."""
    both = np.concatenate([places_enu_m, positions_enu_m])
    _, number = np.unique(both, axis=0, return_inverse=True)
    is_place = np.zeros(len(both), np.bool_)
    is_place[number[: len(places_enu_m)]] = True
    return np.asarray(is_place[number[len(places_enu_m) :]])
