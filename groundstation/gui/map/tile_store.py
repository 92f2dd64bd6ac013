"""Pictures of map tiles: read and decoded on another thread, kept while they are likely to be seen again."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Sequence

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QObject, Signal
from PySide6.QtGui import QGuiApplication, QImage, QImageReader

from groundstation.gui.map.vector_paint import paint_vector_tile, read_layers
from groundstation.services.map.tile_source import TileNotReached, TileSource
from groundstation.services.map.vector_tiles import VectorLayer
from groundstation.services.map.web_mercator import Tile

MAX_CACHED = 400
"""Of 256 KiB each at the usual 256 x 256: about 100 MB, ten screens full at 1920 x 1080."""

VECTOR_SHARE = 4
"""Pictures of vector tiles are four times as large, and so many fewer are kept."""

MAX_LAYERS_KEPT = 6
"""Vector tiles of which the shapes are kept, for the levels that are drawn from them."""

RETRY_S = 10.0
"""How long nothing is asked for after a source could not be reached."""

MAX_SIDE_PX = 1024
"""Larger tiles do not exist; a picture that says so would only fill the memory."""


class TileReader:
    """Pictures of the tiles of one source, on the thread that calls it."""

    def __init__(self, source: TileSource) -> None:
        self.source = source
        self._layers: OrderedDict[Tile, tuple[VectorLayer, ...]] = OrderedDict()
        self._family = QGuiApplication.font().family()

    def picture(self, tile: Tile) -> QImage | None:
        """Picture of a tile; None where there is none, or a damaged one.

        Raises
        ------
        TileNotReached
            As `TileSource.image`.
        """
        info = self.source.info
        if not info.is_vector:
            return decode_tile(self.source.image(tile))
        of = tile.parent(max(0, tile.zoom - info.max_zoom))
        layers = self._layers.get(of)
        if layers is None:
            data = self.source.image(of)
            try:
                layers = () if data is None else read_layers(data)
            except ValueError:
                # A damaged tile is a hole, as in a map of pictures.
                layers = ()
            self._layers[of] = layers
            while len(self._layers) > MAX_LAYERS_KEPT:
                self._layers.popitem(last=False)
        self._layers.move_to_end(of)
        return paint_vector_tile(layers, of, tile, self._family) if layers else None


class TileStore(QObject):
    """Decoded tiles of one map.

    Signals
    -------
    tilesReady()
        More tiles were decoded: paint again.
    failed(str)
        The source could not be reached, and why; empty where it is reached again.
    """

    tilesReady = Signal()  # noqa: N815  (Qt's own way of naming)
    failed = Signal(str)
    _decoded = Signal(object, object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._reader: TileReader | None = None
        self._cached: OrderedDict[Tile, QImage | None] = OrderedDict()
        self._wanted: list[Tile] = []
        self._lock = threading.Lock()
        self._worker: threading.Thread | None = None
        self._n_on_their_way = 0
        self._paused_until_s = 0.0
        self._problem = ""
        self._decoded.connect(self._keep)

    def source(self) -> TileSource | None:
        """The map that is shown."""
        return None if self._reader is None else self._reader.source

    def set_source(self, source: TileSource | None) -> None:
        """Take another map; the old one is closed."""
        with self._lock:
            old, self._wanted = self._reader, []
            self._reader = None if source is None else TileReader(source)
            self._paused_until_s, self._problem = 0.0, ""
        if old is not None:
            old.source.close()
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
            if self._reader is None or not self._wanted or self._worker is not None:
                return
            if time.monotonic() < self._paused_until_s:
                return
            self._worker = threading.Thread(target=self._work, name="map-tiles", daemon=True)
        self._worker.start()

    def is_busy(self) -> bool:
        """Whether tiles are being read, or are on their way to the window's thread."""
        with self._lock:
            return self._worker is not None or self._n_on_their_way > 0

    def close(self) -> None:
        """Read nothing more, and wait for the tile that is being read."""
        with self._lock:
            worker = self._worker
        self.set_source(None)
        if worker is not None:
            worker.join(5.0)

    def problem(self) -> str:
        """Why the source cannot be reached; empty where it can."""
        return self._problem

    def _work(self) -> None:
        while True:
            with self._lock:
                reader = self._reader
                if reader is None or not self._wanted:
                    self._worker = None
                    return
                tile = self._wanted.pop(0)
            try:
                picture = reader.picture(tile)
            except TileNotReached as error:
                with self._lock:
                    self._worker, self._wanted = None, []
                    self._paused_until_s = time.monotonic() + RETRY_S
                self._tell(reader, str(error))
                return
            self._tell(reader, "")
            with self._lock:
                self._n_on_their_way += 1
            self._decoded.emit(reader, tile, picture)

    def _tell(self, reader: TileReader, problem: str) -> None:
        with self._lock:
            is_news = reader is self._reader and problem != self._problem
            if is_news:
                self._problem = problem
        if is_news:
            self.failed.emit(problem)

    def _keep(self, reader: TileReader, tile: Tile, picture: QImage | None) -> None:
        with self._lock:
            self._n_on_their_way -= 1
        if reader is not self._reader:
            return
        self._cached[tile] = picture
        while len(self._cached) > (MAX_CACHED // VECTOR_SHARE if reader.source.info.is_vector else MAX_CACHED):
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
