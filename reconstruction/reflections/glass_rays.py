"""Rays of glass pixels: where each meets its panel's plane, where it is mirrored to, and what colour the photo has.

This is all a model of reflections learns from; no rasteriser has a part in it. A pixel counts as glass where all of its
area lies on one panel: its middle ray and those through its four corners meet the panel inside its edges. Pixels that
a frame shares would teach the frame's colour as a reflection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.progress import QUIET, Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.reflections.photo_set import PanelPlanes, PhotoSet
from reconstruction.reflections.shading import incidence_cosines, reflected_directions

Array = NDArray[np.float64]

LEAST_COSINE = 1e-3
"""Between a ray and its panel's normal: below, at 89.94 degrees, a pixel is as long as a hundred panels."""

AT_ONCE = 1 << 18
"""Pixels whose rays are made at a time: about 100 MB."""

DEFAULT_BYTES = 1 << 30
"""Memory for rays."""

CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


@dataclass(frozen=True, slots=True, eq=False)
class GlassRays:
    """Rays of n pixels.

    Parameters
    ----------
    points
        Where they meet their panels' planes, rescaled by `PanelPlanes`, shape (n, 3), float32.
    omega_r
        Unit directions, ENU, that they are mirrored to (paper Eq. 20), shape (n, 3), float32.
    cosines
        Of the angle of incidence, shape (n,), float32.
    panels
        Which panels, from 0, shape (n,), int32.
    off_axis
        Squared distance from the principal point, 1 in the picture's corners, shape (n,), float32.
    gains
        Exposure of the ray's photo on top of that of all photos, shape (n,), float32.
    colours
        Of the photo, sRGB, shape (n, 3), uint8.
    """

    points: Tensor
    omega_r: Tensor
    cosines: Tensor
    panels: Tensor
    off_axis: Tensor
    gains: Tensor
    colours: Tensor

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, rows: Tensor | slice) -> GlassRays:
        """Some of the rays."""
        return GlassRays(*(getattr(self, field.name)[rows] for field in fields(self)))

    @property
    def display(self) -> Tensor:
        """Colours as 0 to 1, shape (n, 3), float32."""
        return self.colours.float() / 255.0


BYTES_PER_RAY = 3 * 4 + 3 * 4 + 4 + 4 + 4 + 4 + 3


def joined(parts: Sequence[GlassRays]) -> GlassRays:
    """All rays of several."""
    return GlassRays(*(torch.cat([getattr(part, field.name) for part in parts]) for field in fields(GlassRays)))


def glass_rays(
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    memory_bytes: int = DEFAULT_BYTES,
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> GlassRays:
    """Rays of all glass pixels of some photos, read one photo after the other.

    Where they would take more than `memory_bytes`, an even random share of each photo's is kept: a training of 1000
    batches of 8192 looks at 8 million rays, a third of what the default holds.

    Parameters
    ----------
    memory_bytes
        Of the rays; while they are joined, as much again.

    Raises
    ------
    InputError
        A file is damaged.
    OperationCancelled
        From `monitor`.
    """
    share = 1.0
    if sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in photos) * BYTES_PER_RAY > memory_bytes:
        n_pixels = 0
        for done, photo in enumerate(photos):
            monitor.report("counting glass", done, len(photos))
            n_pixels += int((source.panel_numbers(photo) >= 0).sum())
        share = min(1.0, memory_bytes / (BYTES_PER_RAY * max(n_pixels, 1)))
    parts = [_blank_rays()]
    for done, photo in enumerate(photos):
        monitor.report("reading rays", done, len(photos))
        parts.append(rays_of_photo(source, photo, share, seed + done))
    return joined(parts)


def rays_of_photo(source: PhotoSet, photo: PosedPhoto, share: float = 1.0, seed: int = 0) -> GlassRays:
    """Rays of the glass pixels of one photo, row by row; of an even random share of them where that is below 1."""
    numbers = source.panel_numbers(photo)
    rows, columns = np.nonzero(numbers >= 0)
    if share < 1.0:
        kept = np.random.default_rng(seed).random(len(rows)) < share
        rows, columns = rows[kept], columns[kept]
    picture = source.picture(photo)
    parts = [_blank_rays()]
    for start in range(0, len(rows), AT_ONCE):
        row, column = rows[start : start + AT_ONCE], columns[start : start + AT_ONCE]
        found = _rays(photo, source.panels, row, column, numbers[row, column], picture[row, column])
        parts.append(replace(found, gains=found.gains * source.own_exposures.get(photo.name, 1.0)))
    return joined(parts)


def _rays(
    photo: PosedPhoto,
    planes: PanelPlanes,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    panels: NDArray[np.int64],
    colours: NDArray[np.uint8],
) -> GlassRays:
    middles: Array = np.column_stack([columns, rows]).astype(np.float64) + 0.5
    is_whole = np.ones(len(rows), bool)
    for corner in CORNERS:
        points, _, cosines = _met(photo, planes, middles + corner, panels)
        is_whole &= (cosines > LEAST_COSINE) & _inside(points, planes.corners_enu_m[panels])
    kept = np.flatnonzero(is_whole)
    if not len(kept):
        return _blank_rays()
    panels, middles = panels[kept], middles[kept]
    points, directions, _ = _met(photo, planes, middles, panels)
    omega_o, normals = torch.from_numpy(directions), torch.from_numpy(planes.normals_enu[panels])
    lens = photo.intrinsics
    off = middles - (lens.cx_px, lens.cy_px)
    off_axis = (off * off).sum(axis=1) / (0.25 * (lens.width_px**2 + lens.height_px**2))
    return GlassRays(
        torch.from_numpy(planes.rescaled(points).astype(np.float32)),
        reflected_directions(omega_o, normals).float(),
        incidence_cosines(omega_o, normals).float(),
        torch.from_numpy(panels.astype(np.int32)),
        torch.from_numpy(off_axis.astype(np.float32)),
        torch.ones(len(kept)),
        torch.from_numpy(colours[kept]),
    )


def _met(
    photo: PosedPhoto, planes: PanelPlanes, pixels: Array, panels: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """Where rays meet their panels' planes, their unit directions, and cosines against the outward normals.

    Cosines are negative where a panel is seen from behind; points are meaningless where they are under `LEAST_COSINE`.
    """
    origins, directions = photo.rays(pixels)
    normals = planes.normals_enu[panels]
    cosines = -np.einsum("nk,nk->n", directions, normals)
    heights = np.einsum("nk,nk->n", origins - planes.corners_enu_m[panels, 0], normals)
    distances = heights / np.maximum(cosines, LEAST_COSINE)
    return origins + distances[:, None] * directions, directions, cosines


def _inside(points: Array, corners: Array) -> NDArray[np.bool_]:
    """Whether points, shape (n, 3), lie inside convex panels, shape (n, 4, 3), in whose planes they are."""
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    inside = np.ones(len(points), bool)
    for number in range(4):
        first, second = corners[:, number], corners[:, (number + 1) % 4]
        inside &= np.einsum("nk,nk->n", np.cross(second - first, points - first), normals) >= 0.0
    return inside


def _blank_rays() -> GlassRays:
    three, one = torch.zeros(0, 3), torch.zeros(0)
    panels, colours = torch.zeros(0, dtype=torch.int32), torch.zeros(0, 3, dtype=torch.uint8)
    return GlassRays(three, three, one, panels, one, one, colours)
