"""The findings view: verdict, filters, units, freshness, and the way to a place."""

from datetime import UTC, datetime

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.services.mission.readiness import FlightDay
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity

FINDINGS = (
    Finding(Severity.OK, "airspace", "viewpoints outside the airspace by: 0 m", "", 0.0, 0.0, "m"),
    Finding(Severity.ERROR, "leg-distance", "smallest distance along the path", "sortie 2, leg 5", 9.0, 10.0, "m"),
    Finding(Severity.WARNING, "settle", "hover before each photo", "", 0.5, 1.0, "s"),
)


@pytest.fixture
def view(application):
    from groundstation.gui.mission.mission_page import FindingsView

    view = FindingsView()
    view.resize(330, 400)
    view.show()
    yield view
    view.close()


def test_verdict_says_whether_anything_grounds_the_flight(view):
    assert view.verdict() == "Readiness not known"
    view.set_findings(FINDINGS)
    assert view.verdict() == "NOT ready to fly"
    view.set_findings([f for f in FINDINGS if f.severity is not Severity.ERROR])
    assert view.verdict() == "Ready to fly, but read the warnings"
    view.set_findings([f for f in FINDINGS if f.severity is Severity.OK])
    assert view.verdict() == "Ready to fly"
    unknown = Finding(Severity.NOTE, "zones", "which apply here is not looked at")
    view.set_findings([*(f for f in FINDINGS if f.severity is Severity.OK), unknown])
    assert view.verdict() == "Ready to fly; not looked at: zones"
    view.show_severity(Severity.NOTE, is_shown=False)
    assert "All checks passed; not looked at: zones." in view.list_view()._placeholder


def test_the_day_of_the_flight_is_said_by_clicks_and_may_be_left_open(view):
    box, said = view.day_box(), []
    view.dayChanged.connect(said.append)
    assert box.value() == FlightDay()
    assert not box.when.isEnabled()
    box.has_time.click()
    box.has_temperature.click()
    assert box.when.isEnabled()
    box.temperature.setValue(-5.0)
    assert said[-1].temperature_c == -5.0
    assert said[-1].at.tzinfo is not None
    box.has_time.click()
    assert said[-1] == FlightDay(None, -5.0)


@given(at=st.datetimes(datetime(2000, 1, 1), datetime(2090, 1, 1), timezones=st.just(UTC)), cold=st.integers(-40, 55))
@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_day_is_shown_to_the_minute(view, at, cold):
    at = at.replace(second=0, microsecond=0)
    view.day_box().setValue(FlightDay(at, float(cold)))
    assert view.day_box().value() == FlightDay(at, float(cold))


def test_old_findings_are_no_verdict_even_after_units_change(view):
    view.set_findings(FINDINGS[:1])
    view.set_stale()
    assert view.verdict() == "Readiness not known"
    assert "Older than the plan" in view.state_text()
    view.set_units(UnitSystem.IMPERIAL)
    assert view.verdict() == "Readiness not known"
    view.set_findings(FINDINGS[:1])
    assert view.verdict() == "Ready to fly"
    assert view.state_text() == ""


def test_rows_say_severity_rule_value_limit_and_place_gravest_first(view):
    view.set_findings(FINDINGS)
    first, second = view.list_view().texts()
    assert first.startswith("Error (Safety distance)\nsmallest distance")
    assert first.endswith("measured 9.0 m · limit 10.0 m · at sortie 2, leg 5")
    assert second.startswith("Warning (Route)")
    view.set_units(UnitSystem.IMPERIAL)
    assert "measured 29.5 ft · limit 32.8 ft" in view.list_view().texts()[0]


def test_each_severity_can_be_shown_and_hidden(view):
    view.set_findings(FINDINGS)
    view.show_severity(Severity.OK, True)
    view.show_severity(Severity.ERROR, False)
    assert [text.split()[0] for text in view.list_view().texts()] == ["Warning", "Kept"]
    assert view.verdict() == "NOT ready to fly"


def test_click_asks_for_the_place_where_there_is_one(view, qtbot):
    from PySide6.QtCore import Qt

    view.set_findings(FINDINGS)
    heard = []
    view.placePicked.connect(heard.append)
    for row in (0, 1):
        index = view.list_view().model().index(row, 0)
        place = view.list_view().visualRect(index).center()
        qtbot.mouseClick(view.list_view().viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert heard == ["sortie 2, leg 5"]


def test_severities_differ_in_shape_not_only_in_colour(application):
    from dataclasses import replace

    from groundstation.gui.widgets.findings_list import severity_icon
    from groundstation.gui.widgets.theme import LIGHT

    grey = replace(LIGHT, error="#404040", warning="#404040", note="#404040", ok="#404040")
    pictures = {bytes(severity_icon(s, grey).pixmap(22, 22).toImage().constBits()) for s in Severity}
    assert len(pictures) == 4
