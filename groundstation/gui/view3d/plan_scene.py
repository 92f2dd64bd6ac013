"""What a plan looks like: viewpoints with frusta, routes by sortie with arrows, and labels. Nothing is drawn here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.layers import Drawable, Layer
from groundstation.gui.view3d.paint import ColourScale, flat, rgba
from groundstation.gui.view3d.shapes import arrows, frusta, polyline
from groundstation.gui.widgets.theme import SORTIES, Colours
from planning.plan import Plan, ViewpointArrays, viewpoint_arrays

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]

FRUSTUM_M = 1.5
ARROW_M = 1.6
"""Lengths of a viewpoint's pyramid and of arrowheads, metres: about the size of the aircraft."""


CASING_SHIFT = 4.0
"""Outlines of lines lie this many steps of the depth buffer behind the lines themselves."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanScene:
    """A plan ready to be drawn.

    Parameters
    ----------
    views
        All viewpoints, shape (n, ...).
    sortie
        Number of each viewpoint's sortie, shape (n,); -1 where it is in none.
    paths
        Polyline of each sortie, shape (k, 3).
    """

    plan: Plan
    views: ViewpointArrays
    sortie: NDArray[np.int64]
    paths: tuple[Array, ...]
    viewpoint_index: dict[str, int]
    drawables: dict[Layer, tuple[Drawable, ...]]


def plan_scene(
    plan: Plan,
    look: Colours,
    locked: frozenset[str] = frozenset(),
    values: tuple[ColourScale, tuple[Array, ...]] | None = None,
) -> PlanScene:
    """Everything of a plan.

    Parameters
    ----------
    locked
        Identifiers of viewpoints that are kept as they are; they get a filled mark.
    values
        A scale and, for each sortie, a value per vertex of its path: routes are coloured by it instead of by sortie.
    """
    views = viewpoint_arrays(plan.viewpoints)
    paths = tuple(np.array(sortie.path_enu_m, np.float64).reshape(-1, 3) for sortie in plan.sorties)
    number = {found: i for i, sortie in enumerate(plan.sorties) for found in sortie.viewpoint_ids}
    sortie = np.array([number.get(viewpoint.id, -1) for viewpoint in plan.viewpoints], np.int64)
    drawables = {
        Layer.VIEWPOINTS: _viewpoints(plan, views, sortie, look, locked),
        Layer.ROUTES: _routes(paths, values, look),
    }
    index = {viewpoint.id: i for i, viewpoint in enumerate(plan.viewpoints)}
    return PlanScene(plan, views, sortie, paths, index, drawables)


def sortie_colours(sortie: NDArray[np.int64], look: Colours) -> Bytes:
    """Colours by number of sortie, shape (n, 4); the text's colour for -1."""
    table = np.stack([*(rgba(colour) for colour in SORTIES), rgba(look.text)])
    return np.asarray(table[np.where(sortie < 0, len(SORTIES), sortie % len(SORTIES))])


def _viewpoints(
    plan: Plan, views: ViewpointArrays, sortie: NDArray[np.int64], look: Colours, locked: frozenset[str]
) -> tuple[Drawable, ...]:
    n = len(plan.viewpoints)
    if n == 0:
        return ()
    colours = sortie_colours(sortie, look)
    points, cells = frusta(views, plan.camera, FRUSTUM_M)
    dots = np.arange(n)[:, None]
    parts = [
        Drawable(points, cells, np.repeat(colours, len(cells) // n, axis=0)),
        Drawable(views.positions_enu_m, dots, colours, width_px=4.0),
    ]
    held = np.flatnonzero([viewpoint.id in locked for viewpoint in plan.viewpoints])
    if len(held):
        parts.append(Drawable(views.positions_enu_m, held[:, None], flat(look.text, len(held)), width_px=9.0))
    return tuple(parts)


def _routes(
    paths: tuple[Array, ...], values: tuple[ColourScale, tuple[Array, ...]] | None, look: Colours
) -> tuple[Drawable, ...]:
    parts = []
    for number, path in enumerate(paths):
        points, cells = polyline(path)
        if len(cells) == 0:
            continue
        colours = flat(SORTIES[number % len(SORTIES)], len(cells))
        heads, triangles = arrows(path, ARROW_M)
        head_colours = flat(SORTIES[number % len(SORTIES)], len(triangles))
        if values is not None:
            scale, by_sortie = values
            if by_sortie[number].shape != (len(path),):
                raise ValueError(f"sortie {number + 1}: expected {len(path)} values, got {by_sortie[number].shape}")
            # The worse end decides a leg's colour: a leg is as near to something as its nearest end.
            legs = np.fmin(by_sortie[number][:-1], by_sortie[number][1:])
            colours = scale.colours(legs)
            # Some colours of a scale are as dark or as bright as the background.
            casing = flat(look.text, len(cells))
            parts.append(Drawable(points, cells, casing, width_px=5.0, depth_shift=CASING_SHIFT))
        parts.append(Drawable(points, cells, colours, width_px=2.5))
        if len(triangles):
            parts.append(Drawable(heads, triangles, head_colours))
    return tuple(parts)


def ends_of_sorties(paths: tuple[Array, ...]) -> list[tuple[Array, list[int], list[int]]]:
    """Places where sorties start or land: point, numbers of those that start there, of those that land there."""
    places: list[tuple[Array, list[int], list[int]]] = []
    for number, path in enumerate(paths, start=1):
        for end, role in ((0, 1), (-1, 2)):
            if len(path) == 0:
                continue
            point = path[end]
            place = next((known for known in places if np.linalg.norm(known[0] - point) < 1.0), None)
            if place is None:
                place = (point, [], [])
                places.append(place)
            (place[1] if role == 1 else place[2]).append(number)
    return places
