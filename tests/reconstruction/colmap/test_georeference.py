"""Models laid into the site by the positions of their photos."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.base.cameras import Pose
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import (
    Similarity,
    angle_between_deg,
    georeference,
    in_enu,
    model_of,
    posed_photos,
)
from reconstruction.colmap.record import rotation_of
from tests.reconstruction.colmap.models import covariance, model, photos, turned
from tests.slow import slow

AWAY = Similarity(0.137, rotation_of((0.3, -0.5, 0.7, 0.2)), np.array([4.0, -9.0, 2.0]))
"""From the site's frame to a model's own."""

FOLDER = Path("photos")


def assert_posed(found, expected, position_m, angle_deg):
    for one, other in zip(found, expected, strict=True):
        assert one.name == other.name
        assert np.linalg.norm(one.pose.position_enu_m - other.pose.position_enu_m) < position_m
        assert angle_between_deg(one.pose.cam_from_enu, other.pose.cam_from_enu) < angle_deg


def test_a_model_in_a_frame_of_its_own_comes_back_to_the_site():
    posed = photos()
    free = in_enu(model(posed), AWAY)
    found = georeference(free, posed)
    assert found.rms_m < 1e-6
    assert found.angles_deg.max() < 1e-5
    assert found.is_inlier.all()
    assert found.findings == ()
    assert_posed(posed_photos(free, found.enu_from_model, FOLDER), posed, 1e-6, 1e-5)
    back = in_enu(free, found.enu_from_model)
    np.testing.assert_allclose(back.points.xyz, model(posed).points.xyz, atol=1e-6)


def test_residuals_are_the_errors_of_the_positions():
    posed = photos(30)
    rng = np.random.default_rng(0)
    errors = rng.normal(0.0, 0.02, (30, 3))
    measured = [turned(photo, e, np.zeros(3)) for photo, e in zip(posed, errors, strict=True)]
    measured[4] = turned(measured[4], np.array([3.0, 0.0, 0.0]), np.zeros(3))
    found = georeference(in_enu(model(posed), AWAY), measured)
    assert not found.is_inlier[4]
    assert found.is_inlier.sum() == 29
    assert 0.8 * 0.02 * 3**0.5 < found.rms_m < 1.2 * 0.02 * 3**0.5
    assert np.corrcoef(found.residuals_m[found.is_inlier].ravel(), -errors[found.is_inlier].ravel())[0, 1] > 0.9
    assert [finding.code for finding in found.findings] == ["positions-contradict"]


def test_photos_in_one_row_are_turned_by_their_cameras_angles():
    row = [
        replace(photo, pose=Pose(np.array([1.5 * i, -12.0, 5.0]), photo.pose.cam_from_enu, photo.pose.covariance))
        for i, photo in enumerate(photos(10))
    ]
    rng = np.random.default_rng(1)
    measured = [turned(photo, rng.normal(0.0, 0.02, 3), rng.normal(0.0, 0.01, 3)) for photo in row]
    found = georeference(in_enu(model(row), AWAY), measured)
    assert found.on_a_line
    assert [finding.code for finding in found.findings] == ["model-on-a-line"]
    assert_posed(posed_photos(in_enu(model(row), AWAY), found.enu_from_model, FOLDER), row, 0.3, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("sigma_m", "sigma_deg"), [slow(2.0, 0.5), (0.02, 20.0)], ids=["angles", "positions"])
def test_what_is_known_better_decides(sigma_m, sigma_deg):
    """Errors of the model's angles stay below those of either alone: 2 m on a flight of 12 m, or 20 degrees."""
    errors = []
    for seed in range(8):
        posed = photos(12, seed, sigma_m=sigma_m)
        rng = np.random.default_rng(seed)
        known = covariance(sigma_m, sigma_deg)
        off_rad = rng.normal(0.0, np.radians(sigma_deg), 3)  # the same for all: that of the gimbal
        given = [
            turned(replace(p, pose=replace(p.pose, covariance=known)), rng.normal(0.0, sigma_m, 3), off_rad)
            for p in posed
        ]
        free = in_enu(model(posed), AWAY)
        found = posed_photos(free, georeference(free, given).enu_from_model, FOLDER)
        errors.append(angle_between_deg(found[0].pose.cam_from_enu, posed[0].pose.cam_from_enu))
    assert np.mean(errors) < 2.5 * min(sigma_deg, np.degrees(sigma_m / 4.0))


def test_a_model_of_other_photos_or_of_one_place_is_refused():
    posed = photos()
    with pytest.raises(InputError, match="2 of its 12 images are among the 2 photos"):
        georeference(model(posed), posed[:2])
    still = [replace(photo, pose=replace(photo.pose, position_enu_m=np.zeros(3))) for photo in posed]
    with pytest.raises(InputError, match="in one place"):
        georeference(model(posed), still)


def test_photos_become_a_model_and_come_back(tmp_path):
    posed = photos()
    posed[3] = replace(posed[3], intrinsics=posed[3].intrinsics.straight(), taken_at=datetime(2024, 5, 1))
    made = model_of(posed)
    assert [camera.model for camera in made.cameras.values()] == ["OPENCV", "PINHOLE"]
    write_model(tmp_path, made)
    again = posed_photos(read_model(tmp_path), Similarity.identity(), FOLDER, {"003.jpg": datetime(2024, 5, 1)})
    assert_posed(again, posed, 1e-9, 1e-6)
    assert [photo.intrinsics for photo in again] == [photo.intrinsics for photo in posed]
    assert again[3].taken_at == datetime(2024, 5, 1)
    assert again[0].path == FOLDER / "000.jpg"


@pytest.mark.long
def test_the_real_model_meets_its_own_cameras(shared_data):
    folder = shared_data / "multiview" / "lund_door"
    real = read_model(folder / "colmap_ground_truth")
    posed = posed_photos(real, AWAY, folder)
    found = georeference(real, posed)
    assert found.rms_m < 1e-6
    errors = []
    for photo in posed:
        image = next(image for image in real.images.values() if image.name == photo.name)
        seen = np.flatnonzero(image.point_ids >= 0)
        row = {point: index for index, point in enumerate(real.points.ids.tolist())}
        rows = [row[point] for point in image.point_ids[seen].tolist()]
        errors.append(np.linalg.norm(photo.pixels(AWAY(real.points.xyz[rows])) - image.points_px[seen], axis=1))
    assert np.median(np.concatenate(errors)) < 0.7  # its points project where they were found: frames and pixels agree
