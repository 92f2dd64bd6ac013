"""How features of vector tiles are drawn: a sober style like OpenStreetMap's, for the layouts of tiles that are common.

Layers and classes are those of OpenMapTiles, Protomaps, Shortbread and Mapbox Streets. What none of them has is not
drawn. Roads have the width that they have on the ground, and at least one that can be seen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum, auto

from groundstation.services.map.vector_tiles import Geometry, Value

LAND = "#f4f1ea"
"""Colour of ground of no kind."""

WATER, BUILDING, BUILDING_EDGE, RAIL, BORDER, TEXT = "#a9cfe0", "#d6ccc0", "#b5a897", "#7d7d7d", "#9b86a8", "#3d3d3d"


class Role(IntEnum):
    """What a feature is; what has a higher number is drawn later."""

    LAND = auto()
    WATER = auto()
    WATERWAY = auto()
    RUNWAY = auto()
    BUILDING = auto()
    ROAD = auto()
    RAIL = auto()
    BORDER = auto()
    ROAD_NAME = auto()
    PLACE = auto()


LAYERS = {
    **dict.fromkeys(("landcover", "landuse", "landuse_overlay", "park", "land", "sites", "earth"), Role.LAND),
    **dict.fromkeys(("water", "ocean", "water_polygons"), Role.WATER),
    **dict.fromkeys(("waterway", "water_lines", "physical_line"), Role.WATERWAY),
    **dict.fromkeys(("aeroway",), Role.RUNWAY),
    **dict.fromkeys(("building", "buildings"), Role.BUILDING),
    **dict.fromkeys(("transportation", "road", "roads", "streets", "tunnel", "bridge"), Role.ROAD),
    **dict.fromkeys(("boundary", "boundaries", "admin"), Role.BORDER),
    **dict.fromkeys(("transportation_name", "road_label", "street_labels"), Role.ROAD_NAME),
    **dict.fromkeys(("place", "places", "place_label", "place_labels"), Role.PLACE),
}
"""What the features of a layer are, by its name."""

CLASS_KEYS = ("class", "kind", "pmap:kind", "type", "kind_detail", "subclass")
"""Properties that say what a feature is, the widest first."""

GROUND = {
    **dict.fromkeys(("wood", "forest", "tree"), "#c5dbb4"),
    **dict.fromkeys(
        ("grass", "grassland", "meadow", "park", "garden", "village_green", "recreation_ground"), "#d5e8c3"
    ),
    **dict.fromkeys(("nature_reserve", "protected_area", "national_park", "golf_course", "playground"), "#d9e8cc"),
    **dict.fromkeys(("scrub", "heath", "shrub", "wetland", "bog"), "#dbe2c0"),
    **dict.fromkeys(("farmland", "farmyard", "agriculture", "crop", "orchard", "vineyard", "allotments"), "#ebe7d0"),
    **dict.fromkeys(("sand", "beach", "bare_rock", "rock", "quarry"), "#ece2c4"),
    **dict.fromkeys(("ice", "glacier", "snow"), "#e8f2f5"),
    **dict.fromkeys(("residential", "neighbourhood", "suburb"), "#ece8e2"),
    **dict.fromkeys(("commercial", "retail", "industrial", "railway", "military", "urban_area", "garages"), "#e7e1e0"),
    **dict.fromkeys(("school", "university", "college", "kindergarten", "hospital", "education"), "#eee7d6"),
    **dict.fromkeys(("cemetery", "grave_yard"), "#cfdcc6"),
    **dict.fromkeys(("pitch", "stadium", "sports_centre", "track"), "#c3e0c9"),
    **dict.fromkeys(("parking", "pedestrian", "plaza", "pier", "bus_station"), "#e9e6e3"),
    **dict.fromkeys(("aerodrome", "airport", "apron"), "#e4e2e8"),
}
"""Colours of ground by its class."""


@dataclass(frozen=True, slots=True)
class RoadClass:
    """How a road looks.

    Parameters
    ----------
    rank
        Wider roads are drawn later.
    width_m
        On the ground; roads of two carriageways are two lines.
    least_px
        Width where that is less.
    min_zoom
        From which on it is drawn.
    """

    rank: int
    width_m: float
    least_px: float
    min_zoom: int
    fill: str
    casing: str = ""


_MOTORWAY = RoadClass(7, 11.0, 2.2, 4, "#eba19b", "#c9716a")
_TRUNK = RoadClass(6, 10.0, 2.0, 5, "#f2b899", "#cf8a62")
_PRIMARY = RoadClass(5, 10.0, 1.8, 7, "#f8d8a3", "#cfa560")
_SECONDARY = RoadClass(4, 9.0, 1.5, 9, "#f7f0b5", "#c4b768")
_TERTIARY = RoadClass(3, 8.0, 1.2, 11, "#ffffff", "#bdb5aa")
_MINOR = RoadClass(2, 6.0, 1.0, 12, "#ffffff", "#cbc4ba")
_SERVICE = RoadClass(1, 3.5, 0.8, 14, "#fbf9f6", "#d8d2c9")
_PATH = RoadClass(0, 1.5, 0.8, 14, "#b09a86")

ROADS = {
    **dict.fromkeys(("motorway", "motorway_link", "highway"), _MOTORWAY),
    **dict.fromkeys(("trunk", "trunk_link"), _TRUNK),
    **dict.fromkeys(("primary", "primary_link", "major_road", "main"), _PRIMARY),
    **dict.fromkeys(("secondary", "secondary_link"), _SECONDARY),
    **dict.fromkeys(("tertiary", "tertiary_link", "medium_road", "link"), _TERTIARY),
    **dict.fromkeys(("minor", "minor_road", "street", "street_limited", "residential", "unclassified"), _MINOR),
    **dict.fromkeys(("living_street", "busway", "road"), _MINOR),
    **dict.fromkeys(("service", "track", "driveway", "parking_aisle", "raceway"), _SERVICE),
    **dict.fromkeys(("path", "footway", "cycleway", "steps", "pedestrian", "bridleway", "other"), _PATH),
}
"""Roads by their class."""

RAILS = frozenset(
    ("rail", "major_rail", "minor_rail", "transit", "tram", "subway", "light_rail", "narrow_gauge", "funicular")
)

PLACES = {
    **dict.fromkeys(("country",), (0, 6, 1.3)),
    **dict.fromkeys(("state", "region", "province"), (4, 8, 1.1)),
    **dict.fromkeys(("city", "locality", "capital", "state_capital"), (4, 14, 1.3)),
    **dict.fromkeys(("town",), (8, 15, 1.15)),
    **dict.fromkeys(("village", "suburb", "settlement", "macrohood"), (11, 17, 1.0)),
    **dict.fromkeys(
        ("hamlet", "neighbourhood", "quarter", "settlement_subdivision", "isolated_dwelling"), (13, 19, 0.9)
    ),
}
"""First and last zoom at which names of places are drawn, and their size beside that of other texts."""


def class_of(properties: Mapping[str, Value], known: Mapping[str, object]) -> str:
    """The first of a feature's classes that is known; empty where none is."""
    for key in CLASS_KEYS:
        value = properties.get(key)
        if isinstance(value, str) and value in known:
            return value
    return ""


def role_of(layer: str, properties: Mapping[str, Value]) -> Role | None:
    """What a feature is; None for what is not drawn."""
    role = LAYERS.get(layer)
    if role is Role.ROAD:
        if any(properties.get(key) in RAILS for key in CLASS_KEYS):
            return Role.RAIL
        return Role.ROAD if class_of(properties, ROADS) else None
    if role is Role.LAND and layer != "earth" and not class_of(properties, GROUND):
        return None
    return role


def road_class(properties: Mapping[str, Value]) -> RoadClass:
    """How a road is drawn: by the closest of its classes that is known."""
    found = ROADS[class_of(properties, ROADS)]
    detail = properties.get("kind_detail")
    return ROADS.get(detail, found) if isinstance(detail, str) else found


def ground_colour(properties: Mapping[str, Value]) -> str:
    """Colour of a piece of ground."""
    return GROUND.get(class_of(properties, GROUND), LAND)


def name_of(properties: Mapping[str, Value]) -> str:
    """Name as it stands on signs."""
    value = properties.get("name", properties.get("name_en"))
    return value[:80] if isinstance(value, str) else ""


def is_drawn_as_area(role: Role, geometry: Geometry) -> bool:
    """Whether a feature is filled: its kind has areas, and it is one."""
    return geometry is Geometry.POLYGON and role in (Role.LAND, Role.WATER, Role.BUILDING, Role.RUNWAY)
