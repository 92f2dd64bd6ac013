"""How far a grid reaches: the stretch its lines are seen along, and border cells that its other lines do not enter."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.search.record import GridLine

Array = NDArray[np.float64]

LEAST_SHARE = 0.4
"""Of the usual support of crossing lines, that the cells of a border must show. Walls and skies beside a facade show
under 0.2, the weakest border columns of glass 0.6."""

USUAL_QUANTILE = 0.75
"""Of the cells' support that is taken as usual: where half of the cells are not the facade, the median is theirs."""

NEAR_PX = 1.5
"""From a line's edge to a pixel that supports it."""


def best_stretch(values: Array) -> tuple[int, int]:
    """Start and stop of the consecutive values with the largest sum; everything where none is positive."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    stop = int(np.argmax(sums - np.minimum.accumulate(sums)))
    start = int(np.argmin(sums[: stop + 1]))
    return (start, stop) if stop > start else (0, values.size)


def crossing_support(is_edge: NDArray[np.bool_], lines: tuple[GridLine, ...], crossing: tuple[GridLine, ...]) -> Array:
    """Share of each piece of a line that has an edge.

    Parameters
    ----------
    is_edge
        Shape (h, w): edges along the direction of `lines`, the columns of this picture.
    lines
        Along the columns of the picture.
    crossing
        The other direction's: pieces of lines lie between them.

    Returns
    -------
    Array
        Shape (len(lines), len(crossing) - 1), the better edge of each line counting.
    """
    height = is_edge.shape[0]
    support = np.zeros((len(lines), max(0, len(crossing) - 1)))
    for i, line in enumerate(lines):
        for seen in seen_along(is_edge, line):
            sums = np.concatenate([[0.0], np.cumsum(seen)])
            for j, (a, b) in enumerate(pairwise(crossing)):
                start = int(np.clip(a.position_px + a.width_px / 2 + 2.0, 0, height))
                stop = int(np.clip(b.position_px - b.width_px / 2 - 2.0, 0, height))
                if stop > start:
                    support[i, j] = max(support[i, j], (sums[stop] - sums[start]) / (stop - start))
    return support


def seen_along(is_edge: NDArray[np.bool_], line: GridLine) -> NDArray[np.bool_]:
    """Whether either edge of a line along the columns is seen in each row, shape (2, h)."""
    height, width = is_edge.shape
    seen = np.zeros((2, height), bool)
    for side, sign in enumerate((-0.5, 0.5)):
        x = line.position_px + sign * line.width_px
        low, high = max(0, round(x - NEAR_PX - 0.5)), min(width, round(x + NEAR_PX + 0.5))
        if low < high:
            seen[side] = is_edge[:, low:high].any(axis=1)
    return seen


def crossed_by(
    is_edge: NDArray[np.bool_], lines: tuple[GridLine, ...], between_px: tuple[float, float]
) -> Array | None:
    """How much of the inner lines along the columns is seen in each row, as a multiple of the usual, shape (h,).

    None where there are no inner lines, or nothing of them is seen.
    """
    if len(lines) < 3:
        return None
    seen = np.mean([seen_along(is_edge, line).any(axis=0) for line in lines[1:-1]], axis=0)
    usual = float(np.median(seen[int(between_px[0]) : int(between_px[1]) + 1]))
    return np.asarray(seen / usual) if usual > 0.0 else None


def kept_cells(support: Array) -> slice:
    """Cells between crossing lines that lie on the facade: the stretch of cells with most support.

    Parameters
    ----------
    support
        Of inner lines, shape (n_lines, n_cells), from `crossing_support`; without any line nothing is cut.
    """
    n_lines, n_cells = support.shape
    if n_lines == 0 or n_cells < 2:
        return slice(0, n_cells)
    seen = support.mean(axis=0)
    return slice(*best_stretch(seen - LEAST_SHARE * float(np.quantile(seen, USUAL_QUANTILE))))
