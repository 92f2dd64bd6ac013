"""Where a radiance grid of the surroundings lies, and how fine it is: as the photos call for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from reconstruction.light.config import GridSettings
from reconstruction.light.glass_rays import GlassRays

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
        Rescaled side of a cell that is wished for; larger where that would take more than `most_cells`.
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
    table, met, middle = rays.table, rays.met(), rays.middle()
    half_m = float(table.half_side_m)
    reach_m = settings.reach_m or REACH * half_m
    covered_m = float(((met.distances_m + 0.5 * reach_m) / table.lenses[rays.photos, 0]).median())
    return box_around(
        middle.points,
        middle.omega_r,
        table.normals[rays.panels],
        reach_m / half_m,
        settings.cell * covered_m / half_m,
        settings.outer,
        max(LEAST_CELLS, min(settings.most_cells, round(n_rays / settings.rays_per_cell))),
    )
