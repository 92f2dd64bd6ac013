"""The header of a JPEG file: picture size, and the EXIF and XMP parts in it (ITU-T T.81 annex B, XMP part 3, 1.1.3).

Programs write PNG files under such names, so the content counts (PNG, third edition, 11.3.2.4; XMP part 3, 1.1.5).
Only the header is read, and no picture is ever decoded: neither large dimensions nor hostile data cost anything.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file
from planning.base.messages import say

PHOTO_FILE = FileLimit(say("a photo"), 512 * MIB)
"""Panoramas of drones have up to 100 MiB."""

SOI, EOI, SOS, APP1 = 0xD8, 0xD9, 0xDA, 0xE1
SIZE_MARKERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Frame headers, which hold the picture's size; the three left out are tables and a reserved marker."""

NO_MARKERS = frozenset((0x00, 0xFF))
WITHOUT_LENGTH = frozenset(range(0xD0, 0xD8)) | {0x01}

EXIF = b"Exif\0\0"
XMP = b"http://ns.adobe.com/xap/1.0/\0"
EXTENDED_XMP = b"http://ns.adobe.com/xmp/extension/\0"

MAX_SEGMENTS = 4096
"""Thermal cameras store raw data in some 60 segments of 64 KiB each."""

MAX_EXTENDED_BYTES = 4 * 2**20
"""Larger extended XMP holds depth maps and the like, and nothing of a flight."""

MAX_FILL_BYTES = 1024
"""Between two segments; any number is allowed, and none is usual."""

MAX_STRAY_BYTES = 65536
"""Between all segments of a header, which belong to none: some programs leave the rest of a longer part there."""

JPEG_START, PNG_START = b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n"

PNG_XMP = b"XML:com.adobe.xmp\0\0\0"
"""Before a packet that is not compressed; language and translated keyword follow, empty."""

MAX_CHUNKS, MAX_PNG_PART_BYTES = 2**17, 2**24
"""Of a PNG file: a picture of 512 MiB may be in parts of 8 KiB; and of one part that is read."""

KINDS = {JPEG_START: "JPEG", PNG_START: "PNG", b"II*\0": "TIFF", b"MM\0*": "TIFF", b"BM": "BMP", b"GIF8": "GIF"}
BOXES = {b"heic": "HEIC", b"heix": "HEIC", b"mif1": "HEIC", b"msf1": "HEIC", b"avif": "AVIF"}
LFS_POINTER = b"version https://git-lfs"

CHUNK_BYTES = 65536

MAX_SEARCHED_BYTES = 64 * 2**20
"""From the file's end on; more than any photo has."""


def kind_of(start: bytes) -> str | None:
    """What kind of picture a file is by its first 12 bytes or more; None for none that is known."""
    if start.startswith(b"RIFF") and start[8:12] == b"WEBP":
        return "WebP"
    if start[4:8] == b"ftyp":
        return BOXES.get(start[8:12])
    return next((kind for head, kind in KINDS.items() if start.startswith(head)), None)


@dataclass(frozen=True, slots=True)
class PhotoHeader:
    """What the header holds.

    Parameters
    ----------
    width_px, height_px
        Of the picture as it is stored.
    exif
        The TIFF structure of the EXIF part; None without one.
    xmp
        Packets of XMP: the main one, then the extended one where it is whole.
    is_complete
        Whether an end of the picture was found; False for files that were cut off.
    """

    width_px: int
    height_px: int
    exif: bytes | None
    xmp: tuple[bytes, ...]
    is_complete: bool


def read_header(path: Path) -> PhotoHeader:
    """Header of a JPEG file, or of a PNG file, whatever its name.

    Raises
    ------
    InputError
        The file is missing, unreadable, neither of both, or its header is cut off.
    """
    with open_input_file(path, PHOTO_FILE) as file:
        return _header(file, str(path))


@dataclass(slots=True)
class _Parts:
    """What was found so far; `extended` holds pieces by their identifier, each with its place and the whole's size."""

    size_px: tuple[int, int] | None = None
    exif: bytes | None = None
    xmp: bytes | None = None
    extended: dict[bytes, list[tuple[int, int, bytes]]] = field(default_factory=dict)
    n_extended_bytes: int = 0


def _header(file: BinaryIO, label: str) -> PhotoHeader:
    start = file.read(len(LFS_POINTER))
    if start.startswith(PNG_START):
        return _png_header(file, label)
    if not start.startswith(bytes((0xFF, SOI))):
        raise _no_photo(start, label)
    file.seek(2)
    parts = _Parts()
    for marker, length in _segments(file, label):
        if marker in SIZE_MARKERS and parts.size_px is None:
            frame = _read(file, min(length, 5), label)
            if len(frame) == 5:
                parts.size_px = int.from_bytes(frame[3:5], "big"), int.from_bytes(frame[1:3], "big")
        elif marker == APP1:
            _keep(parts, _read(file, length, label))
    if parts.size_px is not None and 0 in parts.size_px:
        width, height = parts.size_px
        raise InputError.say(
            "claims to be a picture of {} x {} pixels, so there is none in it; copy it from the card again",
            width,
            height,
            place=label,
        )
    if parts.size_px is None:
        raise InputError.say("the JPEG file holds no picture; copy it from the card again", place=label)
    packets = tuple(packet for packet in (parts.xmp, _extended(parts)) if packet is not None)
    return PhotoHeader(*parts.size_px, parts.exif, packets, _has_end(file))


def _no_photo(start: bytes, label: str) -> InputError:
    """The error about a file that has the name of a photo, and is none."""
    kind = kind_of(start)
    if kind is not None:
        return InputError.say(
            "is a picture of the kind {} with the name of a JPEG file; save it as JPEG, with all that the camera wrote "
            "into it",
            kind,
            place=label,
        )
    if start.startswith(LFS_POINTER):
        return InputError.say(
            "is a pointer of Git LFS in the place of the photo; get it by 'git lfs pull'", place=label
        )
    return InputError.say("is no JPEG file; only .jpg photos as the camera wrote them can be read", place=label)


def _png_header(file: BinaryIO, label: str) -> PhotoHeader:
    file.seek(len(PNG_START))
    size_px: tuple[int, int] | None = None
    exif: bytes | None = None
    xmp: bytes | None = None
    is_complete = False
    for _ in range(MAX_CHUNKS):
        head = file.read(8)
        if len(head) < 8:
            break
        length, kind, at = int.from_bytes(head[:4], "big"), head[4:], file.tell()
        if kind == b"IEND":
            is_complete = True
            break
        if kind == b"IHDR" and size_px is None:
            sides = _read(file, 8, label)
            size_px = int.from_bytes(sides[:4], "big"), int.from_bytes(sides[4:], "big")
        elif kind == b"eXIf" and exif is None and length <= MAX_PNG_PART_BYTES:
            exif = _read(file, length, label)
        elif kind == b"iTXt" and xmp is None and length <= MAX_PNG_PART_BYTES:
            text = _read(file, length, label)
            xmp = text[len(PNG_XMP) :].lstrip(b"\0") if text.startswith(PNG_XMP) else None
        file.seek(at + length + 4)
    if size_px is None or 0 in size_px:
        raise InputError.say("the PNG file holds no picture; copy it from the card again", place=label)
    return PhotoHeader(*size_px, exif, () if xmp is None else (xmp,), is_complete)


def _segments(file: BinaryIO, label: str) -> Iterator[tuple[int, int]]:
    """Marker and number of content bytes of each segment up to the picture; whatever is not read is skipped."""
    n_left = MAX_STRAY_BYTES
    for number in range(MAX_SEGMENTS):
        marker, n_stray = _next_marker(file, n_left if number else 0, label)
        n_left -= n_stray
        if marker in WITHOUT_LENGTH:
            continue
        if marker in (SOS, EOI):
            return
        length = int.from_bytes(_read(file, 2, label), "big") - 2
        if length < 0:
            raise _damaged(label)
        after = file.tell() + length
        yield marker, length
        file.seek(after)
    raise InputError.say("the JPEG header has more than {} parts; refused as hostile", MAX_SEGMENTS, place=label)


def _next_marker(file: BinaryIO, n_most: int, label: str) -> tuple[int, int]:
    """The next marker, and the number of bytes before it that belong to nothing: decoders skip those, too."""
    n_stray, n_fill = 0, 0
    after_fill = False
    while n_stray <= n_most and n_fill <= MAX_FILL_BYTES:
        byte = _read(file, 1, label)[0]
        if byte == 0xFF:
            n_fill, after_fill = n_fill + after_fill, True
        elif after_fill and byte not in NO_MARKERS:
            return byte, n_stray
        else:
            n_stray, n_fill, after_fill = n_stray + 1 + after_fill, 0, False
    raise _damaged(label)


def _damaged(label: str) -> InputError:
    return InputError.say("the header of the JPEG file is damaged; copy it from the card again", place=label)


def _read(file: BinaryIO, n: int, label: str) -> bytes:
    content = file.read(n)
    if len(content) < n:
        raise InputError.say("the file ends in its header; copy it from the card again", place=label)
    return content


def _keep(parts: _Parts, content: bytes) -> None:
    """Keep what an APP1 segment holds; the first of a kind counts."""
    if content.startswith(EXIF):
        parts.exif = content[len(EXIF) :] if parts.exif is None else parts.exif
    elif content.startswith(XMP):
        parts.xmp = content[len(XMP) :] if parts.xmp is None else parts.xmp
    elif content.startswith(EXTENDED_XMP):
        body = content[len(EXTENDED_XMP) :]
        parts.n_extended_bytes += len(body)
        if len(body) > 40 and parts.n_extended_bytes <= MAX_EXTENDED_BYTES:
            size, offset = int.from_bytes(body[32:36], "big"), int.from_bytes(body[36:40], "big")
            parts.extended.setdefault(body[:32], []).append((offset, size, body[40:]))


def _extended(parts: _Parts) -> bytes | None:
    """The extended packet that the main one names; None where there is none or a piece of it is missing."""
    for identifier, pieces in parts.extended.items():
        if parts.xmp is None or identifier not in parts.xmp:
            continue
        in_order, size = [], 0
        for offset, _, piece in sorted(pieces):
            if offset == size:
                in_order.append(piece)
                size += len(piece)
        if size == pieces[0][1]:
            return b"".join(in_order)
    return None


def _has_end(file: BinaryIO) -> bool:
    """Whether the picture ends; searched for from the file's end on, where it is in whole files."""
    start, end = file.tell(), file.seek(0, os.SEEK_END)
    start, following = max(start, end - MAX_SEARCHED_BYTES), b""
    while end > start:
        begin = max(start, end - CHUNK_BYTES)
        file.seek(begin)
        content = file.read(end - begin)
        if bytes((0xFF, EOI)) in content + following:
            return True
        end, following = begin, content[:1]
    return False
