"""Python's search for cyclic garbage, done in the window's thread only and when there is time.

Left to itself it runs on whatever thread makes the next object. On the thread of a job it would free widgets there,
which Qt does not survive, and it would hold the interpreter's lock for as long as the search takes: a tenth of a second
and more once the numerical libraries are loaded.
"""

from __future__ import annotations

import gc

from PySide6.QtCore import QObject, QTimer

INTERVAL_MS = 1000

FULL_EVERY = 60
"""Rounds between searches through everything that was made since the window opened."""


class GarbageCollector(QObject):
    """Takes the search over, until `close`.

    What exists when `settle` is called, modules above all, is left out from then on: that is most of all objects.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._round, self._was_on = 0, gc.isenabled()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._collect)
        gc.disable()
        self._timer.start(INTERVAL_MS)

    def settle(self) -> None:
        """What has been imported until now stays."""
        gc.freeze()

    def close(self) -> None:
        """Leave the search as it was."""
        self._timer.stop()
        gc.unfreeze()
        if self._was_on:
            gc.enable()

    def _collect(self) -> None:
        self._round += 1
        young, middle, _ = gc.get_threshold()
        if self._round % FULL_EVERY == 0:
            gc.collect()
            gc.freeze()
        elif gc.get_count()[0] > young:
            gc.collect(1 if gc.get_count()[1] > middle else 0)
