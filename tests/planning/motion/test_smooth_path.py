"""Rounded corners and the fastest sweep: geometry by hand, limits held everywhere, closed form where nothing bends."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.motion.speed_profile import ARC_NODES, PathGrid, arrivals_s, fastest_sweep, path_grid
from planning.motion.timing import FlightPath, MotionLimits, stopping_times_s

LIMITS = MotionLimits(10.0, 4.0, 3.0, 2.5, 1.0, 1.0)


def path(
    vertices: list[list[float]] | np.ndarray, stops: list[int] | None = None, turn_s: list[float] | None = None
) -> FlightPath:
    """Path without hovers; `stops` are the vertices stopped at, by default all."""
    points = np.array(vertices, float)
    k = len(points)
    is_stop = np.isin(np.arange(k), range(k) if stops is None else [0, *stops, k - 1])
    return FlightPath(points, is_stop, np.zeros(k), np.zeros(k - 1) if turn_s is None else np.array(turn_s))


def accelerations(grid: PathGrid, squared: np.ndarray, n_samples: int = 21) -> np.ndarray:
    """Total acceleration all along each interval, b being linear in between."""
    share = np.linspace(0.0, 1.0, n_samples)[:, None]
    within = squared[:-1] * (1.0 - share) + squared[1:] * share
    return np.hypot(np.diff(squared) / (2.0 * grid.step_m), grid.curvature_per_m * within)


@given(
    seed=st.integers(0, 10_000),
    n_legs=st.integers(1, 8),
    scale=st.sampled_from([1e-3, 0.3, 10.0, 2000.0]),
    deviation=st.sampled_from([0.01, 0.3, 5.0]),
    turns=st.booleans(),
)
def test_every_limit_holds_all_along_and_stopping_is_hardly_ever_faster(
    seed: int, n_legs: int, scale: float, deviation: float, turns: bool
) -> None:
    rng = np.random.default_rng(seed)
    vertices = np.cumsum(rng.normal(size=(n_legs + 1, 3)) * scale, axis=0)
    stops = np.flatnonzero(rng.random(n_legs + 1) < 0.4).tolist()
    turn_s = (rng.random(n_legs) * 3.0).tolist() if turns else None
    flown = path(vertices, stops, turn_s)
    grid = path_grid(flown, LIMITS, deviation)
    squared = fastest_sweep(grid)
    assert np.isfinite(squared).all()
    assert (squared >= 0.0).all()
    assert (squared[grid.is_stop] == 0.0).all()
    assert (squared <= grid.ceiling).all()
    assert accelerations(grid, squared).max() <= 2.5 * (1.0 + 1e-9)
    arrival = arrivals_s(grid, squared)
    assert (np.diff(arrival) >= 0.0).all()
    # Creeping around a corner of nearly 175 degrees, or being slow from one node of an arc to the next, costs a little.
    assert arrival[-1] <= stopping_times_s(flown, LIMITS)[-1] * 1.005
    # The path is no longer than the polyline, and its chords are no shorter than the way from stop to stop.
    assert grid.step_m.sum() <= np.linalg.norm(np.diff(vertices, axis=0), axis=1).sum() * (1.0 + 1e-9)
    assert grid.step_m.sum() >= np.linalg.norm(vertices[-1] - vertices[0]) * (1.0 - 1e-9)


@given(seed=st.integers(0, 1000), n_legs=st.integers(1, 6), scale=st.sampled_from([1e-3, 0.3, 10.0, 2000.0]))
def test_stopping_at_every_vertex_takes_what_the_closed_form_says(seed: int, n_legs: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    vertices = np.cumsum(rng.normal(size=(n_legs + 1, 3)) * scale, axis=0)
    flown = path(vertices, turn_s=(rng.random(n_legs) * 3.0).tolist())
    grid = path_grid(flown, LIMITS, 0.3)
    np.testing.assert_allclose(arrivals_s(grid, fastest_sweep(grid)), stopping_times_s(flown, LIMITS), rtol=1e-9)


def test_a_right_angle_is_rounded_as_worked_out_by_hand() -> None:
    # r (1 / cos 45 - 1) = 0.3 m: r = 0.7243 m, cut 0.7243 m from both legs, arc 1.1377 m, sqrt(2.5 r) = 1.3456 m/s.
    radius = 0.3 / (math.sqrt(2.0) - 1.0)
    grid = path_grid(path([[0, 0, 0], [20, 0, 0], [20, 20, 0]], [0]), LIMITS, 0.3)
    is_arc = grid.curvature_per_m > 0.0
    assert is_arc.sum() == len(ARC_NODES) - 1
    assert grid.curvature_per_m[is_arc] == pytest.approx(1.0 / radius)
    assert grid.step_m[is_arc].sum() == pytest.approx(radius * math.pi / 2.0)
    assert grid.step_m[~is_arc].sum() == pytest.approx(2.0 * (20.0 - radius))
    squared = fastest_sweep(grid)
    middle = grid.vertex_node[1]
    assert squared[middle] == pytest.approx(2.5 * radius)
    # The vertex belongs to the middle of the arc.
    assert grid.step_m[:middle].sum() == pytest.approx(grid.step_m[middle:].sum())


def test_arcs_take_no_more_than_half_of_a_leg() -> None:
    grid = path_grid(path([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0]], []), LIMITS, 5.0)
    assert grid.step_m.sum() == pytest.approx(2.0 * 0.5 + 2.0 * 0.5 * math.pi / 2.0)
    assert not grid.is_stop[1:-1].any()


def test_going_straight_through_a_vertex_costs_nothing() -> None:
    through = path_grid(path([[0, 0, 0], [20, 0, 0], [40, 0, 0]], []), LIMITS, 0.3)
    direct = path_grid(path([[0, 0, 0], [40, 0, 0]]), LIMITS, 0.3)
    assert arrivals_s(through, fastest_sweep(through))[-1] == pytest.approx(
        arrivals_s(direct, fastest_sweep(direct))[-1]
    )


@pytest.mark.parametrize(
    "vertices",
    [
        [[0, 0, 0], [20, 0, 0], [0, 0, 0]],  # straight back
        [[0, 0, 0], [20, 0, 0], [20, 0, 0], [40, 0, 0]],  # a leg of no length
    ],
)
def test_reversals_and_legs_of_no_length_are_stopped_at(vertices: list[list[float]]) -> None:
    grid = path_grid(path(vertices, []), LIMITS, 0.3)
    squared = fastest_sweep(grid)
    assert squared[grid.vertex_node[1]] == 0.0
    assert arrivals_s(grid, squared)[-1] == pytest.approx(stopping_times_s(path(vertices), LIMITS)[-1])


def test_turning_on_the_spot_takes_the_time_of_the_turn() -> None:
    flown = path([[0, 0, 0], [5, 0, 0], [5, 0, 0], [9, 0, 0]], turn_s=[0.0, 2.0, 0.0])
    grid = path_grid(flown, LIMITS, 0.3)
    arrival = arrivals_s(grid, fastest_sweep(grid))
    assert arrival == pytest.approx(stopping_times_s(flown, LIMITS))
    assert arrival[2] - arrival[1] == pytest.approx(2.0)


def test_a_path_of_one_point_takes_no_time() -> None:
    grid = path_grid(path([[1, 2, 3]]), LIMITS, 0.3)
    assert arrivals_s(grid, fastest_sweep(grid)).tolist() == [0.0]


def slow_sweep(grid: PathGrid) -> np.ndarray:
    """Highest squared speeds by raising them bit by bit while every limit holds: the slow twin."""
    squared = np.zeros(len(grid.is_stop))
    step = 0.25 * grid.ceiling.max()
    while step > 1e-7 * grid.ceiling.max():
        is_raised = True
        while is_raised:
            is_raised = False
            for i in np.flatnonzero(~grid.is_stop):
                tried = squared.copy()
                tried[i] += step
                near = slice(max(0, i - 1), i + 1)
                rise = np.diff(tried)[near] / (2.0 * grid.step_m[near])
                bend = grid.curvature_per_m[near] * np.maximum(tried[:-1], tried[1:])[near]
                if tried[i] <= grid.ceiling[i] and (np.hypot(rise, bend) <= 2.5).all():
                    squared, is_raised = tried, True
        step /= 2.0
    return squared


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(3))
def test_the_sweep_reaches_what_raising_speeds_bit_by_bit_does(seed: int) -> None:
    vertices = np.cumsum(np.random.default_rng(seed).normal(size=(5, 3)) * 5.0, axis=0)
    grid = path_grid(path(vertices, []), LIMITS, 0.5)
    np.testing.assert_allclose(fastest_sweep(grid), slow_sweep(grid), atol=2e-5 * grid.ceiling.max())


def test_a_deviation_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="corner_deviation_m: expected more than 0"):
        path_grid(path([[0, 0, 0], [1, 0, 0]]), LIMITS, 0.0)
