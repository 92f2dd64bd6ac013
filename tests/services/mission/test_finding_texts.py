"""Findings in order and in the user's units."""

import re
from pathlib import Path

import pytest

from groundstation.services.mission.readiness import (
    by_severity,
    counts_by_severity,
    duration_text,
    measured_text,
    subject_of,
)
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity

METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL
ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("value", "unit", "metric", "imperial"),
    [
        (10.0, "m", "10.0 m", "32.8 ft"),
        (5.0, "m/s", "5.0 m/s", "11.2 mph"),
        (25.4, "mm", "25.40 mm", "1.000 in"),
        (90.0, "s", "90.0 s", "90.0 s"),
        (1890.0, "s", "31:30 min", "31:30 min"),
        (-30.0, "deg", "-30.0°", "-30.0°"),
        (3.0, "viewpoints", "3 viewpoints", "3 viewpoints"),
        (196.0, "", "196", "196"),
        (-0.001, "m", "0.0 m", "0.0 ft"),
    ],
)
def test_values_are_read_in_the_users_units(value, unit, metric, imperial):
    assert measured_text(value, unit, METRIC) == metric
    assert measured_text(value, unit, IMPERIAL) == imperial


def test_the_gravest_comes_first_and_the_rest_keeps_its_order():
    severities = [Severity.OK, Severity.WARNING, Severity.ERROR, Severity.NOTE, Severity.ERROR]
    findings = [Finding(severity, f"rule-{i}", "text") for i, severity in enumerate(severities)]
    assert [finding.code for finding in by_severity(findings)] == ["rule-2", "rule-4", "rule-1", "rule-3", "rule-0"]
    assert list(counts_by_severity(findings).values()) == [2, 1, 1, 1]
    assert list(counts_by_severity(()).values()) == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("duration_s", "text"),
    [(725.0, "12:05 min"), (3599.4, "59:59 min"), (3599.6, "1:00:00 h"), (4037.0, "1:07:17 h")],
)
def test_durations_of_an_hour_are_not_called_minutes(duration_s, text):
    assert duration_text(duration_s) == text


def test_every_finding_is_about_something_that_has_a_word():
    codes = set()
    for house in ("planning", "missions", "reconstruction", "groundstation"):
        for path in (ROOT / house).rglob("*.py"):
            text = path.read_text("utf-8")
            codes |= set(re.findall(r'\bFinding\(\s*[\w.]+,\s*"([a-z-]+)"', text))
            codes |= set(re.findall(r'\bjudge\(\s*[^,]+,\s*"([a-z-]+)"', text)) if house == "planning" else set()
    assert len(codes) > 150
    assert sorted(code for code in codes if not subject_of(code)) == []
    assert str(subject_of("coverage-far")) == "Coverage"
    assert subject_of("word-of-a-plug-in") == ""
