"""Refining the poses of chosen views one after the other, off the candidates' grid (the only module importing NLopt).

The value of a pose is the weight of the elements that it covers and no other chosen view does: a step function, so the
search is derivative-free: Subplex (Rowan 1990, NLopt's LN_SBPLX), a few dozen evaluations per view. Positions that are
not allowed are worth less than nothing.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import Elements
from planning.optimise.problem import ViewProblem
from planning.optimise.spacing import ANYWHERE, Apart
from planning.plan import ViewpointArrays
from planning.progress import QUIET, Monitor, Stop, never

Array = NDArray[np.float64]

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
    apart: Apart = ANYWHERE,
) -> ViewpointArrays:
    """Views of at least the same value, in the same order, as far apart as `apart` says of them.

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
            monitor.report("refining poses", n_done, len(poses))
            if stop():
                break
            counts[elements[i]] -= 1
            others = apart.of_others(poses[:, :3], i)
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

    def __init__(self, problem: ViewProblem, open_weights: Array, items: NDArray[np.int32], others: Apart) -> None:
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
