"""Input boxes are metric inside whatever stands on screen, and give a value back exactly as it was set."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.services.units import FOOT_M, UnitSystem


@pytest.fixture
def length_box(application):
    from groundstation.gui.inputs import LengthBox

    return LengthBox(-5000.0, 5000.0, decimals=2)


@given(st.floats(-5000.0, 5000.0), st.lists(st.sampled_from(UnitSystem), max_size=6))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
def test_a_value_survives_any_number_of_changes_of_units(length_box, value, systems):
    heard = []
    length_box.valueChanged.connect(heard.append)
    length_box.setValue(value)
    for system in systems:
        length_box.set_units(system)
        shown = value if system is UnitSystem.METRIC else value / FOOT_M
        assert length_box.box().value() == pytest.approx(shown, abs=0.0051)
    assert length_box.value() == value
    assert not heard, "only edits of the user are announced"
    length_box.valueChanged.disconnect(heard.append)


def test_an_edit_in_feet_is_announced_in_metres(length_box):
    heard = []
    length_box.set_units(UnitSystem.IMPERIAL)
    length_box.valueChanged.connect(heard.append)
    length_box.box().setValue(100.0)
    assert heard == [pytest.approx(30.48)]
    assert length_box.box().suffix() == " ft"


def test_values_outside_the_range_go_to_its_end_in_both_units(application):
    from groundstation.gui.inputs import LengthBox

    box = LengthBox(0.0, 200.0, system=UnitSystem.IMPERIAL)
    box.setValue(1e9)
    assert box.value() == 200.0
    box.box().setValue(box.box().maximum())
    assert box.value() <= 200.0


def test_the_wheel_scrolls_the_form_unless_the_box_has_the_focus(application):
    from PySide6.QtCore import QPoint, QPointF, Qt
    from PySide6.QtGui import QWheelEvent

    from groundstation.gui.inputs import NumberBox

    box = NumberBox(0.0, 10.0, 1.0)
    box.setValue(5.0)
    event = QWheelEvent(
        QPointF(5, 5),
        QPointF(5, 5),
        QPoint(0, 0),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    box.wheelEvent(event)
    assert box.value() == 5.0
    assert not event.isAccepted()


@pytest.mark.parametrize("language", ["en_US", "de_DE", "fr_FR"])
@pytest.mark.parametrize("typed", ["3.5", "3,5"])
def test_a_decimal_point_and_a_comma_are_the_same_in_every_language(application, language, typed):
    from PySide6.QtCore import QLocale, Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.inputs import NumberBox

    before = QLocale()
    QLocale.setDefault(QLocale(language))
    try:
        box = NumberBox(0.0, 100.0, 1.0, " m")
        box.selectAll()
        QTest.keyClicks(box, typed)
        QTest.keyClick(box, Qt.Key.Key_Return)
        assert box.value() == 3.5
        assert box.text() == "3.5 m"
    finally:
        QLocale.setDefault(before)
