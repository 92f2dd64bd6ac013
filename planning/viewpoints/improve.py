"""Improving a choice of views: exchange with other candidates, refined poses, and fresh candidates round by round."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.coverage.model import Elements
from planning.plan import ViewpointArrays
from planning.viewpoints import cover_kernel as kernel
from planning.viewpoints.candidates import Pool, spread_candidates
from planning.viewpoints.problem import NONE_LOCKED, ViewProblem, concatenate, covered_by, take
from planning.viewpoints.spacing import ANYWHERE, SpacingRule, spacing_rule

Array = NDArray[np.float64]


# Refining the poses of chosen views one after the other, off the candidates' grid (the only module importing NLopt).
#
# The value of a pose is the weight of the elements that it covers and no other chosen view does: a step function, so
# the
# search is derivative-free: Subplex (Rowan 1990, NLopt's LN_SBPLX), a few dozen evaluations per view. Positions that
# are
# not allowed are worth less than nothing.

EVALUATIONS_PER_VIEW = 60

FIRST_STEP = np.array([2.0, 2.0, 2.0, 0.1, 0.1])
"""Initial steps: metres for the position, radians (6 degrees) for heading and pitch."""

SMALLEST_STEP = np.array([0.01, 0.01, 0.01, 1e-3, 1e-3])
"""The search ends below this; without a tolerance some of NLopt's algorithms never do."""

NOT_ALLOWED = -1.0


def refine_views(
    problem: ViewProblem,
    views: ViewpointArrays,
    weights: Array,
    stop: Stop = never,
    monitor: Monitor = QUIET,
    improved: Callable[[NDArray[np.int64]], None] | None = None,
    covered: NDArray[np.int32] | None = None,
    spacing: SpacingRule = ANYWHERE,
) -> ViewpointArrays:
    """Views of at least the same value, in the same order, as far apart as `spacing` says of them.

    Sweeps over all views until a sweep brings nothing or `stop` asks for an end. `improved` is called after each sweep
    with the number of views per element. `covered` counts the views that each element has beside these.
    """
    model = problem.model
    poses = np.concatenate([views.positions_enu_m, views.heading_rad[:, None], views.pitch_rad[:, None]], axis=1)
    elements = _each(model.elements(views))
    counts = np.bincount(np.concatenate(elements), minlength=model.n_elements)
    if covered is not None:
        counts = counts + covered
    grown = True
    while grown and not stop():
        grown = False
        for n_done, i in enumerate(_least_useful_first(elements, counts, weights)):
            monitor.report(say("refining poses"), n_done, len(poses))
            if stop():
                break
            counts[elements[i]] -= 1
            others = spacing.of_others(poses[:, :3], i)
            search = _PoseSearch(problem, np.where(counts == 0, weights, 0.0), elements[i], others)
            better = search.run(poses[i])
            if better is not None:
                grown, poses[i], elements[i] = True, better, search.items
            counts[elements[i]] += 1
        if improved is not None:
            improved(counts)
    return _as_views(poses)


class _PoseSearch:
    """Local search for one pose; remembers the best one that can be flown to, and what it covers."""

    def __init__(
        self, problem: ViewProblem, open_weights: Array, items: NDArray[np.int32], others: SpacingRule
    ) -> None:
        self.problem, self.open_weights, self.items, self.others = problem, open_weights, items, others
        self.value = float(open_weights[items].sum())
        self.pose: Array | None = None

    def run(self, start: Array) -> Array | None:
        """A better pose, shape (5,), or None."""
        import nlopt

        low_pitch, high_pitch = np.radians(self.problem.model.camera.gimbal_pitch_deg)
        lower = np.array([*self.problem.space.low_enu_m, -np.inf, low_pitch])
        upper = np.array([*self.problem.space.high_enu_m, np.inf, high_pitch])
        search = nlopt.opt(nlopt.LN_SBPLX, 5)
        search.set_max_objective(self._evaluate)
        search.set_lower_bounds(lower)
        search.set_upper_bounds(upper)
        search.set_initial_step(FIRST_STEP)
        search.set_xtol_abs(SMALLEST_STEP)
        search.set_maxeval(EVALUATIONS_PER_VIEW)
        search.optimize(np.clip(start, lower, upper))
        return self.pose

    def _evaluate(self, pose: Array, _gradient: Array) -> float:
        if self.others.is_too_close(pose[:3]) or not self.problem.space.is_allowed(pose[None, :3])[0]:
            return NOT_ALLOWED
        items = self.problem.model.elements(_as_views(pose[None])).items
        value = float(self.open_weights[items].sum())
        if value > self.value + 1e-9 and self.problem.flyable(pose[None, :3])[0]:
            self.value, self.pose, self.items = value, pose.copy(), items
        return value


def _each(elements: Elements) -> list[NDArray[np.int32]]:
    return [elements.of(i) for i in range(len(elements.starts) - 1)]


def _as_views(poses: Array) -> ViewpointArrays:
    return ViewpointArrays(poses[:, :3], poses[:, 3], poses[:, 4])


def _least_useful_first(
    elements: list[NDArray[np.int32]], counts: NDArray[np.int64], weights: Array
) -> NDArray[np.int64]:
    """Order of views by what would be lost without them."""
    lost = [weights[items][counts[items] == 1].sum() for items in elements]
    return np.argsort(lost, kind="stable")


STEPS_PER_SLICE = 500
IDLE_SLICES = 4
"""The exchange ends by itself after this many slices without growth."""

IDLE_ROUNDS = 2
"""The improvement ends by itself after this many rounds without growth."""

N_FRESH = 4000
MAX_NEIGHBOURS = 12_000
"""New spread candidates, and new candidates around the chosen views, per round."""

NEIGHBOUR_SCALES_M = (0.1, 8.0)
RADIANS_PER_METRE = 0.05
"""Candidates around a view are moved by 0.1 to 8 m and turned by 3 degrees per metre (one standard deviation)."""


def cover_state(
    elements: Elements, weights: Array, covered: NDArray[np.int32] | None = None, spacing: SpacingRule = ANYWHERE
) -> kernel.CoverState:
    """State with nothing chosen and depth 1; `covered` counts the views that each element has all the same."""
    inverse_starts, inverse_items = kernel.invert(elements.starts, elements.items, len(weights))
    n_candidates = len(elements.starts) - 1
    state = kernel.CoverState(
        elements.starts,
        elements.items,
        inverse_starts,
        inverse_items,
        weights,
        counts=np.zeros(len(weights), np.int32) if covered is None else covered.copy(),
        gains=np.zeros(n_candidates),
        depth=np.ones(1, np.int64),
        positions=np.array(spacing.positions_enu_m, np.float64, order="C"),
        taken=np.array(spacing.present_enu_m, np.float64, order="C"),
        spacing=float(spacing.spacing_m),
    )
    kernel.refresh_gains(state)
    return state


class Exchange:
    """Local search by swapping chosen candidates against others; `covered` and `apart` are as in `cover_state`."""

    def __init__(
        self,
        elements: Elements,
        weights: Array,
        chosen: NDArray[np.int64],
        seed: int,
        covered: NDArray[np.int32] | None = None,
        spacing: SpacingRule = ANYWHERE,
    ) -> None:
        self.elements, self.chosen, self.seed = elements, chosen.copy(), seed
        self.state = cover_state(elements, weights, covered, spacing)
        for candidate in self.chosen:
            kernel.add_elements(self.state, elements.of(candidate))
        self._rests_until = np.zeros(len(self.state.gains), np.int64)
        self._rests_until[self.chosen] = kernel.FOREVER
        self._clock = 0

    def value(self) -> float:
        """Weight covered."""
        return float(kernel.objective(self.state))

    def n_covered(self) -> int:
        """Elements covered."""
        return int(np.count_nonzero(self.state.counts))

    def drop_least_useful(self) -> None:
        """Take the candidate away without which least is lost."""
        losses = [kernel.loss_of(self.state, self.elements.of(candidate)) for candidate in self.chosen]
        place = int(np.argmin(losses))
        kernel.remove_elements(self.state, self.elements.of(self.chosen[place]))
        self._rests_until[self.chosen[place]] = 0
        self.chosen = np.delete(self.chosen, place)

    def run(self, stop: Stop, enough: float = np.inf, patience: int = IDLE_SLICES) -> None:
        """Swap until the weight is `enough`, `patience` slices bring nothing, or `stop`."""
        idle = 0
        while idle < patience and self.value() < enough and not stop():
            grown = kernel.exchange_steps(
                self.state, self.chosen, self._rests_until, self._clock, STEPS_PER_SLICE, self._next_seed()
            )
            self._clock += STEPS_PER_SLICE
            idle = 0 if grown > 1e-9 else idle + 1

    def make_room(self, open_elements: NDArray[np.int64], n_wanted: int, stop: Stop) -> None:
        """Cover open elements whose candidates are too close to chosen ones; up to `n_wanted` candidates are chosen."""
        idle, value, rests_until = 0, self.value(), np.zeros(len(self.state.gains), np.int64)
        while idle < IDLE_SLICES and not stop():
            still_open = open_elements[self.state.counts[open_elements] == 0]
            if len(still_open) == 0:
                break
            chosen = np.zeros(max(n_wanted, len(self.chosen)), np.int64)
            chosen[: len(self.chosen)] = self.chosen
            n_chosen = kernel.eject_steps(
                self.state, chosen, len(self.chosen), still_open, rests_until, STEPS_PER_SLICE, self._next_seed()
            )
            self.chosen, rests_until[:] = chosen[:n_chosen], 0
            self._clock += STEPS_PER_SLICE
            idle = 0 if self.value() > value + 1e-9 else idle + 1
            value = self.value()

    def _next_seed(self) -> int:
        """Of the next slice; Numba's generator takes 32 bits."""
        return (self.seed + self._clock) % 2**32


def improve_views(
    problem: ViewProblem,
    pool: Pool,
    chosen: NDArray[np.int64],
    weights: Array,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    locked: ViewpointArrays = NONE_LOCKED,
    spacing_m: float = 0.0,
) -> ViewpointArrays:
    """As many views as were chosen, covering at least as much together with the `locked` ones, which are not returned.

    None stands closer to another than `spacing_m`, unless at its very place.

    Each round exchanges views within its candidates and then refines all poses. The first round's candidates are the
    pool, those of further rounds lie around the views at hand, with fresh ones spread over the site.
    """
    rng = np.random.default_rng(seed + 1)
    views, idle, value, round_number = take(pool.views, chosen), 0, -1.0, 0
    covered = covered_by(problem.model, locked)
    while idle < IDLE_ROUNDS and not stop():
        monitor.report(say("improving views"), round_number, 0)
        apart = spacing_rule(pool.views, locked, spacing_m)
        exchange = Exchange(pool.elements, weights, chosen, seed + 7919 * round_number, covered, apart)
        exchange.run(stop)
        trace.record(exchange.n_covered())
        views = take(pool.views, exchange.chosen)
        views = refine_views(
            problem,
            views,
            weights,
            stop,
            monitor,
            lambda counts: trace.record(int(np.count_nonzero(counts))),
            covered,
            spacing_rule(views, locked, spacing_m),
        )
        reached = float(weights[problem.model.covered(views) | (covered > 0)].sum())
        idle = 0 if reached > value + 1e-9 else idle + 1
        value, round_number = reached, round_number + 1
        pool, chosen = _pool_around(problem, views, rng)
    return views


def _pool_around(
    problem: ViewProblem, views: ViewpointArrays, rng: np.random.Generator
) -> tuple[Pool, NDArray[np.int64]]:
    """Candidates: the views themselves (numbers 0 to n - 1, also returned), neighbours of each, and fresh ones."""
    n = len(views.heading_rad)
    copies = max(1, MAX_NEIGHBOURS // n)
    low, high = np.log(NEIGHBOUR_SCALES_M)
    scale = np.exp(rng.uniform(low, high, (n * copies, 1)))
    turns = rng.normal(size=(n * copies, 2)) * scale * RADIANS_PER_METRE
    low_pitch, high_pitch = np.radians(problem.model.camera.gimbal_pitch_deg)
    around = ViewpointArrays(
        np.repeat(views.positions_enu_m, copies, axis=0) + rng.normal(size=(n * copies, 3)) * scale,
        np.repeat(views.heading_rad, copies) + turns[:, 0],
        np.clip(np.repeat(views.pitch_rad, copies) + turns[:, 1], low_pitch, high_pitch),
    )
    around = take(around, problem.flyable(around.positions_enu_m))
    together = concatenate([views, around, spread_candidates(problem, N_FRESH, rng)])
    return Pool(together, problem.model.elements(together)), np.arange(n)
