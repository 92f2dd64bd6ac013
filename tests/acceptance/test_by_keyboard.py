"""A new user's way a month later: from the start page to the report of a simulated flight, by keyboard alone."""

import sys
import time

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QDialog, QLabel, QWidget

from groundstation.gui.view3d.canvas import image_array
from groundstation.gui.widgets.hold_button import HOLD_MS, HoldButton
from tests.gui.driving import LOOK_MS, turn_until

MOST_KEYS = 80
"""On all of the way: the distance to what is wanted counts, too."""

LEAST_SEEN_PX = 100
"""Pixels that change where the keyboard comes to: a border of 2 px around the smallest button has more."""

PATIENCE_S = 20.0


class Keys:
    """A hand on the keyboard. It knows where the keyboard is from what changes on the screen."""

    def __init__(self, pilot):
        self.pilot, self.n_pressed = pilot, 0

    def press(self, key, modifiers=Qt.KeyboardModifier.NoModifier):
        QTest.keyClick(self._target(), key, modifiers)
        self.n_pressed += 1
        self._turn()

    def hold(self, key):
        button = self._target()
        QTest.keyPress(button, key)
        self._turn(1e-3 * HOLD_MS + 0.3)
        QTest.keyRelease(button, key)
        self.n_pressed += 1
        self._turn()

    def reach(self, text, key=Qt.Key.Key_Tab):
        """Go on by Tab, or back by Shift and Tab, until the keyboard is where a text stands; each stop is seen."""
        words, ways = self.pilot.words(text), []
        for _ in range(40):
            now = QApplication.focusWidget()
            if now is not None and set(_names(now)) & set(words):
                return now
            before = self._screen()
            shift = Qt.KeyboardModifier.ShiftModifier
            self.press(key, shift if key == Qt.Key.Key_Backtab else Qt.KeyboardModifier.NoModifier)
            came = QApplication.focusWidget()
            assert came is not None, f"after {ways} the keyboard is nowhere"
            ways.append(_names(came))
            n_px = _n_changed(before, self._screen(), came)
            assert n_px >= LEAST_SEEN_PX, f"on the way to “{text}”: {ways[-1]} has the keyboard, and nobody sees it"
        raise AssertionError(f"“{text}” is not reached, but {ways}")

    def _target(self):
        return QApplication.focusWidget() or self.pilot.window

    def _turn(self, for_s=0.15):
        end = time.perf_counter() + for_s
        turn_until(self.pilot.application, lambda: time.perf_counter() > end)

    def _screen(self) -> QImage:
        return QApplication.primaryScreen().grabWindow(0, 0, 0, 1280, 720).toImage()


def _names(widget: QWidget) -> tuple[str, ...]:
    text = widget.text().replace("&", "") if isinstance(widget, (QAbstractButton, QLabel)) else ""
    return tuple(name for name in (text, widget.accessibleName()) if name) or (type(widget).__name__,)


def _n_changed(before: QImage, after: QImage, widget: QWidget) -> int:
    """Pixels that are not as they were, on a widget and next to it."""
    place, around = widget.mapToGlobal(QPoint(0, 0)), 3
    rows = slice(max(0, place.y() - around), place.y() + widget.height() + around)
    columns = slice(max(0, place.x() - around), place.x() + widget.width() + around)
    changed = np.abs(image_array(after).astype(int) - image_array(before).astype(int)).sum(axis=2) > 40
    return int(changed[rows, columns].sum())


@pytest.mark.slow
@pytest.mark.alone
def test_from_the_start_page_to_the_report_of_a_simulated_flight_by_keyboard_alone(pilot):
    keys, bar, window = Keys(pilot), pilot.controller.window.next_step, pilot.controller.window
    pilot.come_to_front()
    keys.reach("Bundled site")
    pilot.see("start")
    keys.press(Qt.Key.Key_Return)
    pilot.until(lambda: window.shown_tab() == "site", "the site is shown")
    pilot.idle()
    # Once by Tab, as somebody does who knows no key of this window.
    keys.reach("To Plan", Qt.Key.Key_Backtab)
    pilot.see("site")
    keys.press(Qt.Key.Key_Return)
    pilot.until(lambda: window.shown_tab() == "plan", "the Plan tab is shown")
    pilot.idle()
    keys.reach("Plan the flight", Qt.Key.Key_Backtab)
    keys.press(Qt.Key.Key_Return)
    pilot.until(lambda: "viewpoints:" in bar.text(), "there is a plan")
    pilot.idle()
    pilot.see("planned")
    # Then by the key of the next step, and by that of a tab.
    keys.press(Qt.Key.Key_F8)
    pilot.until(
        lambda: "all checks passed; not looked at: zones, sun, batteries' temperature" in bar.text(),
        "the plan is checked",
    )
    pilot.idle()
    keys.press(Qt.Key.Key_4, Qt.KeyboardModifier.ControlModifier)
    pilot.until(lambda: window.shown_tab() == "fly", "the Fly tab is shown")
    pilot.idle()
    keys.press(Qt.Key.Key_F8)
    pilot.until(lambda: bar.button.text() == "Upload", "the vehicle is there")
    pilot.see("connected")
    keys.press(Qt.Key.Key_F8)
    pilot.until(lambda: bar.button.text() == "Start", "the flight can be started")
    pilot.see("ready")
    _start_by_holding(pilot, keys)
    pilot.come_to_front()
    page = window.tab("fly")
    pilot.until(lambda: page.n_photos() >= 5, "photos are taken")
    keys.reach("Land")
    pilot.see("in flight")
    pilot.until(
        lambda: bar.text().startswith("Done: flown; ") and "Next: read the photos" in bar.text(), "the flight is over"
    )
    pilot.idle()
    keys.reach("Messages")
    pilot.see("report")
    assert pilot.reads("Photos: {0} of {1} views; sections covered: {2} of {3} planned ({4:.1f} %)")
    sys.stdout.write(f"{keys.n_pressed} keys\n")
    assert keys.n_pressed <= MOST_KEYS


def _start_by_holding(pilot, keys):
    """Hold Start with Enter, and answer the question with Tab and Enter, as it stands there."""
    asked: list[str] = []
    timer = QTimer(pilot.controller, interval=LOOK_MS)
    end = time.perf_counter() + PATIENCE_S

    def answer():
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, QDialog) or not dialog.isVisible():
            return
        timer.stop()
        asked.append(dialog.windowTitle())
        dialog.activateWindow()
        while dialog.focusWidget() is None or not set(_names(dialog.focusWidget())) & set(pilot.words("Yes")):
            assert time.perf_counter() < end, "“Yes” is not reached"
            QTest.keyClick(dialog.focusWidget() or dialog, Qt.Key.Key_Tab)
            keys.n_pressed += 1
        pilot.see("question")
        QTest.keyClick(dialog.focusWidget(), Qt.Key.Key_Return)
        keys.n_pressed += 1

    timer.timeout.connect(answer)
    timer.start()
    button = keys.reach("Start")
    if not isinstance(button, HoldButton):
        keys.press(Qt.Key.Key_Tab)
        button = keys.reach("Start")
    assert isinstance(button, HoldButton)
    keys.hold(Qt.Key.Key_Return)
    pilot.until(lambda: bool(asked), "it asks before it starts")
