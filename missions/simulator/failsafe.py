"""What the vehicle does by itself: when its battery runs low, and when it is where its fence forbids to be."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.simulator.guidance import Guidance
from missions.simulator.mission_store import MissionStore
from missions.simulator.modes import FlightModes
from missions.simulator.parameters import ParameterTable
from missions.simulator.place import Place
from missions.simulator.profiles import Activity, VehicleProfile
from missions.simulator.stored_item import StoredItem
from planning.frames import Vec3

CHECK_S = 0.2
"""How often both are looked at."""

INCLUSION, EXCLUSION = (5001, 5003), (5002, 5004)
POLYGONS = (5001, 5002)

HEIGHT_FENCE, CIRCLE_FENCE, POLYGON_FENCE = 1, 2, 4
"""Bits of ArduPilot's FENCE_TYPE."""


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
    """Watches battery and fence; `say` takes the vehicle's texts: severity, text."""

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

    def update(self) -> None:
        """Look at both; called once for every control step."""
        now_s = self._guidance.now_s
        if now_s < self._next_s:
            return
        self._next_s = now_s + CHECK_S
        if self._modes.is_armed and not self._modes.is_landed:
            self._check_battery()
            self._check_fence()
        elif not self._modes.is_armed:
            self._battery_level, self._is_breached, self._modes.is_warned = 0, False, False

    def is_forbidden(self, position_enu_m: Vec3) -> bool:
        """Whether the fence forbids a place."""
        if self._revision != self._fence.revision:
            self._revision, self._zones = self._fence.revision, fence_zones(self._fence.items, self._place)
        x, y, z = position_enu_m
        home_x, home_y, home_z = self._place.home_enu_m
        above_m, away_m = z - home_z, math.hypot(x - home_x, y - home_y)
        values = self._parameters
        if self._autopilot is Autopilot.ARDUPILOT:
            if not values["FENCE_ENABLE"]:
                return False
            kinds = int(values["FENCE_TYPE"])
            highest_m = values["FENCE_ALT_MAX"] if kinds & HEIGHT_FENCE else math.inf
            farthest_m = values["FENCE_RADIUS"] if kinds & CIRCLE_FENCE else math.inf
            has_zones = bool(kinds & POLYGON_FENCE)
        else:
            highest_m = values["GF_MAX_VER_DIST"] or math.inf
            farthest_m = values["GF_MAX_HOR_DIST"] or math.inf
            has_zones = values["GF_ACTION"] > 0
        if above_m > highest_m or away_m > farthest_m:
            return True
        return has_zones and self._is_outside_zones(x, y)

    def _is_outside_zones(self, x: float, y: float) -> bool:
        """Inside a zone to keep out of, or outside all those to stay in."""
        wanted = [zone.holds(x, y) for zone in self._zones if zone.is_inclusion]
        return (bool(wanted) and not any(wanted)) or any(
            zone.holds(x, y) for zone in self._zones if not zone.is_inclusion
        )

    def _check_fence(self) -> None:
        was_breached, self._is_breached = self._is_breached, self.is_forbidden(self._guidance.here_enu_m)
        if not self._is_breached or was_breached:
            return
        is_ardupilot = self._autopilot is Autopilot.ARDUPILOT
        self._warn("Fence breached" if is_ardupilot else "Geofence violation")
        action = int(self._parameters["FENCE_ACTION" if is_ardupilot else "GF_ACTION"])
        self._act({1: "RTL", 2: "LAND", 4: "BRAKE"} if is_ardupilot else PX4_FENCE_ACTIONS, action)

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


PX4_FENCE_ACTIONS = {2: "AUTO.LOITER", 3: "AUTO.RTL", 5: "AUTO.LAND"}
"""GF_ACTION: 0 nothing, 1 a warning, 4 ends the flight, which is not simulated."""
