"""Marks of control points, with the slips that files of them have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.coarse.marks import agreeing_marks, factor_of_marks, meeting_place, scaled_marks

LENS = Intrinsics(4000, 3000, 3000.0, 3000.0, 2000.0, 1500.0)
POINTS = np.array([[0.0, 30.0, 0.0], [8.0, 32.0, 1.0], [-6.0, 35.0, 0.5], [3.0, 28.0, -1.0], [-2.0, 31.0, 4.0]])


@pytest.fixture
def photos():
    poses = [Pose.looking(np.array([8.0 * k - 12.0, 0.0, 6.0 + k]), 12.0 - 8.0 * k, -10.0) for k in range(4)]
    return [PosedPhoto(f"{k}.jpg", Path(f"{k}.jpg"), LENS, pose) for k, pose in enumerate(poses)]


def marked(photos, point, off_px=(0.0, 0.0, 0.0, 0.0)):
    return [
        (photo, *(photo.pixels(point[None])[0] + (off, 0.0)).tolist())
        for photo, off in zip(photos, off_px, strict=True)
    ]


def test_marks_meet_where_the_point_is_and_all_agree(photos):
    seen = marked(photos, POINTS[1], (2.0, -3.0, 1.0, 0.0))
    np.testing.assert_allclose(meeting_place(seen), POINTS[1], atol=0.05)
    assert agreeing_marks(seen) == seen


def test_a_mark_on_another_target_is_found_out(photos):
    seen = marked(photos, POINTS[1], (0.0, 0.0, 700.0, 0.0))
    assert [photo.name for photo, _, _ in agreeing_marks(seen)] == ["0.jpg", "1.jpg", "3.jpg"]
    # Its rays would meet behind one of two cameras.
    assert agreeing_marks(marked(photos, POINTS[1], (-1500.0, 1500.0, 0.0, 0.0))[:2]) == []


@pytest.mark.long
def test_pixels_of_reduced_photos_are_told_by_their_factor(photos):
    whole = [marked(photos, point) for point in POINTS]
    assert factor_of_marks(whole) is None
    reduced = [scaled_marks(seen, 1.0 / 1.92) for seen in whole]
    assert factor_of_marks(reduced) == pytest.approx(1.92, rel=0.01)


@pytest.mark.long
def test_marks_that_fit_with_no_factor_have_none(photos):
    rng = np.random.default_rng(3)
    wrong = [[(photo, *rng.uniform((0.0, 0.0), (4000.0, 3000.0))) for photo in photos] for _ in POINTS]
    assert factor_of_marks(wrong) is None
    assert factor_of_marks([scaled_marks(marked(photos, POINTS[0]), 0.5)]) is None
