"""Which camera took a photo, and what its focal length is, on real and synthetic photos."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from planning.photos.folder import read_photos
from planning.photos.record import Dewarp, PhotoMetadata
from reconstruction.photos.lens import CameraKind, LensSource, camera_kind, lens_of, of_camera

M3E = PhotoMetadata(
    Path("DJI_20240501_0001_V.JPG"),
    5280,
    3956,
    make="DJI",
    model="M3E",
    focal_length_mm=12.29,
    focal_length_35mm_mm=24.0,
)
DEWARP = Dewarp(3713.29, 3713.29, 7.02, -8.72, -0.1126, 0.0149, -0.00009, 0.0, -0.0271)


def test_sources_are_asked_in_order_of_their_worth():
    everything = replace(M3E, dewarp=DEWARP, calibrated_focal_length_px=3725.151611)
    found = lens_of(everything)
    assert (found.source, found.is_distortion_known) == (LensSource.DEWARP, True)
    assert found.intrinsics.distortion == (-0.1126, 0.0149, -0.00009, 0.0, -0.0271)
    assert (found.intrinsics.cx_px, found.intrinsics.cy_px) == pytest.approx((2647.02, 1969.28))
    calibrated = lens_of(replace(everything, dewarp=None))
    assert (calibrated.source, calibrated.intrinsics.fx_px) == (LensSource.CALIBRATED, 3725.151611)
    catalogue = lens_of(M3E)
    assert catalogue.source is LensSource.CATALOGUE
    assert catalogue.intrinsics.fx_px == pytest.approx(12.29 * 5280 / 17.3)
    equivalent = lens_of(replace(M3E, model="Unheard of"))
    assert equivalent.source is LensSource.EQUIVALENT
    assert equivalent.intrinsics.fx_px == pytest.approx(
        math.hypot(5280, 3956) / 2 / math.tan(math.radians(84.0 / 2)), rel=2e-3
    )  # DJI: 84 degrees
    assert lens_of(replace(M3E, model=None, focal_length_35mm_mm=None)) is None


def test_all_sources_of_one_camera_agree_to_three_percent():
    full = replace(M3E, dewarp=DEWARP, calibrated_focal_length_px=3725.15)
    photos = (full, replace(full, dewarp=None), M3E, replace(M3E, model=None))
    photos += (replace(M3E, model="L2D-20c"),)
    unknown = replace(M3E, model=None, focal_length_35mm_mm=None, focal_plane_px_per_mm=5280 / 17.3)
    lenses = [lens_of(photo) for photo in (*photos, unknown)]
    assert {lens.source for lens in lenses} == set(LensSource)
    focal = [lens.intrinsics.fx_px for lens in lenses]
    assert max(focal) / min(focal) < 1.03


def test_a_picture_that_was_dewarped_is_straight():
    found = lens_of(replace(M3E, dewarp=DEWARP, is_dewarped=True))
    assert found.intrinsics.is_straight
    assert found.intrinsics.fx_px == 3713.29


def test_a_calibration_of_another_picture_size_is_passed_over():
    small = replace(M3E, width_px=1320, height_px=989, dewarp=DEWARP, calibrated_focal_length_px=3725.15)
    found = lens_of(small)
    assert found.source is LensSource.CATALOGUE
    assert LensSource.CALIBRATED in found.passed_over
    assert found.intrinsics.fx_px == pytest.approx(12.29 * 1320 / 17.3)


@pytest.mark.parametrize(
    "change", [{"cx_px": 4000.0}, {"fy_px": 37.0}, {"k1": 1e6}], ids=["centre outside", "not square", "no polynomial"]
)
def test_dewarp_data_that_no_camera_has_are_not_used(change):
    assert lens_of(replace(M3E, dewarp=replace(DEWARP, **change))).source is LensSource.CATALOGUE


def test_another_lens_of_the_same_camera_is_not_the_catalogues():
    tele = replace(M3E, focal_length_mm=29.9, focal_length_35mm_mm=162.0)
    assert lens_of(tele).source is LensSource.EQUIVALENT


@pytest.mark.parametrize(
    ("size", "f_px"),
    [((5472, 3648), 8.8 * 5472 / 13.2), ((5472, 3078), 8.8 * 5472 / 13.2), ((4864, 3648), 8.8 * 3648 / 8.8)],
    ids=["3:2", "16:9 is as wide", "4:3 is as high"],
)
@pytest.mark.parametrize("is_upright", [False, True])
def test_pictures_of_each_shape_are_parts_of_the_sensor(size, f_px, is_upright):
    photo = PhotoMetadata(Path("a.jpg"), *(size[::-1] if is_upright else size), model="FC6310", focal_length_mm=8.8)
    found = lens_of(photo)
    assert (found.source, found.intrinsics.fx_px) == (LensSource.SENSOR, pytest.approx(f_px))


def test_a_sensor_of_one_of_several_cameras_is_for_its_pictures_only():
    visible = PhotoMetadata(Path("a.jpg"), 8000, 6000, model="MAVIC2-ENTERPRISE-ADVANCED", focal_length_mm=4.5)
    assert lens_of(visible) is None
    assert lens_of(replace(visible, focal_length_35mm_mm=24.0)).source is LensSource.EQUIVALENT


def test_the_sensor_is_nearer_the_truth_than_the_rounded_equivalent(shared_data):
    """Reference poses of the photos in Lund have a focal length of 2435 px."""
    photo = read_photos(shared_data / "multiview" / "lund_door").photos[0]
    rounded = lens_of(replace(photo, model=None)).intrinsics.fx_px
    assert abs(lens_of(photo).intrinsics.fx_px - 2435.4) < 0.6 * abs(rounded - 2435.4)


@pytest.mark.parametrize(
    ("name", "source", "size", "kind"),
    [
        ("DJI_0001.JPG", "WideCamera", (4000, 3000), CameraKind.WIDE),
        ("DJI_0001.JPG", "VisibleCamera", (4000, 3000), CameraKind.WIDE),
        ("DJI_0001_T.JPG", "ZoomCamera", (4000, 3000), CameraKind.ZOOM),
        ("DJI_20230707093934_0007_T.JPG", None, (4000, 3000), CameraKind.THERMAL),
        ("DJI_20230707093934_0007_Z.JPG", None, (4000, 3000), CameraKind.ZOOM),
        ("anything.JPG", None, (640, 512), CameraKind.THERMAL),
        ("DJI_0001.JPG", None, (5472, 3648), None),
    ],
)
def test_cameras_are_told_apart(name, source, size, kind):
    photo = PhotoMetadata(Path(name), *size, image_source=source)
    assert camera_kind(photo) is kind


def test_one_camera_is_taken_and_the_others_are_told_of():
    photos = [replace(M3E, image_source=source) for source in ("WideCamera", "ZoomCamera", "InfraredCamera")]
    kept, (finding,) = of_camera(photos)
    assert [photo.image_source for photo in kept] == ["WideCamera"]
    assert "1 thermal, 1 zoom" in finding.message
    assert [photo.image_source for photo in of_camera(photos, CameraKind.ZOOM)[0]] == ["ZoomCamera"]
    assert of_camera(photos[2:]) == (photos[2:], ())  # the only camera there is
    assert of_camera([M3E]) == ([M3E], ())
    unknown = replace(M3E, image_source=None, path=Path("a.jpg"))
    assert of_camera([unknown, photos[2]])[0] == [unknown]


def test_real_photos_tell_their_camera_and_focal_length(shared_data):
    photos = {photo.path.name: photo for photo in read_photos(shared_data / "dji" / "photos").photos}
    kinds = {name: camera_kind(photo) for name, photo in photos.items()}
    assert kinds.pop("Mavic2Pro_L1D-20c_issue-exifr-13.jpg") is None
    assert set(kinds.values()) == {CameraKind.THERMAL}
    lenses = {name: lens_of(photo) for name, photo in photos.items()}
    # The older thermal cameras and the M2EA say no 35 mm equivalent: their sensors are known. Views of 13 and 19 mm are
    # 45 and 32 degrees wide, DJI's specification of the XT 2; the M2EA's is 38 mm of 35 mm equivalent.
    sensors = {name: lens.intrinsics.fx_px for name, lens in lenses.items() if lens.source is LensSource.SENSOR}
    assert set(sensors) == {
        "M2EA_IR.JPG", "XT2.jpg", "XT2_issue-exifr-3.jpg", "XTR.jpg", "XTS.jpg", "Mavic2Pro_L1D-20c_issue-exifr-13.jpg",
    }  # fmt: skip
    wide = {name: 2.0 * math.degrees(math.atan(320.0 / fx_px)) for name, fx_px in sensors.items()}
    assert {round(wide[name]) for name in ("XT2.jpg", "XT2_issue-exifr-3.jpg", "XTR.jpg", "XTS.jpg")} == {32, 45}
    assert sensors["M2EA_IR.JPG"] == pytest.approx(38.0 / math.hypot(36.0, 24.0) * math.hypot(640, 512), rel=0.05)
    m3t = lenses["M3T_IR.JPG"].intrinsics
    assert m3t.fx_px == pytest.approx(9.1 / 0.012, rel=0.02)  # 9.1 mm on pixels of 12 um, DJI's specification
