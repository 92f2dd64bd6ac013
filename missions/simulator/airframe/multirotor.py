"""A multirotor that flies straight legs within its limits, turns its nose and its camera, and takes photos.

The trajectory (`trajectory.py`) is the motion that the autopilot steers, exact at any step. Parts (`parts.py`) are put
onto it: wind moves the aircraft off it, position errors part what is believed from what is true. Where no effect is on
there is nothing to add, and `estimate` and `truth` are one object.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from missions.simulator.airframe.state import Battery, Fix, Parts, Pose, Target
from missions.simulator.airframe.trajectory import State, plan_trajectory, resting
from planning.geo.frames import Vec3
from planning.motion.timing import MotionLimits

GRAVITY_M_S2 = 9.80665

NOWHERE: Vec3 = (0.0, 0.0, 0.0)

TINY_M_S = 1e-12

FALL_STEP_S = 0.05
"""Longest step of a fall with drag: the place errs by less than a centimetre over 80 m."""


class Multirotor:
    """An `Airframe` with the limits of an aircraft.

    Parameters
    ----------
    limits
        Bounds for whatever a target asks for.
    gimbal_pitch_rad
        Lowest and highest pitch; a target beyond is cut to them without a word, as gimbals do.
    home_enu_m
        Where it is at first.
    velocity_enu_m_s
        With which it moves there, over the ground.
    ground_z_m
        Height of the level ground; None: it stands on it at first.
    terrain_z_m
        Height of the ground at a place, x and y; None: it is level.
    """

    def __init__(
        self,
        limits: MotionLimits,
        gimbal_pitch_rad: tuple[float, float],
        home_enu_m: Vec3,
        parts: Parts,
        heading_rad: float = 0.0,
        *,
        velocity_enu_m_s: Vec3 = NOWHERE,
        ground_z_m: float | None = None,
        terrain_z_m: Callable[[float, float], float] | None = None,
    ) -> None:
        self._limits, self._gimbal_pitch_rad, self._parts = limits, gimbal_pitch_rad, parts
        level_z_m = home_enu_m[2] if ground_z_m is None else ground_z_m
        self._ground_z_m = terrain_z_m or (lambda _x, _y: level_z_m)
        self._trajectory, self._leg_s = resting(home_enu_m), 0.0
        self._steered: tuple[Vec3, Vec3, bool] | None = None
        self._motion: State = (home_enu_m, velocity_enu_m_s, NOWHERE)
        self._heading_rad, self._yaw_rate_rad_s = heading_rad, 0.0
        self._target: Target | None = None
        self._time_s = 0.0
        self._truth: Pose | None = None
        self._believed: Pose | None = None

    @property
    def truth(self) -> Pose:
        """Where it really is."""
        if self._truth is None:
            self._truth = self._pose(self._motion, self._heading_rad, self._parts.gimbal.pitch_rad, 0.0)
        return self._truth

    @property
    def estimate(self) -> Pose:
        """Where the autopilot's estimator says it is; `truth` itself where nothing errs."""
        if not self._parts.errors:
            return self.truth
        if self._believed is None:
            true = self.truth
            self._believed = Pose(
                true.time_s,
                self._held(self._motion, 0.0),
                true.velocity_enu_m_s,
                true.heading_rad,
                true.pitch_rad,
                true.roll_rad,
                true.gimbal_pitch_rad,
                true.gimbal_heading_rad,
                true.yaw_rate_rad_s,
            )
        return self._believed

    @property
    def fix(self) -> Fix:
        """State of the GNSS receiver."""
        return self._parts.receiver.fix

    @property
    def battery(self) -> Battery:
        """State of the battery."""
        return self._parts.pack.state

    @property
    def wind_enu_m_s(self) -> Vec3:
        """Wind that blows towards this direction."""
        return NOWHERE if self._parts.air is None else self._parts.air.wind_enu_m_s

    def step(self, duration_s: float, target: Target) -> None:
        """Fly on for a time of any length.

        Raises
        ------
        ValueError
            The duration is negative or not finite, or the target asks for something that is not finite or a speed
            that is not positive.
        """
        if not (math.isfinite(duration_s) and duration_s >= 0.0):
            raise ValueError(f"duration_s: expected 0 or more seconds, got {duration_s}")
        if not math.isfinite(target.heading_rad + target.gimbal_pitch_rad) or not target.yaw_rate_rad_s >= 0.0:
            raise ValueError(f"target: expected finite angles and a rate of 0 or more, got {target}")
        self._target = target
        if target.motors_on:
            self._fly(duration_s, target)
        else:
            self._fall(duration_s)
        self._turn(duration_s, target)
        self._time_s += duration_s
        parts = self._parts
        flies = target.motors_on and not self._stands
        parts.gimbal.step(duration_s, self._gimbal_goal_rad(target))
        if parts.air is not None:
            parts.air.step(duration_s, flies=flies)
        for error in parts.errors:
            error.step(duration_s, self._motion[0], flies=flies)
        parts.pack.step(duration_s, self._motion[1], self.wind_enu_m_s, motors_on=target.motors_on)
        self._truth = self._believed = None

    def shutter(self) -> tuple[Pose, float]:
        """True pose of the camera at the middle of an exposure that is asked for now, and the exposure's length."""
        parts, target = self._parts, self._target
        ahead_s = parts.latency_s + 0.5 * parts.exposure_s
        if ahead_s == 0.0 or target is None:
            return self.truth, parts.exposure_s
        motion = self._trajectory.at(self._leg_s + ahead_s) if target.motors_on else self._motion
        heading_rad = self._heading_after(ahead_s, target)
        pitch_rad = parts.gimbal.ahead_rad(ahead_s, self._gimbal_goal_rad(target))
        return self._pose(motion, heading_rad, pitch_rad, ahead_s), parts.exposure_s

    @property
    def _stands(self) -> bool:
        """On the ground and at rest."""
        x, y, z = self._motion[0]
        return z <= self._ground_z_m(x, y) and self._motion[1] == NOWHERE

    def _fly(self, duration_s: float, target: Target) -> None:
        """Follow the trajectory to the target, planned anew where the target has changed."""
        self._steer(target)
        goal = self._goal(target)
        left_s = duration_s
        while self._leg_s + left_s > self._trajectory.end_s:
            left_s -= self._trajectory.end_s - self._leg_s
            self._leg_s = self._trajectory.end_s
            self._motion = self._trajectory.at(self._leg_s)
            if self._motion[0] == goal:
                break
            # It had to stop first, or passed and nothing followed: the leg from here ends at the target.
            self._plan(target, passes=False)
        self._leg_s += left_s
        self._motion = self._trajectory.at(self._leg_s)

    def _goal(self, target: Target) -> Vec3:
        """Place of a target; none lies in the ground."""
        x, y, z = target.position_enu_m
        return x, y, max(z, self._ground_z_m(x, y))

    def _steer(self, target: Target) -> None:
        speeds = target.horizontal_m_s, target.ascent_m_s, target.descent_m_s
        wanted = target.position_enu_m, speeds, target.passes
        if wanted != self._steered:
            self._plan(target, passes=target.passes)
            self._steered = wanted

    def _plan(self, target: Target, *, passes: bool) -> None:
        limits, goal, here = self._limits, self._goal(target), self._motion[0]
        level_m_s = min(target.horizontal_m_s, limits.horizontal_m_s)
        course = goal[0] - here[0], goal[1] - here[1], 0.0
        if self._parts.air is not None and (course[0] or course[1]):
            level_m_s = self._parts.air.ground_speed_m_s(course, level_m_s)
        speeds = level_m_s, min(target.ascent_m_s, limits.ascent_m_s), min(target.descent_m_s, limits.descent_m_s)
        self._trajectory = plan_trajectory(
            self._motion, goal, speeds, limits.acceleration_m_s2, limits.jerk_m_s3, passes=passes
        )
        self._leg_s = 0.0

    def _fall(self, duration_s: float) -> None:
        """Without motors: stand on the ground, or fall there; without drag in one step, which is exact."""
        has_drag = self._parts.fall_drag_per_m > 0.0
        left_s = duration_s
        while True:
            step_s = min(left_s, FALL_STEP_S) if has_drag else left_s
            self._drop(step_s, self._mean_pull_m_s2(step_s) if has_drag else (0.0, 0.0, -GRAVITY_M_S2))
            left_s -= step_s
            if left_s <= 0.0 or self._stands:
                break
        self._trajectory, self._leg_s, self._steered = resting(self._motion[0]), 0.0, None

    def _drop(self, duration_s: float, pull_m_s2: Vec3) -> None:
        """Move with an acceleration that stays, as far as the ground."""
        (x, y, z), (vx, vy, vz), _ = self._motion
        ax, ay, az = pull_m_s2
        ground_z_m = self._ground_z_m(x, y)
        height_m = max(0.0, z - ground_z_m)
        root = math.sqrt(max(0.0, vz * vz - 2.0 * az * height_m))
        # Drag brakes a fall that began faster than it can keep on, so that az may point up.
        ground_s = (vz + root) / -az if az < 0.0 else 2.0 * height_m / max(root - vz, TINY_M_S)
        t = min(duration_s, ground_s)
        place = x + t * (vx + 0.5 * ax * t), y + t * (vy + 0.5 * ay * t), z + t * (vz + 0.5 * az * t)
        if ground_s <= duration_s:
            self._motion = (place[0], place[1], ground_z_m), NOWHERE, NOWHERE
        else:
            self._motion = place, (vx + ax * t, vy + ay * t, vz + az * t), NOWHERE

    def _mean_pull_m_s2(self, duration_s: float) -> Vec3:
        """Gravity, and quadratic drag against the wind of now, in the middle of a step (midpoint rule)."""
        pull = 0.0, 0.0, 0.0
        for half_s in (0.0, 0.5 * duration_s):
            ux, uy, uz = (v + half_s * a - w for v, a, w in zip(self._motion[1], pull, self.wind_enu_m_s, strict=True))
            drag = self._parts.fall_drag_per_m * math.hypot(ux, uy, uz)
            pull = -drag * ux, -drag * uy, -drag * uz - GRAVITY_M_S2
        return pull

    def _turn(self, duration_s: float, target: Target) -> None:
        before_rad = self._heading_rad
        self._heading_rad = self._heading_after(duration_s, target)
        turned_rad = _shortest(before_rad, self._heading_rad)
        self._yaw_rate_rad_s = turned_rad / duration_s if duration_s > 0.0 else 0.0

    def _heading_after(self, duration_s: float, target: Target) -> float:
        """Heading some time later, in (-pi, pi]; a half turn goes clockwise."""
        if not target.motors_on:
            return self._heading_rad
        rate_rad_s = min(target.yaw_rate_rad_s, self._limits.yaw_rate_rad_s)
        left_rad = _shortest(self._heading_rad, target.heading_rad)
        most_rad = rate_rad_s * duration_s
        if abs(left_rad) <= most_rad:
            return _wrapped(target.heading_rad)
        return _wrapped(self._heading_rad + math.copysign(most_rad, left_rad))

    def _gimbal_goal_rad(self, target: Target) -> float:
        low, high = self._gimbal_pitch_rad
        return min(max(target.gimbal_pitch_rad, low), high)

    def _held(self, motion: State, ahead_s: float) -> Vec3:
        """Where the aircraft is in the autopilot's eyes: on its trajectory but for what the wind pushes it off."""
        air = self._parts.air
        if air is None:
            return motion[0]
        (x, y, z), (ox, oy, oz), (vx, vy, vz) = motion[0], air.offset_enu_m, air.offset_velocity_enu_m_s
        return x + ox + ahead_s * vx, y + oy + ahead_s * vy, z + oz + ahead_s * vz

    def _pose(self, motion: State, heading_rad: float, gimbal_pitch_rad: float, ahead_s: float) -> Pose:
        """True pose for a motion of the trajectory, `ahead_s` after now."""
        parts, velocity, push = self._parts, motion[1], motion[2]
        x, y, z = self._held(motion, ahead_s)
        for error in parts.errors:
            ex, ey, ez = error.offset_enu_m
            x, y, z = x - ex, y - ey, z - ez
        if parts.air is not None:
            dx, dy, dz = parts.air.drag_enu_m_s2(velocity)
            push = push[0] - dx, push[1] - dy, push[2] - dz
            ox, oy, oz = parts.air.offset_velocity_enu_m_s
            velocity = velocity[0] + ox, velocity[1] + oy, velocity[2] + oz
        pitch_rad, roll_rad = (0.0, 0.0) if self._stands else _tilt(push, heading_rad)
        return Pose(
            self._time_s + ahead_s,
            (x, y, max(z, self._ground_z_m(x, y))),
            velocity,
            heading_rad,
            pitch_rad,
            roll_rad,
            gimbal_pitch_rad,
            heading_rad,
            self._yaw_rate_rad_s,
        )


def _wrapped(angle_rad: float) -> float:
    """Same angle in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, 2.0 * math.pi)
    return math.pi if wrapped <= -math.pi else wrapped


def _shortest(from_rad: float, to_rad: float) -> float:
    """Shortest signed turn, in (-pi, pi]."""
    return _wrapped(to_rad - from_rad)


def _tilt(push_enu_m_s2: Vec3, heading_rad: float) -> tuple[float, float]:
    """Pitch (nose up) and roll (right side down) whose thrust gives an acceleration besides carrying the weight."""
    east, north, up = push_enu_m_s2
    sin_h, cos_h = math.sin(heading_rad), math.cos(heading_rad)
    forward, right = east * sin_h + north * cos_h, east * cos_h - north * sin_h
    lift = max(GRAVITY_M_S2 + up, 0.1 * GRAVITY_M_S2)
    return -math.atan2(forward, lift), math.atan2(right, math.hypot(forward, lift))
