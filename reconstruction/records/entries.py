"""What is kept about an object: frozen records that cannot hold what `limits` refuses.

`global_id` is the object's, `key` the record's own: a GlobalId too, "" before it is in a book. Dates are texts,
`2026-03-31`.
"""

from __future__ import annotations

import re
import uuid
from dataclasses import dataclass, field, fields
from typing import Literal
from urllib.parse import urlsplit

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.records.limits import (
    CURRENCY,
    MAX_NUMBER,
    MAX_OUTLINE,
    MAX_TEXT,
    SHA256,
    check_choice,
    check_date,
    check_dates,
    check_number,
    check_text,
    check_texts,
    is_plain_name,
)

# IFC GlobalIds: 128 bits in 22 characters, the keys of objects and records.

ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$"
"""Digits of the base 64 that IFC has of its own (buildingSMART, implementation guide on GUIDs)."""

LENGTH = 22

_PAIRS = tuple(first + second for first in ALPHABET for second in ALPHABET)
_FORM = re.compile(r"[0-3][0-9A-Za-z_$]{21}")
_NAMESPACE = uuid.uuid5(uuid.NAMESPACE_URL, "urn:reflight:objects")


def is_global_id(text: str) -> bool:
    """Whether a text is an IFC GlobalId: 22 characters of the alphabet, the first of 0 to 3 (132 bits hold 128)."""
    return _FORM.fullmatch(text) is not None


def check_global_id(text: str, field: str) -> None:
    """Refuse what is no GlobalId.

    Raises
    ------
    InputError
        It is none.
    """
    if not is_global_id(text):
        raise InputError(say("expected an IFC GlobalId ({} characters), got '{}'", LENGTH, text[:40], place=field))


def compressed(number: uuid.UUID) -> str:
    """GlobalId of a UUID."""
    value, pairs = number.int, []
    for _ in range(LENGTH // 2):
        value, pair = divmod(value, len(_PAIRS))
        pairs.append(_PAIRS[pair])
    return "".join(reversed(pairs))


def global_id_of(site_name: str, name: str) -> str:
    """GlobalId of an object that has none of its own: the same for the same two names, always.

    Parameters
    ----------
    name
        Of the object, unique on the site.
    """
    # The length keeps ("a", "bc") and ("ab", "c") apart.
    return compressed(uuid.uuid5(_NAMESPACE, f"{len(site_name)}:{site_name}{name}"))


def new_global_id() -> str:
    """GlobalId that is random."""
    return compressed(uuid.uuid4())


AttributeType = Literal["text", "number", "date", "yes/no"]
Value = str | float | bool
Place = tuple[float, float]

TYPES: tuple[AttributeType, ...] = ("text", "number", "date", "yes/no")
STATES = ("open", "repaired")

STANDARD: dict[str, tuple[AttributeType, str]] = {
    "material": ("text", ""),
    "maker": ("text", ""),
    "product": ("text", ""),
    "coating": ("text", ""),
    "thickness": ("number", "mm"),
    "installed_on": ("date", ""),
    "warranty_until": ("date", ""),
}
"""Type and unit of the attributes that every pane may have; others are free."""

COMPUTED = ("width", "height")
"""Attributes that follow from the corners, in metres."""

RESERVED = ("global_id", "name")
"""Columns of every table, so no names of attributes."""

NAME_FORBIDDEN = '[]()\r\n\t;"'
"""In names and units of attributes: heads of CSV columns put both together."""


@dataclass(frozen=True, slots=True)
class Attribute:
    """One property of an object; an object has each name once.

    Parameters
    ----------
    value
        Text, finite number, date or truth, as `type` says.
    """

    global_id: str
    name: str
    value: Value
    type: AttributeType = "text"
    unit: str = ""
    key: str = ""

    def __post_init__(self) -> None:
        _check_keys(self)
        check_text(self.name, "name", 100, required=True)
        check_text(self.unit, "unit", 30)
        for place, text in (("name", self.name), ("unit", self.unit)):
            if text != text.strip() or any(character in NAME_FORBIDDEN for character in text):
                raise InputError(
                    say("expected a name without brackets, quotes and blanks around it, got '{}'", text, place=place)
                )
        check_choice(self.type, "type", TYPES)
        if self.name in RESERVED:
            raise InputError(say("name: '{}' stands for the object itself; use another name", self.name))
        if self.name in COMPUTED:
            raise InputError(say("follows from the corners of the pane and is not set", place=self.name))
        if self.name in STANDARD and STANDARD[self.name] != (self.type, self.unit):
            kind, unit = STANDARD[self.name]
            found = say("{} in {}", self.type, self.unit) if self.unit else self.type
            raise InputError(
                say("expected a {} in {}, got a {}", kind, unit, found, place=self.name)
                if unit
                else say("expected a {}, got a {}", kind, found, place=self.name)
            )
        self._check_value()

    def _check_value(self) -> None:
        if self.type == "text":
            check_text(self.value, self.name, MAX_TEXT, required=True)
        elif self.type == "date":
            check_date(self.value, self.name)
        elif self.type == "number":
            check_number(self.value, self.name, 0.0 if self.name == "thickness" else -MAX_NUMBER)
            _as_floats(self, "value")
        elif not isinstance(self.value, bool):
            raise InputError(say("expected yes or no, got {}", repr(self.value), place=self.name))


@dataclass(frozen=True, slots=True)
class Inspection:
    """Somebody looked at an object."""

    global_id: str
    date: str
    inspector: str = ""
    method: str = ""
    result: str = ""
    note: str = ""
    key: str = ""

    def __post_init__(self) -> None:
        _check_keys(self)
        check_date(self.date, "date")
        check_texts(self, ("inspector", "method", "result"), ("note",))


@dataclass(frozen=True, slots=True)
class Defect:
    """A crack, a leak, a scratch.

    Parameters
    ----------
    severity
        1 (to be watched) to 5 (danger).
    u, v
        Place on the pane, 0 to 1 from corner c0, along c0 to c1 and along c0 to c3; None where not known.
    outline
        Such places around the defect, at least three, or none.
    picture
        Name of a file in the folder of pictures (`stored_files`), or "".
    inspection
        Key of the inspection that found it, or "".
    """

    global_id: str
    kind: str
    severity: int
    found_on: str
    u: float | None = None
    v: float | None = None
    outline: tuple[Place, ...] = ()
    picture: str = ""
    status: Literal["open", "repaired"] = "open"
    repaired_on: str | None = None
    note: str = ""
    inspection: str = ""
    key: str = ""

    def __post_init__(self) -> None:
        _check_keys(self)
        check_texts(self, ("kind",), ("note",), required=("kind",))
        check_choice(self.severity, "severity", (1, 2, 3, 4, 5))
        check_date(self.found_on, "found_on")
        check_dates(self, ("repaired_on",))
        check_choice(self.status, "status", STATES)
        if self.repaired_on is not None and self.status == "open":
            raise InputError(
                say("expected none while the defect is open, got {}", self.repaired_on, place="repaired_on")
            )
        if (self.u is None) != (self.v is None):
            raise InputError(say("u, v: expected both or neither"))
        if self.u is not None:
            _check_place((self.u, self.v), "u, v")
            _as_floats(self, "u", "v")
        if 0 < len(self.outline) < 3 or len(self.outline) > MAX_OUTLINE:
            raise InputError(say("outline: expected none or 3 to {} places, got {}", MAX_OUTLINE, len(self.outline)))
        for place in self.outline:
            _check_place(place, "outline")
        object.__setattr__(self, "outline", tuple((float(u), float(v)) for u, v in self.outline))
        if self.picture:
            check_stored_name(self.picture, "picture")
        if self.inspection:
            check_global_id(self.inspection, "inspection")


@dataclass(frozen=True, slots=True)
class Maintenance:
    """Work done on an object.

    Parameters
    ----------
    cost
        0 or more, with its `currency` (ISO 4217, such as EUR); None where not known.
    """

    global_id: str
    date: str
    work: str
    done_by: str = ""
    cost: float | None = None
    currency: str = ""
    next_due: str | None = None
    note: str = ""
    key: str = ""

    def __post_init__(self) -> None:
        _check_keys(self)
        check_date(self.date, "date")
        check_texts(self, ("done_by", "currency"), ("work", "note"), required=("work",))
        check_dates(self, ("next_due",))
        if self.cost is not None:
            check_number(self.cost, "cost", 0.0)
            _as_floats(self, "cost")
        if (self.cost is None) != (not self.currency) or (self.currency and not CURRENCY.fullmatch(self.currency)):
            raise InputError(
                say("currency: expected three letters such as EUR with every cost, got '{}'", self.currency)
            )


@dataclass(frozen=True, slots=True)
class Document:
    """A paper about an object.

    Parameters
    ----------
    place
        An http(s) address, or the name of a file in the folder of stored files.
    sha256
        Of the file, hexadecimal; "" where not known.
    """

    global_id: str
    title: str
    place: str
    kind: str = ""
    sha256: str = ""
    key: str = ""

    def __post_init__(self) -> None:
        _check_keys(self)
        check_texts(self, ("title", "kind"), required=("title",))
        check_text(self.place, "place", 2000, required=True)
        if self.sha256 and not SHA256.fullmatch(self.sha256):
            raise InputError(say("sha256: expected 64 hexadecimal digits in lower case, got '{}'", self.sha256[:70]))
        if not is_address(self.place):
            check_stored_name(self.place, "place")


Entry = Attribute | Inspection | Defect | Maintenance | Document


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of entries and how it is kept.

    Parameters
    ----------
    name
        `inspection`.
    table
        `inspections`: of the database, and stem of the CSV file.
    code
        In the numbers of the search index; never changed.
    texts
        Fields that are searched, in an order that is never changed; new ones go last.
    columns
        Fields but `global_id`, in their order.
    """

    name: str
    table: str
    record: type[Entry]
    code: int
    texts: tuple[str, ...]

    columns: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        names = (each.name for each in fields(self.record))
        object.__setattr__(self, "columns", tuple(name for name in names if name != "global_id"))


KINDS = (
    Kind("attribute", "attributes", Attribute, 1, ("name", "value", "unit")),
    Kind("inspection", "inspections", Inspection, 2, ("inspector", "method", "result", "note", "date")),
    Kind("defect", "defects", Defect, 3, ("kind", "note", "status", "found_on")),
    Kind("maintenance", "maintenance", Maintenance, 4, ("work", "done_by", "note", "date")),
    Kind("document", "documents", Document, 5, ("title", "kind", "place")),
)
KIND_OF = {kind.record: kind for kind in KINDS}
KIND_NAMED = {kind.name: kind for kind in KINDS}


def check_stored_name(name: str, field: str) -> None:
    """Refuse what is no name of a stored file: it must lead nowhere else.

    Raises
    ------
    InputError
        It has folders in it, is hidden, or has characters that some system does not bear.
    """
    if not isinstance(name, str) or not is_plain_name(name):
        raise InputError(
            say(
                "expected an address (http, https) or the name of a file beside the records, got '{}'",
                name[:80],
                place=field,
            )
        )


def is_address(text: str) -> bool:
    """Whether a document is on the web; else its place is the name of a file beside the records."""
    try:
        parts = urlsplit(text)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and not any(map(str.isspace, text))
    except ValueError:
        return False


def _check_keys(entry: Entry) -> None:
    check_text(entry.global_id, "global_id")
    check_global_id(entry.global_id, "global_id")
    check_text(entry.key, "key")
    if entry.key:
        check_global_id(entry.key, "key")


def _as_floats(entry: Entry, *names: str) -> None:
    """Whole numbers as floats, with 0 for -0, so that an entry reads back as it was."""
    for name in names:
        object.__setattr__(entry, name, float(getattr(entry, name)) + 0.0)


def _check_place(place: tuple[float | None, float | None], field: str) -> None:
    if len(place) != 2:
        raise InputError(say("expected two numbers, got {}", len(place), place=field))
    for number in place:
        check_number(number, field, 0.0, 1.0)
