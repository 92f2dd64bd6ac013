"""Small scenes whose pictures can be worked out by hand: a pane, a board to be mirrored, ground, a camera between."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.geo.mesh import from_corners
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.record import Body, Glass, Layer, Panes, Scene, Sky, Texture
from tests.planning.plan_cases import kiosk

SQUARE_M = 0.5
BOARD_Y_M = -20.0
MIRROR = Glass(coating=0.8, tint=(1.0, 1.0, 1.0), sheets=1)
DULL = Sky(sun=(0.0, 0.0, 0.0), zenith=(0.5, 0.5, 0.5), horizon=(0.5, 0.5, 0.5))


def checkerboard() -> Texture:
    """Two by two squares of half a metre; the one at the lower left is dark."""
    light = np.kron(np.array([[0, 1], [1, 0]]), np.ones((32, 32)))
    return Texture(np.repeat(0.05 + 0.9 * light[:, :, None], 3, axis=2).astype(np.float32), 32 / SQUARE_M)


def ramp(length_m: float) -> Texture:
    """From dark to light to the right over a length."""
    row = np.linspace(0.0, 1.0, 1024, endpoint=False) + 0.5 / 1024
    return Texture(np.tile(row[None, :, None], (4, 1, 3)).astype(np.float32), 1024 / length_m)


def quad(corners: list[tuple[float, float, float]], name: str, layer: Layer, texture: Texture | None = None) -> Body:
    """A flat body of two triangles."""
    c = np.array(corners, float)
    return Body(name, layer, from_corners(np.array([c[[0, 1, 2]], c[[0, 2, 3]]])), (0.6, 0.6, 0.6), texture)


def board(y_m: float = BOARD_Y_M, half_m: float = 12.0, texture: Texture | None = None) -> Body:
    """An upright board in the south that faces north, its middle 10 m above the origin."""
    low, high = 10.0 - half_m, 10.0 + half_m
    corners = [(half_m, y_m, low), (-half_m, y_m, low), (-half_m, y_m, high), (half_m, y_m, high)]
    return quad(corners, "board", Layer.NEAR, texture or checkerboard())


def ground() -> Body:
    """Level, 200 m wide."""
    return quad([(-100, -100, 0), (100, -100, 0), (100, 100, 0), (-100, 100, 0)], "ground", Layer.GROUND)


def facing_south(width_m: float = 8.0, height_m: float = 6.0, columns: int = 1) -> NDArray[np.float64]:
    """Corners of panes side by side in the plane y = 0, their middle 10 m above the origin."""
    edges = np.linspace(-width_m / 2, width_m / 2, columns + 1)
    low, high = 10.0 - height_m / 2, 10.0 + height_m / 2
    pairs = itertools.pairwise(edges)
    return np.array([[(a, 0, low), (b, 0, low), (b, 0, high), (a, 0, high)] for a, b in pairs], float)


def panes(corners_enu_m: NDArray[np.float64], room: float = 0.1) -> Panes:
    """Flat panes of the first kind of glass."""
    m = len(corners_enu_m)
    return Panes(corners_enu_m, np.zeros((m, 2)), np.zeros((m, 2)), np.zeros(m, np.int64), np.full((m, 3), room))


def scene(
    *bodies: Body, corners: NDArray[np.float64] | None = None, glass: Glass = MIRROR, sky: Sky = DULL, room: float = 0.1
) -> Scene:
    """A scene of one kind of glass."""
    made = panes(facing_south() if corners is None else corners, room)
    return Scene("small", 0, kiosk(), bodies, made, (glass,), sky)


def with_panes(made: Scene, **changes: NDArray[np.float64]) -> Scene:
    """The scene with some of its panes' arrays changed."""
    return replace(made, panes=replace(made.panes, **changes))


def photo(
    position: tuple[float, float, float] = (0.0, -10.0, 10.0),
    heading_deg: float = 0.0,
    pitch_deg: float = 0.0,
    *,
    width_px: int = 256,
    height_px: int = 192,
    focal_px: float = 300.0,
) -> PosedPhoto:
    """A camera 10 m in front of the panes, looking at them."""
    lens = Intrinsics(width_px, height_px, focal_px, focal_px, width_px / 2, height_px / 2)
    return PosedPhoto("a.jpg", Path("a.jpg"), lens, Pose.looking(np.array(position), heading_deg, pitch_deg))
