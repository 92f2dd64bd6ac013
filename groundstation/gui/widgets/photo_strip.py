"""Photos beside each other in one row, each with a small picture decoded on another thread, a frame, and a foot."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
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
    QTimer,
    Signal,
)
from PySide6.QtGui import QColor, QImage, QPainter, QPen
from PySide6.QtWidgets import QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from groundstation.gui.widgets.theme import colours
from planning.base.errors import InputError
from planning.base.files import read_input_file
from reconstruction.photos.decode import PICTURE_FILE, decoded

# Small copies of photos for the strip, decoded on another thread, those last that were asked for first.

SIDE_PX = 132
MOST_CACHED, MOST_WANTED = 1000, 80
LOOK_MS = 30
"""How often it is looked what has been decoded. The thread tells nobody itself: its listener may be gone by then."""

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
        self._cached: OrderedDict[Path, QImage | None] = OrderedDict()
        self._wanted: OrderedDict[Path, int] = OrderedDict()
        self._done: deque[tuple[Path, QImage | None]] = deque()
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def picture(self, path: Path, longest_px: int) -> QImage | None:
        """A small picture of a file whose longest side is known; None while it is decoded, or where it is damaged."""
        if path in self._cached:
            self._cached.move_to_end(path)
            return self._cached[path]
        with self._lock:
            self._wanted[path] = longest_px
            self._wanted.move_to_end(path)
            while len(self._wanted) > MOST_WANTED:
                self._wanted.popitem(last=False)
            if self._worker is None:
                self._worker = threading.Thread(target=self._work, name="small pictures", daemon=True)
                self._worker.start()
        self._timer.start(LOOK_MS)
        return None

    def is_busy(self) -> bool:
        """Whether pictures are being decoded, or wait to be taken."""
        with self._lock:
            return self._worker is not None or bool(self._done)

    def close(self) -> None:
        """Decode nothing more, and wait for the picture that is being decoded."""
        with self._lock:
            worker = self._worker
            self._wanted.clear()
        if worker is not None:
            worker.join(10.0)

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._wanted:
                    self._worker = None
                    return
                path, longest_px = self._wanted.popitem()
            self._done.append((path, _small(path, longest_px)))

    def _look(self) -> None:
        while self._done:
            path, picture = self._done.popleft()
            self._cached[path] = picture
            while len(self._cached) > MOST_CACHED:
                self._cached.popitem(last=False)
            self.ready.emit(path)
        if not self.is_busy():
            self._timer.stop()


def _small(path: Path, longest_px: int) -> QImage | None:
    scale = max(each for each in FLAGS if each == 1 or longest_px // each >= SIDE_PX)
    try:
        content = read_input_file(path, PICTURE_FILE)
        picture = decoded(content, FLAGS[scale] | cv2.IMREAD_IGNORE_ORIENTATION, str(path))
    except InputError:
        return None
    height, width = picture.shape[:2]
    share = min(1.0, SIDE_PX / max(height, width))
    size = max(1, round(share * width)), max(1, round(share * height))
    small = np.ascontiguousarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
    shared = QImage(small.data, size[0], size[1], 3 * size[0], QImage.Format.Format_BGR888)
    return shared.convertToFormat(QImage.Format.Format_RGB32)


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
