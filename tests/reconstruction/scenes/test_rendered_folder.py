"""Folders of photos that a real camera took: bent, told wrong, exposed one by one, moving."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from planning.photos.folder import read_photos
from planning.site.bundled import single_panel
from reconstruction.base.cameras import Intrinsics, Pose
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import Similarity, angle_between_deg
from reconstruction.colmap.georeference import posed_photos as of_colmap
from reconstruction.photos.lens import LensSource
from reconstruction.photos.poses import pose_photos
from reconstruction.scenes.parameters import DISTORTION, EXPOSURE, GIMBAL_ERROR, MOTION_BLUR, RenderSettings
from reconstruction.scenes.photos.camera_model import CameraModel, GimbalErrors, Moment, PositionErrors, bent_lens
from reconstruction.scenes.record import Scene
from reconstruction.scenes.runs.photo_folder import ScenePhotos, render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look
from tests.reconstruction.scenes.runs.test_photo_folder import job_for

BEND = (-0.35, 0.05, 0.002, -0.001, -0.02)
LENS = bent_lens(Intrinsics(64, 48, 60.0, 60.0, 32.0, 24.0), BEND)
CAMERA_MODEL = CameraModel(
    exposure="metered",
    distortion=BEND,
    position=PositionErrors("rtk", 0.05, 0.08, 0.2, 0.3),
    gimbal=GimbalErrors(0.2, 0.2, 0.2, 2.0, 1.0, 1.0),
)
MOMENTS = tuple(Moment(0, (speed_m_s, 0.0, 0.0), 0.004) for speed_m_s in (0.0, 40.0, 10.0))


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build_scene(single_panel(), Look(near=False), 2)


def taken_job(scene: Scene, folder: Path, lens: Intrinsics = LENS, **changes: Any) -> PhotoJob:
    """Three photos of a bent camera in motion; the second looks up to the sky."""
    job = job_for(
        scene, folder, camera_model=CAMERA_MODEL, moments=MOMENTS, settings=RenderSettings(effects={GIMBAL_ERROR: "on"})
    )
    photos = [replace(photo, intrinsics=lens) for photo in job.photos]
    middle = photos[1].pose
    photos[1] = replace(photos[1], pose=Pose.looking(middle.position_enu_m, middle.heading_deg, 17.0))
    return replace(job, photos=tuple(photos), **changes)


@pytest.fixture(scope="module")
def written(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> ScenePhotos:
    """A finished run; tests must not change it."""
    folder = tmp_path_factory.mktemp("taken") / "photos"
    return render_photo_folder(taken_job(scene, folder), folder, 1)


def record_of(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "scene.json").read_text()))


@pytest.mark.slow
def test_photos_tell_the_wrong_pose_and_the_right_lens(scene: Scene, written: ScenePhotos) -> None:
    images = written.folder / "images"
    back = pose_photos(read_photos(images).photos, scene.site.site, images)
    captures = record_of(written.folder)["captures"]
    for photo, lens, true in zip(back.photos, back.lenses, written.photos, strict=True):
        told = captures[photo.name]
        assert lens.source is LensSource.DEWARP
        assert lens.is_distortion_known
        assert photo.intrinsics.distortion == pytest.approx(BEND)
        assert photo.pose.position_enu_m == pytest.approx(np.array(told["told_position_enu_m"]), abs=1e-3)
        assert angle_between_deg(photo.pose.cam_from_enu, np.array(told["told_cam_from_enu"])) < 0.01
        assert np.linalg.norm(photo.pose.position_enu_m - true.pose.position_enu_m) > 0.02
        assert angle_between_deg(photo.pose.cam_from_enu, true.pose.cam_from_enu) > 0.1
        assert photo.pose.covariance is not None
        variances = np.diag(photo.pose.covariance)[:3]
        assert np.sqrt(variances) == pytest.approx([np.hypot(0.05, 0.2)] * 2 + [np.hypot(0.08, 0.3)], rel=1e-3)
    for metadata in back.metadata:
        assert metadata.is_rtk_fixed
        assert metadata.exposure_s == pytest.approx(captures[metadata.path.name]["exposure_s"], rel=1e-4)
    assert [metadata.speed_east_m_s for metadata in back.metadata] == [0.0, 40.0, 10.0]


def test_colmaps_and_nerfstudios_files_have_the_true_pose_and_the_lens(written: ScenePhotos) -> None:
    cameras = of_colmap(read_model(written.folder / "sparse" / "0"), Similarity.identity(), written.folder)
    transforms = json.loads((written.folder / "transforms.json").read_text())
    assert transforms["camera_model"] == "OPENCV"
    for camera, frame, true in zip(cameras, transforms["frames"], written.photos, strict=True):
        assert camera.intrinsics.distortion == pytest.approx(BEND)
        assert camera.pose.position_enu_m == pytest.approx(true.pose.position_enu_m)
        assert np.array(frame["transform_matrix"])[:3, 3] == pytest.approx(true.pose.position_enu_m)
        assert tuple(frame[name] for name in ("k1", "k2", "p1", "p2", "k3")) == BEND


def test_layers_lie_where_the_bent_picture_shows_things(scene: Scene, written: ScenePhotos) -> None:
    corners = scene.panes.corners_enu_m[0]
    for photo in written.photos:
        panels = cv2.imread(str(written.folder / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        mask = cv2.imread(str(written.folder / "masks" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED) > 0
        edge = np.concatenate([np.linspace(a, b, 40) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)])
        outline = photo.pixels(edge).astype(np.float32)
        inside_px = np.array(
            [[cv2.pointPolygonTest(outline, (x + 0.5, y + 0.5), True) for x in range(64)] for y in range(48)]
        )
        # Frames are 0.3 px wide.
        is_clear = np.abs(inside_px) > 0.5
        assert ((panels > 0) == (inside_px > 0.0))[is_clear].all()
        assert mask[panels > 0].all()
        assert not mask[inside_px < -1.0].any()
    above = written.photos[1]
    straight = replace(above, intrinsics=above.intrinsics.straight())
    assert np.linalg.norm(straight.pixels(corners) - above.pixels(corners), axis=1).max() > 0.6


def test_each_photo_has_its_own_exposure_in_thirds_of_a_stop(written: ScenePhotos) -> None:
    captures = record_of(written.folder)["captures"].values()
    assert len({capture["exposure"] for capture in captures}) > 1
    for capture, moment in zip(captures, MOMENTS, strict=True):
        stops = 3.0 * np.log2(capture["exposure"])
        assert stops == pytest.approx(round(stops), abs=1e-9)
        assert capture["exposure_s"] == pytest.approx(0.004 * capture["exposure"])
        way_m = moment.velocity_enu_m_s[0] * capture["exposure_s"]
        assert capture["moved_enu_m"] == pytest.approx([way_m, 0.0, 0.0])
    means = [cv2.imread(str(photo.path)).mean() for photo in written.photos]
    assert np.ptp(means) < 30.0


@pytest.mark.slow
def test_what_is_off_leaves_no_trace(scene: Scene, tmp_path: Path) -> None:
    effects = dict.fromkeys((DISTORTION, EXPOSURE, MOTION_BLUR), "off")
    folder = tmp_path / "off"
    photos = render_photo_folder(taken_job(scene, folder, settings=RenderSettings(effects=effects)), folder, 1).photos
    record = record_of(folder)
    assert all(photo.intrinsics.is_straight for photo in photos)
    assert record["camera"]["distortion"] == [0.0] * 5
    assert record["taking"]["distortion"] == list(BEND)
    for capture in record["captures"].values():
        assert (capture["exposure"], capture["exposure_s"], capture["moved_enu_m"]) == (1.0, 0.004, [0.0] * 3)


@pytest.mark.slow
def test_another_way_of_taking_is_another_run(scene: Scene, written: ScenePhotos) -> None:
    other = replace(CAMERA_MODEL, sensor=replace(CAMERA_MODEL.sensor, gain=2.0))
    with pytest.raises(InputError, match=r"taking\.sensor\.gain is 1\.0 there, and 2\.0 was asked for"):
        render_photo_folder(taken_job(scene, written.folder, camera_model=other), written.folder, 1)
    again = render_photo_folder(taken_job(scene, written.folder), written.folder, 1)
    assert again.n_kept == len(again.photos)


def test_moments_are_of_all_photos_or_none(scene: Scene, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="moments: expected one for each of 3 photos, or none, got 1"):
        taken_job(scene, tmp_path, moments=MOMENTS[:1])
