"""Web Mercator (EPSG:3857) as web maps use it: world coordinates from 0 to 1, tiles, and true scale.

With longitude l and latitude p in radians, x = (l / pi + 1) / 2 runs east and y = (1 - asinh(tan p) / pi) / 2 runs
south; level z has 2^z by 2^z tiles of 256 x 256 points. The latitude is WGS 84's, used as if on a sphere: that is how
web maps are defined (EPSG method 1024), and why scale has to be taken from the ellipsoid (`metres_per_point`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin

TILE_POINTS = 256

MAX_LAT_DEG = math.degrees(math.atan(math.sinh(math.pi)))
"""85.0511...: where the square world ends."""

MAX_ZOOM = 24
"""Deeper than any tiles there are: a point is 9 mm at the equator."""

_A_M, _E2 = 6378137.0, 0.00669437999014
"""WGS 84: semi-major axis and square of the first eccentricity (NIMA TR8350.2)."""


class Tile(NamedTuple):
    """A tile: level, column from 180 W eastwards, row from the north southwards ("XYZ")."""

    zoom: int
    column: int
    row: int

    def parent(self, levels: int = 1) -> Tile:
        """The tile `levels` above that holds this one."""
        return Tile(self.zoom - levels, self.column >> levels, self.row >> levels)


def world_from_geodetic(lat_deg: ArrayLike, lon_deg: ArrayLike) -> NDArray[np.float64]:
    """World coordinates, shape (n, 2), of latitudes and longitudes that broadcast to shape (n,).

    Latitudes beyond the end of the world are brought to it; longitudes are not wrapped.
    """
    lat = np.radians(np.clip(np.asarray(lat_deg, np.float64), -MAX_LAT_DEG, MAX_LAT_DEG))
    lon = np.asarray(lon_deg, np.float64)
    x, y = np.broadcast_arrays(lon / 360.0 + 0.5, 0.5 - np.arcsinh(np.tan(lat)) / (2.0 * math.pi))
    return np.stack([x.ravel(), y.ravel()], axis=1)


def geodetic_from_world(x: float, y: float) -> tuple[float, float]:
    """Latitude and longitude in [-180, 180) of a point; y beyond the world is brought to its edge."""
    lat = math.degrees(math.atan(math.sinh(math.pi * (1.0 - 2.0 * min(max(y, 0.0), 1.0)))))
    return lat, (x - math.floor(x)) * 360.0 - 180.0


def world_from_enu(origin: Origin, points_enu_m: ArrayLike) -> NDArray[np.float64]:
    """World coordinates, shape (n, 2), of local points, shape (n, 3); next to the origin's also across 180 E."""
    lat, lon, _ = geodetic_from_enu(origin, points_enu_m)
    world = world_from_geodetic(lat, lon)
    centre_x = origin.lon_deg / 360.0 + 0.5
    world[:, 0] -= np.round(world[:, 0] - centre_x)
    return world


def metres_per_point(lat_deg: float, zoom: float) -> float:
    """Metres from west to east that one point spans, on the ellipsoid.

    N cos(p) 2 pi / (256 2^z) with the radius of curvature in the prime vertical N; from south to north it is up to
    0.7 % less.
    """
    lat = math.radians(lat_deg)
    radius_m = _A_M / math.sqrt(1.0 - _E2 * math.sin(lat) ** 2)
    return radius_m * math.cos(lat) * 2.0 * math.pi / (TILE_POINTS * math.exp2(zoom))
