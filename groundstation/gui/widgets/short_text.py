"""A text in few lines that pushes nothing away, and what severities are called."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, QRect, QSize, Qt, Signal
from PySide6.QtGui import (
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QTextLayout,
)
from PySide6.QtWidgets import (
    QLabel,
    QSizePolicy,
    QWidget,
)

from planning.base.findings import Severity

N_LINES = 2
"""Lines at most; the list of messages has all of a text."""


class ShortText(QLabel):
    """A text in two lines at most, so that a long one pushes nothing away; the tool tip has all of it.

    Signals
    -------
    clicked()
    """

    clicked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    def setText(self, text: str) -> None:  # noqa: N802
        """Show a text."""
        super().setText(text)
        self.setToolTip(text)

    def sizeHint(self) -> QSize:  # noqa: N802
        """As high as its lines, whatever stands in it: nothing moves when a message comes."""
        return QSize(100, N_LINES * self.fontMetrics().lineSpacing())

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """The same."""
        return self.sizeHint()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """A click asks for more."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.clicked.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Break lines at words, and end in dots where there is more."""
        painter, metrics = QPainter(self), self.fontMetrics()
        lines = self._lines()
        top = max(0, (self.height() - len(lines) * metrics.lineSpacing()) // 2)
        for number, line in enumerate(lines):
            room = QRect(0, top + number * metrics.lineSpacing(), self.width(), metrics.lineSpacing())
            flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
            self.style().drawItemText(painter, room, flags, self.palette(), True, line, self.foregroundRole())
        painter.end()

    def _lines(self) -> list[str]:
        layout, lines, text = QTextLayout(self.text(), self.font()), [], self.text()
        layout.beginLayout()
        while len(lines) < N_LINES:
            line = layout.createLine()
            if not line.isValid():
                break
            line.setLineWidth(self.width())
            start = line.textStart()
            end = start + line.textLength()
            is_last = len(lines) == N_LINES - 1
            shown = text[start:] if is_last else text[start:end]
            lines.append(self.fontMetrics().elidedText(shown.strip(), Qt.TextElideMode.ElideRight, self.width()))
        layout.endLayout()
        return lines


def severity_words() -> dict[Severity, str]:
    """Severities of messages in the user's language."""
    translate = QCoreApplication.translate
    return {
        Severity.ERROR: translate("MessageArea", "Error"),
        Severity.WARNING: translate("MessageArea", "Warning"),
        Severity.NOTE: translate("MessageArea", "Note"),
        Severity.OK: translate("MessageArea", "Done"),
    }
