"""What the simulated autopilot wants of its airframe, and what it gets to know of it.

The autopilot (`vehicle.py`) sees the airframe only as `believed`; photos are taken where it truly is (`truth`).
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
    def believed(self) -> Pose:
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
