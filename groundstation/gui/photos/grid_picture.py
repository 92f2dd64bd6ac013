"""A photo, or its rectified view, that can be moved and enlarged, with the found grids over it and a legend."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from groundstation.gui.photos.photo_store import LargePicture
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.grid_edits import LinePlace, cell_bounds, lines_of
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.solving.record import Axis

# A large picture that can be moved and enlarged.

MAX_ZOOM = 16.0
"""Screen pixels per pixel of the picture."""

WHEEL_STEP = 1.25
PAN_PX = 60.0


class PictureView(QWidget):
    """Shows a picture: the wheel enlarges, dragging moves, a double click shows it whole."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._picture: LargePicture | None = None
        self._text = ""
        self._zoom, self._corner = 1.0, QPointF()
        self._is_whole = True
        self._grabbed: QPointF | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setMinimumSize(QSize(240, 180))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def set_picture(self, picture: LargePicture | None) -> None:
        """Show another picture; of the same size, the same part of it."""
        before = self._size()
        self._picture = picture if picture is not None and picture.levels else None
        if self._size() != before:
            self._is_whole = True
        if self._is_whole:
            self.show_whole()
        self.update()

    def set_text(self, text: str) -> None:
        """Say something in the place of a picture."""
        self._text = text
        self.update()

    def picture(self) -> LargePicture | None:
        """What is shown."""
        return self._picture

    def show_whole(self) -> None:
        """Show all of the picture."""
        self._is_whole = True
        size = self._size()
        if not size.isEmpty():
            room = self.room()
            self._zoom = self._whole_zoom()
            self._corner = room.center() - QPointF(size.width(), size.height()) * (0.5 * self._zoom)
        self.update()

    def room(self) -> QRectF:
        """Where the whole picture has its place."""
        return QRectF(self.rect())

    def zoom(self) -> float:
        """Screen pixels per pixel of the picture."""
        return self._zoom

    def zoom_by(self, factor: float, about: QPointF | None = None) -> None:
        """Enlarge about a point of the widget, its middle where none is given."""
        about = QPointF(self.rect().center()) if about is None else about
        here = self.to_picture(about)
        whole = self._whole_zoom()
        self._zoom = min(MAX_ZOOM, max(0.5 * whole, self._zoom * factor))
        self._is_whole = False
        self._corner = about - here * self._zoom
        self.update()

    def to_picture(self, point: QPointF) -> QPointF:
        """Pixels of the picture, of a point of the widget."""
        return (point - self._corner) / self._zoom

    def to_widget(self, point: QPointF) -> QPointF:
        """Point of the widget, of pixels of the picture."""
        return point * self._zoom + self._corner

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """The picture, then what lies over it."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(colours().scene))
        if self._picture is None:
            painter.setPen(QColor(colours().muted))
            room = self.rect().adjusted(16, 16, -16, -16)
            painter.drawText(room, Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignCenter, self._text)
        else:
            self._paint_picture(painter, self._picture)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._paint_over(painter)
        if self.hasFocus():
            painter.setPen(QColor(colours().accent))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _paint_picture(self, painter: QPainter, picture: LargePicture) -> None:
        """Only the part that is seen, from the smallest copy that is fine enough."""
        full = picture.levels[0]
        suffices = [level for level in picture.levels if level.width() >= self._zoom * full.width()]
        level = suffices[-1] if suffices else full
        shrink = level.width() / full.width()
        seen = QRectF(self.to_picture(QPointF(0, 0)), self.to_picture(QPointF(self.width(), self.height())))
        seen = seen.intersected(QRectF(0, 0, full.width(), full.height()))
        if seen.isEmpty():
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self._zoom < 2.0)
        source = QRectF(seen.topLeft() * shrink, seen.bottomRight() * shrink)
        painter.drawImage(QRectF(self.to_widget(seen.topLeft()), self.to_widget(seen.bottomRight())), level, source)

    def _paint_over(self, painter: QPainter) -> None:
        """For views that draw something over the picture."""

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Stay whole."""
        super().resizeEvent(event)
        if self._is_whole:
            self.show_whole()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Enlarge about the pointer."""
        self.zoom_by(WHEEL_STEP ** (event.angleDelta().y() / 120.0), event.position())

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of the picture."""
        self._grabbed = event.position()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Move the picture."""
        if self._grabbed is not None:
            self._pan(event.position() - self._grabbed)
            self._grabbed = event.position()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        self._grabbed = None

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        """Show all of it."""
        self.show_whole()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Arrows move, plus and minus enlarge, 0 shows the whole."""
        key = Qt.Key(event.key())
        moves = {
            Qt.Key.Key_Left: QPointF(PAN_PX, 0),
            Qt.Key.Key_Right: QPointF(-PAN_PX, 0),
            Qt.Key.Key_Up: QPointF(0, PAN_PX),
            Qt.Key.Key_Down: QPointF(0, -PAN_PX),
        }
        if key in moves:
            self._pan(moves[key])
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Minus):
            self.zoom_by(WHEEL_STEP if key == Qt.Key.Key_Plus else 1.0 / WHEEL_STEP)
        elif key == Qt.Key.Key_0:
            self.show_whole()
        else:
            super().keyPressEvent(event)

    def _pan(self, step: QPointF) -> None:
        self._is_whole = False
        self._corner += step
        self.update()

    def _size(self) -> QSize:
        return QSize() if self._picture is None else self._picture.levels[0].size()

    def _whole_zoom(self) -> float:
        size = self._size()
        room = self.room()
        return 1.0 if size.isEmpty() else min(room.width() / size.width(), room.height() / size.height())


Array = NDArray[np.float64]

SURE, UNSURE = 0.9, 0.6
"""Confidence from where a panel is drawn as sure, and below which as doubtful. Our choice."""

POINTS = 17
"""Along a line: enough for the bend of any lens on the screen."""

LINE_COLOUR, CHOSEN_COLOUR, CHOSEN_EDGE = "#7fffd4", "#ffffff", "#15202b"
"""They lie on photos, which no theme changes."""

OUTLINE_COLOUR = "#fff36b"
"""Of panels that are known from other photos: bright on glass, and unlike all that was found in this one."""

SAMPLE_PX, PAD_PX = 26.0, 6.0
"""Width of a sample in the legend, and the room around it."""

PHOTO_GREY = "#59636c"

Entry = tuple[QColor | QPen, str]
"""A sample of what is drawn, and what it is."""


class GridPicture(PictureView):
    """Draws grids over a picture, of which one is active, and the outlines of panels that are known from elsewhere."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grids: tuple[FacadeGrid, ...] = ()
        self._grid: FacadeGrid | None = None
        self._outlines: tuple[Array, ...] = ()
        self._is_rectified = False
        self._line: LinePlace | None = None
        self._held_px: float | None = None
        self._cell: tuple[int, int] | None = None

    def set_grids(self, grids: tuple[FacadeGrid, ...], active: FacadeGrid | None, *, is_rectified: bool) -> None:
        """Draw these grids, of which one is active; the picture is the rectified view of that, or the photo."""
        self._grids, self._grid, self._is_rectified = grids, active, is_rectified
        self._make_room()

    def set_outlines(self, outlines: tuple[Array, ...]) -> None:
        """Draw panels that were not looked for in this photo, shape (k, 2) each, in its pixels."""
        self._outlines = outlines
        self._make_room()

    def place_of(self, point_px: tuple[float, float]) -> QPointF:
        """Point of the widget, of a point of the rectified view of the active grid."""
        assert self._grid is not None
        x, y = self._in_picture(self._grid, np.array([point_px]))[0]
        return self.to_widget(QPointF(float(x), float(y)))

    def room(self) -> QRectF:
        """Above the legend."""
        return QRectF(self.rect()).adjusted(0.0, 0.0, 0.0, -self._line_px() * len(self._lines_of_legend()))

    def legend(self) -> tuple[str, ...]:
        """What stands in the legend."""
        return tuple(text for _, text in self._entries())

    # Drawing

    def _paint_over(self, painter: QPainter) -> None:
        if not self._is_rectified:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(_outline_pen())
            for outline in self._outlines:
                painter.drawPolygon(self._polygon(outline))
            for grid in self._grids:
                if grid is not self._grid:
                    self._paint_grid(painter, grid, is_active=False)
        if self._grid is not None:
            self._paint_grid(painter, self._grid, is_active=True)
            self._paint_chosen(painter, self._grid)
        self._paint_legend(painter)

    def _paint_grid(self, painter: QPainter, grid: FacadeGrid, *, is_active: bool) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        for panel in grid.panels:
            colour = confidence_colour(panel.confidence)
            colour.setAlpha(90 if is_active else 45)
            painter.setBrush(colour)
            painter.drawPolygon(self._polygon(self._corners(grid, panel)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(_cross_pen())
        for row, column in grid.missing:
            for points in _crossed(grid, row, column):
                painter.drawPolyline(self._polygon(self._in_picture(grid, points)))
        painter.setPen(QPen(QColor(LINE_COLOUR), 1.0 if is_active else 0.5))
        for panel in grid.panels:
            # The edges of whole cells are the lines.
            if panel.part > 0:
                painter.drawPolygon(self._polygon(self._corners(grid, panel)))
        for axis in ("column", "row"):
            for index, line in enumerate(lines_of(grid, axis)):
                if is_active and self._line == (axis, index):
                    continue
                painter.setPen(_pen(line, 1.6 if is_active else 0.8))
                painter.drawPolyline(self._polygon(self._course(grid, axis, line.position_px)))

    def _paint_chosen(self, painter: QPainter, grid: FacadeGrid) -> None:
        """The line or the cell that is worked on: white with a dark edge, which any picture shows."""
        pens = (QPen(QColor(CHOSEN_EDGE), 5.0), QPen(QColor(CHOSEN_COLOUR), 2.6))
        if self._line is not None:
            axis, index = self._line
            line = lines_of(grid, axis)[index]
            points = self._course(grid, axis, line.position_px if self._held_px is None else self._held_px)
            pens[1].setStyle(_style(line))
            for pen in pens:
                painter.setPen(pen)
                painter.drawPolyline(self._polygon(points))
        if self._cell is not None:
            left, right, above, below = cell_bounds(grid, *self._cell)
            corners = np.array([[left, below], [right, below], [right, above], [left, above]])
            for pen in pens:
                painter.setPen(pen)
                painter.drawPolygon(self._polygon(self._in_picture(grid, corners)))

    def _course(self, grid: FacadeGrid, axis: Axis, position: float) -> Array:
        """Points along a line, in the picture."""
        across, along = (grid.columns, grid.rows) if axis == "column" else (grid.rows, grid.columns)
        if not across or not along:
            return np.zeros((0, 2))
        run = np.linspace(along[0].position_px, along[-1].position_px, POINTS)
        fixed = np.full(POINTS, position)
        points = np.column_stack([fixed, run] if axis == "column" else [run, fixed])
        return self._in_picture(grid, points)

    def _corners(self, grid: FacadeGrid, panel: FoundPanel) -> Array:
        return grid.rectification.to_rectified(panel.corners_px) if self._is_rectified else panel.corners_px

    def _in_picture(self, grid: FacadeGrid, points_px: Array) -> Array:
        """Points of a rectified view, shape (n, 2), in the picture that is shown."""
        return points_px if self._is_rectified else grid.rectification.to_photo(points_px)

    def _polygon(self, points: Array) -> QPolygonF:
        finite = points[np.isfinite(points).all(axis=1)]
        return QPolygonF([self.to_widget(QPointF(float(x), float(y))) for x, y in finite])

    # The legend

    def _entries(self) -> list[Entry]:
        """Samples and texts of what is drawn: fills of panels, pens of lines."""
        grids = [self._grid] if self._is_rectified and self._grid is not None else list(self._grids)
        least = [panel.confidence for grid in grids for panel in grid.panels]
        lines = [line for grid in grids for line in (*grid.rows, *grid.columns)]
        entries: list[tuple[QColor | QPen, str, bool]] = [
            (confidence_colour(SURE), self.tr("panel, sure"), any(one >= SURE for one in least)),
            (confidence_colour(UNSURE), self.tr("panel, less sure"), any(UNSURE <= one < SURE for one in least)),
            (confidence_colour(0.0), self.tr("panel, doubtful"), any(one < UNSURE for one in least)),
            (_cross_pen(), self.tr("no panel"), any(grid.missing for grid in grids)),
            (
                QPen(QColor(LINE_COLOUR), 2.0, Qt.PenStyle.DashLine),
                self.tr("not seen, follows from the spacing"),
                any(line.is_inferred for line in lines),
            ),
            (
                _outline_pen(),
                self.tr("known panel, not looked for here"),
                bool(self._outlines) and not self._is_rectified,
            ),
        ]
        return [(sample, text) for sample, text, is_drawn in entries if is_drawn]

    def _lines_of_legend(self) -> list[list[Entry]]:
        """Entries side by side, as many as have room."""
        lines: list[list[Entry]] = []
        left = self.width() + 1.0
        for entry in self._entries():
            width = self._width_of(entry[1])
            if left + width > self.width() - PAD_PX:
                lines.append([])
                left = PAD_PX
            lines[-1].append(entry)
            left += width
        return lines

    def _width_of(self, text: str) -> float:
        return SAMPLE_PX + 4.0 * PAD_PX + QFontMetricsF(self.font()).horizontalAdvance(text)

    def _line_px(self) -> float:
        return QFontMetricsF(self.font()).height() + 2.0

    def _make_room(self) -> None:
        """The legend stands below the picture: it would hide a part of the grid."""
        if self._is_whole:
            self.show_whole()
        self.update()

    def _paint_legend(self, painter: QPainter) -> None:
        lines, step = self._lines_of_legend(), self._line_px()
        box = QRectF(self.rect())
        box.setTop(self.room().bottom())
        painter.fillRect(box, QColor(colours().base))
        for number, entries in enumerate(lines):
            left = PAD_PX
            for sample, text in entries:
                _paint_sample(painter, sample, QRectF(left, box.top() + number * step, SAMPLE_PX, step))
                painter.setPen(QColor(colours().text))
                room = QRectF(left + SAMPLE_PX + PAD_PX, box.top() + number * step, self._width_of(text), step)
                painter.drawText(room, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, text)
                left += self._width_of(text)


def _paint_sample(painter: QPainter, sample: QColor | QPen, box: QRectF) -> None:
    """On grey: pens and see-through colours look as they do on a photo."""
    box = box.adjusted(0.0, 2.0, 0.0, -2.0)
    painter.fillRect(box, QColor(PHOTO_GREY))
    if isinstance(sample, QPen):
        painter.setPen(sample)
        painter.drawLine(QPointF(box.left(), box.center().y()), QPointF(box.right(), box.center().y()))
    else:
        sample.setAlpha(170)
        painter.fillRect(box, sample)


def confidence_colour(confidence: float) -> QColor:
    """Colour of a panel."""
    look = colours()
    if confidence >= SURE:
        return QColor(look.covered)
    return QColor(look.open if confidence >= UNSURE else look.undecided)


def _crossed(grid: FacadeGrid, row: int, column: int) -> tuple[Array, Array]:
    """The diagonals of a cell that is no panel."""
    x0, x1, y0, y1 = cell_bounds(grid, row, column)
    return np.array([[x0, y0], [x1, y1]]), np.array([[x0, y1], [x1, y0]])


def _cross_pen() -> QPen:
    return QPen(QColor(colours().undecided), 1.2)


def _outline_pen() -> QPen:
    return QPen(QColor(OUTLINE_COLOUR), 1.2, Qt.PenStyle.DotLine)


def _style(line: GridLine) -> Qt.PenStyle:
    """Lines that were not seen are dashed, doubtful ones dotted: none is told by colour alone."""
    if line.is_inferred:
        return Qt.PenStyle.DashLine
    return Qt.PenStyle.DotLine if line.confidence < UNSURE else Qt.PenStyle.SolidLine


def _pen(line: GridLine, width_px: float) -> QPen:
    return QPen(QColor(colours().open if line.confidence < SURE else LINE_COLOUR), width_px, _style(line))
