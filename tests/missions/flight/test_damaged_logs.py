"""Damaged logs: an InputError or what is left of the flight, soon, and never anything else."""

from __future__ import annotations

import struct
import time
from pathlib import Path

import numpy as np
import pytest

from missions.flight.logs.read import read_log
from planning.base.errors import InputError
from tests.missions.flight import log_writers as write
from tests.missions.flight.flights import flown_as_planned
from tests.missions.flight.test_logs import LOGS, PLAN, SITE, tlog_records, written

FLOWN = flown_as_planned(PLAN)[:1]

LONGEST_S = 30.0
"""Of processor time for any single log of this size, some hundred times what it takes; what hangs takes for ever."""


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["feedback.tlog", "captured.tlog", "flight.BIN", "flight.log", "flight.ulg"])
def test_logs_damaged_at_random_are_read_or_refused(tmp_path: Path, name: str) -> None:
    content = LOGS[name](FLOWN, SITE)
    rng = np.random.default_rng(5)
    n_read = 0
    for _ in range(12):
        path = written(tmp_path, name, write.damaged(content, rng))
        start_s = time.process_time()
        try:
            records = read_log(path, SITE).records
        except InputError:
            records = ()
        n_read += bool(records)
        for record in records:
            assert np.isfinite(record.track.position_enu_m).all()
            assert all(np.isfinite(photo.position_enu_m).all() for photo in record.photos)
            assert len(record.photos) <= 100
        assert time.process_time() - start_s < LONGEST_S
    assert n_read > 6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dronekit_la_log171.bin", "sample_px4_events.ulg", "uavlogviewer_vtol.tlog"])
def test_real_logs_damaged_at_random_are_read_or_refused(shared_data: Path, tmp_path: Path, name: str) -> None:
    content = (shared_data / "logs" / name).read_bytes()
    rng = np.random.default_rng(7)
    for _ in range(5):
        start_s = time.process_time()
        with pytest.raises(InputError, match=r"."):
            read_log(written(tmp_path, name, write.damaged(content, rng)), SITE)  # they are all of other sites
        assert time.process_time() - start_s < LONGEST_S


def test_a_ulog_on_which_pyulog_never_ends_is_refused(tmp_path: Path) -> None:
    # Damage whose length leads from the end of the file back to the start of the record before it.
    last = write.ulog_message("F", b"battery_status:uint64_t timestamp;float remaining;")
    tail = bytes(5)
    damage = struct.pack("<HB", len(last) + 1 + len(tail), 0) + tail
    endless = b"ULog\x01\x12\x35\x01" + bytes(8) + write.ulog_message("B", bytes(40)) + last + damage
    start_s = time.process_time()
    with pytest.raises(InputError, match="damaged beyond reading"):
        read_log(written(tmp_path, "endless.ulg", endless), SITE)
    assert time.process_time() - start_s < LONGEST_S


def test_a_record_length_of_zero_does_not_stop_the_reader(tmp_path: Path) -> None:
    zero = bytes([0xA3, 0x95, 128]) + struct.pack(
        "<BB4s16s64s", 10, 0, b"POS", b"QLLff", b"TimeUS,Lat,Lng,Alt,RelHomeAlt"
    )
    content = write.dataflash(FLOWN, SITE)
    flights = read_log(written(tmp_path, "zero.BIN", content + zero + content[-500:]), SITE)
    assert len(flights.records[0].photos) == 6


@pytest.mark.slow
def test_a_log_of_nothing_but_starts_of_frames_is_refused_at_once(tmp_path: Path) -> None:
    content = write.tlog(FLOWN, SITE)[:200] + (bytes(8) + b"\xfd") * 300_000
    start_s = time.process_time()
    with pytest.raises(InputError):
        read_log(written(tmp_path, "fd.tlog", content), SITE)
    assert time.process_time() - start_s < 4.0 * LONGEST_S


def test_what_is_lost_is_counted(tmp_path: Path) -> None:
    frames = tlog_records(write.tlog(FLOWN, SITE))
    frames.insert(50, bytes(777))
    flights = read_log(written(tmp_path, "zeros.tlog", b"".join(frames)), SITE)
    (finding,) = flights.findings
    assert (finding.code, finding.value) == ("log-damaged", 777)
    assert len(flights.records[0].photos) == 6


def test_a_log_that_ends_in_a_record_keeps_what_came_before(tmp_path: Path) -> None:
    for name in ("feedback.tlog", "flight.BIN", "flight.ulg"):
        content = LOGS[name](FLOWN, SITE)
        (record,) = read_log(written(tmp_path, name, content[: int(0.55 * len(content)) + 3]), SITE).records
        assert record.duration_s is None
        assert 0 < len(record.photos) < 6


def test_absurd_sizes_are_refused_before_reading(tmp_path: Path) -> None:
    path = tmp_path / "huge.BIN"
    with path.open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(InputError, match="more than 512 MiB"):
        read_log(path, SITE)
