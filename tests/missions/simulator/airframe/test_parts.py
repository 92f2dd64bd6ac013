"""Gimbal lag, battery, GNSS and barometer errors: each part by itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.simulator.airframe.state import Target
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.barometer import DriftingBarometer, drift_m_s
from missions.simulator.effects.battery import SaggingPack, power_ratio
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.gimbal import lagging_rad
from tests.missions.simulator.effects.test_two_ways import blur_px
from tests.missions.simulator.flying import bundled

FACTS = effect_facts()
STILL = (0.0, 0.0, 0.0)


@given(st.floats(-4.0, 4.0), st.floats(0.0, 5.0), st.floats(0.0, 5.0), st.floats(0.05, 5.0), st.floats(0.01, 2.0))
def test_a_lagging_turn_does_not_depend_on_how_time_is_cut(
    distance_rad: float, first_s: float, then_s: float, rate_rad_s: float, lag_s: float
) -> None:
    whole = lagging_rad(distance_rad, first_s + then_s, rate_rad_s, lag_s)
    parts = lagging_rad(lagging_rad(distance_rad, first_s, rate_rad_s, lag_s), then_s, rate_rad_s, lag_s)
    assert whole == pytest.approx(parts, abs=1e-12)
    assert abs(distance_rad) - rate_rad_s * (first_s + then_s) - 1e-12 <= abs(whole) <= abs(distance_rad)


def test_a_gimbal_settles_in_one_to_two_seconds() -> None:
    left = lagging_rad(math.radians(40.0), 1.5, math.radians(60.0), FACTS.gimbal.lag_s)
    assert 0.2 < math.degrees(left) < 0.8


def test_hovering_takes_more_power_than_slow_flight_and_fast_flight_most() -> None:
    """DJI states 38 min of hovering and 45 min at 9 m/s."""
    assert power_ratio(0.0, 0.0, FACTS.battery) == pytest.approx(1.0)
    assert power_ratio(9.0, 0.0, FACTS.battery) == pytest.approx(38.0 / 45.0, rel=0.02)
    assert power_ratio(20.0, 0.0, FACTS.battery) > 1.1
    assert power_ratio(0.0, 3.0, FACTS.battery) > 1.3


@given(st.floats(0.0, 1000.0), st.floats(-100.0, 100.0))
def test_power_is_finite_and_positive(airspeed_m_s: float, climb_m_s: float) -> None:
    assert 0.2 <= power_ratio(airspeed_m_s, climb_m_s, FACTS.battery) < 1e6


def test_a_battery_lasts_its_endurance_at_the_speed_for_which_it_is_stated() -> None:
    pack = SaggingPack(FACTS.battery, 2520.0)
    voltages = []
    for _ in range(252):
        pack.step(9.999, (0.0, 9.0, 0.0), STILL, motors_on=True)
        voltages.append(pack.state.voltage_v)
    assert pack.state.remaining == pytest.approx(0.0, abs=1e-3)
    assert (np.diff(voltages) < 0.0).all()
    assert pack.state.consumed_mah == pytest.approx(FACTS.battery.capacity_mah, rel=1e-3)
    pack.step(1e6, STILL, STILL, motors_on=True)
    assert pack.state.remaining == 0.0
    pack.step(1.0, STILL, STILL, motors_on=False)
    assert pack.state.current_a == 0.0


def test_wind_counts_for_the_battery_as_airspeed() -> None:
    into, still = SaggingPack(FACTS.battery, 1500.0), SaggingPack(FACTS.battery, 1500.0)
    into.step(60.0, (5.0, 0.0, 0.0), (-5.0, 0.0, 3.0), motors_on=True)
    still.step(60.0, (10.0, 0.0, 0.0), STILL, motors_on=True)
    assert into.state == still.state


@pytest.mark.slow
def test_what_is_believed_differs_from_the_truth_by_the_error_and_heights_count_from_the_start() -> None:
    model, plan = bundled("office")
    conditions = Conditions(fix="single", height_source="gnss")
    off = {"multipath": "off", "battery sag": "off"}
    errors = []
    for seed in range(60):
        made, _ = make_airframe(plan, model, conditions=conditions, settings=off, seed=seed)  # type: ignore[arg-type]
        x, y, z = made.truth.position_enu_m
        assert made.estimate.position_enu_m[2] == z
        assert made.estimate.position_enu_m[:2] != (x, y)
        up = Target((x, y, z + 30.0), 15.0, 6.0, 6.0, 0.0, 1.0, 0.0)
        made.step(60.0, up)
        assert made.estimate.position_enu_m == pytest.approx((x, y, z + 30.0), abs=1e-9)
        errors.append([a - b for a, b in zip(made.truth.position_enu_m, made.estimate.position_enu_m, strict=True)])
        assert (made.fix.fix_type, made.fix.n_satellites) == (3, 18)
    found = np.array(errors).std(axis=0)
    assert found[:2] == pytest.approx([1.06, 1.06], rel=0.3)
    # After a tenth of the correlation time the height has hardly left what it was at the start.
    assert 0.05 < found[2] < 1.0


def test_a_barometer_drifts_as_fast_as_the_weather_and_starts_at_nothing() -> None:
    drifts = []
    for seed in range(300):
        made = DriftingBarometer(FACTS.barometer, gives_height=True, rng=np.random.default_rng(seed))
        made.step(500.0, STILL, flies=False)
        assert made.offset_enu_m == STILL
        made.step(1000.0, STILL, flies=True)
        drifts.append(made.offset_enu_m[2])
    assert np.std(drifts) == pytest.approx(1000.0 * drift_m_s(FACTS.barometer), rel=0.12)


def test_blur_adds_way_and_turn() -> None:
    """1 m/s for 10 ms at 10 m and 1 mrad a pixel: 1 px; 0.1 rad/s for 10 ms: 1 px more."""
    assert blur_px((0.6, 0.0, 0.8), 0.0, 0.01, 10.0, 1e-3) == pytest.approx(1.0)
    assert blur_px((0.6, 0.0, 0.8), -0.1, 0.01, 10.0, 1e-3) == pytest.approx(2.0)
    assert blur_px((9.0, 0.0, 0.0), 1.0, 0.0, 10.0, 1e-3) == 0.0
