"""From panes one by one to the grids of facades: what the network says, weighed with how facades are built.

Panes of one facade have sides that run to two vanishing points. Seen straight on they stand in rows and columns, whose
edges most of them share; an edge is therefore measured by all panes along it, a pane that nothing else speaks for is
believed less than one that stands in a row, and a cell in which no pane was found, but most places say glass, is one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.site.importing.facades import facade_name
from reconstruction.panels.network.predictions import FoundPanes
from reconstruction.panels.network.votes import Pane, inside, weighted_median
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import vanishing_view
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.search.views import WholePicture

Array = NDArray[np.float64]

DIRECTION_RAD = np.radians(4.0)
"""A pane's sides point to the vanishing points of its facade to so much, beside what its corners are uncertain by."""

MOST_DIRECTION_RAD = np.radians(15.0)
"""However uncertain its corners are."""

N_PAIRS, N_NEAR = 300, 8
"""Pairs of panes that are tried as the start of a facade, each of one pane and one of so many next to it."""

MOST_FACADES = 60

APART = 3.0
"""Panes of one grid have a neighbour within so many of their own sizes."""

SAME = 0.2
"""Middles within so much of a pane's size are of one row or column."""

SNAP = 0.08
"""An edge within so much of a pane's size of the others' along its line is theirs; one farther off is its own."""

FILLED = 0.9
"""A cell without a pane is one where its places say so on average, and no pane lies on it."""

MANY = 4
"""Panes of a grid from which on they speak for one another."""


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """Panes whose sides run to the same two vanishing points, homogeneous, shape (3,) each."""

    panes: Sequence[Pane]
    level: Array
    upright: Array


def network_facades(found: FoundPanes, width_px: int, height_px: int, seed: int = 0) -> tuple[FacadeGrid, ...]:
    """Grids of the facades in a photo of that size, without a pose, the one with most panes first."""
    size = width_px, height_px
    left = list(found.panes)
    rng = np.random.default_rng(seed)
    grids: list[FacadeGrid] = []
    for _ in range(MOST_FACADES):
        if not left:
            break
        group = _largest(left, rng)
        view = _view(group, width_px, height_px)
        members = max(_apart(group.panes, view), key=lambda part: sum(pane.confidence for pane in part))
        left = [pane for pane in left if not any(pane is member for member in members)]
        grid = _grid(members, view, found, size)
        if grid is not None:
            grids.append(grid)
    grids.sort(key=lambda grid: -len(grid.panels))
    return tuple(_named(grid, facade_name(number)) for number, grid in enumerate(grids))


def grid_in_view(found: FoundPanes, view: Rectification, facade_id: str, size_px: tuple[int, int]) -> FacadeGrid:
    """The grid of a facade that is seen through a known view of a photo of `size_px`, width and height.

    It has no lines and no panels where the network found none.
    """
    grid = _grid(found.panes, view, found, size_px) if found.panes else None
    return _named(grid, facade_id) if grid is not None else FacadeGrid(facade_id, view, (), (), ())


def _named(grid: FacadeGrid, name: str) -> FacadeGrid:
    panels = tuple(replace(panel, id=f"{name}-r{panel.row}c{panel.column}") for panel in grid.panels)
    return replace(grid, id=name, panels=panels)


# Panes of one plane.


def _largest(panes: Sequence[Pane], rng: np.random.Generator) -> _Group:
    """The vanishing points that most panes agree with; one that goes with no other is a group of its own."""
    quads = np.stack([pane.corners_px for pane in panes])
    weight = np.array([pane.confidence for pane in panes])
    sigma = np.array([pane.sigma_px for pane in panes])
    n = len(panes)
    middles = quads.mean(axis=1)
    best: tuple[float, NDArray[np.bool_]] = (-1.0, np.zeros(n, bool))
    if n > 1:
        for first in rng.choice(n, N_PAIRS, p=weight / weight.sum()):
            nearest = np.argsort(np.abs(middles - middles[first]).max(axis=1))[1 : N_NEAR + 1]
            chosen = np.array([first, rng.choice(nearest)])
            off = _disagreement(quads, middles, sigma, *_points(quads[chosen]))
            total = float((weight * np.maximum(0.0, 1.0 - off**2)).sum())
            if total > best[0] and (off[chosen] < 1.0).all():
                best = total, off < 1.0
    if best[1].sum() < 2:
        best = 0.0, np.arange(n) == int(np.argmax(weight))
    members = np.nonzero(best[1])[0]
    for _ in range(3):  # all of them tell the points better than two do
        level, upright = _points(quads[members])
        again = np.nonzero(_disagreement(quads, middles, sigma, level, upright) < 1.0)[0]
        if len(again) < len(members) or np.array_equal(again, members):
            break
        members = again
    return _Group([panes[int(i)] for i in members], *_points(quads[members]))


def _points(quads: Array) -> tuple[Array, Array]:
    """Vanishing points of the level and of the upright sides of panes, shape (n, 4, 2)."""
    level = np.concatenate([quads[:, [0, 1]], quads[:, [3, 2]]])
    upright = np.concatenate([quads[:, [3, 0]], quads[:, [2, 1]]])
    return _meeting(level, quads), _meeting(upright, quads)


def _meeting(segments: Array, quads: Array) -> Array:
    """Where segments, shape (n, 2, 2), meet, as far as they do, homogeneous, shape (3,)."""
    middle, scale = quads.mean(axis=(0, 1)), float(np.ptp(quads, axis=(0, 1)).max()) + 1.0
    ends = (segments - middle) / scale
    a, b = (np.column_stack([ends[:, i], np.ones(len(ends))]) for i in (0, 1))
    lines = np.cross(a, b)  # as long as the segment: long ones count more
    _, _, turned = np.linalg.svd(lines)
    x, y, w = turned[2]
    return np.array([scale * x + middle[0] * w, scale * y + middle[1] * w, w])


def _disagreement(quads: Array, middles: Array, sigma: Array, level: Array, upright: Array) -> Array:
    """How far panes' sides point beside either point, in units of what is allowed, shape (n,)."""
    off = np.zeros(len(quads))
    for point, first, second in ((level, [0, 3], [1, 2]), (upright, [3, 2], [0, 1])):
        along = (quads[:, second] - quads[:, first]).sum(axis=1)
        length = np.linalg.norm(along, axis=1)
        towards = point[:2] - point[2] * middles
        cross = np.abs(along[:, 0] * towards[:, 1] - along[:, 1] * towards[:, 0])
        sine = cross / np.maximum(length * np.linalg.norm(towards, axis=1), 1e-12)
        allowed = np.minimum(DIRECTION_RAD + 2.0 * sigma / np.maximum(length, 1.0), MOST_DIRECTION_RAD)
        off = np.maximum(off, sine / np.sin(allowed))
    return off


def _view(group: _Group, width_px: int, height_px: int) -> Rectification:
    """The facade seen straight on; the photo itself where no such view follows from its panes."""
    region = np.concatenate([pane.corners_px for pane in group.panes])
    region = np.clip(region, [-0.2 * width_px, -0.2 * height_px], [1.2 * width_px, 1.2 * height_px])
    low, high = region.min(axis=0), region.max(axis=0)
    outline = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    try:
        view = vanishing_view(group.level, group.upright, width_px, height_px, region_px=outline)
    except (InfeasibleError, ValueError):
        return WholePicture(width_px, height_px)
    boxes = view.to_rectified(region)
    if not np.isfinite(boxes).all():
        return WholePicture(width_px, height_px)
    return view


def _apart(panes: Sequence[Pane], view: Rectification) -> list[list[Pane]]:
    """Panes that stand together, those with a gap between them apart."""
    boxes = np.stack([_box(pane, view) for pane in panes])
    reach = APART * np.median(np.stack([boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1]], axis=1), axis=0)
    label = np.full(len(panes), -1)
    for start in range(len(panes)):
        if label[start] >= 0:
            continue
        waiting = [start]
        label[start] = start
        while waiting:
            here = boxes[waiting.pop()]
            gap_x = np.maximum(boxes[:, 0] - here[2], here[0] - boxes[:, 2])
            gap_y = np.maximum(boxes[:, 1] - here[3], here[1] - boxes[:, 3])
            near = np.nonzero((label < 0) & (gap_x < reach[0]) & (gap_y < reach[1]))[0]
            label[near] = start
            waiting += near.tolist()
    return [[panes[int(i)] for i in np.nonzero(label == name)[0]] for name in np.unique(label)]


def _box(pane: Pane, view: Rectification) -> Array:
    """Left, top, right, bottom of a pane in the rectified view: the middles of its sides."""
    (a, b, c, d) = view.to_rectified(pane.corners_px)
    return np.array([0.5 * (a[0] + d[0]), 0.5 * (c[1] + d[1]), 0.5 * (b[0] + c[0]), 0.5 * (a[1] + b[1])])


# Rows and columns.


@dataclass(frozen=True, slots=True, eq=False)
class _Stripe:
    """A row or column: where its panes begin and end, and how much they scatter."""

    first: float
    last: float
    sigma: float
    members: NDArray[np.intp]


def _stripes(first: Array, last: Array, weight: Array) -> list[_Stripe]:
    """Rows or columns of panes that begin and end at these places, in rising order."""
    middle, size = 0.5 * (first + last), float(np.median(last - first))
    order = np.argsort(middle)
    breaks = np.nonzero(np.diff(middle[order]) > SAME * size)[0] + 1
    return [
        _Stripe(
            weighted_median(first[members], weight[members]),
            weighted_median(last[members], weight[members]),
            float(np.median(np.abs(first[members] - np.median(first[members])))) + 0.01 * size,
            members,
        )
        for members in np.split(order, breaks)
    ]


def _lines(stripes: Sequence[_Stripe], confidence: float) -> tuple[GridLine, ...]:
    """Lines between rows or columns, and one at either end."""
    gaps = [max(0.0, after.first - before.last) for before, after in pairwise(stripes)]
    usual = float(np.median(gaps)) if gaps else 0.1 * (stripes[0].last - stripes[0].first)
    sigma = float(np.median([stripe.sigma for stripe in stripes]))
    inner = [
        GridLine(0.5 * (before.last + after.first), gap, sigma, confidence)
        for (before, after), gap in zip(pairwise(stripes), gaps, strict=True)
    ]
    return (
        GridLine(stripes[0].first - 0.5 * usual, usual, sigma, confidence),
        *inner,
        GridLine(stripes[-1].last + 0.5 * usual, usual, sigma, confidence),
    )


def _grid(panes: Sequence[Pane], view: Rectification, found: FoundPanes, size_px: tuple[int, int]) -> FacadeGrid | None:
    """Panes that stand together as rows and columns; None where none of them is to be believed."""
    boxes = np.stack([_box(pane, view) for pane in panes])
    weight = np.array([pane.confidence for pane in panes])
    columns, rows = (_stripes(boxes[:, i], boxes[:, i + 2], weight) for i in (0, 1))
    column_of, row_of = _stripe_of(columns, len(panes)), _stripe_of(rows, len(panes))
    panels: dict[tuple[int, int], FoundPanel] = {}
    for i in np.argsort(-weight):
        place = len(rows) - 1 - int(row_of[i]), int(column_of[i])
        snapped = _snapped(boxes[i], columns[column_of[i]], rows[row_of[i]])
        corners = _corners(panes[i], snapped, view)
        if place not in panels:
            panels[place] = FoundPanel("", *place, corners, float(min(1.0, weight[i])))
    if len(panes) >= MANY:
        _fill(panels, rows, columns, view, found, size_px)
    cells = {(row, column) for row in range(len(rows)) for column in range(len(columns))}
    sure = float(np.mean([panel.confidence for panel in panels.values()]))
    ordered = tuple(panels[place] for place in sorted(panels))
    missing = tuple(sorted(cells - set(panels)))
    return FacadeGrid("", view, _lines(rows, sure), _lines(columns, sure), ordered, missing)


def _stripe_of(stripes: Sequence[_Stripe], n: int) -> NDArray[np.intp]:
    number = np.zeros(n, np.intp)
    for i, stripe in enumerate(stripes):
        number[stripe.members] = i
    return number


def _snapped(box: Array, column: _Stripe, row: _Stripe) -> Array:
    """A box whose edges are those of its row and column, where they nearly are anyway."""
    wide, high = box[2] - box[0], box[3] - box[1]
    result = box.copy()
    for i, stripe, shared, size in (
        (0, column, column.first, wide),
        (2, column, column.last, wide),
        (1, row, row.first, high),
        (3, row, row.last, high),
    ):
        if len(stripe.members) > 2 and abs(box[i] - shared) < SNAP * size:
            result[i] = shared
    return result


def _corners(pane: Pane, box: Array, view: Rectification) -> Array:
    """Corners in the photo, shape (4, 2), of a pane's box, or its own where the view does not fit it."""
    quad = view.to_photo(_corners_of(box))
    own = pane.corners_px
    side = np.sqrt(max(1.0, float(np.linalg.norm(own[1] - own[0]) * np.linalg.norm(own[3] - own[0]))))
    if not np.isfinite(quad).all() or np.abs(quad - own).max() > 0.25 * side:
        return own
    return quad


def _corners_of(box: Array) -> Array:
    left, top, right, bottom = box
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


def _fill(
    panels: dict[tuple[int, int], FoundPanel],
    rows: Sequence[_Stripe],
    columns: Sequence[_Stripe],
    view: Rectification,
    found: FoundPanes,
    size_px: tuple[int, int],
) -> None:
    """Add panels to cells that show none, where the network says glass all the same."""
    share = np.linspace(0.1, 0.9, 6)
    usual = [float(np.median([stripe.last - stripe.first for stripe in stripes])) for stripes in (columns, rows)]
    for from_top, row in enumerate(rows):
        for number, column in enumerate(columns):
            place = len(rows) - 1 - from_top, number
            if place in panels or min(len(row.members), len(column.members)) < 2:
                continue
            if column.last - column.first < 0.5 * usual[0] or row.last - row.first < 0.5 * usual[1]:
                continue
            x, y = np.meshgrid(
                column.first + share * (column.last - column.first), row.first + share * (row.last - row.first)
            )
            points = view.to_photo(np.column_stack([x.ravel(), y.ravel()]))
            corners = view.to_photo(_corners_of(np.array([column.first, row.first, column.last, row.last])))
            shown = np.isfinite(points).all(axis=1) & (points >= 0).all(axis=1) & (points < size_px).all(axis=1)
            if shown.mean() < 0.6 or not np.isfinite(corners).all() or _is_covered(points, panels.values()):
                continue
            sure = float(found.predictions.probability_at(points[shown]).mean())
            if sure >= FILLED:
                panels[place] = FoundPanel("", *place, corners, 0.7 * sure)


def _is_covered(points: Array, panels: Iterable[FoundPanel]) -> bool:
    """Whether any of these points, shape (n, 2), lies on a panel."""
    return any(inside(panel.corners_px, points).any() for panel in panels)
