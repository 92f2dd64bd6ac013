"""Cells cut by inclined profiles: nothing is lost, nothing overlaps, and a site takes what comes out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.site.records import Panel
from reconstruction.panels.search.cutting import LEAST_PIECE, Cut, area, cut_pieces, four_corners

Array = NDArray[np.float64]

BOX = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]])

angles = st.floats(0.0, 2.0 * np.pi)


def through(point: tuple[float, float], angle: float, half_width: float = 0.05, open_side: int = 0) -> Cut:
    along = 10.0 * np.array([np.cos(angle), np.sin(angle)])
    return Cut(np.array(point) - along, np.array(point) + along, half_width, open_side)


@given(st.floats(0.3, 2.7), st.floats(0.3, 1.7), angles, st.floats(0.0, 0.1))
def test_two_pieces_and_the_profile_between_them_are_the_cell(x: float, y: float, angle: float, half: float) -> None:
    cut = through((x, y), angle, half)
    sides = [cut_pieces(BOX, [through((x, y), angle, half, side)]) for side in (1, -1)]
    kept = sum(area(piece) for pieces in sides for piece in pieces)
    assert kept == pytest.approx(sum(area(piece) for piece in cut_pieces(BOX, [cut])))
    n_closed = 2 - len(sides[0]) - len(sides[1])
    lost = 6.0 - kept
    assert -1e-9 <= lost <= 2.0 * half * np.hypot(3.0, 2.0) + n_closed * LEAST_PIECE * 6.0 + 1e-9


@given(st.lists(st.tuples(st.floats(0.5, 2.5), st.floats(0.5, 1.5), angles), min_size=1, max_size=3))
def test_pieces_turn_as_the_cell_and_do_not_overlap(places: list[tuple[float, float, float]]) -> None:
    cuts = [through((x, y), angle) for x, y, angle in places]
    pieces = cut_pieces(BOX, cuts)
    assert sum(area(piece) for piece in pieces) < 6.0
    assert all(area(piece) > 0.0 for piece in pieces)
    for cut in cuts:
        for piece in pieces:
            off = cut.signed(piece)
            assert off.min() >= cut.half_width - 1e-9 or off.max() <= -cut.half_width + 1e-9


def test_a_line_from_corner_to_corner_does_not_cut_the_cells_that_it_touches() -> None:
    diagonal = Cut(np.array([0.0, 0.0]), np.array([3.0, 2.0]), 0.05)
    assert [len(piece) for piece in cut_pieces(BOX, [diagonal])] == [3, 3]
    beside = BOX + np.array([3.0, 0.0])
    (whole,) = cut_pieces(beside, [diagonal])
    assert whole is beside


def test_a_line_that_ends_before_the_cell_does_not_cut_it() -> None:
    (whole,) = cut_pieces(BOX, [Cut(np.array([-3.0, -2.0]), np.array([0.6, 0.4]), 0.05)])
    assert whole is BOX


def test_beyond_the_facades_edge_there_are_no_panels() -> None:
    gable = Cut(np.array([-3.0, 1.0]), np.array([6.0, 1.0 + 1e-3]), 0.05, open_side=-1)
    (kept,) = cut_pieces(BOX, [gable])
    assert kept[:, 1].max() < 1.0
    assert cut_pieces(BOX + np.array([0.0, 2.0]), [gable]) == []
    (below,) = cut_pieces(lower := BOX - np.array([0.0, 2.0]), [gable])
    assert below is lower


def test_an_edge_in_front_of_its_frame_is_further_out() -> None:
    gable = through((1.5, 1.0), 0.3, 0.1, open_side=-1)
    (glass,), (outer,) = cut_pieces(BOX, [gable]), cut_pieces(BOX, [gable], is_outer=True)
    assert area(outer) - area(glass) == pytest.approx(0.2 * 3.0 / np.cos(0.3), rel=0.02)
    (whole,) = cut_pieces(BOX, [through((1.5, 1.0), 0.3)], is_outer=True)
    assert whole is BOX


@given(
    st.lists(angles, min_size=3, max_size=6, unique=True).filter(
        lambda found: np.diff([*sorted(found), min(found) + 2.0 * np.pi]).min() > 0.2
    )
)
def test_a_site_takes_four_corners_of_any_convex_panel(directions: list[float]) -> None:
    turned = np.sort(directions)
    outline = np.column_stack([2.0 * np.cos(turned), np.zeros(len(turned)), 2.0 * np.sin(turned)])
    corners = four_corners(outline)
    a, b, c, d = (tuple(corner) for corner in np.round(corners, 4).tolist())
    Panel("A-01-01a", (a, b, c, d))
    normals = [np.cross(p[2] - p[0], p[-1] - p[1]) for p in (corners, outline)]
    assert normals[0] @ normals[1] > 0.0
    flat, kept = outline[:, [0, 2]], corners[:, [0, 2]]
    share = area(kept) / area(flat)
    # The fourth corner of a triangle lies a little outside; thin ones, 40 times as long as high, grow by 4 %.
    limits = {3: (1.0, 1.06), 4: (1.0 - 1e-9, 1.0 + 1e-9)}
    low, high = limits.get(len(outline), (0.6, 1.0))
    assert low <= share <= high
