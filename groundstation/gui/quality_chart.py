"""Quality against time of the running plan, with the bound above it."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtWidgets import QWidget

from planning.progress import QualityPoint


class QualityChart(pg.PlotWidget):  # type: ignore[misc]
    """Covered sections over seconds as they come, and the upper bound once it is known."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent, background="w")
        self.setLabel("left", self.tr("covered sections"))
        self.setLabel("bottom", self.tr("time"), units="s")
        self.showGrid(x=True, y=True, alpha=0.2)
        self._line = self.plot(pen=pg.mkPen("#2e86ab", width=2), stepMode="right")
        self._bound = pg.InfiniteLine(
            angle=0, pen=pg.mkPen("#d64545", style=pg.QtCore.Qt.PenStyle.DashLine), label="", movable=False
        )
        self._points: list[QualityPoint] = []
        self.setMinimumSize(280, 220)
        self.setLimits(xMin=0.0)

    def clear_points(self) -> None:
        """Start over."""
        self._points = []
        self._line.setData([], [])
        self.removeItem(self._bound)

    def add_point(self, point: QualityPoint) -> None:
        """Another improvement."""
        self._points.append(point)
        self._line.setData([p.t_s for p in self._points], [p.value for p in self._points])
        self.setXRange(0.0, max(1.0, 1.05 * point.t_s), padding=0.0)

    def set_bound(self, sections: int) -> None:
        """Draw the upper bound."""
        self._bound.setValue(sections)
        self.removeItem(self._bound)
        self.addItem(self._bound)
