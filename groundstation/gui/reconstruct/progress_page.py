"""Details of a training: its stage, time, PSNR and terms of the loss, and the model of mirrored light it uses."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, QTimer, Signal
from PySide6.QtWidgets import QComboBox, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.charts.axes import Line, LinesPlot
from groundstation.gui.reconstruct.view_pictures import light_name, term_name
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.parameter_form import title_of
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.reconstruct.choices import MethodRow
from groundstation.services.reconstruct.curves import ThinCurve, smoothed
from groundstation.services.units import UnitSystem
from planning.base.effects import Decision
from planning.base.parameters import declared
from reconstruction.training.parameters import LIGHTS, TrainRequest

# Which model of mirrored light the scene calls for and why; and what the user chooses instead.


class LightPage(QWidget):
    """Edits the name of a model of light, and shows decisions about it.

    Signals
    -------
    valueChanged(str)
        By the user.
    asked()
        The scene shall be asked.
    """

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.light, self.ask, self.words = ChoiceBox(), QPushButton(self.tr("Ask the scene")), QLabel()
        self.effects = EffectsPanel()
        self.ask.setToolTip(
            self.tr("Try the cheap models on the photos for some seconds, and say which one is worth it")
        )
        self.words.setWordWrap(True)
        heading = QLabel(title_of(declared(TrainRequest)["light"].parameter))
        heading.setProperty("role", "heading")
        for light in LIGHTS:
            self.light.addItem(light_name(light.value), light.value)
        self.light.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.light.setMinimumContentsLength(10)
        self.light.currentIndexChanged.connect(self._changed)
        self.ask.clicked.connect(self._ask)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        for widget in (heading, self.light, self.ask, self.words, self.effects):
            layout.addWidget(widget)
        layout.addStretch(1)
        self.show_decisions("", ())

    def value(self) -> str:
        """What is chosen."""
        return str(self.light.currentData())

    def setValue(self, light: str) -> None:  # noqa: N802
        """Show another request."""
        with QSignalBlocker(self.light):
            self.light.setCurrentIndex(self.light.findData(light))

    def set_possible(self, method: MethodRow, *, can_ask: bool, can_choose: bool) -> None:
        """Enable what can be done now, with a method."""
        self.ask.setEnabled(can_ask and method.knows_panels)
        self.light.setEnabled(can_choose and method.knows_panels)
        usual = light_name("auto")
        if method.light != "auto":
            usual = self.tr("as the method has it: {0}").format(light_name(method.light))
        self.light.setItemText(self.light.findData("auto"), usual)

    def show_decisions(self, light: str, decisions: tuple[Decision, ...]) -> None:
        """Show what was decided; "" where nothing is known yet."""
        if not light:
            words = self.tr(
                "Nothing is known of this scene yet. It is asked when a training begins, or now, which takes seconds."
            )
        elif decisions:
            words = self.tr("The scene calls for: {0}.").format(light_name(light))
        else:
            words = self.tr("It is learned as: {0}.").format(light_name(light))
        self.words.setText(words)
        self.effects.set_effects(tuple(EffectChoice(decision, None) for decision in decisions))
        self.effects.setVisible(bool(decisions))

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self.effects.set_units(units)

    def text(self) -> str:
        """What is said of the light."""
        return self.words.text()

    def _changed(self) -> None:
        self.valueChanged.emit(self.value())

    def _ask(self) -> None:
        self.asked.emit()


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
            (self.tr("Facades of some unseen views"), self.quality),
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
