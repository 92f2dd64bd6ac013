"""Nap-of-the-object: the commercial baseline, a grid of views that follows each facade at constant distance.

Photos look straight at the facade and overlap by a given share, as in DJI's slope route. One direction per panel is all
they see; that is what hemisphere coverage is compared with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.positions import aimed_views
from planning.coverage.sections import panel_frames
from planning.plan import ViewpointArrays
from planning.site.free_space import SAFETY_MARGIN_M
from planning.viewpoints.problem import Goal, ViewProblem, ViewSet, nothing_to_see, take

Array = NDArray[np.float64]

PLANAR_SPREAD_RAD = np.radians(10.0)
"""Facades whose normals differ by less are flown as planes."""


@dataclass(frozen=True, slots=True)
class NotoParameters:
    """Settings of the baseline.

    Parameters
    ----------
    side_overlap, vertical_overlap
        Between neighbouring photos of a row, and between rows (0 to below 1); used when no number of views is given.
    extra_distance_m
        Flown this much further out than the minimum distance.
    """

    side_overlap: float = 0.8
    vertical_overlap: float = 0.7
    extra_distance_m: float = 0.5


def noto(
    problem: ViewProblem,
    goal: Goal,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: NotoParameters = NotoParameters(),
) -> ViewSet:
    """Grid of views; with a number of views the overlaps are chosen so that the grid has at most that many.

    Raises
    ------
    InfeasibleError
        No view of the grid is allowed.
    """
    monitor.report(say("laying the grid"), 0, 1)
    if goal.n_views is None:
        views = _grid(problem, parameters, 1.0)
    else:
        views = _grid(problem, parameters, _spacing_for(problem, parameters, goal.n_views))
        views = take(views, np.arange(min(goal.n_views, len(views.heading_rad))))
    if len(views.heading_rad) == 0:
        raise nothing_to_see()
    trace.record(problem.model.covered_count(views))
    return ViewSet(views)


def _spacing_for(problem: ViewProblem, parameters: NotoParameters, n_views: int) -> float:
    """Smallest stretch of the grid, to about 1 %, that gives at most `n_views`."""

    def too_many(spacing: float) -> bool:
        return len(_grid(problem, parameters, spacing).heading_rad) > n_views

    wide = 1.0
    while too_many(wide):
        wide *= 1.5
    narrow = wide / 1.5
    while not too_many(narrow) and narrow > 0.01:
        wide, narrow = narrow, narrow / 1.5
    for _ in range(6):
        middle = float(np.sqrt(narrow * wide))
        narrow, wide = (middle, wide) if too_many(middle) else (narrow, middle)
    return wide


def _grid(problem: ViewProblem, parameters: NotoParameters, spacing: float) -> ViewpointArrays:
    """Allowed views of the grid; `spacing` stretches it."""
    camera = problem.model.camera
    distance = problem.space.min_distance_m + parameters.extra_distance_m + SAFETY_MARGIN_M
    across = 2.0 * camera.half_width * distance * (1.0 - parameters.side_overlap) * spacing
    upwards = 2.0 * camera.half_height * distance * (1.0 - parameters.vertical_overlap) * spacing
    positions, targets = [], []
    for corners in facade_corners(problem):
        feet, normals = _surface_grid(corners, across, upwards)
        positions.append(feet + distance * normals)
        targets.append(feet)
    views = aimed_views(np.concatenate(positions), np.concatenate(targets), camera)
    return take(views, problem.flyable(views.positions_enu_m))


def facade_corners(problem: ViewProblem) -> list[Array]:
    """Panel corners, shape (k, 4, 3), of each group of panels whose normals turn gradually.

    Facades as the site groups them are not known here; panels whose normals differ by less than 30 degrees from a
    neighbour's belong together, which gives the same groups for real buildings.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    frames = problem.model.frames
    reach = 2.5 * float(np.median(np.linalg.norm(frames.corners[:, 2] - frames.corners[:, 0], axis=1)))
    pairs = cKDTree(frames.centroids).query_pairs(reach, output_type="ndarray")
    alike = np.einsum("pk,pk->p", frames.normals[pairs[:, 0]], frames.normals[pairs[:, 1]]) > np.cos(np.radians(30.0))
    m = len(frames)
    graph = coo_array((np.ones(alike.sum()), (pairs[alike, 0], pairs[alike, 1])), shape=(m, m))
    n_groups, group = connected_components(graph, directed=False)
    return [frames.corners[group == g] for g in range(n_groups)]


def _surface_grid(corners: Array, across: float, upwards: float) -> tuple[Array, Array]:
    """Points on a facade with their outward normals, both shape (n, 3), about `across` and `upwards` metres apart."""
    frames = panel_frames(corners)
    mean = frames.normals.sum(axis=0)
    mean /= max(float(np.linalg.norm(mean)), 1e-12)
    spread = np.arccos(np.clip(frames.normals @ mean, -1.0, 1.0)).max()
    upright = np.abs(frames.normals[:, 2]).max() < np.sin(PLANAR_SPREAD_RAD)
    if spread < PLANAR_SPREAD_RAD or not upright:
        return _plane_grid(corners, mean, across, upwards)
    return _wall_grid(frames.centroids, frames.normals, corners, across, upwards)


def _ticks(low: float, high: float, step: float) -> Array:
    """Evenly spaced values that cover low to high with gaps of at most `step`; the middle when one is enough."""
    n = max(1, int(np.ceil((high - low) / step)))
    return low + (np.arange(n) + 0.5) * (high - low) / n


def _plane_grid(corners: Array, normal: Array, across: float, upwards: float) -> tuple[Array, Array]:
    horizontal = np.array([-normal[1], normal[0], 0.0])
    t = horizontal / np.linalg.norm(horizontal) if np.linalg.norm(horizontal) > 1e-6 else np.array([1.0, 0.0, 0.0])
    b = np.cross(normal, t)
    points = corners.reshape(-1, 3)
    u, v = points @ t, points @ b
    columns, rows = np.meshgrid(_ticks(u.min(), u.max(), across), _ticks(v.min(), v.max(), upwards))
    outermost = float((points @ normal).max())
    feet = columns.reshape(-1, 1) * t + rows.reshape(-1, 1) * b + outermost * normal
    return feet, np.broadcast_to(normal, feet.shape).copy()


def _wall_grid(centroids: Array, normals: Array, corners: Array, across: float, upwards: float) -> tuple[Array, Array]:
    """Grid on an upright curved wall, unrolled along the plan view of its panels."""
    plan, first = np.unique(centroids[:, :2].round(3), axis=0, return_index=True)
    order = _along_the_wall(plan)
    line, sideways = plan[order], normals[first[order], :2]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    ticks = _ticks(0.0, lengths[-1], across)
    feet_xy = np.stack([np.interp(ticks, lengths, line[:, k]) for k in range(2)], axis=1)
    normal_xy = np.stack([np.interp(ticks, lengths, sideways[:, k]) for k in range(2)], axis=1)
    normal_xy /= np.linalg.norm(normal_xy, axis=1, keepdims=True)
    heights = _ticks(corners[..., 2].min(), corners[..., 2].max(), upwards)
    feet = np.concatenate([np.c_[feet_xy, np.full(len(ticks), z)] for z in heights])
    return feet, np.tile(np.c_[normal_xy, np.zeros(len(ticks))], (len(heights), 1))


def _along_the_wall(plan: Array) -> NDArray[np.int64]:
    """Order of points in plan view from one end of the wall to the other: nearest neighbours from the remotest."""
    start = int(np.argmax(np.linalg.norm(plan - plan.mean(axis=0), axis=1)))
    order, left = [start], set(range(len(plan))) - {start}
    while left:
        rest = np.array(sorted(left))
        order.append(int(rest[np.argmin(np.linalg.norm(plan[rest] - plan[order[-1]], axis=1))]))
        left.remove(order[-1])
    return np.array(order)
