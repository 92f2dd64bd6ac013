"""A process beside the window's that trains a model and shows models: torch never touches the window's own.

It is asked and answers by the messages of `reconstruct_messages`, pickled, through its standard input and output. A
model in training is shown by the process that trains it, between two steps, so that it need not be copied; memory that
runs out ends that process and not the window.

Where nobody writes to it any more, a training breaks off, keeps its state on the disk, and the process ends.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from groundstation.services.reconstruct.messages import Lost

SERVER = "groundstation.services.reconstruct.server"
"""The module that runs over there. By its name only: it loads what the window must not."""

NICENESS = 10
"""The window's own threads run first when both want a processor."""

Listener = Callable[[Any], None]


class ModelProcess:
    """The process, seen from here; it starts with the first message.

    Parameters
    ----------
    listener
        Called with every message that comes, on a thread that reads them.
    niceness
        By which it leaves the processor to others, the window first of all; not on Windows.
    """

    def __init__(self, listener: Listener, niceness: int = NICENESS) -> None:
        self._listener = listener
        self._niceness = niceness
        self._process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None
        self._lock = threading.Lock()
        self._is_closed = False

    @property
    def is_running(self) -> bool:
        """Whether it has been started, and has not ended."""
        return self._process is not None and self._process.poll() is None

    def send(self, message: Any) -> None:
        """Send a message; where the process has ended, a new one is started. It is told by `Lost` that it has."""
        if self._is_closed:
            return
        with self._lock, suppress(OSError):
            process = self._started()
            assert process.stdin is not None
            process.stdin.write(pickle.dumps(message, pickle.HIGHEST_PROTOCOL))
            process.stdin.flush()

    def close(self) -> None:
        """Send and hear nothing more. A training that runs keeps its state by itself; nobody waits for it."""
        self._is_closed = True
        self._let_go()

    def end(self) -> None:
        """End it at once, whatever it does."""
        process = self._process
        self.close()
        if process is not None:
            process.kill()
            process.wait()

    def _let_go(self) -> None:
        process, self._process = self._process, None
        if process is not None and process.stdin is not None:
            with suppress(OSError):
                process.stdin.close()

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is None or self._process.poll() is not None:
            self._let_go()
            paths = os.pathsep.join(path for path in sys.path if path)
            self._process = subprocess.Popen(
                [sys.executable, "-m", SERVER, str(self._niceness)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, "PYTHONPATH": paths},
            )
            self._reader = threading.Thread(target=self._read, args=(self._process,), name="read-models", daemon=True)
            self._reader.start()
        return self._process

    def _read(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        with suppress(EOFError, OSError, ValueError, pickle.UnpicklingError):
            while True:
                self._tell(pickle.load(process.stdout))
        status = process.wait()
        process.stdout.close()
        self._tell(Lost(status))

    def _tell(self, message: Any) -> None:
        if not self._is_closed:
            self._listener(message)
