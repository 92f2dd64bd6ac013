"""What a vehicle will do by itself, told and judged before take-off; rally points on board."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.vehicle.failsafes import NAMES, failsafe_checks, return_of
from groundstation.vehicle.orders import rally_messages, sortie_orders
from groundstation.vehicle.parameters import ATTEMPT_S, N_ROUNDS, ParameterReads
from groundstation.vehicle.preflight import Verdict
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, MissionItemInt, ParamValue, Received
from missions.mission.build import missions_from_plan
from missions.simulator.autopilot.profiles import vehicle_profile
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.records import Obstacle, RallyPoint, box_geometry
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK
from tests.vehicle.sortie.test_flight_run import toy_at_home
from tests.vehicle.toy import ToyLink

VEHICLE = Address(1, 1)
ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4


@pytest.fixture(scope="module")
def planned():
    model = kiosk()
    return model, plan_flight(model, PlanRequest(n_views=6, greedy=QUICK)).plan


def orders_of(planned, *places):
    model, plan = planned
    points = tuple(RallyPoint(f"rally-{n}", place) for n, place in enumerate(places, 1))
    model = replace(model, site=replace(model.site, rally_points=points))
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return sortie_orders(plan, model, mission)


def values(autopilot, **changes):
    """Of a vehicle out of the box, but for a return above everything."""
    usual = {name: float(vehicle_profile(autopilot).parameters[name]) for name in NAMES[autopilot]}
    return {**usual, **({"RTL_ALT": 5000.0} if autopilot is ARDUPILOT else {}), **changes}


def found(orders, autopilot, code, **changes):
    checks = failsafe_checks(autopilot, values(autopilot, **changes), orders)
    return next((check for check in checks if check.code == code), None)


@pytest.mark.few(4)
@pytest.mark.parametrize(
    ("autopilot", "changes", "verdict", "words"),
    [
        (ARDUPILOT, {}, Verdict.OK, "continue mission"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 1.0}, Verdict.OK, "5 s without the link, and it breaks the mission off"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 1.0, "FS_OPTIONS": 2.0}, Verdict.OK, "continue mission"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 5.0}, Verdict.WARN, "lands, whatever is below"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 7.0}, Verdict.WARN, "hovers until its battery is low"),
        (ARDUPILOT, {"FS_GCS_ENABLE": 42.0}, Verdict.WARN, "is not known (FS_GCS_ENABLE 42)"),
        (PX4, {}, Verdict.OK, "continue mission"),
        (PX4, {"NAV_DLL_ACT": 2.0}, Verdict.OK, "10 s without the link"),
        (PX4, {"NAV_DLL_ACT": 2.0, "COM_DLL_EXCEPT": 1.0}, Verdict.OK, "continue mission"),
        (PX4, {"NAV_DLL_ACT": 5.0}, Verdict.BAD, "stops its motors and falls"),
    ],
)
def test_what_happens_when_the_link_is_lost_is_told(planned, autopilot, changes, verdict, words):
    check = found(orders_of(planned), autopilot, "link-loss", **changes)
    assert check.verdict is verdict
    assert words in check.text


@pytest.mark.few(10)
@pytest.mark.parametrize(
    ("autopilot", "code", "changes", "verdict", "words"),
    [
        (
            ARDUPILOT,
            "rc-loss",
            {},
            Verdict.OK,
            "1 s without the remote control, and it breaks the mission off and returns",
        ),
        (ARDUPILOT, "rc-loss", {"FS_THR_ENABLE": 0.0}, Verdict.OK, "continue mission (FS_THR_ENABLE 0)"),
        (ARDUPILOT, "rc-loss", {"FS_OPTIONS": 1.0}, Verdict.OK, "continue mission (FS_OPTIONS 1)"),
        (ARDUPILOT, "rc-loss", {"FS_THR_ENABLE": 3.0}, Verdict.WARN, "lands, whatever is below it"),
        (PX4, "rc-loss", {}, Verdict.OK, "0.5 s without the remote control, and it breaks the mission off"),
        (PX4, "rc-loss", {"NAV_RCL_ACT": 1.0}, Verdict.WARN, "hovers"),
        (PX4, "rc-loss", {"NAV_RCL_ACT": 6.0}, Verdict.BAD, "stops its motors and falls"),
        (PX4, "rc-loss", {"NAV_RCL_ACT": 6.0, "COM_RCL_EXCEPT": 1.0}, Verdict.OK, "continue mission"),
        (PX4, "rc-loss", {"COM_RC_IN_MODE": 4.0}, Verdict.WARN, "takes no remote control"),
        (ARDUPILOT, "battery-low", {}, Verdict.WARN, "nothing is done by itself when the battery is low"),
        (ARDUPILOT, "battery-low", {"BATT_FS_LOW_ACT": 2.0}, Verdict.OK, "below 10.5 V, and it breaks the mission off"),
        (ARDUPILOT, "battery-low", {"BATT_FS_LOW_ACT": 2.0, "BATT_LOW_VOLT": 0.0}, Verdict.WARN, "nothing is done"),
        (ARDUPILOT, "battery-low", {"BATT_FS_LOW_ACT": 1.0}, Verdict.WARN, "lands, whatever is below it"),
        (
            ARDUPILOT,
            "battery-low",
            {"BATT_FS_CRT_ACT": 1.0, "BATT_CRT_VOLT": 9.9},
            Verdict.OK,
            "below 9.9 V, and it lands",
        ),
        (ARDUPILOT, "battery-low", {"BATT_FS_LOW_ACT": 5.0}, Verdict.BAD, "falls"),
        (PX4, "battery-low", {}, Verdict.WARN, "nothing is done by itself"),
        (PX4, "battery-low", {"COM_LOW_BAT_ACT": 3.0}, Verdict.OK, "below 7%, and it breaks the mission off"),
        (PX4, "battery-low", {"COM_LOW_BAT_ACT": 2.0}, Verdict.OK, "below 7%, and it lands"),
        (ARDUPILOT, "position-loss", {}, Verdict.OK, "it lands, whatever is below it (FS_EKF_ACTION 1)"),
        (ARDUPILOT, "position-loss", {"FS_EKF_ACTION": 2.0}, Verdict.WARN, "drifts with the wind: take over at once"),
        (ARDUPILOT, "position-loss", {"FS_EKF_THRESH": 0.0}, Verdict.WARN, "(FS_EKF_THRESH 0)"),
        (PX4, "position-loss", {}, Verdict.WARN, "drifts with the wind"),
        (PX4, "position-loss", {"COM_POSCTL_NAVL": 1.0}, Verdict.OK, "lands"),
    ],
)
def test_what_happens_without_remote_control_charge_or_position_is_told(
    planned, autopilot, code, changes, verdict, words
):
    check = found(orders_of(planned), autopilot, code, **changes)
    assert words in check.text
    assert check.verdict is verdict


def test_a_battery_limit_that_ends_the_mission_early_is_told(planned):
    """A sortie that leaves 70 % is broken off where the vehicle returns at 80 %."""
    orders = orders_of(planned)
    reserve = orders.surroundings[ARDUPILOT].rules.battery_reserve
    orders = replace(orders, battery_needed=0.3 + reserve, autopilot_s={})
    limits = {"BATT_FS_LOW_ACT": 2.0, "BATT_LOW_VOLT": 0.0, "BATT_CAPACITY": 3300.0}
    early = found(orders, ARDUPILOT, "battery-low", **limits, BATT_LOW_MAH=0.8 * 3300.0)
    assert early.verdict is Verdict.WARN
    assert "at a charge of 80%, and the sortie ends with 70%: set BATT_LOW_MAH" in early.text
    assert found(orders, ARDUPILOT, "battery-low", **limits, BATT_LOW_MAH=0.2 * 3300.0).verdict is Verdict.OK
    px4 = {"COM_LOW_BAT_ACT": 3.0, "BAT_CRIT_THR": 0.75}
    assert "set BAT_CRIT_THR" in found(orders, PX4, "battery-low", **px4).text


@pytest.mark.parametrize("autopilot", Autopilot)
def test_a_vehicle_that_does_not_say_is_not_taken_for_safe(planned, autopilot):
    checks = {check.code: check for check in failsafe_checks(autopilot, {}, orders_of(planned))}
    assert checks["link-loss"].verdict is checks["return"].verdict is Verdict.WARN


@pytest.mark.parametrize(("autopilot", "name", "factor"), [(ARDUPILOT, "RTL_ALT", 100.0), (PX4, "RTL_RETURN_ALT", 1.0)])
def test_a_return_through_the_building_grounds_until_the_height_suffices(planned, autopilot, name, factor):
    """Of an aircraft behind it; at the height that an upload would set, all is well."""
    plan, orders = planned[1], orders_of(planned)
    behind = np.array([[0.0, 22.0, 5.0], [0.0, 22.0, 5.0]])
    around = {each: replace(orders.surroundings[each], path_enu_m=behind) for each in Autopilot}
    orders = replace(orders, surroundings=around)
    changes = {"RTL_CONE_SLOPE": 0.0} if autopilot is ARDUPILOT else {}
    low = found(orders, autopilot, "return", **changes, **{name: 6.0 * factor})
    assert low.verdict is Verdict.BAD
    assert "straight through the building" in low.text
    assert f"set {name}" in low.text
    high = found(orders, autopilot, "return", **changes, **{name: orders.return_height_m * factor})
    assert high.verdict is Verdict.OK
    assert high.value >= plan.constraints.min_distance_m - 0.5
    above = found(orders, autopilot, "return", **changes, **{name: 200.0 * factor})
    assert above.verdict is Verdict.BAD
    assert "above the airspace, which ends" in above.text
    assert above.limit == pytest.approx(around[autopilot].space.high_enu_m[2] - orders.home_enu_m[2])


@pytest.mark.parametrize("autopilot", Autopilot)
def test_a_climb_beside_something_that_juts_out_is_a_warning_because_no_height_is_better(planned, autopilot):
    """Aircraft return straight up first: from beside and below a thing, that leads nearer to it."""
    model, plan = planned
    sign = Obstacle("sign", box_enu_m=((14.5, -24.5, 22.0), (15.5, -23.5, 24.0)))
    hung = replace(model, site=replace(model.site, obstacles=(sign,)), obstacles=(box_geometry(sign),))
    orders = orders_of((hung, plan))
    beside = np.array([[23.0, -24.0, 12.0], [23.0, -24.0, 12.0]])
    around = {each: replace(orders.surroundings[each], path_enu_m=beside) for each in Autopilot}
    orders = replace(orders, surroundings=around, return_height_m=34.0)
    name, factor = ("RTL_ALT", 100.0) if autopilot is ARDUPILOT else ("RTL_RETURN_ALT", 1.0)
    check = found(orders, autopilot, "return", **{name: 34.0 * factor})
    assert check.verdict is Verdict.WARN
    assert check.text.startswith("it climbs within 7.5 m of the building or an obstacle before it returns (34 m above")
    low = found(orders, autopilot, "return", **{name: 20.0 * factor})
    assert low.verdict is Verdict.BAD, "it need not come that near"


@pytest.mark.parametrize(("angle_deg", "slope"), [(0.0, 0.0), (45.0, 1.0), (65.0, 0.4663), (80.0, 0.1763)])
def test_px4s_cone_lets_it_return_lower_close_to_home(planned, angle_deg, slope):
    orders = orders_of(planned)
    of = return_of(PX4, values(PX4, RTL_CONE_ANG=angle_deg), orders)
    assert of.cone_slope == pytest.approx(slope, abs=1e-4)
    flat = return_of(PX4, values(PX4, RTL_CONE_ANG=90.0, RTL_DESCEND_ALT=12.0), orders)
    assert (flat.height_m, flat.height_name) == (12.0, "RTL_DESCEND_ALT")


def test_a_return_through_the_building_is_flown_only_where_the_pilot_overrules_it(planned):
    orders = orders_of(planned)
    behind = np.array([[0.0, 22.0, 5.0], [0.0, 22.0, 5.0]])
    around = {each: replace(orders.surroundings[each], path_enu_m=behind) for each in Autopilot}
    orders = replace(orders, surroundings=around)
    low = {"RTL_ALT": 600.0, "CAM1_TYPE": 1.0, "MNT1_TYPE": 1.0}
    options = RunOptions(connect_s=10.0, ready_s=20.0)
    toy = toy_at_home(orders, parameters=dict(low))
    _, outcome = fly(orders, toy, options)
    assert "straight through the building" in str(outcome.error)
    assert not toy.has_flown
    toy = toy_at_home(orders, parameters=dict(low))
    run, outcome = fly(orders, toy, replace(options, overrules=frozenset({"return"})))
    assert outcome.succeeded
    (told,) = [check for check in run.checks() if check.code == "return"]
    assert (told.verdict, told.text[-12:]) == (Verdict.WARN, " (overruled)")
    # What cannot be overruled stays.
    toy = toy_at_home(orders, battery=5, parameters=dict(low))
    _, outcome = fly(orders, toy, replace(options, overrules=frozenset({"return", "battery"})))
    assert "battery holds 5%" in str(outcome.error)


def test_rally_points_count_as_the_parameters_have_it(planned):
    orders = orders_of(planned, (20.0, -28.0, 0.0))
    home, rally = orders.home_enu_m, (20.0, -28.0, 0.0)
    assert return_of(ARDUPILOT, values(ARDUPILOT), orders).destinations_enu_m == (home, rally)
    assert return_of(ARDUPILOT, values(ARDUPILOT, RALLY_INCL_HOME=0.0), orders).destinations_enu_m == (rally,)
    for kind, places in (
        (0, (home, rally)),
        (1, (rally,)),
        (2, (home,)),
        (3, (home, rally)),
        (4, (home,)),
        (5, (rally,)),
    ):
        assert return_of(PX4, values(PX4, RTL_TYPE=float(kind)), orders).destinations_enu_m == places
    assert return_of(PX4, values(PX4, RTL_TYPE=1.0), orders_of(planned)).destinations_enu_m == (home,)


@pytest.mark.parametrize(
    ("autopilot", "changes", "verdict", "words"),
    [
        (ARDUPILOT, {}, Verdict.WARN, "nothing keeps the aircraft from leaving it (FENCE_ENABLE 0)"),
        (ARDUPILOT, {"FENCE_ENABLE": 1.0}, Verdict.OK, "it returns (FENCE_ACTION 1)"),
        (ARDUPILOT, {"FENCE_ENABLE": 1.0, "FENCE_ACTION": 0.0}, Verdict.WARN, "nothing keeps"),
        (ARDUPILOT, {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 3.0}, Verdict.WARN, "(FENCE_TYPE 3)"),
        (PX4, {}, Verdict.OK, "it hovers (GF_ACTION 2)"),
        (PX4, {"GF_ACTION": 4.0}, Verdict.BAD, "falls"),
        (PX4, {"GF_ACTION": 5.0}, Verdict.OK, "it lands"),
    ],
)
def test_what_happens_at_the_geofence_is_told_where_there_is_one(planned, autopilot, changes, verdict, words):
    orders = orders_of(planned)
    assert orders.fences[autopilot]
    check = found(orders, autopilot, "fence-action", **changes)
    assert check.verdict is verdict
    assert words in check.text
    assert found(replace(orders, fences={}), autopilot, "fence-action", **changes) is None


def room_m(orders, autopilot):
    """How high and how far from home the sortie goes."""
    x, y, z = (orders.surroundings[autopilot].path_enu_m - np.array(orders.home_enu_m)).T
    return {"fence-height": float(z.max()), "fence-radius": float(np.hypot(x, y).max())}


LIMITS = [
    (ARDUPILOT, "fence-height", "FENCE_ALT_MAX", {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 1.0}),
    (ARDUPILOT, "fence-radius", "FENCE_RADIUS", {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 2.0}),
    (PX4, "fence-height", "GF_MAX_VER_DIST", {}),
    (PX4, "fence-radius", "GF_MAX_HOR_DIST", {}),
]


@pytest.mark.few(6)
@pytest.mark.parametrize(("autopilot", "code", "name", "changes"), LIMITS)
@pytest.mark.parametrize(
    ("more_m", "verdict"), [(-0.1, Verdict.BAD), (0.1, Verdict.WARN), (1.9, Verdict.WARN), (2.1, Verdict.OK)]
)
def test_a_sortie_beyond_the_vehicles_own_limits_stays_on_the_ground(
    planned, autopilot, code, name, changes, more_m, verdict
):
    orders = orders_of(planned)
    limit_m = room_m(orders, autopilot)[code] + more_m
    check = found(orders, autopilot, code, **changes, **{name: limit_m})
    assert (check.verdict, check.value) == (verdict, pytest.approx(more_m))
    assert name in check.text
    other = {"fence-height": "fence-radius", "fence-radius": "fence-height"}[code]
    assert found(orders, autopilot, other, **changes, **{name: limit_m}) is None


@pytest.mark.parametrize(("autopilot", "code", "name", "changes"), LIMITS)
def test_limits_that_are_switched_off_say_nothing_and_those_that_only_tell_ground_nothing(
    planned, autopilot, code, name, changes
):
    orders = orders_of(planned)
    action = "FENCE_ACTION" if autopilot is ARDUPILOT else "GF_ACTION"
    off = {"FENCE_ENABLE": 0.0} if autopilot is ARDUPILOT else {name: 0.0}
    assert found(orders, autopilot, code, **{**changes, name: 1.0, **off}) is None
    assert found(orders, autopilot, code, **changes, **{name: 1.0, action: 0.0}).verdict is Verdict.WARN


def test_the_fences_margin_is_the_vehicles_own(planned):
    orders = orders_of(planned)
    fence = {"FENCE_ENABLE": 1.0, "FENCE_ALT_MAX": room_m(orders, ARDUPILOT)["fence-height"] + 4.0}
    assert found(orders, ARDUPILOT, "fence-height", **fence).verdict is Verdict.OK
    assert found(orders, ARDUPILOT, "fence-height", **fence, FENCE_MARGIN=5.0).verdict is Verdict.WARN


def test_ardupilot_returns_no_higher_than_its_fence_lets_it(planned):
    fence = {"FENCE_ENABLE": 1.0, "FENCE_ALT_MAX": 40.0}
    way = return_of(ARDUPILOT, values(ARDUPILOT, **fence), orders_of(planned))
    assert (way.height_m, way.height_name) == (38.0, "FENCE_ALT_MAX")
    way = return_of(ARDUPILOT, values(ARDUPILOT, **fence, FENCE_TYPE=6.0), orders_of(planned))
    assert (way.height_m, way.height_name) == (50.0, "RTL_ALT")


def test_a_sortie_above_the_height_fence_does_not_take_off(planned):
    orders = orders_of(planned)
    toy = toy_at_home(orders)
    toy.parameters |= {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 1.0, "FENCE_ALT_MAX": 3.0, "FENCE_ACTION": 1.0}
    _, outcome = fly(orders, toy)
    assert "raise FENCE_ALT_MAX" in str(outcome.error)


def test_several_parameters_are_read_at_once_and_unknown_ones_are_given_up():
    reads = ParameterReads(("A", "B", "C"), ARDUPILOT, VEHICLE)
    assert [message.param_id for message in reads.start(0.0)] == ["A", "B", "C"]
    reads.receive(Received(ParamValue("B", 2.0, 9, 1, 0), VEHICLE, 0.1))
    reads.receive(Received(ParamValue("X", 2.0, 9, 1, 0), VEHICLE, 0.1))
    reads.receive(Received(ParamValue("A", 2.0, 9, 1, 0), Address(2, 1), 0.1))
    now_s, n_asked = 0.0, 1
    while reads.outcome is None:
        now_s += ATTEMPT_S
        asked = reads.tick(now_s)
        assert {message.param_id for message in asked} <= {"A", "C"}
        n_asked += bool(asked)
    assert reads.outcome == {"B": 2.0}
    assert n_asked == N_ROUNDS


SETS = RunOptions(sets_parameters=True, connect_s=10.0, ready_s=20.0)


def fly(orders, toy, options=SETS):
    run = FlightRun(orders, options, "toy")
    return run, conduct(run, ToyLink(toy), lambda: toy.now_s)


def test_rally_points_of_the_site_are_put_on_board_and_read_back(planned):
    orders = orders_of(planned, (20.0, -28.0, 0.0), (-10.0, -30.0, 1.0))
    toy = toy_at_home(orders)
    run, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert run.on_board.rally is True
    assert [(item.command, item.x, item.y, item.z) for item in toy.rally] == [
        (5100, item.x, item.y, item.z) for item in rally_messages(orders, ARDUPILOT)
    ]
    assert toy.rally[1].z == pytest.approx(1.0, abs=0.01)


def test_rally_points_of_another_flight_are_cleared_and_the_pilot_is_told(planned):
    orders = orders_of(planned)
    toy = toy_at_home(orders, rally=[MissionItemInt(1, 1, 0, 3, 5100, 0, 1, 0, 0, 0, 0, 10, 10, 5.0, 2)])
    run, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert toy.rally == []
    assert "the vehicle had 1 rally points of another flight" in str([note.text for note in outcome.notes])
    assert [check.verdict for check in run.on_board.failsafes if check.code == "rally"] == [Verdict.WARN]


def test_where_there_are_none_on_board_nothing_is_said_or_sent(planned):
    orders = orders_of(planned)
    run, outcome = fly(orders, toy_at_home(orders))
    assert outcome.succeeded
    assert not [note for note in outcome.notes if note.code == "warning-rally"]
    assert run.on_board.rally is True, "known to be empty"
