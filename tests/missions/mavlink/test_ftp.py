"""Logs over MAVFTP: one test for each way in which a link or a vehicle can misbehave, against the simulated server."""

from __future__ import annotations

import heapq
import itertools
import math
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.ftp import (
    MAX_DATA,
    FileRead,
    FolderEntry,
    FolderList,
    FtpError,
    FtpFrame,
    Opcode,
    Pieces,
    ReadState,
    file_checksum,
    frame_of,
)
from missions.mavlink.messages import Address, FileTransferProtocol, Message, Received
from missions.mavlink.transfer.exchange import Ending, Route
from missions.mavlink.wire import Decoder, Encoder
from missions.simulator.autopilot.file_server import FileServer

OWN, VEHICLE = Address(255, 190), Address(1, 1)
ROUTE = Route(OWN, VEHICLE)
PATH = "/APM/LOGS/00000001.BIN"
STEP_S, DELAY_S = 0.02, 0.03

Fault = Callable[[bool, FtpFrame, int], Sequence[tuple[float, FtpFrame]]]
"""From whether it goes up, a frame and its number that way: what arrives, and how much later than usual."""


def content(size: int) -> bytes:
    return np.random.default_rng(size).bytes(size)


def nothing_wrong(_is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
    return [(0.0, frame)]


@dataclass
class FtpAir:
    """A server, and a link with delay that does to frames what `fault` says."""

    server: FileServer
    fault: Fault = nothing_wrong
    now_s: float = 0.0
    passed: list[tuple[bool, FtpFrame]] = field(default_factory=list)
    _queue: list[tuple[float, int, bool, FtpFrame]] = field(default_factory=list)
    _order: itertools.count[int] = field(default_factory=itertools.count)
    _n: dict[bool, itertools.count[int]] = field(
        default_factory=lambda: {True: itertools.count(), False: itertools.count()}
    )

    def put(self, is_up: bool, messages: Sequence[Message]) -> None:
        for message in messages:
            assert isinstance(message, FileTransferProtocol)
            frame = frame_of(message)
            assert frame is not None
            self.passed.append((is_up, frame))
            for later_s, arrives in self.fault(is_up, frame, next(self._n[is_up])):
                heapq.heappush(self._queue, (self.now_s + DELAY_S + later_s, next(self._order), is_up, arrives))

    def run(self, machine: FileRead | FolderList, most_s: float = 600.0) -> None:
        self.put(True, machine.start(self.now_s))
        while machine.outcome is None:
            self.now_s += STEP_S
            assert self.now_s < most_s, "it never ended"
            while self._queue and self._queue[0][0] <= self.now_s:
                _, _, is_up, frame = heapq.heappop(self._queue)
                to = VEHICLE if is_up else OWN
                message = FileTransferProtocol(to.system, to.component, frame.payload())
                if is_up:
                    self.put(False, self.server.receive(message, OWN))
                else:
                    self.put(True, machine.receive(Received(message, VEHICLE, self.now_s)))
            self.put(False, self.server.tick())
            if machine.outcome is None:
                self.put(True, machine.tick(self.now_s))

    def asked(self, opcode: Opcode) -> int:
        return sum(is_up and frame.opcode == opcode for is_up, frame in self.passed)


def read(size: int = 20_000, fault: Fault = nothing_wrong, server: FileServer | None = None) -> tuple[FileRead, FtpAir]:
    air = FtpAir(server or FileServer(lambda: {PATH: content(size)}), fault)
    machine = FileRead(ROUTE, PATH)
    air.run(machine)
    return machine, air


def test_a_file_comes_in_bursts_and_is_proved_and_closed() -> None:
    machine, air = read(100_000)
    assert machine.outcome is not None
    assert machine.outcome.ending is Ending.DONE
    assert machine.outcome.content == content(100_000)
    assert machine.outcome.is_checked
    assert [air.asked(each) for each in (Opcode.OPEN, Opcode.BURST, Opcode.READ, Opcode.CRC)] == [1, 5, 0, 1]
    assert machine.state is ReadState.ENDED
    assert machine.tick(1e9) == []
    # The session was given back: another file can be opened at once.
    air.now_s += 1.0
    again = FileRead(ROUTE, PATH, machine.number)
    air.run(again)
    assert air.asked(Opcode.RESET) == 0


@pytest.mark.parametrize("size", [0, 1, MAX_DATA - 1, MAX_DATA, MAX_DATA + 1, 100 * MAX_DATA])
def test_files_of_every_length_come_whole(size: int) -> None:
    machine, _ = read(size)
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (content(size), True)


@pytest.mark.parametrize("loss", [0.05, pytest.param(0.3, marks=pytest.mark.slow)])
def test_what_is_lost_either_way_is_asked_for_again(loss: float) -> None:
    rng = np.random.default_rng(7)

    def lossy(_is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        return [] if rng.random() < loss else [(0.0, frame)]

    machine, air = read(60_000, lossy)
    assert machine.outcome is not None
    assert machine.outcome.content == content(60_000)
    assert air.asked(Opcode.READ) > 0


@pytest.mark.parametrize("opcode", [Opcode.OPEN, Opcode.BURST, Opcode.READ, Opcode.CRC])
@pytest.mark.parametrize("is_up", [True, False])
def test_each_question_and_each_answer_may_be_the_one_that_is_lost(opcode: Opcode, is_up: bool) -> None:
    lost: list[int] = []

    def lose_first(up: bool, frame: FtpFrame, n: int) -> Sequence[tuple[float, FtpFrame]]:
        is_it = up is is_up and (frame.opcode if up else frame.request) == opcode
        # A hole in the middle has the client ask for single pieces, too.
        is_hole = not up and frame.request == Opcode.BURST and frame.offset == 10 * MAX_DATA and opcode == Opcode.READ
        if (is_it and not lost) or is_hole:
            lost.extend([n] if is_it else [])
            return []
        return [(0.0, frame)]

    machine, _ = read(10_000, lose_first)
    assert lost
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (content(10_000), True)


def test_copies_and_frames_out_of_order_do_no_harm() -> None:
    rng = np.random.default_rng(3)

    def shuffled(_is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        return [(float(later_s), frame) for later_s in rng.exponential(0.05, rng.integers(1, 3))]

    machine, _ = read(50_000, shuffled)
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (content(50_000), True)


def test_late_pieces_of_the_file_before_are_not_taken_for_this_one() -> None:
    machine = FileRead(ROUTE, PATH, 500)
    machine.start(0.0)
    opened = FtpFrame(502, 7, Opcode.ACK, 4, Opcode.OPEN, data=(1000).to_bytes(4, "little"))
    machine.receive(told(opened))
    assert machine.state is ReadState.READING
    late = FtpFrame(498, 7, Opcode.ACK, 100, Opcode.BURST, data=b"x" * 100)
    other = FtpFrame(503, 6, Opcode.ACK, 100, Opcode.BURST, data=b"x" * 100)
    assert machine.receive(told(late)) == machine.receive(told(other)) == []
    assert machine.progress[1] == 0
    machine.receive(told(replace(other, session=7)))
    assert machine.progress[1] == 100


def told(frame: FtpFrame, source: Address = VEHICLE, target: Address = OWN) -> Received:
    return Received(FileTransferProtocol(target.system, target.component, frame.payload()), source, 0.0)


def test_answers_of_others_and_to_others_are_none_of_ours() -> None:
    machine = FileRead(ROUTE, PATH)
    machine.start(0.0)
    opened = FtpFrame(2, 1, Opcode.ACK, 4, Opcode.OPEN, data=bytes(4))
    assert machine.receive(told(opened, Address(2, 1))) == []
    assert machine.receive(told(opened, VEHICLE, Address(254, 1))) == []
    assert machine.receive(told(replace(opened, number=1))) == []
    assert machine.state is ReadState.OPENING
    machine.receive(told(opened, VEHICLE, Address(0, 0)))
    assert machine.state is ReadState.CHECKING


@pytest.mark.parametrize("code", [1, 2, 8, 9, 10, 77])
def test_a_refusal_ends_it_with_its_code(code: int) -> None:
    machine = FileRead(ROUTE, PATH)
    machine.start(0.0)
    machine.receive(told(FtpFrame(2, 0, Opcode.NAK, 1, Opcode.OPEN, data=bytes([code]))))
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.error) == (Ending.REFUSED, code)


def test_a_file_that_is_not_there_is_refused_by_the_server() -> None:
    air = FtpAir(FileServer(dict))
    machine = FileRead(ROUTE, "/nothing")
    air.run(machine)
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.error) == (Ending.REFUSED, FtpError.FAIL_ERRNO)


def test_a_session_that_somebody_forgot_is_reset_once() -> None:
    server = FileServer(lambda: {PATH: content(5000)})
    server.receive(FileTransferProtocol(1, 1, FtpFrame(900, 0, Opcode.OPEN, 22, data=PATH.encode()).payload()), OWN)
    machine, air = read(5000, server=server)
    assert machine.outcome is not None
    assert machine.outcome.content == content(5000)
    assert air.asked(Opcode.RESET) == 1


def test_a_vehicle_that_never_has_a_session_ends_it() -> None:
    def busy(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        if not is_up and frame.request == Opcode.OPEN:
            return [(0.0, replace(frame, opcode=Opcode.NAK, size=1, data=bytes([FtpError.NO_SESSIONS])))]
        return [(0.0, frame)]

    machine, air = read(1000, busy)
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.error) == (Ending.REFUSED, FtpError.NO_SESSIONS)
    assert air.asked(Opcode.OPEN) == 2


def test_a_restart_in_the_middle_keeps_what_came() -> None:
    server = FileServer(lambda: {PATH: content(60_000)})
    restarted: list[float] = []

    def restart(is_up: bool, frame: FtpFrame, n: int) -> Sequence[tuple[float, FtpFrame]]:
        if not is_up and n == 130 and not restarted:
            restarted.append(n)
            server.forget()
        return [(0.0, frame)]

    machine, air = read(60_000, restart, server)
    assert restarted
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (content(60_000), True)
    assert air.asked(Opcode.OPEN) == 2
    n_pieces = sum(not up and each.request == Opcode.BURST and each.size > 1 for up, each in air.passed)
    assert n_pieces < 1.2 * 60_000 / MAX_DATA


def test_a_vehicle_that_restarts_for_ever_ends_it() -> None:
    def never(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        if not is_up and frame.request == Opcode.BURST:
            return [(0.0, replace(frame, opcode=Opcode.NAK, size=1, data=bytes([FtpError.INVALID_SESSION])))]
        return [(0.0, frame)]

    server = FileServer(lambda: {PATH: content(1000)})
    machine, _ = read(1000, never, server)
    assert machine.outcome is not None
    assert machine.outcome.ending in (Ending.STALLED, Ending.REFUSED)


def test_without_bursts_it_is_read_piece_by_piece() -> None:
    def no_bursts(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        if is_up and frame.opcode == Opcode.BURST:
            return [(0.0, replace(frame, opcode=77))]
        return [(0.0, replace(frame, request=Opcode.BURST) if frame.request == 77 else frame)]

    machine, air = read(10_000, no_bursts)
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (content(10_000), True)
    assert air.asked(Opcode.READ) == math.ceil(10_000 / MAX_DATA)


def test_without_checksums_it_is_done_and_not_proved() -> None:
    def no_checksums(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        if not is_up and frame.request == Opcode.CRC:
            return [(0.0, replace(frame, opcode=Opcode.NAK, size=1, data=bytes([FtpError.UNKNOWN_COMMAND])))]
        return [(0.0, frame)]

    machine, _ = read(1000, no_checksums)
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.is_checked) == (Ending.DONE, False)


@pytest.mark.parametrize("n_damaged", [1, 10**9])
def test_a_piece_that_was_changed_is_found_by_the_checksum(n_damaged: int) -> None:
    """MAVLink's own checksum of 16 bits lets one damaged frame in 65536 through."""
    damaged = itertools.count()

    def damage(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        is_piece = not is_up and frame.request == Opcode.BURST and frame.offset == 5 * MAX_DATA and frame.size > 1
        if is_piece and next(damaged) < n_damaged:
            return [(0.0, replace(frame, data=b"#" * frame.size))]
        return [(0.0, frame)]

    machine, _ = read(5000, damage)
    assert machine.outcome is not None
    if n_damaged == 1:
        assert (machine.outcome.content, machine.outcome.is_checked) == (content(5000), True)
    else:
        assert (machine.outcome.ending, machine.outcome.differs, machine.outcome.content) == (
            Ending.OUT_OF_STEP,
            True,
            b"",
        )


def test_a_log_that_still_grows_is_read_to_its_end() -> None:
    whole, seen = content(30_000), itertools.count()
    server = FileServer(lambda: {PATH: whole[: 20_000 if next(seen) == 0 else 30_000]})
    machine, air = read(server=server)
    assert machine.outcome is not None
    assert (machine.outcome.content, machine.outcome.is_checked) == (whole, True)
    assert air.asked(Opcode.OPEN) == 2


def test_a_file_that_is_shorter_than_it_says_ends_it() -> None:
    def longer(is_up: bool, frame: FtpFrame, _n: int) -> Sequence[tuple[float, FtpFrame]]:
        if not is_up and frame.request == Opcode.OPEN:
            return [(0.0, replace(frame, data=(9000).to_bytes(4, "little")))]
        return [(0.0, frame)]

    machine, air = read(5000, longer)
    assert machine.outcome is not None
    assert machine.outcome.ending is Ending.OUT_OF_STEP
    assert air.now_s < 30.0


def test_a_file_larger_than_any_log_is_refused_before_it_comes() -> None:
    machine = FileRead(ROUTE, PATH)
    machine.start(0.0)
    huge = (2**32 - 1).to_bytes(4, "little")
    machine.receive(told(FtpFrame(2, 1, Opcode.ACK, 4, Opcode.OPEN, data=huge)))
    assert machine.outcome is not None
    assert machine.outcome.error == FtpError.INVALID_DATA_SIZE


def test_silence_ends_it() -> None:
    machine, air = read(1000, lambda _up, _frame, _n: [])
    assert machine.outcome is not None
    assert machine.outcome.ending is Ending.SILENT
    assert 15.0 <= air.now_s < 40.0


def test_silence_in_the_middle_ends_it_too() -> None:
    machine, _ = read(60_000, lambda up, frame, n: [(0.0, frame)] if up or n < 40 else [])
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.content) == (Ending.SILENT, b"")


def test_giving_up_gives_the_session_back() -> None:
    machine = FileRead(ROUTE, PATH)
    assert machine.cancel() == []
    machine.start(0.0)
    machine.receive(told(FtpFrame(2, 9, Opcode.ACK, 4, Opcode.OPEN, data=(1000).to_bytes(4, "little"))))
    (closing,) = machine.cancel()
    assert isinstance(closing, FileTransferProtocol)
    frame = frame_of(closing)
    assert frame is not None
    assert (frame.opcode, frame.session) == (Opcode.TERMINATE, 9)


# Lists


def listed(files: dict[str, bytes], fault: Fault = nothing_wrong, path: str = "/logs") -> FolderList:
    machine = FolderList(ROUTE, path)
    FtpAir(FileServer(lambda: files), fault).run(machine)
    return machine


def test_a_long_folder_is_listed_in_pieces() -> None:
    files = {f"/logs/{n:08d}.BIN": bytes(n) for n in range(60)} | {"/logs/old/1.BIN": b"", "/other/x": b""}
    for fault in (nothing_wrong, lambda _up, frame, n: [] if n % 3 == 1 else [(0.0, frame)]):
        machine = listed(files, fault)
        assert machine.outcome is not None
        assert machine.outcome.ending is Ending.DONE
        wanted = [FolderEntry("old", None), *(FolderEntry(f"{n:08d}.BIN", n) for n in range(60))]
        assert list(machine.outcome.entries) == wanted


def test_a_folder_that_is_not_there_is_refused() -> None:
    machine = listed({})
    assert machine.outcome is not None
    assert (machine.outcome.ending, machine.outcome.error) == (Ending.REFUSED, FtpError.FAIL_ERRNO)


@pytest.mark.parametrize(
    "entry", [b"F../x\t3", b"F\t3", b"Fa/b\t3", b"Fa\\b\t3", b"Fa\t", b"Fa\t-1", b"Fa\tx", b"Fa\x07\t3", b"S", b"D..",
              b"Fa\t99999999999999999999", b"\xff\xfe"],
)  # fmt: skip
def test_names_that_lead_elsewhere_and_sizes_that_are_none_are_left_out(entry: bytes) -> None:
    machine = FolderList(ROUTE, "/logs")
    machine.start(0.0)
    data = entry + b"\0Fgood.BIN\t3\0"
    machine.receive(told(FtpFrame(2, 0, Opcode.ACK, len(data), Opcode.LIST, data=data)))
    machine.receive(told(FtpFrame(3, 0, Opcode.NAK, 1, Opcode.LIST, data=bytes([FtpError.END_OF_FILE]))))
    assert machine.outcome is not None
    assert machine.outcome.entries == (FolderEntry("good.BIN", 3),)


def test_entries_without_end_end_it() -> None:
    machine = FolderList(ROUTE, "/logs")
    sent, number = machine.start(0.0), 1
    while machine.outcome is None:
        data = b"Fa\t1\0" * 40
        sent = machine.receive(told(FtpFrame(number + 1, 0, Opcode.ACK, len(data), Opcode.LIST, data=data)))
        number += 1
        assert number < 1000
    assert sent == []
    assert machine.outcome.ending is Ending.OUT_OF_STEP


# Frames and pieces


def test_frames_are_those_of_pymavlink() -> None:
    from pymavlink.mavftp_op import FTP_OP

    frame = FtpFrame(300, 4, Opcode.READ, 80, 0, False, 70_000)
    theirs = FTP_OP(300, 4, Opcode.READ, 80, 0, False, 70_000, None).pack()
    assert bytes(frame.payload()[: len(theirs)]) == bytes(theirs)


@given(st.binary(max_size=300))
def test_checksums_are_the_reflected_polynomial_from_zero(data: bytes) -> None:
    """Bit by bit, as in the protocol's page: polynomial 0x04C11DB7 (reflected 0xEDB88320), from 0, not inverted."""
    register = 0
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register >> 1) ^ (0xEDB88320 if register & 1 else 0)
    assert file_checksum(data) == register
    assert file_checksum(b"") == 0
    assert file_checksum(b"123456789") != zlib.crc32(b"123456789")


@given(st.integers(0, 40), st.lists(st.tuples(st.integers(0, 45), st.binary(max_size=9)), max_size=30))
def test_pieces_are_kept_as_a_list_of_bytes_would(size: int, puts: list[tuple[int, bytes]]) -> None:
    pieces, there = Pieces(), [False] * size
    pieces.resize(size)
    for offset, data in puts:
        inside = range(offset, min(size, offset + len(data)))
        assert pieces.put(offset, data) == any(not there[place] for place in inside)
        for place in inside:
            there[place] = True
    assert pieces.n_missing == there.count(False)
    holes = {place for start, end in pieces.holes(1000) for place in range(start, end)}
    assert holes == {place for place in range(size) if not there[place]}
    assert pieces.holes(2) == pieces.holes(1000)[:2]


@given(st.lists(st.binary(min_size=12, max_size=251), max_size=30), st.integers(0, 3))
def test_nonsense_never_crashes_and_never_succeeds(payloads: list[bytes], n_right: int) -> None:
    machine: FileRead | FolderList
    for machine in (FileRead(ROUTE, PATH), FolderList(ROUTE, "/logs")):
        machine.start(0.0)
        for number, payload in enumerate(payloads):
            content_ = bytearray(payload.ljust(251, b"\0"))
            if number < n_right:
                # As near to right as nonsense can be.
                content_[0:2] = (machine.number + 1).to_bytes(2, "little")
                content_[3] = Opcode.ACK
                content_[5] = machine._question.opcode if machine._question else 0
            machine.receive(Received(FileTransferProtocol(255, 190, tuple(content_)), VEHICLE, 0.1 * number))
            machine.tick(0.1 * number)
        if machine.outcome is not None and machine.outcome.ending is Ending.DONE:
            assert not getattr(machine.outcome, "is_checked", False) or machine.outcome.content == b""


@given(st.binary(max_size=251))
def test_the_server_answers_nonsense_with_a_refusal_or_nothing(payload: bytes) -> None:
    server = FileServer(lambda: {PATH: content(1000)})
    message = FileTransferProtocol(1, 1, tuple(payload.ljust(251, b"\0")))
    for answer in [*server.receive(message, OWN), *server.tick()]:
        assert isinstance(answer, FileTransferProtocol)
        frame = frame_of(answer)
        assert frame is not None
        assert frame.opcode in (Opcode.ACK, Opcode.NAK)


def test_frames_travel_over_the_wire() -> None:
    message = FileTransferProtocol(1, 1, FtpFrame(5, 0, Opcode.OPEN, len(PATH), data=PATH.encode()).payload())
    (frame,) = Decoder().feed(Encoder(OWN).encode(message), 0.0)
    assert frame.received is not None
    assert frame.received.message == message
