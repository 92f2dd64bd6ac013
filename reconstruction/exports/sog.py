"""SOG files (PlayCanvas, version 2): Gaussians as lossless WebP images in a ZIP file.

Each Gaussian is a pixel, at the same place in all images. Places are logarithms in 16 bits, rotations three components
of a quaternion in 8 bits, sizes and colours numbers in codebooks of 256, colours by direction entries of a palette.
"""

from __future__ import annotations

import io
import json
import math
import struct
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import check_scene
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
from reconstruction.exports.glb import plain
from reconstruction.exports.spz import OTHERS
from reconstruction.objects.gs_scene import GsScene

# Few values that stand for many: codebooks of numbers, and palettes of vectors, by Lloyd's k-means.
#
# A palette is found in two steps, groups and then colours within each group: of k colours a vector is compared with
# about
# 2 sqrt(k), so that 65 536 of them for a million vectors take seconds and not hours. What that costs is measured in
# `tests.benchmarks --only model-size`.

Floats = NDArray[np.float32]

CODES = 256

NUMBER_STEPS = 64
"""Of Lloyd's method for numbers, which are sorted: each step takes microseconds."""

CODEBOOK_STEPS = 8

ROUNDS = 8
"""In which colours are shared out: groups that have enough leave theirs to the others."""

AT_ONCE = 16_384
"""Vectors compared at a time: 16 MB of distances to 256 others."""


def codebook(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Numbers that values, of any shape but empty, are told by, rising, shape (256,).

    It begins half with evenly spaced ones and half with as many values between any two, so that rare values far out
    count, too.
    """
    sorted_values = np.sort(np.asarray(values, np.float64), axis=None)
    n = len(sorted_values)
    sums = np.concatenate([[0.0], np.cumsum(sorted_values)])
    even = np.linspace(sorted_values[0], sorted_values[-1], CODES // 2)
    often = sorted_values[np.linspace(0, n - 1, CODES // 2).astype(np.int64)]
    found = np.sort(np.concatenate([even, often]))
    for _ in range(NUMBER_STEPS):
        ends = np.searchsorted(sorted_values, 0.5 * (found[1:] + found[:-1]))
        edges = np.concatenate([[0], ends, [n]])
        counts = np.diff(edges)
        means = np.diff(sums[edges]) / np.maximum(counts, 1)
        moved = np.sort(np.where(counts > 0, means, found))
        if np.array_equal(moved, found):
            break
        found = moved
    return found


def nearest_codes(values: NDArray[np.floating], codes: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Number of the nearest of rising codes for each value."""
    return np.searchsorted(0.5 * (codes[1:] + codes[:-1]), values).astype(np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Palette:
    """Vectors that stand for others.

    Parameters
    ----------
    groups
        Middles, shape (g, d).
    starts
        First colour of each group and the end, shape (g + 1,).
    colours
        Shape (k, d).
    """

    groups: Floats
    starts: NDArray[np.int64]
    colours: Floats

    def labels(self, vectors: Floats) -> NDArray[np.int64]:
        """Number of the colour for each vector, shape (n,): the nearest of those of the nearest group."""
        groups = _nearest(vectors, self.groups)
        found = np.zeros(len(vectors), np.int64)
        for group, rows in _by_group(groups, len(self.groups)):
            own = slice(int(self.starts[group]), int(self.starts[group + 1]))
            found[rows] = own.start + _nearest(vectors[rows], self.colours[own])
        return found


def palette(vectors: Floats, size: int, seed: int, monitor: Monitor) -> Palette:
    """At most `size` colours for vectors, shape (n, d), n > 0.

    Groups get colours by how much their vectors differ.
    """
    rng = np.random.default_rng(seed)
    size = min(size, len(vectors))
    groups = _lloyd(vectors, min(math.isqrt(size - 1) + 1, size), rng)
    numbers = _nearest(vectors, groups)
    members = list(_by_group(numbers, len(groups)))
    spread = np.array([float(((vectors[rows] - groups[group]) ** 2).sum()) for group, rows in members])
    counts = _shared_out(spread, np.array([len(rows) for _, rows in members]), size)
    colours, sizes = [], np.zeros(len(groups), np.int64)
    for (group, rows), count in zip(members, counts, strict=True):
        monitor.report(say("finding colours"), group, len(groups))
        own = _lloyd(vectors[rows], int(count), rng)
        colours.append(own)
        sizes[group] = len(own)
    # Groups that nothing is in have no colour, and nothing may come to them.
    kept = sizes > 0
    starts = np.concatenate([[0], np.cumsum(sizes[kept])])
    return Palette(groups[kept], starts, np.concatenate(colours))


def _shared_out(spread: NDArray[np.float64], members: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """How many of `size` colours each group gets: one, and of the rest by its spread, but not more than members."""
    if size >= members.sum():
        return members
    counts = np.ones(len(spread), np.int64)
    for _ in range(ROUNDS):
        left = size - int(counts.sum())
        shares = np.where(counts < members, spread, 0.0)
        total = float(shares.sum())
        if left <= 0 or total == 0.0:
            break
        counts = np.minimum(counts + np.floor(left * shares / total).astype(np.int64), members)
    return counts


def _lloyd(vectors: Floats, k: int, rng: np.random.Generator) -> Floats:
    """Middles, shape (k, d), k <= n; those that nothing is nearest to stay where they began."""
    if k >= len(vectors):
        return vectors.copy()
    found = vectors[np.sort(rng.choice(len(vectors), k, replace=False))]
    for _ in range(CODEBOOK_STEPS):
        labels = _nearest(vectors, found)
        order = np.argsort(labels, kind="stable")
        counts = np.bincount(labels, minlength=k)
        is_used = counts > 0
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])[is_used]
        sums = np.add.reduceat(vectors[order], starts, axis=0)
        moved = found.copy()
        moved[is_used] = sums / counts[is_used, None].astype(np.float32)
        if np.array_equal(moved, found):
            break
        found = moved
    return found


def _nearest(vectors: Floats, middles: Floats) -> NDArray[np.int64]:
    """Number of the nearest middle for each vector, shape (n,)."""
    squares = (middles**2).sum(axis=1)
    found = np.empty(len(vectors), np.int64)
    for start in range(0, len(vectors), AT_ONCE):
        rows = slice(start, start + AT_ONCE)
        found[rows] = (squares - 2.0 * (vectors[rows] @ middles.T)).argmin(axis=1)
    return found


def _by_group(numbers: NDArray[np.int64], n_groups: int) -> list[tuple[int, NDArray[np.int64]]]:
    """Rows of each group that has any."""
    order = np.argsort(numbers, kind="stable")
    ends = np.searchsorted(numbers[order], np.arange(n_groups + 1))
    return [(group, order[ends[group] : ends[group + 1]]) for group in range(n_groups) if ends[group + 1] > ends[group]]


# Bytes as lossless WebP images, every bit of all four channels, and back.

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
        raise InputError(say("{} has {} x {} pixels; expected at most {}", name, width, height, most_px, place=path))
    found = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    if found is None or found.ndim != 3 or found.shape[:2] != (height, width):
        raise InputError(say("{} is damaged", name, place=path))
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
    raise InputError(say("expected a lossless WebP image", place=f"{path}: {name}"))


META = "meta.json"

VERSION = 2

STEPS = 65_535
"""Of places, along each axis."""

FIRST_TAG = 252
"""Of rotations: alpha less this is the number of the largest component, of w, x, y, z."""

PALETTE_COLUMNS = 64
"""Entries of the palette in a row of its image."""

LEAST_PALETTE = 64
"""Entries, one row of the image."""

SAMPLES_FOR_EACH = 8
"""Gaussians for each entry that the palette is found from."""

SEED = 0

TIME_OF_FILES = (1980, 1, 1, 0, 0, 0)


@dataclass(slots=True, eq=False)
class _Gathered:
    """What is kept of all Gaussians, in the file's order."""

    means_m: NDArray[np.float32]
    log_scales: NDArray[np.float32]
    colours: NDArray[np.float32]
    opacities: Bytes
    quats: Bytes
    rank: NDArray[np.int64]


def write_sog(
    scene: GsScene,
    path: Path,
    compression: Compression = PRESETS["balanced"],
    axes: Axes = "y-down",
    monitor: Monitor = QUIET,
) -> Compressed:
    """Write the components of a scene that are here, whole or not at all.

    Parameters
    ----------
    axes
        The format's text says `y-up`; its makers' own programs write and show `y-down`, so that is what stands upright
        in SuperSplat.

    Raises
    ------
    InputError
        There is nothing to see, numbers are not finite, there are too many, or the file cannot be written.
    """
    check_scene(scene, path)
    found = _gathered(scene, path, compression, axes, monitor)
    n = len(found.means_m)
    if max(image_size(n)) > LONGEST_SIDE_PX:
        raise InputError(
            say("not written: {} Gaussians are more than fit into an image; write single facades", n, place=path)
        )
    meta: dict[str, Any] = {"version": VERSION, "asset": _asset(scene, axes), "count": n}
    # One of both: who knows of antialiasing draws the third size, which is next to nothing, too.
    if is_antialiased(scene):
        meta["model"] = "antialiased"
    elif are_discs(scene):
        meta["model"] = "2dgs"
    images: dict[str, bytes] = {}
    step = _put_means(found, meta, images)
    monitor.report(say("writing images"), 2, 7)
    codes = codebook(found.log_scales)
    images["scales.webp"] = rows_as_image(nearest_codes(found.log_scales, codes))
    meta["scales"] = {"codebook": _shortened(codes), "files": ["scales.webp"]}
    monitor.report(say("writing images"), 3, 7)
    images["quats.webp"] = rows_as_image(found.quats)
    meta["quats"] = {"files": ["quats.webp"]}
    monitor.report(say("writing images"), 4, 7)
    codes = codebook(found.colours)
    pixels = np.column_stack([nearest_codes(found.colours, codes), found.opacities])
    images["sh0.webp"] = rows_as_image(pixels)
    meta["sh0"] = {"codebook": _shortened(codes), "files": ["sh0.webp"]}
    if compression.degree > 0:
        _put_palette(scene, compression, axes, found.rank, meta, images, monitor)
    content = _zipped(meta, images)
    write_atomically(path, content)
    furthest_m = float(np.abs(found.means_m).max())
    return Compressed(
        path, len(content), n, n_gaussians(scene) - n, 0, (1.0 + furthest_m) * float(np.expm1(0.5 * step))
    )


def _gathered(scene: GsScene, path: Path, compression: Compression, axes: Axes, monitor: Monitor) -> _Gathered:
    parts = [
        (block.means_m, log_scales(block), block.sh[:, 0].copy(), _shares(block.opacities), _quaternions(block.quats))
        for block in blocks_of(scene, axes, compression.least_opacity, monitor, say("reading Gaussians"))
    ]
    expect_some(sum(len(part[0]) for part in parts), path)
    means, scales, colours, opacities, quats = (np.concatenate([part[at] for part in parts]) for at in range(5))
    order = morton_order(means)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return _Gathered(means[order], scales[order], colours[order], opacities[order], quats[order], rank)


def _shares(opacities: NDArray[np.float32]) -> Bytes:
    return np.asarray(np.rint(255.0 * opacities), np.uint8)


def _quaternions(quats: NDArray[np.float32]) -> Bytes:
    """Pixels, shape (n, 4), of unit quaternions w, x, y, z."""
    rows = np.arange(len(quats))
    largest = np.abs(quats).argmax(axis=1)
    signs = np.where(quats[rows, largest] < 0.0, -1.0, 1.0)
    others = np.take_along_axis(quats, OTHERS[largest], axis=1) * signs[:, None]
    values = np.clip(np.rint(255.0 * (others * np.sqrt(0.5) + 0.5)), 0.0, 255.0)
    found = np.column_stack([values, FIRST_TAG + largest])
    return np.asarray(found, np.uint8)


def _put_means(found: _Gathered, meta: dict[str, Any], images: dict[str, bytes]) -> float:
    """Places as images; the largest step of their logarithms."""
    logs = np.sign(found.means_m) * np.log1p(np.abs(found.means_m.astype(np.float64)))
    low, high = logs.min(axis=0), logs.max(axis=0)
    span = high - low
    values = np.rint((logs - low) * (STEPS / np.where(span > 0.0, span, 1.0))).astype(np.uint16)
    images["means_l.webp"] = rows_as_image((values & 0xFF).astype(np.uint8))
    images["means_u.webp"] = rows_as_image((values >> 8).astype(np.uint8))
    meta["means"] = {"mins": low.tolist(), "maxs": high.tolist(), "files": ["means_l.webp", "means_u.webp"]}
    return float(span.max()) / STEPS


def _put_palette(
    scene: GsScene,
    compression: Compression,
    axes: Axes,
    rank: NDArray[np.int64],
    meta: dict[str, Any],
    images: dict[str, bytes],
    monitor: Monitor,
) -> None:
    """Colours by direction: a palette found from some of the Gaussians, then the entry for each of them."""
    n, size = len(rank), palette_size(len(rank), compression)
    rng = np.random.default_rng(SEED)
    chosen = np.zeros(n, bool)
    chosen[rng.choice(n, min(n, SAMPLES_FOR_EACH * size), replace=False)] = True

    def blocks(stage: str) -> Any:
        start = 0
        for block in blocks_of(scene, axes, compression.least_opacity, monitor, stage):
            rest = block.sh[:, 1 : (compression.degree + 1) ** 2]
            yield slice(start, start + len(block)), np.ascontiguousarray(rest).reshape(len(block), -1)
            start += len(block)

    sample = np.concatenate([vectors[chosen[rows]] for rows, vectors in blocks(say("choosing samples"))])
    found = palette(sample, size, SEED, monitor)
    labels = np.empty(n, np.int64)
    for rows, vectors in blocks(say("choosing colours")):
        labels[rank[rows]] = found.labels(vectors)
    codes = codebook(found.colours)
    images["shN_centroids.webp"] = _palette_image(found, codes)
    images["shN_labels.webp"] = rows_as_image(np.column_stack([labels & 0xFF, labels >> 8]).astype(np.uint8))
    meta["shN"] = {
        "count": len(found.colours),
        "bands": compression.degree,
        "codebook": _shortened(codes),
        "files": ["shN_centroids.webp", "shN_labels.webp"],
    }


def palette_size(n_gaussians: int, compression: Compression) -> int:
    """Entries of a palette for so many Gaussians."""
    return min(compression.palette, max(LEAST_PALETTE, n_gaussians // compression.gaussians_each), n_gaussians)


def _palette_image(found: Palette, codes: NDArray[np.float64]) -> bytes:
    """64 entries in a row, each of a pixel for every coefficient."""
    pixels = nearest_codes(found.colours, codes).reshape(len(found.colours), -1, 3)
    n_coefficients = pixels.shape[1]
    height = -(-len(pixels) // PALETTE_COLUMNS)
    whole = np.zeros((height * PALETTE_COLUMNS, n_coefficients, 4), np.uint8)
    whole[:, :, 3] = 255
    whole[: len(pixels), :, :3] = pixels
    return image_of(whole.reshape(height, PALETTE_COLUMNS * n_coefficients, 4))


def _asset(scene: GsScene, axes: Axes) -> dict[str, Any]:
    """What the format leaves to programs: where this belongs."""
    asset: dict[str, Any] = {"generator": "Reflight", "site": plain(scene.name), "axes": axes}
    asset["origin_enu_m"] = list(scene.origin_enu_m)
    if scene.origin is not None:
        origin = scene.origin
        asset["origin_wgs84"] = [origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m]
    return asset


def _shortened(codes: NDArray[np.float64]) -> list[float]:
    """As many digits as readers keep."""
    return [float(f"{code:.8g}") for code in codes]


def _zipped(meta: Mapping[str, Any], images: Mapping[str, bytes]) -> bytes:
    """Not compressed again, and the same bytes at all times."""
    stream = io.BytesIO()
    files = {META: json.dumps(meta, allow_nan=False).encode(), **images}
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, TIME_OF_FILES), content)
    return stream.getvalue()
