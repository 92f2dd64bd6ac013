"""What lies on the map in layers: online tiles, a map file, overlays, site and plan; each shown, faint or hidden."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPainterPath, QPen, QPolygonF

from groundstation.gui.map.map_paint import paint_label, paint_tiles
from groundstation.gui.map.tile_store import TileStore
from groundstation.gui.map.viewport import Viewport
from groundstation.gui.widgets.layer_list import LayerRow
from groundstation.gui.widgets.theme import SORTIES, Colours
from groundstation.services.map.online import OnlineMap, OnlineTiles
from groundstation.services.map.overlays import Overlay, read_overlay
from groundstation.services.map.tiles import open_map_file
from planning.base.errors import InputError

ONLINE, FILE, ZONES, SITE = "online", "file", "zones", "site"
"""Keys of layers; those of overlays are `overlay:` and a number, those of sorties `sortie:` and theirs."""

FADED = 0.2
"""How strongly sorties are drawn that are not looked at while one is."""

OVERLAY_COLOURS = ("#7b3294", "#008837", "#c51b7d", "#2166ac", "#8c510a", "#01665e")

POINT_PX, LINE_PX = 5.0, 2.5

LABEL_ZOOM = 14.0
"""Names of an overlay are shown from here on."""


@dataclass(frozen=True, slots=True)
class LayerState:
    """How a layer is shown."""

    is_visible: bool = True
    opacity: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """An overlay with its colour, its picture ready to be painted, and between which points it lies."""

    overlay: Overlay
    colour: str
    image: QImage | None
    extent: NDArray[np.float64]


def sortie_key(number: int) -> str:
    """Key of a sortie, counted from 1."""
    return f"sortie:{number}"


class MapLayers(QObject):
    """The layers of one map.

    Signals
    -------
    changed()
        Paint again: tiles came, or a layer of tiles or pictures is shown otherwise.
    shapesChanged()
        Shapes of overlays, site or plan are shown otherwise.
    rowsChanged()
        There are other layers.
    overlayAdded(str), overlaysChanged(tuple of Path)
        Key of a new overlay; the files of all of them.
    refused(Message)
        A file could not be read, and why.
    """

    changed = Signal()
    shapesChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    rowsChanged = Signal()  # noqa: N815
    overlayAdded = Signal(str)  # noqa: N815
    overlaysChanged = Signal(object)  # noqa: N815
    refused = Signal(object)
    _read = Signal(object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.file, self.online_tiles = TileStore(self), TileStore(self)
        self._online = OnlineMap()
        self._states: dict[str, LayerState] = {}
        self._overlays: dict[str, _Shown] = {}
        self._reading: list[Path] = []
        self._n_read = 0
        for store in (self.file, self.online_tiles):
            store.tilesReady.connect(self.changed)
            store.failed.connect(lambda _text: self.changed.emit())
        self._read.connect(self._take)

    # What there is

    def open_file(self, path: Path) -> None:
        """Show another map file.

        Raises
        ------
        InputError
            As `open_map_file`.
        """
        self.file.set_source(open_map_file(path))
        self.rowsChanged.emit()

    def online(self) -> OnlineMap:
        """The online map as it is set up."""
        return self._online

    def set_online(self, online: OnlineMap, caches: Path) -> None:
        """Set the online map up; nothing is asked for unless it is on.

        Raises
        ------
        InputError
            As `OnlineTiles`.
        """
        self._online = online
        self.online_tiles.set_source(OnlineTiles(online, caches) if online.is_on else None)
        self.rowsChanged.emit()
        self.changed.emit()

    def add_overlay(self, path: Path) -> None:
        """Read an overlay beside the window's thread; one that is there already is read anew."""
        if path in self._reading:
            return
        self._reading.append(path)
        threading.Thread(target=self._work, args=(path,), name="map-overlay", daemon=True).start()

    def remove(self, key: str) -> None:
        """Take an overlay from the map."""
        if self._overlays.pop(key, None) is not None:
            self._states.pop(key, None)
            self._tell_overlays()

    def overlay(self, key: str) -> Overlay:
        """An overlay by its key."""
        return self._overlays[key].overlay

    def swap_axes(self, key: str) -> None:
        """Exchange latitudes and longitudes of an overlay; its file stays as it is."""
        shown = self._overlays[key]
        overlay = shown.overlay.swapped()
        self._overlays[key] = replace(shown, overlay=overlay, extent=overlay.extent())
        self.shapesChanged.emit()

    def extent(self) -> NDArray[np.float64] | None:
        """Points between which all overlays lie, shape (n, 2); None without any."""
        found = [shown.extent for shown in self._overlays.values()]
        return np.concatenate(found) if found else None

    def is_busy(self) -> bool:
        """Whether tiles or overlays are being read."""
        return bool(self._reading) or self.file.is_busy() or self.online_tiles.is_busy()

    def close(self) -> None:
        """Read nothing more."""
        for store in (self.file, self.online_tiles):
            store.close()

    # How it is shown

    def rows(self, *, has_site: bool, n_sorties: int = 0, has_zones: bool = False) -> tuple[LayerRow, ...]:
        """Layers for a list, the topmost first."""
        rows = []
        for number in range(1, n_sorties + 1):
            colour = SORTIES[(number - 1) % len(SORTIES)]
            rows.append(LayerRow(sortie_key(number), self.tr("Sortie {0}").format(number), colour=colour))
        if has_site:
            rows.append(LayerRow(SITE, self.tr("Site")))
        if has_zones:
            rows.append(LayerRow(ZONES, self.tr("Geo-zones")))
        for key, shown in reversed(self._overlays.items()):
            name, colour = shown.overlay.name, "" if shown.image is not None else shown.colour
            rows.append(LayerRow(key, name, colour=colour, tip=str(shown.overlay.path), can_remove=True))
        source = self.file.source()
        if source is not None:
            rows.append(LayerRow(FILE, source.info.name, tip=str(source.info.path)))
        if self._online.is_on:
            rows.append(LayerRow(ONLINE, self.tr("Online map"), tip=self._online.server))
        return tuple(
            replace(row, is_visible=self.state(row.key).is_visible, opacity=self.state(row.key).opacity) for row in rows
        )

    def state(self, key: str) -> LayerState:
        """How a layer is shown."""
        return self._states.get(key, LayerState())

    def set_state(self, key: str, is_visible: bool, opacity: float) -> None:
        """Show a layer otherwise."""
        self._states[key] = LayerState(is_visible, opacity)
        (self.changed if key in (FILE, ONLINE) else self.shapesChanged).emit()

    def sortie_strengths(self, n_sorties: int, focus: int = 0) -> dict[int, float]:
        """Opacity of each sortie, counted from 1, 0 where it is hidden; others than the one in focus are faint."""
        states = {number: self.state(sortie_key(number)) for number in range(1, n_sorties + 1)}
        return {
            number: (state.opacity if focus in (0, number) else FADED * state.opacity) if state.is_visible else 0.0
            for number, state in states.items()
        }

    def has_tiles(self) -> bool:
        """Whether there is a map that is shown."""
        return any(True for _ in self._shown_stores())

    def attribution(self) -> str:
        """Whose data is shown."""
        texts = [store.source().info.attribution for _, store in self._shown_stores()]  # type: ignore[union-attr]
        return " · ".join(dict.fromkeys(text for text in texts if text))

    def problem(self) -> str:
        """Why the online map cannot be reached; empty where it can, or is not wanted."""
        return self.online_tiles.problem() if self.state(ONLINE).is_visible and self._online.is_on else ""

    # Painting

    def paint_tiles(self, painter: QPainter, viewport: Viewport) -> None:
        """Paint the maps, and ask for the tiles that are missed."""
        for key, store in self._shown_stores():
            source = store.source()
            assert source is not None
            painter.setOpacity(self.state(key).opacity)
            store.want(paint_tiles(painter, viewport, source.info, store.picture, store.knows))
        painter.setOpacity(1.0)

    def paint_overlays(self, painter: QPainter, viewport: Viewport, found: Colours) -> None:
        """Paint the overlays, pictures below shapes."""
        shown = [(key, shown) for key, shown in self._overlays.items() if self.state(key).is_visible]
        for key, each in shown:
            if each.image is not None and each.overlay.picture is not None:
                picture = each.overlay.picture
                corners = viewport.screen(np.array([picture.low, picture.high]) + _near(each.extent, viewport))
                painter.setOpacity(self.state(key).opacity)
                painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
                target = QRectF(QPointF(*corners[0]), QPointF(*corners[1]))
                painter.drawImage(target, each.image, QRectF(each.image.rect()))
        for key, each in shown:
            painter.setOpacity(self.state(key).opacity)
            _paint_shapes(painter, viewport, each, found)
        painter.setOpacity(1.0)

    # Parts

    def _shown_stores(self) -> list[tuple[str, TileStore]]:
        """Stores with a source that is shown, the lowest first."""
        stores = ((ONLINE, self.online_tiles), (FILE, self.file))
        return [(key, store) for key, store in stores if store.source() is not None and self.state(key).is_visible]

    def _work(self, path: Path) -> None:
        try:
            self._read.emit(path, read_overlay(path))
        except InputError as error:
            self._read.emit(path, error)

    def _take(self, path: Path, result: Overlay | InputError) -> None:
        self._reading.remove(path)
        if isinstance(result, InputError):
            self.refused.emit(str(result))
            self._tell_overlays()
            return
        key = next((key for key, shown in self._overlays.items() if shown.overlay.path == path), None)
        if key is None:
            key = f"overlay:{self._n_read}"
            self._n_read += 1
        number = int(key.partition(":")[2])
        image = None
        if result.picture is not None:
            height, width, _ = result.picture.rgba.shape
            image = QImage(result.picture.rgba.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888)
            image = image.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
        colour = OVERLAY_COLOURS[number % len(OVERLAY_COLOURS)]
        self._overlays[key] = _Shown(result, colour, image, result.extent())
        self._tell_overlays()
        self.overlayAdded.emit(key)

    def _tell_overlays(self) -> None:
        self.rowsChanged.emit()
        self.shapesChanged.emit()
        if not self._reading:
            self.overlaysChanged.emit(tuple(shown.overlay.path for shown in self._overlays.values()))


def _near(extent: NDArray[np.float64], viewport: Viewport) -> NDArray[np.float64]:
    """Whole turns of the world that bring an overlay nearest to what is in sight, shape (2,)."""
    middle = 0.5 * (extent[:, 0].min() + extent[:, 0].max())
    return np.array([np.round(viewport.centre[0] - middle), 0.0])


def _paint_shapes(painter: QPainter, viewport: Viewport, shown: _Shown, found: Colours) -> None:
    """Areas, lines, points and names of an overlay, as far as they are in sight."""
    overlay, turn = shown.overlay, _near(shown.extent, viewport)
    colour = QColor(shown.colour)
    fill = QColor(colour)
    fill.setAlpha(50)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(colour, LINE_PX))
    for area in overlay.areas:
        rings = [viewport.screen(ring + turn) for ring in area]
        if _is_in_sight(rings[0], viewport):
            path = QPainterPath()
            for ring in rings:
                path.addPolygon(_polygon(ring))
                path.closeSubpath()
            painter.setBrush(fill)
            painter.drawPath(path)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for line in overlay.lines:
        points = viewport.screen(line + turn)
        if _is_in_sight(points, viewport):
            painter.drawPolyline(_polygon(points))
    painter.setBrush(colour)
    painter.setPen(QPen(QColor(255, 255, 255, 220), 1.5))
    if len(overlay.points):
        points = viewport.screen(overlay.points + turn)
        size = (viewport.width_px, viewport.height_px)
        for x, y in points[((points > -POINT_PX) & (points < np.add(size, POINT_PX))).all(axis=1)].tolist():
            painter.drawEllipse(QPointF(x, y), POINT_PX, POINT_PX)
    if viewport.zoom >= LABEL_ZOOM:
        for name, place in overlay.labels:
            x, y = viewport.screen(np.array([place]) + turn)[0]
            if 0.0 <= x <= viewport.width_px and 0.0 <= y <= viewport.height_px:
                paint_label(painter, QPointF(x, y - 14.0), name, found)


def _is_in_sight(points: NDArray[np.float64], viewport: Viewport) -> bool:
    low, high = points.min(axis=0), points.max(axis=0)
    return bool((high >= 0.0).all() and (low <= (viewport.width_px, viewport.height_px)).all())


def _polygon(points: NDArray[np.float64]) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in points.tolist()])
