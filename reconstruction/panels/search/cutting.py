"""Cells cut by inclined profiles: plane geometry in any unit, in the picture as well as on the facade."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_PIECE = 0.03
"""Of a cell's area: smaller pieces are where three profiles meet, no panes."""

LEAST_CROSSED = 0.5
"""Of its way through a cell, that a profile must run along to cut it."""

LEAST_BEYOND = 0.03
"""Of the cell's shorter side, that lies beyond both edges of a profile which cuts it: one from corner to corner of a
cell touches the corners of those beside it, too."""


BULGE = 1e-3
"""Of a triangle's longest side, that the fourth corner in its middle lies outside it: corners of a site are rounded to
0.1 mm, and must still go round a convex panel then."""


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """An inclined profile.

    Parameters
    ----------
    first, last
        Ends of its middle, shape (2,).
    half_width
        From its middle to its edges.
    open_side
        0 with panels on both sides, else the sign that `signed` has where they are.
    """

    first: Array
    last: Array
    half_width: float
    open_side: int = 0

    def signed(self, points: Array) -> Array:
        """Distances of points, shape (n, 2), from its middle, shape (n,)."""
        along, off = self.last - self.first, points - self.first
        return np.asarray((along[0] * off[:, 1] - along[1] * off[:, 0]) / np.hypot(*along))

    def crosses(self, box: Array) -> bool:
        """Whether it runs through a convex polygon, shape (k, 2), from border to border."""
        off = self.signed(box)
        beyond = self.half_width + LEAST_BEYOND * float(np.linalg.norm(np.roll(box, -1, axis=0) - box, axis=1).min())
        if off.min() > -beyond or off.max() < beyond:
            return False
        following, next_off = np.roll(box, -1, axis=0), np.roll(off, -1)
        through = (off >= 0.0) != (next_off >= 0.0)
        share = (off / np.where(through, off - next_off, 1.0))[through, None]
        crossings = box[through] + share * (following - box)[through]
        along = self.last - self.first
        places = np.sort((crossings - self.first) @ along / (along @ along))
        if len(places) < 2:
            return False
        inside = min(places[-1], 1.0) - max(places[0], 0.0)
        return bool(inside >= LEAST_CROSSED * (places[-1] - places[0]))

    def closes(self, point: Array) -> bool:
        """Whether there are no panels at a point, shape (2,): it lies beyond this profile, seen level or upright."""
        if not self.open_side or self.open_side * float(self.signed(point[None])[0]) > 0.0:
            return False
        low, high = np.minimum(self.first, self.last), np.maximum(self.first, self.last)
        return bool(((point >= low) & (point <= high)).any())


def cut_pieces(box: Array, cuts: Sequence[Cut], is_outer: bool = False) -> list[Array]:
    """What profiles leave of a cell: the cell itself, its pieces, or nothing beyond the facade's edge.

    Parameters
    ----------
    box
        A convex polygon, shape (k, 2).
    is_outer
        Cut at the far edges of the profiles instead of the near ones, and only along the facade's edge: the cell with
        its frames.

    Returns
    -------
    list
        Polygons, shape (k, 2) each, that turn as the cell does.
    """
    crossing = [cut for cut in cuts if cut.crosses(box)]
    middle = box.mean(axis=0)
    if any(cut.closes(middle) for cut in cuts if cut not in crossing):
        return []
    pieces = [box]
    for cut in crossing:
        if is_outer and not cut.open_side:
            continue
        sides = (cut.open_side,) if cut.open_side else (1, -1)
        edge = -cut.half_width if is_outer else cut.half_width
        pieces = [clipped(piece, side * cut.signed(piece) - edge) for piece in pieces for side in sides]
        pieces = [piece for piece in pieces if len(piece) > 2]
    least = LEAST_PIECE * abs(area(box))
    return [piece for piece in pieces if abs(area(piece)) >= least]


def clipped(polygon: Array, off: Array) -> Array:
    """The part of a convex polygon, shape (k, 2), where a linear function, given at its corners, is not negative."""
    following, next_off = np.roll(polygon, -1, axis=0), np.roll(off, -1)
    kept = []
    for here, there, at_here, at_there in zip(polygon, following, off, next_off, strict=True):
        if at_here >= 0.0:
            kept.append(here)
        if at_here * at_there < 0.0:
            kept.append(here + (there - here) * at_here / (at_here - at_there))
    return np.array(kept).reshape(-1, 2)


def area(polygon: Array) -> float:
    """Signed area of a polygon, shape (k, 2)."""
    x, y = polygon[:, 0], polygon[:, 1]
    return float(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def four_corners(polygon: Array) -> Array:
    """Four corners for a convex polygon, shape (k, 2) or (k, 3): what the format of sites has room for.

    Three corners get a fourth in the middle of the longest side; of five and more, the four with the largest area stay.
    """
    n = len(polygon)
    if n == 3:
        longest = int(np.argmax(np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)))
        first, last, opposite = (polygon[(longest + step) % 3] for step in range(3))
        side, middle = last - first, 0.5 * (first + last)
        outwards = middle - opposite
        outwards = outwards - (outwards @ side) / (side @ side) * side
        bulge = BULGE * float(np.linalg.norm(side)) * outwards / np.linalg.norm(outwards)
        return np.insert(polygon, longest + 1, middle + bulge, axis=0)
    if n == 4:
        return polygon

    choices = [polygon[list(chosen)] for chosen in combinations(range(n), 4)]
    return choices[int(np.argmax([_squared_area(*choice) for choice in choices]))]


def _squared_area(a: Array, b: Array, c: Array, d: Array) -> float:
    """Square of twice the area of a convex quadrilateral in the plane or in space, from its diagonals."""
    p, q = c - a, d - b
    return float((p @ p) * (q @ q) - (p @ q) ** 2)
