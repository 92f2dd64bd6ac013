"""Small pictures of all photos in the order of time, with signs for what is wrong with them."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QWidget

from groundstation.gui.photos.photo_store import PhotoStore
from groundstation.gui.widgets.photo_strip import PhotoStrip
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.intake import PhotoCard, PhotoMark

CELL = QSize(124, 100)
FOOT_PX = 20

SIGNS = {
    PhotoMark.UNREADABLE: "\u2717",
    PhotoMark.CUT_OFF: "\u2702",
    PhotoMark.BLURRED: "\u2248",
    PhotoMark.DARK: "\u25cf",
    PhotoMark.BRIGHT: "\u25cb",
    PhotoMark.ALIKE: "=",
    PhotoMark.UNPOSED: "?",
}
"""No state is told by colour alone."""

SEARCHED = "\u25a6"
"""A photo in which a grid was found."""

NO_USE = frozenset({PhotoMark.UNREADABLE, PhotoMark.CUT_OFF, PhotoMark.UNPOSED})


class ThumbnailStrip(PhotoStrip[PhotoCard]):
    """Shows photos beside each other.

    Signals
    -------
    chosen(int)
        Number of a photo.
    """

    chosen = Signal(int)

    def __init__(self, store: PhotoStore, parent: QWidget | None = None) -> None:
        super().__init__(CELL, FOOT_PX, lambda card: card.path, parent)
        self._store = store
        self._searched: frozenset[Path] = frozenset()
        self.setAccessibleName(self.tr("Photos in the order of time"))
        self.selectionModel().currentChanged.connect(lambda now, _before: self.chosen.emit(now.row()))
        store.thumbnailReady.connect(self.repaint_path)

    def set_cards(self, cards: tuple[PhotoCard, ...]) -> None:
        """Show other photos."""
        self.show_photos(cards)

    def set_searched(self, paths: frozenset[Path]) -> None:
        """Show in which photos grids were found."""
        self._searched = paths
        self.viewport().update()

    def choose(self, number: int) -> None:
        """Bring a photo to the front."""
        self.choose_row(number)

    def picture(self, card: PhotoCard) -> QImage | None:
        """Its picture; None where there is none yet, or the file is damaged."""
        return self._store.thumbnail(card.metadata)

    def paint_foot(self, painter: QPainter, foot: QRect, row: int, card: PhotoCard) -> None:
        """Number and signs."""
        look, line = colours(), foot.adjusted(2, 0, -2, 0)
        number = f"{row + 1} {SEARCHED}" if card.path in self._searched else str(row + 1)
        painter.drawText(line, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, number)
        if card.marks:
            painter.setPen(QColor(look.error if NO_USE.intersection(card.marks) else look.warning))
            signs = " ".join(SIGNS[mark] for mark in card.marks)
            painter.drawText(line, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, signs)

    def words(self, card: PhotoCard) -> str:
        """What is known of a photo."""
        said = {
            PhotoMark.UNREADABLE: self.tr("cannot be decoded"),
            PhotoMark.CUT_OFF: self.tr("the file was cut off"),
            PhotoMark.BLURRED: self.tr("blurred"),
            PhotoMark.DARK: self.tr("too dark"),
            PhotoMark.BRIGHT: self.tr("too bright"),
            PhotoMark.ALIKE: self.tr("shows the same as another one"),
            PhotoMark.UNPOSED: self.tr("does not say where it was taken"),
        }
        return "\n".join([card.path.name, *(f"{SIGNS[mark]} {said[mark]}" for mark in card.marks)])
