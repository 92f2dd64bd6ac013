"""Photos beside each other in one row, each with a small picture decoded on another thread, a frame, and a foot."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

import cv2
import numpy as np
from PySide6.QtCore import (
    QAbstractListModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QRect,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QColor, QImage, QPainter, QPen
from PySide6.QtWidgets import QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from groundstation.gui.widgets.picture_decoder import PictureDecoder, qimage_of
from groundstation.gui.widgets.theme import colours
from planning.base.errors import InputError
from planning.base.files import read_input_file
from reconstruction.photos.decode import PICTURE_FILE, decoded

# Small copies of photos for the strip, decoded on another thread, those last that were asked for first.

SIDE_PX = 132

FLAGS = {1: cv2.IMREAD_COLOR, 2: cv2.IMREAD_REDUCED_COLOR_2, 4: cv2.IMREAD_REDUCED_COLOR_4}
FLAGS |= {8: cv2.IMREAD_REDUCED_COLOR_8}


class Thumbnails(QObject):
    """Keeps small pictures of files.

    Signals
    -------
    ready(Path)
    """

    ready = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._decoder = PictureDecoder(_small, self.ready.emit, self)

    def picture(self, path: Path, longest_px: int) -> QImage | None:
        """A small picture of a file whose longest side is known; None while it is decoded, or where it is damaged."""
        return self._decoder.picture(path, (path, longest_px))

    def is_busy(self) -> bool:
        """Whether pictures are being decoded, or wait to be taken."""
        return self._decoder.is_busy()

    def close(self) -> None:
        """Decode nothing more, and wait for the picture that is being decoded."""
        self._decoder.close()


def _small(photo: tuple[Path, int]) -> QImage | None:
    path, longest_px = photo
    scale = max(each for each in FLAGS if each == 1 or longest_px // each >= SIDE_PX)
    try:
        content = read_input_file(path, PICTURE_FILE)
        picture = decoded(content, FLAGS[scale] | cv2.IMREAD_IGNORE_ORIENTATION, str(path))
    except InputError:
        return None
    height, width = picture.shape[:2]
    share = min(1.0, SIDE_PX / max(height, width))
    size = max(1, round(share * width)), max(1, round(share * height))
    return qimage_of(np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8))


BAR_PX = 24
"""For the scroll bar below."""

Photo = TypeVar("Photo")

Index = QModelIndex | QPersistentModelIndex


class _Rows(QAbstractListModel):
    """The photos, in the order in which they are shown."""

    def __init__(self, strip: PhotoStrip[Any]) -> None:
        super().__init__(strip)
        self._strip = strip

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008, N802
        """Number of photos."""
        return 0 if parent.isValid() else len(self._strip.photos())

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        """What is known of one, in words."""
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole):
            return self._strip.words(self._strip.photos()[index.row()])
        return None


class _Painter(QStyledItemDelegate):
    """Paints one photo."""

    def __init__(self, strip: PhotoStrip[Any]) -> None:
        super().__init__(strip)
        self._strip = strip

    def sizeHint(self, _option: QStyleOptionViewItem, _index: Index) -> QSize:  # noqa: N802
        """All are of one size."""
        return self._strip.cell

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Picture, foot, and a frame."""
        strip, look, row = self._strip, colours(), index.row()
        photo = strip.photos()[row]
        box: QRect = option.rect.adjusted(3, 3, -3, -3)
        room = box.adjusted(0, 0, 0, -strip.foot_px)
        painter.save()
        painter.fillRect(box, QColor(look.window))
        picture = strip.picture(photo)
        if picture is not None:
            place = QRect(room.topLeft(), picture.size().scaled(room.size(), Qt.AspectRatioMode.KeepAspectRatio))
            place.moveCenter(room.center())
            painter.drawImage(place, picture)
        painter.setPen(QColor(look.text))
        strip.paint_foot(painter, QRect(box.left(), room.bottom() + 1, box.width(), strip.foot_px), row, photo)
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        painter.setPen(QPen(QColor(look.accent if is_chosen else look.line), 3 if is_chosen else 1))
        painter.drawRect(box)
        painter.restore()


class PhotoStrip(QListView, Generic[Photo]):
    """A row of photos.

    Parameters
    ----------
    cell
        Size of each.
    foot_px
        Of that, below the picture.
    path_of
        Where a photo's picture is read from.
    """

    def __init__(
        self, cell: QSize, foot_px: int, path_of: Callable[[Photo], Path], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.cell, self.foot_px = cell, foot_px
        self._path_of = path_of
        self._photos: tuple[Photo, ...] = ()
        self._rows_of: Mapping[Path, int] = {}
        self._model = _Rows(self)
        self.setModel(self._model)
        self.setItemDelegate(_Painter(self))
        self.setFlow(QListView.Flow.LeftToRight)
        self.setWrapping(False)
        self.setUniformItemSizes(True)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        self.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self.setFixedHeight(cell.height() + BAR_PX)

    # What a strip says of its photos

    def picture(self, photo: Photo) -> QImage | None:
        """Its picture; None where it is still being read."""
        raise NotImplementedError

    def paint_foot(self, painter: QPainter, foot: QRect, row: int, photo: Photo) -> None:
        """What is below the picture; the pen has the colour of text."""
        raise NotImplementedError

    def words(self, photo: Photo) -> str:
        """What is known of it."""
        raise NotImplementedError

    # What all have

    def photos(self) -> tuple[Photo, ...]:
        """As they are shown."""
        return self._photos

    def show_photos(self, photos: tuple[Photo, ...]) -> None:
        """Show others, or in another order; none is marked then."""
        self._model.beginResetModel()
        self._photos = photos
        self._rows_of = {self._path_of(photo): row for row, photo in enumerate(photos)}
        self._model.endResetModel()

    def choose_row(self, row: int) -> None:
        """Mark a photo, and bring it into sight."""
        index = self._model.index(row)
        self.setCurrentIndex(index)
        self.scrollTo(index)

    def repaint_path(self, path: Path) -> None:
        """A photo's picture has come."""
        row = self._rows_of.get(path)
        if row is not None:
            self.viewport().update(self.visualRect(self._model.index(row)))
