"""Geoid heights of EGM96: what lies between a height above sea level and one above the WGS 84 ellipsoid.

The 15-minute grid is interpolated bilinearly, as DJI's FlightHub does (its own files agree to 0.3 mm). That is not
EGM96 itself: at cell centres, the worst places, it is off by 0.016 m in the median, by less than 0.21 m in 99 of 100
cells and by 1.1 m at most (against a bicubic spline, which reproduces NGA's six test points to 3 mm). EGM96 in turn is
some 0.5 to 1 m from the true geoid (NIMA TR8350.2, 2000). `tests.planning.geo.make_egm96_grid` says where the
grid comes from.

pyproj is no help here: its wheel has no vertical grids, and without them it returns heights unchanged and says nothing.
"""

from __future__ import annotations

import lzma
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

GRID_PATH = Path(__file__).parents[0] / "data" / "egm96_15_mm.xz"

N_ROWS, N_COLUMNS = 721, 1440
"""Rows from 90 S to 90 N, columns from 180 W eastwards, both in steps of 15 minutes."""


@cache
def grid_m() -> NDArray[np.float64]:
    """Geoid heights of the whole grid, metres, shape (721, 1440), read-only."""
    millimetres = np.frombuffer(lzma.decompress(GRID_PATH.read_bytes()), "<i2").reshape(N_ROWS, N_COLUMNS)
    for axis in (0, 0, 1, 1):
        millimetres = np.cumsum(millimetres, axis=axis, dtype=np.int64)
    grid = millimetres / 1000.0
    grid.flags.writeable = False
    return grid


def undulation_m(lat_deg: ArrayLike, lon_deg: ArrayLike) -> NDArray[np.float64]:
    """Height of the EGM96 geoid above the WGS 84 ellipsoid.

    Parameters
    ----------
    lat_deg, lon_deg
        Any shapes that broadcast; longitudes are understood modulo 360.

    Returns
    -------
    undulation_m
        Broadcast shape, metres, -107 to 86.

    Raises
    ------
    ValueError
        A value is not finite, or a latitude is outside -90 to 90.
    """
    lat, lon = np.broadcast_arrays(np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64))
    if not (np.isfinite(lat).all() and np.isfinite(lon).all()):
        raise ValueError("expected finite latitudes and longitudes")
    if (np.abs(lat) > 90.0).any():
        raise ValueError(f"lat_deg: expected -90 to 90, got {lat[np.abs(lat) > 90.0][0]}")
    grid = grid_m()
    row, column = (lat + 90.0) * 4.0, np.remainder(lon + 180.0, 360.0) * 4.0
    south = np.minimum(row.astype(np.int64), N_ROWS - 2)
    west = column.astype(np.int64)
    north_share, east_share = row - south, column - west
    # A remainder may round up to 360 itself; column 1440 is column 0.
    west, east = west % N_COLUMNS, (west + 1) % N_COLUMNS
    south_value = (1.0 - east_share) * grid[south, west] + east_share * grid[south, east]
    north_value = (1.0 - east_share) * grid[south + 1, west] + east_share * grid[south + 1, east]
    return np.asarray((1.0 - north_share) * south_value + north_share * north_value)


def amsl_from_ellipsoid_m(lat_deg: ArrayLike, lon_deg: ArrayLike, ellipsoid_height_m: ArrayLike) -> NDArray[np.float64]:
    """Height above mean sea level (EGM96) of points given by their height above the ellipsoid, metres."""
    return np.asarray(ellipsoid_height_m, np.float64) - undulation_m(lat_deg, lon_deg)


def ellipsoid_from_amsl_m(lat_deg: ArrayLike, lon_deg: ArrayLike, altitude_amsl_m: ArrayLike) -> NDArray[np.float64]:
    """Height above the ellipsoid of points given by their height above mean sea level (EGM96), metres."""
    return np.asarray(altitude_amsl_m, np.float64) + undulation_m(lat_deg, lon_deg)
