"""How long ArduPilot takes: against legs that a real ArduCopter flew, and against the simulated vehicle."""

import math
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.fly.flying import FlightRequest, fly_plan
from groundstation.vehicle.duration import items_duration_s, timed_by_items
from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.setup import leg_late_s
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from planning.aircraft.catalogue import profile
from planning.motion.timing import leg_times_s, motion_limits
from planning.parameters import FlightRules
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.at_once import TIMING_S, TIMING_SHARE, sortie_leg_times
from planning.site.bundled import single_panel
from tests.planning.revision.cases import QUICK
from tests.slow import slow

LEGS = [
    (5.61, -0.02, 6.10),
    (8.79, 1.44, 7.17),
    (11.30, 22.26, 12.82),
    (12.44, -17.10, 15.00),
    (14.53, -23.36, 19.10),
    (15.21, 0.00, 9.01),
    (26.33, -0.95, 10.05),
    (39.14, -0.27, 11.29),
    (46.80, 4.44, 12.21),
    (60.35, -2.03, 13.79),
]
"""Legs of ArduCopter 4.7.0-dev (git 2598e9d4b2) in its own simulation, with the profile `ardupilot`: metres over the
ground, metres up, and seconds without the hold. From its own log of the office flight."""


def test_legs_take_what_a_real_arducopter_took():
    limits = motion_limits(profile("ardupilot").aircraft, FlightRules())
    ways = np.array([(level, 0.0, up) for level, up, _ in LEGS])
    reckoned = leg_times_s(ways, limits) + leg_late_s(Autopilot.ARDUPILOT)
    differences = reckoned - np.array([seconds for _, _, seconds in LEGS])
    assert np.abs(differences).max() < 0.6
    assert abs(differences.mean()) < 0.15


@pytest.mark.slow
@pytest.mark.parametrize("profile_id", ["ardupilot", slow("m3e")])
def test_the_simulated_vehicle_takes_what_its_items_are_reckoned_to(profile_id):
    """The M3E states no jerk: both fly with the autopilot's own."""
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=8, greedy=QUICK, profile_id=profile_id)).plan
    flown = fly_plan(plan, model, FlightRequest(autopilot=Autopilot.ARDUPILOT))
    (sortie,) = flown.sorties
    seconds = flown.flight.report.sorties[0].duration_flown_s
    assert math.isclose(seconds, sortie.expected_s, rel_tol=0.04)


def test_a_plan_timed_by_its_items_keeps_its_other_sorties():
    plan = plan_flight(single_panel(), PlanRequest(n_views=8, greedy=QUICK)).plan
    twice = replace(plan, sorties=plan.sorties * 2)
    timed = timed_by_items(twice, {2: 100.0})
    assert timed.sorties[0] == plan.sorties[0]
    assert timed.sorties[1].duration_s == 100.0 + plan.rules.takeoff_landing_s
    assert replace(timed, sorties=twice.sorties) == twice


@pytest.mark.long
@pytest.mark.parametrize("profile_id", ["m3e", "ardupilot", "px4"])
def test_paces_of_aircraft_that_fly_at_once_span_what_both_autopilots_take(profile_id):
    site_model = single_panel()
    for settle_s in (0.0, 2.0):
        rules = FlightRules(settle_s=settle_s)
        request = PlanRequest(n_views=12, greedy=QUICK, profile_id=profile_id, rules=rules)
        plan = plan_flight(site_model, request).plan
        missions = missions_from_plan(plan, site_model.site.origin, site_model.site.home_enu_m)
        (orders,) = (sortie_orders(plan, site_model, mission) for mission in missions)
        legs = sortie_leg_times(plan, plan.sorties[0])
        at_paces_s = legs.until_s[:, -1] - rules.takeoff_landing_s  # from lift-off
        taken_s = np.array([items_duration_s(orders, autopilot) for autopilot in Autopilot])
        allowed_s = TIMING_S + TIMING_SHARE * taken_s
        slack_s = 0.7 * allowed_s  # plans of eight seeds took up to 0.57 of it
        assert (at_paces_s.min() - slack_s <= taken_s).all()
        assert (taken_s <= at_paces_s.max() + slack_s).all()
        if settle_s == 0.0 and profile_id != "px4":
            assert taken_s.max() > at_paces_s[0] + allowed_s.max(), "as planned alone would not do"
