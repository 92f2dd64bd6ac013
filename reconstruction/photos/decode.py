"""Photos as grey pictures, at a reduced scale where wanted, with limits on what a file may cost.

A JPEG file can be decoded at 1/2, 1/4 or 1/8 of its size for less work, because its blocks of 8 x 8 pixels are stored
as frequencies. EXIF's orientation is left out of account: pixels stay where the camera's intrinsics have them.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_input_file
from planning.base.messages import say
from planning.photos.jpeg import MAX_STRAY_BYTES, PHOTO_FILE
from planning.photos.record import PhotoMetadata

# What is wrong with a picture is said in an error, and once.
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)

Scale = Literal[1, 2, 4, 8]
"""The picture is decoded at one part in so many of its width and height."""

FLAGS = {
    1: cv2.IMREAD_GRAYSCALE,
    2: cv2.IMREAD_REDUCED_GRAYSCALE_2,
    4: cv2.IMREAD_REDUCED_GRAYSCALE_4,
    8: cv2.IMREAD_REDUCED_GRAYSCALE_8,
}

COLOUR_FLAGS = {
    1: cv2.IMREAD_COLOR,
    2: cv2.IMREAD_REDUCED_COLOR_2,
    4: cv2.IMREAD_REDUCED_COLOR_4,
    8: cv2.IMREAD_REDUCED_COLOR_8,
}

MAX_PIXELS = 400 * 10**6
"""Larger pictures are refused: the largest aerial cameras have 150 megapixels, and a file of some kilobytes can claim
4300. A progressive one takes 6 bytes per pixel while it is decoded."""

LARGE_PIXELS = 64 * 10**6
"""Larger ones are decoded one at a time."""

PICTURE_FILE = FileLimit(say("a picture"), 512 * MIB)

JPEG_START, PNG_START = b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n"

_TIFF = {b"II*\0": "<", b"MM\0*": ">"}
"""First bytes, and the order of those of numbers."""

_NO_SIZE = {0xC4, 0xC8, 0xCC}
"""JPEG markers among those of frames (SOF) that are none."""


def grey_picture(photo: PhotoMetadata, scale: Scale = 1) -> NDArray[np.uint8]:
    """The picture, shape (h, w), at 1/`scale` of its size, rounded up.

    Raises
    ------
    InputError
        The file has gone, is damaged, or claims to hold more than any camera's picture.
    """
    return _picture(photo, FLAGS[scale], scale)


def colour_picture(photo: PhotoMetadata, scale: Scale = 1) -> NDArray[np.uint8]:
    """The picture, shape (h, w, 3), blue, green, red; scale and errors as in `grey_picture`."""
    return _picture(photo, COLOUR_FLAGS[scale], scale)


def _picture(photo: PhotoMetadata, flag: int, scale: Scale) -> NDArray[np.uint8]:
    place = str(photo.path)
    _check_size((photo.width_px, photo.height_px), place, MAX_PIXELS)
    content = read_input_file(photo.path, PHOTO_FILE)
    if not photo.is_complete:
        raise InputError(
            say("the file was cut off, so that part of the picture is missing; copy it again", place=place)
        )
    picture = decoded(content, flag | cv2.IMREAD_IGNORE_ORIENTATION, place)
    expected = -(-photo.height_px // scale), -(-photo.width_px // scale)
    if picture.shape[:2] != expected:
        raise InputError(
            say(
                "expected a picture of {} x {} pixels, as the header says, got {} x {}; the file is damaged: "
                "copy it again",
                expected[1],
                expected[0],
                picture.shape[1],
                picture.shape[0],
                place=place,
            )
        )
    return np.asarray(picture, np.uint8)


def decoded(content: bytes, flags: int, place: str, max_pixels: int = MAX_PIXELS) -> NDArray[Any]:
    """A picture from the content of a file; how large it will be is read from its header before it is decoded.

    Parameters
    ----------
    flags
        Of OpenCV's `imdecode`.
    place
        For messages.

    Raises
    ------
    InputError
        It is no JPEG, PNG, WebP, TIFF or BMP file, is damaged, or claims to have no or too many pixels.
    """
    size_wh = picture_size(content)
    if size_wh is None:
        raise InputError(
            say("cannot be decoded as a picture; expected JPEG, PNG, WebP, TIFF or BMP, whole", place=place)
        )
    _check_size(size_wh, place, max_pixels)
    if content.startswith(PNG_START) and not _is_whole_png(content):
        raise InputError(say("the picture is cut off or damaged; copy the file again", place=place))
    if content.startswith(JPEG_START):
        content = _without_stray_bytes(content)
    try:
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error as error:
        raise InputError(
            say("the picture cannot be decoded ({}); copy the file again", error.err, place=place)
        ) from error
    if picture is None or picture.size == 0:
        raise InputError(say("the picture cannot be decoded; copy the file again", place=place))
    return np.asarray(picture)


def _check_size(size_wh: tuple[int, int], place: str, max_pixels: int) -> None:
    if not 0 < size_wh[0] * size_wh[1] <= max_pixels:
        raise InputError(
            say(
                "claims to be a picture of {} x {} pixels; expected 1 to {} megapixels, so it is not decoded",
                size_wh[0],
                size_wh[1],
                max_pixels // 10**6,
                place=place,
            )
        )


def picture_size(content: bytes) -> tuple[int, int] | None:
    """Width and height that a file's header says; None where there is none."""
    if content.startswith(PNG_START):
        return struct.unpack(">II", content[16:24]) if len(content) >= 24 and content[12:16] == b"IHDR" else None
    if content.startswith(b"RIFF") and content[8:12] == b"WEBP":
        return _size_of_webp(content)
    if content.startswith(b"BM") and len(content) >= 26:
        width, height = struct.unpack("<ii", content[18:26])
        return width, abs(height)
    if content[:4] in _TIFF:
        return _size_of_tiff(content, _TIFF[content[:4]])
    if not content.startswith(JPEG_START):
        return None
    place, n_stray = 2, 0
    while place + 9 <= len(content) and n_stray <= MAX_STRAY_BYTES:
        marker = content[place + 1]
        if content[place] != 0xFF or marker in (0x00, 0xFF):  # fill bytes, and such that belong to nothing
            place, n_stray = place + 1, n_stray + 1
            continue
        if 0xC0 <= marker <= 0xCF and marker not in _NO_SIZE:
            height, width = struct.unpack(">HH", content[place + 5 : place + 9])
            return width, height
        place += 2 + int(struct.unpack(">H", content[place + 2 : place + 4])[0])
    return None


def _without_stray_bytes(content: bytes) -> bytes:
    """A JPEG file without bytes that belong to none of its header's parts: its decoder prints a complaint of them."""
    parts, place, begin, n_stray = [], 2, 0, 0
    while place + 4 <= len(content) and n_stray <= MAX_STRAY_BYTES:
        marker = content[place + 1]
        if content[place] != 0xFF or marker in (0x00, 0xFF):
            if content[place] != 0xFF and begin <= place:
                parts.append(content[begin:place])
                begin = place + 1
            place, n_stray = place + 1, n_stray + 1
            continue
        if marker == 0xDA or marker == 0xD9:
            break
        place += 2 + int(struct.unpack(">H", content[place + 2 : place + 4])[0])
    return content if begin == 0 else b"".join((*parts, content[begin:]))


def _is_whole_png(content: bytes) -> bool:
    """Whether all parts of a PNG file have their checksums; its decoder draws on over damage and prints complaints."""
    place = len(PNG_START)
    while place + 12 <= len(content):
        end = place + 8 + int.from_bytes(content[place : place + 4], "big")
        checksum = int.from_bytes(content[end : end + 4], "big")
        if end + 4 > len(content) or zlib.crc32(content[place + 4 : end]) != checksum:
            return False
        if content[place + 4 : place + 8] == b"IEND":
            return True
        place = end + 4
    return False


def _size_of_webp(content: bytes) -> tuple[int, int] | None:
    """Of the first chunk: extended, lossless or lossy (RFC 9649)."""

    def number(start: int, n_bytes: int) -> int:
        return int.from_bytes(content[start : start + n_bytes], "little")

    kind = content[12:16] if len(content) >= 30 else b""
    if kind == b"VP8X":
        return number(24, 3) + 1, number(27, 3) + 1
    if kind == b"VP8L" and content[20] == 0x2F:
        bits = number(21, 4)
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 " and content[23:26] == b"\x9d\x01\x2a":
        return number(26, 2) & 0x3FFF, number(28, 2) & 0x3FFF
    return None


def _size_of_tiff(content: bytes, order: str) -> tuple[int, int] | None:
    """Of the first picture's directory (TIFF 6.0, section 2); a size is one number of two or four bytes."""
    sides: dict[int, int] = {}
    try:
        (start,) = struct.unpack_from(f"{order}I", content, 4)
        (n_entries,) = struct.unpack_from(f"{order}H", content, start)
        for number in range(n_entries):
            tag, kind, _ = struct.unpack_from(f"{order}HHI", content, start + 2 + 12 * number)
            if tag in (256, 257):
                value = f"{order}{'H' if kind == 3 else 'I'}"
                (sides[tag],) = struct.unpack_from(value, content, start + 10 + 12 * number)
    except struct.error:
        return None
    return (sides[256], sides[257]) if len(sides) == 2 else None
