"""A polyline whose corners are rounded where the aircraft flies through them, and the fastest way along it.

It answers by how much a flight that does not stop at every corner can be faster than one that does. The missions that
are written stop at every waypoint, where the closed form of `planning.motion.timing` is exact; missions of other
programs and pilots need not, so a check of durations asks here first.

The path is described by its length s and the squared speed b = (ds/dt)^2 (D. Verscheure et al., 2009, "Time-optimal
path tracking for robots: a convex optimization approach", section III): the tangential acceleration is b'/2 and the
centripetal one kappa b, so that all limits are convex in b. With b linear between the nodes of a grid they hold
everywhere when they hold at both ends of every interval, and the time over an interval is exact. A limit of jerk is
left out: it is not convex in b.

All decisions are made with the sweep, `fastest_sweep`. `solver="nlp"` is its reference: the same problem as one convex
and sparse nonlinear program, solved by Ipopt through CasADi; tests hold the two against each other. The program is also
the place for limits that couple more than two neighbouring nodes, which no sweep can keep. As long as there are none,
the sweep finds the same profile in a fraction of the time (benchmark `speed-profile`). This is the only module that
imports casadi.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.jit import inline, kernel
from planning.base.messages import say
from planning.motion.timing import FlightPath, MotionLimits, speed_limits_m_s, stopping_times_s

Floats = NDArray[np.float64]


# A polyline whose corners are rounded where the aircraft flies through them, and the fastest way along it.
#
# The path is described by its length s and the squared speed b = (ds/dt)^2 (D. Verscheure et al., 2009, "Time-optimal
# path tracking for robots: a convex optimization approach", section III): the tangential acceleration is b'/2 and the
# centripetal one kappa b, so that all limits are convex in b. With b linear between the nodes of a grid they hold
# everywhere when they hold at both ends of every interval, and the time over an interval is exact. A limit of jerk is
# left out: it is not convex in b.

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
    `_solve` would be badly scaled.
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


CORNER_DEVIATION_M = 0.3
"""How far a rounded corner leaves the polyline: less than the position error of an aircraft without RTK."""

MAX_ITERATIONS = 300
"""Of Ipopt; flights of 500 legs take under 150."""

SMALLEST = 1e-9
"""Squared speeds stay above this part of what the nearest stops allow: their square roots are differentiated."""

HOLDS = 1e-6
"""Relative violation of a limit that counts as none; Ipopt ends at 1e-8."""


COST_PER_NODE_S = 6e-6
"""Time of the grid and the sweep; measured on flights of 35 to 700 legs."""


@dataclass(frozen=True, slots=True, eq=False)
class SpeedProfile:
    """Speeds along a sortie.

    Parameters
    ----------
    distance_m, speed_m_s
        Shape (q + 1,), at the nodes, along the rounded path; between them the squared speed is linear.
    arrival_s
        Shape (k,), arrival at every vertex of the polyline (at a rounded corner: the middle of the arc), seconds from
        the start of the hover at the first.
    duration_s
        Until the hover at the last vertex is over.
    iterations
        Of Ipopt; 0 where it was not asked.
    """

    distance_m: Floats
    speed_m_s: Floats
    arrival_s: Floats
    duration_s: float
    iterations: int = 0


def fastest_profile(
    path: FlightPath,
    limits: MotionLimits,
    *,
    solver: Literal["sweep", "nlp"] = "sweep",
    corner_deviation_m: float = CORNER_DEVIATION_M,
) -> SpeedProfile:
    """Fastest way to fly a path within the limits.

    Parameters
    ----------
    solver
        `nlp` is the reference of `sweep`, and slow.
    corner_deviation_m
        How far the flown path may cut a corner at which the aircraft does not stop; clearances must allow for it.

    Returns
    -------
    profile
        Never faster than the limits allow. Corners sharper than `SHARPEST_TURN_RAD` and legs of no length are stopped
        at, whatever the path says.

    Raises
    ------
    ArithmeticError
        Ipopt did not converge, or to something that breaks a limit.
    """
    grid = path_grid(path, limits, corner_deviation_m)
    squared, iterations = fastest_sweep(grid), 0
    if solver == "nlp" and not grid.is_stop.all():
        squared, iterations = _solve(grid, squared)
    arrival_s = arrivals_s(grid, squared)
    distance_m = np.concatenate([[0.0], np.cumsum(grid.step_m)])
    duration_s = float(arrival_s[-1] + grid.rest_s[-1])
    return SpeedProfile(distance_m, np.sqrt(squared), arrival_s, duration_s, iterations)


def _holds(grid: PathGrid, squared: Floats) -> bool:
    """Whether a profile keeps every limit."""
    tangential = np.diff(squared) / (2.0 * grid.step_m)
    centripetal = grid.curvature_per_m * np.maximum(squared[:-1], squared[1:])
    within = np.hypot(tangential, centripetal) <= grid.acceleration_m_s2 * (1.0 + HOLDS)
    return bool(within.all() and (squared <= grid.ceiling * (1.0 + HOLDS)).all() and (squared >= 0.0).all())


def _highest(grid: PathGrid) -> Floats:
    """Squared speed that ceilings and the nearest stops allow at each node: the scale of the variables."""
    ceiling = grid.ceiling
    gain = 2.0 * grid.acceleration_m_s2 * grid.step_m
    highest = ceiling.copy()
    for i, rise in enumerate(gain):
        highest[i + 1] = min(highest[i + 1], highest[i] + rise)
    for i in range(len(gain) - 1, -1, -1):
        highest[i] = min(highest[i], highest[i + 1] + gain[i])
    return highest


def _solve(grid: PathGrid, start: Floats) -> tuple[Floats, int]:
    """Squared speeds at all nodes by Ipopt, and the number of its iterations.

    Least time, the sum of 2 ds / (sqrt(b0) + sqrt(b1)); b under its ceilings (speed by direction, heading and gimbal
    rate); tangential and centripetal acceleration together within one circle.
    """
    import casadi

    highest = _highest(grid)
    free = np.flatnonzero(~grid.is_stop)
    variable = np.full(len(highest), -1)
    variable[free] = np.arange(len(free))
    x = casadi.MX.sym("x", len(free))
    squared = x * casadi.DM(highest[free])
    left, right = variable[:-1], variable[1:]

    def pick(vector: Any, indices: NDArray[np.int64]) -> Any:
        return casadi.reshape(vector[indices.tolist()], len(indices), 1)  # CasADi picks nothing as a row

    # Intervals next to a stop have one free end: there the limit of acceleration is already in `highest`.
    both = np.flatnonzero((left >= 0) & (right >= 0))
    one = np.flatnonzero((left < 0) != (right < 0))
    b0, b1, lone = pick(squared, left[both]), pick(squared, right[both]), pick(squared, np.maximum(left, right)[one])
    time_s = casadi.sum1(2.0 * casadi.DM(grid.step_m[both]) / (casadi.sqrt(b0) + casadi.sqrt(b1)))
    time_s += casadi.sum1(2.0 * casadi.DM(grid.step_m[one]) / casadi.sqrt(lone))
    gain = 2.0 * grid.step_m[both] * grid.acceleration_m_s2
    # Rows are scaled by what their interval can change of its variables: unscaled, those of short intervals have
    # gradients of thousands, and Ipopt loses its way on sorties of hundreds of legs.
    row = np.minimum(1.0, gain / np.maximum(highest[:-1], highest[1:])[both])
    tangential = (b1 - b0) / casadi.DM(gain)
    bend = casadi.DM(grid.curvature_per_m[both] / grid.acceleration_m_s2)
    is_arc = grid.curvature_per_m[both] > 0.0
    lines, arcs = np.flatnonzero(~is_arc), np.flatnonzero(is_arc)
    circles = [pick((tangential**2 + (bend * b) ** 2) * casadi.DM(row), arcs) for b in (b0, b1)]
    constraints = casadi.vertcat(pick(tangential * casadi.DM(row), lines), *circles)
    upper = np.concatenate([row[lines], row[arcs], row[arcs]])
    lower = np.concatenate([-row[lines], np.full(2 * len(arcs), -np.inf)])
    sweep_s = float(interval_times_s(grid, start).sum())

    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-8,
        "ipopt.max_iter": MAX_ITERATIONS,
        "ipopt.bound_relax_factor": 0.0,  # otherwise bounds are exceeded, and profiles faster than they may be
    }
    program = {"x": x, "f": time_s / sweep_s, "g": constraints}
    ipopt = casadi.nlpsol("profile", "ipopt", program, options)
    solution = ipopt(
        # The sweep's profile lies on the limits; an interior-point method wants to begin inside them.
        x0=np.maximum(0.5 * start[free] / highest[free], SMALLEST),
        lbx=SMALLEST,
        ubx=1.0,
        lbg=lower,
        ubg=upper,
    )
    statistics = ipopt.stats()
    found = np.zeros(len(highest))
    found[free] = np.asarray(solution["x"]).ravel() * highest[free]
    if not (statistics["success"] and _holds(grid, found)):
        raise ArithmeticError(say("Ipopt found no speed profile: {}", statistics["return_status"]))
    return found, int(statistics["iter_count"])


@dataclass(frozen=True, slots=True)
class CornerSpeed:
    """Effect: at corners without a photo the aircraft may fly on, which saves the time of stopping there.

    Where it stops at every vertex the closed form is exact, turns in flight included. The scene is a path with the
    aircraft's limits.
    """

    name: str = say("speed through corners")
    unit: str = "s"
    tolerance: float = 1.0
    """A second a sortie: less than the wind changes its duration."""

    def assess(self, scene: tuple[FlightPath, MotionLimits]) -> Assessment:
        """Time that stopping at every vertex would add to the sortie."""
        path, limits = scene
        n_flown_through = int((~path.is_stop).sum())
        if n_flown_through == 0:
            return Assessment(0.0, say("the aircraft stops at every vertex, where the closed form is exact"), 0.0)
        grid = path_grid(path, limits, CORNER_DEVIATION_M)
        rounded_s = float(arrivals_s(grid, fastest_sweep(grid))[-1])
        saved_s = float(stopping_times_s(path, replace(limits, jerk_m_s3=math.inf))[-1]) - rounded_s
        reason = say("{} of {} vertices are flown through without a stop", n_flown_through, len(path.is_stop))
        return Assessment(max(0.0, saved_s), reason, COST_PER_NODE_S * len(grid.is_stop))


def corner_saving_s(path: FlightPath, limits: MotionLimits, setting: EffectSetting = "auto") -> tuple[float, Decision]:
    """What flying through the corners of a path saves against stopping at each, and the effect's decision.

    Returns
    -------
    saving_s
        Where the effect is on; 0 where it is off. Jerk is left out on both sides.
    """
    decision = decide(CornerSpeed(), (path, limits), setting)
    if not decision.on:
        return 0.0, decision
    stopping_s = float(stopping_times_s(path, replace(limits, jerk_m_s3=math.inf))[-1]) + float(path.hover_s[-1])
    return max(0.0, stopping_s - fastest_profile(path, limits).duration_s), decision
