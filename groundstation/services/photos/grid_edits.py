"""Corrections of found panels: lines and panels near a hand, moved, added and removed; panels drawn into other photos.

A correction is made in the rectified view of one photo, and meant for the facade. It is carried over to the other
photos of the facade by what the last solution knows of their poses; the grids of all of them are then solved again.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.found_panels import GridPlace, PanelDraft
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.bvh import OCCLUSION_OFFSET_M, LineOfSight
from planning.site.records import Site, panel_corners
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.solving.adjustment import moved_pose
from reconstruction.panels.solving.record import Axis

Array = NDArray[np.float64]


# Panels drawn into photos that were not searched: where they must be, by the photo's own pose.

BENT_PIECES = 6
"""Of an edge that a lens bends: a panel half as wide as the picture is then right to half a pixel (k1 = -0.11)."""


def panel_outlines(
    photo: PosedPhoto, panels_enu_m: Sequence[Array], sight: LineOfSight | None = None
) -> tuple[Array, ...]:
    """Outlines of the panels that a photo shows, shape (k, 2) each, in its pixels.

    Panels are left out that turn their back, lie outside the picture or reach behind the camera, and those whose middle
    something hides.

    Parameters
    ----------
    panels_enu_m
        Corners of each panel, shape (k, 3), counter-clockwise as seen from outside.
    sight
        Tells what is hidden; None where the scene hides nothing.
    """
    outlines: list[Array] = []
    for n_corners in sorted({len(corners) for corners in panels_enu_m}):
        alike = np.array([corners for corners in panels_enu_m if len(corners) == n_corners])
        outlines += _outlines(photo, alike, sight)
    return tuple(outlines)


def _outlines(photo: PosedPhoto, corners_enu_m: Array, sight: LineOfSight | None) -> list[Array]:
    """Of panels with as many corners, shape (m, k, 3)."""
    following = np.roll(corners_enu_m, -1, axis=1)
    middles = corners_enu_m.mean(axis=1)
    normals = np.cross(corners_enu_m - middles[:, None], following - middles[:, None]).sum(axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shown = np.flatnonzero(((photo.pose.position_enu_m - middles) * normals).sum(axis=1) > 0.0)
    pixels = _projected(photo, corners_enu_m[shown])
    size = np.array([photo.intrinsics.width_px, photo.intrinsics.height_px])
    with np.errstate(invalid="ignore"):
        is_in = (pixels.max(axis=1) > 0.0).all(axis=1) & (pixels.min(axis=1) < size).all(axis=1)
    shown, pixels = shown[is_in], pixels[is_in]
    if sight is not None and len(shown):
        places = np.broadcast_to(photo.pose.position_enu_m, (len(shown), 3))
        is_free = sight(places, middles[shown] + OCCLUSION_OFFSET_M * normals[shown])
        shown, pixels = shown[is_free], pixels[is_free]
    if not photo.intrinsics.is_straight:
        shares = np.linspace(0.0, 1.0, BENT_PIECES, endpoint=False)[:, None]
        starts, ends = corners_enu_m[shown][:, :, None], following[shown][:, :, None]
        pixels = _projected(photo, (starts + shares * (ends - starts)).reshape(len(shown), -1, 3))
    return list(pixels)


def _projected(photo: PosedPhoto, points_enu_m: Array) -> Array:
    """Pixels, shape (m, k, 2), of points, shape (m, k, 3)."""
    return photo.pixels(points_enu_m.reshape(-1, 3)).reshape(*points_enu_m.shape[:2], 2)


def known_panels(draft: PanelDraft | None, site: Site, photo: PosedPhoto) -> tuple[Array, ...]:
    """Corners, shape (k, 3), of panels that are known but were not looked for in a photo: the draft's, else the site's.

    Facades with a grid in the photo are left out: that shows them as they were found.
    """
    if draft is None:
        return tuple(panel_corners(site))
    searched = {place.facade for place in draft.places() if draft.photos[place.photo].path == photo.path}
    facades = (facade for facade in draft.found.facades if facade.id not in searched)
    panels = (panel for facade in facades for panel in facade.panels)
    return tuple(panel.corners_enu_m if panel.outline_enu_m is None else panel.outline_enu_m for panel in panels)


# Grids found in photos, as a hand meets them: which line is near, which cell is here, how far a line can go.

LinePlace = tuple[Axis, int]
"""A line of a grid: its direction and its number."""

LEAST_APART_PX = 3.0
"""Between two lines in the rectified view: no panel is narrower in a photo that shows it as one."""


def lines_of(grid: FacadeGrid, axis: Axis) -> tuple[GridLine, ...]:
    """Lines of one direction, in the order of the rectified view's pixels."""
    return grid.columns if axis == "column" else grid.rows


def line_near(grid: FacadeGrid, point_px: tuple[float, float], reach_px: float) -> LinePlace | None:
    """The line within reach of a point of the rectified view that is nearest to it."""
    x, y = point_px
    offers: list[tuple[float, Axis, int]] = [
        *((abs(line.position_px - x), "column", index) for index, line in enumerate(grid.columns)),
        *((abs(line.position_px - y), "row", index) for index, line in enumerate(grid.rows)),
    ]
    distance, axis, index = min(offers, default=(np.inf, "row", 0))
    return (axis, index) if distance <= reach_px else None


def cell_at(grid: FacadeGrid, point_px: tuple[float, float]) -> tuple[int, int] | None:
    """Row (from the bottom) and column of the cell that holds a point of the rectified view."""
    x, y = point_px
    column = bisect_right([line.position_px for line in grid.columns], x) - 1
    from_top = bisect_right([line.position_px for line in grid.rows], y) - 1
    if not (0 <= column < len(grid.columns) - 1 and 0 <= from_top < len(grid.rows) - 1):
        return None
    return len(grid.rows) - 2 - from_top, column


def cell_bounds(grid: FacadeGrid, row: int, column: int) -> tuple[float, float, float, float]:
    """Left, right, upper and lower line of a cell, by their positions in the rectified view."""
    top = len(grid.rows) - 2 - row
    return (
        grid.columns[column].position_px,
        grid.columns[column + 1].position_px,
        grid.rows[top].position_px,
        grid.rows[top + 1].position_px,
    )


def cell_middle(grid: FacadeGrid, row: int, column: int) -> tuple[float, float]:
    """Middle of a cell in the rectified view."""
    left, right, above, below = cell_bounds(grid, row, column)
    return 0.5 * (left + right), 0.5 * (above + below)


def panels_in(grid: FacadeGrid, cell: tuple[int, int]) -> tuple[FoundPanel, ...]:
    """Panels of a cell: one as a rule, several where it is divided, none where it is no panel."""
    return tuple(panel for panel in grid.panels if (panel.row, panel.column) == cell)


def room_for_line(grid: FacadeGrid, axis: Axis, index: int) -> tuple[float, float]:
    """Between which positions a line may be moved: it stays between its neighbours, and in the picture."""
    lines = lines_of(grid, axis)
    end = grid.rectification.width_px if axis == "column" else grid.rectification.height_px
    low = lines[index - 1].position_px + LEAST_APART_PX if index > 0 else 0.0
    high = lines[index + 1].position_px - LEAST_APART_PX if index + 1 < len(lines) else float(end)
    return low, high


def following_line(grid: FacadeGrid, line: LinePlace | None, step: int) -> LinePlace | None:
    """The next line (`step` 1) or the one before (-1): upright lines from left to right, then level ones downwards.

    The first one, or the last, where none is given; None behind either end.
    """
    order: list[LinePlace] = [("column", index) for index in range(len(grid.columns))]
    order += [("row", index) for index in range(len(grid.rows))]
    at = (-1 if step > 0 else len(order)) if line is None else order.index(line)
    return order[at + step] if 0 <= at + step < len(order) else None


def place_beside(grid: FacadeGrid, line: LinePlace) -> float:
    """Where a line beside this one is added: halfway to the next, or back to the one before where it is the last."""
    axis, index = line
    positions = [one.position_px for one in lines_of(grid, axis)]
    other = index + 1 if index + 1 < len(positions) else max(index - 1, 0)
    return 0.5 * (positions[index] + positions[other])


def cell_beside(
    grid: FacadeGrid, cell: tuple[int, int] | None, upwards: int, rightwards: int
) -> tuple[int, int] | None:
    """The cell so many rows and columns away, within the grid; its lower left one where none is given."""
    n_rows, n_columns = len(grid.rows) - 1, len(grid.columns) - 1
    if n_rows < 1 or n_columns < 1:
        return None
    row, column = (0, 0) if cell is None else (cell[0] + upwards, cell[1] + rightwards)
    return min(max(row, 0), n_rows - 1), min(max(column, 0), n_columns - 1)


DRAWN_SIGMA_PX = 1.0
"""Of a line that is put in its place by hand, in the rectified view."""


def move_line(draft: PanelDraft, place: GridPlace, axis: Axis, index: int, position_px: float) -> PanelDraft:
    """With a line of a facade elsewhere.

    Raises
    ------
    InputError
        It would leave the picture, or pass another line.
    """
    grid = draft.grid(place)
    low, high = room_for_line(grid, axis, index)
    if not low <= position_px <= high:
        raise InputError(
            say(
                "a line can be moved as far as its neighbours and the edge of the picture; remove the line that "
                "is in the way first"
            )
        )
    old = lines_of(grid, axis)[index]
    return _with_lines_changed(draft, place, axis, old.position_px, position_px, old.width_px)


def add_line(draft: PanelDraft, place: GridPlace, axis: Axis, position_px: float) -> PanelDraft:
    """With one more line on a facade, as wide as its others usually are.

    Raises
    ------
    InputError
        There is a line already.
    """
    lines = lines_of(draft.grid(place), axis)
    if any(abs(line.position_px - position_px) < LEAST_APART_PX for line in lines):
        raise InputError(say("there is a line already; point at a place between two lines, or beyond the last"))
    width = float(np.median([line.width_px for line in lines])) if lines else 0.0
    return _with_lines_changed(draft, place, axis, None, position_px, width)


def remove_line(draft: PanelDraft, place: GridPlace, axis: Axis, index: int) -> PanelDraft:
    """Without one line of a facade.

    Raises
    ------
    InputError
        There would be no panel left.
    """
    lines = lines_of(draft.grid(place), axis)
    if len(lines) <= 2:
        raise InputError(
            say("a facade needs two lines in each direction at least; add another line before this one goes")
        )
    return _with_lines_changed(draft, place, axis, lines[index].position_px, None, 0.0)


def set_panel(draft: PanelDraft, place: GridPlace, row: int, column: int, *, is_panel: bool) -> PanelDraft:
    """With a cell of a facade's grid taken for a panel, or for none; one that is cut stands for all its pieces."""
    middle = np.array(cell_middle(draft.grid(place), row, column))
    grids = dict(draft.found.grids)
    for other in _same_facade(draft, place):
        grid = draft.grid(other)
        at = middle if other == place else _in_view(draft, other, _on_surface(draft, place, middle))
        cell = cell_at(grid, (float(at[0]), float(at[1])))
        if cell is not None:
            missing = [found for found in grid.missing if found != cell]
            grids[other.facade, other.photo] = _with_panels_between(
                grid, grid.rows, grid.columns, [*missing, *([] if is_panel else [cell])]
            )
    return _changed(draft, place.facade, grids)


def _with_lines_changed(
    draft: PanelDraft, place: GridPlace, axis: Axis, old_px: float | None, new_px: float | None, width_px: float
) -> PanelDraft:
    """In every photo of the facade: without the line at the old place, with one at the new one."""
    grids = dict(draft.found.grids)
    for other in _same_facade(draft, place):
        grid = draft.grid(other)
        lines = lines_of(grid, axis)
        gone = None
        if old_px is not None:
            gone = _nearest(lines, _carried(draft, place, other, axis, old_px), is_exact=other == place)
        kept = [line for index, line in enumerate(lines) if index != gone]
        if new_px is not None:
            at = _carried(draft, place, other, axis, new_px)
            width = width_px if other == place else _usual_width_px(lines) if gone is None else lines[gone].width_px
            if gone is not None or other == place or _reaches(lines, at):
                kept.append(GridLine(at, width, DRAWN_SIGMA_PX))
        changed = tuple(sorted(kept, key=lambda line: line.position_px))
        rows, columns = (grid.rows, changed) if axis == "column" else (changed, grid.columns)
        grids[other.facade, other.photo] = _remade(grid, rows, columns)
    return _changed(draft, place.facade, grids)


def _changed(draft: PanelDraft, facade_id: str, grids: dict[tuple[str, int], FacadeGrid]) -> PanelDraft:
    return replace(draft, found=replace(draft.found, grids=grids), unsolved=draft.unsolved | {facade_id})


def _same_facade(draft: PanelDraft, place: GridPlace) -> tuple[GridPlace, ...]:
    """All photos with a grid of the facade that can be carried over, its own among them."""
    found = (other for other in draft.places() if other.facade == place.facade)
    return tuple(other for other in found if other == place or len(_ends(draft.grid(other))) == 4)


def _ends(grid: FacadeGrid) -> tuple[float, ...]:
    if not grid.rows or not grid.columns:
        return ()
    return (
        *(grid.columns[k].position_px for k in (0, -1)),
        *(grid.rows[k].position_px for k in (0, -1)),
    )


def _middle(grid: FacadeGrid) -> Array:
    left, right, top, bottom = _ends(grid)
    return np.array([0.5 * (left + right), 0.5 * (top + bottom)])


def _carried(draft: PanelDraft, place: GridPlace, other: GridPlace, axis: Axis, position_px: float) -> float:
    """Where a line of one photo lies in the rectified view of another; NaN where that does not show it."""
    if other == place:
        return position_px
    across = 0 if axis == "column" else 1
    point = _middle(draft.grid(place))
    point[across] = position_px
    st = _on_surface(draft, other, _middle(draft.grid(other)))
    st[across] = _on_surface(draft, place, point)[across]
    return float(_in_view(draft, other, st)[across])


def _camera(draft: PanelDraft, place: GridPlace) -> PosedPhoto:
    """The photo with the pose that the last solution gave it."""
    photo = draft.photos[place.photo]
    change = draft.facade(place.facade).pose_changes.get(place.photo)
    return photo if change is None else replace(photo, pose=moved_pose(photo.pose, change))


def _on_surface(draft: PanelDraft, place: GridPlace, point_px: Array) -> Array:
    """Coordinates on the facade, metres, shape (2,), of a point of a rectified view, shape (2,)."""
    surface = draft.facade(place.facade).surface
    pixels = draft.grid(place).rectification.to_photo(point_px[None])
    return np.asarray(surface.hits(*_camera(draft, place).rays(pixels))[0], float)


def _in_view(draft: PanelDraft, place: GridPlace, st_m: Array) -> Array:
    """Point of a rectified view, shape (2,), of coordinates on the facade, metres, shape (2,)."""
    points = draft.facade(place.facade).surface.to_enu(st_m[None])
    return np.asarray(draft.grid(place).rectification.to_rectified(_camera(draft, place).pixels(points))[0], float)


def _nearest(lines: Sequence[GridLine], position_px: float, *, is_exact: bool) -> int | None:
    """The line that is meant: within a third of the usual distance of two lines, where it is of another photo."""
    distances = [abs(line.position_px - position_px) for line in lines]
    if not distances or not np.isfinite(position_px):
        return None
    index = int(np.argmin(distances))
    return index if is_exact or distances[index] <= _usual_step_px(lines) / 3.0 else None


def _usual_step_px(lines: Sequence[GridLine]) -> float:
    steps = np.diff([line.position_px for line in lines])
    return float(np.median(steps)) if len(steps) else 0.0


def _usual_width_px(lines: Sequence[GridLine]) -> float:
    return float(np.median([line.width_px for line in lines])) if lines else 0.0


def _reaches(lines: Sequence[GridLine], position_px: float) -> bool:
    """Whether a new line would lie on a grid, or one panel beyond it: further out, lines between would be missing."""
    if len(lines) < 2:
        return False
    step = _usual_step_px(lines)
    low, high = lines[0].position_px - 1.5 * step, lines[-1].position_px + 1.5 * step
    return low <= position_px <= high and all(abs(one.position_px - position_px) >= LEAST_APART_PX for one in lines)


def _remade(grid: FacadeGrid, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...]) -> FacadeGrid:
    """The grid with other lines; cells around the middle of one that was no panel are none either."""
    bare = replace(grid, rows=rows, columns=columns, panels=(), missing=())
    middles = [cell_middle(grid, *cell) for cell in grid.missing]
    return _with_panels_between(
        grid, rows, columns, [cell for cell in (cell_at(bare, middle) for middle in middles) if cell]
    )


def _with_panels_between(
    grid: FacadeGrid, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...], missing: Sequence[tuple[int, int]]
) -> FacadeGrid:
    """Panels between lines, cut by the inclined ones that were found."""
    whole = facade_grid(grid.id, grid.rectification, rows, columns, grid.inclined)
    cells = {*whole.missing, *missing}
    panels = tuple(panel for panel in whole.panels if (panel.row, panel.column) not in cells)
    return replace(whole, panels=panels, missing=tuple(sorted(cells)))
