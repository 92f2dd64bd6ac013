"""Scenes out of sites: panels become panes in their profiles, the building a wall behind them, and streets are laid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import PanelFrames, panel_frames
from planning.geo.mesh import TriangleMesh
from planning.site.records import Site, SiteModel, panel_corners, require_panels
from reconstruction.scenes.record import Body, Glass, Interiors, Layer, Panes, Scene, Sky
from reconstruction.scenes.world.look import Look
from reconstruction.scenes.world.panorama import panorama
from reconstruction.scenes.world.profiles import edge_neighbours, profile_rings
from reconstruction.scenes.world.rooms import furnished, painted, shared_rooms
from reconstruction.scenes.world.surroundings import surround
from reconstruction.scenes.world.textures import grain
from reconstruction.scenes.world.wall_cut import without_openings

OTHER_COATING = 0.12
"""How much more or less panes of another batch mirror."""

DUSTY = 0.06
"""Share of dust on panes that are hard to clean, beyond that of the others."""

DUSTY_PANES = 0.15

ROOM, LAMP, BLIND = (0.05, 0.05, 0.048), (0.3, 0.26, 0.18), (0.42, 0.41, 0.38)
"""Light of a dim room, a lit one, and a blind in daylight."""

LIT_ROOMS = 0.12

PAINT = (0.1, 0.11, 0.13)
"""Light of spandrels' paint, a dark grey, in daylight."""

SAME_ROW_M = 0.3
"""Difference of their middles' heights up to which panels are of one row."""

LEAST_AREA_M2 = 1e-10
"""Smaller triangles are left out: 10 micrometres square."""


def build_scene(model: SiteModel, look: Look | None = None, seed: int = 0) -> Scene:
    """A site with all that a photo of it shows.

    The panes are the site's panels themselves. What of the building's mesh lies in their plane or up to 0.3 m before it
    is cut out behind them (`wall_cut`). Buildings opposite and trees stand among the obstacles of the scene's site, so
    that flights planned on it keep away from them; the site's hash stays.

    Panes, sky and surroundings draw from generators of their own: the panes of a scene are the same with and without
    what is near.

    Raises
    ------
    InputError
        The site has no panels.
    """
    require_panels(model.site)
    look = look or Look()
    panels = _lower_left_first(panel_frames(panel_corners(model.site)))
    walls, sky, around, glass, inside = (np.random.default_rng([seed, part]) for part in range(5))
    bodies = [_frames(panels, look)]
    building = without_openings(model.building, panels)
    bodies.append(Body("walls", Layer.BUILDING, building, look.wall_albedo, grain(walls, (0.9,) * 3, 0.12, 30.0)))
    bodies += [
        Body(f"obstacle-{obstacle.id}", Layer.NEAR, mesh, (0.5, 0.48, 0.45), grain(walls, (0.85,) * 3, 0.3, 15.0))
        for obstacle, mesh in zip(model.site.obstacles, model.obstacles, strict=True)
    ]
    bodies = [replace(body, mesh=_with_area(body.mesh)) for body in bodies]
    if look.near:
        surroundings = surround(model, look, around)
        model, bodies = surroundings.model, [*bodies, *surroundings.bodies]
    glasses = _glasses(look.glass)
    panes, interiors = _panes(panels, look, glass, inside)
    if look.spandrel_every:
        interiors, rooms = painted(panes, interiors, _spandrels(model.site, look.spandrel_every), np.array(PAINT))
        panes = replace(panes, rooms=rooms)
    return Scene(
        name=model.site.name,
        seed=seed,
        site=model,
        bodies=tuple(body for body in bodies if len(body.mesh.triangles)),
        panes=panes,
        glasses=glasses,
        sky=_sky(look, sky),
        interiors=interiors,
    )


def _frames(panels: PanelFrames, look: Look) -> Body:
    mesh = profile_rings(panels, look.frame_width_m, look.frame_depth_m)
    return Body("profiles", Layer.BUILDING, mesh, look.frame_albedo)


def _with_area(mesh: TriangleMesh) -> TriangleMesh:
    """Without triangles that have no normal: imported meshes have some, and so have rings around three-sided panes."""
    corners = mesh.corners_enu_m
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return TriangleMesh(mesh.vertices_enu_m, mesh.triangles[np.linalg.norm(crossed, axis=1) > 2.0 * LEAST_AREA_M2])


def _lower_left_first(panels: PanelFrames) -> PanelFrames:
    """The same panels, their corners counted from the lower left one, seen from outside."""
    relative = panels.corners - panels.centroids[:, None]
    right = np.einsum("mkx,mx->mk", relative, panels.tangents)
    up = np.einsum("mkx,mx->mk", relative, panels.bitangents)
    # Shares of the extents, so that of a wide and low panel the lower left corner is found, too.
    first = (right / np.ptp(right, axis=1)[:, None] + up / np.ptp(up, axis=1)[:, None]).argmin(axis=1)
    order = (first[:, None] + np.arange(4)) % 4
    return replace(panels, corners=np.take_along_axis(panels.corners, order[..., None], axis=1))


def _glasses(glass: Glass) -> tuple[Glass, ...]:
    """As it was ordered; hard to clean; replaced by another batch."""
    other = glass.coating - OTHER_COATING if glass.coating >= OTHER_COATING else glass.coating + OTHER_COATING
    red, green, blue = glass.tint
    return (
        glass,
        replace(glass, dirt=min(glass.dirt + DUSTY, 0.99)),
        replace(glass, coating=min(other, 0.99), tint=(0.94 * red, 0.97 * green, min(1.02 * blue, 1.0))),
    )


def _panes(
    panels: PanelFrames, look: Look, rng: np.random.Generator, inside: np.random.Generator
) -> tuple[Panes, Interiors]:
    n = len(panels)
    relative = panels.corners - panels.centroids[:, None]
    halves = np.stack(
        [np.abs(np.einsum("mkx,mx->mk", relative, axis)).max(axis=1) for axis in (panels.tangents, panels.bitangents)],
        axis=1,
    )
    tilts = np.radians(look.tilt_deg) * rng.normal(size=(n, 2))
    bows = np.radians(look.bow_deg) * (1.0 + 0.3 * rng.normal(size=(n, 1))) / halves
    if look.curved_glass:
        bows = bows + facade_bows_per_m(panels)
    draws = rng.random(n)
    kinds = np.where(draws < look.replaced, 2, np.where(rng.random(n) < DUSTY_PANES, 1, 0))
    is_lit = rng.random((n, 1)) < LIT_ROOMS
    lights = np.where(is_lit, LAMP, ROOM) * rng.uniform(0.5, 1.5, (n, 1))
    drawn = np.where(rng.random((n, 1)) < look.blinds, rng.uniform(0.15, 1.0, (n, 1)), 0.0)
    blind_lights = np.array(BLIND) * rng.uniform(0.8, 1.1, (n, 1))
    panes = Panes(panels.corners, tilts, bows, kinds.astype(np.int64), np.zeros((n, 3)))
    first = shared_rooms(panes, inside)
    interiors, rooms = furnished(panes, first, is_lit[:, 0], lights, drawn[:, 0], blind_lights, inside)
    return replace(panes, rooms=rooms), interiors


def _spandrels(site: Site, every: int) -> NDArray[np.bool_]:
    """Panels in every so-manyth row of their facades, counted from the foot, shape (m,)."""
    found = []
    for facade in site.facades:
        heights = np.array([np.mean(panel.corners_enu_m, axis=0)[2] for panel in facade.panels])
        order = np.argsort(heights, kind="stable")
        rows = np.zeros(len(heights), np.int64)
        rows[order] = np.cumsum(np.diff(heights[order], prepend=heights[order[0]]) > SAME_ROW_M)
        found.append(rows % every == every - 1)
    return np.concatenate(found)


def facade_bows_per_m(panels: PanelFrames) -> NDArray[np.float64]:
    """Curvature of the facade at each panel, to the right and upwards, shape (m, 2): how neighbours turn.

    Of panels whose corners lie on a cylinder it is 1 / radius. Edges without a neighbour, or with one around a corner
    (`profiles.LEAST_COSINE`), count for nothing.
    """
    neighbours = edge_neighbours(panels)[1]
    away = panels.centroids[neighbours] - panels.centroids[:, None]
    turned = panels.normals[neighbours]
    bows = np.zeros((len(panels), 2))
    for k, axis in enumerate((panels.tangents, panels.bitangents)):
        along = np.einsum("mkx,mx->mk", away, axis)
        # Beside the panel in this direction, and not above or below it.
        lengths = np.linalg.norm(away, axis=2)
        counts = (neighbours >= 0) & (np.abs(along) > math.sqrt(0.5) * lengths)
        turns = np.einsum("mkx,mx->mk", turned, axis) * np.sign(along)
        curvatures = np.divide(turns, lengths, out=np.zeros_like(turns), where=counts)
        bows[:, k] = curvatures.sum(axis=1) / np.maximum(counts.sum(axis=1), 1)
    return bows


def _sky(look: Look, rng: np.random.Generator) -> Sky:
    clear = Sky(look.sun_heading_deg, look.sun_elevation_deg)
    return replace(clear, panorama=panorama(rng, clear, look.clouds, look.skyline_deg))
