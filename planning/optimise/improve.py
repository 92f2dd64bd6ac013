"""Improving a choice of views: exchange with other candidates, refined poses, and fresh candidates round by round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import Elements
from planning.optimise import cover_kernel as kernel
from planning.optimise.candidates import Pool, spread_candidates
from planning.optimise.locked import NONE_LOCKED, covered_by
from planning.optimise.problem import ViewProblem, concatenate, take
from planning.optimise.refine import refine_views
from planning.optimise.spacing import ANYWHERE, Apart, apart_of
from planning.plan import ViewpointArrays
from planning.progress import Monitor, Stop, Trace

Array = NDArray[np.float64]

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
    elements: Elements, weights: Array, covered: NDArray[np.int32] | None = None, apart: Apart = ANYWHERE
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
        positions=np.array(apart.positions_enu_m, np.float64, order="C"),
        taken=np.array(apart.taken_enu_m, np.float64, order="C"),
        spacing=float(apart.spacing_m),
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
        apart: Apart = ANYWHERE,
    ) -> None:
        self.elements, self.chosen, self.seed = elements, chosen.copy(), seed
        self.state = cover_state(elements, weights, covered, apart)
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
        monitor.report("improving views", round_number, 0)
        apart = apart_of(pool.views, locked, spacing_m)
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
            apart_of(views, locked, spacing_m),
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
