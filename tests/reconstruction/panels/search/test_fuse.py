"""Several views of one facade searched as one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.progress import QUIET
from reconstruction.panels.search.grid import Axes
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.segment import fused, segment_views
from reconstruction.panels.search.views import WholePicture
from reconstruction.panels.segment import segment_view
from tests.reconstruction.panels.search.pictures import draw, spans

Image = NDArray[np.uint8]
Mask = NDArray[np.bool_]

PLAIN = SegmentationParameters(straighten=False)


def everywhere(picture: Image) -> Mask:
    return np.ones(picture.shape, bool)


def test_one_view_is_itself() -> None:
    picture = np.random.default_rng(0).integers(0, 256, (40, 50)).astype(np.uint8)
    found, alone = fused([picture], [everywhere(picture)], PLAIN), Axes.of(picture, everywhere(picture), PLAIN)
    for one, other in ((found.down, alone.down), (found.across, alone.across)):
        assert np.array_equal(one.edges.is_edge, other.edges.is_edge)
        assert np.array_equal(one.edges.offset_px, other.edges.offset_px)
        assert np.array_equal(one.coverage, other.coverage)


@given(seed=st.integers(0, 1000), n=st.integers(2, 5))
def test_every_row_is_of_the_view_whose_turn_it_is_among_those_that_show_the_place(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    pictures = [rng.integers(0, 256, (17, 19)).astype(np.uint8) for _ in range(n)]
    valid = [rng.random((17, 19)) < 0.7 for _ in range(n)]  # too little in common for any gain
    found = fused(pictures, valid, PLAIN).down
    alone = [Axes.of(picture, mask, PLAIN).down for picture, mask in zip(pictures, valid, strict=True)]
    for y in range(17):
        for x in range(19):
            showing = [k for k in range(n) if valid[k][y, x]]
            which = showing[y % len(showing)] if showing else 0
            assert found.edges.is_edge[y, x] == alone[which].edges.is_edge[y, x]
            assert found.picture[y, x] == alone[which].picture[y, x]


def test_frames_keep_their_support_and_mirror_images_that_move_lose_it() -> None:
    views = []
    for k in range(5):
        view = np.full((100, 80), 120, np.uint8)
        view[:, 8 + 6 * k : 11 + 6 * k] = 250
        view[:, 60:64] = 30
        views.append(view)
    down = fused(views, [everywhere(view) for view in views], PLAIN).down
    support = down.edges.is_edge.mean(axis=0)
    assert support[58:66].max() == 1.0
    assert 0.0 < support[:50].max() <= 0.2


def test_darker_exposures_are_brought_to_the_first() -> None:
    rng = np.random.default_rng(0)
    first = rng.integers(60, 200, (40, 50)).astype(np.uint8)
    dark = np.rint(0.6 * first - 10.0).astype(np.uint8)
    down = fused([first, dark], [everywhere(first)] * 2, PLAIN).down
    assert np.abs(down.picture - first).max() <= 3.0


def test_views_of_other_sizes_and_none_are_refused_in_words() -> None:
    with pytest.raises(InputError, match="at least one"):
        fused([], [], PLAIN)
    with pytest.raises(InputError, match="one size"):
        fused([np.zeros((3, 4), np.uint8), np.zeros((4, 4), np.uint8)], [np.ones((3, 4), bool)] * 2, PLAIN)


@pytest.mark.slow
def test_a_grid_behind_mirrored_lines_is_found_in_five_views_together_and_in_none_alone() -> None:
    columns, rows = spans(np.full(7, 70.0), 5.0, 50.0), spans(np.full(5, 80.0), 5.0, 50.0)
    size = int(columns[-1, 1] + 55), int(rows[-1, 1] + 55)
    rng = np.random.default_rng(3)
    views = []
    for _ in range(5):
        picture = draw(columns, rows, size, 5.0, 1).picture.copy()
        top, bottom, left, right = (int(v) for v in (rows[0, 0], rows[-1, 1], columns[0, 0], columns[-1, 1]))
        for x in rng.choice(np.arange(left, right - 4), 14, replace=False):
            picture[top:bottom, x : x + 4] = 235
        for y in rng.choice(np.arange(top, bottom - 4), 10, replace=False):
            picture[y : y + 4, left:right] = 235
        views.append(picture)
    whole = WholePicture(*size)
    together = segment_views(views, [whole] * 5, PLAIN, QUIET, "A")
    assert [(len(grid.columns) - 1, len(grid.rows) - 1) for grid in together] == [(7, 5)] * 5
    alone = [segment_view(view, whole, PLAIN, QUIET, "A") for view in views]
    assert all((len(grid.columns) - 1, len(grid.rows) - 1) != (7, 5) for grid in alone)
