"""One vehicle on one link, from connecting to landing: flown on a thread of its own, told by events.

The thread owns the link and the state machines of `groundstation.vehicle`; whoever watches gets frozen events and puts
requests into a queue. Each request is answered by an event. A link that breaks is opened again for as long as it takes;
the aircraft flies on meanwhile, and so does the sortie. Every frame goes into a telemetry log, every sortie into a
flight file, also one that ends with the program.
"""

from __future__ import annotations

import math
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from groundstation.services.fly.connection import WAIT_S, Connection, LoggedLink, OpenedLink
from groundstation.services.fly.corrections import Corrections, corrections_check
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
    ViewState,
    WarningCleared,
    WarningRaised,
)
from groundstation.services.fly.fleet import Fleet, LiveCoverage
from groundstation.services.fly.log_book import book_path, enter, entry_of
from groundstation.services.fly.onboard_logs import keep_logs
from groundstation.services.fly.options import USUAL, FlightSettings
from groundstation.services.fly.own_fences import own_fences
from groundstation.services.fly.readouts import BEFORE_TAKE_OFF, allowed_requests, link_state, readouts
from groundstation.services.fly.signing import signing_problem
from groundstation.services.fly.sortie import LiveSortie
from groundstation.services.fly.to_go import SortieTimes, to_go
from groundstation.services.fly.video_offer import VideoFinder
from groundstation.vehicle.commands import CommandCall, CommandOutcome, set_mode_command
from groundstation.vehicle.onboard_logs import NewestLog
from groundstation.vehicle.preflight import OnBoard, is_ready, preflight_checks
from groundstation.vehicle.setup import ParameterChange, message_requests
from groundstation.vehicle.sortie.conduct import Companion
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import ORDER_MODES, Phase, PilotOrder, RunOptions
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.telemetry import LocalFrame, updated_state
from groundstation.vehicle.watch import PHOTO_LATE_S, FlightWarning, Watch
from missions.flight.record import FlightRecord, TakenPhoto
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.camera_definition import CameraDefinition, read_definition
from missions.mavlink.link import GROUND_HEARTBEAT, GROUND_STATION, HEARTBEAT_EVERY_S
from missions.mavlink.messages import Address, Message, Received
from missions.mavlink.remote_id import RemoteIdSender
from missions.mavlink.transfer.exchange import Route
from planning.base.errors import GroundStationError, InputError, LinkError
from planning.base.messages import say
from planning.base.progress import Clock

# Hears a vehicle while no sortie of ours is under way, and passes the pilot's orders on, as a state machine.

ASK_EVERY_S = 10.0
"""How often telemetry is asked for while no position comes: nobody acknowledges that here, and radios lose messages."""


class Listener:
    """Folds what is heard into a state.

    Parameters
    ----------
    state
        What is known already, as from a sortie that ended.
    """

    def __init__(self, frame: LocalFrame, state: VehicleState, own: Address = GROUND_STATION) -> None:
        self.state, self._frame, self._own = state, frame, own
        self.answers: tuple[CommandOutcome, ...] = ()
        self._orders: deque[PilotOrder] = deque()
        self._call: CommandCall | None = None
        self._heartbeat_s = self._asked_s = -math.inf

    def order(self, order: PilotOrder) -> None:
        """Queue an order; it goes out with the next `receive` or `tick`."""
        self._orders.append(order)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        self.state = updated_state(self.state, received, self._frame)
        sent = [] if self._call is None else self._call.receive(received)
        return [*sent, *self._advance(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        sent = [] if self._call is None else self._call.tick(now_s)
        return [*sent, *self._advance(now_s)]

    def _advance(self, now_s: float) -> list[Message]:
        sent: list[Message] = []
        if self._call is not None and self._call.outcome is not None:
            self.answers = (*self.answers, self._call.outcome)
            self._call = None
        if self._call is None and self._orders:
            sent += self._begin(self._orders.popleft(), now_s)
        if now_s >= self._heartbeat_s + HEARTBEAT_EVERY_S:
            self._heartbeat_s = now_s
            sent.append(GROUND_HEARTBEAT)
            sent += self._ask(now_s)
        return sent

    def _begin(self, order: PilotOrder, now_s: float) -> list[Message]:
        autopilot, address = self.state.autopilot, self.state.address
        if autopilot is None or address is None:
            return []
        command = set_mode_command(autopilot, ORDER_MODES[order][autopilot], address.system, address.component)
        self._call = CommandCall(order.value, command, self._own)
        return self._call.start(now_s)

    def _ask(self, now_s: float) -> list[Message]:
        autopilot, address, motion = self.state.autopilot, self.state.address, self.state.motion
        is_told = motion is not None and motion.age_s(now_s) < ASK_EVERY_S
        if autopilot is None or address is None or is_told or now_s < self._asked_s + ASK_EVERY_S:
            return []
        self._asked_s = now_s
        return list(message_requests(autopilot, address))


# What is new since it was last looked: photos, answers and warnings, told once each.


class FlightEvents:
    """Publishes what was not published before."""

    def __init__(self, publish: Callable[[LiveEvent], None], coverage: LiveCoverage) -> None:
        self._publish, self._coverage = publish, coverage
        self.begin()

    def begin(self) -> None:
        """Another machine listens: its photos and answers count from nothing."""
        self._n_photos = self._n_answers = 0
        self._warnings: tuple[FlightWarning, ...] = ()

    def photos(self, photos: Sequence[TakenPhoto], viewpoint_ids: Sequence[str]) -> None:
        """Count the photos that are new, as of these views."""
        for number, photo in enumerate(photos[self._n_photos :], self._n_photos + 1):
            started_s = time.perf_counter()
            counted, coverage = self._coverage.add(photo, viewpoint_ids), self._coverage
            self._publish(
                PhotoCounted(
                    number=number,
                    photo=photo,
                    view_id="" if counted.view is None else counted.view.id,
                    position_error_m=counted.position_error_m,
                    heading_error_deg=counted.heading_error_deg,
                    gimbal_pitch_error_deg=counted.gimbal_pitch_error_deg,
                    n_new=counted.n_new,
                    covered=coverage.covered,
                    covered_planned=coverage.covered_planned,
                    counts=coverage.counts(),
                    seconds=time.perf_counter() - started_s,
                )
            )
        self._n_photos = len(photos)

    def new_answers(self, answers: Sequence[CommandOutcome]) -> Sequence[CommandOutcome]:
        """Those that were not there when this was asked last."""
        new, self._n_answers = answers[self._n_answers :], len(answers)
        return new

    def warnings(self, warnings: tuple[FlightWarning, ...]) -> None:
        """Tell which appeared and which went."""
        before, now = {warning.code for warning in self._warnings}, {warning.code for warning in warnings}
        for warning in warnings:
            if warning.code not in before:
                self._publish(WarningRaised(warning))
        for code in sorted(before - now):
            self._publish(WarningCleared(code))
        self._warnings = warnings


# What becomes of the pilot's requests: the orders they are, when they are done, and what is said of them.

REFUSALS = {
    Request.UPLOAD: say("nothing can be uploaded now: the vehicle must be heard, on the ground and disarmed"),
    Request.START: say("the pre-flight list is not all well, or nothing was uploaded yet"),
    Request.PAUSE: say("the vehicle does not fly its mission, so there is nothing to pause"),
    Request.RESUME: say("the vehicle is not in flight, so there is nothing to resume"),
    Request.RETURN: say("the vehicle is not in flight, so it cannot return"),
    Request.LAND: say("the vehicle is not in flight, so it cannot land"),
    Request.LOG: say("logs are fetched on the ground only, from a vehicle that is heard and disarmed"),
    Request.DISCONNECT: say("there is no link"),
}
REACHED = {Request.UPLOAD: (Phase.CHECKING, Phase.READY), Request.START: (Phase.FLYING,)}
"""Phases in which the run has done what was asked for."""

DONE = {
    Request.UPLOAD: say("the mission is on board, read back and equal"),
    Request.START: say("the aircraft flies its mission"),
}

ORDERS = {
    Request.PAUSE: PilotOrder.PAUSE,
    Request.RESUME: PilotOrder.RESUME,
    Request.RETURN: PilotOrder.RETURN,
    Request.LAND: PilotOrder.LAND,
}


# Tells once, while a link is open, that its two ends do not sign alike.


class SigningEvents:
    """Publishes what is wrong with the signing of a link when that changes to something."""

    def __init__(self, publish: Callable[[LinkProblem], None]) -> None:
        self._publish = publish
        self._told = ""

    def look(self, opened: OpenedLink | None, *, is_heard: bool) -> None:
        """Look at what came in on a link; `is_heard`: an autopilot was."""
        if opened is None or opened.counts is None:
            return
        text = signing_problem(opened.counts, is_signed=opened.is_signed, is_heard=is_heard)
        if text and text != self._told:
            self._publish(LinkProblem(text))
        self._told = text


VIEW_EVERY_S = 0.1
"""Shortest time between two views, unless what a pilot reacts to has changed."""

MAX_BATCH = 200
"""Messages taken before the flight is shown again: none is behind by more than some milliseconds."""


_Asked = Request | LiveSortie | FlightSettings | tuple[ParameterChange, ...] | str
"""What crosses to the flight's thread; a text is the code of a check that the pilot overrules."""


class LiveFlight:
    """A vehicle that is connected, and the sorties that it flies.

    Parameters
    ----------
    publish
        Called with each event, on the flight's own thread; must return at once.
    folder
        Where telemetry log and flight file go; where it cannot be written, the user's data folder takes its place.
    flown
        Records of the same plan from before, such as on another battery; photos and coverage count on.
    fleet, number
        What other flights of the same plan share with this one, `flown` too, and the aircraft's number among them; None
        for an aircraft that flies alone.
    corrections
        Of RTK, begun already; they end with the flight.
    clock, unix_clock
        Real time, by which the vehicle is watched too, unless it is a simulated one: see `OpenedLink`. Its own time, in
        its messages, runs ahead.
    """

    def __init__(
        self,
        sortie: LiveSortie,
        connection: Connection,
        publish: Callable[[LiveEvent], None],
        folder: Path,
        *,
        flown: tuple[FlightRecord, ...] = (),
        fleet: Fleet | None = None,
        number: int = 1,
        settings: FlightSettings = USUAL,
        corrections: Corrections | None = None,
        clock: Clock = time.perf_counter,
        unix_clock: Clock = time.time,
    ) -> None:
        self._connection, self._publish = connection, publish
        self._settings, self._clock = settings, clock
        self._asked: queue.SimpleQueue[_Asked] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._live, name="live-flight", daemon=True)
        self._is_closing = False
        self._fleet = Fleet(sortie.case, folder, flown) if fleet is None else fleet
        self._number, name = number, "flight" if number == 1 else f"flight-aircraft-{number}"
        self._wire = LoggedLink(connection, folder, lambda text: publish(LogProblem(text)), clock, unix_clock, name)
        self._folder, self._unix_clock = folder, unix_clock
        self._log: NewestLog | None = None
        self._corrections = corrections
        self._link = LinkState.OPENING
        self._view: LiveView | None = None
        self._shown_s = -math.inf
        self._coverage = self._fleet.coverage
        self._run: FlightRun | None = None
        self._awaited: Request | None = None
        self._ordered: deque[Request] = deque()
        self._events = FlightEvents(publish, self._coverage)
        self._signing = SigningEvents(publish)
        self._remote_id = RemoteIdSender(settings.identity, sortie.orders.home, unix_clock)
        self._video = VideoFinder()
        self._activate(sortie, VehicleState())

    # For whoever watches, from any thread

    def start(self) -> None:
        """Open the link, and go on until `close`."""
        self._thread.start()

    def request(self, request: Request) -> None:
        """Ask for something; `Answered` says what became of it."""
        self._asked.put(request)

    def set_next_sortie(self, sortie: LiveSortie) -> None:
        """Fly another sortie of the same plan next; passed over while one is under way."""
        self._asked.put(sortie)

    def set_settings(self, settings: FlightSettings) -> None:
        """The pilot decided otherwise; parameters are set with the next upload."""
        self._asked.put(settings)

    def set_parameters(self, changes: tuple[ParameterChange, ...]) -> None:
        """The pilot agrees that these parameters of the vehicle are set; passed over in flight."""
        self._asked.put(changes)

    def overrule(self, code: str) -> None:
        """The pilot overrules a check before take-off, until the next upload."""
        self._asked.put(code)

    def close(self, timeout_s: float = 10.0) -> bool:
        """Disconnect, keep what was flown; True where that was done in time. The aircraft goes on with what it does."""
        self._is_closing = True
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    @property
    def is_in_flight(self) -> bool:
        """Whether the vehicle was armed when it was last heard."""
        return self._view is not None and self._view.state.is_armed

    # The thread

    def _live(self) -> None:
        problem = ""
        self._wire.open_log()
        try:
            self._wire.open(self._sortie.orders)
            while not self._is_closing:
                self._take_requests()
                self._look_around()
                self._serve()
                self._notice()
        except GroundStationError as error:
            problem = str(error)
        except Exception as error:
            problem = say(
                "the flight could not be watched any longer ({}: {}); please report it", type(error).__name__, error
            )
            raise
        finally:
            self._keep_unfinished()
            self._fleet.traffic.leave(self._number)
            self._wire.close()
            if self._corrections is not None:
                self._corrections.close()
            self._say_link(LinkState.CLOSED, problem)

    def _look_around(self) -> None:
        """Tell the other flights where this aircraft is, and hear where theirs are."""
        state, traffic, orders = self._machine.state, self._fleet.traffic, self._sortie.orders
        around = orders.surroundings[state.autopilot or Autopilot.ARDUPILOT]
        traffic.tell(self._number, orders.number, state, around, self._wire.now_s())
        if self._run is not None:
            self._run.others = traffic.others(self._number)

    def _serve(self) -> None:
        """Take what came in, and let time pass; a broken link is opened again."""
        try:
            if self._wire.opened is None:
                self._wire.open_again(self._sortie.orders)
            for message in self._exchange():
                self._wire.send(message)
        except LinkError as error:
            if self._wire.broke():
                self._say_link(LinkState.LOST, str(error))

    def _exchange(self) -> Iterator[Message]:
        """What the machine wants to be sent, from what was received and the time; without a link only time passes."""
        wait_s = WAIT_S
        for _ in range(MAX_BATCH):
            received = self._wire.receive(wait_s)
            if received is None:
                break
            wait_s = 0.0
            yield from self._machine.receive(received)
            for companion in self._companions:
                yield from companion.receive(received)
            if self._log is not None:
                yield from self._log.receive(received)
        yield from self._machine.tick(self._wire.now_s())
        for companion in self._companions:
            yield from companion.tick(self._wire.now_s())
        if self._log is not None:
            yield from self._log.cancel() if self._machine.state.is_armed else self._log.tick(self._wire.now_s())

    @property
    def _companions(self) -> tuple[Companion, ...]:
        """What goes along on the link."""
        usual = (self._remote_id, self._video)
        return usual if self._corrections is None else (*usual, self._corrections)

    @property
    def _machine(self) -> FlightRun | Listener:
        return self._listener if self._run is None else self._run

    # Requests

    def _take_requests(self) -> None:
        while not self._asked.empty():
            request = self._asked.get()
            if isinstance(request, FlightSettings):
                self._settle(request)
            elif isinstance(request, LiveSortie):
                if self._run is None or self._run.phase in BEFORE_TAKE_OFF:
                    self._activate(request, self._machine.state)
            elif not isinstance(request, Request):
                if self._run is not None and self._run.phase in BEFORE_TAKE_OFF:
                    self._agree(self._run, request)
            elif request not in self._now().may:
                self._publish(Answered(request, False, REFUSALS[request]))
            else:
                self._do(request)

    def _settle(self, settings: FlightSettings) -> None:
        self._settings = settings
        self._remote_id.identity = settings.identity
        if self._run is not None:
            self._run.options = replace(self._run.options, needs_rtk=settings.needs_rtk)

    def _agree(self, run: FlightRun, request: str | tuple[ParameterChange, ...]) -> None:
        if isinstance(request, str):
            run.options = replace(run.options, overrules=run.options.overrules | {request})
        else:
            run.set_parameters(request)

    def _do(self, request: Request) -> None:
        if request is Request.DISCONNECT:
            self._is_closing = True
        elif request is Request.UPLOAD:
            self._begin_run()
        elif request is Request.LOG:
            self._fetch_log()
        elif request is Request.START and self._run is not None:
            self._awaited = request
            self._run.begin()
        elif request in ORDERS:
            self._ordered.append(request)
            self._machine.order(ORDERS[request])

    def _begin_run(self) -> None:
        settings, connection = self._settings, self._connection
        fences, problem = own_fences(self._sortie.orders)
        definition, unread = self._camera_definition()
        for text in filter(None, (problem, unread)):
            self._publish(LogProblem(text))
        options = RunOptions(
            sets_parameters=connection.is_simulated,
            starts_itself=False,
            needs_rtk=settings.needs_rtk,
            own_fences=fences,
            camera_definition=definition,
        )
        run = FlightRun(self._sortie.orders, options, connection.name)
        run.state = replace(self._machine.state, photos=())
        self._run, self._awaited = run, Request.UPLOAD
        self._ordered.clear()
        self._events.begin()
        self._coverage.add_sortie(self._sortie.viewpoint_ids)
        for message in run.start(self._wire.now_s()):
            self._wire.send(message)

    def _camera_definition(self) -> tuple[CameraDefinition | None, str]:
        """The definition that the pilot named, and why it cannot be read; a simulated camera has its own names."""
        path = self._settings.camera_definition
        if not path or self._connection.is_simulated:
            return None, ""
        try:
            return read_definition(Path(path)), ""
        except InputError as error:
            return None, say("the camera is asked for its own definition: {}", error)

    def _fetch_log(self) -> None:
        """Begin to fetch the vehicle's own log, or stop that."""
        autopilot, address = self._machine.state.autopilot, self._machine.state.address
        if self._log is not None:
            sent, self._log = self._log.cancel(), None
            self._publish(Answered(Request.LOG, False, say("the log was not fetched: stopped")))
        elif autopilot is not None and address is not None:
            self._log = NewestLog(Route(GROUND_STATION, address), autopilot)
            sent = self._log.start(self._wire.now_s())
        else:
            sent = []
        for message in sent:
            self._wire.send(message)

    def _notice_log(self) -> None:
        """Keep the vehicle's own log once it has come."""
        log = self._log
        if log is not None and self._machine.state.is_armed:
            self._log = None
            self._publish(LogFetched(None, problem=say("the log was not fetched: the vehicle is armed")))
            return
        if log is None or log.outcome is None:
            return
        self._log = None
        try:
            kept = keep_logs(log.outcome, self._folder)
        except GroundStationError as error:
            self._publish(LogFetched(None, problem=str(error)))
            return
        if kept:
            self._publish(LogFetched(kept[0].path, kept[0].is_checked))
        else:
            self._publish(LogFetched(None, problem=log.outcome.problem))

    # What has happened

    def _notice(self) -> None:
        """Publish what is new."""
        self._notice_link()
        self._notice_log()
        self._signing.look(self._wire.opened, is_heard=self._machine.state.heartbeat is not None)
        machine, run = self._machine, self._run
        self._events.photos(machine.state.photos, self._sortie.viewpoint_ids)
        for outcome in self._events.new_answers(machine.answers):
            self._answer(self._ordered.popleft(), outcome.is_accepted, outcome.text)
        self._events.warnings(() if run is None else run.watch.warnings)
        if run is not None:
            awaited = self._awaited
            if awaited is not None and run.phase in REACHED[awaited]:
                self._answer(awaited, True, DONE[awaited])
            if run.outcome is not None:
                self._end_run(run)
        now_s = self._clock()
        if now_s >= self._shown_s + VIEW_EVERY_S:
            self._show(now_s)

    def _show(self, now_s: float) -> None:
        self._shown_s = now_s
        self._view = self._now()
        self._publish(FlightChanged(self._view))

    def _notice_link(self) -> None:
        link = link_state(self._machine.state, self._wire.now_s(), is_open=self._wire.opened is not None)
        if link is not self._link:
            text = say("the vehicle is heard again") if self._link is LinkState.LOST else ""
            self._say_link(link, text if link is LinkState.ALIVE else "")

    def _say_link(self, link: LinkState, text: str) -> None:
        self._link = link
        self._publish(LinkChanged(link, text))

    def _answer(self, request: Request, is_accepted: bool, text: str) -> None:
        if request is self._awaited:
            self._awaited = None
        self._publish(Answered(request, is_accepted, text))

    def _end_run(self, run: FlightRun) -> None:
        assert run.outcome is not None
        error, record, awaited = run.outcome.error, run.outcome.record, self._awaited
        if awaited is not None:
            self._answer(awaited, False, str(error))
        self._activate(self._sortie, run.state)
        # The report takes a while: meanwhile nobody should take the aircraft for one in the air.
        self._show(self._clock())
        if awaited is not Request.UPLOAD:
            self._end_flight(run, record, error)

    def _end_flight(self, run: FlightRun, record: FlightRecord | None, error: GroundStationError | None) -> None:
        """Keep what was flown, and tell."""
        if record is None:
            self._publish(FlightEnded(run.orders.number, error, None, None, None))
        else:
            ended = self._fleet.ended(run, record, error, self._wire.opened, self._wire.name)
            self._publish(ended)
            self._enter(run, ended)

    def _enter(self, run: FlightRun, ended: FlightEnded) -> None:
        """Enter a flight in the log book of this folder, and in that of all flights."""
        settings = self._settings
        entry = entry_of(
            ended,
            self._sortie.case.plan,
            self._sortie.case.site_model.site,
            run.orders.home,
            self._unix_clock(),
            battery=settings.battery,
            operator=settings.operator,
            is_simulated=self._connection.is_simulated or run.is_simulation,
        )
        try:
            if entry is not None:
                enter(entry, (book_path(self._folder), book_path()))
        except GroundStationError as error:
            self._publish(LogProblem(str(error)))

    def _keep_unfinished(self) -> None:
        """Keep what was flown of a sortie that is not over."""
        run = self._run
        if run is not None and run.recorder is not None and run.phase is Phase.FLYING:
            run.note("disconnected", say("the ground station disconnected; the aircraft went on by itself"))
            record = run.recorder.record(run.orders.site, run.orders.number)
            error = LinkError(
                say("disconnected in flight; the aircraft goes on by itself, what was recorded ends there")
            )
            self._end_flight(run, record, error)

    # The active sortie

    def _activate(self, sortie: LiveSortie, state: VehicleState) -> None:
        """Listen, with this sortie to be flown next."""
        orders = sortie.orders
        frame = LocalFrame.of_home(orders.site.origin, orders.home_enu_m)
        self._sortie, self._listener = sortie, Listener(frame, replace(state, photos=()))
        self._times = SortieTimes.of(sortie)
        self._remote_id.place = orders.home
        self._run = self._awaited = None
        self._ordered.clear()
        self._events.begin()

    def _now(self) -> LiveView:
        """The flight as it stands."""
        run, state, now_s = self._run, self._machine.state, self._wire.now_s()
        orders, on_board = self._sortie.orders, OnBoard() if run is None else run.on_board
        overrules: frozenset[str] = frozenset() if run is None else run.options.overrules
        checks = preflight_checks(
            state, orders, on_board, now_s, needs_rtk=self._settings.needs_rtk, overrules=overrules
        )
        if self._corrections is not None:
            checks = (*checks, corrections_check(self._corrections.status()))
        phase, watch = (None, Watch()) if run is None else (run.phase, run.watch)
        link = link_state(state, now_s, is_open=self._wire.opened is not None)
        missing = [view_id for view_id, since_s in watch.passed_s if now_s - since_s > PHOTO_LATE_S]
        view_states = self._coverage.states(self._sortie.viewpoint_ids, missing)
        around = orders.surroundings[state.autopilot or Autopilot.ARDUPILOT]
        is_done = [seen not in (ViewState.TO_COME, ViewState.NEXT) for _, seen in view_states]
        left = to_go(self._times, self._sortie, state, around, is_done)
        return LiveView(
            link=link,
            silent_s=None if state.heartbeat is None else state.heartbeat.age_s(now_s),
            phase=phase,
            state=state,
            checks=() if state.is_armed else checks,
            warnings=watch.warnings,
            on_board=on_board,
            doing=("", 0.0, 0.0) if run is None else run.view().doing,
            may=allowed_requests(link, phase, state, is_ready=is_ready(checks)),
            readouts=readouts(state, around, orders.site.airspace.ground_z_m, left),
            view_states=view_states,
            speed_up=self._connection.speed_up,
            fetching=None if self._log is None else self._log.progress,
            video=self._video.offered(),
        )
