"""Is on the vehicle what was sent? Field by field, but for the rounding that `data/mavlink_rounding.toml` knows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

import numpy as np

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import has_home, has_place
from planning.base.json_file import read_toml
from planning.base.messages import say
from planning.geo.frames import wrap_heading_deg

DATA_PATH = Path(__file__).parents[2] / "data" / "mavlink_rounding.toml"

FIELDS = (
    "command", "frame", "current", "autocontinue", "param1", "param2", "param3", "param4", "x", "y", "z",
)  # fmt: skip
FLOATS = frozenset(("param1", "param2", "param3", "param4", "z"))
COUNT = "count"

FLOAT32_SLACK = 4.0 * 2.0**-23
"""A step is cut off in 32 bit arithmetic, which may be some last places off."""


class Keeps(StrEnum):
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
    keeps: Keeps
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

    def forgives(self, field: str, sent: float, back: float) -> bool:
        """Whether a value may come back so."""
        match self.keeps:
            case Keeps.ANYTHING:
                return True
            case Keeps.NOTHING:
                return back == 0
            case Keeps.WHOLE:
                return math.isfinite(sent) and back == math.trunc(sent)
            case Keeps.STEP:
                slack = FLOAT32_SLACK * max(abs(sent), 1.0) if field in FLOATS else 0.0
                return abs(sent - back) <= self.step + slack
            case Keeps.DEGREES:
                return math.isfinite(sent - back) and abs(wrap_heading_deg(sent - back)) <= self.step
            case Keeps.SIGN:
                return back == (-1.0 if sent < 0.0 else 1.0)
            case Keeps.FRAME:
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
        if rule is None or not rule.forgives(field, ours, theirs):
            yield Difference(seq, field, ours, theirs)


def _on_the_wire(item: MissionItemInt, field: str) -> float:
    value = float(getattr(item, field))
    if field not in FLOATS:
        return value
    with np.errstate(over="ignore"):
        return float(np.float32(value))
