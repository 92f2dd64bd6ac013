"""EXIF: the tags that we use, out of a TIFF structure in either byte order (CIPA DC-008).

The structure comes from strangers: entries that are damaged, point outside or hold more than such a tag can are left
out, one by one, and only the tags asked for are decoded, so that nothing in it can cost time or memory.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from enum import IntEnum

Value = str | tuple[float, ...]

MAX_ENTRIES = 1000
MAX_TEXT_BYTES = 1024
MAX_NUMBERS = 16

EXIF_POINTER, GPS_POINTER = 0x8769, 0x8825

FORMATS = {1: "B", 3: "H", 4: "I", 6: "b", 7: "B", 8: "h", 9: "i", 11: "f", 12: "d"}
"""Letters of `struct` by type; rationals (5, 10) and text (2) are treated by themselves."""

ASCII, RATIONAL, SIGNED_RATIONAL = 2, 5, 10


class Tag(IntEnum):
    """Tags by their numbers; those of the GPS part carry 0x10000 on top, because its numbers overlap with others."""

    MAKE = 0x010F
    MODEL = 0x0110
    ORIENTATION = 0x0112
    EXPOSURE_TIME = 0x829A
    F_NUMBER = 0x829D
    ISO = 0x8827
    DATE_TIME_ORIGINAL = 0x9003
    OFFSET_TIME_ORIGINAL = 0x9011
    FOCAL_LENGTH = 0x920A
    SUB_SEC_TIME_ORIGINAL = 0x9291
    FOCAL_LENGTH_35MM = 0xA405
    BODY_SERIAL_NUMBER = 0xA431
    GPS_LATITUDE_REF = 0x10001
    GPS_LATITUDE = 0x10002
    GPS_LONGITUDE_REF = 0x10003
    GPS_LONGITUDE = 0x10004
    GPS_ALTITUDE_REF = 0x10005
    GPS_ALTITUDE = 0x10006
    GPS_H_POSITIONING_ERROR = 0x1001F


GPS_BASE = 0x10000

TAGS = frozenset(map(int, Tag))


def read_exif(content: bytes) -> dict[Tag, Value]:
    """Tags of an EXIF part: text, or one to sixteen numbers (NaN for a rational over zero).

    Parameters
    ----------
    content
        The TIFF structure; anything is understood, what is damaged gives fewer tags.
    """
    order = {b"II": "<", b"MM": ">"}.get(content[:2])
    if order is None or len(content) < 8:
        return {}
    found: dict[Tag, Value] = {}
    first = struct.unpack_from(order + "I", content, 4)[0]
    pointers: dict[int, int] = {}
    for number, value in _entries(content, order, first, 0):
        if number in (EXIF_POINTER, GPS_POINTER):
            if not isinstance(value, str) and 0.0 <= value[0] < len(content):
                pointers[number] = int(value[0])
        elif number in TAGS:
            found.setdefault(Tag(number), value)
    for pointer, base in ((EXIF_POINTER, 0), (GPS_POINTER, GPS_BASE)):
        if pointer in pointers:
            for number, value in _entries(content, order, pointers[pointer], base):
                if number in TAGS:
                    found.setdefault(Tag(number), value)
    return found


def _entries(content: bytes, order: str, offset: int, base: int) -> Iterator[tuple[int, Value]]:
    """Entries of one directory that are of use, with their tag numbers."""
    if offset + 2 > len(content):
        return
    n = struct.unpack_from(order + "H", content, offset)[0]
    for index in range(min(n, MAX_ENTRIES)):
        at = offset + 2 + 12 * index
        if at + 12 > len(content):
            return
        number, kind, count = struct.unpack_from(order + "HHI", content, at)
        number += base
        if number not in TAGS and number not in (EXIF_POINTER, GPS_POINTER):
            continue
        value = _value(content, order, kind, count, at + 8)
        if value is not None:
            yield number, value


def _value(content: bytes, order: str, kind: int, count: int, at: int) -> Value | None:
    """Value of an entry whose last four bytes stand at `at`; None where it is no value of ours."""
    is_rational = kind in (RATIONAL, SIGNED_RATIONAL)
    letter = {ASCII: "s", RATIONAL: "I", SIGNED_RATIONAL: "i"}.get(kind) or FORMATS.get(kind)
    if letter is None or not 0 < count <= (MAX_TEXT_BYTES if kind == ASCII else MAX_NUMBERS):
        return None
    layout = f"{order}{count * 2 if is_rational else count}{letter}"
    size = struct.calcsize(layout)
    start = at if size <= 4 else struct.unpack_from(order + "I", content, at)[0]
    if start + size > len(content):
        return None
    values = struct.unpack_from(layout, content, start)
    if kind == ASCII:
        text: str = values[0].split(b"\0")[0].decode("utf-8", "replace")
        return "".join(character for character in text if character.isprintable()).strip()
    if is_rational:
        pairs = zip(values[0::2], values[1::2], strict=True)
        return tuple(above / below if below else math.nan for above, below in pairs)
    return tuple(float(value) for value in values)
