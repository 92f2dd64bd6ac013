"""Clearance along one sortie: what is kept from building, obstacles and no-fly volumes, and what must be."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.theme import colours
from groundstation.services.units import UnitSystem, length_unit
from planning.insight.clearance import RouteClearance

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
        self._plot = pg.PlotWidget()
        self._plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._plot.setMenuEnabled(False)
        self._plot.setMouseEnabled(x=True, y=False)
        self._plot.hideButtons()
        self._solids = self._plot.plot()
        self._no_fly = self._plot.plot()
        self._limit = pg.InfiniteLine(angle=0, movable=False)
        self._plot.addItem(self._limit, ignoreBounds=True)
        above = QHBoxLayout()
        above.addWidget(self._sortie)
        above.addWidget(self._words, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addLayout(above)
        layout.addWidget(self._plot, 1)
        self._sortie.currentIndexChanged.connect(lambda index: self.sortieChosen.emit(index + 1))
        self._plot.scene().sigMouseClicked.connect(self._clicked)
        self._dress()
        self._draw()

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
        self._dress()
        self._draw()

    def text(self) -> str:
        """What is said above the curve."""
        return self._words.text()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_limit"):
            self._dress()

    def _dress(self) -> None:
        found, unit = colours(), length_unit(self._units)
        self._plot.setBackground(found.base)
        left, bottom = self.tr("in {0}"), self.tr("distance flown in {0}")
        for side, text in (("left", left), ("bottom", bottom)):
            axis = self._plot.getAxis(side)
            axis.setLabel(text.format(unit.symbol), color=found.text)
            axis.setPen(found.line)
            axis.setTextPen(found.text)
            axis.enableAutoSIPrefix(False)
        self._plot.showGrid(x=True, y=True, alpha=0.15)
        self._solids.setPen(pg.mkPen(found.accent, width=2))
        self._no_fly.setPen(pg.mkPen(found.warning, width=2, style=Qt.PenStyle.DotLine))
        self._limit.setPen(pg.mkPen(found.error, width=1.5, style=Qt.PenStyle.DashLine))

    def _draw(self) -> None:
        found, unit = self._found, length_unit(self._units)
        self._limit.setVisible(found is not None)
        if found is None or len(found.distance_m) == 0:
            self._solids.setData([], [])
            self._no_fly.setData([], [])
            self._words.setText(self.tr("No route to measure yet."))
            return
        x, top = unit.factor * found.distance_m, unit.shown(max(SHOWN_LIMITS * self._limit_m, 10.0))
        self._solids.setData(x, np.minimum(unit.factor * found.solids.clearance_m, top))
        if found.no_fly is None:
            self._no_fly.setData([], [])
        else:
            self._no_fly.setData(x, np.minimum(unit.factor * found.no_fly.clearance_m, top))
        self._limit.setValue(unit.shown(self._limit_m))
        self._plot.setXRange(0.0, max(float(x[-1]), 1.0), padding=0.01)
        lowest = min(0.0, unit.shown(found.solids.smallest_m))
        self._plot.setYRange(lowest, top, padding=0.02)
        words = self.tr("Smallest clearance {0} (must be {1}); further than {2} is cut off").format(
            unit.text(found.solids.smallest_m), unit.text(self._limit_m), unit.text(unit.metric(top))
        )
        if found.no_fly is not None:
            words += self.tr("; from no-fly volumes {0} (dotted)").format(unit.text(found.no_fly.smallest_m))
        self._words.setText(words)

    def _clicked(self, event: object) -> None:
        found = self._found
        if found is None or len(found.distance_m) == 0:
            return
        place = self._plot.getPlotItem().vb.mapSceneToView(event.scenePos())  # type: ignore[attr-defined]
        distance_m = length_unit(self._units).metric(place.x())
        nearest = int(np.argmin(np.abs(found.distance_m - distance_m)))
        self.legPicked.emit(self.sortie(), int(found.leg[nearest]) + 1)
