"""The part of the world that a map shows: a centre, a zoom, and the size of the widget."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.web_mercator import MAX_ZOOM, TILE_POINTS, Tile, geodetic_from_world, metres_per_point

MIN_ZOOM = 0.0


@dataclass(frozen=True, slots=True)
class Viewport:
    """North is up. `centre` is in world coordinates (see `web_mercator`); x may lie beyond 0 to 1 near 180 E."""

    centre: tuple[float, float] = (0.5, 0.5)
    zoom: float = 1.0
    width_px: int = 1
    height_px: int = 1

    @property
    def scale(self) -> float:
        """Pixels that the width of the world would take."""
        return TILE_POINTS * math.exp2(self.zoom)

    @property
    def metres_per_px(self) -> float:
        """Metres from west to east that a pixel at the centre spans."""
        return metres_per_point(geodetic_from_world(*self.centre)[0], self.zoom)

    def screen(self, world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels, shape (n, 2), of world coordinates, shape (n, 2)."""
        # The difference comes first: at zoom 24 a pixel is 2e-10 of the world.
        return (world - self.centre) * self.scale + (self.width_px / 2.0, self.height_px / 2.0)

    def world(self, x_px: float, y_px: float) -> tuple[float, float]:
        """World coordinates of a pixel."""
        x = self.centre[0] + (x_px - self.width_px / 2.0) / self.scale
        return x, self.centre[1] + (y_px - self.height_px / 2.0) / self.scale

    def resized(self, width_px: int, height_px: int) -> Viewport:
        """The same centre in another size."""
        return replace(self, width_px=max(1, width_px), height_px=max(1, height_px))

    def panned(self, dx_px: float, dy_px: float) -> Viewport:
        """Everything moved on the screen by so much; the centre stays in the world from north to south."""
        x, y = self.centre[0] - dx_px / self.scale, self.centre[1] - dy_px / self.scale
        return replace(self, centre=(x, min(max(y, 0.0), 1.0)))

    def zoomed(self, levels: float, x_px: float, y_px: float) -> Viewport:
        """Nearer by so many levels; what is at the pixel stays there."""
        zoom = min(max(self.zoom + levels, MIN_ZOOM), float(MAX_ZOOM))
        held = self.world(x_px, y_px)
        nearer = replace(self, zoom=zoom)
        moved = nearer.world(x_px, y_px)
        return replace(
            nearer,
            centre=(self.centre[0] + held[0] - moved[0], min(max(self.centre[1] + held[1] - moved[1], 0.0), 1.0)),
        )

    def fitted(self, world: NDArray[np.float64], margin_px: float = 40.0, max_zoom: float = 21.0) -> Viewport:
        """All points, shape (n, 2), n >= 1, within the margins; a single point at `max_zoom`."""
        low, high = world.min(axis=0), world.max(axis=0)
        room = np.maximum([self.width_px - 2.0 * margin_px, self.height_px - 2.0 * margin_px], 20.0)
        widest = float(((high - low) / room).max())
        zoom = max_zoom if widest <= 0.0 else min(max_zoom, -math.log2(widest * TILE_POINTS))
        centre = (low + high) / 2.0
        return replace(self, centre=(float(centre[0]), float(centre[1])), zoom=max(MIN_ZOOM, zoom))

    def tiles(self, level: int) -> list[tuple[Tile, float, float]]:
        """Tiles of a level in sight, with the pixels of their upper left corners, the nearest to the centre first."""
        n = 2**level
        size_px = self.scale / n
        left, top = self.world(0.0, 0.0)
        right, bottom = self.world(self.width_px, self.height_px)
        found = []
        for row in range(max(0, math.floor(top * n)), min(n - 1, math.floor(bottom * n)) + 1):
            for column in range(math.floor(left * n), math.floor(right * n) + 1):
                corner = self.screen(np.array([[column / n, row / n]]))[0]
                found.append((Tile(level, column % n, row), float(corner[0]), float(corner[1])))
        middle = self.width_px / 2.0 - size_px / 2.0, self.height_px / 2.0 - size_px / 2.0
        return sorted(found, key=lambda tile: math.dist(tile[1:], middle))
