"""What can be read in the window, and what its texts are called in German, as the translators keep it."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QComboBox,
    QLabel,
    QLineEdit,
    QListView,
    QPlainTextEdit,
    QTabBar,
    QWidget,
)

GERMAN = Path(__file__).resolve().parents[2] / "groundstation/gui/translations/reflight_de.ts"

QT_GERMAN = {"Yes": ("Ja",), "No": ("Nein",), "OK": ("OK",), "Cancel": ("Abbrechen",), "Save": ("Speichern",)}
"""Words of Qt's own dialogs."""

N_ROWS_READ = 100
"""Of a list or table, when its language is looked at."""

_GAP = re.compile(r"\{\d[^}]*\}")


@cache
def german() -> dict[str, tuple[str, ...]]:
    """What each English text of the window is called in German; one text may have several translations."""
    found: dict[str, list[str]] = {text: list(texts) for text, texts in QT_GERMAN.items()}
    for message in ElementTree.parse(GERMAN).iter("message"):
        source, translation = message.findtext("source", ""), message.findtext("translation", "")
        found.setdefault(plain(source), []).append(plain(translation))
    return {source: tuple(texts) for source, texts in found.items()}


@cache
def _english() -> tuple[frozenset[str], re.Pattern[str]]:
    """English texts of some words that German has others for: those without gaps, and a pattern of the rest."""
    texts = [
        source for source, found in german().items() if " " in source and source.lower() not in map(str.lower, found)
    ]
    whole = [text for text in texts if not _GAP.search(text)]
    # A text of little but gaps would be found in anything.
    with_gaps = [
        text for text in texts if _GAP.search(text) and len(re.findall("[A-Za-z]{3,}", _GAP.sub("", text))) > 2
    ]
    return frozenset(map(str.lower, whole)), re.compile("|".join(map(pattern, with_gaps)), re.IGNORECASE)


def is_english(line: str) -> bool:
    """Whether a line is an English text that German has other words for."""
    whole, with_gaps = _english()
    return line.lower() in whole or with_gaps.fullmatch(line) is not None


def left_in_english(window: QWidget) -> list[str]:
    """Lines in a window that is to be German."""
    shown = [each for each in window.findChildren(QWidget) if each.isVisible() and each.window() is window]
    lines = {line for each in shown for text in _all_texts_of(each) for line in text.splitlines()}
    return sorted(filter(is_english, lines))


def plain(text: str) -> str:
    """Text without the marks of its shortcut."""
    return text.replace("&", "")


def text_of(widget: QWidget) -> str:
    """What stands on a widget."""
    if isinstance(widget, (QLabel, QAbstractButton, QLineEdit)):
        return plain(widget.text())
    if isinstance(widget, QPlainTextEdit):
        return widget.toPlainText()
    return ""


def _all_texts_of(widget: QWidget) -> Iterator[str]:
    """What can be read on a widget, also where one points at it, opens it or has not yet filled it in."""
    yield text_of(widget)
    yield plain(widget.toolTip())
    yield from (plain(action.text()) for action in widget.actions())
    if isinstance(widget, QLineEdit):
        yield widget.placeholderText()
    if isinstance(widget, QTabBar):
        yield from (plain(widget.tabText(k)) for k in range(widget.count()))
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(k) for k in range(widget.count()))
    if isinstance(widget, QAbstractItemView) and (model := widget.model()) is not None:
        rows = min(model.rowCount(), N_ROWS_READ)
        columns = range(1 if isinstance(widget, QListView) else model.columnCount())
        places = [model.index(row, column) for row in range(rows) for column in columns]
        for role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            yield from (str(place.data(role) or "") for place in places)
            yield from (str(model.headerData(k, Qt.Orientation.Horizontal, role) or "") for k in columns)


def pattern(template: str) -> str:
    """A regular expression for a text whose gaps, as “{0}”, may hold anything."""
    return re.sub(r"\\\{\d[^}]*\\\}", "(.|\n)*?", re.escape(template))
