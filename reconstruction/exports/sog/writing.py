"""SOG files (PlayCanvas, version 2): Gaussians as lossless WebP images in a ZIP file.

Each Gaussian is a pixel, at the same place in all images. Places are logarithms in 16 bits, rotations three components
of a quaternion in 8 bits, sizes and colours numbers in codebooks of 256, colours by direction entries of a palette.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    log_scales,
    morton_order,
    n_gaussians,
)
from reconstruction.exports.gltf_tables import plain
from reconstruction.exports.sog.codebooks import Palette, codebook, nearest_codes, palette
from reconstruction.exports.sog.images import LONGEST_SIDE_PX, Bytes, image_of, image_size, rows_as_image
from reconstruction.exports.spz.packing import OTHERS
from reconstruction.exports.turned_axes import Axes
from reconstruction.objects.gs_scene import GsScene

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
    meta["scales"] = {"codebook": _told(codes), "files": ["scales.webp"]}
    monitor.report(say("writing images"), 3, 7)
    images["quats.webp"] = rows_as_image(found.quats)
    meta["quats"] = {"files": ["quats.webp"]}
    monitor.report(say("writing images"), 4, 7)
    codes = codebook(found.colours)
    pixels = np.column_stack([nearest_codes(found.colours, codes), found.opacities])
    images["sh0.webp"] = rows_as_image(pixels)
    meta["sh0"] = {"codebook": _told(codes), "files": ["sh0.webp"]}
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
        "codebook": _told(codes),
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


def _told(codes: NDArray[np.float64]) -> list[float]:
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
