"""Fronto-parallel pictures of facades with known lines, for tests of the search for lines."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """A picture and where its panels are: `columns` and `rows` hold start and end of each, shape (n, 2)."""

    picture: NDArray[np.uint8]
    columns: Array
    rows: Array


def spans(sizes: Array, frame_px: float, start_px: float) -> Array:
    """Panels of given sizes with a frame before, between and after them."""
    starts = start_px + frame_px + np.concatenate([[0.0], np.cumsum(sizes[:-1] + frame_px)])
    return np.column_stack([starts, starts + sizes])


def draw(
    columns: Array,
    rows: Array,
    size: tuple[int, int],
    frame_px: float,
    seed: int = 0,
    reflection: float = 1.0,
    noise: float = 3.0,
    clutter: bool = True,
    frame_grey: float = 60.0,
) -> Drawn:
    """Panels with reflections of their own in a frame before a background; `size` is (width, height)."""
    rng = np.random.default_rng(seed)
    width, height = size
    fine = 4
    world = _world(rng, 3 * max(width, height))
    canvas = np.full((height * fine, width * fine), 170.0, np.float32)
    if clutter:
        canvas = cv2.resize(world[:height, :width], (width * fine, height * fine), interpolation=cv2.INTER_NEAREST)
    outer = [columns[0, 0] - frame_px, columns[-1, 1] + frame_px, rows[0, 0] - frame_px, rows[-1, 1] + frame_px]
    x0, x1, y0, y1 = (round(v * fine) for v in outer)
    canvas[max(0, y0) : y1, max(0, x0) : x1] = frame_grey
    for top, bottom in rows:
        for left, right in columns:
            a, b, c, d = (round(v * fine) for v in (left, right, top, bottom))
            shift = rng.integers(0, max(width, height), 2)
            piece = world[shift[1] :, shift[0] :][: (d - c) // fine + 2, : (b - a) // fine + 2]
            glass = cv2.resize(piece, (b - a, d - c), interpolation=cv2.INTER_LINEAR)
            canvas[c:d, a:b] = 40.0 + reflection * 0.8 * glass
    small = cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA)
    small = cv2.GaussianBlur(small, (0, 0), 0.6) + rng.normal(0.0, noise, small.shape)
    return Drawn(np.clip(small, 0, 255).astype(np.uint8), columns, rows)


def _world(rng: np.random.Generator, side: int) -> NDArray[np.float32]:
    """What is reflected: sky, blocks with sharp edges, bright spots."""
    world = np.tile(np.linspace(230.0, 120.0, side, dtype=np.float32)[:, None], (1, side))
    for _ in range(150):
        x, y = rng.integers(0, side, 2)
        w, h = rng.integers(20, 300, 2)
        world[y : y + h, x : x + w] = rng.uniform(10.0, 250.0)
    return world
