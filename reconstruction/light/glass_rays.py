"""Rays of glass pixels: where each meets its panel's plane, where it is mirrored to, and what colour the photo has.

This is all a model of reflections learns from; no rasteriser has a part in it. What is kept of a pixel is which one it
is; its rays, one or several through places all over it, are made when they are needed. A pixel counts as glass where
all of its area lies on one panel: its middle ray and those through its four corners meet the panel inside its edges.
Pixels that a frame shares would teach the frame's colour as a reflection; who knows what the frame adds to them asks
for `middle` pixels too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.ray_table import PaneHits, RayTable
from reconstruction.light.shading import reflected_directions

DEFAULT_BYTES = 1 << 30
"""Memory for rays."""

AT_ONCE = 1 << 18
"""Pixels whose corners are checked at a time: about 100 MB."""

CORNERS = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))

Which = Literal["whole", "middle"]
"""Pixels that count: whose whole area lies on a panel, or whose middle does."""


@dataclass(frozen=True, slots=True, eq=False)
class GlassRays:
    """Rays of n pixels.

    Parameters
    ----------
    table
        The cameras and panels that the numbers below count.
    photos
        Which photos, shape (n,), int32.
    columns, rows
        Of the pixels, shape (n,), int16.
    panels
        Which panels, from 0, shape (n,), int32.
    colours
        Of the photo, sRGB, shape (n, 3), uint8.
    """

    table: RayTable
    photos: Tensor
    columns: Tensor
    rows: Tensor
    panels: Tensor
    colours: Tensor

    def __len__(self) -> int:
        return len(self.panels)

    def __getitem__(self, rows: Tensor | slice) -> GlassRays:
        """Some of the rays, by numbers, shape (k,), a mask, shape (n,), or a range."""
        if isinstance(rows, slice):
            return GlassRays(self.table, *(getattr(self, name)[rows] for name in COLUMNS))
        numbers = torch.nonzero(rows).squeeze(1) if rows.dtype == torch.bool else rows
        return GlassRays(self.table, *(getattr(self, name).index_select(0, numbers) for name in COLUMNS))

    def repeated(self, times: int) -> GlassRays:
        """Each ray so many times in a row."""
        if times == 1:
            return self
        return GlassRays(self.table, *(getattr(self, name).repeat_interleave(times, dim=0) for name in COLUMNS))

    @property
    def display(self) -> Tensor:
        """Colours as 0 to 1, shape (n, 3), float32."""
        return self.colours.float() / 255.0

    @property
    def middles_px(self) -> Tensor:
        """Of the pixels, continuous coordinates, shape (n, 2), float64."""
        return torch.stack([self.columns, self.rows], dim=1).double() + 0.5

    @property
    def off_axis(self) -> Tensor:
        """Squared distance from the principal point, 1 in the pictures' corners, shape (n,), float32."""
        return self.table.off_axis(self.photos, self.middles_px).float()

    @property
    def gains(self) -> Tensor:
        """Exposure of each ray's photo on top of that of all photos, shape (n,), float32."""
        return self.table.gains[self.photos].float()

    def hits(self, offsets_px: Tensor | None = None, moves: Tensor | None = None) -> PaneHits:
        """One ray of each pixel, through its middle or off it by `offsets_px`, shape (n, 2); see `RayTable.meet`."""
        places = self.middles_px if offsets_px is None else self.middles_px + offsets_px
        return self.table.meet(self.photos, places, self.panels, moves)

    def middle(self) -> MiddleRays:
        """Through the pixels' middles, mirrored by the panels' planes."""
        hits = self.hits()
        mirrored = reflected_directions(hits.directions, self.table.normals[self.panels])
        cosines = hits.cosines.abs().clamp(max=1.0)
        return MiddleRays(self.table.rescaled(hits.points_m).float(), mirrored.float(), cosines.float())


COLUMNS = tuple(field.name for field in fields(GlassRays) if field.name != "table")

BYTES_PER_RAY = 4 + 2 + 2 + 4 + 3


@dataclass(frozen=True, slots=True, eq=False)
class MiddleRays:
    """One ray of each of n pixels.

    Parameters
    ----------
    points
        Where they meet their panels' planes, rescaled by `PanelPlanes`, shape (n, 3), float32.
    omega_r
        Unit directions, ENU, that they are mirrored to (paper Eq. 20), shape (n, 3), float32.
    cosines
        Of the angle of incidence, shape (n,), float32.
    """

    points: Tensor
    omega_r: Tensor
    cosines: Tensor


def joined(parts: Sequence[GlassRays]) -> GlassRays:
    """All rays of several, at least one, that share a table."""
    return GlassRays(parts[0].table, *(torch.cat([getattr(part, name) for part in parts]) for name in COLUMNS))


def rays_of_pixels(
    table: RayTable, photo: int, columns: Tensor, rows: Tensor, panels: Tensor, colours: Tensor | None = None
) -> GlassRays:
    """Rays of pixels of one photo, of whatever panels they are said to show, shape (n,) each; black without colours."""
    numbers = torch.full_like(panels, photo, dtype=torch.int32)
    shown = torch.zeros(len(panels), 3, dtype=torch.uint8, device=panels.device) if colours is None else colours
    return GlassRays(table, numbers, columns.to(torch.int16), rows.to(torch.int16), panels.to(torch.int32), shown)


def glass_rays(
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    memory_bytes: int = DEFAULT_BYTES,
    seed: int = 0,
    monitor: Monitor = QUIET,
    which: Which = "whole",
) -> GlassRays:
    """Rays of all glass pixels of some photos, read one photo after the other.

    Where they would take more than `memory_bytes`, an even random share of each photo's is kept: a training of 1000
    batches of 8192 looks at 8 million rays, an eighth of what the default holds.

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
            monitor.report(say("counting glass"), done, len(photos))
            n_pixels += int((source.panel_numbers(photo) >= 0).sum())
        share = min(1.0, memory_bytes / (BYTES_PER_RAY * max(n_pixels, 1)))
    table = RayTable.of(photos, source.panels, source.own_exposures)
    parts = [_no_rays(table)]
    for done, photo in enumerate(photos):
        monitor.report(say("reading rays"), done, len(photos))
        parts.append(_rays(source, table, done, photo, share, seed + done, which))
    return joined(parts)


def rays_of_photo(source: PhotoSet, photo: PosedPhoto, which: Which = "whole") -> GlassRays:
    """Rays of the glass pixels of one photo, row by row."""
    return _rays(source, RayTable.of([photo], source.panels, source.own_exposures), 0, photo, 1.0, 0, which)


def _rays(
    source: PhotoSet, table: RayTable, number: int, photo: PosedPhoto, share: float, seed: int, which: Which
) -> GlassRays:
    """Of an even random share of a photo's pixels."""
    numbers = source.panel_numbers(photo)
    rows, columns = np.nonzero(numbers >= 0)
    if share < 1.0:
        kept = np.random.default_rng(seed).random(len(rows)) < share
        rows, columns = rows[kept], columns[kept]
    picture = source.picture(photo)
    parts = [_no_rays(table)]
    for start in range(0, len(rows), AT_ONCE):
        row, column = rows[start : start + AT_ONCE], columns[start : start + AT_ONCE]
        parts.append(_kept(table, number, row, column, numbers[row, column], picture[row, column], which))
    return joined(parts)


def _kept(
    table: RayTable,
    number: int,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    panels: NDArray[np.int64],
    colours: NDArray[np.uint8],
    which: Which,
) -> GlassRays:
    rays = rays_of_pixels(
        table,
        number,
        torch.from_numpy(columns),
        torch.from_numpy(rows),
        torch.from_numpy(panels),
        torch.from_numpy(colours),
    )
    around = np.array(CORNERS if which == "whole" else ((0.0, 0.0),))
    return rays[table.holds(rays.photos, rays.middles_px, rays.panels, around)]


def _no_rays(table: RayTable) -> GlassRays:
    none, short = torch.zeros(0, dtype=torch.int32), torch.zeros(0, dtype=torch.int16)
    return GlassRays(table, none, short, short, none, torch.zeros(0, 3, dtype=torch.uint8))
