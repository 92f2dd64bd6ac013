"""Files of ground heights: GeoTIFF in any reference system, tiles of Copernicus GLO-30 and SRTM, read window by window.

A raster is a grid of posts, the centres of its pixels (GDAL moves rasters whose pixels are points by the half pixel
that they need). What a raster does not know is NaN here: its own nodata value, masked pixels, voids of SRTM, blocks
that were never written, and heights that no ground on earth has.

Heights are above something, and a file mostly does not say what. It is taken from a compound or three-dimensional
reference system, and from the names of tiles; else it has to be stated.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import ANY_FILE, check_input_file, open_input_file
from planning.base.messages import about, say
from planning.geo.crs import CrsConversion, crs_conversion, crs_label, parse_crs

if TYPE_CHECKING:
    from pyproj import CRS

Array = NDArray[np.float64]

HeightUnit = Literal["auto", "m", "ft", "us-ft"]

FEET = {"m": 1.0, "ft": 0.3048, "us-ft": 1200.0 / 3937.0}
"""Metres per unit of height."""

UNIT_NAMES = {
    "": "auto",
    **dict.fromkeys(("m", "metre", "meter", "metres", "meters"), "m"),
    **dict.fromkeys(("ft", "foot", "feet", "international foot", "international feet"), "ft"),
    **dict.fromkeys(("us-ft", "us survey foot", "us survey feet", "ftus", "us foot", "sft"), "us-ft"),
}
"""What files call units of height (`UNITTYPE` of GDAL), in small letters and without underscores."""

LOWEST_M, HIGHEST_M = -1000.0, 10_000.0
"""Ground beyond is none: the shore of the Dead Sea lies at -430 m, an open mine at -300 m, Everest at 8 849 m."""

FILL_STEP_M = 5.0
"""No shore rises so far from one post to the next; between posts further apart, none is steeper than 45 degrees."""

MAX_JUDGED = 8_000_000
"""Posts that are judged at once: some 250 MB."""

MAX_FILES = 5000
"""Of one folder that are looked at."""

NEXT_TO = 1e-3
"""Part of a pixel by which posts of neighbouring tiles may miss each other."""

SRTM_SIZES = (1201, 3601)
SRTM_VOID = -32768

HEIGHT_FILES = (".tif", ".tiff", ".hgt")

_GLO = re.compile(r"(?i)copernicus_dsm_(?:cog_)?(\d\d)_([ns])(\d\d)_00_([ew])(\d{3})_00_(\w+)\.tiff?$")
_HGT = re.compile(r"(?i)(?:^|_)([ns])(\d\d)([ew])(\d{3})(?:\.\w+)?\.hgt$")


class Product(NamedTuple):
    """What is known of files by their names.

    `accuracy_m` holds for nine of ten places; `shows_surface`: roofs and trees are in it.
    """

    name: str
    vertical: str
    accuracy_m: float
    shows_surface: bool


GLO = Product("Copernicus DEM", "egm2008", 4.0, True)
"""Copernicus DEM Product Handbook, version 5: absolute vertical accuracy under 4 m (90 % linear error), EGM2008."""

SRTM = Product("SRTM", "egm96", 9.0, True)
"""Rodriguez, Morris and Belz, 2006, table 1: 90 % absolute height errors of 5.6 m (Africa) to 9.0 m (North America)."""


@dataclass(frozen=True, slots=True)
class HeightOptions:
    """What the user says about files of heights, where they do not say it themselves.

    Parameters
    ----------
    crs
        Of the coordinates.
    vertical
        What heights are above: `ellipsoid`, `egm96`, `egm2008`, or the code of a height system such as `EPSG:7837`.
    unit
        Of the heights.
    geoid
        Grid of the geoid that heights above sea level are above (`geoid_file`).
    """

    crs: str | None = None
    vertical: str | None = None
    unit: HeightUnit = "auto"
    geoid: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """A file of heights: where its posts are, and what its heights are above.

    Parameters
    ----------
    width, height
        Numbers of posts.
    from_pixel
        Coordinates of the posts: x = a column + b row + c, y = d column + e row + f, as (a, b, c, d, e, f).
    conversion
        Of its coordinates to WGS 84.
    vertical
        In words.
    is_round
        Coordinates are longitudes and latitudes, so that x comes back after 360 degrees.
    geoid_note
        Which geoid stands for what its heights are above; empty where that is said already.
    is_zero_unknown
        Whether heights of exactly 0 count as not known (`with_zeros_judged`).
    """

    path: Path
    width: int
    height: int
    from_pixel: tuple[float, float, float, float, float, float]
    conversion: CrsConversion
    vertical: str
    is_round: bool
    product: Product | None = None
    notes: tuple[str, ...] = ()
    geoid_note: str = ""
    is_zero_unknown: bool = False

    def coordinates(self, column: Array, row: Array) -> tuple[Array, Array]:
        """Coordinates of posts, x and y, in the raster's system."""
        a, b, c, d, e, f = self.from_pixel
        return a * column + b * row + c, d * column + e * row + f

    def pixels(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Columns and rows, not whole, of coordinates."""
        a, b, c, d, e, f = self.from_pixel
        if self.is_round:
            middle = self.coordinates(np.array(0.5 * self.width), np.array(0.5 * self.height))[0]
            x = np.remainder(x - middle + 180.0, 360.0) - 180.0 + middle
        dx, dy = x - c, y - f
        determinant = a * e - b * d
        return (e * dx - b * dy) / determinant, (a * dy - d * dx) / determinant

    def pixels_at(self, lat_deg: Array, lon_deg: Array) -> tuple[Array, Array]:
        """Columns and rows, not whole, of places on WGS 84; infinite where the raster's system has no such place."""
        from pyproj import Transformer

        x, y = Transformer.from_pipeline(self.conversion.pipeline).transform(lon_deg, lat_deg, direction="INVERSE")
        return self.pixels(np.asarray(x), np.asarray(y))

    def read(self, first_row: int, last_row: int, first_column: int, last_column: int) -> Array:
        """Heights in the file's unit of the posts of a window, ends excluded; NaN where it knows none.

        Raises
        ------
        InputError
            The file cannot be read, or is damaged.
        """
        window = first_row, last_row, first_column, last_column
        raw = _read_hgt(self, *window) if self.path.suffix.lower() == ".hgt" else _read_tiff(self, *window)
        metres = raw * self.conversion.height_unit_m
        with np.errstate(invalid="ignore"):
            is_height = (metres >= LOWEST_M) & (metres <= HIGHEST_M)
            return np.where(is_height & ((metres != 0.0) | (not self.is_zero_unknown)), raw, np.nan)


def open_heights(path: Path, options: HeightOptions = HeightOptions()) -> Raster:
    """A file of heights, described; no height is read yet.

    Raises
    ------
    InputError
        It is no such file, is damaged, or does not say what has to be known; the message says which option does.
    """
    check_input_file(path, ANY_FILE)
    if path.suffix.lower() == ".hgt":
        return _open_hgt(path, options)
    return _open_tiff(path, options)


def with_zeros_judged(raster: Raster, window: tuple[int, int, int, int], spacing_m: float) -> Raster:
    """A raster whose heights of exactly 0 count as not known where they look like a fill value, with a note.

    Programs fill holes and borders with 0, and often do not say so. A sea at 0 m has a shore that begins at 0; a patch
    of zeros of which no neighbour lies within `FILL_STEP_M` and 45 degrees of it has none. Neither has a window of
    nothing but zeros. Zeros are heights in products, and where a file says another value that means none.

    Parameters
    ----------
    window
        First and last rows and columns, ends excluded, of the posts that count.
    spacing_m
        Between its posts.
    """
    first_row, last_row, first_column, last_column = window
    if raster.product is not None or first_row >= last_row or first_column >= last_column or states_nodata(raster.path):
        return raster
    n_rows, is_all_zero = max(1, MAX_JUDGED // (last_column - first_column)), True
    for start in range(first_row, last_row, n_rows):
        # A row of the next part, too: what lies on both sides of the border between two parts touches.
        heights = raster.read(start, min(start + n_rows + 1, last_row), first_column, last_column)
        is_all_zero = is_all_zero and not (heights != 0.0).any()
        step_m = _fill_step_m(heights * raster.conversion.height_unit_m, max(FILL_STEP_M, spacing_m))
        if step_m is not None:
            text = say(
                "'{}' has heights of exactly 0 m that lie {:.0f} m or more off all heights around them, and does not "
                "say which value means that a height is not known: its zeros count as not known; where 0 m is the "
                "ground, write such a value into the file (gdal_edit.py -a_nodata -9999 FILE)",
                raster.path.name,
                step_m,
            )
            return replace(raster, is_zero_unknown=True, notes=(*raster.notes, text))
    if is_all_zero:
        raise InputError.say(
            "all its heights below the site are exactly 0 m, and it does not say which value means that a height is "
            "not known: take another file; where 0 m is the ground, write such a value into it (gdal_edit.py -a_nodata "
            "-9999 FILE), or attach no terrain",
            place=raster.path,
        )
    return raster


def _fill_step_m(heights_m: Array, least_m: float) -> float | None:
    """How far the nearest neighbour of a patch of zeros lies above or below it where that is at least some metres.

    None where all patches have nearer neighbours, or there is none.
    """
    from scipy.ndimage import label, minimum, minimum_filter

    zeros = heights_m == 0.0
    if not zeros.any() or zeros.all():
        return None
    off = np.where(zeros | np.isnan(heights_m), np.inf, np.abs(heights_m))
    nearest = minimum_filter(off, size=(3, 3), mode="nearest")
    patches, n_patches = label(zeros, structure=np.ones((3, 3)))
    steps = np.asarray(minimum(nearest, patches, np.arange(1, n_patches + 1)))
    steps = steps[np.isfinite(steps) & (steps >= least_m)]
    return float(steps.min()) if len(steps) else None


def states_nodata(path: Path) -> bool:
    """Whether a file says which of its values mean that a height is not known."""
    if path.suffix.lower() == ".hgt":
        return True
    import rasterio
    from rasterio.enums import MaskFlags
    from rasterio.errors import RasterioError

    try:
        with _quiet(), rasterio.Env(**GDAL_OPTIONS), rasterio.open(path, driver="GTiff") as source:
            return source.nodata is not None or MaskFlags.all_valid not in source.mask_flag_enums[0]
    except (RasterioError, OSError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from error


def height_files(place: Path, south_west_deg: tuple[float, float], north_east_deg: tuple[float, float]) -> list[Path]:
    """The files of a folder, and of those within it, that may hold heights of an area; a file stands for itself.

    Tiles whose names say where they lie are left out where that is elsewhere; so are layers of Copernicus tiles that
    are no heights.

    Parameters
    ----------
    south_west_deg, north_east_deg
        Latitudes and longitudes that enclose the area; the eastern one is the smaller where it lies across the 180th
        meridian.

    Raises
    ------
    InputError
        The folder has none, or too many to look at.
    """
    if not place.is_dir():
        return [place]
    found = sorted(path for path in place.rglob("*") if path.suffix.lower() in HEIGHT_FILES and path.is_file())
    if not found:
        raise InputError.say("the folder has no files of heights; expected .tif or .hgt", place=place)
    near = [path for path in found if _may_cover(path.name, south_west_deg, north_east_deg)]
    if not near:
        raise InputError.say(
            "none of the tiles in the folder ({}) covers the site; it needs {}",
            len(found),
            tile_names(south_west_deg, north_east_deg),
            place=place,
        )
    if len(near) > MAX_FILES:
        raise InputError.say(
            "the folder has {} files that may cover the site; expected at most {}; name the right ones",
            len(near),
            MAX_FILES,
            place=place,
        )
    return near


def tile_names(south_west_deg: tuple[float, float], north_east_deg: tuple[float, float]) -> str:
    """How tiles of one degree that cover an area are called: as SRTM does, the names of others have these in them."""
    south, west = (math.floor(value) for value in south_west_deg)
    north, east = (math.floor(value) for value in north_east_deg)
    east += 360 if east < west else 0
    names = [_tile_name(lat, lon) for lat in range(south, north + 1) for lon in range(west, east + 1)]
    return ", ".join(names)


def _tile_name(lat_deg: int, lon_deg: int) -> str:
    lon = (lon_deg + 180) % 360 - 180
    return f"{'S' if lat_deg < 0 else 'N'}{abs(lat_deg):02d}{'W' if lon < 0 else 'E'}{abs(lon):03d}"


def _may_cover(name: str, south_west_deg: tuple[float, float], north_east_deg: tuple[float, float]) -> bool:
    glo, hgt = _GLO.search(name), _HGT.search(name)
    if glo is not None:
        if glo[6].upper() != "DEM":
            return False
        south, west = _signed(glo[2], glo[3]), _signed(glo[4], glo[5])
    elif hgt is not None:
        south, west = _signed(hgt[1], hgt[2]), _signed(hgt[3], hgt[4])
    else:
        return not name.lower().startswith("copernicus_dsm")
    # A neighbour's first posts may be needed, two pixels of the coarsest tiles away.
    margin = 0.02
    width = (north_east_deg[1] - south_west_deg[1]) % 360.0
    from_west = (south_west_deg[1] - west + 180.0) % 360.0 - 180.0
    beside = from_west > 1.0 + margin or from_west + width < -margin
    return not beside and south - margin <= north_east_deg[0] and south_west_deg[0] <= south + 1.0 + margin


def _signed(letter: str, digits: str) -> int:
    return -int(digits) if letter.upper() in "SW" else int(digits)


# What heights are above.


class _Vertical(NamedTuple):
    is_orthometric: bool
    label: str
    note: str = ""


def _vertical(name: str, place: Path) -> _Vertical:
    """What heights are above, from `HeightOptions.vertical`."""
    wanted = name.strip().lower()
    if wanted == "ellipsoid":
        return _Vertical(False, say("the ellipsoid"))
    if wanted in ("egm96", "epsg:5773"):
        return _Vertical(True, "EGM96")
    if wanted in ("egm2008", "epsg:3855"):
        # Root mean square and largest difference: Guth, help of MICRODEM, "EGM96 and EGM2008 geoids".
        text = say(
            "EGM96 stands in for EGM2008: both differ by 0.5 m in the mean, at few places by several metres; home "
            "stands on the same terrain, so heights above take-off do not change; a grid of EGM2008 (--geoid) brings "
            "them nearer"
        )
        return _Vertical(True, "EGM2008", text)
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        system = CRS.from_user_input(name)
    except CRSError:
        system = None
    if system is None or not system.is_vertical:
        raise InputError.say(
            "'{}' is nothing that heights are above; expected ellipsoid, egm96, egm2008 or the code of a height system "
            "such as EPSG:7837",
            name,
            place=place,
        )
    return _of_system(system)


def _of_system(system: CRS) -> _Vertical:
    epsg = system.to_epsg()
    if epsg in (5773, 3855):
        return _vertical(f"epsg:{epsg}", Path())
    text = say(
        "EGM96 stands in for '{}', which may be off by 1 m, in mountains by 2 m; home stands on the same terrain, so "
        "heights above take-off do not change",
        system.name,
    )
    return _Vertical(True, system.name, text)


def _described(
    path: Path,
    size: tuple[int, int],
    from_pixel: tuple[float, float, float, float, float, float],
    crs: CRS,
    unit: str,
    product: Product | None,
    options: HeightOptions,
) -> Raster:
    """A raster from what its file says, `unit` that of its heights or `auto`, and what the user says."""
    width, height = size
    middle = (0.5 * width, 0.5 * height)
    a, b, c, d, e, f = from_pixel
    at = np.array([[a * middle[0] + b * middle[1] + c, d * middle[0] + e * middle[1] + f, 0.0]])
    stated = options.vertical or (None if product is None else product.vertical)
    own_unit_m = None
    is_3d = not crs.is_compound and len(crs.axis_info) == 3
    if stated is not None:
        vertical = _vertical(stated, path)
    elif crs.is_compound:
        system = crs.sub_crs_list[1]
        vertical, axis = _of_system(system), system.axis_info[0]
        own_unit_m = axis.unit_conversion_factor
        if axis.direction.lower() == "down":
            raise InputError.say("its values are depths ({}); expected heights", system.name, place=path)
    elif is_3d:
        vertical = _vertical("ellipsoid", path)
    else:
        raise InputError.say(
            "does not say what its heights are above ({} has no heights); say it with --vertical: ellipsoid, egm96, "
            "egm2008, or a height system such as EPSG:7837",
            crs_label(crs),
            place=path,
        )
    unit_m = _unit_m(unit, own_unit_m, options.unit, path)
    horizontal = (crs.sub_crs_list[0] if crs.is_compound else crs).to_2d()
    try:
        conversion = crs_conversion(horizontal.to_wkt(), at, "xy", "orthometric")
    except InputError as error:
        raise InputError(about(path, error)) from error
    # What heights are above, and their unit, are known better here than from the coordinates' system.
    conversion = replace(
        conversion,
        name=crs_label(horizontal),
        height_unit_m=unit_m,
        is_orthometric=vertical.is_orthometric,
        keeps_height=False,
    )
    is_round = bool(horizontal.is_geographic)
    # Of the datum shift; the last note is on heights.
    notes = conversion.notes[-2:-1] if conversion.accuracy_m > 0.0 else ()
    return Raster(path, width, height, from_pixel, conversion, vertical.label, is_round, product, notes, vertical.note)


def _unit_m(of_file: str, of_system_m: float | None, stated: HeightUnit, path: Path) -> float:
    """Metres per unit of height."""
    if stated != "auto":
        return FEET[stated]
    named_m = FEET.get(of_file)
    if named_m is not None and of_system_m is not None and abs(named_m - of_system_m) > 1e-9:
        raise InputError.say(
            "says two units of height: {:.7g} m with its heights and {:.7g} m in its reference system; say the right "
            "one with --height-unit",
            named_m,
            of_system_m,
            place=path,
        )
    return named_m or of_system_m or 1.0


# Tiles of SRTM: big-endian 16-bit heights of one degree, rows from north to south.


def _open_hgt(path: Path, options: HeightOptions) -> Raster:
    found = _HGT.search(path.name)
    if found is None:
        raise InputError.say("the name does not say where the tile lies; expected one such as N22E114.hgt", place=path)
    n_bytes = check_input_file(path, ANY_FILE).st_size
    size = next((size for size in SRTM_SIZES if 2 * size * size == n_bytes), None)
    if size is None:
        raise InputError.say(
            "has {} bytes; a tile of SRTM has {} or {}; copy it again",
            n_bytes,
            *(2 * size * size for size in SRTM_SIZES),
            place=path,
        )
    south, west, step = _signed(found[1], found[2]), _signed(found[3], found[4]), 1.0 / (size - 1)
    if not (-90 <= south < 90 and -180 <= west < 180):
        raise InputError.say("the name says a place that is not on earth", place=path)
    from_pixel = (step, 0.0, float(west), 0.0, -step, south + 1.0)
    crs = parse_crs(options.crs or "EPSG:4326")
    return _described(path, (size, size), from_pixel, crs, "m", SRTM, options)


def _read_hgt(raster: Raster, first_row: int, last_row: int, first_column: int, last_column: int) -> Array:
    with open_input_file(raster.path, ANY_FILE) as file:
        file.seek(2 * raster.width * first_row)
        content = file.read(2 * raster.width * (last_row - first_row))
    if len(content) != 2 * raster.width * (last_row - first_row):
        raise InputError.say("is cut off; copy it again", place=raster.path)
    posts = np.frombuffer(content, ">i2").reshape(-1, raster.width)[:, first_column:last_column]
    return np.where(posts == SRTM_VOID, np.nan, posts.astype(np.float64))


# GeoTIFF, by GDAL.

TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

GDAL_OPTIONS = {"GDAL_CACHEMAX": 64, "GDAL_NUM_THREADS": 1, "GTIFF_POINT_GEO_IGNORE": "FALSE"}


class TiffFacts(NamedTuple):
    """What a GeoTIFF of one band says of itself.

    `corners` places corners of pixels as `Raster.from_pixel` places posts; `wkt` and `unit` are empty where it names no
    reference system and no unit of its values.
    """

    size: tuple[int, int]
    corners: tuple[float, float, float, float, float, float]
    wkt: str
    kind: np.dtype[Any]
    unit: str


def tiff_facts(path: Path, what: str) -> TiffFacts:
    """What a GeoTIFF of one band says of itself; no value is read.

    Parameters
    ----------
    what
        Its values, in words.

    Raises
    ------
    InputError
        It is none, has several bands, is damaged, or does not say where it lies.
    """
    with open_input_file(path, ANY_FILE) as file:
        if file.read(4) not in TIFF_STARTS:
            raise InputError.say("is no GeoTIFF; expected {} as .tif", what, place=path)
    import rasterio
    from rasterio.errors import RasterioError

    try:
        with _quiet(), rasterio.Env(**GDAL_OPTIONS), rasterio.open(path, driver="GTiff") as source:
            if source.count != 1:
                raise InputError.say(
                    "has {} bands, as pictures have; expected one band of {}", source.count, what, place=path
                )
            kind = np.dtype(source.dtypes[0])
            size, transform = (int(source.width), int(source.height)), source.transform
            a, b, c, d, e, f = (float(value) for value in transform[:6])
            is_placed = not transform.is_identity
            wkt = "" if source.crs is None else str(source.crs.to_wkt(version="WKT2_2019"))
            unit = str(source.units[0] or "").lower().replace("_", " ")
    except (RasterioError, OSError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from error
    if not is_placed or not all(map(math.isfinite, (a, b, c, d, e, f))) or abs(a * e - b * d) < 1e-18:
        raise InputError.say("does not say where it lies; give a GeoTIFF with its georeference", place=path)
    return TiffFacts(size, (a, b, c, d, e, f), wkt, kind, unit)


def _open_tiff(path: Path, options: HeightOptions) -> Raster:
    size, (a, b, c, d, e, f), wkt, kind, unit = tiff_facts(path, say("heights"))
    if kind.kind not in "iuf" or kind.itemsize == 1:
        raise InputError.say(
            "holds values of the type {}, as shaded pictures do; expected heights as 16 or 32 bit",
            kind.name,
            place=path,
        )
    if options.crs is None and not wkt:
        raise InputError.say("names no coordinate reference system; name it with --crs", place=path)
    try:
        crs = parse_crs(options.crs or wkt)
    except InputError as error:
        if options.crs is not None:
            raise
        raise InputError.say(
            "names a coordinate reference system that is not known here; name it with --crs", place=path
        ) from error
    if unit not in UNIT_NAMES and options.unit == "auto":
        raise InputError.say(
            "its heights are in the unit '{}', which is not known here; say it with --height-unit", unit, place=path
        )
    glo = _GLO.search(path.name)
    # Posts are the centres of pixels.
    from_pixel = (a, b, c + 0.5 * (a + b), d, e, f + 0.5 * (d + e))
    return _described(path, size, from_pixel, crs, UNIT_NAMES.get(unit, "auto"), None if glo is None else GLO, options)


def _read_tiff(raster: Raster, first_row: int, last_row: int, first_column: int, last_column: int) -> Array:
    size = (raster.width, raster.height)
    return read_band(raster.path, size, first_row, last_row, first_column, last_column)


def read_band(
    path: Path, size: tuple[int, int], first_row: int, last_row: int, first_column: int, last_column: int
) -> Array:
    """Values of the only band of a GeoTIFF within a window, ends excluded; NaN where it knows none.

    Raises
    ------
    InputError
        The file cannot be read, is damaged, or is no longer of the size, columns and rows, that it had.
    """
    import rasterio
    from rasterio.errors import RasterioError
    from rasterio.windows import Window

    window = Window(first_column, first_row, last_column - first_column, last_row - first_row)
    try:
        with _quiet(), rasterio.Env(**GDAL_OPTIONS), rasterio.open(path, driver="GTiff") as source:
            if (source.width, source.height) != size:
                raise InputError.say("has changed while it was read", place=path)
            values = source.read(1, window=window, masked=True).astype(np.float64).filled(np.nan)
            values = values * source.scales[0] + source.offsets[0]
            if source.nodata is None:
                _forget_unwritten(source, values, first_row, first_column)
    except (RasterioError, OSError, ValueError, AttributeError) as error:
        raise _damaged(path, error) from error
    return np.asarray(values)


def _forget_unwritten(source: Any, heights: Array, first_row: int, first_column: int) -> None:
    """Set posts of blocks that the file leaves out to NaN: GDAL reads them as zero."""
    rows, columns = heights.shape
    block_rows, block_columns = source.block_shapes[0]
    for i in range(first_row // block_rows, (first_row + rows - 1) // block_rows + 1):
        for j in range(first_column // block_columns, (first_column + columns - 1) // block_columns + 1):
            if source.get_tag_item(f"BLOCK_OFFSET_{j}_{i}", "TIFF", bidx=1) is None:
                low, left = i * block_rows - first_row, j * block_columns - first_column
                heights[max(low, 0) : low + block_rows, max(left, 0) : left + block_columns] = np.nan


@contextmanager
def _quiet() -> Iterator[None]:
    """Without rasterio's warnings, of which each is looked for here and said in words."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def _damaged(path: Path, error: Exception) -> InputError:
    if isinstance(error, InputError):
        return error
    return InputError.say(
        "cannot be read as a GeoTIFF: it is cut off or damaged; copy or download it again, and compare its size with "
        "that at its source",
        place=path,
    )


def same_grid(one: Raster, other: Raster) -> bool:
    """Whether heights of one file may stand between posts of the other: same system, same unit, same heights."""
    return replace(one.conversion, notes=()) == replace(other.conversion, notes=()) and one.vertical == other.vertical


def unique_notes(rasters: Sequence[Raster]) -> tuple[str, ...]:
    """What is worth knowing about files, each thing once."""
    told = (note for raster in rasters for note in (raster.geoid_note, *raster.notes) if note)
    return tuple(dict.fromkeys(told))
