"""What the Mission tab does: check, import and compare, each as a job, each result put where it belongs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.compare import MissionComparison, compare_with_plan
from groundstation.services.mission.files import bare_site, missions_as_plan, plan_of_missions, read_mission_files
from groundstation.services.mission.readiness import UNKNOWN_DAY, FlightDay, Preflight, preflight
from groundstation.services.plan.places import item_of_place
from groundstation.services.plan.planning import PLANNED_WITHIN_S
from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.site.sources import with_new_site
from planning.base.findings import Finding, Severity
from planning.plan import Plan
from planning.site.records import SiteModel
from planning.site.zones.keep_out import at_time

MAX_SHOWN_FINDINGS = 5
"""Findings of one import that are said one by one; the check lists all."""


@dataclass(frozen=True, slots=True, eq=False)
class Proved:
    """What the independent verifier said of a plan on its site."""

    plan: Plan
    site_model: SiteModel
    finding: Finding


class MissionController(QObject):
    """Works on the current plan of the document.

    Signals
    -------
    checked(Preflight)
        A check ended; it may be of a plan that has changed since.
    compared(MissionComparison, str)
        With the names of the files.
    proved(Proved)
        An independent check ended; it may be of a plan that has changed since.
    """

    checked = Signal(object)
    compared = Signal(object, str)
    proved = Signal(object)

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._check_id = self._proof_id = 0
        self._day = UNKNOWN_DAY
        context.documentChanged.connect(self._document_changed)

    @property
    def day(self) -> FlightDay:
        """What is known of the day of the flight."""
        return self._day

    def set_day(self, day: FlightDay) -> None:
        """The flight is on this day: plans and checks keep out of the geo-zones that apply then."""
        self._day = day
        self._show_zones_of_day()

    def _document_changed(self, _before: Document, _after: Document) -> None:
        # Listeners of this very change come first.
        QTimer.singleShot(0, self, self._show_zones_of_day)

    def _show_zones_of_day(self) -> None:
        document = self._context.document
        if document.site is not None and document.site.site.zones:
            timed = at_time(document.site, self._day.at, PLANNED_WITHIN_S)
            if timed.zones_at != document.site.zones_at:
                self._context.amend(replace(document, site=timed))

    @property
    def plan(self) -> Plan | None:
        """The current plan, where there is a site to fly it on."""
        document = self._context.document
        return None if document.site is None or document.current is None else document.current.plan

    @property
    def can_check(self) -> bool:
        """Whether there is a plan, and panels that it is to photograph: a bare site has none."""
        site_model = self._context.document.site
        return self.plan is not None and site_model is not None and site_model.site.n_panels > 0

    @property
    def is_checking(self) -> bool:
        """Whether a check runs or waits."""
        return any(job.id == self._check_id for job in self._context.jobs())

    def check(self) -> None:
        """Check the current plan; one check at a time."""
        plan, site_model, day = self.plan, self._context.document.site, self.day
        if plan is None or site_model is None or not self.can_check or self.is_checking:
            return

        def work(context: JobContext) -> Preflight:
            found = context.run_in_process(preflight, plan, site_model, day)
            return replace(found, plan=plan, site_model=site_model)

        self._check_id = self._context.start(self.tr("Check"), work, self.checked.emit).id

    def check_and_prove(self) -> None:
        """Check the current plan, and prove it: what takes longer, and is done where it is asked for."""
        self.check()
        self.prove()

    def prove(self) -> None:
        """Make the proof of the current plan and have the independent verifier judge it; one at a time."""
        plan, site_model = self.plan, self._context.document.site
        if plan is None or site_model is None or not self.can_check or self.is_proving:
            return

        def work(context: JobContext) -> Proved:
            from groundstation.services.mission.proof import proved_as_saved

            return Proved(plan, site_model, context.run_in_process(proved_as_saved, plan, site_model))

        self._proof_id = self._context.start(self.tr("Proof"), work, self.proved.emit).id

    @property
    def is_proving(self) -> bool:
        """Whether a proof is made or waits."""
        return any(job.id == self._proof_id for job in self._context.jobs())

    def import_files(self, paths: Sequence[Path]) -> None:
        """Take mission files of one flight over as a plan of the project; without a site they get a bare one."""
        document = self._context.document
        site_model, request, paths = document.site, document.request, tuple(paths)
        if not paths:
            return
        name = paths[0].stem

        def work(context: JobContext) -> tuple[SiteModel | None, Plan, tuple[Finding, ...]]:
            wanted = request.profile_id, request.constraints, context
            if site_model is not None:
                return None, *missions_as_plan(paths, site_model, *wanted)
            read = read_mission_files(paths)
            bare, on_site = bare_site(read)
            plan, findings = plan_of_missions(read, bare, *wanted)
            return bare, plan, (*on_site, *findings)

        def done(result: tuple[SiteModel | None, Plan, tuple[Finding, ...]]) -> None:
            bare, plan, findings = result
            now = self._context.document
            if now.site is not site_model:
                self._context.say(
                    Severity.WARNING, self.tr("{0} was read for a site that has changed; import again").format(name)
                )
                return
            if bare is not None:
                now = with_new_site(now, bare)
            entry = PlanEntry(now.free_plan_id(), name, plan)
            self._context.change(self.tr("Import {0}").format(name), now.with_plan(entry))
            self._context.say(
                Severity.OK,
                self.tr("{0} imported, photos: {1}, sorties: {2}").format(
                    name, len(plan.viewpoints), len(plan.sorties)
                ),
            )
            self._say_findings(name, findings)

        self._context.start(self.tr("Import mission"), work, done)

    def compare_files(self, paths: Sequence[Path]) -> None:
        """Read mission files back and compare them with the current plan."""
        plan, site_model, paths = self.plan, self._context.document.site, tuple(paths)
        if plan is None or site_model is None or not paths:
            return
        site = site_model.site
        names = ", ".join(path.name for path in paths)

        def work(_context: JobContext) -> MissionComparison:
            return compare_with_plan(read_mission_files(paths), plan, site.origin, site.home_enu_m)

        def done(comparison: MissionComparison) -> None:
            self.compared.emit(comparison, names)
            self._say_findings(names, comparison.findings)

        self._context.start(self.tr("Compare"), work, done)

    def _say_findings(self, names: str, findings: Sequence[Finding]) -> None:
        """Say what there is to say of the files of these names; what holds of several sorties once."""
        self._context.withdraw("plan.file.")
        by_message = {found.message: found for found in reversed(findings) if found.severity is not Severity.OK}
        for found in list(reversed(by_message.values()))[:MAX_SHOWN_FINDINGS]:
            item = item_of_place(found.place, self._context.document)
            self._context.say(
                found.severity,
                self.tr("{0}: {1}").format(names, self._context.localized(found.message)),
                item,
                f"plan.file.{found.message}",
            )
        if len(by_message) > MAX_SHOWN_FINDINGS:
            self._context.say(
                Severity.NOTE, self.tr("{0} more findings like these").format(len(by_message) - MAX_SHOWN_FINDINGS)
            )
