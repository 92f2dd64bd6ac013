"""The channel to a process: messages both ways, and either side may end at any time."""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from groundstation.services.jobs.channel import Process, ProcessEnded

PARENT = f"""
import sys
from groundstation.services.jobs.channel import Process
process = Process({__name__!r}, lambda message: print(message, flush=True))
process.send(("note", sys.argv[1]))
process.send("noted")
sys.stdin.read()
"""


class Echo:
    """Sends back what it is sent; notes in a file that it was left alone."""

    def __init__(self, send: Any) -> None:
        self._send = send
        self._orders: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._note: Path | None = None

    def take(self, message: Any) -> None:
        self._orders.put(message)

    def gone(self) -> float:
        if self._note is not None:
            self._note.write_text(f"{os.getpid()} has gone")
        return 0.0

    def run(self) -> None:
        while True:
            match self._orders.get():
                case "niceness":
                    self._send(os.nice(0))
                case ("note", path):
                    self._note = Path(path)
                case ("return", status):
                    os._exit(status)
                case message:
                    self._send(message)


service = Echo


@pytest.fixture
def heard() -> queue.SimpleQueue[Any]:
    return queue.SimpleQueue()


def test_messages_come_back_in_their_order_until_the_process_ends_with_its_status(heard) -> None:
    process = Process(__name__, heard.put)
    for message in (1, b"x" * 300_000, None):
        assert process.send(message)
    assert process.send(("return", 7))
    assert [heard.get(timeout=60.0) for _ in range(4)] == [1, b"x" * 300_000, None, ProcessEnded(7)]
    assert not process.is_running
    assert not process.send("nobody reads this")
    process.end()


def test_what_cannot_be_pickled_is_the_callers_error_and_costs_no_other_message(heard) -> None:
    process = Process(__name__, heard.put)
    with pytest.raises((AttributeError, TypeError, pickle.PicklingError)):
        process.send(lambda: None)
    process.send("well")
    assert heard.get(timeout=60.0) == "well"
    process.end()
    assert heard.get(timeout=60.0).is_killed == (sys.platform != "win32")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no niceness")
def test_a_process_is_as_nice_as_it_is_asked_to_be(heard) -> None:
    process = Process(__name__, heard.put, niceness=5)
    process.send("niceness")
    assert heard.get(timeout=60.0) == min(19, os.nice(0) + 5)
    process.close_input()
    assert heard.get(timeout=60.0) == ProcessEnded(0), "who is let go ends by itself"


def test_a_process_ends_with_the_one_that_started_it(tmp_path) -> None:
    note = tmp_path / "note"
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    parent = subprocess.Popen([sys.executable, "-c", PARENT, str(note)], text=True, **pipes)
    assert parent.stdout is not None
    assert parent.stdout.readline() == "noted\n"
    parent.kill()
    # The process shares its parent's error output, which is closed when both have ended.
    parent.communicate(timeout=60.0)
    assert note.read_text().endswith("has gone")
