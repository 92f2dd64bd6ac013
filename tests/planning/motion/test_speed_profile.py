"""The nonlinear program, reference of the sweep: equal to it and to the closed form, quiet; the effect, on and off."""

from __future__ import annotations

import dataclasses
import math
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.effects import decide
from planning.motion.speed_profile import (
    CORNER_DEVIATION_M,
    CornerSpeed,
    _solve,
    corner_saving_s,
    fastest_profile,
    fastest_sweep,
    path_grid,
)
from planning.motion.timing import FlightPath, MotionLimits, stopping_times_s
from tests.planning.motion.test_smooth_path import path

SOLVERS: tuple[Literal["sweep", "nlp"], ...] = ("sweep", "nlp")
LIMITS = MotionLimits(10.0, 4.0, 3.0, 2.5, 1.0, 1.0)


def zigzag(n_legs: int, seed: int = 0, *, stop_share: float = 0.3, turns: bool = False) -> FlightPath:
    rng = np.random.default_rng(seed)
    vertices = np.cumsum(rng.normal(size=(n_legs + 1, 3)) * 10.0, axis=0)
    stops = np.flatnonzero(rng.random(n_legs + 1) < stop_share).tolist()
    return path(vertices, stops, (rng.random(n_legs) * 3.0).tolist() if turns else None)


HARD = {
    "one millimetre": path([[0, 0, 0], [0.001, 0, 0]]),
    "two kilometres": path([[0, 0, 0], [2000, 0, 0]]),
    "up and down": path([[0, 0, 0], [0, 0, 50], [0, 0, 0]]),
    "half a turn over half a metre": path([[0, 0, 0], [0.5, 0, 0]], turn_s=[3.0]),
    "no length": path([[0, 0, 0], [5, 0, 0], [5, 0, 0], [9, 0, 0]], turn_s=[0.0, 2.0, 0.0]),
    "one point": path([[1, 2, 3]]),
    "millimetres beside kilometres": path([[0, 0, 0], [0.001, 0, 0], [2000, 0, 0], [2000, 0.5, 0]]),
    "forty turns": path([[3.0 * i, 2.0 * (i % 2), 0.0] for i in range(41)], turn_s=[2.0] * 40),
}


@pytest.mark.parametrize("name", HARD)
def test_with_a_stop_at_every_vertex_the_closed_form_is_met(name: str) -> None:
    exact_s = stopping_times_s(HARD[name], LIMITS)
    for solver in SOLVERS:
        profile = fastest_profile(HARD[name], LIMITS, solver=solver)
        assert profile.duration_s >= exact_s[-1] * (1.0 - 1e-9)
        np.testing.assert_allclose(profile.arrival_s, exact_s, rtol=1e-5, atol=1e-5)
        assert (profile.iterations > 0) == (solver == "nlp" and name != "one point")


@given(seed=st.integers(0, 1000), n_legs=st.integers(1, 10), turns=st.booleans())
@settings(max_examples=25)
def test_the_program_and_the_sweep_find_the_same_profile(seed: int, n_legs: int, turns: bool) -> None:
    flown = zigzag(n_legs, seed, turns=turns)
    sweep, program = (fastest_profile(flown, LIMITS, solver=solver) for solver in SOLVERS)
    assert sweep.duration_s * (1.0 - 1e-9) <= program.duration_s <= sweep.duration_s * (1.0 + 1e-4)
    assert (np.diff(program.distance_m) > 0.0).all()
    assert np.isfinite(program.speed_m_s).all()


def test_the_program_finds_it_from_a_poor_start_as_well() -> None:
    grid = path_grid(zigzag(20), LIMITS, CORNER_DEVIATION_M)
    good, _ = _solve(grid, fastest_sweep(grid))
    poor, _ = _solve(grid, 0.01 * fastest_sweep(grid))
    np.testing.assert_allclose(poor, good, rtol=0.02, atol=0.02)


@pytest.mark.slow
def test_five_hundred_legs_take_well_under_a_few_seconds_of_iterations() -> None:
    sweep, profile = (fastest_profile(zigzag(500, turns=True), LIMITS, solver=solver) for solver in SOLVERS)
    assert profile.iterations < 150
    assert profile.duration_s == pytest.approx(sweep.duration_s, rel=1e-4)


def test_hovers_and_arrivals_add_up() -> None:
    flown = FlightPath(
        np.array([[0.0, 0, 0], [20, 0, 0], [20, 20, 0], [40, 20, 0]]),
        np.array([True, True, False, True]),
        np.array([1.0, 5.0, 0.0, 2.0]),
        np.zeros(3),
    )
    profile = fastest_profile(flown, LIMITS)
    first_leg = 2.0 * math.sqrt(20.0 / 2.5)
    assert profile.arrival_s[:2] == pytest.approx([0.0, 1.0 + first_leg], rel=1e-6)
    assert profile.duration_s == pytest.approx(profile.arrival_s[-1] + 2.0)
    without = fastest_profile(FlightPath(flown.vertices_enu_m, flown.is_stop, np.zeros(4), np.zeros(3)), LIMITS)
    assert profile.duration_s == pytest.approx(without.duration_s + 8.0)


def test_flying_through_corners_saves_time_and_the_more_the_wider_they_may_be_cut() -> None:
    corners = zigzag(15, stop_share=0.0)
    durations = [fastest_profile(corners, LIMITS, corner_deviation_m=d).duration_s for d in (0.01, 0.1, 1.0)]
    assert durations == sorted(durations, reverse=True)
    assert durations[0] < stopping_times_s(corners, LIMITS)[-1]


def test_a_program_that_ends_too_early_is_no_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planning.motion.speed_profile.MAX_ITERATIONS", 2)
    with pytest.raises(ArithmeticError, match="Maximum_Iterations_Exceeded"):
        fastest_profile(zigzag(50), LIMITS, solver="nlp")


def test_the_solver_prints_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    fastest_profile(zigzag(20), LIMITS, solver="nlp")
    assert capfd.readouterr() == ("", "")


def test_where_nothing_is_flown_through_the_effect_is_off_and_would_change_nothing() -> None:
    flown = zigzag(30, stop_share=1.0, turns=True)
    decision = decide(CornerSpeed(), (flown, LIMITS))
    assert not decision.on
    assert decision.reason == "the aircraft stops at every vertex, where the closed form is exact"
    change = stopping_times_s(flown, LIMITS)[-1] - fastest_profile(flown, LIMITS).duration_s
    assert abs(change) < 0.01 * decision.tolerance


def test_one_corner_is_worth_nothing_that_shows() -> None:
    flown = path([[0, 0, 0], [10, 0, 0], [10, 10, 0]], [])
    decision = decide(CornerSpeed(), (flown, LIMITS))
    assert not decision.on
    change = stopping_times_s(flown, LIMITS)[-1] - fastest_profile(flown, LIMITS).duration_s
    assert 0.0 < change < decision.tolerance


@pytest.mark.parametrize("turns", [False, True])
def test_many_corners_are_worth_it_and_the_effect_knows_by_how_much(turns: bool) -> None:
    flown = zigzag(30, stop_share=0.3, turns=turns)
    decision = decide(CornerSpeed(), (flown, LIMITS))
    assert decision.on
    change = stopping_times_s(flown, LIMITS)[-1] - fastest_profile(flown, LIMITS).duration_s
    assert change > decision.tolerance
    assert decision.size == pytest.approx(change, abs=0.05)
    assert decide(CornerSpeed(), (flown, LIMITS), "off").on is False


def test_what_corners_save_is_what_the_program_says_where_the_effect_is_on_and_nothing_where_it_is_off() -> None:
    flown = zigzag(30, stop_share=0.3)
    saving_s, decision = corner_saving_s(flown, LIMITS)
    assert decision.on
    assert saving_s == pytest.approx(
        stopping_times_s(flown, LIMITS)[-1] - fastest_profile(flown, LIMITS, solver="nlp").duration_s, abs=0.01
    )
    assert corner_saving_s(flown, LIMITS, "off")[0] == 0.0
    # A limit of jerk slows both ways of flying: it does not count as time saved.
    assert corner_saving_s(flown, dataclasses.replace(LIMITS, jerk_m_s3=1.0))[0] == pytest.approx(saving_s)
