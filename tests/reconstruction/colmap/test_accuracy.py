"""Covariances of poses: against the whole normal matrix, and against what noise really does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.record import camera_of
from reconstruction.colmap.refine import LEAST_SIGMA_PX, pose_covariances
from tests.reconstruction.colmap.models import LENS, covariance, model, photos, turned

SIGMA_M = 0.02
SIGMA_RAD = np.radians(1.0)


def measured(posed, sigma_m=SIGMA_M, sigma_deg=1.0):
    """By name, with these standard deviations."""
    known = covariance(sigma_m, sigma_deg)
    return {photo.name: replace(photo, pose=replace(photo.pose, covariance=known)) for photo in posed}


def unknowns_moved(posed, xyz, step):
    """Photos and points after a step of all unknowns: poses, focal length, points."""
    n = len(posed)
    factor = 1.0 + step[6 * n]
    lens = Intrinsics(2000, 1500, 1500.0 * factor, 1500.0 * factor, 1000.0, 750.0, LENS.distortion)
    moved = [
        replace(turned(photo, step[6 * i : 6 * i + 3], step[6 * i + 3 : 6 * i + 6]), intrinsics=lens)
        for i, photo in enumerate(posed)
    ]
    return moved, xyz + step[6 * n + 1 :].reshape(-1, 3)


def whole_jacobian(posed, found):
    """Derivatives of all image points by all unknowns, numerically: the slow twin. Points seen once tell nothing."""
    all_rows = [image.point_ids - 1 for image in found.images.values()]
    often = np.flatnonzero(np.bincount(np.concatenate(all_rows), minlength=len(found.points)) >= 2)
    xyz = found.points.xyz[often]
    rows = [np.searchsorted(often, r[np.isin(r, often)]) for r in all_rows]

    def pixels(step):
        moved, points = unknowns_moved(posed, xyz, step)
        return np.concatenate([p.pixels(points[r]).ravel() for p, r in zip(moved, rows, strict=True)])

    n = 6 * len(posed) + 1 + 3 * len(xyz)
    columns = [(pixels(e) - pixels(-e)) / 2e-6 for e in 1e-6 * np.eye(n)]
    return np.stack(columns, axis=1)


@pytest.mark.long
def test_eliminating_the_points_gives_what_the_whole_normal_matrix_gives():
    posed = photos(6, rows=2)
    found = model(posed, 40)
    jacobian = whole_jacobian(posed, found)
    normal = jacobian.T @ jacobian / LEAST_SIGMA_PX**2
    for i in range(6):
        normal[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] += np.eye(3) / SIGMA_M**2
        normal[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] += np.eye(3) / SIGMA_RAD**2 / len(posed)
    expected = np.linalg.inv(normal)
    covariances = pose_covariances(found, measured(posed))
    for i, photo in enumerate(posed):
        np.testing.assert_allclose(
            covariances[photo.name], expected[6 * i : 6 * i + 6, 6 * i : 6 * i + 6], rtol=2e-3, atol=1e-9
        )


def test_many_photos_know_their_poses_better_than_their_receivers():
    posed = photos(24)
    covariances = pose_covariances(model(posed, 300), measured(posed))
    sigmas = np.sqrt([np.diag(c) for c in covariances.values()])
    assert (sigmas[:, :3] < SIGMA_M).all()
    assert (sigmas[:, 3:] < np.radians(0.3)).all()
    assert all(np.linalg.eigvalsh(c).min() > 0.0 for c in covariances.values())


def test_errors_of_the_image_points_count():
    posed = photos(12)
    surveyed = measured(posed, 1e-5, 90.0)  # so that image points alone decide the angles
    exact = pose_covariances(model(posed, 200), surveyed)
    noisy = pose_covariances(model(posed, 200, sigma_px=2.0), surveyed)
    ratio = np.sqrt(np.trace(noisy["003.jpg"][3:, 3:]) / np.trace(exact["003.jpg"][3:, 3:]))
    assert 0.9 < ratio / (2.0 / LEAST_SIGMA_PX) < 1.1


def test_what_nothing_fixes_is_not_told_as_known():
    posed = photos(6, rows=2)
    found = model(posed, 40)
    loose = replace(
        found, images={k: replace(v, point_ids=np.full_like(v.point_ids, -1)) for k, v in found.images.items()}
    )
    assert pose_covariances(loose, measured(posed)) == {}
    assert pose_covariances(replace(found, images={}), measured(posed)) == {}


def test_points_without_depth_do_no_harm():
    """Points seen once, and points as far away as makes no difference."""
    posed = photos(6, rows=2)
    found = model(posed, 40)
    covariances = pose_covariances(found, measured(posed))
    far = found.points.xyz.copy()
    far[0] = (0.0, 1e9, 0.0)
    stretched = replace(found, points=replace(found.points, xyz=far))
    with_far = pose_covariances(stretched, measured(posed))
    for name, found_covariance in with_far.items():
        assert np.isfinite(found_covariance).all()
        assert np.trace(found_covariance) > 0.5 * np.trace(covariances[name])


def test_two_cameras_have_their_own_focal_lengths():
    posed = photos(8, rows=2)
    found = model(posed, 80)
    second = camera_of(LENS.scaled(2000, 1500), 2)
    images = {k: replace(v, camera_id=1 + k % 2) for k, v in found.images.items()}
    both = pose_covariances(replace(found, cameras={**found.cameras, 2: second}, images=images), measured(posed))
    one = pose_covariances(found, measured(posed))
    for name in one:  # more unknowns are known less
        assert np.trace(both[name]) >= np.trace(one[name]) * (1.0 - 1e-9)


@pytest.mark.parametrize("sigma_m", [0.01, 1.0])
def test_a_common_error_of_all_receivers_stays(sigma_m):
    """Many photos share the error of where the whole model lies: it shrinks with the root of their number only."""
    posed = photos(24)
    covariances = pose_covariances(model(posed, 300), measured(posed, sigma_m))
    least = sigma_m / np.sqrt(24)
    for found in covariances.values():
        assert (np.sqrt(np.diag(found)[:3]) > 0.99 * least).all()
