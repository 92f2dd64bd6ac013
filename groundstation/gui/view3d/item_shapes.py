"""The shape of one item: the lines that mark it, and what has to be in view to look at it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.plan_scene import FRUSTUM_M, PlanScene
from groundstation.gui.view3d.shapes import Shape, box_edges, frusta, joined, outlines, polyline, shown_panels
from groundstation.gui.view3d.site_scene import SiteScene, home_pad
from groundstation.services.document import Item, ItemKind
from planning.plan import ViewpointArrays

Array = NDArray[np.float64]

MARK_LIFT_M = 0.03
"""Marks of panels lie this far in front of them, so that they are not half hidden."""

SURROUNDINGS_M = 6.0
"""Something smaller is shown with at least this much around it."""


@dataclass(frozen=True, slots=True, eq=False)
class ItemShape:
    """Lines that mark an item; points, shape (n, 3), that show it; the side from which it is looked at.

    `normal` has shape (3,) and is zero where any side will do.
    """

    lines: Shape
    points_enu_m: Array
    normal: Array


def item_shape(item: Item, site: SiteScene | None, plan: PlanScene | None) -> ItemShape | None:
    """Shape of an item of a site or plan; None where there is none such."""
    if plan is not None and item.kind in (ItemKind.VIEWPOINT, ItemKind.SORTIE, ItemKind.LEG):
        return _of_plan(item, plan)
    if site is None:
        return None
    model = site.model
    match item.kind:
        case ItemKind.PANEL | ItemKind.FACADE:
            return _of_panels(item, site)
        case ItemKind.BUILDING:
            vertices = model.building.vertices_enu_m
            return _boxed(vertices) if len(vertices) else None
        case ItemKind.OBSTACLE:
            meshes = zip(model.site.obstacles, model.obstacles, strict=True)
            found = next((mesh for obstacle, mesh in meshes if obstacle.id == item.id), None)
            return None if found is None or len(found.vertices_enu_m) == 0 else _boxed(found.vertices_enu_m)
        case ItemKind.NO_FLY:
            zone = next((zone for zone in model.site.airspace.no_fly if zone.id == item.id), None)
            if zone is None:
                return None
            ring = np.array([*zone.polygon_enu_m, zone.polygon_enu_m[0]])
            low, high = (np.c_[ring, np.full(len(ring), z)] for z in (zone.floor_m, zone.ceiling_m))
            return _lines([low, high, *(np.stack(pair) for pair in zip(low[:-1], high[:-1], strict=True))])
        case ItemKind.AIRSPACE:
            return _boxed(np.array([model.site.airspace.min_enu_m, model.site.airspace.max_enu_m]))
        case ItemKind.HOME:
            return _boxed(home_pad(model).vertices_enu_m)
        case _:
            return None


def _of_plan(item: Item, plan: PlanScene) -> ItemShape | None:
    if item.kind is ItemKind.VIEWPOINT:
        index = plan.viewpoint_index.get(item.id)
        if index is None:
            return None
        view = ViewpointArrays(*(part[index : index + 1] for part in plan.views))
        shape = frusta(view, plan.plan.camera, 2.0 * FRUSTUM_M)
        return ItemShape(shape, shape[0], np.zeros(3))
    number, _, leg = item.id.partition("/")
    if not (number.isdecimal() and 1 <= int(number) <= len(plan.paths)):
        return None
    path = plan.paths[int(number) - 1]
    if item.kind is ItemKind.LEG:
        if not (leg.isdecimal() and 1 <= int(leg) < len(path)):
            return None
        path = path[int(leg) - 1 : int(leg) + 1]
    return ItemShape(polyline(path), path, np.zeros(3)) if len(path) > 1 else None


def _of_panels(item: Item, site: SiteScene) -> ItemShape | None:
    if item.kind is ItemKind.PANEL:
        index = site.panel_index.get(item.id)
        panels = np.zeros(0, np.int64) if index is None else np.array([index])
    else:
        numbers = [i for i, facade in enumerate(site.model.site.facades) if facade.id == item.id]
        panels = np.flatnonzero(np.isin(site.facade, numbers))
    if len(panels) == 0:
        return None
    corners = shown_panels(site.frames)[panels] + MARK_LIFT_M * site.frames.normals[panels, None]
    return ItemShape(outlines(corners), corners.reshape(-1, 3), site.frames.normals[panels].sum(axis=0))


def _boxed(points_enu_m: Array) -> ItemShape:
    shape = box_edges(points_enu_m.min(axis=0), points_enu_m.max(axis=0))
    return ItemShape(shape, shape[0], np.zeros(3))


def _lines(pieces: list[Array]) -> ItemShape:
    shape = joined([polyline(piece) for piece in pieces])
    return ItemShape(shape, shape[0], np.zeros(3))


def with_surroundings(points_enu_m: Array) -> Array:
    """Points, shape (n, 3), and corners of a box of at least `SURROUNDINGS_M` to each side of their middle."""
    low, high = points_enu_m.min(axis=0), points_enu_m.max(axis=0)
    centre = 0.5 * (low + high)
    half = np.maximum(0.5 * (high - low), SURROUNDINGS_M)
    return box_edges(centre - half, centre + half)[0]
