"""The log protocol against the simulated vehicle's end of it, over air that loses, doubles and reorders."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.log_transfer import PIECE, WINDOW, LogEntries, LogRead
from missions.mavlink.messages import (
    Address,
    LogData,
    LogEntry,
    LogRequestData,
    LogRequestEnd,
    LogRequestList,
    Received,
)
from missions.mavlink.transfer.exchange import Ending, Route
from missions.simulator.autopilot.log_server import LogServer

OWN, VEHICLE = Address(255, 190), Address(1, 1)
ROUTE = Route(OWN, VEHICLE)
ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4


def server(*contents, autopilot=ARDUPILOT, busy=False):
    files = {f"{number:08d}": content for number, content in enumerate(contents, 1)}
    return LogServer(autopilot, lambda: files, 1_700_000_000.0, lambda: busy)


def run(machine, end, loss=0.0, seed=0, most=60_000, doubles=0.0, cut_s=np.inf):
    """Drive a machine against a server: each message is lost with a chance, each way; some come twice, or late."""
    rng, now_s, late = np.random.default_rng(seed), 0.0, []
    asked = []
    outgoing = machine.start(0.0)
    for _ in range(most):
        if machine.outcome is not None:
            return machine.outcome, asked, now_s
        asked += outgoing
        answers = [a for each in outgoing if rng.random() >= loss and now_s < cut_s for a in end.receive(each)]
        answers += end.tick()
        heard = [*late, *(a for a in answers if rng.random() >= loss and now_s < cut_s)]
        late = [a for a in heard if rng.random() < doubles]
        now_s += 0.02
        outgoing = [m for a in heard for m in machine.receive(Received(a, VEHICLE, now_s))]
        outgoing += machine.tick(now_s)
    raise AssertionError("it never ended")


def content(n, seed=1):
    return np.random.default_rng(seed).bytes(n)


@pytest.mark.parametrize("n", [0, 1, PIECE - 1, PIECE, PIECE + 1, WINDOW * PIECE, WINDOW * PIECE + 7, 200_000])
@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_log_comes_whole_whatever_its_size_and_the_air(n, loss):
    log = content(n)
    outcome, asked, _ = run(LogRead(ROUTE, 1, n), server(log), loss)
    assert (outcome.ending, outcome.content) == (Ending.DONE, log)
    if not loss and n:
        requests = [each for each in asked if isinstance(each, LogRequestData)]
        assert len(requests) == -(-n // (WINDOW * PIECE))


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 3000), st.floats(0.0, 0.6), st.floats(0.0, 0.4))
def test_lost_doubled_and_late_pieces_never_make_another_log(seed, n, loss, doubles):
    log = content(n, seed)
    outcome, _, _ = run(LogRead(ROUTE, 1, n), server(log), loss, seed, doubles=doubles)
    assert outcome.content == log[: len(outcome.content)]
    assert outcome.ending in (Ending.DONE, Ending.SILENT)
    assert outcome.ending is not Ending.DONE or outcome.content == log


def test_what_broke_off_goes_on_where_it_ended_and_only_for_the_same_log():
    log = content(400_000)
    broken, _, _ = run(LogRead(ROUTE, 1, len(log)), server(log), cut_s=2.5)
    assert broken.ending is Ending.SILENT
    assert 50_000 < len(broken.content) < len(log)
    assert log.startswith(broken.content)
    resumed, asked, _ = run(LogRead(ROUTE, 1, len(log), broken.content), server(log))
    assert resumed.content == log
    first = next(each for each in asked if isinstance(each, LogRequestData))
    assert first.ofs == len(broken.content) // PIECE * PIECE - PIECE
    other = content(400_000, 2)
    anew, asked, _ = run(LogRead(ROUTE, 1, len(other), broken.content), server(other))
    assert anew.content == other
    assert any(isinstance(each, LogRequestData) and each.ofs == 0 for each in asked)


def test_a_log_that_changes_or_is_shorter_than_listed_is_not_kept():
    log = content(5000)
    machine = LogRead(ROUTE, 1, len(log))
    machine.start(0.0)
    piece = LogData(1, 0, PIECE, tuple(log[:PIECE]))
    machine.receive(Received(piece, VEHICLE, 0.1))
    machine.receive(Received(LogData(1, 0, PIECE, tuple(PIECE * b"x")), VEHICLE, 0.2))
    assert machine.outcome.differs
    assert machine.outcome.content == b""
    outcome, _, _ = run(LogRead(ROUTE, 1, 6000), server(log))
    assert outcome.is_shorter
    assert log.startswith(outcome.content)


def test_pieces_of_another_log_or_another_vehicle_and_nonsense_are_left():
    log = content(300)
    machine = LogRead(ROUTE, 1, len(log))
    machine.start(0.0)
    bad = tuple(PIECE * b"!")
    for message, source in (
        (LogData(2, 0, PIECE, bad), VEHICLE),
        (LogData(1, 0, PIECE, bad), Address(2, 1)),
        (LogData(1, 7, PIECE, bad), VEHICLE),
        (LogData(1, 270, PIECE, bad), VEHICLE),
        (LogData(1, 0, 200, bad), VEHICLE),
        (LogData(1, 90 * 10**7, PIECE, bad), VEHICLE),
    ):
        assert machine.receive(Received(message, source, 0.1)) == []
    assert machine.outcome is None
    assert run(machine_after(machine), server(log))[0].content == log


def machine_after(machine):
    """Its first window again."""
    machine.start = lambda now_s: [LogRequestData(1, 1, 1, 0, 300)]
    return machine


def test_nobody_who_answers_ends_in_time_and_cancelling_lets_the_vehicle_stop():
    outcome, _, now_s = run(LogRead(ROUTE, 1, 500), server(content(500)), loss=1.0)
    assert (outcome.ending, outcome.content) == (Ending.SILENT, b"")
    assert 20.0 < now_s < 22.0
    assert LogRead(ROUTE, 1, 500).cancel() == [LogRequestEnd(1, 1)]


@pytest.mark.parametrize("autopilot", Autopilot)
@pytest.mark.parametrize("loss", [0.0, 0.5])
def test_entries_are_asked_for_again_until_all_are_there(autopilot, loss):
    logs = [content(n) for n in range(1, 40)]
    outcome, asked, _ = run(LogEntries(ROUTE), server(*logs, autopilot=autopilot), loss, seed=3)
    assert outcome.ending is Ending.DONE
    first = 1 if autopilot is ARDUPILOT else 0
    assert [(each.id, each.size) for each in outcome.entries] == [(first + n, n + 1) for n in range(39)]
    if loss:
        assert any(isinstance(each, LogRequestList) and each.start > first for each in asked)


def test_no_logs_and_no_answer_are_two_things():
    assert run(LogEntries(ROUTE), server())[0] == run(LogEntries(ROUTE), server())[0]
    assert run(LogEntries(ROUTE), server())[0].ending is Ending.DONE
    assert run(LogEntries(ROUTE), server(b"x", busy=True))[0].ending is Ending.SILENT


def test_a_vehicle_that_repeats_one_entry_for_ever_is_given_up():
    class Parrot:
        def receive(self, message):
            return []

        def tick(self):
            return [LogEntry(3, 9, 9, 0, 5)]

    outcome, _, now_s = run(LogEntries(ROUTE), Parrot())
    assert (outcome.ending, outcome.entries) == (Ending.STALLED, ())
    assert 60.0 < now_s < 63.0
