"""The telemetry log: readable by others, whole after a crash, and no danger to a flight."""

import struct
import subprocess
import sys

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega

from groundstation.vehicle.recorder import RETRY_S, TelemetryLog, new_log_path
from planning.base.errors import InputError

NOON_S = 1_800_000_000.25


def frames(n):
    mavlink = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    made = []
    for i in range(n):
        message = mavlink.attitude_encode(1000 * i, 0.0, 0.0, 0.25 * i, 0.0, 0.0, 0.0)
        made.append(bytes(message.pack(mavlink)))
    return made


def read_by_pymavlink(path):
    reader = mavutil.mavlink_connection(str(path))
    messages = []
    while (message := reader.recv_match(type="ATTITUDE")) is not None:
        messages.append((message._timestamp, message.yaw))
    reader.close()
    return messages


@pytest.mark.slow
def test_pymavlink_reads_what_is_written(tmp_path):
    log = TelemetryLog(tmp_path / "a.tlog")
    for i, frame in enumerate(frames(5)):
        log.write(frame, NOON_S + i)
    log.close()
    assert read_by_pymavlink(log.path) == [(pytest.approx(NOON_S + i, abs=1e-5), 0.25 * i) for i in range(5)]


@pytest.mark.long
def test_every_frame_is_on_its_way_to_the_disk_before_the_program_can_crash(tmp_path):
    program = (
        "import os, sys; from pathlib import Path\n"
        "from groundstation.vehicle.recorder import TelemetryLog\n"
        "log = TelemetryLog(Path(sys.argv[1]))\n"
        "for frame in sys.argv[2:]: log.write(bytes.fromhex(frame), 1.8e9)\n"
        "os.kill(os.getpid(), 9)\n"
    )
    path = tmp_path / "crash.tlog"
    arguments = [sys.executable, "-c", program, str(path), *(frame.hex() for frame in frames(3))]
    assert subprocess.run(arguments, check=False).returncode == -9
    assert len(read_by_pymavlink(path)) == 3


def test_a_log_is_never_written_over(tmp_path):
    TelemetryLog(tmp_path / "a.tlog").close()
    with pytest.raises(InputError, match="exists already"):
        TelemetryLog(tmp_path / "a.tlog")


def test_a_log_that_cannot_be_made_says_why(tmp_path):
    with pytest.raises(InputError, match="cannot be made"):
        TelemetryLog(tmp_path / "none" / "a.tlog")


class Disk:
    """A file whose disk has room for so many bytes."""

    def __init__(self, file, room):
        self.file, self.room = file, room

    def write(self, content):
        part = content[: self.room]
        if not part:
            raise OSError(28, "No space left on device")
        self.room -= len(part)
        return self.file.write(part)

    def __getattr__(self, name):
        return getattr(self.file, name)


@pytest.mark.parametrize("room", [0, 10])
def test_a_full_disk_is_survived_and_the_log_goes_on_where_it_was_whole(tmp_path, room):
    log = TelemetryLog(tmp_path / "a.tlog")
    log.write(frames(1)[0], NOON_S)
    disk = log._file = Disk(log._file, room)
    log.write(frames(2)[1], NOON_S + 1.0)
    assert "cannot be written" in log.problem
    disk.room = 10_000
    log.write(frames(2)[1], NOON_S + 2.0)
    assert log.problem, "it is not tried again at once"
    log.write(frames(3)[2], NOON_S + 1.0 + RETRY_S)
    assert (log.problem, log.n_lost) == ("", 2)
    log.close()
    assert [yaw for _, yaw in read_by_pymavlink(log.path)] == [0.0, 0.5]


def test_a_frame_that_was_cut_off_is_taken_away_at_the_end(tmp_path):
    log = TelemetryLog(tmp_path / "a.tlog")
    log.write(frames(1)[0], NOON_S)
    log._file = Disk(log._file, 10)
    log.write(frames(1)[0], NOON_S)
    log.close()
    log.close()
    assert log.path.stat().st_size == 8 + len(frames(1)[0])


def test_after_closing_nothing_is_written(tmp_path):
    log = TelemetryLog(tmp_path / "a.tlog")
    log.close()
    log.write(b"\xfd", NOON_S)
    assert log.path.read_bytes() == b""


def test_time_stands_before_each_frame_in_microseconds(tmp_path):
    log = TelemetryLog(tmp_path / "a.tlog")
    log.write(b"frame", NOON_S)
    log.close()
    assert log.path.read_bytes() == struct.pack(">Q", 1_800_000_000_250_000) + b"frame"


def test_logs_of_the_same_second_have_names_of_their_own(tmp_path):
    folder = tmp_path / "flights"
    first = new_log_path(folder, 1_800_000_000.0)
    assert first.name == "flight-2027-01-15T08-00-00Z.tlog"
    TelemetryLog(first).close()
    assert new_log_path(folder, 1_800_000_000.9).name == "flight-2027-01-15T08-00-00Z-2.tlog"


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        new_log_path(tmp_path / "file", 0.0)
