"""A photo, or its rectified view, with the found grids over it and a legend of what is drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from groundstation.gui.photos.picture_view import PictureView
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.grid_edits import LinePlace, cell_bounds, lines_of
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.solving.record import Axis

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
    """Draws grids over a picture, of which one is in hand, and the outlines of panels that are known from elsewhere."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grids: tuple[FacadeGrid, ...] = ()
        self._grid: FacadeGrid | None = None
        self._outlines: tuple[Array, ...] = ()
        self._is_rectified = False
        self._line: LinePlace | None = None
        self._held_px: float | None = None
        self._cell: tuple[int, int] | None = None

    def set_grids(self, grids: tuple[FacadeGrid, ...], in_hand: FacadeGrid | None, *, is_rectified: bool) -> None:
        """Draw these grids, of which one is in hand; the picture is the rectified view of that, or the photo."""
        self._grids, self._grid, self._is_rectified = grids, in_hand, is_rectified
        self._make_room()

    def set_outlines(self, outlines: tuple[Array, ...]) -> None:
        """Draw panels that were not looked for in this photo, shape (k, 2) each, in its pixels."""
        self._outlines = outlines
        self._make_room()

    def place_of(self, point_px: tuple[float, float]) -> QPointF:
        """Point of the widget, of a point of the rectified view of the grid in hand."""
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
                    self._paint_grid(painter, grid, is_in_hand=False)
        if self._grid is not None:
            self._paint_grid(painter, self._grid, is_in_hand=True)
            self._paint_chosen(painter, self._grid)
        self._paint_legend(painter)

    def _paint_grid(self, painter: QPainter, grid: FacadeGrid, *, is_in_hand: bool) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        for panel in grid.panels:
            colour = confidence_colour(panel.confidence)
            colour.setAlpha(90 if is_in_hand else 45)
            painter.setBrush(colour)
            painter.drawPolygon(self._polygon(self._corners(grid, panel)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(_cross_pen())
        for row, column in grid.missing:
            for points in _crossed(grid, row, column):
                painter.drawPolyline(self._polygon(self._in_picture(grid, points)))
        painter.setPen(QPen(QColor(LINE_COLOUR), 1.0 if is_in_hand else 0.5))
        for panel in grid.panels:
            # The edges of whole cells are the lines.
            if panel.part > 0:
                painter.drawPolygon(self._polygon(self._corners(grid, panel)))
        for axis in ("column", "row"):
            for index, line in enumerate(lines_of(grid, axis)):
                if is_in_hand and self._line == (axis, index):
                    continue
                painter.setPen(_pen(line, 1.6 if is_in_hand else 0.8))
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
