"""Refining cameras with pycolmap, on the photos of Lund with the poses of their reference model."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.effects import decide
from planning.base.errors import InputError, OperationCancelled, ReconstructionError
from planning.base.progress import QUIET
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.colmap import refine
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import Similarity, angle_between_deg, georeference, posed_photos
from reconstruction.colmap.pycolmap_run import ColmapRun, Fit, FoundLens, StartPhoto, keep_counted
from reconstruction.colmap.record import camera_of
from reconstruction.colmap.refine import RefineParameters, _covariances, refine_poses
from tests.reconstruction.colmap.models import covariance, model, photos, turned

UPRIGHT = Similarity(1.0, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros(3))
"""The reference model has y down; its unit is taken for a metre."""

SIGMA_M, SIGMA_DEG = 0.02, 1.0


def start(folder: Path, n: int) -> tuple[list[PosedPhoto], list[PosedPhoto]]:
    """Photos as a drone gives them, with errors and a straight lens, its focal length 3 % too long; and the truth."""
    truth = list(posed_photos(read_model(folder / "colmap_ground_truth"), UPRIGHT, folder))[:n]
    rng = np.random.default_rng(0)
    lens = Intrinsics(1296, 1936, 2435.38 * 1.03, 2435.38 * 1.03, 648.0, 968.0)
    given = []
    for photo in truth:
        off = turned(photo, rng.normal(0.0, SIGMA_M, 3), rng.normal(0.0, np.radians(SIGMA_DEG), 3))
        pose = type(off.pose)(off.pose.position_enu_m, off.pose.cam_from_enu, covariance(SIGMA_M, SIGMA_DEG))
        given.append(PosedPhoto(photo.name, photo.path, lens, pose))
    return given, truth


@pytest.fixture
def folder(shared_data):
    pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    return shared_data / "multiview" / "lund_door"


@pytest.mark.parametrize("n_columns", [4, 6])
def test_the_largest_features_are_kept_in_their_order(tmp_path, n_columns):
    colmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    rng = np.random.default_rng(0)
    scales, turns, places = rng.permutation(50) + 1.0, rng.uniform(0.0, 6.0, 50), rng.uniform(0.0, 900.0, (50, 2))
    c, s = scales * np.cos(turns), scales * np.sin(turns)
    shapes = [scales, turns] if n_columns == 4 else [c, -s, s, c]
    keypoints = np.column_stack([places, *shapes]).astype(np.float32)
    descriptors = rng.integers(0, 255, (50, 128)).astype(np.uint8)
    path = tmp_path / "features.db"
    with colmap.Database.open(path) as database:
        camera = database.write_camera(colmap.Camera.create_from_model_name(1, "PINHOLE", 900.0, 900, 900))
        for number, n in ((1, 50), (2, 30)):
            image = database.write_image(colmap.Image(name=f"{number}.jpg", camera_id=camera))
            database.write_keypoints(image, keypoints[:n])
            database.write_descriptors(
                image, colmap.FeatureDescriptors(colmap.FeatureExtractorType.SIFT, descriptors[:n])
            )
    keep_counted(path, 30)
    large = scales > 20.0
    with colmap.Database.open(path) as database:
        for image, rows in ((1, large), (2, slice(0, 30))):
            assert np.array_equal(np.asarray(database.read_keypoints(image)), keypoints[rows])
            assert np.array_equal(np.asarray(database.read_descriptors(image).data), descriptors[rows])


@pytest.mark.parametrize("size_px", [900, 300])
def test_features_of_pixels_that_a_mask_has_black_do_not_count(tmp_path, size_px):
    colmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.uniform(0.0, 449.9, 30), rng.uniform(450.0, 900.0, 20)])
    keypoints = np.column_stack([x, rng.uniform(0.0, 900.0, 50), np.arange(1.0, 51.0), np.zeros(50)]).astype(np.float32)
    mask = np.zeros((size_px, size_px), np.uint8)
    mask[:, size_px // 2 :] = 255
    cv2.imwrite(str(tmp_path / "mask.png"), mask)
    descriptors = rng.integers(0, 255, (50, 128)).astype(np.uint8)
    path = tmp_path / "features.db"
    with colmap.Database.open(path) as database:
        camera = database.write_camera(colmap.Camera.create_from_model_name(1, "PINHOLE", 900.0, 900, 900))
        for name, n in (("card/a.jpg", 50), ("b.jpg", 50), ("black.jpg", 30), ("empty.jpg", 0)):
            image = database.write_image(colmap.Image(name=name, camera_id=camera))
            database.write_keypoints(image, keypoints[:n])
            database.write_descriptors(
                image, colmap.FeatureDescriptors(colmap.FeatureExtractorType.SIFT, descriptors[:n])
            )
    masks = dict.fromkeys(("card/a.jpg", "black.jpg", "empty.jpg"), tmp_path / "mask.png")
    kept = [np.arange(35, 50), np.arange(35, 50), np.arange(0), np.arange(0)]
    for _ in range(2):  # a run that was interrupted goes on with what it left
        keep_counted(path, 15, masks)
        with colmap.Database.open(path) as database:
            for number, rows in enumerate(kept, 1):
                assert np.array_equal(np.asarray(database.read_keypoints(number)).reshape(-1, 4), keypoints[rows])
                found = np.asarray(database.read_descriptors(number).data).reshape(-1, 128)
                assert np.array_equal(found, descriptors[rows])


@pytest.mark.parametrize("tilt_deg", [0.0, 25.0])
def test_positions_to_centimetres_find_a_lens_that_was_stated_wrongly(tmp_path, tilt_deg):
    """A grid flown to and fro, looking straight down: as a calibration of DJI's was off by 1 % and 30 pixels."""
    colmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    true = Intrinsics(1600, 1300, 1986.0, 1986.0, 788.0, 660.0, (-0.41, 0.21, 0.001, 0.0, 0.0))
    stated = Intrinsics(1600, 1300, 1973.0, 1956.0, 781.0, 630.0, (-0.42, 0.37, 0.004, 0.004, -0.26))
    posed = []
    for number in range(24):
        strip, step = divmod(number, 8)
        place = np.array([-14.0 + 4.0 * (7 - step if strip % 2 else step), 8.0 * (strip - 1), 44.0])
        pose = Pose.looking(place, 90.0 - 180.0 * (strip % 2), -90.0 + tilt_deg * (step % 2), 0.0, covariance(0.02))
        posed.append(PosedPhoto(f"{number:02d}.jpg", Path(f"{number:02d}.jpg"), true, pose))
    seen = model(posed, 2500, sigma_px=0.3, low=(-20.0, -16.0, 0.0), high=(20.0, 16.0, 6.0))
    write_model(tmp_path, replace(seen, cameras={1: camera_of(stated, 1)}), "txt")
    places = [StartPhoto(photo.name, "drone", stated, photo.pose.position_enu_m, 0.01 * np.eye(3)) for photo in posed]
    run = ColmapRun(colmap, tmp_path, tmp_path, places, RefineParameters(), QUIET)

    def off_m(adjusted):
        true_m = {photo.name: photo.pose.position_enu_m for photo in posed}
        images = [adjusted.image(number) for number in adjusted.reg_image_ids()]
        return np.median([np.linalg.norm(image.projection_center() - true_m[image.name]) for image in images])

    as_stated = colmap.Reconstruction(tmp_path)
    run.adjust(as_stated, {1})
    assert off_m(as_stated) > 0.06
    found = run.with_found_lenses(as_stated, {1}, tmp_path / "lenses")
    assert off_m(found) < 0.02
    fx, fy, cx, cy = found.camera(1).params[:4]
    # Straight down from one height, the ground may be as much lower as the focal length is longer.
    assert np.allclose((fx, fy), 1986.0, atol=6.0) if tilt_deg else (fx, fy) == pytest.approx((1964.5, 1964.5))
    assert np.allclose((cx, cy), (788.0, 660.0), atol=3.0)
    assert np.allclose(as_stated.camera(1).params[:4], (1973.0, 1956.0, 781.0, 630.0))


CALIBRATED = Intrinsics(1600, 1300, 1186.0, 1186.0, 800.0, 650.0, (-0.11, 0.05, 0.001, 0.0, -0.01))


def around(tmp_path, colmap, stated, find_lens="auto", n=12):
    """A model of a round flight with a calibrated lens, adjusted as it is stated, and its run."""
    posed = []
    for number in range(n):
        angle = 2.0 * np.pi * number / n
        place = np.array([19.0 * np.cos(angle), 19.0 * np.sin(angle), 4.0 + 5.0 * (number % 3)])
        heading = np.degrees(np.arctan2(-place[0], -place[1]))
        pose = Pose.looking(place, heading, -10.0 - 5.0 * (number % 3), 0.0, covariance(SIGMA_M))
        posed.append(PosedPhoto(f"{number:02d}.jpg", Path(f"{number:02d}.jpg"), CALIBRATED, pose))
    seen = model(posed, 600, sigma_px=0.5, low=(-7.0, -5.0, 0.0), high=(7.0, 5.0, 9.0))
    write_model(tmp_path, replace(seen, cameras={1: camera_of(stated, 1)}), "txt")
    rng = np.random.default_rng(0)
    places = [
        StartPhoto(
            photo.name,
            "drone",
            stated,
            photo.pose.position_enu_m + rng.normal(0.0, SIGMA_M, 3),
            SIGMA_M**2 * np.eye(3),
        )
        for photo in posed
    ]
    run = ColmapRun(colmap, tmp_path, tmp_path, places, RefineParameters(find_lens=find_lens), QUIET)
    start_model = colmap.Reconstruction(tmp_path)
    run.adjust(start_model, {1})
    return run, start_model


def longer(share):
    return replace(CALIBRATED, fx_px=(1.0 + share) * 1186.0, fy_px=(1.0 + share) * 1186.0)


@pytest.mark.parametrize(
    ("share", "setting", "is_found"),
    [(0.0, "auto", False), (0.015, "auto", True), (-0.015, "auto", True), (0.015, "off", False), (0.0, "on", True)],
)
def test_a_calibration_stays_unless_the_photos_contradict_it(tmp_path, share, setting, is_found):
    colmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    stated = longer(share)
    run, start_model = around(tmp_path, colmap, stated, setting)
    chosen, decision = run.choose_lenses(start_model, {1}, tmp_path / "lenses")
    assert decision.on is is_found
    assert decision.decided_by == ("scene" if setting == "auto" else "user")
    focal_px = chosen.camera(1).params[0]
    assert focal_px == pytest.approx(1186.0, abs=1.5) if is_found else focal_px == stated.fx_px
    if setting == "auto":
        stated_fit, found_fit = (
            run.fit_of(start_model),
            run.fit_of(run.with_found_lenses(start_model, {1}, tmp_path / "again")),
        )
        assert (stated_fit.error_px > 1.1 * found_fit.error_px) is is_found
        assert f"{stated_fit.error_px:.2f} px" in str(decision)


def test_too_few_photos_tell_no_lens(tmp_path):
    colmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    run, start_model = around(tmp_path, colmap, longer(0.015), n=8)
    chosen, decision = run.choose_lenses(start_model, {1}, tmp_path / "lenses")
    assert chosen is start_model
    assert not decision.on


@pytest.mark.parametrize(
    ("stated", "found", "is_on"),
    [
        (Fit(0.56, 2.0), Fit(0.56, 1.9), False),  # positions alone are met a little better by any lens that may bend
        (Fit(0.56, 30.0), Fit(0.56, 5.0), True),
        (Fit(0.56, 30.0), Fit(0.56, 20.0), False),
        (Fit(0.73, 2.0), Fit(0.56, 2.0), True),
        (Fit(0.56, 2.0), Fit(0.57, 2.0), False),
        (Fit(0.0, 0.0), Fit(0.0, 0.0), False),
    ],
)
def test_a_lens_is_found_where_image_points_fit_better_or_positions_contradict_the_stated_one(stated, found, is_on):
    assert decide(FoundLens(), (stated, found)).on is is_on


@pytest.mark.slow
def test_refined_poses_meet_the_reference(folder):
    given, truth = start(folder, 12)
    found = refine_poses(given, folder, RefineParameters(max_image_size_px=600, max_features=2000))
    assert [photo.name for photo in found.photos] == [photo.name for photo in truth]
    assert found.left_out == ()
    assert found.reprojection_px < 1.0
    lens = found.photos[0].intrinsics
    assert lens.fx_px == pytest.approx(2435.38, rel=0.01)
    between, angles, turns, in_sigmas, turned_sigmas = [], [], [], [], []
    for photo, true in zip(found.photos, truth, strict=True):
        off = photo.pose.position_enu_m - true.pose.position_enu_m
        between.append(off)
        one, other = photo.pose.cam_from_enu, true.pose.cam_from_enu
        angles.append(angle_between_deg(one, other))
        turns.append(other.T @ one)
        off_rad = cv2.Rodrigues(one @ other.T)[0].ravel()
        turned_sigmas.append(off_rad @ np.linalg.solve(photo.pose.covariance[3:, 3:], off_rad))
        in_sigmas.append(off @ np.linalg.solve(photo.pose.covariance[:3, :3], off))
    # A common shift is that of the receivers' mean error; the rest is how well the photos fit together.
    assert np.linalg.norm(np.mean(between, axis=0)) < 3.0 * SIGMA_M / 12**0.5 * 3**0.5
    assert np.linalg.norm(np.array(between) - np.mean(between, axis=0), axis=1).max() < 1.5 * SIGMA_M
    # The photos stand almost on a line: the model as a whole is turned about it, the photos fit each other.
    assert np.mean(angles) < SIGMA_DEG
    assert max(angle_between_deg(turn, turns[0]) for turn in turns) < 0.1
    assert np.mean(in_sigmas) < 3.0 * 3.0  # three axes; errors of neighbours go together
    assert np.mean(turned_sigmas) < 3.0 * 3.0
    assert len(found.model.points) > 1000
    assert len(found.model.cameras) == 1  # of photos in several batches


@pytest.mark.slow
def test_neighbours_suffice_and_a_calibrated_lens_stays(folder):
    given, truth = start(folder, 6)
    lens = Intrinsics(1296, 1936, 2435.38, 2435.38, 648.0, 968.0, (-0.0336, 0.0, 0.0, 0.0, 1e-4))
    calibrated = [replace(photo, intrinsics=lens) for photo in given]
    parameters = RefineParameters(max_image_size_px=500, max_features=1500, n_neighbours=3, exhaustive_up_to=2)
    found = refine_poses(calibrated, folder, parameters)
    assert found.left_out == ()
    assert {photo.intrinsics for photo in found.photos} == {lens}
    for photo, true in zip(found.photos, truth, strict=True):
        assert np.linalg.norm(photo.pose.position_enu_m - true.pose.position_enu_m) < 4.0 * SIGMA_M


@pytest.mark.slow
def test_photos_that_matches_put_nowhere_or_far_away_are_tried_where_they_say_that_they_were(folder, monkeypatch):
    given, truth = start(folder, 12)
    free_model = ColmapRun.map

    def spoiled(run, fixed_cameras):
        found = free_model(run, fixed_cameras)
        names = {found.image(number).name: number for number in found.reg_image_ids()}
        for photo in given[4:6]:
            found.deregister_frame(found.image(names[photo.name]).frame_id)
        away = found.frame(found.image(names[given[8].name]).frame_id)
        pose = away.rig_from_world
        away.rig_from_world = type(pose)(pose.rotation, pose.translation + np.array([3.0, 0.0, 0.0]))
        return found

    monkeypatch.setattr(ColmapRun, "map", spoiled)
    found = refine_poses(given, folder, RefineParameters(max_image_size_px=400, max_features=1500))
    assert found.left_out == ()
    off = np.array(
        [photo.pose.position_enu_m - true.pose.position_enu_m for photo, true in zip(found.photos, truth, strict=True)]
    )
    assert np.linalg.norm(off - off.mean(axis=0), axis=1).max() < 1.5 * SIGMA_M
    assert not [finding for finding in found.findings if finding.code in ("photos-not-refined", "positions-contradict")]


@pytest.mark.slow
def test_where_matches_alone_give_no_model_all_photos_begin_where_they_say_that_they_were(folder, monkeypatch):
    given, truth = start(folder, 12)
    monkeypatch.setattr(ColmapRun, "map", lambda run, fixed_cameras: None)
    found = refine_poses(given, folder, RefineParameters(max_image_size_px=400, max_features=1500))
    assert found.left_out == ()
    off = np.array([a.pose.position_enu_m - b.pose.position_enu_m for a, b in zip(found.photos, truth, strict=True)])
    assert np.linalg.norm(off - off.mean(axis=0), axis=1).max() < 1.5 * SIGMA_M


@pytest.mark.slow
def test_photos_that_show_nothing_in_common_are_refused(folder, tmp_path):
    given, _ = start(folder, 4)
    for photo in given:
        cv2.imwrite(str(tmp_path / photo.name), np.full((1936, 1296, 3), 128, np.uint8))
    blank = [replace(photo, path=tmp_path / photo.name) for photo in given]
    with pytest.raises(ReconstructionError, match="the 4 photos do not fit together"):
        refine_poses(blank, tmp_path, RefineParameters(max_image_size_px=400))


@pytest.mark.slow
def test_a_refinement_can_be_cancelled(folder):
    class Cancelling:
        stages: list[str] = []  # noqa: RUF012

        def report(self, stage, done, total):
            self.stages.append(stage)
            if len(self.stages) > 3:
                raise OperationCancelled("enough")

    with pytest.raises(OperationCancelled):
        refine_poses(start(folder, 4)[0], folder, RefineParameters(max_image_size_px=400), Cancelling())
    assert set(Cancelling.stages) == {"finding features"}


def test_too_many_photos_that_are_linked_count_as_equally_good(monkeypatch):
    monkeypatch.setattr(refine, "MAX_SEGMENT", 12)
    posed = photos(9)
    found = model(posed)
    covariances, said = _covariances(found, georeference(found, posed), posed, QUIET)
    assert [finding.code for finding in said] == ["accuracy-estimated"]
    assert set(covariances) == {photo.name for photo in posed}
    assert len({known.tobytes() for known in covariances.values()}) == 1


def test_without_pycolmap_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)
    with pytest.raises(InputError, match=r"pip install 'reflight-groundstation\[colmap\]'"):
        refine_poses(photos(3), Path())


def test_two_photos_are_too_few():
    with pytest.raises(InputError, match="at least 3 photos with a pose, got 2"):
        refine_poses(photos(2), Path())


@pytest.mark.parametrize("wrong", [{"max_image_size_px": 0}, {"max_features": 0}, {"n_neighbours": 0}])
def test_parameters_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ValueError, match="expected at least 1"):
        RefineParameters(**wrong)
