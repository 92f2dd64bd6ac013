"""Orbits: the usual first flight, rings around the building looking inwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.positions import aimed_views
from planning.plan import ViewpointArrays
from planning.viewpoints.problem import Goal, ViewProblem, ViewSet, nothing_to_see, take

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class OrbitParameters:
    """Settings of the orbits.

    Parameters
    ----------
    n_views
        Views in all when the goal does not say.
    row_spacing_m
        Between rings.
    extra_distance_m
        The rings keep this much more than the minimum distance from the building's circumscribed circle.
    """

    n_views: int = 120
    row_spacing_m: float = 8.0
    extra_distance_m: float = 5.0


def orbit(
    problem: ViewProblem,
    goal: Goal,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: OrbitParameters = OrbitParameters(),
) -> ViewSet:
    """Rings of views at several heights; places that are not allowed are left out.

    Raises
    ------
    InfeasibleError
        No place on the rings is allowed.
    """
    monitor.report(say("laying the rings"), 0, 1)
    n_wanted = parameters.n_views if goal.n_views is None else goal.n_views
    # Where a part of the rings lies outside the airspace, more places are tried until enough are left.
    for factor in (1, 2, 4, 8):
        views = _rings(problem, parameters, factor * n_wanted)
        if len(views.heading_rad) >= n_wanted:
            break
    n = len(views.heading_rad)
    if n == 0:
        raise nothing_to_see()
    if n > n_wanted:
        views = take(views, np.unique(np.linspace(0, n - 1, n_wanted).round().astype(np.int64)))
    trace.record(problem.model.covered_count(views))
    return ViewSet(views)


def _rings(problem: ViewProblem, parameters: OrbitParameters, n_views: int) -> ViewpointArrays:
    points = problem.space.solids.bvh.corners.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = 0.5 * (low + high)
    circumscribed = float(np.linalg.norm(points[:, :2] - middle[:2], axis=1).max())
    radius = circumscribed + problem.space.min_distance_m + parameters.extra_distance_m
    floor, ceiling = problem.space.low_enu_m[2], problem.space.high_enu_m[2]
    lowest = max(floor + 1.0, low[2] + 2.0)
    highest = max(lowest, min(ceiling - 1.0, high[2] + problem.space.min_distance_m))
    n_rings = max(1, round((highest - lowest) / parameters.row_spacing_m) + 1)
    heights = np.linspace(lowest, highest, n_rings)
    per_ring = -(-n_views // n_rings)
    positions, targets = [], []
    for ring, height in enumerate(heights):
        angle = 2.0 * np.pi * (np.arange(per_ring) + 0.5 * (ring % 2)) / per_ring
        circle = np.c_[middle[0] + radius * np.cos(angle), middle[1] + radius * np.sin(angle)]
        positions.append(np.c_[circle, np.full(per_ring, height)])
        targets.append(np.broadcast_to([*middle[:2], 0.5 * (height + middle[2])], (per_ring, 3)))
    views = aimed_views(np.concatenate(positions), np.concatenate(targets), problem.model.camera)
    return take(views, problem.flyable(views.positions_enu_m))
