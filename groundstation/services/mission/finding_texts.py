"""Findings in the order and units in which a pilot reads them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from groundstation.services.units import UnitSystem, length_unit, minutes_text, sampling_unit, speed_unit
from planning.base.findings import Finding, Severity
from planning.base.messages import say

SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.NOTE, Severity.OK)
"""The gravest first."""

HOUR_S = 3600

LONG_S = 120.0
"""Durations from here on are read as minutes and seconds."""


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Findings, the gravest first, else in the order in which they came."""
    return tuple(sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)))


def counts_by_severity(findings: Iterable[Finding]) -> Mapping[Severity, int]:
    """Number of findings of each severity, 0 included."""
    counts = Counter(finding.severity for finding in findings)
    return {severity: counts[severity] for severity in SEVERITIES}


def duration_text(duration_s: float) -> str:
    """A duration with its unit: `12:05 min`, `1:02:05 h` from an hour on."""
    return f"{minutes_text(duration_s)} {'min' if round(duration_s) < HOUR_S else 'h'}"


def measured_text(value: float, unit: str, system: UnitSystem) -> str:
    """A value of a finding with its unit, as the user reads it.

    Lengths, speeds and sizes of pixels go to the user's units; what has no imperial form stays.
    """
    match unit:
        case "m":
            return length_unit(system).text(value)
        case "m/s":
            return speed_unit(system).text(value)
        case "mm":
            return sampling_unit(system).text(value / 1e3)
        case "s":
            return f"{value:.1f} s" if abs(value) < LONG_S else duration_text(value)
        case "deg":
            return f"{value:.1f}°"
        case _:
            return say(f"{{:g}} {unit}", round(value, 3)) if unit else f"{round(value, 3):g}"
