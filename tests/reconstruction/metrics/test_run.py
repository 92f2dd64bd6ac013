"""Scoring a method on a set: perfect answers, masks, answers that never come, and views that fit the truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.errors import InfeasibleError, InputError, OperationCancelled
from planning.base.progress import QUIET
from reconstruction.metrics.run import Answer, masks_method, own_method, score_answer, score_set
from reconstruction.metrics.sets import SYNTHETIC_SETS, PhotoSet, ScoredPhoto, scored, surface_of, synthetic_set
from reconstruction.scenes.facades.cases import random_case, wide_camera
from reconstruction.scenes.facades.record import Layout, Wall
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.synthetic_photos import simple_case

SMALL = wide_camera(400, 300)


def perfect(photo: ScoredPhoto, _monitor: object) -> Answer:
    return Answer(photo.index, photo.region, 0.1)


@pytest.fixture(scope="module")
def planar() -> PhotoSet:
    photos = [scored(render_facade(random_case("planar", seed, SMALL))) for seed in range(3)]
    return PhotoSet("made-planar", tuple(photo.name for photo in photos), lambda: iter(photos))


@pytest.mark.slow
def test_perfect_answers_score_one(planar: PhotoSet) -> None:
    scores, worst = score_set(planar, perfect)
    assert scores.overall_iou.worst == scores.individual_miou.worst == scores.coverage[5] == 1.0
    assert (scores.n_missed, scores.n_false) == (0, 0)
    assert scores.seconds.mean == pytest.approx(0.1)
    assert len(worst) == 3


def test_worst_photos_come_first_and_few_are_kept(planar: PhotoSet) -> None:
    names = [photo.name for photo in planar.photos()]
    shifts = dict(zip(names, (0, 3, 1), strict=True))

    def shifted(photo: ScoredPhoto, _monitor: object) -> Answer:
        return Answer(np.roll(photo.index, shifts[photo.name], axis=1), photo.region, 0.0)

    scores, worst = score_set(planar, shifted, n_worst=2)
    assert [case.photo.name for case in worst] == [names[1], names[2]]
    assert scores.individual_miou.worst_photo == names[1]


def test_photo_that_cannot_be_done_scores_as_nothing_found(planar: PhotoSet) -> None:
    def refusing(photo: ScoredPhoto, _monitor: object) -> Answer:
        raise InfeasibleError(f"{photo.name}: seen edge-on")

    scores, _ = score_set(planar, refusing)
    assert scores.overall_iou.mean == scores.individual_miou.mean == 0.0
    assert scores.n_missed == scores.n_panels > 0


def test_masks_of_another_method_are_scored_without_panels(planar: PhotoSet, tmp_path: Path) -> None:
    for photo in planar.photos():
        cv2.imwrite(str(tmp_path / f"{photo.name}.png"), 255 * photo.region.astype(np.uint8))
    scores, _ = score_set(planar, masks_method(tmp_path, planar))
    assert scores.overall_iou.worst == 1.0
    assert scores.coverage[5] == 1.0
    assert scores.individual_miou is None
    (tmp_path / f"{photo.name}.png").unlink()
    with pytest.raises(InputError, match=photo.name):
        masks_method(tmp_path, planar)


def test_where_the_truth_knows_no_frames_the_answer_has_none_either(planar: PhotoSet) -> None:
    photo = next(planar.photos())
    windows = replace(photo, region=None)
    assert score_answer(windows, perfect(photo, QUIET)).overall_iou == 1.0
    only_region = Answer(None, photo.region, 0.0)
    assert 0.5 < score_answer(windows, only_region).overall_iou < 1.0


def test_cancelling_ends_scoring(planar: PhotoSet) -> None:
    class Cancelled:
        def report(self, stage: str, done: float, total: float) -> None:
            if done == 1:
                raise OperationCancelled

    with pytest.raises(OperationCancelled):
        score_set(planar, perfect, Cancelled())


@pytest.mark.slow
def test_own_method_answers_in_the_size_of_the_photo_and_counts_its_time() -> None:
    made = render_facade(simple_case(Layout(4, 6), intrinsics=wide_camera(800, 600)))
    ticks: Iterator[float] = iter((10.0, 12.5))
    answer = own_method(clock=lambda: next(ticks))(scored(made), QUIET)
    assert answer.seconds == 2.5
    assert answer.index is not None
    assert answer.region is not None
    assert answer.index.shape == answer.region.shape == made.index.shape
    assert answer.region[answer.index > 0].all()


@pytest.mark.parametrize("curvature", [0.0, 0.04])
def test_surface_and_view_of_a_made_facade_fit_its_truth(curvature: float) -> None:
    wall = Wall((10.0, -5.0, 3.0), 65.0, curvature)
    case = simple_case(Layout(5, 9, widths="random"), wall=wall, intrinsics=SMALL, oblique_deg=10.0)
    surface = surface_of(case)
    s, h = np.linspace(-6.0, 6.0, 7), np.linspace(0.0, 9.0, 7)
    np.testing.assert_allclose(surface.to_enu(np.column_stack([s, h])), wall.points_enu_m(s, h), atol=1e-9)
    np.testing.assert_allclose(surface.normals_at(np.column_stack([s, h])), wall.outward_enu(s), atol=1e-9)
    made = render_facade(case)
    (view,) = scored(made).views
    for panel in made.panels:
        rectified = view.to_rectified(panel.corners_px)
        # Lower left, lower right, upper right, upper left of an upright rectangle.
        np.testing.assert_allclose(rectified[[0, 1], 1], rectified[[1, 0], 1], atol=1e-6)
        np.testing.assert_allclose(rectified[[0, 1], 0], rectified[[3, 2], 0], atol=1e-6)
        np.testing.assert_allclose(view.to_photo(rectified), panel.corners_px, atol=1e-6)


def test_view_holds_the_facade_and_little_else_unless_its_extent_is_unknown() -> None:
    made = render_facade(random_case("planar", 2, SMALL))
    corners = np.concatenate([panel.corners_px for panel in made.panels])
    shares = []
    for margin_m in (0.5, 2.0, None):
        (view,) = scored(made, margin_m).views
        rectified = view.to_rectified(corners)
        size = np.array([view.width_px, view.height_px])
        assert ((rectified > 0.0) & (rectified < size)).all()
        shares.append(np.prod(np.ptp(rectified, axis=0)) / np.prod(size))
    assert 0.3 < shares[1] < shares[0] < 0.95
    assert shares[2] < 0.7 * shares[1]


@pytest.mark.slow
def test_made_sets_are_made_when_asked_for() -> None:
    for name, shape in SYNTHETIC_SETS.items():
        photos = synthetic_set(name, 10_000, SMALL)
        first = next(photos.photos())
        assert first.name == photos.photo_names[0] == f"{shape}-000"
        assert first.image.shape == (300, 400, 3)
        assert first.region is not None
