"""What the embedded simulation shall take into account, and what it would take into account by itself."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, QSignalBlocker, Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.inputs import Form
from groundstation.gui.widgets.parameter_form import add_rows, rows_of
from groundstation.services.fly.connection import CALM, Simulation
from groundstation.services.fly.options import ConnectionChoice
from groundstation.services.fly.sortie import LiveSortie, simulation_effects
from groundstation.services.jobs.runner import JobContext
from groundstation.services.plan.effects import EffectChoice
from groundstation.services.units import UnitSystem
from missions.simulator.conditions import Conditions
from missions.simulator.server import CommonTime
from planning.base.effects import EffectSetting
from planning.base.parameters import declared, with_values
from planning.plan import Plan

# What the embedded simulation flies in: wind, GNSS, and the effects that the flight calls for.


class SimulationPage(QWidget):
    """Edits `Conditions` and the settings of effects.

    Signals
    -------
    valueChanged()
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._conditions = Conditions()
        self._effect_settings: dict[str, EffectSetting] = {}
        self.rows = rows_of(declared(Conditions))
        self.effects = EffectsPanel()
        form = Form()
        add_rows(form, self.rows)
        layout = QVBoxLayout(self)
        # The cards need the whole width beside a scroll bar.
        inner = self.effects.layout()
        assert inner is not None
        for one in (layout, inner):
            one.setContentsMargins(2, 4, 2, 4)
        layout.addLayout(form)
        layout.addWidget(self.effects, 1)
        for row in self.rows.values():
            row.valueChanged.connect(self._edited)
        self.effects.settingChanged.connect(self._effect_set)
        self.setValue(self._conditions, {})

    def value(self) -> tuple[Conditions, dict[str, EffectSetting]]:
        """Conditions, and settings by the name of an effect."""
        return self._conditions, dict(self._effect_settings)

    def setValue(self, conditions: Conditions, effect_settings: dict[str, EffectSetting]) -> None:  # noqa: N802
        """Show other conditions."""
        self._conditions, self._effect_settings = conditions, dict(effect_settings)
        blockers = [QSignalBlocker(row) for row in self.rows.values()]
        for row in self.rows.values():
            row.setValue(row.declared.value_in(conditions))
        del blockers

    def set_effects(self, choices: tuple[EffectChoice, ...]) -> None:
        """Show what was decided about each effect."""
        self.effects.set_effects(choices)

    def set_units(self, units: UnitSystem) -> None:
        """Show speeds in other units."""
        for row in self.rows.values():
            row.set_units(units)
        self.effects.set_units(units)

    def _edited(self, *_value: object) -> None:
        values = {row.declared.path: row.value() for row in self.rows.values()}
        self._conditions = with_values(self._conditions, values)
        self.valueChanged.emit()

    def _effect_set(self, effect: str, setting: EffectSetting) -> None:
        self._effect_settings[effect] = setting
        self.valueChanged.emit()


class SimulationController(QObject):
    """Conditions and settings of effects of the next simulation.

    Its wind begins as the one that the plan expects, as that of the command `simulate` does, and follows another plan
    until the pilot chooses one.

    Signals
    -------
    effectsChanged(tuple of EffectChoice)
        What the simulation would take into account.
    """

    effectsChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context
        self._looking_id = 0
        self.conditions: Conditions = CALM
        self._expected_wind_m_s = CALM.wind_m_s
        self.effect_settings: dict[str, EffectSetting] = {}

    def connection(
        self, sortie: LiveSortie, choice: ConnectionChoice, charge: float, seed: int, common: CommonTime
    ) -> Simulation:
        """The simulation of a sortie, as it was chosen; `charge` of the battery that it begins with, 1 full.

        Each aircraft has errors of its own, by its `seed`, and time in common with those that fly at once.
        """
        self.expect_wind_of(sortie.case.plan)
        return Simulation(
            sortie.case.plan,
            sortie.case.site_model,
            autopilot=choice.autopilot,
            speed_up=choice.speed_up,
            conditions=self.conditions,
            effects=dict(self.effect_settings),
            charge=charge,
            seed=seed,
            common=common,
        )

    def choose(
        self, conditions: Conditions, effect_settings: dict[str, EffectSetting], plan: Plan | None, number: int
    ) -> None:
        """Simulate this sortie in other conditions the next time."""
        self.conditions, self.effect_settings = conditions, effect_settings
        self.look(plan, number)

    def expect_wind_of(self, plan: Plan | None) -> None:
        """Begin with the wind of another plan, unless the pilot chose one."""
        if plan is None:
            return
        if self.conditions.wind_m_s == self._expected_wind_m_s:
            self.conditions = replace(self.conditions, wind_m_s=plan.rules.wind_m_s)
        self._expected_wind_m_s = plan.rules.wind_m_s

    def look(self, plan: Plan | None, number: int) -> None:
        """Find out what the simulation of a sortie, counted from 1, takes into account."""
        site_model = self._context.document.site
        is_busy = any(job.id == self._looking_id for job in self._context.jobs())
        if plan is None or site_model is None or number > len(plan.sorties) or is_busy:
            return
        if site_model.site.n_panels == 0:
            return
        request = (number, self.conditions, dict(self.effect_settings))

        def work(context: JobContext) -> tuple[EffectChoice, ...]:
            return context.run_in_process(simulation_effects, plan, site_model, *request)

        def done(choices: tuple[EffectChoice, ...]) -> None:
            self.effectsChanged.emit(choices)
            if request != (number, self.conditions, self.effect_settings):
                self.look(plan, number)

        self._looking_id = self._context.start(self.tr("Look at the flight"), work, done).id
