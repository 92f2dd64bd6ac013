"""Files damaged at random, of every format: each is read or refused in words, never with another exception."""

from __future__ import annotations

import io
import random
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from missions.formats.options import ExportOptions
from missions.formats.registry import encode, read_missions
from missions.mavlink.autopilots import Autopilot
from missions.mission.export_choices import FileFormat
from missions.mission.to_plan import viewpoints_and_sorties
from planning.base.errors import GroundStationError
from planning.geo.frames import Origin
from tests.missions.plans import example_plan

VALUES = (
    b"nan", b"inf", b"-1", b"1e309", b"65535", b"", b"0", b"-9999999", b"abc", b"null", b"[]", b"{}", b"true",
    b"99999999999999999999", b"1e-320", b"followWayline", b"coordinateTurn", b"multipleTiming",
    b"betweenAdjacentPoints",
)  # fmt: skip
VALUE = re.compile(rb"(?<=[>\t,:\[ ])[^<\t,\n\[\]{}]+(?=[<\t,\n\]}])")


def damaged(content: bytes, rng: random.Random) -> bytes:
    """The content with one to four values replaced, or pieces lost, doubled or flipped."""
    text = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 4))):
        kind, start = rng.random(), rng.randrange(len(text))
        if kind < 0.6:
            places = list(VALUE.finditer(text))
            place = rng.choice(places)
            text[place.start() : place.end()] = rng.choice(VALUES)
        elif kind < 0.75:
            del text[start : start + rng.choice((1, 5, 50))]
        elif kind < 0.9:
            text[start:start] = text[start : start + rng.choice((5, 50, 500))]
        else:
            text[start] = rng.randrange(256)
    return bytes(text)


def damaged_kmz(content: bytes, rng: random.Random) -> bytes:
    """A KMZ with one of its parts damaged, packed soundly."""
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as new:
        chosen = rng.choice(old.namelist())
        for name in old.namelist():
            part = old.read(name)
            new.writestr(name, damaged(part, rng) if name == chosen else part)
    return packed.getvalue()


def damages(file_format: FileFormat, autopilot: Autopilot, n: int) -> Iterator[bytes]:
    rng = random.Random(f"{file_format} {autopilot}")
    options = ExportOptions(autopilot=autopilot, clock=lambda: 0.0)
    content = encode(example_plan(), None, None, file_format, options).contents[0]
    damage = damaged_kmz if file_format is FileFormat.DJI_KMZ else damaged
    return (damage(content, rng) for _ in range(n))


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("autopilot", list(Autopilot))
@pytest.mark.parametrize("file_format", list(FileFormat))
def test_damaged_file_is_read_or_refused_in_words(
    tmp_path: Path, file_format: FileFormat, autopilot: Autopilot
) -> None:
    path = tmp_path / "m.file"
    n_refused = 0
    for content in damages(file_format, autopilot, 120):
        path.write_bytes(content)
        try:
            missions = read_missions(path)
            first = missions[0].waypoints[0]
            origin = Origin(first.lat_deg, first.lon_deg, 50.0)
            viewpoints_and_sorties(missions, origin, (0.0, 0.0, 0.0))
        except GroundStationError:
            n_refused += 1
    assert n_refused > 5
