"""Coordinates of city models and drawings to WGS 84: axis order, datum and heights.

Three traps are dealt with here, each with a note for the user:

- *Axis order.* EPSG lists some systems as (north, east); files mostly hold (east, north) whatever the system says. What
  the numbers allow is decided by the system's area of use.
- *Datum shift.* The operation is chosen for the place and its accuracy is told. Where only a "ballpark" one is known,
  which may be off by hundreds of metres, the import is refused.
- *Heights.* A height above a national datum needs a geoid grid. None is in pyproj's wheel, and PROJ then passes the
  number through unchanged without a word. EGM96 stands in for all of them, and the note says what that costs.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.errors import InputError
from planning.base.messages import joined, say
from planning.geo.enu import Geodetic, wrap_longitude_deg
from planning.geo.geoid import undulation_m

if TYPE_CHECKING:
    from pyproj import CRS


# Names of coordinate reference systems, in every form that files use, to PROJ's description of them.

_ADV_HORIZONTAL = {"ETRS89_UTM31": 25831, "ETRS89_UTM32": 25832, "ETRS89_UTM33": 25833}
_ADV_HORIZONTAL |= {f"DE_DHDN_3GK{zone}": 31464 + zone for zone in (2, 3, 4, 5)}
_ADV_VERTICAL = {"DE_DHHN12_NOH": 7699, "DE_DHHN85_NOH": 5784, "DE_DHHN92_NH": 5783, "DE_DHHN2016_NH": 7837}
"""Names that the German surveying authorities write instead of EPSG codes (urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH)."""


def parse_crs(name: str) -> CRS:
    """Coordinate reference system from its name.

    Understood are `EPSG:7415`, `7415`, `EPSG:25832+7837`, OGC URNs (simple and compound), OGC URLs (likewise), the old
    `epsg.xml#` form, and `urn:adv:crs:` names.

    Raises
    ------
    InputError
        The name means nothing to PROJ, or names something without horizontal coordinates.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        crs = CRS.from_user_input(_plain_name(name.strip()))
    except CRSError as error:
        raise InputError.say(
            "'{}' is not a coordinate reference system known here; expected a code such as EPSG:25832, "
            "EPSG:7415 or EPSG:25832+7837",
            name,
        ) from error
    horizontal = horizontal_part(crs)
    if not (horizontal.is_projected or horizontal.is_geographic):
        raise InputError.say("'{}' is a {}; expected a projected or geographic system", name, crs.type_name)
    return crs


def horizontal_part(crs: CRS) -> CRS:
    """The system without the vertical one that it may be compounded with."""
    return crs.sub_crs_list[0] if crs.is_compound else crs


def crs_label(crs: CRS) -> str:
    """Code and name of a system, for messages."""
    codes = [crs.to_epsg()]
    if codes == [None] and crs.is_compound:
        codes = [part.to_epsg() for part in crs.sub_crs_list]
    return crs.name if None in codes else f"EPSG:{'+'.join(str(code) for code in codes)} ({crs.name})"


def _plain_name(name: str) -> str:
    """Name in a form that PROJ itself understands."""
    if codes := re.findall(r"def/crs/EPSG/[\d.]+/(\d+)", name):
        return "EPSG:" + "+".join(codes)
    if old := re.search(r"epsg\.xml#(\d+)$", name):
        return f"EPSG:{old[1]}"
    if adv := re.fullmatch(r"urn:adv:crs:(\w+)(?:\*(\w+))?", name):
        horizontal, vertical = _ADV_HORIZONTAL.get(adv[1]), _ADV_VERTICAL.get(adv[2] or "")
        if horizontal is not None:
            return f"EPSG:{horizontal}" + (f"+{vertical}" if vertical is not None else "")
    return name


AxisOrder = Literal["auto", "xy", "yx"]
"""`xy`: east or longitude first; `yx`: north or latitude first; `auto`: what fits the area of use."""

HeightReference = Literal["auto", "orthometric", "ellipsoid"]
"""What heights in the file are above: sea level, the ellipsoid, or whatever the system says (sea level if nothing)."""

AREA_MARGIN_DEG = 6.0
"""Systems are used beyond their area of use (all of Germany in UTM zone 32), but hardly by more than one zone."""

MIN_FAR_COORDINATE = 100_000.0
"""Smaller numbers must lie inside the area of use proper: around zero they are rather local coordinates or degrees."""

GEOID_UNCERTAINTY = say("which may be off by 1 m, in mountains by 2 m")
"""EGM96 against a national height datum: 0.5 to 1 m of the model itself (NIMA TR8350.2), the datum's own offset, and
what a 15-minute grid cannot show: 2.0 m in the Alps against swisstopo's example."""

EGM96_HEIGHT_EPSG = 5773


class Geoid(Protocol):
    """Heights of a geoid above the WGS 84 ellipsoid."""

    def undulation_m(self, lat_deg: ArrayLike, lon_deg: ArrayLike) -> NDArray[np.float64]:
        """As `planning.geo.geoid.undulation_m`."""


@dataclass(frozen=True, slots=True)
class CrsConversion:
    """How to bring coordinates of one file to WGS 84, decided once for the whole file.

    Parameters
    ----------
    name
        The system in words.
    pipeline
        PROJ pipeline from (east, north) or (longitude, latitude), in the system's units, to degrees on WGS 84; it takes
        and gives ellipsoidal heights where `keeps_height`.
    swaps
        The file holds north or latitude first.
    keeps_height
        The pipeline converts heights, too (the system is three-dimensional).
    height_unit_m
        Metres upwards per unit of the third coordinate, where the pipeline leaves it alone.
    is_orthometric
        Heights are above sea level; EGM96 turns them into ellipsoidal ones.
    accuracy_m
        Of the horizontal operation as EPSG states it; 0 where no datum is shifted.
    notes
        What was decided and what it may cost, for the user.
    geoid
        A grid in the place of EGM96.
    """

    name: str
    pipeline: str
    swaps: bool
    keeps_height: bool
    height_unit_m: float
    is_orthometric: bool
    accuracy_m: float
    notes: tuple[str, ...]
    geoid: Geoid | None = None

    def geodetic(self, coordinates: NDArray[np.float64]) -> Geodetic:
        """WGS 84 positions of file coordinates, shape (n, 3).

        Raises
        ------
        InputError
            A point has no position in this system.
        """
        from pyproj import Transformer

        first, second, height = np.asarray(coordinates, np.float64).reshape(-1, 3).T
        x, y = (second, first) if self.swaps else (first, second)
        transformer = Transformer.from_pipeline(self.pipeline)
        if self.keeps_height:
            lon, lat, height_m = transformer.transform(x, y, height)
        else:
            lon, lat = transformer.transform(x, y)
            height_m = height * self.height_unit_m
        is_good = np.isfinite(lon) & np.isfinite(lat) & np.isfinite(height_m)
        if not is_good.all():
            bad = tuple(coordinates[int(np.argmin(is_good))].tolist())
            raise InputError.say(
                "the point {} has no position in {}; is this the system the file is in?", bad, self.name
            )
        if self.is_orthometric:
            height_m = height_m + (undulation_m if self.geoid is None else self.geoid.undulation_m)(lat, lon)
        return Geodetic(np.asarray(lat), wrap_longitude_deg(lon), np.asarray(height_m))


def crs_conversion(
    name: str,
    coordinates: NDArray[np.float64],
    axis_order: AxisOrder = "auto",
    height_reference: HeightReference = "auto",
) -> CrsConversion:
    """Decide how coordinates of a file in the system `name` become WGS 84.

    Parameters
    ----------
    coordinates
        All or some points of the file, shape (n, 3), n > 0: they tell the place and the axis order.

    Raises
    ------
    InputError
        The system is not known, no operation to WGS 84 of known accuracy is, or the points lie far outside the system's
        area of use in either order of axes.
    """
    crs = parse_crs(name)
    horizontal = horizontal_part(crs)
    keeps_height = len(horizontal.axis_info) == 3 and height_reference != "orthometric"
    if not keeps_height:
        horizontal = horizontal.to_2d()
    middle = np.median(np.asarray(coordinates, np.float64), axis=0)
    order = _axis_order(name, horizontal, middle, axis_order)
    lon_deg, lat_deg = _place(horizontal, *_east_north(middle, order.swaps))
    operation = _operation(horizontal, lon_deg, lat_deg)
    height = _heights(crs, height_reference, keeps_height, float(undulation_m(lat_deg, lon_deg)))
    return CrsConversion(
        name=crs_label(crs),
        pipeline=operation.pipeline,
        swaps=order.swaps,
        keeps_height=keeps_height,
        height_unit_m=height.unit_m,
        is_orthometric=height.is_orthometric,
        accuracy_m=operation.accuracy_m,
        notes=(*order.notes, operation.note, height.note),
    )


def _east_north(point: NDArray[np.float64], swaps: bool) -> tuple[float, float]:
    return (float(point[1]), float(point[0])) if swaps else (float(point[0]), float(point[1]))


def _place(crs: CRS, x: float, y: float) -> tuple[float, float]:
    """Longitude and latitude on the system's own datum, degrees; infinite or beyond 90 where there is no such place."""
    from pyproj import Transformer

    geographic = crs.geodetic_crs
    assert geographic is not None  # parse_crs lets only projected and geographic systems through
    lon, lat = Transformer.from_crs(crs.to_2d(), geographic.to_2d(), always_xy=True).transform(x, y)
    return float(lon), float(lat)


class _Order(NamedTuple):
    swaps: bool
    notes: tuple[str, ...]


def _axis_order(name: str, crs: CRS, middle: NDArray[np.float64], stated: AxisOrder) -> _Order:
    """Which of the first two coordinates is east.

    Where both orders are possible, a geographic system named by URN or URL means what the authority lists; old short
    names ("EPSG:4326") are longitude first by custom; projected coordinates are east first in city models whatever the
    name.
    """
    lists_north_first = crs.axis_info[0].direction.lower() in ("north", "south")
    is_short_name = re.match(r"(?i)\s*(epsg:)?\d", name) is not None
    prefers_swap = lists_north_first and crs.is_geographic and not is_short_name
    in_words = {False: say("(east, north)"), True: say("(north, east)")}
    orders = (prefers_swap, not prefers_swap) if stated == "auto" else (stated == "yx",)
    is_far = float(np.abs(middle[:2]).max()) > MIN_FAR_COORDINATE
    for margin_deg in (0.0, AREA_MARGIN_DEG) if is_far else (0.0,):
        for swaps in orders:
            if _is_in_area(crs, *_east_north(middle, swaps), margin_deg):
                if swaps == lists_north_first or stated != "auto":
                    return _Order(swaps, ())
                listed = in_words[lists_north_first]
                note = say(
                    "coordinates are read as {}, as they fit; {} itself lists {}", in_words[swaps], crs.name, listed
                )
                return _Order(swaps, (note,))
    tried = joined(say(" and as "), (in_words[swaps] for swaps in orders))
    raise InputError.say(
        "the coordinates ({:.2f}, {:.2f}), read as {}, lie far outside the area of use of {}; name the "
        "right system with --crs",
        middle[0],
        middle[1],
        tried,
        crs_label(crs),
    )


def _is_in_area(crs: CRS, x: float, y: float, margin_deg: float) -> bool:
    """True where (east, north) coordinates lie in the system's area of use, widened by a margin."""
    lon, lat = _place(crs, x, y)
    if not (np.isfinite(lon) and abs(lon) <= 360.0 and np.isfinite(lat) and abs(lat) <= 90.0):
        return False
    if crs.area_of_use is None:
        return True
    west, south, east, north = crs.area_of_use.bounds
    width = (east - west) % 360.0 or 360.0
    from_west = (lon - west + margin_deg) % 360.0
    return bool(from_west <= width + 2.0 * margin_deg and south - margin_deg <= lat <= north + margin_deg)


class _Operation(NamedTuple):
    pipeline: str
    accuracy_m: float
    note: str


def _operation(crs: CRS, lon_deg: float, lat_deg: float) -> _Operation:
    """The most accurate operation to WGS 84 at a place that needs no absent grid."""
    from pyproj.transformer import AreaOfInterest, TransformerGroup

    lon, lat = float(wrap_longitude_deg(lon_deg)), min(max(lat_deg, -89.9), 89.9)
    place = AreaOfInterest(max(lon - 0.05, -180.0), lat - 0.05, min(lon + 0.05, 180.0), lat + 0.05)
    target = "EPSG:4979" if len(crs.axis_info) == 3 else "EPSG:4326"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of the absent grid, which the note below names
        group = TransformerGroup(crs, target, always_xy=True, area_of_interest=place, allow_ballpark=False)
    best = next((t for t in group.transformers if t.accuracy >= 0.0), None)
    if best is None:
        raise InputError.say(
            "no transformation to WGS 84 of known accuracy is installed; convert the file to a system on WGS "
            "84 or ETRS89 first (a UTM zone, say)",
            place=crs_label(crs),
        )
    note = say("coordinates are in {}", crs_label(crs))
    if best.accuracy > 0.0:
        shift = next((step for step in best.description.split(" + ") if " to WGS 84" in step), best.description)
        note += say(
            "; '{}' is accurate to about {:.3g} m, by which the whole site may be displaced", shift, best.accuracy
        )
        for finer in group.unavailable_operations:
            if grids := [grid.short_name for grid in finer.grids if not grid.available]:
                note += say(" (a finer one, {:.3g} m, needs the grid {})", finer.accuracy, grids[0])
                break
    return _Operation(best.definition, float(best.accuracy), note)


class _Heights(NamedTuple):
    unit_m: float
    is_orthometric: bool
    note: str


def _heights(crs: CRS, stated: HeightReference, keeps_height: bool, geoid_m: float) -> _Heights:
    """What the third coordinate is above, and its unit."""
    geoid = say("EGM96, here {:.1f} m above the ellipsoid", geoid_m)
    stand_in = say("{}, stands in for the national geoid, {}", geoid, GEOID_UNCERTAINTY)
    if crs.is_compound:
        vertical = crs.sub_crs_list[1]
        axis = vertical.axis_info[0]
        unit_m = axis.unit_conversion_factor * (-1.0 if axis.direction.lower() == "down" else 1.0)
        if stated == "ellipsoid":
            return _Heights(
                unit_m, False, say("heights are taken above the ellipsoid, as you asked, not as {}", vertical.name)
            )
        if vertical.to_epsg() == EGM96_HEIGHT_EPSG:
            return _Heights(unit_m, True, say("heights are above the geoid of {}", geoid))
        return _Heights(unit_m, True, say("heights are in the system '{}'; {}", vertical.name, stand_in))
    if keeps_height:
        return _Heights(1.0, False, say("heights are above the ellipsoid, as the system says"))
    axis = crs.axis_info[0]
    unit_m = axis.unit_conversion_factor if crs.is_projected else 1.0
    unit = "" if unit_m == 1.0 else say(" in the unit of the other coordinates ({})", axis.unit_name)
    if stated == "ellipsoid":
        return _Heights(unit_m, False, say("heights are taken above the ellipsoid{}, as you asked", unit))
    why = (
        say("as you asked")
        if stated == "orthometric"
        else say("as the system has none of its own (see --height-reference)")
    )
    return _Heights(unit_m, True, say("heights are taken above sea level{}, {}; {}", unit, why, stand_in))


def names_wgs84(name: str) -> bool:
    """Whether a name, such as the `crs` of older GeoJSON, is that of WGS 84 in degrees, in any of its spellings."""
    return name.strip().upper().endswith(("CRS84", "CRS84H", ":4326", "/4326"))
