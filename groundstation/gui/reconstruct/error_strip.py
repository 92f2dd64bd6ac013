"""All photos of a data set beside each other, with how well the model shows each: a bar and decibels."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QWidget

from groundstation.gui.widgets.photo_strip import PhotoStrip
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.gui.widgets.thumbnails import SmallPictures
from reconstruction.base.cameras import PosedPhoto

CELL = QSize(112, 104)
FOOT_PX, BAR_PX = 18, 7

UNSEEN = "\u25c7"
"""A photo that is not learned from."""

LEAST_SPREAD_DB = 3.0
"""Between the worst and the best photo, for the colours of bars: less is no difference to speak of."""


class ErrorStrip(PhotoStrip[PosedPhoto]):
    """Shows photos beside each other, in the order of their names or the worst first.

    Signals
    -------
    chosen(str)
        Name of a photo that the user chose.
    """

    chosen = Signal(str)

    def __init__(self, pictures: SmallPictures, parent: QWidget | None = None) -> None:
        super().__init__(CELL, BAR_PX + FOOT_PX, lambda photo: photo.path, parent)
        self._pictures = pictures
        self._all: tuple[PosedPhoto, ...] = ()
        self._unseen: frozenset[str] = frozenset()
        self._psnr_db: dict[str, float] = {}
        self._range_db = (0.0, 1.0)
        self._worst_first, self._is_filling = False, False
        self.setAccessibleName(self.tr("Photos of the data set, and how well the model shows them"))
        self.selectionModel().currentChanged.connect(self._current_changed)
        pictures.ready.connect(self.repaint_path)

    def set_photos(self, photos: tuple[PosedPhoto, ...], unseen: frozenset[str]) -> None:
        """Show other photos; `unseen` are not learned from."""
        self._all, self._unseen = photos, unseen
        self._psnr_db = {}
        self._arrange()

    def set_errors(self, psnr_db: dict[str, float]) -> None:
        """Show other errors; the order stays until `set_worst_first`, or until more photos are known."""
        knows_more = bool(set(psnr_db) - set(self._psnr_db))
        self._psnr_db = dict(psnr_db)
        if psnr_db:
            low, high = min(psnr_db.values()), max(psnr_db.values())
            self._range_db = low - 0.1 * LEAST_SPREAD_DB, max(high, low + LEAST_SPREAD_DB)
        if self._worst_first and knows_more:
            self._arrange()
        self.viewport().update()

    def errors(self) -> dict[str, float]:
        """Those that are shown, PSNR in dB."""
        return self._psnr_db

    def set_worst_first(self, is_on: bool) -> None:
        """Sort by what is known now, or by names."""
        self._worst_first = is_on
        self._arrange()
        if is_on:
            self.horizontalScrollBar().setValue(0)

    def choose(self, name: str) -> None:
        """Mark a photo, and bring it into sight."""
        row = self._row_of(name)
        if row is not None:
            self.choose_row(row)

    def current(self) -> str:
        """Name of the photo that is marked; "" for none."""
        row = self.currentIndex().row()
        return self.photos()[row].name if 0 <= row < len(self.photos()) else ""

    def names(self) -> tuple[str, ...]:
        """As they are shown."""
        return tuple(photo.name for photo in self.photos())

    def picture(self, photo: PosedPhoto) -> QImage | None:
        """Its picture; None where it is still being read."""
        lens = photo.intrinsics
        return self._pictures.picture(photo.path, max(lens.width_px, lens.height_px))

    def paint_foot(self, painter: QPainter, foot: QRect, _row: int, photo: PosedPhoto) -> None:
        """Bar, sign, name and decibels."""
        look, found = colours(), self._psnr_db.get(photo.name)
        if found is not None:
            low, high = self._range_db
            share = min(1.0, max(0.0, (found - low) / (high - low)))
            bar = QRect(foot.left() + 2, foot.top(), foot.width() - 4, BAR_PX - 1)
            painter.fillRect(bar, QColor(look.handle))
            bar.setWidth(max(3, round(share * bar.width())))
            painter.fillRect(bar, _colour(share, look))
        line = foot.adjusted(3, BAR_PX - 1, -3, -1)
        sign = f"{UNSEEN} " if photo.name in self._unseen else ""
        left, right = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight
        middle = Qt.AlignmentFlag.AlignVCenter
        metrics = painter.fontMetrics()
        room_px = line.width() - (36 if found is not None else 0) - metrics.horizontalAdvance(sign)
        name = metrics.elidedText(Path(photo.name).stem, Qt.TextElideMode.ElideLeft, room_px)
        painter.drawText(line, left | middle, sign + name)
        if found is not None:
            painter.drawText(line, right | middle, f"{found:.1f}")

    def words(self, photo: PosedPhoto) -> str:
        """What is known of a photo."""
        found = self._psnr_db.get(photo.name)
        lines = [photo.name]
        if found is not None:
            lines.append(self.tr("{0:.2f} dB on the facades, as the model is now").format(found))
        if photo.name in self._unseen:
            lines.append(self.tr("{0} not learned from: kept for scoring").format(UNSEEN))
        return "\n".join(lines)

    def _row_of(self, name: str) -> int | None:
        return next((row for row, photo in enumerate(self.photos()) if photo.name == name), None)

    def _arrange(self) -> None:
        chosen, errors = self.current(), self._psnr_db
        place = self.horizontalScrollBar().value()
        order = sorted(self._all, key=lambda photo: photo.name)
        if self._worst_first:
            order = sorted(order, key=lambda photo: errors.get(photo.name, float("inf")))
        self._is_filling = True
        self.show_photos(tuple(order))
        row = self._row_of(chosen)
        if row is not None:
            self.setCurrentIndex(self.model().index(row, 0))
        self.horizontalScrollBar().setValue(place)
        self._is_filling = False

    def _current_changed(self, now: QModelIndex, _before: QModelIndex) -> None:
        if now.isValid() and not self._is_filling:
            self.chosen.emit(self.photos()[now.row()].name)


def _colour(share: float, look: Colours) -> QColor:
    """From the worst to the best, by way of orange."""
    worst, middle, best = QColor(look.error), QColor(look.open), QColor(look.ok)
    one, other, part = (worst, middle, 2.0 * share) if share < 0.5 else (middle, best, 2.0 * share - 1.0)
    pairs = ((one.redF(), other.redF()), (one.greenF(), other.greenF()), (one.blueF(), other.blueF()))
    return QColor.fromRgbF(*(a + part * (b - a) for a, b in pairs))
