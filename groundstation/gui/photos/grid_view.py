"""A photo, or its rectified view, with the found grid over it, and the tools that correct it."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QMouseEvent, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QToolTip, QWidget

from groundstation.gui.photos.picture_view import PictureView
from groundstation.gui.theme import colours
from groundstation.services.photo_grids import cell_at, line_near, lines_of, room_for_line
from reconstruction.panels.record import Axis
from reconstruction.segmentation.record import FacadeGrid, GridLine

Array = NDArray[np.float64]

GRAB_PX = 12.0
"""On the screen; a finger on a large picture hits that well enough, for lines are far apart there."""

SURE, UNSURE = 0.9, 0.6
"""Confidence from where a panel is drawn as sure, and below which as doubtful. Our choice."""

POINTS = 17
"""Along a line: enough for the bend of any lens on the screen."""


class Tool(Enum):
    """What a press on the picture does."""

    MOVE = auto()
    ADD_COLUMN = auto()
    ADD_ROW = auto()
    REMOVE_LINE = auto()
    PANEL = auto()


class GridView(PictureView):
    """Draws one or more grids over a picture; the `grid` in hand can be corrected.

    Signals
    -------
    lineMoved(str, int, float), lineAdded(str, float), lineRemoved(str, int)
        Axis ("column" or "row"), number of the line, position in the rectified view.
    panelSwitched(int, int, bool)
        Row, column, and whether the cell is a panel now.
    """

    lineMoved = Signal(str, int, float)  # noqa: N815  (Qt's own way of naming)
    lineAdded = Signal(str, float)  # noqa: N815
    lineRemoved = Signal(str, int)  # noqa: N815
    panelSwitched = Signal(int, int, bool)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grids: tuple[FacadeGrid, ...] = ()
        self._grid: FacadeGrid | None = None
        self._is_rectified = False
        self._tool = Tool.MOVE
        self._dragged: tuple[Axis, int, float] | None = None
        self.setAccessibleName(self.tr("Photo with the grid found in it"))

    def set_grids(self, grids: tuple[FacadeGrid, ...], in_hand: FacadeGrid | None, *, is_rectified: bool) -> None:
        """Draw these grids, of which one is in hand; the picture is the rectified view of that, or the photo."""
        self._grids, self._grid, self._is_rectified = grids, in_hand, is_rectified
        self._dragged = None
        self.update()

    def set_tool(self, tool: Tool) -> None:
        """What a press does from now on."""
        self._tool = tool
        shape = Qt.CursorShape.OpenHandCursor if tool is Tool.MOVE else Qt.CursorShape.CrossCursor
        self.setCursor(shape)

    def tool(self) -> Tool:
        """What a press does."""
        return self._tool

    # Where things are

    def place_of(self, point_px: tuple[float, float]) -> QPointF:
        """Point of the widget, of a point of the rectified view of the grid in hand."""
        assert self._grid is not None
        points = np.array([point_px])
        if not self._is_rectified:
            points = self._grid.rectification.to_photo(points)
        return self.to_widget(QPointF(float(points[0, 0]), float(points[0, 1])))

    def _rectified(self, at: QPointF) -> tuple[tuple[float, float], float] | None:
        """Point of the rectified view under a point of the widget, and how far the grab reaches there."""
        if self._grid is None:
            return None
        near = [self.to_picture(at + QPointF(x, y)) for x, y in ((0.0, 0.0), (GRAB_PX, 0.0), (0.0, GRAB_PX))]
        points = np.array([[point.x(), point.y()] for point in near])
        if not self._is_rectified:
            points = self._grid.rectification.to_rectified(points)
        if not np.isfinite(points).all():
            return None
        reach = float(np.linalg.norm(points[1:] - points[0], axis=1).max())
        return (float(points[0, 0]), float(points[0, 1])), reach

    # Hands

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Do what the tool does; on nothing, take hold of the picture."""
        found = self._rectified(event.position())
        if found is None or self._grid is None or event.button() != Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
            return
        point, reach = found
        line = line_near(self._grid, point, reach)
        if self._tool is Tool.MOVE and line is not None:
            self._dragged = (*line, lines_of(self._grid, line[0])[line[1]].position_px)
            self.update()
        elif self._tool is Tool.MOVE:
            super().mousePressEvent(event)
        else:
            self._use(self._grid, point, line)

    def _use(self, grid: FacadeGrid, point: tuple[float, float], line: tuple[Axis, int] | None) -> None:
        cell = cell_at(grid, point)
        match self._tool:
            case Tool.ADD_COLUMN:
                self.lineAdded.emit("column", point[0])
            case Tool.ADD_ROW:
                self.lineAdded.emit("row", point[1])
            case Tool.REMOVE_LINE if line is not None:
                self.lineRemoved.emit(*line)
            case Tool.PANEL if cell is not None:
                self.panelSwitched.emit(*cell, cell in grid.missing)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take the line along, or the picture."""
        if self._dragged is None or self._grid is None:
            super().mouseMoveEvent(event)
            return
        found = self._rectified(event.position())
        if found is not None:
            axis, index, _ = self._dragged
            low, high = room_for_line(self._grid, axis, index)
            self._dragged = axis, index, min(max(found[0][0 if axis == "column" else 1], low), high)
            self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Put the line down."""
        dragged, self._dragged = self._dragged, None
        if dragged is not None and self._grid is not None:
            axis, index, position = dragged
            if abs(position - lines_of(self._grid, axis)[index].position_px) > 0.01:
                self.lineMoved.emit(axis, index, position)
            self.update()
        super().mouseReleaseEvent(event)

    def event(self, event: QEvent) -> bool:
        """Say what is known of the panel under the pointer."""
        if isinstance(event, QHelpEvent):
            QToolTip.showText(event.globalPos(), self.words_at(QPointF(event.pos())), self)
            return True
        return super().event(event)

    def words_at(self, at: QPointF) -> str:
        """What is known of the panel under a point of the widget."""
        found = self._rectified(at)
        cell = None if found is None or self._grid is None else cell_at(self._grid, found[0])
        if cell is None or self._grid is None:
            return ""
        panel = next((one for one in self._grid.panels if (one.row, one.column) == cell), None)
        where = self.tr("row {0}, column {1}").format(cell[0] + 1, cell[1] + 1)
        if panel is None:
            return self.tr("{0}: no panel").format(where)
        return self.tr("{0}: confidence {1:.0f} %").format(where, 100.0 * panel.confidence)

    # Drawing

    def _paint_over(self, painter: QPainter) -> None:
        for grid in self._grids:
            if grid is not self._grid and not self._is_rectified:
                self._paint_grid(painter, grid, is_in_hand=False)
        if self._grid is not None:
            self._paint_grid(painter, self._grid, is_in_hand=True)

    def _paint_grid(self, painter: QPainter, grid: FacadeGrid, *, is_in_hand: bool) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        for panel in grid.panels:
            corners = grid.rectification.to_rectified(panel.corners_px) if self._is_rectified else panel.corners_px
            colour = confidence_colour(panel.confidence)
            colour.setAlpha(90 if is_in_hand else 45)
            painter.setBrush(colour)
            painter.drawPolygon(self._polygon(corners))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(colours().undecided), 1.2))
        for row, column in grid.missing:
            for points in _crossed(grid, row, column):
                painter.drawPolyline(self._polygon(self._in_picture(grid, points)))
        for axis in ("column", "row"):
            for index, line in enumerate(lines_of(grid, axis)):
                held = self._dragged if is_in_hand else None
                is_held = held is not None and held[:2] == (axis, index)
                position = held[2] if is_held and held is not None else line.position_px
                painter.setPen(_pen(line, is_in_hand=is_in_hand, is_held=is_held))
                painter.drawPolyline(self._polygon(self._course(grid, axis, position)))

    def _course(self, grid: FacadeGrid, axis: Axis, position: float) -> Array:
        """Points along a line, in the picture."""
        across, along = (grid.columns, grid.rows) if axis == "column" else (grid.rows, grid.columns)
        if not across or not along:
            return np.zeros((0, 2))
        run = np.linspace(along[0].position_px, along[-1].position_px, POINTS)
        fixed = np.full(POINTS, position)
        points = np.column_stack([fixed, run] if axis == "column" else [run, fixed])
        return self._in_picture(grid, points)

    def _in_picture(self, grid: FacadeGrid, points_px: Array) -> Array:
        """Points of a rectified view, shape (n, 2), in the picture that is shown."""
        return points_px if self._is_rectified else grid.rectification.to_photo(points_px)

    def _polygon(self, points: Array) -> QPolygonF:
        finite = points[np.isfinite(points).all(axis=1)]
        return QPolygonF([self.to_widget(QPointF(float(x), float(y))) for x, y in finite])


def _crossed(grid: FacadeGrid, row: int, column: int) -> tuple[Array, Array]:
    """The diagonals of a cell that is no panel."""
    top = len(grid.rows) - 2 - row
    x0, x1 = grid.columns[column].position_px, grid.columns[column + 1].position_px
    y0, y1 = grid.rows[top].position_px, grid.rows[top + 1].position_px
    return np.array([[x0, y0], [x1, y1]]), np.array([[x0, y1], [x1, y0]])


def confidence_colour(confidence: float) -> QColor:
    """Colour of a panel."""
    look = colours()
    if confidence >= SURE:
        return QColor(look.covered)
    return QColor(look.open if confidence >= UNSURE else look.undecided)


def _pen(line: GridLine, *, is_in_hand: bool, is_held: bool) -> QPen:
    """Lines that were not seen are dashed, doubtful ones dotted: none is told by colour alone."""
    colour = QColor("#ffffff" if is_held else colours().open if line.confidence < SURE else "#7fffd4")
    style = Qt.PenStyle.SolidLine
    if line.is_inferred:
        style = Qt.PenStyle.DashLine
    elif line.confidence < UNSURE:
        style = Qt.PenStyle.DotLine
    return QPen(colour, 3.0 if is_held else 1.6 if is_in_hand else 0.8, style)
