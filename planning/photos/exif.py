"""EXIF: the tags that we use, out of a TIFF structure in either byte order (CIPA DC-008).

The structure comes from strangers: entries that are damaged, point outside or hold more than such a tag can are left
out, one by one, and only the tags asked for are decoded, so that nothing in it can cost time or memory.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping
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
    PIXEL_X_DIMENSION = 0xA002
    FOCAL_PLANE_X_RESOLUTION = 0xA20E
    FOCAL_PLANE_RESOLUTION_UNIT = 0xA210
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


# EXIF written: a TIFF structure of the tags that `planning.photos.exif` reads (CIPA DC-008).

BYTE, SHORT, LONG = 1, 3, 4

Ratio = tuple[int, int]

Content = str | bytes | int | tuple[Ratio, ...]
"""What a tag holds: text, bytes, a whole number up to 65535, or ratios of two whole numbers below 2**32."""

IN_FIRST_PART = frozenset({Tag.MAKE, Tag.MODEL, Tag.ORIENTATION})
"""Tags about the picture; all others but those of the GPS part are about the shot, and stand in a part of their own."""

HEADER = b"II*\0" + struct.pack("<I", 8)
"""Little-endian; the first part follows at once."""


def exif_content(tags: Mapping[Tag, Content]) -> bytes:
    """The TIFF structure with `tags`, without the name that a JPEG segment puts in front of it."""
    first = {int(tag): content for tag, content in tags.items() if tag in IN_FIRST_PART}
    shot = {int(tag): content for tag, content in tags.items() if tag not in IN_FIRST_PART and tag < GPS_BASE}
    place = {tag - GPS_BASE: content for tag, content in tags.items() if tag >= GPS_BASE}
    n_pointers = bool(shot) + bool(place)
    start = len(HEADER)
    end = start + len(_part(first, start, {})) + 12 * n_pointers
    pointers, parts = {}, b""
    for pointer, part in ((EXIF_POINTER, shot), (GPS_POINTER, place)):
        if part:
            pointers[pointer] = end + len(parts)
            parts += _part(part, pointers[pointer], {})
    return HEADER + _part(first, start, pointers) + parts


def _part(tags: Mapping[int, Content], start: int, pointers: Mapping[int, int]) -> bytes:
    """One directory that begins at `start`: entries in the order of their numbers, then what does not fit in them."""
    coded = {number: _coded(content) for number, content in tags.items()}
    coded |= {number: (LONG, 1, struct.pack("<I", at)) for number, at in pointers.items()}
    entries, rest = struct.pack("<H", len(coded)), b""
    after = start + 2 + 12 * len(coded) + 4
    for number, (kind, count, content) in sorted(coded.items()):
        entries += struct.pack("<HHI", number, kind, count)
        if len(content) <= 4:
            entries += content.ljust(4, b"\0")
        else:
            entries += struct.pack("<I", after + len(rest))
            # Values begin at even places.
            rest += content + b"\0" * (len(content) % 2)
    return entries + struct.pack("<I", 0) + rest


def _coded(content: Content) -> tuple[int, int, bytes]:
    """Type, number of values and bytes."""
    if isinstance(content, str):
        text = content.encode("ascii") + b"\0"
        return ASCII, len(text), text
    if isinstance(content, bytes):
        return BYTE, len(content), content
    if isinstance(content, int):
        return SHORT, 1, struct.pack("<H", content)
    return RATIONAL, len(content), b"".join(struct.pack("<II", above, below) for above, below in content)
