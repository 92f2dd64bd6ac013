"""Wind: gusts as the model says, position held as real autopilots do, speed within what a tilted aircraft reaches."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.simulator.airframe.state import Target
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.wind import GustResponse, GustyAir, gust_scale_m, gust_sigma_m_s, highest_airspeed_m_s
from tests.missions.simulator.flying import bundled

FACTS = effect_facts().wind


def air(east: float, north: float, seed: int = 0) -> GustyAir:
    return GustyAir((east, north, 0.0), 30.0, FACTS, np.random.default_rng(seed))


def test_the_model_joins_the_one_for_greater_heights() -> None:
    """At 1000 ft the factor 0.177 + 0.000823 h is 1: all scales and sigmas are equal there."""
    assert gust_sigma_m_s(10.0, 304.8) == pytest.approx([1.0, 1.0, 1.0], rel=1e-3)
    assert gust_scale_m(304.8) == pytest.approx([304.8] * 3, rel=1e-3)


def test_positions_are_held_as_arducopter_was_measured_to_hold_them() -> None:
    """0.06 to 0.11 m at the shutter in 8 m/s of turbulent wind."""
    spread = GustResponse(FACTS, 8.0, 20.0).spread()
    assert 0.06 < math.sqrt(float(spread[:, 1, 1].sum())) < 0.14


@pytest.mark.few(1)
@pytest.mark.parametrize("step_s", [0.02, 0.2, 3.0])
def test_gusts_and_offsets_have_the_spread_of_the_long_run(step_s: float) -> None:
    made = air(6.0, 0.0, seed=2)
    rows = []
    for _ in range(15_000):
        made.step(step_s, flies=True)
        rows.append((*made.wind_enu_m_s, *made.offset_enu_m))
    found = np.array(rows)
    if step_s * len(rows) < 1000.0:
        found = found[len(found) // 10 :]
    response = GustResponse(FACTS, 6.0, 30.0)
    assert found[:, 0].mean() == pytest.approx(6.0, abs=0.7)
    assert found[:, 2].std() == pytest.approx(response.sigma_m_s[2], rel=0.3)
    assert found[:, 3:].std(axis=0) == pytest.approx(np.sqrt(response.spread()[:, 1, 1]), rel=0.3)


def test_on_the_ground_nothing_is_pushed() -> None:
    made = air(8.0, 0.0)
    for _ in range(100):
        made.step(0.1, flies=False)
    assert made.offset_enu_m == made.offset_velocity_enu_m_s == (0.0, 0.0, 0.0)


@given(st.floats(-12.0, 12.0), st.floats(-12.0, 12.0), st.floats(-math.pi, math.pi), st.floats(0.1, 40.0))
def test_speed_over_the_ground_never_needs_more_airspeed_than_there_is(
    east: float, north: float, course_rad: float, wanted_m_s: float
) -> None:
    course = math.sin(course_rad), math.cos(course_rad)
    speed = air(east, north).ground_speed_m_s((7.0 * course[0], 7.0 * course[1], 0.0), wanted_m_s)
    assert 0.0 < speed <= wanted_m_s
    most = highest_airspeed_m_s(FACTS)
    assert math.hypot(speed * course[0] - east, speed * course[1] - north) <= most * (1.0 + 1e-9) or speed == wanted_m_s
    if speed < wanted_m_s:
        assert math.hypot(speed * course[0] - east, speed * course[1] - north) == pytest.approx(most)


def test_a_hovering_aircraft_leans_into_the_wind_and_flies_slower_against_it() -> None:
    model, plan = bundled("office")
    storm = Conditions(wind_m_s=12.0, wind_from_deg=270.0)
    made, _ = make_airframe(plan, model, conditions=storm)
    x, y, z = made.truth.position_enu_m
    up = Target((x, y, z + 30.0), 15.0, 6.0, 6.0, math.radians(-90.0), 1.0, 0.0)
    for _ in range(400):
        made.step(0.1, up)
    # The nose points west, where the wind comes from: it is down.
    assert made.truth.pitch_rad < math.radians(-10.0)
    west = Target((x - 300.0, y, z + 30.0), 15.0, 6.0, 6.0, math.radians(-90.0), 1.0, 0.0)
    speeds = []
    for _ in range(250):
        made.step(0.1, west)
        speeds.append(-made.truth.velocity_enu_m_s[0])
    assert max(speeds) == pytest.approx(highest_airspeed_m_s(FACTS) - 12.0, abs=1.0)
