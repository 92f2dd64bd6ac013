"""Simulated fly-aways stay inside the volumes, and would not if those were smaller."""

import math
from dataclasses import replace

import numpy as np
import pytest

from missions.simulator.fly_away import Ending, simulate_fly_aways
from planning.base.errors import OperationCancelled
from planning.insight.ground_risk import assess_ground_risk, grown
from planning.insight.ground_risk_request import GroundRiskRequest
from tests.planning.insight.ground_risk_cases import BENT, ROUND, flown, place

REQUESTS = (
    GroundRiskRequest(),
    GroundRiskRequest(wind_m_s=0.0),
    GroundRiskRequest(speed_m_s=5.0, wind_m_s=8.0, geography="paths"),
    GroundRiskRequest(speed_m_s=2.0, wind_m_s=12.0, reaction_s=4.0),
    GroundRiskRequest(speed_m_s=15.0, wind_m_s=3.0, tilt_deg=45.0, gnss_error_m=0.0, hold_error_m=0.0, map_error_m=0.1),
)


def smaller(risk, share):
    """The buffer with a part of its width."""
    rest = risk.value_of("S_FG") + risk.value_of("S_CV")
    return grown(risk.core, rest + share * risk.value_of("S_GRB"), risk.request.arc_tolerance_m)


def assert_holds(paths, request, n, seed):
    plan = flown(*paths)
    risk = assess_ground_risk(plan, place(), request)
    away = simulate_fly_aways(plan, risk, n, seed)
    assert away.share_inside == 1.0, away.margins_m.min()
    # Without the buffer's last third some come down outside.
    tried = simulate_fly_aways(plan, risk, n, seed, buffer=smaller(risk, 0.7))
    assert tried.share_inside < 1.0
    assert np.array_equal(tried.ends_enu_m, away.ends_enu_m)


@pytest.mark.parametrize("request_", REQUESTS[1:3])
def test_fly_aways_stay_inside_and_a_buffer_of_seven_tenths_does_not_hold_them(request_):
    assert_holds((ROUND,), request_, 120, 1)


@pytest.mark.slow
@pytest.mark.parametrize("request_", REQUESTS)
@pytest.mark.parametrize("paths", [(ROUND,), (BENT,), (ROUND, BENT)])
@pytest.mark.parametrize("seed", range(3))
def test_many_fly_aways_stay_inside(paths, request_, seed):
    assert_holds(paths, request_, 500, seed)


def test_a_pilot_who_brakes_stays_in_the_contingency_volume_only_if_it_is_large_enough():
    plan = flown(ROUND)
    risk = assess_ground_risk(plan, place(), REQUESTS[4])
    away = simulate_fly_aways(plan, risk, 90)
    braked = np.array([each is Ending.BRAKED for each in away.endings])
    assert 0.0 <= away.margins_m[braked].min() < 1.0
    numbers = tuple(replace(each, value=1.5) if each.symbol == "t_R" else each for each in risk.quantities)
    late = simulate_fly_aways(plan, replace(risk, quantities=numbers), 90)
    assert late.margins_m[braked].min() < 0.0


def test_the_same_seed_flies_the_same_and_another_does_not():
    plan = flown(ROUND)
    risk = assess_ground_risk(plan, place(), REQUESTS[1])
    once, again, other = (simulate_fly_aways(plan, risk, 6, seed).ends_enu_m for seed in (5, 5, 6))
    assert np.array_equal(once, again)
    assert not np.array_equal(once, other)


def test_a_flight_over_one_place_flies_away_too():
    plan = flown(((3.0, 4.0, 10.0),))
    risk = assess_ground_risk(plan, place(), REQUESTS[1])
    away = simulate_fly_aways(plan, risk, 30)
    assert np.allclose(away.starts_enu_m, (3.0, 4.0, 10.0))
    assert away.share_inside == 1.0
    assert math.isclose(away.ends_enu_m[:, 2].min(), 0.0)


def test_it_can_be_cancelled():
    class Cancels:
        def report(self, stage, done, total):
            raise OperationCancelled("enough")

    plan = flown(ROUND)
    risk = assess_ground_risk(plan, place(), REQUESTS[1])
    with pytest.raises(OperationCancelled):
        simulate_fly_aways(plan, risk, 3, monitor=Cancels())
