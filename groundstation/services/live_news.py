"""What is new since it was last looked: photos, answers and warnings, told once each."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from groundstation.services.live_coverage import LiveCoverage
from groundstation.services.live_events import LiveEvent, PhotoCounted, WarningCleared, WarningRaised
from groundstation.vehicle.commands import CommandOutcome
from groundstation.vehicle.watch import FlightWarning
from missions.flight.record import TakenPhoto


class FlightNews:
    """Publishes what was not published before."""

    def __init__(self, publish: Callable[[LiveEvent], None], coverage: LiveCoverage) -> None:
        self._publish, self._coverage = publish, coverage
        self.begin()

    def begin(self) -> None:
        """Another machine listens: its photos and answers count from nothing."""
        self._n_photos = self._n_answers = 0
        self._warnings: tuple[FlightWarning, ...] = ()

    def photos(self, photos: Sequence[TakenPhoto], viewpoint_ids: Sequence[str]) -> None:
        """Count the photos that are new, as of these views."""
        for number, photo in enumerate(photos[self._n_photos :], self._n_photos + 1):
            started_s = time.perf_counter()
            counted, coverage = self._coverage.add(photo, viewpoint_ids), self._coverage
            self._publish(
                PhotoCounted(
                    number=number,
                    photo=photo,
                    view_id="" if counted.view is None else counted.view.id,
                    position_error_m=counted.position_error_m,
                    heading_error_deg=counted.heading_error_deg,
                    gimbal_pitch_error_deg=counted.gimbal_pitch_error_deg,
                    n_new=counted.n_new,
                    covered=coverage.covered,
                    covered_planned=coverage.covered_planned,
                    counts=coverage.counts(),
                    seconds=time.perf_counter() - started_s,
                )
            )
        self._n_photos = len(photos)

    def new_answers(self, answers: Sequence[CommandOutcome]) -> Sequence[CommandOutcome]:
        """Those that were not there when this was asked last."""
        new, self._n_answers = answers[self._n_answers :], len(answers)
        return new

    def warnings(self, warnings: tuple[FlightWarning, ...]) -> None:
        """Tell which appeared and which went."""
        before, now = {warning.code for warning in self._warnings}, {warning.code for warning in warnings}
        for warning in warnings:
            if warning.code not in before:
                self._publish(WarningRaised(warning))
        for code in sorted(before - now):
            self._publish(WarningCleared(code))
        self._warnings = warnings
