"""A radiance grid: what glass mirrors as a scene, density and light that mirrored rays march through.

It tells what is near from what is far by parallax, where the Reflection MLP memorises places and directions, and so
needs fewer photos. Where density is, and how far away what is seen is, is learned from colours alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_cdt, maximum_filter
from torch import Tensor, nn
from torch.nn.functional import grid_sample, interpolate

from planning.base.jit import chunks, run_chunks
from reconstruction.light import radiance_grid_kernels as kernels
from reconstruction.light.config import GridSettings
from reconstruction.light.glass_rays import GlassRays

# Where a radiance grid of the surroundings lies, and how fine it is: as the photos call for.

NEAR_SHARE = 0.98
"""Of the places along mirrored rays that the inner box has to hold, along each axis."""

REACH = 2.5
"""Of half the longest side of the box around all panels, where nothing else is asked for."""

LEAST_CELLS = 512
"""Of a grid, however few rays there are."""

LEAST_SHARE = 0.05
"""Of the inner box's longest side that the others have at least."""


@dataclass(frozen=True, slots=True)
class GridBox:
    """A box that is turned about the vertical, in the units that places are rescaled to.

    Cells are equally large inside; around, up to infinity, they grow with the square of the distance.

    Parameters
    ----------
    heading_rad
        Of its y axis, clockwise from north.
    middle, halves
        Of the inner box; `middle` in rescaled ENU, `halves` along its own axes.
    counts
        Vertices along x, y and z, the outer ones with them.
    outer
        Extent of what is around the inner box in the grid, of half the inner box, on each side.
    reach
        Along rays, up to which steps are equally long; beyond they grow with the way.
    """

    heading_rad: float
    middle: tuple[float, float, float]
    halves: tuple[float, float, float]
    counts: tuple[int, int, int]
    outer: float
    reach: float

    def __post_init__(self) -> None:
        if min(self.counts) < 2:
            raise ValueError(f"counts: expected at least 2 along each axis, got {self.counts}")
        numbers = (self.heading_rad, *self.middle, *self.halves, self.outer, self.reach)
        if not all(map(math.isfinite, numbers)) or min(*self.halves, self.outer, self.reach) <= 0.0:
            raise ValueError("expected finite numbers, and halves, outer and reach above 0")

    def turned(self, enu: Tensor, back: bool = False) -> Tensor:
        """ENU places or directions, shape (..., 3), in the box's axes; or `back`. Never in half precision."""
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad) * (-1.0 if back else 1.0)
        x, y, z = enu.unbind(dim=-1)
        return torch.stack([c * x - s * y, s * x + c * y, z], dim=-1)

    def cell(self, counts: tuple[int, int, int]) -> float:
        """Shortest side of an inner cell with so many vertices."""
        return min(2.0 * h * (1.0 + self.outer) / (n - 1) for h, n in zip(self.halves, counts, strict=True))

    def counts_at(self, level: int) -> tuple[int, int, int]:
        """Vertices along x, y and z, halved so many times."""
        x, y, z = (max(2, -(-n // (1 << level))) for n in self.counts)
        return x, y, z


def box_around(
    points: Tensor, omega_r: Tensor, normals: Tensor, reach: float, cell: float, outer: float, most_cells: int
) -> GridBox:
    """The box that holds mirrored rays up to a distance.

    Parameters
    ----------
    points, omega_r, normals
        Rescaled places on glass, unit directions of mirrored rays, and panels' normals, shape (n, 3), of a few
        thousand rays.
    reach
        Rescaled distance from the glass.
    cell
        Rescaled target side of a cell; larger where that would take more than `most_cells`.
    """
    mean = normals.double().mean(dim=0)
    heading = math.atan2(float(mean[0]), float(mean[1])) if float(mean[:2].norm()) > 0.1 else 0.0
    level = GridBox(heading, (0, 0, 0), (1, 1, 1), (2, 2, 2), outer, 1.0)
    shares = torch.linspace(0.0, 1.0, 9, dtype=torch.float64)
    places = points.double()[:, None] + reach * shares[:, None] * omega_r.double()[:, None]
    own = level.turned(places).reshape(-1, 3)
    tails = torch.tensor([0.5 - 0.5 * NEAR_SHARE, 0.5 + 0.5 * NEAR_SHARE], dtype=torch.float64)
    low, high = torch.quantile(own, tails, dim=0)
    halves = (0.5 * (high - low)).clamp(min=LEAST_SHARE * 0.5 * float((high - low).max()))
    widths = 2.0 * halves * (1.0 + outer)
    side = max(cell, float((widths.prod() / most_cells) ** (1 / 3)))
    x, y, z = (max(4, math.ceil(float(width) / side) + 1) for width in widths)
    east, north, up = level.turned(0.5 * (low + high), back=True).tolist()
    a, b, c = halves.tolist()
    return GridBox(heading, (east, north, up), (a, b, c), (x, y, z), outer, reach)


def box_of(rays: GlassRays, settings: GridSettings, n_rays: int) -> GridBox:
    """The box that these rays call for, a few thousand of the `n_rays` that are learned from."""
    table, hits, middle = rays.table, rays.hits(), rays.middle()
    half_m = float(table.half_side_m)
    reach_m = settings.reach_m or REACH * half_m
    covered_m = float(((hits.distances_m + 0.5 * reach_m) / table.lenses[rays.photos, 0]).median())
    return box_around(
        middle.points,
        middle.omega_r,
        table.normals[rays.panels],
        reach_m / half_m,
        settings.cell * covered_m / half_m,
        settings.outer,
        max(LEAST_CELLS, min(settings.most_cells, round(n_rays / settings.rays_per_cell))),
    )


# Marching rays through a grid of density and light in plain torch: readable, and for graphics cards.
#
# Every ray visits all of its places, whether anything is there or not, so it takes more time and memory than the
# kernels.

DENSITY_SCALE, OPAQUE = 10.0, 1e-3
"""As of the kernels."""


def march(
    origins: Tensor, directions: Tensor, starts: Tensor, cells: Tensor, skips: Tensor, far: Tensor, box: Tensor,
    times: Tensor, steps: Tensor, unit: float,
) -> tuple[Tensor, Tensor]:  # fmt: skip
    """Light, shape (n, 3), and share of it that comes from far away, shape (n,); arguments as those of the kernel."""
    visited = times + starts[:, None] * steps
    places = origins[:, None, :] + visited[..., None] * directions[:, None, :]
    inside = (places - box[:3]) * box[3:6]
    sizes = torch.tensor(cells.shape[2::-1], dtype=cells.dtype, device=cells.device)
    corners = (contracted(inside, box[6]) / (1.0 + box[6]) * 0.5 + 0.5) * (sizes - 1.0)
    values = interpolated(cells, corners)
    raw = DENSITY_SCALE * values[..., 0]
    base = torch.minimum(corners.detach().long(), sizes.long() - 2).unbind(dim=-1)
    is_there = (skips[base[2], base[1], base[0]] == 0) & (raw > -1.0)
    density = torch.where(is_there, ramp(raw) * unit * steps, torch.zeros_like(raw))
    passed = torch.cumsum(density, dim=1)
    reached = torch.cat([torch.ones_like(passed[:, :1]), torch.exp(-passed[:, :-1])], dim=1)
    # The place at which a ray becomes opaque still counts, all further ones do not.
    shares = torch.where(reached >= OPAQUE, reached * -torch.expm1(-density), torch.zeros_like(density))
    left = 1.0 - shares.sum(dim=1)
    near = (shares[..., None] * values[..., 1:].square()).sum(dim=1)
    return near + left[:, None] * far_light(far, directions), left


def ramp(raw: Tensor) -> Tensor:
    """0 up to -1, raw from 1 on, a parabola in between."""
    return torch.where(raw >= 1.0, raw, (0.5 * (raw + 1.0)).clamp(min=0.0, max=1.0).square())


def contracted(values: Tensor, outer: Tensor | float) -> Tensor:
    """-1 to 1 stays; what is beyond, up to infinity, goes on to 1 + `outer` on either side."""
    size = values.abs().clamp(min=1.0)
    return torch.where(values.abs() <= 1.0, values, values.sign() * (1.0 + outer * (1.0 - 1.0 / size)))


def interpolated(cells: Tensor, corners: Tensor) -> Tensor:
    """Linear between vertices, shape (n, s, 4), at places (n, s, 3) counted in cells along x, y and z."""
    sizes = torch.tensor(cells.shape[2::-1], dtype=corners.dtype, device=corners.device)
    places = (corners / (sizes - 1.0) * 2.0 - 1.0)[None, :, :, None, :]
    found = grid_sample(
        cells.permute(3, 0, 1, 2)[None], places, mode="bilinear", padding_mode="border", align_corners=True
    )
    return found[0, :, :, :, 0].permute(1, 2, 0)


def unfolded(directions: Tensor) -> Tensor:
    """Places, -1 to 1, shape (n, 2), of directions in a square picture of all of them: an octahedron folded out."""
    plain = directions[:, :2] / directions.abs().sum(dim=1, keepdim=True)
    signs = torch.where(plain >= 0.0, 1.0, -1.0).to(plain.dtype)
    return torch.where(directions[:, 2:] < 0.0, (1.0 - plain.abs().flip(1)) * signs, plain)


def far_light(far: Tensor, directions: Tensor) -> Tensor:
    """Light from far away, shape (n, 3), linear between pixels of square roots of light, over edges too."""
    side = len(far)
    places = (unfolded(directions) + 1.0) * (0.5 * side) - 0.5
    first = torch.floor(places.detach())
    a, b = (places - first).unbind(dim=1)
    column, row = first.long().unbind(dim=1)
    flat = far.reshape(-1, 3)
    root = (
        ((1.0 - a) * (1.0 - b))[:, None] * flat[wrapped(column, row, side)]
        + (a * (1.0 - b))[:, None] * flat[wrapped(column + 1, row, side)]
        + ((1.0 - a) * b)[:, None] * flat[wrapped(column, row + 1, side)]
        + (a * b)[:, None] * flat[wrapped(column + 1, row + 1, side)]
    )
    return root.square()


def wrapped(columns: Tensor, rows: Tensor, side: int) -> Tensor:
    """Numbers of pixels, also of those one step over an edge: each edge meets itself, turned about."""
    is_off = (columns < 0) | (columns >= side)
    columns, rows = columns.clamp(0, side - 1), torch.where(is_off, side - 1 - rows, rows)
    is_off = (rows < 0) | (rows >= side)
    rows, columns = rows.clamp(0, side - 1), torch.where(is_off, side - 1 - columns, columns)
    return rows * side + columns


def roughness(cells: Tensor, amounts: Tensor, corners: Tensor) -> Tensor:
    """Huber's function of neighbours' differences, straight from `corners` on, times a factor for each channel."""
    total = torch.zeros((), dtype=cells.dtype, device=cells.device)
    for axis in range(3):
        size = cells.diff(dim=axis).abs()
        bent = torch.where(size < corners, 0.5 * size.square() / corners, size - 0.5 * corners)
        total = total + (amounts * bent).sum()
    return total


FOLLOWED = 8192
"""Rays at a time that distances are found along: about 100 MB."""

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
        return march(origins, directions, starts, self.cells, skips, self.far, numbers, times, steps, self.unit)[0]

    @torch.no_grad()
    def distances(self, points: Tensor, omega_r: Tensor) -> Tensor:
        """How far away is what rays show: half of their light comes from nearer, shape (n,); inf where it never does.

        Parameters
        ----------
        points, omega_r
            As for `forward`, on the processor; distances are rescaled as places are.
        """
        times, steps = torch.from_numpy(self.times), torch.from_numpy(self.steps)
        box, sizes = torch.from_numpy(self.numbers), torch.tensor(self._counts(), dtype=torch.float32)
        middles, density = times + 0.5 * steps, self.cells[..., :1]
        found = torch.full((len(points),), torch.inf)
        for start, stop in chunks(len(points), FOLLOWED):
            origins, directions = (self.box.turned(part[start:stop].float()) for part in (points, omega_r))
            inside = (origins[:, None] + middles[:, None] * directions[:, None] - box[:3]) * box[3:6]
            corners = (contracted(inside, box[6]) / (1.0 + box[6]) * 0.5 + 0.5) * (sizes - 1.0)
            raw = DENSITY_SCALE * interpolated(density, corners)[..., 0]
            stopped = torch.cumsum(ramp(raw) * self.unit * steps, dim=1) > math.log(2.0)
            found[start:stop] = torch.where(stopped.any(dim=1), middles[stopped.float().argmax(dim=1)], torch.inf)
        return found

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
            return roughness(self.cells, amounts, corners) + emptier * self.cells[..., 0].sum()
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
            picture = edged(self.far)
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


def edged(picture: Tensor) -> Tensor:
    """A picture of all directions with a rim of one pixel around it, from where its edges meet themselves."""
    side = len(picture)
    row, column = torch.meshgrid(torch.arange(-1, side + 1), torch.arange(-1, side + 1), indexing="ij")
    return picture.reshape(-1, 3)[wrapped(column, row, side)]


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
