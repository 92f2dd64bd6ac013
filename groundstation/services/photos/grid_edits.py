"""Corrections of found panels: lines are moved, added and removed, panels taken out and put back.

A correction is made in the rectified view of one photo, and meant for the facade. It is carried over to the other
photos of the facade by what the last solution knows of their poses; the grids of all of them are then solved again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.found_panels import GridPlace, PanelDraft
from groundstation.services.photos.grids import LEAST_APART_PX, cell_at, cell_middle, lines_of, room_for_line
from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import FacadeGrid, GridLine
from reconstruction.panels.solving.adjustment import moved_pose
from reconstruction.panels.solving.record import Axis

Array = NDArray[np.float64]

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
            grids[other.facade, other.photo] = _made(
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
    return _made(grid, rows, columns, [cell for cell in (cell_at(bare, middle) for middle in middles) if cell])


def _made(
    grid: FacadeGrid, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...], missing: Sequence[tuple[int, int]]
) -> FacadeGrid:
    """Panels between lines, cut by the inclined ones that were found."""
    made = facade_grid(grid.id, grid.rectification, rows, columns, grid.inclined)
    cells = {*made.missing, *missing}
    panels = tuple(panel for panel in made.panels if (panel.row, panel.column) not in cells)
    return replace(made, panels=panels, missing=tuple(sorted(cells)))
