"""One sortie over time or distance: height and speed with what limits them, and the clearance to all that is solid."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPointF, QRectF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QFont, QFontMetricsF, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from groundstation.gui.map.map_paint import sortie_colour
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.scrolling import fitted
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.mission.waypoints import GroundCurve, HeightLimits, ProfileCurves, nearest_photo
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, length_unit, minutes_text, speed_unit
from planning.checks.rules import MAX_ALTITUDE_M
from planning.insight.clearance import RouteClearance

# Letters of pyqtgraph's charts: as large as those of the window, and none over another.

RESTYLED = (QEvent.Type.PaletteChange, QEvent.Type.FontChange)

WIDEST_HEIGHT = "-1000"
"""Room for heights of four figures, so that charts do not jump when the units change."""

NAME_SHARES = tuple(0.05 * number for number in range(21))
"""Places along a chart at which the name of a line is tried, as parts of its width."""


def dress_axis(axis: pg.AxisItem, text: str, font: QFont, look: Colours) -> None:
    """Write an axis in the window's font and colours; a title that is longer than its axis is written smaller.

    One for which even small letters are too long is left out; what is shown stands beside the chart, too.
    """
    is_upright = axis.orientation == "left"
    axis.setPen(look.line)
    axis.setTextPen(look.text)
    axis.setStyle(tickFont=font)
    # Seconds and feet take no prefix such as "k".
    axis.enableAutoSIPrefix(False)
    if is_upright:
        metrics = QFontMetricsF(font)
        axis.setWidth(metrics.horizontalAdvance(WIDEST_HEIGHT) + metrics.height() + 8.0)
    axis.setLabel(text, color=look.text)
    fit_title(axis, font)


def fit_title(axis: pg.AxisItem, font: QFont) -> None:
    """Give the title of an axis the largest letters that it has room for."""
    size = axis.size()
    room_px = size.height() if axis.orientation == "left" else size.width()
    fitting, shown = fitted(font, axis.labelText, room_px)
    axis.label.setFont(fitting)
    axis.showLabel(shown == axis.labelText)


@dataclass(frozen=True, slots=True, eq=False)
class LineName:
    """The name of a line in a chart.

    Parameters
    ----------
    height_at
        Of the line, at a place along the chart, both in its own units; NaN where it is not.
    share
        Where along the chart the name stands best, 0 to 1.
    """

    item: pg.TextItem
    height_at: Callable[[float], float]
    share: float


def place_names(plot: pg.PlotItem, names: Sequence[LineName], curve: tuple[np.ndarray, np.ndarray]) -> None:
    """Put names below or above their lines, where none lies over another; one that has no such place is left out.

    Parameters
    ----------
    curve
        Along the chart and up, in its units, shapes (n,): where they can, names keep clear of it, and of other lines.
    """
    (left, right), (low, high) = plot.vb.viewRange()
    room = plot.vb.rect()
    x_px, y_px = room.width() * (curve[0] - left) / (right - left), room.height() * (high - curve[1]) / (high - low)

    def n_hidden(box: QRectF) -> int:
        """Lines that run through a box, the curve twice."""
        on_curve = (x_px >= box.left()) & (x_px <= box.right()) & (y_px >= box.top()) & (y_px <= box.bottom())
        at = left + (right - left) * box.center().x() / room.width()
        heights = (room.height() * (high - each.height_at(at)) / (high - low) for each in names)
        return 2 * bool(on_curve.any()) + sum(1 for each in heights if box.top() + 1.0 < each < box.bottom() - 1.0)

    taken: list[QRectF] = []
    for name in names:
        places = _places(name, room, (left, right), (low, high))
        free = (box for box in places if not any(map(box.intersects, taken)))
        box = min(free, key=n_hidden, default=None)
        name.item.setVisible(box is not None)
        if box is not None:
            taken.append(box)
            across, down = box.left() / room.width(), box.top() / room.height()
            name.item.setPos(left + (right - left) * across, high - (high - low) * down)


def _places(name: LineName, room: QRectF, span: tuple[float, float], heights: tuple[float, float]) -> Iterator[QRectF]:
    """Boxes for a name in a chart, px, the best one first."""
    size = name.item.textItem.boundingRect().size()
    for share in sorted(NAME_SHARES, key=lambda share: abs(share - name.share)):
        left_px = share * (room.width() - size.width())
        middle = (left_px + 0.5 * size.width()) / max(room.width(), 1.0)
        height = name.height_at(span[0] + (span[1] - span[0]) * middle)
        line_px = room.height() * (heights[1] - height) / (heights[1] - heights[0])
        for top_px in (line_px, line_px - size.height()):
            box = QRectF(QPointF(left_px, top_px), size)
            if math.isfinite(top_px) and room.contains(box):
                yield box


# Clearance along one sortie: what is kept from building, obstacles and no-fly volumes, and what must be.

SHOWN_LIMITS = 5.0
"""Clearances beyond this many limits are cut off: how far away the far away is does not matter."""


class ClearanceChart(QWidget):
    """Draws what it gets of one sortie.

    Signals
    -------
    sortieChosen(int)
        Number from 1.
    legPicked(int, int)
        Sortie and leg, both from 1, where the curve was clicked.
    """

    sortieChosen = Signal(int)  # noqa: N815  (Qt's own way of naming)
    legPicked = Signal(int, int)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = UnitSystem.METRIC
        self._found: RouteClearance | None = None
        self._limit_m = 0.0
        self._sortie = ChoiceBox()
        self._words = QLabel()
        self._words.setWordWrap(True)
        self._is_made = False
        above = QHBoxLayout()
        above.addWidget(self._sortie)
        above.addWidget(self._words, 1)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(4, 4, 4, 4)
        self._layout.addLayout(above)
        self._sortie.currentIndexChanged.connect(lambda index: self.sortieChosen.emit(index + 1))
        self._draw()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Make the chart when it is first wanted: that takes longer than the rest of its tab."""
        super().showEvent(event)
        if not self._is_made:
            self._make_plot()
            self._dress()
            self._draw()

    def _make_plot(self) -> None:
        self._is_made = True
        self._plot = pg.PlotWidget()
        self._plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._plot.setMenuEnabled(False)
        self._plot.setMouseEnabled(x=True, y=False)
        self._plot.hideButtons()
        self._solids = self._plot.plot()
        self._no_fly = self._plot.plot()
        self._limit = pg.InfiniteLine(angle=0, movable=False)
        self._plot.addItem(self._limit, ignoreBounds=True)
        self._plot.scene().sigMouseClicked.connect(self._clicked)
        self._plot.getPlotItem().vb.sigResized.connect(self._fit_titles)
        self._layout.addWidget(self._plot, 1)

    def set_sorties(self, n_sorties: int) -> None:
        """How many sorties there are; the chosen one stays where it can."""
        chosen = max(0, self._sortie.currentIndex())
        with QSignalBlocker(self._sortie):
            self._sortie.clear()
            self._sortie.addItems([self.tr("Sortie {0}").format(number) for number in range(1, n_sorties + 1)])
            self._sortie.setCurrentIndex(min(chosen, n_sorties - 1))

    def sortie(self) -> int:
        """The chosen sortie, from 1; 0 where there is none."""
        return self._sortie.currentIndex() + 1

    def set_clearance(self, found: RouteClearance | None, limit_m: float = 0.0) -> None:
        """Show the clearance of the chosen sortie; None while it is not known."""
        self._found, self._limit_m = found, limit_m
        self._draw()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        if self._is_made:
            self._dress()
        self._draw()

    def text(self) -> str:
        """What is said above the curve."""
        return self._words.text()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() in RESTYLED and getattr(self, "_is_made", False):
            self._dress()

    def _dress(self) -> None:
        found, unit = colours(), length_unit(self._units)
        self._plot.setBackground(found.base)
        left, bottom = self.tr("in {0}"), self.tr("distance flown in {0}")
        for side, text in (("left", left), ("bottom", bottom)):
            dress_axis(self._plot.getAxis(side), text.format(unit.symbol), self.font(), found)
        self._plot.showGrid(x=True, y=True, alpha=0.15)
        self._solids.setPen(pg.mkPen(found.accent, width=2))
        self._no_fly.setPen(pg.mkPen(found.warning, width=2, style=Qt.PenStyle.DotLine))
        self._limit.setPen(pg.mkPen(found.error, width=1.5, style=Qt.PenStyle.DashLine))

    def _fit_titles(self) -> None:
        for side in ("left", "bottom"):
            fit_title(self._plot.getAxis(side), self.font())

    def _draw(self) -> None:
        self._words.setText(self._said())
        if self._is_made:
            self._draw_curves()

    def _top(self) -> float:
        """Where curves are cut off, in the chosen unit."""
        return length_unit(self._units).shown(max(SHOWN_LIMITS * self._limit_m, 10.0))

    def _said(self) -> str:
        found, unit = self._found, length_unit(self._units)
        if found is None or len(found.distance_m) == 0:
            return self.tr("No route to measure yet.")
        words = self.tr("Smallest clearance {0} (must be {1}); further than {2} is cut off").format(
            unit.text(found.solids.smallest_m), unit.text(self._limit_m), unit.text(unit.metric(self._top()))
        )
        if found.no_fly is not None:
            words += self.tr("; from no-fly volumes {0} (dotted)").format(unit.text(found.no_fly.smallest_m))
        return words

    def _draw_curves(self) -> None:
        found, unit = self._found, length_unit(self._units)
        self._limit.setVisible(found is not None)
        if found is None or len(found.distance_m) == 0:
            self._solids.setData([], [])
            self._no_fly.setData([], [])
            return
        x, top = unit.factor * found.distance_m, self._top()
        self._solids.setData(x, np.minimum(unit.factor * found.solids.clearance_m, top))
        if found.no_fly is None:
            self._no_fly.setData([], [])
        else:
            self._no_fly.setData(x, np.minimum(unit.factor * found.no_fly.clearance_m, top))
        self._limit.setValue(unit.shown(self._limit_m))
        self._plot.setXRange(0.0, max(float(x[-1]), 1.0), padding=0.01)
        lowest = min(0.0, unit.shown(found.solids.smallest_m))
        self._plot.setYRange(lowest, top, padding=0.02)

    def _clicked(self, event: object) -> None:
        found = self._found
        if found is None or len(found.distance_m) == 0:
            return
        place = self._plot.getPlotItem().vb.mapSceneToView(event.scenePos())  # type: ignore[attr-defined]
        distance_m = length_unit(self._units).metric(place.x())
        nearest = int(np.argmin(np.abs(found.distance_m - distance_m)))
        self.legPicked.emit(self.sortie(), int(found.leg[nearest]) + 1)


TIME, DISTANCE = "time", "distance"


class ProfileChart(QWidget):
    """Draws curves. `bar` chooses what is shown and says what is under the pointer; put it where there is room.

    Signals
    -------
    picked(Item)
        The user clicked: the viewpoint whose photo is nearest in time.
    """

    picked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._curves: tuple[ProfileCurves, ...] = ()
        self._limits: HeightLimits | None = None
        self._selection: Item | None = None
        self._units = UnitSystem.METRIC
        self._sortie, self._over, self._hover = ChoiceBox(), ChoiceBox(), QLabel()
        self._over.addItem(self.tr("over time"), TIME)
        self._over.addItem(self.tr("over distance"), DISTANCE)
        self._hover.setProperty("role", "muted")
        self._marks: list[pg.InfiniteLine] = []
        self._names: list[LineName] = []
        self._is_made = False
        self.bar = QWidget(self)
        row = QHBoxLayout(self.bar)
        row.setContentsMargins(0, 0, 0, 0)
        for widget in (self._hover, self._sortie, self._over):
            row.addWidget(widget)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._sortie.currentIndexChanged.connect(self._draw)
        self._over.currentIndexChanged.connect(self._draw)
        self._draw()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Make the charts when they are first wanted: that takes longer than the rest of their tab."""
        super().showEvent(event)
        self._make_plots()

    def _make_plots(self) -> None:
        if self._is_made:
            return
        self._is_made = True
        self._charts = pg.GraphicsLayoutWidget()
        self._charts.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._charts.setAccessibleName(self.tr("Height and speed"))
        self._height = self._charts.addPlot(row=0, col=0)
        # Side by side: below the shared view there is width, not height.
        self._speed = self._charts.addPlot(row=0, col=1)
        self._charts.ci.layout.setColumnStretchFactor(0, 3)
        self._charts.ci.layout.setColumnStretchFactor(1, 2)
        self._charts.ci.setContentsMargins(2, 2, 8, 2)
        self._speed.setXLink(self._height)
        for plot in (self._height, self._speed):
            plot.setMenuEnabled(False)
            plot.hideButtons()
            plot.setMouseEnabled(x=True, y=False)
            plot.vb.sigResized.connect(self._fit)
        self._height.vb.sigRangeChanged.connect(self._place_names)
        self._layout.addWidget(self._charts, 1)
        self._charts.scene().sigMouseMoved.connect(self._pointed)
        self._charts.scene().sigMouseClicked.connect(lambda event: self._clicked(event.scenePos()))
        self._draw()

    def set_curves(self, curves: Sequence[ProfileCurves], limits: HeightLimits | None) -> None:
        """Show the sorties of another plan, and what limits the height."""
        chosen = self._sortie.currentData()
        self._curves, self._limits = tuple(curves), limits
        with QSignalBlocker(self._sortie):
            self._sortie.clear()
            for number, curve in enumerate(self._curves):
                self._sortie.addItem(self.tr("Sortie {0}").format(curve.sortie), number)
            self._sortie.setCurrentIndex(max(0, self._sortie.findData(chosen)) if self._curves else -1)
        self._draw()

    def set_units(self, units: UnitSystem) -> None:
        """Show heights, distances and speeds in other units."""
        self._units = units
        self._draw()

    def set_selection(self, item: Item | None) -> None:
        """Mark the photo of a viewpoint, in the chart of its sortie."""
        self._selection = item
        number = self._number_of(item)
        if number is not None and number != self._sortie.currentIndex():
            self._sortie.setCurrentIndex(number)
        else:
            self._mark()

    def hover_text(self) -> str:
        """What is said of the place under the pointer."""
        return self._hover.text()

    def plots(self) -> tuple[pg.PlotItem, pg.PlotItem]:
        """The charts of height and speed."""
        self._make_plots()
        return self._height, self._speed

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw in the colours of another theme."""
        super().changeEvent(event)
        if event.type() in RESTYLED and hasattr(self, "_is_made"):
            self._draw()

    def _curve(self) -> ProfileCurves | None:
        index = self._sortie.currentIndex()
        return self._curves[index] if 0 <= index < len(self._curves) else None

    def _number_of(self, item: Item | None) -> int | None:
        if item is None or item.kind is not ItemKind.VIEWPOINT:
            return None
        return next((number for number, curve in enumerate(self._curves) if item.id in curve.photo_ids), None)

    def _draw(self) -> None:
        self._hover.setText("" if self._curve() else self.tr("No sortie to show: plan a flight first."))
        if self._is_made:
            self._draw_curves()

    def _draw_curves(self) -> None:
        found, curve = colours(), self._curve()
        length, speed = length_unit(self._units), speed_unit(self._units)
        self._charts.setBackground(found.base)
        self._names = []
        over = below = (
            self.tr("Time [min]") if self._is_over_time() else self.tr("Distance [{0}]").format(length.symbol)
        )
        if curve is not None and self._is_over_time() and curve.takeoff_landing_s > 0.0:
            # Only under the wider chart is there room for it.
            below = self.tr("Time [min]; take-off and landing add {0:.0f} s").format(curve.takeoff_landing_s)
        for plot, beside, under in (
            (self._height, self.tr("Height [{0}]").format(length.symbol), below),
            (self._speed, self.tr("Speed [{0}]").format(speed.symbol), over),
        ):
            plot.clear()
            dress_axis(plot.getAxis("left"), beside, self.font(), found)
            dress_axis(plot.getAxis("bottom"), under, self.font(), found)
            plot.showGrid(x=True, y=True, alpha=0.25)
        self._marks = []
        if curve is not None:
            x, photo_x = self._x(curve), self._photo_x(curve)
            pen = pg.mkPen(sortie_colour(curve.sortie), width=2)
            self._height.plot(x, curve.height_m * length.factor, pen=pen)
            self._height.plot(
                photo_x,
                curve.photo_height_m * length.factor,
                pen=None,
                symbol="o",
                symbolSize=6,
                symbolPen=found.base,
                symbolBrush=sortie_colour(curve.sortie),
            )
            # Stop and go at hundreds of photos: thick lines would run into one another.
            self._speed.plot(x, curve.speed_m_s * speed.factor, pen=pg.mkPen(sortie_colour(curve.sortie), width=1))
            # Room for the names of the lines; a ceiling far above would flatten what is flown.
            lowest = min(0.0, 0.0 if self._limits is None else self._limits.ground_m)
            if curve.ground is not None:
                lowest = min(0.0, float(np.nanmin(curve.ground.height_m, initial=0.0)))
                self._draw_ground(curve.ground)
            room = 0.25 * max(float(curve.height_m.max()) - lowest, 5.0)
            shown = lowest - room, float(curve.height_m.max()) + room
            self._height.setYRange(*(height_m * length.factor for height_m in shown), padding=0.0)
            self._draw_limits(shown)
            self._height.setXRange(float(x[0]), float(x[-1]), padding=0.01)
            self._place_names()
            self._add_marks()
        self._mark()

    def _draw_ground(self, ground: GroundCurve) -> None:
        """The terrain, and how high above it no permit is needed; gaps where it is not known."""
        found, factor = colours(), length_unit(self._units).factor
        x = ground.t_s / 60.0 if self._is_over_time() else ground.distance_m * factor
        for above_m, colour, style in (
            (0.0, found.muted, Qt.PenStyle.SolidLine),
            (MAX_ALTITUDE_M, found.error, Qt.PenStyle.DashLine),
        ):
            pen = pg.mkPen(colour, width=1.5, style=style)
            self._height.plot(x, (ground.height_m + above_m) * factor, pen=pen, connect="finite")
        self._name(self.tr("terrain"), found.muted, 0.1, lambda at: float(np.interp(at, x, ground.height_m * factor)))

    def _draw_limits(self, shown_m: tuple[float, float]) -> None:
        limits, found = self._limits, colours()
        if limits is None:
            return
        length = length_unit(self._units)
        level = (
            (limits.ground_m, self.tr("ground"), found.muted, 0.15),
            (limits.legal_m, self.tr("legal ceiling"), found.error, 0.25),
        )
        for height_m, name, colour, place in (
            *(level if limits.is_level else ()),
            (limits.floor_m, self.tr("airspace floor"), found.warning, 0.45),
            (limits.ceiling_m, self.tr("airspace ceiling"), found.warning, 0.75),
        ):
            if not shown_m[0] <= height_m <= shown_m[1]:
                continue
            height = height_m * length.factor
            pen = pg.mkPen(colour, width=1.5, style=Qt.PenStyle.DashLine)
            self._height.addItem(pg.InfiniteLine(height, angle=0, pen=pen), ignoreBounds=True)
            text = self.tr("{0} {1}").format(name, length.text(height_m))
            self._name(text, colour, place, lambda _at, height=height: height)  # type: ignore[misc]

    def _name(self, text: str, colour: str, share: float, height_at: Callable[[float], float]) -> None:
        item = pg.TextItem(text, color=colour)
        item.setFont(self.font())
        item.textItem.document().setDocumentMargin(0.0)
        self._height.addItem(item, ignoreBounds=True)
        self._names.append(LineName(item, height_at, share))

    def _place_names(self) -> None:
        curve = self._curve()
        if curve is not None:
            height = curve.height_m * length_unit(self._units).factor
            place_names(self._height, self._names, (self._x(curve), height))

    def _fit(self) -> None:
        for plot in (self._height, self._speed):
            for side in ("left", "bottom"):
                fit_title(plot.getAxis(side), self.font())
        self._place_names()

    def _add_marks(self) -> None:
        for plot in (self._height, self._speed):
            mark = pg.InfiniteLine(angle=90, pen=pg.mkPen(colours().accent, width=2))
            mark.setVisible(False)
            plot.addItem(mark, ignoreBounds=True)
            self._marks.append(mark)

    def _mark(self) -> None:
        curve = self._curve()
        at = None
        item = self._selection
        if curve is not None and item is not None and self._number_of(item) == self._sortie.currentIndex():
            at = self._photo_x(curve)[curve.photo_ids.index(item.id)]
        for mark in self._marks:
            mark.setVisible(at is not None)
            if at is not None:
                mark.setValue(float(at))

    def _is_over_time(self) -> bool:
        return bool(self._over.currentData() == TIME)

    def _x(self, curve: ProfileCurves) -> np.ndarray:
        return curve.t_s / 60.0 if self._is_over_time() else curve.distance_m * length_unit(self._units).factor

    def _photo_x(self, curve: ProfileCurves) -> np.ndarray:
        if self._is_over_time():
            return curve.photo_t_s / 60.0
        return curve.photo_distance_m * length_unit(self._units).factor

    def _sample_at(self, scene: QPointF) -> int | None:
        """The sample under the pointer; None outside both charts."""
        curve = self._curve()
        plot = next((p for p in (self._height, self._speed) if p.sceneBoundingRect().contains(scene)), None)
        if curve is None or plot is None:
            return None
        x = plot.vb.mapSceneToView(scene).x()
        return int(np.argmin(np.abs(self._x(curve) - x)))

    def _pointed(self, scene: QPointF) -> None:
        sample, curve = self._sample_at(scene), self._curve()
        if sample is None or curve is None:
            return
        length, speed = length_unit(self._units), speed_unit(self._units)
        values = [
            minutes_text(float(curve.t_s[sample])),
            length.text(float(curve.distance_m[sample])),
            length.text(float(curve.height_m[sample])),
            speed.text(float(curve.speed_m_s[sample])),
            nearest_photo(curve, float(curve.t_s[sample])) or "–",
        ]
        text = self.tr("{0} min, {1} flown: {2} above take-off, {3}, nearest photo {4}")
        if curve.ground is not None:
            ground_m = float(np.interp(curve.t_s[sample], curve.ground.t_s, curve.ground.height_m))
            above_m = float(curve.height_m[sample]) - ground_m
            values.append(length.text(above_m) if math.isfinite(above_m) else "?")
            text = self.tr("{0} min, {1} flown: {2} above take-off, {5} above the terrain, {3}, nearest photo {4}")
        self._hover.setText(text.format(*values))

    def _clicked(self, scene: QPointF) -> None:
        sample, curve = self._sample_at(scene), self._curve()
        if sample is None or curve is None:
            return
        viewpoint_id = nearest_photo(curve, float(curve.t_s[sample]))
        if viewpoint_id is not None:
            self.picked.emit(Item(ItemKind.VIEWPOINT, viewpoint_id))
