"""How long PX4 takes for a leg and for a turn.

Its trajectory does not brake with full deceleration up to the goal. At each distance d before it PX4 allows the speed
v from which it could stop if full deceleration needed the time 2 a / j to build up:

    v^2 = 2 a (d - 2 a v / j),   so   v(d) = (sqrt(b^2 + 8 a d) - b) / 2   with   b = 4 a^2 / j

(PX4, TrajMath.hpp, computeMaxSpeedFromDistance). The last metres are an exponential approach with the time constant
2 a / j: 1.5 s with PX4's defaults. A waypoint counts as reached at its acceptance radius, long before that ends.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.motion.timing import MotionLimits

Floats = NDArray[np.float64]

YAW_ACCELERATION_DEG_S2 = 20.0
"""PX4's default MPC_YAWRAUTO_ACC."""

JERK_M_S3 = 4.0
"""PX4's default MPC_JERK_AUTO, for aircraft that state none."""

ALTITUDE_RADIUS_M = 0.8
"""PX4's default NAV_MC_ALT_RAD: height within which a waypoint is reached."""

BISECTIONS = 50
"""Halvings of the speed: down to the last bits of a float."""


def px4_turn_s(turn_deg: float, rate_deg_s: float) -> float:
    """Time of a turn from rest to rest; angles in degrees, not negative."""
    gaining_s = rate_deg_s / YAW_ACCELERATION_DEG_S2
    turning_s = turn_deg / rate_deg_s
    return turning_s + gaining_s if turning_s >= gaining_s else 2.0 * math.sqrt(turning_s * gaining_s)


def px4_legs_s(deltas_enu_m: Floats, limits: MotionLimits, radius_m: float) -> Floats:
    """Times from rest until PX4 takes waypoints for reached, shape (n,), which are `deltas_enu_m` away, shape (n, 3).

    Across and up or down it flies side by side, each as fast as it may; the later of the two counts.

    Raises
    ------
    ValueError
        The radius is not positive: the approach never ends.
    """
    delta = np.asarray(deltas_enu_m, float)
    a, j = limits.acceleration_m_s2, limits.jerk_m_s3 if math.isfinite(limits.jerk_m_s3) else JERK_M_S3
    across_s = straight_s(np.hypot(delta[:, 0], delta[:, 1]), limits.horizontal_m_s, a, j, radius_m)
    climbing_m_s = np.where(delta[:, 2] > 0.0, limits.ascent_m_s, limits.descent_m_s)
    return np.maximum(across_s, straight_s(np.abs(delta[:, 2]), climbing_m_s, a, j, ALTITUDE_RADIUS_M))


def straight_s(length_m: ArrayLike, speed_m_s: ArrayLike, a_m_s2: float, j_m_s3: float, radius_m: float) -> Floats:
    """Times along straight lines from rest to within `radius_m` of their ends, broadcast shape.

    It gains speed as fast as acceleration and jerk allow, keeps it, and brakes along v(d), where that begins.
    """
    if not radius_m > 0.0:
        raise ValueError(f"radius_m: expected more than 0, got {radius_m}")
    length, fast = (each.astype(float) for each in np.broadcast_arrays(length_m, speed_m_s))
    slow = np.zeros(length.shape)
    for _ in range(BISECTIONS):
        middle = (slow + fast) / 2.0
        fits = _gaining_s(middle, a_m_s2, j_m_s3) * middle / 2.0 + _braking_m(middle, a_m_s2, j_m_s3) <= length
        slow, fast = np.where(fits, middle, slow), np.where(fits, fast, middle)
    gaining_s, braking_m = _gaining_s(fast, a_m_s2, j_m_s3), _braking_m(fast, a_m_s2, j_m_s3)
    cruising_m = np.maximum(0.0, length - gaining_s * fast / 2.0 - braking_m)
    # Where braking begins within the radius, it is not waited for.
    flown_m = np.maximum(0.0, cruising_m - np.maximum(0.0, radius_m - braking_m))
    braking_s = _braking_s(np.maximum(braking_m, radius_m), radius_m, a_m_s2, j_m_s3)
    return np.where(length <= radius_m, 0.0, gaining_s + flown_m / fast + braking_s)


def _gaining_s(speed_m_s: Floats, a: float, j: float) -> Floats:
    return np.where(speed_m_s >= a * a / j, speed_m_s / a + a / j, 2.0 * np.sqrt(speed_m_s / j))


def _braking_m(speed_m_s: Floats, a: float, j: float) -> Floats:
    """Distance at which the allowed speed has come down to this one."""
    return speed_m_s * (speed_m_s / (2.0 * a) + 2.0 * a / j)


def _braking_s(from_m: Floats, to_m: float, a: float, j: float) -> Floats:
    """Integral of 1 / v(d): with u = sqrt(b^2 + 8 a d) it is (u + b ln(u - b)) / (2 a) between the two."""
    b = 4.0 * a * a / j
    u_from, u_to = np.sqrt(b * b + 8.0 * a * from_m), math.sqrt(b * b + 8.0 * a * to_m)
    # u - b = 8 a d / (u + b), without the difference of near numbers.
    ratio = (from_m / to_m) * (u_to + b) / (u_from + b)
    return np.asarray((u_from - u_to + b * np.log(ratio)) / (2.0 * a))
