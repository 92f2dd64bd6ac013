"""What the Fly tab does: connect, ask, follow, and plan what comes after. It belongs to the workspace, not to a window.

Events of a flight come from its thread as Qt signals, in the window's thread; nothing here waits for the link.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.fly.active_flight import ActiveFlight
from groundstation.gui.fly.after_flight import AfterFlight
from groundstation.gui.fly.signing_controller import SigningController
from groundstation.gui.fly.simulation_controller import SimulationController
from groundstation.services.fly.connection import Connection, VehicleAt, flights_folder
from groundstation.services.fly.events import (
    Answered,
    FlightChanged,
    FlightEnded,
    LinkChanged,
    LinkProblem,
    LinkState,
    LiveEvent,
    LiveView,
    LogProblem,
    PhotoCounted,
    Request,
    WarningCleared,
    WarningRaised,
)
from groundstation.services.fly.flight import LiveFlight
from groundstation.services.fly.options import (
    ConnectionChoice,
    FlightSettings,
    LinkKind,
    choice_path,
    flight_settings_path,
    read_choice,
    read_flight_settings,
)
from groundstation.services.fly.readouts import BEFORE_TAKE_OFF
from groundstation.services.fly.signing import link_signer
from groundstation.services.fly.sortie import LiveSortie, prepare_sortie
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.readiness import TooLong, shared_out, too_long
from groundstation.services.project.document import PlanEntry
from groundstation.services.settings import write_kept
from groundstation.services.site.edits import move_home
from groundstation.vehicle.preflight import stands_enu_m
from groundstation.vehicle.setup import ParameterChange
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.checks.case import Case
from planning.plan import Plan

# Plans with more photos in a sortie than the autopilot keeps items for: found, and shared out anew as a plan.


class ItemLimit(QObject):
    """Works on the current plan of the document."""

    def __init__(self, workspace: ApplicationContext, parent: QObject) -> None:
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


BEFORE_FLIGHT = (Request.UPLOAD, Request.START)

CLOSE_S = 5.0
"""Longest wait for a flight's thread when the window closes; it notices within a twentieth of a second."""


class FlyController(QObject):
    """One vehicle at a time.

    Signals
    -------
    stateChanged()
        Connected, disconnected, or another sortie.
    viewChanged(LiveView), photoCounted(PhotoCounted), linkChanged(LinkState), flightEnded(FlightEnded)
        As the flight publishes them.
    noted(object, Severity, str)
        Something to be remembered: how long after take-off (None on the ground), how severe, and the text.
    """

    stateChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    viewChanged = Signal(object)  # noqa: N815
    photoCounted = Signal(object)  # noqa: N815
    linkChanged = Signal(object)  # noqa: N815
    flightEnded = Signal(object)  # noqa: N815
    noted = Signal(object, object, str)
    _published = Signal(int, object)

    def __init__(self, workspace: ApplicationContext) -> None:
        super().__init__(workspace)
        self._workspace = workspace
        self._flight: LiveFlight | None = None
        self._ids = itertools.count(1)
        self._flight_id = 0
        self._case: Case | None = None
        self._preparing_id = 0
        self.choice = read_choice(choice_path(), self._say_soon)
        self.settings = read_flight_settings(flight_settings_path(), self._say_soon)
        self.simulation, self.limit = SimulationController(workspace, self), ItemLimit(workspace, self)
        self.number = 1
        self.in_hand: ActiveFlight | None = None
        self.after, self.signing = AfterFlight(workspace, self), SigningController(workspace, self)
        self._published.connect(self._take)
        workspace.count_as_busy(lambda: self.is_in_flight)

    @classmethod
    def of(cls, workspace: ApplicationContext) -> FlyController:
        """The controller of a workspace: windows come and go, the flight goes on."""
        known = workspace.findChild(cls)
        return cls(workspace) if known is None else known

    # What there is

    @property
    def plan(self) -> Plan | None:
        """The current plan, where there is a site to fly it on."""
        document = self._workspace.document
        return None if document.site is None or document.current is None else document.current.plan

    @property
    def is_connected(self) -> bool:
        """Whether a link is open, or being opened."""
        return self._flight is not None

    @property
    def is_for_shown_plan(self) -> bool:
        """Whether the connection was made for the plan that is shown; only that one may be uploaded and started."""
        return self.in_hand is not None and self.in_hand.sortie.case.plan is self.plan

    @property
    def is_preparing(self) -> bool:
        """Whether a connection is about to be made."""
        return self._runs(self._preparing_id)

    @property
    def is_in_flight(self) -> bool:
        """Whether an aircraft is in the air, as far as is known."""
        return self._flight is not None and self._flight.is_in_flight

    # Connecting

    def set_choice(self, choice: ConnectionChoice) -> None:
        """Connect in another way the next time; kept for the next start of the program too."""
        self.choice = choice
        self._keep(choice_path(), choice)

    def set_settings(self, settings: FlightSettings) -> None:
        """The pilot decided otherwise; kept for the next start of the program too."""
        self.settings = settings
        self._keep(flight_settings_path(), settings)
        if self._flight is not None:
            self._flight.set_settings(settings)

    def share_out(self, found: TooLong) -> None:
        """Share the views out among sorties that fit, and connect for that plan."""
        if not self.is_preparing:
            self._preparing_id = self.limit.share_out(found, self.connect_vehicle)
            self.stateChanged.emit()

    def parameter_changes(self) -> tuple[ParameterChange, ...]:
        """What differs on the vehicle from what the plan needs."""
        in_hand = self.in_hand
        return () if in_hand is None or in_hand.view is None else in_hand.view.on_board.changes or ()

    def set_parameters(self, changes: tuple[ParameterChange, ...]) -> None:
        """The pilot agrees that these are set."""
        if self._flight is not None:
            self._flight.set_parameters(changes)

    def overrule(self, code: str) -> None:
        """The pilot overrules a check before take-off, until the next upload."""
        if self._flight is not None:
            self._flight.overrule(code)

    def raise_flight(self, by_m: float) -> None:
        """Fly the same places from a take-off that lies so much lower; to be uploaded again."""
        in_hand = self.in_hand
        if self._flight is not None and in_hand is not None and self.is_for_shown_plan:
            self._prepare(self._take_on, in_hand.sortie.orders.raised_m + by_m)

    def plan_from_here(self) -> None:
        """Make the place where the aircraft stands the site's home."""
        in_hand, document = self.in_hand, self._workspace.document
        if in_hand is None or in_hand.view is None or document.site is None:
            return
        place = stands_enu_m(in_hand.view.state, in_hand.sortie.orders)
        if place is None:
            return
        try:
            model = move_home(document.site, place)
        except InputError as error:
            self._say(Severity.ERROR, str(error))
            return
        self._workspace.change(self.tr("Home to the aircraft"), replace(document, site=model))
        self._workspace.say(Severity.NOTE, self.tr("Home is where the aircraft stands: plan again, then connect anew."))

    def set_sortie(self, number: int) -> None:
        """Fly another sortie of the plan, from 1; connected, it becomes the next one."""
        self.number = number
        if self._flight is not None and self.is_for_shown_plan:
            self._prepare(self._take_on)
        self.stateChanged.emit()

    def connect_vehicle(self) -> None:
        """Prepare the sortie, then open the link."""
        if self._flight is None:
            self._prepare(self._connect)

    def disconnect_vehicle(self) -> None:
        """Close the link; the aircraft goes on by itself."""
        self.request(Request.DISCONNECT)

    def request(self, request: Request) -> None:
        """Ask the flight for something."""
        if self._flight is not None and (self.is_for_shown_plan or request not in BEFORE_FLIGHT):
            self._flight.request(request)

    def close(self) -> None:
        """End the flight's thread; what was flown is kept."""
        flight, self._flight = self._flight, None
        self._flight_id = 0
        if flight is not None:
            flight.close(CLOSE_S)

    def _keep(self, path: Path, record: object) -> None:
        try:
            write_kept(path, record)
        except InputError as error:
            self._say(Severity.WARNING, str(error))

    def _say_soon(self, text: str) -> None:
        """Say it once there is a window that can show it."""
        QTimer.singleShot(0, self, lambda: self._say(Severity.WARNING, text))

    def _prepare(self, then: Callable[[LiveSortie], None], raised_m: float = 0.0) -> None:
        plan, site_model, number, known = self.plan, self._workspace.document.site, self.number, self._case
        if plan is None or site_model is None or self.is_preparing:
            return

        def work(context: JobContext) -> LiveSortie:
            return prepare_sortie(plan, site_model, number, known, raised_m, context)

        def done(sortie: LiveSortie) -> None:
            self._case = sortie.case
            then(sortie)
            self.stateChanged.emit()

        self._preparing_id = self._workspace.start(self.tr("Prepare the flight"), work, done).id
        self.stateChanged.emit()

    def _runs(self, job_id: int) -> bool:
        return any(job.id == job_id for job in self._workspace.jobs())

    def _take_on(self, sortie: LiveSortie) -> None:
        in_hand = self.in_hand
        is_free = in_hand is not None and in_hand.view is not None and in_hand.view.phase in BEFORE_TAKE_OFF
        if self._flight is not None and is_free and not self.is_in_flight and self.is_for_shown_plan:
            self._flight.take_on(sortie)
            self.in_hand = ActiveFlight(sortie)

    def _connect(self, sortie: LiveSortie) -> None:
        if self._flight is not None:
            return
        plan = sortie.case.plan
        charge = self.after.charge(plan, sortie.orders.number)
        self._flight_id = flight_id = next(self._ids)
        for topic in ("link", "flight."):
            self._workspace.settle(topic)
        self.in_hand = ActiveFlight(sortie)
        self._flight = LiveFlight(
            sortie,
            self._connection(sortie, charge),
            lambda event: self._published.emit(flight_id, event),
            flights_folder(self._workspace.session.folder),
            flown=self.after.flown(plan),
            settings=self.settings,
        )
        self._flight.start()
        self._note(Severity.NOTE, self.tr("connecting"))
        if charge < 1.0 and self.choice.kind is LinkKind.SIMULATION:
            text = self.tr("simulated battery: {0:.0%}, as the flight before left it").format(charge)
            self._note(Severity.NOTE, text)

    def _connection(self, sortie: LiveSortie, charge: float) -> Connection:
        choice = self.choice
        if choice.kind is LinkKind.SIMULATION:
            return self.simulation.connection(sortie, choice, charge)
        return VehicleAt(choice.url, signer=cache(link_signer) if choice.is_signed else None)

    # Events

    def _take(self, flight_id: int, event: LiveEvent) -> None:
        in_hand = self.in_hand
        if flight_id != self._flight_id or in_hand is None:
            return
        match event:
            case FlightChanged():
                self._take_view(in_hand, event.view)
            case PhotoCounted():
                in_hand.take_photo(event)
                self.photoCounted.emit(event)
            case LinkChanged():
                self._take_link(in_hand, event)
            case Answered():
                self._note(Severity.OK if event.is_accepted else Severity.ERROR, self._words(event.text))
                if event.is_accepted:
                    self._workspace.settle("order")
                else:
                    self._say(Severity.ERROR, event.text, "order")
            case WarningRaised():
                self._note(event.warning.severity, self._words(event.warning.text))
                self._say(event.warning.severity, event.warning.text, f"flight.warning.{event.warning.code}")
            case WarningCleared():
                self._workspace.settle(f"flight.warning.{event.code}")
            case LinkProblem():
                in_hand.link_problem = event.text
                self._note(Severity.ERROR, self._words(event.text))
                self._say(Severity.ERROR, event.text, "link")
                self.stateChanged.emit()
            case LogProblem():
                self._note(Severity.WARNING, self._words(event.text))
                self._say(Severity.WARNING, event.text, "flight.log")
            case FlightEnded():
                self._take_end(in_hand, event)

    def _take_view(self, in_hand: ActiveFlight, view: LiveView) -> None:
        for text in in_hand.take_view(view):
            severity = (
                Severity.ERROR if text.severity <= 3 else Severity.WARNING if text.severity == 4 else Severity.NOTE
            )
            self._note(severity, self.tr("autopilot: {0}").format(text.text))
        self.viewChanged.emit(view)

    def _take_link(self, in_hand: ActiveFlight, event: LinkChanged) -> None:
        before, in_hand.link = in_hand.link, event.link
        text = self._words(event.text)
        if event.link is LinkState.LOST:
            self._note(Severity.ERROR, self.tr("link lost") if not text else self.tr("link lost: {0}").format(text))
        elif event.link is LinkState.ALIVE:
            self._workspace.settle("link")
            self._note(
                Severity.OK, self.tr("link alive") if before is not LinkState.LOST else self.tr("link found again")
            )
        elif event.link is LinkState.CLOSED:
            self._note(Severity.NOTE, self.tr("disconnected"))
            for topic in ("order", "flight.warning.", "flight.log"):
                self._workspace.settle(topic)
            if text:
                self._say(Severity.ERROR, event.text, "link")
            self._flight = None
            self.stateChanged.emit()
        self.linkChanged.emit(event.link)

    def _take_end(self, in_hand: ActiveFlight, event: FlightEnded) -> None:
        in_hand.ended = event
        if event.record is not None:
            case = in_hand.sortie.case
            self.after.add(case.plan, case.site_model, event.record, in_hand.battery)
        if event.error is not None:
            self._note(Severity.ERROR, self._words(str(event.error)))
            self._say(Severity.ERROR, str(event.error), "flight.ended")
        else:
            self._note(Severity.OK, self.tr("landed"))
        if event.problem:
            self._say(Severity.WARNING, event.problem, "flight.kept")
        in_hand.took_off_s = None
        self.flightEnded.emit(event)

    def _note(self, severity: Severity, text: str) -> None:
        in_hand = self.in_hand
        view = None if in_hand is None else in_hand.view
        when = None if in_hand is None or view is None else in_hand.since_take_off_s(view)
        if in_hand is not None:
            in_hand.notes.append((when, severity, text))
        self.noted.emit(when, severity, text)

    def _say(self, severity: Severity, text: str, about: str = "") -> None:
        self._workspace.say(severity, self._words(text), about=about)

    def _words(self, text: str) -> str:
        words: str = self._workspace.words(text)
        return words
