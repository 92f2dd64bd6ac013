"""EXIF written: a TIFF structure of the tags that `planning.photos.exif` reads (CIPA DC-008)."""

from __future__ import annotations

import struct
from collections.abc import Mapping

from planning.photos.exif import ASCII, EXIF_POINTER, GPS_BASE, GPS_POINTER, RATIONAL, Tag

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
