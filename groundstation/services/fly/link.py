"""The link of a live flight: every frame goes into its telemetry log, and it is opened again when it breaks."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from groundstation.services.fly.connection import Connection, OpenedLink
from groundstation.services.fly.record import open_log
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.telemetry_log import TelemetryLog
from missions.mavlink.messages import Message, Received
from planning.base.progress import Clock

WAIT_S = 0.05
"""How soon somebody who waits for messages looks at something else."""

RETRY_S = 1.0
"""Pause before a link that broke is opened again."""


class LoggedLink:
    """Used by one thread.

    Parameters
    ----------
    folder
        Where the log goes; where it cannot be written, the user's data folder takes its place.
    problem
        Called with what is wrong with the log, when that changes to something.
    """

    def __init__(
        self, connection: Connection, folder: Path, problem: Callable[[str], None], clock: Clock, unix_clock: Clock
    ) -> None:
        self._connection, self._folder, self._problem = connection, folder, problem
        self._clock, self._unix_clock = clock, unix_clock
        self._log: TelemetryLog | None = None
        self._log_problem = ""
        self._retry_s = 0.0
        self.opened: OpenedLink | None = None

    @property
    def name(self) -> str:
        """Of the log without its suffix; a name made of the time where there is no log."""
        return f"flight-{self._unix_clock():.0f}" if self._log is None else self._log.path.stem

    def open_log(self) -> None:
        """Begin the log."""
        self._log, problem = open_log(self._folder, self._unix_clock())
        self._say(problem)

    def open(self, orders: SortieOrders) -> None:
        """Open the link.

        Raises
        ------
        InputError, LinkError
            It cannot be opened.
        """
        self.opened = self._connection.open(orders, self._clock, self._frame_passed)

    def open_again(self, orders: SortieOrders) -> None:
        """Open a link that broke, once it is time to; returns after a moment in any case.

        Raises
        ------
        LinkError
            It still cannot be opened.
        """
        time.sleep(WAIT_S)
        if self._clock() >= self._retry_s:
            self.open(orders)

    def broke(self) -> bool:
        """Close what broke, to be opened again later; False where it was closed already."""
        self._retry_s = self._clock() + RETRY_S
        opened, self.opened = self.opened, None
        if opened is not None:
            opened.link.close()
        return opened is not None

    def receive(self, wait_s: float) -> Received | None:
        """The next message; None where none came in time, or there is no link."""
        return None if self.opened is None else self.opened.link.receive(wait_s)

    def send(self, message: Message) -> None:
        """Send, where there is a link."""
        if self.opened is not None:
            self.opened.link.send(message)

    def close(self) -> None:
        """Close link and log."""
        if self.opened is not None:
            self.opened.link.close()
        if self._log is not None:
            self._log.close()

    def _frame_passed(self, frame: bytes, _is_sent: bool, _time_s: float) -> None:
        if self._log is not None:
            self._log.write(frame, self._unix_clock())
            self._say(self._log.problem)

    def _say(self, problem: str) -> None:
        if problem and problem != self._log_problem:
            self._problem(problem)
        self._log_problem = problem
