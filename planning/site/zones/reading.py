"""Files of geo-zones: which format one is in, and what it says.

A format is one module with `recognises` and `read`, and a row of `FORMATS`. It is loaded when a file is read: few sites
have zones, and all windows wait for what is loaded at the start.
"""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_input_file
from planning.base.json_file import parse_json
from planning.base.messages import say
from planning.site.zones.records import Zone, ZoneSet

ZONES_FILE = FileLimit(
    say("a file of geo-zones"), 128 * MIB, say("cut out the part around the site, or take the file of one country")
)
"""Those of whole countries have under 30 MiB."""

KNOWN = say("a file of geo-zones: ED-269 or ED-318 JSON, GeoJSON, KML, AIXM 5.1 or OpenAir")


@dataclass(frozen=True, slots=True)
class ZoneFormat:
    """A format of geo-zones.

    Parameters
    ----------
    module
        In this room: `recognises` tells a file of the format, `read` reads it.
    is_json
        Whether both take parsed JSON, else the bytes of the file.
    """

    module: str
    is_json: bool

    def reader(self) -> _Reader:
        """The module."""
        found: _Reader = importlib.import_module(f"planning.site.zones.{self.module}")
        return found


class _Reader(Protocol):
    recognises: Callable[[Any], bool]
    read: Callable[[Any, Path], ZoneSet]


FORMATS = (
    ZoneFormat("ed269", is_json=True),
    ZoneFormat("ed318", is_json=True),
    ZoneFormat("geojson", is_json=True),
    ZoneFormat("kml", is_json=False),
    ZoneFormat("aixm", is_json=False),
    ZoneFormat("openair", is_json=False),
)
"""The first that recognises a file reads it."""


def read_zones(path: Path) -> ZoneSet:
    """What a file of geo-zones says.

    Raises
    ------
    InputError
        It cannot be read whole, is of no format known here, or holds no zone.
    """
    return zones_of(read_input_file(path, ZONES_FILE), path)


def zones_of(written: bytes, path: Path) -> ZoneSet:
    """What the content of a file says; errors as `read_zones`."""
    start = written.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    content = parse_json(written, path) if start in (b"{", b"[") else None
    for each in FORMATS:
        given = content if each.is_json else written
        if (content is None) != each.is_json and (reader := each.reader()).recognises(given):
            found = reader.read(given, path)
            if not found.zones:
                raise InputError.say("there is no zone in this {} file", found.format, place=path)
            return replace(found, zones=_with_unique_ids(found.zones))
    if written.startswith(b"PK\x03\x04"):
        raise InputError.say("expected {}, found an archive; unpack it first", KNOWN, place=path)
    if not start:
        raise InputError.say("expected {}, found an empty file; copy it again", KNOWN, place=path)
    raise InputError.say("expected {}, found something else", KNOWN, place=path)


def _with_unique_ids(zones: tuple[Zone, ...]) -> tuple[Zone, ...]:
    """Zones whose identifiers differ: a permission for one of two must not be taken for the other."""
    used = Counter[str]()
    taken = {zone.id for zone in zones}
    found = []
    for zone in zones:
        used[zone.id] += 1
        name, number = zone.id, used[zone.id]
        while number > 1 and (name := f"{zone.id} ({number})") in taken:
            number += 1
        taken.add(name)
        found.append(zone if name == zone.id else replace(zone, id=name))
    return tuple(found)


@lru_cache(maxsize=8)
def known_zones(written: bytes, path: Path) -> ZoneSet | InputError:
    """As `zones_of`, once for each file that is looked at again and again; an error is returned."""
    try:
        return zones_of(written, path)
    except InputError as error:
        return error
