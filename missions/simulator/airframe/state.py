"""What the simulated autopilot wants of its airframe, what it gets to know of it, and the parts of the airframe.

The autopilot (`vehicle.py`) sees the airframe only as `estimate`; photos are taken where it truly is (`truth`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from planning.geo.frames import Vec3


@dataclass(frozen=True, slots=True)
class Target:
    """Where the autopilot steers, from now on.

    Parameters
    ----------
    position_enu_m
        To be reached, as the autopilot believes positions.
    horizontal_m_s, ascent_m_s, descent_m_s
        Highest speeds on the way.
    heading_rad
        For the nose, clockwise from north.
    yaw_rate_rad_s
        Highest rate of turn.
    gimbal_pitch_rad
        For the camera: 0 level, negative down.
    passes
        Do not brake for the position: another one follows at once (ArduPilot's "fast waypoint").
    motors_on
        False: the aircraft stands on the ground, or falls.
    """

    position_enu_m: Vec3
    horizontal_m_s: float
    ascent_m_s: float
    descent_m_s: float
    heading_rad: float
    yaw_rate_rad_s: float
    gimbal_pitch_rad: float
    passes: bool = False
    motors_on: bool = True


@dataclass(frozen=True, slots=True)
class Pose:
    """Place and attitude at one time. Angles: heading clockwise from north, pitch nose up, roll right side down.

    The gimbal's pitch is against the horizon (0 level, negative down), its heading clockwise from north.
    """

    time_s: float
    position_enu_m: Vec3
    velocity_enu_m_s: Vec3
    heading_rad: float
    pitch_rad: float
    roll_rad: float
    gimbal_pitch_rad: float
    gimbal_heading_rad: float
    yaw_rate_rad_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Fix:
    """What the GNSS receiver says of itself: MAVLink's GPS_FIX_TYPE and accuracies, 1 sigma."""

    fix_type: int
    n_satellites: int
    horizontal_accuracy_m: float
    vertical_accuracy_m: float


@dataclass(frozen=True, slots=True)
class Battery:
    """What the battery monitor says."""

    voltage_v: float
    current_a: float
    consumed_mah: float
    remaining: float
    """From 1 full to 0 empty."""


class Airframe(Protocol):
    """The simulated body: moves towards its target, and knows the truth."""

    @property
    def truth(self) -> Pose:
        """Where it really is."""

    @property
    def estimate(self) -> Pose:
        """Where the autopilot's estimator says it is; the same object as `truth` where no effect errs."""

    @property
    def fix(self) -> Fix:
        """State of the GNSS receiver."""

    @property
    def battery(self) -> Battery:
        """State of the battery."""

    @property
    def wind_enu_m_s(self) -> Vec3:
        """Wind that blows towards this direction, as the autopilot estimates it."""

    def step(self, duration_s: float, target: Target) -> None:
        """Fly on for a time."""

    def shutter(self) -> tuple[Pose, float]:
        """Open the shutter now: the true pose of the camera at the middle of the exposure, and its length in seconds.

        With photo latency the pose is a little later than the command.
        """


# What a simulated multirotor is made of besides its trajectory, and the ideal form of each part.
#
# Effects put other parts in their place. A part that is not there is not asked: what is off costs nothing.


class Air(Protocol):
    """Wind: pushes the aircraft off the place that it holds, tilts it, and takes ground speed."""

    @property
    def wind_enu_m_s(self) -> Vec3:
        """Wind now, towards where it blows."""

    @property
    def offset_enu_m(self) -> Vec3:
        """From where the aircraft wants to be to where it is."""

    @property
    def offset_velocity_enu_m_s(self) -> Vec3:
        """How fast the offset changes."""

    def ground_speed_m_s(self, course_enu: Vec3, wanted_m_s: float) -> float:
        """Highest horizontal speed over the ground along a course (any length but level), at most `wanted_m_s`."""

    def drag_enu_m_s2(self, velocity_enu_m_s: Vec3) -> Vec3:
        """Acceleration by the air at a velocity over the ground; the aircraft tilts against it."""

    def step(self, duration_s: float, *, flies: bool) -> None:
        """Blow on for a time; an aircraft that stands on the ground is not pushed."""


class PositionError(Protocol):
    """Something that makes the autopilot believe to be where it is not."""

    @property
    def offset_enu_m(self) -> Vec3:
        """From where it is to where it believes to be."""

    def step(self, duration_s: float, position_enu_m: Vec3, *, flies: bool) -> None:
        """Let the error change for a time, at a true position."""


class Receiver(Protocol):
    """The GNSS receiver, as far as it knows of its errors."""

    @property
    def fix(self) -> Fix:
        """What the receiver says of itself."""


class Gimbal(Protocol):
    """Turns the camera up and down."""

    @property
    def pitch_rad(self) -> float:
        """Where the camera looks now, against the horizon."""

    def step(self, duration_s: float, wanted_rad: float) -> None:
        """Turn towards a pitch within the limits."""

    def ahead_rad(self, duration_s: float, wanted_rad: float) -> float:
        """Pitch after some more time."""


class Pack(Protocol):
    """The battery."""

    @property
    def state(self) -> Battery:
        """What its monitor says."""

    def step(self, duration_s: float, velocity_enu_m_s: Vec3, wind_enu_m_s: Vec3, *, motors_on: bool) -> None:
        """Draw power for a time."""


def towards(value: float, goal: float, most: float) -> float:
    """`value` moved towards `goal` by at most `most`."""
    return goal if abs(goal - value) <= most else value + (most if goal > value else -most)


@dataclass(frozen=True, slots=True)
class ExactReceiver:
    """A receiver whose error is too small to count; what it says of itself is what one of its kind says."""

    fix: Fix


class RateGimbal:
    """A gimbal that turns at its full rate from the start, as flight durations assume."""

    def __init__(self, rate_rad_s: float, pitch_rad: float = 0.0) -> None:
        self._rate_rad_s, self.pitch_rad = rate_rad_s, pitch_rad

    def step(self, duration_s: float, wanted_rad: float) -> None:
        """Turn towards a pitch."""
        self.pitch_rad = self.ahead_rad(duration_s, wanted_rad)

    def ahead_rad(self, duration_s: float, wanted_rad: float) -> float:
        """Pitch after some more time."""
        return towards(self.pitch_rad, wanted_rad, self._rate_rad_s * duration_s)


class SteadyPack:
    """A battery that is drawn evenly, so that it lasts the endurance, at its nominal voltage."""

    def __init__(self, capacity_mah: float, nominal_v: float, endurance_s: float) -> None:
        self._capacity_mah, self._nominal_v, self._endurance_s = capacity_mah, nominal_v, endurance_s
        self._used, self._motors_on = 0.0, False

    @property
    def state(self) -> Battery:
        """What its monitor says."""
        current_a = self._capacity_mah * 3.6 / self._endurance_s if self._motors_on else 0.0
        return Battery(self._nominal_v, current_a, self._used * self._capacity_mah, 1.0 - self._used)

    def step(self, duration_s: float, _velocity: Vec3, _wind: Vec3, *, motors_on: bool) -> None:
        """Draw power for a time."""
        self._motors_on = motors_on
        if motors_on:
            self._used = min(1.0, self._used + duration_s / self._endurance_s)


@dataclass(frozen=True, slots=True)
class Parts:
    """Everything that is put onto a trajectory to make an aircraft of it.

    Parameters
    ----------
    air, errors
        None and empty where no effect is on.
    receiver
        One of `errors`, or one without an error.
    latency_s
        From the command to the opening of the shutter.
    exposure_s
        How long the shutter is open.
    fall_drag_per_m
        Of a fall with motors off: deceleration over the square of the speed through the air. 0: falls without drag.
    """

    gimbal: Gimbal
    pack: Pack
    receiver: Receiver
    air: Air | None = None
    errors: tuple[PositionError, ...] = ()
    latency_s: float = 0.0
    exposure_s: float = 0.0
    fall_drag_per_m: float = 0.0
