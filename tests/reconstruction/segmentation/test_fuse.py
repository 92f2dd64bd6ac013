"""Several views of one facade made into one picture."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.errors import InputError
from planning.progress import QUIET
from reconstruction.segmentation.fuse import fused
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.segment import segment_views
from reconstruction.segmentation.views import WholePicture
from tests.reconstruction.segmentation.pictures import draw, spans

Image = NDArray[np.uint8]

NOISE_GREY = 90.0
"""So much that one view does not show the grid."""


@given(seed=st.integers(0, 100), n=st.integers(2, 6))
def test_median_over_what_each_view_shows_equals_numpy(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    pictures = [rng.integers(0, 256, (7, 9)).astype(np.uint8) for _ in range(n)]
    valid = [rng.random((7, 9)) < 0.7 for _ in range(n)]
    picture, known = fused(pictures, valid)  # too little in common for any gain
    stack = np.where(np.array(valid), np.array(pictures, float), np.nan)
    expected = np.rint(
        np.array(
            [[np.median(c[np.isfinite(c)]) if np.isfinite(c).any() else 0 for c in r] for r in stack.transpose(1, 2, 0)]
        )
    )
    assert (known == np.any(valid, axis=0)).all()
    assert np.array_equal(picture, expected)


def test_darker_exposures_are_brought_to_the_first() -> None:
    rng = np.random.default_rng(0)
    first = rng.integers(60, 200, (40, 50)).astype(np.uint8)
    dark = np.rint(0.6 * first - 10.0).astype(np.uint8)
    everywhere = np.ones(first.shape, bool)
    picture, _ = fused([first, dark, dark], [everywhere] * 3)
    assert np.abs(picture.astype(int) - first).max() <= 3


def test_mirror_images_that_move_vanish_and_frames_stay() -> None:
    rng = np.random.default_rng(1)
    views = []
    for _ in range(5):
        view = np.full((60, 80), 120, np.uint8)
        x = rng.integers(0, 70)
        view[:, x : x + 6] = 250
        view[:, 40:44] = 30
        views.append(view)
    picture, _ = fused(views, [np.ones((60, 80), bool)] * 5)
    assert (picture[:, 40:44] < 60).all()
    assert (picture[:, :39] < 200).all()


def test_views_of_other_sizes_and_none_are_refused_in_words() -> None:
    with pytest.raises(InputError, match="at least one"):
        fused([], [])
    with pytest.raises(InputError, match="one size"):
        fused([np.zeros((3, 4), np.uint8), np.zeros((4, 4), np.uint8)], [np.ones((3, 4), bool)] * 2)


def test_a_grid_lost_in_noise_is_found_in_nine_views_together() -> None:
    columns, rows = spans(np.full(7, 70.0), 5.0, 50.0), spans(np.full(5, 80.0), 5.0, 50.0)
    size = int(columns[-1, 1] + 55), int(rows[-1, 1] + 55)
    views = [draw(columns, rows, size, 5.0, seed, noise=NOISE_GREY, reflection=0.8) for seed in range(9)]
    parameters = SegmentationParameters(straighten=False)
    whole = WholePicture(*size)

    def count(pictures: list[Image]) -> tuple[int, int]:
        grid = segment_views(pictures, [whole] * len(pictures), parameters, QUIET, "A")
        return max(0, len(grid.columns) - 1), max(0, len(grid.rows) - 1)

    assert count([view.picture for view in views]) == (7, 5)
    assert count([views[0].picture]) != (7, 5)
