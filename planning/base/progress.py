"""How long work reports progress, is cancelled, is stopped early, and shows its quality against time.

Three small arguments, passed last, in this order where present:

- `monitor` publishes progress and raises `OperationCancelled` when the user cancelled: the work is thrown away.
- `stop` is asked now and then; when it answers True an *anytime* algorithm returns the best it has.
- `trace` collects (elapsed time, quality): the curve that shows what accuracy costs in time.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

from planning.base.messages import say

Clock = Callable[[], float]
"""Seconds from an arbitrary start, never going back. `time.perf_counter` outside tests."""

Stop = Callable[[], bool]
"""Asked between steps; True means: return the best so far."""


class Monitor(Protocol):
    """Takes progress; may raise `OperationCancelled`."""

    def report(self, stage: str, done: float, total: float) -> None:
        """Say that `done` of `total` parts of `stage` are finished (`total` 0: not known)."""


class _Quiet:
    def report(self, stage: str, done: float, total: float) -> None:
        """Ignore it."""


QUIET: Monitor = _Quiet()


@dataclass(frozen=True, slots=True)
class PartOf:
    """Takes the progress of a part for that of a longer stage, from the share `start` of it to the share `end`."""

    monitor: Monitor
    stage: str
    start: float
    end: float

    def report(self, _stage: str, done: float, total: float) -> None:
        """Say how far the longer stage is."""
        share = min(1.0, done / total) if total > 0.0 else 0.0
        self.monitor.report(self.stage, self.start + share * (self.end - self.start), 1.0)


def never() -> bool:
    """Stop criterion that lets the algorithm end by itself."""
    return False


class TimeLimit:
    """Stop criterion: True once `seconds` have passed since it was made, or once `also` holds."""

    def __init__(self, seconds: float, clock: Clock = time.perf_counter, also: Stop = never) -> None:
        self._clock, self._also = clock, also
        self.deadline_s = clock() + seconds

    def __call__(self) -> bool:
        """True once the time is up."""
        return self.remaining_s() <= 0.0

    def remaining_s(self) -> float:
        """Seconds left; never negative."""
        return 0.0 if self._also() else max(0.0, self.deadline_s - self._clock())


class StopRequest:
    """Stop criterion: True once the user pressed "good enough, stop here" (`request`)."""

    def __init__(self) -> None:
        self._event = threading.Event()

    def request(self) -> None:
        """Ask for the best so far; safe from any thread."""
        self._event.set()

    def __call__(self) -> bool:
        """True once it was requested."""
        return self._event.is_set()


def any_of(*criteria: Stop) -> Stop:
    """Stop criterion that holds once one of `criteria` does."""

    def stop() -> bool:
        return any(criterion() for criterion in criteria)

    return stop


@dataclass(frozen=True, slots=True)
class QualityPoint:
    """The best quality known after `t_s` seconds. The unit of `value` is the algorithm's: sections, metres, seconds."""

    t_s: float
    value: float


@dataclass(slots=True)
class Trace:
    """Quality against time of one run, and whoever wants to see it grow.

    Parameters
    ----------
    clock
        Source of time; its value at construction is t = 0.
    observer, bound_observer
        Called with every recorded point and bound, in the thread that does the work.
    bound
        What no result can be better than, as far as it is known; None before anything is.
    """

    clock: Clock = time.perf_counter
    observer: Callable[[QualityPoint], None] | None = None
    bound_observer: Callable[[float], None] | None = None
    points: list[QualityPoint] = field(default_factory=list)
    bound: float | None = None
    _start_s: float = field(init=False)

    def __post_init__(self) -> None:
        self._start_s = self.clock()

    def elapsed_s(self) -> float:
        """Seconds since the trace was made."""
        return self.clock() - self._start_s

    def record(self, value: float) -> None:
        """Add the best quality known now."""
        point = QualityPoint(self.elapsed_s(), value)
        self.points.append(point)
        if self.observer is not None:
            self.observer(point)

    def record_bound(self, value: float) -> None:
        """Note a bound that is now known; a later one is tighter."""
        self.bound = value
        if self.bound_observer is not None:
            self.bound_observer(value)


# Long compiled loops in slices short enough to be stopped between them.

SLICE_S = 0.05
"""Aimed-at length of a slice: half of what a user notices after pressing "stop"."""


def slices(n_steps: int | None = None, *, first: int = 1, clock: Clock = time.perf_counter) -> Iterator[int]:
    """Numbers of steps to take one after the other, adding up to `n_steps` (endless where None).

    The first slice has `first` steps. The time until the next number is asked for is taken as the time that the steps
    took, and slices grow (at most to twice the last) or shrink so that one takes about `SLICE_S`.
    """
    taken, size = 0, first
    while n_steps is None or taken < n_steps:
        size = size if n_steps is None else min(size, n_steps - taken)
        begin = clock()
        yield size
        taken += size
        size = max(1, min(2 * size, int(size * SLICE_S / max(clock() - begin, 1e-6))))


# Kernels are compiled where this computer has none yet, which takes up to a minute on whatever comes first.

COMPILING = say("compiling for this computer, once")

COMPILING_LOG = logging.getLogger("planning.base.jit")
"""Named here, so that who listens need not import a compiler. Libraries hear nothing of it unless they ask."""


def hear_compiling(tell: Callable[[str], None]) -> Callable[[], None]:
    """Have `tell` called when this process compiles its first kernel, on that thread; returns what ends it."""

    class _Tell(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            tell(record.msg)

    handler = _Tell()
    COMPILING_LOG.setLevel(logging.INFO)
    COMPILING_LOG.addHandler(handler)
    return lambda: COMPILING_LOG.removeHandler(handler)
