"""The tour: a card that goes from part to part of the window and says what each is for; it can be left at any time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPoint, QRect, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.widgets.theme import colours
from groundstation.gui.window.main_window import MainWindow

CARD_PX, APART_PX, FRAME_PX = 360, 10, 3


@dataclass(frozen=True, slots=True)
class Stop:
    """One part of the window.

    Parameters
    ----------
    part
        Found when the tour comes there; None where it is not shown.
    """

    title: str
    says: str
    part: Callable[[], QWidget | None]


class Tour(QFrame):
    """The card, and a frame around what it speaks of.

    Signals
    -------
    ended()
        It came to its end, or was left.
    """

    ended = Signal()

    def __init__(self, window: QWidget, stops: Sequence[Stop]) -> None:
        super().__init__(window)
        self._window, self._stops, self._number = window, tuple(stops), 0
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self._frame = _Frame(window)
        self._title, self._says, self._count = QLabel(), QLabel(), QLabel()
        self._title.setProperty("role", "heading")
        self._count.setProperty("role", "muted")
        self._says.setWordWrap(True)
        self.before, self.next, self.leave = QPushButton(self.tr("Back")), QPushButton(), QPushButton(self.tr("Leave"))
        self.next.setProperty("primary", True)
        buttons = QHBoxLayout()
        buttons.addWidget(self._count)
        buttons.addStretch(1)
        for button in (self.leave, self.before, self.next):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        for label in (self._title, self._says):
            layout.addWidget(label)
        layout.addLayout(buttons)
        self.leave.clicked.connect(self.end)
        self.before.clicked.connect(lambda: self._go_to(self._number - 1))
        self.next.clicked.connect(lambda: self._go_to(self._number + 1))
        window.installEventFilter(self)

    def begin(self) -> None:
        """Show the first stop."""
        self.show()
        self._go_to(0)

    def end(self) -> None:
        """Go away."""
        self._window.removeEventFilter(self)
        self._frame.hide()
        self._frame.deleteLater()
        self.hide()
        self.ended.emit()
        self.deleteLater()

    def text(self) -> str:
        """What is said now."""
        return f"{self._title.text()}\n{self._says.text()}"

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Esc leaves the tour."""
        if event.key() == Qt.Key.Key_Escape:
            self.end()
        else:
            super().keyPressEvent(event)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Stay beside what it speaks of when the window changes its size."""
        if event.type() == QEvent.Type.Resize and self.isVisible():
            self._place()
        return super().eventFilter(watched, event)

    def _go_to(self, number: int) -> None:
        if number >= len(self._stops):
            self.end()
            return
        self._number = max(0, number)
        stop = self._stops[self._number]
        is_last = self._number == len(self._stops) - 1
        self._title.setText(stop.title)
        self._says.setText(stop.says)
        self._count.setText(f"{self._number + 1} / {len(self._stops)}")
        self.before.setEnabled(self._number > 0)
        self.next.setText(self.tr("Finish") if is_last else self.tr("Next"))
        self._place()
        self.next.setFocus()

    def _place(self) -> None:
        """Below what it speaks of where there is room, else above; always inside the window."""
        window, part = self._window.rect(), self._stops[self._number].part()
        self.setFixedWidth(min(CARD_PX + 4 * self.fontMetrics().averageCharWidth(), window.width() - 2 * APART_PX))
        self.adjustSize()
        around = QRect(window.center(), window.center())
        if part is not None and part.isVisible():
            around = QRect(part.mapTo(self._window, QPoint(0, 0)), part.size())
        self._frame.show_around(around if part is not None and part.isVisible() else QRect())
        if around.height() > window.height() // 2:
            self.move(window.center() - self.rect().center())
            self.raise_()
            return
        top = around.bottom() + APART_PX
        if top + self.height() > window.height():
            top = around.top() - self.height() - APART_PX
        top = max(APART_PX, min(top, window.height() - self.height() - APART_PX))
        left = max(APART_PX, min(around.left(), window.width() - self.width() - APART_PX))
        self.move(left, top)
        self.raise_()


def stops_of(window: MainWindow) -> tuple[Stop, ...]:
    """What the tour shows, in order."""
    translate = QCoreApplication.translate

    def on_tab(name: str, part: QWidget) -> Callable[[], QWidget]:
        def found() -> QWidget:
            if window.shown_tab() != name:
                window.show_tab(name)
            return part

        return found

    return (
        Stop(
            translate("Tour", "Where to begin"),
            translate("Tour", "The sample project has every step done: look around in it, nothing can break."),
            on_tab("start", window.tab("start").left),
        ),
        Stop(
            translate("Tour", "Seven steps"),
            translate("Tour", "They stand in the order of the work. A tick says that a step is done."),
            on_tab("start", window.tab_bar()),
        ),
        Stop(
            translate("Tour", "What comes next"),
            translate("Tour", "This line says what is done and what comes next. The blue button leads there."),
            on_tab("site", window.next_step),
        ),
        Stop(
            translate("Tour", "The view"),
            translate("Tour", "The site in 3-D, on the map, or as a camera will see it. Drag to turn, wheel to zoom."),
            on_tab("site", window.shared_view),
        ),
        Stop(
            translate("Tour", "Help"),
            translate("Tour", "The manual's page of this tab. A “?” beside a word says what it means."),
            on_tab("site", window.next_step.help),
        ),
        Stop(
            translate("Tour", "Messages"),
            translate("Tour", "What holds now, and all that was told. What runs stands beside it, with its time."),
            on_tab("site", window.messages),
        ),
    )


class _Frame(QWidget):
    """A frame that lets every click through."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def show_around(self, room: QRect) -> None:
        """Stand around a part of the window; nowhere for an empty one."""
        self.setVisible(not room.isEmpty())
        self.setGeometry(room.adjusted(-FRAME_PX, -FRAME_PX, FRAME_PX, FRAME_PX))
        self.raise_()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """The frame alone."""
        painter = QPainter(self)
        painter.setPen(QPen(QColor(colours().warning), FRAME_PX))
        half = FRAME_PX // 2 + 1
        painter.drawRect(self.rect().adjusted(half, half, -half, -half))
        painter.end()
