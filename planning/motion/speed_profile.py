"""Fastest speed profile of a whole sortie as one nonlinear program, and the effect that says when it is worth having.

It answers by how much a flight that does not stop at every corner can be faster than one that does. The missions that
are written stop at every waypoint, where the closed form of `planning.motion.timing` is exact; missions of other
programs and pilots need not, so a check of durations asks here first.

The program is that of `planning.motion.smooth_path`: squared speeds b at the nodes of a grid; least time, the sum of
2 ds / (sqrt(b0) + sqrt(b1)); b under its ceilings (speed by direction, heading and gimbal rate); tangential and
centripetal acceleration together within one circle. It is convex and sparse; Ipopt solves it from the profile of
`fastest_sweep`. This is the only module that imports casadi.

As long as every limit couples two neighbouring nodes, the sweep alone finds the same profile a thousand times faster
(the tests hold the two against each other). The program is where limits go that reach further.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, never
from planning.motion.smooth_path import PathGrid, arrivals_s, fastest_sweep, interval_times_s, path_grid
from planning.motion.timing import FlightPath, MotionLimits, stopping_times_s

Floats = NDArray[np.float64]

CORNER_DEVIATION_M = 0.3
"""How far a rounded corner leaves the polyline: less than the position error of an aircraft without RTK."""

MAX_ITERATIONS = 300

SMALLEST = 1e-9
"""Squared speeds stay above this part of what the nearest stops allow: their square roots are differentiated."""

HOLDS = 1e-6
"""Relative violation of a limit that counts as none; Ipopt ends at 1e-8."""


COST_S, COST_PER_NODE_S = 0.05, 2e-4
"""Time the program takes; measured on sorties of 5 to 500 legs."""


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
    solver
        `nlp`, or `sweep` where that was asked for or the program was stopped before it had converged.
    iterations
        Of Ipopt.
    """

    distance_m: Floats
    speed_m_s: Floats
    arrival_s: Floats
    duration_s: float
    solver: Literal["nlp", "sweep"]
    iterations: int


def fastest_profile(
    path: FlightPath,
    limits: MotionLimits,
    *,
    solver: Literal["nlp", "sweep"] = "nlp",
    corner_deviation_m: float = CORNER_DEVIATION_M,
    stop: Stop = never,
    monitor: Monitor = QUIET,
) -> SpeedProfile:
    """Fastest way to fly a path within the limits.

    Parameters
    ----------
    corner_deviation_m
        How far the flown path may cut a corner at which the aircraft does not stop; clearances must allow for it.
    stop
        Asked at every iteration; the profile is then that of the sweep.

    Returns
    -------
    profile
        Never faster than the limits allow. Corners sharper than `planning.motion.smooth_path.SHARPEST_TURN_RAD` and
        legs of no length are stopped at, whatever the path says.
    """
    grid = path_grid(path, limits, corner_deviation_m)
    squared = fastest_sweep(grid)
    used: Literal["nlp", "sweep"] = "sweep"
    iterations = 0
    if solver == "nlp" and not grid.is_stop.all():
        found, iterations = _solve(grid, squared, stop, monitor)
        if found is not None and _holds(grid, found):
            squared, used = found, "nlp"
    arrival_s = arrivals_s(grid, squared)
    distance_m = np.concatenate([[0.0], np.cumsum(grid.step_m)])
    duration_s = float(arrival_s[-1] + grid.rest_s[-1])
    return SpeedProfile(distance_m, np.sqrt(squared), arrival_s, duration_s, used, iterations)


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


def _solve(grid: PathGrid, start: Floats, stop: Stop, monitor: Monitor) -> tuple[Floats | None, int]:
    """Squared speeds at all nodes and the number of iterations; None unless Ipopt converged."""
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

    progress = _progress(len(free), constraints.shape[0], stop, monitor)
    options = {
        "print_time": False,
        "error_on_fail": False,
        "iteration_callback": progress,
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
    progress.raise_cancelled()
    statistics = ipopt.stats()
    if not statistics["success"]:
        return None, int(statistics["iter_count"])
    found = np.zeros(len(highest))
    found[free] = np.asarray(solution["x"]).ravel() * highest[free]
    return found, int(statistics["iter_count"])


def _progress(n_variables: int, n_constraints: int, stop: Stop, monitor: Monitor) -> Any:
    """Iteration callback that reports progress, and ends the solver when `stop` or the monitor wants it."""
    import casadi

    class Progress(casadi.Callback):
        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.iterations = 0
            self.cancelled: BaseException | None = None
            self.construct("progress", {})

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, i: int) -> Any:
            sizes = {"f": 1, "x": n_variables, "lam_x": n_variables, "g": n_constraints, "lam_g": n_constraints}
            size = sizes.get(casadi.nlpsol_out(i), 0)
            return casadi.Sparsity.dense(size, 1) if size else casadi.Sparsity(0, 0)

        def eval(self, _: Any) -> list[int]:
            self.iterations += 1
            try:
                monitor.report(say("speed profile"), self.iterations, 0)
            except BaseException as error:  # CasADi would turn it into an error of its own: kept and raised afterwards
                self.cancelled = error
            return [int(self.cancelled is not None or stop())]

        def raise_cancelled(self) -> None:
            if self.cancelled is not None:
                raise self.cancelled

    return Progress()


@dataclass(frozen=True, slots=True)
class CornerSpeed:
    """Effect: at corners without a photo the aircraft may fly on, which saves the time of stopping there.

    Where it stops at every vertex the closed form is exact, turns in flight included, and no program is needed. The
    scene is a path with the aircraft's limits.
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
        return Assessment(max(0.0, saved_s), reason, COST_S + COST_PER_NODE_S * len(grid.is_stop))


def corner_saving_s(path: FlightPath, limits: MotionLimits, setting: EffectSetting = "auto") -> tuple[float, Decision]:
    """What flying through the corners of a path saves against stopping at each, and the effect's decision.

    Returns
    -------
    saving_s
        By the program where the effect is on, 0 where it is off. Jerk is left out on both sides.
    """
    decision = decide(CornerSpeed(), (path, limits), setting)
    if not decision.on:
        return 0.0, decision
    stopping_s = float(stopping_times_s(path, replace(limits, jerk_m_s3=math.inf))[-1]) + float(path.hover_s[-1])
    return max(0.0, stopping_s - fastest_profile(path, limits).duration_s), decision
