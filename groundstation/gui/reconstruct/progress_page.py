"""How far a training is: its stage and time, PSNR of unseen views and the terms of the loss against time."""

from __future__ import annotations

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QLabel, QProgressBar, QVBoxLayout, QWidget

from groundstation.gui.charts.lines_plot import Line, LinesPlot
from groundstation.gui.reconstruct.names import term_name
from groundstation.services.reconstruct.curves import ThinCurve, smoothed

REDRAW_MS = 250
"""Steps come a hundred times as often as the eye can follow."""

SMOOTH = 20
"""Values of a loss that are averaged: each is of another photo."""


MINUTES_FROM_S = 900.0
"""Longer trainings are drawn over minutes."""


class ProgressPage(QWidget):
    """Two charts, and what stands above them."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.state, self.bar, self.numbers = QLabel(), QProgressBar(), QLabel()
        empty = self.tr("Appears here while a model learns.")
        self.quality = LinesPlot(self.tr("time in s"), self.tr("PSNR in dB"), empty)
        self.losses = LinesPlot(self.tr("time in s"), self.tr("loss"), empty)
        for label in (self.state, self.numbers):
            label.setWordWrap(True)
        self.state.setProperty("role", "heading")
        self.numbers.setProperty("role", "muted")
        self.bar.setRange(0, 1000)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        for widget in (self.state, self.bar, self.numbers):
            layout.addWidget(widget)
        for heading, plot in (
            (self.tr("Facades of unseen views"), self.quality),
            (self.tr("Terms of the loss"), self.losses),
        ):
            title = QLabel(heading)
            title.setProperty("role", "heading")
            layout.addWidget(title)
            layout.addWidget(plot, 1)
        self._curves: tuple[ThinCurve, dict[str, ThinCurve]] = (ThinCurve(), {})
        self._redraw = QTimer(self)
        self._redraw.setSingleShot(True)
        self._redraw.setInterval(REDRAW_MS)
        self._redraw.timeout.connect(self._draw)
        self.set_state("", None)

    def set_state(self, words: str, share: float | None, numbers: str = "") -> None:
        """Say where it stands; `share` done, 0 to 1, negative where that is not known, None where nothing runs."""
        self.state.setText(words or self.tr("Nothing is being trained."))
        self.bar.setVisible(share is not None)
        if share is not None:
            self.bar.setRange(0, 0 if share < 0.0 else 1000)
            self.bar.setValue(int(1000 * min(1.0, max(0.0, share))))
        self.numbers.setText(numbers)
        self.numbers.setVisible(bool(numbers))

    def set_curves(self, quality: ThinCurve, terms: dict[str, ThinCurve]) -> None:
        """Draw curves, soon."""
        self._curves = quality, terms
        if not self._redraw.isActive():
            self._redraw.start()

    def text(self) -> str:
        """What stands above the charts."""
        return f"{self.state.text()}\n{self.numbers.text()}".strip()

    def _draw(self) -> None:
        quality, terms = self._curves
        last_s = max([0.0, *(curve.x[-1] for curve in (quality, *terms.values()) if curve.x)])
        in_minutes = last_s > MINUTES_FROM_S
        for plot in (self.quality, self.losses):
            plot.set_title_x(self.tr("time in min") if in_minutes else self.tr("time in s"))
        scale = 1.0 / 60.0 if in_minutes else 1.0
        seconds, psnr_db = quality.arrays()
        self.quality.set_lines((Line(self.tr("unseen views"), scale * seconds, psnr_db),) if quality.x else ())
        lines = []
        for name, curve in terms.items():
            x, y = curve.arrays()
            lines.append(Line(term_name(name), scale * x, smoothed(y, SMOOTH)))
        self.losses.set_lines(tuple(lines), from_zero=True)
