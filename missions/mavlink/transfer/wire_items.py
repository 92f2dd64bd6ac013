"""Mission items to MISSION_ITEM_INT and back, as each autopilot counts and scales them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import ardupilotmega as dialect

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import WITH_POSITION
from missions.mavlink.items import MissionItem
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from planning.base.errors import MissionError
from planning.base.messages import say

SCALE = 1e7
LARGEST = 2**31 - 1

MAY_HAVE_POSITION = frozenset(number for number, entry in dialect.enums["MAV_CMD"].items() if entry.has_location)
"""Commands that the dialect gives a position; those in `WITH_POSITION` have one in every frame."""

HOME = MissionItemInt(0, 0, 0, dialect.MAV_FRAME_GLOBAL, dialect.MAV_CMD_NAV_WAYPOINT, 1, 1, 0, 0, 0, 0, 0, 0, 0)
"""Item 0 of an ArduPilot mission: a dummy, the vehicle writes its own home there."""


def has_place(command: int, frame: int) -> bool:
    """Whether x and y of an item are degrees times 1e7; otherwise they are params 5 and 6 as they stand.

    So DO_DIGICAM_CONTROL's x is 1: ArduPilot takes 10 000 000, stores 128, and the camera never fires.
    """
    return command in WITH_POSITION or (command in MAY_HAVE_POSITION and frame != dialect.MAV_FRAME_MISSION)


def has_home(autopilot: Autopilot, mission_type: MissionType) -> bool:
    """Whether item 0 is the vehicle's home."""
    return autopilot is Autopilot.ARDUPILOT and mission_type is MissionType.MISSION


def to_wire(
    items: Sequence[MissionItem], autopilot: Autopilot, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItemInt, ...]:
    """Messages of items, with home where the autopilot wants it; who they are for is filled in by `Upload`.

    Raises
    ------
    MissionError
        A value has no place in the message.
    """
    messages = [_message(item, say("item {}", number), mission_type) for number, item in enumerate(items, 1)]
    if has_home(autopilot, mission_type) and messages:
        messages.insert(0, HOME)
    return tuple(messages)


def _message(item: MissionItem, place: str, mission_type: MissionType) -> MissionItemInt:
    p1, p2, p3, p4, p5, p6, p7 = item.params
    scale = SCALE if has_place(item.command, item.frame) else 1.0
    x, y = _whole(p5 * scale, scale, f"{place}, param 5"), _whole(p6 * scale, scale, f"{place}, param 6")
    return MissionItemInt(0, 0, 0, item.frame, item.command, 0, 1, p1, p2, p3, p4, x, y, p7, mission_type)


def _whole(value: float, scale: float, place: str) -> int:
    if not abs(value) <= LARGEST or (scale == 1.0 and value != math.trunc(value)):
        kind = "degrees" if scale == SCALE else "a whole number"
        raise MissionError(f"{place} is {value / scale:g}, which has no place in MISSION_ITEM_INT; expected {kind}")
    return round(value)


def from_wire(
    messages: Sequence[MissionItemInt], autopilot: Autopilot, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItem, ...]:
    """Items of messages that were read back, without home."""
    flown = messages[1:] if has_home(autopilot, mission_type) else messages
    return tuple(_item(message) for message in flown)


def _item(message: MissionItemInt) -> MissionItem:
    scale = SCALE if has_place(message.command, message.frame) else 1.0
    params = (message.param1, message.param2, message.param3, message.param4)
    return MissionItem(message.command, message.frame, (*params, message.x / scale, message.y / scale, message.z))
