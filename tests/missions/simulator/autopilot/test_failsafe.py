"""Battery and fence: what the vehicle does by itself."""

from __future__ import annotations

import math

import pytest

from missions.mavlink.link import GROUND_STATION
from missions.mavlink.messages import Address, Heartbeat, Received
from missions.simulator.autopilot.failsafe import FenceZone
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


@pytest.mark.few(4)
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


@pytest.mark.parametrize(
    ("autopilot", "parameters", "is_forbidden"),
    [
        (ARDUPILOT, {"FENCE_ENABLE": 1}, True),
        (ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_OPTIONS": 2}, False),
        (PX4, {}, False),
    ],
)
def test_of_two_areas_to_stay_in_ardupilot_wants_both_and_px4_any(autopilot, parameters, is_forbidden: bool) -> None:
    ground = Ground(autopilot, parameters)
    assert ground.upload([*square(5001, 0, 100), *square(5001, 200, 100)], 1) == 0
    failsafe = ground.vehicle._failsafe
    assert failsafe.is_forbidden((0.0, 0.0, 10.0)) is is_forbidden
    assert failsafe.is_forbidden((100.0, 0.0, 10.0)) is True


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


@pytest.mark.few(5)
@pytest.mark.parametrize(
    ("autopilot", "parameters", "mode"),
    [
        (ARDUPILOT, {}, "AUTO"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 1}, "RTL"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 5}, "LAND"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 7}, "BRAKE"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 1, "FS_OPTIONS": 2}, "AUTO"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 1, "FS_GCS_TIMEOUT": 100.0}, "AUTO"),
        (PX4, {}, "AUTO.MISSION"),
        (PX4, {"NAV_DLL_ACT": 1}, "AUTO.LOITER"),
        (PX4, {"NAV_DLL_ACT": 2}, "AUTO.RTL"),
        (PX4, {"NAV_DLL_ACT": 3}, "AUTO.LAND"),
        (PX4, {"NAV_DLL_ACT": 2, "COM_DLL_EXCEPT": 1}, "AUTO.MISSION"),
        (PX4, {"NAV_DLL_ACT": 2, "COM_DL_LOSS_T": 100}, "AUTO.MISSION"),
    ],
)
def test_a_silent_ground_station_is_acted_upon_as_parameters_say(autopilot, parameters, mode: str) -> None:
    ground = on_the_way(talking(Ground(autopilot, parameters)), 10.0)
    assert ground.vehicle.modes.is_mission_active
    ground.talks = False
    ground.until(lambda: ground.frame.position[0] > 120 or not ground.vehicle.modes.is_mission_active, 120.0)
    assert ground.vehicle.modes.mode == mode


def talking(ground: Ground) -> Ground:
    """A ground station whose heartbeats come each second for as long as it talks."""
    ground.talks, step, last_s = True, ground.vehicle.step, -1.0
    heartbeat = Heartbeat(6, 8, 0, 0, 4)

    def stepped(duration_s):
        nonlocal last_s
        if ground.talks and ground.vehicle.now_s >= last_s + 1.0:
            last_s = ground.vehicle.now_s
            ground.vehicle.receive(Received(heartbeat, GROUND_STATION, last_s))
        return step(duration_s)

    ground.vehicle.step = stepped
    return ground


def test_ardupilot_waits_for_no_ground_station_that_it_never_heard_and_hears_only_its_own() -> None:
    ground = Ground(ARDUPILOT, {"FS_GCS_ENABLE": 1})
    ground.vehicle.receive(Received(Heartbeat(6, 8, 0, 0, 4), Address(200, 190), 0.0))
    on_the_way(ground, 60.0)
    assert ground.vehicle.modes.mode == "AUTO"


def test_when_the_ground_station_is_heard_again_the_mode_stays() -> None:
    ground = on_the_way(talking(Ground(ARDUPILOT, {"FS_GCS_ENABLE": 1})), 10.0)
    ground.talks = False
    ground.until(lambda: ground.vehicle.modes.mode == "RTL", 60.0)
    ground.talks = True
    ground.until(lambda: "GCS Failsafe Cleared" in ground.said, 10.0)
    assert ground.vehicle.modes.mode == "RTL"


@pytest.mark.parametrize(
    ("action", "mode"), [(0, "AUTO"), (1, "RTL"), (2, "LAND"), (3, "RTL"), (4, "BRAKE"), (5, "LAND")]
)
def test_every_fence_action_of_ardupilot_is_known(action: int, mode: str) -> None:
    ground = on_the_way(Ground(ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_RADIUS": 40.0, "FENCE_ACTION": action}))
    ground.until(lambda: ground.frame.position[0] > 60 or not ground.vehicle.modes.is_mission_active, 60.0)
    assert ground.vehicle.modes.mode == mode


def test_farther_out_ardupilot_acts_again_and_in_the_end_lands_whatever_it_was_told() -> None:
    ground = on_the_way(Ground(ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_RADIUS": 35.0, "FENCE_ACTION": 4}))
    modes = ground.vehicle.modes
    ground.until(lambda: modes.mode == "BRAKE", 60.0)
    breached_m = ground.frame.position[0]
    modes.set_mode("AUTO")
    ground.until(lambda: modes.mode == "BRAKE", 60.0)
    assert ground.frame.position[0] > breached_m + 18.0
    while modes.mode != "LAND":
        modes.set_mode("AUTO")
        ground.until(lambda: modes.mode != "AUTO", 60.0)
    assert ground.frame.position[0] > 135.0


RALLY = {"east": (60.0, 5.0, 0.0), "far": (60.0, 400.0, 0.0)}


def landed_at(autopilot, parameters, *points, east: float = 50.0):
    """Where a return that is ordered on the way ends."""
    ground = Ground(autopilot, parameters)
    assert ground.upload([at(5100, *RALLY[point]) for point in points], 2) == 0
    on_the_way(ground, east)
    ground.vehicle.modes.set_mode("RTL" if autopilot is ARDUPILOT else "AUTO.RTL")
    ground.until(lambda: not ground.vehicle.modes.is_armed, 300.0)
    return ground.frame.position


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("autopilot", "parameters", "points", "place"),
    [
        (ARDUPILOT, {}, ["east"], "east"),
        (ARDUPILOT, {}, [], "home"),
        (ARDUPILOT, {"RALLY_LIMIT_KM": 0.005}, ["east"], "home"),
        (ARDUPILOT, {}, ["far"], "home"),
        (ARDUPILOT, {"RALLY_INCL_HOME": 0, "RALLY_LIMIT_KM": 1.0}, ["far"], "far"),
        (PX4, {"RTL_DESCEND_ALT": 10.0}, ["east"], "east"),
        (PX4, {"RTL_DESCEND_ALT": 10.0, "RTL_TYPE": 2}, ["east"], "home"),
        (PX4, {"RTL_DESCEND_ALT": 10.0, "RTL_TYPE": 1}, ["far"], "far"),
        (PX4, {"RTL_DESCEND_ALT": 10.0, "RTL_TYPE": 1}, [], "home"),
    ],
)
def test_the_vehicle_returns_to_the_rally_point_or_home_that_its_parameters_say(
    autopilot, parameters, points, place
) -> None:
    expected = (0.0, 0.0, 0.0) if place == "home" else RALLY[place]
    assert math.dist(landed_at(autopilot, parameters, *points), expected) < 1.5


def test_ardupilot_does_not_return_to_a_rally_point_that_its_fence_forbids() -> None:
    ground = Ground(ARDUPILOT, {"FENCE_ENABLE": 1, "FENCE_RADIUS": 59.0})
    assert ground.upload([at(5100, *RALLY["east"])], 2) == 0
    on_the_way(ground, 50.0)
    ground.vehicle.modes.set_mode("RTL")
    ground.until(lambda: not ground.vehicle.modes.is_armed, 300.0)
    assert math.dist(ground.frame.position, (0.0, 0.0, 0.0)) < 1.5


def test_close_to_its_destination_ardupilot_climbs_no_higher_than_the_cone() -> None:
    highest = {}
    for slope in (0.0, 1.0):
        ground = on_the_way(Ground(ARDUPILOT, {"RTL_ALT": 6000, "RTL_CONE_SLOPE": slope}), 30.0)
        ground.vehicle.modes.set_mode("RTL")
        tops = []
        ground.until(lambda tops=tops, ground=ground: tops.append(ground.frame.position[2]) or max(tops) > tops[-1] + 5)
        highest[slope] = max(tops)
    assert highest[0.0] == pytest.approx(60.0, abs=1.0)
    assert highest[1.0] == pytest.approx(30.0, abs=5.0)
