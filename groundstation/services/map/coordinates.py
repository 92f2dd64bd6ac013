"""Places from what a pilot types: decimal degrees, degrees with minutes and seconds, UTM, and MGRS, all on WGS 84."""

from __future__ import annotations

import re

from planning.base.errors import InputError
from planning.base.messages import say

BANDS = "CDEFGHJKLMNPQRSTUVWX"
"""Latitude bands of UTM and MGRS, 8 degrees each from 80 S, the last one 12 degrees (DMA TM 8358.1, 1-3)."""

COLUMN_SETS = ("ABCDEFGH", "JKLMNPQR", "STUVWXYZ")
ROW_LETTERS = "ABCDEFGHJKLMNPQRSTUV"
"""Letters of the squares of 100 km; rows repeat every 2000 km and begin at F in even zones (TM 8358.1, 3-5)."""

BAND_MARGIN_DEG = 1.0
"""Squares of 100 km at the edge of a band reach beyond it."""

_UTM = re.compile(r"(\d{1,2})\s*([A-Z])\s*(?:[EX]=?\s*)?(\d{5,7}(?:\.\d+)?)\s*(?:M?E)?[\s,;]\s*(?:[NY]=?\s*)?"
                  r"(\d{1,8}(?:\.\d+)?)\s*(?:M?N)?")  # fmt: skip
_MGRS = re.compile(r"(\d{1,2})\s*([A-Z])\s*([A-Z])([A-Z])\s*((?:\d+\s*)*)")
_MARKED = re.compile(r"[NSEW]")
_NUMBER = r"\d+(?:\.\d+)?"


def parse_place(text: str) -> tuple[float, float]:
    """Latitude and longitude, degrees, of a text.

    Raises
    ------
    InputError
        It is no place, in words that say why.
    """
    typed = " ".join(text.strip().upper().split())
    if not typed:
        raise _no_place(text)
    if found := _MGRS.fullmatch(typed):
        return _from_mgrs(*found.groups())
    if found := _UTM.fullmatch(typed):
        zone, band, easting, northing = found.groups()
        return _from_utm(int(zone), band, float(easting), float(northing))
    lat, lon = _degrees_pair(typed, text)
    if abs(lat) > 90.0:
        swapped = abs(lon) <= 90.0
        hint = say("; is the longitude written first?") if swapped else ""
        raise InputError.say("the latitude is {:g} degrees; expected -90 to 90{}", lat, hint)
    if abs(lon) > 180.0:
        raise InputError.say("the longitude is {:g} degrees; expected -180 to 180", lon)
    return lat, lon


def _no_place(text: str) -> InputError:
    return InputError.say(
        "'{}' is no place; expected latitude and longitude (22.3372, 114.2636, or 22°20'14\" N 114°15'49\" E), UTM "
        "(50Q 218155 2472500) or MGRS (50Q KK 18155 72500)",
        text.strip()[:80],
    )


def _degrees_pair(typed: str, text: str) -> tuple[float, float]:
    """Latitude and longitude from degrees, with letters on either side of the numbers or none."""
    marks = _MARKED.findall(typed)
    if len(marks) not in (0, 2) or (len(marks) == 2 and (marks[0] in "NS") == (marks[1] in "NS")):
        if re.search(r"(?<![A-Z])O(?![A-Z])", typed) and re.search(r"\d", typed):
            raise InputError.say("'O' is east in German and west in French; write E or W")
        raise _no_place(text)
    if marks:
        leads = _MARKED.match(typed) is not None
        parts = _MARKED.split(typed)
        numbers = parts[1:] if leads else parts[:2]
        if (parts[0] if leads else parts[2]).strip(" ,;"):
            raise _no_place(text)
        values = [_degrees(number, text) for number in numbers]
        signed = [-abs(v) if mark in "SW" else v for v, mark in zip(values, marks, strict=True)]
        return (signed[0], signed[1]) if marks[0] in "NS" else (signed[1], signed[0])
    first, second = _halves(typed, text)
    return _degrees(first, text), _degrees(second, text)


def _halves(typed: str, text: str) -> tuple[str, str]:
    """The two sides of what parts latitude and longitude: a semicolon, a comma, or the middle of an even row."""
    for sign in (";", ", "):
        if typed.count(sign) == 1:
            first, second = typed.split(sign)
            return first, second
    if typed.count(",") == 1 and " " not in typed:
        first, second = typed.split(",")
        return first, second
    words = typed.split(" ")
    if len(words) % 2:
        raise _no_place(text)
    return " ".join(words[: len(words) // 2]), " ".join(words[len(words) // 2 :])


def _degrees(written: str, text: str) -> float:
    """Degrees with decimals, or with minutes and seconds."""
    # A comma inside a number is a decimal point, as it is written in most of Europe.
    plain = re.sub(r"(?<=\d),(?=\d)", ".", written.strip(" ,;"))
    plain = re.sub(r"[°º:D]|DEG", " ", plain)
    plain = re.sub("[′’´‘`]|''|″|”|\"|'", " ", plain).strip()
    found = re.fullmatch(rf"([-+−]?)\s*({_NUMBER})(?:\s+({_NUMBER}))?(?:\s+({_NUMBER}))?", plain)
    if found is None:
        raise _no_place(text)
    sign, degrees, minutes, seconds = found.groups(default="")
    if (minutes and "." in degrees) or (seconds and "." in minutes):
        raise InputError.say("'{}' has decimals before its last part", written.strip())
    for part in (minutes, seconds):
        if part and float(part) >= 60.0:
            raise InputError.say("'{}' has 60 or more minutes or seconds", written.strip())
    value = float(degrees) + float(minutes or 0.0) / 60.0 + float(seconds or 0.0) / 3600.0
    return -value if sign in ("-", "−") else value


def _check_zone(zone: int, band: str) -> None:
    if not 1 <= zone <= 60:
        raise InputError.say("the zone is {}; UTM has zones from 1 to 60", zone)
    if band not in BANDS:
        raise InputError.say("'{}' is no band of UTM; bands are C to X without I and O", band)


def _band_deg(band: str) -> tuple[float, float]:
    """Southern and northern edge of a band."""
    south = -80.0 + 8.0 * BANDS.index(band)
    return south, 84.0 if band == "X" else south + 8.0


def _in_band(lat: float, band: str) -> bool:
    south, north = _band_deg(band)
    return south - BAND_MARGIN_DEG <= lat <= north + BAND_MARGIN_DEG


def _from_utm(zone: int, band: str, easting_m: float, northing_m: float) -> tuple[float, float]:
    """A place in UTM; N and S are bands, and where the place lies outside of them, hemispheres."""
    _check_zone(zone, band)
    if not (100_000.0 <= easting_m <= 900_000.0 and northing_m <= 10_000_000.0):
        raise InputError.say(
            "expected an easting of 100000 to 900000 m and a northing of at most 10000000 m, found {:g} and {:g}",
            easting_m,
            northing_m,
        )
    lat, lon = _geodetic(zone, band >= "N", easting_m, northing_m)
    if not _in_band(lat, band):
        if band == "S":
            return _geodetic(zone, False, easting_m, northing_m)
        if band != "N":
            raise InputError.say("the northing {:g} m does not lie in band {}", northing_m, band)
    return lat, lon


def _from_mgrs(zone_text: str, band: str, column: str, row: str, digits: str) -> tuple[float, float]:
    zone = int(zone_text)
    _check_zone(zone, band)
    columns = COLUMN_SETS[(zone - 1) % 3]
    if column not in columns or row not in ROW_LETTERS:
        raise InputError.say("there is no square {} in zone {}", column + row, zone)
    parts = digits.split()
    joined = "".join(parts)
    if len(joined) % 2 or len(joined) > 10 or (len(parts) == 2 and len(parts[0]) != len(parts[1])) or len(parts) > 2:
        raise InputError.say(
            "expected as many digits of easting as of northing, up to 5 each, found '{}'", digits.strip()
        )
    half = len(joined) // 2
    # Digits name a square of 1 m to 100 km; its middle is meant, but for 1 m, where its corner is what others show.
    size_m = 10.0 ** (5 - half)
    middle_m = 0.5 * size_m if half < 5 else 0.0
    east, north = (float(joined[part] or 0) * size_m + middle_m for part in (slice(0, half), slice(half, None)))
    easting = 100_000.0 * (columns.index(column) + 1) + east
    first_row = ROW_LETTERS.index(row) - (5 if zone % 2 == 0 else 0)
    for repeat in range(6):
        northing = 100_000.0 * (first_row % 20) + 2_000_000.0 * repeat + north
        if northing > 10_000_000.0:
            break
        lat, lon = _geodetic(zone, band >= "N", easting, northing)
        if _in_band(lat, band):
            return lat, lon
    raise InputError.say("there is no square {} in band {} of zone {}", column + row, band, zone)


def _geodetic(zone: int, is_north: bool, easting_m: float, northing_m: float) -> tuple[float, float]:
    from pyproj import Transformer

    transformer = Transformer.from_crs((32600 if is_north else 32700) + zone, 4326, always_xy=True)
    lon, lat = transformer.transform(easting_m, northing_m)
    return float(lat), float(lon)
