"""The shape of one item: the lines that mark it, and what has to be in view to look at it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.pinhole import Pinhole, photo_pinhole
from groundstation.gui.view3d.plan_scene import FRUSTUM_M, PlanScene
from groundstation.gui.view3d.shapes import Shape, box_edges, frusta, joined, outlines, polyline, shown_panels
from groundstation.gui.view3d.site_scene import SiteScene, landing_pad
from groundstation.services.project.document import Item, ItemKind
from planning.coverage.sections import PanelFrames
from planning.geo.frames import camera_axes
from planning.plan import ViewpointArrays

Array = NDArray[np.float64]

MARK_LIFT_M = 0.03
"""Marks of panels lie this far in front of them, so that they are not half hidden."""

SURROUNDINGS_M = 6.0
"""Something smaller is shown with at least this much around it."""

NO_PANEL_M = 15.0
"""How far a viewpoint looks that has no panel in its picture: as far as most have theirs."""

PANEL_ASIDE_DEG, PLAN_ASIDE_DEG = 20.0, 50.0
"""How far beside their front things are looked at: glass nearly straight on, a viewpoint and what it sees apart."""


@dataclass(frozen=True, slots=True, eq=False)
class ItemShape:
    """Lines that mark an item; points, shape (n, 3), that show it; from where it is looked at.

    `normal` has shape (3,) and points to the side on which to stand, `aside_deg` to the right of it; zero where any
    side will do.
    """

    lines: Shape
    points_enu_m: Array
    normal: Array
    aside_deg: float = PANEL_ASIDE_DEG


def item_shape(item: Item, site: SiteScene | None, plan: PlanScene | None) -> ItemShape | None:
    """Shape of an item of a site or plan; None where there is none such."""
    if plan is not None and item.kind in (ItemKind.VIEWPOINT, ItemKind.SORTIE, ItemKind.LEG):
        return _of_plan(item, site, plan)
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
            return _boxed(landing_pad(model.site.home_enu_m).vertices_enu_m)
        case ItemKind.RALLY:
            point = next((point for point in model.site.rally_points if point.id == item.id), None)
            return None if point is None else _boxed(landing_pad(point.position_enu_m).vertices_enu_m)
        case _:
            return None


def _of_plan(item: Item, site: SiteScene | None, plan: PlanScene) -> ItemShape | None:
    if item.kind is ItemKind.VIEWPOINT:
        index = plan.viewpoint_index.get(item.id)
        return None if index is None else _of_viewpoint(index, site, plan)
    number, _, leg = item.id.partition("/")
    if not (number.isdecimal() and 1 <= int(number) <= len(plan.paths)):
        return None
    path = plan.paths[int(number) - 1]
    if item.kind is ItemKind.LEG:
        if not (leg.isdecimal() and 1 <= int(leg) < len(path)):
            return None
        return _of_leg(path[int(leg) - 1 : int(leg) + 1], site)
    return ItemShape(polyline(path), path, np.zeros(3)) if len(path) > 1 else None


def _of_viewpoint(index: int, site: SiteScene | None, plan: PlanScene) -> ItemShape:
    """A viewpoint is looked at together with what its picture shows, from behind and beside it."""
    view = ViewpointArrays(*(part[index : index + 1] for part in plan.views))
    camera, eye = plan.plan.camera, view.positions_enu_m[0]
    heading, pitch = float(view.heading_rad[0]), float(view.pitch_rad[0])
    reach_m = NO_PANEL_M if site is None else _reach_m(photo_pinhole(eye, heading, pitch, camera, 1000.0), site.frames)
    lines = frusta(view, camera, 2.0 * FRUSTUM_M)
    # Level, so that a view that looks up is not looked at from below the ground.
    ahead, _, _ = camera_axes(heading, 0.0)
    return ItemShape(lines, frusta(view, camera, reach_m)[0], -ahead, PLAN_ASIDE_DEG)


def _reach_m(view: Pinhole, frames: PanelFrames) -> float:
    """Depth of the panel nearest to the middle of a picture, of those that turn their front to it."""
    pixels, depths = view.project(frames.centroids)
    away = frames.centroids - view.eye_enu_m
    middle = np.array([0.5 * view.width_px, 0.5 * view.height_px])
    is_in = (depths > 0.0) & (np.abs(pixels - middle) <= middle).all(axis=1)
    is_in &= np.einsum("ij,ij->i", away, frames.normals) < 0.0
    if not is_in.any():
        return NO_PANEL_M
    beside = np.linalg.norm(pixels - middle, axis=1)
    return float(depths[np.argmin(np.where(is_in, beside, np.inf))])


def _of_leg(ends_enu_m: Array, site: SiteScene | None) -> ItemShape:
    """A leg is looked at together with the panel nearest to its middle, from that panel's front."""
    lines = polyline(ends_enu_m)
    if site is None or len(site.frames) == 0:
        return ItemShape(lines, ends_enu_m, np.zeros(3))
    centroids = site.frames.centroids
    nearest = int(np.linalg.norm(centroids - ends_enu_m.mean(axis=0), axis=1).argmin())
    return ItemShape(lines, np.vstack([ends_enu_m, centroids[nearest]]), site.frames.normals[nearest], PLAN_ASIDE_DEG)


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
