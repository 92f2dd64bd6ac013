"""The question before take-off, as a pilot reads it."""

from dataclasses import replace

import pytest
from PySide6.QtWidgets import QWidget

from groundstation.gui.fly.questions import FlightQuestions
from groundstation.services.fly.sortie import take_off_of
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import PreflightCheck, Verdict
from planning.base.messages import say
from tests.gui.driving import clicked, escape
from tests.services.live_cases import sortie

TROUBLE = say(
    "it can be armed, but has trouble with: {}; find out why, or start only where the flight does without", "compass"
)


@pytest.fixture
def parent(application):
    widget = QWidget()
    widget.show()
    yield widget
    widget.close()


def test_warnings_of_the_list_are_read_where_the_pilot_agrees_to_start(parent):
    checks = (PreflightCheck("link", Verdict.OK, "well"), PreflightCheck("sensors", Verdict.WARN, TROUBLE))
    take_off = take_off_of(sortie(), None, checks)
    assert take_off.warnings == (TROUBLE,)
    questions = FlightQuestions()
    with clicked("Yes") as asked:
        assert questions.start(parent, take_off, UnitSystem.METRIC)
    assert "The list before take-off warns; by starting you confirm:" in asked[0]
    assert "it can be armed, but has trouble with: compass" in asked[0]
    assert "well" not in asked[0].split("confirm:")[1].split("Is everybody")[0]
    with clicked(escape):
        assert not questions.start(parent, take_off, UnitSystem.METRIC)
    with clicked("Yes") as asked:
        assert questions.start(parent, replace(take_off, warnings=()), UnitSystem.METRIC)
    assert "warns" not in asked[0]
