"""Lengths, courses and points along the legs of a geodetic polyline."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.errors import MissionError
from planning.base.messages import say
from planning.geo.frames import Origin

if TYPE_CHECKING:
    from pyproj import Geod

VERTICAL_LEG_M = 0.05
"""A leg that moves less than this sideways is vertical: no course can be read from it. GNSS noise is larger."""

MAX_SHOTS = 10_000
"""Photos on one leg, far more than a camera takes on a battery; only a wrong number asks for more."""


@cache
def _geod() -> Geod:
    from pyproj import Geod

    return Geod(ellps="WGS84")


def leg_lengths_m(lat_deg: ArrayLike, lon_deg: ArrayLike, height_m: ArrayLike) -> NDArray[np.float64]:
    """Straight lengths between consecutive points, shape (n - 1,) from n points; heights in any one reference."""
    from planning.geo.enu import enu_from_geodetic

    lat, lon, height = (np.asarray(values, np.float64) for values in (lat_deg, lon_deg, height_m))
    if len(lat) < 2:
        return np.zeros(0)
    # Heights above take-off are counted from some height near sea level; 1 km more would stretch legs by 0.02 %.
    first = Origin(float(lat[0]), float((lon[0] + 180.0) % 360.0 - 180.0), 0.0)
    points = enu_from_geodetic(first, lat, lon, height)
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def courses_deg(lat_deg: Sequence[float], lon_deg: Sequence[float]) -> list[float | None]:
    """Course at the start of each leg, clockwise from north in (-180, 180]; None for vertical legs."""
    if len(lat_deg) < 2:
        return []
    azimuth, _, distance_m = _geod().inv(lon_deg[:-1], lat_deg[:-1], lon_deg[1:], lat_deg[1:])
    pairs = zip(azimuth, distance_m, strict=True)
    return [None if away_m < VERTICAL_LEG_M else _wrapped(float(angle)) for angle, away_m in pairs]


def bearing_deg(from_lat_deg: float, from_lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> float:
    """Direction from one point to another, clockwise from north in (-180, 180]."""
    azimuth, _, _ = _geod().inv(from_lon_deg, from_lat_deg, to_lon_deg, to_lat_deg)
    return _wrapped(float(azimuth))


def distance_m(from_lat_deg: float, from_lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> float:
    """Horizontal distance of two points along the ellipsoid, metres."""
    _, _, away_m = _geod().inv(from_lon_deg, from_lat_deg, to_lon_deg, to_lat_deg)
    return float(away_m)


def point_between(
    start_lat_deg: float, start_lon_deg: float, end_lat_deg: float, end_lon_deg: float, fraction: float
) -> tuple[float, float]:
    """Latitude and longitude at `fraction` (0 to 1) of the geodesic from start to end."""
    geod: Any = _geod()
    azimuth, _, away_m = geod.inv(start_lon_deg, start_lat_deg, end_lon_deg, end_lat_deg)
    lon, lat, _ = geod.fwd(start_lon_deg, start_lat_deg, azimuth, away_m * fraction)
    return float(lat), float(lon)


def are_too_many(length: float, spacing: float) -> bool:
    """Whether a camera that triggers every `spacing` would take more photos on a leg than any camera can."""
    return spacing > 0.0 and not length / spacing <= MAX_SHOTS


def too_many_shots(length: float, spacing: float) -> str:
    """What is to be said then."""
    return say(
        "a camera trigger every {:g} would take {:.3g} photos on one leg; it is not followed", spacing, length / spacing
    )


def shots_on_leg(travelled: float, length: float, spacing: float) -> list[float]:
    """Where on a leg a camera triggers that triggers every `spacing`, as fractions of the leg in (0, 1].

    Parameters
    ----------
    travelled
        Way (or time) since the trigger was armed, at the start of the leg; a shot at its very start belongs to the
        leg before.
    length, spacing
        Of the leg and between shots, in the unit of `travelled`.

    Raises
    ------
    MissionError
        There would be more than `MAX_SHOTS` shots.
    """
    if length <= 0.0 or spacing <= 0.0:
        return []
    if are_too_many(length, spacing):
        raise MissionError(too_many_shots(length, spacing))
    # A shot within 1e-9 of a spacing after the end is that of the end itself, moved by rounding.
    first, last = np.floor(travelled / spacing + 1e-9) + 1.0, np.floor((travelled + length) / spacing + 1e-9)
    shots = (np.arange(first, last + 1.0) * spacing - travelled) / length
    return [min(1.0, float(shot)) for shot in shots]


def _wrapped(angle_deg: float) -> float:
    return angle_deg if angle_deg > -180.0 else 180.0
