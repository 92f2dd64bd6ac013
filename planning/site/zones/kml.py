"""Areas of KML 2.2 files. They say only where: see `planning.site.zones.geojson`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from planning.base.errors import InputError
from planning.base.files import HostileXml, local_name, parse_xml
from planning.base.messages import say
from planning.site.zones.fields import Asked
from planning.site.zones.geojson import NO_MEANING, POINT_WIDTH_M, ring
from planning.site.zones.records import LonLat, Outline, Restriction, Volume, Zone, ZoneSet

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

NOT_READ, NOT_READ_INSIDE = ("NetworkLink", "GroundOverlay"), ("Model", "Track", "MultiTrack")
"""Elements that may show areas in ways that are not read, beside placemarks and inside of them."""


def recognises(content: bytes) -> bool:
    """Whether a file is KML: XML with such a root."""
    head = content[:4000].lower()
    return b"<kml" in head or b":kml" in head


def read(content: bytes, path: Path) -> ZoneSet:
    """Areas of a KML file.

    Raises
    ------
    InputError
        It is no XML, or does what no such file needs.
    """
    try:
        root = parse_xml(content, path)
    except HostileXml as error:
        raise InputError.say("the KML file {}; expected areas alone", error, place=path) from error
    except ValueError as error:
        raise InputError.say(
            "not valid XML ({}): it is cut off or damaged; download it again", error, place=path
        ) from error
    zones = []
    for number, placemark in enumerate(_named(root, "Placemark"), 1):
        name = _text(placemark, "name") or f"{path.stem} {number}"
        asked = Asked([NO_MEANING])
        volumes = [Volume(area) for area in _areas(placemark, asked)]
        if not volumes and not asked.places:
            asked.places.append(say("an area has no outline that can be read"))
        zones.append(
            Zone(
                id=placemark.get("id") or name,
                name=name,
                restriction=Restriction.UNKNOWN,
                message=_text(placemark, "description"),
                volumes=tuple(volumes),
                **asked.of_zone(),
            )
        )
    for number, element in enumerate((each for kind in NOT_READ for each in _named(root, kind)), 1):
        kind = local_name(element)
        name = _text(element, "name") or f"{kind} {number}"
        zones.append(Zone(id=name, name=name, restriction=Restriction.UNKNOWN, place_questions=(_not_read(kind),)))
    return ZoneSet("KML", tuple(zones))


def _not_read(kind: str) -> str:
    return say("what its element '{}' shows is not read: look at it in another program", kind)


def _named(element: Element, name: str) -> Iterator[Element]:
    """Elements of a name, of whatever version of KML."""
    return (each for each in element.iter() if local_name(each) == name)


def _text(element: Element, name: str) -> str:
    return next((" ".join((each.text or "").split()) for each in element if local_name(each) == name), "")


def _areas(placemark: Element, asked: Asked) -> Iterator[Outline]:
    inside, questions = set(), asked.places
    for polygon in _named(placemark, "Polygon"):
        before = len(questions)
        outer = [_ring(each, questions) for each in _named(polygon, "outerBoundaryIs")]
        holes = [_ring(each, questions) for each in _named(polygon, "innerBoundaryIs")]
        inside |= {id(each) for each in polygon.iter()}
        if len(outer) != 1 or not outer[0]:
            questions.append(say("an area has no outline that can be read"))
            continue
        is_sure = len(questions) == before
        yield Outline(
            outer[0],
            tuple(each for each in holes if len(each) > 3) if is_sure else (),
            0.0 if is_sure else POINT_WIDTH_M,
        )
    questions += [_not_read(kind) for kind in NOT_READ_INSIDE if next(_named(placemark, kind), None) is not None]
    for kind in ("Point", "LineString", "LinearRing"):
        for element in _named(placemark, kind):
            if id(element) in inside:
                continue
            points = _ring(element, questions)
            if kind == "LinearRing" and points:
                yield Outline(points)
                continue
            asked.widths.append(say("a {} has no width; it counts with {:.0f} m to each side", kind, POINT_WIDTH_M))
            if points:
                yield Outline(points, tolerance_m=POINT_WIDTH_M)


def _ring(element: Element, questions: list[str]) -> tuple[LonLat, ...]:
    """Positions of all `coordinates` in an element: `lon,lat[,altitude]`, parted by blanks."""
    found: list[object] = []
    for each in _named(element, "coordinates"):
        for word in (each.text or "").split():
            try:
                found.append([float(number) for number in word.split(",")])
            except ValueError:
                found.append(word)
    return ring(found, questions)
