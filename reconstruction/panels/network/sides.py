"""Sides of panes, measured again where the photo shows edges.

The network names corners to a tenth of a pane, and takes most panes for upright. The strip along each side that it
names is straightened; every straight line through it is a candidate. The one is taken that follows edges over most of
its length and lies not far from the side: first where the pane is small, then finer around the line found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.network.votes import Pane, Picture, signed_areas

Array = NDArray[np.float64]
Level = tuple[float, NDArray[np.float32]]
"""A smaller picture of the photo, and its pixels per pixel of the photo."""

SHRINK, LEAST_PX = 0.7, 200
"""Each level of the photo against the one before; none follows one whose longer side is below it."""

N_ALONG = 24
"""Places along a side at which edges are looked for."""

ENDS = 0.06
"""Of a side at either end where its neighbours' edges are."""

STEEP, STEEP_GREY = 0.9, 12.0
"""Quantile of the strip's steps that counts as an edge, and at least so many grey values over two pixels."""

LEAST_SEEN = 4
"""Places of a side within the photo from which on it is measured."""

FARTHEST = 2.5
"""Corners that move by more than so many reaches of a side: the lines found do not belong together."""


@dataclass(frozen=True, slots=True)
class _Pass:
    """How sides are looked for, lengths as shares of the pane's side.

    Parameters
    ----------
    side_px
        Size that panes have in the level that is looked at.
    reach
        Ends of candidate lines lie so far to either side.
    sigma, turn
        Usual distance of the true side, and usual difference between its two ends.
    weight
        Of a line that is once the usual distance off, against the share of it that follows edges.
    """

    side_px: float
    reach: float
    sigma: float
    turn: float
    weight: float


PASSES = (_Pass(40.0, 0.22, 0.10, 0.24, 0.5), _Pass(100.0, 0.06, 0.05, 0.10, 0.2))


def measured(panes: Sequence[Pane], image: Picture) -> list[Pane]:
    """Panes of a photo, shape (h, w, 3), with corners where lines along their edges meet."""
    if not panes:
        return []
    levels = _levels(image)
    corners = []
    for pane in panes:
        quad = pane.corners_px
        for how in PASSES:
            quad = _again(quad, levels, how)
        corners.append(quad)
    return [replace(pane, corners_px=quad) for pane, quad in zip(panes, corners, strict=True)]


def _levels(image: Picture) -> list[Level]:
    levels: list[Level] = [(1.0, image.astype(np.float32))]
    while max(levels[-1][1].shape[:2]) > LEAST_PX:
        larger = levels[-1][1]
        size = max(1, round(SHRINK * larger.shape[1])), max(1, round(SHRINK * larger.shape[0]))
        smaller = np.asarray(cv2.resize(larger, size, interpolation=cv2.INTER_AREA), np.float32)
        levels.append((size[0] / image.shape[1], smaller))
    return levels


def _again(quad: Array, levels: Sequence[Level], how: _Pass) -> Array:
    """Corners, shape (4, 2), by lines along all four sides; as they were where those do not meet near them."""
    side = float(np.sqrt(max(signed_areas(quad[None])[0], 1.0)))
    scale, picture = min(levels, key=lambda level: abs(np.log(level[0] * side / how.side_px)))
    scaled, size = quad * scale, side * scale
    reach = max(2, round(how.reach * size))
    lines = [_line(scaled[k], scaled[(k + 1) % 4], picture, reach, size, how) for k in range(4)]
    meeting = np.array([np.cross(lines[k - 1], lines[k]) for k in range(4)])
    if (np.abs(meeting[:, 2]) < 1e-9).any():
        return quad
    corners = meeting[:, :2] / meeting[:, 2:]
    is_far = np.abs(corners - scaled).max() > FARTHEST * reach
    if is_far or not cv2.isContourConvex(corners.astype(np.float32)):
        return quad
    return np.asarray(corners / scale)


def _line(a: Array, b: Array, picture: NDArray[np.float32], reach: int, size: float, how: _Pass) -> Array:
    """The line along a side from a to b, homogeneous, shape (3,), that follows most of an edge beside it."""
    along = b - a
    normal = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-9)
    share = np.linspace(ENDS, 1.0 - ENDS, N_ALONG)
    edges, is_seen = _edges(a + share[:, None] * along, normal, picture, reach)
    if is_seen.sum() < LEAST_SEEN:
        return np.cross([*a, 1.0], [*b, 1.0])
    ends = np.arange(-reach, reach + 1)
    first, last = (each.ravel() for each in np.meshgrid(ends, ends, indexing="ij"))
    path = np.rint(first[:, None] + (last - first)[:, None] * share[is_seen]).astype(int) + reach
    followed = edges[np.nonzero(is_seen)[0], path].mean(axis=1)
    off = (0.5 * (first + last) / (how.sigma * size)) ** 2 + ((last - first) / (how.turn * size)) ** 2
    best = int(np.argmax(followed - how.weight * off))
    return np.cross([*(a + first[best] * normal), 1.0], [*(b + last[best] * normal), 1.0])


def _edges(
    places: Array, normal: Array, picture: NDArray[np.float32], reach: int
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """How much of an edge there is at distances up to `reach` from places, 0 to 1, and which places are seen."""
    across = np.arange(-reach - 1, reach + 2)
    points = places[:, None] + across[:, None] * normal
    x, y = (np.ascontiguousarray(points[..., i] - 0.5, np.float32) for i in (0, 1))
    strip = np.asarray(cv2.remap(picture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.float32)
    inside = np.asarray(((points > 0.0) & (points < picture.shape[1::-1])).all(axis=-1))
    steps = np.abs(strip[:, 2:] - strip[:, :-2]).max(axis=-1)
    steps[~(inside[:, 2:] & inside[:, :-2])] = 0.0
    is_seen = np.asarray(inside.any(axis=1), bool)
    steep = float(np.quantile(steps[is_seen], STEEP)) if is_seen.any() else STEEP_GREY
    return np.asarray(np.minimum(steps / max(steep, STEEP_GREY), 1.0), np.float32), is_seen
