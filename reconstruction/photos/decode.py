"""Photos as grey pictures, at a reduced scale where wanted, with limits on what a file may cost.

A JPEG file can be decoded at 1/2, 1/4 or 1/8 of its size for less work, because its blocks of 8 x 8 pixels are stored
as frequencies. EXIF's orientation is left out of account: pixels stay where the camera's intrinsics have them.
"""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.photo_files.record import PhotoMetadata

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

MAX_FILE_BYTES = 512 * 2**20


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
    n_pixels = photo.width_px * photo.height_px
    if n_pixels > MAX_PIXELS:
        raise InputError(
            f"{place}: claims to be a picture of {photo.width_px} x {photo.height_px} pixels; expected at most "
            f"{MAX_PIXELS // 10**6} megapixels, so it is not decoded"
        )
    try:
        if photo.path.stat().st_size > MAX_FILE_BYTES:
            raise InputError(f"{place}: has more than {MAX_FILE_BYTES // 2**20} MiB; expected a photo")
        content = photo.path.read_bytes()
    except OSError as error:
        raise InputError(f"{place}: cannot be read any more ({error.strerror or error})") from error
    if not photo.is_complete:
        raise InputError(f"{place}: the file was cut off, so that part of the picture is missing; copy it again")
    try:
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), flag | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error as error:
        raise InputError(f"{place}: the picture cannot be decoded ({error.err}); copy the file again") from error
    if picture is None or picture.size == 0:
        raise InputError(f"{place}: the picture cannot be decoded; copy the file again")
    expected = -(-photo.height_px // scale), -(-photo.width_px // scale)
    if picture.shape[:2] != expected:
        raise InputError(
            f"{place}: expected a picture of {expected[1]} x {expected[0]} pixels, as the header says, got "
            f"{picture.shape[1]} x {picture.shape[0]}; the file is damaged: copy it again"
        )
    return np.asarray(picture, np.uint8)
