"""All photos of a data set beside each other, with how well the model shows each: a bar and decibels."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QAbstractListModel, QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from groundstation.gui.reconstruct.small_pictures import SmallPictures
from groundstation.gui.theme import Colours, colours
from reconstruction.cameras import PosedPhoto

CELL = QSize(112, 104)
FOOT_PX, BAR_PX = 18, 7

UNSEEN = "\u25c7"
"""A photo that is not learned from."""

LEAST_SPREAD_DB = 3.0
"""Between the worst and the best photo, for the colours of bars: less is no difference to speak of."""

Index = QModelIndex | QPersistentModelIndex


class _Photos(QAbstractListModel):
    """The photos, in the order in which they are shown."""

    def __init__(self, strip: ErrorStrip) -> None:
        super().__init__(strip)
        self._strip = strip
        self.photos: tuple[PosedPhoto, ...] = ()
        self.unseen: frozenset[str] = frozenset()
        self.psnr_db: dict[str, float] = {}
        self.range_db = (0.0, 1.0)

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008, N802
        """Number of photos."""
        return 0 if parent.isValid() else len(self.photos)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        """Name and error, in words."""
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole):
            return self._strip.words(self.photos[index.row()].name)
        return None


class _Painter(QStyledItemDelegate):
    """Paints one photo."""

    def __init__(self, pictures: SmallPictures, parent: QWidget) -> None:
        super().__init__(parent)
        self._pictures = pictures

    def sizeHint(self, _option: QStyleOptionViewItem, _index: Index) -> QSize:  # noqa: N802
        """All are of one size."""
        return CELL

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Picture, bar, sign and decibels."""
        model = index.model()
        assert isinstance(model, _Photos)
        photo, look = model.photos[index.row()], colours()
        box: QRect = option.rect.adjusted(3, 3, -3, -3)
        room = box.adjusted(0, 0, 0, -FOOT_PX - BAR_PX)
        painter.save()
        painter.fillRect(box, QColor(look.window))
        lens = photo.intrinsics
        picture = self._pictures.picture(photo.path, max(lens.width_px, lens.height_px))
        if picture is not None:
            place = QRect(room.topLeft(), picture.size().scaled(room.size(), Qt.AspectRatioMode.KeepAspectRatio))
            place.moveCenter(room.center())
            painter.drawImage(place, picture)
        found = model.psnr_db.get(photo.name)
        if found is not None:
            low, high = model.range_db
            share = min(1.0, max(0.0, (found - low) / (high - low)))
            bar = QRect(box.left() + 2, room.bottom() + 1, box.width() - 4, BAR_PX - 1)
            painter.fillRect(bar, QColor(look.handle))
            bar.setWidth(max(3, round(share * bar.width())))
            painter.fillRect(bar, _colour(share, look))
        foot = QRect(box.left() + 3, box.bottom() - FOOT_PX, box.width() - 6, FOOT_PX)
        painter.setPen(QColor(look.text))
        sign = f"{UNSEEN} " if photo.name in model.unseen else ""
        left, right = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight
        middle = Qt.AlignmentFlag.AlignVCenter
        metrics = painter.fontMetrics()
        room_px = foot.width() - (36 if found is not None else 0) - metrics.horizontalAdvance(sign)
        name = metrics.elidedText(Path(photo.name).stem, Qt.TextElideMode.ElideLeft, room_px)
        painter.drawText(foot, left | middle, sign + name)
        if found is not None:
            painter.drawText(foot, right | middle, f"{found:.1f}")
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        painter.setPen(QPen(QColor(look.accent if is_chosen else look.line), 3 if is_chosen else 1))
        painter.drawRect(box)
        painter.restore()


class ErrorStrip(QListView):
    """Shows photos beside each other, in the order of their names or the worst first.

    Signals
    -------
    chosen(str)
        Name of a photo that the user chose.
    """

    chosen = Signal(str)

    def __init__(self, pictures: SmallPictures, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._photos = _Photos(self)
        self._all: tuple[PosedPhoto, ...] = ()
        self._worst_first, self._is_filling = False, False
        self.setModel(self._photos)
        self.setItemDelegate(_Painter(pictures, self))
        self.setFlow(QListView.Flow.LeftToRight)
        self.setWrapping(False)
        self.setUniformItemSizes(True)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        self.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self.setFixedHeight(CELL.height() + 24)
        self.setAccessibleName(self.tr("Photos of the data set, and how well the model shows them"))
        self.selectionModel().currentChanged.connect(self._current_changed)
        pictures.ready.connect(self._repaint_one)

    def set_photos(self, photos: tuple[PosedPhoto, ...], unseen: frozenset[str]) -> None:
        """Show other photos; `unseen` are not learned from."""
        self._all, self._photos.unseen = photos, unseen
        self._photos.psnr_db = {}
        self._arrange()

    def set_errors(self, psnr_db: dict[str, float]) -> None:
        """Show other errors; the order stays until `set_worst_first`, or until more photos are known."""
        knows_more = bool(set(psnr_db) - set(self._photos.psnr_db))
        self._photos.psnr_db = dict(psnr_db)
        if psnr_db:
            low, high = min(psnr_db.values()), max(psnr_db.values())
            self._photos.range_db = low - 0.1 * LEAST_SPREAD_DB, max(high, low + LEAST_SPREAD_DB)
        if self._worst_first and knows_more:
            self._arrange()
        self.viewport().update()

    def set_worst_first(self, is_on: bool) -> None:
        """Sort by what is known now, or by names."""
        self._worst_first = is_on
        self._arrange()
        if is_on:
            self.horizontalScrollBar().setValue(0)

    def choose(self, name: str) -> None:
        """Mark a photo, and bring it into sight."""
        row = next((row for row, photo in enumerate(self._photos.photos) if photo.name == name), None)
        if row is not None:
            index = self._photos.index(row)
            self.setCurrentIndex(index)
            self.scrollTo(index)

    def current(self) -> str:
        """Name of the photo that is marked; "" for none."""
        row = self.currentIndex().row()
        return self._photos.photos[row].name if 0 <= row < len(self._photos.photos) else ""

    def names(self) -> tuple[str, ...]:
        """As they are shown."""
        return tuple(photo.name for photo in self._photos.photos)

    def words(self, name: str) -> str:
        """What is known of a photo."""
        found = self._photos.psnr_db.get(name)
        lines = [name]
        if found is not None:
            lines.append(self.tr("{0:.2f} dB on the facades, as the model is now").format(found))
        if name in self._photos.unseen:
            lines.append(self.tr("{0} not learned from: kept for scoring").format(UNSEEN))
        return "\n".join(lines)

    def _arrange(self) -> None:
        chosen, errors = self.current(), self._photos.psnr_db
        place = self.horizontalScrollBar().value()
        order = sorted(self._all, key=lambda photo: photo.name)
        if self._worst_first:
            order = sorted(order, key=lambda photo: errors.get(photo.name, float("inf")))
        self._is_filling = True
        self._photos.beginResetModel()
        self._photos.photos = tuple(order)
        self._photos.endResetModel()
        rows = [row for row, photo in enumerate(order) if photo.name == chosen]
        if rows:
            self.setCurrentIndex(self._photos.index(rows[0]))
        self.horizontalScrollBar().setValue(place)
        self._is_filling = False

    def _current_changed(self, now: QModelIndex, _before: QModelIndex) -> None:
        if now.isValid() and not self._is_filling:
            self.chosen.emit(self._photos.photos[now.row()].name)

    def _repaint_one(self, path: Path) -> None:
        for row, photo in enumerate(self._photos.photos):
            if photo.path == path:
                self.viewport().update(self.visualRect(self._photos.index(row)))


def _colour(share: float, look: Colours) -> QColor:
    """From the worst to the best, by way of orange."""
    worst, middle, best = QColor(look.error), QColor(look.open), QColor(look.ok)
    one, other, part = (worst, middle, 2.0 * share) if share < 0.5 else (middle, best, 2.0 * share - 1.0)
    pairs = ((one.redF(), other.redF()), (one.greenF(), other.greenF()), (one.blueF(), other.blueF()))
    return QColor.fromRgbF(*(a + part * (b - a) for a, b in pairs))
