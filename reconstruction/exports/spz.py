"""SPZ files (Niantic): Gaussians in few bytes each, all in one gzip stream (version 3) or by kinds in ZSTD (version 4).

Nearly everything that reads SPZ reads version 3. Version 4 is a little smaller; PlayCanvas' engine reads it
alone. The format has neither panels nor origin: places count from the scene's `origin_enu_m`.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from backports import zstd
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import Ellipsoids, check_scene
from reconstruction.exports.compression import PRESETS, Compressed, Compression
from reconstruction.exports.gaussian_blocks import (
    Axes,
    are_discs,
    blocks_of,
    expect_some,
    is_antialiased,
    log_scales,
    morton_order,
    n_gaussians,
)
from reconstruction.objects.gs_scene import GsScene
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID

# Gaussians in the bytes of SPZ (Niantic, version 3), and back.
#
# Places are fixed-point numbers of 24 bits, sizes logarithms in steps of 1/16, rotations the three smallest
# components of
# a quaternion in 10 bits each, opacities and colours 8 bits. Names of streams are the format's.

Bytes = NDArray[np.uint8]

STREAMS = ("positions", "alphas", "colors", "scales", "rotations", "sh")
"""In the file's order."""

MOST_FRACTION_BITS = 24
"""Steps of 60 nm; readers need not take more."""

LARGEST_FIXED = (1 << 23) - 1

COLOR_SCALE = 0.15
"""Of coefficients of degree 0; colours of -0.44 to 1.44 as display values can be told."""

LEAST_LOG_SCALE, LOG_SCALE_STEPS = -10.0, 16.0

MOST_LOG_SCALE = LEAST_LOG_SCALE + 255.0 / LOG_SCALE_STEPS

LARGEST_SMALL = math.sqrt(0.5)
"""Of a unit quaternion's components but the largest."""

MAGNITUDES = 511

OTHERS = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
"""Components beside the largest."""


def sizes_of(degree: int, version: int = 3) -> dict[str, int]:
    """Bytes of a Gaussian in each stream."""
    sizes = {"positions": 9, "alphas": 1, "colors": 3, "scales": 3, "rotations": 3 if version == 2 else 4}
    return sizes | {"sh": 3 * ((degree + 1) ** 2 - 1)}


def fraction_bits(furthest_m: float) -> int | None:
    """Bits after the binary point with which all places up to `furthest_m` from 0 can be told; None if none can."""
    if furthest_m > LARGEST_FIXED:
        return None
    if furthest_m == 0.0:
        return MOST_FRACTION_BITS
    return min(MOST_FRACTION_BITS, math.floor(math.log2(LARGEST_FIXED / furthest_m)))


def packed(ellipsoids: Ellipsoids, fraction: int, options: Compression) -> dict[str, Bytes]:
    """Streams, shape (n, bytes) each, of Gaussians in the file's axes."""
    n = len(ellipsoids)
    fixed = np.rint(ellipsoids.means_m.astype(np.float64) * 2.0**fraction).astype("<i4")
    logs = (log_scales(ellipsoids) - LEAST_LOG_SCALE) * LOG_SCALE_STEPS
    return {
        "positions": fixed.view(np.uint8).reshape(n, 3, 4)[:, :, :3].reshape(n, 9),
        "alphas": _to_bytes(255.0 * ellipsoids.opacities)[:, None],
        "colors": _to_bytes((COLOR_SCALE * 255.0) * ellipsoids.sh[:, 0] + 127.5),
        "scales": _to_bytes(logs),
        "rotations": _packed_quaternions(ellipsoids.quats),
        "sh": _packed_harmonics(ellipsoids.sh[:, 1 : (options.degree + 1) ** 2], options),
    }


def n_resized(ellipsoids: Ellipsoids, n_sizes: int) -> int:
    """Gaussians with one of the first `n_sizes` sizes beyond what the format can tell."""
    logs = log_scales(ellipsoids)[:, :n_sizes]
    half = 0.5 / LOG_SCALE_STEPS
    return int(((logs < LEAST_LOG_SCALE - half) | (logs > MOST_LOG_SCALE + half)).any(axis=1).sum())


def _to_bytes(values: NDArray[np.float32]) -> Bytes:
    found: Bytes = np.clip(np.rint(values), 0.0, 255.0).astype(np.uint8)
    return found


def _packed_harmonics(sh: NDArray[np.float32], options: Compression) -> Bytes:
    """Colours run fastest; fewer bits are rounded ones, with 0 among them, which gzip makes short."""
    values = np.rint(np.clip(sh, -1.0, 1.0) * 128.0).astype(np.int32) + 128
    for rows, bits in ((slice(0, 3), options.first_bits), (slice(3, None), options.further_bits)):
        step = 1 << (8 - bits)
        values[:, rows] = (values[:, rows] + step // 2) // step * step
    found: Bytes = np.clip(values, 0, 255).astype(np.uint8)
    return found.reshape(len(sh), 3 * values.shape[1])


def _packed_quaternions(quats: NDArray[np.float32]) -> Bytes:
    """Number of the largest component in 2 bits, then the others' signs and magnitudes, in the order x, y, z, w."""
    xyzw = quats[:, [1, 2, 3, 0]]
    rows = np.arange(len(xyzw))
    largest = np.abs(xyzw).argmax(axis=1)
    others = np.take_along_axis(xyzw, OTHERS[largest], axis=1)
    is_negative = (others < 0.0) ^ (xyzw[rows, largest] < 0.0)[:, None]
    sizes = np.minimum(np.rint(np.abs(others) * (MAGNITUDES / LARGEST_SMALL)), MAGNITUDES).astype(np.uint32)
    parts = sizes | is_negative.astype(np.uint32) << np.uint32(9)
    found = largest.astype(np.uint32)
    for column in range(3):
        found = found << np.uint32(10) | parts[:, column]
    return np.asarray(found, "<u4").view(np.uint8).reshape(len(xyzw), 4)


# The file of SPZ's version 4: header and table of contents as they are, and a ZSTD frame for each stream.

MAGIC = b"NGSP"
VERSION = 4

ZSTD_HEADER = struct.Struct("<4sIIBBBBI12x")
"""Magic, version, count, degree, bits after the binary point, flags, streams, where the table begins; reserved."""

ENTRY = struct.Struct("<QQ")
"""Of the table: bytes of a stream in the file, and unpacked."""

LEVEL = 12
"""As the format's own library has it."""

AT_ONCE_BYTES = 1 << 22


def zstd_file(n: int, degree: int, fraction: int, flags: int, streams: Sequence[memoryview], monitor: Monitor) -> bytes:
    """A whole file.

    Parameters
    ----------
    n
        Gaussians.
    fraction
        Bits after the binary point.
    streams
        In the format's order, without empty ones.
    """
    total, done = sum(map(len, streams)), 0
    frames = []
    for stream in streams:
        compressor = zstd.ZstdCompressor(LEVEL)
        compressor.set_pledged_input_size(len(stream))
        pieces = []
        for start in range(0, len(stream), AT_ONCE_BYTES):
            monitor.report(say("compressing"), done, total)
            piece = stream[start : start + AT_ONCE_BYTES]
            pieces.append(compressor.compress(piece))
            done += len(piece)
        frames.append(b"".join([*pieces, compressor.flush()]))
    header = ZSTD_HEADER.pack(MAGIC, VERSION, n, degree, fraction, flags, len(frames), ZSTD_HEADER.size)
    table = [ENTRY.pack(len(frame), len(stream)) for frame, stream in zip(frames, streams, strict=True)]
    return b"".join([header, *table, *frames])


Version = Literal[3, 4]

HEADER = struct.Struct("<4sIIBBBB")
"""Of version 3: magic, version, count, degree, bits after the binary point, flags, reserved."""

ANTIALIASED = 1
"""Of the flags."""

GZIP = 31
"""zlib's name for a window of 32 KiB in a gzip stream."""


def write_spz(
    scene: GsScene,
    path: Path,
    compression: Compression = PRESETS["balanced"],
    axes: Axes = "y-up",
    monitor: Monitor = QUIET,
    version: Version = 3,
) -> Compressed:
    """Write the components of a scene that are here, whole or not at all.

    Parameters
    ----------
    axes
        `y-up` is what the format says; others are for programs that do not go by it.

    Raises
    ------
    InputError
        There is nothing to see, numbers are not finite or too large, or the file cannot be written.
    """
    check_scene(scene, path)
    content, found = spz_of(scene, compression, axes, path, monitor, version)
    write_atomically(path, content)
    return found


def spz_of(
    scene: GsScene, compression: Compression, axes: Axes, path: Path, monitor: Monitor, version: Version = 3
) -> tuple[bytes, Compressed]:
    """What a file of a scene's components holds, and what came of them.

    Parameters
    ----------
    path
        That it is for.

    Raises
    ------
    InputError
        There is nothing to see, or a place is too far away for the format.
    """
    least = compression.least_opacity
    means = [block.means_m for block in blocks_of(scene, axes, least, monitor, say("reading Gaussians"))]
    n = sum(map(len, means))
    expect_some(n, path)
    places_m = np.concatenate(means)
    furthest_m = float(np.abs(places_m).max())
    fraction = fraction_bits(furthest_m)
    if fraction is None:
        raise InputError(
            say("not written: a Gaussian lies {:.3g} m from the origin; train again", furthest_m, place=path)
        )
    rank = np.empty(n, np.int64)
    rank[morton_order(places_m)] = np.arange(n)
    del means, places_m
    streams = {name: np.empty((n, size), np.uint8) for name, size in sizes_of(compression.degree).items()}
    start, resized = 0, 0
    n_sizes = FLAT if are_discs(scene) else SOLID
    for block in blocks_of(scene, axes, least, monitor, say("packing Gaussians")):
        rows = rank[start : start + len(block)]
        for name, values in packed(block, fraction, compression).items():
            streams[name][rows] = values
        resized += n_resized(block, n_sizes)
        start += len(block)
    parts = [streams[name].data.cast("B") for name in STREAMS if streams[name].size]
    flags = ANTIALIASED * is_antialiased(scene)
    if version == 3:
        header = HEADER.pack(MAGIC, version, n, compression.degree, fraction, flags, 0)
        content = _gzipped([header, *parts], monitor)
    else:
        content = zstd_file(n, compression.degree, fraction, flags, parts, monitor)
    return content, Compressed(path, len(content), n, n_gaussians(scene) - n, resized, 2.0 ** -(fraction + 1))


def _gzipped(parts: list[bytes | memoryview], monitor: Monitor) -> bytes:
    total, done = sum(map(len, parts)), 0
    compressor = zlib.compressobj(6, zlib.DEFLATED, GZIP)
    found = []
    for part in parts:
        for start in range(0, len(part), AT_ONCE_BYTES):
            monitor.report(say("compressing"), done, total)
            piece = part[start : start + AT_ONCE_BYTES]
            found.append(compressor.compress(piece))
            done += len(piece)
    return b"".join([*found, compressor.flush()])
