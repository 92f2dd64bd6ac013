"""The effects panel: each effect with on, off or auto, what the scene says, how large it would be and what it costs."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFrame, QLabel, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.scrolling import WrappingRow
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.units import UnitSystem

SETTINGS = ("auto", "on", "off")


class EffectsPanel(QWidget):
    """One card per effect.

    Signals
    -------
    settingChanged(str, str)
        Name of the effect, and auto, on or off.
    lookedAt()
        It came into sight.
    """

    settingChanged = Signal(str, str)  # noqa: N815  (Qt's own way of naming)
    lookedAt = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layout = QVBoxLayout(self)
        self._empty = QLabel(self.tr("What the scene calls for stands here, once the panels of a site were looked at."))
        self._empty.setProperty("role", "muted")
        self._empty.setWordWrap(True)
        self._layout.addWidget(self._empty)
        self._layout.addStretch(1)
        self._cards: dict[str, _EffectCard] = {}
        self._choices: tuple[EffectChoice, ...] = ()
        self._units = UnitSystem.METRIC

    def set_effects(self, choices: tuple[EffectChoice, ...]) -> None:
        """Show effects. Cards are kept for good: there are a few kinds of effects only."""
        self._choices = choices
        for card in self._cards.values():
            card.setVisible(False)
        for number, choice in enumerate(choices):
            name = choice.decision.effect
            if name not in self._cards:
                self._cards[name] = _EffectCard()
                self._cards[name].settingChanged.connect(
                    lambda setting, name=name: self.settingChanged.emit(name, setting)
                )
                self._layout.insertWidget(1 + number, self._cards[name])
            self._cards[name].set_choice(choice, self._units)
            self._cards[name].setVisible(True)
        self._empty.setVisible(not choices)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self.set_effects(self._choices)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Somebody looks."""
        super().showEvent(event)
        self.lookedAt.emit()

    def card(self, name: str) -> _EffectCard:
        """The card of one effect."""
        return self._cards[name]


class _EffectCard(QFrame):
    """Name and setting above, the decision in words below."""

    settingChanged = Signal(str)  # noqa: N815

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._name, self._state, self._words, self._size = QLabel(), QLabel(), QLabel(), QLabel()
        self._name.setProperty("role", "heading")
        self._size.setProperty("role", "muted")
        for label in (self._name, self._words, self._size):
            label.setWordWrap(True)
        self.setting = ChoiceBox()
        for setting, text in zip(SETTINGS, (self.tr("auto"), self.tr("on"), self.tr("off")), strict=True):
            self.setting.addItem(text, setting)
        self.setting.currentIndexChanged.connect(
            lambda _index: self.settingChanged.emit(str(self.setting.currentData()))
        )
        above = WrappingRow(first_grows=True)
        above.addWidget(self._name)
        above.addWidget(self._state)
        above.addWidget(self.setting)
        layout = QVBoxLayout(self)
        layout.addLayout(above)
        layout.addWidget(self._words)
        layout.addWidget(self._size)

    def set_choice(self, choice: EffectChoice, units: UnitSystem) -> None:
        """Show a decision."""
        found = choice.decision
        self._name.setText(translated(found.effect, units))
        self._state.setText(self.tr("is on") if found.on else self.tr("is off"))
        self._state.setProperty("role", "ok" if found.on else "muted")
        self._state.style().polish(self._state)
        by = "" if found.decided_by == "scene" else self.tr(" (as you asked)")
        self._words.setText(translated(found.reason, units) + by)
        self._size.setText(
            self.tr("Size {0:.3g} {1}, tolerance {2:.3g}; costs about {3:.1f} s").format(
                found.size, translated(found.unit, units), found.tolerance, found.cost_s
            )
        )
        self.setting.setVisible(choice.setting is not None)
        with QSignalBlocker(self.setting):
            self.setting.setCurrentIndex(SETTINGS.index(choice.setting or "auto"))

    def text(self) -> str:
        """Everything the card says."""
        return "\n".join(label.text() for label in (self._name, self._state, self._words, self._size))
