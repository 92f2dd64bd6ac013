"""Small copies of photos for the strip, decoded on another thread, those last that were asked for first."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from pathlib import Path

import cv2
import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QImage

from planning.base.errors import InputError
from planning.base.files import read_given
from reconstruction.photos.decode import PICTURE_FILE, decoded

SIDE_PX = 132
MOST_KEPT, MOST_WANTED = 1000, 80
LOOK_MS = 30
"""How often it is looked what has been decoded. The thread tells nobody itself: its listener may be gone by then."""

FLAGS = {1: cv2.IMREAD_COLOR, 2: cv2.IMREAD_REDUCED_COLOR_2, 4: cv2.IMREAD_REDUCED_COLOR_4}
FLAGS |= {8: cv2.IMREAD_REDUCED_COLOR_8}


class SmallPictures(QObject):
    """Keeps small pictures of files.

    Signals
    -------
    ready(Path)
    """

    ready = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._kept: OrderedDict[Path, QImage | None] = OrderedDict()
        self._wanted: OrderedDict[Path, int] = OrderedDict()
        self._done: deque[tuple[Path, QImage | None]] = deque()
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def picture(self, path: Path, longest_px: int) -> QImage | None:
        """A small picture of a file whose longest side is known; None while it is decoded, or where it is damaged."""
        if path in self._kept:
            self._kept.move_to_end(path)
            return self._kept[path]
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
            self._kept[path] = picture
            while len(self._kept) > MOST_KEPT:
                self._kept.popitem(last=False)
            self.ready.emit(path)
        if not self.is_busy():
            self._timer.stop()


def _small(path: Path, longest_px: int) -> QImage | None:
    scale = max(each for each in FLAGS if each == 1 or longest_px // each >= SIDE_PX)
    try:
        content = read_given(path, PICTURE_FILE)
        picture = decoded(content, FLAGS[scale] | cv2.IMREAD_IGNORE_ORIENTATION, str(path))
    except InputError:
        return None
    height, width = picture.shape[:2]
    share = min(1.0, SIDE_PX / max(height, width))
    size = max(1, round(share * width)), max(1, round(share * height))
    small = np.ascontiguousarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
    shared = QImage(small.data, size[0], size[1], 3 * size[0], QImage.Format.Format_BGR888)
    return shared.convertToFormat(QImage.Format.Format_RGB32)
