"""Pictures of map tiles: read and decoded on another thread, kept while they are likely to be seen again."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QObject, Signal
from PySide6.QtGui import QImage, QImageReader

from groundstation.services.map.tiles import MapTiles
from groundstation.services.map.web_mercator import Tile

MAX_CACHED = 400
"""Of 256 KiB each at the usual 256 x 256: about 100 MB, ten screens full at 1920 x 1080."""

MAX_SIDE_PX = 1024
"""Larger tiles do not exist; a picture that says so would only fill the memory."""


class TileStore(QObject):
    """Decoded tiles of one map.

    Signals
    -------
    tilesReady()
        More tiles were decoded: paint again.
    """

    tilesReady = Signal()  # noqa: N815  (Qt's own way of naming)
    _decoded = Signal(object, object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._source: MapTiles | None = None
        self._cached: OrderedDict[Tile, QImage | None] = OrderedDict()
        self._wanted: list[Tile] = []
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._decoded.connect(self._keep)

    def source(self) -> MapTiles | None:
        """The map that is shown."""
        return self._source

    def set_source(self, source: MapTiles | None) -> None:
        """Take another map; the old one is closed."""
        with self._lock:
            old, self._source, self._wanted = self._source, source, []
        if old is not None:
            old.close()
        self._cached.clear()

    def knows(self, tile: Tile) -> bool:
        """Whether it is known what a tile shows, or that it shows nothing."""
        return tile in self._cached

    def picture(self, tile: Tile) -> QImage | None:
        """A decoded tile; None while it is not, and where the map has none."""
        found = self._cached.get(tile)
        if found is not None:
            self._cached.move_to_end(tile)
        return found

    def want(self, tiles: Sequence[Tile]) -> None:
        """Read these next, in this order; what was wanted before and is not now is forgotten."""
        with self._lock:
            self._wanted = [tile for tile in tiles if tile not in self._cached]
            if self._source is None or not self._wanted or self._worker is not None:
                return
            self._worker = threading.Thread(target=self._work, name="map-tiles", daemon=True)
        self._worker.start()

    def is_busy(self) -> bool:
        """Whether tiles are being read."""
        with self._lock:
            return self._worker is not None

    def close(self) -> None:
        """Read nothing more, and wait for the tile that is being read."""
        with self._lock:
            worker = self._worker
        self.set_source(None)
        if worker is not None:
            worker.join(5.0)

    def _work(self) -> None:
        while True:
            with self._lock:
                source = self._source
                if source is None or not self._wanted:
                    self._worker = None
                    return
                tile = self._wanted.pop(0)
            self._decoded.emit(source, tile, decode_tile(source.image(tile)))

    def _keep(self, source: MapTiles, tile: Tile, picture: QImage | None) -> None:
        if source is not self._source:
            return
        self._cached[tile] = picture
        while len(self._cached) > MAX_CACHED:
            self._cached.popitem(last=False)
        self.tilesReady.emit()


def decode_tile(data: bytes | None) -> QImage | None:
    """A picture ready to be painted; None for damaged and oversized ones."""
    if data is None:
        return None
    buffer = QBuffer()
    buffer.setData(QByteArray(data))
    buffer.open(QIODevice.OpenModeFlag.ReadOnly)
    reader = QImageReader(buffer)
    size = reader.size()
    if not (0 < size.width() <= MAX_SIDE_PX and 0 < size.height() <= MAX_SIDE_PX):
        return None
    picture = reader.read()
    if picture.isNull():
        return None
    return picture.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
