"""Folders of photos that no coarse model can be made of: what is said of them."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
import pytest

from groundstation.services.photos.coarse import coarse_files
from planning.base.errors import InputError
from planning.photos.record import PhotoMetadata
from reconstruction.coarse.inputs import days_apart
from reconstruction.coarse.parameters import CoarseRequest
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save


def write(folder, name, lat_deg=48.0, **properties):
    folder.mkdir(exist_ok=True)
    exif = exif_part({0x010F: "DJI", 0x0110: "M3T"}, {}, gps_tags(lat_deg, 11.0, 500.0))
    save(folder / name, jpeg(exif, packet(properties)))


def test_photos_of_places_far_apart_are_told_without_a_word_of_a_site(tmp_path):
    for number, lat_deg in enumerate((40.0, 45.0, 50.0)):
        write(tmp_path / "card", f"{number}.jpg", lat_deg)
    with pytest.raises(InputError, match=r"up to \d+ km apart; put those of one building into a folder") as refused:
        coarse_files(CoarseRequest(tmp_path / "card", tmp_path / "out"))
    assert "site" not in str(refused.value)


def test_too_few_photos_of_a_camera_are_told_with_the_others(tmp_path):
    for number in range(4):
        write(tmp_path / "card", f"{number}.jpg", ImageSource="InfraredCamera")
    write(tmp_path / "card", "4.jpg", ImageSource="WideCamera")
    with pytest.raises(InputError, match=r"of 5 photos, 1 are of the wide camera; choose another camera"):
        coarse_files(CoarseRequest(tmp_path / "card", tmp_path / "out"))


def test_damaged_photos_are_left_out_and_told_before_they_are_too_few(tmp_path):
    for number in range(4):
        write(tmp_path / "card", f"{number}.jpg")
    for number in range(2):
        path = tmp_path / "card" / f"{number}.jpg"
        path.write_bytes(path.read_bytes()[:-20] + path.read_bytes()[-2:])
    with pytest.raises(
        InputError, match=r"needs at least 3 photos, and 2 of 4 are whole; the first other: .*0\.jpg: a p"
    ):
        coarse_files(CoarseRequest(tmp_path / "card", tmp_path / "out"))


@pytest.mark.parametrize("place", ["card/masks", "masks"])
def test_masks_that_do_not_fit_their_photos_are_told(tmp_path, place):
    photos = tmp_path / "card" / "images" if place == "card/masks" else tmp_path / "images"
    photos.parent.mkdir(exist_ok=True)
    for number in range(4):
        write(photos, f"{number}.jpg")
    (tmp_path / place).mkdir()
    for number, size in enumerate([(7, 9), (8, 8)]):
        cv2.imwrite(str(tmp_path / place / f"{number}.jpg.png"), np.zeros(size, np.uint8))
    with pytest.raises(InputError, match=r"2 of 4 are whole; the first other: its mask cannot be used \(.*it was left"):
        coarse_files(CoarseRequest(photos, tmp_path / "out"))


def test_copies_of_one_photo_count_once(tmp_path):
    for number in range(5):
        write(tmp_path / "card", f"{number}.jpg")
    with pytest.raises(
        InputError, match=r"at least 3 photos taken from different places, got 1; 4 of 5 photos are copies .* 1\.jpg"
    ):
        coarse_files(CoarseRequest(tmp_path / "card", tmp_path / "out"))


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("DJI_0001.MP4", "but videos, the first DJI_0001.MP4; fly again"),
        ("shot.PNG", "but 1 of other kinds, the first shot.PNG"),
    ],
)
def test_files_that_are_no_photos_are_named(tmp_path, name, said):
    (tmp_path / "card" / "DCIM").mkdir(parents=True)
    (tmp_path / "card" / "DCIM" / name).write_bytes(b"0")
    with pytest.raises(InputError, match=said):
        coarse_files(CoarseRequest(tmp_path / "card", tmp_path / "out"))


@pytest.mark.parametrize(("days", "is_told"), [(0, False), (1, False), (9, True)])
def test_photos_of_flights_days_apart_are_told(days, is_told):
    begun = datetime(2026, 5, 1, 10)
    photos = [PhotoMetadata(Path("a.jpg"), 4, 3, taken_at=begun + timedelta(days=n)) for n in (0, 0, days)]
    assert bool(days_apart(photos)) is is_told
