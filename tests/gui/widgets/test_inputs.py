"""Input boxes are metric inside whatever stands on screen, and give a value back exactly as it was set."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.services.units import FOOT_M, UnitSystem
from tests.gui.driving import turn_until


@pytest.fixture
def length_box(application):
    from groundstation.gui.widgets.inputs import LengthBox

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


def test_a_value_that_cannot_be_typed_is_shown_and_kept_until_it_is_edited(application):
    from groundstation.gui.widgets.inputs import LengthBox

    box = LengthBox(0.0, 200.0, system=UnitSystem.IMPERIAL)
    box.setValue(250.0)
    assert box.value() == 250.0
    assert box.box().text() == "820.2 ft"
    box.set_units(UnitSystem.METRIC)
    assert (box.value(), box.box().text()) == (250.0, "250.0 m")
    box.setValue(10.0)
    assert box.box().maximum() == 200.0, "with the value goes the room for it"
    box.box().setValue(box.box().maximum())
    assert box.value() == 200.0


@given(st.floats(-1e7, 1e7), st.integers(0, 3), st.floats(-10.0, 0.0), st.floats(1.0, 10.0))
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_number_comes_back_exactly_also_while_it_is_announced(application, value, decimals, low, high):
    from groundstation.gui.widgets.inputs import NumberBox

    box = NumberBox(low, high, 1.0, decimals=decimals)
    heard = []
    box.valueChanged.connect(lambda _shown: heard.append(box.value()))
    box.setValue(value)
    assert box.value() == value
    assert heard in ([], [value])
    box.setDecimals(4)
    assert box.value() == value
    box.setRange(low, high)
    assert box.value() == value
    box.stepUp()
    assert box.value() != value or box.value() >= high


@given(st.integers(0, 2**63 - 1))
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whole_numbers_of_64_bits_are_shown_typed_and_given_back(application, value):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.widgets.inputs import WholeBox

    box, heard = WholeBox(0, 2**63 - 1), []
    box.valueChanged.connect(heard.append)
    box.setValue(value)
    assert (box.value(), box.text()) == (value, str(value))
    box.selectAll()
    QTest.keyClicks(box, str(value // 3))
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.value() == value // 3
    box.stepBy(1)
    assert box.value() == value // 3 + 1
    QTest.keyClicks(box, "x-")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.value() == value // 3 + 1
    assert set(heard) <= {value, value // 3, value // 3 + 1}


def test_whole_numbers_outside_of_what_is_allowed_are_not_taken(application):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.widgets.inputs import WholeBox

    box = WholeBox(1, 100)
    box.setValue(50)
    for typed in ("0", "", "101", "7.5"):
        box.selectAll()
        QTest.keyClick(box, Qt.Key.Key_Backspace)
        QTest.keyClicks(box, typed)
        QTest.keyClick(box, Qt.Key.Key_Return)
        assert 1 <= box.value() <= 100, typed
    box.stepBy(1000)
    assert box.value() == 100
    box.setValue(300)
    assert box.value() == 300
    box.setValue(5)
    assert box.maximum() == 100


def boxes_that_turn():
    """Every kind of box that a wheel could change."""
    from PySide6.QtWidgets import QDateTimeEdit, QSlider

    from groundstation.gui.widgets.inputs import ChoiceBox, LengthBox, NumberBox, WholeBox, calm

    choice, length, slider, when = ChoiceBox(), LengthBox(0.0, 10.0), QSlider(), QDateTimeEdit()
    choice.addItems(["a", "b", "c"])
    choice.setCurrentIndex(1)
    slider.setValue(50)
    for box in (slider, when):
        calm(box)
    number, whole = NumberBox(0.0, 10.0, 1.0), WholeBox(0, 10)
    number.setValue(5.0)
    whole.setValue(5)
    length.setValue(5.0)
    return (
        (number, number.value),
        (whole, whole.value),
        (length.box(), length.value),
        (choice, choice.currentIndex),
        (slider, slider.value),
        (when, when.dateTime),
    )


def turn_the_wheel(application, box):
    """As the system tells it: whoever takes the focus by the wheel gets it."""
    from PySide6.QtCore import QPoint, QPointF
    from PySide6.QtTest import QTest

    window = box.window()
    QTest.wheelEvent(window.windowHandle(), QPointF(box.mapTo(window, box.rect().center())), QPoint(0, 120))
    application.processEvents()


def test_the_wheel_scrolls_the_form_and_changes_no_box_even_if_it_has_the_focus(application):
    from PySide6.QtCore import Qt
    from PySide6.QtWidgets import QPushButton, QSlider, QVBoxLayout, QWidget

    class Form(QWidget):
        turns = 0

        def wheelEvent(self, event):  # noqa: N802
            self.turns += 1
            event.accept()

    form = Form()
    layout, boxes = QVBoxLayout(form), boxes_that_turn()
    first = QPushButton("first")
    layout.addWidget(first)
    for box, _ in boxes:
        layout.addWidget(box)
        assert not (box.focusPolicy() & Qt.FocusPolicy.WheelFocus & ~Qt.FocusPolicy.StrongFocus), type(box)
    form.show()
    form.activateWindow()
    first.setFocus()
    turn_until(application, first.hasFocus)
    for box, value in boxes:
        before, turns = value(), form.turns
        turn_the_wheel(application, box)
        assert value() == before, type(box)
        assert form.turns == turns + 1, "the form scrolls"
        box.setFocus()
        turn_until(application, box.hasFocus)
        turn_the_wheel(application, box)
        # The box that was typed into last may slide under the pointer while the form scrolls.
        assert (value() == before) is not isinstance(box, QSlider), type(box)
    form.close()


@pytest.mark.parametrize("make", [lambda of: of.WholeBox(0, 100), lambda of: of.NumberBox(0.0, 100.0, 1.0)])
def test_what_was_typed_counts_before_a_shortcut_does(application, make):
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QAction, QKeySequence
    from PySide6.QtTest import QTest
    from PySide6.QtWidgets import QVBoxLayout, QWidget

    from groundstation.gui.widgets import inputs

    form, box, seen = QWidget(), make(inputs), []
    QVBoxLayout(form).addWidget(box)
    action = QAction("plan", form)
    action.setShortcut(QKeySequence("Ctrl+P"))
    action.triggered.connect(lambda: seen.append(box.value()))
    form.addAction(action)
    form.show()
    form.activateWindow()
    turn_until(application, form.isActiveWindow)
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "12")
    QTest.keyClick(box, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    assert box.value() == 0.0, "copying is no order"
    QTest.keyClick(box, Qt.Key.Key_P, Qt.KeyboardModifier.ControlModifier)
    assert seen == [12]
    form.close()


@pytest.mark.parametrize("language", ["en_US", "de_DE", "fr_FR"])
@pytest.mark.parametrize("typed", ["3.5", "3,5"])
def test_a_decimal_point_and_a_comma_are_the_same_in_every_language(application, language, typed):
    from PySide6.QtCore import QLocale, Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.widgets.inputs import NumberBox

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
