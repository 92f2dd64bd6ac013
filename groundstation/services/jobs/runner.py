"""Jobs: long work on a thread of its own, told about through frozen events that the command line and the window share.

States of a job and what leads from one to the next:

    QUEUED -> RUNNING -> SUCCEEDED   the work returned a result
                      -> FAILED      it raised an exception
                      -> CANCELLED   the user cancelled, and the work noticed
    QUEUED -> CANCELLED              the user cancelled before it began

Exactly one of succeeded, failed and cancelled ends every job.
"""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any, Generic, TypeVar

from groundstation.services.jobs.worker import Worker
from planning.base.errors import OperationCancelled
from planning.base.messages import say
from planning.base.plugins import with_plugin_named
from planning.base.progress import Clock, QualityPoint, StopRequest, Trace

Result = TypeVar("Result")


class JobState(Enum):
    """Where a job stands; see the module for the transitions."""

    QUEUED = auto()
    RUNNING = auto()
    SUCCEEDED = auto()
    FAILED = auto()
    CANCELLED = auto()


ENDED = frozenset({JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED})


@dataclass(frozen=True, slots=True)
class JobEvent:
    """Something happened to a job."""

    job_id: int
    name: str


@dataclass(frozen=True, slots=True)
class JobStateChanged(JobEvent):
    """The job went on to `state`. `result` is set when it succeeded, `error` when it failed."""

    state: JobState
    result: Any = None
    error: BaseException | None = None


@dataclass(frozen=True, slots=True)
class JobProgress(JobEvent):
    """`done` of `total` parts of `stage` are finished (`total` 0: not known), `elapsed_s` after the start.

    `remaining_s` is an estimate for this stage, None where there is nothing to estimate it from.
    """

    stage: str
    done: float
    total: float
    elapsed_s: float
    remaining_s: float | None


@dataclass(frozen=True, slots=True)
class JobImproved(JobEvent):
    """An anytime algorithm found something better."""

    point: QualityPoint


@dataclass(frozen=True, slots=True)
class JobBounded(JobEvent):
    """It is known that no result can be better than `bound`."""

    bound: float


Listener = Callable[[JobEvent], None]


class JobContext:
    """What work gets to report to: a monitor, a stop request ("good enough"), and a trace of its quality."""

    def __init__(self, job: Job[Any], publish: Listener, clock: Clock, worker: Worker | None = None) -> None:
        self._job, self._publish, self._clock, self._worker = job, publish, clock, worker
        self._start_s = clock()
        self._stage, self._stage_start_s, self._last_published_s = "", self._start_s, -1.0
        self.stop = job.stop_request
        self.trace = Trace(clock, self._improved, self._bounded)

    def report(self, stage: str, done: float, total: float) -> None:
        """Publish progress, at most 20 times a second within a stage; raises `OperationCancelled` after a cancel."""
        if self._job.cancel_requested:
            raise OperationCancelled(say("{} was cancelled", self._job.name))
        now = self._clock()
        if stage != self._stage:
            self._stage, self._stage_start_s = stage, now
        elif now - self._last_published_s < 0.05:
            return
        self._last_published_s = now
        spent = now - self._stage_start_s
        remaining = spent * (total - done) / done if done > 0 and total > done and spent > 0.2 else None
        self._publish(JobProgress(self._job.id, self._job.name, stage, done, total, now - self._start_s, remaining))

    def run_in_process(self, function: Callable[..., Result], *arguments: Any) -> Result:
        """Call `function(*arguments, stop=, trace=, monitor=)` in a process of its own, where there is one for it."""
        run = self._worker.run if self._worker is not None else _here
        return run(function, *arguments, stop=self.stop, trace=self.trace, monitor=self)

    def _improved(self, point: QualityPoint) -> None:
        self._publish(JobImproved(self._job.id, self._job.name, point))

    def _bounded(self, bound: float) -> None:
        self._publish(JobBounded(self._job.id, self._job.name, bound))


def _here(function: Callable[..., Result], *arguments: Any, **reporting: Any) -> Result:
    return function(*arguments, **reporting)


@dataclass(eq=False)
class Job(Generic[Result]):
    """Handle of a job; all of its methods may be called from any thread."""

    id: int
    name: str
    stop_request: StopRequest = field(default_factory=StopRequest)
    _cancel: threading.Event = field(default_factory=threading.Event)
    _ended: threading.Event = field(default_factory=threading.Event)
    _state: JobState = JobState.QUEUED
    _result: Result | None = None
    _error: BaseException | None = None

    @property
    def state(self) -> JobState:
        """Where it stands."""
        return self._state

    @property
    def cancel_requested(self) -> bool:
        """Whether the user asked to throw the work away."""
        return self._cancel.is_set()

    def stop(self) -> None:
        """Ask for the best so far."""
        self.stop_request.request()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for the end; False when the time is up first."""
        return self._ended.wait(timeout_s)

    def result(self) -> Result:
        """Wait for the end and return the result.

        Raises
        ------
        BaseException
            Whatever the work raised; `OperationCancelled` when it was cancelled.
        """
        self._ended.wait()
        if self._error is not None:
            raise self._error
        return self._result  # type: ignore[return-value]  # set whenever there is no error


class JobRunner:
    """Runs jobs one after the other on a worker thread and publishes their events to all listeners.

    Listeners are called on the worker's thread (or the caller's, for the first and for queued jobs that are
    cancelled); the window hands events over to its own thread.

    Parameters
    ----------
    worker
        The process for `JobContext.run_in_process`; without one that work, too, is done on the job's thread.
    """

    def __init__(self, n_workers: int = 1, clock: Clock = time.perf_counter, *, worker: Worker | None = None) -> None:
        self._pool = ThreadPoolExecutor(n_workers, thread_name_prefix="job")
        self._worker = worker
        self._clock = clock
        self._ids = itertools.count(1)
        self._lock = threading.Lock()
        self._listeners: tuple[Listener, ...] = ()

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Call `listener` with every event from now on; returns a function that ends it."""
        with self._lock:
            self._listeners += (listener,)

        def unsubscribe() -> None:
            with self._lock:
                self._listeners = tuple(kept for kept in self._listeners if kept is not listener)

        return unsubscribe

    def submit(self, name: str, work: Callable[[JobContext], Result]) -> Job[Result]:
        """Queue work; it gets a `JobContext` and returns its result."""
        job: Job[Result] = Job(next(self._ids), name)
        self._publish(JobStateChanged(job.id, name, JobState.QUEUED))
        self._pool.submit(self._run, job, work)
        return job

    def cancel(self, job: Job[Any]) -> None:
        """Ask a job to end and throw its work away; a queued job ends at once."""
        job._cancel.set()
        if self._advance(job, JobState.QUEUED, JobState.CANCELLED):
            self._end(job, JobState.CANCELLED, error=OperationCancelled(say("{} was cancelled", job.name)))

    def shutdown(self) -> None:
        """Wait for running jobs; queued ones still run unless cancelled first."""
        self._pool.shutdown(wait=True)

    def _run(self, job: Job[Result], work: Callable[[JobContext], Result]) -> None:
        if not self._advance(job, JobState.QUEUED, JobState.RUNNING):
            return
        self._publish(JobStateChanged(job.id, job.name, JobState.RUNNING))
        try:
            result = work(JobContext(job, self._publish, self._clock, self._worker))
        except OperationCancelled as error:
            self._finish(job, JobState.CANCELLED, error=error)
        except BaseException as error:
            self._finish(job, JobState.FAILED, error=with_plugin_named(error))
        else:
            self._finish(job, JobState.SUCCEEDED, result=result)

    def _finish(self, job: Job[Any], state: JobState, result: Any = None, error: BaseException | None = None) -> None:
        self._advance(job, JobState.RUNNING, state)
        self._end(job, state, result, error)

    def _advance(self, job: Job[Any], start: JobState, end: JobState) -> bool:
        """Go from one state to another; False when the job was not in the first."""
        with self._lock:
            if job._state is not start:
                return False
            job._state = end
            return True

    def _end(self, job: Job[Any], state: JobState, result: Any = None, error: BaseException | None = None) -> None:
        job._result, job._error = result, error
        try:
            self._publish(JobStateChanged(job.id, job.name, state, result, error))
        finally:
            job._ended.set()

    def _publish(self, event: JobEvent) -> None:
        with self._lock:
            listeners = self._listeners
        for listener in listeners:
            listener(event)
