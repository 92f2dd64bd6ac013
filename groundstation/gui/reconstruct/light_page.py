"""Which model of mirrored light the scene calls for and why; and what the user wishes instead."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QComboBox, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.reconstruct.names import light_name
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.reconstruct.choices import MethodRow, light_names
from groundstation.services.units import UnitSystem
from planning.base.effects import Decision


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
        heading = QLabel(self.tr("Mirrored light is learned as"))
        heading.setProperty("role", "heading")
        for light in light_names():
            self.light.addItem(light_name(light), light)
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
        """What is wished."""
        return str(self.light.currentData())

    def setValue(self, light: str) -> None:  # noqa: N802
        """Show another wish."""
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
