"""The "?" beside terms of the trade: a click on the word says what it means, and leads to its page of the manual.

Qt's own "What's this?" shows the words: by Shift+F1 for the field that has the keyboard, too.
"""

from __future__ import annotations

from functools import lru_cache
from html import escape

from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QRectF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QApplication, QLabel, QWhatsThis, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.theme import colours
from groundstation.services.glossary import TERMS, Term, terms_by_word
from groundstation.services.units import UnitSystem
from planning.base.messages import Message

SIGN_PX, GAP_PX = 15, 5
"""Size of the sign, and its distance from the word."""


def term_of(word: str) -> Term | None:
    """The term that a word of the window stands for, in the window's language."""
    # The words of the first one tell which language is spoken.
    return _terms(_in_language(TERMS[0].says)).get(word.casefold())


@lru_cache(maxsize=4)
def _terms(_language: str) -> dict[str, Term]:
    return terms_by_word(_in_language)


def _in_language(message: Message) -> str:
    return translated(message, UnitSystem.METRIC)


def explanation(term: Term) -> str:
    """What is shown of a term, as HTML, with a way to its page of the manual."""
    more = QCoreApplication.translate("Terms", "More in the manual")
    name, says = escape(_in_language(term.name)), escape(_in_language(term.says))
    return f'<p><b>{name}</b></p><p>{says}</p><p><a href="{escape(term.page)}">{more}</a></p>'


class TermLabel(QLabel):
    """A word with a "?" behind it."""

    def __init__(self, text: str, term: Term, parent: QWidget | None = None) -> None:
        super().__init__(text, parent)
        self._term = term
        self.setContentsMargins(0, 0, SIGN_PX + GAP_PX, 0)
        self.setCursor(Qt.CursorShape.WhatsThisCursor)
        self.setWhatsThis(explanation(term))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Say what the word means."""
        if event.button() == Qt.MouseButton.LeftButton and self.rect().contains(event.position().toPoint()):
            QWhatsThis.showText(self.mapToGlobal(QPoint(0, self.height())), self.whatsThis(), self)

    def event(self, event: QEvent) -> bool:
        """Let a dialog's window hear of the way to the manual: the event itself ends at the dialog."""
        if event.type() == QEvent.Type.WhatsThisClicked:
            above = self.window().parentWidget()
            return bool(QApplication.sendEvent(self.window() if above is None else above, event))
        return super().event(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """The word, and the sign behind it."""
        super().paintEvent(event)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        wide = min(self.fontMetrics().horizontalAdvance(self.text().replace("&", "")), self.width() - SIGN_PX - GAP_PX)
        line = self.fontMetrics().lineSpacing()
        top = (self.height() - SIGN_PX) / 2.0 if self.height() < 2 * line else (line - SIGN_PX) / 2.0
        room = QRectF(wide + GAP_PX, top, SIGN_PX, SIGN_PX)
        look = QColor(colours().accent)
        painter.setPen(QPen(look, 1.2))
        painter.drawEllipse(room.adjusted(1, 1, -1, -1))
        font = self.font()
        font.setPixelSize(SIGN_PX - 5)
        font.setBold(True)
        painter.setFont(font)
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, "?")
        painter.end()


def label_of(text: str, field: QWidget) -> QLabel:
    """The label of a field: with a "?" where it is a term; Shift+F1 in the field says the same."""
    term = term_of(text)
    if term is None:
        return QLabel(text)
    if not field.whatsThis():
        field.setWhatsThis(explanation(term))
    return TermLabel(text, term)
