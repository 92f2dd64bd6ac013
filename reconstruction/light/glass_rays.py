"""Rays of glass pixels: where each meets its panel's plane, where it is mirrored to, and what colour the photo has.

This is all a model of reflections learns from; no rasteriser has a part in it. What is kept of a pixel is which one it
is; its rays, one or several through places all over it, are made when they are needed. A pixel counts as glass where
all of its area lies on one panel: its middle ray and those through its four corners meet the panel inside its edges.
Panels are convex: where the four corners of a square of pixels do, all pixels in it count.
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

from planning.base.jit import chunks, n_threads, run_parallel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.ray_table import PaneHits, RayTable
from reconstruction.light.shading import reflected_directions

DEFAULT_BYTES = 1 << 30
"""Memory for rays."""

AT_ONCE = 1 << 18
"""Pixels of a photo that are checked at a time."""

MOST_READ_PX = 1 << 24
"""Pixels of photos that are read at a time on several cores: some 500 MB."""

SQUARE_PX = 8
"""Side of squares of pixels that are checked at once: most of a pane that is some tens of pixels wide."""

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

    def sample(self, number: int, generator: torch.Generator) -> GlassRays:
        """So many, drawn with replacement; all where there are no more: of millions it takes no time to draw a few."""
        if len(self) <= number:
            return self
        return self[torch.randint(len(self), (number,), generator=generator)]

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


def numbers_in(column: Tensor) -> Tensor:
    """Numbers of photos or panels that a column of rays has, ascending, int64; quicker than sorting millions."""
    return torch.nonzero(torch.bincount(column)).squeeze(1)


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
    most = max((photo.intrinsics.width_px * photo.intrinsics.height_px for photo in photos), default=1)
    for first, last in chunks(len(photos), max(1, min(n_threads(), MOST_READ_PX // most))):
        monitor.report(say("reading rays"), first, len(photos))
        arguments = ((source, table, done, photos[done], share, seed + done, which) for done in range(first, last))
        parts += run_parallel(_rays, arguments)
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
    picture, is_whole = source.picture(photo), _in_squares(table, number, numbers)
    parts = [_no_rays(table)]
    for start in range(0, len(rows), AT_ONCE):
        row, column = rows[start : start + AT_ONCE], columns[start : start + AT_ONCE]
        panels, colours, whole = numbers[row, column], picture[row, column], is_whole[row, column]
        parts.append(_kept(table, number, row, column, panels, colours, whole, which))
    return joined(parts)


def _in_squares(table: RayTable, number: int, numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Pixels in squares that lie whole on one panel, shape as `numbers`; those of other squares may, too.

    Where a lens bends straight lines, sides of a square are off by some thousandths of a pixel.
    """
    n_rows, n_columns = (length // SQUARE_PX for length in numbers.shape)
    squares = numbers[: n_rows * SQUARE_PX, : n_columns * SQUARE_PX].reshape(n_rows, SQUARE_PX, n_columns, SQUARE_PX)
    first, last = squares.min(axis=(1, 3)), squares.max(axis=(1, 3))
    rows, columns = np.nonzero((first == last) & (first >= 0))
    middles_px = SQUARE_PX * (torch.from_numpy(np.column_stack([columns, rows])).double() + 0.5)
    photos, panels = torch.full((len(rows),), number), torch.from_numpy(first[rows, columns])
    is_whole = np.zeros((n_rows, n_columns), bool)
    is_whole[rows, columns] = table.holds(photos, middles_px, panels, SQUARE_PX * np.array(CORNERS)).numpy()
    found = np.zeros(numbers.shape, bool)
    found[: n_rows * SQUARE_PX, : n_columns * SQUARE_PX] = is_whole.repeat(SQUARE_PX, 0).repeat(SQUARE_PX, 1)
    return found


def _kept(
    table: RayTable,
    number: int,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    panels: NDArray[np.int64],
    colours: NDArray[np.uint8],
    is_whole: NDArray[np.bool_],
    which: Which,
) -> GlassRays:
    """Rays of pixels of a photo that count; those that are known to be `is_whole` are not looked at."""
    rays = rays_of_pixels(
        table,
        number,
        torch.from_numpy(columns),
        torch.from_numpy(rows),
        torch.from_numpy(panels),
        torch.from_numpy(colours),
    )
    around = np.array(CORNERS if which == "whole" else ((0.0, 0.0),))
    kept = torch.from_numpy(is_whole)
    others = rays[~kept]
    kept[~kept] = table.holds(others.photos, others.middles_px, others.panels, around)
    return rays[kept]


def _no_rays(table: RayTable) -> GlassRays:
    none, short = torch.zeros(0, dtype=torch.int32), torch.zeros(0, dtype=torch.int16)
    return GlassRays(table, none, short, short, none, torch.zeros(0, 3, dtype=torch.uint8))
