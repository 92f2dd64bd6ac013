"""A small site, and slow independent measures of plans in plain float64 NumPy: the contract's words, no shared code.

`kiosk` has everything a site can have: a building, glass on two sides, an obstacle, a no-fly volume.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from planning.geo.mesh import box_mesh, empty_mesh
from planning.plan import Camera, Plan, Viewpoint
from planning.site.bundled import ORIGIN, arc_grid, panel_grid
from planning.site.records import Airspace, NoFlyZone, Obstacle, Site, SiteModel, box_geometry

Floats = NDArray[np.float64]

PAIRS_AT_A_TIME = 6_000
"""Points or lines times triangles."""


def kiosk(**changes: object) -> SiteModel:
    """Building of 12 x 8 x 9 m with 3 x 3 panels to the south and 3 x 2 to the east; `changes` go to the site."""
    south = panel_grid("A", ((-6.0, 0.0, 0.0), (6.0, 0.0, 0.0), (-6.0, 0.0, 9.0)), 3, 3)
    east = panel_grid("B", ((6.0, 0.0, 0.0), (6.0, 8.0, 0.0), (6.0, 0.0, 9.0)), 3, 2)
    zone = NoFlyZone("road", ((-35.0, -38.0), (-20.0, -38.0), (-20.0, 38.0), (-35.0, 38.0)), 0.0, 50.0)
    fields: dict[str, object] = {
        "name": "kiosk",
        "origin": ORIGIN,
        "facades": (south, east),
        "airspace": Airspace((-40.0, -40.0, 3.0), (40.0, 40.0, 40.0), ground_z_m=0.0, no_fly=(zone,)),
        "home_enu_m": (0.0, -30.0, 0.0),
        "building_mesh": "kiosk.ply",
        "obstacles": (Obstacle("tree", box_enu_m=((18.0, -14.0, 0.0), (21.0, -11.0, 11.0))),),
    }
    site = Site(**{**fields, **changes})  # type: ignore[arg-type]
    building = box_mesh(np.array([-6.0, 0.0, 0.0]), np.array([6.0, 8.0, 9.0]))
    return SiteModel(site, building, tuple(box_geometry(obstacle) for obstacle in site.obstacles))


def turned_site(
    turn_deg: float = 0.0,
    shift_m: tuple[float, float] = (0.0, 0.0),
    bend_deg: float = 0.0,
    n_rows: int = 3,
    n_columns: int = 4,
    panel_m: tuple[float, float] = (1.5, 1.5),
    foot_m: float = 5.0,
    beside_m: float = 30.0,
    top_m: float = 33.0,
    obstacle_m: float | None = None,
) -> SiteModel:
    """A facade without a building behind it, turned, shifted and bent out of the frame's axes.

    Parameters
    ----------
    bend_deg
        Of the arc that the facade is; 0: planar.
    panel_m
        Width and height of a panel.
    foot_m
        Height of the lowest panel's lower edge.
    beside_m, top_m
        How far the airspace reaches to the sides and up.
    obstacle_m
        A mast stands 11 m in front, so far to the side.
    """
    turn, shift = math.radians(turn_deg), np.array(shift_m)
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])

    def place(x: float, y: float, z: float) -> tuple[float, float, float]:
        u, v = shift + axes @ [x, y]
        return float(u), float(v), float(z)

    width, height = n_columns * panel_m[0], n_rows * panel_m[1]
    if bend_deg:
        half, radius = 0.5 * math.radians(bend_deg), width / math.radians(bend_deg)
        centre = place(0.0, radius, 0.0)[:2]
        azimuths = (turn - 0.5 * math.pi - half, turn - 0.5 * math.pi + half)
        facade = arc_grid("A", centre, radius, azimuths, (foot_m, foot_m + height), n_rows, n_columns)
    else:
        corners = place(-0.5 * width, 0.0, foot_m), place(0.5 * width, 0.0, foot_m)
        facade = panel_grid("A", (*corners, place(-0.5 * width, 0.0, foot_m + height)), n_rows, n_columns, gap_m=0.05)
    low, high = (shift - beside_m).tolist(), (shift + beside_m).tolist()
    mast: tuple[Obstacle, ...] = ()
    if obstacle_m is not None:
        x, y, _ = place(obstacle_m, -11.0, 0.0)
        mast = (Obstacle("mast", box_enu_m=((x - 0.5, y - 0.5, 0.0), (x + 0.5, y + 0.5, 9.0))),)
    airspace = Airspace((*low, 5.0), (*high, top_m), ground_z_m=0.0)
    site = Site("turned", ORIGIN, (facade,), airspace, place(0.0, -24.0, 0.0), obstacles=mast)
    return SiteModel(site, empty_mesh(), tuple(box_geometry(obstacle) for obstacle in mast))


def solid_triangles(model: SiteModel) -> Floats:
    """Panels, building and obstacles as triangles, shape (t, 3, 3)."""
    panels = [np.array(panel.corners_enu_m)[[[0, 1, 2], [0, 2, 3]]] for panel in model.site.panels]
    return np.concatenate([*panels, model.building.corners_enu_m, *(mesh.corners_enu_m for mesh in model.obstacles)])


def dense_points(path_enu_m: Floats, spacing_m: float = 0.1) -> Floats:
    """Points along a polyline, its vertices included, at most `spacing_m` apart; shape (n, 3)."""
    parts = [path_enu_m[:1]]
    for a, b in itertools.pairwise(path_enu_m):
        steps = max(1, math.ceil(np.linalg.norm(b - a) / spacing_m))
        parts.append(a + np.arange(1, steps + 1)[:, None] / steps * (b - a))
    return np.concatenate(parts)


def _some_at_a_time(n: int, n_triangles: int) -> Iterator[slice]:
    at_a_time = max(1, PAIRS_AT_A_TIME // max(n_triangles, 1))
    return (slice(start, start + at_a_time) for start in range(0, n, at_a_time))


def distances(points_enu_m: Floats, triangles: Floats) -> Floats:
    """Distance of each point, shape (n, 3), to the nearest triangle, shape (t, 3, 3): plane or one of three edges."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    squares = np.maximum((edges**2).sum(axis=2), 1e-300)
    normals = np.cross(edges[:, 0], -edges[:, 2])
    sizes = np.linalg.norm(normals, axis=1)
    inwards = np.cross(normals[:, None], edges)
    best = np.full(len(points_enu_m), np.inf)
    for some in _some_at_a_time(len(points_enu_m), len(triangles)):
        rays = points_enu_m[some, None, None] - triangles
        along = np.clip(np.einsum("ptec,tec->pte", rays, edges) / squares, 0.0, 1.0)
        beside = rays - along[..., None] * edges
        to_edges = np.sqrt(np.einsum("ptec,ptec->pte", beside, beside).min(axis=2))
        above_inside = (np.einsum("ptec,tec->pte", rays, inwards) >= 0.0).all(axis=2) & (sizes > 0.0)
        heights = np.abs(np.einsum("ptc,tc->pt", rays[:, :, 0], normals)) / np.maximum(sizes, 1e-300)
        best[some] = np.where(above_inside, np.minimum(to_edges, heights), to_edges).min(axis=1, initial=np.inf)
    return best


def lines_free(a_enu_m: Floats, b_enu_m: Floats, triangles: Floats) -> NDArray[np.bool_]:
    """Whether segments, ends of shape (k, 3), meet no triangle (T. Moeller and B. Trumbore, 1997)."""
    free = np.ones(len(a_enu_m), np.bool_)
    edge_1, edge_2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    for some in _some_at_a_time(len(a_enu_m), len(triangles)):
        direction = (b_enu_m - a_enu_m)[some, None]
        p = np.cross(direction, edge_2)
        determinant = (p * edge_1).sum(axis=2)
        crosses = np.abs(determinant) > 1e-12
        inverse = 1.0 / np.where(crosses, determinant, 1.0)
        ray = a_enu_m[some, None] - triangles[:, 0]
        u = (ray * p).sum(axis=2) * inverse
        q = np.cross(ray, edge_1)
        v = (direction * q).sum(axis=2) * inverse
        t = (q * edge_2).sum(axis=2) * inverse
        met = crosses & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t >= 0.0) & (t <= 1.0)
        free[some] = ~met.any(axis=1)
    return free


def seen_by_contract(
    model: SiteModel, camera: Camera, viewpoints: tuple[Viewpoint, ...], step_deg: float, occlusion: bool
) -> Counter[tuple[int, int]]:
    """How often each (panel, section) is covered, viewpoint by viewpoint and panel by panel as the contract puts it."""
    triangles = solid_triangles(model)
    found: Counter[tuple[int, int]] = Counter()
    for viewpoint in viewpoints:
        o = np.array(viewpoint.position_enu_m)
        h, p = math.radians(viewpoint.heading_deg), math.radians(viewpoint.gimbal_pitch_deg)
        forward = np.array([math.cos(p) * math.sin(h), math.cos(p) * math.cos(h), math.sin(p)])
        right = np.array([math.cos(h), -math.sin(h), 0.0])
        up = np.cross(right, forward)
        pairs, targets = [], []
        for j, panel in enumerate(model.site.panels):
            corners = np.array(panel.corners_enu_m)
            c = corners.mean(axis=0)
            n = np.cross(corners[2] - corners[0], corners[3] - corners[1])
            n = n / np.linalg.norm(n)
            depth = forward @ (c - o)
            half_width = camera.sensor_width_mm / (2.0 * camera.focal_length_mm) * depth
            half_height = camera.sensor_height_mm / (2.0 * camera.focal_length_mm) * depth
            if not (depth > 0.0 and abs(right @ (c - o)) <= half_width and abs(up @ (c - o)) <= half_height):
                continue
            d = (o - c) / np.linalg.norm(o - c)
            theta = math.degrees(math.acos(max(-1.0, min(1.0, d @ n))))
            if not theta < 90.0:
                continue
            t = np.cross([0.0, 0.0, 1.0], n)
            t = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(t) < 1e-6 else t / np.linalg.norm(t)
            phi = math.degrees(math.atan2(d @ np.cross(n, t), d @ t)) % 360.0
            pairs.append((j, int(theta // step_deg) * round(360.0 / step_deg) + int(phi // step_deg)))
            targets.append(c + 0.15 * n)
        if occlusion and pairs:
            free = lines_free(np.broadcast_to(o, (len(pairs), 3)), np.array(targets), triangles)
            pairs = [pair for pair, is_free in zip(pairs, free, strict=True) if is_free]
        found.update(pairs)
    return found


def inside_zone(points_enu_m: Floats, zone: NoFlyZone) -> NDArray[np.bool_]:
    """Whether points lie in a no-fly volume (even-odd rule)."""
    x, y, z = points_enu_m.T
    inside = np.zeros(len(points_enu_m), np.bool_)
    ring = np.array(zone.polygon_enu_m)
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
    return inside & (z > zone.floor_m) & (z < zone.ceiling_m)


def paths(plan: Plan) -> list[Floats]:
    """Vertices of each sortie's path."""
    return [np.array(sortie.path_enu_m, np.float64) for sortie in plan.sorties]


class StopAfter:
    """Stop criterion that does not hold the first `n` times it is asked."""

    def __init__(self, n: int) -> None:
        self.left = n

    def __call__(self) -> bool:
        self.left -= 1
        return self.left < 0
