"""From files on a card to coverage: a flight written as a camera writes it, and everything that follows from it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.coverage.evaluate import coverage_counts
from planning.coverage.model import CoverageModel
from planning.coverage.sections import SectionGrid, panel_frames
from planning.geo.enu import geodetic_from_enu
from planning.photos.folder import read_photos
from planning.plan import Viewpoint
from planning.site.records import panel_corners
from reconstruction.photos.coverage import achieved_coverage, distances_m
from reconstruction.photos.lens import LensSource
from reconstruction.photos.poses import pose_photos
from reconstruction.photos.quality import check_quality
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save
from tests.planning.plan_cases import kiosk
from tests.reconstruction.photos.pictures import facade, moved

CAMERA = profile("m3e").camera
SITE = kiosk().site
F_PX = CAMERA.focal_length_mm * 660 / CAMERA.sensor_width_mm, CAMERA.focal_length_mm * 496 / CAMERA.sensor_height_mm


def flight() -> list[Viewpoint]:
    """In front of the southern side, in two rows."""
    return [
        Viewpoint(
            f"v{i:02d}",
            (-10.03 + 2.517 * (i % 9), -11.07 - 0.031 * i, 3.53 + 4.019 * (i // 9)),
            5.13 * (i % 3 - 1) + 0.77,
            -8.31,
        )
        for i in range(18)
    ]


def write_flight(folder, views):
    """As a Mavic 3 Enterprise with RTK does, but at an eighth of the size; the sixth is moved, the last taken twice."""
    lat, lon, height = geodetic_from_enu(SITE.origin, [view.position_enu_m for view in views])
    for i, view in enumerate([*views, views[-1]]):
        at = min(i, len(views) - 1)
        picture = moved(facade(at, (496, 660)), 11) if i == 5 else facade(at, (496, 660))
        properties = {
            "GimbalYawDegree": f"{view.heading_deg:+.2f}",
            "GimbalPitchDegree": f"{view.gimbal_pitch_deg:+.2f}",
            "GimbalRollDegree": "+0.00",
            "FlightYawDegree": "+20.0",
            "AbsoluteAltitude": f"{height[at]:+.3f}",
            "AltitudeType": "RtkAlt",
            "RtkFlag": "50",
            "RtkStdLon": "0.01",
            "RtkStdLat": "0.01",
            "RtkStdHgt": "0.02",
            "DewarpData": f"2024-05-01;{F_PX[0]},{F_PX[1]},0,0,0,0,0,0,0",
            "DewarpFlag": "0",
            "ImageSource": "WideCamera",
        }
        exif = exif_part(
            {0x010F: "DJI", 0x0110: "M3E"},
            {0x9003: f"2024:05:01 10:00:{i:02d}", 0x829A: 0.001, 0x920A: 12.29, 0xA405: 24},
            gps_tags(float(lat[at]), float(lon[at]), float(height[at])),
        )
        base = cv2.imencode(".jpg", picture)[1].tobytes()
        save(folder / f"DJI_20240501100{i:03d}_{i + 1:04d}_V.JPG", jpeg(exif, packet(properties), base=base))


@pytest.mark.long
def test_a_flight_comes_from_the_card_with_poses_quality_and_coverage(tmp_path):
    views = flight()
    write_flight(tmp_path, views)
    (tmp_path / "broken_0099.jpg").write_bytes(b"\xff\xd8\xff")
    folder = read_photos(tmp_path)
    assert [finding.code for finding in folder.findings] == ["photo-unreadable"]
    photos = pose_photos(folder.photos, SITE, tmp_path)
    assert [photo.name[-10:-6] for photo in photos.photos] == [f"{i:04d}" for i in range(1, 20)]
    assert {lens.source for lens in photos.lenses} == {LensSource.DEWARP}
    for photo, view in zip(photos.photos, views, strict=False):
        assert np.linalg.norm(photo.pose.position_enu_m - view.position_enu_m) < 2e-3
    assert {finding.code for finding in photos.findings} == {"height-reference", "lens-source"}

    model = CoverageModel(panel_frames(panel_corners(SITE)), CAMERA, SectionGrid(30.0))
    quality = check_quality(photos.metadata, photos.photos, distances_m(model, photos.photos))
    assert [finding.code for finding in quality.findings] == ["photo-blurred", "photo-alike"]
    assert "_0006_V" in quality.findings[0].place
    assert quality.alike == ((17, 18),)

    whole = achieved_coverage(model, photos.photos, views)
    np.testing.assert_array_equal(whole.counts > 0, coverage_counts(model, views) > 0)
    assert not whole.missed.any()
    half = achieved_coverage(model, photos.photos[:9], views)
    assert half.missed.sum() == whole.covered - half.covered > 0
    angles = np.array([photo.pose.angles_deg for photo in photos.photos[:18]])
    np.testing.assert_allclose(angles[:, 0], [view.heading_deg for view in views], atol=0.01)
    np.testing.assert_allclose(angles[:, 2], 0.0, atol=0.01)
