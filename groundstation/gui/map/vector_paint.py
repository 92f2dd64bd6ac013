"""Pictures of vector tiles, painted on the thread that reads them: a tile, or the part that a deeper level shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter, QPainterPath, QPen, QPolygonF

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
