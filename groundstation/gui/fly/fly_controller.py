"""What the Fly tab does: connect, ask, follow, and plan what comes after. It belongs to the application, not a window.

Events of a flight come from its thread as Qt signals, in the window's thread; nothing here waits for the link.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.fly.signing_controller import SigningController
from groundstation.gui.fly.simulation_controller import SimulationController
from groundstation.services.fly.connection import Connection, VehicleAt, flights_folder
from groundstation.services.fly.corrections import Corrections
from groundstation.services.fly.events import (
    Answered,
    FlightChanged,
    FlightEnded,
    LinkChanged,
    LinkProblem,
    LinkState,
    LiveEvent,
    LiveView,
    LogFetched,
    LogProblem,
    PhotoCounted,
    Request,
    WarningCleared,
    WarningRaised,
)
from groundstation.services.fly.flight import LiveFlight
from groundstation.services.fly.flying import report_of_log
from groundstation.services.fly.joystick import JoystickButtons, joystick_path, read_joystick_buttons
from groundstation.services.fly.options import (
    ConnectionChoice,
    FlightSettings,
    LinkKind,
    choice_path,
    flight_settings_path,
    read_choice,
    read_flight_settings,
)
from groundstation.services.fly.readouts import BEFORE_TAKE_OFF, flight_state
from groundstation.services.fly.signing import link_signer
from groundstation.services.fly.sortie import LiveSortie, is_same_place, prepare_sortie
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.readiness import TooLong, split_to_fit, too_long
from groundstation.services.plan.top_up import flown_plan, resume_flight, top_up_flight
from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.steps import FlightState
from groundstation.services.settings import write_preferences
from groundstation.services.site.edits import move_home
from groundstation.vehicle.preflight import stands_enu_m
from groundstation.vehicle.setup import ParameterChange
from groundstation.vehicle.state import VehicleText
from missions.flight.flight_file import flight_of
from missions.flight.record import FlightRecord
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.ntrip import caster_of
from missions.mission.resume import Resumed
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.checks.case import Case
from planning.geo.frames import Vec3
from planning.plan import Plan
from planning.revision.top_up import TopUp, TopUpRequest
from planning.site.records import SiteModel

# What is known of the flight that is shown, also after it ended.


@dataclass(slots=True)
class ActiveFlight:
    """Grows as the flight tells.

    Parameters
    ----------
    track_enu_m
        Where the aircraft was, ten times a second at most.
    link_problem
        Why both ends of an open link do not understand each other; empty where nothing shows it.
    photos
        By the view that they are of.
    notes
        What happened: how long after take-off (None on the ground), how severe, and the text.
    took_off_s
        When the motors started, by the vehicle's own clock; None on the ground.
    """

    sortie: LiveSortie
    view: LiveView | None = None
    link: LinkState = LinkState.OPENING
    link_problem: str = ""
    track_enu_m: list[Vec3] = field(default_factory=list)
    photos: dict[str, PhotoCounted] = field(default_factory=dict)
    counted: PhotoCounted | None = None
    ended: FlightEnded | None = None
    notes: list[tuple[float | None, Severity, str]] = field(default_factory=list)
    last_text_s: float = -math.inf
    battery: float | None = None
    took_off_s: float | None = None

    def take_view(self, view: LiveView) -> tuple[VehicleText, ...]:
        """The flight as it stands now; returns the autopilot's texts that are new."""
        self.view = view
        state = view.state
        if self.took_off_s is None and state.is_armed:
            self.took_off_s = state.boot_time_s
        if state.motion is not None and view.link is LinkState.ALIVE:
            place = state.motion.value.position_enu_m
            if not self.track_enu_m or self.track_enu_m[-1] != place:
                self.track_enu_m.append(place)
        if view.readouts.battery is not None:
            self.battery = view.readouts.battery
        # Those that a state keeps are the last ones of all.
        texts = tuple(text for text in state.texts if text.time_s > self.last_text_s)
        if texts:
            self.last_text_s = texts[-1].time_s
        return texts

    def since_take_off_s(self, view: LiveView) -> float | None:
        """How long the motors have been running, as plans and reports count; None on the ground."""
        now_s = view.state.boot_time_s
        return None if self.took_off_s is None or now_s is None else max(0.0, now_s - self.took_off_s)

    def take_photo(self, counted: PhotoCounted) -> None:
        """A photo was taken."""
        self.counted = counted
        if counted.view_id:
            self.photos[counted.view_id] = counted


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
        self._last: tuple[Plan, SiteModel] | None = None
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

    def correct(self, plan: Plan, record: FlightRecord) -> None:
        """The sortie that was flown last, as the vehicle's own log tells it: what the link lost is in it."""
        known = self.flown(plan)
        if known:
            told = replace(record, sortie=known[-1].sortie, vehicle=known[-1].vehicle)
            self._flown[id(plan)] = (plan, (*known[:-1], told))

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
        plan, site_model, records = flown
        battery = self._battery
        # Full ones come into it where the one on board does not suffice.
        request = TopUpRequest(battery=battery, n_batteries=None if battery is None else MOST_BATTERIES)

        def work(context: JobContext) -> tuple[TopUp, tuple[Finding, ...]]:
            found = flown_plan(flight_of(plan, site_model, records), plan, site_model)
            return top_up_flight(found, request, monitor=context)

        def done(result: tuple[TopUp, tuple[Finding, ...]]) -> None:
            found, findings = result
            for finding in findings:
                self._context.say(finding.severity, self._context.localized(finding.message))
            if found.wanted == 0:
                self._context.say(Severity.OK, self.tr("Nothing is missing: the photos show all that was planned."))
            elif found.is_negligible and found.plan is not None:
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
        plan, site_model, records = flown

        def work(context: JobContext) -> Resumed:
            found = flown_plan(flight_of(plan, site_model, records), plan, site_model)
            return resume_flight(found, monitor=context)

        def done(rest: Resumed) -> None:
            text = self.tr("Rest of sortie {0} planned, photos: {1}. It needs a full battery: change it first.").format(
                rest.mission.number, len(rest.plan.viewpoints)
            )
            self._add_plan(self.tr("Rest of sortie {0}").format(rest.mission.number), rest.plan, text)

        self._context.start(self.tr("Resume sortie"), work, done)

    def _flown_here(self) -> tuple[Plan, SiteModel, tuple[FlightRecord, ...]] | None:
        """The plan that was flown last, the site as it is now, and all that was flown of the plan."""
        site_model = self._context.document.site
        if self._last is None or site_model is None:
            return None
        plan, flown_over = self._last
        if not is_same_place(flown_over.site, site_model.site):
            text = self.tr("This flight was over the site {0}: open its project first.").format(flown_over.site.name)
            self._context.say(Severity.WARNING, text)
            return None
        return plan, site_model, self.flown(plan)

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

    def __init__(self, context: ApplicationContext) -> None:
        super().__init__(context)
        self._context = context
        self._flight: LiveFlight | None = None
        self._ids = itertools.count(1)
        self._flight_id = 0
        self._case: Case | None = None
        self._preparing_id = 0
        self.choice = read_choice(choice_path(), self._say_soon)
        self.settings = read_flight_settings(flight_settings_path(), self._say_soon)
        self.joystick = read_joystick_buttons(joystick_path(), self._say_soon)
        self.simulation, self.limit = SimulationController(context, self), ItemLimit(context, self)
        self.number, self.corrections_password = 1, ""
        self.active: ActiveFlight | None = None
        self.after, self.signing = AfterFlight(context, self), SigningController(context, self)
        self._published.connect(self._take)
        context.count_as_busy(lambda: self.is_in_flight)
        self.stateChanged.connect(self._tell_state)
        context.documentChanged.connect(lambda *_: self._tell_state())

    @classmethod
    def of(cls, context: ApplicationContext) -> FlyController:
        """The controller of a context: windows come and go, the flight goes on."""
        known = context.findChild(cls)
        return cls(context) if known is None else known

    # What there is

    @property
    def plan(self) -> Plan | None:
        """The current plan, where there is a site to fly it on."""
        document = self._context.document
        return None if document.site is None or document.current is None else document.current.plan

    @property
    def is_connected(self) -> bool:
        """Whether a link is open, or being opened."""
        return self._flight is not None

    @property
    def is_for_shown_plan(self) -> bool:
        """Whether the connection was made for the plan that is shown; only that one may be uploaded and started."""
        return self.active is not None and self.active.sortie.case.plan is self.plan

    @property
    def is_preparing(self) -> bool:
        """Whether a connection is about to be made."""
        return self._runs(self._preparing_id)

    @property
    def is_in_flight(self) -> bool:
        """Whether an aircraft is in the air, as far as is known."""
        return self._flight is not None and self._flight.is_in_flight

    def _tell_state(self) -> None:
        """Note where the flight of the plan that is shown stands."""
        view = None if self.active is None else self.active.view
        state = FlightState.APART
        if self.is_preparing or (self.is_connected and view is None):
            state = FlightState.BUSY
        elif self.is_connected and view is not None and (self.is_for_shown_plan or view.state.is_armed):
            state = flight_state(view)
        self._context.note(flight=state)

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

    def set_joystick(self, buttons: JoystickButtons) -> None:
        """The buttons of the joystick do something else; kept for the next start of the program too."""
        self.joystick = buttons
        self._keep(joystick_path(), buttons)

    def set_corrections_password(self, password: str) -> None:
        """Of the caster's user; for the next connection, and kept nowhere else."""
        self.corrections_password = password

    def share_out(self, found: TooLong) -> None:
        """Share the views out among sorties that fit, and connect for that plan."""
        if not self.is_preparing:
            self._preparing_id = self.limit.share_out(found, self.connect_vehicle)
            self.stateChanged.emit()

    def parameter_changes(self) -> tuple[ParameterChange, ...]:
        """What differs on the vehicle from what the plan needs."""
        active = self.active
        return () if active is None or active.view is None else active.view.on_board.changes or ()

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
        active = self.active
        if self._flight is not None and active is not None and self.is_for_shown_plan:
            self._prepare(self._take_on, active.sortie.orders.raised_m + by_m)

    def plan_from_here(self) -> None:
        """Make the place where the aircraft stands the site's home."""
        active, document = self.active, self._context.document
        if active is None or active.view is None or document.site is None:
            return
        place = stands_enu_m(active.view.state, active.sortie.orders)
        if place is None:
            return
        try:
            model = move_home(document.site, place)
        except InputError as error:
            self._say(Severity.ERROR, str(error))
            return
        self._context.change(self.tr("Home to the aircraft"), replace(document, site=model))
        self._context.say(Severity.NOTE, self.tr("Home is where the aircraft stands: plan again, then connect anew."))

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
            write_preferences(path, record)
        except InputError as error:
            self._say(Severity.WARNING, str(error))

    def _say_soon(self, text: str) -> None:
        """Say it once there is a window that can show it."""
        QTimer.singleShot(0, self, lambda: self._say(Severity.WARNING, text))

    def _prepare(self, then: Callable[[LiveSortie], None], raised_m: float = 0.0) -> None:
        plan, site_model, number, known = self.plan, self._context.document.site, self.number, self._case
        if plan is None or site_model is None or self.is_preparing:
            return

        def work(context: JobContext) -> LiveSortie:
            return prepare_sortie(plan, site_model, number, known, raised_m, context)

        def done(sortie: LiveSortie) -> None:
            self._case = sortie.case
            then(sortie)
            self.stateChanged.emit()

        self._preparing_id = self._context.start(self.tr("Prepare the flight"), work, done).id
        self.stateChanged.emit()

    def _runs(self, job_id: int) -> bool:
        return any(job.id == job_id for job in self._context.jobs())

    def _take_on(self, sortie: LiveSortie) -> None:
        active = self.active
        is_free = active is not None and active.view is not None and active.view.phase in BEFORE_TAKE_OFF
        if self._flight is not None and is_free and not self.is_in_flight and self.is_for_shown_plan:
            self._flight.set_next_sortie(sortie)
            self.active = ActiveFlight(sortie)

    def _connect(self, sortie: LiveSortie) -> None:
        if self._flight is not None:
            return
        plan = sortie.case.plan
        charge = self.after.charge(plan, sortie.orders.number)
        self._flight_id = flight_id = next(self._ids)
        for topic in ("link", "flight."):
            self._context.withdraw(topic)
        self.active = ActiveFlight(sortie)
        self._flight = LiveFlight(
            sortie,
            self._connection(sortie, charge),
            lambda event: self._published.emit(flight_id, event),
            flights_folder(self._context.session.folder),
            flown=self.after.flown(plan),
            settings=self.settings,
            corrections=self._corrections_for(sortie),
        )
        self._flight.start()
        self._note(Severity.NOTE, self.tr("connecting"))
        if charge < 1.0 and self.choice.kind is LinkKind.SIMULATION:
            text = self.tr("simulated battery: {0:.0%}, as the flight before left it").format(charge)
            self._note(Severity.NOTE, text)

    def _corrections_for(self, sortie: LiveSortie) -> Corrections | None:
        """RTK corrections for a flight, connected; None where none are wanted, or their address is none."""
        if not self.settings.corrections:
            return None
        try:
            caster = caster_of(self.settings.corrections)
        except InputError as error:
            self._say(Severity.WARNING, str(error))
            return None
        corrections = Corrections(caster, self.corrections_password, sortie.orders.home)
        corrections.start()
        return corrections

    def _connection(self, sortie: LiveSortie, charge: float) -> Connection:
        choice = self.choice
        if choice.kind is LinkKind.SIMULATION:
            return self.simulation.connection(sortie, choice, charge)
        return VehicleAt(choice.url, signer=cache(link_signer) if choice.is_signed else None)

    # Events

    def _take(self, flight_id: int, event: LiveEvent) -> None:
        active = self.active
        if flight_id != self._flight_id or active is None:
            return
        match event:
            case FlightChanged():
                self._take_view(active, event.view)
            case PhotoCounted():
                active.take_photo(event)
                self.photoCounted.emit(event)
            case LinkChanged():
                self._take_link(active, event)
            case Answered():
                self._note(Severity.OK if event.is_accepted else Severity.ERROR, self._words(event.text))
                if event.is_accepted:
                    self._context.withdraw("order")
                else:
                    self._say(Severity.ERROR, event.text, "order")
            case WarningRaised():
                self._note(event.warning.severity, self._words(event.warning.text))
                self._say(event.warning.severity, event.warning.text, f"flight.warning.{event.warning.code}")
            case WarningCleared():
                self._context.withdraw(f"flight.warning.{event.code}")
            case LinkProblem():
                active.link_problem = event.text
                self._note(Severity.ERROR, self._words(event.text))
                self._say(Severity.ERROR, event.text, "link")
                self.stateChanged.emit()
            case LogProblem():
                self._note(Severity.WARNING, self._words(event.text))
                self._say(Severity.WARNING, event.text, "flight.log")
            case LogFetched():
                self._take_log(active, event)
            case FlightEnded():
                self._take_end(active, event)

    def _take_view(self, active: ActiveFlight, view: LiveView) -> None:
        for text in active.take_view(view):
            severity = (
                Severity.ERROR if text.severity <= 3 else Severity.WARNING if text.severity == 4 else Severity.NOTE
            )
            self._note(severity, self.tr("autopilot: {0}").format(text.text))
        self._tell_state()
        self.viewChanged.emit(view)

    def _take_link(self, active: ActiveFlight, event: LinkChanged) -> None:
        before, active.link = active.link, event.link
        text = self._words(event.text)
        if event.link is LinkState.LOST:
            self._note(Severity.ERROR, self.tr("link lost") if not text else self.tr("link lost: {0}").format(text))
        elif event.link is LinkState.ALIVE:
            self._context.withdraw("link")
            self._note(
                Severity.OK, self.tr("link alive") if before is not LinkState.LOST else self.tr("link found again")
            )
        elif event.link is LinkState.CLOSED:
            self._note(Severity.NOTE, self.tr("disconnected"))
            for topic in ("order", "flight.warning.", "flight.log"):
                self._context.withdraw(topic)
            if text:
                self._say(Severity.ERROR, event.text, "link")
            self._flight = None
            self.stateChanged.emit()
        self.linkChanged.emit(event.link)

    def _take_end(self, active: ActiveFlight, event: FlightEnded) -> None:
        active.ended = event
        if event.record is not None:
            case = active.sortie.case
            self.after.add(case.plan, case.site_model, event.record, active.battery)
            flown = {record.sortie for record in self.after.flown(case.plan)}
            if self.is_for_shown_plan and len(flown) >= len(case.plan.sorties):
                self._context.note(is_flown=True)
            # Only a simulated vehicle tells with which effects it flew.
            if self.is_for_shown_plan and event.path is not None and event.record.effects:
                self._context.note(simulated=event.path)
        if event.error is not None:
            self._note(Severity.ERROR, self._words(str(event.error)))
            self._say(Severity.ERROR, str(event.error), "flight.ended")
        else:
            self._note(Severity.OK, self.tr("landed"))
        if event.problem:
            self._say(Severity.WARNING, event.problem, "flight.kept")
        active.took_off_s = None
        self.flightEnded.emit(event)

    def _take_log(self, active: ActiveFlight, event: LogFetched) -> None:
        """The vehicle's own log is here: report from it."""
        path, case = event.path, active.sortie.case
        if path is None:
            self._note(Severity.ERROR, self._words(event.problem))
            self._say(Severity.ERROR, event.problem, "flight.log")
            return
        proof = self.tr("proved by its checksum") if event.is_checked else self.tr("not proved: it knows no checksums")
        self._note(Severity.OK, self.tr("vehicle's log: {0}, {1}").format(path, proof))

        def work(context: JobContext) -> FlightEnded:
            record, report, out = report_of_log(case, path, context)
            return FlightEnded(active.sortie.orders.number, None, record, report, out)

        def done(ended: FlightEnded) -> None:
            if self.active is active and ended.record is not None:
                active.ended = ended
                self.after.correct(case.plan, ended.record)
                self._context.say(Severity.OK, self.tr("The report is made from the vehicle's own log."))
                self.flightEnded.emit(ended)

        self._context.start(self.tr("Report"), work, done)

    def _note(self, severity: Severity, text: str) -> None:
        active = self.active
        view = None if active is None else active.view
        when = None if active is None or view is None else active.since_take_off_s(view)
        if active is not None:
            active.notes.append((when, severity, text))
        self.noted.emit(when, severity, text)

    def _say(self, severity: Severity, text: str, about: str = "") -> None:
        self._context.say(severity, self._words(text), about=about)

    def _words(self, text: str) -> str:
        words: str = self._context.localized(text)
        return words
