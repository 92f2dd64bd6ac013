"""A button that acts once it was held: not by a slip, and by finger and key alike."""

import time

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolTip

from groundstation.gui.widgets.hold_button import HOLD_MS, NEAR_PX, HoldButton

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def button(application):
    button = HoldButton("Return")
    button.acted = []
    button.clicked.connect(lambda: button.acted.append(True))
    button.resize(200, 60)
    button.show()
    application.processEvents()
    yield button
    button.close()


def wait(duration_s):
    end = time.monotonic() + duration_s
    while time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.005)


@pytest.mark.long
def test_a_press_that_lasts_acts_once_and_a_slip_does_not(button):
    for _ in range(3):
        QTest.mouseClick(button, LEFT)
        QTest.mouseDClick(button, LEFT)
    wait(0.1)
    assert not button.acted
    QTest.mousePress(button, LEFT)
    wait(0.5 * HOLD_MS / 1000.0)
    assert not button.acted
    assert button.is_held()
    wait(1.2 * HOLD_MS / 1000.0)
    assert button.acted == [True], "still pressed, it acts no second time"
    QTest.mouseRelease(button, LEFT)
    assert button.acted == [True]


def no_hint():
    """Whatever hint is shown goes."""
    QToolTip.hideText()
    end = time.monotonic() + 60.0
    while QToolTip.isVisible() and time.monotonic() < end:
        wait(0.01)
    assert not QToolTip.isVisible()


@pytest.mark.long
def test_a_press_that_is_too_short_says_what_to_do(button):
    def by_mouse():
        QTest.mousePress(button, LEFT)
        yield
        QTest.mouseRelease(button, LEFT)

    def by_key():
        QTest.keyPress(button, Qt.Key.Key_Space)
        yield
        QTest.keyRelease(button, Qt.Key.Key_Space)

    for press in (by_mouse, by_key):
        no_hint()
        for _ in press():
            assert not QToolTip.isVisible()
        assert QToolTip.isVisible()
        assert "Keep it pressed" in QToolTip.text()
    no_hint()
    for _ in by_mouse():
        wait(1.7 * HOLD_MS / 1000.0)
    assert button.acted == [True]
    assert not QToolTip.isVisible(), "it was held long enough"


def test_its_bar_shows_how_long_it_is_held(application, button):
    def bar_px():
        image = button.grab().toImage()
        row = [image.pixelColor(x, image.height() - 4) for x in range(4, image.width() - 4)]
        return sum(colour.lightness() < 100 for colour in row)

    assert bar_px() == 0
    QTest.mousePress(button, LEFT)
    wait(0.4 * HOLD_MS / 1000.0)
    early = bar_px()
    wait(0.3 * HOLD_MS / 1000.0)
    assert 0 < early < bar_px()
    QTest.mouseRelease(button, LEFT)
    assert bar_px() == 0


@pytest.mark.long
def test_a_key_is_held_as_a_finger_is_though_it_repeats_itself(button):
    button.setFocus()
    press, release = QKeyEvent.Type.KeyPress, QKeyEvent.Type.KeyRelease
    none = Qt.KeyboardModifier.NoModifier
    QTest.keyPress(button, Qt.Key.Key_Space)
    end = time.monotonic() + 1.3 * HOLD_MS / 1000.0
    while time.monotonic() < end:
        for kind in (release, press):
            QApplication.sendEvent(button, QKeyEvent(kind, Qt.Key.Key_Space, none, " ", True))
        wait(0.03)
    assert button.acted == [True]
    QTest.keyRelease(button, Qt.Key.Key_Space)
    QTest.keyClick(button, Qt.Key.Key_Return)
    wait(0.1)
    assert button.acted == [True]


@pytest.mark.long
@pytest.mark.parametrize("away", ["slides off", "focus goes", "is disabled", "is hidden"])
def test_it_is_let_go_by_whatever_ends_the_hold(button, away):
    button.setFocus()
    QTest.mousePress(button, LEFT)
    wait(0.05)
    if away == "slides off":
        QTest.mouseMove(button, QPoint(100, 59 + NEAR_PX - 1))
        wait(0.05)
        assert button.is_held(), "a finger is wide"
        QTest.mouseMove(button, QPoint(100, 60 + 2 * NEAR_PX))
    elif away == "focus goes":
        QApplication.sendEvent(button, QFocusEvent(QFocusEvent.Type.FocusOut))
    elif away == "is disabled":
        button.setEnabled(False)
    else:
        button.hide()
    wait(1.2 * HOLD_MS / 1000.0)
    assert not button.acted
    assert not button.is_held()


def test_shortcuts_and_screen_readers_act_at_once(button):
    button.click()
    assert button.acted == [True]


@pytest.mark.long
def test_while_the_window_stands_still_nothing_is_held(button):
    """The finger was lifted meanwhile, and that is heard after the timer."""
    QTest.mousePress(button, LEFT)
    time.sleep(1.5 * HOLD_MS / 1000.0)
    QApplication.processEvents()
    assert not button.acted
    QTest.mouseRelease(button, LEFT)
    wait(0.1)
    assert not button.acted
