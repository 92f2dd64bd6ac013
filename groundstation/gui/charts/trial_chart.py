"""The accuracy of corners against the time of the search, at several scales and with fewer photos."""

from __future__ import annotations

from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.charts.axes import PAD_PX, Axes, Chart, box_of_axes
from groundstation.gui.widgets.theme import Colours
from groundstation.services.photos.tradeoff import Knob, Trial
from groundstation.services.units import UnitSystem, sampling_unit

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
