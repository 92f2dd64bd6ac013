"""A user who tries everything: clicks, keys and words at random, on whatever the window shows.

`python -m tests.gui.random_user SEED SECONDS FOLDER LANGUAGE [PROJECT]` writes what went wrong to stdout, with what
was done before it: exceptions, messages of Qt, English in a German window, and layouts whose items PySide holds for
gone. A crash ends the process.
"""

from __future__ import annotations

import faulthandler
import os
import random
import sys
import threading
import time
import traceback
from collections import deque
from pathlib import Path

from PySide6.QtCore import QPoint, Qt, QTimer, qInstallMessageHandler
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QFileDialog,
    QLineEdit,
    QMainWindow,
    QMenu,
    QTabBar,
    QWidget,
)
from shiboken6 import isValid

from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.widgets.hold_button import HoldButton
from groundstation.gui.widgets.scrolling import WrappingRow
from tests.gui.screen import start_virtual_screen
from tests.gui.words import left_in_english

PACE_MS, START_MS, HOLD_MS, KEPT = 25, 4000, 1500, 12

ACTS_PER_READING = 5
"""All that stands in a window is read in a quarter of a second."""

WORDS = ("", "1", "-1", "0", "99999", "abc", "12.5", "47.37, 8.54", "a/b", "1e9", "%n", "{0}", " ", "C:\\x", "nan", "ä")

KEYS = (
    Qt.Key.Key_Tab,
    Qt.Key.Key_Backtab,
    Qt.Key.Key_Return,
    Qt.Key.Key_Escape,
    Qt.Key.Key_Space,
    Qt.Key.Key_Delete,
    Qt.Key.Key_Up,
    Qt.Key.Key_Down,
    Qt.Key.Key_F8,
)

NEVER_CHOSEN = ("Quit", "Beenden", "English", "Deutsch")
"""Entries of menus: the language stays."""

USUAL = ("propagateSizeHints", "QFont", "libEGL", "QStandardPaths", "XDG_RUNTIME", "fontconfig", "GLX")
"""Messages of Qt about the screen and the fonts of a computer without either."""

KINDS = (QAbstractButton, QComboBox, QAbstractSpinBox, QLineEdit, QAbstractSlider, QTabBar, QAbstractItemView, Canvas)


class RandomUser:
    """Acts until its time is over, and tells what went wrong."""

    def __init__(self, seed: int, seconds: float, folder: Path, language: str) -> None:
        self.n_faults, self.n_acts = 0, 0
        self._is_german, self._told = language == "de", set[str]()
        self._rng, self._folder = random.Random(seed), folder
        self._end = time.monotonic() + seconds
        self._done: deque[str] = deque(maxlen=KEPT)
        self._rows: list[WrappingRow] = []
        self._listen()

    def tell(self, what: str) -> None:
        """Write what went wrong, and what was done before it."""
        self.n_faults += 1
        lines = "\n".join(f"  {act}" for act in self._done)
        sys.stdout.write(f"== {what}\nafter {self.n_acts} acts, the last:\n{lines}\n")
        sys.stdout.flush()

    def act(self) -> None:
        """Do one thing, and come again; dialogs that this brings up are acted on by the next ones."""
        if time.monotonic() > self._end:
            sys.stdout.write(f"{self.n_acts} acts, {self.n_faults} faults\n")
            sys.stdout.flush()
            os._exit(min(1, self.n_faults))
        QTimer.singleShot(PACE_MS, self.act)
        self._look_at_rows()
        self._read()
        self.n_acts += 1
        try:
            self._act_on(QApplication.activePopupWidget() or QApplication.activeModalWidget() or self._window())
        except RuntimeError as error:  # what was to be clicked went meanwhile
            if "already deleted" not in str(error):
                raise

    def _listen(self) -> None:
        sys.excepthook = lambda *error: self.tell("".join(traceback.format_exception(*error)))
        threading.excepthook = lambda args: self.tell(f"in a thread: {args.exc_type} {args.exc_value}")
        qInstallMessageHandler(
            lambda _kind, _at, text: None if any(each in text for each in USUAL) else self.tell(text)
        )
        begin, rows = WrappingRow.__init__, self._rows

        def noted(row: WrappingRow, *arguments: object, **named: object) -> None:
            begin(row, *arguments, **named)
            rows.append(row)

        WrappingRow.__init__ = noted

    def _look_at_rows(self) -> None:
        for row in [row for row in self._rows if isValid(row)]:
            lost = sum(not isValid(row.itemAt(number)) for number in range(row.count()))
            if lost:
                self._rows.remove(row)
                self.tell(f"{lost} of {row.count()} things in a row count as gone")

    def _read(self) -> None:
        host = QApplication.activeModalWidget() or self._window()
        if self._is_german and host is not None and self.n_acts % ACTS_PER_READING == 0:
            new = [line for line in left_in_english(host) if line not in self._told]
            self._told.update(new)
            for line in new:
                self.tell(f"in English: {line}")

    def _window(self) -> QWidget | None:
        return next((one for one in QApplication.topLevelWidgets() if isinstance(one, QMainWindow)), None)

    def _act_on(self, host: QWidget | None) -> None:
        draw = self._rng.random()
        if isinstance(host, QMenu):
            self._choose_in(host)
        elif isinstance(host, QFileDialog):
            self._answer(host)
        elif host is not None and draw < 0.08:
            key, on = self._rng.choice(KEYS), QApplication.focusWidget() or host
            self._done.append(f"key {key.name} on {_name(on)}")
            QTest.keyClick(on, key)
        elif isinstance(host, QMainWindow) and draw < 0.11:
            bar = host.menuBar()
            action = self._rng.choice([each for each in bar.actions() if each.isVisible()])
            self._done.append(f"menu {action.text()}")
            QTest.mouseClick(bar, Qt.MouseButton.LeftButton, pos=bar.actionGeometry(action).center())
        elif host is not None:
            shown = [each for each in host.findChildren(QWidget) if isinstance(each, KINDS) and _can_be_used(each)]
            if shown:
                # Kinds by turns: of some there are hundreds, of others one.
                kind = self._rng.choice(sorted({type(each).__name__ for each in shown}))
                self._use(self._rng.choice([each for each in shown if type(each).__name__ == kind]))

    def _choose_in(self, menu: QMenu) -> None:
        actions = [each for each in menu.actions() if each.isEnabled() and each.isVisible() and each.text()]
        actions = [each for each in actions if each.text().replace("&", "") not in NEVER_CHOSEN]
        if not actions or self._rng.random() < 0.2:
            QTest.keyClick(menu, Qt.Key.Key_Escape)
            return
        action = self._rng.choice(actions)
        self._done.append(f"entry {action.text()}")
        QTest.mouseClick(menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(action).center())

    def _answer(self, dialog: QFileDialog) -> None:
        if self._rng.random() < 0.5:
            self._done.append(f"leave {dialog.windowTitle()}")
            dialog.reject()
            return
        files = [str(path) for path in sorted(self._folder.rglob("*"))[:400]]
        name = self._rng.choice([*files, "/nowhere/x", str(self._folder / f"new{self._rng.randrange(9)}")])
        self._done.append(f"{dialog.windowTitle()}: {name}")
        dialog.findChildren(QLineEdit)[0].setText(name)
        dialog.accept()

    def _use(self, widget: QWidget) -> None:
        self._done.append(_name(widget))
        left = Qt.MouseButton.LeftButton
        if isinstance(widget, QAbstractSpinBox | QLineEdit):
            widget.setFocus()
            widget.selectAll()
            QApplication.clipboard().setText(self._rng.choice(WORDS))
            QTest.keyClick(widget, Qt.Key.Key_V, Qt.KeyboardModifier.ControlModifier)
            QTest.keyClick(widget, self._rng.choice(KEYS))
        elif isinstance(widget, HoldButton):
            QTest.mousePress(widget, left)
            QTimer.singleShot(self._rng.choice((50, HOLD_MS)), widget, lambda: QTest.mouseRelease(widget, left))
        elif isinstance(widget, QTabBar):
            QTest.mouseClick(widget, left, pos=widget.tabRect(self._rng.randrange(max(1, widget.count()))).center())
        elif isinstance(widget, QAbstractButton):
            QTest.mouseClick(widget, left)
        else:
            inside = widget.viewport() if isinstance(widget, QAbstractItemView) else widget
            room = inside.rect()
            at, to = (QPoint(*(self._rng.randrange(max(1, n)) for n in (room.width(), room.height()))) for _ in "ab")
            draw = self._rng.random()
            if draw < 0.7:
                QTest.mouseClick(inside, left, pos=at)
            elif draw < 0.8:
                QTest.mouseDClick(inside, left, pos=at)
            elif draw < 0.9:
                QTest.mouseClick(inside, Qt.MouseButton.RightButton, pos=at)
            else:
                QTest.mousePress(inside, left, pos=at)
                QTest.mouseMove(inside, to)
                QTest.mouseRelease(inside, left, pos=to)


def _can_be_used(widget: QWidget) -> bool:
    is_part = isinstance(widget.parentWidget(), QAbstractSpinBox | QComboBox)
    return widget.isVisible() and widget.isEnabled() and not is_part and not widget.visibleRegion().isEmpty()


def _name(widget: QWidget) -> str:
    text = widget.text() if isinstance(widget, QAbstractButton) else widget.accessibleName()
    return f"{type(widget).__name__} “{text}”"


def main(seed: int, seconds: float, folder: Path, language: str, project: Path | None = None) -> None:
    """Begin with the start page, or a project; settings and home are in the folder."""
    faulthandler.enable()
    folder.mkdir(parents=True, exist_ok=True)
    os.environ.update(REFLIGHT_CONFIG_DIR=str(folder / "config"), HOME=str(folder), BROWSER="true")
    start_virtual_screen()
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_DontUseNativeDialogs)
    application = QApplication(["reflight-tests"])
    application.setQuitOnLastWindowClosed(False)
    from groundstation.gui.window.project_controller import ProjectController
    from groundstation.services.settings import Language

    user, controller = RandomUser(seed, seconds, folder, language), ProjectController(application)
    controller.show()
    controller.choose(language=Language(language))
    if project is not None:
        QTimer.singleShot(0, lambda: controller.open_path(project))
    QTimer.singleShot(START_MS, user.act)
    application.exec()


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3]), sys.argv[4], *map(Path, sys.argv[5:]))
