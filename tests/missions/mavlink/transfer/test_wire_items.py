from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import MissionItem, mission_items
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import HOME, has_place, to_wire
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from planning.base.errors import MissionError
from tests.missions.mavlink.driving import from_wire
from tests.missions.plans import example_plan

ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4
POINT = MissionItem(16, 3, (2.0, 0.0, 0.0, 0.0, 22.3372001, 114.2636002, 20.5))


def planned(autopilot: Autopilot) -> tuple[MissionItem, ...]:
    return mission_items(missions_from_plan(example_plan())[0], autopilot, HeightReference.ABOVE_TAKEOFF)


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_items_of_a_plan_come_back_but_for_1e_7_degrees(autopilot: Autopilot) -> None:
    items = planned(autopilot)
    back = from_wire(to_wire(items, autopilot), autopilot)
    assert len(back) == len(items)
    for ours, theirs in zip(items, back, strict=True):
        assert (theirs.command, theirs.frame) == (ours.command, ours.frame)
        for index, (sent, found) in enumerate(zip(ours.params, theirs.params, strict=True)):
            off = 0.51e-7 if index in (4, 5) else 0.0
            assert abs(found - sent) <= off or (math.isnan(sent) and math.isnan(found))


def test_item_0_of_ardupilots_mission_is_home_and_of_nothing_else() -> None:
    assert to_wire((POINT,), ARDUPILOT)[0] == HOME
    assert len(to_wire((POINT,), ARDUPILOT)) == 2
    for autopilot, kind in ((PX4, MissionType.MISSION), (ARDUPILOT, MissionType.FENCE), (PX4, MissionType.RALLY)):
        assert len(to_wire((POINT,), autopilot, kind)) == 1
    assert to_wire((), ARDUPILOT) == ()
    assert from_wire((), ARDUPILOT) == ()
    assert from_wire((HOME,), ARDUPILOT) == ()


def test_trigger_of_digicam_control_is_raw_1() -> None:
    trigger = MissionItem(203, 2, (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0))
    for frame in (0, 2, 3):
        (message,) = to_wire((replace(trigger, frame=frame),), PX4)
        assert message.x == 1


def test_positions_are_1e_7_degrees_in_every_frame_of_a_waypoint() -> None:
    for frame in (0, 2, 3, 5, 6, 10, 11):
        assert has_place(16, frame)
        (message,) = to_wire((replace(POINT, frame=frame),), PX4)
        assert (message.x, message.y, message.z) == (223372001, 1142636002, 20.5)


def test_region_of_interest_has_a_position_only_where_its_frame_is_one() -> None:
    assert has_place(201, 3)
    assert not has_place(201, 2)


@given(lat=st.floats(-90, 90), lon=st.floats(-180, 180))
def test_every_position_on_the_globe_fits(lat: float, lon: float) -> None:
    (message,) = to_wire((replace(POINT, params=(*POINT.params[:4], lat, lon, 0.0)),), PX4)
    (back,) = from_wire((message,), PX4)
    assert abs(back.params[4] - lat) <= 0.51e-7
    assert abs(back.params[5] - lon) <= 0.51e-7


@pytest.mark.parametrize(
    ("item", "words"),
    [
        (replace(POINT, params=(*POINT.params[:4], math.nan, 0.0, 0.0)), "item 1, param 5 is nan.*degrees"),
        (replace(POINT, params=(*POINT.params[:5], 400.0, 0.0)), "item 1, param 6 is 400.*degrees"),
        (MissionItem(203, 2, (0.0,) * 4 + (0.5, 0.0, 0.0)), "item 1, param 5 is 0.5.*whole number"),
        (MissionItem(203, 2, (0.0,) * 4 + (1.0, math.inf, 0.0)), "item 1, param 6 is inf.*whole number"),
    ],
)
def test_value_that_the_message_cannot_hold_is_refused(item: MissionItem, words: str) -> None:
    with pytest.raises(MissionError, match=words):
        to_wire((item,), PX4)
