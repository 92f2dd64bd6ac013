"""People below a flight by a population raster: GeoTIFF of GHS-POP, WorldPop, GPW or others.

Such rasters count residents in one of two ways, people in each cell or people per square kilometre, and mostly do not
say in which. It is known of products by the names of their files, else it has to be stated. Cells are brought into the
local plane, where their areas are true to 0.01 % within some kilometres, whatever the raster's map does to areas.

What a raster does not know is not nobody: its nodata value, masked cells, negative counts, blocks that were never
written, and all beyond its edge count as unknown.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.crs import parse_crs
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.insight.ground_risk_request import Counts
from planning.site.importing.elevation import read_band, tiff_facts

if TYPE_CHECKING:
    from shapely import Geometry

Array = NDArray[np.float64]

Counted = Literal["cell", "km2"]

PRODUCTS: tuple[tuple[re.Pattern[str], str, Counted], ...] = (
    (re.compile(r"(?i)^ghs_pop_"), "GHS-POP", "cell"),
    (re.compile(r"(?i)(^|_)ppp_|_pop_\d{4}_.*(100m|1km)"), "WorldPop", "cell"),
    (re.compile(r"(?i)_pd_\d{4}_"), "WorldPop", "km2"),
    (re.compile(r"(?i)^gpw_v4_population_count"), "GPWv4", "cell"),
    (re.compile(r"(?i)^gpw_v4_population_density"), "GPWv4", "km2"),
)
"""Products by the names of their files, and what their values count (GHSL Data Package 2023, section 2.5; WorldPop's
and CIESIN's download pages)."""

MOST_CELLS = 1_000_000
"""Below one buffer; 100 m cells of a square of 100 km."""

LEAST_OVERLAP_M2 = 1.0
"""Cells that only touch an area are not below it."""

M2_PER_KM2 = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class PopulationRaster:
    """A raster of people, described; no value is read yet.

    Parameters
    ----------
    product
        By the name of the file; empty for none that is known.
    counts
        What a value counts people in: a cell, or a square kilometre.
    is_stated
        The pilot said so, not the name.
    width, height
        Numbers of cells.
    from_pixel
        Coordinates of cells' corners: x = a column + b row + c, y = d column + e row + f, as (a, b, c, d, e, f).
    crs
        Of the coordinates, as WKT.
    """

    path: Path
    product: str
    counts: Counted
    is_stated: bool
    width: int
    height: int
    from_pixel: tuple[float, float, float, float, float, float]
    crs: str


@dataclass(frozen=True, slots=True)
class People:
    """What a raster says of the people below an area.

    Parameters
    ----------
    most_per_km2, mean_per_km2
        In the cell with most people and in the mean of what is known; None where nothing is known.
    unknown
        Share of the area of which the raster knows nothing, 0 to 1.
    n_cells
        That the area reaches into.
    cell_m
        Side of a square as large as a cell.
    """

    file: str
    product: str
    counts: Counted
    is_stated: bool
    most_per_km2: float | None
    mean_per_km2: float | None
    unknown: float
    n_cells: int
    cell_m: float


def open_population(path: Path, counts: Counts = "auto") -> PopulationRaster:
    """A population raster, described.

    Parameters
    ----------
    counts
        What its values count people in; `auto`: as the name of its product says.

    Raises
    ------
    InputError
        It is no such file, is damaged, or does not say what its values count.
    """
    facts = tiff_facts(path, say("people"))
    if facts.kind.kind not in "iuf":
        raise InputError.say("holds values of the type {}; expected numbers", facts.kind.name, place=path)
    if not facts.wkt:
        raise InputError.say("names no coordinate reference system; take the file as its maker gives it", place=path)
    try:
        parse_crs(facts.wkt)
    except InputError as error:
        raise InputError.say("names a coordinate reference system that is not known here", place=path) from error
    known = next(((name, counted) for pattern, name, counted in PRODUCTS if pattern.search(path.name)), None)
    if known is None and counts == "auto":
        raise InputError.say(
            "does not say whether it counts people in a cell or per square kilometre; say it (--population-counts)",
            place=path,
        )
    product, counted = known if known is not None else ("", "cell")
    is_stated = counts != "auto"
    return PopulationRaster(
        path,
        product,
        counts if counts != "auto" else counted,
        is_stated,
        *facts.size,
        facts.corners,
        facts.wkt,
    )


def people_below(raster: PopulationRaster, area_enu: Geometry, origin: Origin) -> People:
    """People per square kilometre below an area, shapely in ENU metres about an origin.

    Every cell that the area reaches into counts for the maximum; the mean is weighted by the overlap.

    Raises
    ------
    InputError
        The file cannot be read or is damaged, or the area is torn by the edge of the raster's map.
    """
    import shapely

    columns, rows = _window(raster, area_enu, origin)
    n_columns, n_rows = columns[1] - columns[0], rows[1] - rows[0]
    if n_columns * n_rows > MOST_CELLS:
        raise InputError.say(
            "has more than {} cells below the buffer; the map of the raster may be torn here, or its cells are too "
            "fine: take one in longitudes and latitudes, of 100 m or more",
            MOST_CELLS,
            place=raster.path,
        )
    corners = _corners_enu(raster, columns, rows, origin)
    cells = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=2)
    values = _read(raster, columns, rows)
    polygons = shapely.polygons(cells.reshape(-1, 4, 2))
    sizes_m2 = shapely.area(polygons)
    shapely.prepare(area_enu)
    near = np.flatnonzero(shapely.intersects(area_enu, polygons))
    overlap_m2 = shapely.area(shapely.intersection(polygons[near], area_enu))
    is_below = overlap_m2 > LEAST_OVERLAP_M2
    near, overlap_m2 = near[is_below], overlap_m2[is_below]
    people = values.reshape(-1)[near]
    per_km2 = people if raster.counts == "km2" else people / (sizes_m2[near] / M2_PER_KM2)
    known = np.isfinite(per_km2)
    total_m2 = float(area_enu.area)
    known_m2 = float(overlap_m2[known].sum())
    unknown = 1.0 - min(1.0, known_m2 / total_m2) if total_m2 > 0.0 else 0.0
    most = float(per_km2[known].max()) if known.any() else None
    mean = float((per_km2[known] * overlap_m2[known]).sum() / known_m2) if known.any() else None
    cell_m = math.sqrt(float(np.median(sizes_m2)))
    return People(
        raster.path.name,
        raster.product,
        raster.counts,
        raster.is_stated,
        most,
        mean,
        0.0 if unknown < SLIVER else unknown,
        len(near),
        cell_m,
    )


SLIVER = 1e-3
"""Share of an area that is lost between cells by rounding, and by those that only touch it."""

SIDE_POINTS = 9
"""On each side of the box around an area: cells' lines are nearly straight within some kilometres."""


def _window(raster: PopulationRaster, area_enu: Geometry, origin: Origin) -> tuple[tuple[int, int], tuple[int, int]]:
    """Columns and rows, ends excluded, that may hold an area; they may lie beyond the raster."""
    west, south, east, north = area_enu.bounds
    x, y = np.meshgrid(np.linspace(west, east, SIDE_POINTS), np.linspace(south, north, SIDE_POINTS))
    lat, lon, _ = geodetic_from_enu(origin, np.c_[x.ravel(), y.ravel(), np.zeros(x.size)])
    lats, lons = np.append(lat, origin.lat_deg), np.append(lon, origin.lon_deg)
    first, second = _transformer(raster).transform(lons, lats, direction="INVERSE")
    px, py = np.asarray(first), np.asarray(second)
    if not (np.isfinite(px).all() and np.isfinite(py).all()):
        raise InputError.say("has no such place on its map", place=raster.path)
    if _is_round(raster):
        # Longitudes beside that of the site, so that nothing is torn at the 180th meridian.
        px = px[-1] + (px - px[-1] + 180.0) % 360.0 - 180.0
    a, b, c, d, e, f = raster.from_pixel
    determinant = a * e - b * d
    column = (e * (px - c) - b * (py - f)) / determinant
    row = (a * (py - f) - d * (px - c)) / determinant
    if _is_round(raster):
        turn = 360.0 / abs(a)
        column = column + turn * np.round((0.5 * raster.width - column[-1]) / turn)
    return (
        (math.floor(column.min()) - 1, math.ceil(column.max()) + 1),
        (math.floor(row.min()) - 1, math.ceil(row.max()) + 1),
    )


def _corners_enu(raster: PopulationRaster, columns: tuple[int, int], rows: tuple[int, int], origin: Origin) -> Array:
    """Places of cells' corners, shape (rows + 1, columns + 1, 2)."""
    column, row = np.meshgrid(np.arange(columns[0], columns[1] + 1.0), np.arange(rows[0], rows[1] + 1.0))
    a, b, c, d, e, f = raster.from_pixel
    x, y = a * column + b * row + c, d * column + e * row + f
    lon, lat = _transformer(raster).transform(x.ravel(), y.ravel())
    height = np.full(x.size, origin.ellipsoid_height_m)
    return np.asarray(enu_from_geodetic(origin, np.clip(lat, -90.0, 90.0), lon, height)[:, :2]).reshape(*x.shape, 2)


def _read(raster: PopulationRaster, columns: tuple[int, int], rows: tuple[int, int]) -> Array:
    """Values of a window, NaN where the raster knows none; a raster all around the earth goes on at its other end."""
    found = np.full((rows[1] - rows[0], columns[1] - columns[0]), np.nan)
    wanted = np.arange(*columns)
    turn = 360.0 / abs(raster.from_pixel[0])
    if _is_round(raster) and abs(turn - raster.width) < 0.5:
        wanted = wanted % raster.width
    first_row, last_row = max(rows[0], 0), min(rows[1], raster.height)
    # Runs of columns that follow one another in the file.
    for run in np.split(np.arange(len(wanted)), np.flatnonzero(np.diff(wanted) != 1) + 1):
        inside = run[(wanted[run] >= 0) & (wanted[run] < raster.width)]
        if len(inside) and first_row < last_row:
            low = int(wanted[inside[0]])
            part = read_band(raster.path, (raster.width, raster.height), first_row, last_row, low, low + len(inside))
            found[first_row - rows[0] : last_row - rows[0], inside[0] : inside[-1] + 1] = part
    with np.errstate(invalid="ignore"):
        return np.where((found >= 0.0) & np.isfinite(found), found, np.nan)


def _transformer(raster: PopulationRaster) -> Any:
    """From the raster's coordinates to longitudes and latitudes on WGS 84."""
    from pyproj import Transformer

    return Transformer.from_crs(parse_crs(raster.crs), "EPSG:4326", always_xy=True)


def _is_round(raster: PopulationRaster) -> bool:
    return bool(parse_crs(raster.crs).is_geographic)
