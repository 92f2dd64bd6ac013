"""SPZ files (Niantic): Gaussians in few bytes each, all in one gzip stream (version 3) or by kinds in ZSTD (version 4).

Nearly everything that reads SPZ reads version 3. Version 4 is a little smaller; PlayCanvas' engine reads it
alone. The format has neither panels nor origin: places count from the scene's `origin_enu_m`.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Literal

import numpy as np

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import check_scene
from reconstruction.exports.compression import PRESETS, Compressed, Compression
from reconstruction.exports.gaussian_blocks import (
    are_discs,
    blocks_of,
    expect_some,
    is_antialiased,
    morton_order,
    n_gaussians,
)
from reconstruction.exports.spz.packing import STREAMS, fraction_bits, n_resized, packed, sizes_of
from reconstruction.exports.spz.zstd import AT_ONCE_BYTES, MAGIC, zstd_file
from reconstruction.exports.turned_axes import Axes
from reconstruction.objects.gs_scene import GsScene
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID

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
            monitor.report("compressing", done, total)
            piece = part[start : start + AT_ONCE_BYTES]
            found.append(compressor.compress(piece))
            done += len(piece)
    return b"".join([*found, compressor.flush()])
