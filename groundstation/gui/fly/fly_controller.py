"""What the Fly tab does: connect, ask, follow, and plan what comes after. It belongs to the application, not a window.

Events of a flight come from its thread as Qt signals, in the window's thread; nothing here waits for the link.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.fly.after_flight import AfterFlight, ItemLimit
from groundstation.gui.fly.live_aircraft import ActiveFlight, LiveAircraft, n_aircraft, sortie_of
from groundstation.gui.fly.signing_controller import SigningController
from groundstation.gui.fly.simulation_controller import SimulationController
from groundstation.services.fly.announce import AgedWarning, aged_warnings, fleet_warnings
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
from groundstation.services.fly.fleet import Fleet, ReturnAll
from groundstation.services.fly.flight import LiveFlight
from groundstation.services.fly.flying import report_of_log
from groundstation.services.fly.joystick import JoystickButtons, joystick_path, read_joystick_buttons
from groundstation.services.fly.options import (
    ConnectionChoice,
    FlightSettings,
    LinkKind,
    beside,
    choice_path,
    flight_settings_path,
    read_choice,
    read_flight_settings,
)
from groundstation.services.fly.readouts import BEFORE_TAKE_OFF, flight_state
from groundstation.services.fly.signing import link_signer
from groundstation.services.fly.sortie import LiveSortie, prepare_sortie
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.readiness import TooLong
from groundstation.services.project.steps import FlightState
from groundstation.services.settings import write_preferences
from groundstation.services.site.edits import move_home
from groundstation.vehicle.preflight import stands_enu_m
from groundstation.vehicle.setup import ParameterChange
from missions.mavlink.ntrip import caster_of
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.base.messages import say
from planning.checks.case import Case
from planning.plan import Plan

BEFORE_FLIGHT = (Request.UPLOAD, Request.START)

CLOSE_S = 5.0
"""Longest wait for a flight's thread when the window closes; it notices within a twentieth of a second."""


class FlyController(QObject):
    """One vehicle, or one for each aircraft of a plan that flies several at once; one of them is selected.

    What is asked for is asked of the selected one, and the signals below but for the last two tell of it alone.

    Signals
    -------
    stateChanged()
        Connected, disconnected, or another sortie.
    viewChanged(LiveView), photoCounted(PhotoCounted), linkChanged(LinkState), flightEnded(FlightEnded)
        As the flight publishes them.
    noted(object, Severity, str)
        Something to be remembered: how long after take-off (None on the ground), how severe, and the text, as it is
        before it is put into the window's language.
    aircraftSelected()
        Another one is selected.
    fleetChanged()
        Something of any aircraft has changed, or there are more or fewer.
    """

    stateChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    viewChanged = Signal(object)  # noqa: N815
    photoCounted = Signal(object)  # noqa: N815
    linkChanged = Signal(object)  # noqa: N815
    flightEnded = Signal(object)  # noqa: N815
    noted = Signal(object, object, str)
    aircraftSelected = Signal()  # noqa: N815
    fleetChanged = Signal()  # noqa: N815
    _published = Signal(int, object)

    def __init__(self, context: ApplicationContext) -> None:
        super().__init__(context)
        self._context = context
        self._ids = itertools.count(1)
        self._case: Case | None = None
        choice = read_choice(choice_path(), self._say_soon)
        settings = read_flight_settings(flight_settings_path(), self._say_soon)
        self._aircraft = {1: LiveAircraft(1, choice, settings)}
        self._selected = 1
        self._returning = ReturnAll()
        self.joystick = read_joystick_buttons(joystick_path(), self._say_soon)
        self.simulation, self.limit = SimulationController(context, self), ItemLimit(context, self)
        self.corrections_password = ""
        self.after, self.signing = AfterFlight(context, self), SigningController(context, self)
        self._published.connect(self._take)
        context.count_as_busy(lambda: self.is_any_in_flight)
        self.stateChanged.connect(self._tell_state)
        self._shown_plan = self.plan
        self._assign()
        context.documentChanged.connect(self._document_changed)
        context.jobsChanged.connect(self._tell_state)  # a preparation that fails or is cancelled ends without a word

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
    def aircraft(self) -> tuple[LiveAircraft, ...]:
        """All that the shown plan flies with, and that are connected, by their numbers."""
        n_shown = max([n_aircraft(self.plan), *(n for n, each in self._aircraft.items() if each.flight is not None)])
        for number in range(1, n_shown + 1):
            if number not in self._aircraft:
                self._aircraft[number] = self._made(number)
        return tuple(self._aircraft[number] for number in range(1, n_shown + 1))

    @property
    def selected(self) -> LiveAircraft:
        """The aircraft that the screen shows in full."""
        return self._aircraft[self._selected]

    @property
    def active(self) -> ActiveFlight | None:
        """The last flight of the selected aircraft."""
        return self.selected.active

    @property
    def choice(self) -> ConnectionChoice:
        """How the selected aircraft is reached."""
        return self.selected.choice

    @property
    def settings(self) -> FlightSettings:
        """What the pilot chose for the selected aircraft."""
        return self.selected.settings

    @property
    def number(self) -> int:
        """Sortie, from 1, that the selected aircraft flies next."""
        return self.selected.sortie_number

    @property
    def is_connected(self) -> bool:
        """Whether a link to the selected aircraft is open, or being opened."""
        return self.selected.flight is not None

    @property
    def is_any_connected(self) -> bool:
        """Whether a link is open, or being opened."""
        return any(each.flight is not None for each in self._aircraft.values())

    @property
    def is_for_shown_plan(self) -> bool:
        """Whether the connection was made for the plan that is shown; only that one may be uploaded and started."""
        return self.selected.flies(self.plan)

    @property
    def is_preparing(self) -> bool:
        """Whether a connection is about to be made."""
        return self._runs(self.selected.job_id)

    @property
    def is_in_flight(self) -> bool:
        """Whether the selected aircraft is in the air, as far as is known."""
        return self.selected.is_in_flight

    @property
    def is_any_in_flight(self) -> bool:
        """Whether an aircraft is in the air, as far as is known."""
        return any(each.is_in_flight for each in self._aircraft.values())

    def select(self, number: int) -> None:
        """Show another aircraft in full, and ask it from now on."""
        if number != self._selected and any(each.number == number for each in self.aircraft):
            self._selected = number
            self._tell_state()
            self.aircraftSelected.emit()

    def views(self) -> dict[int, LiveView]:
        """The flights of all connected aircraft as they stand, by number."""
        return {each.number: each.view for each in self._aircraft.values() if each.view is not None}

    def warnings(self) -> tuple[AgedWarning, ...]:
        """Warnings of all connected aircraft; of several, each with its number."""
        views = self.views()
        if len(self.aircraft) == 1:
            return tuple(aged for view in views.values() for aged in aged_warnings(view))
        return fleet_warnings(views)

    def wait_s(self, aircraft: LiveAircraft) -> float:
        """How long an aircraft on the ground has to wait for its start, to keep apart from those in the air."""
        fleet = aircraft.fleet
        if fleet is None or aircraft.active is None or aircraft.view is None or aircraft.view.state.is_armed:
            return 0.0
        in_air, slower = {}, {aircraft.active.sortie.orders.number: aircraft.active.slower}
        for each in self._aircraft.values():
            since_s = None if each is aircraft or each.fleet is not fleet else each.since_take_off_s()
            if each.active is not None and since_s is not None:
                number = each.active.sortie.orders.number
                in_air[number], slower[number] = since_s, each.active.slower
        return fleet.wait_s(aircraft.active.sortie.orders.number, in_air, slower)

    def _made(self, number: int) -> LiveAircraft:
        """Another aircraft, which is reached beside the first one, and has its own battery and serial number."""
        first = self._aircraft[1]
        own = replace(first.settings, serial_number="", battery="", video="")
        choice = read_choice(choice_path(number), self._say_soon, beside(first.choice, number))
        settings = read_flight_settings(flight_settings_path(number), self._say_soon, own)
        return LiveAircraft(number, choice, settings, sortie_of(self.plan, number))

    def _document_changed(self, *_: object) -> None:
        if self.plan is not self._shown_plan:
            self._shown_plan = self.plan
            self._assign()
            self.after.tell_flown()
        self._tell_state()

    def _assign(self) -> None:
        """Give each aircraft that is not connected its own sortie of the plan that is shown."""
        n_sorties = 0 if self.plan is None else len(self.plan.sorties)
        for each in self.aircraft:
            is_own = n_aircraft(self.plan) > 1 or each.sortie_number > n_sorties
            if each.flight is None and is_own:
                each.sortie_number = sortie_of(self.plan, each.number)
        if self._selected > len(self.aircraft):
            self._selected = 1
            self.aircraftSelected.emit()
        self.fleetChanged.emit()

    def _tell_state(self) -> None:
        """Note where the flight of the plan that is shown stands."""
        view = None if self.active is None else self.active.view
        state = FlightState.APART
        if self.is_preparing or (self.is_connected and view is None):
            state = FlightState.BUSY
        elif self.is_connected and view is not None and (self.is_for_shown_plan or view.state.is_armed):
            state = flight_state(view)
        if state is FlightState.IN_AIR and self.active is not None and self.active.link is LinkState.LOST:
            state = FlightState.SIGNAL_LOST
        if state is FlightState.CONNECTED and self.active is not None and self.active.took_off_s is not None:
            state = FlightState.BUSY  # it has landed, and its report is not there yet
        self._context.note(flight=state, sortie=self.number)

    # Connecting

    def set_choice(self, choice: ConnectionChoice) -> None:
        """Connect in another way the next time; kept for the next start of the program too."""
        self.selected.choice = choice
        self._keep(choice_path(self._selected), choice)

    def set_settings(self, settings: FlightSettings) -> None:
        """The pilot decided otherwise; kept for the next start of the program too. Speech is for all aircraft alike."""
        for each in self.aircraft:
            is_own = each is self.selected
            wanted = settings if is_own else replace(each.settings, speaks=settings.speaks)
            if is_own or wanted != each.settings:
                each.settings = wanted
                self._keep(flight_settings_path(each.number), wanted)
                if each.flight is not None:
                    each.flight.set_settings(wanted)

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
            self.selected.job_id = self.limit.share_out(found, self.connect_vehicle)
            self.stateChanged.emit()

    def parameter_changes(self) -> tuple[ParameterChange, ...]:
        """What differs on the vehicle from what the plan needs."""
        active = self.active
        return () if active is None or active.view is None else active.view.on_board.changes or ()

    def set_parameters(self, changes: tuple[ParameterChange, ...]) -> None:
        """The pilot agrees that these are set."""
        if self.selected.flight is not None:
            self.selected.flight.set_parameters(changes)

    def overrule(self, code: str) -> None:
        """The pilot overrules a check before take-off, until the next upload."""
        if self.selected.flight is not None:
            self.selected.flight.overrule(code)

    def raise_flight(self, by_m: float) -> None:
        """Fly the same places from a take-off that lies so much lower; to be uploaded again."""
        active = self.active
        if self.is_connected and active is not None and self.is_for_shown_plan:
            self._prepare(self.selected, self._take_on, active.sortie.orders.raised_m + by_m)

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
        self._say(Severity.NOTE, say("Home is where the aircraft stands: plan again, then connect anew."))

    def set_sortie(self, number: int) -> None:
        """Fly another sortie of the plan, from 1; connected, it becomes the next one."""
        aircraft = self.selected
        before, aircraft.sortie_number = aircraft.sortie_number, number
        if self.is_connected and self.is_for_shown_plan:
            if self._is_free(aircraft):
                self._prepare(aircraft, self._take_on)
            else:
                aircraft.sortie_number = before
        self.stateChanged.emit()

    def connect_vehicle(self) -> None:
        """Prepare the sortie, then open the link; one that was opened for another plan is closed first."""
        aircraft = self.selected
        if aircraft.flight is not None and not aircraft.flies(self.plan) and not aircraft.is_in_flight:
            aircraft.connects_again = True
            self.disconnect_vehicle()
        elif aircraft.flight is None and self._is_free(aircraft):
            self._prepare(aircraft, self._connect)

    def choose_next_sortie(self) -> None:
        """Make the first sortie that nobody has begun the next one, on the aircraft that the plan gives it."""
        flown, plan = self._context.milestones.flown, self.plan
        if flown is not None and flown.sorties_left and plan is not None:
            number = flown.sorties_left[0]
            self.select(plan.sorties[number - 1].aircraft or self._selected)
            if self.number != number:
                self.set_sortie(number)

    def disconnect_vehicle(self) -> None:
        """Close the link; the aircraft goes on by itself."""
        self.request(Request.DISCONNECT)

    def request(self, request: Request) -> None:
        """Ask the selected aircraft for something."""
        self._returning = self._returning.without(self._selected)
        self._ask(self.selected, request)

    def return_all(self) -> None:
        """Ask all in the air to return to home, one after the other, the rest hovering: they all land there."""
        self._returning, asked = ReturnAll.of(self.views())
        self._ask_each(asked)
        for number in self._returning.waiting:
            self._note(self._aircraft[number], Severity.NOTE, say("returns once the others have landed"))

    def _ask_each(self, asked: Sequence[tuple[int, Request]]) -> None:
        for number, request in asked:
            self._ask(self._aircraft[number], request)

    def _ask(self, aircraft: LiveAircraft, request: Request) -> None:
        if aircraft.flight is not None and (aircraft.flies(self.plan) or request not in BEFORE_FLIGHT):
            aircraft.flight.request(request)

    def _is_free(self, aircraft: LiveAircraft) -> bool:
        """Whether no other aircraft has its sortie or its address; says so where one has."""
        for each in self._aircraft.values():
            if each is aircraft or each.flight is None:
                continue
            is_same = each.flies(self.plan) and each.sortie_number == aircraft.sortie_number
            text = say("Aircraft {} has sortie {} already: choose another sortie.", each.number, each.sortie_number)
            if (
                not is_same
                and aircraft.flight is None
                and aircraft.choice.url
                and aircraft.choice.url == each.choice.url
            ):
                is_same = True
                text = say(
                    "Aircraft {} is connected at that address: give this one an address of its own.", each.number
                )
            if is_same:
                self._say(Severity.ERROR, text, "fleet")
                return False
        self._context.withdraw("fleet")
        return True

    def close(self) -> None:
        """End the flights' threads; what was flown is kept."""
        flights = [each.flight for each in self._aircraft.values() if each.flight is not None]
        for each in self._aircraft.values():
            each.flight, each.flight_id = None, 0
        for flight in flights:
            flight.close(CLOSE_S)

    def _keep(self, path: Path, record: object) -> None:
        try:
            write_preferences(path, record)
        except InputError as error:
            self._say(Severity.WARNING, str(error))

    def _say_soon(self, text: str) -> None:
        """Say it once there is a window that can show it."""
        QTimer.singleShot(0, self, lambda: self._say(Severity.WARNING, text))

    def _prepare(
        self, aircraft: LiveAircraft, then: Callable[[LiveAircraft, LiveSortie], None], raised_m: float = 0.0
    ) -> None:
        plan, site_model, known = self.plan, self._context.document.site, self._case
        number = aircraft.sortie_number
        if plan is None or site_model is None or self._runs(aircraft.job_id):
            return

        def work(context: JobContext) -> LiveSortie:
            return prepare_sortie(plan, site_model, number, known, raised_m, context)

        def done(sortie: LiveSortie) -> None:
            self._case = sortie.case
            then(aircraft, sortie)
            self._state_changed(aircraft)

        aircraft.job_id = self._context.start(self.tr("Prepare the flight"), work, done).id
        self.stateChanged.emit()

    def _runs(self, job_id: int) -> bool:
        return any(job.id == job_id for job in self._context.jobs())

    def _take_on(self, aircraft: LiveAircraft, sortie: LiveSortie) -> None:
        view = aircraft.view
        is_free = view is not None and view.phase in BEFORE_TAKE_OFF
        if aircraft.flight is not None and is_free and not aircraft.is_in_flight and aircraft.flies(self.plan):
            aircraft.flight.set_next_sortie(sortie)
            aircraft.active = ActiveFlight(sortie)

    def _connect(self, aircraft: LiveAircraft, sortie: LiveSortie) -> None:
        if aircraft.flight is not None:
            return
        plan, number = sortie.case.plan, aircraft.number
        charge = self.after.charge(plan, sortie.orders.number)
        aircraft.flight_id = flight_id = next(self._ids)
        for topic in ("link", "flight."):
            self._context.withdraw(_topic(aircraft, topic))
        aircraft.active = ActiveFlight(sortie)
        folder = flights_folder(self._context.session.folder)
        beside = (each.fleet for each in self._aircraft.values() if each.flight is not None and each.flies(plan))
        aircraft.fleet = next(beside, None) or Fleet(sortie.case, folder, self.after.flown(plan))
        aircraft.flight = LiveFlight(
            sortie,
            self._connection(sortie, charge, aircraft),
            lambda event: self._published.emit(flight_id, event),
            folder,
            fleet=aircraft.fleet,
            number=number,
            settings=aircraft.settings,
            corrections=self._corrections_for(sortie, aircraft.settings),
        )
        aircraft.flight.start()
        self._note(aircraft, Severity.NOTE, say("connecting"))
        if charge < 1.0 and aircraft.choice.kind is LinkKind.SIMULATION:
            text = say("simulated battery: {:.0f} %, as the flight before left it", 100.0 * charge)
            self._note(aircraft, Severity.NOTE, text)

    def _corrections_for(self, sortie: LiveSortie, settings: FlightSettings) -> Corrections | None:
        """RTK corrections for a flight, connected; None where none are wanted, or their address is none."""
        if not settings.corrections:
            return None
        try:
            caster = caster_of(settings.corrections)
        except InputError as error:
            self._say(Severity.WARNING, str(error))
            return None
        corrections = Corrections(caster, self.corrections_password, sortie.orders.home)
        corrections.start()
        return corrections

    def _connection(self, sortie: LiveSortie, charge: float, aircraft: LiveAircraft) -> Connection:
        choice = aircraft.choice
        if choice.kind is LinkKind.SIMULATION:
            assert aircraft.fleet is not None
            flown = (each.choice for each in self._aircraft.values() if each.flight and each.fleet is aircraft.fleet)
            first = next((each for each in flown if each.kind is LinkKind.SIMULATION), choice)
            # Those that fly at once fly as fast, or nothing could be said of their distance.
            choice = replace(choice, speed_up=first.speed_up)
            common = aircraft.fleet.simulated_time
            return self.simulation.connection(sortie, choice, charge, aircraft.number - 1, common)
        return VehicleAt(choice.url, signer=cache(link_signer) if choice.is_signed else None)

    # Events

    def _take(self, flight_id: int, event: LiveEvent) -> None:
        aircraft = next((each for each in self._aircraft.values() if each.flight_id == flight_id), None)
        active = None if aircraft is None else aircraft.active
        if aircraft is None or active is None:
            return
        match event:
            case FlightChanged():
                self._take_view(aircraft, active, event.view)
            case PhotoCounted():
                active.take_photo(event)
                if aircraft is self.selected:
                    self.photoCounted.emit(event)
            case LinkChanged():
                self._take_link(aircraft, active, event)
            case Answered():
                severity = Severity.OK if event.is_accepted else Severity.ERROR
                self._note(aircraft, severity, event.text)
                if event.is_accepted:
                    self._context.withdraw(_topic(aircraft, "order"))
                else:
                    self._tell(aircraft, Severity.ERROR, event.text, "order")
            case WarningRaised():
                self._note(aircraft, event.warning.severity, event.warning.text)
                topic = f"flight.warning.{event.warning.code}"
                self._tell(aircraft, event.warning.severity, event.warning.text, topic)
            case WarningCleared():
                self._context.withdraw(_topic(aircraft, f"flight.warning.{event.code}"))
            case LinkProblem():
                active.link_problem = event.text
                self._note(aircraft, Severity.ERROR, event.text)
                self._tell(aircraft, Severity.ERROR, event.text, "link")
                self._state_changed(aircraft)
            case LogProblem():
                self._note(aircraft, Severity.WARNING, event.text)
                self._tell(aircraft, Severity.WARNING, event.text, "flight.log")
            case LogFetched():
                self._take_log(aircraft, active, event)
            case FlightEnded():
                self._take_end(aircraft, active, event)
        self.fleetChanged.emit()

    def _take_view(self, aircraft: LiveAircraft, active: ActiveFlight, view: LiveView) -> None:
        for text in active.take_view(view):
            severity = (
                Severity.ERROR if text.severity <= 3 else Severity.WARNING if text.severity == 4 else Severity.NOTE
            )
            self._note(aircraft, severity, say("autopilot: {}", text.text))
        if aircraft is self.selected:
            self._tell_state()
            self.viewChanged.emit(view)
        if self._returning.waiting:
            self._returning, asked = self._returning.after(self.views())
            self._ask_each(asked)

    def _take_link(self, aircraft: LiveAircraft, active: ActiveFlight, event: LinkChanged) -> None:
        before, active.link = active.link, event.link
        text = event.text
        if event.link is LinkState.LOST:
            words = say("link lost") if not text else say("link lost: {}", text)
            self._note(aircraft, Severity.ERROR, words)
        elif event.link is LinkState.ALIVE:
            self._context.withdraw(_topic(aircraft, "link"))
            words = say("link alive") if before is not LinkState.LOST else say("link found again")
            self._note(aircraft, Severity.OK, words)
        elif event.link is LinkState.CLOSED:
            self._note(aircraft, Severity.NOTE, say("disconnected"))
            for topic in ("order", "flight.warning.", "flight.log"):
                self._context.withdraw(_topic(aircraft, topic))
            if text:
                self._tell(aircraft, Severity.ERROR, event.text, "link")
            aircraft.flight = None
            self._state_changed(aircraft)
            if aircraft.connects_again:
                aircraft.connects_again = False
                self._prepare(aircraft, self._connect)
        if aircraft is self.selected:
            self._tell_state()
            self.linkChanged.emit(event.link)

    def _take_end(self, aircraft: LiveAircraft, active: ActiveFlight, event: FlightEnded) -> None:
        active.ended = event
        if event.record is not None:
            case = active.sortie.case
            self.after.add(case.plan, case.site_model, event.record, active.battery)
            if event.report is not None:
                self.after.take_report(case.plan, event.report)
            # Only a simulated vehicle tells with which effects it flew.
            if case.plan is self.plan and event.path is not None and event.record.effects:
                self._context.note(simulated=event.path)
        if event.error is not None:
            self._note(aircraft, Severity.ERROR, str(event.error))
            self._tell(aircraft, Severity.ERROR, str(event.error), "flight.ended")
        else:
            self._note(aircraft, Severity.OK, say("landed"))
        if event.problem:
            self._tell(aircraft, Severity.WARNING, event.problem, "flight.kept")
        active.took_off_s = None
        if aircraft is self.selected:
            self._tell_state()
            self.flightEnded.emit(event)
        elif event.report is not None:
            self._tell(aircraft, Severity.OK, say("landed; select it for its report"), "flight.landed")

    def _take_log(self, aircraft: LiveAircraft, active: ActiveFlight, event: LogFetched) -> None:
        """The vehicle's own log is here: report from it."""
        path, case = event.path, active.sortie.case
        if path is None:
            self._note(aircraft, Severity.ERROR, event.problem)
            self._tell(aircraft, Severity.ERROR, event.problem, "flight.log")
            return
        proof = say("proved by its checksum") if event.is_checked else say("not proved: it knows no checksums")
        self._note(aircraft, Severity.OK, say("vehicle's log: {}, {}", path, proof))
        number = active.sortie.orders.number

        def work(context: JobContext) -> FlightEnded:
            record, report, out = report_of_log(case, path, context)
            return FlightEnded(number, None, record, report, out)

        def done(ended: FlightEnded) -> None:
            if aircraft.active is active and ended.record is not None:
                active.ended = ended
                self.after.correct(case.plan, number, ended.record)
                if ended.report is not None:
                    self.after.take_report(case.plan, ended.report)
                self._say(Severity.OK, say("The report is made from the vehicle's own log."))
                if aircraft is self.selected:
                    self.flightEnded.emit(ended)

        self._context.start(self.tr("Report"), work, done)

    def _state_changed(self, aircraft: LiveAircraft) -> None:
        if aircraft is self.selected:
            self.stateChanged.emit()
        self.fleetChanged.emit()

    def _note(self, aircraft: LiveAircraft, severity: Severity, text: str) -> None:
        active = aircraft.active
        view = None if active is None else active.view
        when = None if active is None or view is None else active.since_take_off_s(view)
        if active is not None:
            active.notes.append((when, severity, text))
        if aircraft is self.selected:
            self.noted.emit(when, severity, text)

    def _tell(self, aircraft: LiveAircraft, severity: Severity, text: str, about: str) -> None:
        """Say something of an aircraft; of one of several with its number."""
        words = text if len(self.aircraft) == 1 else say("Aircraft {}: {}", aircraft.number, text)
        self._context.say(severity, words, about=_topic(aircraft, about))

    def _say(self, severity: Severity, text: str, about: str = "") -> None:
        self._context.say(severity, text, about=about)


def _topic(aircraft: LiveAircraft, about: str) -> str:
    """The topic of a message about an aircraft: what holds for one does not settle what another said."""
    return about if aircraft.number == 1 else f"aircraft-{aircraft.number}.{about}"
