"""Records of panes as a web page has them: what is shown of each object, and columns that panes are coloured by.

Rows are plain mappings with `global_id`, `record` (`attribute`, `inspection`, `defect`, `maintenance`, `document`) and
the fields that `reconstruction.records.entries` has, or any others: what is not known is shown by its own name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import Monitor
from planning.geo.frames import Vec3
from reconstruction.objects.gs_scene import GsElement
from reconstruction.photos.decode import decoded
from reconstruction.records.entries import is_address
from reconstruction.records.stored_files import STARTS, download_name

# Files that records name, for a web page: pictures small, documents as they are.
#
# Pictures are made anew as small JPEG files, so that nothing of the old file is left in them: neither places in EXIF
# nor
# whatever else it carries reaches the page.

LONGEST_PX = 1280
QUALITY = 82
"""Of JPEG: some 200 kB for a picture of that size."""

MAX_PIXELS = 100 * 10**6
"""Larger ones are refused by what their header says: a file of some kilobytes can claim any size."""

MAX_FILE_BYTES = 64 * 2**20


MAX_PICTURE_BYTES = 64 * 2**20
"""Of all pictures together, as they are in the page."""

MAX_DOCUMENT_BYTES = 64 * 2**20
"""Of all documents together; the smallest ones are taken first."""

PICTURES = (*STARTS, ".jpeg")
"""Endings of documents that are shown."""

State = Literal["missing", "damaged", "large"]
"""Why a file is not in the page: it is not beside the records; it is no picture that can be read; or its size."""


@dataclass(frozen=True, slots=True)
class WebFiles:
    """What records name, by the names of stored files.

    Parameters
    ----------
    pictures, documents
        Content.
    states
        Of what is not there, and of documents that are too large also their bytes.
    """

    pictures: dict[str, bytes]
    documents: dict[str, bytes]
    states: dict[str, State]
    sizes: dict[str, int]

    def as_json(self) -> dict[str, dict[str, Any]]:
        """As the page knows them: the number of the part that holds it, its bytes, and why it is not there."""
        found: dict[str, dict[str, Any]] = {name: {"state": state} for name, state in self.states.items()}
        found |= {name: {"picture": number} for number, name in enumerate(self.pictures)}
        found |= {name: {"document": number} for number, name in enumerate(self.documents)}
        for name, size in self.sizes.items():
            found[name]["bytes"] = size
        return found


def files_of(
    records: Mapping[str, Sequence[dict[str, Any]]], content_of: Callable[[str], bytes | None], monitor: Monitor
) -> WebFiles:
    """Files of defects and documents; records of stored documents are told what these are called (`file`).

    Raises
    ------
    InputError
        Pictures are too large together, even made small.
    """
    rows = [row for of_object in records.values() for row in of_object]
    pictures = {str(row["picture"]) for row in rows if "picture" in row}
    documents: set[str] = set()
    for row in rows:
        place = str(row.get("place", ""))
        if row["record"] == "document" and place and not is_address(place):
            row["file"] = download_name(str(row.get("title", "")), place)
            (pictures if place.endswith(PICTURES) else documents).add(place)
    found = WebFiles({}, {}, {}, {})
    n_bytes = 0
    for number, name in enumerate(sorted(pictures)):
        monitor.report(say("reading pictures"), number, len(pictures))
        content = content_of(name)
        try:
            if content is None:
                found.states[name] = "missing"
                continue
            found.pictures[name] = small_jpeg(name, content)
        except InputError:
            found.states[name] = "damaged"
            continue
        n_bytes += len(found.pictures[name])
        if n_bytes > MAX_PICTURE_BYTES:
            raise InputError(
                say(
                    "pictures of defects: more than {} MiB after {} of {}, even made small; leave some out",
                    MAX_PICTURE_BYTES // 2**20,
                    number + 1,
                    len(pictures),
                )
            )
    _take_documents(found, sorted(documents - pictures), content_of, monitor)
    return found


def _take_documents(
    found: WebFiles, names: Sequence[str], content_of: Callable[[str], bytes | None], monitor: Monitor
) -> None:
    for number, name in enumerate(names):
        monitor.report(say("reading documents"), number, len(names))
        content = content_of(name)
        if content is None:
            found.states[name] = "missing"
        else:
            found.sizes[name], found.documents[name] = len(content), content
            total = sum(map(len, found.documents.values()))
            while total > MAX_DOCUMENT_BYTES:  # the largest one goes
                largest = max(found.documents, key=lambda each: (len(found.documents[each]), each))
                total -= len(found.documents.pop(largest))
                found.states[largest] = "large"


def small_jpeg(name: str, content: bytes, longest_px: int = LONGEST_PX) -> bytes:
    """The picture, made small.

    Parameters
    ----------
    name
        For messages.
    longest_px
        Width or height at most.

    Raises
    ------
    InputError
        It is no JPEG, PNG or WebP file, is damaged, or larger than any camera's.
    """
    place = say("picture '{}'", name[:80])
    if len(content) > MAX_FILE_BYTES:
        raise InputError(say("has more than {} MiB; save it smaller", MAX_FILE_BYTES // 2**20, place=place))
    picture = np.asarray(decoded(content, cv2.IMREAD_COLOR, place, MAX_PIXELS), np.uint8)
    is_good, written = cv2.imencode(".jpg", _shrunk(picture, longest_px), (cv2.IMWRITE_JPEG_QUALITY, QUALITY))
    if not is_good:
        raise InputError(say("cannot be written as JPEG", place=place))
    return written.tobytes()


def _shrunk(picture: NDArray[np.uint8], longest_px: int) -> NDArray[np.uint8]:
    height, width = picture.shape[:2]
    factor = longest_px / max(height, width)
    if factor >= 1.0:
        return picture
    size_wh = max(1, round(width * factor)), max(1, round(height * factor))
    return np.asarray(cv2.resize(picture, size_wh, interpolation=cv2.INTER_AREA), np.uint8)


Row = Mapping[str, Any]
Plain = str | float | bool | None

RECORDS = ("attribute", "inspection", "defect", "maintenance", "document")

MAX_RECORDS = 1_000_000
MAX_FIELDS = 64
MAX_TEXT = 20_000
MAX_PLACES = 1000

NOT_SHOWN = frozenset({"global_id", "key", "sha256"})


@dataclass(frozen=True, slots=True)
class Column:
    """A value of each pane.

    Parameters
    ----------
    name
        Of an attribute as its maker wrote it; those that the page translates begin with `:`.
    type
        `text`, `number`, `date` or `yes/no`.
    values
        By pane; None where there is none.
    """

    name: str
    type: str
    unit: str
    values: tuple[Plain, ...]


def by_object(rows: Iterable[Row], known: frozenset[str]) -> tuple[dict[str, list[dict[str, Any]]], int]:
    """Records of each object by its GlobalId, and how many belong to none of `known`.

    Raises
    ------
    InputError
        A record lacks its object or kind, or holds what no page can show: other than texts, finite numbers, truths,
        and lists of places.
    """
    found: dict[str, list[dict[str, Any]]] = {}
    n_strays = 0
    for number, row in enumerate(rows, 1):
        if number > MAX_RECORDS:
            raise InputError(say("records: there are more than {}; leave some out", MAX_RECORDS))
        record = _checked(row, number)
        global_id = row["global_id"]
        if global_id in known:
            found.setdefault(global_id, []).append(record)
        else:
            n_strays += 1
    return found, n_strays


def _checked(row: Row, number: int) -> dict[str, Any]:
    place = say("record {}", number)
    if not isinstance(row.get("global_id"), str):
        raise InputError(
            say(
                "expected the GlobalId of an object, got {}",
                f"{row.get('global_id')!r:.60}",
                place=f"{place}: global_id",
            )
        )
    if row.get("record") not in RECORDS:
        raise InputError(
            say("record: expected one of {}, got {}", ", ".join(RECORDS), f"{row.get('record')!r:.60}", place=place)
        )
    if len(row) > MAX_FIELDS:
        raise InputError(say("has {} fields; at most {} are shown", len(row), MAX_FIELDS, place=place))
    return {
        name: _plain(value, f"{place}: {name:.60}")
        for name, value in row.items()
        if name not in NOT_SHOWN and value is not None and value != ""
    }


def _plain(value: Any, place: str) -> Any:
    if isinstance(value, bool):
        return value
    if isinstance(value, str):
        if len(value) > MAX_TEXT:
            raise InputError(say("expected at most {} characters, got {}", MAX_TEXT, len(value), place=place))
        return value
    if isinstance(value, int | float):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise InputError(say("expected a finite number, got {}", f"{value!r:.60}", place=place))
        return int(number) if number.is_integer() and abs(number) < 2**53 else number
    if isinstance(value, list | tuple) and len(value) <= MAX_PLACES and all(_is_place(each) for each in value):
        return [[float(u), float(v)] for u, v in value]
    raise InputError(
        say("expected a text, a number, yes or no, or places on a pane; got {}", type(value).__name__, place=place)
    )


def _is_place(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and len(value) == 2
        and all(isinstance(part, int | float) and math.isfinite(part) for part in value)
    )


def columns_of(elements: Sequence[GsElement], records: Mapping[str, Sequence[Row]]) -> list[Column]:
    """What panes can be coloured by: attributes, what inspections and defects come to, sizes."""
    of_panes = [records.get(element.global_id, ()) for element in elements]
    sizes = [size_m(element.corners_enu_m) for element in elements]
    inspected = [_latest(rows, "inspection", "date") for rows in of_panes]
    due = [_latest(rows, "maintenance", "next_due") for rows in of_panes]
    open_defects = [[row for row in rows if _is_open(row)] for rows in of_panes]
    severities = [
        [row["severity"] for row in rows if isinstance(row.get("severity"), int | float)] for rows in open_defects
    ]
    computed = [
        Column(":last_inspection", "date", "", tuple(inspected)),
        Column(":worst_defect", "number", "", tuple(max(found, default=None) for found in severities)),
        Column(":open_defects", "number", "", tuple(len(found) or None for found in open_defects)),
        Column(":next_due", "date", "", tuple(due)),
    ]
    attributes = _attributes(of_panes)
    measured = [
        Column(":width", "number", "m", tuple(round(width, 3) for width, _ in sizes)),
        Column(":height", "number", "m", tuple(round(height, 3) for _, height in sizes)),
    ]
    return [column for column in (*computed, *attributes, *measured) if any(v is not None for v in column.values)]


def _attributes(of_panes: Sequence[Sequence[Row]]) -> list[Column]:
    found: dict[tuple[str, str, str], list[Plain]] = {}
    for pane, rows in enumerate(of_panes):
        for row in rows:
            if row["record"] == "attribute" and "name" in row and "value" in row:
                key = str(row["name"]), _type(row), str(row.get("unit", ""))
                found.setdefault(key, [None] * len(of_panes))[pane] = row["value"]
    return [Column(name, type_, unit, tuple(found[name, type_, unit])) for name, type_, unit in sorted(found)]


def _type(row: Row) -> str:
    value = row["value"]
    if isinstance(value, bool):
        return "yes/no"
    if isinstance(value, int | float):
        return "number"
    return "date" if row.get("type") == "date" else "text"


def _is_open(row: Row) -> bool:
    return bool(row["record"] == "defect" and row.get("status", "open") == "open")


def _latest(rows: Sequence[Row], record: str, field: str) -> str | None:
    return max((str(row[field]) for row in rows if row["record"] == record and field in row), default=None)


def size_m(corners_enu_m: Sequence[Vec3]) -> tuple[float, float]:
    """Width and height of a pane: means of opposite edges, from c0 to c1 and from c0 to c3."""
    corners = np.asarray(corners_enu_m, np.float64)
    edges = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    return float(edges[0] + edges[2]) / 2.0, float(edges[1] + edges[3]) / 2.0
