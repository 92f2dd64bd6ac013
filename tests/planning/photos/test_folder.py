"""Folders of photos: order, broken files, progress."""

import zlib
from datetime import datetime

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.photos.folder import in_order, read_photos
from planning.photos.record import PhotoMetadata
from tests.planning.photos.photo_writer import exif_part, jpeg, packet, save


def shot(second, fraction=None):
    tags = {0x9003: f"2024:05:01 10:00:{second:02d}"} | ({} if fraction is None else {0x9291: fraction})
    return jpeg(exif_part(photo=tags))


def names(folder):
    return [photo.path.name for photo in folder.photos]


def test_photos_come_in_the_order_of_time_then_of_the_cameras_count(tmp_path):
    save(tmp_path / "101MEDIA" / "DJI_0001.JPG", shot(20))
    save(tmp_path / "100MEDIA" / "DJI_0999.JPG", shot(10))
    save(tmp_path / "100MEDIA" / "DJI_0998.JPG", shot(10))
    save(tmp_path / "100MEDIA" / "z_0001.jpeg", shot(10, "5"))
    save(tmp_path / "a.jpg", jpeg())
    assert names(read_photos(tmp_path)) == ["DJI_0998.JPG", "DJI_0999.JPG", "z_0001.jpeg", "DJI_0001.JPG", "a.jpg"]


def test_the_clock_of_the_exposure_counts_where_all_have_one(tmp_path):
    for count, exposed in enumerate((2, 1, 0), 1):
        xmp = packet({"UTCAtExposure": f"2024-05-01T08:00:{exposed:02d}.25"})
        save(tmp_path / f"DJI_{count:04d}.JPG", jpeg(exif_part(photo={0x9003: "2024:05:01 10:00:00"}), xmp))
    assert names(read_photos(tmp_path)) == ["DJI_0003.JPG", "DJI_0002.JPG", "DJI_0001.JPG"]
    save(tmp_path / "DJI_0000.JPG", shot(0))
    assert names(read_photos(tmp_path))[:2] == ["DJI_0000.JPG", "DJI_0001.JPG"]  # clocks are never mixed


def test_broken_files_are_told_of_and_left_out(tmp_path):
    save(tmp_path / "good.jpg", shot(1))
    save(tmp_path / "broken.jpg", shot(2)[:40])
    save(tmp_path / "cut.jpg", shot(3)[:-2])
    save(tmp_path / "notes.txt", b"no photo")
    save(tmp_path / "._good.jpg", b"left there by a Mac")
    found = read_photos(tmp_path)
    assert names(found) == ["good.jpg", "cut.jpg"]
    assert {(finding.code, finding.place) for finding in found.findings} == {
        ("photo-unreadable", str(tmp_path / "broken.jpg")),
        ("photo-cut-off", str(tmp_path / "cut.jpg")),
    }


PNG = cv2.imencode(".png", np.full((30, 40, 3), 90, np.uint8))[1].tobytes()
HEAD_END = 8 + 8 + 13 + 4
"""Of a PNG file: signature and IHDR."""


def chunk(kind, content):
    return len(content).to_bytes(4, "big") + kind + content + zlib.crc32(kind + content).to_bytes(4, "big")


@pytest.mark.parametrize("place", ["before the picture", "behind it"])
def test_a_png_that_is_called_jpg_is_read_by_its_content(tmp_path, place):
    exif = exif_part(photo={0x9003: "2024:05:01 10:00:07"})[len(b"Exif\0\0") :]
    xmp = b"XML:com.adobe.xmp" + bytes(5) + packet({"RelativeAltitude": "+12.5"}).encode()
    parts = chunk(b"eXIf", exif) + chunk(b"iTXt", xmp)
    at = HEAD_END if place == "before the picture" else len(PNG) - 12
    save(tmp_path / "a.jpg", PNG[:at] + parts + PNG[at:])
    save(tmp_path / "b.jpg", PNG[:-12])
    whole, cut = read_photos(tmp_path).photos
    assert (whole.width_px, whole.height_px, whole.is_complete) == (40, 30, True)
    assert (whole.taken_at, whole.height_above_takeoff_m) == (datetime(2024, 5, 1, 10, 0, 7), 12.5)
    assert (cut.width_px, cut.is_complete) == (40, False)


def test_a_jpeg_that_is_called_otherwise_is_a_photo(tmp_path):
    save(tmp_path / "a.png", shot(7))
    save(tmp_path / "b.png", PNG)
    (photo,) = read_photos(tmp_path).photos
    assert (photo.path.name, photo.taken_at.second) == ("a.png", 7)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (cv2.imencode(".webp", np.zeros((8, 8, 3), np.uint8))[1].tobytes(), "of the kind WebP with the name of a JPEG"),
        (cv2.imencode(".tif", np.zeros((8, 8, 3), np.uint8))[1].tobytes(), "of the kind TIFF"),
        (cv2.imencode(".bmp", np.zeros((8, 8, 3), np.uint8))[1].tobytes(), "of the kind BMP"),
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "of the kind HEIC"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "'git lfs pull'"),
        (b"<!DOCTYPE html>", "is no JPEG file"),
        (b"", "is no JPEG file"),
    ],
)
def test_what_a_file_is_that_is_called_a_photo_is_said(tmp_path, content, says):
    save(tmp_path / "a.jpg", content)
    with pytest.raises(InputError, match=says):
        read_photos(tmp_path)


@pytest.mark.parametrize("at", [1, 7, 8, 15, 16, 20, 23])
def test_a_png_that_ends_in_its_header_is_refused_in_words(tmp_path, at):
    save(tmp_path / "a.jpg", PNG[:at])
    with pytest.raises(InputError, match=r"copy it from the card again|no JPEG file"):
        read_photos(tmp_path)


def test_what_is_no_folder_of_photos_is_refused(tmp_path):
    with pytest.raises(InputError, match="found nothing"):
        read_photos(tmp_path / "none")
    with pytest.raises(InputError, match="found a file"):
        read_photos(save(tmp_path / "x" / "a.jpg", shot(0)))
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"holds no \.jpg photo"):
        read_photos(tmp_path / "empty")
    save(tmp_path / "bad" / "a.jpg", b"nothing")
    with pytest.raises(InputError, match="none of its 1 photos"):
        read_photos(tmp_path / "bad")


def test_reading_is_reported_and_can_be_cancelled(tmp_path):
    for count in range(130):
        save(tmp_path / f"DJI_{count:04d}.JPG", shot(count % 60))

    seen = []

    class Impatient:
        def report(self, stage, done, total):
            seen.append((done, total))
            if done > 0:
                raise OperationCancelled("enough")

    with pytest.raises(OperationCancelled):
        read_photos(tmp_path, Impatient())
    assert seen == [(0, 130), (64, 130)]


def test_order_without_any_file(tmp_path):
    first = PhotoMetadata(tmp_path / "b", 1, 1, taken_at=datetime(2024, 1, 1))
    assert in_order([PhotoMetadata(tmp_path / "a", 1, 1), first])[0] is first
    assert in_order([]) == ()
