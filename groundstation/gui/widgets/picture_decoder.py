"""Pictures of files, decoded on another thread, small ones kept while they are likely to be seen again."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from collections.abc import Callable
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QImage

MAX_CACHED = 1000
"""Of some 60 KiB each: 60 MB at most, however many photos there are."""

MAX_WANTED = 80
"""More than a strip shows at once; what was wanted before them has been scrolled past."""

LOOK_MS = 15
"""How often it is looked what has been decoded. The thread tells nobody itself: its listener may be gone by then."""

Source = TypeVar("Source")


class PictureDecoder(QObject, Generic[Source]):
    """Decodes small pictures of files, those first that were asked for last.

    Parameters
    ----------
    decode
        Makes the small picture of a source, on the thread; None where the file is damaged.
    tell
        Called on the window's thread with the path of each small picture that is there from now on.
    """

    def __init__(
        self,
        decode: Callable[[Source], QImage | None],
        tell: Callable[[Path], None],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._decode, self._tell = decode, tell
        self._cached: OrderedDict[Path, QImage | None] = OrderedDict()
        self._wanted: OrderedDict[Path, Source] = OrderedDict()
        self._done: deque[Callable[[], None]] = deque()
        self._first: Callable[[], Callable[[], None]] | None = None
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)

    def picture(self, path: Path, source: Source) -> QImage | None:
        """A small picture; None while it is decoded, and where the file is damaged."""
        if path in self._cached:
            self._cached.move_to_end(path)
            return self._cached[path]
        with self._lock:
            self._wanted[path] = source
            self._wanted.move_to_end(path)
            while len(self._wanted) > MAX_WANTED:
                self._wanted.popitem(last=False)
        self._start()
        return None

    def work_first(self, work: Callable[[], Callable[[], None]]) -> None:
        """Do this before all small pictures, in place of what waits as such; what it returns runs in the window."""
        with self._lock:
            self._first = work
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
            self._first = None
        if worker is not None:
            worker.join(10.0)

    def _start(self) -> None:
        with self._lock:
            if self._worker is None:
                self._worker = threading.Thread(target=self._work, name="pictures", daemon=True)
                self._worker.start()
        self._timer.start(LOOK_MS)

    def _work(self) -> None:
        while True:
            with self._lock:
                work, self._first = self._first, None
                small = self._wanted.popitem() if work is None and self._wanted else None
                if work is None and small is None:
                    self._worker = None
                    return
            if work is not None:
                self._done.append(work())
            elif small is not None:
                self._done.append(self._kept(small[0], self._decode(small[1])))

    def _kept(self, path: Path, picture: QImage | None) -> Callable[[], None]:
        def keep() -> None:
            self._cached[path] = picture
            while len(self._cached) > MAX_CACHED:
                self._cached.popitem(last=False)
            self._tell(path)

        return keep

    def _look(self) -> None:
        while self._done:
            self._done.popleft()()
        if not self.is_busy():
            self._timer.stop()


def qimage_of(picture: NDArray[np.uint8], order: QImage.Format = QImage.Format.Format_BGR888) -> QImage:
    """A picture, shape (h, w, 3), blue, green, red or in another order, in the format that is painted fastest."""
    height, width = picture.shape[:2]
    data = np.ascontiguousarray(picture)
    return QImage(data.data, width, height, 3 * width, order).convertToFormat(QImage.Format.Format_RGB32)
