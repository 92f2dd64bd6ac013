"""The process that trains a model and shows models, as the window sees it: torch never touches the window's own.

It is asked and answers by the messages of `messages.py`, through `jobs/channel.py`. A model in training is shown by the
process that trains it, between two steps, so that it need not be copied; memory that runs out ends that process and not
the window. Where nobody writes to it any more, a training breaks off, keeps its state on the disk, and it ends.
"""

from __future__ import annotations

import threading
from typing import Any

from groundstation.services.jobs.channel import NICENESS, Listener, Process

SERVER = "groundstation.services.reconstruct.server"


class ModelProcess:
    """The process, seen from here; it starts with the first message.

    Parameters
    ----------
    listener
        Called with every message that comes, on a thread that reads them; where the process ends, with `Lost`.
    niceness
        By which it leaves the processor to others, the window first of all; not on Windows.
    """

    def __init__(self, listener: Listener, niceness: int = NICENESS) -> None:
        self._listener = listener
        self._niceness = niceness
        self._process: Process | None = None
        self._lock = threading.Lock()
        self._is_closed = False

    @property
    def is_running(self) -> bool:
        """Whether it has been started, and has not ended."""
        return self._process is not None and self._process.is_running

    def send(self, message: Any) -> None:
        """Send a message; where the process has ended, a new one is started. It is told by `Lost` that it has."""
        if self._is_closed:
            return
        with self._lock:
            if self._process is None or not self._process.is_running:
                self._let_go()
                self._process = Process(SERVER, self._tell, self._niceness)
            self._process.send(message)

    def close(self) -> None:
        """Send and hear nothing more. A training that runs keeps its state by itself; nobody waits for it."""
        self._is_closed = True
        self._let_go()

    def end(self) -> None:
        """End it at once, whatever it does."""
        process = self._process
        self.close()
        if process is not None:
            process.end()

    def _let_go(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.let_go()

    def _tell(self, message: Any) -> None:
        if not self._is_closed:
            self._listener(message)
