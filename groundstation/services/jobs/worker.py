"""Planning in a process of its own (`channel.py`): one function after the other, with progress, stopping, cancelling.

What is sent to it and back is pickled: functions of modules, and records (a planned tower of 3640 panels is 6 MB).
Progress, quality and bounds come back while it works; stopping and cancelling go the other way.
"""

from __future__ import annotations

import pickle
import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, TypeVar

from groundstation.services.jobs.channel import Process, ProcessEnded, Send, sendable
from planning.base.errors import GroundStationError, OperationCancelled
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, hear_compiling, never

Result = TypeVar("Result")

POLL_S = 0.05
"""How often stopping and cancelling are looked for."""

REPORT_S = 0.05
"""Shortest time between two reports of one stage."""

GRACE_S = 5.0
"""What a cancelled process is given to notice; then it is ended."""


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


@dataclass(frozen=True, slots=True)
class _Load:
    function: Callable[[], None]


class _Order(Enum):
    STOP = auto()
    CANCEL = auto()


class _LostError(Exception):
    """The process has ended; `lost` is its last message."""

    def __init__(self, lost: ProcessEnded) -> None:
        self.lost = lost


class _Child:
    """The process and what it has sent, so that waiting for it can have an end."""

    def __init__(self) -> None:
        self._heard: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.process = Process(__name__, self._heard.put)

    def receive(self) -> Any:
        """Return the next message, None after `POLL_S` without one; raises `_LostError` at the last."""
        try:
            message = self._heard.get(timeout=POLL_S)
        except queue.Empty:
            return None
        if isinstance(message, ProcessEnded):
            raise _LostError(message)
        return message


class Worker:
    """Runs one function after the other in a process of its own, which starts with the first and stays.

    `run` blocks and may be called from any thread; a second call waits for the first.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._child: _Child | None = None
        self._is_closed = False

    def start(self, load: Callable[[], None]) -> None:
        """Start the process and let it load what calls will need, so that the first one need not wait for it."""
        with self._lock:
            if not self._is_closed and self._child is None:
                self._running().process.send(_Load(load))

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
                child.process.send(_Call(function, arguments))
                ended = self._follow(child, stop, Trace() if trace is None else trace, monitor)
            except OperationCancelled:
                self._call_off()
                raise
            except _LostError as error:
                raise self._lost(error.lost) from error
        if ended.error is not None:
            raise ended.error
        return ended.result  # type: ignore[no-any-return]

    def close(self) -> None:
        """End the process at once, whatever it does; it does not start again."""
        self._is_closed = True
        child = self._child
        if child is not None:
            child.process.end()

    def _running(self) -> _Child:
        if self._is_closed:
            raise OperationCancelled(say("the window is closing"))
        if self._child is None or not self._child.process.is_running:
            self._child = _Child()
        return self._child

    def _follow(self, child: _Child, stop: Stop, trace: Trace, monitor: Monitor) -> _Ended:
        """Pass on what is heard until the end is."""
        latest, is_stopped = _Report("starting", 0, 0), False
        while True:
            if not is_stopped and stop():
                is_stopped = True
                child.process.send(_Order.STOP)
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
            child.process.send(_Order.CANCEL)
            while time.monotonic() < end_s:
                if isinstance(child.receive(), _Ended):
                    return
        self._forget()

    def _lost(self, lost: ProcessEnded) -> GroundStationError:
        self._forget()
        if self._is_closed:
            return OperationCancelled(say("the window is closing"))
        why = (
            say("the system ended it, mostly because memory ran out")
            if lost.is_killed
            else say("exit status {}", lost.status)
        )
        return GroundStationError(
            say(
                "the process that plans ended before the work was done ({}); close other programs, or ask for "
                "less, and try again",
                why,
            )
        )

    def _forget(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.process.end()


class _Service:
    """Over there: calls one after the other, orders at once; monitor and observer of what is called."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._calls: queue.SimpleQueue[_Call | _Load] = queue.SimpleQueue()
        self._stop, self._cancel = threading.Event(), threading.Event()
        self._stage, self._last_s = "", 0.0
        # Whoever waits for the next call hears it, too.
        hear_compiling(lambda text: self._send(_Report(text, 0, 0)))

    def take(self, message: Any) -> None:
        """Take a call or a request."""
        match message:
            case _Call() as call:
                self._stop.clear()
                self._cancel.clear()
                self._calls.put(call)
            case _Load() as load:
                self._calls.put(load)
            case _Order.STOP:
                self._stop.set()
            case _Order.CANCEL:
                self._cancel.set()

    def gone(self) -> float:
        """Nobody wants the plan any more."""
        return 0.0

    def run(self) -> None:
        """Do what is called, for ever."""
        while True:
            call = self._calls.get()
            if isinstance(call, _Load):
                call.function()
                continue
            try:
                self._send(self._outcome(call))
            except (pickle.PicklingError, AttributeError, TypeError) as error:  # pickle cannot send the result
                self._send(_Ended(error=sendable(error)))

    def _outcome(self, call: _Call) -> _Ended:
        self._stage = ""  # a first report is never held back for one of the call before
        trace = Trace(
            observer=lambda point: self._send(_Improved(point.value)),
            bound_observer=lambda bound: self._send(_Bounded(bound)),
        )
        try:
            return _Ended(call.function(*call.arguments, stop=self._stop.is_set, trace=trace, monitor=self))
        except BaseException as error:
            return _Ended(error=sendable(error))

    def report(self, stage: str, done: float, total: float) -> None:
        """Send progress, at most every `REPORT_S` within a stage; raises `OperationCancelled` after a cancel."""
        if self._cancel.is_set():
            raise OperationCancelled(say("cancelled while {}", stage))
        now = time.monotonic()
        if stage == self._stage and now - self._last_s < REPORT_S:
            return
        self._stage, self._last_s = stage, now
        self._send(_Report(stage, done, total))


service = _Service
