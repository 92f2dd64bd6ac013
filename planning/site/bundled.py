"""Sites that the program makes itself: two bundled ones after the paper's cases, and scenes for tests and benchmarks.

`office` and `library` stand for the planar and the curved case of the paper (20 x 14 and 30 x 10 panels). The others
each call for something else: `court` and `canyon` for occlusion, `roof` for horizontal panels, `tower` for size.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.geo.frames import Origin, Vec3
from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh, extrude, write_mesh
from planning.site.file import write_site
from planning.site.records import Airspace, Facade, Obstacle, Panel, Site, SiteModel, box_geometry

ORIGIN = Origin(lat_deg=22.3372, lon_deg=114.2636, ellipsoid_height_m=62.0)
"""A campus in Hong Kong; the contract's example."""

Rectangle = tuple[Vec3, Vec3, Vec3]
"""Lower left, lower right and upper left corner as seen from outside."""


def panel_grid(facade_id: str, rectangle: Rectangle, n_rows: int, n_columns: int, gap_m: float = 0.0) -> Facade:
    """Facade of equal panels: rows from below, columns from the left as seen from outside.

    Parameters
    ----------
    rectangle
        Three corners; the outward normal is (right - left) x (up - low).
    gap_m
        Width of the mullions between neighbouring panels.
    """
    origin, right, up = (np.array(corner) for corner in rectangle)
    across, along = right - origin, up - origin
    gap_u, gap_v = 0.5 * gap_m / np.linalg.norm(across), 0.5 * gap_m / np.linalg.norm(along)
    rows, columns = (index.ravel()[:, None] for index in np.mgrid[:n_rows, :n_columns])
    u0, u1 = columns / n_columns + gap_u, (columns + 1) / n_columns - gap_u
    v0, v1 = rows / n_rows + gap_v, (rows + 1) / n_rows - gap_v
    places = ((u0, v0), (u1, v0), (u1, v1), (u0, v1))
    corners = np.stack([origin + u * across + v * along for u, v in places], axis=1)
    panels = [_panel(f"{facade_id}-{number:04d}", each) for number, each in enumerate(corners.tolist())]
    return Facade(facade_id, tuple(panels))


def arc_grid(
    facade_id: str,
    centre: tuple[float, float],
    radius_m: float,
    azimuths_rad: tuple[float, float],
    heights_m: tuple[float, float],
    n_rows: int,
    n_columns: int,
) -> Facade:
    """Facade of flat panels on a vertical cylinder, seen from outside; azimuths counter-clockwise from east."""
    angles = np.linspace(*azimuths_rad, n_columns + 1)
    ring = np.c_[centre[0] + radius_m * np.cos(angles), centre[1] + radius_m * np.sin(angles)]
    levels = np.linspace(*heights_m, n_rows + 1)
    panels: list[Panel] = []
    for low, high in itertools.pairwise(levels):
        for left, right in itertools.pairwise(ring):
            corners = [(*left, low), (*right, low), (*right, high), (*left, high)]
            panels.append(_panel(f"{facade_id}-{len(panels):04d}", corners))
    return Facade(facade_id, tuple(panels))


def _panel(panel_id: str, corners: Sequence[Sequence[float] | NDArray[np.float64]]) -> Panel:
    """Panel with coordinates rounded to 0.1 mm, so that the file reads back as it was."""
    a, b, c, d = ((round(float(x), 4), round(float(y), 4), round(float(z), 4)) for x, y, z in corners)
    return Panel(panel_id, (a, b, c, d))


def _model(
    name: str,
    facades: tuple[Facade, ...],
    building: TriangleMesh,
    airspace: Airspace,
    home_enu_m: Vec3,
    obstacles: tuple[Obstacle, ...] = (),
) -> SiteModel:
    site = Site(
        name=name,
        origin=ORIGIN,
        facades=facades,
        airspace=airspace,
        home_enu_m=home_enu_m,
        building_mesh=f"{name}.ply" if len(building.triangles) else None,
        obstacles=obstacles,
    )
    return SiteModel(site, building, tuple(box_geometry(obstacle) for obstacle in obstacles))


def office() -> SiteModel:
    """Free-standing office with one planar facade of 20 x 14 panels, 36 m x 42 m, facing south."""
    facade = panel_grid("A", ((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 42.0)), 14, 20, gap_m=0.1)
    building = box_mesh(np.array([-18.5, 0.0, 0.0]), np.array([18.5, 18.0, 43.0]))
    airspace = Airspace((-60.0, -70.0, 3.0), (60.0, 50.0, 75.0), ground_z_m=0.0)
    return _model("office", (facade,), building, airspace, (0.0, -45.0, 0.0))


def library() -> SiteModel:
    """Free-standing library with one convex facade of 30 x 10 panels on a cylinder of 30 m radius."""
    azimuths = (math.radians(-150.0), math.radians(-30.0))
    facade = arc_grid("A", (0.0, 0.0), 30.0, azimuths, (1.0, 25.0), 10, 30)
    lowest_row = facade.panels[:30]
    wall = [panel.corners_enu_m[0][:2] for panel in lowest_row] + [lowest_row[-1].corners_enu_m[1][:2]]
    building = extrude(np.array([*wall, (30.0, 5.0), (-30.0, 5.0)]), 0.0, 26.0)
    airspace = Airspace((-75.0, -90.0, 3.0), (75.0, 50.0, 60.0), ground_z_m=0.0)
    return _model("library", (facade,), building, airspace, (0.0, -60.0, 0.0))


def court() -> SiteModel:
    """L-shaped building: glass on both wings of the inner corner, so that each wing hides views of the other."""
    outline = np.array([[-40.0, -40.0], [-25.0, -40.0], [-25.0, 0.0], [25.0, 0.0], [25.0, 15.0], [-40.0, 15.0]])
    west = panel_grid("A", ((-25.0, -38.0, 1.0), (-25.0, -2.0, 1.0), (-25.0, -38.0, 22.0)), 7, 18)
    north = panel_grid("B", ((-23.0, 0.0, 1.0), (25.0, 0.0, 1.0), (-23.0, 0.0, 22.0)), 7, 24)
    airspace = Airspace((-80.0, -80.0, 3.0), (65.0, 55.0, 55.0), ground_z_m=0.0)
    return _model("court", (west, north), extrude(outline, 0.0, 23.0), airspace, (15.0, -50.0, 0.0))


def canyon() -> SiteModel:
    """A glass facade on a street 24 m wide, with another building of the same height across."""
    facade = panel_grid("A", ((-24.0, 0.0, 1.0), (24.0, 0.0, 1.0), (-24.0, 0.0, 31.0)), 10, 20)
    building = box_mesh(np.array([-24.5, 0.0, 0.0]), np.array([24.5, 16.0, 32.0]))
    opposite = Obstacle("opposite", box_enu_m=((-30.0, -40.0, 0.0), (30.0, -24.0, 32.0)))
    airspace = Airspace((-70.0, -75.0, 3.0), (70.0, 50.0, 65.0), ground_z_m=0.0)
    return _model("canyon", (facade,), building, airspace, (45.0, -12.0, 0.0), (opposite,))


def roof() -> SiteModel:
    """Horizontal skylights on a flat roof: panels whose normal is vertical."""
    facade = panel_grid("A", ((-10.0, -6.0, 12.0), (10.0, -6.0, 12.0), (-10.0, 6.0, 12.0)), 4, 8, gap_m=0.2)
    building = box_mesh(np.array([-12.0, -8.0, 0.0]), np.array([12.0, 8.0, 12.0]))
    airspace = Airspace((-50.0, -50.0, 3.0), (50.0, 50.0, 50.0), ground_z_m=0.0)
    return _model("roof", (facade,), building, airspace, (0.0, -30.0, 0.0))


def tower() -> SiteModel:
    """Tower of 3 640 panels: four facades of 14 columns and 65 rows."""
    half, top = 15.0, 130.0
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    facades = []
    for name, left, right in zip("ABCD", corners, [*corners[1:], corners[0]], strict=True):
        facades.append(panel_grid(name, ((*left, 0.0), (*right, 0.0), (*left, top)), 65, 14))
    building = box_mesh(np.array([-half, -half, 0.0]), np.array([half, half, top]))
    airspace = Airspace((-75.0, -75.0, 3.0), (75.0, 75.0, 165.0), ground_z_m=0.0)
    return _model("tower", tuple(facades), building, airspace, (0.0, -50.0, 0.0))


def single_panel() -> SiteModel:
    """One panel, nothing else: the smallest site."""
    facade = panel_grid("A", ((-1.0, 0.0, 9.0), (1.0, 0.0, 9.0), (-1.0, 0.0, 12.0)), 1, 1)
    airspace = Airspace((-50.0, -50.0, 2.0), (50.0, 20.0, 50.0), ground_z_m=0.0)
    return _model("single-panel", (facade,), empty_mesh(), airspace, (0.0, -30.0, 0.0))


SCENES: dict[str, Callable[[], SiteModel]] = {
    "office": office,
    "library": library,
    "court": court,
    "canyon": canyon,
    "roof": roof,
    "tower": tower,
    "single-panel": single_panel,
}


def write_scene(name: str, folder: Path) -> Path:
    """Write a scene's site file and mesh into `folder`; returns the path of the site file.

    Raises
    ------
    InputError
        There is no such scene.
    """
    if name not in SCENES:
        raise InputError.say("there is no bundled site '{}'; known are: {}", name, ", ".join(sorted(SCENES)))
    model = SCENES[name]()
    path = folder / f"{name}.site.json"
    if model.site.building_mesh is not None:
        write_mesh(folder / model.site.building_mesh, model.building)
    write_site(path, model.site)
    return path
