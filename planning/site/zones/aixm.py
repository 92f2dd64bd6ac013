"""Airspaces of AIXM 5.1 messages (EUROCONTROL and FAA): type, class, limits and horizontal projection of baselines.

What is not read is asked: changes for a time, activation by timesheets, parts of borders that stand elsewhere.
Volumes are put together; what a file takes away from them or cuts them with is left, so that the result is not smaller
than the true one. Positions are latitude first in EPSG:4326. Angles of arcs count clockwise from north in that system
(OGC 12-028, Use of GML for aviation data).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from planning.base.errors import InputError
from planning.base.files import HostileXml, local_name, parse_xml
from planning.base.messages import say
from planning.site.zones.arcs import arc_corners
from planning.site.zones.fields import quoted
from planning.site.zones.geojson import MAX_RADIUS_M, POINT_WIDTH_M, ring
from planning.site.zones.heights import EVERYWHERE_BELOW, FOOT_M, NAUTICAL_MILE_M, limit, no_limit, unread_limit
from planning.site.zones.records import (
    ALWAYS,
    FROM_GROUND,
    UNLIMITED,
    Circle,
    HeightAbove,
    Limit,
    LonLat,
    Outline,
    Period,
    Volume,
    Zone,
    ZoneSet,
    airspace_restriction,
)
from planning.site.zones.times import moment

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

GML_ID, HREF = "{http://www.opengis.net/gml/3.2}id", "{http://www.w3.org/1999/xlink}href"

KINDS = {"P": "P", "R": "R", "D": "Q", "W": "W", "A": "ALERT"}
"""Codes of types in the words of OpenAir: in AIXM, D is a danger area, and A one of alert."""

READ = ("BASELINE", "SNAPSHOT", "")
"""Interpretations of time slices: what holds. Others say what changes."""

RADII_M = {"NM": NAUTICAL_MILE_M, "[NMI_I]": NAUTICAL_MILE_M, "KM": 1000.0, "M": 1.0, "FT": FOOT_M, "[FT_I]": FOOT_M}

MAX_REFERENCES = 4
"""Airspaces that are made of others, one in the other."""

LAT_FIRST = ("urn:ogc:def:crs:EPSG::4326", "EPSG:4326", "http://www.opengis.net/def/crs/EPSG/0/4326", "")
LON_FIRST = ("urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84", "CRS84")


def recognises(content: bytes) -> bool:
    """Whether a file is AIXM 5: XML that names its schema."""
    return b"aixm.aero/schema/5" in content[:8000]


def read(content: bytes, path: Path) -> ZoneSet:
    """Airspaces of an AIXM message.

    Raises
    ------
    InputError
        It is no XML, or does what no such file needs.
    """
    try:
        root = parse_xml(content, path)
    except HostileXml as error:
        raise InputError.say("the AIXM file {}; expected airspaces alone", error, place=path) from error
    except ValueError as error:
        raise InputError.say(
            "not valid XML ({}): it is cut off or damaged; download it again", error, place=path
        ) from error
    known = {found: each for each in root.iter() if (found := each.get(GML_ID))}
    known |= {f"urn:uuid:{_text(each, 'identifier')}": each for each in _all(root, "Airspace")}
    zones = []
    for number, airspace in enumerate(_all(root, "Airspace"), 1):
        slices = list(_all(airspace, "AirspaceTimeSlice"))
        held = [each for each in slices if _text(each, "interpretation").upper() in READ]
        changes = len(slices) - len(held)
        for each in held or [airspace]:
            zones.append(_zone(each, airspace, known, changes, f"{path.stem} {number}"))
    return ZoneSet("AIXM 5.1", tuple(zones))


@dataclass(frozen=True, slots=True)
class _Shape:
    """What is known while a shape is read: elements by identifier, its reference system, and what cannot be read."""

    known: Mapping[str, Element]
    system: str
    places: list[str]


def _all(element: Element, *names: str) -> Iterator[Element]:
    """Elements below that have one of these names."""
    return (each for each in element.iter() if each is not element and local_name(each) in names)


def _child(element: Element, name: str) -> Element | None:
    return next((each for each in element if local_name(each) == name), None)


def _text(element: Element, name: str) -> str:
    found = _child(element, name)
    return "" if found is None else " ".join((found.text or "").split())


def _zone(one: Element, airspace: Element, known: Mapping[str, Element], changes: int, unnamed: str) -> Zone:
    questions: list[str] = []
    places: list[str] = []
    classes = [" ".join((each.text or "").split()).upper() for each in _all(one, "classification")]
    written = _text(one, "type").upper()
    kinds = [kind for kind in (KINDS.get(written, written.partition("_")[0]), *classes) if kind]
    if changes:
        questions.append(say("what changes it for a time ({} entries) is not read", changes))
    if _child(one, "activation") is not None:
        questions.append(say("when it is active is not read: it counts all the time"))
    volumes = [volume for each in _all(one, "AirspaceVolume") for volume in _volumes(each, known, questions, places)]
    if any((each.text or "").strip().upper() not in ("", "BASE", "UNION") for each in _all(one, "operation")):
        questions.append(say("parts that are cut off or cut out count all the same"))
    if not volumes and not places:
        places.append(say("an area has no outline that can be read"))
    name = _text(one, "name") or _text(one, "designator") or unnamed
    return Zone(
        id=_text(one, "designator") or _text(airspace, "identifier") or name,
        name=name,
        restriction=airspace_restriction(kinds, questions),
        written_type=" ".join(filter(None, (written, *classes))),
        volumes=tuple(volumes),
        periods=_periods(one),
        questions=tuple(questions),
        place_questions=tuple(places),
    )


def _periods(one: Element) -> tuple[Period, ...] | None:
    """Validity of a time slice; ends that are not known are open."""
    times = _child(one, "validTime")
    if times is None:
        return ALWAYS
    ends: list[Period] = []
    for each in _all(times, "TimePeriod"):
        found = []
        for name in ("beginPosition", "endPosition"):
            text = _text(each, name)
            found.append(moment(text) if text else None)
            if text and found[-1] is None:
                return None
        ends.append(Period(found[0], found[1]))
    return tuple(ends) or None


def _volumes(
    volume: Element, known: Mapping[str, Element], questions: list[str], places: list[str], depth: int = 0
) -> Iterator[Volume]:
    parts = list(_all(volume, "AirspaceVolumeDependency"))
    for each in parts:
        yield from _of_another(each, volume, known, questions, places, depth)
    projection = _child(volume, "horizontalProjection")
    if projection is None:
        if not parts:
            places.append(say("an area has no outline that can be read"))
        return
    lower, upper = _limit(volume, "lower", questions), _limit(volume, "upper", questions)
    systems = {name for each in projection.iter() if (name := each.get("srsName"))}
    if len(systems) > 1:
        places.append(say("its places are in several systems: {}", ", ".join(sorted(systems))))
    shape = _Shape(known, next(iter(systems), ""), places)
    for patch in _all(projection, "PolygonPatch"):
        before = len(places)
        exterior = _child(patch, "exterior")
        corners, circles, tolerance_m = ([], [], 0.0) if exterior is None else _boundary(exterior, shape)
        holes = _holes(patch, shape)
        for circle in circles:
            yield Volume(circle, lower, upper)
        if corners:
            is_sure = len(places) == before
            inner = holes if is_sure else ()
            width_m = tolerance_m if is_sure else tolerance_m + POINT_WIDTH_M
            yield Volume(Outline(tuple(corners), inner, width_m), lower, upper)
        elif not circles:
            places.append(say("an area has no outline that can be read"))
    if next(_all(projection, "PolygonPatch"), None) is None:
        places.append(say("an area has no outline that can be read"))


def _of_another(
    part: Element,
    volume: Element,
    known: Mapping[str, Element],
    questions: list[str],
    places: list[str],
    depth: int,
) -> Iterator[Volume]:
    """Volumes of the airspace that a volume names in the place of its own shape, with its own limits where it says."""
    named = _child(part, "theAirspace")
    href = "" if named is None else named.get(HREF) or ""
    target = known.get(href.removeprefix("#"))
    if target is None or depth >= MAX_REFERENCES:
        places.append(say("its shape is that of another airspace, which is not in the file ('{}')", quoted(href)))
        return
    keeps_limits = _text(part, "dependency").upper() != "HORZ_PROJECTION"
    for each in _all(target, "AirspaceTimeSlice"):
        if _text(each, "interpretation").upper() not in READ:
            continue
        for inner in _all(each, "AirspaceVolume"):
            for found in _volumes(inner, known, questions, places, depth + 1):
                if keeps_limits:
                    yield found
                else:
                    lower, upper = _limit(volume, "lower", questions), _limit(volume, "upper", questions)
                    yield replace(found, lower=lower, upper=upper)


def _holes(patch: Element, shape: _Shape) -> tuple[tuple[LonLat, ...], ...]:
    """Holes of a patch, as far as they are known: what is not read of one is no hole."""
    found = []
    for each in patch:
        if local_name(each) == "interior":
            own = replace(shape, places=[])
            corners, circles, tolerance_m = _boundary(each, own)
            if len(corners) > 3 and not (own.places or circles or tolerance_m):
                found.append(tuple(corners))
    return tuple(found)


def _limit(volume: Element, which: str, questions: list[str]) -> Limit:
    """A limit: a number with its unit, or a word."""
    element, is_lower = _child(volume, f"{which}Limit"), which == "lower"
    if element is None or not (element.text or "").strip():
        return no_limit(questions, is_lower=is_lower)
    word, unit = (element.text or "").strip().upper(), (element.get("uom") or "").upper()
    reference = _text(volume, f"{which}LimitReference")
    if word in ("GND", "SFC") and is_lower:
        return FROM_GROUND
    if word == "UNL" and not is_lower:
        return UNLIMITED
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        unread_limit(quoted(word), questions)
        return EVERYWHERE_BELOW
    if unit == "FL":
        return Limit(value * 100.0 * FOOT_M, HeightAbove.FLIGHT_LEVEL, f"FL{value:g}")
    return limit(value, unit, reference, questions, is_lower=is_lower)


def _boundary(element: Element, shape: _Shape) -> tuple[list[LonLat], list[Circle], float]:
    """Corners and circles of a boundary, and the tolerance of its arcs."""
    corners: list[LonLat] = []
    circles: list[Circle] = []
    tolerance_m = 0.0
    for each in _segments(element, shape):
        kind = local_name(each)
        if kind == "CircleByCenterPoint":
            centre, radius_m = _centre(each, shape), _radius_m(each)
            if centre is None or radius_m is None:
                shape.places.append(say("a circle has no centre or no radius that can be used"))
            else:
                circles.append(Circle(centre, radius_m))
        elif kind == "ArcByCenterPoint":
            arc, spread_m = _arc(each, shape)
            corners += arc
            tolerance_m = max(tolerance_m, spread_m)
        else:
            corners += _positions(each, shape)
    return corners, circles, tolerance_m


SEGMENTS = ("GeodesicString", "Geodesic", "LineStringSegment", "LinearRing", "CircleByCenterPoint", "ArcByCenterPoint")


def _segments(element: Element, shape: _Shape, depth: int = 0) -> Iterator[Element]:
    """Segments in the order in which they stand, those of curves elsewhere in the file included."""
    for each in element:
        href = each.get(HREF)
        if local_name(each) in SEGMENTS:
            yield each
        elif href and local_name(each) in ("curveMember", "baseCurve"):
            target = shape.known.get(href.removeprefix("#"))
            if target is None or depth > 3:
                shape.places.append(say("a part of its outline stands elsewhere ('{}')", quoted(href)))
            else:
                yield from _segments(target, shape, depth + 1)
        elif local_name(each) in ("Arc", "ArcString", "ArcByBulge", "Bezier", "BSpline", "CubicSpline", "OffsetCurve"):
            shape.places.append(say("a part of its outline is a '{}', which is not read", local_name(each)))
        else:
            yield from _segments(each, shape, depth)


def _positions(element: Element, shape: _Shape) -> tuple[LonLat, ...]:
    """Positions of `pos` and `posList` below, longitude first."""
    found: list[object] = []
    for each in element.iter():
        if local_name(each) == "pointProperty" and each.get(HREF):
            target = shape.known.get((each.get(HREF) or "").removeprefix("#"))
            found += [[lon, lat] for lon, lat in _positions(target, shape)] if target is not None else [None]
        if local_name(each) not in ("pos", "posList"):
            continue
        system = each.get("srsName") or element.get("srsName") or shape.system
        size = 3 if each.get("srsDimension") == "3" else 2
        try:
            numbers = [float(word) for word in (each.text or "").split()]
        except ValueError:
            numbers = []
        if not numbers or len(numbers) % size or system not in (*LAT_FIRST, *LON_FIRST):
            found.append(None)
            continue
        for first, second in zip(numbers[::size], numbers[1::size], strict=False):
            found.append([second, first] if system in LAT_FIRST else [first, second])
    return ring(found, shape.places)


def _centre(element: Element, shape: _Shape) -> LonLat | None:
    found = _positions(element, shape)
    return found[0] if len(found) == 1 else None


def _radius_m(element: Element) -> float | None:
    radius = _child(element, "radius")
    unit_m = None if radius is None else RADII_M.get((radius.get("uom") or "").upper())
    try:
        value = float((radius.text or "") if radius is not None else "")
    except ValueError:
        return None
    return value * unit_m if unit_m is not None and 0.0 < value * unit_m <= MAX_RADIUS_M else None


def _arc(element: Element, shape: _Shape) -> tuple[tuple[LonLat, ...], float]:
    centre, radius_m = _centre(element, shape), _radius_m(element)
    try:
        start, end = (float(_text(element, name)) for name in ("startAngle", "endAngle"))
    except ValueError:
        start = end = math.nan
    if centre is None or radius_m is None or not (math.isfinite(start) and 0.0 < abs(end - start) <= 360.0):
        shape.places.append(say("a part of its outline is a '{}', which is not read", "ArcByCenterPoint"))
        return (), 0.0
    return arc_corners(centre, start, end - start, (radius_m, radius_m))
