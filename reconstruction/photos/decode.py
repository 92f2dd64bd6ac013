"""Photos as grey pictures, at a reduced scale where wanted, with limits on what a file may cost.

A JPEG file can be decoded at 1/2, 1/4 or 1/8 of its size for less work, because its blocks of 8 x 8 pixels are stored
as frequencies. EXIF's orientation is left out of account: pixels stay where the camera's intrinsics have them.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_input_file
from planning.base.jit import inline, kernel
from planning.base.messages import say
from planning.photos.jpeg import JPEG_START, MAX_STRAY_BYTES, PHOTO_FILE, PNG_START, kind_of
from planning.photos.record import PhotoMetadata

# What is wrong with a picture is said in an error, and once.
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)

Scale = Literal[1, 2, 4, 8]
"""The picture is decoded at one part in so many of its width and height."""

FLAGS: dict[Scale, int] = {
    1: cv2.IMREAD_GRAYSCALE,
    2: cv2.IMREAD_REDUCED_GRAYSCALE_2,
    4: cv2.IMREAD_REDUCED_GRAYSCALE_4,
    8: cv2.IMREAD_REDUCED_GRAYSCALE_8,
}

COLOUR_FLAGS: dict[Scale, int] = {
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

NAMED = {
    ".jpg": "JPEG",
    ".jpeg": "JPEG",
    ".png": "PNG",
    ".tif": "TIFF",
    ".tiff": "TIFF",
    ".webp": "WebP",
    ".bmp": "BMP",
}
"""Kinds of pictures by the endings of their names."""

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
    return _picture(photo, FLAGS, scale)


def colour_picture(photo: PhotoMetadata, scale: Scale = 1) -> NDArray[np.uint8]:
    """The picture, shape (h, w, 3), blue, green, red; scale and errors as in `grey_picture`."""
    return _picture(photo, COLOUR_FLAGS, scale)


def whole_content(photo: PhotoMetadata) -> bytes:
    """The content of a photo's file, all of whose picture is there.

    Raises
    ------
    InputError
        As `grey_picture`, but for headers that the decoder alone finds fault with.
    """
    place = str(photo.path)
    _check_size((photo.width_px, photo.height_px), place, MAX_PIXELS)
    content = read_input_file(photo.path, PHOTO_FILE)
    if not photo.is_complete:
        raise InputError(
            say("the file was cut off, so that part of the picture is missing; copy it again", place=place)
        )
    check_whole(content, place)
    return content


def is_named_rightly(content: bytes, path: Path) -> bool:
    """Whether a file is of the kind of picture that its name says."""
    return kind_of(content[:12]) == NAMED.get(path.suffix.lower())


def _picture(photo: PhotoMetadata, flags: Mapping[Scale, int], scale: Scale) -> NDArray[np.uint8]:
    content, place = whole_content(photo), str(photo.path)
    is_jpeg = content.startswith(JPEG_START)
    picture = decoded(content, flags[scale if is_jpeg else 1] | cv2.IMREAD_IGNORE_ORIENTATION, place)
    expected = -(-photo.height_px // scale), -(-photo.width_px // scale)
    if not is_jpeg and picture.shape[:2] == (photo.height_px, photo.width_px):
        picture = cv2.resize(picture, expected[::-1], interpolation=cv2.INTER_AREA)  # only JPEG is decoded at a part
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


MASK_THRESHOLD = 0.5
"""Share of white from which a pixel of a mask counts."""


def read_mask(path: Path) -> NDArray[np.bool_]:
    """A mask, shape (h, w), of a picture of 0 and 1, 0 and 255, or shares over the whole range of 8 or 16 bit.

    Raises
    ------
    InputError
        There is none, it cannot be decoded, or it is no mask.
    """
    values = decoded(read_input_file(path, PICTURE_FILE), cv2.IMREAD_UNCHANGED, str(path))
    if values.dtype not in (np.uint8, np.uint16):
        raise InputError(say("expected an image of 8 or 16 bit, found {}", values.dtype, place=path))
    if values.ndim == 3:
        colours = values[..., :3]
        if (colours != colours[..., :1]).any():
            raise InputError(
                say("expected a grey mask, found colours; write what counts as white on black", place=path)
            )
        values = colours[..., 0]
    highest = int(values.max(initial=0))
    full = 1 if highest <= 1 else int(np.iinfo(values.dtype).max)
    return np.asarray(values >= MASK_THRESHOLD * full)


def mask_of_size(path: Path, width_px: int, height_px: int) -> NDArray[np.bool_]:
    """Which pixels of a picture of a size count by its mask, shape (h, w).

    Raises
    ------
    InputError
        The mask cannot be read, has another shape than the picture, or leaves nothing of it.
    """
    mask = read_mask(path)
    height, width = mask.shape
    if abs(height - height_px * width / width_px) > 1.0:
        raise InputError(
            say("has {} x {} pixels, and the photo's camera {} x {}", *(width, height, width_px, height_px), place=path)
        )
    if not mask.any():
        raise InputError(say("is black everywhere", place=path))
    return resized_mask(mask, width_px, height_px)


def resized_mask(mask: NDArray[np.bool_], width_px: int, height_px: int) -> NDArray[np.bool_]:
    """A mask of a size, each pixel with the value of the nearest one."""
    if mask.shape == (height_px, width_px):
        return mask
    resized = cv2.resize(mask.astype(np.uint8), (width_px, height_px), interpolation=cv2.INTER_NEAREST_EXACT)
    return np.asarray(resized, bool)


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


# Whether all of a JPEG file's picture is there.
#
# Of a card with a bad sector, a file keeps its header and its end, and the decoder goes on over the damage: half of the
# picture is grey or shifted, and nobody is told. So the codes of a sequential picture (ITU-T T.81, F.2.2) are read
# once, without making a picture of them: they have to give all of its units, and to end where these do.

HUFFMAN_FRAMES = (0xC0, 0xC1)
"""Sequential frames with Huffman codes, which cameras write; others are decoded as they are."""

DHT, DRI, SOS, RST0 = 0xC4, 0xDD, 0xDA, 0xD0

SHORT_BITS = 9
"""Codes up to this length are looked up at once; nearly all are."""

MOST_LEFT_BYTES = 8
"""Behind the last unit: of 808 public photos that are whole one leaves a byte there, all others none."""

Codes = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32], NDArray[np.uint8]]
"""Of eight Huffman tables, four for constant parts and four for others: what short codes mean, as `length << 8 |
symbol`; the last code of each length; what is added to a code of each length for its place among the symbols; these."""


@dataclass(frozen=True, slots=True, eq=False)
class _Scan:
    """Codes of a picture in one sequential scan.

    Parameters
    ----------
    start
        Place of the first code in the file.
    tables
        For the constant and the other parts of each block of a unit, shape (n_blocks, 2).
    n_units
        Of the picture, the smallest parts that repeat.
    restart
        Units between two restart markers; 0 for none.
    """

    start: int
    codes: Codes
    tables: NDArray[np.int64]
    n_units: int
    restart: int


def check_whole(content: bytes, place: str) -> None:
    """Refuse a JPEG file whose picture is spoiled on the way; whatever is no such file passes.

    Raises
    ------
    InputError
        Codes of the picture are missing or make no sense.
    """
    scan = _scan_of(content) if content.startswith(JPEG_START) else None
    if scan is None:
        return
    data = np.frombuffer(content, np.uint8)
    if not is_whole(data, scan.start, scan.codes, scan.tables, scan.n_units, scan.restart):
        raise InputError(say("a part of the picture is damaged; copy the file again, and check the card", place=place))


def _scan_of(content: bytes) -> _Scan | None:
    """The codes of a picture; None of other kinds of pictures, and of headers that the decoder refuses by itself."""
    codes: Codes = (
        np.zeros((8, 1 << SHORT_BITS), np.int32),
        np.full((8, 17), -1, np.int32),
        np.zeros((8, 17), np.int32),
        np.zeros((8, 256), np.uint8),
    )
    size_hw, samplings, restart = (0, 0), dict[int, tuple[int, int]](), 0
    at, n_stray = 2, 0
    while at + 4 <= len(content) and n_stray <= MAX_STRAY_BYTES:
        marker = content[at + 1]
        if content[at] != 0xFF or marker in (0x00, 0xFF):
            at, n_stray = at + 1, n_stray + 1
            continue
        length = int.from_bytes(content[at + 2 : at + 4], "big")
        part = content[at + 4 : at + 2 + length]
        at += 2 + length
        if marker in HUFFMAN_FRAMES and len(part) >= 6 and len(part) >= 6 + 3 * part[5]:
            size_hw = int.from_bytes(part[1:3], "big"), int.from_bytes(part[3:5], "big")
            samplings = {part[k]: (part[k + 1] >> 4, part[k + 1] & 15) for k in range(6, 6 + 3 * part[5], 3)}
        elif marker == DHT and not _take_up(part, codes):
            return None
        elif marker == DRI and len(part) == 2:
            restart = int.from_bytes(part, "big")
        elif marker == SOS:
            return _scan(part, at, codes, size_hw, samplings, restart)
    return None


def _scan(
    part: bytes,
    start: int,
    codes: Codes,
    size_hw: tuple[int, int],
    samplings: dict[int, tuple[int, int]],
    restart: int,
) -> _Scan | None:
    """The scan that a SOS segment opens, of a frame's size and samplings; None where it does not hold all of them."""
    n = part[0] if part else 0
    named = {part[k]: (part[k + 1] >> 4, 4 + (part[k + 1] & 15)) for k in range(1, min(1 + 2 * n, len(part) - 1), 2)}
    if not named or named.keys() != samplings.keys() or not all(map(all, samplings.values())):
        return None
    if any(
        constant > 3 or other > 7 or (codes[1][[constant, other]] < 0).all(axis=1).any()
        for constant, other in named.values()
    ):
        return None
    wide, high = (max(each) if n > 1 else 1 for each in zip(*samplings.values(), strict=True))
    n_blocks = {name: across * down if n > 1 else 1 for name, (across, down) in samplings.items()}
    tables = [each for name, each in named.items() for _ in range(n_blocks[name])]
    n_units = -(-size_hw[0] // (8 * high)) * -(-size_hw[1] // (8 * wide))
    return _Scan(start, codes, np.array(tables, np.int64), n_units, restart)


def _take_up(part: bytes, codes: Codes) -> bool:
    """Take up the Huffman tables of a DHT segment (annex C, F.2.2.3); whether it holds some."""
    short, last, added, symbols = codes
    at = 0
    while at + 17 <= len(part):
        kind, number, counts = part[at] >> 4, part[at] & 15, part[at + 1 : at + 17]
        values = part[at + 17 : at + 17 + sum(counts)]
        if kind > 1 or number > 3 or len(values) != sum(counts) or len(values) > symbols.shape[1]:
            return False
        table, code, k = 4 * kind + number, 0, 0
        short[table], last[table] = 0, -1
        symbols[table, : len(values)] = np.frombuffer(values, np.uint8)
        for length, count in enumerate(counts, 1):
            if code + count > 1 << length:
                return False
            added[table, length] = k - code
            if length <= SHORT_BITS:
                share = 1 << SHORT_BITS - length
                for symbol in values[k : k + count]:
                    short[table, code * share : (code + 1) * share] = length << 8 | symbol
                    code += 1
            else:
                code += count
            if count:
                last[table, length] = code - 1
            code, k = code << 1, k + count
        at += 17 + len(values)
    return at == len(part)


@inline
def _symbol(bits: Any, table: Any, codes: Any) -> Any:
    """Symbol and length of the code that 16 bits begin with, as `length << 8 | symbol`; 0 for none."""
    short, last, added, symbols = codes
    found = np.int64(short[table, bits >> (16 - SHORT_BITS)])
    if found == 0:
        for length in range(SHORT_BITS + 1, 17):
            code = bits >> (16 - length)
            if code <= last[table, length]:
                found = np.int64(length << 8) | np.int64(symbols[table, added[table, length] + code])
                break
    return found


@kernel
def is_whole(
    data: NDArray[np.uint8], start: int, codes: Codes, tables: NDArray[np.int64], n_units: int, restart: int
) -> bool:
    """Whether the codes of a picture give all of its units, and end with them; see `_Scan`.

    Bits are read from the left into a store of up to 56. A zero behind 0xFF belongs to it, anything else is a marker.
    """
    at, end = start, len(data)
    held, n_held = np.int64(0), 0
    for unit in range(n_units):
        if restart > 0 and unit > 0 and unit % restart == 0:
            while at + 1 < end and data[at] == 0xFF and data[at + 1] == 0xFF:
                at += 1
            if at + 1 >= end or data[at] != 0xFF or data[at + 1] != RST0 + (unit // restart - 1) % 8:
                return False
            at, held, n_held = at + 2, np.int64(0), 0
        for block in range(len(tables)):
            k = 0
            while k < 64:
                while n_held <= 48 and at < end:
                    byte = np.int64(data[at])
                    if byte == 0xFF:
                        if at + 1 >= end or data[at + 1] != 0:
                            break
                        at += 1
                    at += 1
                    held, n_held = (held << 8 | byte) & 0xFFFFFFFFFFFFFF, n_held + 8
                bits = (held >> (n_held - 16) if n_held >= 16 else held << (16 - n_held)) & 0xFFFF
                found = _symbol(bits, tables[block, 0 if k == 0 else 1], codes)
                run, n_more = (0, found & 0xFF) if k == 0 else (found >> 4 & 15, found & 15)
                n_held -= (found >> 8) + n_more
                if found == 0 or n_more > 16 or n_held < 0 or k + run > 63:
                    return False
                if k > 0 and n_more == 0 and run < 15:
                    break
                k += run + 1
    left = at
    while left + 1 < end and (data[left] != 0xFF or data[left + 1] == 0):
        left += 1
    return left - at + n_held // 8 <= MOST_LEFT_BYTES
