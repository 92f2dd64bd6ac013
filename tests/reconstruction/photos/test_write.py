"""Rendered photos are read back as the cameras that took them, wherever on earth and however they look."""

from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.geo.frames import Origin
from planning.photos.exif import read_exif
from planning.photos.jpeg import read_header
from planning.photos.metadata import exif_altitude_m, exif_position_deg, read_photo
from planning.site.records import Airspace, Facade, Panel, Site
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.colmap.georeference import angle_between_deg
from reconstruction.photos.poses import pose_photos
from reconstruction.photos.write import photo_jpeg

LENS = Intrinsics(32, 24, 22.5, 22.5, 16.0, 12.0)
PICTURE = np.full((24, 32, 3), 90, np.uint8)
TAKEN_AT = datetime(2024, 5, 1, 10, 0, 5, 250_000)
HONG_KONG = Origin(22.3372, 114.2636, 62.0)
PANEL = Panel("A-1", ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, 2.0), (0.0, 0.0, 2.0)))


def there_and_back(folder, origin, pose, home_up_m=0.0):
    """The photo as it is posed after it was written and read."""
    site = Site("s", origin, (Facade("A", (PANEL,)),), Airspace((-9, -9, 0), (9, 9, 9), 0.0), (0.0, 0.0, home_up_m))
    path = folder / "DJI_20240501100005_0001_V.JPG"
    photo = PosedPhoto(path.name, path, LENS, pose, TAKEN_AT)
    path.write_bytes(photo_jpeg(PICTURE, photo, origin, TAKEN_AT, home_up_m))
    return pose_photos([read_photo(path)], site, folder)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("photos")


@settings(max_examples=40)
@given(
    st.floats(-84.0, 84.0).filter(lambda lat: abs(lat) > 0.1),  # 0, 0 means no fix
    st.floats(-179.9, 179.9),
    st.tuples(*[st.floats(-2000.0, 2000.0)] * 2, st.floats(-50.0, 500.0)),
    st.floats(-180.0, 180.0),
    st.floats(-95.0, 40.0),
)
def test_poses_come_back_to_a_millimetre_and_a_hundredth_of_a_degree(folder, lat, lon, place, heading, pitch):
    pose = Pose.looking(np.array(place), heading, pitch)
    (back,) = there_and_back(folder, Origin(lat, lon, 62.0), pose).photos
    assert back.pose.position_enu_m == pytest.approx(pose.position_enu_m, abs=1e-3)
    assert angle_between_deg(back.pose.cam_from_enu, pose.cam_from_enu) < 0.01
    assert back.intrinsics == LENS
    assert back.taken_at == TAKEN_AT


@pytest.mark.parametrize(("heading", "pitch"), [(0.0, 0.0), (0.0, -90.0), (180.0, 0.0), (90.0, -120.0)])
def test_special_directions_come_back(folder, heading, pitch):
    pose = Pose.looking(np.array([0.0, -20.0, 5.0]), heading, pitch)
    found = there_and_back(folder, HONG_KONG, pose)
    assert not found.unposed
    assert angle_between_deg(found.photos[0].pose.cam_from_enu, pose.cam_from_enu) < 0.01


def test_heights_above_take_off_count_from_home(folder):
    there_and_back(folder, HONG_KONG, Pose.looking(np.array([0.0, -20.0, 30.0]), 0.0, 0.0), home_up_m=12.0)
    photo = read_photo(folder / "DJI_20240501100005_0001_V.JPG")
    assert photo.height_above_takeoff_m == pytest.approx(18.0, abs=1e-3)
    assert photo.height_ellipsoid_m == pytest.approx(92.0, abs=1e-3)


@pytest.mark.parametrize("up_m", [-500.0, 700.0])
def test_exif_alone_says_the_same_place(folder, up_m):
    there_and_back(folder, HONG_KONG, Pose.looking(np.array([0.0, 0.0, up_m]), 10.0, 0.0))
    tags = read_exif(read_header(folder / "DJI_20240501100005_0001_V.JPG").exif)
    assert exif_position_deg(tags) == pytest.approx((22.3372, 114.2636), abs=1e-8)
    assert exif_altitude_m(tags) == pytest.approx(62.0 + up_m, abs=1e-3)
