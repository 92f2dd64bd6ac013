"""What comes after a flight, as new plans: a top-up for what it missed, or the rest of an interrupted sortie."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.gui.workspace import Workspace
from groundstation.services.document import Document, PlanEntry
from groundstation.services.jobs import JobContext
from groundstation.services.top_up import flown_plan, resume_flight, top_up_flight
from missions.flight.flight_file import flight_of
from missions.flight.record import FlightRecord
from missions.resume import Resumed
from planning.findings import Finding, Severity
from planning.plan import Plan
from planning.site import SiteModel
from planning.top_up import TopUp, TopUpRequest


class AfterFlight(QObject):
    """Keeps what was flown of each plan, and plans what is left, as jobs."""

    def __init__(self, workspace: Workspace, parent: QObject) -> None:
        super().__init__(parent)
        self._workspace = workspace
        self._flown: dict[int, tuple[Plan, tuple[FlightRecord, ...]]] = {}
        self._last: Plan | None = None
        self._battery: float | None = None

    def flown(self, plan: Plan) -> tuple[FlightRecord, ...]:
        """What was flown of a plan since the program was started."""
        _, records = self._flown.get(id(plan), (plan, ()))
        return records

    def add(self, plan: Plan, record: FlightRecord, battery: float | None) -> None:
        """A sortie of a plan was flown; `battery` is what it left of the charge, 1 full."""
        self._flown[id(plan)] = (plan, (*self.flown(plan), record))
        self._last, self._battery = plan, battery

    def top_up(self) -> None:
        """Plan the shortest flight that closes what is missing, with the battery that is left, as a new plan."""
        flown = self._flown_here()
        if flown is None:
            return
        plan, site_model, records = flown
        battery = self._battery

        def work(context: JobContext) -> tuple[TopUp, tuple[Finding, ...]]:
            found = flown_plan(flight_of(plan, site_model, records), plan, site_model)
            return top_up_flight(found, TopUpRequest(battery=battery), monitor=context)

        def done(result: tuple[TopUp, tuple[Finding, ...]]) -> None:
            found, findings = result
            for finding in findings:
                self._workspace.say(finding.severity, self._workspace.words(finding.message))
            if found.plan is None:
                self._workspace.say(Severity.OK, self.tr("Nothing is missing: the photos show all that was planned."))
                return
            text = self.tr("Top-up planned, photos: {0}; it closes {1} of {2} missing sections").format(
                len(found.plan.viewpoints), found.closed, found.wanted
            )
            self._add_plan(self.tr("Top-up"), found.plan, text)

        self._workspace.start(self.tr("Top-up flight"), work, done)

    def resume_sortie(self) -> None:
        """Plan the rest of the sortie that was interrupted, for a full battery, as a new plan."""
        flown = self._flown_here()
        if flown is None:
            return
        plan, site_model, records = flown

        def work(context: JobContext) -> Resumed:
            found = flown_plan(flight_of(plan, site_model, records), plan, site_model)
            return resume_flight(found, monitor=context)

        def done(rest: Resumed) -> None:
            text = self.tr("Rest of sortie {0} planned, photos: {1}").format(
                rest.mission.number, len(rest.plan.viewpoints)
            )
            self._add_plan(self.tr("Rest of sortie {0}").format(rest.mission.number), rest.plan, text)

        self._workspace.start(self.tr("Resume sortie"), work, done)

    def _flown_here(self) -> tuple[Plan, SiteModel, tuple[FlightRecord, ...]] | None:
        """The plan that was flown last, the site as it is now, and all that was flown of the plan."""
        site_model = self._workspace.document.site
        if self._last is None or site_model is None:
            return None
        return self._last, site_model, self.flown(self._last)

    def _add_plan(self, title: str, plan: Plan, text: str) -> None:
        document: Document = self._workspace.document
        entry = PlanEntry(document.free_plan_id(), title, plan)
        self._workspace.change(title, document.with_plan(entry))
        self._workspace.say(Severity.OK, text)
