"""What the vehicle does by itself: its battery runs low, its fence forbids a place, its ground station falls silent.

ArduPilot's FENCE_MARGIN changes nothing in a mission: it holds where the pilot steers. Silence counts in the vehicle's
time: in a simulation that runs faster, the heartbeats of a ground station in real time come more rarely.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address
from missions.simulator.autopilot.guidance import Guidance, Place
from missions.simulator.autopilot.mission_store import MissionStore, StoredItem
from missions.simulator.autopilot.modes import FlightModes
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.profiles import Activity, VehicleProfile
from planning.geo.frames import Vec3

CHECK_S = 0.2
"""How often all are looked at."""

INCLUSION = (5001, 5003)
POLYGONS = (5001, 5002)

GROUND_STATION_SYSTEM = 255
"""ArduPilot's default SYSID_MYGCS: heartbeats of others do not count. PX4 takes those of any ground station."""

CONTINUE_MISSION, CONTINUE_LANDING = 2, 8
"""Bits of ArduPilot's FS_OPTIONS."""

AGAIN_M = 20.0
"""ArduPilot acts once more when it is so much farther outside its height or circle than where it acted last."""

GIVE_UP_M = 100.0
"""ArduPilot lands, whatever FENCE_ACTION says, farther outside its height or circle than this."""

HEIGHT_FENCE, CIRCLE_FENCE, POLYGON_FENCE = 1, 2, 4
"""Bits of ArduPilot's FENCE_TYPE."""

UNION_OF_INCLUSIONS = 2
"""Bit of ArduPilot's FENCE_OPTIONS: without it the vehicle must be inside of every area to stay in; PX4: of any."""


@dataclass(frozen=True, slots=True)
class FenceZone:
    """One zone of the fence in the local plane: a polygon, or a circle around its only point."""

    is_inclusion: bool
    corners_m: tuple[tuple[float, float], ...]
    radius_m: float = 0.0

    def holds(self, x: float, y: float) -> bool:
        """Whether a point is inside."""
        if self.radius_m > 0.0:
            return math.dist(self.corners_m[0], (x, y)) <= self.radius_m
        inside = False
        ax, ay = self.corners_m[-1]
        for bx, by in self.corners_m:
            if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
                inside = not inside
            ax, ay = bx, by
        return inside


def fence_zones(items: Sequence[StoredItem], place: Place) -> tuple[FenceZone, ...]:
    """Zones of a fence as it was uploaded: each polygon is a run of corners that all say how many they are."""
    zones: list[FenceZone] = []
    index = 0
    while index < len(items):
        item = items[index]
        count = max(1, int(item.param1)) if item.command in POLYGONS else 1
        run = items[index : index + count]
        corners = tuple(place.enu(corner.x, corner.y, 0.0, 3)[:2] for corner in run)
        if item.command in POLYGONS and len(run) >= 3:
            zones.append(FenceZone(item.command in INCLUSION, corners))
        elif item.command in (5003, 5004):
            zones.append(FenceZone(item.command in INCLUSION, corners, item.param1))
        index += count
    return tuple(zones)


class Failsafe:
    """Watches battery, fence and link; `say` takes the vehicle's texts: severity, text."""

    def __init__(
        self,
        autopilot: Autopilot,
        profile: VehicleProfile,
        guidance: Guidance,
        modes: FlightModes,
        parameters: ParameterTable,
        place: Place,
        fence: MissionStore,
        say: Callable[[int, str], None],
    ) -> None:
        self._autopilot, self._profile = autopilot, profile
        self._guidance, self._modes, self._parameters = guidance, modes, parameters
        self._place, self._fence, self._say = place, fence, say
        self._zones: tuple[FenceZone, ...] = ()
        self._revision = -1
        self._next_s = 0.0
        self._battery_level = 0
        self._is_breached = False
        self._again_m = 0.0
        self._heard_s: float | None = None
        self._is_alone = False

    def hear_heartbeat(self, source: Address) -> None:
        """A heartbeat came in."""
        if source.system == GROUND_STATION_SYSTEM:
            self._heard_s = self._guidance.now_s

    def update(self) -> None:
        """Look at all; called once for every control step."""
        now_s = self._guidance.now_s
        if now_s < self._next_s:
            return
        self._next_s = now_s + CHECK_S
        if self._modes.is_armed and not self._modes.is_landed:
            self._check_battery()
            self._check_fence()
            self._check_link()
        elif not self._modes.is_armed:
            self._battery_level, self._is_breached, self._is_alone = 0, False, False
            self._modes.is_warned = False

    def is_forbidden(self, position_enu_m: Vec3) -> bool:
        """Whether the fence forbids a place."""
        if self._revision != self._fence.revision:
            self._revision, self._zones = self._fence.revision, fence_zones(self._fence.items, self._place)
        return self._outside_m(position_enu_m) > 0.0 or self._is_outside_zones(*position_enu_m[:2])

    def _outside_m(self, position_enu_m: Vec3) -> float:
        """How far a place is above the fence's height or outside its circle; 0 and less where it is neither."""
        above_m = position_enu_m[2] - self._place.home_enu_m[2]
        away_m = math.dist(position_enu_m[:2], self._place.home_enu_m[:2])
        values = self._parameters
        if self._autopilot is Autopilot.ARDUPILOT:
            kinds = int(values["FENCE_TYPE"]) if values["FENCE_ENABLE"] else 0
            highest_m = values["FENCE_ALT_MAX"] if kinds & HEIGHT_FENCE else math.inf
            farthest_m = values["FENCE_RADIUS"] if kinds & CIRCLE_FENCE else math.inf
        else:
            highest_m = values["GF_MAX_VER_DIST"] or math.inf
            farthest_m = values["GF_MAX_HOR_DIST"] or math.inf
        return max(above_m - highest_m, away_m - farthest_m)

    def _is_outside_zones(self, x: float, y: float) -> bool:
        """Inside a zone to keep out of, or not inside those to stay in, where zones count."""
        values = self._parameters
        if self._autopilot is Autopilot.ARDUPILOT:
            counts = bool(values["FENCE_ENABLE"]) and bool(int(values["FENCE_TYPE"]) & POLYGON_FENCE)
            is_any_enough = bool(int(values["FENCE_OPTIONS"]) & UNION_OF_INCLUSIONS)
        else:
            counts, is_any_enough = values["GF_ACTION"] > 0, True
        if not counts:
            return False
        wanted = [zone.holds(x, y) for zone in self._zones if zone.is_inclusion]
        return (bool(wanted) and not (any(wanted) if is_any_enough else all(wanted))) or any(
            zone.holds(x, y) for zone in self._zones if not zone.is_inclusion
        )

    def _check_fence(self) -> None:
        here, is_ardupilot = self._guidance.here_enu_m, self._autopilot is Autopilot.ARDUPILOT
        was_breached, self._is_breached = self._is_breached, self.is_forbidden(here)
        outside_m = self._outside_m(here)
        is_farther = is_ardupilot and outside_m > self._again_m
        if not self._is_breached or (was_breached and not is_farther):
            return
        self._again_m = max(outside_m, 0.0) + AGAIN_M
        self._warn("Fence breached" if is_ardupilot else "Geofence violation")
        action = int(self._parameters["FENCE_ACTION" if is_ardupilot else "GF_ACTION"])
        if is_ardupilot and action > 0 and outside_m > GIVE_UP_M:
            action = ALWAYS_LAND
        self._act(ARDUPILOT_FENCE_ACTIONS if is_ardupilot else PX4_FENCE_ACTIONS, action)

    def _check_link(self) -> None:
        """The ground station's silence, once it was heard (ArduPilot), or since it took off (PX4)."""
        values, is_ardupilot = self._parameters, self._autopilot is Autopilot.ARDUPILOT
        action = int(values["FS_GCS_ENABLE" if is_ardupilot else "NAV_DLL_ACT"])
        if action == 0 or (is_ardupilot and self._heard_s is None):
            return
        limit_s = values["FS_GCS_TIMEOUT" if is_ardupilot else "COM_DL_LOSS_T"]
        was_alone = self._is_alone
        self._is_alone = self._guidance.now_s - (self._heard_s or 0.0) > limit_s
        if self._is_alone == was_alone:
            return
        if not self._is_alone:
            # The mode stays: the pilot decides how to go on.
            text = "GCS Failsafe Cleared" if is_ardupilot else "Connection to ground station regained"
            self._say(mavlink.MAV_SEVERITY_WARNING, text)
        elif is_ardupilot:
            self._link_lost_ardupilot(action, int(values["FS_OPTIONS"]))
        else:
            self._warn("Connection to ground station lost")
            is_excepted = self._modes.activity is Activity.MISSION and int(values["COM_DLL_EXCEPT"]) & EXCEPT_MISSION
            if not is_excepted:
                self._act(PX4_LINK_ACTIONS, action)

    def _link_lost_ardupilot(self, action: int, options: int) -> None:
        if self._modes.activity is Activity.LAND and options & CONTINUE_LANDING:
            self._warn("GCS Failsafe - Continuing Landing")
        elif self._modes.activity is Activity.MISSION and options & CONTINUE_MISSION:
            self._warn("GCS Failsafe - Continuing Auto Mode")
        else:
            self._warn("GCS Failsafe")
            self._act(ARDUPILOT_LINK_ACTIONS, action)

    def _check_battery(self) -> None:
        remaining, values = self._guidance.airframe.battery.remaining, self._parameters
        if self._autopilot is Autopilot.ARDUPILOT:
            capacity = values["BATT_CAPACITY"]
            low, critical = values["BATT_LOW_MAH"] / capacity, values["BATT_CRT_MAH"] / capacity
        else:
            low, critical = values["BAT_LOW_THR"], values["BAT_CRIT_THR"]
        level = 2 if remaining < critical else 1 if remaining < low else 0
        if level <= self._battery_level:
            return
        self._battery_level = level
        word = "critical" if level == 2 else "low"
        self._warn(f"Battery 1 is {word} {self._guidance.airframe.battery.voltage_v:.2f}V")
        if self._autopilot is Autopilot.ARDUPILOT:
            action = int(values["BATT_FS_CRT_ACT" if level == 2 else "BATT_FS_LOW_ACT"])
            self._act({1: "LAND", 2: "RTL", 3: "RTL", 4: "RTL"}, action)
        elif level == 2:
            # PX4 acts on the critical level: return, land, or return first and land when it is nearly empty.
            self._act({1: "AUTO.RTL", 2: "AUTO.LAND", 3: "AUTO.RTL"}, int(values["COM_LOW_BAT_ACT"]))

    def _warn(self, text: str) -> None:
        self._say(mavlink.MAV_SEVERITY_CRITICAL, text)
        self._modes.is_warned = True

    def _act(self, modes: dict[int, str], action: int) -> None:
        """Change to the mode of an action, but never out of a landing or, to return, out of a return."""
        mode = modes.get(action)
        if mode is None or self._modes.activity is Activity.LAND:
            return
        if self._modes.activity is Activity.RETURN and self._profile.modes[mode].activity is not Activity.LAND:
            return
        self._modes.set_mode(mode)


ARDUPILOT_FENCE_ACTIONS = {1: "RTL", 2: "LAND", 3: "RTL", 4: "BRAKE", 5: "LAND"}
"""FENCE_ACTION: 0 reports only; SmartRTL (3, 5) is not simulated, and what ArduPilot does where it cannot is."""

ALWAYS_LAND = 2

ARDUPILOT_LINK_ACTIONS = {1: "RTL", 2: "RTL", 3: "RTL", 4: "LAND", 5: "LAND", 6: "RTL", 7: "BRAKE"}
"""FS_GCS_ENABLE: as above for SmartRTL (3, 4); missions here have no landing sequence to go to (6)."""

PX4_LINK_ACTIONS = {1: "AUTO.LOITER", 2: "AUTO.RTL", 3: "AUTO.LAND"}
"""NAV_DLL_ACT: 5 and 6 end the flight, which is not simulated."""

EXCEPT_MISSION = 1
"""Bit of COM_DLL_EXCEPT: in a mission the silence of the ground station changes nothing."""

PX4_FENCE_ACTIONS = {2: "AUTO.LOITER", 3: "AUTO.RTL", 5: "AUTO.LAND"}
"""GF_ACTION: 0 nothing, 1 a warning, 4 ends the flight, which is not simulated."""
