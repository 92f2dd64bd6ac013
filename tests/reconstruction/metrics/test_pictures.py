"""Pictures are read whole or refused by name."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.metrics.pictures import read_labels, read_picture, write_picture

PICTURE = np.random.default_rng(0).integers(0, 256, (40, 60, 3), np.uint8)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp", ".jpg"])
def test_pictures_come_back(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    write_picture(path, cv2.GaussianBlur(PICTURE, (0, 0), 5))
    read = read_picture(path)
    assert read.shape == PICTURE.shape
    worst = np.abs(read.astype(int) - cv2.GaussianBlur(PICTURE, (0, 0), 5)).max()
    assert worst == 0 if suffix != ".jpg" else worst < 30


def test_photo_that_was_cut_off_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    write_picture(path, PICTURE)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match=r"a\.jpg: the file was cut off"):
        read_picture(path)


def test_picture_that_claims_to_be_huge_is_not_decoded(tmp_path: Path) -> None:
    header = b"IHDR" + struct.pack(">IIBBBBB", 60_000, 60_000, 8, 0, 0, 0, 0)
    path = tmp_path / "bomb.png"
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header)) + b"\0" * 64
    )
    for read in (read_picture, read_labels):
        with pytest.raises(InputError, match="60000 x 60000 pixels"):
            read(path)


def test_floating_point_labels_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.tif"
    assert cv2.imwrite(str(path), np.zeros((4, 4), np.float32))
    with pytest.raises(InputError, match="8 or 16 bit, found float32"):
        read_labels(path)


def test_picture_stays_as_its_pixels_lie_whatever_exif_says(shared_data: Path) -> None:
    for path in sorted((shared_data / "dji" / "photos").glob("*.[jJ][pP]*"))[:3]:
        raw = cv2.imread(str(path), cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
        np.testing.assert_array_equal(read_picture(path), raw)
