"""From the grids of one facade in several photos to its panels in 3-D."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit, changed
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.search.cells import PARTS, from_lower_left
from reconstruction.panels.search.cutting import Cut, cut_pieces, four_corners
from reconstruction.panels.search.record import FacadeGrid, InclinedLine
from reconstruction.panels.solving.adjustment import LEAST_SIGMA_M, UNKNOWN_POSE, Adjusted, adjust
from reconstruction.panels.solving.association import FALSE_LINE, MISSED, LineGroup, associate, observed_lines
from reconstruction.panels.solving.record import SolvedFacade, SolvedPanel, SurfaceInclined, SurfaceLine

Array = NDArray[np.float64]


# Panels of a facade between its adjusted lines, those that inclined profiles cut included, with covariances.

STEP = 1e-5
"""Of the surface's parameters, for derivatives: metres and radians."""

ON_EDGE_M = 5e-3
"""From a profile's edge to a corner that lies on it: the fourth of a triangle lies outside by millimetres."""


def facade_panels(
    facade_id: str,
    adjusted: Adjusted,
    columns: Sequence[SurfaceLine],
    rows: Sequence[SurfaceLine],
    missing: set[tuple[int, int]],
    inclined: Sequence[SurfaceInclined] = (),
) -> tuple[SolvedPanel, ...]:
    """Panels row by row from the lower left; parts of a cut cell have letters behind the cell's name.

    Parameters
    ----------
    adjusted
        Its positions are those of the columns, then of the rows.
    missing
        Cells (row, column) that are no panels.
    """
    cuts = [line.cut() for line in inclined]
    panels: list[SolvedPanel] = []
    for row, (below, above) in enumerate(pairwise(rows)):
        for column, (left, right) in enumerate(pairwise(columns)):
            s0, s1 = left.position_m + 0.5 * left.width_m, right.position_m - 0.5 * right.width_m
            t0, t1 = below.position_m + 0.5 * below.width_m, above.position_m - 0.5 * above.width_m
            if (row, column) in missing or s1 <= s0 or t1 <= t0:
                continue
            box = np.array([(s0, t0), (s1, t0), (s1, t1), (s0, t1)])
            crossing = [(line, cut) for line, cut in zip(inclined, cuts, strict=True) if cut.crosses(box)]
            sure = min(line.confidence for line in (below, above, left, right))
            sure = min([sure, *(line.confidence for line, _ in crossing)])
            name = f"{facade_id}-{row + 1:02d}-{column + 1:02d}"
            for number, piece in enumerate(cut_pieces(box, cuts) if cuts else [box]):
                is_cut = piece is not box
                outline = from_lower_left(piece, np.array([0.0, 1.0])) if is_cut else piece
                corners = four_corners(outline)
                covariance = _covariances(
                    adjusted, corners, outline, box, (row, column), len(columns), crossing if is_cut else []
                )
                panels.append(
                    SolvedPanel(
                        name + (PARTS[number % len(PARTS)] if is_cut else ""),
                        row,
                        column,
                        adjusted.surface.to_enu(corners),
                        covariance,
                        sure,
                        adjusted.surface.to_enu(outline) if len(outline) != 4 else None,
                    )
                )
    return tuple(panels)


def _covariances(
    adjusted: Adjusted,
    corners: Array,
    outline: Array,
    box: Array,
    cell: tuple[int, int],
    n_columns: int,
    crossing: Sequence[tuple[SurfaceInclined, Cut]],
) -> Array:
    """Covariances of corners, shape (n, 3, 3), ENU.

    A corner moves with the four lines of its cell as far as it lies between them, with the surface, and along the other
    edge that it belongs to where an inclined profile moves against the grid.
    """
    surface = adjusted.surface
    n_lines, n_all = len(adjusted.positions_m), len(adjusted.covariance)
    design = np.zeros((len(corners), 3, n_all))
    share = (corners - box[0]) / (box[2] - box[0])
    right, up = surface.right_at(corners), np.broadcast_to(surface.up_enu, (len(corners), 3))
    first_row = n_columns + cell[0]
    design[:, :, cell[1]], design[:, :, cell[1] + 1] = (1.0 - share[:, :1]) * right, share[:, :1] * right
    design[:, :, first_row], design[:, :, first_row + 1] = (1.0 - share[:, 1:]) * up, share[:, 1:] * up
    for i in range(n_all - n_lines):
        step = np.zeros(n_all - n_lines)
        step[i] = STEP
        ahead, behind = changed(surface, step).to_enu(corners), changed(surface, -step).to_enu(corners)
        design[:, :, n_lines + i] = (ahead - behind) / (2.0 * STEP)
    found = design @ adjusted.covariance @ design.transpose(0, 2, 1)
    for line, cut in crossing:
        for index, move in enumerate(_moves(corners, outline, cut)):
            moved = move[0] * right[index] + move[1] * up[index]
            found[index] += line.sigma_m**2 * np.outer(moved, moved)
    return np.asarray(found, float)


def _moves(corners: Array, outline: Array, cut: Cut) -> Array:
    """How far each corner moves, shape (n, 2), where a profile moves by one across its direction; 0 off its edges."""
    along = (cut.last - cut.first) / np.linalg.norm(cut.last - cut.first)
    across = np.array([-along[1], along[0]])
    moves = np.zeros((len(corners), 2))
    for index, corner in enumerate(corners):
        if abs(abs(float(cut.signed(corner[None])[0])) - cut.half_width) > ON_EDGE_M:
            continue
        moves[index] = across
        (at,) = np.nonzero((outline == corner).all(axis=1))
        if len(at):
            beside = outline[[at[0] - 1, (at[0] + 1) % len(outline)]] - corner
            other = beside[np.argmax(np.abs(beside @ across) / np.linalg.norm(beside, axis=1))]
            if abs(other @ across) > 0.0:
                moves[index] = other / (other @ across)
    return moves


# Inclined profiles of a facade on its surface, from the photos that show them.
#
# The grid's lines have been adjusted by then, and the poses with them: an inclined line is where the adjusted poses
# put
# it, on the average of its photos. On a cylinder it is straight in the arc's length and the height, as it is built.

TOGETHER = 0.3
"""Of the narrowest panel: lines of two photos whose ends are closer than this to one another are one."""

MOST_SURE = 0.99


@dataclass(frozen=True, slots=True, eq=False)
class _PhotoLine:
    """One photo's line: ends from left to right (upright ones upwards), shape (2, 2)."""

    photo: int
    ends_st_m: Array
    width_m: float
    sigma_m: float
    confidence: float
    open_side: int


def surface_inclined(
    photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], adjusted: Adjusted, narrowest_m: float
) -> tuple[SurfaceInclined, ...]:
    """Inclined profiles with a confidence of one half at least.

    Parameters
    ----------
    grids
        By the number of their photo.
    narrowest_m
        Narrowest panel of the grid.
    """
    seen: list[_PhotoLine] = []
    for number, grid in grids.items():
        photo = replace(photos[number], pose=adjusted.poses.get(number, photos[number].pose))
        seen += [one for line in grid.inclined if (one := _photo_line(photo, number, grid, adjusted, line)) is not None]
    groups: list[list[_PhotoLine]] = []
    for one in sorted(seen, key=lambda line: -line.confidence):
        for group in groups:
            if all(one.photo != other.photo for other in group) and _is_same(one, group[0], TOGETHER * narrowest_m):
                group.append(one)
                break
        else:
            groups.append([one])
    cast = {number: _covered(photos[number], grid, adjusted, number) for number, grid in grids.items()}
    found = (_joined(group, cast) for group in groups)
    return tuple(line for line in found if line.confidence >= 0.5)


def _photo_line(
    photo: PosedPhoto, number: int, grid: FacadeGrid, adjusted: Adjusted, line: InclinedLine
) -> _PhotoLine | None:
    ends = np.array([line.first_px, line.last_px])
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    across = np.array([-along[1], along[0]])
    middle = ends.mean(axis=0)
    points = np.array([ends[0], ends[1], middle - 0.5 * across, middle + 0.5 * across])
    st = adjusted.surface.hits(*photo.rays(grid.rectification.to_photo(points)))
    if not np.isfinite(st).all():
        return None
    m_per_px = float(np.linalg.norm(st[3] - st[2]))
    # t rises where y falls, so what is to the right of a walk along the line changes sides.
    first, last, side = st[0], st[1], -line.open_side
    if (last - first) @ (1.0, 1e-3) < 0.0:
        first, last, side = last, first, -side
    sigma = max(line.sigma_px * m_per_px, LEAST_SIGMA_M)
    return _PhotoLine(number, np.array([first, last]), line.width_px * m_per_px, sigma, line.confidence, side)


def _is_same(one: _PhotoLine, other: _PhotoLine, tolerance_m: float) -> bool:
    """Whether each line's ends lie on the other's course, and their stretches have a part in common."""
    cut = Cut(other.ends_st_m[0], other.ends_st_m[1], 0.0)
    if np.abs(cut.signed(one.ends_st_m)).max() > tolerance_m:
        return False
    along = other.ends_st_m[1] - other.ends_st_m[0]
    places = (one.ends_st_m - other.ends_st_m[0]) @ along / (along @ along)
    return bool(places.max() > 0.0 and places.min() < 1.0)


def _covered(photo: PosedPhoto, grid: FacadeGrid, adjusted: Adjusted, number: int) -> Array:
    """Lowest and highest s and t of a photo's grid, shape (2, 2); NaN where it has none."""
    if len(grid.rows) < 2 or len(grid.columns) < 2:
        return np.full((2, 2), np.nan)
    x = [grid.columns[i].position_px for i in (0, -1)]
    y = [grid.rows[i].position_px for i in (0, -1)]
    posed = replace(photo, pose=adjusted.poses.get(number, photo.pose))
    corners = grid.rectification.to_photo(np.array([(a, b) for a in x for b in y]))
    st = adjusted.surface.hits(*posed.rays(corners))
    return np.array([st.min(axis=0), st.max(axis=0)])


def _joined(group: Sequence[_PhotoLine], covered: Mapping[int, Array]) -> SurfaceInclined:
    """The mean line of several photos, from its outermost end to the other."""
    base = group[0].ends_st_m
    along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
    across = np.array([-along[1], along[0]])
    places = np.array([(one.ends_st_m - base[0]) @ along for one in group])
    low, high = float(places.min()), float(places.max())
    weights = np.array([one.sigma_m**-2 for one in group])
    offsets = np.array([_offsets_at(one, base[0], along, across, (low, high)) for one in group])
    mean = weights @ offsets / weights.sum()
    first, last = (base[0] + u * along + off * across for u, off in zip((low, high), mean, strict=True))
    middle = 0.5 * (first + last)
    covering = sum(bool((box[0] <= middle).all() and (middle <= box[1]).all()) for box in covered.values())
    sure = np.clip([one.confidence for one in group], 1.0 - MOST_SURE, MOST_SURE)
    odds = float(np.log(sure / (1.0 - sure)).sum())
    odds += max(0, covering - len(group)) * float(np.log(MISSED / (1.0 - FALSE_LINE)))
    return SurfaceInclined(
        (float(first[0]), float(first[1])),
        (float(last[0]), float(last[1])),
        float(np.median([one.width_m for one in group])),
        float(max(LEAST_SIGMA_M, weights.sum() ** -0.5)),
        float(1.0 / (1.0 + np.exp(-odds))),
        int(np.sign(sum(one.open_side for one in group))),
        len(group),
    )


def _offsets_at(one: _PhotoLine, origin: Array, along: Array, across: Array, places: tuple[float, float]) -> Array:
    """Offsets of a photo's line from the base line at two places along it, shape (2,)."""
    u, off = (one.ends_st_m - origin) @ along, (one.ends_st_m - origin) @ across
    slope = (off[1] - off[0]) / (u[1] - u[0])
    return np.array([off[0] + slope * (place - u[0]) for place in places])


REACH_SIGMAS = 3.0
"""How far a photo's grid may lie off, in standard deviations of its pose; two photos may lie off to opposite sides."""


def solve_facade(
    facade_id: str, photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], fit: SurfaceFit
) -> SolvedFacade:
    """Panels of one facade.

    Parameters
    ----------
    grids
        By the number of their photo.
    fit
        The facade's surface: its plane or its cylinder, as the scene calls for.

    Raises
    ------
    InfeasibleError
        No photo shows a grid of at least one panel on this surface.
    """
    seen = [
        line for number, grid in grids.items() for line in observed_lines(photos[number], number, grid, fit.surface)
    ]
    groups = associate(seen, 2.0 * max((reach_m(photos[number], fit.surface) for number in grids), default=0.0))
    n_columns = sum(group.axis == "column" for group in groups)
    if min(n_columns, len(groups) - n_columns) < 2:
        raise InfeasibleError(say("facade {}: no photo shows a grid with at least one panel", facade_id))
    adjusted = adjust(photos, fit, groups)
    is_row = np.array([group.axis == "row" for group in groups])
    order = np.lexsort((adjusted.positions_m, is_row))
    groups = tuple(groups[i] for i in order)
    adjusted = _ordered(adjusted, order)
    columns, rows = (_surface_lines(groups, adjusted, axis) for axis in ("column", "row"))
    missing = _missing(photos, grids, adjusted, groups)
    narrowest = min(float(np.diff([line.position_m for line in lines]).min()) for lines in (columns, rows))
    inclined = surface_inclined(photos, grids, adjusted, narrowest)
    panels = facade_panels(facade_id, adjusted, columns, rows, missing, inclined)
    return SolvedFacade(facade_id, adjusted.surface, rows, columns, panels, adjusted.pose_changes, inclined)


def reach_m(photo: PosedPhoto, surface: FacadeSurface) -> float:
    """How far the grid of a photo may lie off on a surface, metres, by the covariance of its pose."""
    covariance = UNKNOWN_POSE if photo.pose.covariance is None else photo.pose.covariance
    distance = abs(float(surface.height_m(photo.pose.position_enu_m[None])[0]))
    position = float(np.linalg.eigvalsh(covariance[:3, :3]).max())
    turn = float(np.linalg.eigvalsh(covariance[3:, 3:]).max())
    return REACH_SIGMAS * float(np.sqrt(max(0.0, position) + max(0.0, turn) * distance**2))


def _ordered(adjusted: Adjusted, order: NDArray[np.int64]) -> Adjusted:
    n = len(order)
    full = np.concatenate([order, np.arange(n, len(adjusted.covariance))])
    return Adjusted(
        adjusted.surface,
        adjusted.positions_m[order],
        adjusted.covariance[np.ix_(full, full)],
        adjusted.poses,
        adjusted.pose_changes,
        adjusted.residual,
    )


def _surface_lines(groups: Sequence[LineGroup], adjusted: Adjusted, axis: str) -> tuple[SurfaceLine, ...]:
    return tuple(
        SurfaceLine(
            position_m=float(adjusted.positions_m[i]),
            width_m=float(np.median([line.width_m for line in group.members])),
            sigma_m=float(np.sqrt(max(0.0, adjusted.covariance[i, i]))),
            confidence=group.confidence,
            n_photos=len(group.members),
        )
        for i, group in enumerate(groups)
        if group.axis == axis
    )


def _missing(
    photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], adjusted: Adjusted, groups: Sequence[LineGroup]
) -> set[tuple[int, int]]:
    """Cells that most of the photos which show them say are no panels."""
    columns = np.array([adjusted.positions_m[i] for i, group in enumerate(groups) if group.axis == "column"])
    rows = np.array([adjusted.positions_m[i] for i, group in enumerate(groups) if group.axis == "row"])
    votes: Counter[tuple[int, int]] = Counter()
    for number, grid in grids.items():
        photo = photos[number]
        for sign, cells in ((-1, [panel.corners_px.mean(axis=0) for panel in grid.panels]), (1, _middles(grid))):
            if not cells:
                continue
            st = adjusted.surface.hits(*photo.rays(np.array(cells)))
            for s, t in st[np.isfinite(st).all(axis=1)]:
                votes[int(np.searchsorted(rows, t)) - 1, int(np.searchsorted(columns, s)) - 1] += sign
    return {cell for cell, count in votes.items() if count > 0}


def _middles(grid: FacadeGrid) -> list[Array]:
    """Middles, in the photo, of the cells that are no panels."""
    n = len(grid.rows)
    points = [
        (
            0.5 * (grid.columns[column].position_px + grid.columns[column + 1].position_px),
            0.5 * (grid.rows[n - 2 - row].position_px + grid.rows[n - 1 - row].position_px),
        )
        for row, column in grid.missing
    ]
    found = grid.rectification.to_photo(np.array(points)) if points else np.zeros((0, 2))
    return [point for point in found if np.isfinite(point).all()]
