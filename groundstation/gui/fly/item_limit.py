"""Plans with more photos in a sortie than the autopilot keeps items for: found, and shared out anew as a plan."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject

from groundstation.gui.workspace import Workspace
from groundstation.services.document import PlanEntry
from groundstation.services.jobs import JobContext
from groundstation.services.live_choice import ConnectionChoice, LinkKind
from groundstation.services.live_limit import TooLong, shared_out, too_long
from missions.mavlink.autopilots import Autopilot
from planning.findings import Severity
from planning.plan import Plan


class ItemLimit(QObject):
    """Works on the current plan of the document."""

    def __init__(self, workspace: Workspace, parent: QObject) -> None:
        super().__init__(parent)
        self._workspace = workspace

    def exceeded(self, choice: ConnectionChoice) -> TooLong | None:
        """Whether a sortie has more photos than the autopilot, or any that may answer at a link, has room for."""
        entry = self._workspace.document.current
        if entry is None:
            return None
        is_simulation = choice.kind is LinkKind.SIMULATION
        return too_long(entry.plan, [choice.autopilot] if is_simulation else tuple(Autopilot))

    def share_out(self, found: TooLong, then: Callable[[], None]) -> int:
        """Share the views out among sorties that fit, as a plan of its own; returns the job's number, 0 for none.

        Parameters
        ----------
        then
            Called once that is the current plan.
        """
        site_model, entry = self._workspace.document.site, self._workspace.document.current
        if site_model is None or entry is None:
            return 0

        def work(context: JobContext) -> Plan:
            return shared_out(entry.plan, site_model, found, context)

        def done(anew: Plan) -> None:
            document = self._workspace.document
            if document.site is not site_model:
                return
            title = self.tr("{0}, shared out").format(entry.title)
            added = document.with_plan(PlanEntry(document.free_plan_id(), title, anew))
            self._workspace.change(self.tr("Share views out"), added)
            text = self.tr("Views shared out anew, sorties: {0}").format(len(anew.sorties))
            self._workspace.say(Severity.OK, text)
            then()

        job_id: int = self._workspace.start(self.tr("Share views out"), work, done).id
        return job_id
