"""Driving the real window in tests: turning the event loop until something has happened, and answering questions."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QTimer

from groundstation.gui.questions import Answer, Questions

SETTLE_S, CALM_S = 0.35, 0.05
"""Time without a job after which none follows: where a timer still runs (effects are looked at 0.3 s after the last
change), and where none does."""


class Answers(Questions):
    """A user whose answers are known before; questions that were asked are kept."""

    def __init__(self, save: Answer = Answer.NO, recover: Answer = Answer.CANCEL, folder: Path | None = None) -> None:
        super().__init__()
        self.save, self.take_over, self.chosen = save, recover, folder
        self.asked: list[str] = []

    def save_first(self, parent):
        self.asked.append("save")
        return self.save

    def recover(self, parent, when, changes, is_of_saved_state):
        self.asked.append(f"recover {when}: {', '.join(changes)}")
        return self.take_over

    def folder(self, parent, title):
        self.asked.append(title)
        return self.chosen

    def new_folder(self, parent, title):
        self.asked.append(title)
        return self.chosen

    def file(self, parent, title, kinds):
        self.asked.append(title)
        return self.chosen


def turn_until(application, condition: Callable[[], bool], timeout_s: float = 60.0) -> float:
    """Process events until a condition holds; returns the longest time that one turn of the event loop took, s."""
    end, longest = time.perf_counter() + timeout_s, 0.0
    while not condition():
        started = time.perf_counter()
        application.processEvents()
        longest = max(longest, time.perf_counter() - started)
        assert time.perf_counter() < end, "it did not happen in time"
        time.sleep(0.002)
    return longest


def turn_until_idle(application, desk, timeout_s: float = 60.0) -> float:
    """Process events until no job runs and none follows; returns the longest turn, s."""
    longest, quiet_since = 0.0, time.perf_counter()
    while time.perf_counter() - quiet_since < (SETTLE_S if _waits(desk) else CALM_S):
        longest = max(longest, turn_until(application, lambda: not desk.workspace.jobs(), timeout_s))
        started = time.perf_counter()
        application.processEvents()
        longest = max(longest, time.perf_counter() - started)
        if desk.workspace.jobs():
            quiet_since = time.perf_counter()
        time.sleep(0.005)
    return longest


def _waits(desk) -> bool:
    """Whether a timer runs that may start something soon."""
    timers = desk.window.findChildren(QTimer)
    return any(timer.isActive() and timer.interval() <= 1000.0 * SETTLE_S for timer in timers)
