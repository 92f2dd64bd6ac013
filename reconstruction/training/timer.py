"""Seconds that a training has taken, all in all."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from planning.base.progress import Clock


class Timer:
    """Seconds since something began, without its pauses.

    Parameters
    ----------
    begun_s
        What the clock said then; None for now.
    before_s
        That it had taken before, where it is gone on with.

    Attributes
    ----------
    clock
        That it goes by; parts of the work that have times of their own go by it, too.
    lasted_s
        How long parts of it, by name, took when they were done last.
    """

    def __init__(self, clock: Clock = time.perf_counter, begun_s: float | None = None, before_s: float = 0.0) -> None:
        self.clock = clock
        self._begun_s = clock() if begun_s is None else begun_s
        self.before_s = before_s
        self.lasted_s: dict[str, float] = {}

    def __call__(self) -> float:
        """Seconds."""
        return self.before_s + self.clock() - self._begun_s

    @contextmanager
    def timing(self, part: str) -> Iterator[None]:
        """Note how long a part takes, which is done in the block."""
        begun_s = self.clock()
        yield
        self.lasted_s[part] = self.clock() - begun_s

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Do not count what is done in the block."""
        begun_s = self.clock()
        yield
        self._begun_s += self.clock() - begun_s
