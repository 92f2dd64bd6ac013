"""Sites and views for the tests of sun and sky."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta

import numpy as np

from planning.aircraft.catalogue import profile
from planning.geo.frames import Origin
from planning.geo.mesh import empty_mesh
from planning.geo.sun import SunTrack, sun_track
from planning.plan import Viewpoint
from planning.site.bundled import panel_grid
from planning.site.records import Airspace, Facade, Obstacle, Panel, Site, SiteModel, box_geometry

CAMERA = profile("m3e").camera


def wall(
    lat_deg: float = 48.0,
    lon_deg: float = 0.0,
    heading_deg: float = 180.0,
    slope_deg: float = 0.0,
    obstacles: tuple[Obstacle, ...] = (),
    n: int = 1,
    size_m: float = 4.0,
    tilt_deg: tuple[float, float] | None = None,
) -> SiteModel:
    """Panes of n x n in a square around (0, 0, 10), without a building; a slope of 90 makes a roof of them."""
    heading, slope = math.radians(heading_deg), math.radians(slope_deg)
    right = np.array([-math.cos(heading), math.sin(heading), 0.0])
    flat = np.array([math.sin(heading), math.cos(heading), 0.0])
    normal = math.cos(slope) * flat + math.sin(slope) * np.array([0.0, 0.0, 1.0])
    up = np.cross(normal, right)
    middle, half = np.array([0.0, 0.0, 10.0]), size_m / 2.0
    places = [middle - half * right - half * up, middle + half * right - half * up, middle - half * right + half * up]
    facade = panel_grid("A", tuple(tuple(map(float, place)) for place in places), n, n)  # type: ignore[arg-type]
    if tilt_deg is not None:
        panels = tuple(Panel(each.id, each.corners_enu_m, None, tilt_deg) for each in facade.panels)
        facade = Facade("A", panels)
    site = Site(
        "wall",
        Origin(lat_deg, lon_deg, 0.0),
        (facade,),
        Airspace((-80.0, -80.0, 2.0), (80.0, 80.0, 60.0), ground_z_m=0.0),
        (0.0, -40.0, 0.0),
        obstacles=obstacles,
    )
    return SiteModel(site, empty_mesh(), tuple(box_geometry(obstacle) for obstacle in obstacles))


def day_of(model: SiteModel, day: str = "2026-03-20", hours: float = 24.0, least_s: float = 10.0) -> SunTrack:
    """A day of a site, in UTC."""
    start = datetime.fromisoformat(day).replace(tzinfo=UTC)
    origin = model.site.origin
    return sun_track(origin.lat_deg, origin.lon_deg, start, start + timedelta(hours=hours), least_s)


def moment_of(model: SiteModel, at: datetime) -> SunTrack:
    """A second of a day."""
    origin = model.site.origin
    return sun_track(origin.lat_deg, origin.lon_deg, at, at + timedelta(seconds=1.0), 1.0)


def aimed(name: str, place: object, direction: object) -> Viewpoint:
    """A view from a place along a direction."""
    d = np.asarray(direction, float) / np.linalg.norm(np.asarray(direction, float))
    x, y, z = map(float, np.asarray(place, float))
    return Viewpoint(name, (x, y, z), math.degrees(math.atan2(d[0], d[1])), math.degrees(math.asin(d[2])))
