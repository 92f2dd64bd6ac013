"""Cameras of photos: written with a known pose, read back, and what a photo must say for it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import amsl_from_ellipsoid_m
from planning.photos.folder import read_photos
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import cam_from_enu
from reconstruction.photos.lens import CameraKind, lens_of
from reconstruction.photos.poses import Accuracy, angle_covariance, pose_photos
from tests.planning.plan_cases import kiosk

SITE = kiosk().site
FOLDER = Path("photos")


def metadata(site=SITE, point=(3.0, -20.0, 7.0), **changes):
    """Of a photo taken at a point of the site's frame."""
    lat, lon, height = (float(column[0]) for column in geodetic_from_enu(site.origin, [point]))
    home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
    fields = {
        "lat_deg": lat,
        "lon_deg": lon,
        "height_ellipsoid_m": height,
        "height_above_takeoff_m": height - home_m,
        "gimbal_heading_deg": 10.0,
        "gimbal_pitch_deg": -15.0,
        "gimbal_roll_deg": 0.0,
        "focal_length_35mm_mm": 24.0,
        "rtk_flag": 50,
        "rtk_std_lon_m": 0.012,
        "rtk_std_lat_m": 0.018,
        "rtk_std_height_m": 0.03,
    }
    return PhotoMetadata(FOLDER / "a" / "DJI_0001.JPG", 4000, 3000, **{**fields, **changes})


def posed(photo, site=SITE, **options):
    (found,) = pose_photos([photo], site, FOLDER, **options).photos
    return found


@pytest.mark.parametrize(
    "origin",
    [
        Origin(22.3, 114.2, 62.0),
        Origin(-16.5, 179.99999, 55.0),
        Origin(-16.5, -180.0, 55.0),
        Origin(31.5, 35.5, -395.0),
        Origin(89.9999, 12.0, 20.0),
    ],
    ids=["Hong Kong", "antimeridian", "antimeridian itself", "below sea level", "near the pole"],
)
@pytest.mark.parametrize("kind", ["ellipsoid", "sea level", "take-off"])
def test_a_photo_stands_where_it_was_taken_anywhere_on_earth(origin, kind):
    site = replace(SITE, origin=origin)
    photo = metadata(site, (3.0, -20.0, 7.0))
    if kind == "sea level":
        amsl = float(amsl_from_ellipsoid_m(photo.lat_deg, photo.lon_deg, photo.height_ellipsoid_m))
        photo = replace(photo, height_ellipsoid_m=None, altitude_amsl_m=amsl)
    heights = "takeoff" if kind == "take-off" else "absolute"
    found = posed(photo, site, heights=heights)
    assert found.pose.position_enu_m == pytest.approx((3.0, -20.0, 7.0), abs=1e-4)
    assert found.name == "a/DJI_0001.JPG"


def test_angles_count_from_the_north_of_the_photos_own_place():
    """Twenty metres from the pole, a camera that looks along its meridian looks at the pole wherever it stands."""
    site = replace(SITE, origin=Origin(90.0, 0.0, 20.0))
    for point in ((20.0, 0.0, 5.0), (0.0, 20.0, 5.0), (-14.0, 3.0, 5.0)):
        found = posed(metadata(site, point, gimbal_heading_deg=0.0, gimbal_pitch_deg=0.0), site)
        towards = -np.array([*point[:2], 0.0]) / np.hypot(*point[:2])
        assert found.pose.forward_enu == pytest.approx(towards, abs=1e-5)
    at_home = posed(metadata(gimbal_heading_deg=37.0, gimbal_pitch_deg=-30.0, gimbal_roll_deg=2.0))
    assert at_home.pose.cam_from_enu == pytest.approx(cam_from_enu(37.0, -30.0, 2.0), abs=1e-5)


@pytest.mark.parametrize("pitch", [-90.0, -89.999, -105.0, 90.0])
def test_straight_down_and_beyond_is_a_pose_like_any_other(pitch):
    found = posed(metadata(gimbal_heading_deg=60.0, gimbal_pitch_deg=pitch))
    right = found.pose.cam_from_enu[0]
    assert right == pytest.approx((math.cos(math.radians(60)), -math.sin(math.radians(60)), 0.0), abs=1e-4)
    assert np.linalg.eigvalsh(found.pose.covariance).min() > 0.0


def test_standard_deviations_of_rtk_are_the_positions():
    covariance = posed(metadata()).pose.covariance
    assert np.sqrt(np.diag(covariance)[:3]) == pytest.approx((0.012, 0.018, 0.03), rel=1e-3)
    fixed = posed(metadata(rtk_std_lon_m=0.0, rtk_std_lat_m=0.0, rtk_std_height_m=0.0)).pose.covariance
    assert np.sqrt(np.diag(fixed)[:3]) == pytest.approx((0.02, 0.02, 0.03), rel=1e-3)


def test_defaults_stand_for_a_single_receiver_and_for_heights_above_take_off():
    plain = metadata(rtk_flag=None, rtk_std_lon_m=None, rtk_std_lat_m=None, rtk_std_height_m=None)
    takeoff = posed(plain).pose.covariance
    assert np.sqrt(np.diag(takeoff)[:3]) == pytest.approx((1.06, 1.06, 1.0), rel=1e-2)
    absolute = posed(plain, heights="absolute", accuracy=Accuracy(single_vertical_m=4.0)).pose.covariance
    assert math.sqrt(absolute[2, 2]) == pytest.approx(4.0, rel=1e-3)
    told = replace(plain, accuracy_horizontal_m=0.4, accuracy_vertical_m=0.6, accuracy_heading_deg=5.0)
    parrot = posed(told, heights="absolute").pose.covariance
    assert np.sqrt(np.diag(parrot)[:3]) == pytest.approx((0.4, 0.4, 0.6), rel=1e-3)
    assert parrot[3:, 3:].trace() == pytest.approx(math.radians(5.0) ** 2 + 2 * math.radians(0.5) ** 2)


@given(heading=st.floats(-180, 180), pitch=st.floats(-120, 40), roll=st.floats(-20, 20), seed=st.integers(0, 99))
def test_covariance_of_angles_is_that_of_cameras_turned_at_random(heading, pitch, roll, seed):
    """A camera turned about the vertical and about horizontal axes; the small rotation is read off the matrices."""
    rng = np.random.default_rng(seed)
    start = cam_from_enu(heading, pitch, roll)
    sigma = np.array([0.5e-3, 0.5e-3, 2e-3])  # about east, north and up
    w = rng.normal(0.0, sigma, (4000, 3))
    skew = np.zeros((4000, 3, 3))
    for (i, j), axis, sign in zip(((1, 2), (0, 2), (0, 1)), range(3), (1.0, -1.0, 1.0), strict=True):
        skew[:, i, j], skew[:, j, i] = -sign * w[:, axis], sign * w[:, axis]
    turned = start @ (np.eye(3) + skew)  # first order is enough for milliradians
    small = turned @ start.T
    vectors = np.stack([small[:, 2, 1], small[:, 0, 2], small[:, 1, 0]], axis=1)
    expected = angle_covariance(start, 2e-3, 0.5e-3)
    assert np.abs(np.cov(vectors.T) - expected).max() < 0.12 * np.trace(expected)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"lat_deg": None}, "a position"),
        ({"height_ellipsoid_m": None, "height_above_takeoff_m": None}, "a height"),
        ({"gimbal_pitch_deg": None}, "where the camera looked"),
        ({"focal_length_35mm_mm": None}, "a focal length"),
    ],
)
def test_what_a_photo_does_not_say_is_told_and_never_guessed(changes, words):
    good, bad = metadata(), metadata(**changes)
    bad = replace(bad, path=FOLDER / "bad.jpg")
    found = pose_photos([good, bad], SITE, FOLDER)
    assert [photo.name for photo in found.photos] == ["a/DJI_0001.JPG"]
    assert [(photo.name, photo.missing) for photo in found.unposed] == [("bad.jpg", words)]
    (finding,) = [finding for finding in found.findings if finding.code == "photos-unposed"]
    assert words in finding.message
    assert "bad.jpg" in finding.message
    with pytest.raises(InputError, match=f"1 without {words}"):
        pose_photos([bad], SITE, FOLDER)


def test_photos_of_other_places_and_cameras_are_told_of():
    far = replace(metadata(), path=FOLDER / "far.jpg", lat_deg=metadata().lat_deg + 1.0)
    thermal = replace(metadata(), path=FOLDER / "t.jpg", image_source="InfraredCamera")
    found = pose_photos([metadata(), far, thermal], SITE, FOLDER)
    assert [photo.name for photo in found.photos] == ["a/DJI_0001.JPG"]
    codes = {finding.code for finding in found.findings}
    assert {"photos-elsewhere", "photos-other-camera", "lens-source", "lens-distortion-unknown"} <= codes
    assert pose_photos([metadata(), thermal], SITE, FOLDER, camera=CameraKind.THERMAL).photos[0].name == "t.jpg"
    with pytest.raises(InputError, match="km from the site"):
        pose_photos([far], SITE, FOLDER)
    with pytest.raises(InputError, match="there are none"):
        pose_photos([], SITE, FOLDER)


def test_heights_are_above_take_off_where_one_photo_has_no_fix():
    loose = replace(metadata(), path=FOLDER / "b.jpg", rtk_flag=34)
    found = pose_photos([metadata(), loose], SITE, FOLDER)
    assert all(photo.pose.covariance[2, 2] == pytest.approx(1.0, rel=1e-3) for photo in found.photos)
    codes = [finding.code for finding in found.findings]
    assert "rtk-not-fixed" in codes
    assert "height-reference" in codes


def test_real_photos_get_poses_where_they_say_enough(shared_data):
    photos = read_photos(shared_data / "dji" / "photos").photos
    folder = shared_data / "dji" / "photos"
    by_name = {photo.path.name: photo for photo in photos}
    n_posed = 0
    for name, photo in by_name.items():
        if photo.lat_deg is None or lens_of(photo) is None:
            with pytest.raises(InputError, match="no photo can be given a camera pose"):
                pose_photos([photo], SITE, folder)
            continue
        site = replace(SITE, origin=Origin(photo.lat_deg, photo.lon_deg, 50.0))
        (found,) = pose_photos([photo], site, folder, heights="takeoff").photos
        assert found.name == name
        assert found.pose.heading_deg == pytest.approx(photo.gimbal_heading_deg, abs=0.01)
        assert found.pose.pitch_deg == pytest.approx(photo.gimbal_pitch_deg, abs=0.01)
        expected_m = photo.height_above_takeoff_m + SITE.home_enu_m[2]
        assert found.pose.position_enu_m == pytest.approx((0.0, 0.0, expected_m), abs=1e-3)
        n_posed += 1
    assert n_posed == 11
