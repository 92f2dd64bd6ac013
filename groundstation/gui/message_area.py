"""What the window has told the user: the last message always in sight, all of them on request."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QGuiApplication
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.theme import colours
from groundstation.gui.workspace import Message, Workspace
from planning.findings import Severity

MAX_MESSAGES = 500


class MessageArea(QWidget):
    """A line with the last message and its severity in words; a list of all unfolds above it."""

    def __init__(self, workspace: Workspace, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._workspace = workspace
        self._severity, self._text = QLabel(), QLabel()
        self._text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._text.setWordWrap(True)
        self._text.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._all = QToolButton()
        self._all.setCheckable(True)
        self._all.setText(self.tr("Messages"))
        self._all.setToolTip(self.tr("Show all messages"))
        self._jump = QToolButton()
        self._jump.setText(self.tr("Show place"))
        self._jump.setVisible(False)
        self._list = QListWidget()
        self._list.setVisible(False)
        self._list.setMaximumHeight(180)
        self._list.setWordWrap(True)
        self._last: Message | None = None
        line = QHBoxLayout()
        for widget in (self._severity, self._text, self._jump, self._all):
            line.addWidget(widget, 1 if widget is self._text else 0)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 2, 6, 2)
        layout.addWidget(self._list)
        layout.addLayout(line)
        self._all.toggled.connect(self._show_all)
        self._jump.clicked.connect(self._jump_to_last)
        self._list.itemActivated.connect(self._activated)
        workspace.messageShown.connect(self.add)

    def add(self, message: Message) -> None:
        """Show a message."""
        self._last = message
        words = self._words()
        self._severity.setText(words[message.severity])
        role = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.OK: "ok"}.get(
            message.severity, "heading"
        )
        self._severity.setProperty("role", role)
        self._severity.style().polish(self._severity)
        self._text.setText(message.text)
        self._jump.setVisible(message.item is not None)
        row = QListWidgetItem(f"{words[message.severity]}: {message.text}")
        row.setData(Qt.ItemDataRole.UserRole, message)
        colour = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}.get(message.severity)
        if colour:
            row.setForeground(QColor(colour))
        self._list.addItem(row)
        while self._list.count() > MAX_MESSAGES:
            self._list.takeItem(0)
        if self._list.isVisible():  # a list that is hidden would lay out all of its rows for this
            self._list.scrollToBottom()

    def messages(self) -> tuple[Message, ...]:
        """All messages, the oldest first."""
        rows = (self._list.item(row) for row in range(self._list.count()))
        return tuple(row.data(Qt.ItemDataRole.UserRole) for row in rows)

    def texts(self) -> str:
        """All messages, one in a line."""
        return "\n".join(self._list.item(row).text() for row in range(self._list.count()))

    def copy_all(self) -> None:
        """All messages to the clipboard, to send them to somebody."""
        QGuiApplication.clipboard().setText(self.texts())

    def _show_all(self, is_wanted: bool) -> None:
        self._list.setVisible(is_wanted)
        self._list.scrollToBottom()

    def _words(self) -> dict[Severity, str]:
        return {
            Severity.ERROR: self.tr("Error"),
            Severity.WARNING: self.tr("Warning"),
            Severity.NOTE: self.tr("Note"),
            Severity.OK: self.tr("Done"),
        }

    def _jump_to_last(self) -> None:
        if self._last is not None and self._last.item is not None:
            self._workspace.jump_to(self._last.item)

    def _activated(self, row: QListWidgetItem) -> None:
        message = row.data(Qt.ItemDataRole.UserRole)
        if message.item is not None:
            self._workspace.jump_to(message.item)
