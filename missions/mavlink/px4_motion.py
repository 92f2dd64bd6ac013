"""How long PX4 takes for a leg and for a turn.

Its trajectory does not brake with full deceleration up to the goal. At each distance d before it PX4 allows the speed
v from which it could stop if full deceleration needed the time 2 a / j to build up:

    v^2 = 2 a (d - 2 a v / j),   so   v(d) = (sqrt(b^2 + 8 a d) - b) / 2   with   b = 4 a^2 / j

(PX4, TrajMath.hpp, computeMaxSpeedFromDistance). The last metres are an exponential approach with the time constant
2 a / j: 1.5 s with PX4's defaults. A waypoint counts as reached at its acceptance radius, long before that ends.
"""

from __future__ import annotations

import math

from planning.geo.frames import Vec3
from planning.motion.timing import MotionLimits

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


def px4_leg_s(delta_enu_m: Vec3, limits: MotionLimits, radius_m: float) -> float:
    """Time from rest until PX4 takes a waypoint for reached, which is `delta_enu_m` away.

    Across and up or down it flies side by side, each as fast as it may; the later of the two counts.

    Raises
    ------
    ValueError
        The radius is not positive: the approach never ends.
    """
    x, y, z = delta_enu_m
    a, j = limits.acceleration_m_s2, limits.jerk_m_s3 if math.isfinite(limits.jerk_m_s3) else JERK_M_S3
    climbing_m_s = limits.ascent_m_s if z > 0.0 else limits.descent_m_s
    across_s = straight_s(math.hypot(x, y), limits.horizontal_m_s, a, j, radius_m)
    return max(across_s, straight_s(abs(z), climbing_m_s, a, j, ALTITUDE_RADIUS_M))


def straight_s(length_m: float, speed_m_s: float, a_m_s2: float, j_m_s3: float, radius_m: float) -> float:
    """Time along a straight line from rest to within `radius_m` of its end.

    It gains speed as fast as acceleration and jerk allow, keeps it, and brakes along v(d), where that begins.
    """
    if not radius_m > 0.0:
        raise ValueError(f"radius_m: expected more than 0, got {radius_m}")
    if length_m <= radius_m:
        return 0.0
    slow, fast = 0.0, speed_m_s
    for _ in range(BISECTIONS):
        middle = (slow + fast) / 2.0
        fits = _gaining_s(middle, a_m_s2, j_m_s3) * middle / 2.0 + _braking_m(middle, a_m_s2, j_m_s3) <= length_m
        slow, fast = (middle, fast) if fits else (slow, middle)
    top_m_s = fast
    gaining_s, braking_m = _gaining_s(top_m_s, a_m_s2, j_m_s3), _braking_m(top_m_s, a_m_s2, j_m_s3)
    cruising_m = max(0.0, length_m - gaining_s * top_m_s / 2.0 - braking_m)
    if braking_m <= radius_m:
        return gaining_s + max(0.0, cruising_m - (radius_m - braking_m)) / top_m_s
    return gaining_s + cruising_m / top_m_s + _braking_s(braking_m, radius_m, a_m_s2, j_m_s3)


def _gaining_s(speed_m_s: float, a: float, j: float) -> float:
    return speed_m_s / a + a / j if speed_m_s >= a * a / j else 2.0 * math.sqrt(speed_m_s / j)


def _braking_m(speed_m_s: float, a: float, j: float) -> float:
    """Distance at which the allowed speed has come down to this one."""
    return speed_m_s * (speed_m_s / (2.0 * a) + 2.0 * a / j)


def _braking_s(from_m: float, to_m: float, a: float, j: float) -> float:
    """Integral of 1 / v(d): with u = sqrt(b^2 + 8 a d) it is (u + b ln(u - b)) / (2 a) between the two."""
    b = 4.0 * a * a / j
    u_from, u_to = (math.sqrt(b * b + 8.0 * a * d) for d in (from_m, to_m))
    # u - b = 8 a d / (u + b), without the difference of near numbers.
    ratio = (from_m / to_m) * (u_to + b) / (u_from + b)
    return (u_from - u_to + b * math.log(ratio)) / (2.0 * a)
