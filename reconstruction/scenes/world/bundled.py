"""Bundled scenes: the paper's planar and curved case, both without what is near, a court, and windows in concrete."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.mesh import TriangleMesh, box_mesh, extrude, join
from planning.site.bundled import ORIGIN, arc_grid, court, panel_grid
from planning.site.records import Airspace, Facade, Panel, Site, SiteModel
from reconstruction.scenes.record import Glass, Scene
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look

AIRSPACE = Airspace((-70.0, -50.0, 3.0), (70.0, 75.0, 60.0), ground_z_m=0.0)
HOME = (50.0, 14.0, 0.0)
"""In the street before the facade, past its end."""

N_COLUMNS, N_ROWS = 20, 8
WIDTH_M, FOOT_M, TOP_M = 30.0, 1.0, 21.0
"""Of the facades in the paper's proportions: panels of 1.5 m x 2.5 m."""

RADIUS_M = 26.0
"""Of the curved one: it turns by 66 degrees."""

WINDOW_COLUMNS, WINDOW_ROWS = 10, 6
WINDOW_M, REVEAL_M = (1.4, 1.8), 0.2


def _site(name: str, facade: Facade, building: TriangleMesh) -> SiteModel:
    return SiteModel(Site(name, ORIGIN, (facade,), AIRSPACE, HOME, f"{name}.ply"), building)


def planar_site(name: str = "planar") -> SiteModel:
    """A plane facade of 20 x 8 panels, 30 m x 20 m, that looks north: in shade itself, it mirrors a sunny street."""
    half = 0.5 * WIDTH_M
    facade = panel_grid(
        "A", ((half, 0.0, FOOT_M), (-half, 0.0, FOOT_M), (half, 0.0, TOP_M)), N_ROWS, N_COLUMNS, gap_m=0.06
    )
    building = box_mesh(np.array([-half - 0.5, -16.0, 0.0]), np.array([half + 0.5, 0.0, TOP_M + 1.0]))
    return _site(name, facade, building)


def curved_site(name: str = "curved") -> SiteModel:
    """A convex facade of 20 x 8 panels, 30 m along its arc and 20 m high, that looks north; its top at y = 0."""
    half = 0.5 * WIDTH_M / RADIUS_M
    azimuths = (0.5 * math.pi - half, 0.5 * math.pi + half)
    facade = arc_grid("A", (0.0, -RADIUS_M), RADIUS_M, azimuths, (FOOT_M, TOP_M), N_ROWS, N_COLUMNS)
    lowest = facade.panels[:N_COLUMNS]
    wall = [panel.corners_enu_m[0][:2] for panel in lowest] + [lowest[-1].corners_enu_m[1][:2]]
    outline = np.array([*wall, (wall[-1][0], -22.0), (wall[0][0], -22.0)])
    return _site(name, facade, extrude(outline, 0.0, TOP_M + 1.0))


def concrete_site() -> SiteModel:
    """A concrete facade that looks north, with 10 x 6 windows set back in their openings."""
    half, depth = 0.5 * WIDTH_M, REVEAL_M + 0.06
    columns = np.linspace(half, -half, WINDOW_COLUMNS + 1)
    middles = 0.5 * (columns[:-1] + columns[1:])
    rows = np.linspace(FOOT_M, TOP_M, WINDOW_ROWS + 1)
    lows = 0.5 * (rows[:-1] + rows[1:] - WINDOW_M[1])
    panes: list[Panel] = []
    boxes = [box_mesh(np.array([-half, -16.0, 0.0]), np.array([half, -depth, TOP_M + 1.0]))]
    for low in lows:
        for x in middles:
            left, right = x + 0.5 * WINDOW_M[0], x - 0.5 * WINDOW_M[0]
            corners = ((left, -REVEAL_M, low), (right, -REVEAL_M, low), (left, -REVEAL_M, low + WINDOW_M[1]))
            panes += panel_grid(f"A-{len(panes):02d}", corners, 1, 1).panels
        edges = [-half, *np.sort(np.concatenate([middles - 0.5 * WINDOW_M[0], middles + 0.5 * WINDOW_M[0]])), half]
        for a, b in zip(edges[::2], edges[1::2], strict=True):
            boxes.append(box_mesh(np.array([a, -depth, low]), np.array([b, 0.0, low + WINDOW_M[1]])))
    levels = [0.0, *np.sort(np.concatenate([lows, lows + WINDOW_M[1]])), TOP_M + 1.0]
    for a, b in zip(levels[::2], levels[1::2], strict=True):
        boxes.append(box_mesh(np.array([-half, -depth, a]), np.array([half, 0.0, b])))
    return _site("concrete", Facade("A", tuple(panes)), join(boxes))


def _planar(seed: int) -> Scene:
    return build_scene(planar_site(), seed=seed)


def _curved(seed: int) -> Scene:
    return build_scene(curved_site(), seed=seed)


def _planar_far(seed: int) -> Scene:
    return build_scene(planar_site("planar-far"), Look(near=False), seed)


def _curved_far(seed: int) -> Scene:
    return build_scene(curved_site("curved-far"), Look(near=False), seed)


def _court(seed: int) -> Scene:
    # From the south-east the sun reaches both wings, whose glass then mirrors each other in the light.
    return build_scene(court(), Look(sun_heading_deg=135.0, sun_elevation_deg=40.0), seed)


def _concrete(seed: int) -> Scene:
    look = Look(glass=Glass(coating=0.05, dirt=0.03), wall_albedo=(0.5, 0.49, 0.46), bow_deg=0.05)
    return build_scene(concrete_site(), look, seed)


SCENES: dict[str, Callable[[int], Scene]] = {
    "planar": _planar,
    "curved": _curved,
    "planar-far": _planar_far,
    "curved-far": _curved_far,
    "court": _court,
    "concrete": _concrete,
}


def bundled_scene(name: str, seed: int = 0) -> Scene:
    """One of `SCENES`; the same seed gives the same scene.

    Raises
    ------
    InputError
        There is no such scene.
    """
    if name not in SCENES:
        raise InputError(say("there is no bundled scene '{}'; known are: {}", name, ", ".join(SCENES)))
    return SCENES[name](seed)
