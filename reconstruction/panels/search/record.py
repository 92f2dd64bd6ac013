"""What was found in one photo: lines of the facade's grid, panels between them, how sure each is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from reconstruction.panels.rectify.surface import Rectification

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class GridLine:
    """One line of a facade's grid in the rectified view: a frame profile (mullion or transom), or a bare joint.

    Parameters
    ----------
    position_px
        Middle of the profile: y of a horizontal line, x of a vertical one.
    width_px
        From edge to edge; panels end at its edges. 0 for a joint thinner than can be seen.
    sigma_px
        Standard deviation of the position.
    confidence
        From 0 to 1: how sure it is that there is a line.
    is_inferred
        True for a line that was not seen but follows from the spacing of the others.
    """

    position_px: float
    width_px: float = 0.0
    sigma_px: float = 1.0
    confidence: float = 1.0
    is_inferred: bool = False


@dataclass(frozen=True, slots=True)
class InclinedLine:
    """A straight profile that runs neither along rows nor along columns, in the rectified view.

    Parameters
    ----------
    first_px, last_px
        Ends of its middle, (x, y). It crosses every cell of the grid between them from border to border.
    width_px
        From edge to edge; panels end at its edges.
    sigma_px
        Standard deviation of its middle, across it.
    confidence
        From 0 to 1: how sure it is that there is a line.
    open_side
        On which side there are panels: 0 on both; along a gable only to the right of a walk from first to last (1), as
        the picture shows it, or only to the left (-1).
    """

    first_px: tuple[float, float]
    last_px: tuple[float, float]
    width_px: float = 0.0
    sigma_px: float = 1.0
    confidence: float = 1.0
    open_side: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class FoundPanel:
    """A panel in a photo.

    Parameters
    ----------
    row, column
        From the bottom row and the left column, from 0.
    corners_px
        Shape (k, 2), in the photo; k is 4 but for irregular panels: lower left, lower right, upper right, upper left,
        which is counter-clockwise as seen from outside, the order of a site's panels.
    confidence
        The least of its lines.
    part
        0 for a whole cell; parts of a cell that inclined lines cut count from 1.
    """

    id: str
    row: int
    column: int
    corners_px: Array
    confidence: float
    part: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class FacadeGrid:
    """One facade in one photo.

    Parameters
    ----------
    rows
        Horizontal lines from top to bottom in the rectified view.
    columns
        Vertical lines from left to right.
    missing
        Cells (row, column) of the grid that are no panels.
    inclined
        Profiles that cut cells of the grid.
    decision
        Why inclined lines were looked for, or not; None where there is no grid.
    network
        Why its panels are those of the network for panes, or not; None where it was not asked.
    """

    id: str
    rectification: Rectification
    rows: tuple[GridLine, ...]
    columns: tuple[GridLine, ...]
    panels: tuple[FoundPanel, ...]
    missing: tuple[tuple[int, int], ...] = ()
    inclined: tuple[InclinedLine, ...] = ()
    decision: Decision | None = None
    network: Decision | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """Everything found in one photo of `width_px` x `height_px`."""

    image: str
    width_px: int
    height_px: int
    facades: tuple[FacadeGrid, ...]

    @property
    def panels(self) -> tuple[FoundPanel, ...]:
        """Of all facades."""
        return tuple(panel for facade in self.facades for panel in facade.panels)
