"""Files of heights made for tests: surfaces of the local frame as rasters in any system."""

from __future__ import annotations

import numpy as np
import rasterio
from affine import Affine
from pyproj import Transformer

from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m

ORIGIN = Origin(47.1, 8.3, 500.0)
UTM32 = "EPSG:32632"


def heights_above_ellipsoid(surface, lat_deg, lon_deg, origin=ORIGIN):
    """Heights at which points at places, any shape, lie on a surface z(x, y) of the local frame."""
    h = np.full(np.shape(lat_deg), origin.ellipsoid_height_m)
    for _ in range(4):
        p = enu_from_geodetic(origin, lat_deg, lon_deg, h).reshape(*np.shape(lat_deg), 3)
        h = h + np.nan_to_num(surface(p[..., 0], p[..., 1])) - p[..., 2]
    p = enu_from_geodetic(origin, lat_deg, lon_deg, h).reshape(*np.shape(lat_deg), 3)
    return np.where(np.isnan(surface(p[..., 0], p[..., 1])), np.nan, h)


def transform_at(origin=ORIGIN, crs=UTM32, pixel=1.0, half=100, turn_deg=0.0):
    """Geotransform of a raster of 2 half x 2 half pixels around a place, turned about it."""
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(origin.lon_deg, origin.lat_deg)
    corner = Affine.translation(-half, -half)
    return Affine.translation(x, y) @ Affine.rotation(turn_deg) @ Affine.scale(pixel, -pixel) @ corner


def write_heights(
    path,
    surface,
    origin=ORIGIN,
    crs=UTM32,
    transform=None,
    size=(200, 200),
    geoid=False,
    unit_m=1.0,
    tags=None,
    **profile,
):
    """A GeoTIFF of a surface, at the centres of its pixels; returns the heights written."""
    transform = transform_at(origin, crs) if transform is None else transform
    columns, rows = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    x, y = transform @ (columns, rows)
    horizontal = (
        rasterio.crs.CRS.from_user_input(crs).to_wkt()
        if profile.get("horizontal") is None
        else profile.pop("horizontal")
    )
    lon, lat = Transformer.from_crs(horizontal, "EPSG:4326", always_xy=True).transform(x, y)
    heights = heights_above_ellipsoid(surface, lat, lon, origin)
    if geoid:
        heights = heights - undulation_m(lat, lon)
    options = {"driver": "GTiff", "dtype": "float32", "count": 1, "nodata": -9999.0, "crs": crs, "transform": transform}
    written = np.where(np.isnan(heights), options["nodata"], heights / unit_m).astype("float64")
    with rasterio.open(path, "w", width=size[0], height=size[1], **{**options, **profile}) as file:
        file.write(written.astype(file.dtypes[0]), 1)
        if tags:
            file.update_tags(**tags)
        if unit_m != 1.0 and "units" not in profile:
            file.units = ("US survey foot",) if abs(unit_m - 1200 / 3937) < 1e-9 else ("ft",)
    return heights


def write_hgt(folder, name, surface, size=1201, origin=ORIGIN, void=None):
    """A tile of SRTM whose heights, above EGM96, are those of a surface rounded to metres."""
    south, west = int(name[1:3]) * (-1 if name[0] == "S" else 1), int(name[4:7]) * (-1 if name[3] == "W" else 1)
    step = 1.0 / (size - 1)
    # Only the posts near the origin are worth the time that their place takes.
    lat, lon = south + 1.0 - step * np.arange(size), west + step * np.arange(size)
    posts = np.zeros((size, size))
    away = np.remainder(lon - origin.lon_deg + 180.0, 360.0) - 180.0
    near_rows, near_columns = np.flatnonzero(np.abs(lat - origin.lat_deg) < 0.02), np.flatnonzero(np.abs(away) < 0.02)
    if len(near_rows) and len(near_columns):
        grid_lon, grid_lat = np.meshgrid(lon[near_columns], lat[near_rows])
        heights = heights_above_ellipsoid(surface, grid_lat, grid_lon, origin) - undulation_m(grid_lat, grid_lon)
        posts[np.ix_(near_rows, near_columns)] = heights
    whole = np.round(posts)
    if void is not None:
        whole[void(*np.meshgrid(lon, lat))] = -32768
    (folder / f"{name}.hgt").write_bytes(whole.astype(">i2").tobytes())
