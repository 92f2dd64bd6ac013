"""Pictures of map tiles: read and decoded on another thread, kept while they are likely to be seen again.

Vector tiles are painted on the thread that reads them: a tile, or the part of it that a deeper level shows.
"""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontMetricsF,
    QGuiApplication,
    QImage,
    QImageReader,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
)

from groundstation.services.map.map_style import (
    BORDER,
    BUILDING,
    BUILDING_EDGE,
    GROUND,
    LAND,
    LAYERS,
    PLACES,
    RAIL,
    TEXT,
    WATER,
    Role,
    class_of,
    ground_colour,
    is_drawn_as_area,
    name_of,
    road_class,
    role_of,
)
from groundstation.services.map.tile_source import TileNotReached, TileSource
from groundstation.services.map.vector_tiles import Geometry, Value, VectorLayer, decode_vector_tile
from groundstation.services.map.web_mercator import Tile, geodetic_from_world, metres_per_point

PICTURE_PX = 512

BUILDING_EDGE_ZOOM, NAME_ZOOM, SERVICE_NAME_ZOOM = 15, 13, 15
"""Levels from which on buildings have outlines, and roads names."""

CASING_PX = 1.2
"""By which the edge of a road is wider than the road, both sides together."""

MARGIN = 0.05
"""Of a picture: what lies beyond its edge by less still reaches into it by its width."""

SMALLEST_PX = 0.5
"""Areas that are narrower on the picture are not drawn."""

MAX_NAMES = 24
"""Of one picture."""

FONT_PX = 13.0


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    """A feature, its points in pixels of the picture."""

    role: Role
    geometry: Geometry
    properties: dict[str, Value]
    parts: list[NDArray[np.float64]]


def read_layers(data: bytes) -> tuple[VectorLayer, ...]:
    """Layers of a tile that are drawn.

    Raises
    ------
    ValueError
        As `decode_vector_tile`.
    """
    return decode_vector_tile(data, LAYERS)


def paint_vector_tile(layers: tuple[VectorLayer, ...], of: Tile, tile: Tile, family: str) -> QImage:
    """Picture of a tile from the layers of the tile `of`, which is the same or one above.

    Parameters
    ----------
    family
        Font of names.
    """
    picture = QImage(PICTURE_PX, PICTURE_PX, QImage.Format.Format_ARGB32_Premultiplied)
    picture.fill(QColor(LAND))
    shapes = _shapes(layers, of, tile)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    _paint_areas(painter, shapes, tile)
    _paint_roads(painter, shapes, tile)
    _paint_names(painter, shapes, tile, family)
    painter.end()
    return picture


def _shapes(layers: tuple[VectorLayer, ...], of: Tile, tile: Tile) -> list[_Shape]:
    """What a picture shows of a tile, in the order in which it is drawn."""
    levels = tile.zoom - of.zoom
    shift = np.array([tile.column - (of.column << levels), tile.row - (of.row << levels)], np.float64)
    found = []
    for layer in layers:
        if not len(layer.part_ends):
            continue
        points = (layer.points * 2**levels - shift) * PICTURE_PX
        starts = np.concatenate([[0], layer.part_ends[:-1]])
        low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
        margin = MARGIN * PICTURE_PX
        is_in = np.all((high > -margin) & (low < PICTURE_PX + margin), axis=1)
        first = 0
        for number, last in enumerate(layer.feature_ends.tolist()):
            if is_in[first:last].any():
                properties, geometry = layer.properties[number], layer.geometries[number]
                role = role_of(layer.name, properties)
                if role is not None:
                    # Rings stay together, or holes would be filled.
                    whole = geometry is Geometry.POLYGON
                    parts = [points[starts[i] : layer.part_ends[i]] for i in range(first, last) if whole or is_in[i]]
                    found.append(_Shape(role, geometry, properties, parts))
            first = last
    return sorted(found, key=lambda shape: shape.role)


def _paint_areas(painter: QPainter, shapes: list[_Shape], tile: Tile) -> None:
    for shape in shapes:
        if not is_drawn_as_area(shape.role, shape.geometry):
            continue
        spans = np.ptp(np.concatenate(shape.parts), axis=0)
        if spans.max() < SMALLEST_PX:
            continue
        painter.setPen(Qt.PenStyle.NoPen)
        match shape.role:
            case Role.WATER:
                painter.setBrush(QColor(WATER))
            case Role.BUILDING:
                painter.setBrush(QColor(BUILDING))
                if tile.zoom >= BUILDING_EDGE_ZOOM:
                    painter.setPen(QPen(QColor(BUILDING_EDGE), 1.0))
            case Role.RUNWAY:
                painter.setBrush(QColor(GROUND["apron"]))
            case _:
                painter.setBrush(QColor(ground_colour(shape.properties)))
        painter.drawPath(_rings(shape.parts))


def _paint_roads(painter: QPainter, shapes: list[_Shape], tile: Tile) -> None:
    """Waters that are lines, roads with their edges, rails and borders."""
    lat_deg = geodetic_from_world(0.0, (tile.row + 0.5) / 2**tile.zoom)[0]
    metres_per_px = metres_per_point(lat_deg, tile.zoom) * 256.0 / PICTURE_PX
    lines = [shape for shape in shapes if shape.geometry is Geometry.LINE]
    for shape in lines:
        if shape.role is Role.WATERWAY:
            _stroke(painter, shape.parts, WATER, max(1.2, 3.0 / metres_per_px))
    found = [(road_class(shape.properties), shape) for shape in lines if shape.role is Role.ROAD]
    roads = sorted(
        ((road, shape) for road, shape in found if tile.zoom >= road.min_zoom - 1), key=lambda pair: pair[0].rank
    )
    for road, shape in roads:
        if road.casing:
            width = max(road.least_px, road.width_m / metres_per_px)
            _stroke(painter, shape.parts, road.casing, width + CASING_PX)
    for road, shape in roads:
        width = max(road.least_px, road.width_m / metres_per_px)
        _stroke(painter, shape.parts, road.fill, width, is_dashed=not road.casing)
    for shape in lines:
        if shape.role is Role.RAIL and tile.zoom >= 10:
            _stroke(painter, shape.parts, RAIL, max(1.2, 1.5 / metres_per_px))
        elif shape.role is Role.BORDER:
            _stroke(painter, shape.parts, BORDER, 1.2, is_dashed=True)
        elif shape.role is Role.RUNWAY:
            _stroke(painter, shape.parts, GROUND["apron"], max(1.5, 30.0 / metres_per_px))


def _paint_names(painter: QPainter, shapes: list[_Shape], tile: Tile, family: str) -> None:
    """Names that fit into the picture whole and over no other: a name is never cut at the edge of a tile."""
    taken: list[QRectF] = []
    known: set[str] = set()
    for shape in reversed(shapes):
        name = name_of(shape.properties)
        if not name or name in known or len(taken) >= MAX_NAMES:
            continue
        if shape.role is Role.PLACE:
            first, last, size = PLACES.get(class_of(shape.properties, PLACES), (25, 25, 1.0))
            if not first <= tile.zoom + 1 <= last:
                continue
            place, turn = shape.parts[0].mean(axis=0), 0.0
            font = _font(family, size, is_bold=size > 1.0)
        elif shape.geometry is Geometry.LINE and (shape.role in (Role.ROAD_NAME, Role.ROAD)) and tile.zoom >= NAME_ZOOM:
            font = _font(family, 0.85)
            longest = _longest_leg(shape.parts)
            if longest is None or longest[2] < QFontMetricsF(font).horizontalAdvance(name) + 8.0:
                continue
            place, turn, _ = longest
        else:
            continue
        box = _turned_box(QFontMetricsF(font), name, place, turn)
        inside = QRectF(2, 2, PICTURE_PX - 4, PICTURE_PX - 4).contains(box)
        if not inside or any(box.intersects(other) for other in taken):
            continue
        taken.append(box)
        known.add(name)
        _write(painter, font, name, place, turn)


def _longest_leg(parts: list[NDArray[np.float64]]) -> tuple[NDArray[np.float64], float, float] | None:
    """Middle, turn (degrees, so that its text is not upside down) and length of the longest straight piece inside."""
    best: tuple[NDArray[np.float64], float, float] | None = None
    for part in parts:
        legs = np.diff(part, axis=0)
        if not len(legs):
            continue
        middles = 0.5 * (part[1:] + part[:-1])
        is_in = np.all((middles > 0.0) & (middles < PICTURE_PX), axis=1)
        lengths = np.where(is_in, np.hypot(legs[:, 0], legs[:, 1]), 0.0)
        longest = int(lengths.argmax())
        if lengths[longest] > (0.0 if best is None else best[2]):
            turn = float(np.degrees(np.arctan2(legs[longest, 1], legs[longest, 0])))
            turn = turn - 180.0 if turn > 90.0 else turn + 180.0 if turn <= -90.0 else turn
            best = middles[longest], turn, float(lengths[longest])
    return best


def _turned_box(metrics: QFontMetricsF, name: str, place: NDArray[np.float64], turn_deg: float) -> QRectF:
    """Upright box around a text that is turned about its middle."""
    width, height, turn = metrics.horizontalAdvance(name), metrics.height(), np.radians(turn_deg)
    half_w = 0.5 * (width * abs(np.cos(turn)) + height * abs(np.sin(turn)))
    half_h = 0.5 * (width * abs(np.sin(turn)) + height * abs(np.cos(turn)))
    return QRectF(place[0] - half_w, place[1] - half_h, 2.0 * half_w, 2.0 * half_h)


def _write(painter: QPainter, font: QFont, name: str, place: NDArray[np.float64], turn_deg: float) -> None:
    """A text with a pale rim, about its middle."""
    metrics = QFontMetricsF(font)
    path = QPainterPath()
    path.addText(QPointF(-0.5 * metrics.horizontalAdvance(name), 0.5 * metrics.ascent() - 2.0), font, name)
    painter.save()
    painter.translate(*place)
    painter.rotate(turn_deg)
    rim = QPen(QColor(255, 255, 255, 220), 3.0)
    rim.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.strokePath(path, rim)
    painter.fillPath(path, QColor(TEXT))
    painter.restore()


def _font(family: str, size: float, *, is_bold: bool = False) -> QFont:
    font = QFont(family)
    font.setPixelSize(round(FONT_PX * size))
    font.setBold(is_bold)
    return font


def _stroke(
    painter: QPainter, parts: list[NDArray[np.float64]], colour: str, width_px: float, *, is_dashed: bool = False
) -> None:
    pen = QPen(QColor(colour), width_px)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap if is_dashed else Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    if is_dashed:
        pen.setDashPattern([3.0, 2.0])
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for part in parts:
        painter.drawPolyline(_polygon(part))


def _rings(parts: list[NDArray[np.float64]]) -> QPainterPath:
    path = QPainterPath()
    for part in parts:
        path.addPolygon(_polygon(part))
        path.closeSubpath()
    return path


def _polygon(points: NDArray[np.float64]) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in points.tolist()])


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
    failed(Message)
        The source could not be reached, and why; empty where it is reached again.
    """

    tilesReady = Signal()  # noqa: N815  (Qt's own way of naming)
    failed = Signal(object)
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
