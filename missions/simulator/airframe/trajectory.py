"""Trajectories of constant jerk from any motion to a place, within limits of speed, acceleration and jerk.

A trajectory is planned once per target and then evaluated at any time, so that no step is too long or too short for it.
Its parts: acceleration is taken back where it points elsewhere, the velocity is changed along a straight line to one
that points at the target, kept, and changed again to rest. A straight change of the velocity v1 to v2 passes only
velocities between the two; as what the limits allow is convex, they hold on the way when they hold at both ends.
From rest that is the shortest time over the straight leg (`planning.motion.timing.rest_to_rest_s`). From motion it is a
legal way, not always the shortest.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.geo.frames import Vec3

# Kernel of `trajectory.py`: plans the pieces of constant jerk.

Floats = NDArray[np.float64]

PASS_OVERSHOOT_M = 2.0
"""A place that is flown through is passed so slowly that the aircraft could stop this far behind it, so that no corner
is cut or overshot by more: ArduPilot's default WPNAV_RADIUS and PX4's default NAV_ACC_RAD."""

ARRIVED_M = 1e-6
"""At rest this close to the target it is put there: what rounding leaves over legs of kilometres."""

ACROSS = 1e-10
"""Acceleration across the change of velocity below this share of the limit is left as it is: rounding. Over a minute it
moves the aircraft by less than a micrometre."""

TINY = 1e-100
"""Speeds and accelerations below this have no direction: their squares have no digits."""

BISECTIONS = 52
"""Halvings of the share of the highest speed: float64's precision."""

DIRECTION_ITERATIONS = 30
"""For the direction to the target, which depends on where the bend ends."""

MAX_PIECES = 13


@kernel
def _ramp(gain: float, a0: float, a_max: float, j_max: float) -> tuple[float, float, float, float]:
    """Shortest change of speed by `gain` from acceleration `a0` to none: three durations and the sign of the jerk.

    The jerk is +, 0, - (times the sign). With the reflected gain g and a0, the acceleration's peak p without a plateau
    follows from (p^2 - a0^2) / 2j + p^2 / 2j = g; where it is above the limit, a plateau makes up for it.
    """
    at_once = a0 * abs(a0) / (2.0 * j_max)
    sign = 1.0 if gain >= at_once else -1.0
    g, a = sign * gain, sign * a0
    peak = math.sqrt(max(0.0, j_max * g + 0.5 * a * a))
    plateau_s = 0.0
    if peak > a_max:
        peak = a_max
        plateau_s = max(0.0, (g - (2.0 * peak * peak - a * a) / (2.0 * j_max)) / peak)
    return max(0.0, (peak - a) / j_max), plateau_s, peak / j_max, sign


@kernel
def _ramp_distance(ramp: tuple[float, float, float, float], a0: float, j_max: float) -> float:
    """Way along the change of velocity that it makes by itself, beginning at speed 0."""
    t1, t2, t3, sign = ramp
    j = sign * j_max
    v1, x1 = a0 * t1 + 0.5 * j * t1 * t1, 0.5 * a0 * t1 * t1 + j * t1 * t1 * t1 / 6.0
    a1 = a0 + j * t1
    v2, x2 = v1 + a1 * t2, x1 + v1 * t2 + 0.5 * a1 * t2 * t2
    return x2 + v2 * t3 + 0.5 * a1 * t3 * t3 - j * t3 * t3 * t3 / 6.0


@kernel
def _change_s(gain: float, a_max: float, j_max: float) -> float:
    """Time to change speed by `gain` >= 0 from and to no acceleration."""
    return gain / a_max + a_max / j_max if gain * j_max >= a_max * a_max else 2.0 * math.sqrt(gain / j_max)


@kernel
def _pass_speed_m_s(a_max: float, j_max: float, overshoot_m: float) -> float:
    """Speed from which the aircraft stops within `overshoot_m`: v r(v) = 2 overshoot, as in `rest_to_rest_s`."""
    least = a_max * a_max / j_max
    speed: float
    if 2.0 * overshoot_m >= 2.0 * a_max * least / j_max:
        speed = (math.sqrt(least * least + 8.0 * a_max * overshoot_m) - least) / 2.0
    else:
        speed = (overshoot_m * overshoot_m * j_max) ** (1.0 / 3.0)
    return speed


@kernel
def _speed_limit(u: Floats, caps: Floats) -> float:
    """Highest speed along a unit vector; caps are horizontal, ascent, descent."""
    vertical = caps[1] if u[2] > 0.0 else caps[2]
    slowness: float = max(math.hypot(u[0], u[1]) / caps[0], abs(u[2]) / vertical)
    return 1.0 / slowness


@kernel
def _bend(
    p: Floats, v: Floats, a: Floats, goal_v: Floats, a_max: float, j_max: float, end: Floats, along: Floats
) -> tuple[float, float, float]:
    """Change the velocity to `goal_v`: writes where that ends and along which unit vector the velocity changes.

    Returns the time in which acceleration is taken back first, the time of the rest, and the acceleration along the
    change with which that begins. Acceleration is kept only where it already points along the change.
    """
    a_norm = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    gain_v = goal_v - v
    gain = math.sqrt(gain_v[0] * gain_v[0] + gain_v[1] * gain_v[1] + gain_v[2] * gain_v[2])
    if gain > TINY:
        along[:] = gain_v / gain
    elif a_norm > TINY:
        along[:] = a / a_norm
    else:
        end[:] = p
        return 0.0, 0.0, 0.0
    a_along = a[0] * along[0] + a[1] * along[1] + a[2] * along[2]
    first_s, v1, p1 = 0.0, v, p
    across = a - a_along * along
    if math.sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]) > ACROSS * a_max:
        first_s = a_norm / j_max
        v1 = v + 0.5 * first_s * a
        p1 = p + first_s * v + first_s * first_s / 3.0 * a
        gain_v = goal_v - v1
        gain = math.sqrt(gain_v[0] * gain_v[0] + gain_v[1] * gain_v[1] + gain_v[2] * gain_v[2])
        if gain > TINY:
            along[:] = gain_v / gain
        a_along = 0.0
    ramp = _ramp(gain, a_along, a_max, j_max)
    bend_s = ramp[0] + ramp[1] + ramp[2]
    end[:] = p1 + bend_s * v1 + _ramp_distance(ramp, a_along, j_max) * along
    return first_s, bend_s, a_along


@kernel
def _try_share(
    share: float,
    state: Floats,
    target: Floats,
    caps: Floats,
    a_max: float,
    j_max: float,
    exit_m_s: float,
    goal_v: Floats,
    end: Floats,
    along: Floats,
) -> float:
    """Time to the target with a share of the highest speed towards it; infinite where that does not work out.

    Writes the velocity after the bend, and the bend's end and direction. Share 0 stops, and counts the leg that
    remains from rest.
    """
    p, v, a = state[0], state[1], state[2]
    goal_v[:] = 0.0
    first_s, bend_s, _ = _bend(p, v, a, goal_v, a_max, j_max, end, along)
    to_go = target - (end if share == 0.0 else p)
    rest_m = math.sqrt(to_go[0] * to_go[0] + to_go[1] * to_go[1] + to_go[2] * to_go[2])
    if share == 0.0:
        if rest_m <= ARRIVED_M:
            return first_s + bend_s
        speed = _speed_limit(to_go / rest_m, caps)
        fastest = _pass_speed_m_s(a_max, j_max, 0.5 * rest_m)
        if fastest < speed:
            return first_s + bend_s + 2.0 * _change_s(fastest, a_max, j_max)
        return first_s + bend_s + rest_m / speed + _change_s(speed, a_max, j_max)
    if rest_m == 0.0:
        return math.inf
    u = to_go / rest_m
    speed, turned = 0.0, math.inf
    for _ in range(DIRECTION_ITERATIONS):
        speed = share * _speed_limit(u, caps)
        goal_v[:] = speed * u
        first_s, bend_s, _ = _bend(p, v, a, goal_v, a_max, j_max, end, along)
        to_go = target - end
        rest_m = math.sqrt(to_go[0] * to_go[0] + to_go[1] * to_go[1] + to_go[2] * to_go[2])
        if rest_m == 0.0:
            turned = 0.0
            break
        w = to_go / rest_m
        turned = math.sqrt((w[0] - u[0]) ** 2 + (w[1] - u[1]) ** 2 + (w[2] - u[2]) ** 2)
        if turned < 1e-14:
            break
        u = w
    if turned * rest_m > 1e-9:
        return math.inf
    leaving = min(exit_m_s, speed)
    brake_s = _change_s(speed - leaving, a_max, j_max)
    cruise_m = rest_m - 0.5 * (speed + leaving) * brake_s
    if cruise_m < 0.0:
        return math.inf
    return first_s + bend_s + cruise_m / speed + brake_s


@kernel
def _push(pieces: Floats, n: int, duration_s: float, jerk: Floats) -> int:
    """Append a piece of constant jerk after piece n - 1; returns the new number."""
    if duration_s <= 0.0:
        return n
    t = duration_s
    here, after = pieces[n], pieces[n + 1]
    here[10:13] = jerk
    p, v, a = here[1:4], here[4:7], here[7:10]
    after[0] = here[0] + t
    after[1:4] = p + t * (v + t * (0.5 * a + t / 6.0 * jerk))
    after[4:7] = v + t * (a + 0.5 * t * jerk)
    after[7:10] = a + t * jerk
    return n + 1


@kernel
def _push_ramp(
    pieces: Floats, n: int, gain: float, a0: float, along: Floats, a_max: float, j_max: float, goal_v: Floats
) -> int:
    """Append a straight change of the velocity by `gain`, which ends at `goal_v` without acceleration."""
    t1, t2, t3, sign = _ramp(gain, a0, a_max, j_max)
    jerk = sign * j_max * along
    n = _push(pieces, n, t1, jerk)
    n = _push(pieces, n, t2, 0.0 * jerk)
    n = _push(pieces, n, t3, -jerk)
    # Rounding stays where it arose: the next piece begins with the velocity that was meant.
    pieces[n, 4:7] = goal_v
    pieces[n, 7:10] = 0.0
    return n


@kernel
def _best_share(
    state: Floats,
    target: Floats,
    caps: Floats,
    a_max: float,
    j_max: float,
    exit_m_s: float,
    goal_v: Floats,
    end: Floats,
    along: Floats,
) -> float:
    """Share of the highest speed with which the target is reached soonest; 0 to stop first."""
    best_s = _try_share(1.0, state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
    best_share = 1.0
    if not math.isfinite(best_s):
        low, high = 0.0, 1.0
        to_go, a = target - state[0], state[2]
        away_m = math.sqrt(to_go[0] * to_go[0] + to_go[1] * to_go[1] + to_go[2] * to_go[2])
        if away_m > 0.0:
            # Slowing down first would lengthen the way: where the speed that it has, once its acceleration is taken
            # back, can be kept, only faster is of interest.
            u = to_go / away_m
            kept_v = state[1] + 0.5 * math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) / j_max * a
            kept = (kept_v[0] * u[0] + kept_v[1] * u[1] + kept_v[2] * u[2]) / _speed_limit(u, caps)
            if 0.0 < kept < 1.0:
                best_share = kept
                best_s = _try_share(kept, state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
                if math.isfinite(best_s):
                    low = kept
                else:
                    high = kept
        for _ in range(BISECTIONS):
            share = 0.5 * (low + high)
            found_s = _try_share(share, state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
            if math.isfinite(found_s):
                low = share
            else:
                high = share
            if found_s < best_s:
                best_share, best_s = share, found_s
    stopping_s = _try_share(0.0, state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
    # At rest both are the same way, but for rounding.
    return 0.0 if stopping_s < best_s * (1.0 - 1e-6) else best_share


@kernel
def _plan_pieces(state: Floats, target: Floats, caps: Floats, a_max: float, j_max: float, passes: bool) -> Floats:
    """Pieces of a trajectory, shape (n, 13): start time, position, velocity, acceleration, jerk; the last is rest."""
    goal_v, end, along = np.zeros(3), np.zeros(3), np.zeros(3)
    exit_m_s = _pass_speed_m_s(a_max, j_max, PASS_OVERSHOOT_M) if passes else 0.0
    share = _best_share(state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
    # Once more, for what it writes.
    _try_share(share, state, target, caps, a_max, j_max, exit_m_s, goal_v, end, along)
    first_s, _, a_along = _bend(state[0], state[1], state[2], goal_v, a_max, j_max, end, along)
    pieces = np.zeros((MAX_PIECES, 13))
    pieces[0, 1:4], pieces[0, 4:7], pieces[0, 7:10] = state[0], state[1], state[2]
    n = 0
    if first_s > 0.0:
        n = _push(pieces, 0, first_s, -state[2] / first_s)
        pieces[n, 7:10] = 0.0
    gain_v = goal_v - pieces[n, 4:7]
    gain = gain_v[0] * along[0] + gain_v[1] * along[1] + gain_v[2] * along[2]
    n = _push_ramp(pieces, n, gain, a_along, along, a_max, j_max, goal_v)
    speed = math.sqrt(goal_v[0] * goal_v[0] + goal_v[1] * goal_v[1] + goal_v[2] * goal_v[2])
    if speed > 0.0:
        u = goal_v / speed
        leaving = min(exit_m_s, speed)
        to_go = target - pieces[n, 1:4]
        rest_m = to_go[0] * u[0] + to_go[1] * u[1] + to_go[2] * u[2]
        cruise_m = rest_m - 0.5 * (speed + leaving) * _change_s(speed - leaving, a_max, j_max)
        n = _push(pieces, n, cruise_m / speed, np.zeros(3))
        n = _push_ramp(pieces, n, speed - leaving, 0.0, -u, a_max, j_max, leaving * u)
        if leaving > 0.0:
            n = _push_ramp(pieces, n, leaving, 0.0, -u, a_max, j_max, np.zeros(3))
    return pieces[: n + 1]


JERK_RAMP_S = 1e-3
"""Where no jerk is stated the acceleration is reached in this time: a leg takes 1 ms longer than without any limit."""

State = tuple[Vec3, Vec3, Vec3]
"""Position, velocity and acceleration; ENU, m, m/s, m/s2."""


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Motion from one state to rest, by pieces of constant jerk.

    Parameters
    ----------
    starts_s
        When each piece begins; the last piece is rest for ever.
    pieces
        Start time, position, velocity, acceleration, jerk: 13 numbers each.
    """

    starts_s: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]

    @property
    def end_s(self) -> float:
        """When it is at rest."""
        return self.starts_s[-1]

    def at(self, time_s: float) -> State:
        """Motion at a time of 0 or later; exact, whatever the step."""
        t0, px, py, pz, vx, vy, vz, ax, ay, az, jx, jy, jz = self.pieces[bisect_right(self.starts_s, time_s) - 1]
        t = time_s - t0
        h, s = 0.5 * t, t / 6.0
        return (
            (
                px + t * (vx + h * ax + s * t * jx),
                py + t * (vy + h * ay + s * t * jy),
                pz + t * (vz + h * az + s * t * jz),
            ),
            (vx + t * (ax + h * jx), vy + t * (ay + h * jy), vz + t * (az + h * jz)),
            (ax + t * jx, ay + t * jy, az + t * jz),
        )


def resting(position_enu_m: Vec3) -> Trajectory:
    """Rest at a place."""
    return Trajectory((0.0,), ((0.0, *position_enu_m, *([0.0] * 9)),))


def plan_trajectory(
    state: State,
    target_enu_m: Vec3,
    speeds_m_s: tuple[float, float, float],
    acceleration_m_s2: float,
    jerk_m_s3: float,
    *,
    passes: bool = False,
) -> Trajectory:
    """Trajectory from a motion to a place.

    Parameters
    ----------
    speeds_m_s
        Highest horizontal speed, ascent and descent.
    jerk_m_s3
        May be infinite; see `JERK_RAMP_S`.
    passes
        Do not brake for the target: it is passed with up to the speed from which the aircraft stops `PASS_OVERSHOOT_M`
        behind it, which it does when no other target follows.

    Returns
    -------
    trajectory
        Ends at rest, at the target but for two cases: with `passes`, and where the aircraft is too fast to get there
        without stopping first. A leg from where it then rests leads to it.

    Raises
    ------
    ValueError
        Something is not finite, or a limit is not positive.
    """
    numbers = (*state[0], *state[1], *state[2], *target_enu_m, *speeds_m_s, acceleration_m_s2)
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"expected finite motion, target and limits, got {state}, {target_enu_m}, {speeds_m_s}")
    if not (min(speeds_m_s) > 0.0 and acceleration_m_s2 > 0.0 and jerk_m_s3 > 0.0):
        raise ValueError(f"expected positive limits, got {speeds_m_s}, {acceleration_m_s2}, {jerk_m_s3}")
    jerk = jerk_m_s3 if math.isfinite(jerk_m_s3) else acceleration_m_s2 / JERK_RAMP_S
    target = np.array(target_enu_m, np.float64)
    found = _plan_pieces(
        np.array(state, np.float64), target, np.array(speeds_m_s, np.float64), acceleration_m_s2, jerk, passes
    )
    if np.abs(found[-1, 1:4] - target).max() <= ARRIVED_M:
        found[-1, 1:4] = target
    rows = tuple(tuple(row) for row in found.tolist())
    return Trajectory(tuple(row[0] for row in rows), rows)
