"""A process beside the window's, and the channel to it: messages, pickled, both ways.

A thread is not enough for long work: what it does between its kernels (NumPy's sorting, loading compiled code, SciPy)
holds Python's interpreter, and the window stood still for up to 80 ms. A process holds nothing of the window's; its end
by lack of memory is an error message instead of the window's end.

It is a plain child, `python -m` this module with the name of the module that works, and it talks through its standard
input and output: `multiprocessing` would import the program's main file once more, whatever that does. What is sent are
frozen records, and functions by their names. Where the window goes, the pipe closes, and the process ends.
"""

from __future__ import annotations

import importlib
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import IO, Any, Protocol

from planning.base.plugins import with_plugin_named

NICENESS = 10
"""Half of the way to the least urgent: the window's own threads run first when both want a processor."""

BROKEN_PIPE = (EOFError, OSError, ValueError, pickle.UnpicklingError)
"""What reading a pipe raises after its end, or when the other side died within a message."""

Listener = Callable[[Any], None]


@dataclass(frozen=True, slots=True)
class ProcessEnded:
    """The last message of a process: it has ended; `status` as the system has it."""

    status: int

    @property
    def is_killed(self) -> bool:
        """Whether the system ended it, which it mostly does because memory ran out."""
        return sys.platform != "win32" and self.status == -signal.SIGKILL


class Process:
    """A process as this side sees it, from its start to its end.

    Parameters
    ----------
    module
        By its name only, as it may load what this side must not. It has `service`, as `Service` says.
    listener
        Called with every message that comes, on a thread that reads them; with `ProcessEnded` as the last one.
    niceness
        By which it leaves the processor to others; not on Windows.
    """

    def __init__(self, module: str, listener: Listener, niceness: int = NICENESS) -> None:
        paths = os.pathsep.join(path for path in sys.path if path)
        self._child = subprocess.Popen(
            [sys.executable, "-m", __name__, module, str(niceness)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": paths},
        )
        self._listener = listener
        self._reader = threading.Thread(target=self._read, name=f"read-{module.rpartition('.')[2]}", daemon=True)
        self._reader.start()

    @property
    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._child.poll() is None

    def send(self, message: Any) -> bool:
        """Send a message; whether the process still reads. A message that cannot be pickled sends nothing."""
        assert self._child.stdin is not None
        pickled = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
        try:
            self._child.stdin.write(pickled)
            self._child.stdin.flush()
        except (OSError, ValueError):  # it has ended, or was let go
            return False
        return True

    def close_input(self) -> None:
        """Send nothing more: the process hears that this side has gone, and ends by itself."""
        assert self._child.stdin is not None
        with suppress(OSError):
            self._child.stdin.close()

    def end(self) -> None:
        """End it, whatever it does, and wait for that. `ProcessEnded` has been told then."""
        if not self._reader.is_alive():
            with suppress(subprocess.TimeoutExpired):  # it is about to end by itself, with a status of its own
                self._child.wait(1.0)
        self._child.kill()
        self._child.wait()
        self._reader.join()
        self.close_input()

    def _read(self) -> None:
        assert self._child.stdout is not None
        with suppress(*BROKEN_PIPE):
            while True:
                self._listener(pickle.load(self._child.stdout))
        status = self._child.wait()
        self._child.stdout.close()
        self._listener(ProcessEnded(status))


class Service(Protocol):
    """What the other side does: the result of its module's `service(send)`, where `send` takes messages."""

    def take(self, message: Any) -> None:
        """Take a message; called by a thread that reads, while `run` works."""

    def gone(self) -> float:
        """Hear that nobody listens any more; returns seconds that the work is given to end, before it is ended."""

    def run(self) -> None:
        """Work, on the main thread."""


Send = Callable[[Any], None]


def sendable(error: BaseException) -> BaseException:
    """An error as it comes through a pipe; one that does not is told in words."""
    error = with_plugin_named(error)
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def serve(module: str, niceness: int) -> None:
    """What the process does: messages have its standard output for themselves, all else goes to the error output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides what Ctrl+C ends
    if sys.platform != "win32":
        os.nice(niceness)
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    writing = threading.Lock()

    def send(message: Any) -> None:
        pickled = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)  # whole, before the first byte is written
        # Where the window has gone, the thread that reads has noticed, or will.
        with writing, suppress(OSError):
            out.write(pickled)
            out.flush()

    service = importlib.import_module(module).service(send)
    threading.Thread(target=_read_orders, args=(sys.stdin.buffer, service), name="read-orders", daemon=True).start()
    service.run()


def _read_orders(source: IO[bytes], service: Service) -> None:
    """Read until the other side closes the pipe; the process then ends, whatever it does."""
    with suppress(*BROKEN_PIPE):
        while True:
            service.take(pickle.load(source))
    time.sleep(service.gone())
    os._exit(0)


if __name__ == "__main__":
    # By its full name, so that what is pickled here has the same classes over there.
    from groundstation.services.jobs.channel import serve as serve_by_name

    serve_by_name(sys.argv[1], int(sys.argv[2]))
