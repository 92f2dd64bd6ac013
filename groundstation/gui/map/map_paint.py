"""Painting of a map's layers onto any painter: tiles or a grid, the site, the plan, and what belongs on every map."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QImage, QPainter, QPainterPath, QPen, QPolygonF

from groundstation.gui.map.viewport import Viewport
from groundstation.gui.widgets.theme import FACADES, SORTIES, Colours, zone_colour
from groundstation.services.map.shapes import PlanShapes, SiteShapes, ZoneArea, round_length
from groundstation.services.map.tile_source import TileSetInfo
from groundstation.services.map.web_mercator import TILE_POINTS, Tile
from groundstation.services.units import UnitSystem, distance_unit, length_unit

WEDGE_PX, WEDGE_HALF_RAD = 15.0, math.radians(20.0)
SCALE_BAR_PX = 140.0
GRID_PX = 70.0
"""Widest scale bar and narrowest grid."""

FAR_M = 2000.0
"""From here on distances are read in kilometres or miles."""

MAX_TILES = 200
"""More in sight than this are too small to show anything."""

MAX_OVERZOOM = 6
"""Levels above that a missing tile is taken from; a point then has become 64 pixels."""

BUILDING, OBSTACLE, RALLY, PAPER = (QColor("#8d96a0"), QColor("#b5793f"), QColor("#7a4fa3"), QColor(255, 255, 255, 220))


def tile_level(viewport: Viewport, min_zoom: int, max_zoom: int, tile_points: int = TILE_POINTS) -> int:
    """Level of the tiles, so many points wide, that fit a viewport best."""
    return min(max(round(viewport.zoom - math.log2(tile_points / TILE_POINTS)), min_zoom), max_zoom)


def paint_tiles(
    painter: QPainter,
    viewport: Viewport,
    info: TileSetInfo,
    picture: Callable[[Tile], QImage | None],
    knows: Callable[[Tile], bool],
) -> list[Tile]:
    """Paint the tiles that are at hand, else a piece of a tile above; returns the tiles that are missed."""
    levels = info.levels
    level = tile_level(viewport, *levels, info.tile_points)
    in_sight = viewport.tiles(level) if viewport.scale / 2**level * MAX_TILES**0.5 > viewport.width_px else []
    size_px = viewport.scale / 2**level
    missed: dict[Tile, None] = {}
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    for tile, x, y in in_sight:
        # Edges on whole pixels leave no seams between neighbours.
        left, top, right, bottom = round(x), round(y), round(x + size_px), round(y + size_px)
        target = QRectF(left, top, right - left, bottom - top)
        is_waited_for = False
        for above in range(min(MAX_OVERZOOM, level - levels[0]) + 1):
            parent = tile.parent(above)
            # A tile above is asked for only where there is none below it.
            if not is_waited_for and not knows(parent):
                is_waited_for = True
                missed[parent] = None
            found = picture(parent)
            if found is not None:
                share = found.width() / 2**above, found.height() / 2**above
                column, row = tile.column - (parent.column << above), tile.row - (parent.row << above)
                painter.drawImage(target, found, QRectF(column * share[0], row * share[1], *share))
                break
    return list(missed)


def paint_grid(
    painter: QPainter, viewport: Viewport, anchor: NDArray[np.float64], units: UnitSystem, line: str
) -> None:
    """Lines a round length apart, counted from `anchor` (world coordinates): a ground where there is no map."""
    unit = length_unit(units)
    # The first round length that is at least as wide as wanted.
    step = round_length(unit.shown(GRID_PX * viewport.metres_per_px) * 2.5)
    step_px = unit.metric(step) / viewport.metres_per_px
    at = viewport.screen(anchor[None])[0]
    pale = QColor(line)
    pale.setAlpha(130)
    painter.setPen(QPen(pale, 1))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    lines = [QLineF(x, 0, x, viewport.height_px) for x in np.arange(at[0] % step_px, viewport.width_px, step_px)]
    lines += [QLineF(0, y, viewport.width_px, y) for y in np.arange(at[1] % step_px, viewport.height_px, step_px)]
    painter.drawLines(lines)


def paint_site(painter: QPainter, viewport: Viewport, shapes: SiteShapes, found: Colours) -> None:
    """Airspace, no-fly zones, solids and panels."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(found.muted), 1.5, Qt.PenStyle.DashLine))
    painter.drawPath(_path(shapes.airspace.rings, viewport))
    for number, area in enumerate(shapes.solids):
        colour = BUILDING if number == 0 and area.item.id == "" else OBSTACLE
        painter.setPen(QPen(colour.darker(160), 1.5))
        painter.setBrush(colour)
        painter.drawPath(_path(area.rings, viewport))
    for zone in shapes.no_fly:
        red = QColor(found.error)
        painter.setPen(QPen(red, 2))
        fill = QColor(red)
        fill.setAlpha(45)
        path = _path(zone.rings, viewport)
        painter.setBrush(fill)
        painter.drawPath(path)
        painter.fillPath(path, QBrush(red, Qt.BrushStyle.BDiagPattern))
        paint_label(painter, path.boundingRect().center(), zone.item.id, found)
    for number, (_, panels) in enumerate(shapes.facades):
        colour = QColor(FACADES[number % len(FACADES)])
        painter.setPen(QPen(colour, 4))
        painter.setBrush(colour)
        path = QPainterPath()
        for corners in viewport.screen(panels.reshape(-1, 2)).reshape(-1, 4, 2):
            path.addPolygon(_polygon(corners))
            path.closeSubpath()
        painter.drawPath(path)


def paint_zones(painter: QPainter, viewport: Viewport, zones: tuple[ZoneArea, ...], found: Colours) -> None:
    """Geo-zones, the largest below: hatched where flights keep out, an outline where they need not."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for zone in reversed(zones):
        colour, path = QColor(zone_colour(zone.restriction, found)), _path(zone.rings, viewport)
        fill = QColor(colour)
        fill.setAlpha(38 if zone.is_kept else 12)
        painter.setBrush(fill)
        painter.setPen(QPen(colour, 2, Qt.PenStyle.SolidLine if zone.is_kept else Qt.PenStyle.DotLine))
        painter.drawPath(path)
        if zone.is_kept:
            pattern = QColor(colour)
            pattern.setAlpha(110)
            painter.fillPath(path, QBrush(pattern, Qt.BrushStyle.FDiagPattern))


def paint_volumes(
    painter: QPainter, viewport: Viewport, volumes: Sequence[tuple[QColor, tuple[NDArray[np.float64], ...]]]
) -> None:
    """Areas one over the other, each with its colour and rings in world coordinates (even-odd rule)."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for colour, rings in volumes:
        fill = QColor(colour)
        fill.setAlpha(60)
        painter.setPen(QPen(colour, 2))
        painter.setBrush(fill)
        painter.drawPath(_path(rings, viewport))


def paint_legend(painter: QPainter, viewport: Viewport, rows: list[tuple[QColor, bool, str]], found: Colours) -> None:
    """Colours and what they mean, in the lower right corner; rows are colour, whether it is hatched, and text."""
    if not rows:
        return
    metrics = painter.fontMetrics()
    height = metrics.height() + 6
    width = max(metrics.horizontalAdvance(text) for _, _, text in rows) + 44
    box = QRectF(viewport.width_px - width - 8, viewport.height_px - 34 - height * len(rows), width, height * len(rows))
    painter.fillRect(box, _paper(found))
    for number, (colour, is_kept, text) in enumerate(rows):
        row = QRectF(box.left() + 6, box.top() + number * height, width - 12, height)
        mark = QRectF(row.left(), row.top() + 4, 24, height - 8)
        painter.setPen(QPen(colour, 2, Qt.PenStyle.SolidLine if is_kept else Qt.PenStyle.DotLine))
        painter.setBrush(QBrush(colour, Qt.BrushStyle.FDiagPattern) if is_kept else Qt.BrushStyle.NoBrush)
        painter.drawRect(mark)
        painter.setPen(QColor(found.text))
        painter.drawText(row.adjusted(32, 0, 0, 0), Qt.AlignmentFlag.AlignVCenter, text)


def paint_plan(
    painter: QPainter, viewport: Viewport, plan: PlanShapes, strengths: Mapping[int, float] | None = None
) -> None:
    """Routes by sortie, and a wedge per viewpoint that opens to where the camera looks.

    Parameters
    ----------
    strengths
        Opacity of sorties, counted from 1; 1 for those that are not in it.
    """
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    strengths = strengths or {}
    for number, route in enumerate(plan.routes):
        painter.setOpacity(strengths.get(number + 1, 1.0))
        if not painter.opacity():
            continue
        points = [QPointF(x, y) for x, y in viewport.screen(route).tolist()]
        # One by one: joining lines that cross each other a thousand times takes twice as long.
        legs = [QLineF(a, b) for a, b in itertools.pairwise(points)]
        for colour, width_px in ((PAPER, 4), (sortie_colour(number + 1), 2)):
            painter.setPen(QPen(colour, width_px))
            painter.drawLines(legs)
    places = viewport.screen(plan.viewpoints)
    is_near = ((places > -WEDGE_PX) & (places < [viewport.width_px + WEDGE_PX, viewport.height_px + WEDGE_PX])).all(
        axis=1
    )
    for number in np.unique(plan.sortie_of):
        own = is_near & (plan.sortie_of == number)
        painter.setOpacity(strengths.get(int(number), 1.0))
        painter.setPen(QPen(PAPER, 1))
        painter.setBrush(sortie_colour(int(number)))
        for corners in wedges(places[own], np.radians(plan.headings_deg[own])):
            painter.drawConvexPolygon(_polygon(corners))
    painter.setOpacity(1.0)


def wedges(places: NDArray[np.float64], heading_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Triangles, shape (n, 3, 2), with a corner at each place, shape (n, 2), opening along the heading; y runs down."""
    turns = heading_rad[:, None] + np.array([0.0, -WEDGE_HALF_RAD, WEDGE_HALF_RAD])
    lengths = np.array([0.0, WEDGE_PX, WEDGE_PX])
    corners: NDArray[np.float64] = places[:, None] + lengths[None, :, None] * np.stack(
        [np.sin(turns), -np.cos(turns)], axis=-1
    )
    return corners


def sortie_colour(number: int) -> QColor:
    """Colour of a sortie from 1; grey for none."""
    return QColor(SORTIES[(number - 1) % len(SORTIES)]) if number else QColor("#6b7680")


def paint_scale_bar(painter: QPainter, viewport: Viewport, units: UnitSystem, found: Colours) -> None:
    """A bar of a round length in the lower left corner, true to the ellipsoid at the centre of the map."""
    longest_m = SCALE_BAR_PX * viewport.metres_per_px
    unit = distance_unit(units) if longest_m > FAR_M else length_unit(units)
    length = round_length(unit.shown(longest_m))
    width_px = unit.metric(length) / viewport.metres_per_px
    text = f"{length:g} {unit.symbol}"
    box = QRectF(8, viewport.height_px - 34, width_px + 16, 28)
    painter.fillRect(box, _paper(found))
    painter.setPen(QPen(QColor(found.text), 2))
    y = box.bottom() - 6
    painter.drawPolyline([QPointF(16, y - 6), QPointF(16, y), QPointF(16 + width_px, y), QPointF(16 + width_px, y - 6)])
    painter.drawText(box.adjusted(0, 0, 0, -8), Qt.AlignmentFlag.AlignCenter, text)


def paint_north(painter: QPainter, centre: QPointF, found: Colours) -> None:
    """An arrow to true north: up."""
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(_paper(found))
    painter.drawEllipse(centre, 18, 18)
    painter.setBrush(QColor(found.text))
    x, y = centre.x(), centre.y()
    painter.drawPolygon([QPointF(x, y - 15), QPointF(x + 5, y), QPointF(x - 5, y)])
    painter.setPen(QColor(found.text))
    painter.drawText(QRectF(x - 15, y - 1, 30, 17), Qt.AlignmentFlag.AlignCenter, "N")


def paint_text_box(painter: QPainter, corner: QPointF, text: str, found: Colours, *, is_right: bool = False) -> None:
    """A line of text on paper, its lower left (or right) corner at `corner`."""
    if not text:
        return
    size = painter.fontMetrics().size(0, text)
    left = corner.x() - size.width() - 8 if is_right else corner.x()
    box = QRectF(left, corner.y() - size.height() - 4, size.width() + 8, size.height() + 4)
    painter.fillRect(box, _paper(found))
    painter.setPen(QColor(found.text))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def paint_note(painter: QPainter, viewport: Viewport, text: str, found: Colours, buttons: QRectF) -> None:
    """A sentence above the scale bar, in as many lines as it takes, and beside the buttons at the right."""
    if not text:
        return
    wrap = Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignLeft
    room = QRectF(12, 0, viewport.width_px - 24, viewport.height_px - 42)
    box = painter.boundingRect(room, wrap, text)
    if room.bottom() - box.height() < buttons.bottom():
        room.setRight(min(room.right(), buttons.left() - 8))
        box = painter.boundingRect(room, wrap, text)
    box.moveBottom(room.bottom())
    painter.fillRect(box.adjusted(-4, -2, 4, 2), _paper(found))
    painter.setPen(QColor(found.text))
    painter.drawText(box, wrap, text)


def paint_ring(painter: QPainter, centre: NDArray[np.float64], text: str, found: Colours) -> None:
    """What is selected: a ring around it and its name."""
    at = QPointF(*centre)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, width in ((PAPER, 6), (QColor(found.accent), 3)):
        painter.setPen(QPen(colour, width))
        painter.drawEllipse(at, 12, 12)
    if text:
        paint_label(painter, QPointF(at.x(), at.y() - 26), text, found)


def paint_landings(painter: QPainter, at: NDArray[np.float64], found: Colours) -> None:
    """Where flights begin and may end: a disc with an H for home, the first, with an R for each rally point.

    `at` is in pixels, shape (1 + n, 2).
    """
    for number, (x, y) in enumerate(at):
        painter.setPen(QPen(PAPER, 2))
        painter.setBrush(RALLY if number else QColor(found.ok))
        painter.drawEllipse(QPointF(x, y), 11, 11)
        painter.setPen(PAPER if number else QColor(found.base))
        painter.drawText(QRectF(x - 11, y - 11, 22, 22), Qt.AlignmentFlag.AlignCenter, "R" if number else "H")


def paint_label(painter: QPainter, centre: QPointF, text: str, found: Colours) -> None:
    """A text on paper about a point."""
    size = painter.fontMetrics().size(0, text)
    box = QRectF(0, 0, size.width() + 8, size.height() + 2)
    box.moveCenter(centre)
    painter.fillRect(box, _paper(found))
    painter.setPen(QColor(found.text))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _paper(found: Colours) -> QColor:
    paper = QColor(found.base)
    paper.setAlpha(215)
    return paper


def _path(rings: Sequence[NDArray[np.float64]], viewport: Viewport) -> QPainterPath:
    path = QPainterPath()
    for ring in rings:
        path.addPolygon(_polygon(viewport.screen(ring)))
        path.closeSubpath()
    return path


def _polygon(points: NDArray[np.float64]) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in points.tolist()])
