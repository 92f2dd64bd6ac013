"""Cameras of photos: projection, rays and poses."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.geo.frames import camera_axes
from planning.plan import Viewpoint
from reconstruction.base.cameras import STRAIGHT_HALF_DEG, Intrinsics, Pose, PosedPhoto, cam_from_enu

CAMERA = profile("m3e").camera
STRAIGHT = Intrinsics.of(CAMERA)
BENT = Intrinsics(
    5280, 3956, 3713.29, 3713.29, 2647.02, 1969.28, (-0.11257524, 0.01487443, -0.00008572, 0.0, -0.02706411)
)
"""Of the order of what DJI writes into photos of a Mavic 3 Enterprise."""

angles = st.floats(-180.0, 180.0)


@given(heading=angles, pitch=st.floats(-89.0, 89.0), roll=angles)
def test_rotation_is_orthonormal_and_right_handed(heading: float, pitch: float, roll: float) -> None:
    rotation = cam_from_enu(heading, pitch, roll)
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@given(heading=angles, pitch=st.floats(-89.0, 89.0))
def test_rows_are_right_down_and_forward_of_the_contract(heading: float, pitch: float) -> None:
    forward, right, up = camera_axes(np.radians(heading), np.radians(pitch))
    assert np.allclose(cam_from_enu(heading, pitch), [right, -up, forward])


@given(heading=st.floats(-179.9, 180.0), pitch=st.floats(-89.0, 89.0))
def test_heading_and_pitch_come_back(heading: float, pitch: float) -> None:
    pose = Pose.looking(np.zeros(3), heading, pitch)
    assert np.cos(np.radians(pose.heading_deg - heading)) == pytest.approx(1.0, abs=1e-12)
    assert pose.pitch_deg == pytest.approx(pitch, abs=1e-6)


@given(heading=angles, pitch=st.floats(-130.0, 85.0), roll=st.floats(-80.0, 80.0))
def test_angles_come_back_from_poses(heading: float, pitch: float, roll: float) -> None:
    pose = Pose.looking(np.zeros(3), heading, pitch, roll)
    again = Pose.looking(np.zeros(3), *pose.angles_deg)
    assert again.cam_from_enu == pytest.approx(pose.cam_from_enu, abs=1e-5)
    assert abs(pose.angles_deg[2]) <= 90.0 + 1e-9


@pytest.mark.parametrize("pitch", [-105.0, -90.0])
def test_a_gimbal_at_or_beyond_the_vertical_keeps_its_heading(pitch: float) -> None:
    assert Pose.looking(np.zeros(3), 40.0, pitch).angles_deg == pytest.approx((40.0, pitch, 0.0))


def test_roll_turns_the_camera_clockwise_so_that_its_right_sinks() -> None:
    right = Pose.looking(np.zeros(3), 0.0, 0.0, roll_deg=10.0).cam_from_enu[0]
    assert right[2] == pytest.approx(-np.sin(np.radians(10.0)))


def test_a_planned_view_sees_its_target_in_the_middle_and_the_field_of_view_is_that_of_planning() -> None:
    photo = PosedPhoto("a", __file__, STRAIGHT, Pose.of(Viewpoint("v", (0.0, 0.0, 10.0), 90.0, 0.0)))  # type: ignore[arg-type]
    edge = CAMERA.half_width * 20.0
    pixels = photo.pixels(np.array([[20.0, 0.0, 10.0], [20.0, -edge, 10.0], [20.0, 0.0, 12.0], [-20.0, 0.0, 10.0]]))
    assert np.allclose(pixels[0], (2640.0, 1978.0))
    assert np.allclose(pixels[1], (5280.0, 1978.0))
    assert pixels[2, 1] < 1978.0
    assert np.isnan(pixels[3]).all()
    inside = photo.sees(np.array([[20.0, -0.999 * edge, 10.0], [20.0, -1.001 * edge, 10.0], [-20.0, 0.0, 10.0]]))
    assert inside.tolist() == [True, False, False]


@pytest.mark.parametrize("intrinsics", [STRAIGHT, BENT])
def test_rays_are_the_inverse_of_projection_in_the_whole_picture(intrinsics: Intrinsics) -> None:
    x, y = np.meshgrid(np.linspace(0.0, 5280.0, 23), np.linspace(0.0, 3956.0, 17))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    assert np.abs(intrinsics.pixels(7.0 * intrinsics.rays(pixels)) - pixels).max() < 1e-5


def test_projection_equals_opencv() -> None:
    points = np.random.default_rng(0).normal(size=(100, 3)) * (2.0, 1.5, 0.5) + (0.0, 0.0, 8.0)
    theirs, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), BENT.matrix, np.array(BENT.distortion))
    assert np.abs(BENT.pixels(points) - theirs[:, 0]).max() < 1e-9


def test_distortion_folds_no_point_far_outside_back_into_the_picture() -> None:
    far = np.array([[5.0, 0.0, 1.0], [0.0, 40.0, 1.0]])
    assert not BENT.is_seen(far).any()


def test_a_resized_picture_sees_the_same_directions() -> None:
    half = BENT.scaled(2640, 1978)
    pixels = np.array([[100.0, 3000.0], [5000.0, 7.0]])
    assert np.allclose(half.rays(pixels / 2.0), BENT.rays(pixels), atol=1e-9)


@pytest.mark.parametrize("bad", [{"width_px": 0}, {"fx_px": 0.0}, {"fy_px": float("nan")}, {"cx_px": float("inf")}])
def test_impossible_cameras_are_refused(bad: dict[str, float]) -> None:
    values: dict[str, float] = {"width_px": 10, "height_px": 10, "fx_px": 9.0, "fy_px": 9.0, "cx_px": 5.0, "cy_px": 5.0}
    with pytest.raises(ValueError, match="expected"):
        Intrinsics(**{**values, **bad})  # type: ignore[arg-type]


def test_a_pose_that_is_no_rotation_is_refused() -> None:
    with pytest.raises(ValueError, match="rotation"):
        Pose(np.zeros(3), np.diag([1.0, 1.0, 2.0]))


def test_a_bent_camera_has_no_rays_for_no_pixels() -> None:
    bent = Intrinsics(64, 48, 60.0, 60.0, 32.0, 24.0, (-0.1, 0.0, 0.0, 0.0, 0.0))
    assert bent.rays(np.zeros((0, 2))).shape == (0, 3)
    assert bent.pixels(np.zeros((0, 3))).shape == (0, 2)


FISHEYES = [
    (0.0, 0.0, 0.0, 0.0),
    (0.05, -0.02, 0.003, -0.0005),
    (-0.03, 0.01, -0.005, 0.0008),
]


def fisheye(numbers: tuple[float, float, float, float], f_px: float = 400.0) -> Intrinsics:
    return Intrinsics(1200, 900, f_px, f_px - 2.0, 610.0, 440.0, fisheye=numbers)


@pytest.mark.parametrize("numbers", FISHEYES)
def test_a_fisheye_projects_as_opencv_and_its_rays_are_the_inverse(numbers: tuple[float, float, float, float]) -> None:
    lens, rng = fisheye(numbers), np.random.default_rng(0)
    points = rng.normal(size=(2000, 3))
    points[:, 2] = np.abs(points[:, 2])
    nothing = np.zeros(3)
    wanted, _ = cv2.fisheye.projectPoints(points.reshape(-1, 1, 3), nothing, nothing, lens.matrix, np.array(numbers))
    assert np.abs(lens.pixels(points) - wanted[:, 0]).max() < 1e-9
    pixels = rng.uniform((0.0, 0.0), (1200.0, 900.0), (2000, 2))
    rays = lens.rays(pixels)
    assert rays[:, 2].min() < 0.0  # corners show what is behind the camera
    assert np.abs(lens.pixels(3.0 * rays) - pixels).max() < 1e-8
    axis = lens.pixels(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, -2.0], [0.0, 0.0, 0.0]]))
    assert axis[0] == pytest.approx((610.0, 440.0))
    assert not np.isfinite(axis[1:]).any()


def test_a_fisheye_shows_nothing_beyond_where_its_polynomial_folds() -> None:
    lens = fisheye((0.0, -0.1, 0.0, 0.0))  # grows up to 1.19 rad
    assert lens.fisheye_reach_rad == pytest.approx(2.0**0.25, abs=2e-3)
    angles = np.array([1.18, 1.3, 2.0])
    points = np.column_stack([np.sin(angles), np.zeros(3), np.cos(angles)])
    assert lens.is_seen(points).tolist() == [True, False, False]
    assert np.isfinite(lens.rays(np.array([[0.0, 0.0], [1200.0, 900.0]]))).all()


@pytest.mark.parametrize("f_px", [250.0, 400.0, 2000.0])
def test_a_fisheye_made_straight_reaches_as_far_as_its_photo_within_a_limit(f_px: float) -> None:
    lens = fisheye(FISHEYES[1], f_px)
    straight = lens.straight()
    assert straight.is_straight
    assert (straight.fx_px, straight.fy_px) == (lens.fx_px, lens.fy_px)
    for side, inner in (((0.0, 440.0), (0.0, None)), ((1200.0, 440.0), (1.0, None)), ((610.0, 900.0), (None, 1.0))):
        angle = min(np.radians(STRAIGHT_HALF_DEG), float(np.arccos(lens.rays(np.array([side]))[0, 2])))
        x, y = (
            None if share is None else share * size
            for share, size in zip(inner, (straight.width_px, straight.height_px), strict=True)
        )
        ray = straight.rays(np.array([[straight.cx_px if x is None else x, straight.cy_px if y is None else y]]))[0]
        reached = float(np.arccos(ray[2] / np.linalg.norm(ray)))
        assert reached == pytest.approx(angle, abs=2.0 / straight.fx_px)
