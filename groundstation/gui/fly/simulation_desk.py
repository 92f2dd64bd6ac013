"""What the embedded simulation shall take into account, and what it would take into account by itself."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from groundstation.gui.workspace import Workspace
from groundstation.services.effects import EffectChoice
from groundstation.services.jobs import JobContext
from groundstation.services.live_choice import ConnectionChoice
from groundstation.services.live_connection import CALM, Simulation
from groundstation.services.live_sortie import LiveSortie, simulation_effects
from missions.simulator.scene import Conditions
from planning.effects import Wish
from planning.plan import Plan


class SimulationDesk(QObject):
    """Conditions and wishes of the next simulation.

    Signals
    -------
    effectsChanged(tuple of EffectChoice)
        What the simulation would take into account.
    """

    effectsChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, workspace: Workspace, parent: QObject) -> None:
        super().__init__(parent)
        self._workspace = workspace
        self._looking_id = 0
        self.conditions: Conditions = CALM
        self.wishes: dict[str, Wish] = {}

    def connection(self, sortie: LiveSortie, choice: ConnectionChoice, charge: float) -> Simulation:
        """The simulation of a sortie, as it was chosen; `charge` of the battery that it begins with, 1 full."""
        return Simulation(
            sortie.case.plan,
            sortie.case.site_model,
            autopilot=choice.autopilot,
            speed_up=choice.speed_up,
            conditions=self.conditions,
            wishes=dict(self.wishes),
            charge=charge,
        )

    def choose(self, conditions: Conditions, wishes: dict[str, Wish], plan: Plan | None, number: int) -> None:
        """Simulate this sortie in other conditions the next time."""
        self.conditions, self.wishes = conditions, wishes
        self.look(plan, number)

    def look(self, plan: Plan | None, number: int) -> None:
        """Find out what the simulation of a sortie, counted from 1, takes into account."""
        site_model = self._workspace.document.site
        is_busy = any(job.id == self._looking_id for job in self._workspace.jobs())
        if plan is None or site_model is None or number > len(plan.sorties) or is_busy:
            return
        if site_model.site.n_panels == 0:
            return
        asked = (number, self.conditions, dict(self.wishes))

        def work(_context: JobContext) -> tuple[EffectChoice, ...]:
            return simulation_effects(plan, site_model, *asked)

        def done(choices: tuple[EffectChoice, ...]) -> None:
            self.effectsChanged.emit(choices)
            if asked != (number, self.conditions, self.wishes):
                self.look(plan, number)

        self._looking_id = self._workspace.start(self.tr("Look at the flight"), work, done).id
