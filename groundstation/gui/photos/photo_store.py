"""Pictures of photos: decoded on another thread, small ones kept while they are likely to be seen again."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QImage

from planning.base.errors import InputError
from planning.photos.record import PhotoMetadata
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import warp
from reconstruction.photos.decode import colour_picture

THUMBNAIL_PX = 144
"""Longest side of a small picture; 1/8 of a photo is four times that, and is shrunk before it is kept."""

MAX_CACHED = 1000
"""Of some 60 KiB each: 60 MB at most, however many photos there are."""

MAX_WANTED = 80
"""More than a strip shows at once; what was wanted before them has been scrolled past."""

LOOK_MS = 15
"""How often it is looked what has been decoded. The thread tells nobody itself: its listener may be gone by then."""

LEAST_LEVEL_PX = 600
"""Shorter pictures need no smaller copy for being seen whole."""


@dataclass(frozen=True, slots=True, eq=False)
class LargePicture:
    """A picture for looking at closely, or what is wrong with its file.

    Parameters
    ----------
    levels
        The picture, then copies of half the size each, which are painted where they suffice.
    """

    path: Path
    view: Rectification | None
    levels: tuple[QImage, ...]
    problem: str = ""


class PhotoStore(QObject):
    """Small pictures of many photos, and one large one.

    Signals
    -------
    thumbnailReady(Path)
    largeReady(LargePicture)
        The one that was asked for last.
    """

    thumbnailReady = Signal(object)  # noqa: N815  (Qt's own way of naming)
    largeReady = Signal(object)  # noqa: N815

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._cached: OrderedDict[Path, QImage | None] = OrderedDict()
        self._wanted: OrderedDict[Path, PhotoMetadata] = OrderedDict()
        self._large: tuple[PhotoMetadata, Rectification | None] | None = None
        self._last: tuple[Path, NDArray[np.uint8]] | None = None
        self._asked: tuple[Path, Rectification | None] | None = None
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._done: deque[tuple[Path, QImage | None] | LargePicture] = deque()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def thumbnail(self, photo: PhotoMetadata) -> QImage | None:
        """A small picture; None while it is decoded, and where the file is damaged."""
        if photo.path in self._cached:
            self._cached.move_to_end(photo.path)
            return self._cached[photo.path]
        with self._lock:
            self._wanted[photo.path] = photo
            self._wanted.move_to_end(photo.path)
            while len(self._wanted) > MAX_WANTED:
                self._wanted.popitem(last=False)
        self._start()
        return None

    def ask_large(self, photo: PhotoMetadata, view: Rectification | None = None) -> None:
        """Decode a photo whole, seen through a rectified view where one is given; it comes before small pictures."""
        with self._lock:
            self._large, self._asked = (photo, view), (photo.path, view)
        self._start()

    def is_busy(self) -> bool:
        """Whether pictures are being decoded, or wait to be taken."""
        with self._lock:
            return self._worker is not None or bool(self._done)

    def close(self) -> None:
        """Decode nothing more, and wait for the picture that is being decoded."""
        with self._lock:
            worker = self._worker
            self._wanted.clear()
            self._large = None
        if worker is not None:
            worker.join(10.0)

    def _start(self) -> None:
        with self._lock:
            if self._worker is not None:
                return
            self._worker = threading.Thread(target=self._work, name="photos", daemon=True)
            self._worker.start()
        self._timer.start(LOOK_MS)

    def _work(self) -> None:
        while True:
            with self._lock:
                large, self._large = self._large, None
                small = self._wanted.popitem()[1] if large is None and self._wanted else None
                if large is None and small is None:
                    self._worker = None
                    return
            if large is not None:
                self._done.append(self._decode_large(*large))
            elif small is not None:
                self._done.append((small.path, _thumbnail(small)))

    def _look(self) -> None:
        """Take what has been decoded."""
        while self._done:
            found = self._done.popleft()
            if isinstance(found, LargePicture):
                self._pass_on(found)
            else:
                self._keep(*found)
        if not self.is_busy():
            self._timer.stop()

    def _decode_large(self, photo: PhotoMetadata, view: Rectification | None) -> LargePicture:
        try:
            if self._last is None or self._last[0] != photo.path:
                self._last = photo.path, colour_picture(photo)
            picture = self._last[1] if view is None else warp(self._last[1], view)[0]
        except InputError as error:
            return LargePicture(photo.path, view, (), str(error))
        return LargePicture(photo.path, view, _levels(picture))

    def _keep(self, path: Path, picture: QImage | None) -> None:
        self._cached[path] = picture
        while len(self._cached) > MAX_CACHED:
            self._cached.popitem(last=False)
        self.thumbnailReady.emit(path)

    def _pass_on(self, picture: LargePicture) -> None:
        if self._asked is not None and self._asked[0] == picture.path and self._asked[1] is picture.view:
            self.largeReady.emit(picture)


def _thumbnail(photo: PhotoMetadata) -> QImage | None:
    try:
        picture = _image(colour_picture(photo, 8))
    except InputError:
        return None
    side = QSize(THUMBNAIL_PX, THUMBNAIL_PX)
    return picture.scaled(side, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)


def _image(picture: NDArray[np.uint8]) -> QImage:
    """A picture, shape (h, w, 3), blue, green, red, in the format that is painted fastest."""
    height, width = picture.shape[:2]
    data = np.ascontiguousarray(picture)
    shared = QImage(data.data, width, height, 3 * width, QImage.Format.Format_BGR888)
    return shared.convertToFormat(QImage.Format.Format_RGB32)


def _levels(picture: NDArray[np.uint8]) -> tuple[QImage, ...]:
    levels = [_image(picture)]
    while min(levels[-1].width(), levels[-1].height()) > 2 * LEAST_LEVEL_PX:
        half = levels[-1].size() / 2
        levels.append(
            levels[-1].scaled(half, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation)
        )
    return tuple(levels)
