"""What is where on the map: from a pixel to the thing drawn there, and from a thing to its place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.map.viewport import Viewport
from groundstation.services.map.shapes import Area, PlanShapes, SiteShapes
from groundstation.services.project.document import Item, ItemKind

REACH_PX = 14.0
"""How far from a point a finger or mouse may be to mean it."""

LINE_REACH_PX = 7.0


def find_item(
    at_px: NDArray[np.float64], viewport: Viewport, site: SiteShapes | None, plan: PlanShapes | None
) -> Item | None:
    """The thing at a pixel, shape (2,): points first, then panels, then what covers ground."""
    if plan is not None and len(plan.viewpoints):
        away = np.linalg.norm(viewport.screen(plan.viewpoints) - at_px, axis=1)
        nearest = int(np.argmin(away))
        if away[nearest] <= REACH_PX:
            return Item(ItemKind.VIEWPOINT, plan.viewpoint_ids[nearest])
    if site is None:
        return None
    landings = np.linalg.norm(viewport.screen(site.landings()) - at_px, axis=1)
    nearest = int(np.argmin(landings))
    if landings[nearest] <= REACH_PX:
        return site.rally[nearest - 1][0] if nearest else Item(ItemKind.HOME)
    for item, panels in site.facades:
        corners = viewport.screen(panels.reshape(-1, 2)).reshape(-1, 4, 2)
        if _distance_px(corners, np.roll(corners, -1, axis=1), at_px) <= LINE_REACH_PX:
            return item
    areas = (*site.no_fly, *reversed(site.solids))
    return next((area.item for area in areas if _is_inside(area, viewport, at_px)), None)


def place_of(item: Item, site: SiteShapes | None, plan: PlanShapes | None) -> NDArray[np.float64] | None:
    """World coordinates of a thing, shape (n, 2), n >= 1; None where the map does not show it."""
    if plan is not None:
        if item.kind is ItemKind.VIEWPOINT and item.id in plan.viewpoint_ids:
            return plan.viewpoints[plan.viewpoint_ids.index(item.id)][None]
        if item.kind in (ItemKind.SORTIE, ItemKind.LEG):
            return _place_on_route(item, plan)
    if site is None:
        return None
    if item.kind is ItemKind.HOME:
        return site.home[None]
    if item.kind is ItemKind.AIRSPACE:
        return site.airspace.rings[0]
    if item.kind is ItemKind.RALLY:
        return next((place[None] for point, place in site.rally if point == item), None)
    areas = (*site.no_fly, *site.solids)
    found = next((area for area in areas if area.item == item), None)
    if found is not None and found.rings:
        return np.concatenate(found.rings)
    return next((panels.reshape(-1, 2) for facade, panels in site.facades if facade == item), None)


def _place_on_route(item: Item, plan: PlanShapes) -> NDArray[np.float64] | None:
    number, _, leg = item.id.partition("/")
    if not number.isdecimal() or not 1 <= int(number) <= len(plan.routes):
        return None
    route = plan.routes[int(number) - 1]
    if item.kind is ItemKind.SORTIE:
        return route if len(route) else None
    end = int(leg) if leg.isdecimal() else 0
    return route[end - 1 : end + 1] if 1 <= end < len(route) else None


def _distance_px(starts: NDArray[np.float64], ends: NDArray[np.float64], at_px: NDArray[np.float64]) -> float:
    """Distance of a pixel to the nearest of many segments, shapes (..., 2)."""
    legs, rays = ends - starts, at_px - starts
    along = np.clip((rays * legs).sum(axis=-1) / np.maximum((legs**2).sum(axis=-1), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(rays - along[..., None] * legs, axis=-1).min())


def _is_inside(area: Area, viewport: Viewport, at_px: NDArray[np.float64]) -> bool:
    """Even-odd rule over all rings."""
    inside = False
    for ring in area.rings:
        a = viewport.screen(ring) - at_px
        b = np.roll(a, -1, axis=0)
        crosses = (a[:, 1] > 0.0) != (b[:, 1] > 0.0)
        a, b = a[crosses], b[crosses]
        right = (b[:, 0] - a[:, 0]) * -a[:, 1] / (b[:, 1] - a[:, 1]) + a[:, 0] > 0.0
        inside ^= bool(np.count_nonzero(right) % 2)
    return inside
