"""Each rule with a sequence that breaks it, for the autopilot it is about."""

from __future__ import annotations

import math

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import check_items
from missions.mavlink.items import MavlinkFile, MissionItem, mission_items, plain
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import point_at_amsl
from planning.base.findings import Severity
from tests.missions.plans import example_plan

ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4
ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE
HOME = point_at_amsl(52.0, 5.0, 10.0)


def at(
    command: int, *params: float, place: tuple[float, float, float] = (52.001, 5.0, 30.0), frame: int = 3
) -> MissionItem:
    p1, p2, p3, p4 = (*params, *[0.0] * (4 - len(params)))
    return MissionItem(command, frame, (p1, p2, p3, p4, *place))


TAKEOFF, LAND = at(22, place=(52.0, 5.0, 30.0)), at(21, place=(52.0, 5.0, 0.0))
SHOOT, DELAY = plain(203, 0, 0, 0, 0, 1), plain(93, 1, -1, -1, -1)


def codes(autopilot: Autopilot | None, *items: MissionItem) -> set[tuple[str, Severity]]:
    return {(f.code, f.severity) for f in check_items(MavlinkFile(items, HOME), autopilot)}


@pytest.mark.parametrize("autopilot", list(Autopilot))
@pytest.mark.parametrize("reference", [HeightReference.ABOVE_TAKEOFF, HeightReference.AMSL])
def test_what_we_write_has_nothing_to_complain_about(autopilot: Autopilot, reference: HeightReference) -> None:
    for mission in missions_from_plan(example_plan()):
        assert codes(autopilot, *mission_items(mission, autopilot, reference)) == set()


RULES = [
    ("latitude", None, [TAKEOFF, at(16, place=(95.0, 5.0, 30.0))], "coordinates", ERROR),
    ("zero island", None, [TAKEOFF, at(16, place=(0.0, 0.0, 30.0))], "coordinates", WARNING),
    ("altitude", None, [TAKEOFF, at(16, place=(52.0, 5.0, math.nan))], "height", ERROR),
    ("negative hold", None, [TAKEOFF, at(16, -1.0)], "hold", ERROR),
    ("hold beyond 16 bits", None, [TAKEOFF, at(16, 70_000.0)], "hold", ERROR),
    ("trigger without its 1", None, [TAKEOFF, at(16, 2.0), plain(203, 1)], "no-trigger", WARNING),
    ("no take-off", None, [at(16), LAND], "no-takeoff", WARNING),
    ("mixed heights", None, [TAKEOFF, at(16), at(16, frame=0)], "mixed-heights", WARNING),
    ("close waypoints", None, [TAKEOFF, at(16), at(16, place=(52.001001, 5.0, 30.0))], "spacing", NOTE),
    ("acceptance radius", None, [TAKEOFF, at(16), at(16, 0, 3.0, place=(52.00102, 5.0, 30.0))], "spacing", NOTE),
    ("NaN in a gimbal command", ARDUPILOT, [TAKEOFF, plain(1000, 0, 0, math.nan), at(16)], "nan", ERROR),
    ("NaN hold", ARDUPILOT, [TAKEOFF, at(16, math.nan)], "nan", ERROR),
    ("hold of 2.9 s", ARDUPILOT, [TAKEOFF, at(16, 2.9)], "hold-truncated", WARNING),
    ("yaw of a waypoint", ARDUPILOT, [TAKEOFF, at(16, 2, 0, 0, 90.0)], "yaw-ignored", WARNING),
    ("fraction of a degree", ARDUPILOT, [TAKEOFF, plain(1000, -45.67), at(16)], "angle-truncated", WARNING),
    ("rejected command", ARDUPILOT, [TAKEOFF, plain(530), at(16)], "unsupported-command", ERROR),
    ("unknown command", ARDUPILOT, [TAKEOFF, plain(2505), at(16)], "unknown-command", WARNING),
    ("local frame", ARDUPILOT, [TAKEOFF, at(16, frame=1)], "unsupported-frame", ERROR),
    ("terrain", ARDUPILOT, [TAKEOFF, at(16, frame=10)], "terrain-height", WARNING),
    ("photo behind a condition", ARDUPILOT, [TAKEOFF, at(16, 2), plain(115, 90), SHOOT, LAND], "dropped-do", WARNING),
    ("two photos at once", ARDUPILOT, [TAKEOFF, at(16, 2), SHOOT, SHOOT, LAND], "dropped-photo", WARNING),
    ("no hold", ARDUPILOT, [TAKEOFF, at(16), SHOOT, DELAY, LAND], "photo-in-flight", WARNING),
    ("turns on", ARDUPILOT, [TAKEOFF, at(16, 2), SHOOT, plain(115, 9), at(16)], "photo-while-turning", WARNING),
    ("mount behind yaw", ARDUPILOT, [TAKEOFF, plain(115, 90), plain(205, -9), at(16)], "mount-after-yaw", WARNING),
    ("items after the end", ARDUPILOT, [TAKEOFF, at(16, 2), SHOOT], "after-the-end", WARNING),
    ("651 items", ARDUPILOT, [TAKEOFF, *[at(16)] * 649], "item-count", ERROR),
    ("501 items", PX4, [TAKEOFF, *[at(16)] * 500], "item-count", WARNING),
    ("CONDITION_YAW", PX4, [TAKEOFF, plain(115, 90), at(16)], "unsupported-command", ERROR),
    ("terrain on PX4", PX4, [TAKEOFF, at(16, frame=10)], "unsupported-frame", ERROR),
    ("gimbal in frame 3", PX4, [TAKEOFF, MissionItem(1000, 3, (0.0,) * 7), at(16)], "unsupported-frame", ERROR),
]  # fmt: skip


@pytest.mark.parametrize(
    ("autopilot", "items", "code", "severity"), [rule[1:] for rule in RULES], ids=[rule[0] for rule in RULES]
)
def test_rule_finds_what_breaks_it(
    autopilot: Autopilot | None, items: list[MissionItem], code: str, severity: Severity
) -> None:
    assert (code, severity) in codes(autopilot, *items)


def test_orderly_mission_of_ardupilot_breaks_no_rule() -> None:
    good = [TAKEOFF, plain(205, -9, 0, 0, 0, 0, 0, 2), plain(115, 90), at(16, 2), SHOOT, DELAY, LAND]
    assert codes(ARDUPILOT, *good) == set()


def test_650_items_with_home_are_allowed() -> None:
    assert ("item-count", ERROR) not in codes(ARDUPILOT, TAKEOFF, *[at(16)] * 648)


def test_findings_name_the_item_and_the_measured_value() -> None:
    (finding,) = [f for f in check_items(MavlinkFile((TAKEOFF, at(16, 2.9)), HOME), ARDUPILOT) if "hold" in f.code]
    assert (finding.place, finding.value, finding.limit) == ("item 2", 2.9, 2.0)
