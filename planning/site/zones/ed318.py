"""ED-318: GeoJSON with layers, circles and properties of geographical zones (EUROCAE; its published schemas)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from planning.site.zones.fields import RESTRICTIONS, Asked, Fields, authorities, period_of, restriction_of
from planning.site.zones.geojson import check_reference_system, features_of, volumes
from planning.site.zones.records import (
    ALWAYS,
    Period,
    Zone,
    ZoneSet,
)
from planning.site.zones.times import moment


def recognises(content: Any) -> bool:
    """Whether parsed JSON is ED-318: GeoJSON of which a feature has a layer, or says variant and type of a zone."""
    return isinstance(content, dict) and any(_is_zone(feature) for feature in features_of(content))


def _is_zone(feature: Any) -> bool:
    if not isinstance(feature, dict):
        return False
    properties, geometry = feature.get("properties"), feature.get("geometry")
    has_layer = isinstance(geometry, dict) and ("layer" in geometry or "extent" in geometry)
    says = isinstance(properties, dict) and (
        "variant" in properties or "zoneAuthority" in properties or properties.get("type") in RESTRICTIONS
    )
    return has_layer or says


def read(content: Any, path: Path) -> ZoneSet:
    """Zones of an ED-318 file, parsed; errors as `geojson.read`."""
    check_reference_system(content, path)
    questions: list[str] = []
    top = Fields(content, "file", questions)
    metadata = Fields(top.values.get("metadata") or {}, "metadata", questions)
    dates = {}
    for name in ("issued", "validFrom", "validTo"):
        text = metadata.text(name)
        dates[name] = moment(text) if text else None
        if text and dates[name] is None:
            metadata.ask(name, text)
    return ZoneSet(
        "ED-318",
        tuple(_zone(feature, f"{path.stem} {number}") for number, feature in enumerate(features_of(content), 1)),
        publisher=", ".join(metadata.texts("provider")),
        issued=dates["issued"],
        valid_from=dates["validFrom"],
        valid_to=dates["validTo"],
        questions=tuple(questions),
    )


def _zone(feature: Any, unnamed: str) -> Zone:
    asked = Asked()
    top = Fields(feature, "feature", asked.questions)
    fields = Fields(top.values.get("properties"), "properties", asked.questions)
    name = " ".join(fields.texts("name"))
    found = volumes(top.values.get("geometry"), asked)
    return Zone(
        id=fields.text("identifier") or name or unnamed,
        name=name or fields.text("identifier") or unnamed,
        restriction=restriction_of(fields, "type"),
        written_type=fields.text("type"),
        country=fields.text("country"),
        reasons=(*fields.texts("reason"), *fields.texts("otherReasonInfo")),
        conditions="; ".join(fields.texts("restrictionConditions")),
        message=" ".join(fields.texts("message")),
        authorities=authorities(fields),
        volumes=tuple(found),
        periods=_periods(fields),
        **asked.of_zone(),
    )


def _periods(fields: Fields) -> tuple[Period, ...] | None:
    """When a zone applies: always where nothing limits it."""
    if not fields.has("limitedApplicability"):
        return ALWAYS if fields.values.get("limitedApplicability") in (None, []) else None
    periods = [
        period_of(Fields(each, "limitedApplicability", fields.questions))
        for each in fields.items("limitedApplicability")
    ]
    return None if None in periods else tuple(each for each in periods if each is not None)
