"""ED-318: GeoJSON with layers, circles and properties of geographical zones (EUROCAE; its published schemas)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from planning.site.zones.fields import Fields
from planning.site.zones.geojson import check_reference_system, features_of, volumes
from planning.site.zones.records import (
    ALWAYS,
    Authority,
    Clock,
    Daily,
    Daylight,
    Period,
    Restriction,
    Zone,
    ZoneSet,
)
from planning.site.zones.times import clock, moment, week_days

RESTRICTIONS = {
    "PROHIBITED": Restriction.PROHIBITED,
    "REQ_AUTHORIZATION": Restriction.AUTHORISATION,
    "REQ_AUTHORISATION": Restriction.AUTHORISATION,
    "USPACE": Restriction.U_SPACE,
    "CONDITIONAL": Restriction.CONDITIONAL,
    "NO_RESTRICTION": Restriction.NONE,
}
"""Both spellings: ED-269 has the British one, ED-318 the American one."""

_PERIOD_FIELDS = ("startDateTime", "endDateTime", "schedule")
_DAILY_FIELDS = ("day", "startTime", "startEvent", "endTime", "endEvent")


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
    questions: list[str] = []
    top = Fields(feature, "feature", questions)
    fields = Fields(top.values.get("properties"), "properties", questions)
    name = " ".join(fields.texts("name"))
    places: list[str] = []
    found = volumes(top.values.get("geometry"), places)
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
        questions=tuple(questions),
        place_questions=tuple(places),
    )


def restriction_of(fields: Fields, name: str) -> Restriction:
    """The restriction that a field spells; what is not known is asked and kept like what is prohibited."""
    word = fields.text(name).upper()
    found = RESTRICTIONS.get(word)
    if found is None:
        fields.ask(name, word or fields.values.get(name))
    return found or Restriction.UNKNOWN


def authorities(fields: Fields) -> tuple[Authority, ...]:
    """Authorities of a zone, in both formats."""
    found = []
    for each in fields.items("zoneAuthority"):
        # How to reach somebody decides nothing: what cannot be read of it is left out.
        one = Fields(each, "zoneAuthority", [])
        names = [*one.texts("name"), *one.texts("service")]
        contact = [*one.texts("contactName"), one.text("phone"), one.text("email"), one.text("siteURL")]
        found.append(
            Authority(
                ", ".join(dict.fromkeys(names)),
                ", ".join(text for text in contact if text),
                one.text("purpose"),
                one.text("intervalBefore"),
            )
        )
    return tuple(found)


def _periods(fields: Fields) -> tuple[Period, ...] | None:
    """When a zone applies: always where nothing limits it."""
    if not fields.has("limitedApplicability"):
        return ALWAYS if fields.values.get("limitedApplicability") in (None, []) else None
    periods = [
        period_of(Fields(each, "limitedApplicability", fields.questions))
        for each in fields.items("limitedApplicability")
    ]
    return None if None in periods else tuple(each for each in periods if each is not None)


def period_of(fields: Fields, others: tuple[str, ...] = ()) -> Period | None:
    """A period of either format; None, with a question, where it cannot be read.

    Parameters
    ----------
    others
        Fields that were looked at already.
    """
    before = len(fields.questions)
    fields.ask_about_others((*_PERIOD_FIELDS, *others))
    ends = []
    for name in ("startDateTime", "endDateTime"):
        text = fields.text(name)
        ends.append(moment(text) if text else None)
        if text and ends[-1] is None:
            fields.ask(name, text)
    schedule = [_daily(Fields(each, "schedule", fields.questions)) for each in fields.items("schedule")]
    if not fields.has("schedule") and fields.values.get("schedule") not in (None, []):
        fields.ask("schedule", fields.values["schedule"])
    start, end = ends
    if start is not None and end is not None and end < start:
        fields.ask("endDateTime", fields.text("endDateTime"))
    if len(fields.questions) > before:
        return None
    return Period(start, end, tuple(each for each in schedule if each is not None))


def _daily(fields: Fields) -> Daily | None:
    fields.ask_about_others(_DAILY_FIELDS)
    days = week_days(fields.items("day") if isinstance(fields.values.get("day"), list) else [fields.values.get("day")])
    if days is None:
        fields.ask("day", fields.values.get("day"))
    start, end = _hour(fields, "start"), _hour(fields, "end")
    return None if days is None or start is None or end is None else Daily(days, start, end)


def _hour(fields: Fields, which: str) -> Clock | Daylight | None:
    at, event = fields.text(f"{which}Time"), fields.text(f"{which}Event").upper()
    found: Clock | Daylight | None = None
    if at and not event:
        found = clock(at)
    elif event in set(Daylight) and not at:
        found = Daylight(event)
    if found is None:
        fields.ask(f"{which}Time", at or event)
    return found
