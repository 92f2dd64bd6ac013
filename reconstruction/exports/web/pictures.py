"""Files that records name, for a web page: pictures small, documents as they are.

Pictures are made anew as small JPEG files, so that nothing of the old file is left in them: neither places in EXIF nor
whatever else it carries reaches the page.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.photos.decode import decoded
from reconstruction.records.entries import is_address
from reconstruction.records.stored_files import STARTS, told_name

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

    def told(self) -> dict[str, dict[str, Any]]:
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
            row["file"] = told_name(str(row.get("title", "")), place)
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
