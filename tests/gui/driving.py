"""Driving the real window in tests: turning the event loop until something has happened, and clicking dialogs.

No test answers in place of a dialog. `clicked` waits for the dialogs that an action brings up and works each as a user
does: it presses a button, types a path, or leaves by Escape.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar

import numpy as np
import shiboken6
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QInputDialog,
    QLabel,
    QLineEdit,
    QMessageBox,
    QScrollArea,
    QWidget,
)

from groundstation.gui.widgets.hold_button import HoldButton

SETTLE_S, CALM_S = 0.35, 0.05
"""Time without a job after which none follows: where a timer still runs (effects are looked at 0.3 s after the last
change), and where none does."""

TURN_S, LONG_TURN_S = 0.005, 0.01
"""Pauses between turns of the event loop, while something happens and while only a timer runs: turns cost processor
time that other tests want."""

LOOK_MS, READ_MS, TRIES = 15, 150, 40
"""How often the hand looks for a dialog, and how long and how often it gives one of files to read its folder."""

PATIENCE_S = 240.0
"""Longest wait for anything: it ends tests that would wait for ever, also where a second of work takes ten."""

GUARD_MS, GUARD_S = 500, 60.0
"""How often somebody looks for dialogs that nobody clicks, and how long one may stand."""

OWN_SCHEDULE = Path("/proc/thread-self/schedstat")

Step = Callable[[QDialog], None]


def press(button: str | QMessageBox.StandardButton) -> Step:
    """A step: click the button with this text, or of this kind in any language."""

    def step(dialog: QDialog) -> None:
        click_on(dialog, _button_of(dialog, button))

    return step


def escape(dialog: QDialog) -> None:
    """A step: leave by the Escape key."""
    QTest.keyClick(dialog, Qt.Key.Key_Escape)


def shut(dialog: QDialog) -> None:
    """A step: close by the cross in the title bar."""
    dialog.close()


def choose(*paths: Path | str) -> Step:
    """A step: type a path into a file dialog, or some, and accept."""

    def step(dialog: QDialog) -> None:
        assert isinstance(dialog, QFileDialog), f"expected a file dialog, got “{dialog.windowTitle()}”"
        text = str(paths[0]) if len(paths) == 1 else " ".join(f'"{path}"' for path in paths)
        _type_when_ready(dialog, text)

    return step


def type_into(line: QLineEdit, text: str) -> None:
    """Replace what stands in a line, key by key."""
    line.setFocus()
    line.selectAll()
    QTest.keyClick(line, Qt.Key.Key_Backspace)
    QTest.keyClicks(line, text)


def scroll_to(widget: QWidget) -> None:
    """Bring a widget into view, as the wheel does, in every scroll area that it is in."""
    area = widget.parentWidget()
    while area is not None:
        if isinstance(area, QScrollArea):
            area.ensureWidgetVisible(widget)
        area = area.parentWidget()
    QApplication.processEvents()


def click_on(window: QWidget, widget: QWidget, at: QPoint | None = None) -> None:
    """Click a widget where a user can, scrolling to it: it is enabled, on the screen, and nothing lies over it."""
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=_place_on_top(window, widget, at))


def _place_on_top(window: QWidget, widget: QWidget, at: QPoint | None = None) -> QPoint:
    """Where to press a widget, which is brought into view: it is enabled, on the screen, and nothing lies over it."""
    above = widget.parentWidget()
    while above is not None:
        if isinstance(above, QScrollArea):
            above.ensureWidgetVisible(widget)
        above = above.parentWidget()
    place = widget.rect().center() if at is None else at
    assert widget.isVisible(), f"“{_name(widget)}” is not shown"
    assert widget.isEnabled(), f"“{_name(widget)}” cannot be pressed"
    on_top = window.childAt(widget.mapTo(window, place))
    assert on_top is not None, f"“{_name(widget)}” is outside its window"
    assert on_top is widget or widget.isAncestorOf(on_top), f"“{_name(on_top)}” lies over “{_name(widget)}”"
    screen = widget.screen().availableGeometry()
    assert screen.contains(widget.mapToGlobal(place)), f"“{_name(widget)}” is off the screen"
    return place


def hold_on(window: QWidget, button: HoldButton) -> None:
    """Hold a button where a user can, until it acts; a dialog that this brings up comes while it is held."""
    place = _place_on_top(window, button)
    acted: list[bool] = []

    def note() -> None:
        acted.append(True)

    button.clicked.connect(note)
    QTest.mousePress(button, Qt.MouseButton.LeftButton, pos=place)
    end = time.perf_counter() + PATIENCE_S
    while not acted and time.perf_counter() < end:
        QApplication.processEvents()
        time.sleep(TURN_S)
    button.clicked.disconnect(note)
    QTest.mouseRelease(button, Qt.MouseButton.LeftButton, pos=place)
    assert acted, f"“{_name(button)}” did not act"


def press_in(window: QWidget, text: str) -> None:
    """Click the button of a window that shows a text."""
    click_on(window, _buttons_with(window, text)[0])


def trigger(window: QWidget, text: str) -> None:
    """Choose an entry of a menu."""
    actions = [action for action in window.findChildren(QAction) if _plain(action.text()) == text]
    assert actions, f"no entry “{text}”"
    assert actions[0].isEnabled(), f"“{text}” cannot be chosen"
    actions[0].trigger()


def words_of(dialog: QDialog) -> str:
    """Title and text of a dialog."""
    if isinstance(dialog, QMessageBox):
        return f"{dialog.windowTitle()}\n{dialog.text()}"
    texts = (label.text() for label in dialog.findChildren(QLabel) if label.isVisible())
    return "\n".join((dialog.windowTitle(), *texts))


class Hand:
    """Works modal dialogs, one step each, in the order in which they come up."""

    active: ClassVar[list[Hand]] = []

    def __init__(self, steps: Sequence[Step], is_endless: bool = False) -> None:
        self.words: list[str] = []
        self.problem: str | None = None
        self._steps, self._is_endless, self._ended = list(steps), is_endless, False
        self._seen: set[int] = set()

    @property
    def is_done(self) -> bool:
        """Whether every step was taken, or one failed."""
        return not self._steps or self.problem is not None

    def start(self) -> None:
        """Look from now on for dialogs that come up."""
        stands = QApplication.activeModalWidget()
        if isinstance(stands, QDialog):
            self._see(stands)
        self.active.append(self)
        QTimer.singleShot(LOOK_MS, self._look)

    def end(self) -> None:
        """Look no longer."""
        self._ended = True
        self.active.remove(self)

    def _look(self) -> None:
        if self._ended:
            return
        # The next look is on its way before anything is clicked: a click may open a dialog of its own and come back
        # only when that has gone.
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, QDialog) or not dialog.isVisible() or self.active[-1] is not self:
            QTimer.singleShot(LOOK_MS, self._look)
            return
        QTimer.singleShot(LOOK_MS, self._look)
        if _address(dialog) in self._seen:
            return
        if self.problem is not None:
            dialog.reject()
            return
        if not self._steps:
            self._fail(dialog, f"a dialog that nobody awaited: {words_of(dialog)}")
            return
        self._see(dialog)
        self.words.append(words_of(dialog))
        step = self._steps[0] if self._is_endless else self._steps.pop(0)
        try:
            step(dialog)
        except Exception as error:
            self._fail(dialog, f"{type(error).__name__}: {error}; in the dialog {self.words[-1]}")

    def _see(self, dialog: QDialog) -> None:
        """Remember a dialog as long as it stands; another one may come to lie where it was."""
        address = _address(dialog)
        self._seen.add(address)
        dialog.finished.connect(lambda _result: self._seen.discard(address))

    def _fail(self, dialog: QDialog, problem: str) -> None:
        self.problem = problem
        if _address(dialog) in self._seen or not self._steps:
            dialog.reject()


class Guard:
    """Sends away dialogs that wait for a click in a test that clicks none: it would stand for ever."""

    def __init__(self) -> None:
        self.found: list[str] = []
        self._since: tuple[int, float] | None = None
        self._timer = QTimer(interval=GUARD_MS)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    def end(self) -> None:
        """Look no longer."""
        self._timer.stop()

    def _look(self) -> None:
        dialog = QApplication.activeModalWidget()
        if Hand.active or not isinstance(dialog, (QMessageBox, QFileDialog, QInputDialog)):
            self._since = None
        elif self._since is None or self._since[0] != _address(dialog):
            self._since = _address(dialog), time.perf_counter()
        elif time.perf_counter() - self._since[1] > GUARD_S:
            self.found.append(words_of(dialog))
            dialog.reject()


@contextmanager
def clicked(*steps: Step | str, timeout_s: float = PATIENCE_S) -> Iterator[list[str]]:
    """Work the dialogs that the block brings up: one step each, a text standing for the button with that text.

    Yields the words of the dialogs, filled as they come. Ends when every step was taken.

    Raises
    ------
    AssertionError
        A dialog did not come up, one came up that nobody awaited, or a step could not be taken.
    """
    hand = Hand([press(step) if isinstance(step, str) else step for step in steps])
    hand.start()
    try:
        yield hand.words
        end = time.perf_counter() + timeout_s
        while not hand.is_done and time.perf_counter() < end:
            QApplication.processEvents()
            time.sleep(0.002)
        QApplication.processEvents()
    finally:
        hand.end()
    assert hand.problem is None, hand.problem
    assert not hand._steps, f"{len(hand._steps)} of {len(steps)} dialogs did not come up"


def close_controller(controller) -> None:
    """Close the window as somebody does who wants to leave, whatever is asked, and let go of everything."""
    buttons = QMessageBox.StandardButton

    def leave(dialog: QDialog) -> None:
        box = dialog if isinstance(dialog, QMessageBox) else None
        known = [kind for kind in (buttons.Discard, buttons.Yes) if box is not None and box.button(kind) is not None]
        (press(known[0]) if known else escape)(dialog)

    hand = Hand([leave], is_endless=True)
    hand.start()
    try:
        controller.window.close()
    finally:
        hand.end()
    controller.close()


def accept_button(dialog: QFileDialog) -> QAbstractButton:
    """The button of a file dialog that takes what is chosen, whatever it is called at the moment."""
    box, role = dialog.findChild(QDialogButtonBox), QDialogButtonBox.ButtonRole.AcceptRole
    return next(button for button in box.buttons() if box.buttonRole(button) == role)


def _type_when_ready(dialog: QFileDialog, text: str) -> None:
    """Type into a file dialog and accept; while it reads its folder it forgets what was typed, or takes no click."""
    line = next(box for box in dialog.findChildren(QLineEdit) if box.objectName() == "fileNameEdit")
    accept = accept_button(dialog)
    again = QTimer(dialog, interval=READ_MS)
    stopped: list[int] = []
    dialog.finished.connect(stopped.append)
    dialog.finished.connect(again.stop)
    tries = iter(range(TRIES))

    def click() -> None:
        if next(tries, None) is None:
            again.stop()
            dialog.reject()
        elif _is_in_front(dialog):
            if line.text() != text:
                type_into(line, text)
            elif accept.isEnabled():
                n_asked = len(Hand.active[-1].words)
                click_on(dialog, accept)
                if len(Hand.active[-1].words) > n_asked and not stopped:
                    # It asked whether to replace a file, and was told no.
                    escape(dialog)

    again.timeout.connect(click)
    again.start()


def _is_in_front(dialog: QDialog) -> bool:
    front = QApplication.activeModalWidget()
    return isinstance(front, QDialog) and _address(front) == _address(dialog)


def _button_of(dialog: QDialog, wanted: str | QMessageBox.StandardButton) -> QAbstractButton:
    if not isinstance(wanted, str):
        assert isinstance(dialog, QMessageBox)
        return dialog.button(wanted)
    return _buttons_with(dialog, wanted)[0]


def _buttons_with(window: QWidget, text: str) -> list[QAbstractButton]:
    buttons = [button for button in window.findChildren(QAbstractButton) if button.isVisible()]
    found = [button for button in buttons if _plain(button.text()) == text]
    assert found, f"no button “{text}”, but {sorted({_plain(button.text()) for button in buttons})}"
    return found


def _address(dialog: QDialog) -> int:
    return shiboken6.getCppPointer(dialog)[0]


def _plain(text: str) -> str:
    return text.replace("&", "")


def _name(widget: QWidget) -> str:
    text = widget.text() if isinstance(widget, QAbstractButton) else widget.accessibleName()
    return _plain(text) or type(widget).__name__


class TurnGaps:
    """Gaps between turns of the event loop, by a timer of 2 ms.

    A machine that others use, or that gives a container no more than its share, takes the processor away. So what is
    taken off the clock is the time in which this thread could have run and had no processor, as Linux counts it; and a
    gap is as long as this process worked in it, on any thread that may hold the interpreter, and no longer than the
    clock that is left. A wait that costs no processor is seen by that clock, which is given `TAKEN_AWAY` times as long,
    and longer where others wait for the processor, too: a thread that this one waits for may want one.
    """

    TAKEN_AWAY = 4.0

    CROWDED, SHARED = 2.0, 0.25
    """Where more than so many want each processor, work takes so much longer for each further one, as they use its
    caches: a frame of the flight took 65 ms of this process alone, and 100 ms beside seven others on two processors."""

    def __init__(self) -> None:
        self._ticks: list[tuple[float, float]] = []
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._timer.start(2)

    def _tick(self) -> None:
        self._ticks.append((time.perf_counter() - _waited_for_processor_s(), time.process_time()))

    def start(self) -> None:
        """Forget all gaps so far."""
        self._ticks.clear()

    def n_turns(self) -> int:
        """Turns since the start."""
        return len(self._ticks)

    def longest_ms(self) -> float:
        """The longest since the start, but for the last turn, in which the test itself went on."""
        assert len(self._ticks) > 10
        clock, worked = np.diff(np.array(self._ticks[:-1]), axis=0).T
        taken_away = self.TAKEN_AWAY * max(1.0, self._load())
        return 1e3 * float(np.maximum(np.minimum(clock, worked), clock / taken_away).max())

    def allowed_ms(self, limit_ms: float) -> float:
        """A limit, as it is on a machine that is not crowded; beside two busy loops it holds as it is."""
        return limit_ms * (1.0 + self.SHARED * max(0.0, self._load() - self.CROWDED))

    @staticmethod
    def _load() -> float:
        """How many want each processor."""
        return os.getloadavg()[0] / (os.cpu_count() or 1)


def _waited_for_processor_s() -> float:
    """For which this thread could have run and no processor was free, since it began; 0 where nobody says."""
    try:
        return int(OWN_SCHEDULE.read_bytes().split()[1]) / 1e9
    except OSError:
        return 0.0


def turn_until(application, condition: Callable[[], bool], timeout_s: float = PATIENCE_S) -> float:
    """Process events until a condition holds; returns the longest time that one turn of the event loop took, s."""
    end, longest = time.perf_counter() + timeout_s, 0.0
    while not condition():
        started = time.perf_counter()
        application.processEvents()
        longest = max(longest, time.perf_counter() - started)
        assert time.perf_counter() < end, "it did not happen in time"
        time.sleep(TURN_S)
    return longest


def turn_until_idle(application, controller, timeout_s: float = PATIENCE_S) -> float:
    """Process events until no job runs and none follows; returns the longest turn, s."""
    longest, quiet_since = 0.0, time.perf_counter()
    end = quiet_since + timeout_s
    while (
        (quiet_s := time.perf_counter() - quiet_since) < CALM_S
        or (quiet_s < SETTLE_S and _waits(controller))
        or (_is_due(controller) and time.perf_counter() < end)  # another thread may have held this one up for long
    ):
        longest = max(longest, turn_until(application, lambda: not controller.context.jobs(), timeout_s))
        started = time.perf_counter()
        application.processEvents()
        longest = max(longest, time.perf_counter() - started)
        if controller.context.jobs() or (_is_due(controller) and started < end):
            quiet_since = time.perf_counter()
        time.sleep(0.005)
    return longest


def _is_due(controller) -> bool:
    """Whether a timer that fires once fires soon, however long that takes on a busy machine."""
    timers = controller.window.findChildren(QTimer)
    return any(timer.isActive() and timer.isSingleShot() and timer.interval() <= 1000.0 * SETTLE_S for timer in timers)


def _waits(controller) -> bool:
    """Whether a timer runs that may start something soon."""
    timers = controller.window.findChildren(QTimer)
    return any(timer.isActive() and timer.interval() <= 1000.0 * SETTLE_S for timer in timers)
