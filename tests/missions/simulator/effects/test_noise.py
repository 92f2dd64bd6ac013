"""Random errors are smooth, have the spread that is asked for, and do not depend on how time is cut."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.noise import SmoothNoise, _step_of, covariance_root
from missions.simulator.effects.wind import GustResponse


@given(st.floats(1e-6, 5.0), st.floats(0.5, 900.0))
def test_two_half_steps_are_a_whole_one(duration_s: float, correlation_s: float) -> None:
    """F(2t) = F(t)^2 and Q(2t) = F Q F^T + Q, from a microsecond on, where differences would lose all digits."""
    (f, r), (whole_f, whole_r) = _step_of(duration_s, correlation_s), _step_of(2.0 * duration_s, correlation_s)
    scale = np.array([1.0, correlation_s])
    assert np.abs((f @ f - whole_f) * scale[:, None] / scale).max() < 1e-12
    twice = f @ (r @ r.T) @ f.T + r @ r.T
    assert twice == pytest.approx(whole_r @ whole_r.T, rel=5e-3, abs=1e-300)


@pytest.mark.parametrize("step_s", [0.02, 1.0, 60.0])
def test_spread_and_correlation_are_those_asked_for(step_s: float) -> None:
    n = 4000
    correlation_s = 10.0 * step_s
    noise = SmoothNoise((2.0, 0.5, 0.0), correlation_s, np.random.default_rng(3))
    values = np.empty((n, 3))
    for row in values:
        noise.step(step_s)
        row[:] = noise.value
    assert values.std(axis=0)[:2] == pytest.approx([2.0, 0.5], rel=0.2)
    assert (values[:, 2] == 0.0).all()
    later = float(np.mean(values[:-10, 0] * values[10:, 0]) / np.mean(values[:, 0] ** 2))
    assert later == pytest.approx(2.0 * np.exp(-1.0), abs=0.12)  # (1 + t/T) exp(-t/T) at t = T


def test_it_begins_with_the_spread_that_it_keeps() -> None:
    first = np.array([SmoothNoise((1.0, 1.0, 1.0), 100.0, np.random.default_rng(seed)).value for seed in range(400)])
    assert first.std() == pytest.approx(1.0, rel=0.07)


def test_nothing_jumps() -> None:
    """At 50 Hz an error of 1 m and 100 s moves at 1 cm/s (1 sigma)."""
    noise = SmoothNoise((1.0, 1.0, 1.0), 100.0, np.random.default_rng(1))
    last = np.array(noise.value)
    for _ in range(5000):
        noise.step(0.02)
        now = np.array(noise.value)
        assert np.abs(now - last).max() / 0.02 < 0.05
        last = now


@pytest.mark.parametrize("correlation_s", [0.0, -1.0, float("nan")])
def test_a_correlation_that_makes_no_sense_is_refused(correlation_s: float) -> None:
    with pytest.raises(ValueError, match="positive time"):
        SmoothNoise((1.0, 1.0, 1.0), correlation_s, np.random.default_rng(0))


@given(st.integers(0, 1000), st.integers(1, 4))
def test_a_covariance_root_gives_it_back_also_when_singular(seed: int, rank: int) -> None:
    half = np.random.default_rng(seed).standard_normal((4, rank)) * np.array([[1e-9], [1e-3], [1.0], [1e6]])
    covariance = half @ half.T
    root = covariance_root(covariance)
    scale = np.sqrt(np.diagonal(covariance))
    assert np.abs((root @ root.T - covariance) / np.outer(scale, scale)).max() < 1e-7


@settings(max_examples=25)
@given(st.floats(0.1, 30.0), st.floats(0.0, 400.0), st.sampled_from((0.001, 0.02, 0.2, 0.5)))
def test_gusts_do_not_depend_on_how_time_is_cut(wind_m_s: float, height_m: float, step_s: float) -> None:
    response = GustResponse(effect_facts().wind, wind_m_s, height_m)
    (f, r), (whole_f, whole_r) = response.over(step_s), response.over(2.0 * step_s)
    assert f @ f == pytest.approx(whole_f, abs=1e-10)
    added = r @ np.swapaxes(r, 1, 2)
    twice = f @ added @ np.swapaxes(f, 1, 2) + added
    whole = whole_r @ np.swapaxes(whole_r, 1, 2)
    scale = np.sqrt(np.diagonal(whole, axis1=1, axis2=2))
    assert (np.abs(twice - whole) <= 1e-6 * scale[:, :, None] * scale[:, None, :] + 1e-18).all()


@settings(max_examples=25)
@given(st.floats(0.5, 20.0), st.floats(3.0, 200.0))
def test_the_spread_of_gusts_in_the_long_run_is_kept_by_every_step(wind_m_s: float, height_m: float) -> None:
    response = GustResponse(effect_facts().wind, wind_m_s, height_m)
    spread = response.spread()
    f, r = response.over(0.5)
    kept = f @ spread @ np.swapaxes(f, 1, 2) + r @ np.swapaxes(r, 1, 2)
    assert kept == pytest.approx(spread, rel=1e-7, abs=1e-12)
    assert np.sqrt(spread[:, 0, 0]) == pytest.approx(response.sigma_m_s, rel=1e-9)
