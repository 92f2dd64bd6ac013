"""Knobs of the search for panels turned one at a time."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from reconstruction.metrics.sets import PhotoSet, scored, synthetic_set
from reconstruction.panels.search.grid import Axes, Rows, posterior
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.scenes.facades.record import Layout
from reconstruction.scenes.facades.render import render_facade
from reconstruction.tradeoff.search_tradeoff import SegmentVariants, run_variants, variant_rows, variants_panel
from tests.reconstruction.synthetic_photos import simple_case


@pytest.mark.slow
def test_every_setting_is_scored_on_the_same_photos_and_drawn_a_line_a_knob() -> None:
    photo = scored(render_facade(simple_case(Layout(4, 6), intrinsics=wide_camera(480, 360))))
    photos = PhotoSet("one", (photo.name,), lambda: iter([photo]))
    base = SegmentationParameters(long_side_px=480)
    runs = run_variants(photos, base, SegmentVariants((240, 480), (16,), ("lsd",)))
    assert [run.name for run in runs] == [
        "as asked",
        "image size 240",
        "image size 480",
        "samples of a row 16",
        "detector lsd",
    ]
    assert runs[3].parameters == SegmentationParameters(long_side_px=480, n_samples=16, use_posterior=True)
    # The same settings give the same score.
    assert runs[2].gap == runs[0].gap
    rows = variant_rows(runs)
    assert all(0.0 <= row["individual_miou"] <= 1.0 and row["photos"] == 1 for row in rows)
    panel = variants_panel("t", runs)
    assert [line.name for line in panel.lines] == ["as asked", "image size", "samples of a row", "detector"]
    assert panel.lines[1].curve.final_gap == min(runs[1].gap, runs[2].gap)


def test_values_that_no_knob_takes_are_refused() -> None:
    with pytest.raises(ValueError, match="--detectors: expected gradient, hough"):
        SegmentVariants(detectors=("canny",))
    with pytest.raises(ValueError, match="--sizes"):
        SegmentVariants((4,))
    with pytest.raises(ValueError, match="--samples"):
        SegmentVariants(samples=(-1,))
    with pytest.raises(ValueError, match="--views: expected 1 or more"):
        SegmentVariants(n_views=(0,))
    with pytest.raises(ValueError, match="--rectified-by: expected auto, exact, tangent, polynomial, got round"):
        SegmentVariants(view_kinds=("round",))


@pytest.mark.slow
def test_more_samples_of_a_row_take_the_posterior_and_change_what_is_compared() -> None:
    """Without the posterior no rows are compared, and the knob would turn nothing."""
    photo = scored(render_facade(simple_case(Layout(4, 6), intrinsics=wide_camera(640, 480))))
    photos = PhotoSet("one", (photo.name,), lambda: iter([photo]))
    base = SegmentationParameters(long_side_px=640)
    runs = run_variants(photos, base, SegmentVariants((), (16, 0)))
    assert [run.parameters.use_posterior for run in runs] == [False, True, True]
    axis = Axes.of(cv2.cvtColor(photo.image, cv2.COLOR_BGR2GRAY), None, base).down
    rows = axis.picture.T
    prior = np.random.default_rng(0).random(len(rows))
    few, all_of_them = (posterior(Rows.of(rows, run.parameters.n_samples), prior, 20.0) for run in runs[1:])
    assert np.abs(few - all_of_them).max() > 1e-6


@pytest.mark.slow
def test_photos_searched_together_and_other_rectifications_are_knobs_of_made_sets() -> None:
    photos = synthetic_set("made-curved", 1, wide_camera(640, 480), n_beside=1)
    base = SegmentationParameters(long_side_px=640)
    variants = SegmentVariants((), (), n_views=(2,), view_kinds=("exact", "polynomial"))
    runs = run_variants(photos, base, variants)
    assert [run.name for run in runs[1:]] == ["views together 2", "rectified exact", "rectified polynomial"]
    exact, polynomial = runs[2:]
    # The exact view is the usual one; the paper's polynomial is off.
    assert exact.gap == runs[0].gap
    assert exact.view_error_px is None
    assert polynomial.view_error_px is not None
    assert 0.001 < polynomial.view_error_px < 20.0
    assert variant_rows(runs)[-1]["view_error_px"] == round(polynomial.view_error_px, 3)
