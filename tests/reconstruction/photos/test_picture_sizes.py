"""Pictures of any kind: how large they will be is read from their header, and nothing beyond bounds is decoded."""

import random
import struct
import tracemalloc
import zlib

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from planning.photos.jpeg import read_header
from planning.photos.metadata import read_photo
from reconstruction.photos.decode import MAX_PIXELS, colour_picture, decoded, grey_picture, picture_size

ENDINGS = (".jpg", ".png", ".webp", ".tif", ".bmp")


def coded(ending, width=37, height=23):
    picture = np.random.default_rng(1).integers(0, 255, (height, width, 3), np.uint8)
    options = [cv2.IMWRITE_WEBP_QUALITY, 80] if ending == ".webp" else []
    return cv2.imencode(ending, picture, options)[1].tobytes()


def claiming(ending, width, height):
    """A small file that says it has so many pixels."""
    content = bytearray(coded(ending))
    if ending == ".jpg":
        at = next(k for k in range(2, len(content)) if content[k : k + 2] == b"\xff\xc0")
        content[at + 5 : at + 9] = struct.pack(">HH", height, width)
    elif ending == ".png":
        content[16:24] = struct.pack(">II", width, height)
        content[29:33] = struct.pack(">I", zlib.crc32(content[12:29]))
    elif ending == ".webp":
        at = content.index(b"\x9d\x01\x2a") + 3
        content[at : at + 4] = struct.pack("<HH", width & 0x3FFF, height & 0x3FFF)
    elif ending == ".bmp":
        content[18:26] = struct.pack("<ii", width, height)
    else:
        start = struct.unpack_from("<I", content, 4)[0]
        for number in range(struct.unpack_from("<H", content, start)[0]):
            place = start + 2 + 12 * number
            tag, kind = struct.unpack_from("<HH", content, place)
            if tag in (256, 257):
                struct.pack_into("<H" if kind == 3 else "<I", content, place + 8, width if tag == 256 else height)
    return bytes(content)


@pytest.mark.parametrize("ending", ENDINGS)
def test_sizes_are_those_that_are_decoded(ending):
    content = coded(ending)
    assert picture_size(content) == (37, 23)
    assert decoded(content, cv2.IMREAD_COLOR, "a").shape == (23, 37, 3)
    lossless = cv2.imencode(".webp", np.zeros((5, 7, 4), np.uint8), [cv2.IMWRITE_WEBP_QUALITY, 101])[1].tobytes()
    assert picture_size(lossless) == (7, 5)


@pytest.mark.parametrize("ending", [".jpg", ".png", ".tif", ".bmp"])
def test_small_files_that_claim_to_be_large_are_not_decoded(ending):
    content = claiming(ending, 60_000, 60_000)
    tracemalloc.start()
    with pytest.raises(
        InputError, match="claims to be a picture of 60000 x 60000 pixels; expected 1 to 400 megapixels"
    ):
        decoded(content, cv2.IMREAD_COLOR, "a")
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()


@pytest.mark.parametrize("ending", [".jpg", ".png", ".tif", ".bmp", ".webp"])
@pytest.mark.parametrize("size", [(0, 0), (0, 23), (37, 0)])
def test_pictures_of_no_pixels_are_none(tmp_path, ending, size):
    content = claiming(ending, *size)
    with pytest.raises(InputError, match=r"claims to be a picture of|cannot be decoded"):
        decoded(content, cv2.IMREAD_COLOR, "a")
    if ending == ".jpg":
        (tmp_path / "a.jpg").write_bytes(content)
        with pytest.raises(InputError, match="so there is none in it"):
            read_header(tmp_path / "a.jpg")


def test_others_are_no_pictures():
    for content in (b"", b"GIF89a" + bytes(50), b"P6\n9 9\n255\n", b"#?RADIANCE\n", b"v/1\x01" + bytes(99), bytes(99)):
        assert picture_size(content) is None
        with pytest.raises(InputError, match="expected JPEG, PNG, WebP, TIFF or BMP"):
            decoded(content, cv2.IMREAD_COLOR, "a")


@pytest.mark.parametrize("ending", ENDINGS)
def test_damaged_pictures_are_decoded_or_refused(ending):
    rng, whole = random.Random(1), coded(ending)
    for _ in range(150):
        content = bytearray(whole[: rng.randrange(len(whole) + 1)] if rng.random() < 0.3 else whole)
        for _ in range(rng.randrange(6)):
            if content:
                content[rng.randrange(min(len(content), rng.choice((40, 10_000))))] = rng.randrange(256)
        try:
            found = decoded(bytes(content), cv2.IMREAD_COLOR, "a")
        except InputError:
            continue
        assert 0 < found.size <= 3 * MAX_PIXELS


@pytest.mark.parametrize("scale", [1, 2, 4, 8])
def test_a_png_that_is_called_jpg_is_made_smaller_like_a_jpeg(tmp_path, scale):
    (tmp_path / "a.jpg").write_bytes(coded(".png"))
    photo = read_photo(tmp_path / "a.jpg")
    assert grey_picture(photo, scale).shape == (-(-23 // scale), -(-37 // scale))
    assert colour_picture(photo, scale).shape == (-(-23 // scale), -(-37 // scale), 3)
