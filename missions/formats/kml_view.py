"""A mission to look at in Google Earth or a map: the flown path, every photo with its view, and where it looks.

Altitudes are above mean sea level (EGM96), as KML defines them. What a map does not need, ids and angles, stands in
ExtendedData, so that the file can be read back.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import (
    Finish,
    GeoPoint,
    Mission,
    Photo,
    ReadMission,
    ReadPhoto,
    ReadWaypoint,
    Waypoint,
    altitude_amsl_m,
    point_at_amsl,
)
from missions.mission.safe_files import read_limited
from planning.base.errors import MissionError
from planning.base.files import HostileXml, parse_xml
from planning.geo.frames import Origin, camera_axes

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

SIGHT_M = 5.0
"""Length of the line that shows where a photo looks: seen on a map, and well short of any facade."""

_KML = "{http://www.opengis.net/kml/2.2}"

_STYLES = """\
  <Style id="path"><LineStyle><color>ff00a5ff</color><width>2</width></LineStyle></Style>
  <Style id="sight"><LineStyle><color>ffffffff</color><width>2</width></LineStyle></Style>
  <Style id="photo"><IconStyle><scale>0.5</scale></IconStyle><LabelStyle><scale>0.6</scale></LabelStyle></Style>"""


def kml_bytes(missions: Sequence[Mission]) -> bytes:
    """All sorties, a folder each."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<kml xmlns="http://www.opengis.net/kml/2.2">',
        " <Document>",
        f"  <name>{escape(missions[0].name)}</name>",
        _STYLES,
    ]
    for mission in missions:
        lines += _folder(mission)
    return "\n".join([*lines, " </Document>", "</kml>", ""]).encode()


def _folder(mission: Mission) -> Iterator[str]:
    home = mission.takeoff
    path = [home, *(waypoint.position for waypoint in mission.waypoints), home]
    data = {"sortie": str(mission.number), "takeoff": _tuple(home), "takeoff_height_ellipsoid_m": _m(home)}
    yield "  <Folder>"
    yield f"   <name>Sortie {mission.number}</name>"
    yield _extended_data(data)
    yield "   <Placemark>"
    yield "    <name>Path</name><styleUrl>#path</styleUrl>"
    yield _line(path)
    yield "   </Placemark>"
    for index, waypoint in enumerate(mission.waypoints):
        for photo in waypoint.photos:
            yield from _photo(waypoint, photo, index)
    yield "  </Folder>"


def _photo(waypoint: Waypoint, photo: Photo, index: int) -> Iterator[str]:
    point, altitude_m = waypoint.position, altitude_amsl_m(waypoint.position)
    data = {
        "viewpoint_id": photo.viewpoint_id,
        "waypoint": str(index),
        "heading_deg": f"{photo.heading_deg:.3f}",
        "gimbal_pitch_deg": f"{photo.gimbal_pitch_deg:.3f}",
        "height_ellipsoid_m": _m(point),
    }
    yield "   <Placemark>"
    yield f"    <name>{escape(photo.viewpoint_id)}</name>"
    # KML's tilt is 0 straight down and 90 at the horizon.
    yield (
        f"    <Camera><longitude>{point.lon_deg:.9f}</longitude><latitude>{point.lat_deg:.9f}</latitude>"
        f"<altitude>{altitude_m:.4f}</altitude><heading>{photo.heading_deg % 360.0:.3f}</heading>"
        f"<tilt>{90.0 + photo.gimbal_pitch_deg:.3f}</tilt><altitudeMode>absolute</altitudeMode></Camera>"
    )
    yield "    <styleUrl>#photo</styleUrl>"
    yield _extended_data(data)
    coordinates = f"<coordinates>{_tuple(point)}</coordinates>"
    yield f"    <Point><altitudeMode>absolute</altitudeMode>{coordinates}</Point>"
    yield "   </Placemark>"
    yield "   <Placemark>"
    yield f"    <name>{escape(photo.viewpoint_id)} looks</name><styleUrl>#sight</styleUrl>"
    yield _line([point, _looked_at(point, photo)])
    yield "   </Placemark>"


def _looked_at(point: GeoPoint, photo: Photo) -> GeoPoint:
    """Where the line of sight of a photo ends."""
    from planning.geo.enu import geodetic_from_enu

    forward, _, _ = camera_axes(math.radians(photo.heading_deg), math.radians(photo.gimbal_pitch_deg))
    here = Origin(point.lat_deg, point.lon_deg, point.height_ellipsoid_m)
    lat_deg, lon_deg, height_m = geodetic_from_enu(here, SIGHT_M * forward[None, :])
    return GeoPoint(float(lat_deg[0]), float(lon_deg[0]), float(height_m[0]))


def _m(point: GeoPoint) -> str:
    return f"{point.height_ellipsoid_m:.4f}"


def _tuple(point: GeoPoint) -> str:
    return f"{point.lon_deg:.9f},{point.lat_deg:.9f},{altitude_amsl_m(point):.4f}"


def _line(points: Sequence[GeoPoint]) -> str:
    coordinates = " ".join(_tuple(point) for point in points)
    mode = "<altitudeMode>absolute</altitudeMode>"
    return f"    <LineString>{mode}<coordinates>{coordinates}</coordinates></LineString>"


def _extended_data(values: dict[str, str]) -> str:
    data = "".join(f'<Data name="{name}"><value>{escape(value)}</value></Data>' for name, value in values.items())
    return f"    <ExtendedData>{data}</ExtendedData>"


def read_kml(path: Path) -> tuple[ReadMission, ...]:
    """Sorties of a KML that `kml_bytes` wrote.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no KML, or one that another program made for looking at, which says too little to be a mission.
    """
    try:
        root = parse_xml(read_limited(path), path)
    except HostileXml as error:
        raise MissionError.say("{}, which no mission needs; refused as hostile", error, place=path) from error
    except ValueError as error:
        raise MissionError.say("not readable as XML ({})", error, place=path) from error
    folders = [folder for folder in root.iter(f"{_KML}Folder") if "sortie" in _data(folder)]
    if not folders:
        raise MissionError.say(
            "a KML of another program; it shows places but does not say where photos are taken and with "
            "which angles; import the mission file itself",
            place=path,
        )
    try:
        return tuple(_read_folder(folder, path, several=len(folders) > 1) for folder in folders)
    except (KeyError, ValueError, IndexError) as error:
        raise MissionError.say(
            "damaged: a sortie lacks what Reflight writes ({}); export it again", error, place=path
        ) from error


def _read_folder(folder: Element, path: Path, *, several: bool) -> ReadMission:
    data = _data(folder)
    line = folder.find(f".//{_KML}LineString/{_KML}coordinates")
    text = "" if line is None or line.text is None else line.text
    lon_lat = [tuple(float(number) for number in part.split(",")) for part in text.split()]
    points = [point_at_amsl(lat_deg, lon_deg, altitude_m) for lon_deg, lat_deg, altitude_m in lon_lat]
    photos: list[list[ReadPhoto]] = [[] for _ in points[1:-1]]
    for placemark in folder.iter(f"{_KML}Placemark"):
        values = _data(placemark)
        if "viewpoint_id" in values:
            angles = float(values["heading_deg"]), float(values["gimbal_pitch_deg"])
            photos[int(values["waypoint"])].append(ReadPhoto(*angles, values["viewpoint_id"]))
    lon_deg, lat_deg, _ = map(float, data["takeoff"].split(","))
    return ReadMission(
        name=f"{path.stem}-{data['sortie']}" if several else path.stem,
        path=path,
        format=FileFormat.KML,
        waypoints=tuple(
            ReadWaypoint(p.lat_deg, p.lon_deg, height_ellipsoid_m=p.height_ellipsoid_m, photos=tuple(taken))
            for p, taken in zip(points[1:-1], photos, strict=True)
        ),
        takeoff=GeoPoint(lat_deg, lon_deg, float(data["takeoff_height_ellipsoid_m"])),
        height_reference=HeightReference.AMSL,
        finish=Finish.LAND,
    )


def _data(element: Element) -> dict[str, str]:
    """ExtendedData of a feature itself, not of those inside it."""
    found = element.find(f"{_KML}ExtendedData")
    pairs = ((data.get("name", ""), data.findtext(f"{_KML}value", "")) for data in (found if found is not None else ()))
    return dict(pairs)
