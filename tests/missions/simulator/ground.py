"""A ground station and an airframe for tests of the simulated vehicle, both as simple as they can be."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import MissionItem as PlannedItem
from missions.mavlink.messages import (
    CommandAck,
    CommandLong,
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionItemReached,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    Received,
    Statustext,
)
from missions.simulator.airframe.state import Battery, Fix, Pose, Target
from missions.simulator.autopilot.mission_store import WITH_POSITION
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin, Vec3

ORIGIN = Origin(22.3372, 114.2636, 62.0)
HOME: Vec3 = (0.0, 0.0, 0.0)
ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4
GUIDED, AUTO = 4, 3


def towards(value: float, goal: float, most: float) -> float:
    return goal if abs(goal - value) <= most else value + math.copysign(most, goal - value)


class PointMass:
    """Accelerates and brakes with 2.5 m/s2, turns at its rate, stands on level ground at home; nothing errs."""

    acceleration_m_s2 = 2.5
    gimbal_rate_rad_s = math.radians(120.0)

    def __init__(self, home: Vec3 = HOME, heading_rad: float = 0.0) -> None:
        self.position, self.velocity = home, (0.0, 0.0, 0.0)
        self.ground_z, self.time_s = home[2], 0.0
        self.heading, self.tilt = heading_rad, 0.0
        self.remaining = 1.0
        self.fix = Fix(6, 20, 0.01, 0.02)
        self.wind_enu_m_s: Vec3 = (0.0, 0.0, 0.0)
        self._pose: Pose | None = None

    @property
    def truth(self) -> Pose:
        if self._pose is None:
            self._pose = Pose(
                self.time_s, self.position, self.velocity, self.heading, 0.0, 0.0, self.tilt, self.heading
            )  # fmt: skip
        return self._pose

    estimate = truth

    @property
    def battery(self) -> Battery:
        return Battery(15.2, 10.0, 3300.0 * (1.0 - self.remaining), self.remaining)

    def shutter(self) -> tuple[Pose, float]:
        return self.truth, 0.001

    def step(self, duration_s: float, target: Target) -> None:
        self.time_s += duration_s
        self._pose = None
        if not target.motors_on:
            self.velocity = (0.0, 0.0, 0.0)
            return
        x, y, z = target.position_enu_m
        goal = (x, y, max(z, self.ground_z))
        way = [b - a for a, b in zip(self.position, goal, strict=True)]
        length = math.hypot(*way)
        level, up = math.hypot(way[0], way[1]), way[2]
        if length < 0.005 and math.hypot(*self.velocity) < 0.2:
            self.position, self.velocity = goal, (0.0, 0.0, 0.0)
        else:
            vertical = target.ascent_m_s if up > 0.0 else target.descent_m_s
            slowness = max(level / target.horizontal_m_s, abs(up) / vertical)
            fastest = length / slowness if slowness else 1.0
            # Who need not stop at the goal must be able to stop 2 m behind it.
            room = length + 2.0 if target.passes else length
            braking = math.sqrt(2.0 * self.acceleration_m_s2 * room) * 0.95
            speed = min(fastest, braking, length / duration_s)
            most = self.acceleration_m_s2 * duration_s
            wanted = [speed * part / length if length else 0.0 for part in way]
            change = [b - a for a, b in zip(self.velocity, wanted, strict=True)]
            size = math.hypot(*change)
            share = 1.0 if size <= most else most / size
            velocity = [a + share * b for a, b in zip(self.velocity, change, strict=True)]
            self.position = tuple(a + duration_s * b for a, b in zip(self.position, velocity, strict=True))
            self.velocity = tuple(velocity)
            if self.position[2] < self.ground_z:
                self.position = (*self.position[:2], self.ground_z)
                self.velocity = (0.0, 0.0, 0.0)
        turn = math.remainder(target.heading_rad - self.heading, 2.0 * math.pi)
        self.heading = self.heading + towards(0.0, turn, target.yaw_rate_rad_s * duration_s)
        self.tilt = towards(self.tilt, target.gimbal_pitch_rad, self.gimbal_rate_rad_s * duration_s)


def item(command: int, *params: float, frame: int = 3, mission_type: int = 0) -> MissionItemInt:
    """An item without place: params 1 to 7, of which 5 and 6 are raw."""
    p = (*params, *(0.0,) * (7 - len(params)))
    return MissionItemInt(1, 1, 0, frame, command, 0, 1, *p[:4], int(p[4]), int(p[5]), p[6], mission_type)


def at(command: int, east: float, north: float, up: float, *params: float, frame: int = 3) -> MissionItemInt:
    """An item at a local place; `up` is above home."""
    p = (*params, *(0.0,) * (4 - len(params)))
    lat, lon, _ = geodetic_from_enu(ORIGIN, [(east, north, up)])
    return MissionItemInt(
        1, 1, 0, frame, command, 0, 1, *p, round(float(lat[0]) * 1e7), round(float(lon[0]) * 1e7), up
    )  # fmt: skip


def planned(items: Sequence[PlannedItem]) -> list[MissionItemInt]:
    """Items of our own missions as they go over the wire."""
    sent = []
    for each in items:
        scale = 1e7 if each.command in WITH_POSITION else 1.0
        p = each.params
        x, y = round(p[4] * scale), round(p[5] * scale)
        sent.append(MissionItemInt(1, 1, 0, each.frame, each.command, 0, 1, *p[:4], x, y, p[6]))
    return sent


class Ground:
    """Talks to one vehicle; `heard` is all that it said, `said` the texts."""

    def __init__(
        self,
        autopilot: Autopilot = ARDUPILOT,
        parameters: dict[str, float] | None = None,
        airframe: object = None,
        is_ready: bool = True,
        **kwargs: object,
    ) -> None:
        self.frame = PointMass() if airframe is None else airframe
        self.vehicle = SimulatedVehicle(
            autopilot, self.frame, kwargs.pop("origin", ORIGIN), parameters=parameters, is_ready=is_ready, **kwargs
        )  # fmt: skip
        self.link = DirectLink(self.vehicle)
        self.heard: list[Received] = []

    def next(self, timeout_s: float = 5.0) -> Message | None:
        received = self.link.receive(timeout_s)
        if received is None:
            return None
        self.heard.append(received)
        return received.message

    def wait(self, kind: type[Message], timeout_s: float = 20.0) -> Message:
        end_s = self.vehicle.now_s + timeout_s
        while self.vehicle.now_s < end_s:
            message = self.next(end_s - self.vehicle.now_s)
            if isinstance(message, kind):
                return message
        raise AssertionError(f"no {kind.__name__} in {timeout_s} s")

    def of(self, kind: type[Message]) -> list[Message]:
        return [each.message for each in self.heard if isinstance(each.message, kind)]

    @property
    def said(self) -> list[str]:
        return [text.text for text in self.of(Statustext)]

    @property
    def reached(self) -> list[int]:
        return [each.seq for each in self.of(MissionItemReached)]

    def command(self, command: int, *params: float) -> int:
        self.link.send(CommandLong(1, 1, command, *params))
        return self.wait(CommandAck).result

    def upload(self, items: Sequence[MissionItemInt], mission_type: int = 0) -> int:
        """Upload; ArduPilot's home is put before a mission."""
        from dataclasses import replace

        if self.vehicle.autopilot is ARDUPILOT and mission_type == 0:
            items = [item(16, frame=0), *items]
        items = [replace(each, seq=seq, mission_type=mission_type) for seq, each in enumerate(items)]
        self.link.send(MissionCount(1, 1, len(items), mission_type))
        while True:
            message = self.next(20.0)
            if isinstance(message, MissionRequest | MissionRequestInt):
                self.link.send(items[message.seq])
            elif isinstance(message, MissionAck):
                return message.type

    def download(self, mission_type: int = 0) -> list[MissionItemInt]:
        self.link.send(MissionRequestList(1, 1, mission_type))
        count = self.wait(MissionCount).count
        items = []
        for seq in range(count):
            self.link.send(MissionRequestInt(1, 1, seq, mission_type))
            items.append(self.wait(MissionItemInt))
        return items

    def take_off_with_mission(self) -> None:
        """As it must be done: ArduPilot is armed in GUIDED and told to start, PX4 starts at once."""
        if self.vehicle.autopilot is ARDUPILOT:
            assert [self.command(176, 1, GUIDED), self.command(400, 1), self.command(176, 1, AUTO)] == [0, 0, 0]
        assert self.command(300) == 0

    def until(self, condition: Callable[[], bool], limit_s: float = 600.0) -> None:
        end_s = self.vehicle.now_s + limit_s
        while not condition():
            assert self.vehicle.now_s < end_s, f"not within {limit_s} s; {self.said}"
            self.next(0.02)

    def fly(self, items: Sequence[MissionItemInt], limit_s: float = 1200.0) -> None:
        """Upload, start, and wait until the motors stop."""
        assert self.upload(items) == 0
        self.take_off_with_mission()
        self.until(lambda: not self.vehicle.modes.is_armed, limit_s)
