"""Mission items to MISSION_ITEM_INT and back, as each autopilot counts, scales and rounds them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as dialect

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import WITH_POSITION
from missions.mavlink.items import MissionItem
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from planning.base.errors import MissionError
from planning.base.json_file import read_toml
from planning.base.messages import say
from planning.geo.frames import wrap_heading_deg

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
        raise MissionError.say(
            "{} is {:g}, which has no place in MISSION_ITEM_INT; expected {}", place, value / scale, kind
        )
    return round(value)


def _item(message: MissionItemInt) -> MissionItem:
    scale = SCALE if has_place(message.command, message.frame) else 1.0
    params = (message.param1, message.param2, message.param3, message.param4)
    return MissionItem(message.command, message.frame, (*params, message.x / scale, message.y / scale, message.z))


# Is on the vehicle what was sent? Field by field, but for the rounding that `data/mavlink_rounding.toml` knows.

DATA_PATH = Path(__file__).parents[2] / "data" / "mavlink_rounding.toml"

FIELDS = (
    "command", "frame", "current", "autocontinue", "param1", "param2", "param3", "param4", "x", "y", "z",
)  # fmt: skip
FLOATS = frozenset(("param1", "param2", "param3", "param4", "z"))
COUNT = "count"

FLOAT32_SLACK = 4.0 * 2.0**-23
"""A step is cut off in 32 bit arithmetic, which may be some last places off."""


class KeptPart(StrEnum):
    """What a vehicle keeps of a field; the data file explains the words."""

    ANYTHING = "anything"
    NOTHING = "nothing"
    WHOLE = "whole"
    STEP = "step"
    DEGREES = "degrees"
    SIGN = "sign"
    FRAME = "frame"


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule of the table; the data file explains the fields."""

    fields: tuple[str, ...]
    keeps: KeptPart
    reason: str
    autopilot: Autopilot | None = None
    lists: tuple[MissionType, ...] = tuple(MissionType)
    commands: frozenset[int] | None = None
    place: bool | None = None
    step: float = 0.0
    frames: tuple[frozenset[int], ...] = ()

    def fits(self, item: MissionItemInt, autopilot: Autopilot, mission_type: MissionType) -> bool:
        """Whether it speaks of an item."""
        return (
            self.autopilot in (None, autopilot)
            and mission_type in self.lists
            and (self.commands is None or item.command in self.commands)
            and self.place in (None, has_place(item.command, item.frame))
        )

    def tolerates(self, field: str, sent: float, back: float) -> bool:
        """Whether a value may come back so."""
        match self.keeps:
            case KeptPart.ANYTHING:
                return True
            case KeptPart.NOTHING:
                return back == 0
            case KeptPart.WHOLE:
                return math.isfinite(sent) and back == math.trunc(sent)
            case KeptPart.STEP:
                slack = FLOAT32_SLACK * max(abs(sent), 1.0) if field in FLOATS else 0.0
                return abs(sent - back) <= self.step + slack
            case KeptPart.DEGREES:
                return math.isfinite(sent - back) and abs(wrap_heading_deg(sent - back)) <= self.step
            case KeptPart.SIGN:
                return back == (-1.0 if sent < 0.0 else 1.0)
            case KeptPart.FRAME:
                return any(sent in same and back in same for same in self.frames)


@dataclass(frozen=True, slots=True)
class Difference:
    """A field that is not on the vehicle as it was sent; `seq` counts as on the wire.

    The field `count` says that the vehicle has another number of items.
    """

    seq: int
    field: str
    sent: float
    read_back: float

    def __str__(self) -> str:
        if self.field == COUNT:
            return say("{:g} items were sent, {:g} are on the vehicle", self.sent, self.read_back)
        return say("item {}, {}: sent {:.10g}, on the vehicle {:.10g}", self.seq, self.field, self.sent, self.read_back)


@cache
def rounding_rules() -> tuple[Rule, ...]:
    """The table."""
    return read_toml(DATA_PATH, dict[str, tuple[Rule, ...]])["rules"]


def compare(
    sent: Sequence[MissionItemInt],
    read_back: Sequence[MissionItemInt],
    autopilot: Autopilot,
    mission_type: MissionType = MissionType.MISSION,
) -> tuple[Difference, ...]:
    """All fields in which the items on the vehicle are not those that were sent; none: they are equal.

    Item 0 of an ArduPilot mission is the vehicle's own home, and is not compared. A vehicle without a mission may list
    its home or nothing.
    """
    first = int(has_home(autopilot, mission_type))
    differences: list[Difference] = []
    if len(sent[first:]) != len(read_back[first:]):
        differences.append(Difference(0, COUNT, len(sent), len(read_back)))
    for seq, (ours, theirs) in enumerate(zip(sent[first:], read_back[first:], strict=False), first):
        differences += _differences(seq, ours, theirs, autopilot, mission_type)
    return tuple(differences)


def _differences(
    seq: int, sent: MissionItemInt, back: MissionItemInt, autopilot: Autopilot, mission_type: MissionType
) -> Iterator[Difference]:
    fitting = [rule for rule in rounding_rules() if rule.fits(sent, autopilot, mission_type)]
    for field in FIELDS:
        ours, theirs = _on_the_wire(sent, field), _on_the_wire(back, field)
        if ours == theirs or (math.isnan(ours) and math.isnan(theirs)):
            continue
        rule = next((each for each in fitting if field in each.fields), None)
        if rule is None or not rule.tolerates(field, ours, theirs):
            yield Difference(seq, field, ours, theirs)


def _on_the_wire(item: MissionItemInt, field: str) -> float:
    value = float(getattr(item, field))
    if field not in FLOATS:
        return value
    with np.errstate(over="ignore"):
        return float(np.float32(value))
