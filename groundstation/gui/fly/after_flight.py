"""What comes after a flight: plans for what was missed, for the rest of a sortie, and for fewer photos in each.

Also the log book: flights of this project or of this user, cycles of batteries, and the table for spreadsheets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QDateTime, QLocale, QObject, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.questions import choose_new_file
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.fly.connection import flights_folder
from groundstation.services.fly.log_book import (
    BookEntry,
    battery_uses,
    book_path,
    read_book,
    write_book_csv,
)
from groundstation.services.fly.options import (
    ConnectionChoice,
    LinkKind,
)
from groundstation.services.fly.sortie import is_same_place
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.readiness import TooLong, split_to_fit, too_long
from groundstation.services.plan.top_up import flown_plan, resume_flight, top_up_flight
from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.steps import Flown, flown_records
from groundstation.services.units import minutes_text
from missions.flight.flight_file import flight_of
from missions.flight.outcome import FlightReport
from missions.flight.record import FlightRecord
from missions.mavlink.autopilots import Autopilot
from missions.mission.resume import Resumed
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.plan import Plan
from planning.revision.top_up import TopUp, TopUpRequest
from planning.site.records import SiteModel

UNKNOWN = "-"


class LogBookDialog(QDialog):
    """Shows the book; writes it as a table."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Log book"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._context = context
        self._entries: tuple[BookEntry, ...] = ()
        self.every, self.simulated = QCheckBox(self.tr("Flights of all projects")), QCheckBox(self.tr("Simulated, too"))
        self._model: RowModel[BookEntry] = RowModel(self._columns(), self)
        self.table = table_of(self._model, self.tr("Flights"))
        self._batteries, self._state = QLabel(), QLabel()
        self.export = QPushButton(self.tr("Export as CSV ..."))
        close = QPushButton(self.tr("Close"))
        for label in (self._batteries, self._state):
            label.setWordWrap(True)
        head, foot = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self.every)
        head.addWidget(self.simulated)
        head.addStretch(1)
        foot.addWidget(self._state, 1)
        foot.addWidget(close)
        foot.addWidget(self.export)
        layout = QVBoxLayout(self)
        layout.addLayout(head)
        layout.addWidget(self.table, 1)
        layout.addWidget(self._batteries)
        layout.addLayout(foot)
        self.resize(860, 460)
        has_project = context.session.folder is not None
        self.every.setChecked(not has_project)
        self.every.setEnabled(has_project)
        self.every.toggled.connect(lambda _is_on: self._read())
        self.simulated.toggled.connect(lambda _is_on: self._show())
        self.export.clicked.connect(self._choose_file)
        close.clicked.connect(self.reject)
        self._read()

    def batteries_text(self) -> str:
        """What is said of the batteries."""
        return self._batteries.text()

    def state_text(self) -> str:
        """What is said of the book."""
        return self._state.text()

    def shown_entries(self) -> tuple[BookEntry, ...]:
        """Flights that are shown."""
        return tuple(each for each in self._entries if self.simulated.isChecked() or not each.is_simulated)

    def write(self, path: Path) -> None:
        """Write what is shown as a table."""
        try:
            write_book_csv(path, self.shown_entries())
        except InputError as error:
            self._state.setText(self._context.localized(str(error)))
            return
        self._state.setText(self.tr("Written: {0}").format(path))
        self._context.say(Severity.OK, self.tr("Written: {0}").format(path))

    def _read(self) -> None:
        folder = self._context.session.folder
        path = book_path(None if self.every.isChecked() or folder is None else flights_folder(folder))
        try:
            self._entries = read_book(path)
            self._state.setText("")
        except InputError as error:
            self._entries = ()
            self._state.setText(self._context.localized(str(error)))
        self._show()

    def _show(self) -> None:
        shown = self.shown_entries()
        self._model.set_rows(tuple(reversed(shown)))
        self.table.resizeColumnsToContents()
        self.export.setEnabled(bool(shown))
        uses = battery_uses(self._entries)
        self._batteries.setText(
            "\n".join(
                self.tr("Battery {0}: flights: {1}, cycles: {2:.1f}").format(use.name, use.n_flights, use.cycles)
                for use in uses
            )
        )
        n_hidden = len(self._entries) - len(shown)
        if n_hidden and not shown:
            self._state.setText(self.tr("No flights yet; simulated ones: {0}").format(n_hidden))

    def _choose_file(self) -> None:
        folder = self._context.session.folder or Path.home()
        kinds = self.tr("Tables (*{0})").format(".csv")
        path = choose_new_file(self, self.tr("Write the log book"), folder / "log-book.csv", kinds, ".csv")
        if path is not None:
            self.write(path)

    def _columns(self) -> tuple[Column[BookEntry], ...]:
        def when(entry: BookEntry) -> str:
            moment = QDateTime.fromSecsSinceEpoch(round(entry.started_unix_s))
            return str(QLocale().toString(moment, QLocale.FormatType.ShortFormat))

        return (
            Column(self.tr("Start"), when),
            Column(self.tr("Time"), lambda row: minutes_text(row.duration_s), is_number=True),
            Column(self.tr("Site"), lambda row: row.site),
            Column(self.tr("Aircraft"), lambda row: row.aircraft),
            Column(self.tr("Battery"), lambda row: row.battery or UNKNOWN),
            Column(
                self.tr("Charge used"),
                lambda row: UNKNOWN if row.battery_used is None else f"{row.battery_used:.0%}",
                is_number=True,
            ),
            Column(self.tr("Photos"), lambda row: f"{row.n_photos}/{row.n_planned}", is_number=True),
            Column(self.tr("Findings"), lambda row: str(len(row.findings)), is_number=True),
            Column(self.tr("Ended"), lambda row: self._context.localized(row.ended) or self.tr("landed")),
        )


# What comes after a flight, as new plans: a top-up for what it missed, or the rest of an interrupted sortie.

MOST_BATTERIES = 20
"""Full batteries that a top-up may take at most; more than anybody has with them."""


class AfterFlight(QObject):
    """Keeps what was flown of each plan, and plans what is left, as jobs.

    Signals
    -------
    restFound(TopUp)
        So little is missing that a flight for it wants a decision; `take` makes it a plan.
    """

    restFound = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context
        self._flown: dict[int, tuple[Plan, tuple[FlightRecord, ...]]] = {}
        self._reported: dict[int, tuple[Plan, Flown]] = {}
        self._last: tuple[Plan, SiteModel] | None = None
        self._topped_up: Plan | None = None
        self._battery: float | None = None
        self._on_board: tuple[Plan, float] | None = None

    def flown(self, plan: Plan) -> tuple[FlightRecord, ...]:
        """What was flown of a plan since the program was started."""
        _, records = self._flown.get(id(plan), (plan, ()))
        return records

    def add(self, plan: Plan, site_model: SiteModel, record: FlightRecord, battery: float | None) -> None:
        """A sortie of a plan was flown over a site; `battery` is what it left of the charge, 1 full."""
        self._flown[id(plan)] = (plan, (*self.flown(plan), record))
        self._last, self._battery = (plan, site_model), battery
        self._on_board = None

    def take_report(self, plan: Plan, report: FlightReport) -> None:
        """A report on all that was flown of a plan since the program was started."""
        shown, known = self._context.document.current, self._reported.get(id(plan))
        flown = None if known is None else known[1]
        if flown is None and shown is not None and shown.plan is plan:
            flown = self._context.milestones.flown  # on other days
        self._take_flown(plan, (flown or Flown({})).also(report))

    def tell_flown(self) -> None:
        """Note what was flown of the plan that is shown."""
        shown = self._context.document.current
        known = None if shown is None else self._reported.get(id(shown.plan))
        if known is not None:
            self._context.note(flown=known[1])

    def leave_rest(self) -> None:
        """What the last top-up found missing is not worth a flight."""
        plan, shown = self._topped_up, self._context.document.current
        if plan is not None and shown is not None and shown.plan is plan and self._context.milestones.flown is not None:
            self._take_flown(plan, replace(self._context.milestones.flown, is_enough=True))

    def _take_flown(self, plan: Plan, flown: Flown) -> None:
        self._reported[id(plan)] = plan, flown
        self.tell_flown()

    def correct(self, plan: Plan, number: int, record: FlightRecord) -> None:
        """A sortie, from 1, as the vehicle's own log tells its last flight: what the link lost is in it."""
        known = self.flown(plan)
        last = max((n for n, each in enumerate(known) if each.sortie == number), default=None)
        if last is not None:
            told = replace(record, sortie=number, vehicle=known[last].vehicle)
            self._flown[id(plan)] = (plan, (*known[:last], told, *known[last + 1 :]))

    def charge(self, plan: Plan, number: int) -> float:
        """Charge of the battery that a sortie, from 1, begins with, 1 full: of a top-up, what the flight before left.

        Further sorties, other plans, and a top-up that is flown again have a full one.
        """
        if self._on_board is None or number != 1:
            return 1.0
        top_up, battery = self._on_board
        return battery if top_up is plan else 1.0

    def top_up(self) -> None:
        """Plan the shortest flight that closes what is missing, with the battery that is left, as a new plan."""
        flown = self._flown_here()
        if flown is None:
            return
        plan, site_model, read = flown
        self._topped_up, battery = plan, self._battery
        # Full ones come into it where the one on board does not suffice.
        request = TopUpRequest(battery=battery, n_batteries=None if battery is None else MOST_BATTERIES)

        def work(context: JobContext) -> tuple[TopUp, tuple[Finding, ...]]:
            found = flown_plan(flight_of(plan, site_model, read()), plan, site_model)
            return top_up_flight(found, request, monitor=context)

        def done(result: tuple[TopUp, tuple[Finding, ...]]) -> None:
            found, findings = result
            for finding in findings:
                self._context.say(finding.severity, self._context.localized(finding.message))
            if found.wanted == 0:
                self._context.say(Severity.OK, self.tr("Nothing is missing: the photos show all that was planned."))
                self.leave_rest()
            elif found.plan is None:
                self.leave_rest()  # why is among the findings
            elif found.is_negligible:
                self.restFound.emit(found)
            else:
                self.take(found)

        self._context.start(self.tr("Top-up flight"), work, done)

    def take(self, found: TopUp) -> None:
        """Make a top-up a plan of the project."""
        if found.plan is None:
            return
        battery = self._battery
        text = self.tr("Top-up planned, photos: {0}; it closes {1} of {2} missing sections").format(
            len(found.plan.viewpoints), found.closed, found.wanted
        )
        on_board = found.on_board and battery is not None
        needed = (
            self.tr("Fly it before the battery is changed.")
            if on_board and len(found.plan.sorties) == 1
            else self.tr("Fly the first sortie before the battery is changed, the others with full ones.")
            if on_board
            else self.tr("It needs a full battery: change it first.")
        )
        self._add_plan(self.tr("Top-up"), found.plan, self.tr("{0}. {1}").format(text, needed))
        self._on_board = (found.plan, battery) if on_board and battery is not None else None

    def resume_sortie(self) -> None:
        """Plan the rest of the sortie that was interrupted, for a full battery, as a new plan."""
        flown = self._flown_here()
        if flown is None:
            return
        plan, site_model, read = flown

        def work(context: JobContext) -> Resumed:
            found = flown_plan(flight_of(plan, site_model, read()), plan, site_model)
            return resume_flight(found, monitor=context)

        def done(rest: Resumed) -> None:
            text = self.tr("Rest of sortie {0} planned, photos: {1}. It needs a full battery: change it first.").format(
                rest.mission.number, len(rest.plan.viewpoints)
            )
            self._add_plan(self.tr("Rest of sortie {0}").format(rest.mission.number), rest.plan, text)

        self._context.start(self.tr("Resume sortie"), work, done)

    def _flown_here(self) -> tuple[Plan, SiteModel, Callable[[], tuple[FlightRecord, ...]]] | None:
        """The plan that is shown, where it was flown, else that flown last; the site as it is now; what reads the rest.

        What was flown on other days is in the project's files.
        """
        document, folder = self._context.document, self._context.session.folder
        site_model, entry = document.site, document.current
        if site_model is None:
            return None
        if entry is not None and self._context.milestones.flown is not None:
            shown, known = entry.plan, self.flown(entry.plan)
            if known:
                return shown, site_model, lambda: known
            if folder is not None:
                return shown, site_model, lambda: flown_records(folder, shown)
        if self._last is None:
            return None
        plan, flown_over = self._last
        if not is_same_place(flown_over.site, site_model.site):
            text = self.tr("This flight was over the site {0}: open its project first.").format(flown_over.site.name)
            self._context.say(Severity.WARNING, text)
            return None
        return plan, site_model, lambda: self.flown(plan)

    def _add_plan(self, title: str, plan: Plan, text: str) -> None:
        document: Document = self._context.document
        entry = PlanEntry(document.free_plan_id(), title, plan)
        self._context.change(title, document.with_plan(entry))
        self._context.say(Severity.OK, text)


# Plans with more photos in a sortie than the autopilot keeps items for: found, and shared out anew as a plan.


class ItemLimit(QObject):
    """Works on the current plan of the document."""

    def __init__(self, context: ApplicationContext, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context

    def exceeded(self, choice: ConnectionChoice) -> TooLong | None:
        """Whether a sortie has more photos than the autopilot, or any that may answer at a link, has room for."""
        entry = self._context.document.current
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
        site_model, entry = self._context.document.site, self._context.document.current
        if site_model is None or entry is None:
            return 0

        def work(context: JobContext) -> Plan:
            return split_to_fit(entry.plan, site_model, found, context)

        def done(anew: Plan) -> None:
            document = self._context.document
            if document.site is not site_model:
                return
            title = self.tr("{0}, shared out").format(entry.title)
            added = document.with_plan(PlanEntry(document.free_plan_id(), title, anew))
            self._context.change(self.tr("Share views out"), added)
            text = self.tr("Views shared out anew, sorties: {0}").format(len(anew.sorties))
            self._context.say(Severity.OK, text)
            then()

        job_id: int = self._context.start(self.tr("Share views out"), work, done).id
        return job_id
