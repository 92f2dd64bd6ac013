"""Knobs of the search for panels turned one at a time."""

from __future__ import annotations

import pytest

from reconstruction.made_facades.cases import simple_case, wide_camera
from reconstruction.made_facades.record import Layout
from reconstruction.made_facades.render import make_facade
from reconstruction.scores.sets import PhotoSet, scored
from reconstruction.scores.tradeoff import SegmentVariants, run_variants, variant_rows, variants_panel
from reconstruction.segmentation.parameters import SegmentationParameters


def test_every_setting_is_scored_on_the_same_photos_and_drawn_a_line_a_knob() -> None:
    photo = scored(make_facade(simple_case(Layout(4, 6), intrinsics=wide_camera(640, 480))))
    photos = PhotoSet("one", (photo.name,), lambda: iter([photo]))
    base = SegmentationParameters(long_side_px=640)
    runs = run_variants(photos, base, SegmentVariants((320, 640), (16,), ("lsd",)))
    assert [run.name for run in runs] == [
        "as asked",
        "image size 320",
        "image size 640",
        "samples 16",
        "detector lsd",
    ]
    assert runs[3].parameters == SegmentationParameters(long_side_px=640, n_samples=16)
    # The same settings give the same score.
    assert runs[2].gap == runs[0].gap
    rows = variant_rows(runs)
    assert all(0.0 <= row["individual_miou"] <= 1.0 and row["photos"] == 1 for row in rows)
    panel = variants_panel("t", runs)
    assert [line.name for line in panel.lines] == ["as asked", "image size", "samples", "detector"]
    assert panel.lines[1].curve.final_gap == min(runs[1].gap, runs[2].gap)


def test_values_that_no_knob_takes_are_refused() -> None:
    with pytest.raises(ValueError, match="--detectors: expected gradient, hough"):
        SegmentVariants(detectors=("canny",))
    with pytest.raises(ValueError, match="--sizes"):
        SegmentVariants((4,))
    with pytest.raises(ValueError, match="--samples"):
        SegmentVariants(samples=(-1,))
