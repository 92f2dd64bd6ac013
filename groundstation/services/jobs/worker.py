"""A process beside the window's, in which planning runs.

A thread is not enough: what it does between its kernels (NumPy's sorting, loading compiled code, SciPy) holds Python's
interpreter, and the window stood still for up to 80 ms. A process holds nothing of the window's, its end by lack of
memory is an error message instead of the window's end, and closing the window ends it at once.

What is sent to it and back is pickled: functions of modules, and records (a planned tower of 3640 panels is 6 MB).
Progress, quality and bounds come back while it works; stopping and cancelling go the other way. It is a plain child
that reads its standard input: `multiprocessing` would import the program's main file once more, whatever that does.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum, auto
from typing import IO, Any, TypeVar

from planning.base.errors import GroundStationError, OperationCancelled
from planning.base.progress import QUIET, Monitor, QualityPoint, Stop, Trace, never

Result = TypeVar("Result")

POLL_S = 0.05
"""How often stopping and cancelling are looked for."""

REPORT_S = 0.05
"""Shortest time between two reports of one stage."""

GRACE_S = 5.0
"""What a cancelled process is given to notice; then it is ended."""

NICENESS = 10
"""Half of the way to the least urgent: the window's own threads run first when both want a processor."""


@dataclass(frozen=True, slots=True)
class _Call:
    function: Callable[..., Any]
    arguments: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class _Report:
    stage: str
    done: float
    total: float


@dataclass(frozen=True, slots=True)
class _Improved:
    value: float


@dataclass(frozen=True, slots=True)
class _Bounded:
    bound: float


@dataclass(frozen=True, slots=True)
class _Ended:
    result: Any = None
    error: BaseException | None = None


class _Wish(Enum):
    LOAD = auto()
    STOP = auto()
    CANCEL = auto()


class _LostError(Exception):
    """The pipe is closed: the process has ended."""


class _Child:
    """The process, seen from here. What it sends is read by a thread, so that waiting for it can have an end."""

    def __init__(self) -> None:
        paths = os.pathsep.join(path for path in sys.path if path)
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": paths},
        )
        self._heard: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, name="read-worker", daemon=True)
        self._reader.start()

    def send(self, message: Any) -> None:
        """Send a message; raises `_LostError` where nobody reads it."""
        assert self._process.stdin is not None
        pickled = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
        try:
            self._process.stdin.write(pickled)
            self._process.stdin.flush()
        except OSError as error:
            raise _LostError from error

    def receive(self) -> Any:
        """Return the next message, None after `POLL_S` without one; raises `_LostError` after the last."""
        try:
            message = self._heard.get(timeout=POLL_S)
        except queue.Empty:
            return None
        if isinstance(message, _LostError):
            raise message
        return message

    def is_running(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    def end(self) -> int:
        """End it, whatever it does; returns its exit status."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(0.0 if self._reader.is_alive() else 1.0)
        self._process.kill()
        status = self._process.wait()
        self._reader.join()
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(OSError):
            self._process.stdin.close()
        self._process.stdout.close()
        return status

    def _read(self) -> None:
        assert self._process.stdout is not None
        try:
            while True:
                self._heard.put(pickle.load(self._process.stdout))
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            self._heard.put(_LostError())


class Worker:
    """Runs one function after the other in a process of its own, which starts with the first and stays.

    `run` blocks and may be called from any thread; a second call waits for the first.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._child: _Child | None = None
        self._is_closed = False

    def start(self) -> None:
        """Start the process and let it load what planning needs, so that the first plan need not wait for it."""
        with self._lock, suppress(_LostError):
            if not self._is_closed and self._child is None:
                self._running().send(_Wish.LOAD)

    def run(
        self,
        function: Callable[..., Result],
        *arguments: Any,
        stop: Stop = never,
        trace: Trace | None = None,
        monitor: Monitor = QUIET,
    ) -> Result:
        """Call `function(*arguments, stop=, trace=, monitor=)` over there and return what it returns.

        Raises
        ------
        OperationCancelled
            The monitor raised it, or the worker was closed. A process that does not notice in `GRACE_S` is ended.
        GroundStationError
            The process ended before the work did.
        BaseException
            Whatever the function raised.
        """
        with self._lock:
            try:
                child = self._running()
                child.send(_Call(function, arguments))
                ended = self._follow(child, stop, Trace() if trace is None else trace, monitor)
            except OperationCancelled:
                self._call_off()
                raise
            except _LostError as error:
                raise self._lost() from error
        if ended.error is not None:
            raise ended.error
        return ended.result  # type: ignore[no-any-return]

    def close(self) -> None:
        """End the process at once, whatever it does; it does not start again."""
        self._is_closed = True
        child = self._child
        if child is not None:
            child.end()

    def _running(self) -> _Child:
        if self._is_closed:
            raise OperationCancelled("the window is closing")
        if self._child is None or not self._child.is_running():
            self._child = _Child()
        return self._child

    def _follow(self, child: _Child, stop: Stop, trace: Trace, monitor: Monitor) -> _Ended:
        """Pass on what is heard until the end is."""
        latest, is_stopped = _Report("starting", 0, 0), False
        while True:
            if not is_stopped and stop():
                is_stopped = True
                child.send(_Wish.STOP)
            match child.receive():
                case _Report() as latest:
                    monitor.report(latest.stage, latest.done, latest.total)
                case _Improved(value):
                    trace.record(value)
                case _Bounded(bound):
                    trace.record_bound(bound)
                case _Ended() as ended:
                    return ended
                case _:  # nothing new: the monitor may want to cancel all the same
                    monitor.report(latest.stage, latest.done, latest.total)

    def _call_off(self) -> None:
        """Cancel over there and wait until it is noticed, so that the next call does not hear of this one."""
        child, end_s = self._child, time.monotonic() + GRACE_S
        if child is None:
            return
        with suppress(_LostError):
            child.send(_Wish.CANCEL)
            while time.monotonic() < end_s:
                if isinstance(child.receive(), _Ended):
                    return
        self._forget()

    def _lost(self) -> GroundStationError:
        status = self._forget()
        if self._is_closed:
            return OperationCancelled("the window is closing")
        is_killed = sys.platform != "win32" and status == -signal.SIGKILL
        why = "the system ended it, mostly because memory ran out" if is_killed else f"exit status {status}"
        return GroundStationError(
            f"the process that plans ended before the work was done ({why}); close other programs, or ask for less, "
            "and try again"
        )

    def _forget(self) -> int | None:
        child, self._child = self._child, None
        return None if child is None else child.end()


class _Telling:
    """Monitor and observer over there: what it hears goes through the pipe."""

    def __init__(self, out: IO[bytes], cancel: threading.Event) -> None:
        self._out, self._cancel = out, cancel
        self._stage, self._last_s = "", 0.0

    def send(self, message: Any) -> None:
        """Send a message, whole: it is pickled before the first byte is written."""
        self._out.write(pickle.dumps(message, pickle.HIGHEST_PROTOCOL))
        self._out.flush()

    def report(self, stage: str, done: float, total: float) -> None:
        """Send progress, at most every `REPORT_S` within a stage; raises `OperationCancelled` after a cancel."""
        if self._cancel.is_set():
            raise OperationCancelled(f"cancelled while {stage}")
        now = time.monotonic()
        if stage == self._stage and now - self._last_s < REPORT_S:
            return
        self._stage, self._last_s = stage, now
        self.send(_Report(stage, done, total))

    def improved(self, point: QualityPoint) -> None:
        """Send a better quality."""
        self.send(_Improved(point.value))

    def bounded(self, bound: float) -> None:
        """Send a bound."""
        self.send(_Bounded(bound))


class _Orders:
    """What comes in over there: calls one after the other, wishes at once."""

    def __init__(self, source: IO[bytes]) -> None:
        self._source = source
        self.calls: queue.SimpleQueue[_Call | None] = queue.SimpleQueue()
        """None asks for what planning needs to be loaded."""
        self.stop, self.cancel = threading.Event(), threading.Event()

    def read(self) -> None:
        """Read until the other side closes the pipe; the process then ends, whatever it does."""
        with suppress(EOFError, OSError):
            while True:
                match pickle.load(self._source):
                    case _Call() as call:
                        self.stop.clear()
                        self.cancel.clear()
                        self.calls.put(call)
                    case _Wish.LOAD:
                        self.calls.put(None)
                    case _Wish.STOP:
                        self.stop.set()
                    case _Wish.CANCEL:
                        self.cancel.set()
        os._exit(0)


def _serve() -> None:
    """What the process does: messages have its standard output for themselves, all else goes to the error output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides what Ctrl+C ends
    if sys.platform != "win32":
        os.nice(NICENESS)
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    orders = _Orders(sys.stdin.buffer)
    threading.Thread(target=orders.read, name="read-orders", daemon=True).start()
    while True:
        call = orders.calls.get()
        if call is None:
            _load_planning()
            continue
        telling = _Telling(out, orders.cancel)
        outcome = _outcome(call, telling, orders.stop)
        try:
            telling.send(outcome)
        except (pickle.PicklingError, AttributeError, TypeError) as error:  # pickle cannot send the result
            telling.send(_Ended(error=_sendable(error)))


def _outcome(call: _Call, telling: _Telling, stop: threading.Event) -> _Ended:
    trace = Trace(observer=telling.improved, bound_observer=telling.bounded)
    try:
        return _Ended(call.function(*call.arguments, stop=stop.is_set, trace=trace, monitor=telling))
    except BaseException as error:
        return _Ended(error=_sendable(error))


def _sendable(error: BaseException) -> BaseException:
    """An error as it comes through a pipe; one that does not is told in words."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _load_planning() -> None:
    """Load the modules and the compiled kernels that most plans need, by planning a very small one."""
    from planning.parameters import GreedyParameters
    from planning.planner import plan_flight
    from planning.request import PlanRequest
    from planning.site.bundled import SCENES

    few = GreedyParameters(n_candidates=200)
    plan_flight(SCENES["roof"](), PlanRequest(n_views=3, greedy=few, time_budget_s=2.0))


if __name__ == "__main__":
    # By its full name, so that what is pickled here has the same classes over there.
    from groundstation.services.jobs.worker import _serve as serve

    serve()
