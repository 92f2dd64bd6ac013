"""The message centre: what holds now, what happened last, and everything that was told.

A message with a topic (`about`) holds until it is settled: the job runs again, the link is found, another project is
opened. It is shown in the line until then, the gravest first, whatever else is told meanwhile. What happened, such as a
file that was written, is shown for some seconds, and no longer than until the site or the plan is changed: its numbers
are of what was. All of it is kept in the list, which opens over the window and moves
nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QPoint, Qt, QTimer, Signal, SignalInstance
from PySide6.QtGui import (
    QColor,
    QFont,
    QGuiApplication,
    QKeySequence,
    QShortcut,
)
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QStyle,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext, Message
from groundstation.gui.widgets.icons import set_icon
from groundstation.gui.widgets.scrolling import ShortText, severity_words
from groundstation.gui.widgets.theme import colours
from groundstation.services.project.document import Document
from planning.base.findings import Severity

MAX_MESSAGES = 500


EVENT_S, TROUBLE_S = 12.0, 60.0
"""How long the line shows what happened, and an error or a warning that nobody settles."""

LOOK_MS = 1000

GRAVITY = {Severity.ERROR: 2, Severity.WARNING: 1}

ROLES = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.OK: "ok"}


class MessageArea(QWidget):
    """A line with the message that counts now, and a list of all.

    Parameters
    ----------
    clock
        Seconds, for how long messages have been shown.
    """

    def __init__(
        self, context: ApplicationContext, parent: QWidget | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(parent)
        self._context, self._clock = context, clock
        self._told: list[tuple[Message, str]] = []
        self._standing: list[tuple[Message, float]] = []
        self._event: tuple[Message, float] | None = None
        self._shown: Message | None = None
        self._severity, self._text = QLabel(), ShortText()
        self._all, self._jump = QToolButton(), QToolButton()
        self._all.setCheckable(True)
        self._all.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        set_icon(self._all, "messages")
        self._all.setToolTip(self.tr("All messages: what holds now, and what was told before"))
        self._jump.setText(self.tr("Show place"))
        self._jump.setVisible(False)
        self.sheet = MessageSheet(self, context.localized)
        line = QHBoxLayout(self)
        line.setContentsMargins(6, 2, 6, 2)
        for widget in (self._severity, self._text, self._jump, self._all):
            line.addWidget(widget, 1 if widget is self._text else 0)
        self._all.toggled.connect(self._open)
        self._text.clicked.connect(self._all.toggle)
        self._jump.clicked.connect(self._jump_to_shown)
        self.sheet.closed.connect(lambda: self._all.setChecked(False))
        self.sheet.dismissed.connect(self.dismiss)
        self.sheet.placeRequested.connect(self._show_place)
        self.sheet.copyRequested.connect(self.copy_all)
        self._timer = QTimer(self, interval=LOOK_MS)
        self._timer.timeout.connect(self.look)
        context.messageShown.connect(self.add)
        context.messageWithdrawn.connect(self.withdraw)
        context.documentChanged.connect(self._document_changed)
        self._show()

    def add(self, message: Message) -> None:
        """Show a message; one about the same as another takes its place."""
        now = self._clock()
        self._told.append((message, time.strftime("%H:%M")))
        del self._told[:-MAX_MESSAGES]
        if message.about:
            self._standing = [entry for entry in self._standing if entry[0].about != message.about]
        if message.severity in GRAVITY:
            self._standing = [*(entry for entry in self._standing if entry[0].text != message.text), (message, now)]
        else:
            self._event = message, now
        self._timer.start()
        self._show()

    def withdraw(self, about: str) -> None:
        """What was said about something does not hold any more; a topic that ends in a dot is all that begin so."""
        is_over = about.endswith(".")
        self._standing = [
            (message, since)
            for message, since in self._standing
            if not (message.about.startswith(about) if is_over else message.about == about)
        ]
        self._show()

    def dismiss(self, message: Message) -> None:
        """Put a message away that holds no more; the history keeps it."""
        self._standing = [entry for entry in self._standing if entry[0] is not message]
        self._show()

    def look(self) -> None:
        """Let go of what has been shown for long enough."""
        now = self._clock()
        if self._event is not None and now - self._event[1] > EVENT_S:
            self._event = None
        self._standing = [
            (message, since) for message, since in self._standing if message.about or now - since <= TROUBLE_S
        ]
        if self._event is None and all(message.about for message, _ in self._standing):
            self._timer.stop()
        self._show()

    def messages(self) -> tuple[Message, ...]:
        """All messages, the oldest first."""
        return tuple(message for message, _ in self._told)

    def standing(self) -> tuple[Message, ...]:
        """What holds now, the gravest first, and of those the latest."""
        ordered = sorted(self._standing, key=lambda entry: (GRAVITY[entry[0].severity], entry[1]), reverse=True)
        return tuple(message for message, _ in ordered)

    def take_over(self, other: MessageArea) -> None:
        """Go on where another area ends: the window is made anew."""
        self._told, self._standing, self._event = list(other._told), list(other._standing), other._event
        self._timer.start()
        self._show()

    def line(self) -> str:
        """What the line says, with its severity."""
        return f"{self._severity.text()}: {self._text.text()}" if self._text.text() else ""

    def texts(self) -> str:
        """All messages, one in a line."""
        words = severity_words()
        return "\n".join(
            f"{words[message.severity]}: {self._context.localized(message.text)}" for message, _ in self._told
        )

    def copy_all(self) -> None:
        """All messages to the clipboard, to send them to somebody."""
        QGuiApplication.clipboard().setText(self.texts())

    def _show(self) -> None:
        """Trouble first, but for a moment what has just happened."""
        standing, now = self.standing(), self._clock()
        message = standing[0] if standing else None
        if self._event is not None:
            event, since = self._event
            latest = max((at for _, at in self._standing), default=-1.0)
            if message is None or (since >= latest and now - since <= EVENT_S):
                message = event
        if message is not self._shown:
            self._shown = message
            self._severity.setText("" if message is None else severity_words()[message.severity])
            self._severity.setProperty("role", "heading" if message is None else ROLES.get(message.severity, "heading"))
            self._severity.style().polish(self._severity)
            self._text.setText("" if message is None else self._context.localized(message.text))
            self._jump.setVisible(message is not None and message.item is not None)
        self._all.setText(
            self.tr("Messages: {0}").format(f"\u26a0 {len(standing)}") if standing else self.tr("Messages")
        )
        if self.sheet.isVisible():
            self._fill()

    def _document_changed(self, before: Document, after: Document) -> None:
        """What happened was told of the site and the plan as they were."""
        if self._event is not None and (before.site is not after.site or before.plans is not after.plans):
            self._event = None
            self._show()

    def _open(self, is_wanted: bool) -> None:
        if is_wanted:
            self._fill()
        self.sheet.show_above(self, is_wanted)

    def _fill(self) -> None:
        self.sheet.fill(self.standing(), self._told)

    def _jump_to_shown(self) -> None:
        if self._shown is not None:
            self._show_place(self._shown)

    def _show_place(self, message: Message) -> None:
        if message.item is not None:
            self._context.jump_to(message.item)


class MessageSheet(QFrame):
    """The list of all messages; it lies over the window, above the line.

    Parameters
    ----------
    words
        Puts a message into the user's language.

    Signals
    -------
    closed()
    dismissed(Message), placeRequested(Message), copyRequested()
    """

    closed = Signal()
    dismissed = Signal(object)
    placeRequested = Signal(object)  # noqa: N815
    copyRequested = Signal()  # noqa: N815

    def __init__(self, line: QWidget, words: Callable[[str], str]) -> None:
        super().__init__(line)
        self._line, self._words = line, words
        self._standing: tuple[Message, ...] = ()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self._list = QListWidget()
        self._list.setWordWrap(True)
        self._list.setAccessibleName(self.tr("All messages"))
        self._place, self._dismiss_button = QPushButton(self.tr("Show place")), QPushButton(self.tr("Dismiss"))
        self._dismiss_button.setToolTip(self.tr("The message is read; it stays in the list"))
        copy, close = QPushButton(self.tr("Copy all")), QPushButton(self.tr("Close"))
        buttons = QHBoxLayout()
        for button in (self._place, self._dismiss_button, copy):
            buttons.addWidget(button)
        buttons.addStretch(1)
        buttons.addWidget(close)
        layout = QVBoxLayout(self)
        layout.addWidget(self._list, 1)
        layout.addLayout(buttons)
        self._list.currentRowChanged.connect(lambda _row: self._enable())
        self._list.itemActivated.connect(lambda _item: self._ask(self.placeRequested))
        self._place.clicked.connect(lambda: self._ask(self.placeRequested))
        self._dismiss_button.clicked.connect(lambda: self._ask(self.dismissed))
        copy.clicked.connect(self.copyRequested)
        close.clicked.connect(self.closed)
        escape = QShortcut(QKeySequence(Qt.Key.Key_Escape), self)
        escape.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        escape.activated.connect(self.closed)
        self.hide()

    def fill(self, standing: tuple[Message, ...], history: list[tuple[Message, str]]) -> None:
        """What holds now, and under it everything, the latest first."""
        chosen = self._chosen()
        self._list.clear()
        self._head(self.tr("Now"))
        for message in standing:
            self._row(message, "")
        if not standing:
            self._head(self.tr("nothing to heed"), is_bold=False)
        self._head(self.tr("Told so far"))
        for message, when in reversed(history):
            self._row(message, f"{when}  ")
        rows = (row for row in range(self._list.count()) if self._message(self._list.item(row)) is chosen)
        if chosen is not None:
            self._list.setCurrentRow(next(rows, -1))
        self._standing = standing
        self._enable()

    def texts(self) -> list[str]:
        """All rows."""
        return [self._list.item(row).text() for row in range(self._list.count())]

    def rows(self) -> QListWidget:
        """The list itself, for clicks of tests."""
        return self._list

    def show_above(self, line: QWidget, is_wanted: bool) -> None:
        """Open above the line, as wide as the window, or close."""
        if not is_wanted:
            self.hide()
            line.window().removeEventFilter(self)
            return
        self.setParent(line.window())
        self._fit()
        line.window().installEventFilter(self)
        self.show()
        self.raise_()
        self._list.setFocus()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Stay above the line when the window changes its size."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest) and self.isVisible():
            QTimer.singleShot(0, self, self._fit)
        return super().eventFilter(watched, event)

    def _fit(self) -> None:
        window = self._line.window()
        bottom = self._line.mapTo(window, QPoint(0, 0)).y()
        height = min(bottom, max(bottom // 2, self.minimumSizeHint().height()))
        self.setGeometry(0, bottom - height, window.width(), height)

    def _head(self, text: str, is_bold: bool = True) -> None:
        row = QListWidgetItem(text)
        font = QFont(self._list.font())
        font.setBold(is_bold)
        row.setFont(font)
        row.setFlags(Qt.ItemFlag.NoItemFlags)
        row.setForeground(QColor(colours().text if is_bold else colours().muted))
        self._list.addItem(row)

    def _row(self, message: Message, when: str) -> None:
        row = QListWidgetItem(f"{when}{severity_words()[message.severity]}: {self._words(message.text)}")
        row.setData(Qt.ItemDataRole.UserRole, message)
        colour = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}.get(message.severity)
        if colour:
            row.setForeground(QColor(colour))
        icon = {
            Severity.ERROR: QStyle.StandardPixmap.SP_MessageBoxCritical,
            Severity.WARNING: QStyle.StandardPixmap.SP_MessageBoxWarning,
        }.get(message.severity)
        if icon is not None:
            row.setIcon(self.style().standardIcon(icon))
        self._list.addItem(row)

    def _message(self, row: QListWidgetItem | None) -> Message | None:
        message: Message | None = None if row is None else row.data(Qt.ItemDataRole.UserRole)
        return message

    def _chosen(self) -> Message | None:
        return self._message(self._list.currentItem())

    def _enable(self) -> None:
        chosen = self._chosen()
        self._place.setEnabled(chosen is not None and chosen.item is not None)
        self._dismiss_button.setEnabled(
            any(message is chosen for message in self._standing) if chosen is not None else False
        )

    def _ask(self, signal: SignalInstance) -> None:
        chosen = self._chosen()
        if chosen is not None:
            signal.emit(chosen)
