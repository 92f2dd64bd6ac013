"""Reading photos, label images and masks, with their faults told by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import write_atomically
from planning.base.messages import glue, say
from planning.photos.jpeg import JPEG_START
from planning.photos.metadata import read_photo
from reconstruction.photos.decode import PICTURE_FILE, colour_picture, decoded

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
    raise InputError(say("expected an image of 8 or 16 bit, found {}", picture.dtype, place=path))


def write_picture(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture in the format that the suffix says; a JPEG at quality 82."""
    coded, data = cv2.imencode(path.suffix, picture, [cv2.IMWRITE_JPEG_QUALITY, 82])
    if not coded:
        raise ValueError(f"{path}: the picture cannot be coded")
    write_atomically(path, data.tobytes())


def pictures_in(folder: Path) -> dict[str, Path]:
    """Picture files of a folder by their names without suffix, sorted.

    Raises
    ------
    InputError
        There is no such folder, it holds no pictures, or two of them have one name.
    """
    if not folder.is_dir():
        raise InputError(
            glue(folder, ": expected a folder of pictures, found ", say("a file") if folder.exists() else "nothing")
        )
    found: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() in PICTURE_SUFFIXES and path.is_file():
            if path.stem in found:
                raise InputError(
                    say("{} and {} have one name; keep one of them", found[path.stem].name, path.name, place=folder)
                )
            found[path.stem] = path
    if not found:
        raise InputError(
            say("expected pictures ({}) in this folder, found none", ", ".join(PICTURE_SUFFIXES), place=folder)
        )
    return found


def _decoded(path: Path, flags: int) -> NDArray[Any]:
    return decoded(_content(path), flags, str(path))


def _content(path: Path) -> bytes:
    content = read_input_file(path, PICTURE_FILE)
    if not content:
        raise InputError(say("the file is empty; copy it again", place=path))
    return content
