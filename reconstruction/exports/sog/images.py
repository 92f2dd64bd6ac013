"""Bytes as lossless WebP images, every bit of all four channels, and back."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError

Bytes = NDArray[np.uint8]

LONGEST_SIDE_PX = 16_383
"""Of a WebP image."""

RIFF_HEADER = struct.Struct("<4sI4s4sI")
"""RIFF, length, WEBP, kind and length of the first chunk."""

LOSSLESS, EXTENDED = b"VP8L", b"VP8X"

LOSSLESS_START = 0x2F


def image_size(n: int) -> tuple[int, int]:
    """Width and height of an image of at least `n` pixels, both multiples of 4."""
    width = max(4, 4 * math.ceil(math.sqrt(n) / 4.0))
    return width, max(4, 4 * math.ceil(n / width / 4.0))


def image_of(values: Bytes) -> bytes:
    """A WebP file of values, shape (h, w, 4): red, green, blue, alpha."""
    # Without the second, colours of transparent pixels are not kept.
    options = [cv2.IMWRITE_WEBP_QUALITY, 101, cv2.IMWRITE_WEBP_LOSSLESS_MODE, cv2.IMWRITE_WEBP_LOSSLESS_PRESERVE_COLOR]
    is_made, content = cv2.imencode(".webp", np.ascontiguousarray(values[:, :, [2, 1, 0, 3]]), options)
    if not is_made:
        raise ValueError(f"values: expected an image of (h, w, 4) bytes, got {values.shape}")
    return content.tobytes()


def rows_as_image(rows: Bytes, alpha: int = 255) -> bytes:
    """A WebP file whose pixels, row by row from the top left, are rows, shape (n, 1 to 4).

    Channels that are not given are 0, alpha is `alpha`.
    """
    width, height = image_size(len(rows))
    whole = np.zeros((width * height, 4), np.uint8)
    whole[:, 3] = alpha
    whole[: len(rows), : rows.shape[1]] = rows
    return image_of(whole.reshape(height, width, 4))


def values_of(content: bytes, name: str, path: Path, most_px: int) -> Bytes:
    """Red, green, blue, alpha of a lossless WebP file, shape (h, w, 4).

    Parameters
    ----------
    name, path
        Of the image and of the file it is in, for messages.
    most_px
        That it may have; more is refused before any is decoded.

    Raises
    ------
    InputError
        It is no such file, is damaged or too large.
    """
    width, height = _size(content, name, path)
    if width * height > most_px:
        raise InputError(f"{path}: {name} has {width} x {height} pixels; expected at most {most_px}")
    found = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    if found is None or found.ndim != 3 or found.shape[:2] != (height, width):
        raise InputError(f"{path}: {name} is damaged")
    if found.shape[2] == 3:
        found = np.dstack([found, np.full((height, width), 255, np.uint8)])
    return np.ascontiguousarray(found[:, :, [2, 1, 0, 3]], dtype=np.uint8)


def _size(content: bytes, name: str, path: Path) -> tuple[int, int]:
    """Of the header; a file without colours lost has one of two kinds of first chunk."""
    if len(content) >= RIFF_HEADER.size + 10:
        riff, _, webp, kind, _ = RIFF_HEADER.unpack_from(content)
        if (riff, webp) == (b"RIFF", b"WEBP"):
            start = RIFF_HEADER.size
            if kind == LOSSLESS and content[start] == LOSSLESS_START:
                bits = int.from_bytes(content[start + 1 : start + 5], "little")
                return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
            if kind == EXTENDED:
                sides = (int.from_bytes(content[start + at : start + at + 3], "little") + 1 for at in (4, 7))
                width, height = sides
                return width, height
    raise InputError(f"{path}: {name}: expected a lossless WebP image")
