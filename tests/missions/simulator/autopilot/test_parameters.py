"""Parameters over MAVLink."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.messages import ParamRequestList, ParamRequestRead, ParamSet, ParamValue
from missions.simulator.autopilot.parameters import INT32, REAL32, ParameterTable, from_wire_value, wire_value
from missions.simulator.autopilot.profiles import vehicle_profile
from tests.missions.simulator.ground import ARDUPILOT, PX4, Ground, at, item


@given(st.integers(-(2**31), 2**31 - 1))
def test_px4_sends_the_bytes_of_whole_numbers(value: int) -> None:
    sent = wire_value(value, PX4)
    assert struct.pack("<f", sent) == struct.pack("<i", value) or math.isnan(sent)
    if not math.isnan(sent):
        assert from_wire_value(sent, True, PX4) == value


def test_small_whole_numbers_look_like_nothing_on_px4_and_like_themselves_on_ardupilot() -> None:
    assert 0.0 < wire_value(2, PX4) < 1e-40
    assert wire_value(2, ARDUPILOT) == 2.0


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_list_holds_every_parameter_once(autopilot) -> None:
    values = ParameterTable(autopilot).receive(ParamRequestList(1, 1))
    assert [each.param_index for each in values] == list(range(len(values)))
    assert {each.param_id for each in values} == set(vehicle_profile(autopilot).parameters)
    assert all(each.param_count == len(values) and len(each.param_id) <= 16 for each in values)


def test_parameters_are_read_by_name_and_by_number() -> None:
    table = ParameterTable(ARDUPILOT)
    (by_name,) = table.receive(ParamRequestRead(1, 1, "WP_YAW_BEHAVIOR"))
    (by_number,) = table.receive(ParamRequestRead(1, 1, "", by_name.param_index))
    assert by_name == by_number == ParamValue("WP_YAW_BEHAVIOR", 2.0, INT32, by_name.param_count, by_name.param_index)
    assert table.receive(ParamRequestRead(1, 1, "NO_SUCH")) == []


def test_set_is_answered_with_what_now_holds() -> None:
    table = ParameterTable(ARDUPILOT)
    (answer,) = table.receive(ParamSet(1, 1, "WP_YAW_BEHAVIOR", 0.0, REAL32))
    assert (answer.param_value, table["WP_YAW_BEHAVIOR"], table.revision) == (0.0, 0, 1)
    (answer,) = table.receive(ParamSet(1, 1, "MNT1_PITCH_MAX", math.nan, REAL32))
    assert answer.param_value == 20.0
    assert table.receive(ParamSet(1, 1, "NO_SUCH", 1.0, REAL32)) == []


def test_px4_keeps_its_value_where_the_type_is_wrong() -> None:
    """A ground station that sends the number instead of its bytes changes nothing."""
    table = ParameterTable(PX4)
    (answer,) = table.receive(ParamSet(1, 1, "GF_ACTION", 3.0, REAL32))
    assert from_wire_value(answer.param_value, True, PX4) == table["GF_ACTION"] == 2
    table.receive(ParamSet(1, 1, "GF_ACTION", wire_value(3, PX4), INT32))
    assert table["GF_ACTION"] == 3


def test_unknown_parameter_of_our_own_is_a_wrong_call() -> None:
    with pytest.raises(ValueError, match="MNT_1"):
        ParameterTable(ARDUPILOT, {"MNT_1": 3})


def test_changed_speed_holds_in_flight() -> None:
    ground = Ground()
    ground.upload([at(22, 0, 0, 20), at(16, 200, 0, 20, 1), item(93, 1), at(21, 0, 0, 0)])
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > 40)
    assert math.hypot(*ground.frame.velocity) == pytest.approx(10.0, abs=0.01)
    ground.link.send(ParamSet(1, 1, "WPNAV_SPEED", 300.0, REAL32))
    ground.until(lambda: ground.frame.position[0] > 80)
    assert math.hypot(*ground.frame.velocity) == pytest.approx(3.0, abs=0.01)
