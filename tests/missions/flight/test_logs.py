"""The same flight from every kind of log, several flights in one, gaps, clocks that jump, and logs of other places."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from missions.flight.logs.read import _content, _raw_log, read_log
from missions.flight.matching import match_flight
from missions.flight.record import FlightRecord
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.base.progress import QUIET
from planning.geo.frames import Origin, wrap_heading_deg
from planning.geo.geoid import ellipsoid_from_amsl_m
from planning.site.records import Site
from tests.missions.flight import log_writers as write
from tests.missions.flight.flights import cut_at, flown_as_planned, with_durations
from tests.missions.plans import example_plan

PLAN = with_durations(example_plan())
FLOWN = flown_as_planned(PLAN)
SITE = write.log_site()

LOGS: dict[str, Callable[..., bytes]] = {
    "feedback.tlog": write.tlog,
    "captured.tlog": lambda records, site: write.tlog(records, site, captured=True),
    "fast.tlog": lambda records, site: write.tlog(records, site, speedup=20.0),
    "flight.BIN": write.dataflash,
    "flight.log": write.dataflash_text,
    "flight.ulg": write.ulog,
    "triggers.ulg": lambda records, site: write.ulog(records, site, triggers_only=True),
}


def written(tmp_path: Path, name: str, content: bytes) -> Path:
    """A log on disk."""
    path = tmp_path / name
    path.write_bytes(content)
    return path


@pytest.mark.few(2)
@pytest.mark.parametrize("name", LOGS)
def test_every_log_tells_the_same_flights(tmp_path: Path, name: str) -> None:
    flights = read_log(written(tmp_path, name, LOGS[name](FLOWN, SITE)), SITE)
    assert len(flights.records) == 2
    for record, truth in zip(flights.records, FLOWN, strict=True):
        offset_s = record.photos[0].time_s - truth.photos[0].time_s
        for axis in range(3):
            flown_m = np.interp(record.track.time_s - offset_s, truth.track.time_s, truth.track.position_enu_m[:, axis])
            np.testing.assert_allclose(record.track.position_enu_m[:, axis], flown_m, atol=0.12)
        assert record.duration_s == pytest.approx(truth.duration_s, abs=2.5)
        for photo, planned in zip(record.photos, truth.photos, strict=True):
            assert math.dist(photo.position_enu_m, planned.position_enu_m) < 0.03
            assert photo.heading_deg is not None
            assert planned.heading_deg is not None
            assert wrap_heading_deg(photo.heading_deg - planned.heading_deg) == pytest.approx(0.0, abs=0.02)
            if name != "flight.log":
                assert photo.gimbal_pitch_deg == pytest.approx(planned.gimbal_pitch_deg, abs=0.02)
                assert record.track.battery[-1] == pytest.approx(truth.track.battery[-1], abs=0.006)
                assert photo.speed_m_s is not None
                assert photo.speed_m_s < 0.05
    taken = [match.reason.value for match in match_flight(PLAN, flights.records).views]
    assert taken == ["taken"] * 10
    codes = {finding.code for finding in flights.findings}
    assert codes == ({"triggers-only"} if name == "triggers.ulg" else set())


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "mode", "text"),
    [
        ("feedback.tlog", "AUTO", None),
        ("flight.BIN", "AUTO", "ArduCopter V4.5.6"),
        ("flight.log", "AUTO", None),
        ("flight.ulg", "MISSION", "[commander] Takeoff detected"),
    ],
)
def test_modes_texts_and_arming_are_events(tmp_path: Path, name: str, mode: str, text: str | None) -> None:
    log = _raw_log(LOGS[name](FLOWN[:1], SITE), name, QUIET)
    assert [event.text for event in log.events if event.code == "mode"] == [mode]
    assert [event.text for event in log.events if event.code == "text"] == ([text] if text else [])
    (record,) = read_log(written(tmp_path, name, LOGS[name](FLOWN[:1], SITE)), SITE).records
    armed = [event for event in record.events if event.code in ("armed", "disarmed")]
    assert [event.code for event in armed] == ["armed", "disarmed"]
    assert armed[1].time_s - armed[0].time_s == pytest.approx((FLOWN[0].duration_s or 0.0) + 30.0, abs=3.0)


def test_a_log_of_another_site_is_refused_with_the_distance(tmp_path: Path) -> None:
    path = written(tmp_path, "flight.BIN", write.dataflash(FLOWN, SITE))
    elsewhere = replace(SITE, origin=Origin(22.5, 114.2636, 62.0))
    with pytest.raises(InputError, match=r"flight\.BIN: the flight is 18\.\d km from the site 'office'"):
        read_log(path, elsewhere)
    with pytest.raises(InputError, match=r"km from the site"):
        read_log(path, replace(SITE, origin=Origin(-60.0, -70.0, 0.0)))


def test_a_log_from_the_middle_of_a_flight_has_no_duration(tmp_path: Path) -> None:
    middle = FLOWN[0].photos[2].time_s
    content = write.dataflash((cut_at(FLOWN[0], middle),), SITE)
    (record,) = read_log(written(tmp_path, "cut.BIN", content), SITE).records
    assert record.duration_s is None
    assert len(record.photos) == 3


def test_a_gap_is_told_of_and_nothing_is_made_up_in_it(tmp_path: Path) -> None:
    content = write.tlog(FLOWN[:1], SITE)
    frames = tlog_records(content)
    time_s = [struct.unpack(">Q", frame[:8])[0] / 1e6 - write.UNIX_S for frame in frames]
    kept = b"".join(frame for frame, t in zip(frames, time_s, strict=True) if not 60.0 < t < 80.0)
    (record,) = read_log(written(tmp_path, "gap.tlog", kept), SITE).records
    gaps = [event for event in record.events if event.code == "gap"]
    assert [event.text for event in gaps] == ["the log says nothing for 20.2 s"]
    assert np.diff(record.track.time_s).max() == pytest.approx(20.2, abs=0.05)


def tlog_records(content: bytes) -> list[bytes]:
    """A telemetry log, record by record."""
    frames = []
    while content:
        size = 8 + 12 + content[9]
        frames.append(content[:size])
        content = content[size:]
    return frames


@pytest.mark.slow
def test_records_out_of_order_are_put_in_order_and_told_of(tmp_path: Path) -> None:
    frames = tlog_records(write.tlog(FLOWN[:1], SITE))
    frames[2000:2400], frames[2400:2800] = frames[2400:2800], frames[2000:2400]
    flights = read_log(written(tmp_path, "back.tlog", b"".join(frames)), SITE)
    straight = read_log(written(tmp_path, "straight.tlog", write.tlog(FLOWN[:1], SITE)), SITE)
    assert {finding.code for finding in flights.findings} <= {"time-went-back"}
    assert np.all(np.diff(flights.records[-1].track.time_s) >= 0.0)
    assert len(flights.records[0].photos) == len(straight.records[0].photos)


def test_a_reboot_between_two_flights_keeps_them_apart(tmp_path: Path) -> None:
    first, second = write.tlog(FLOWN[:1], SITE), write.tlog(FLOWN[1:], SITE)
    duration_us = int(1e6 * (FLOWN[0].track.time_s[-1] + 300.0))
    later = b"".join(
        struct.pack(">Q", struct.unpack(">Q", frame[:8])[0] + duration_us) + frame[8:] for frame in tlog_records(second)
    )
    flights = read_log(written(tmp_path, "reboot.tlog", first + later), SITE)
    assert [len(record.photos) for record in flights.records] == [6, 4]


def test_positions_of_zero_nan_and_nowhere_are_left_out(tmp_path: Path) -> None:
    good = write.dataflash(FLOWN[:1], SITE)
    us = int((write.BOOT_S + 60.0) * 1e6)
    bad = b"".join(
        write.dataflash_record("POS", us, lat, lon, alt, alt, alt)
        for lat, lon, alt in ((0.0, 0.0, 1.0), (22.3, 114.2, math.nan), (95.0, 114.0, 1.0), (22.3, 114.2, 1e30))
    )
    flights = read_log(written(tmp_path, "bad.BIN", good + bad), SITE)
    (clean,) = read_log(written(tmp_path, "good.BIN", good), SITE).records
    (record,) = flights.records
    np.testing.assert_array_equal(record.track.position_enu_m, clean.track.position_enu_m)
    assert "positions-dropped" in {finding.code for finding in flights.findings}


def test_heights_above_sea_level_can_be_asked_for_and_differences_are_told(tmp_path: Path) -> None:
    content = write.dataflash(FLOWN[:1], SITE)
    higher = replace(SITE, origin=replace(SITE.origin, ellipsoid_height_m=72.0))
    path = written(tmp_path, "flight.BIN", content)
    by_takeoff, by_sea = read_log(path, higher), read_log(path, higher, "sea-level")
    apart = by_sea.records[0].track.position_enu_m - by_takeoff.records[0].track.position_enu_m
    np.testing.assert_allclose(apart[:, 2], -10.0, atol=0.05)
    for flights, value in ((by_takeoff, -10.0), (by_sea, 10.0)):
        (finding,) = flights.findings
        assert (finding.code, finding.severity) == ("height-reference", Severity.NOTE)
        assert finding.value == pytest.approx(value, abs=0.05)


def test_on_the_ground_only_is_no_flight(tmp_path: Path) -> None:
    still = FLOWN[0].track
    stay = replace(still, position_enu_m=np.tile(SITE.home_enu_m, (len(still.time_s), 1)))
    ground = replace(FLOWN[0], track=stay, photos=())
    with pytest.raises(InputError, match="did not fly"):
        read_log(written(tmp_path, "ground.BIN", write.dataflash((ground,), SITE)), SITE)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the log is empty"),
        (b"hello world, this is no log" * 10, "its content is no flight log"),
        (b"\xa3\x95" + bytes(100), "holds no position"),
        (b"ULog\x01\x12\x35\x01", "the ULog cannot be read"),
        (b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n", "holds no position"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_log(written(tmp_path, "x.bin", content), SITE)


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_log(tmp_path / "none.tlog", SITE)
    with pytest.raises(InputError, match="found a folder"):
        read_log(tmp_path, SITE)


def test_a_ulog_type_that_contains_itself_is_refused(tmp_path: Path) -> None:
    header = b"ULog\x01\x12\x35\x01" + bytes(8) + write.ulog_message("B", bytes(40))
    nested = write.ulog_message("F", b"battery_status:uint64_t timestamp;a[60000] x;")
    nested += write.ulog_message("F", b"a:b[60000] x;") + write.ulog_message("F", b"b:float[60000] x;")
    body = write.ulog_message("A", struct.pack("<BH", 0, 1) + b"battery_status")
    with pytest.raises(InputError, match="more than 2000 fields"):
        read_log(written(tmp_path, "bomb.ulg", header + nested + body), SITE)
    loop = write.ulog_message("F", b"battery_status:battery_status x;")
    with pytest.raises(InputError, match="contains itself"):
        read_log(written(tmp_path, "loop.ulg", header + loop + body), SITE)


REAL = {
    "dronekit_la_log171.bin": (1, 200.0),
    "sample_px4_events.ulg": (1, 10.0),
    "uavlogviewer_vtol.tlog": (1, 170.0),
}


@pytest.mark.long
@pytest.mark.parametrize("name", REAL)
def test_real_logs_give_their_flights(shared_data: Path, name: str) -> None:
    path = shared_data / "logs" / name
    n_flights, at_least_s = REAL[name]
    records = read_log(path, site_of(path)).records
    assert len(records) == n_flights
    for record in records:
        assert record.track.time_s[-1] >= at_least_s
        assert np.isfinite(record.track.position_enu_m).all()
        assert np.isfinite(record.track.heading_rad).mean() > 0.95
        moved = np.gradient(record.track.position_enu_m, axis=0)
        assert np.abs(moved).max() < 60.0


def site_of(path: Path) -> Site:
    """A site whose home is where a real log takes off."""
    log = _raw_log(_content(path), path.name, QUIET)
    _, lat, lon, amsl_m, above_home_m = next(row for row in log.positions if abs(row[1]) > 1.0 and row[4] == row[4])
    height_m = float(ellipsoid_from_amsl_m(lat, lon, amsl_m - above_home_m))
    return replace(SITE, origin=Origin(lat, lon, height_m), home_enu_m=(0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("ardupilot_text_underpowered.log", "holds no position"),
        ("pymavlink_test.BIN", "km from the site"),
        ("sample_appended_multiple.ulg", "holds no position"),
    ],
)
def test_real_logs_without_a_flight_here_are_refused(shared_data: Path, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_log(shared_data / "logs" / name, SITE)


def test_the_records_are_those_of_the_plan(tmp_path: Path) -> None:
    swapped: tuple[FlightRecord, ...] = (FLOWN[1], FLOWN[0])
    records = read_log(written(tmp_path, "swapped.BIN", write.dataflash(swapped, SITE)), SITE).records
    assert match_flight(PLAN, records).sortie_of_record == (2, 1)
