"""A pilot at the real window: finds things by the words that stand on them, and has only a mouse and a keyboard.

What a test says in English is looked for in the window's language, in the file that the translators keep.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDialog,
    QLabel,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QTabBar,
    QWidget,
)

from groundstation.gui.widgets.hold_button import HoldButton
from groundstation.services.settings import Language
from tests.gui.driving import LOOK_MS, click_on, hold_on, scroll_to, turn_until, turn_until_idle, type_into
from tests.gui.words import german, left_in_english, pattern, plain, text_of

PICTURES = os.environ.get("REFLIGHT_ACCEPTANCE_PICTURES", "")
"""Folder into which the window is photographed at each stage; none unless one is named."""

PATIENCE_S = 240.0


def stay(_dialog: QDialog) -> None:
    """A step: leave a dialog open, to be worked in afterwards."""


class Pilot:
    """Looks at the window, clicks and types."""

    def __init__(self, application: QApplication, controller, folder: Path) -> None:
        self.application, self.controller, self.folder = application, controller, folder
        self.language = Language.ENGLISH
        self._n_pictures, self._own_window = 0, None

    # What is there

    @property
    def window(self) -> QWidget:
        """What can be clicked: the dialog in front, or the window that is worked in."""
        front = QApplication.activeModalWidget()
        return self._own_window or self.controller.window if front is None else front

    def words(self, text: str) -> tuple[str, ...]:
        """What a text may be called in the language of the window."""
        if self.language is Language.ENGLISH:
            return (text,)
        if text in german():
            return german()[text]
        # Some are put together: “Data set: Choose ...”, “Defect ...”.
        for mark in (": ", " ..."):
            first, found, rest = text.partition(mark)
            if found:
                endings = self.words(rest) if rest else ("",)
                return tuple(first_words + mark + ending for first_words in self.words(first) for ending in endings)
        raise LookupError(f"“{text}” is no text of the window, or has no translation")

    def says(self) -> str:
        """All that can be read."""
        return "\n".join(text for text in map(text_of, self._visible(QWidget)) if text)

    def reads(self, text: str) -> bool:
        """Whether a text stands somewhere; the gaps of a template, as “{0}”, may hold anything."""
        shown = self.says()
        return any(re.search(pattern(each), shown) for each in self.words(text))

    def button(self, text: str) -> QAbstractButton:
        """A button by what stands on it, or by its name."""
        texts = self.words(text)
        buttons = self._visible(QAbstractButton)
        found = [each for each in buttons if plain(each.text()) in texts or each.accessibleName() in texts]
        assert found, f"no button {texts}, but {sorted({plain(each.text()) for each in buttons})}"
        return found[0]

    def field(self, label: str) -> QWidget:
        """What is filled in behind a label."""
        texts = self.words(label)
        for each in self._visible(QLabel):
            if plain(each.text()) in texts and each.buddy() is not None:
                return each.buddy()
        named = [each for each in self._visible(QWidget) if each.accessibleName() in texts]
        assert named, f"nothing is labelled {texts}"
        return named[0]

    def lines(self, table: str) -> list[str]:
        """What stands in the first column of a list."""
        view = self.field(table)
        assert isinstance(view, QAbstractItemView)
        model = view.model()
        return [str(model.index(row, 0).data()) for row in range(model.rowCount())]

    # What is done

    def come_to_front(self) -> None:
        """Give the keyboard to what is in front, as the desktop does when a dialog has gone."""
        window = self.window
        if not window.isActiveWindow():
            window.activateWindow()
            self.until(window.isActiveWindow, "the window is in front")

    def press(self, text: str) -> None:
        """Click a button, once it can be pressed; one that acts when it is held is held."""
        self.come_to_front()
        button = self.button(text)
        self.until(button.isEnabled, f"“{text}” can be pressed")
        scroll_to(button)
        if isinstance(button, HoldButton):
            hold_on(button.window(), button)
        else:
            click_on(button.window(), button)
        self.application.processEvents()

    def tab(self, text: str) -> None:
        """Click a tab."""
        texts = self.words(text)
        bars = self._visible(QTabBar)
        for bar in bars:
            for number in range(bar.count()):
                if re.sub(r" \(\d+\)$", "", plain(bar.tabText(number))) in texts:
                    click_on(bar.window(), bar, bar.tabRect(number).center())
                    self.idle()
                    return
        raise AssertionError(f"no tab {texts}, but {[bar.tabText(n) for bar in bars for n in range(bar.count())]}")

    def choose(self, label: str, text: str) -> None:
        """Choose in a box: by Home and arrows, as somebody does who came by Tab."""
        self.come_to_front()
        box, texts = self.field(label), self.words(text)
        assert isinstance(box, QComboBox)
        scroll_to(box)
        box.setFocus()
        QTest.keyClick(box, Qt.Key.Key_Home)
        for _ in range(box.count()):
            if box.currentText() in texts:
                break
            QTest.keyClick(box, Qt.Key.Key_Down)
        assert box.currentText() in texts, f"{[box.itemText(n) for n in range(box.count())]} without {texts}"

    def fill(self, label: str, text: str) -> None:
        """Type into a field."""
        self.come_to_front()
        box = self.field(label)
        scroll_to(box)
        assert box.isEnabled(), f"{label} cannot be filled in"
        if isinstance(box, QPlainTextEdit):
            box.setFocus()
            QTest.keyClicks(box, text)
            return
        line = box.findChild(QLineEdit) if isinstance(box, (QAbstractSpinBox, QComboBox)) else box
        type_into(line, text)
        QTest.keyClick(line, Qt.Key.Key_Tab)

    def entry(self, button: str, text: str) -> None:
        """Choose an entry of a button's menu."""
        texts = self.words(text)
        again = QTimer(self.controller, interval=LOOK_MS)
        problems: list[str] = []

        def click() -> None:
            menu = QApplication.activePopupWidget()
            if not isinstance(menu, QMenu):
                return
            again.stop()
            found = [each for each in menu.actions() if plain(each.text()) in texts]
            if found:
                QTest.mouseClick(menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(found[0]).center())
            else:
                problems.append(f"no entry {texts}, but {[each.text() for each in menu.actions()]}")
                menu.close()

        again.timeout.connect(click)
        again.start()
        self.press(button)
        assert not problems, problems
        again.deleteLater()

    def row(self, table: str, number: int, *, with_ctrl: bool = False, column: int = 0, twice: bool = False) -> None:
        """Click a row of a table or list."""
        view = self.field(table)
        assert isinstance(view, QAbstractItemView)
        index = view.model().index(number, column)
        assert index.isValid(), f"{table} has {view.model().rowCount()} rows"
        view.scrollTo(index)
        keys = Qt.KeyboardModifier.ControlModifier if with_ctrl else Qt.KeyboardModifier.NoModifier
        place = view.visualRect(index).center()
        QTest.mouseClick(view.viewport(), Qt.MouseButton.LeftButton, keys, place)
        if twice:
            QTest.mouseDClick(view.viewport(), Qt.MouseButton.LeftButton, keys, place)
        self.application.processEvents()

    @contextmanager
    def in_window(self, title: str) -> Iterator[None]:
        """Work in another window than the main one, and close it afterwards by its cross."""
        texts = self.words(title)
        shown = [each for each in QApplication.topLevelWidgets() if each.isVisible()]
        self._own_window = next((each for each in shown if each.windowTitle() in texts), None)
        assert self._own_window is not None, f"no window {texts}, but {[each.windowTitle() for each in shown]}"
        try:
            yield
        finally:
            self._own_window.close()
            self._own_window = None

    def speak(self, language: Language) -> None:
        """Choose the language, View > Language."""
        if language is not self.language:
            self.controller.choose(language=language)
            self.language = language
            self.until(lambda: self.controller.window.shared_view.scene() is not None, "the window is back")
            self.controller.window.setGeometry(0, 0, 1280, 720)
            self.come_to_front()

    # Waiting

    def until(self, condition: Callable[[], bool], what: str, timeout_s: float = PATIENCE_S) -> None:
        """Wait until something is so."""
        try:
            turn_until(self.application, condition, timeout_s)
        except AssertionError:
            self.see("stuck")
            raise AssertionError(f"waited {timeout_s:.0f} s until {what}; what stands there:\n{self.says()}") from None

    def until_reads(self, text: str, timeout_s: float = PATIENCE_S) -> None:
        """Wait until a text stands somewhere."""
        self.until(lambda: self.reads(text), f"“{text}” stands there", timeout_s)

    def idle(self) -> None:
        """Wait until nothing runs."""
        turn_until_idle(self.application, self.controller, PATIENCE_S)

    def see(self, name: str) -> None:
        """Look at the window: all is in its language. Take a picture of the screen, where pictures are wanted."""
        if self.language is Language.GERMAN:
            left = left_in_english(self.window)
            assert not left, f"on “{name}” stands in English: {left}"
        if PICTURES:
            self._n_pictures += 1
            end = time.perf_counter() + 0.3
            while time.perf_counter() < end:
                self.application.processEvents()
            target = Path(PICTURES) / f"{self.language.value}-{self._n_pictures:02d}-{name}.png"
            target.parent.mkdir(parents=True, exist_ok=True)
            QApplication.primaryScreen().grabWindow(0, 0, 0, 1280, 720).save(str(target))

    def _visible(self, kind: type) -> list:
        window = self.window
        return [each for each in window.findChildren(kind) if each.isVisible() and each.window() is window]
