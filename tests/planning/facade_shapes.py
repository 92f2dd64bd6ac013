"""Facades whose sides geometry alone tells wrongly or not at all: two-sided, thin, and around courts and streets."""

from __future__ import annotations

import numpy as np

from planning.geo.frames import Vec3
from planning.site.bundled import panel_grid
from planning.site.records import Facade, Panel

Rectangle = tuple[Vec3, Vec3, Vec3]


def wall(low_left: tuple[float, float], low_right: tuple[float, float], top_m: float = 12.0) -> Rectangle:
    """Upright rectangle from the ground, its ends as seen from outside, left first."""
    (x0, y0), (x1, y1) = low_left, low_right
    return (x0, y0, 0.0), (x1, y1, 0.0), (x0, y0, top_m)


def around(x0: float, y0: float, x1: float, y1: float) -> list[Rectangle]:
    """Four walls of a block that face outwards."""
    return [wall((x0, y0), (x1, y0)), wall((x1, y0), (x1, y1)), wall((x1, y1), (x0, y1)), wall((x0, y1), (x0, y0))]


def inside(x0: float, y0: float, x1: float, y1: float) -> list[Rectangle]:
    """Four walls of a court that face inwards."""
    return [wall((x1, y0), (x0, y0)), wall((x1, y1), (x1, y0)), wall((x0, y1), (x1, y1)), wall((x0, y0), (x0, y1))]


SHAPES: dict[str, list[Rectangle]] = {
    "one wall": [wall((0, 0), (20, 0))],
    "both sides, 1 m thick": [wall((0, 0), (20, 0)), wall((20, 1), (0, 1))],
    "both sides, 0.3 m thick": [wall((0, 0), (20, 0)), wall((20, 0.3), (0, 0.3))],
    "block": around(0, 0, 20, 12),
    "court": inside(0, 0, 8, 8),
    "block with a court": [*around(0, 0, 20, 20), *inside(6, 6, 14, 14)],
    "street": [wall((20, 6), (0, 6)), wall((0, 12), (20, 12))],
}
"""By name; each facade has 3 x 5 panels."""


def facades(shape: str, at: tuple[float, float] = (0.0, 0.0), prefix: str = "") -> tuple[Facade, ...]:
    """Facades of a shape, moved to a place."""
    found = []
    for number, rectangle in enumerate(SHAPES[shape]):
        a, b, c = ((x + at[0], y + at[1], z) for x, y, z in rectangle)
        name = f"{prefix}{'ABCDEFGHIJ'[number]}"
        panels = panel_grid(name, (a, b, c), 3, 5, 0.2).panels
        found.append(Facade(name, tuple(Panel(p.id, p.corners_enu_m, p.id) for p in panels)))
    return tuple(found)


def normal(corners: object) -> np.ndarray:
    """Unit normal of four corners."""
    points = np.array(corners, float)
    vector = np.cross(points[2] - points[0], points[3] - points[1])
    return np.asarray(vector / np.linalg.norm(vector))
