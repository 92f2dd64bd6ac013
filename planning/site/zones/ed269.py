"""ED-269: JSON of UAS geographical zones (EUROCAE, 2020), as national publishers write it.

Positions are longitude first, circles in metres, heights in `uomDimensions`. Limits that are left out are the ground
and the sky. Zones are listed as `features`, or as `UASZoneList` where a U-space's common information service answers.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from planning.base.messages import say
from planning.site.zones.fields import Asked, Fields, authorities, period_of, restriction_of
from planning.site.zones.geojson import circle, outlines
from planning.site.zones.heights import EVERYWHERE_BELOW, limit
from planning.site.zones.records import ALWAYS, UNLIMITED, Circle, Limit, Outline, Period, Volume, Zone, ZoneSet

_VOLUME_FIELDS = (
    "uomDimensions",
    "lowerLimit",
    "lowerVerticalReference",
    "upperLimit",
    "upperVerticalReference",
    "horizontalProjection",
)
_PROJECTION_FIELDS = ("type", "coordinates", "center", "radius")


def _zones_of(content: Any) -> list[Any]:
    """What the file lists as zones, unread; GeoJSON has features, too, and says that it is a collection of them."""
    if not isinstance(content, dict) or content.get("type") == "FeatureCollection":
        return []
    listed = content.get("features", content.get("UASZoneList"))
    return listed if isinstance(listed, list) else []


def recognises(content: Any) -> bool:
    """Whether parsed JSON is ED-269: zones whose geometry is a list of volumes, or that say a restriction."""
    return any(
        isinstance(each, dict) and ("restriction" in each or isinstance(each.get("geometry"), list))
        for each in _zones_of(content)
    )


def read(content: Any, path: Path) -> ZoneSet:
    """Zones of an ED-269 file, parsed."""
    zones = (_zone(feature, f"{path.stem} {number}") for number, feature in enumerate(_zones_of(content), 1))
    return ZoneSet("ED-269", tuple(zones), publisher=Fields(content, "file", []).text("title"))


def _zone(feature: Any, unnamed: str) -> Zone:
    asked = Asked()
    fields = Fields(feature, "feature", asked.questions)
    identifier, name = fields.text("identifier"), " ".join(fields.texts("name"))
    u_space = fields.text("uSpaceClass")
    conditions = [*fields.texts("restrictionConditions"), *([f"U-space {u_space}"] if u_space else [])]
    volumes = [volume for each in fields.items("geometry") for volume in _volumes(each, asked)]
    return Zone(
        id=identifier or name or unnamed,
        name=name or identifier or unnamed,
        restriction=restriction_of(fields, "restriction"),
        written_type=fields.text("restriction"),
        country=fields.text("country"),
        reasons=(*fields.texts("reason"), *fields.texts("otherReasonInfo")),
        conditions="; ".join(conditions),
        message=" ".join(fields.texts("message")),
        authorities=authorities(fields),
        volumes=tuple(volumes),
        periods=_periods(fields),
        **asked.of_zone(),
    )


def _volumes(content: Any, asked: Asked) -> list[Volume]:
    fields, questions = Fields(content, "geometry", asked.places), asked.places
    lower, upper = _limits(fields, asked.questions)
    projection = Fields(fields.values.get("horizontalProjection"), "horizontalProjection", questions)
    projection.ask_about_others(_PROJECTION_FIELDS)
    kind, areas = projection.text("type"), list[Outline | Circle]()
    if kind == "Circle":
        found = circle(projection.values.get("center"), projection.number("radius"), questions)
        areas += [] if found is None else [found]
    elif kind in ("Polygon", "MultiPolygon"):
        areas += outlines(kind, projection.values.get("coordinates"), questions)
    elif projection.values:
        projection.ask("type", kind)
    return [Volume(area, lower, upper) for area in areas]


def _limits(fields: Fields, questions: list[str]) -> tuple[Limit, Limit]:
    if fields.ask_about_others(_VOLUME_FIELDS):
        return EVERYWHERE_BELOW, UNLIMITED
    heights = Fields(fields.values, fields.name, questions)
    unit = heights.text("uomDimensions")
    lower, upper = (
        limit(
            heights.number(f"{which}Limit"),
            unit,
            heights.text(f"{which}VerticalReference"),
            questions,
            is_lower=which == "lower",
            is_stated=fields.values.get(f"{which}Limit") is not None,
        )
        for which in ("lower", "upper")
    )
    return lower, upper


def _periods(fields: Fields) -> tuple[Period, ...] | None:
    """When a zone applies; ED-269 has to say so, so a zone that does not is asked about, and counts."""
    found: list[Period | None] = []
    for each in fields.items("applicability"):
        one = Fields(each, "applicability", fields.questions)
        permanent = one.text("permanent").upper()
        if permanent == "YES":
            return ALWAYS
        period = period_of(one, ("permanent",))
        if permanent != "NO" or period == Period():
            one.ask("permanent", permanent)
            period = None
        found.append(period)
    if not found:
        fields.questions.append(say("the file does not say when this applies, so it counts at all times"))
    return None if not found or None in found else tuple(each for each in found if each is not None)
