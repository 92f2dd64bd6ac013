"""Fields of JSON objects that others wrote: what is missing or of another kind becomes a question, no exception.

Also those that ED-269 and ED-318 share (EUROCAE): restrictions, authorities and periods.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from planning.base.errors import shortened
from planning.base.messages import say
from planning.site.zones.records import Authority, Clock, Daily, Daylight, Period, Restriction
from planning.site.zones.times import clock, moment, week_days

_NUMBER = re.compile(r"[-+]?[0-9]{1,12}(\.[0-9]{1,12})?")

MAX_SHOWN = 40
"""Characters of a value that a question quotes."""


def quoted(value: object) -> str:
    """A value as a question quotes it."""
    text = shortened(str(value))
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]} ..."


@dataclass(frozen=True, slots=True)
class Asked:
    """What a file leaves open of a zone while it is read: in general, about its place, about its width."""

    questions: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    widths: list[str] = field(default_factory=list)

    def of_zone(self) -> dict[str, Any]:
        """As fields of a zone."""
        return {
            "questions": tuple(self.questions),
            "place_questions": tuple(self.places),
            "width_questions": tuple(self.widths),
        }


class Fields:
    """Fields of one object.

    Parameters
    ----------
    content
        Of the file; anything but an object has no fields, and raises a question.
    name
        Of the object, for questions.
    questions
        Where they are added.
    """

    def __init__(self, content: Any, name: str, questions: list[str]) -> None:
        self.values: Mapping[str, Any] = content if isinstance(content, dict) else {}
        self.name, self.questions = name, questions
        if not isinstance(content, dict):
            self.ask(name, content)

    def ask(self, name: str, value: object) -> None:
        """Ask what a field means."""
        if value in (None, "", [], {}):
            self.questions.append(say("the field '{}' is missing or empty", name))
        else:
            self.questions.append(say("the field '{}' cannot be read: it is '{}'", name, quoted(value)))

    def has(self, name: str) -> bool:
        """Whether a field is there and says something."""
        return self.values.get(name) not in (None, "", [], {})

    def text(self, name: str) -> str:
        """A text, or a number as one; "" where there is none."""
        value = self.values.get(name)
        if value is None or value == [] or value == {}:
            return ""
        if isinstance(value, str):
            return value.strip()
        if isinstance(value, int | float) and not isinstance(value, bool):
            return f"{value:g}"
        self.ask(name, value)
        return ""

    def texts(self, name: str) -> tuple[str, ...]:
        """Texts of a list, or a single one; objects with a `text` in a language each give one, English if there."""
        value = self.values.get(name)
        if value in (None, "", [], {}):
            return ()
        values = value if isinstance(value, list) else [value]
        plain = tuple(each.strip() for each in values if isinstance(each, str))
        told = [each for each in values if isinstance(each, dict) and isinstance(each.get("text"), str)]
        told.sort(key=lambda each: not str(each.get("lang", "")).lower().startswith("en"))
        if len(plain) + len(told) < len(values):
            self.ask(name, value)
        return (*plain, *(each["text"].strip() for each in told[:1]))

    def number(self, name: str) -> float | None:
        """A finite number, None where there is none; some publishers put numbers in quotation marks."""
        value = self.values.get(name)
        if value is None:
            return None
        if isinstance(value, str) and _NUMBER.fullmatch(value.strip()):
            return float(value)
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
        self.ask(name, value)
        return None

    def items(self, name: str) -> list[Any]:
        """A list, empty where there is none; a single object counts as a list of one."""
        value = self.values.get(name)
        if value is None:
            return []
        if isinstance(value, list):
            return value
        if isinstance(value, dict):
            return [value]
        self.ask(name, value)
        return []

    def ask_about_others(self, known: Collection[str]) -> bool:
        """Ask about fields that are not known; returns whether there are any."""
        others = [name for name in self.values if name not in known and self.has(name)]
        for name in others:
            self.questions.append(say("the file says '{}' of '{}', which is not known here", quoted(name), self.name))
        return bool(others)


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


def restriction_of(fields: Fields, name: str) -> Restriction:
    """The restriction that a field spells; what is not known is asked and kept like what is prohibited."""
    word = fields.text(name).upper()
    found = RESTRICTIONS.get(word)
    if found is None:
        if word:
            text = say("what it restricts is not known here, '{}', so it counts as prohibited", quoted(word))
        else:
            text = say("the file does not say what it restricts (field '{}'), so it counts as prohibited", name)
        fields.questions.append(text)
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
