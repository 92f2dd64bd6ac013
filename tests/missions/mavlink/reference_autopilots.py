"""Slow, independent models of how the two autopilots run a mission: where and how each photo is really taken.

ArduPilot (AP_Mission as measured on ArduCopter 4.5.6): when navigation command n completes, n+1 starts at once, and the
DO and CONDITION items between them run while it is being flown. A CONDITION blocks those after it until it holds. When
n+1 completes, what is left of them is dropped. Starting a waypoint turns the nose into the course, CONDITION_YAW turns
it elsewhere. Holds are whole seconds. The aircraft is at full speed at once, the worst case for all that must be
finished in time.

PX4: items run one after another; a waypoint is held from when its position is reached, and left when the hold is over
and the nose stands within MIS_YAW_ERR. The nose gains and loses speed with MPC_YAWRAUTO_ACC.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from missions.mavlink.items import MissionItem
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin

TAKEOFF, WAYPOINT, LAND, DELAY = 22, 16, 21, 93
YAW, MOUNT, GIMBAL, DIGICAM, CAPTURE, SPEED = 115, 205, 1000, 203, 2000, 178
NAVIGATION = (TAKEOFF, WAYPOINT, LAND, DELAY)


@dataclass
class Shot:
    """One photo: when, where (ENU metres), how fast the aircraft moved, and how the camera stood; angles in degrees."""

    t_s: float
    position: NDArray[np.float64]
    moving: bool
    heading: float
    pitch: float
    steady_for_s: float = math.inf
    """How long nothing was told to move after it."""


@dataclass
class Axis:
    """Something that turns to a target at a constant rate."""

    rate: float
    is_heading: bool
    angle: float
    target: float
    t_s: float = 0.0

    def difference(self, target: float) -> float:
        return (target - self.angle + 180.0) % 360.0 - 180.0 if self.is_heading else target - self.angle

    def at(self, t_s: float) -> float:
        self.advance(t_s)
        return self.angle

    def advance(self, t_s: float) -> None:
        turn = self.difference(self.target)
        step = self.rate * max(0.0, t_s - self.t_s)
        self.angle = self.target if abs(turn) <= step else self.angle + math.copysign(step, turn)
        self.t_s = max(t_s, self.t_s)

    def turn_to(self, target: float, t_s: float) -> None:
        self.advance(t_s)
        self.target = target

    def done_at(self) -> float:
        return self.t_s + abs(self.difference(self.target)) / self.rate


@dataclass
class ReferenceArduPilot:
    """Runs items; `two_axis` models a gimbal without pan axis, on which DO_MOUNT_CONTROL turns the vehicle."""

    origin: Origin
    home: tuple[float, float, float]
    two_axis: bool = False
    yaw_rate: float = 60.0
    gimbal_rate: float = 60.0
    speed: float = 10.0
    shots: list[Shot] = field(default_factory=list)
    n_dropped: int = 0

    def run(self, items: Sequence[MissionItem]) -> list[Shot]:
        self.t = 0.0
        self.yaw = Axis(self.yaw_rate, True, 123.0, 123.0)
        self.tilt = Axis(self.gimbal_rate, False, 0.0, 0.0)
        self.position = self.enu(*self.home)
        navigation = [i for i, item in enumerate(items) if item.command in NAVIGATION]
        start = 0
        for index in navigation:
            self.navigate(items[index], items[start:index])
            start = index + 1
        return self.shots

    def enu(self, lat: float, lon: float, above: float) -> NDArray[np.float64]:
        return enu_from_geodetic(self.origin, lat, lon, above)[0]

    def navigate(self, item: MissionItem, waiting: Sequence[MissionItem]) -> None:
        begin = self.t
        is_leg = item.command != DELAY
        start, end = self.position, self.position
        if is_leg:
            lat, lon, above = item.params[4:]
            end = self.enu(lat, lon, above + self.home[2])
            if item.command == WAYPOINT and np.linalg.norm((end - start)[:2]) > 0.01:
                self.told_to_move(begin)
                self.yaw.turn_to(math.degrees(math.atan2(end[0] - start[0], end[1] - start[1])), begin)
            arrival = begin + float(np.linalg.norm(end - start)) / self.speed
            hold = math.floor(item.params[0]) if item.command == WAYPOINT else 0
            complete = arrival + hold
        else:
            arrival, complete = begin, begin + item.params[0]
        self.run_waiting(list(waiting), begin, arrival, complete, start, end)
        if np.linalg.norm(end - start) > 0:
            self.told_to_move(begin)
        self.position, self.t = end, complete

    def run_waiting(
        self,
        waiting: list[MissionItem],
        begin: float,
        arrival: float,
        complete: float,
        start: NDArray[np.float64],
        end: NDArray[np.float64],
    ) -> None:
        now = begin
        for number, item in enumerate(waiting):
            if now > complete:
                self.n_dropped += sum(later.command in (DIGICAM, CAPTURE) for later in waiting[number:])
                return
            if item.command == MOUNT:
                self.told_to_move(now)
                self.tilt.turn_to(item.params[0], now)
                if self.two_axis:
                    self.yaw.turn_to(item.params[2], now)
            elif item.command == YAW:
                self.told_to_move(now)
                self.yaw.turn_to(item.params[0], now)
                now = max(now, self.yaw.done_at())
            elif item.command == DIGICAM and item.params[4] == 1.0:
                share = 1.0 if arrival <= begin else min(1.0, (now - begin) / (arrival - begin))
                place = start + share * (end - start)
                moving = now < arrival and float(np.linalg.norm(end - start)) > 1e-6 and now > begin
                self.shots.append(Shot(now, place, moving, self.yaw.at(now), self.tilt.at(now)))
            elif item.command == SPEED:
                self.speed = item.params[1]

    def told_to_move(self, t_s: float) -> None:
        for shot in self.shots:
            shot.steady_for_s = min(shot.steady_for_s, t_s - shot.t_s) if t_s >= shot.t_s else shot.steady_for_s


@dataclass
class Px4Twin:
    """Runs items of PX4; its gimbal turns while the aircraft flies, and only the last degrees of its yaw are not waited
    for. The acceleration of a turn is taken as time lost before it."""

    origin: Origin
    home: tuple[float, float, float]
    gimbal_rate: float = 60.0
    yaw_rate: float = 45.0
    yaw_acceleration: float = 20.0
    yaw_error: float = 12.0

    def run(self, items: Sequence[MissionItem]) -> list[Shot]:
        t, speed = 0.0, 5.0
        shots: list[Shot] = []
        yaw, tilt = Axis(self.yaw_rate, True, 123.0, 123.0), Axis(self.gimbal_rate, False, 0.0, 0.0)
        position = enu_from_geodetic(self.origin, *self.home)[0]
        has_control = False
        for item in items:
            if item.command == 1001:
                has_control = item.params[:2] == (-2.0, -2.0)
            elif item.command == SPEED:
                speed = item.params[1]
            elif item.command == GIMBAL:
                assert has_control
                assert item.frame == 2
                for shot in shots:
                    shot.steady_for_s = min(shot.steady_for_s, t - shot.t_s)
                tilt.turn_to(item.params[0], t)
            elif item.command in (TAKEOFF, WAYPOINT, LAND):
                lat, lon, above = item.params[4:]
                end = enu_from_geodetic(self.origin, lat, lon, above + self.home[2])[0]
                t_leg = float(np.linalg.norm(end - position)) / speed
                is_turning = item.command == WAYPOINT and abs(yaw.difference(item.params[3])) > 1e-9
                if t_leg > 1e-6 or is_turning:
                    for shot in shots:
                        shot.steady_for_s = min(shot.steady_for_s, t - shot.t_s)
                if is_turning:
                    turn = abs(yaw.difference(item.params[3]))
                    gaining = self.yaw_rate / self.yaw_acceleration
                    fast = turn / self.yaw_rate
                    yaw.turn_to(item.params[3], t)
                    yaw.t_s += gaining if fast >= gaining else 2.0 * math.sqrt(fast * gaining) - fast
                hold = item.params[0] if item.command == WAYPOINT else 0.0
                t = max(t + t_leg + hold, yaw.done_at() - self.yaw_error / self.yaw_rate)
                position = end
            elif item.command == CAPTURE and item.params[2] == 1.0:
                shots.append(Shot(t, position, False, yaw.at(t), tilt.at(t)))
        return shots
