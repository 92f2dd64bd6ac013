"""Facades by plane and by curved surface, the order of their panels, and panes that are given twice."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from planning.site.importing.facades import facade_name, group_facades
from planning.site.importing.panes import coincident_pairs, without_duplicates
from planning.site.importing.polygons import plane_axes, unit_normals


def wall(
    start: tuple[float, float, float], right: tuple[float, float], n_columns: int, n_rows: int, size_m: float = 1.5
) -> np.ndarray:
    """Grid of square panels 2 m apart; `right` is its horizontal direction as seen from outside."""
    across = np.array([*right, 0.0]) / np.hypot(*right)
    up = np.array([0.0, 0.0, 1.0])
    lows = [
        np.array(start) + 2.0 * column * across + 2.0 * row * up for row in range(n_rows) for column in range(n_columns)
    ]
    return np.array([[p, p + size_m * across, p + size_m * (across + up), p + size_m * up] for p in lows])


def ring(n: int, radius_m: float, n_rows: int = 1, concave: bool = False, span_rad: float = 2.0 * np.pi) -> np.ndarray:
    """Panels on a vertical cylinder, edge to edge, seen from outside (or from within)."""
    turns = np.linspace(0.0, span_rad, n + 1)
    points = np.c_[radius_m * np.cos(turns), radius_m * np.sin(turns)]
    quads = []
    for row in range(n_rows):
        for a, b in itertools.pairwise(points):
            low, high = 3.0 * row, 3.0 * row + 3.0
            a, b = (b, a) if concave else (a, b)
            quads.append([[*a, low], [*b, low], [*b, high], [*a, high]])
    return np.array(quads)


def sizes(corners: np.ndarray) -> list[int]:
    return [len(group) for group in group_facades(corners)]


@pytest.mark.parametrize(
    ("number", "name"), [(0, "A"), (1, "B"), (25, "Z"), (26, "AA"), (51, "AZ"), (52, "BA"), (702, "AAA")]
)
def test_facade_names_count_like_columns_of_a_sheet(number: int, name: str) -> None:
    assert facade_name(number) == name


def test_four_sides_of_a_box_are_four_facades_and_every_panel_is_in_one() -> None:
    corners = np.concatenate(
        [wall((0, 0, 0), (1, 0), 5, 3), wall((10, 0, 0), (0, 1), 4, 3), wall((10, 8, 0), (-1, 0), 5, 2),
         wall((0, 8, 0), (0, -1), 4, 1)]
    )  # fmt: skip
    groups = group_facades(corners)
    assert [len(group) for group in groups] == [15, 12, 10, 4]
    assert sorted(np.concatenate(groups)) == list(range(len(corners)))


def test_windows_far_apart_in_one_plane_are_one_facade_and_a_recess_is_another() -> None:
    near, far = wall((0, 0, 0), (1, 0), 2, 2), wall((60, 0, 0), (1, 0), 2, 2)
    recessed = wall((20, 1.5, 0), (1, 0), 2, 2)
    assert sizes(np.concatenate([near, far, recessed])) == [8, 4]


def test_window_types_of_little_different_depth_stay_together() -> None:
    corners = np.concatenate([wall((0, 0, 0), (1, 0), 2, 2), wall((4, 0.1, 0), (1, 0), 2, 2)])
    assert sizes(corners) == [8]


@pytest.mark.parametrize("concave", [False, True])
@pytest.mark.parametrize("n", [18, 24, 60])
def test_a_cylinder_is_one_facade(n: int, concave: bool) -> None:
    assert sizes(ring(n, 15.0, 4, concave)) == [4 * n]


@pytest.mark.parametrize(("n", "expected"), [(12, 12), (8, 8), (4, 4)])
def test_a_prism_with_corners_is_not(n: int, expected: int) -> None:
    assert len(sizes(ring(n, 15.0, 2))) == expected


def test_separate_windows_on_a_curved_wall_chain_when_as_near_as_they_are_wide() -> None:
    assert sizes(ring(60, 30.0)[::2]) == [30]


def test_a_curved_wall_and_the_flat_one_it_runs_into_are_one_surface_and_a_step_parts_them() -> None:
    bend = ring(30, 20.0, 1, span_rad=np.pi / 2.0)  # from east round to north
    smooth = np.array(
        [[[20.0, y, 0.0], [20.0, y + 1.0, 0.0], [20.0, y + 1.0, 3.0], [20.0, y, 3.0]] for y in (-2.0, -1.0)]
    )
    assert sizes(np.concatenate([bend, smooth])) == [32]
    assert sizes(np.concatenate([bend, smooth + np.array([2.0, 0.0, 0.0])])) == [30, 2]


@pytest.mark.parametrize("right", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.6, -0.8)])
def test_rows_rise_and_run_from_left_to_right_seen_from_outside(right: tuple[float, float]) -> None:
    corners = wall((5.0, 3.0, 2.0), right, 6, 4)
    shuffled = np.random.default_rng(0).permutation(len(corners))
    (group,) = group_facades(corners[shuffled])
    np.testing.assert_array_equal(shuffled[group], np.arange(len(corners)))


def test_windows_of_different_heights_on_one_floor_are_one_row() -> None:
    low = np.array([[[x, 0.0, 1.0], [x + 1, 0.0, 1.0], [x + 1, 0.0, 2.5], [x, 0.0, 2.5]] for x in (0.0, 4.0, 8.0)])
    tall = np.array([[[x, 0.0, 0.5], [x + 1, 0.0, 0.5], [x + 1, 0.0, 2.5], [x, 0.0, 2.5]] for x in (2.0, 6.0)])
    (group,) = group_facades(np.concatenate([low, tall]))
    assert list(group) == [0, 3, 1, 4, 2]


def test_the_order_on_a_curved_facade_follows_its_surface() -> None:
    corners = ring(40, 15.0, 3, span_rad=np.radians(300.0))  # three quarters round: no line orders it
    shuffled = np.random.default_rng(1).permutation(len(corners))
    (group,) = group_facades(corners[shuffled])
    np.testing.assert_array_equal(shuffled[group], np.arange(120))


def test_the_order_round_a_whole_tower_starts_somewhere_and_goes_round_once_to_the_right() -> None:
    corners = ring(36, 15.0, 2)
    (group,) = group_facades(corners)
    for row in (group[:36], group[36:]):
        centres = corners[row].mean(axis=1)
        turns = np.unwrap(np.arctan2(centres[:, 1], centres[:, 0]))
        np.testing.assert_allclose(np.diff(turns), np.radians(10.0), atol=1e-6)


def test_skylights_are_ordered_by_north_and_east() -> None:
    corners = np.array(
        [
            [[x, y, 12.0], [x + 1, y, 12.0], [x + 1, y + 1, 12.0], [x, y + 1, 12.0]]
            for y in (0.0, 3.0)
            for x in (0.0, 3.0)
        ]
    )
    (group,) = group_facades(corners[::-1].copy())
    assert list(group) == [3, 2, 1, 0]


def test_nothing_has_no_facades_and_one_panel_has_one() -> None:
    assert group_facades(np.zeros((0, 4, 3))) == []
    assert sizes(wall((0, 0, 0), (1, 0), 1, 1)) == [1]


@pytest.mark.slow
def test_five_thousand_panels_are_grouped_within_seconds() -> None:
    import time

    corners = np.concatenate([wall((0, 0, 0), (1, 0), 60, 60), ring(60, 40.0, 25) + np.array([200.0, 0.0, 0.0])])
    started = time.perf_counter()
    assert sizes(corners) == [1500, 3600]  # the curved one has more glass
    assert time.perf_counter() - started < 20.0


# --- panes that are given twice ---


def test_of_two_skins_the_outer_one_stays_and_of_one_plane_the_larger() -> None:
    inner = wall((0, 0, 0), (1, 0), 3, 2)
    outer = inner - np.array([0.0, 0.3, 0.0])
    assert list(without_duplicates(np.concatenate([inner, outer]))) == [6, 7, 8, 9, 10, 11]
    assert list(without_duplicates(np.concatenate([outer, inner]))) == [0, 1, 2, 3, 4, 5]
    smaller = inner + 0.05 * (inner.mean(axis=1, keepdims=True) - inner)
    assert list(without_duplicates(np.concatenate([smaller, inner]))) == [6, 7, 8, 9, 10, 11]


def test_a_frame_over_its_panes_goes_and_the_panes_stay() -> None:
    panes = wall((0, 0, 0), (1, 0), 3, 2)
    frame = np.array([[[0.0, 0.0, 0.0], [5.5, 0.0, 0.0], [5.5, 0.0, 3.5], [0.0, 0.0, 3.5]]])
    assert list(without_duplicates(np.concatenate([frame, panes]))) == [1, 2, 3, 4, 5, 6]


def test_panes_side_by_side_back_to_back_or_far_apart_all_stay() -> None:
    beside = wall((0, 0, 0), (1, 0), 3, 2, size_m=2.0)
    assert len(without_duplicates(beside)) == 6
    back = beside[:, ::-1] + np.array([0.0, 0.1, 0.0])
    assert len(without_duplicates(np.concatenate([beside, back]))) == 12
    across = beside - np.array([0.0, 5.0, 0.0])
    assert len(without_duplicates(np.concatenate([beside, across]))) == 12


def test_the_result_does_not_depend_on_the_order() -> None:
    inner = wall((0, 0, 0), (1, 0), 4, 3)
    corners = np.concatenate([inner, inner - np.array([0.0, 0.2, 0.0]), wall((30, 0, 0), (1, 0), 2, 2)])
    expected = set(without_duplicates(corners))
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(len(corners))
        assert {int(order[i]) for i in without_duplicates(corners[order])} == expected


def test_exact_copies_are_named() -> None:
    panes = wall((0, 0, 0), (1, 0), 3, 1)
    assert coincident_pairs(np.concatenate([panes, panes[1:2]])) == [(1, 3)]
    assert coincident_pairs(panes) == []
    assert coincident_pairs(np.zeros((0, 4, 3))) == []


def test_panels_used_here_are_seen_from_outside() -> None:
    normal = unit_normals(wall((0, 0, 0), (1, 0), 1, 1))[0]
    np.testing.assert_allclose(normal, [0.0, -1.0, 0.0])
    np.testing.assert_allclose(plane_axes(normal)[0], [1.0, 0.0, 0.0])
