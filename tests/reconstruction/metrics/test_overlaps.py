"""Overlaps of panels: counting equals the slow loop, and both ways of measuring agree."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from reconstruction.metrics.metrics import score_overlaps
from reconstruction.metrics.overlaps import MOST_PANELS, Array, Overlaps, index_image, pixel_overlaps

indices = arrays.arrays(np.uint16, (7, 9), elements=st.integers(0, 4))
masks = arrays.arrays(bool, (7, 9))


@given(indices, indices, masks, masks)
def test_one_pass_counts_what_a_loop_over_masks_counts(true, found, true_region, found_region) -> None:
    overlaps = pixel_overlaps(true, found, true_region, found_region)
    true_numbers, found_numbers = ([n for n in np.unique(index) if n] for index in (true, found))
    joint = [[((true == a) & (found == b)).sum() for b in found_numbers] for a in true_numbers]
    np.testing.assert_array_equal(overlaps.joint, np.reshape(joint, (len(true_numbers), len(found_numbers))))
    np.testing.assert_array_equal(overlaps.true_areas, [(true == a).sum() for a in true_numbers])
    np.testing.assert_array_equal(overlaps.found_areas, [(found == b).sum() for b in found_numbers])
    np.testing.assert_array_equal(overlaps.covered, [((true == a) & found_region).sum() for a in true_numbers])
    assert overlaps.true_region == true_region.sum()
    assert overlaps.found_region == found_region.sum()
    assert overlaps.joint_region == (true_region & found_region).sum()
    assert overlaps.picture == 63


def test_tall_pictures_are_counted_whole() -> None:
    true = np.zeros((1500, 2), np.uint16)
    true[::500] = 1
    true[1499] = 2
    np.testing.assert_array_equal(pixel_overlaps(true, true).true_areas, [6, 2])


def jittered_grid(rng: np.random.Generator, n: int, jitter_px: float) -> list[np.ndarray]:
    side = 400.0 / n
    return [
        np.array([[x, y + side], [x + side, y + side], [x + side, y], [x, y]]) + rng.normal(0.0, jitter_px, (4, 2))
        for y in np.arange(n) * side
        for x in np.arange(n) * side
    ]


@pytest.mark.parametrize("jitter_px", [0.0, 1.0, 4.0])
def test_pixels_and_exact_polygons_agree(jitter_px: float) -> None:
    rng = np.random.default_rng(1)
    # An odd scale: on panels that all lie alike on the pixels their rounding would not average out.
    true = [polygon * 0.9173 + 13.3 for polygon in jittered_grid(rng, 8, 0.0)]
    found = [
        0.97 * (corners - corners.mean(axis=0)) + corners.mean(axis=0) + rng.normal(0.0, jitter_px, 2)
        for corners in true
    ]
    exact = score_overlaps("", polygon_overlaps(true, found, 400, 400))
    counted = score_overlaps("", pixel_overlaps(index_image(true, 400, 400), index_image(found, 400, 400)))
    assert counted.individual_miou == pytest.approx(exact.individual_miou, abs=0.004)
    assert counted.overall_iou == pytest.approx(exact.overall_iou, abs=0.004)
    assert counted.coverage_percentile(10) == pytest.approx(exact.coverage_percentile(10), abs=0.04)
    assert (counted.n_missed, counted.n_false) == (exact.n_missed, exact.n_false)


def test_polygons_are_cut_at_the_picture_and_may_cross_themselves() -> None:
    half_out = np.array([[-5.0, 0.0], [5.0, 0.0], [5.0, 10.0], [-5.0, 10.0]])
    bow_tie = np.array([[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]])
    overlaps = polygon_overlaps([half_out], [bow_tie], 10, 10)
    assert overlaps.true_areas[0] == pytest.approx(50.0)
    assert overlaps.found_areas[0] == pytest.approx(50.0)
    assert overlaps.joint[0, 0] == pytest.approx(25.0)


def test_polygons_may_have_no_area() -> None:
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    for flat in (np.zeros((3, 2)), np.array([[1.0, 1.0], [3.0, 3.0], [2.0, 2.0]]), square * [1.0, 0.0]):
        overlaps = polygon_overlaps([square], [square, flat], 9, 9)
        np.testing.assert_array_equal(overlaps.joint, [[16.0]])
        scores = score_overlaps("", overlaps)
        assert (scores.individual_miou, scores.n_false) == (1.0, 0)
        assert score_overlaps("", polygon_overlaps([flat, square], [square], 9, 9)).n_true == 1


def test_polygons_may_be_none_at_all() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    assert polygon_overlaps([], [square], 9, 9).joint.shape == (0, 1)
    assert polygon_overlaps([square], [], 9, 9).covered[0] == 0.0


def test_wrong_calls_are_refused() -> None:
    index = np.zeros((4, 5), np.uint16)
    with pytest.raises(ValueError, match="found panels or"):
        pixel_overlaps(index, None)
    with pytest.raises(ValueError, match="one size"):
        pixel_overlaps(index, index.T)
    with pytest.raises(ValueError, match=f"to {MOST_PANELS}"):
        pixel_overlaps(index, np.full((4, 5), 65_535, np.uint16))


def polygon_overlaps(
    true_polygons: Sequence[Array], found_polygons: Sequence[Array], width_px: int, height_px: int
) -> Overlaps:
    """Exact areas of polygons, each shape (k, 2), inside a picture; regions are the unions of the panels.

    As in `pixel_overlaps`, polygons with no area inside the picture do not count.
    """
    frame = shapely.box(0.0, 0.0, width_px, height_px)
    true, found = (_inside(polygons, frame) for polygons in (true_polygons, found_polygons))
    joint = np.zeros((len(true), len(found)))
    if len(true) and len(found):
        first, second = shapely.STRtree(found).query(true, predicate="intersects")
        joint[first, second] = shapely.area(shapely.intersection(true[first], found[second]))
    true_region, found_region = shapely.union_all(true), shapely.union_all(found)
    return Overlaps(
        joint,
        np.asarray(shapely.area(true), float),
        np.asarray(shapely.area(found), float),
        np.asarray(shapely.area(shapely.intersection(true, found_region)), float),
        float(true_region.area),
        float(found_region.area),
        float(true_region.intersection(found_region).area),
        float(frame.area),
    )


def _inside(polygons: Sequence[Array], frame: Any) -> NDArray[Any]:
    """Shapely's polygons, cut at a frame."""
    shapes = shapely.make_valid(np.array([shapely.Polygon(polygon) for polygon in polygons], object))
    cut = shapely.intersection(shapes, frame)
    return np.asarray(cut[shapely.area(cut) > 0.0])
