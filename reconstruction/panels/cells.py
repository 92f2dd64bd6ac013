"""Panels of a facade between its adjusted lines, those that inclined profiles cut included, with covariances."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.adjustment import Adjusted
from reconstruction.panels.record import SolvedPanel, SurfaceInclined, SurfaceLine
from reconstruction.rectify.fit import changed
from reconstruction.segmentation.cells import PARTS, from_lower_left
from reconstruction.segmentation.cutting import Cut, cut_pieces, four_corners

Array = NDArray[np.float64]

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
