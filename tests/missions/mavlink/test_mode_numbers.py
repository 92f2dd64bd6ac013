"""Custom mode numbers: what the autopilots' own headers and pymavlink say."""

import pytest
from pymavlink import mavutil

from missions.mavlink.autopilots import Autopilot, mode_numbers, px4_custom_mode, px4_main_and_sub
from missions.simulator.autopilot.profiles import vehicle_profile


def test_arducopters_numbers_are_those_of_pymavlink():
    theirs = {name: number for number, name in mavutil.mode_mapping_acm.items()}
    ours = mode_numbers(Autopilot.ARDUPILOT)
    common = ours.keys() & theirs.keys()
    assert len(common) > 20
    assert {name: ours[name] for name in common} == {name: theirs[name] for name in common}


def test_px4s_numbers_are_named_alike_by_pymavlink():
    """It does not know all of them."""
    theirs = {name: mavutil.interpret_px4_mode(157, number) for name, number in mode_numbers(Autopilot.PX4).items()}
    known = {name: alias for name, alias in theirs.items() if alias not in ("UNKNOWN", "FOLLOWME")}
    assert len(known) > 10
    assert all(alias == name.removeprefix("AUTO.") for name, alias in known.items())


def test_main_and_sub_mode_come_back():
    for number in mode_numbers(Autopilot.PX4).values():
        assert px4_custom_mode(*px4_main_and_sub(number)) == number


@pytest.mark.parametrize("autopilot", list(Autopilot))
def test_every_mode_of_the_simulated_vehicle_has_a_number(autopilot):
    assert vehicle_profile(autopilot).modes.keys() <= mode_numbers(autopilot).keys()
