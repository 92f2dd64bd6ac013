"""Which warning is spoken next: new and worse ones at once, those that go on again and again, one at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from groundstation.services.fly.events import LiveView
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
from planning.base.messages import say

AGAIN_S = {Severity.ERROR: 12.0, Severity.WARNING: 45.0}
"""Between two times that the same warning is spoken: a sentence takes some 5 s, and a pilot has to hear his crew."""


def ordered_warnings(warnings: Sequence[FlightWarning]) -> tuple[FlightWarning, ...]:
    """The worst first, the newest of these first."""
    return tuple(sorted(warnings, key=lambda each: (each.severity is not Severity.ERROR, -each.since_s)))


@dataclass(frozen=True, slots=True)
class AgedWarning:
    """A warning, and for how long it has been shown."""

    warning: FlightWarning
    age_s: float


def aged_warnings(view: LiveView, number: int | None = None) -> tuple[AgedWarning, ...]:
    """The warnings of a flight; of one of several aircraft, with its number in code and text.

    Each link has a clock of its own, so warnings of several are compared by their ages.
    """
    heartbeat, silent_s = view.state.heartbeat, view.silent_s
    now_s = None if heartbeat is None or silent_s is None else heartbeat.time_s + silent_s
    found = []
    for each in view.warnings:
        age_s = 0.0 if now_s is None else max(0.0, now_s - each.since_s)
        if number is not None:
            text = say("aircraft {}: {}", number, each.text)
            each = replace(each, code=f"{number}:{each.code}", text=text, since_s=-age_s)
        found.append(AgedWarning(each, age_s))
    return tuple(found)


def fleet_warnings(views: Mapping[int, LiveView]) -> tuple[AgedWarning, ...]:
    """The warnings of several aircraft, by their numbers; that two are near each other is said once."""
    found = [aged for number, view in sorted(views.items()) for aged in aged_warnings(view, number)]
    near = [aged for aged in found if aged.warning.code.endswith(":aircraft-apart")]
    spare = near[1:] if len(near) == 2 else []
    return tuple(aged for aged in found if aged not in spare)


@dataclass(frozen=True, slots=True)
class Spoken:
    """How severe a warning was when it was spoken last, and when."""

    severity: Severity
    time_s: float


@dataclass(frozen=True, slots=True)
class Announcements:
    """What was spoken of the warnings that hold, by their code."""

    spoken: Mapping[str, Spoken] = field(default_factory=lambda: MappingProxyType({}))

    def after(self, warnings: Sequence[FlightWarning]) -> Announcements:
        """Forget what is over: when it comes back it is new."""
        codes = {warning.code for warning in warnings}
        return replace(self, spoken={code: said for code, said in self.spoken.items() if code in codes})

    def next(self, warnings: Sequence[FlightWarning], now_s: float) -> FlightWarning | None:
        """The warning to be spoken now, the worst and newest first; None where all were spoken lately.

        Parameters
        ----------
        now_s
            By any clock that runs as the pilot's does; that of a simulation runs ahead.
        """
        return next((each for each in ordered_warnings(warnings) if self._is_due(each, now_s)), None)

    def with_spoken(self, warning: FlightWarning, now_s: float) -> Announcements:
        """It is spoken now."""
        return replace(self, spoken={**self.spoken, warning.code: Spoken(warning.severity, now_s)})

    def _is_due(self, warning: FlightWarning, now_s: float) -> bool:
        said = self.spoken.get(warning.code)
        if said is None or (warning.severity is Severity.ERROR and said.severity is not Severity.ERROR):
            return True
        return now_s - said.time_s >= AGAIN_S.get(warning.severity, AGAIN_S[Severity.WARNING])
