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

from missions.simulator.airframe.trajectory_kernel import ARRIVED_M, plan_pieces
from planning.geo.frames import Vec3

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
    found = plan_pieces(
        np.array(state, np.float64), target, np.array(speeds_m_s, np.float64), acceleration_m_s2, jerk, passes
    )
    if np.abs(found[-1, 1:4] - target).max() <= ARRIVED_M:
        found[-1, 1:4] = target
    rows = tuple(tuple(row) for row in found.tolist())
    return Trajectory(tuple(row[0] for row in rows), rows)
