"""Geoid grids that the user has: `.pgm` of GeographicLib, `.gtx` and `.tif` of PROJ, read around one place.

Such grids are large (EGM2008 in steps of 5 minutes: 19 MB, of 1 minute: 467 MB) and not shipped. A window of some
minutes around a site is read, and interpolated bilinearly: in grids of 5, 2.5 and 1 minutes that is off by at most
0.48, 0.14 and 0.03 m from EGM2008 (GeographicLib, documentation of geoids).

PGM: big-endian 16 bit, rows from 90 N southwards, columns from 0 E; height = offset + scale value, both in comments
(GeographicLib, "The format of the geoid files"). GTX: big-endian; south, west, steps as float64, rows and columns as
int32, then float32 from the south-west, -88.8888 for nothing (NOAA VDatum).
"""

from __future__ import annotations

import math
import os
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.errors import InputError
from planning.base.files import ANY_FILE, check_input_file, open_input_file
from planning.base.messages import say
from planning.geo.geoid import undulation_m
from planning.site.importing.elevation import read_band, tiff_facts

Array = NDArray[np.float64]

GEOID_FILES = (".pgm", ".gtx", ".tif", ".tiff")

REACH_DEG = 0.1
"""Around a site; a site is at most some kilometres wide. In longitude as much more as the meridians are closer."""

MOST_NODES = 4_000_000
"""Of a window; a whole grid of 1 minute has 60 times as many."""

MOST_M = 120.0
"""No geoid is farther from the ellipsoid: -107 m south of India, 86 m at New Guinea."""

GTX_NOTHING = -88.8888
GTX_HEAD = struct.Struct(">4d2i")
MOST_HEAD = 4096

EGM2008_NAMES = ("egm2008-1.pgm", "egm2008-2_5.pgm", "egm2008-5.pgm", "us_nga_egm08_25.tif", "egm08_25.gtx")
"""As GeographicLib and PROJ call their grids of EGM2008, the finest first."""


@dataclass(frozen=True, slots=True, eq=False)
class GeoidWindow:
    """Geoid heights around a place.

    Parameters
    ----------
    file
        Name of the grid's file.
    model
        `EGM96` or `EGM2008` where the file says so; empty where it does not.
    south_deg, west_deg, step_deg
        Of the first node, and between nodes in latitude and longitude; rows go north.
    heights_m
        Above the ellipsoid, shape (n, k); NaN where the file knows none.
    """

    file: str
    model: str
    south_deg: float
    west_deg: float
    step_deg: tuple[float, float]
    heights_m: Array

    def undulation_m(self, lat_deg: ArrayLike, lon_deg: ArrayLike) -> Array:
        """Height of the geoid above the ellipsoid, metres, broadcast shape; NaN outside of the window."""
        lat, lon = np.broadcast_arrays(np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64))
        n, k = self.heights_m.shape
        row = (lat - self.south_deg) / self.step_deg[0]
        middle = self.west_deg + 0.5 * (k - 1) * self.step_deg[1]
        column = ((lon - middle + 180.0) % 360.0 - 180.0 + middle - self.west_deg) / self.step_deg[1]
        # A node at the very edge may lie beyond it by rounding.
        inside = (row >= -1e-9) & (row <= n - 1 + 1e-9) & (column >= -1e-9) & (column <= k - 1 + 1e-9)
        row, column = np.where(inside, row, 0.0).clip(0.0, n - 1.0), np.where(inside, column, 0.0).clip(0.0, k - 1.0)
        i, j = np.minimum(row.astype(np.int64), n - 2), np.minimum(column.astype(np.int64), k - 2)
        u, v, z = column - j, row - i, self.heights_m
        south = (1.0 - u) * z[i, j] + u * z[i, j + 1]
        north = (1.0 - u) * z[i + 1, j] + u * z[i + 1, j + 1]
        return np.asarray(np.where(inside, (1.0 - v) * south + v * north, np.nan))


@dataclass(frozen=True, slots=True)
class _Grid:
    """Where the nodes of a file are: from the first row and column on, rows going north or south."""

    first_lat_deg: float
    first_lon_deg: float
    lat_step_deg: float
    lon_step_deg: float
    n_rows: int
    n_columns: int


def open_geoid(path: Path, lat_deg: float, lon_deg: float) -> GeoidWindow:
    """A geoid grid around a place.

    Raises
    ------
    InputError
        It is no such file, is damaged, or does not cover the place.
    """
    ending = path.suffix.lower()
    if ending not in GEOID_FILES:
        raise InputError.say("is no geoid grid; expected .pgm of GeographicLib, or .gtx or .tif of PROJ", place=path)
    if ending == ".pgm":
        window, said = _pgm(path, lat_deg, lon_deg)
    elif ending == ".gtx":
        window, said = _gtx(path, lat_deg, lon_deg), ""
    else:
        window, said = _tif(path, lat_deg, lon_deg), ""
    found = GeoidWindow(path.name, _model(f"{path.name} {said}"), *window)
    here = float(found.undulation_m(lat_deg, lon_deg))
    if not math.isfinite(here):
        raise InputError.say(
            "this geoid grid knows nothing here ({:.4f}, {:.4f}); take one that covers the site",
            lat_deg,
            lon_deg,
            place=path,
        )
    if np.nanmax(np.abs(found.heights_m)) > MOST_M:
        raise InputError.say(
            "its heights, here {:.0f} m above the ellipsoid, are those of no geoid; is it damaged, or something else?",
            here,
            place=path,
        )
    return found


def found_geoid() -> Path | None:
    """A grid of EGM2008 that GeographicLib or PROJ has on this machine, the finest; None where there is none."""
    return next((path for name in EGM2008_NAMES for folder in _folders() if (path := folder / name).is_file()), None)


def _folders() -> Iterator[Path]:
    """Where GeographicLib and PROJ look for grids."""
    named = os.environ.get("GEOGRAPHICLIB_GEOID_PATH")
    data = os.environ.get("GEOGRAPHICLIB_DATA")
    yield from (Path(folder) for folder in (named, f"{data}/geoids" if data else None) if folder)
    yield from (Path("/usr/local/share/GeographicLib/geoids"), Path("/usr/share/GeographicLib/geoids"))
    from pyproj import datadir

    # Its own type stubs leave the second one out.
    texts = datadir.get_data_dir(), str(getattr(datadir, "get_user_data_dir")())  # noqa: B009
    yield from (Path(folder) for text in texts for folder in text.split(os.pathsep))


def _model(words: str) -> str:
    """Which geoid a file holds, by its name and what it says."""
    if re.search(r"(?i)egm_?(20)?08", words):
        return "EGM2008"
    return "EGM96" if re.search(r"(?i)egm_?(19)?96", words) else ""


_Window = tuple[float, float, tuple[float, float], Array]


def _ranges(grid: _Grid, lat_deg: float, lon_deg: float, path: Path) -> tuple[range, Array]:
    """Rows around a place, and columns, which go on around the earth; of at least two each."""
    aside = min(180.0, REACH_DEG / max(math.cos(math.radians(lat_deg)), 1e-3))
    margin = 2
    middle = (lat_deg - grid.first_lat_deg) / grid.lat_step_deg
    reach = REACH_DEG / abs(grid.lat_step_deg)
    rows = range(max(0, math.floor(middle - reach) - margin), min(grid.n_rows, math.ceil(middle + reach) + margin + 1))
    from_first = (lon_deg - grid.first_lon_deg + 180.0) % 360.0 - 180.0
    reach = aside / grid.lon_step_deg
    first = math.floor(from_first / grid.lon_step_deg - reach) - margin
    last = math.ceil(from_first / grid.lon_step_deg + reach) + margin
    turn = round(360.0 / grid.lon_step_deg)
    columns = np.arange(first, min(last, first + turn) + 1)
    columns = np.where(columns < 0, columns + turn, columns)
    inside = columns % turn if abs(grid.n_columns - turn) <= 1 else columns
    if len(rows) < 2 or not ((inside >= 0) & (inside < grid.n_columns)).any():
        raise InputError.say(
            "this geoid grid knows nothing here ({:.4f}, {:.4f}); take one that covers the site",
            lat_deg,
            lon_deg,
            place=path,
        )
    if len(rows) * len(inside) > MOST_NODES:
        raise InputError.say("is finer than any geoid grid; expected steps of a minute or more", place=path)
    return rows, np.stack([np.arange(first, first + len(inside)), inside])


def _placed(grid: _Grid, rows: range, columns: Array, values: Array) -> _Window:
    """A window of values, shape (rows, columns), with rows going north."""
    last = rows[-1] if grid.lat_step_deg < 0.0 else rows[0]
    south = grid.first_lat_deg + grid.lat_step_deg * last
    west = grid.first_lon_deg + grid.lon_step_deg * float(columns[0, 0])
    north_up = values[::-1] if grid.lat_step_deg < 0.0 else values
    return south, west, (abs(grid.lat_step_deg), grid.lon_step_deg), np.ascontiguousarray(north_up)


def _rows_of(path: Path, start: int, rows: range, columns: Array, width: int, kind: str) -> Array:
    """Numbers of a window in a file of whole rows."""
    size = np.dtype(kind).itemsize
    with open_input_file(path, ANY_FILE) as file:
        file.seek(start + size * width * rows[0])
        content = file.read(size * width * len(rows))
    if len(content) != size * width * len(rows):
        raise InputError.say("is cut off; copy it again", place=path)
    lines = np.frombuffer(content, kind).reshape(len(rows), width)
    inside = columns[1].astype(np.int64)
    is_there = (inside >= 0) & (inside < width)
    found = np.full((len(rows), len(inside)), np.nan)
    found[:, is_there] = lines[:, inside[is_there]]
    return found


def _pgm(path: Path, lat_deg: float, lon_deg: float) -> tuple[_Window, str]:
    with open_input_file(path, ANY_FILE) as file:
        head = file.read(MOST_HEAD)
    said = dict(re.findall(r"^#\s*(\w+)\s+(.*?)\s*$", head.decode("latin-1"), re.MULTILINE))
    sizes = re.match(rb"P5\s(?:\s*#[^\n]*\n)*\s*(\d+)\s+(\d+)\s+(?:#[^\n]*\n\s*)*(\d+)\s", head)
    try:
        offset, scale = float(said["Offset"]), float(said["Scale"])
    except (KeyError, ValueError):
        offset = scale = math.nan
    if sizes is None or int(sizes[3]) != 65535 or not (math.isfinite(offset) and 0.0 < scale < 1.0):
        raise InputError.say(
            "is no geoid of GeographicLib: expected P5 with '# Offset' and '# Scale' and 65535 steps", place=path
        )
    width, height = int(sizes[1]), int(sizes[2])
    if check_input_file(path, ANY_FILE).st_size != sizes.end() + 2 * width * height:
        raise InputError.say("is cut off, or goes on behind its grid; copy it again", place=path)
    if width < 4 or height < 3:
        raise InputError.say("has {} x {} nodes; expected those of the whole earth", width, height, place=path)
    grid = _Grid(90.0, 0.0, -180.0 / (height - 1), 360.0 / width, height, width)
    rows, columns = _ranges(grid, lat_deg, lon_deg, path)
    values = _rows_of(path, sizes.end(), rows, columns, width, ">u2")
    return _placed(grid, rows, columns, offset + scale * values), said.get("Description", "")


def _gtx(path: Path, lat_deg: float, lon_deg: float) -> _Window:
    with open_input_file(path, ANY_FILE) as file:
        head = file.read(GTX_HEAD.size)
    if len(head) != GTX_HEAD.size:
        raise InputError.say("is cut off; copy it again", place=path)
    south, west, lat_step, lon_step, n_rows, n_columns = GTX_HEAD.unpack(head)
    is_sane = all(map(math.isfinite, (south, west, lat_step, lon_step))) and -90.1 <= south <= 90.0
    is_sane = is_sane and -361.0 <= west <= 361.0 and 1e-4 < lat_step < 10.0 and 1e-4 < lon_step < 10.0
    if not is_sane or n_rows < 2 or n_columns < 2:
        raise InputError.say("is no geoid grid in the form GTX, or is damaged", place=path)
    if check_input_file(path, ANY_FILE).st_size != GTX_HEAD.size + 4 * n_rows * n_columns:
        raise InputError.say("is cut off, or goes on behind its grid; copy it again", place=path)
    grid = _Grid(south, west, lat_step, lon_step, n_rows, n_columns)
    rows, columns = _ranges(grid, lat_deg, lon_deg, path)
    values = _rows_of(path, GTX_HEAD.size, rows, columns, n_columns, ">f4")
    return _placed(grid, rows, columns, np.where(np.abs(values - GTX_NOTHING) < 1e-3, np.nan, values))


def _tif(path: Path, lat_deg: float, lon_deg: float) -> _Window:
    from planning.geo.crs import parse_crs

    facts = tiff_facts(path, say("geoid heights"))
    (width, height), (a, b, c, d, e, f) = facts.size, facts.corners
    if b or d or not (a > 0.0 > e) or facts.kind.kind != "f" or not facts.wkt or not parse_crs(facts.wkt).is_geographic:
        raise InputError.say("is no geoid grid: expected heights in longitudes and latitudes", place=path)
    grid = _Grid(f + 0.5 * e, c + 0.5 * a, e, a, height, width)
    rows, columns = _ranges(grid, lat_deg, lon_deg, path)
    inside = columns[1].astype(np.int64)
    values = np.full((len(rows), len(inside)), np.nan)
    for run in np.split(np.arange(len(inside)), np.flatnonzero(np.diff(inside) != 1) + 1):
        there = run[(inside[run] >= 0) & (inside[run] < width)]
        if len(there):
            first, last = int(inside[there[0]]), int(inside[there[-1]])
            values[:, there] = read_band(path, (width, height), rows[0], rows[-1] + 1, first, last + 1)
    return _placed(grid, rows, columns, values)


def geoid_text(window: GeoidWindow, lat_deg: float, lon_deg: float) -> str:
    """Which grid was used, and what it says at a place."""
    here = float(window.undulation_m(lat_deg, lon_deg))
    return say(
        "by the grid '{}' in steps of {:g} minutes: here {:.2f} m above the ellipsoid, {:+.2f} m from EGM96",
        window.file,
        60.0 * window.step_deg[0],
        here,
        here - float(undulation_m(lat_deg, lon_deg)),
    )
