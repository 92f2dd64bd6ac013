"""Reading SPZ files of anybody's: nothing that a header says is believed before the file's length bears it out."""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np
from backports import zstd
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file
from reconstruction.exports import spz
from reconstruction.exports.component_parts import NO_PANEL, Ellipsoids
from reconstruction.exports.gaussian_blocks import Axes, turned
from reconstruction.exports.spz import (
    AT_ONCE_BYTES,
    COLOR_SCALE,
    GZIP,
    HEADER,
    LARGEST_SMALL,
    LEAST_LOG_SCALE,
    LOG_SCALE_STEPS,
    MAGIC,
    MAGNITUDES,
    MOST_FRACTION_BITS,
    OTHERS,
    STREAMS,
    Bytes,
    sizes_of,
)
from reconstruction.splats.harmonic_colour import N_HARMONICS

SPZ_FILE = FileLimit("a SPZ file", 2048 * MIB)

MOST_GAUSSIANS = 10_000_000
"""2.4 GB of them in memory; no viewer shows as many."""

MOST_DEFLATED, MOST_IN_FRAME = 1032, 1 << 15
"""To one byte, by deflate, and by ZSTD, of which a block of 128 KiB may take 4 bytes."""

MOST_AFTER = 1 << 20
"""Bytes of extensions, after the Gaussians or before the table of contents."""

HOW_TO_CONVERT = "save it as version 3 or 4, for example by `splat-transform FILE OTHER.spz`"


BACK: dict[Axes, Axes] = {"enu": "enu", "y-up": "y-down", "y-down": "y-up"}


def turned_back(ellipsoids: Ellipsoids, axes: Axes) -> Ellipsoids:
    """Gaussians in `axes`, told in ENU: the other axes are a quarter turn of the same size, the other way."""
    return turned(ellipsoids, BACK[axes])


def read_spz(path: Path, axes: Axes = "y-up") -> Ellipsoids:
    """Gaussians of a file of version 2 to 4, in ENU.

    Parameters
    ----------
    axes
        That the file is in.

    Raises
    ------
    InputError
        The file is missing, is no such file, says what it does not hold, or holds more than can be read.
    """
    with open_input_file(path, SPZ_FILE) as stream:
        size = os.fstat(stream.fileno()).st_size
        start = stream.read(4)
        stream.seek(0)
        if start == MAGIC:
            return turned_back(_read_frames(stream, size, path), axes)
        if start[:2] != b"\x1f\x8b":
            raise InputError(f"{path}: is no SPZ file (it does not start like one)")
        return turned_back(_read(_Inflated(stream, path), size, path), axes)


class _Inflated:
    """A gzip stream that gives as many bytes as it is asked for, and no more."""

    def __init__(self, stream: BinaryIO, path: Path) -> None:
        self._stream, self._path = stream, path
        self._inflater = zlib.decompressobj(GZIP)
        self._waiting = b""

    def take(self, n: int) -> bytearray:
        """The next `n` bytes."""
        found = bytearray()
        while len(found) < n:
            piece = self._next(min(n - len(found), AT_ONCE_BYTES))
            if not piece:
                raise InputError(f"{self._path}: ends too early; it is cut off or damaged")
            found += piece
        return found

    def end(self) -> None:
        """Come to the end, where the checksum is, past a little that is not known."""
        n = 0
        while piece := self._next(AT_ONCE_BYTES):
            n += len(piece)
            if n > MOST_AFTER:
                raise InputError(f"{self._path}: goes on for more than {MOST_AFTER} bytes after its Gaussians")
        if not self._inflater.eof:
            raise InputError(f"{self._path}: ends too early; it is cut off or damaged")

    def _next(self, most: int) -> bytes:
        try:
            while not self._inflater.eof:
                if not self._waiting:
                    self._waiting = self._stream.read(1 << 16)
                before = len(self._waiting)
                piece = self._inflater.decompress(self._waiting, most)
                self._waiting = self._inflater.unconsumed_tail
                if piece:
                    return piece
                if before == 0:
                    return b""
        except zlib.error as error:
            raise InputError(f"{self._path}: is damaged ({error})") from error
        return b""


def _read(inflated: _Inflated, size: int, path: Path) -> Ellipsoids:
    magic, version, n, degree, fraction, _, _ = HEADER.unpack(inflated.take(HEADER.size))
    if magic != MAGIC:
        raise InputError(f"{path}: is no SPZ file (there is something else in its gzip stream)")
    if version not in (2, 3):
        raise InputError(f"{path}: expected SPZ of version 2 or 3, found {version}; {HOW_TO_CONVERT}")
    sizes = _checked_sizes(version, n, degree, fraction, MOST_DEFLATED * size - HEADER.size, size, path)
    streams: dict[str, Bytes] = {}
    for name in STREAMS:
        values = np.frombuffer(inflated.take(n * sizes[name]), np.uint8)
        streams[name] = values.reshape(n, sizes[name])
    inflated.end()
    return unpacked(streams, fraction, degree, version)


def _read_frames(stream: BinaryIO, size: int, path: Path) -> Ellipsoids:
    """A file of version 4."""
    header = stream.read(spz.ZSTD_HEADER.size)
    if len(header) < spz.ZSTD_HEADER.size:
        raise InputError(f"{path}: ends too early; it is cut off or damaged")
    _, version, n, degree, fraction, _, n_streams, table_at = spz.ZSTD_HEADER.unpack(header)
    if version != spz.VERSION:
        raise InputError(f"{path}: expected SPZ of version 2 to 4, found {version}; {HOW_TO_CONVERT}")
    sizes = _checked_sizes(version, n, degree, fraction, MOST_IN_FRAME * size, size, path)
    names = [name for name in STREAMS if sizes[name]]
    if n_streams != len(names) or not spz.ZSTD_HEADER.size <= table_at <= spz.ZSTD_HEADER.size + MOST_AFTER:
        raise InputError(f"{path}: has {n_streams} streams from byte {table_at} on; expected {len(names)} from 32 on")
    stream.seek(table_at)
    table = stream.read(n_streams * spz.ENTRY.size)
    if len(table) < n_streams * spz.ENTRY.size:
        raise InputError(f"{path}: ends too early; it is cut off or damaged")
    entries = list(spz.ENTRY.iter_unpack(table))
    if table_at + len(table) + sum(packed for packed, _ in entries) != size:
        raise InputError(f"{path}: its streams do not end where it does; it is cut off or damaged")
    streams: dict[str, Bytes] = {"sh": np.zeros((n, 0), np.uint8)}
    for name, (packed, wanted) in zip(names, entries, strict=True):
        if wanted != n * sizes[name]:
            raise InputError(f"{path}: has {wanted} bytes of {name}; expected {n * sizes[name]}")
        values = np.frombuffer(_unpacked_frame(stream.read(packed), wanted, path), np.uint8)
        streams[name] = values.reshape(n, sizes[name])
    return unpacked(streams, fraction, degree, version)


def _unpacked_frame(frame: bytes, wanted: int, path: Path) -> bytes:
    """What a frame holds, which is so many bytes, and no more of it in memory."""
    decompressor = zstd.ZstdDecompressor()
    try:
        # One more is asked for, so that the end is come to, and more than there should be is noticed.
        found = decompressor.decompress(frame, wanted + 1)
    except zstd.ZstdError as error:
        raise InputError(f"{path}: is damaged ({error})") from error
    if len(found) != wanted or not decompressor.eof or decompressor.unused_data:
        raise InputError(f"{path}: a stream holds more or less than it says; it is cut off or damaged")
    return found


def _checked_sizes(
    version: int, n: int, degree: int, fraction: int, most: int, size: int, path: Path
) -> dict[str, int]:
    """Bytes of a Gaussian in each stream, after what a header says was looked at.

    Parameters
    ----------
    most
        Bytes that all of them can be unpacked to.
    size
        Of the file.
    """
    if degree > 3:
        raise InputError(f"{path}: has colours of degree {degree}; 0 to 3 are read")
    if fraction > MOST_FRACTION_BITS:
        raise InputError(f"{path}: has {fraction} bits after the binary point; expected 0 to {MOST_FRACTION_BITS}")
    sizes = sizes_of(degree, version)
    if n == 0 or n * sum(sizes.values()) > most:
        raise InputError(f"{path}: says that it has {n} Gaussians; the file's {size} bytes cannot hold them")
    if n > MOST_GAUSSIANS:
        raise InputError(f"{path}: has {n} Gaussians; at most {MOST_GAUSSIANS} are read")
    return sizes


def unpacked(streams: dict[str, Bytes], fraction: int, degree: int, version: int) -> Ellipsoids:
    """Gaussians of streams, in the file's axes."""
    n = len(streams["alphas"])
    wide = np.zeros((n, 3, 4), np.uint8)
    wide[:, :, 1:] = streams["positions"].reshape(n, 3, 3)
    fixed = wide.view("<i4").reshape(n, 3) >> 8  # brings the sign along
    sh = np.zeros((n, N_HARMONICS, 3), np.float32)
    sh[:, 0] = (streams["colors"] / np.float32(255.0) - np.float32(0.5)) / np.float32(COLOR_SCALE)
    rest = (streams["sh"].astype(np.float32) - 128.0) / 128.0
    sh[:, 1 : (degree + 1) ** 2] = rest.reshape(n, -1, 3)
    quats = _first_three(streams["rotations"]) if version == 2 else _smallest_three(streams["rotations"])
    return Ellipsoids(
        (fixed * 2.0**-fraction).astype(np.float32),
        quats,
        np.exp(streams["scales"].astype(np.float32) / np.float32(LOG_SCALE_STEPS) + np.float32(LEAST_LOG_SCALE)),
        streams["alphas"][:, 0].astype(np.float32) / np.float32(255.0),
        sh,
        np.full(n, NO_PANEL, np.int32),
    )


def _smallest_three(rotations: Bytes) -> NDArray[np.float32]:
    """Quaternions w, x, y, z with w >= 0."""
    found = np.ascontiguousarray(rotations).view("<u4")[:, 0]
    largest = (found >> np.uint32(30)).astype(np.int64)
    parts = np.stack([found >> np.uint32(20), found >> np.uint32(10), found], axis=1)
    sizes = (parts & np.uint32(MAGNITUDES)).astype(np.float64) * (LARGEST_SMALL / MAGNITUDES)
    others = np.where(parts & np.uint32(512), -sizes, sizes)
    xyzw = np.zeros((len(found), 4))
    np.put_along_axis(xyzw, OTHERS[largest], others, axis=1)
    rest = np.sqrt(np.maximum(0.0, 1.0 - (others**2).sum(axis=1)))
    np.put_along_axis(xyzw, largest[:, None], rest[:, None], axis=1)
    return _unit(xyzw)


def _first_three(rotations: Bytes) -> NDArray[np.float32]:
    """As version 2 has them: x, y, z in 8 bits each, w >= 0 the rest."""
    xyz = rotations / 127.5 - 1.0
    w = np.sqrt(np.maximum(0.0, 1.0 - (xyz**2).sum(axis=1)))
    return _unit(np.column_stack([xyz, w]))


def _unit(xyzw: NDArray[np.float64]) -> NDArray[np.float32]:
    found = xyzw[:, [3, 0, 1, 2]] / np.linalg.norm(xyzw, axis=1, keepdims=True)
    return np.asarray(np.where(found[:, :1] < 0.0, -found, found), np.float32)
