"""The list before take-off."""

from dataclasses import replace

import pytest

from groundstation.vehicle.duration import items_duration_s
from groundstation.vehicle.orders import fence_messages, first_seq, sortie_orders
from groundstation.vehicle.preflight import OnBoard, Verdict, is_ready, preflight_checks
from groundstation.vehicle.setup import message_requests, wanted_parameters
from groundstation.vehicle.state import BatteryLevel, EstimatorHealth, GnssFix, Motion, Timed, VehicleState, VehicleText
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.build import missions_from_plan
from missions.mission.model import altitude_amsl_m
from planning.base.errors import MissionError
from planning.insight.flight_profile import LowFlight
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import single_panel
from tests.planning.revision.cases import QUICK

NOW_S = 50.0
ALL_ON_BOARD = OnBoard(mission=True, fence=True)


@pytest.fixture(scope="module")
def orders():
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=3, greedy=QUICK, profile_id="ardupilot")).plan
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return sortie_orders(plan, model, mission)


def charged(state, remaining):
    return replace(state, battery=Timed(BatteryLevel(remaining), NOW_S))


def ready_state(orders):
    x, y, z = orders.home_enu_m
    return VehicleState(
        address=Address(1, 1),
        autopilot=Autopilot.ARDUPILOT,
        heartbeat=Timed(9, NOW_S),
        motion=Timed(Motion((x + 0.5, y, z), (0.0, 0.0, 0.0), 0.0), NOW_S),
        home_altitude_amsl_m=altitude_amsl_m(orders.home),
        fix=Timed(GnssFix(6, 20, 0.014, 0.02), NOW_S),
        battery=Timed(BatteryLevel(0.98), NOW_S),
        estimator=Timed(EstimatorHealth(), NOW_S),
        sensor_problems=Timed((), NOW_S),
        wind_enu_m_s=Timed((1.0, 0.0, 0.0), NOW_S),
    )


def checks(state, orders, on_board=ALL_ON_BOARD, needs_rtk=False):
    return preflight_checks(state, orders, on_board, NOW_S, needs_rtk=needs_rtk)


def test_nothing_is_missing_on_a_vehicle_that_is_ready(orders):
    assert is_ready(checks(ready_state(orders), orders))


def test_an_aircraft_beside_a_home_on_the_border_of_the_airspace_is_ready(orders):
    airspace = orders.site.airspace
    border = replace(airspace, max_enu_m=(orders.home_enu_m[0] + 0.2, *airspace.max_enu_m[1:]))
    on_border = replace(orders, site=replace(orders.site, airspace=border))
    assert is_ready(checks(ready_state(orders), on_border)), "it stands 0.3 m outside, beside home"


def test_before_the_first_heartbeat_everything_is_waited_for(orders):
    found = {check.code: check.verdict for check in checks(VehicleState(), orders, OnBoard())}
    assert found.pop("wind") is Verdict.WARN, "nobody knows it"
    assert found.pop("low-flight") is Verdict.OK, "the plan alone says it"
    assert set(found.values()) == {Verdict.WAIT}


def far(metres):
    def move(state, orders):
        x, y, z = orders.home_enu_m
        return replace(state, motion=Timed(Motion((x + metres, y, z), (0.0, 0.0, 0.0), 0.0), NOW_S))

    return move


@pytest.mark.parametrize(
    ("code", "verdict", "change"),
    [
        ("link", Verdict.WAIT, lambda s, o: replace(s, heartbeat=Timed(9, NOW_S - 10.0))),
        ("position", Verdict.WAIT, lambda s, o: replace(s, estimator=Timed(EstimatorHealth("no position yet"), NOW_S))),
        ("gnss", Verdict.WAIT, lambda s, o: replace(s, fix=Timed(GnssFix(2, 5, None, None), NOW_S))),
        ("gnss", Verdict.WAIT, lambda s, o: replace(s, fix=Timed(GnssFix(6, 5, None, None), NOW_S - 60.0))),
        ("home", Verdict.BAD, far(4.0)),
        ("home", Verdict.BAD, far(4000.0)),
        (
            "battery",
            Verdict.BAD,
            lambda s, o: replace(s, battery=Timed(BatteryLevel(o.battery_needed_by(s.autopilot) - 0.01), NOW_S)),
        ),
        ("battery", Verdict.WAIT, lambda s, o: replace(s, battery=Timed(BatteryLevel(None), NOW_S))),
        ("sensors", Verdict.WAIT, lambda s, o: replace(s, sensor_problems=Timed(("pre-arm checks",), NOW_S))),
        ("wind", Verdict.BAD, lambda s, o: replace(s, wind_enu_m_s=Timed((30.0, 0.0, 0.0), NOW_S))),
        # What is in trouble, or not known, may be flown, but is never well.
        ("wind", Verdict.WARN, lambda s, o: replace(s, wind_enu_m_s=None)),
        ("sensors", Verdict.WARN, lambda s, o: replace(s, sensor_problems=Timed(("magnetometer",), NOW_S))),
        ("position", Verdict.WARN, lambda s, o: replace(s, estimator=None)),
        ("home-height", Verdict.WARN, lambda s, o: replace(s, fix=Timed(GnssFix(3, 20, 1.2, 3.5), NOW_S))),
    ],
)
def test_each_thing_that_is_missing_is_found_and_only_that(orders, code, verdict, change):
    found = checks(change(ready_state(orders), orders), orders)
    assert [(check.code, check.verdict) for check in found if check.verdict is not Verdict.OK] == [(code, verdict)]


@pytest.mark.parametrize(
    ("low", "verdict", "words"),
    [
        (
            LowFlight(4.2, 90.0, 300.0),
            Verdict.WARN,
            "down to 4.2 m above the ground, 1:30 min below 10 m, under the usual",
        ),
        (LowFlight(5.0, 30.0, 300.0), Verdict.OK, "down to 5.0 m above the ground, 0:30 min below 10 m"),
        (LowFlight(12.0, 0.0, 300.0), Verdict.OK, "down to 12.0 m above the ground"),
        (LowFlight(3.0, None, None), Verdict.WARN, "down to 3.0 m above the ground, under the usual 5 m"),
    ],
)
def test_how_low_and_how_long_it_flies_low_is_told_before_take_off(orders, low, verdict, words):
    found = checks(ready_state(orders), replace(orders, low=low))
    (check,) = [check for check in found if check.code == "low-flight"]
    assert check.verdict is verdict
    assert check.text.startswith(words)
    assert is_ready(found)


def test_the_orders_of_a_sortie_know_how_low_it_flies(orders):
    assert 5.0 - 1e-3 <= orders.low.lowest_m < 60.0
    assert orders.low.below_s >= 0.0


def test_rtk_is_asked_for_only_where_it_is_needed(orders):
    state = replace(ready_state(orders), fix=Timed(GnssFix(3, 20, 1.5, 0.9), NOW_S))
    assert is_ready(checks(state, orders))
    (check,) = [check for check in checks(state, orders, needs_rtk=True) if check.verdict is not Verdict.OK]
    assert "RTK float is needed" in check.text


def test_a_mission_that_is_not_the_one_sent_grounds_the_flight(orders):
    for on_board, verdict in ((OnBoard(), Verdict.WAIT), (OnBoard(mission=False), Verdict.BAD)):
        (check,) = [check for check in checks(ready_state(orders), orders, on_board) if check.code == "mission"]
        assert check.verdict is verdict
    triangle = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0))
    fenced = replace(orders, fences=dict.fromkeys(Autopilot, (triangle,)))
    codes = [c.code for c in checks(ready_state(orders), fenced, OnBoard(mission=True)) if c.verdict is not Verdict.OK]
    assert codes == ["geofence"]


def test_the_autopilots_own_words_stand_beside_its_refusal(orders):
    state = replace(
        ready_state(orders),
        sensor_problems=Timed(("pre-arm checks",), NOW_S),
        texts=(VehicleText(1.0, 2, "PreArm: compass not healthy"), VehicleText(2.0, 6, "EKF3 active")),
    )
    (check,) = [check for check in checks(state, orders) if check.code == "sensors"]
    assert "PreArm: compass not healthy" in check.text


def test_triggers_are_numbered_as_on_the_vehicle(orders):
    for autopilot, items in orders.items.items():
        photos = orders.surroundings[autopilot].photos
        assert [items[photo.trigger_seq - first_seq(autopilot)].viewpoint_id for photo in photos] == [
            photo.viewpoint_id for photo in photos
        ]
        assert len(photos) == orders.mission.n_photos


def test_a_fence_says_at_each_corner_how_many_there_are():
    fence = ((10.0, 20.0), (10.0, 21.0), (11.0, 20.0))
    sent = fence_messages((fence,), Autopilot.ARDUPILOT)
    assert [(item.command, item.param1, item.x, item.y) for item in sent] == [
        (5002, 3.0, round(lat * 1e7), round(lon * 1e7)) for lat, lon in fence
    ]


def test_parameters_are_in_the_autopilots_units(orders):
    ardupilot = wanted_parameters(Autopilot.ARDUPILOT, orders.mission, 25.0)
    px4 = wanted_parameters(Autopilot.PX4, orders.mission, 25.0)
    assert ardupilot["WPNAV_SPEED"] == 100.0 * px4["MPC_XY_CRUISE"] == 100.0 * orders.mission.speed_m_s
    assert (ardupilot["MNT1_PITCH_MIN"], ardupilot["MNT1_PITCH_MAX"]) == orders.mission.camera.gimbal_pitch_deg
    assert ardupilot["RTL_ALT"] == 100.0 * px4["RTL_RETURN_ALT"] == 2500.0
    assert (ardupilot["WP_YAW_BEHAVIOR"], ardupilot["CAM1_TYPE"]) == (0, 1)


def test_every_message_is_asked_for_by_its_interval():
    for autopilot in Autopilot:
        *intervals, home = message_requests(autopilot, Address(1, 1))
        assert (home.command, home.param1) == (512, 242.0)
        assert all(command.command == 511 and 1e4 < command.param2 <= 2e6 for command in intervals)


def test_longer_holds_take_as_much_longer(orders):
    for autopilot in Autopilot:
        items = orders.items[autopilot]
        index = next(i for i, item in enumerate(items) if item.command in (203, 2000)) + 1
        longer = replace(items[index], params=(items[index].params[0] + 7.0, *items[index].params[1:]))
        changed = replace(orders, items={autopilot: (*items[:index], longer, *items[index + 1 :])})
        assert items_duration_s(changed, autopilot) - items_duration_s(orders, autopilot) == pytest.approx(7.0)


def test_the_battery_must_last_for_the_autopilot_that_is_there_not_for_the_plans_aircraft(orders):
    """PX4 takes nearly twice as long for a plan that reckons with ArduPilot."""
    aircraft, planned = orders.mission.aircraft, orders.battery_needed
    slow = replace(orders, autopilot_s={Autopilot.PX4: orders.mission.duration_s + 0.2 * aircraft.endurance_s})
    for autopilot, needed in ((Autopilot.ARDUPILOT, planned), (Autopilot.PX4, planned + 0.2)):
        assert slow.battery_needed_by(autopilot) == pytest.approx(needed)
        state = charged(replace(ready_state(slow), autopilot=autopilot), needed - 0.01)
        (check,) = [check for check in checks(state, slow) if check.code == "battery"]
        assert check.verdict is Verdict.BAD
        assert ("PX4 flies it in" in check.text) == (autopilot is Autopilot.PX4)
    faster = replace(orders, autopilot_s={Autopilot.PX4: 1.0})
    assert faster.battery_needed_by(Autopilot.PX4) == planned, "never less than the plan says"


def test_a_sortie_that_no_battery_lasts_for_is_not_cured_by_a_full_one(orders):
    long = replace(orders, battery_needed=1.7)
    (check,) = [check for check in checks(ready_state(orders), long) if check.verdict is not Verdict.OK]
    assert (check.code, check.verdict) == ("battery", Verdict.BAD)
    assert "shorter sorties" in check.text
    assert "full one" not in check.text


# The height of home


def home_height(state, orders):
    (found,) = [check for check in checks(state, orders) if check.code == "home-height"]
    return found


def standing(orders, above_m, **changes):
    """Above the planned home, with heights counted from there."""
    return replace(ready_state(orders), home_altitude_amsl_m=altitude_amsl_m(orders.home) + above_m, **changes)


@pytest.mark.parametrize(
    ("above_m", "verdict", "words"),
    [
        (
            -3.0,
            Verdict.BAD,
            "stands 3.0 m lower than the planned home, and all of the flight would be: raise it by 3.0 m",
        ),
        (
            10.0,
            Verdict.BAD,
            "stands 10.0 m higher than the planned home, and all of the flight would be: lower it by 10.0",
        ),
        (-1.05, Verdict.BAD, "plan from here"),
        (0.9, Verdict.OK, "0.9 m above"),
        (-0.95, Verdict.OK, "below the planned home"),
    ],
)
def test_an_aircraft_that_stands_at_another_height_than_planned_is_grounded(orders, above_m, verdict, words):
    state = standing(orders, above_m, fix=Timed(GnssFix(6, 20, 0.014, None), NOW_S))
    found = home_height(state, orders)
    assert found.verdict is verdict
    assert words in found.text
    assert found.value == pytest.approx(above_m)
    assert is_ready(checks(state, orders)) is (verdict is Verdict.OK)


def test_baro_drift_before_arming_is_no_other_place(orders):
    """The vehicle counts from 4 m below and says that it is 4 m up: it stands where it should."""
    motion = ready_state(orders).motion
    up = replace(motion, value=replace(motion.value, height_above_home_m=4.0))
    assert home_height(standing(orders, -4.0, motion=up), orders).verdict is Verdict.OK


@pytest.mark.parametrize(("geoid_m", "verdict"), [(None, Verdict.OK), (0.0, Verdict.BAD)])
def test_the_receivers_own_geoid_counts_where_it_tells_it(orders, geoid_m, verdict):
    """One that takes the geoid for the ellipsoid is off by what lies between them."""
    fix = GnssFix(6, 20, 0.014, 0.02, geoid_m)
    assert home_height(standing(orders, 0.0, fix=Timed(fix, NOW_S)), orders).verdict is verdict
    between_m = orders.home.height_ellipsoid_m - altitude_amsl_m(orders.home)
    told = replace(fix, geoid_m=between_m + 5.0)
    assert home_height(standing(orders, -5.0, fix=Timed(told, NOW_S)), orders).verdict is Verdict.OK


@pytest.mark.parametrize(("autopilot", "verdict"), [(Autopilot.ARDUPILOT, Verdict.WARN), (Autopilot.PX4, Verdict.BAD)])
@pytest.mark.parametrize("off_m", [-3.0, 10.0])
def test_a_home_of_the_vehicles_own_at_another_height_is_told(orders, autopilot, verdict, off_m):
    told_m = altitude_amsl_m(orders.home) + off_m
    state = standing(orders, 0.0, autopilot=autopilot, home_position_amsl_m=told_m)
    found = home_height(state, orders)
    assert found.verdict is verdict
    assert f"own home lies {abs(off_m):.1f} m {'higher' if off_m > 0 else 'lower'}" in found.text


def test_a_raised_flight_passes_through_the_same_places(orders):
    """From 3 m lower, all heights above take-off are 3 m larger."""
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=3, greedy=QUICK, profile_id="ardupilot")).plan
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    plain, raised = (sortie_orders(plan, model, mission, by_m) for by_m in (0.0, 3.0))
    for autopilot in Autopilot:
        for one, other in zip(*(to_wire(each.items[autopilot], autopilot) for each in (plain, raised)), strict=True):
            is_up = one.command in (16, 22) and one.frame == 3
            assert other.z - one.z == pytest.approx(3.0 if is_up else 0.0, abs=1e-4)
    assert raised.home_enu_m[2] == plain.home_enu_m[2] - 3.0
    assert raised.return_height_m == plain.return_height_m + 3.0
    assert home_height(standing(plain, -3.0), raised).verdict is Verdict.OK
    with pytest.raises(MissionError, match="plan it from where the aircraft stands"):
        sortie_orders(plan, model, mission, -40.0)
