"""A camera led by hand: where it goes, what stays in the picture, and that it stays a camera."""

import math
from pathlib import Path

import numpy as np
import pytest

from groundstation.services.reconstruct.guided_camera import moved, orbited, sized, turned
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto

LENS = Intrinsics(400, 300, 350.0, 350.0, 200.0, 150.0, (-0.1, 0.02, 0.0, 0.0, 0.0))


def camera(heading_deg=30.0, pitch_deg=-20.0, roll_deg=0.0):
    pose = Pose.looking(np.array([3.0, -8.0, 12.0]), heading_deg, pitch_deg, roll_deg)
    return PosedPhoto("a.png", Path("a.png"), LENS, pose)


def test_turning_right_raises_the_heading_and_turning_up_the_pitch():
    found = turned(camera(), math.radians(10.0), math.radians(5.0))
    assert found.pose.angles_deg == pytest.approx((40.0, -15.0, 0.0), abs=1e-9)
    np.testing.assert_array_equal(found.pose.position_enu_m, camera().pose.position_enu_m)


def test_it_goes_along_its_own_axes():
    found = moved(camera(heading_deg=90.0, pitch_deg=0.0), 1.0, 2.0, 4.0)
    # Looking east, the right is south.
    np.testing.assert_allclose(found.pose.position_enu_m - camera().pose.position_enu_m, (4.0, -1.0, 2.0), atol=1e-12)


@pytest.mark.parametrize("roll_deg", [0.0, 12.0])
def test_what_it_flies_around_stays_where_it_is_in_the_picture(roll_deg):
    before = camera(roll_deg=roll_deg)
    pivot = before.pose.position_enu_m + 7.0 * before.pose.forward_enu
    after = orbited(before, 7.0, 0.3, 0.1)
    point = after.pose.points_cam(pivot)[0]
    np.testing.assert_allclose(point, (0.0, 0.0, 7.0), atol=1e-9)
    way = after.pose.position_enu_m - before.pose.position_enu_m
    right, down = before.pose.cam_from_enu[:2]
    assert way @ right > 0.0
    assert way @ down < 0.0


def test_a_thousand_small_turns_leave_a_rotation_and_no_way_is_lost():
    found = camera()
    for _ in range(500):
        found = orbited(found, 9.0, 0.01, 0.004)
    for _ in range(500):
        found = turned(found, 0.02, -0.003)
    rotation = found.pose.cam_from_enu
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert abs(found.pose.angles_deg[2]) < 1e-6


@pytest.mark.parametrize("up_rad", [0.2, -0.2])
def test_it_does_not_tip_over(up_rad):
    found = camera()
    for _ in range(50):
        found = turned(found, 0.0, up_rad)
    assert 75.0 < abs(found.pose.pitch_deg) < 89.01
    assert abs(found.pose.angles_deg[2]) < 1e-6


def test_a_camera_that_looks_straight_down_can_be_turned_away():
    found = turned(camera(pitch_deg=-90.0), 0.1, 0.3)
    assert found.pose.pitch_deg == pytest.approx(-90.0 + math.degrees(0.3), abs=1e-6)


def test_its_picture_fits_and_shows_the_same():
    found = sized(camera(), 1000, 300)
    assert (found.intrinsics.width_px, found.intrinsics.height_px) == (400, 300)
    small = sized(camera(), 100, 100).intrinsics
    assert (small.width_px, small.height_px) == (100, 75)
    assert small.is_straight
    assert small.fx_px == pytest.approx(350.0 / 4.0)
    tiny = sized(camera(), 1, 1).intrinsics
    assert tiny.width_px == 1
    assert tiny.height_px >= 1
