"""Facades whose photos do not agree, searched in all photos at once: an effect that the scene calls for or not."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, GridLine
from reconstruction.panels.search.segment import segment_views
from reconstruction.panels.solving.association import associate
from reconstruction.panels.solving.facades import Facade
from reconstruction.panels.solving.observations import seen_lines
from reconstruction.panels.solving.record import SeenLine
from reconstruction.panels.solving.register import registered
from reconstruction.panels.solving.solve import reach_m

Array = NDArray[np.float64]
LoadPhoto = Callable[[PosedPhoto], NDArray[np.uint8]]

DOUBTFUL = 0.25
"""Sightings that may be missing. A photo misses one line in five (`association.MISSED`), and lines that it shows have a
confidence of 0.9 and more."""

COST_S_PER_PHOTO = 0.7
"""To bring a photo onto the others and to search it again with them: one core, windows of 700 to 1000 px."""

LEAST_AGREEMENT = 0.3
"""Of a photo's edges with the first photo's. Photos brought onto it to a pixel had 0.35 and more, those that ended on
other lines 0.2 and more: some of these are kept, and are outvoted."""

FAINTER = 0.55
"""Of the share of a line that must be seen: what is mirrored lies elsewhere in each photo and drowns less."""

LEAST_SIDE_PX = 60
"""Of the window: smaller ones have no cells to bring photos together by."""

LEAST_OF_ALL = 0.05
"""The least that `SegmentationParameters` takes."""

LEAST_LEFT = 0.5
"""A grid found in all photos at once counts if it has at least this share of the cells that single photos show."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundSingly:
    """What was found in the photos of a facade one by one: `grids` by the number of the photo."""

    photos: Sequence[PosedPhoto]
    grids: Mapping[int, FacadeGrid]
    surface: FacadeSurface


@dataclass(frozen=True, slots=True)
class Fusion:
    """Search all photos of a facade at once: where one by one they show no grid, or each another one."""

    name: str = "photos searched together"
    unit: str = "of the sightings"
    tolerance: float = DOUBTFUL

    def assess(self, scene: FoundSingly) -> Assessment:
        """The share of sightings that is missing: of each line in each photo that shows its place."""
        n = len(scene.grids)
        if n < 2:
            return Assessment(0.0, "there is one photo", 0.0)
        n_bare = sum(len(grid.rows) < 2 or len(grid.columns) < 2 for grid in scene.grids.values())
        bare = f", {n_bare} of them without a grid" if n_bare else ""
        return Assessment(doubt(scene), f"how far {n} photos disagree on their lines{bare}", COST_S_PER_PHOTO * n)


def doubt(found: FoundSingly) -> float:
    """Share of sightings that is missing, 0 to 1, each counted by its confidence.

    Every photo that shows the place of a line should show the line; a line that the others outvote counts as one that
    is missing.
    """
    lines = [
        line
        for number, grid in found.grids.items()
        for line in seen_lines(found.photos[number], number, grid, found.surface)
    ]
    reach = max((reach_m(found.photos[number], found.surface) for number in found.grids), default=0.0)
    groups = associate(lines, 2.0 * reach)
    n_looks = len(lines) - sum(len(group.members) for group in groups)
    shown = 0.0
    for group in groups:
        shown += sum(line.confidence for line in group.members)
        places = found.surface.to_enu(_along(group.members))
        seeing = {number for number in found.grids if found.photos[number].sees(places).mean() >= 0.5}
        n_looks += len(seeing | {line.photo for line in group.members})
    return 1.0 - shown / n_looks if n_looks else 1.0


def _along(members: Sequence[SeenLine]) -> Array:
    """Ends and middle of a line on the surface, metres, shape (3, 2)."""
    across = np.full(3, np.median([line.position_m for line in members]))
    along = np.linspace(min(line.from_m for line in members), max(line.to_m for line in members), 3)
    return np.column_stack([across, along] if members[0].axis == "column" else [along, across])


@dataclass(frozen=True, slots=True, eq=False)
class FusedSearch:
    """What was found in several photos at once.

    Parameters
    ----------
    grids
        By the number of the photo: the same lines in each, through its own view.
    moved_px
        How far photos were moved in the rectified picture to lie on the first, the largest.
    """

    grids: dict[int, FacadeGrid]
    moved_px: float


def search_together(
    photos: Sequence[PosedPhoto],
    facade: Facade,
    numbers: Sequence[int],
    load: LoadPhoto,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> FusedSearch | None:
    """Find the panels of one facade in several photos at once; None where they show no grid together.

    A line is one look at all photos, so that each photo answers for its part only: of the line's log odds, and of its
    standard deviation.

    Parameters
    ----------
    numbers
        Of the photos, the most useful first: the others are brought onto it.
    """
    views = _same_window(photos, facade, numbers, parameters.long_side_px)
    if len(views) < 2 or min(min(view.width_px, view.height_px) for view in views.values()) < LEAST_SIDE_PX:
        return None
    images = []
    for done, number in enumerate(views):
        monitor.report(say("fuse views"), done, len(views))
        images.append(load(photos[number]))
    placed = registered(images, list(views.values()), parameters.seed)
    kept = [i for i, one in enumerate(placed) if one.agreement >= LEAST_AGREEMENT]
    if len(kept) < 2:
        return None
    fainter = replace(parameters, least_seen=max(LEAST_OF_ALL, FAINTER * parameters.least_seen))
    found = segment_views([images[i] for i in kept], [placed[i].view for i in kept], fainter, monitor, facade_id)
    if len(found[0].rows) < 2 or len(found[0].columns) < 2:
        return None
    order = list(views)
    grids = {order[i]: _part(grid, len(kept)) for i, grid in zip(kept, found, strict=True)}
    return FusedSearch(grids, max(placed[i].moved_px for i in kept))


def holds_enough(together: FusedSearch, singly: Mapping[int, FacadeGrid]) -> bool:
    """Whether the grid of all photos has not lost most of what single photos show."""
    least = LEAST_LEFT * float(np.median([_n_cells(grid) for grid in singly.values()]))
    return _n_cells(next(iter(together.grids.values()))) >= least


def _n_cells(grid: FacadeGrid) -> int:
    return max(0, len(grid.rows) - 1) * max(0, len(grid.columns) - 1)


def _same_window(
    photos: Sequence[PosedPhoto], facade: Facade, numbers: Sequence[int], long_side_px: int
) -> dict[int, SurfaceView]:
    """Views of what any of the photos shows of the facade, at the finest of their scales, by the photo's number."""
    views = {}
    for number in numbers:
        try:
            views[number] = surface_view(photos[number], facade.fit.surface, facade.low_st_m, facade.high_st_m)
        except InfeasibleError:
            continue
    if not views:
        return {}
    low = np.min([view.low_st_m for view in views.values()], axis=0)
    high = np.max([view.high_st_m for view in views.values()], axis=0)
    px_per_m = min(max(view.px_per_m for view in views.values()), (long_side_px - 1) / float((high - low).max()))
    return {number: replace(view, low_st_m=low, high_st_m=high, px_per_m=px_per_m) for number, view in views.items()}


def _part(grid: FacadeGrid, n: int) -> FacadeGrid:
    """One photo's part of a grid that n photos show together."""
    rows, columns = (tuple(_part_of_line(line, n) for line in lines) for lines in (grid.rows, grid.columns))
    return facade_grid(grid.id, grid.rectification, rows, columns, grid.inclined)


def _part_of_line(line: GridLine, n: int) -> GridLine:
    inside = min(0.9999, max(0.0001, line.confidence))
    odds = (inside / (1.0 - inside)) ** (1.0 / n)
    return replace(line, confidence=odds / (1.0 + odds), sigma_px=line.sigma_px * float(np.sqrt(n)))
