"""Running a sortie over a link: what comes in goes to the run, what it wants said goes out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol

from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import Phase, RunOutcome, RunView
from missions.mavlink.link import Link
from missions.mavlink.messages import Message, Received
from planning.base.errors import LinkError
from planning.base.progress import QUIET, Clock, Monitor

VIEW_EVERY_S = 0.1
REOPEN_EVERY_S = 1.0
SHORTEST_WAIT_S = 0.02


class Companion(Protocol):
    """What goes along with a flight on the same link, such as remote identification."""

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""

    def tick(self, now_s: float) -> list[Message]:
        """What is due."""


Reopen = Callable[[], Link]
"""Opens the link anew; raises LinkError where it cannot."""


def conduct(
    run: FlightRun,
    link: Link,
    clock: Clock,
    *,
    reopen: Reopen | None = None,
    show: Callable[[RunView], None] | None = None,
    companions: Sequence[Companion] = (),
    wait: Callable[[float], None] = time.sleep,
    monitor: Monitor = QUIET,
) -> RunOutcome:
    """Fly a sortie to its end; the link is closed then.

    Parameters
    ----------
    clock
        The link's: real time for real vehicles, the simulation's for one in this process.
    reopen
        Without it a link that breaks ends the sortie.
    companions
        What goes along on the link.
    show
        Called ten times a second (of the clock) with the run as it stands.
    wait
        What to do for some seconds while the link is broken.

    Raises
    ------
    LinkError
        The link broke and cannot be opened again.
    OperationCancelled
        By the monitor. An aircraft in the air goes on by itself: nothing is ordered without the pilot.
    """
    line = _Line(link, reopen, clock, wait)
    try:
        return _conduct(run, line, clock, show, companions, monitor)
    finally:
        line.close()


def _conduct(
    run: FlightRun,
    line: _Line,
    clock: Clock,
    show: Callable[[RunView], None] | None,
    companions: Sequence[Companion],
    monitor: Monitor,
) -> RunOutcome:
    shown_s = -math.inf
    line.send(run.start(clock()))
    while run.outcome is None:
        now_s = clock()
        if now_s >= shown_s + VIEW_EVERY_S:
            shown_s = now_s
            monitor.report(*_progress(run))
            if show is not None:
                show(run.view())
        wait_s = run.next_deadline_s - now_s
        # Simulated time goes on in steps: a wait shorter than one would be no wait, for ever.
        received = line.receive(max(wait_s, SHORTEST_WAIT_S) if wait_s > 0.0 else 0.0)
        if received is not None:
            line.send(run.receive(received))
            for companion in companions:
                line.send(companion.receive(received))
        for companion in companions:
            line.send(companion.tick(clock()))
        if clock() >= run.next_deadline_s:
            line.send(run.tick(clock()))
    if show is not None:
        show(run.view())
    return run.outcome


def _progress(run: FlightRun) -> tuple[str, float, float]:
    if run.phase is Phase.FLYING:
        return "photos", float(len(run.state.photos)), float(run.orders.mission.n_photos)
    return run.view().doing if run.phase is Phase.UPLOADING else (run.phase.value, 0.0, 0.0)


class _Line:
    """A link that is opened again when it breaks; while it is broken, messages are lost as on any radio."""

    def __init__(self, link: Link, reopen: Reopen | None, clock: Clock, wait: Callable[[float], None]) -> None:
        self._link: Link | None = link
        self._reopen, self._clock, self._wait = reopen, clock, wait
        self._retry_s = -math.inf

    def send(self, messages: list[Message]) -> None:
        """Send messages, or lose them."""
        for message in messages:
            if self._link is not None:
                try:
                    self._link.send(message)
                except LinkError as error:
                    self._broke(error)

    def receive(self, timeout_s: float) -> Received | None:
        """The next message; None where none came in time."""
        if self._link is None and self._clock() >= self._retry_s:
            self._open()
        if self._link is None:
            self._wait(min(timeout_s, REOPEN_EVERY_S))
            return None
        try:
            return self._link.receive(timeout_s)
        except LinkError as error:
            self._broke(error)
            return None

    def close(self) -> None:
        """Close the link, whichever it is by now."""
        if self._link is not None:
            self._link.close()

    def _broke(self, error: LinkError) -> None:
        if self._reopen is None:
            raise error
        if self._link is not None:
            self._link.close()
        self._link = None
        self._retry_s = self._clock() + REOPEN_EVERY_S

    def _open(self) -> None:
        assert self._reopen is not None
        self._retry_s = self._clock() + REOPEN_EVERY_S
        with suppress(LinkError):
            self._link = self._reopen()
