"""Warnings: in time, not too early, and without flicker."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.vehicle.state import (
    Angles,
    BatteryLevel,
    EstimatorHealth,
    GnssFix,
    Landed,
    MissionProgress,
    Motion,
    Timed,
    VehicleState,
)
from groundstation.vehicle.surroundings import ExpectedPhoto, Surroundings
from groundstation.vehicle.watch import (
    APART_TOLERANCE_M,
    HOLD_S,
    PHOTO_LATE_S,
    STALE_S,
    OtherAircraft,
    Watch,
    WatchRules,
    stop_point,
    watched,
    ways_apart_m,
)
from missions.flight.record import TakenPhoto
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address
from planning.base.findings import Severity
from planning.base.messages import plain
from planning.parameters import FlightRules
from planning.plan import Aircraft
from planning.site.bundled import single_panel
from planning.site.free_space import unchecked_space

AIRCRAFT = Aircraft("test", 1000.0, 10.0, max_acceleration_m_s2=2.5, max_wind_m_s=10.0, max_descent_m_s=2.0)
RULES = FlightRules(battery_reserve=0.25, takeoff_landing_s=30.0)


@pytest.fixture(scope="module")
def around():
    """Before a single pane that looks along its normal; the path leads straight away from it."""
    space = unchecked_space(single_panel(), 10.0)
    return Surroundings(space, AIRCRAFT, RULES, np.zeros((0, 3)))


@pytest.fixture(scope="module")
def outwards(around):
    """Centre of the pane and its outward direction."""
    corners = around.space.solids.bvh.corners.reshape(-1, 3)
    centre = corners.mean(axis=0)
    middle = (around.space.low_enu_m + around.space.high_enu_m) / 2.0
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    return centre, normal if normal @ (middle - centre) > 0 else -normal


def flying(place, velocity=(0.0, 0.0, 0.0), mode="AUTO", now_s=100.0, **changes):
    state = VehicleState(
        address=Address(1, 1),
        autopilot=Autopilot.ARDUPILOT,
        heartbeat=Timed(100, now_s),
        mode=Timed(mode, now_s),
        armed=Timed(True, now_s),
        landed=Timed(Landed.IN_AIR, now_s),
        motion=Timed(Motion(tuple(map(float, place)), tuple(map(float, velocity)), 20.0), now_s),
        attitude=Timed(Angles(0.0, 0.0, 0.0), now_s),
    )
    return replace(state, **changes)


DEFAULTS = WatchRules()


def codes(state, around, now_s=100.0, rules=DEFAULTS):
    return watched(Watch(), state, around, now_s, rules).codes()


def test_stop_point_is_where_braking_ends():
    motion = Motion((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), 0.0)
    assert stop_point(motion, 2.5, 0.0) == pytest.approx((3.0, 4.0, 0.0))  # 25 / 5 = 5 m ahead
    assert stop_point(motion, 2.5, 2.0) == pytest.approx((9.0, 12.0, 0.0))


def test_a_facade_is_warned_of_while_the_aircraft_can_still_stop(around, outwards):
    centre, normal = outwards
    braking_m = 5.0**2 / (2.0 * 2.5)
    for away_m, expected in ((10.0 + braking_m + 0.1, False), (9.4 + braking_m, True)):
        state = flying(centre + away_m * normal, -5.0 * normal)
        assert ("facade-distance" in codes(state, around)) is expected
        assert "facade-distance" not in codes(flying(centre + away_m * normal, 5.0 * normal), around)


def test_without_a_mission_that_brakes_the_pilots_reaction_counts(around, outwards):
    centre, normal = outwards
    state = flying(centre + 20.0 * normal, -5.0 * normal)
    assert "facade-distance" not in codes(state, around)
    assert "facade-distance" in codes(replace(state, mode=Timed("LOITER", 100.0)), around)


def test_too_close_already_is_worse_than_soon(around, outwards):
    centre, normal = outwards
    (near,) = [w for w in watched(Watch(), flying(centre + 9 * normal), around, 0.0).warnings if "facade" in w.code]
    assert (near.severity, near.limit, near.unit) == (Severity.ERROR, 9.5, "m")
    assert near.value == pytest.approx(9.0, abs=1e-6)


def test_hovering_at_the_planned_distance_is_no_warning(around, outwards):
    centre, normal = outwards
    assert codes(flying(centre + 9.8 * normal), around) == frozenset()


def test_on_the_ground_nothing_is_too_near(around, outwards):
    centre, normal = outwards
    state = flying(centre + 5.0 * normal)
    assert codes(replace(state, landed=Timed(Landed.ON_GROUND, 100.0)), around) == frozenset()
    assert codes(replace(state, armed=Timed(False, 100.0)), around) == frozenset()


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(distances=st.lists(st.floats(9.3, 9.7), min_size=20, max_size=60))
def test_warnings_never_flicker(around, outwards, distances):
    centre, normal = outwards
    watch, changes, was = Watch(), [], False
    for i, distance_m in enumerate(distances):
        now_s = 0.2 * i
        watch = watched(watch, flying(centre + distance_m * normal, now_s=now_s), around, now_s)
        is_on = "facade-distance" in watch.codes()
        if is_on != was:
            changes.append(now_s)
        was = is_on
    # With 0.25 m of slack around 9.5 m nothing in this band takes a warning away again.
    assert len(changes) <= 1


def test_a_warning_goes_only_after_a_while_and_with_slack(around, outwards):
    centre, normal = outwards
    watch = watched(Watch(), flying(centre + 9.0 * normal, now_s=0.0), around, 0.0)
    for now_s, away_m, expected in ((1.0, 12.0, True), (HOLD_S, 9.6, True), (HOLD_S, 12.0, False)):
        after = watched(watch, flying(centre + away_m * normal, now_s=now_s), around, now_s)
        assert ("facade-distance" in after.codes()) is expected


def test_wind_is_spoken_of_before_the_limit_and_loudly_above(around, outwards):
    centre, normal = outwards
    place = centre + 20.0 * normal
    for wind_m_s, severity in ((8.0, None), (9.0, Severity.WARNING), (10.5, Severity.ERROR)):
        state = flying(place, wind_enu_m_s=Timed((0.0, -wind_m_s, 0.0), 100.0))
        found = [w.severity for w in watched(Watch(), state, around, 100.0).warnings if w.code == "wind"]
        assert found == ([severity] if severity else [])


def test_the_battery_must_hold_the_way_home(around):
    home = around.space.home_enu_m
    place = home + np.array([0.0, 0.0, 40.0])
    needed = 0.25 + (40.0 / 2.0 + 15.0) / 1000.0
    assert around.way_home_s(tuple(place)) == pytest.approx(35.0)
    cases = (
        (needed + 0.06, None),
        (needed + 0.03, Severity.WARNING),
        (needed - 0.01, Severity.ERROR),
        (0.2, Severity.ERROR),
    )
    for level, severity in cases:
        state = flying(place, battery=Timed(BatteryLevel(level), 100.0))
        found = [w.severity for w in watched(Watch(), state, around, 100.0).warnings if w.code == "battery"]
        assert found == ([severity] if severity else [])


def test_a_battery_that_says_nothing_is_not_judged(around, outwards):
    centre, normal = outwards
    assert codes(flying(centre + 20 * normal, battery=Timed(BatteryLevel(None), 100.0)), around) == frozenset()


def test_the_airspace_is_warned_of_on_the_way_out(around):
    low, high = around.space.low_enu_m, around.space.high_enu_m
    edge = (low + high) / 2.0
    edge[0] = high[0] - 2.0
    assert "airspace" not in codes(flying(edge), around)
    assert "airspace" in codes(flying(edge, (6.0, 0.0, 0.0)), around)
    outside = edge + np.array([4.0, 0.0, 0.0])
    (warning,) = [w for w in watched(Watch(), flying(outside), around, 0.0).warnings if w.code == "airspace"]
    assert "2.0 m outside" in warning.text


def test_taking_off_below_the_floor_is_no_breach(around):
    home = around.space.home_enu_m
    assert "airspace" not in codes(flying(home + np.array([0.5, 0.0, 0.5]), (0.0, 0.0, 2.0)), around)


def test_a_fix_is_missed_as_far_as_it_is_needed(around, outwards):
    centre, normal = outwards
    place = centre + 20.0 * normal
    for fix_type, needs_rtk, severity in ((3, False, None), (3, True, Severity.WARNING), (2, False, Severity.ERROR)):
        state = flying(place, fix=Timed(GnssFix(fix_type, 12, None, None), 100.0))
        found = watched(Watch(), state, around, 100.0, WatchRules(needs_rtk)).warnings
        assert [w.severity for w in found if w.code == "gnss"] == ([severity] if severity else [])


def test_a_fix_that_is_not_heard_of_any_more_is_lost(around, outwards):
    centre, normal = outwards
    state = flying(centre + 20.0 * normal, fix=Timed(GnssFix(6, 12, None, None), 90.0))
    assert "gnss" in codes(state, around)


def test_losing_the_link_shows_and_says_nothing_else(around, outwards):
    centre, normal = outwards
    state = flying(centre + 9.0 * normal, fix=Timed(GnssFix(6, 12, None, None), 100.0), now_s=100.0)
    assert codes(state, around, 120.0) == {"link-lost"}


def test_the_deviation_from_the_planned_path_is_that_of_its_nearest_leg(around, outwards):
    centre, normal = outwards
    start, end = centre + 20.0 * normal, centre + 30.0 * normal
    on_path = replace(around, path_enu_m=np.array([start, end, end]))
    beside = start + 5.0 * normal + np.array([0.0, 0.0, 3.0])
    assert on_path.off_path_m(tuple(beside)) == pytest.approx(3.0)
    assert on_path.off_path_m(tuple(end + normal)) == pytest.approx(1.0)
    assert "off-path" in codes(flying(beside), on_path)
    assert "off-path" not in codes(flying(beside, mode="RTL"), on_path)


def test_a_photo_that_stays_away_is_named(around, outwards):
    centre, normal = outwards
    places = [tuple(centre + (20.0 + 4.0 * i) * normal) for i in range(3)]
    photos = tuple(ExpectedPhoto(f"v{i}", place, 10 + 5 * i) for i, place in enumerate(places))
    expecting = replace(around, photos=photos)
    taken = (TakenPhoto(1, 0.0, places[0]),)
    state = flying(places[1], photos=taken, mission=Timed(MissionProgress(18, 30), 100.0))
    watch = watched(Watch(), state, expecting, 100.0)
    assert watch.passed_s == (("v1", 100.0),)
    assert "photo-missing" not in watch.codes(), "it may still be on its way"
    later = 100.1 + PHOTO_LATE_S
    watch = watched(watch, state, expecting, later)
    (warning,) = [w for w in watch.warnings if w.code == "photo-missing"]
    assert "'v1'" in warning.text
    found = replace(state, photos=(*taken, TakenPhoto(2, 0.0, places[1])))
    assert watched(watch, found, expecting, later + HOLD_S).codes() <= {"link-lost"}


def test_a_photo_is_not_missed_before_its_item_is_passed(around, outwards):
    centre, normal = outwards
    expecting = replace(around, photos=(ExpectedPhoto("v0", tuple(centre + 20 * normal), 10),))
    for current, n_missing in ((9, 0), (10, 0), (11, 0), (12, 1)):
        state = flying(centre + 20 * normal, mission=Timed(MissionProgress(current, 30), 100.0))
        assert len(watched(Watch(), state, expecting, 100.0).passed_s) == n_missing


def test_watching_is_cheap(around, outwards):
    import time

    centre, normal = outwards
    state = flying(centre + 15.0 * normal, -2.0 * normal, fix=Timed(GnssFix(6, 12, None, None), 100.0))
    watched(Watch(), state, around, 100.0)
    started = time.thread_time()
    for i in range(200):
        watched(Watch(), state, around, 100.0 + 0.01 * i)
    assert (time.thread_time() - started) / 200 < 0.05


def test_distances_ahead_are_those_of_many_points_on_the_way(around, outwards):
    centre, normal = outwards
    a, b = centre + 12.0 * normal + np.array([0.0, 0.0, 4.0]), centre + 6.0 * normal
    points = a + np.linspace(0.0, 1.0, 500)[:, None] * (b - a)
    slow = min(around.facade_distance_m(tuple(p), tuple(p)) for p in points)
    assert around.facade_distance_m(tuple(a), tuple(b)) == pytest.approx(slow, abs=0.01)
    assert math.isfinite(slow)


# Where it is, and where it looks


@pytest.mark.parametrize(("silent_s", "is_lost"), [(0.1, False), (1.4, False), (1.6, True), (30.0, True)])
def test_positions_that_stay_away_while_heartbeats_come_are_told(around, outwards, silent_s, is_lost):
    """Within 3 s: a heartbeat every second, and rules that are looked at twice a second."""
    centre, normal = outwards
    near = flying(centre + 6.0 * normal)
    state = replace(near, motion=replace(near.motion, time_s=100.0 - silent_s))
    found = {warning.code: warning for warning in watched(Watch(), state, around, 100.0).warnings}
    assert ("position-lost" in found) is is_lost
    assert ("facade-distance" in found) is not is_lost, "what is not known is not watched"
    if is_lost:
        assert found["position-lost"].severity is Severity.ERROR
        assert (
            "distance, airspace, no-fly zones and path are not watched; fly it by hand" in found["position-lost"].text
        )


def test_a_link_that_is_lost_is_no_position_that_is_lost(around, outwards):
    centre, normal = outwards
    state = flying(centre + 20.0 * normal)
    for now_s in np.arange(100.0, 110.0, 0.5):
        told = {warning.code for warning in watched(Watch(), state, around, now_s).warnings}
        assert "position-lost" not in told


@pytest.mark.parametrize("problem", ["no position yet", "its measurements contradict each other"])
def test_an_estimate_that_fails_in_flight_is_told(around, outwards, problem):
    centre, normal = outwards
    state = flying(centre + 20.0 * normal, estimator=Timed(EstimatorHealth(problem), 100.0))
    (found,) = watched(Watch(), state, around, 100.0).warnings
    assert (found.code, found.severity) == ("position-lost", Severity.ERROR)
    assert problem in found.text
    landed = replace(state, landed=Timed(Landed.ON_GROUND, 100.0))
    assert "position-lost" not in {warning.code for warning in watched(Watch(), landed, around, 100.0).warnings}


@given(stuck_deg=st.floats(-90.0, 30.0), planned=st.lists(st.floats(-60.0, 20.0), min_size=2, max_size=8))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_stuck_gimbal_is_told_at_the_second_photo_that_looks_elsewhere(around, outwards, stuck_deg, planned):
    centre, normal = outwards
    places = [tuple(map(float, centre + (20.0 + 8.0 * n) * normal)) for n in range(len(planned))]
    expected = tuple(ExpectedPhoto(f"v{n}", places[n], 4 * n, pitch) for n, pitch in enumerate(planned))
    space = replace(around, photos=expected)
    photos: tuple[TakenPhoto, ...] = ()
    n_off = []
    for n, pitch in enumerate(planned):
        photos = (*photos, TakenPhoto(n, float(n), places[n], 0.0, stuck_deg))
        n_off.append(abs(pitch - stuck_deg) > 5.0)
        told = {w.code for w in watched(Watch(), flying(places[n], photos=photos), space, 100.0).warnings}
        assert ("gimbal" in told) is (sum(n_off[-3:]) >= 2)
    # One that follows is never spoken of.
    right = tuple(TakenPhoto(n, float(n), places[n], 0.0, pitch + 0.5) for n, pitch in enumerate(planned))
    told = {w.code for w in watched(Watch(), flying(places[-1], photos=right), space, 100.0).warnings}
    assert "gimbal" not in told


def beside(place, velocity=(0.0, 0.0, 0.0), age_s=0.0, number=2):
    motion = Motion(tuple(map(float, place)), tuple(map(float, velocity)), 20.0)
    return OtherAircraft(number, motion, stop_point(motion, AIRCRAFT.max_acceleration_m_s2, 0.0), age_s)


def apart(around, place, other, velocity=(0.0, 0.0, 0.0), now_s=100.0, **changes):
    rules = WatchRules(others=(other,))
    found = watched(Watch(), flying(place, velocity, now_s=now_s, **changes), around, now_s, rules).warnings
    return {warning.code: warning for warning in found}


def test_another_aircraft_is_warned_of_where_both_can_stop_and_is_danger_once_it_is_near(around, outwards):
    centre, normal = outwards
    here, limit_m = centre + 20.0 * normal, RULES.apart_m - APART_TOLERANCE_M
    away = here + np.array([0.0, 0.0, limit_m + 4.0])
    assert "aircraft-apart" not in apart(around, here, beside(away))
    # 5 m/s are stopped after 5 m at 2.5 m/s^2: 4 + limit - 5 m from here.
    (found,) = (apart(around, here, beside(away, (0.0, 0.0, -5.0)))[each] for each in ["aircraft-apart"])
    assert found.severity is Severity.WARNING
    assert found.value == pytest.approx(limit_m - 1.0)
    assert "aircraft 2 is" in found.text
    near = apart(around, here, beside(here + np.array([0.0, 0.0, limit_m - 0.1])))["aircraft-apart"]
    assert near.severity is Severity.ERROR
    crossing = apart(around, here, beside(away, (0.0, 0.0, -5.0)), (0.0, 0.0, 4.0))["aircraft-apart"]
    assert crossing.value < found.value


def test_on_the_ground_nobody_is_too_near_and_who_is_not_heard_is_named(around, outwards):
    centre, normal = outwards
    here = centre + 20.0 * normal
    assert not apart(around, here, beside(here), landed=Timed(Landed.ON_GROUND, 100.0))
    silent = apart(around, here, beside(here, age_s=STALE_S + 3.0, number=3))
    assert set(silent) == {"aircraft-unheard"}
    assert "aircraft 3 was last heard 8 s ago" in plain(silent["aircraft-unheard"].text)


@given(
    st.lists(st.floats(-20.0, 20.0), min_size=12, max_size=12),
    st.booleans(),
)
@settings(max_examples=60, deadline=None)
def test_ways_to_where_aircraft_stop_are_no_further_apart_than_any_points_of_them(numbers, is_paused):
    place, velocity, other, towards = np.array(numbers).reshape(4, 3)
    start = Motion(tuple(place), tuple(0.3 * velocity), 0.0)
    end = stop_point(start, 2.5, 1.5 if is_paused else 0.0)
    known = beside(other, 0.3 * towards)
    found = ways_apart_m(start.position_enu_m, end, known)
    share = np.linspace(0.0, 1.0, 101)[:, None]
    one = place + share * (np.array(end) - place)
    two = other + share * (np.array(known.stop_enu_m) - other)
    sampled = np.linalg.norm(one[:, None] - two, axis=-1).min()
    assert found <= sampled + 1e-9
    assert found >= sampled - 0.5 * (np.linalg.norm(one[1] - one[0]) + np.linalg.norm(two[1] - two[0])) - 1e-9
