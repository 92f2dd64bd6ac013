from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import FIELDS, HOME, Difference, compare, has_place, rounding_rules
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, PX4, waypoints

NAN = math.nan
COMMANDS = (16, 19, 21, 22, 82, 93, 112, 115, 178, 201, 203, 205, 206, 1000, 2000, 5001, 5003, 5100)
FLOATS = st.floats(-1e6, 1e6, width=32)
WHOLE = st.integers(-(2**31) + 10, 2**31 - 10)


@st.composite
def items(draw: st.DrawFn) -> MissionItemInt:
    command = draw(st.sampled_from(COMMANDS))
    frame = draw(st.sampled_from((0, 3, 5, 6))) if command in (16, 19, 21, 22, 82, 5001, 5003, 5100) else 2
    params = [draw(FLOATS) for _ in range(4)]
    return MissionItemInt(1, 1, 1, frame, command, 0, 1, *params, draw(WHOLE), draw(WHOLE), draw(st.floats(-500, 9000)))


def differences(
    sent: MissionItemInt, back: MissionItemInt, autopilot: Autopilot, kind: MissionType = MissionType.MISSION
) -> tuple[Difference, ...]:
    """Of one item, behind home."""
    return compare((HOME, sent), (HOME, back), autopilot, kind)


def fields_of(
    sent: MissionItemInt, autopilot: Autopilot, kind: MissionType = MissionType.MISSION, **back: Any
) -> list[str]:
    return [each.field for each in differences(sent, replace(sent, **back), autopilot, kind)]


@given(item=items(), kind=st.sampled_from(MissionType), autopilot=st.sampled_from(Autopilot))
def test_what_comes_back_as_a_32_bit_float_is_equal(
    item: MissionItemInt, kind: MissionType, autopilot: Autopilot
) -> None:
    floats = {name: float(np.float32(getattr(item, name))) for name in ("param1", "param2", "param3", "param4", "z")}
    assert differences(item, replace(item, **floats), autopilot, kind) == ()


MAY_BE_ANYTHING = {ARDUPILOT: {"current", "autocontinue"}, PX4: {"current"}}


@given(item=items(), field=st.sampled_from(FIELDS), autopilot=st.sampled_from(Autopilot), data=st.data())
def test_each_change_beyond_rounding_is_found(
    item: MissionItemInt, field: str, autopilot: Autopilot, data: st.DataObject
) -> None:
    # 1.5 is more than every step and fraction that is forgiven, and is no whole turn.
    assume(field not in MAY_BE_ANYTHING[autopilot])
    old = getattr(item, field)
    if field in ("command", "frame", "autocontinue"):
        new: float = data.draw(st.sampled_from([v for v in (0, 1, 2, 3, 5, 6, 16, 21, 205) if v != old]))
        same = [{0, 2, 5}, {3, 6}] if autopilot is ARDUPILOT else [{0, 5}, {3, 6}]
        is_alike = any({old, new} <= frames for frames in same)
        assume(field != "frame" or not is_alike)
        # ArduPilot does not store the frame of an item without a position.
        assume(field != "frame" or has_place(item.command, item.frame) or new != 0 or autopilot is PX4)
    elif field in ("x", "y"):
        new = data.draw(WHOLE.filter(lambda value: abs(value - old) > 1))
    else:
        # 0 is what comes back for a value that is not stored.
        new = data.draw(FLOATS.filter(lambda value: abs(value - old) > 1.5 and value != 0.0))
        turned = (new - old + 180.0) % 360.0 - 180.0
        assume(abs(turned) > 0.5)
        # Of a landing ArduPilot keeps the sign, as -1 or 1.
        assume((item.command, field) != (21, "param4") or abs(new) != 1.0)
    found = fields_of(item, autopilot, **{field: new})
    assert found == [field]


@given(item=items(), field=st.sampled_from(("param1", "param2", "param3", "param4", "z")))
def test_a_nan_that_was_not_sent_is_found(item: MissionItemInt, field: str) -> None:
    for autopilot in Autopilot:
        assert fields_of(item, autopilot, **{field: NAN}) == [field]


WAYPOINT = replace(waypoints(2)[1], param1=2.9, param2=3.0, param3=1.0, param4=-20.0, z=12.3456)
GIMBAL = MissionItemInt(1, 1, 1, 2, 1000, 0, 1, -45.67, 30.9, 0.0, 0.0, 12, 0, 0.0)
MOUNT = MissionItemInt(1, 1, 1, 2, 205, 0, 1, -45.67, 0.0, 0.0, 0.0, 0, 0, 2.0)
DIGICAM = MissionItemInt(1, 1, 1, 2, 203, 0, 1, 0.0, 0.0, 0.0, 0.0, 1, 0, 0.0)
LAND = replace(WAYPOINT, command=21, param1=0.0, param2=0.0, param3=0.0, param4=0.0)
DELAY = MissionItemInt(1, 1, 1, 2, 93, 0, 1, 2.5, -1.0, -1.0, -1.0, 0, 0, 0.0)


@pytest.mark.parametrize(
    ("sent", "back"),
    [
        (WAYPOINT, {"param1": 2.0, "param2": 0.0, "param3": 0.0, "param4": 0.0, "z": 12.34}),
        (replace(WAYPOINT, z=-12.3456), {"z": -12.34}),
        (replace(WAYPOINT, param4=NAN), {"param4": 0.0}),
        (replace(WAYPOINT, param1=0.5), {"param1": 0.0}),
        (replace(WAYPOINT, frame=6), {"frame": 3, "autocontinue": 0}),
        (replace(WAYPOINT, frame=2), {"frame": 0, "current": 1}),
        (GIMBAL, {"frame": 0, "param1": -45.0, "param2": 30.0}),
        (MOUNT, {"frame": 0, "z": 0.0}),
        (DIGICAM, {"frame": 0}),
        (LAND, {"param4": 1.0, "z": 12.34}),
        (replace(LAND, param4=-90.0), {"param4": -1.0}),
        (replace(LAND, param4=NAN), {"param4": 1.0}),
        (DELAY, {"frame": 0}),
    ],
)
def test_ardupilots_known_rounding_is_forgiven(sent: MissionItemInt, back: dict[str, Any]) -> None:
    assert fields_of(sent, ARDUPILOT, **back) == []


@pytest.mark.parametrize(
    ("sent", "back", "field"),
    [
        (WAYPOINT, {"param1": 3.0}, "param1"),
        (WAYPOINT, {"z": 12.32}, "z"),
        (WAYPOINT, {"x": WAYPOINT.x + 1}, "x"),
        (WAYPOINT, {"frame": 0}, "frame"),
        (replace(WAYPOINT, frame=10), {"frame": 3}, "frame"),
        (MOUNT, {"param1": -45.0}, "param1"),
        (DIGICAM, {"x": 128}, "x"),
        (LAND, {"param4": -1.0}, "param4"),
        (LAND, {"param4": 2.0}, "param4"),
        (DELAY, {"param1": 2.0}, "param1"),
        (GIMBAL, {"param1": -46.0}, "param1"),
        (GIMBAL, {"x": 0}, "x"),
    ],
)
def test_ardupilots_changes_that_matter_are_found(sent: MissionItemInt, back: dict[str, Any], field: str) -> None:
    assert fields_of(sent, ARDUPILOT, **back) == [field]


@pytest.mark.parametrize(
    ("sent", "back", "fields"),
    [
        (WAYPOINT, {"param4": 340.0}, []),
        (WAYPOINT, {"param4": -20.0005}, []),
        (WAYPOINT, {"param4": -20.1}, ["param4"]),
        (WAYPOINT, {"param4": 0.0}, ["param4"]),
        (replace(WAYPOINT, param4=NAN), {}, []),
        (replace(WAYPOINT, param4=NAN), {"param4": 0.0}, ["param4"]),
        (WAYPOINT, {"x": WAYPOINT.x - 1, "y": WAYPOINT.y + 1, "frame": 6}, []),
        (WAYPOINT, {"x": WAYPOINT.x - 2}, ["x"]),
        (WAYPOINT, {"z": 12.34}, ["z"]),
        (WAYPOINT, {"param1": 2.0}, ["param1"]),
        (GIMBAL, {"param1": -45.0}, ["param1"]),
        (GIMBAL, {"frame": 0}, ["frame"]),
        (GIMBAL, {"x": 13}, ["x"]),
    ],
)
def test_px4_keeps_floats_and_turns_yaw(sent: MissionItemInt, back: dict[str, Any], fields: list[str]) -> None:
    assert fields_of(sent, PX4, **back) == fields


def test_rally_points_of_ardupilot_have_whole_metres_and_fences_no_height() -> None:
    rally = replace(WAYPOINT, command=5100, param1=0.0, param2=0.0, param3=0.0, param4=0.0)
    assert fields_of(rally, ARDUPILOT, MissionType.RALLY, z=12.0) == []
    assert fields_of(rally, ARDUPILOT, MissionType.RALLY, z=11.0) == ["z"]
    assert fields_of(rally, PX4, MissionType.RALLY, z=12.0) == ["z"]
    corner = replace(rally, command=5002, frame=0, param1=4.0)
    for autopilot in Autopilot:
        assert fields_of(corner, autopilot, MissionType.FENCE, z=0.0) == []
        assert fields_of(corner, autopilot, MissionType.FENCE, param1=5.0) == ["param1"]


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_another_number_of_items_is_found(autopilot: Autopilot) -> None:
    sent = (HOME, *waypoints(4)[1:])
    assert compare(sent, sent, autopilot) == ()
    for back in ((*sent, waypoints(5)[4]), sent[:-1], sent[:1], ()):
        found = compare(sent, back, autopilot)
        assert (found[0].field, found[0].sent, found[0].read_back) == ("count", 4, len(back))
        assert f"4 items were sent, {len(back)} are on the vehicle" in str(found[0])


def test_home_of_the_vehicle_is_not_compared_on_ardupilot_only() -> None:
    other = replace(HOME, x=5, z=99.0)
    items_sent = (HOME, waypoints(2)[1])
    assert compare(items_sent, (other, items_sent[1]), ARDUPILOT) == ()
    assert [d.seq for d in compare(items_sent, (other, items_sent[1]), PX4)] == [0, 0]
    assert [d.field for d in compare(items_sent, (other, items_sent[1]), ARDUPILOT, MissionType.RALLY)] == ["x", "z"]


def test_difference_says_where_and_what() -> None:
    (difference,) = differences(WAYPOINT, replace(WAYPOINT, param1=4.0), ARDUPILOT)
    assert str(difference) == "item 1, param1: sent 2.900000095, on the vehicle 4"


def test_every_rule_has_its_reason_and_names_a_field() -> None:
    for rule in rounding_rules():
        assert rule.reason
        assert rule.fields
        assert set(rule.fields) <= set(FIELDS)
        assert (rule.step > 0.0) == (rule.keeps in ("step", "degrees"))
        assert bool(rule.frames) == (rule.keeps == "frame")
