"""The waypoints of a plan as a pilot reads them: where, how high in which reference, when, looking where."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from planning.frames import Vec3
from planning.plan import Plan, Sortie, Viewpoint
from planning.site import Origin
from planning.sortie_timing import photo_vertices, sortie_flight_path
from planning.timing import motion_limits, stopping_times_s


class HeightShown(StrEnum):
    """What absolute heights on screen are measured from; each has its name, none is just "altitude"."""

    LOCAL = "local"
    """Zero of the site's own frame."""
    AMSL = "amsl"
    """Mean sea level: the EGM96 geoid."""
    ELLIPSOID = "ellipsoid"
    """WGS 84, as GNSS receivers count."""


@dataclass(frozen=True, slots=True)
class WaypointRow:
    """One photo, or one vertex of a path without any.

    Parameters
    ----------
    sortie
        Number from 1; 0 for viewpoints that are in no sortie.
    vertex
        Of the sortie's path, 0 at take-off, so that leg k ends at vertex k; None where the path misses the viewpoint.
    viewpoint
        None where no photo is taken.
    lat_deg, lon_deg, height_ellipsoid_m, altitude_amsl_m
        None for plans that do not say where they lie.
    height_above_takeoff_m
        Above the first point of the sortie, as a difference of heights in the local frame's vertical where the plan
        does not say where it lies; None without a path.
    leg_m
        Length of the leg that ends here; 0 for a second photo at one place.
    arrival_s
        After lift-off, by the plan's time model with a stop at every vertex, as missions are flown; None where the
        path cannot be flown so.
    """

    sortie: int
    vertex: int | None
    viewpoint: Viewpoint | None
    position_enu_m: Vec3
    leg_m: float | None = None
    arrival_s: float | None = None
    lat_deg: float | None = None
    lon_deg: float | None = None
    height_ellipsoid_m: float | None = None
    altitude_amsl_m: float | None = None
    height_above_takeoff_m: float | None = None

    def height_m(self, shown: HeightShown) -> float | None:
        """Height in one of the references; None where it is not known."""
        match shown:
            case HeightShown.LOCAL:
                return self.position_enu_m[2]
            case HeightShown.AMSL:
                return self.altitude_amsl_m
            case HeightShown.ELLIPSOID:
                return self.height_ellipsoid_m


def waypoint_rows(plan: Plan, origin: Origin | None = None) -> tuple[WaypointRow, ...]:
    """All waypoints in the order of flight, from take-off to landing; last the viewpoints that are in no sortie.

    `origin` is that of the site, for plans that do not say where they lie.
    """
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    rows: list[WaypointRow] = []
    for number, sortie in enumerate(plan.sorties, 1):
        rows += _sortie_rows(number, sortie, by_id, plan)
    flown = {viewpoint_id for sortie in plan.sorties for viewpoint_id in sortie.viewpoint_ids}
    rows += [WaypointRow(0, None, view, view.position_enu_m) for view in plan.viewpoints if view.id not in flown]
    return _placed(rows, plan.origin or origin)


def _sortie_rows(number: int, sortie: Sortie, by_id: dict[str, Viewpoint], plan: Plan) -> Iterator[WaypointRow]:
    views = [by_id[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids]
    path, vertices = sortie.path_enu_m, photo_vertices(sortie, by_id)
    if vertices is None or len(path) < 2:
        # The path misses photos: they are listed all the same, for the findings name them.
        yield from (WaypointRow(number, None, view, view.position_enu_m) for view in views)
        return
    at: list[list[Viewpoint]] = [[] for _ in path]
    for view, vertex in zip(views, vertices, strict=True):
        at[vertex].append(view)
    arrivals = iter(_arrivals_s(sortie, by_id, plan))
    for vertex, (point, photos) in enumerate(zip(path, at, strict=True)):
        leg_m = math.dist(path[vertex - 1], point) if vertex else 0.0
        for nth, photo in enumerate(photos or [None]):
            yield WaypointRow(number, vertex, photo, point, 0.0 if nth else leg_m, next(arrivals, None))


def _arrivals_s(sortie: Sortie, by_id: dict[str, Viewpoint], plan: Plan) -> Sequence[float]:
    """Arrival at each vertex, photos that share one following each other; empty in wind that cannot be flown in."""
    try:
        flown = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError:
        return ()
    return () if flown is None else [float(t) for t in stopping_times_s(flown[0], limits)]


def _placed(rows: Sequence[WaypointRow], origin: Origin | None) -> tuple[WaypointRow, ...]:
    """Rows with their places on the globe and their heights."""
    points = np.array([row.position_enu_m for row in rows], np.float64).reshape(-1, 3)
    takeoff_row = {row.sortie: index for index, row in enumerate(rows) if row.vertex == 0}
    if origin is None:
        above = _above_takeoff_m(rows, points[:, 2], takeoff_row)
        return tuple(replace(row, height_above_takeoff_m=m) for row, m in zip(rows, above, strict=True))
    from planning.geodesy.enu import geodetic_from_enu
    from planning.geodesy.geoid import amsl_from_ellipsoid_m

    lat, lon, height = geodetic_from_enu(origin, points)
    amsl = amsl_from_ellipsoid_m(lat, lon, height)
    above = _above_takeoff_m(rows, height, takeoff_row)
    placed = zip(rows, lat.tolist(), lon.tolist(), height.tolist(), amsl.tolist(), above, strict=True)
    return tuple(
        replace(
            row, lat_deg=a, lon_deg=b, height_ellipsoid_m=h, altitude_amsl_m=altitude_m, height_above_takeoff_m=above_m
        )
        for row, a, b, h, altitude_m, above_m in placed
    )


def _above_takeoff_m(
    rows: Sequence[WaypointRow], heights_m: NDArray[np.float64], takeoff_row: dict[int, int]
) -> list[float | None]:
    return [
        float(height - heights_m[takeoff_row[row.sortie]]) if row.sortie in takeoff_row else None
        for row, height in zip(rows, heights_m, strict=True)
    ]
