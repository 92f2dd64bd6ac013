"""All checks of MAVLink mission items, for the autopilot they are meant for.

What ArduPilot accepts and does was measured on ArduCopter 4.5.6 in its own simulation and read in AP_Mission; PX4's
rules are those of its sources of 2025. Where the autopilot is not known only what both demand is checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import MavlinkFile, MissionItem
from missions.mission.model import leg_lengths_m
from planning.base.findings import Finding, Severity
from planning.base.messages import say

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE

WITH_POSITION = frozenset((16, 17, 18, 19, 21, 22, 31, 82, 84, 85, 195, 4501))
"""Commands whose params 5 to 7 are always a position."""

WAYPOINTS = (mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT)
TRIGGERS = (mavlink.MAV_CMD_DO_DIGICAM_CONTROL, mavlink.MAV_CMD_IMAGE_START_CAPTURE)
CONDITIONS = (
    mavlink.MAV_CMD_CONDITION_YAW,
    mavlink.MAV_CMD_CONDITION_DELAY,
    mavlink.MAV_CMD_CONDITION_DISTANCE,
    mavlink.MAV_CMD_CONDITION_CHANGE_ALT,
)
AIMING = (
    mavlink.MAV_CMD_CONDITION_YAW,
    mavlink.MAV_CMD_DO_MOUNT_CONTROL,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
)
LAST_NAV_COMMAND = 95
"""MAV_CMD numbers up to here are navigation commands: the mission waits for each."""

MAX_HOLD_S = 65535.0
CLOSE_M = 0.5
NAN_ALLOWED = {16: (3,), 21: (3,), 22: (3,), 84: (2, 3), 85: (2, 3)}
"""Indices of params that ArduPilot lets be NaN."""


def check_items(file: MavlinkFile, autopilot: Autopilot | None) -> tuple[Finding, ...]:
    """All findings on the items of a mission; items are counted from 1, as home is not among them."""
    findings = [
        finding
        for number, item in enumerate(file.items, 1)
        for finding in (
            *_positions(item, say("item {}", number)),
            *_parameters(item, say("item {}", number), autopilot),
        )
    ]
    findings += _sequence(file.items, autopilot)
    findings += _legs(file)
    if autopilot is not None:
        n, limit = len(file.items) + (autopilot is Autopilot.ARDUPILOT), facts(autopilot).max_items
        if n > limit:
            severity = ERROR if autopilot is Autopilot.ARDUPILOT else WARNING
            text = say(
                "the mission has {} items, {} keeps {}; plan it with shorter sorties", n, autopilot.product, limit
            )
            findings.append(Finding(severity, "item-count", text, "", n, limit))
        for number, item in enumerate(file.items, 1):
            findings += _support(item, say("item {} (command {})", number, item.command), autopilot)
    return tuple(findings)


def _positions(item: MissionItem, place: str) -> Iterator[Finding]:
    if item.command not in WITH_POSITION:
        return
    lat_deg, lon_deg, altitude_m = item.params[4:]
    if abs(lat_deg) > 90.0 or abs(lon_deg) > 180.0:
        yield Finding(ERROR, "coordinates", say("the position {:g}, {:g} is not on the globe", lat_deg, lon_deg), place)
    elif (lat_deg, lon_deg) == (0.0, 0.0) and item.command in WAYPOINTS:
        text = say(
            "latitude and longitude are 0: ArduPilot takes that for the place where it is, PX4 for one off Africa"
        )
        yield Finding(WARNING, "coordinates", text, place)
    if not math.isfinite(altitude_m):
        yield Finding(ERROR, "height", say("the altitude is no number"), place)


def _parameters(item: MissionItem, place: str, autopilot: Autopilot | None) -> Iterator[Finding]:
    if item.command in WAYPOINTS and not 0.0 <= item.params[0] <= MAX_HOLD_S and not math.isnan(item.params[0]):
        yield Finding(ERROR, "hold", say("the hold time is out of range"), place, item.params[0], MAX_HOLD_S, "s")
    if item.command == mavlink.MAV_CMD_DO_DIGICAM_CONTROL and item.params[4] != 1.0:
        text = say("DO_DIGICAM_CONTROL releases the camera only where param 5 is 1: no photo here")
        yield Finding(WARNING, "no-trigger", text, place, item.params[4], 1.0)
    if autopilot is Autopilot.ARDUPILOT:
        yield from _ardupilot_parameters(item, place)


def _ardupilot_parameters(item: MissionItem, place: str) -> Iterator[Finding]:
    for index, value in enumerate(item.params):
        if math.isnan(value) and index not in NAN_ALLOWED.get(item.command, ()):
            yield Finding(ERROR, "nan", say("param {} is NaN, which ArduPilot refuses here", index + 1), place)
    if item.command in WAYPOINTS:
        hold_s, _, _, yaw_deg = item.params[:4]
        if math.isfinite(hold_s) and hold_s != math.floor(hold_s):
            text = say("ArduPilot stores whole seconds: the hold of {:g} s becomes {} s", hold_s, math.floor(hold_s))
            yield Finding(WARNING, "hold-truncated", text, place, hold_s, math.floor(hold_s), "s")
        if math.isfinite(yaw_deg) and yaw_deg != 0.0:
            text = say("ArduPilot ignores the yaw of a waypoint (param 4); use CONDITION_YAW before it")
            yield Finding(WARNING, "yaw-ignored", text, place, yaw_deg, None, "deg")
    if item.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
        angles = [angle for angle in item.params[:2] if math.isfinite(angle)]
        if any(angle != math.trunc(angle) for angle in angles):
            text = say("ArduPilot stores these angles in whole degrees; DO_MOUNT_CONTROL keeps the fraction")
            yield Finding(WARNING, "angle-truncated", text, place)


def _support(item: MissionItem, place: str, autopilot: Autopilot) -> Iterator[Finding]:
    known = facts(autopilot)
    name = autopilot.product
    if item.command in known.rejected or (autopilot is Autopilot.PX4 and item.command not in known.commands):
        yield Finding(
            ERROR, "unsupported-command", say("{} refuses this command in missions", name), place, item.command
        )
    elif item.command not in known.commands:
        text = say("whether {} takes this command in missions is not known", name)
        yield Finding(WARNING, "unknown-command", text, place, item.command)
    elif item.command in WITH_POSITION:
        if item.frame not in known.position_frames:
            frames = ", ".join(map(str, sorted(known.position_frames)))
            text = say("{} does not take the frame {} here; expected one of {}", name, item.frame, frames)
            yield Finding(ERROR, "unsupported-frame", text, place, item.frame)
        elif item.frame in (10, 11):
            text = say("the height counts from terrain: without terrain data ArduPilot does not arm")
            yield Finding(WARNING, "terrain-height", text, place)
    elif autopilot is Autopilot.PX4 and item.frame != mavlink.MAV_FRAME_MISSION and not _may_have_place(item):
        text = say("PX4 takes this command in frame 2 only, found frame {}", item.frame)
        yield Finding(ERROR, "unsupported-frame", text, place, item.frame)


def _may_have_place(item: MissionItem) -> bool:
    return item.command in (mavlink.MAV_CMD_NAV_ROI, mavlink.MAV_CMD_DO_SET_ROI)


def _sequence(items: Sequence[MissionItem], autopilot: Autopilot | None) -> Iterator[Finding]:
    navigation = [item for item in items if item.command <= LAST_NAV_COMMAND]
    if not navigation or navigation[0].command not in (mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_VTOL_TAKEOFF):
        text = say("the mission does not begin with a take-off: started on the ground it is refused")
        yield Finding(WARNING, "no-takeoff", text)
    kinds = {item.frame in (0, 5) for item in items if item.command in WAYPOINTS and item.frame in (0, 3, 5, 6)}
    if len(kinds) > 1:
        text = say("some waypoints count their height from take-off, others from sea level")
        yield Finding(WARNING, "mixed-heights", text)
    if autopilot is Autopilot.ARDUPILOT:
        yield from _ardupilot_order(items)


def _ardupilot_order(items: Sequence[MissionItem]) -> Iterator[Finding]:
    """What ArduPilot drops, or does while it already flies on, between two navigation commands."""
    condition = trigger = mount_yaw = False
    waypoint: MissionItem | None = None
    n_waiting = 0
    for number, item in enumerate(items, 1):
        place = say("item {}", number)
        if item.command <= LAST_NAV_COMMAND:
            condition = trigger = mount_yaw = False
            waypoint = item if item.command in WAYPOINTS else None
            n_waiting = 0
            continue
        n_waiting += 1
        if item.command in TRIGGERS:
            if condition:
                text = say(
                    "the photo waits for a CONDITION while the aircraft flies on: it is taken on the way, and "
                    "dropped without a word where the next waypoint is reached first; put the condition before the "
                    "waypoint"
                )
                yield Finding(WARNING, "dropped-do", text, place)
            if trigger:
                text = say("a second photo follows at once; within 0.1 s ArduPilot drops it; put a NAV_DELAY between")
                yield Finding(WARNING, "dropped-photo", text, place)
            if waypoint is not None and waypoint.params[0] < 1.0:
                text = say("the waypoint of this photo has no hold: the photo is taken in flight, about 1 m off")
                yield Finding(WARNING, "photo-in-flight", text, place)
            trigger = True
        elif trigger and item.command in AIMING:
            text = say("the camera turns on in the instant of the photo; put a NAV_DELAY behind the trigger")
            yield Finding(WARNING, "photo-while-turning", text, place)
        if item.command == mavlink.MAV_CMD_DO_MOUNT_CONTROL and mount_yaw:
            text = say("on a gimbal without pan axis this turns the vehicle to param 3; put it before CONDITION_YAW")
            yield Finding(WARNING, "mount-after-yaw", text, place)
        condition |= item.command in CONDITIONS
        mount_yaw |= item.command == mavlink.MAV_CMD_CONDITION_YAW
    if n_waiting:
        text = say("the last {} items follow the last navigation command and may never be done", n_waiting)
        yield Finding(WARNING, "after-the-end", text)


def _legs(file: MavlinkFile) -> Iterator[Finding]:
    """Waypoints so close together that the acceptance radius of the next already holds the one before."""
    numbered = [(number, item) for number, item in enumerate(file.items, 1) if item.command in WAYPOINTS]
    placed = [(n, i) for n, i in numbered if abs(i.params[4]) <= 90.0 and abs(i.params[5]) <= 180.0]
    placed = [(n, i) for n, i in placed if math.isfinite(i.params[6])]
    lengths_m = leg_lengths_m(*([item.params[k] for _, item in placed] for k in (4, 5, 6)))
    for (before, first), (after, second), length_m in zip(placed, placed[1:], lengths_m, strict=False):
        radius_m = max(CLOSE_M, second.params[1] if math.isfinite(second.params[1]) else 0.0)
        if first.frame == second.frame and 0.0 < length_m < radius_m:
            text = say("the waypoints are closer together than the vehicle tells apart")
            yield Finding(NOTE, "spacing", text, say("items {} and {}", before, after), float(length_m), radius_m, "m")
