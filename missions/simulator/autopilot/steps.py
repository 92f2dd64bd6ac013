"""The pieces that every flight is made of: fly somewhere, wait, turn, climb, touch down; run one after another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from missions.simulator.autopilot.guidance import Guidance
from planning.geo.frames import Vec3

ARRIVED_M = 0.3
ARRIVED_M_S = 0.15
"""Nearer and slower than this the aircraft is where it was sent: about when ArduPilot's trajectory to it ends."""

NEAR_M = 2.0
PATIENCE_S = 5.0
"""In gusts it may never be still: this long within ArduPilot's default WPNAV_RADIUS is enough."""

GROUND_DEPTH_M = 5.0
"""A landing aircraft is sent this far below the ground: it cannot know exactly where that is."""

STANDS_M_S = 0.05
LANDED_AFTER_S = 2.0
"""It has landed when it does not sink for all that; earlier than this it may not have begun to."""


class Step(Protocol):
    """One piece of a flight."""

    def start(self, guidance: Guidance) -> None:
        """Give the orders."""

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """Whether it is finished, `since_s` after its start; asked once for every control step."""


@dataclass(slots=True)
class FlyTo:
    """Fly to a place, given as such or by where the aircraft is when it sets off, and stop there.

    With `leave_m` it ends as soon as the place is that near, as waypoints without hold do; `passes` then says that the
    aircraft need not brake.
    """

    goal: Vec3 | Callable[[Vec3], Vec3]
    leave_m: float | None = None
    passes: bool = False
    _near_s: float = 0.0

    def start(self, guidance: Guidance) -> None:
        """Set off."""
        goal_enu_m = self.goal(guidance.here_enu_m) if callable(self.goal) else self.goal
        guidance.fly_to(goal_enu_m, passes=self.passes)

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """Arrived."""
        away_m = guidance.distance_m
        if self.leave_m is not None:
            return away_m <= self.leave_m
        if away_m > NEAR_M:
            self._near_s = since_s
            return False
        return (away_m <= ARRIVED_M and guidance.speed_m_s <= ARRIVED_M_S) or since_s - self._near_s >= PATIENCE_S


def climb(z_m: float) -> FlyTo:
    """Climb, or sink, straight to a height."""
    return FlyTo(lambda here: (here[0], here[1], z_m))


def climb_at_least(z_m: float) -> FlyTo:
    """Climb straight to a height, where the aircraft is not higher already."""
    return FlyTo(lambda here: (here[0], here[1], max(here[2], z_m)))


def fly_level(goal_enu_m: Vec3) -> FlyTo:
    """Fly at the present height to above or below a place."""
    return FlyTo(lambda here: (goal_enu_m[0], goal_enu_m[1], here[2]))


@dataclass(frozen=True, slots=True)
class Reach:
    """Fly to a place until it is near: what PX4 calls reached.

    `soonest_s` is how long PX4 takes for it, which brakes more gently than the airframe does.
    """

    goal_enu_m: Vec3
    radius_m: float
    height_m: float
    soonest_s: float = 0.0
    passes: bool = False

    def start(self, guidance: Guidance) -> None:
        """Set off, turning on the way."""
        guidance.fly_to(self.goal_enu_m, passes=self.passes)

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """Near, and at height."""
        (x, y, z), (gx, gy, gz) = guidance.here_enu_m, self.goal_enu_m
        is_near = math.hypot(gx - x, gy - y) <= self.radius_m and abs(gz - z) <= self.height_m
        return is_near and since_s >= self.soonest_s


@dataclass(frozen=True, slots=True)
class Stay:
    """Stay for a time, and until the nose stands right: PX4's hold, which does not wait for the nose to begin."""

    duration_s: float
    heading_rad: float | None
    tolerance_rad: float

    def start(self, guidance: Guidance) -> None:
        """Nothing to do."""

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """The time is up, and the nose is turned."""
        is_turned = self.heading_rad is None or guidance.turn_left_rad(self.heading_rad) <= self.tolerance_rad
        return is_turned and since_s >= self.duration_s - 1e-9


@dataclass(frozen=True, slots=True)
class Wait:
    """Stay for a time; infinite: for ever."""

    duration_s: float

    def start(self, guidance: Guidance) -> None:
        """Nothing to do."""

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """The time is up."""
        return since_s >= self.duration_s - 1e-9


@dataclass(frozen=True, slots=True)
class Sink:
    """Descend straight down to a height, at a speed; already below it nothing happens."""

    z_m: float
    speed_m_s: float

    def start(self, guidance: Guidance) -> None:
        """Begin to sink."""
        x, y, z = guidance.here_enu_m
        guidance.fly_to((x, y, min(z, self.z_m)), descent_m_s=self.speed_m_s)

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """At height; what remains of its speed is left to the touch-down that follows."""
        return guidance.distance_m <= ARRIVED_M


@dataclass(frozen=True, slots=True)
class TouchDown:
    """Descend straight down until the ground stops it."""

    ground_z_m: float
    speed_m_s: float

    def start(self, guidance: Guidance) -> None:
        """Begin to sink."""
        x, y, _ = guidance.here_enu_m
        guidance.fly_to((x, y, self.ground_z_m - GROUND_DEPTH_M), descent_m_s=self.speed_m_s)

    def is_done(self, guidance: Guidance, since_s: float) -> bool:
        """It sinks no more."""
        return since_s >= LANDED_AFTER_S and abs(guidance.airframe.estimate.velocity_enu_m_s[2]) <= STANDS_M_S


class StepRunner:
    """Runs steps one after another; `is_done` once the last is."""

    def __init__(self, steps: Sequence[Step], guidance: Guidance) -> None:
        self._steps, self._guidance = list(steps), guidance
        self._index = -1
        self._started_s = 0.0
        self._next()

    @property
    def is_done(self) -> bool:
        """Whether all steps are finished."""
        return self._index >= len(self._steps)

    @property
    def lands(self) -> bool:
        """Whether it is touching down, or has."""
        return isinstance(self._steps[min(self._index, len(self._steps) - 1)], TouchDown) if self._steps else False

    def update(self) -> bool:
        """Go on; True once all steps are finished."""
        while not self.is_done:
            if not self._steps[self._index].is_done(self._guidance, self._guidance.now_s - self._started_s):
                return False
            self._next()
        return True

    def _next(self) -> None:
        self._index += 1
        self._started_s = self._guidance.now_s
        if not self.is_done:
            self._steps[self._index].start(self._guidance)
