"""COLMAP's camera models and our intrinsics."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.record import RATIONAL_TOLERANCE_PX, ColmapCamera, camera_of, intrinsics_of

POINTS = np.stack([*np.meshgrid(np.linspace(-0.6, 0.6, 9), np.linspace(-0.45, 0.45, 7)), np.ones((7, 9))], axis=-1)


def pixels_by_opencv(camera: ColmapCamera) -> np.ndarray:
    """Projection by OpenCV, whose parameters are COLMAP's; its pixels count from the first one's centre."""
    fx, fy, cx, cy, *distortion = camera.parameters
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return cv2.projectPoints(POINTS.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), matrix, np.array(distortion))[0][:, 0]


@pytest.mark.parametrize(
    ("model", "parameters", "same_as"),
    [
        ("SIMPLE_PINHOLE", (3000, 2010, 1490), (3000, 3000, 2010, 1490)),
        ("PINHOLE", (3000, 3010, 2010, 1490), (3000, 3010, 2010, 1490)),
        ("SIMPLE_RADIAL", (3000, 2010, 1490, -0.05), (3000, 3000, 2010, 1490, -0.05, 0, 0, 0)),
        ("RADIAL", (3000, 2010, 1490, -0.05, 0.02), (3000, 3000, 2010, 1490, -0.05, 0.02, 0, 0)),
        ("OPENCV", (3000, 3010, 2010, 1490, -0.1, 0.02, 1e-3, -2e-3), None),
        ("FULL_OPENCV", (3000, 3010, 2010, 1490, -0.1, 0.02, 1e-3, -2e-3, 0.01, 0, 0, 0), None),
    ],
)
def test_every_model_projects_as_opencv_does(model, parameters, same_as):
    camera = ColmapCamera(1, model, 4000, 3000, tuple(map(float, parameters)))
    expected = pixels_by_opencv(ColmapCamera(1, "", 4000, 3000, same_as or camera.parameters))
    np.testing.assert_allclose(intrinsics_of(camera).pixels(POINTS.reshape(-1, 3)), expected, atol=1e-8)


@pytest.mark.parametrize(
    ("model", "parameters"),
    [
        ("OPENCV_FISHEYE", (1500, 1510, 2010, 1490, 0.05, -0.02, 0.003, -0.0005)),
        ("RADIAL_FISHEYE", (1500, 2010, 1490, 0.05, -0.02)),
        ("SIMPLE_RADIAL_FISHEYE", (1500, 2010, 1490, 0.05)),
    ],
)
def test_fisheyes_project_as_opencv_does_and_come_back(model, parameters):
    camera = ColmapCamera(1, model, 4000, 3000, tuple(map(float, parameters)))
    n_focal = 4 - int(model != "OPENCV_FISHEYE")
    fx, fy, cx, cy = parameters[:4] if n_focal == 4 else (parameters[0], *parameters[:3])
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    numbers = np.array([*parameters[n_focal:], 0.0, 0.0, 0.0][:4], float)
    points, nothing = POINTS.reshape(-1, 1, 3) * (4.0, 4.0, 1.0), np.zeros(3)
    expected, _ = cv2.fisheye.projectPoints(points, nothing, nothing, matrix, numbers)
    lens = intrinsics_of(camera)
    np.testing.assert_allclose(lens.pixels(points.reshape(-1, 3)), expected[:, 0], atol=1e-8)
    assert intrinsics_of(camera_of(lens, 3)) == lens


def test_a_rational_distortion_is_followed_or_refused_with_its_size():
    mild = (3000.0, 3010.0, 2010.0, 1490.0, 0.05, 0.01, 1e-4, -2e-4, 0.0, 0.1, 0.005, 0.0)
    camera = ColmapCamera(1, "FULL_OPENCV", 4000, 3000, mild)
    off_px = np.abs(intrinsics_of(camera).pixels(POINTS.reshape(-1, 3)) - pixels_by_opencv(camera)).max()
    assert 0.0 < off_px <= RATIONAL_TOLERANCE_PX
    for k4 in (3.0, -2.0):  # the second has a pole in the picture
        wild = (*mild[:9], k4, 0.0, 0.0)
        with pytest.raises(InputError, match="px from the nearest polynomial"):
            intrinsics_of(ColmapCamera(1, "FULL_OPENCV", 4000, 3000, wild))


@given(
    st.floats(500, 9000), st.floats(0.9, 1.1), st.tuples(*[st.floats(-0.2, 0.2)] * 5), st.sampled_from((0, 4, 5))
)  # fmt: skip
def test_our_intrinsics_come_back_exactly(fx, ratio, distortion, n_kept):
    kept = (*distortion[:n_kept], *[0.0] * (5 - n_kept))
    intrinsics = Intrinsics(4000, 3000, fx, fx * ratio, 2005.5, 1499.25, kept)
    camera = camera_of(intrinsics, 5)
    assert intrinsics_of(camera) == intrinsics
    assert (camera.id, camera.model) == (5, {0: "PINHOLE", 4: "OPENCV", 5: "FULL_OPENCV"}[n_kept]) or 0.0 in kept
