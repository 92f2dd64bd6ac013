"""Battery and fence: what the vehicle does by itself."""

from __future__ import annotations

import math

import pytest

from missions.mavlink.messages import Heartbeat
from missions.simulator.failsafe import FenceZone
from tests.missions.simulator.ground import ARDUPILOT, PX4, Ground, at, item

MISSION = [at(22, 0, 0, 20), at(16, 150, 0, 20, 2), item(93, 1, frame=2), at(21, 0, 0, 0)]


def corners(command: int, *places: tuple[float, float]):
    return [at(command, east, north, 0, len(places), frame=0) for east, north in places]


def square(command: int, east: float, size: float = 20.0):
    half = size / 2
    return corners(command, (east - half, -half), (east + half, -half), (east + half, half), (east - half, half))


def on_the_way(ground: Ground, east: float = 30.0) -> Ground:
    assert ground.upload(MISSION) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > east)
    return ground


@pytest.mark.parametrize(
    ("parameters", "remaining", "mode"),
    [
        ({"BATT_LOW_MAH": 660.0, "BATT_FS_LOW_ACT": 2}, 0.19, "RTL"),
        ({"BATT_LOW_MAH": 660.0, "BATT_FS_LOW_ACT": 2}, 0.21, "AUTO"),
        ({"BATT_LOW_MAH": 660.0}, 0.19, "AUTO"),
        ({"BATT_CRT_MAH": 330.0, "BATT_FS_CRT_ACT": 1}, 0.09, "LAND"),
    ],
)
def test_ardupilot_acts_on_a_low_battery_as_its_parameters_say(parameters, remaining: float, mode: str) -> None:
    ground = on_the_way(Ground(ARDUPILOT, parameters))
    ground.frame.remaining = remaining
    ground.until(lambda: ground.frame.position[0] > 40 or ground.vehicle.modes.mode != "AUTO")
    assert ground.vehicle.modes.mode == mode
    assert any("Battery" in text for text in ground.said) == (remaining < 0.2)


@pytest.mark.parametrize(
    ("remaining", "action", "mode"), [(0.06, 1, "RTL"), (0.06, 0, "MISSION"), (0.14, 3, "MISSION")]
)
def test_px4_acts_on_a_critical_battery_only(remaining: float, action: int, mode: str) -> None:
    ground = on_the_way(Ground(PX4, {"COM_LOW_BAT_ACT": action}))
    ground.frame.remaining = remaining
    ground.until(lambda: ground.frame.position[0] > 40 or not ground.vehicle.modes.mode.endswith("MISSION"))
    assert ground.vehicle.modes.mode == f"AUTO.{mode}"
    assert sum("Battery" in text for text in ground.said) == 1
    ground.heard.clear()
    assert ground.wait(Heartbeat).system_status == 5


def test_failsafe_speaks_once_and_the_flight_ends_at_home() -> None:
    ground = on_the_way(Ground(ARDUPILOT, {"BATT_LOW_MAH": 660.0, "BATT_FS_LOW_ACT": 2}))
    ground.frame.remaining = 0.19
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    assert sum("Battery" in text for text in ground.said) == 1
    assert math.dist(ground.frame.position, (0, 0, 0)) < 0.3


@pytest.mark.parametrize(
    ("autopilot", "parameters", "mode"),
    [
        (ARDUPILOT, {"FENCE_ENABLE": 1}, "RTL"),
        (ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_ACTION": 4}, "BRAKE"),
        (ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_ACTION": 0}, "AUTO"),
        (ARDUPILOT, {"FENCE_ENABLE": 0}, "AUTO"),
        (ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_TYPE": 3}, "AUTO"),
        (PX4, {}, "AUTO.LOITER"),
        (PX4, {"GF_ACTION": 3}, "AUTO.RTL"),
        (PX4, {"GF_ACTION": 1}, "AUTO.MISSION"),
    ],
)
def test_breach_of_an_exclusion_polygon_is_acted_upon_as_parameters_say(autopilot, parameters, mode: str) -> None:
    ground = Ground(autopilot, parameters)
    assert ground.upload(square(5002, 60), 1) == 0
    on_the_way(ground)
    ground.until(lambda: ground.frame.position[0] > 55 or not ground.vehicle.modes.is_mission_active)
    assert ground.vehicle.modes.mode == mode
    if not ground.vehicle.modes.is_mission_active:
        assert ground.frame.position[0] == pytest.approx(50.0, abs=2.5)


def test_leaving_an_inclusion_polygon_is_a_breach() -> None:
    ground = Ground(ARDUPILOT, {"FENCE_ENABLE": 1})
    assert ground.upload(square(5001, 0, 100), 1) == 0
    on_the_way(ground)
    ground.until(lambda: ground.vehicle.modes.mode == "RTL", 30.0)
    assert ground.frame.position[0] == pytest.approx(50.0, abs=2.5)
    assert "Fence breached" in ground.said


@pytest.mark.parametrize("parameters", [{"FENCE_RADIUS": 50.0}, {"FENCE_ALT_MAX": 15.0}])
def test_height_and_radius_are_fences_too(parameters) -> None:
    ground = Ground(ARDUPILOT, {"FENCE_ENABLE": 1, **parameters})
    ground.upload(MISSION)
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.modes.mode == "RTL", 60.0)


def test_zone_of_a_circle_and_of_a_hollow_polygon() -> None:
    assert FenceZone(False, ((10.0, 0.0),), 5.0).holds(14.9, 0.0)
    assert not FenceZone(False, ((10.0, 0.0),), 5.0).holds(15.1, 0.0)
    letter_u = ((0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (6.0, 9.0), (6.0, 3.0), (3.0, 3.0), (3.0, 9.0), (0.0, 9.0))
    zone = FenceZone(True, letter_u)
    assert [zone.holds(*place) for place in ((1, 5), (4.5, 5), (8, 5), (4.5, 1), (10, 5))] == [
        True,
        False,
        True,
        True,
        False,
    ]


def test_fence_can_be_changed_in_flight() -> None:
    ground = Ground(PX4)
    on_the_way(ground)
    assert ground.upload(square(5002, 60), 1) == 0
    ground.until(lambda: ground.vehicle.modes.mode == "AUTO.LOITER", 20.0)
