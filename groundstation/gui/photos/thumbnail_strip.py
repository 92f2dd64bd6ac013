"""Small pictures of all photos in the order of time, with signs for what is wrong with them."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QAbstractListModel, QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from groundstation.gui.photos.photo_store import PhotoStore
from groundstation.gui.theme import colours
from groundstation.services.photo_cards import PhotoCard, PhotoMark

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

Index = QModelIndex | QPersistentModelIndex


class _Cards(QAbstractListModel):
    """The photos."""

    def __init__(self, strip: ThumbnailStrip) -> None:
        super().__init__(strip)
        self._strip = strip
        self.cards: tuple[PhotoCard, ...] = ()
        self.searched: frozenset[Path] = frozenset()

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008, N802
        """Number of photos."""
        return 0 if parent.isValid() else len(self.cards)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        """Name, and what is wrong, in words."""
        card = self.cards[index.row()]
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole):
            return self._strip.words(card)
        return None


class _Painter(QStyledItemDelegate):
    """Paints one photo; asks for its picture where there is none yet."""

    def __init__(self, store: PhotoStore, parent: QWidget) -> None:
        super().__init__(parent)
        self._store = store

    def sizeHint(self, _option: QStyleOptionViewItem, _index: Index) -> QSize:  # noqa: N802
        """All are of one size."""
        return CELL

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Picture, then number and signs."""
        model = index.model()
        assert isinstance(model, _Cards)
        card, look = model.cards[index.row()], colours()
        box: QRect = option.rect.adjusted(3, 3, -3, -3)
        room = box.adjusted(0, 0, 0, -FOOT_PX)
        painter.save()
        painter.fillRect(box, QColor(look.window))
        picture = self._store.thumbnail(card.metadata)
        if picture is not None:
            size = picture.size().scaled(room.size(), Qt.AspectRatioMode.KeepAspectRatio)
            place = QRect(room.topLeft(), size)
            place.moveCenter(room.center())
            painter.drawImage(place, picture)
        foot = QRect(box.left() + 2, room.bottom() + 1, box.width() - 4, FOOT_PX)
        painter.setPen(QColor(look.text))
        number = f"{index.row() + 1} {SEARCHED}" if card.path in model.searched else str(index.row() + 1)
        painter.drawText(foot, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, number)
        if card.marks:
            painter.setPen(QColor(look.error if NO_USE.intersection(card.marks) else look.warning))
            signs = " ".join(SIGNS[mark] for mark in card.marks)
            painter.drawText(foot, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, signs)
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        painter.setPen(QPen(QColor(look.accent if is_chosen else look.line), 3 if is_chosen else 1))
        painter.drawRect(box)
        painter.restore()


class ThumbnailStrip(QListView):
    """Shows photos beside each other.

    Signals
    -------
    chosen(int)
        Number of a photo.
    """

    chosen = Signal(int)

    def __init__(self, store: PhotoStore, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._cards = _Cards(self)
        self._rows: dict[Path, int] = {}
        self.setModel(self._cards)
        self.setItemDelegate(_Painter(store, self))
        self.setFlow(QListView.Flow.LeftToRight)
        self.setWrapping(False)
        self.setUniformItemSizes(True)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        self.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self.setFixedHeight(CELL.height() + 24)
        self.setAccessibleName(self.tr("Photos in the order of time"))
        self.selectionModel().currentChanged.connect(lambda now, _before: self.chosen.emit(now.row()))
        store.thumbnailReady.connect(self._repaint_one)

    def set_cards(self, cards: tuple[PhotoCard, ...]) -> None:
        """Show other photos."""
        self._cards.beginResetModel()
        self._cards.cards = cards
        self._rows = {card.path: row for row, card in enumerate(cards)}
        self._cards.endResetModel()

    def set_searched(self, paths: frozenset[Path]) -> None:
        """Show in which photos grids were found."""
        self._cards.searched = paths
        self.viewport().update()

    def choose(self, number: int) -> None:
        """Bring a photo to the front."""
        index = self._cards.index(number)
        self.setCurrentIndex(index)
        self.scrollTo(index)

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

    def _repaint_one(self, path: Path) -> None:
        row = self._rows.get(path)
        if row is not None:
            self.viewport().update(self.visualRect(self._cards.index(row)))
