"""The flight report for the command line: text for people, plain values for programs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from missions.flight.outcome import FlightReport, Reason, SortieOutcome, Summary
from planning.base.findings import Severity
from planning.base.json_file import plain_values
from planning.base.messages import say


def report_to_json(report: FlightReport) -> dict[str, Any]:
    """The report as plain values: the summary's fields, then `views`, `sorties` and `findings`."""
    content: dict[str, Any] = plain_values(report)
    return {**content.pop("summary"), **content}


def report_text(report: FlightReport) -> str:
    """The report in some lines: photos, coverage, errors at the shutter, distance, sorties, and what breaks a limit."""
    lines = [
        _photos_line(report.summary),
        _coverage_line(report.summary),
        *_shutter_lines(report),
        *(_sortie_line(outcome) for outcome in report.sorties),
        *(
            f"{finding.severity.value}: {f'{finding.place}: ' if finding.place else ''}{finding.message}"
            for finding in report.findings
            if finding.severity is not Severity.OK
        ),
    ]
    return "\n".join(lines)


def _photos_line(summary: Summary) -> str:
    further = summary.n_photos - summary.n_taken
    text = f"photos: {summary.n_taken} of {summary.n_views} views"
    return f"{text}, {further} further" if further else text


def _coverage_line(summary: Summary) -> str:
    share = f" ({summary.covered / summary.covered_planned:.1%})" if summary.covered_planned else ""
    planned = f"where {summary.covered_planned} were planned{share}"
    text = f"coverage: {summary.covered} sections {planned}, {summary.total} in all"
    return f"{text}; {len(summary.lost_panels)} panels lost" if summary.lost_panels else text


def _shutter_lines(report: FlightReport) -> Iterator[str]:
    taken = [view for view in report.views if view.reason is Reason.TAKEN]
    parts = []
    for name, field, unit in (
        ("position", "position_error_m", "m"),
        ("heading", "heading_error_deg", "deg"),
        ("pitch", "gimbal_pitch_error_deg", "deg"),
        ("speed", "speed_m_s", "m/s"),
        ("blur", "blur_px", "px"),
    ):
        values = np.abs([value for view in taken if (value := getattr(view, field)) is not None])
        if len(values):
            parts.append(f"{name} {np.median(values):.2f} / {values.max():.2f} {unit}")
    if parts:
        yield f"at the shutter (median / worst): {', '.join(parts)}"


def _sortie_line(outcome: SortieOutcome) -> str:
    name = say("sortie {}", outcome.sortie) if outcome.sortie else f"record {outcome.record + 1}, no sortie of the plan"
    parts = [f"{outcome.n_taken} of {outcome.n_views} views"]
    if outcome.duration_flown_s is not None:
        parts.append(f"{outcome.duration_flown_s:.0f} s flown")
    if outcome.duration_predicted_s is not None:
        parts.append(f"{outcome.duration_predicted_s:.0f} s predicted")
    if outcome.battery_used is not None:
        predicted = "" if outcome.battery_predicted is None else f" ({outcome.battery_predicted:.0%} predicted)"
        parts.append(f"{outcome.battery_used:.0%} of a battery{predicted}")
    if outcome.least_distance_m is not None:
        parts.append(f"{outcome.least_distance_m:.2f} m kept at least")
    return f"{name}: {', '.join(parts)}"
