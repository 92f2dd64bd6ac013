"""A polyline whose corners are rounded where the aircraft flies through them, and the fastest way along it.

The path is described by its length s and the squared speed b = (ds/dt)^2 (D. Verscheure et al., 2009, "Time-optimal
path tracking for robots: a convex optimization approach", section III): the tangential acceleration is b'/2 and the
centripetal one kappa b, so that all limits are convex in b. With b linear between the nodes of a grid they hold
everywhere when they hold at both ends of every interval, and the time over an interval is exact. A limit of jerk is
left out: it is not convex in b.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from planning.motion.timing import FlightPath, MotionLimits, speed_limits_m_s

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ARC_NODES = (0.0, 0.02, 0.2, 0.48, 0.5, 0.52, 0.8, 0.98, 1.0)
"""Nodes along one rounded corner, as parts of its arc. The vertex belongs to the middle one, where the turn of one leg
ends and that of the next begins; nodes lie close together where the highest speed changes."""

SHARPEST_TURN_RAD = math.radians(175.0)
"""At sharper corners the aircraft stops: it would pass them at less than 0.2 m/s within 0.3 m."""

STRAIGHT_RAD = 1e-6
"""Corners below are none: the path leaves the direction it had by less than a micrometre a metre."""

NO_LENGTH_M = 1e-9
"""Legs up to a nanometre have no direction; the aircraft stops at both their ends."""

LEAST_CHANGE = 0.01
"""Part of its cap; where b starts closer to the cap, the time lost by this is below a millionth."""

SHORTEST = 1e-9
"""Intervals shorter than this part of their leg are rounding and left out."""


@dataclass(frozen=True, slots=True, eq=False)
class PathGrid:
    """A path cut into intervals of constant curvature.

    Parameters
    ----------
    step_m, curvature_per_m
        Shape (q,), length and curvature of each interval; lengths are positive.
    cap
        Shape (q,), highest squared speed on each interval, (m/s)^2.
    is_stop
        Shape (q + 1,), the nodes at which the aircraft comes to rest.
    vertex_node
        Shape (k,), the node of each vertex of the polyline.
    rest_s
        Shape (k,), time spent at each vertex: hover, and turns on legs of no length that lead on from there.
    acceleration_m_s2
        Limit of tangential and centripetal acceleration together.
    """

    step_m: Floats
    curvature_per_m: Floats
    cap: Floats
    is_stop: NDArray[np.bool_]
    vertex_node: Ints
    rest_s: Floats
    acceleration_m_s2: float

    @property
    def ceiling(self) -> Floats:
        """Highest squared speed at each node, shape (q + 1,): what both its intervals allow, 0 at a stop."""
        ceiling = np.minimum(np.append(self.cap, np.inf), np.insert(self.cap, 0, np.inf))
        return np.where(self.is_stop, 0.0, ceiling)


def path_grid(path: FlightPath, limits: MotionLimits, corner_deviation_m: float) -> PathGrid:
    """Grid on which the fastest profile is exact along straight legs.

    Parameters
    ----------
    corner_deviation_m
        How far a rounded corner may leave the polyline; arcs take at most half of either leg.
    """
    if not corner_deviation_m > 0.0:
        raise ValueError(f"corner_deviation_m: expected more than 0, got {corner_deviation_m}")
    coarse = _pieces(path, limits, corner_deviation_m)
    speed_2 = fastest_sweep(coarse)
    return _with_switches(coarse, speed_2)


@dataclass(frozen=True, slots=True)
class _Corner:
    """What replaces a corner: the arc, how much of both legs it takes, and the highest speed on it."""

    cut_m: float
    arc_m: float
    curvature_per_m: float
    speed_m_s: float


_STOP = _Corner(0.0, 0.0, 0.0, 0.0)


def _rounded(before: Floats, behind: Floats, limits: MotionLimits, deviation_m: float) -> _Corner:
    """Arc for the corner between two leg vectors, or a stop where it needs one.

    With phi the angle between the legs, an arc of radius r leaves the corner by r (1 / cos(phi / 2) - 1) and touches
    the legs r tan(phi / 2) away from it.
    """
    length_in, length_out = float(np.linalg.norm(before)), float(np.linalg.norm(behind))
    if min(length_in, length_out) <= NO_LENGTH_M:
        return _STOP
    u, v = before / length_in, behind / length_out
    angle = 2.0 * math.atan2(float(np.linalg.norm(u - v)), float(np.linalg.norm(u + v)))
    if angle > SHARPEST_TURN_RAD:
        return _STOP
    if angle < STRAIGHT_RAD:
        return _Corner(0.0, 0.0, 0.0, math.inf)
    half = angle / 2.0
    # 1 / cos(x) - 1 without cancellation
    radius = deviation_m * math.cos(half) / (2.0 * math.sin(half / 2.0) ** 2)
    cut = min(radius * math.tan(half), length_in / 2.0, length_out / 2.0)
    radius = cut / math.tan(half)
    directions = u + np.linspace(0.0, 1.0, 9)[:, None] * (v - u)
    speed = float(speed_limits_m_s(directions, limits).min())
    return _Corner(cut, radius * angle, 1.0 / radius, min(speed, math.sqrt(limits.acceleration_m_s2 * radius)))


def _pieces(path: FlightPath, limits: MotionLimits, deviation_m: float) -> PathGrid:
    """Grid with one interval for each straight part, and those between `ARC_NODES` for each arc.

    The turn of a leg is spread along its straight part and the halves of the arcs at its ends.
    """
    deltas = path.deltas_enu_m
    length = np.linalg.norm(deltas, axis=1)
    k = len(path.vertices_enu_m)
    corners = [_STOP if path.is_stop[i] else _rounded(deltas[i - 1], deltas[i], limits, deviation_m) for i in range(k)]
    cuts = np.array([corner.cut_m for corner in corners])
    arcs = np.array([corner.arc_m for corner in corners])
    straight = length - cuts[:-1] - cuts[1:]
    flown = straight + (arcs[:-1] + arcs[1:]) / 2.0
    speed = speed_limits_m_s(deltas, limits)
    is_slowed = path.turn_s * speed > flown
    speed = np.where(is_slowed, flown / np.where(is_slowed, path.turn_s, 1.0), speed)
    pieces: list[tuple[float, float, float]] = []
    stops = []
    vertex_node = np.zeros(k, np.int64)
    for i, corner in enumerate(corners):
        if i > 0 and straight[i - 1] > max(NO_LENGTH_M, SHORTEST * length[i - 1]):
            pieces.append((straight[i - 1], 0.0, speed[i - 1]))
        vertex_node[i] = len(pieces)
        if corner is _STOP:
            stops.append(len(pieces))
        elif corner.arc_m > 0.0:
            vertex_node[i] += ARC_NODES.index(0.5)
            for first, last in itertools.pairwise(ARC_NODES):
                leg = i - 1 if last <= 0.5 else i
                step = corner.arc_m * (last - first)
                pieces.append((step, corner.curvature_per_m, min(corner.speed_m_s, speed[leg])))
    steps, curvatures, speeds = np.array(pieces, float).reshape(-1, 3).T
    is_stop = np.zeros(len(steps) + 1, np.bool_)
    is_stop[stops] = True
    turns_at_rest_s = np.append(np.where(length > NO_LENGTH_M, 0.0, path.turn_s), 0.0)
    return PathGrid(
        step_m=steps,
        curvature_per_m=curvatures,
        cap=speeds**2,
        is_stop=is_stop,
        vertex_node=vertex_node,
        rest_s=path.hover_s + turns_at_rest_s,
        acceleration_m_s2=limits.acceleration_m_s2,
    )


@kernel
def _sweep(step: Floats, curvature: Floats, ceiling: Floats, acceleration: float) -> Floats:
    speed_2 = ceiling.copy()
    for i in range(len(step)):
        speed_2[i + 1] = min(speed_2[i + 1], _reachable(speed_2[i], step[i], curvature[i], acceleration))
    for i in range(len(step) - 1, -1, -1):
        speed_2[i] = min(speed_2[i], _reachable(speed_2[i + 1], step[i], curvature[i], acceleration))
    return speed_2


@inline
def _reachable(speed_2: float, step: float, curvature: float, acceleration: float) -> float:
    """Highest squared speed at the other end of an interval: (b - b0)^2 / (2 ds)^2 + (kappa b)^2 = a^2."""
    gain = 2.0 * step * acceleration
    k = (2.0 * step * curvature) ** 2
    return (speed_2 + math.sqrt(max(0.0, gain**2 * (1.0 + k) - k * speed_2**2))) / (1.0 + k)


def fastest_sweep(grid: PathGrid) -> Floats:
    """Highest squared speed that the limits allow at every node, shape (q + 1,), by one sweep either way.

    Each limit couples two neighbouring nodes only, and allows the more at one the more there is at the other. The
    highest speeds at all nodes are then reached together, and are the fastest profile on this grid.
    """
    return _sweep(grid.step_m, grid.curvature_per_m, grid.ceiling, grid.acceleration_m_s2)


def _with_switches(grid: PathGrid, speed_2: Floats) -> PathGrid:
    """Add the nodes where acceleration ends and braking begins on straight intervals, so that b is linear between.

    None is put so near to an end that b could change by less than `LEAST_CHANGE` on the way: the program of
    `planning.motion.speed_profile` would be badly scaled.
    """
    gain = 2.0 * grid.acceleration_m_s2
    parts: list[Floats] = []
    for i, step in enumerate(grid.step_m):
        part = np.array([step])
        if grid.curvature_per_m[i] == 0.0:
            cap, b0, b1 = grid.cap[i], speed_2[i], speed_2[i + 1]
            first = max(cap - b0, LEAST_CHANGE * cap) / gain
            last = step - max(cap - b1, LEAST_CHANGE * cap) / gain
            if first > last:
                first = last = step / 2.0 + (b1 - b0) / (2.0 * gain)
            inner = np.unique([first, last])
            inner = inner[(inner > SHORTEST * step) & (inner < (1.0 - SHORTEST) * step)]
            part = np.diff(inner, prepend=0.0, append=step)
        parts.append(part)
    repeats = np.array([len(part) for part in parts], np.int64)
    moved = np.concatenate([[0], np.cumsum(repeats)])
    is_stop = np.zeros(moved[-1] + 1, np.bool_)
    is_stop[moved] = grid.is_stop
    return PathGrid(
        step_m=np.concatenate([np.zeros(0), *parts]),
        curvature_per_m=np.repeat(grid.curvature_per_m, repeats),
        cap=np.repeat(grid.cap, repeats),
        is_stop=is_stop,
        vertex_node=moved[grid.vertex_node],
        rest_s=grid.rest_s,
        acceleration_m_s2=grid.acceleration_m_s2,
    )


def interval_times_s(grid: PathGrid, speed_2: Floats) -> Floats:
    """Time over each interval, shape (q,): 2 ds / (sqrt(b0) + sqrt(b1)) for b linear in s."""
    speed = np.sqrt(speed_2)
    return np.asarray(2.0 * grid.step_m / (speed[:-1] + speed[1:]))


def arrivals_s(grid: PathGrid, speed_2: Floats) -> Floats:
    """Arrival at every vertex of the polyline, shape (k,), seconds from the start; hover is included."""
    flown = np.concatenate([[0.0], np.cumsum(interval_times_s(grid, speed_2))])
    rested = np.concatenate([[0.0], np.cumsum(grid.rest_s)[:-1]])
    return np.asarray(flown[grid.vertex_node] + rested)


def compile_kernels() -> None:
    """Compile what this module runs."""
    ones = np.ones(1)
    _sweep(ones, ones, np.zeros(2), 1.0)
