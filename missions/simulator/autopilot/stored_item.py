"""A mission item as a vehicle keeps it: what it takes of what was sent, and what it therefore answers on read-back.

ArduPilot keeps each command in a record of its own shape: holds as whole seconds, heights in centimetres, some numbers
as whole ones, others not at all. PX4 keeps floats, but takes commands without a position only in frame 2.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.messages import MissionItem, MissionItemInt
from missions.simulator.autopilot.profiles import vehicle_profile

MISSION, FENCE, RALLY, ALL_TYPES = 0, 1, 2, 255
"""MAV_MISSION_TYPE."""

DEGREES_E7 = 1e7
MAX_HEIGHT_M = 83_000.0
"""ArduPilot's LOCATION_ALT_MAX_M: higher ones do not fit its record; 40 000 m are accepted."""

WITH_POSITION = frozenset((16, 17, 18, 19, 21, 22, 30, 31, 80, 82, 84, 85, 94, 179, 189, 195, 201, 4501))
"""Commands whose x, y and z are a position, also those where it may be left out."""

FENCE_COMMANDS = frozenset((5000, 5001, 5002, 5003, 5004))
RALLY_COMMANDS = frozenset((5100,))
NAN_ALLOWED = {16: (3,), 21: (3,), 22: (3,), 84: (2, 3), 85: (2, 3)}
"""Indices of params that ArduPilot lets be NaN."""

SAME_FRAME = {0: 0, 2: 0, 3: 3, 5: 0, 6: 3, 10: 10, 11: 10}
"""ArduPilot's frames on read-back."""

POSITION_FREE = frozenset((115, 178, 205, 206, 1000, 2000, 2001, 93, 112, 114, 177))
"""Commands of which ArduPilot keeps none of x, y and z; of the gimbal's 1000 it keeps x and z."""


class Refused(Exception):  # noqa: N818  (it is an answer, not a failure)
    """The vehicle does not take an item; `result` is the MAV_MISSION_RESULT that it answers."""

    def __init__(self, result: int) -> None:
        super().__init__(f"MAV_MISSION_RESULT {result}")
        self.result = result


@dataclass(frozen=True, slots=True)
class StoredItem:
    """One item in the vehicle's memory; fields as in MISSION_ITEM_INT."""

    command: int
    frame: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    autocontinue: int = 1

    @property
    def params(self) -> tuple[float, float, float, float]:
        """Params 1 to 4."""
        return self.param1, self.param2, self.param3, self.param4

    @property
    def has_place(self) -> bool:
        """Whether it names a place; latitude and longitude 0 mean "here"."""
        return self.command in WITH_POSITION and (self.x, self.y) != (0, 0)


def stored(message: MissionItemInt, autopilot: Autopilot) -> StoredItem:
    """What a vehicle keeps of an item.

    Raises
    ------
    Refused
        It does not take the item.
    """
    item = StoredItem(
        message.command,
        message.frame,
        float32(message.param1),
        float32(message.param2),
        float32(message.param3),
        float32(message.param4),
        message.x,
        message.y,
        float32(message.z),
        message.autocontinue,
    )
    if message.mission_type != MISSION:
        return _stored_place(item, FENCE_COMMANDS if message.mission_type == FENCE else RALLY_COMMANDS)
    return _stored_by_ardupilot(item) if autopilot is Autopilot.ARDUPILOT else _stored_by_px4(item)


def from_float_item(message: MissionItem) -> MissionItemInt:
    """The deprecated MISSION_ITEM as a MISSION_ITEM_INT; its float32 degrees are up to a metre off.

    Raises
    ------
    Refused
        A coordinate is not finite, or not on the globe.
    """
    is_place = message.command in WITH_POSITION | FENCE_COMMANDS | RALLY_COMMANDS
    scale = DEGREES_E7 if is_place else 1.0
    whole = []
    for value, limit, result in (
        (message.x, 90.0, mavlink.MAV_MISSION_INVALID_PARAM5_X),
        (message.y, 180.0, mavlink.MAV_MISSION_INVALID_PARAM6_Y),
    ):
        value = 0.0 if math.isnan(value) and not is_place else value
        if not math.isfinite(value) or abs(value) > (limit if is_place else 2**31 - 1):
            raise Refused(result)
        whole.append(int(float32(value) * scale))
    fields = {name: getattr(message, name) for name in MissionItem.__dataclass_fields__ if name not in ("x", "y")}
    return MissionItemInt(**fields, x=whole[0], y=whole[1])


def to_wire(item: StoredItem, seq: int, is_current: bool, mission_type: int) -> MissionItemInt:
    """The item as the vehicle sends it; the addressee is filled in by whoever sends it."""
    return MissionItemInt(
        0, 0, seq, item.frame, item.command, int(is_current), item.autocontinue, *item.params, item.x, item.y, item.z,
        mission_type,
    )  # fmt: skip


def to_float_wire(item: MissionItemInt) -> MissionItem:
    """The same item in the deprecated message."""
    is_place = item.command in WITH_POSITION | FENCE_COMMANDS | RALLY_COMMANDS
    scale = 1.0 / DEGREES_E7 if is_place else 1.0
    fields = {name: getattr(item, name) for name in MissionItemInt.__dataclass_fields__ if name not in ("x", "y")}
    return MissionItem(**fields, x=float32(item.x * scale), y=float32(item.y * scale))


def _stored_by_ardupilot(item: StoredItem) -> StoredItem:
    known = facts(Autopilot.ARDUPILOT)
    if item.command not in known.commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    for index, value in enumerate(item.params):
        if math.isnan(value) and index not in NAN_ALLOWED.get(item.command, ()):
            raise Refused(mavlink.MAV_MISSION_INVALID_PARAM1 + index)
    if not math.isfinite(item.z):
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM7)
    keeps = vehicle_profile(Autopilot.ARDUPILOT).keeps.get(str(item.command), "ffff")
    p1, p2, p3, p4 = (_KEEP[letter](value) for letter, value in zip(keeps, item.params, strict=True))
    kept = replace(item, param1=p1, param2=p2, param3=p3, param4=p4, autocontinue=1)
    if item.command in WITH_POSITION:
        if item.frame not in known.position_frames:
            raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
        _check_on_globe(item)
        if abs(item.z) >= MAX_HEIGHT_M:
            raise Refused(mavlink.MAV_MISSION_INVALID_PARAM7)
        # A whole number of centimetres, cut off, not rounded.
        height_m = float32(int(float32(item.z * 100.0)) / 100.0)
        return replace(kept, frame=SAME_FRAME[item.frame], z=height_m)
    kept = replace(kept, frame=0)
    if item.command == mavlink.MAV_CMD_DO_DIGICAM_CONTROL:
        return replace(kept, x=item.x & 0xFF, y=item.y & 0xFF, z=0.0)
    if item.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
        return replace(kept, y=0, z=float(int(item.z)))
    return replace(kept, x=0, y=0, z=0.0) if item.command in POSITION_FREE else kept


def _stored_by_px4(item: StoredItem) -> StoredItem:
    known = facts(Autopilot.PX4)
    if item.frame in (10, 11):
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    may_have_place = item.command in WITH_POSITION
    needs_place = may_have_place and item.command not in (179, 189, 195, 201)
    if item.command not in known.commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame == mavlink.MAV_FRAME_MISSION:
        if needs_place:
            raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
        return item
    if item.frame not in known.position_frames or not may_have_place:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    # On read-back PX4 names the frames of the integer message.
    return replace(item, frame=5 if item.frame in (0, 5) else 6)


def _stored_place(item: StoredItem, commands: frozenset[int]) -> StoredItem:
    """Corners of a fence and rally points, the same for both autopilots."""
    if item.command not in commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame not in (0, 3, 5, 6):
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    _check_on_globe(item)
    return replace(item, frame=0 if item.frame in (0, 5) else 3)


def _check_on_globe(item: StoredItem) -> None:
    if abs(item.x) > 90.0 * DEGREES_E7:
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if abs(item.y) > 180.0 * DEGREES_E7:
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM6_Y)


def float32(value: float) -> float:
    """What a number is after it went over the wire."""
    try:
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)


def _whole(value: float) -> float:
    return float(math.trunc(value)) if math.isfinite(value) else 0.0


_KEEP: dict[str, Callable[[float], float]] = {
    "f": lambda value: value,
    "i": _whole,
    "u": lambda value: min(max(_whole(value), 0.0), 65535.0),
    "s": lambda value: -1.0 if value < 0.0 else 1.0,
    "-": lambda value: 0.0,
}
