"""Brings job events from worker threads to the window's thread as Qt signals."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from groundstation.services.jobs.runner import (
    JobBounded,
    JobEvent,
    JobImproved,
    JobProgress,
    JobRunner,
    JobStateChanged,
)


class JobBridge(QObject):
    """Signals with the events of a job runner; they arrive in the thread this object lives in."""

    state_changed = Signal(object)
    progressed = Signal(object)
    improved = Signal(object)
    bounded = Signal(object)

    def __init__(self, runner: JobRunner, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._unsubscribe = runner.subscribe(self._forward)

    def close(self) -> None:
        """Hear nothing more."""
        self._unsubscribe()

    def _forward(self, event: JobEvent) -> None:
        # Emitted on the worker's thread: Qt queues the call for receivers that live in another one.
        if isinstance(event, JobStateChanged):
            self.state_changed.emit(event)
        elif isinstance(event, JobProgress):
            self.progressed.emit(event)
        elif isinstance(event, JobImproved):
            self.improved.emit(event)
        elif isinstance(event, JobBounded):
            self.bounded.emit(event)
