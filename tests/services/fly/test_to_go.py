"""What is left of a sortie, by its planned times along the path."""

import dataclasses
import itertools

import numpy as np
import pytest

from groundstation.services.fly.readouts import readouts
from groundstation.services.fly.to_go import SortieTimes, to_go
from groundstation.vehicle.state import Landed, Motion, Timed, VehicleState
from missions.mavlink.autopilots import Autopilot
from planning.geo.frames import Angles
from planning.insight.flight_profile import sortie_profile
from tests.services.live_cases import sortie


@pytest.fixture(scope="module")
def live():
    return sortie()


@pytest.fixture(scope="module")
def times(live):
    return SortieTimes.of(live)


def flying(place, mode="AUTO"):
    return VehicleState(
        autopilot=Autopilot.ARDUPILOT,
        mode=Timed(mode, 0.0),
        armed=Timed(True, 0.0),
        landed=Timed(Landed.IN_AIR, 0.0),
        motion=Timed(Motion(tuple(place), (0.0, 0.0, 0.0), 10.0), 0.0),
        attitude=Timed(Angles(0.0, 0.0, 0.0), 0.0),
    )


def around_of(live):
    return live.orders.surroundings[Autopilot.ARDUPILOT]


def test_along_the_planned_path_the_time_left_is_that_of_the_plan(live, times):
    """Wherever the aircraft is by its profile, what is left and what has gone are the whole."""
    plan = live.case.plan
    profile = sortie_profile(plan, plan.sorties[0])
    for time_s in np.linspace(0.0, profile.duration_s, 60):
        place = profile.at(np.array([time_s])).positions_enu_m[0]
        n_done = int((profile.photo_s <= time_s).sum())
        landed_s, photo_s = times.left_s(tuple(place), n_done)
        # Within a hover nothing tells how much of it is over; on a ramp a straight line stands for a curve.
        hover_s = float((profile.departure_s - profile.arrival_s).max())
        assert landed_s - times.ground_s == pytest.approx(profile.duration_s - time_s, abs=hover_s + 0.6)
        if n_done < len(profile.photo_s):
            assert photo_s == pytest.approx(profile.photo_s[n_done] - time_s, abs=hover_s + 0.6)
        else:
            assert photo_s is None


def test_time_left_never_grows_from_photo_to_photo_wherever_the_aircraft_is(times):
    rng = np.random.default_rng(3)
    for place in rng.uniform(-100.0, 100.0, (50, 3)):
        left = [times.left_s(tuple(place), n)[0] for n in range(len(times.photo_m) + 1)]
        assert all(later <= earlier + 1e-9 for earlier, later in itertools.pairwise(left))
        assert all(np.isfinite(left))


def test_before_take_off_the_whole_flight_is_left_and_in_a_return_the_way_home(live, times):
    around, states = around_of(live), [False] * 6
    total_s = live.orders.duration_s(Autopilot.ARDUPILOT)
    on_ground = dataclasses.replace(flying((0.0, 0.0, 0.0)), armed=Timed(False, 0.0))
    assert to_go(times, live, on_ground, around, states).landed_s == total_s
    place = live.case.plan.viewpoints[0].position_enu_m
    assert to_go(times, live, flying(place, "RTL"), around, states).landed_s == around.way_home_s(place)
    landing = to_go(times, live, flying(place, "LAND"), around, states)
    assert landing.landed_s == pytest.approx(10.0 / around.aircraft.max_descent_m_s)
    assert landing.photo_s is None


def test_where_nothing_is_known_nothing_is_told(live):
    lost = dataclasses.replace(flying((0.0, 0.0, 0.0)), motion=None)
    assert to_go(None, live, lost, around_of(live), []).landed_s is None
    assert to_go(None, live, flying((0.0, 0.0, 5.0)), around_of(live), []).landed_s is None


def test_height_is_told_above_the_ground_and_above_take_off(live):
    found = readouts(flying((0.0, 0.0, 12.0)), around_of(live), 2.0)
    assert (found.above_ground_m, found.height_m) == (10.0, 10.0)
    assert readouts(flying((0.0, 0.0, 12.0)), around_of(live)).above_ground_m is None
