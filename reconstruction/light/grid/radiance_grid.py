"""A radiance grid: what glass mirrors as a scene, density and light that mirrored rays march through.

It tells what is near from what is far by parallax, where the Reflection MLP memorises places and directions, and so
needs fewer photos. Where density is, and how far away what is seen is, is learned from colours alone.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_cdt, maximum_filter
from torch import Tensor, nn
from torch.nn.functional import interpolate

from planning.base.jit import chunks, run_chunks
from reconstruction.light.grid import radiance_grid_kernels as kernels
from reconstruction.light.grid import radiance_grid_reference as twin
from reconstruction.light.grid.grid_box import GridBox

FEW_RAYS, MANY_CHUNKS = 4096, 4
"""Rays up to which there is one chunk, and chunks of more: as many threads can march, and as many arrays hold gradients
before they are added up. Clearing and adding those up, and waking a thread, takes as long as a thousand rays each."""

KEPT_RAYS = 16384
"""At most, of which is kept where they lost light, about 500 bytes each; more are marched again on the way back."""

STEP = 1.0
"""Of the shortest side of a cell, between places along a ray."""

MOVED_EVERY, MANY_MOVED = 4, 1024
"""Of so many rays or more, each fourth has gradients of its own place and direction, four times as large: on average
the same, and what is learned from them, two numbers for each pane, is learned as well for half the time back."""

FAR_TIMES = 12.0
"""Times the box's reach, to where rays are followed; what is further away has no parallax to speak of."""

EMPTY = 0.01
"""Share of light that a cell may take away and still be passed over."""

START_RAW = -0.55
"""Raw density to start from: a thin fog, of which every ray sees all the way."""

CORNERS = (0.05, 0.02, 0.02, 0.02)
"""Differences of density and light from which on Huber's function is straight, so that edges stay."""

SKIPPED_CELLS = 40
"""At most at a time: far enough to leap over what is empty, and quick to find out."""


class RadianceGrid(nn.Module):
    """Density and light in a box before the glass, what is beyond contracted into its rim, and far light by direction.

    Parameters
    ----------
    box
        Where it is.
    expected
        Light that it starts from, above 0.
    levels
        Times that the grid is made twice as fine, `grow` by `grow`, until it has the box's vertices.
    far_side
        Pixels along each side of the square picture of what is far away, in the end.
    """

    def __init__(self, box: GridBox, expected: float, levels: int, far_side: int) -> None:
        super().__init__()
        if far_side < 4 or far_side & (far_side - 1):
            raise ValueError(f"far_side: expected a power of 2 from 4 on, got {far_side}")
        self.skips: NDArray[np.uint8]
        self.box, self.level, self.far_side = box, levels, far_side
        x, y, z = box.counts_at(levels)
        cells = torch.empty(z, y, x, 4)
        cells[..., 0], cells[..., 1:] = START_RAW / float(kernels.DENSITY_SCALE), math.sqrt(expected)
        self.cells = nn.Parameter(cells)
        self.far = nn.Parameter(torch.full((*self._far_shape(),), math.sqrt(expected)))
        self._measure()

    def _far_shape(self) -> tuple[int, int, int]:
        side = max(4, self.far_side >> self.level)
        return side, side, 3

    def forward(self, points: Tensor, omega_r: Tensor, panels: Tensor | None = None) -> Tensor:
        """Light, shape (n, 3), 0 or more, from where rays go.

        Parameters
        ----------
        points, omega_r
            Rescaled places, and unit directions, shape (n, 3); gradients flow through both.
        panels
            Not asked for; other models do.
        """
        origins, directions = self.box.turned(points.float()), self.box.turned(omega_r.float())
        if self.training:
            # Spread evenly without a state: places of a ray differ from batch to batch, as its number does.
            starts = torch.frac(torch.arange(len(points), device=points.device) * 0.6180339887)
        else:
            starts = torch.full((len(points),), 0.5, device=points.device)
        if points.device.type == "cpu":
            found: Tensor = _March.apply(origins, directions, self.cells, self.far, starts, self)  # type: ignore[no-untyped-call]
            return found
        device = points.device
        arrays = (torch.from_numpy(a).to(device) for a in (self.skips, self.numbers, self.times, self.steps))
        skips, numbers, times, steps = arrays
        return twin.march(origins, directions, starts, self.cells, skips, self.far, numbers, times, steps, self.unit)[0]

    def roughness(self, density: float, light: float, emptier: float) -> Tensor:
        """For the loss: Huber's function of neighbours' differences, added up, and raw density.

        Only its gradient is worked out: its value is 0.

        Parameters
        ----------
        density, light, emptier
            Factors of the differences of density and of light, and of raw density.
        """
        if self.cells.device.type != "cpu":
            amounts, corners = (torch.tensor(part).to(self.cells) for part in ([density, *[light] * 3], CORNERS))
            return twin.roughness(self.cells, amounts, corners) + emptier * self.cells[..., 0].sum()
        total: Tensor = _Rough.apply(self.cells, density, light, emptier)  # type: ignore[no-untyped-call]
        return total

    @torch.no_grad()
    def refresh(self) -> None:
        """Find out anew where nothing is: now and then in a training, and after weights were put in."""
        raw = float(kernels.DENSITY_SCALE) * self.cells.detach()[..., 0].cpu().numpy()
        reach = np.where(raw >= 1.0, raw, np.square(np.clip(0.5 * (raw + 1.0), 0.0, 1.0))) * (
            self.unit * self.box.cell(self._counts())
        )
        most = maximum_filter(reach, size=2, origin=-1, mode="nearest")[:-1, :-1, :-1]
        is_full = most > -math.log1p(-EMPTY)
        if is_full.all():
            self.skips = np.zeros(is_full.shape, np.uint8)
        elif not is_full.any():
            self.skips = np.full(is_full.shape, SKIPPED_CELLS, np.uint8)
        else:
            away = distance_transform_cdt(~is_full, "chessboard")
            self.skips = np.minimum(away, SKIPPED_CELLS).astype(np.uint8)

    @torch.no_grad()
    def grow(self) -> None:
        """Make it twice as fine; parameters are new ones afterwards."""
        if self.level == 0:
            raise ValueError("the grid is as fine as its box already")
        self.level -= 1
        x, y, z = self.box.counts_at(self.level)
        channels = self.cells.permute(3, 0, 1, 2)[None]
        finer = interpolate(channels, size=(z, y, x), mode="trilinear", align_corners=True)
        self.cells = nn.Parameter(finer[0].permute(1, 2, 3, 0).contiguous())
        if self._far_shape() != tuple(self.far.shape):
            picture = _edged(self.far)
            side = self._far_shape()[0]
            finer = interpolate(picture.permute(2, 0, 1)[None], scale_factor=2.0, mode="bilinear")[0]
            self.far = nn.Parameter(finer[:, 2 : 2 + side, 2 : 2 + side].permute(1, 2, 0).contiguous())
        self._measure()

    def _counts(self) -> tuple[int, int, int]:
        z, y, x, _ = self.cells.shape
        return x, y, z

    def _measure(self) -> None:
        """What follows from how fine it is."""
        box, cell = self.box, self.box.cell(self._counts())
        middle = box.turned(torch.tensor([box.middle], dtype=torch.float64))[0].tolist()
        self.numbers = np.array([*middle, *(1.0 / h for h in box.halves), box.outer, cell], np.float32)
        step = STEP * cell
        times = [0.0]
        steps = []
        while times[-1] < FAR_TIMES * box.reach:
            steps.append(step * max(1.0, times[-1] / box.reach))
            times.append(times[-1] + steps[-1])
        self.times, self.steps = np.array(times[:-1], np.float32), np.array(steps, np.float32)
        # Of the finest cells, so that growing changes no density: a ramp of 3 takes 95 % away within one.
        self.unit = 1.0 / box.cell(box.counts)
        self.skips = np.zeros(tuple(n - 1 for n in self.cells.shape[:3]), np.uint8)


def _edged(picture: Tensor) -> Tensor:
    """A picture of all directions with a rim of one pixel around it, from where its edges meet themselves."""
    side = len(picture)
    row, column = torch.meshgrid(torch.arange(-1, side + 1), torch.arange(-1, side + 1), indexing="ij")
    return picture.reshape(-1, 3)[twin.wrapped(column, row, side)]


class _March(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, origins: Tensor, directions: Tensor, cells: Tensor, far: Tensor, starts: Tensor, grid: RadianceGrid
    ) -> Tensor:
        arrays = [value.detach().contiguous().numpy() for value in (origins, directions, starts, cells, far)]
        fixed = (*arrays[:4], grid.skips, arrays[4], grid.numbers, grid.times, grid.steps, np.float32(grid.unit))
        marched = _Marched(fixed, len(origins))
        is_kept = grid.training and any(ctx.needs_input_grad) and len(origins) <= KEPT_RAYS
        run_chunks(lambda first, last: marched.march(first, last, is_kept), marched.chunks)
        ctx.marched = marched
        return torch.from_numpy(marched.light)

    @staticmethod
    def backward(ctx: Any, slopes: Tensor) -> tuple[Tensor | None, ...]:
        marched = ctx.marched
        is_moved = ctx.needs_input_grad[0] or ctx.needs_input_grad[1]
        moved = np.empty((2, len(marched.light) if is_moved else 0, 3), np.float32)
        by_light = np.ascontiguousarray(slopes.numpy())
        every = MOVED_EVERY if len(marched.light) >= MANY_MOVED else 1
        found = run_chunks(lambda *part: marched.back(*part, by_light, every, moved), marched.chunks)
        by_cells, by_far = found[0]
        for own_cells, own_far in found[1:]:
            by_cells += own_cells
            by_far += own_far
        by_origins, by_directions = (torch.from_numpy(part) if is_moved else None for part in moved)
        return by_origins, by_directions, torch.from_numpy(by_cells), torch.from_numpy(by_far), None, None


class _Marched:
    """Rays that were marched: their light, and what is kept of each chunk of them for the way back."""

    def __init__(self, fixed: Any, n: int) -> None:
        self.fixed, self.light, self.left = fixed, np.empty((n, 3), np.float32), np.empty(n, np.float32)
        n_chunks = 1 if n <= FEW_RAYS else MANY_CHUNKS
        self.chunks = chunks(n, max(1, -(-n // n_chunks))) or [(0, 0)]  # a picture may show no glass
        self.kept: dict[int, tuple[NDArray[np.float32], NDArray[np.int64]]] = {}

    def march(self, first: int, last: int, is_kept: bool) -> None:
        march: Any = kernels.march
        n_places, n_rays = ((last - first) * len(self.fixed[7]), len(self.light)) if is_kept else (0, 0)
        kept = np.empty((n_places, kernels.KEPT), np.float32), np.empty(n_rays, np.int64)
        march(*self.fixed, first, last, self.light, self.left, *kept)
        if is_kept:
            self.kept[first] = kept

    def back(
        self, first: int, last: int, slopes: NDArray[np.float32], every: int, moved: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Gradients by cells and far light, of a chunk."""
        origins, directions, _, cells, _, far, numbers = self.fixed[:7]
        march_back: Any = kernels.march_back
        own = np.zeros_like(cells), np.zeros_like(far)
        for begin, end in [(first, last)] if first in self.kept else _ranges(first, last, KEPT_RAYS):
            if first not in self.kept:
                self.march(begin, end, True)
            march_back(
                origins, directions, cells, far, numbers, begin, end, self.light, self.left, *self.kept.pop(begin),
                slopes, *own, every, *moved,
            )  # fmt: skip
        return own


def _ranges(first: int, last: int, size: int) -> list[tuple[int, int]]:
    """Half-open ranges of at most `size` that make up one."""
    return [(first + begin, first + end) for begin, end in chunks(last - first, size)]


class _Rough(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, cells: Tensor, density: float, light: float, emptier: float) -> Tensor:
        ctx.save_for_backward(cells)
        ctx.factors = density, light, emptier
        return torch.zeros(())

    @staticmethod
    def backward(ctx: Any, slope: Tensor) -> tuple[Tensor | None, ...]:
        values = ctx.saved_tensors[0].detach().numpy()
        density, light, emptier = (factor * float(slope) for factor in ctx.factors)
        amounts = np.array([density, light, light, light], np.float32)
        corners = np.array(CORNERS, np.float32)
        slopes = np.empty_like(values)
        size = max(1, -(-len(values) // MANY_CHUNKS))
        run_chunks(
            lambda first, last: kernels.rough(values, amounts, corners, np.float32(emptier), first, last, slopes),
            chunks(len(values), size),
        )
        return torch.from_numpy(slopes), None, None, None
