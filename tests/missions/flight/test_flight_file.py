"""flight.json: an exact round trip, and errors that say where."""

from __future__ import annotations

import json
import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from missions.flight.flight_file import Flight, flight_to_json, plan_sha256, read_flight, write_flight
from missions.flight.outcome import FlightReport, Reason, Summary, ViewOutcome
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.geo.frames import Origin
from planning.plan import write_plan
from tests.missions.flight.flights import flown_as_planned
from tests.missions.plans import HONG_KONG, example_plan

known_or_not = st.one_of(st.just(math.nan), st.floats(-1e4, 1e4))


@st.composite
def tracks(draw: st.DrawFn) -> Track:
    """Tracks of any length, with unknown values anywhere but in the time."""
    n = draw(st.integers(0, 6))
    time_s = np.cumsum(draw(arrays(np.float64, n, elements=st.floats(0.0, 10.0))))
    shapes = {f.name: (n, 3) if f.name.endswith(("enu_m", "enu_m_s")) else (n,) for f in fields(Track)}
    columns = {name: draw(arrays(np.float64, shape, elements=known_or_not)) for name, shape in shapes.items()}
    return Track(**{**columns, "time_s": time_s})


def flight(track: Track) -> Flight:
    """A flight of one record with everything in it."""
    photo = TakenPhoto(1, 12.25, (1.0, 2.0, 3.1), -170.25, None, 0.1, "log", "DJI_0001.JPG")
    event = FlightEvent(3.0, "mode", "AUTO")
    effect = Decision("wind", True, "scene", "8 m/s", 0.4, 0.1, "m", 0.0)
    record = FlightRecord(1, "ArduCopter", track, (photo,), (event,), 612.5, (effect,))
    views = (ViewOutcome("v0", 1, Reason.TAKEN, 0, 0, 4, 3, 0.1, -2.0, None, 0.1, 0.5, 10.2),)
    finding = Finding(Severity.WARNING, "position", "worst", "v0", 0.6, 0.5, "m")
    report = FlightReport(Summary(1, 1, 1, 4, 3, 36, ("A-1",), 600.0, 612.5, 9.9), views, (), (finding,))
    return Flight("office", "ab", "cd", HONG_KONG, (record, replace(record, sortie=0, photos=())), report)


@pytest.mark.slow
@settings(max_examples=30)
@given(tracks())
def test_a_flight_comes_back_from_its_file_bit_for_bit(tmp_path_factory: pytest.TempPathFactory, track: Track) -> None:
    path = tmp_path_factory.mktemp("flight") / "flight.json"
    written = flight(track)
    write_flight(path, written)
    read = read_flight(path)
    for ours, theirs in zip(written.sorties, read.sorties, strict=True):
        for field in fields(Track):
            np.testing.assert_array_equal(getattr(ours.track, field.name), getattr(theirs.track, field.name))
        assert replace(ours, track=track).photos == theirs.photos
        assert (ours.events, ours.duration_s, ours.effects) == (theirs.events, theirs.duration_s, theirs.effects)
    assert (read.report, read.origin, read.plan_sha256) == (written.report, written.origin, written.plan_sha256)
    assert flight_to_json(read) == flight_to_json(written)


def test_the_file_is_json_without_nan(tmp_path: Path) -> None:
    track = flown_as_planned(example_plan())[0].track
    write_flight(tmp_path / "flight.json", flight(replace(track, battery=np.full_like(track.battery, np.nan))))
    text = (tmp_path / "flight.json").read_text()
    assert "NaN" not in text
    content = json.loads(text)
    assert content["format"] == "reflight-flight/1"
    assert content["sorties"][0]["track"]["battery"][0] is None


def test_the_file_is_written_in_pieces_as_it_would_be_at_once(tmp_path: Path) -> None:
    written = flight(flown_as_planned(example_plan())[0].track)
    write_flight(tmp_path / "flight.json", written)
    at_once = json.dumps(flight_to_json(written), allow_nan=False, separators=(",", ":"))
    assert (tmp_path / "flight.json").read_text() == at_once


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(format="reflight-plan/1"), "format: expected 'reflight-flight/1'"),
        (lambda c: c["sorties"][0].pop("track"), r"sorties\[0\].*track"),
        (
            lambda c: c["sorties"][0]["track"].update(time_s=[0.0]),
            r"sorties\[0\]\.track\.position_enu_m: expected shape",
        ),
        (lambda c: c["sorties"][1]["track"]["time_s"].reverse(), r"sorties\[1\]\.track\.time_s: expected rising times"),
        (lambda c: c["sorties"][0]["photos"][0].update(position_enu_m=[0, 1]), r"sorties\[0\]\.photos\[0\]"),
        (
            lambda c: c["sorties"][0]["track"]["heading_rad"].insert(0, "north"),
            r"track\.heading_rad\[0\]: expected number",
        ),
        (lambda c: c["report"]["views"][0].update(reason="lost"), r"report\.views\[0\]\.reason"),
    ],
)
def test_a_wrong_file_is_refused_with_the_place(tmp_path: Path, change: object, message: str) -> None:
    path = tmp_path / "flight.json"
    content = flight_to_json(flight(flown_as_planned(example_plan())[0].track))
    change(content)  # type: ignore[operator]
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=message):
        read_flight(path)


def test_fields_of_later_versions_are_ignored(tmp_path: Path) -> None:
    path = tmp_path / "flight.json"
    content = flight_to_json(flight(flown_as_planned(example_plan())[0].track))
    content["weather"] = "fine"
    content["sorties"][0]["pilot"] = "A"
    path.write_text(json.dumps(content))
    assert read_flight(path).site == "office"


def test_the_checksum_is_that_of_the_plan_file_we_write(tmp_path: Path) -> None:
    import hashlib

    write_plan(tmp_path / "plan.json", example_plan())
    assert plan_sha256(example_plan()) == hashlib.sha256((tmp_path / "plan.json").read_bytes()).hexdigest()


def test_nothing_is_left_half_written(tmp_path: Path) -> None:
    path = tmp_path / "flight.json"
    good = Flight("office", "", "", Origin(0.0, 0.0, 0.0), ())
    write_flight(path, good)
    bad = TakenPhoto(1, math.inf, (0.0, 0.0, 0.0))
    record = replace(flown_as_planned(example_plan())[0], photos=(bad,))
    with pytest.raises(ValueError, match="JSON"):
        write_flight(path, replace(good, sorties=(record,)))
    assert read_flight(path) == good
    assert list(tmp_path.iterdir()) == [path]
