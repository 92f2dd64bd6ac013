"""Quality against time: of the running plan with its bound, and of a search for panels at several scales."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt, QTimer
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.charts.axes import PAD_PX, Axes, Chart, box_of_axes
from groundstation.gui.widgets.theme import Colours
from groundstation.services.photos.tradeoff import Knob, Trial
from groundstation.services.units import UnitSystem, per_cent, sampling_unit
from planning.base.progress import Clock, QualityPoint

# The accuracy of corners against the time of the search, at several scales and with fewer photos.

DOT_PX = 4.0
ROOM_ABOVE = 1.15


class TrialPlot(Chart):
    """Draws trials: scales as a line of dots, numbers of photos as one of squares."""

    def __init__(self) -> None:
        super().__init__("", least_height_px=150)
        self.title_x = self.tr("time of the search in s")
        self._trials: tuple[Trial, ...] = ()
        self._units = UnitSystem.METRIC
        self.setAccessibleName(self.tr("Accuracy of corners against the time of the search"))

    def set_trials(self, trials: tuple[Trial, ...], units: UnitSystem) -> None:
        """Draw other trials."""
        self._trials, self._units = tuple(trial for trial in trials if trial.sigma_m is not None), units
        self.update()

    def axes(self) -> Axes:
        """From 0, in both directions; the unit stands above them."""
        unit = sampling_unit(self._units)
        end_x = ROOM_ABOVE * max((trial.seconds for trial in self._trials), default=1.0)
        end_y = ROOM_ABOVE * max((unit.shown(trial.sigma_m or 0.0) for trial in self._trials), default=1.0)
        return Axes(box_of_axes(QRectF(self.rect()), self.font(), self._line_px()), end_x, end_y)

    def paint_inside(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Both lines."""
        self._paint_line(painter, "scale", QColor(look.covered), axes)
        self._paint_line(painter, "photos", QColor(look.open), axes)

    def paint_above(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Unit."""
        painter.setPen(QColor(look.text))
        title = self.tr("\u00b1 {0} at a corner").format(sampling_unit(self._units).symbol)
        painter.drawText(QRectF(PAD_PX, 0.0, self.width(), self._line_px()), title)

    def _line_px(self) -> float:
        return QFontMetricsF(self.font()).height()

    def _paint_line(self, painter: QPainter, knob: Knob, colour: QColor, axes: Axes) -> None:
        unit = sampling_unit(self._units)
        known = [(trial.seconds, unit.shown(trial.sigma_m or 0.0)) for trial in self._trials if trial.knob == knob]
        points = [axes.place(x, y) for x, y in known]
        painter.setPen(QPen(colour, 2.0))
        painter.drawPolyline(points)
        painter.setBrush(colour)
        for point in points:
            if knob == "scale":
                painter.drawEllipse(point, DOT_PX, DOT_PX)
            else:
                painter.drawRect(QRectF(point.x() - DOT_PX, point.y() - DOT_PX, 2.0 * DOT_PX, 2.0 * DOT_PX))


class TrialChart(QWidget):
    """The plot, what it says in words, and `measure`, the button that asks for it."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._trials: tuple[Trial, ...] = ()
        self._units = UnitSystem.METRIC
        self.measure = QPushButton(self.tr("Measure on this facade"))
        self.measure.setToolTip(self.tr("Search its photos again at several scales, and with fewer of them"))
        self.plot, self._words = TrialPlot(), QLabel()
        self._words.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 4, 0, 0)
        layout.addWidget(self.measure)
        layout.addWidget(self.plot, 1)
        layout.addWidget(self._words)
        self._show()

    def set_trials(self, trials: tuple[Trial, ...]) -> None:
        """Show other trials."""
        self._trials = trials
        self._show()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._show()

    def text(self) -> str:
        """What stands below the plot."""
        return self._words.text()

    def _show(self) -> None:
        self.plot.set_trials(self._trials, self._units)
        if not self._trials:
            self._words.setText(self.tr("What a finer picture and more photos cost in time, and what they bring."))
            return
        lines = [
            self.tr("\u25cf side {0} px: {1}").format(trial.value, self._told(trial))
            if trial.knob == "scale"
            else self.tr("\u25a0 photos {0}: {1}").format(trial.value, self._told(trial))
            for trial in self._trials
        ]
        self._words.setText("\n".join(lines))

    def _told(self, trial: Trial) -> str:
        if trial.sigma_m is None:
            return self.tr("{0:.1f} s, no grid").format(trial.seconds)
        unit = sampling_unit(self._units)
        return self.tr("{0:.1f} s, {1} panels, \u00b1 {2:.3g} {3}").format(
            trial.seconds, trial.n_panels, unit.shown(trial.sigma_m), unit.symbol
        )


REDRAW_MS = 100
"""Improvements can come a thousand times a second; the eye needs ten."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """What is drawn.

    Parameters
    ----------
    x, y
        Corners of a line of steps, both rising, shape (n,): each value holds until the next one comes.
    end_x, end_y
        Ends of the axes, which begin at 0; positive.
    bound
        Height of the dashed line; None for none.
    now
        Place of the dotted line; None for none.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    end_x: float
    end_y: float
    bound: float | None = None
    now: float | None = None

    def axes(self, box: QRectF) -> Axes:
        """To draw it in a box."""
        return Axes(box, self.end_x, self.end_y)


class CurvePlot(Chart):
    """A rising curve over time with the bound above it; it is drawn ten times a second beside a running plan."""

    def __init__(self, title_x: str, title_y: str) -> None:
        super().__init__(title_x, title_y)
        self._curve = Curve(np.zeros(0), np.zeros(0), 1.0, 1.0)

    def curve(self) -> Curve:
        """What is drawn."""
        return self._curve

    def set_curve(self, curve: Curve) -> None:
        """Draw another curve."""
        self._curve = curve
        self.update()

    def axes(self) -> Axes:
        """From 0, in both directions."""
        return self._curve.axes(box_of_axes(QRectF(self.rect()), self.font()))

    def paint_inside(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Bound, present time, and the curve."""
        curve = self._curve
        if curve.bound is not None:
            painter.setPen(QPen(QColor(look.error), 1.5, Qt.PenStyle.DashLine))
            painter.drawLine(axes.place(0.0, curve.bound), axes.place(curve.end_x, curve.bound))
        if curve.now is not None:
            painter.setPen(QPen(QColor(look.muted), 1.0, Qt.PenStyle.DotLine))
            painter.drawLine(axes.place(curve.now, 0.0), axes.place(curve.now, curve.end_y))
        painter.setPen(QPen(QColor(look.accent if look.is_dark else look.covered), 2.5))
        painter.drawPolyline(steps(curve, axes))


def steps(curve: Curve, axes: Axes) -> list[QPointF]:
    """The line of steps; of corners that share a column of pixels, the last."""
    if len(curve.x) == 0:
        return []
    column = (curve.x / curve.end_x * axes.box.width()).astype(np.int64)
    kept = np.append(np.flatnonzero(np.diff(column)), len(column) - 1)
    points: list[QPointF] = []
    for x, y in zip(curve.x[kept].tolist(), curve.y[kept].tolist(), strict=True):
        corner = axes.place(x, y)
        if points:
            points.append(QPointF(corner.x(), points[-1].y()))
        points.append(corner)
    return points


class QualityChart(QWidget):
    """Covered sections over seconds as they come, the upper bound once it is known, and the time budget.

    `enough` is the button "good enough, stop here".
    """

    def __init__(self, clock: Clock, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._clock = clock
        self._points: list[QualityPoint] = []
        self._is_for_model = False
        self._bound: float | None = None
        self._started_s: float | None = None
        self._budget_s = 0.0
        self.plot = CurvePlot(self.tr("time in s"), self.tr("covered sections"))
        self._words, self._left = QLabel(), QLabel()
        self._words.setWordWrap(True)
        self.enough = QPushButton(self.tr("Stop and keep"))
        self.enough.setToolTip(self.tr("Keep the best views found so far and plan the route"))
        self.enough.setVisible(False)
        below = QHBoxLayout()
        below.addWidget(self._left, 1)
        below.addWidget(self.enough)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(self.plot, 1)
        layout.addWidget(self._words)
        layout.addLayout(below)
        self._redraw = QTimer(self)
        self._redraw.setInterval(REDRAW_MS)
        self._redraw.timeout.connect(self._draw)
        self._draw()

    def start(self, budget_s: float) -> None:
        """A plan begins, with so much time."""
        self._points, self._bound = [], None
        self._started_s, self._budget_s = self._clock(), budget_s
        self.enough.setVisible(True)
        self.enough.setEnabled(True)
        self._redraw.start()
        self._draw()

    def add_point(self, point: QualityPoint) -> None:
        """Another improvement."""
        self._points.append(point)

    def set_bound(self, sections: float) -> None:
        """No plan covers more than this."""
        self._bound = sections

    def finish(self) -> None:
        """The plan ended, one way or another."""
        self._started_s = None
        self.enough.setVisible(False)
        self._redraw.stop()
        self._draw()

    def show_history(
        self, points: tuple[QualityPoint, ...], bound: float | None, *, is_for_model: bool = False
    ) -> None:
        """The curve of a plan that was made before; its views may have been chosen for the model and not for this."""
        self._points, self._bound, self._is_for_model = list(points), bound, is_for_model
        self._draw()

    def text(self) -> str:
        """What stands below the curve."""
        return f"{self._words.text()} {self._left.text()}".strip()

    def _draw(self) -> None:
        times, values = [p.t_s for p in self._points], [p.value for p in self._points]
        elapsed_s = None if self._started_s is None else self._clock() - self._started_s
        # Room behind the last improvement, or a plan that was found in one go would have no curve.
        end_s = max([*(1.05 * t_s for t_s in times[-1:]), 0.0 if elapsed_s is None else elapsed_s, 1.0])
        if times and end_s > times[-1]:
            times, values = [*times, end_s], [*values, values[-1]]
        highest = max([*values, self._bound or 0.0, 1.0])
        curve = Curve(np.array(times), np.array(values), 1.05 * end_s, 1.08 * highest, self._bound, elapsed_s)
        self.plot.set_curve(curve)
        self._say(values, elapsed_s)

    def _say(self, values: list[float], elapsed_s: float | None) -> None:
        if not values:
            self._words.setText(self.tr("Quality against time appears here while a plan runs."))
        elif elapsed_s is None and self._bound:
            # The plan may have been edited since.
            words = self.tr("The search found {0:.0f} sections, {1:.1f} % of the {2:.0f} that any flight could cover")
            text = words.format(values[-1], per_cent(values[-1], self._bound), self._bound)
            if self._is_for_model:
                text += "\n" + self.tr("Its views were chosen for the quality of the model instead: see “Worth”.")
            self._words.setText(text)
        elif self._bound:
            self._words.setText(
                self.tr("{0:.0f} sections covered, {1:.1f} % of the {2:.0f} that any flight could cover").format(
                    values[-1], per_cent(values[-1], self._bound), self._bound
                )
            )
        else:
            self._words.setText(self.tr("{0:.0f} sections covered").format(values[-1]))
        if elapsed_s is None:
            self._left.clear()
        else:
            left_s = max(0.0, self._budget_s - elapsed_s)
            self._left.setText(self.tr("at most {0:.0f} s left").format(left_s))
