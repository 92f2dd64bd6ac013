"""Python's search for cyclic garbage, done in the window's thread only and when there is time.

Left to itself it runs on whatever thread makes the next object. On the thread of a job it would free widgets there,
which Qt does not survive, and it would hold the interpreter's lock for as long as the search takes: a tenth of a second
and more once the numerical libraries are loaded.
"""

from __future__ import annotations

import gc
from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer

INTERVAL_MS = 1000

FULL_EVERY = 60
"""Least number of rounds between searches through everything that was made since the last of them; such a search took
75 ms after three plans of 560 views."""


def _never() -> bool:
    return False


class GarbageCollector(QObject):
    """Takes the search over, until `close`.

    What exists when `settle` is called, modules above all, is left out from then on: that is most of all objects.

    Parameters
    ----------
    is_busy
        While it is, the window must answer at once: long searches wait.
    """

    def __init__(self, parent: QObject | None = None, is_busy: Callable[[], bool] = _never) -> None:
        super().__init__(parent)
        self._is_busy = is_busy
        self._round, self._was_on = 0, gc.isenabled()
        # What others left out stays so: Python gives back all or nothing, and a search through all of it takes seconds.
        self._may_leave_out = gc.get_freeze_count() == 0
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._collect)
        gc.disable()
        self._timer.start(INTERVAL_MS)

    def settle(self) -> None:
        """What has been imported until now stays."""
        if self._may_leave_out:
            gc.freeze()

    def close(self) -> None:
        """Leave the search as it was."""
        self._timer.stop()
        if self._may_leave_out:
            gc.unfreeze()
        if self._was_on:
            gc.enable()

    def _collect(self) -> None:
        self._round += 1
        if self._round >= FULL_EVERY and not self._is_busy():
            self._round = 0
            gc.collect()
            self.settle()
        elif gc.get_count()[0] > gc.get_threshold()[0]:
            # What outlives a round waits for the next long search: rounds that look at it again, as Python's own do,
            # took up to 40 ms once a plan was there.
            gc.collect(1)
