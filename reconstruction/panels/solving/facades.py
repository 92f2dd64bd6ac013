"""Facades of a building, brought together from what single photos show of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision, EffectSetting, decide
from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.panels_file import OPEN_SIDES, FileFacade, FileInclined, FileLine, FilePanel, PanelsFile
from reconstruction.panels.rectify.fit import (
    Curvature,
    FacadePatch,
    FitParameters,
    FittedFacade,
    SurfaceFit,
    fit_cylinder,
    fit_plane,
)
from reconstruction.panels.rectify.surface import FacadeSurface, Rectification
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine, InclinedLine

Array = NDArray[np.float64]


SAME_SURFACE_M = 0.5
"""Median distance of one patch's points from another's surface up to which they may be one facade."""

SAME_SIDE = 0.9
"""Cosine between the normals of two patches of one facade where they meet."""

GAP_M = 3.0
"""Two parts of one wall further apart than this are two facades."""

SQUARE_ON = 0.4
"""Least cosine between the line of sight and the facade's normal for a photo to be searched for lines."""


@dataclass(frozen=True, slots=True, eq=False)
class Facade:
    """A facade and the photos that show it.

    Parameters
    ----------
    low_st_m, high_st_m
        Its extent on `fit.surface`, shape (2,).
    curvature
        Why that surface is a plane or a cylinder.
    photos
        Numbers of the photos that show it, the most useful first.
    """

    fit: SurfaceFit
    low_st_m: Array
    high_st_m: Array
    curvature: Decision
    photos: tuple[int, ...]


def building_facades(
    photos: Sequence[PosedPhoto],
    patches: Sequence[Sequence[FacadePatch]],
    curvature: EffectSetting = "auto",
    parameters: FitParameters | None = None,
) -> tuple[Facade, ...]:
    """Facades out of the patches of all photos, the one with the most points first.

    Parameters
    ----------
    patches
        Of each photo, as `facades_in_photo` finds them.
    """
    clusters: list[list[tuple[int, FacadePatch]]] = []
    listed = [(number, patch) for number, found in enumerate(patches) for patch in found]
    for number, patch in sorted(listed, key=lambda item: -item[1].share):
        home = next((cluster for cluster in clusters if any(_same(patch, other) for _, other in cluster)), None)
        if home is None:
            clusters.append([(number, patch)])
        else:
            home.append((number, patch))
    clusters.sort(key=lambda cluster: -sum(patch.share for _, patch in cluster))
    return tuple(_facade(photos, cluster, curvature, parameters or FitParameters()) for cluster in clusters)


def _same(one: FacadePatch, other: FacadePatch) -> bool:
    """Whether two patches lie on one surface, from both sides of the comparison, and touch or overlap."""
    return all(_lies_on(a, b) for a, b in ((one, other), (other, one)))


def _lies_on(patch: FacadePatch, other: FacadePatch) -> bool:
    surface = other.cylinder.surface
    st = surface.to_surface(patch.points_enu_m)
    inside = (st >= other.low_st_m - GAP_M) & (st <= other.high_st_m + GAP_M)
    near = np.asarray(inside.all(axis=1))
    if near.sum() < max(6, 0.02 * len(near)):
        return False
    close = float(np.median(np.abs(surface.height_m(patch.points_enu_m[near])))) < SAME_SURFACE_M
    own = patch.cylinder.surface
    facing = (own.normals_at(own.to_surface(patch.points_enu_m[near])) * surface.normals_at(st[near])).sum(axis=1)
    return close and float(np.median(facing)) > SAME_SIDE


def _facade(
    photos: Sequence[PosedPhoto],
    cluster: list[tuple[int, FacadePatch]],
    setting: EffectSetting,
    parameters: FitParameters,
) -> Facade:
    points = np.concatenate([patch.points_enu_m for _, patch in cluster])
    camera = np.mean([photos[number].pose.position_enu_m for number, _ in cluster], axis=0)
    plane, cylinder = fit_plane(points, camera, parameters), fit_cylinder(points, camera, parameters)
    low, high = _extent(cylinder.surface, points)
    scenes = [FittedFacade(photos[number], plane, cylinder, low, high) for number, _ in cluster]
    decision = max((decide(Curvature(), scene, setting) for scene in scenes), key=lambda found: found.size)
    fit = cylinder if decision.on else plane
    low, high = _extent(fit.surface, points)
    numbers = sorted(
        {number for number, _ in cluster}, key=lambda number: -_use(photos[number], fit.surface, low, high)
    )
    useful = tuple(number for number in numbers if _use(photos[number], fit.surface, low, high) > 0.0)
    return Facade(fit, low, high, decision, useful)


def _extent(surface: FacadeSurface, points: Array) -> tuple[Array, Array]:
    st = surface.to_surface(points)
    near = np.abs(surface.height_m(points)) < SAME_SURFACE_M
    return np.asarray(np.nanmin(st[near], axis=0), float), np.asarray(np.nanmax(st[near], axis=0), float)


def _use(photo: PosedPhoto, surface: FacadeSurface, low: Array, high: Array) -> float:
    """Pixels that a photo spends on the facade: of places on it, each weighed by its area in the photo."""
    s, t = np.meshgrid(np.linspace(low[0], high[0], 12), np.linspace(low[1], high[1], 12))
    st = np.column_stack([s.ravel(), t.ravel()])
    points = surface.to_enu(st)
    towards = photo.pose.position_enu_m - points
    distance = np.linalg.norm(towards, axis=1)
    cosine = (towards * surface.normals_at(st)).sum(axis=1) / np.maximum(distance, 1e-9)
    seen = photo.sees(points) & (cosine > SQUARE_ON)
    return float((cosine[seen] / distance[seen] ** 2).sum()) * photo.intrinsics.fx_px**2


# Grids that are given, as from a corrected panels file, in place of a search.

FILE_LINE_SIGMA_PX = 1.0
"""Standard deviation of a line that is given: what a hand can place in a photo."""

BESIDE_M = 2.0
"""Panels of a facade may lie so far beyond what the coarse model knows of it."""


def files_by_photo(photos: Sequence[PosedPhoto], files: Mapping[str, PanelsFile]) -> dict[int, PanelsFile]:
    """Panels files by the number of their photo.

    Parameters
    ----------
    files
        By the name of the photo's file.

    Raises
    ------
    InputError
        A file is about none of the photos, or about a picture of another size.
    """
    numbers = {PurePath(photo.name).name: number for number, photo in enumerate(photos)}
    found = {}
    for image, record in files.items():
        number = numbers.get(PurePath(image).name)
        if number is None:
            raise InputError(
                say(
                    "panels of photo '{}' are given, which is none of the {} photos that have a pose; name the "
                    "photo's file in its field 'image', or take the panels file out of the folder",
                    image,
                    len(photos),
                )
            )
        lens = photos[number].intrinsics
        if (record.width_px, record.height_px) != (lens.width_px, lens.height_px):
            raise InputError(
                say(
                    "panels of photo '{}' are given for {} x {} pixels, but it has {} x {}; find and correct them in "
                    "the photo itself",
                    image,
                    record.width_px,
                    record.height_px,
                    lens.width_px,
                    lens.height_px,
                )
            )
        found[number] = record
    return found


def grid_from_file(
    record: PanelsFile, photo: PosedPhoto, facade: Facade, view: Rectification, facade_id: str
) -> FacadeGrid | None:
    """What a file says about one facade, in a rectified view of it; None where it says nothing.

    The file's own facades are matched by where most of their panels lie. Lines count; panels tell their widths, and
    cells without a panel are none.

    Raises
    ------
    InputError
        A line of it has no point on the facade, or an inclined one leaves it.
    """
    on_it = [file_facade for file_facade in record.facades if file_facade.panels and _is_on(file_facade, photo, facade)]
    if not on_it:
        return None
    file_facade = max(on_it, key=lambda one: len(one.panels))
    rows = _lines(file_facade.horizontal_lines, view, 1, _gaps(file_facade, view, 1))
    columns = _lines(file_facade.vertical_lines, view, 0, _gaps(file_facade, view, 0))
    inclined = tuple(_inclined(line, index, view) for index, line in enumerate(file_facade.inclined_lines))
    whole_grid = facade_grid(facade_id, view, rows, columns, inclined)
    matched = [_matching_panel(whole_grid, panel) for panel in file_facade.panels]
    panels = tuple(panel for panel in whole_grid.panels if panel in matched)
    cells = {(row, column) for row in range(len(rows) - 1) for column in range(len(columns) - 1)}
    present = {(panel.row, panel.column) for panel in panels}
    return FacadeGrid(facade_id, view, rows, columns, panels, tuple(sorted(cells - present)), inclined)


def _matching_panel(grid: FacadeGrid, file_panel: FilePanel) -> FoundPanel | None:
    """The panel of the given one's cell that lies nearest to it: cells may be cut."""
    same_cell = [panel for panel in grid.panels if (panel.row, panel.column) == (file_panel.row, file_panel.column)]
    middle = np.mean(file_panel.corners_px, axis=0)
    return min(same_cell, key=lambda panel: float(np.linalg.norm(panel.corners_px.mean(axis=0) - middle)), default=None)


def _inclined(line: FileInclined, index: int, view: Rectification) -> InclinedLine:
    left, right = (view.to_rectified(np.array(points)) for points in (line.left_px, line.right_px))
    middle = 0.5 * (left + right)
    if not np.isfinite(middle).all():
        raise InputError(
            say("inclined_lines[{}] of a panels file leaves the facade; shorten it, or take it out", index)
        )
    first, last = middle[0], middle[-1]
    along = (last - first) / np.hypot(*(last - first))
    width = float(np.median((right - left) @ np.array([-along[1], along[0]])))
    open_side = OPEN_SIDES[line.panels]
    ends = (float(first[0]), float(first[1])), (float(last[0]), float(last[1]))
    return InclinedLine(*ends, abs(width), FILE_LINE_SIGMA_PX, line.confidence, open_side)


def _is_on(file_facade: FileFacade, photo: PosedPhoto, facade: Facade) -> bool:
    middles = np.array([np.mean(panel.corners_px, axis=0) for panel in file_facade.panels])
    surface: FacadeSurface = facade.fit.surface
    st = surface.hits(*photo.rays(middles))
    with np.errstate(invalid="ignore"):
        inside = ((st >= facade.low_st_m - BESIDE_M) & (st <= facade.high_st_m + BESIDE_M)).all(axis=1)
    return bool(inside.mean() > 0.5)


def _lines(
    file_lines: Sequence[FileLine], view: Rectification, across: int, widths: Mapping[int, float]
) -> tuple[GridLine, ...]:
    usual = float(np.median(list(widths.values()))) if widths else 0.0
    lines = []
    for index, line in enumerate(file_lines):
        places = view.to_rectified(np.array(line.points_px).reshape(-1, 2))[:, across]
        places = places[np.isfinite(places)]
        if not len(places):
            kind = "vertical_lines" if across == 0 else "horizontal_lines"
            raise InputError(
                say(
                    "{}[{}] of a panels file has no point on the facade; give it points_px, or take the line out",
                    kind,
                    index,
                )
            )
        width = widths.get(index, usual)
        lines.append(GridLine(float(np.median(places)), width, FILE_LINE_SIGMA_PX, line.confidence, line.inferred))
    return tuple(sorted(lines, key=lambda line: line.position_px))


def _gaps(file_facade: FileFacade, view: Rectification, across: int) -> dict[int, float]:
    """Widths of the profiles between panels, by the line's index: what is left between the panels beside it."""
    ends: dict[tuple[int, int], tuple[float, float]] = {}
    for panel in file_facade.panels:
        places = view.to_rectified(np.array(panel.corners_px))[:, across]
        if len(panel.corners_px) == 4 and np.isfinite(places).all():
            low, high = np.sort(places).reshape(2, 2).mean(axis=1)
            ends[_place(panel, file_facade.rows, across)] = float(low), float(high)
    gaps: dict[int, list[float]] = {}
    for (along, order), (_, high) in ends.items():
        beyond = ends.get((along, order + 1))
        if beyond is not None:
            gaps.setdefault(order + 1, []).append(max(0.0, beyond[0] - high))
    return {index: float(np.median(found)) for index, found in gaps.items()}


def _place(panel: FilePanel, n_rows: int, across: int) -> tuple[int, int]:
    """Place of a panel along the lines and across them, from left to right or from top to bottom."""
    from_top = n_rows - 1 - panel.row
    return (from_top, panel.column) if across == 0 else (panel.column, from_top)
