"""Reading photos, label images and masks, with their faults told by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.photo_files.metadata import read_photo
from reconstruction.photos.decode import MAX_PIXELS, colour_picture

JPEG_START, PNG_START = b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n"

PICTURE_SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp")


def read_picture(path: Path) -> NDArray[np.uint8]:
    """A photo, shape (height, width, 3), uint8, blue, green, red, as its pixels lie in the file.

    Raises
    ------
    InputError
        There is none, or it cannot be decoded.
    """
    if _content(path).startswith(JPEG_START):
        return colour_picture(read_photo(path))
    return np.asarray(_decoded(path, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION), np.uint8)


def read_labels(path: Path) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """A label image as it is: 8 or 16 bit, one channel or three.

    Raises
    ------
    InputError
        There is none, or it cannot be decoded.
    """
    picture = _decoded(path, cv2.IMREAD_UNCHANGED)
    if picture.dtype == np.uint8:
        return np.asarray(picture, np.uint8)
    if picture.dtype == np.uint16:
        return np.asarray(picture, np.uint16)
    raise InputError(f"{path}: expected an image of 8 or 16 bit, found {picture.dtype}")


def write_picture(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture in the format that the suffix says; a JPEG at quality 82."""
    coded, data = cv2.imencode(path.suffix, picture, [cv2.IMWRITE_JPEG_QUALITY, 82])
    if not coded:
        raise ValueError(f"{path}: the picture cannot be coded")
    path.write_bytes(data.tobytes())


def pictures_in(folder: Path) -> dict[str, Path]:
    """Picture files of a folder by their names without suffix, sorted.

    Raises
    ------
    InputError
        There is no such folder, it holds no pictures, or two of them have one name.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: expected a folder of pictures, found {'a file' if folder.exists() else 'nothing'}")
    found: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() in PICTURE_SUFFIXES and path.is_file():
            if path.stem in found:
                raise InputError(f"{folder}: {found[path.stem].name} and {path.name} have one name; keep one of them")
            found[path.stem] = path
    if not found:
        raise InputError(f"{folder}: expected pictures ({', '.join(PICTURE_SUFFIXES)}) in this folder, found none")
    return found


def _decoded(path: Path, flags: int) -> NDArray[Any]:
    content = _content(path)
    if content.startswith(PNG_START):
        width, height = (int.from_bytes(content[at : at + 4], "big") for at in (16, 20))
        if width * height > MAX_PIXELS:
            raise InputError(
                f"{path}: claims to be a picture of {width} x {height} pixels; expected at most "
                f"{MAX_PIXELS // 10**6} megapixels, so it is not decoded"
            )
    try:
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error as error:
        raise InputError(f"{path}: cannot be decoded as a picture; it may be too large or damaged") from error
    if picture is None:
        raise InputError(f"{path}: cannot be decoded as a picture; expected JPEG, PNG, TIFF or BMP, whole")
    return np.asarray(picture)


def _content(path: Path) -> bytes:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not content:
        raise InputError(f"{path}: the file is empty; copy it again")
    return content
