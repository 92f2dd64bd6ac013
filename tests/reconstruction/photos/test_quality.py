"""The check of many photos: verdicts, broken and hostile files, cancelling, and the price of a reduced scale."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.photos.folder import read_photos
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos import quality
from reconstruction.photos.decode import MAX_PIXELS, grey_picture
from reconstruction.photos.quality import QualityLimits, check_quality, motion_sigma_px, photo_quality
from tests.reconstruction.photos.pictures import facade, moved, write


def codes(report, photo):
    return {finding.code for finding in report.findings if finding.place == str(photo.path)}


def test_good_photos_pass_and_others_are_told_of_with_their_number(tmp_path):
    black, white = np.zeros((480, 640), np.uint8), np.full((480, 640), 255, np.uint8)
    glare = facade(4)
    glare[:, :250] = 255
    pictures = {
        "good": facade(1), "blurred": cv2.GaussianBlur(facade(2), (0, 0), 3.0), "moved": moved(facade(3), 11),
        "glare": glare, "black": black, "white": white, "fog": np.full((480, 640), 140, np.uint8),
    }  # fmt: skip
    photos = {name: write(tmp_path / f"{name}.jpg", picture) for name, picture in pictures.items()}
    report = check_quality(list(photos.values()))
    found = {name: codes(report, photo) for name, photo in photos.items()}
    assert found == {
        "good": set(), "blurred": {"photo-blurred"}, "moved": {"photo-blurred"}, "glare": {"photo-bright"},
        "black": {"photo-dark"}, "white": {"photo-bright"}, "fog": {"photo-without-edges"},
    }  # fmt: skip
    assert report.alike == ()
    (finding,) = [f for f in report.findings if f.place == str(photos["glare"].path)]
    assert finding.value == pytest.approx(250 / 640, abs=0.01)
    assert "expose shorter" in finding.message


@pytest.mark.parametrize("scale", [1, 2, 4, 8])
def test_one_pixel_and_other_small_pictures_are_measured(tmp_path, scale):
    for size in ((1, 1), (1, 50), (7, 9), (17, 33)):
        photo = write(tmp_path / "a.jpg", np.full(size, 90, np.uint8))
        assert photo_quality(photo, scale=scale).sigma_px is None
        assert grey_picture(photo, scale).shape == (-(-size[0] // scale), -(-size[1] // scale))


def test_a_picture_of_sixteen_thousand_pixels_is_measured(tmp_path):
    wide = np.tile(facade(1, (600, 800)), (2, 20))
    photo = write(tmp_path / "a.jpg", np.ascontiguousarray(wide), 90)
    assert photo.width_px == 16000
    assert photo_quality(photo, scale=8).bright < 0.1
    assert photo_quality(photo).sigma_px < 0.8


def test_pixels_stay_where_the_camera_has_them_whatever_exif_says_of_turning(tmp_path):
    from tests.planning.photos.photo_writer import exif_part, jpeg

    base = cv2.imencode(".jpg", facade(1, (60, 90)))[1].tobytes()
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg(exif_part({0x0112: 6}), base=base))
    photo = replace(write(tmp_path / "b.jpg", facade(1, (60, 90))), path=path)
    assert grey_picture(photo).shape == (60, 90)


def damaged(path: Path, kind: str) -> PhotoMetadata:
    photo = write(path, facade(1))
    content = path.read_bytes()
    if kind == "gone":
        path.unlink()
    elif kind == "cut off":
        path.write_bytes(content[: len(content) // 2])
        photo = replace(photo, is_complete=False)
    elif kind == "rubbish":
        path.write_bytes(bytes(1000))
    elif kind == "empty":
        path.write_bytes(b"")
    elif kind == "bomb":
        at = content.index(b"\xff\xc0") + 5
        path.write_bytes(content[:at] + b"\xff\xff\xff\xff" + content[at + 4 :])
        photo = replace(photo, width_px=65535, height_px=65535)
    elif kind == "exchanged":
        write(path, facade(1, (30, 40)))
    return photo


@pytest.mark.parametrize("kind", ["gone", "cut off", "rubbish", "empty", "bomb", "exchanged"])
def test_a_broken_file_is_a_finding_and_stops_nothing(tmp_path, kind):
    good = [write(tmp_path / f"{name}.jpg", facade(seed)) for seed, name in enumerate("ac")]
    photos = [good[0], damaged(tmp_path / "b.jpg", kind), good[1]]
    report = check_quality(photos)
    assert [result is None for result in report.photos] == [False, True, False]
    (finding,) = report.findings
    assert (finding.code, finding.place) == ("photo-unreadable", str(photos[1].path))
    assert "b.jpg" in finding.message


def test_a_bomb_is_refused_before_anything_is_decoded(tmp_path, monkeypatch):
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("it was decoded"))
    bomb = damaged(tmp_path / "b.jpg", "bomb")
    assert bomb.width_px * bomb.height_px > MAX_PIXELS
    with pytest.raises(InputError, match="megapixels"):
        grey_picture(bomb)


def test_large_photos_come_one_at_a_time_and_all_results_in_order(tmp_path, monkeypatch):
    monkeypatch.setattr(quality, "LARGE_PIXELS", 640 * 480)
    photos = [write(tmp_path / f"{i}.jpg", facade(i, (500, 700) if i % 3 == 0 else (480, 640))) for i in range(9)]
    together = check_quality(photos)
    assert together.photos == tuple(photo_quality(photo) for photo in photos)


class Cancelling:
    def __init__(self, after):
        self.left, self.stages = after, set()

    def report(self, stage, done, total):
        self.stages.add(stage)
        self.left -= 1
        if self.left < 0:
            raise OperationCancelled("enough")


def test_a_check_can_be_cancelled(tmp_path):
    photos = [write(tmp_path / "a.jpg", facade(1))] * 60
    with pytest.raises(OperationCancelled):
        check_quality(photos, monitor=Cancelling(3))
    calm = Cancelling(1000)
    assert len(check_quality(photos[:2], monitor=calm).photos) == 2
    assert calm.stages == {"checking photos"}


def camera(photo, heading=0.0, point=(0.0, -20.0, 5.0)):
    lens = Intrinsics(640, 480, 3700.0, 3700.0, 320.0, 240.0)
    return PosedPhoto(photo.path.name, photo.path, lens, Pose.looking(np.array(point), heading, 0.0))


MOVING = {"speed_north_m_s": 0.0, "speed_east_m_s": 4.0, "speed_vertical_m_s": 0.0, "exposure_s": 0.002}


def test_predicted_blur_is_that_of_the_movement_across_the_line_of_sight(tmp_path):
    photo = replace(write(tmp_path / "a.jpg", facade(1)), **MOVING)
    across = motion_sigma_px(photo, camera(photo, 0.0), 10.0)
    assert across == pytest.approx(4.0 * 0.002 / 10.0 * 3700.0 / math.sqrt(12.0))
    assert motion_sigma_px(photo, camera(photo, 90.0), 10.0) == pytest.approx(0.0, abs=1e-9)
    climbing = replace(photo, speed_east_m_s=0.0, speed_vertical_m_s=-4.0)
    assert motion_sigma_px(climbing, camera(photo), 10.0) == pytest.approx(across)
    for unknown in ({"exposure_s": None}, {"speed_east_m_s": None}):
        assert motion_sigma_px(replace(photo, **unknown), camera(photo), 10.0) is None
    assert motion_sigma_px(photo, camera(photo), None) is None


def test_prediction_and_measurement_of_one_movement_agree(tmp_path):
    at_ten_metres_px = 4.0 * 0.002 / 10.0 * 3700.0
    photo = replace(write(tmp_path / "a.jpg", moved(facade(1), 5)), **MOVING)
    found = photo_quality(photo, camera(photo), 10.0 * at_ten_metres_px / 5.0)
    assert 0.9 < found.sigma_px / found.motion_sigma_px < 1.5


def test_where_nothing_can_be_measured_the_prediction_counts(tmp_path):
    photo = replace(write(tmp_path / "a.jpg", np.full((480, 640), 140, np.uint8)), **MOVING)
    report = check_quality([photo], [camera(photo)], [2.0])
    (finding,) = [finding for finding in report.findings if finding.code == "photo-blurred"]
    assert "by speed, exposure and distance" in finding.message
    assert finding.value == pytest.approx(report.photos[0].motion_sigma_px)


def test_photos_taken_twice_are_told_by_picture_and_place(tmp_path):
    photos = [write(tmp_path / f"{i}.jpg", facade(1)) for i in range(3)]
    posed = [camera(photos[0]), camera(photos[1], 0.5), camera(photos[2], 0.0, (9.0, -20.0, 5.0))]
    report = check_quality(photos, posed)
    assert report.alike == ((0, 1),)
    assert codes(report, photos[1]) == {"photo-alike"}
    assert check_quality(photos).alike == ((0, 1), (0, 2), (1, 2))


@pytest.mark.slow
def test_at_a_reduced_scale_strong_blur_is_found_and_sharp_photos_are_left_alone(tmp_path):
    """What changes with the scale: blur of 3 px is told down to 1/2, of 5 px down to 1/4, of 12 px down to 1/8."""
    least = {1: 2.0, 2: 3.0, 4: 5.0, 8: 12.0}
    for scale, sigma in least.items():
        for seed in range(3):
            sharp = facade(seed, (1200, 1600))
            blurred = cv2.GaussianBlur(sharp, (0, 0), sigma)
            photos = [write(tmp_path / f"{scale}-{seed}-{i}.jpg", p) for i, p in enumerate((sharp, blurred))]
            report = check_quality(photos, limits=QualityLimits(scale=scale))
            assert [codes(report, photo) - {"photo-alike"} for photo in photos] == [set(), {"photo-blurred"}]


@pytest.mark.parametrize("wrong", [{"sigma_px": 0.0}, {"clipped": 0.0}, {"scale": 3}])
def test_limits_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ValueError, match="expected sigma_px above 0"):
        QualityLimits(**wrong)


def test_poses_of_other_photos_are_a_wrong_call(tmp_path):
    photo = write(tmp_path / "a.jpg", facade(1))
    with pytest.raises(ValueError, match="of all 2 photos"):
        check_quality([photo, photo], [camera(photo)])


def test_all_real_photos_are_measured_but_the_one_that_was_cut_off(shared_data):
    photos = read_photos(shared_data / "dji" / "photos").photos
    report = check_quality(photos)
    unreadable = [photo.path.name for photo, found in zip(photos, report.photos, strict=True) if found is None]
    assert unreadable == ["XTS.jpg"]
    assert [finding.code for finding in report.findings] == ["photo-unreadable"]
    assert max(found.sigma_px for found in report.photos if found is not None) < 1.2
