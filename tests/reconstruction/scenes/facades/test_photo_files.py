"""Made photos as files are read back as the cameras that took them."""

from datetime import timedelta

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from planning.photos.folder import read_photos
from planning.site.records import Airspace, Facade, Panel, Site
from reconstruction.photos.poses import pose_photos
from reconstruction.scenes.facades.render import BETWEEN, write_photos
from tests.reconstruction.synthetic_photos import ORIGIN
from tests.services.photo_cases import true_photos

PANEL = Panel("A-1", ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, 2.0), (0.0, 0.0, 2.0)))
SITE = Site(
    "made", ORIGIN, (Facade("A", (PANEL,)),), Airspace((-9.0, -9.0, 0.0), (9.0, 9.0, 9.0), 0.0), (0.0, 0.0, 0.0)
)


@pytest.fixture
def made():
    rng = np.random.default_rng(1)
    return [
        (photo, cv2.resize(rng.integers(0, 256, (12, 16, 3), np.uint8), (800, 600), interpolation=cv2.INTER_CUBIC))
        for photo in true_photos()
    ]


def test_poses_lenses_times_and_pictures_come_back(tmp_path, made):
    paths = write_photos(tmp_path / "photos", made, ORIGIN)
    read = read_photos(tmp_path / "photos")
    posed = pose_photos(read.photos, SITE, tmp_path / "photos")
    assert [photo.path for photo in posed.photos] == list(paths)
    for (photo, picture), back in zip(made, posed.photos, strict=True):
        assert back.pose.position_enu_m == pytest.approx(photo.pose.position_enu_m, abs=1e-3)
        turn = back.pose.cam_from_enu @ photo.pose.cam_from_enu.T
        assert np.degrees(np.arccos(np.clip(0.5 * (np.trace(turn) - 1.0), -1.0, 1.0))) < 0.01
        assert np.sqrt(np.diag(back.pose.covariance)[:3]) == pytest.approx([0.02, 0.02, 0.03])
        assert back.intrinsics.fx_px == pytest.approx(photo.intrinsics.fx_px, abs=1e-3)
        assert back.intrinsics.is_straight
        apart = cv2.imread(str(back.path)).astype(float) - picture
        assert 0.0 < np.abs(apart).mean() < 6.0
    assert posed.photos[2].taken_at - posed.photos[0].taken_at == 2 * BETWEEN == timedelta(seconds=10)
    assert not any(finding.code.startswith("lens-distortion") for finding in posed.findings)


def test_a_folder_that_is_a_file_is_refused(tmp_path, made):
    (tmp_path / "photos").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_photos(tmp_path / "photos", made, ORIGIN)
