"""Use cases of flying: a plan flown by the simulated vehicle, or by one at the end of a link; the result is a flight.

A simulated flight is recorded as it truly was, not as its autopilot believed it to be: that is what a simulation can
tell and a real flight cannot.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from groundstation.services.fly.connection import TruthRecorder
from groundstation.services.fly.corrections import Corrections
from groundstation.services.fly.events import FlightEnded
from groundstation.services.fly.log_book import book_path, enter, entry_of
from groundstation.services.fly.own_fences import own_fences
from groundstation.services.mission.files import within_item_limit
from groundstation.services.project.input_files import read_input_plan, read_input_site
from groundstation.services.project.project_file import check_not_index
from groundstation.vehicle.duration import items_duration_s, timed_by_items
from groundstation.vehicle.orders import SortieOrders, sortie_orders
from groundstation.vehicle.preflight import OVERRULABLE
from groundstation.vehicle.recorder import TelemetryLog, new_log_path
from groundstation.vehicle.sortie.conduct import Companion, conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions, RunOutcome, RunView
from missions.flight.flight_file import Flight, flight_of, write_flight
from missions.flight.logs.flights import LogFlights
from missions.flight.logs.read import read_log
from missions.flight.outcome import FlightReport
from missions.flight.photo_folder import read_photo_flights
from missions.flight.record import FlightEvent, FlightRecord
from missions.flight.report import report_case, report_flight
from missions.formats.encode import default_autopilot
from missions.formats.options import ExportOptions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.camera_definition import CameraDefinition
from missions.mavlink.link import ChannelLink, open_link
from missions.mavlink.ntrip import Caster
from missions.mavlink.remote_id import NOBODY, RemoteId, RemoteIdSender
from missions.mavlink.signing import Signer
from missions.mission.build import missions_from_plan
from missions.mission.model import GeoPoint, altitude_amsl_m
from missions.simulator.autopilot.camera_parameters import simulated_camera
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.link_loss import through_air
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.effects import Decision, EffectSetting
from planning.base.errors import (
    GroundStationError,
    InfeasibleError,
    InputError,
    LinkError,
    MissionError,
    OperationCancelled,
)
from planning.base.files import real_path
from planning.base.findings import Finding
from planning.base.json_file import check_output
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.checks.case import Case
from planning.photos.places import PhotoHeights
from planning.plan import Plan
from planning.site.file import is_planned_on
from planning.site.records import Site, SiteModel, require_panels

# ArduCopter's own simulation, started from its binary: at the plan's home, with a camera, in a folder of its own.

SITL_LINK = "tcp:127.0.0.1:5760"
"""Where its first instance listens."""

START_S, END_S = 30.0, 5.0

DEFAULTS = {
    "FRAME_CLASS": 1,
    "FRAME_TYPE": 1,
    "CAM1_TYPE": 1,
    "MNT1_TYPE": 1,
    "BATT_MONITOR": 4,
    "INS_ACCOFFS_X": 0.001,
    "INS_ACC2OFFS_X": 0.001,
}
"""Parameters at first power-up: a quadrotor with camera, gimbal and battery, whose accelerometers count as calibrated.
ArduPilot's own Tools/autotest/default_params/copter.parm, where it is given, comes first."""

MODEL = "x"
"""Motors as FRAME_TYPE 1 has them."""

CURRENT_A = 28.3
"""What its quadrotor draws in flight; measured, 4.7.0-dev."""

Restart = Callable[[int], None]
"""Starts the simulation again, with a full battery; the number is that of the sortie that comes next."""


@contextmanager
def sitl(
    binary: Path, home: GeoPoint, speedup: float, endurance_s: float, defaults: Path | None, monitor: Monitor = QUIET
) -> Iterator[Restart]:
    """Run ArduCopter's simulation at `SITL_LINK`, and end it afterwards; gives what starts it again.

    Parameters
    ----------
    endurance_s
        How long its battery shall last.
    defaults
        A file of parameters; None: those above are enough.

    Raises
    ------
    InputError
        The binary or the file of defaults is missing or cannot be run.
    LinkError
        It ended at once, or opened no link in time; the message holds its last words.
    """
    if defaults is not None and not defaults.is_file():
        raise InputError(say("there is no such file; expected ArduPilot's copter.parm", place=defaults))
    with tempfile.TemporaryDirectory(prefix="reflight-sitl-") as folder:
        own = Path(folder, "reflight.parm")
        values = {**DEFAULTS, "BATT_CAPACITY": round(CURRENT_A * endurance_s / 3.6)}
        own.write_text("".join(f"{name} {value}\n" for name, value in values.items()))
        place = f"{home.lat_deg:.9f},{home.lon_deg:.9f},{altitude_amsl_m(home):.2f},0"
        files = ",".join(str(real_path(path)) for path in (defaults, own) if path is not None)
        command = [str(real_path(binary)), "--model", MODEL, "--speedup", f"{speedup:g}", "--home", place]
        command += ["--defaults", files, "-I0"]
        process = _started([*command, "-w"], Path(folder), monitor)

        def restart(_number: int) -> None:
            nonlocal process
            _end(process)
            process = _started(command, Path(folder), monitor)

        try:
            yield restart
        finally:
            _end(process)


def _started(command: list[str], folder: Path, monitor: Monitor) -> subprocess.Popen[bytes]:
    """The running simulation, once it listens."""
    binary, said = Path(command[0]), folder / "output.txt"
    with said.open("w+b") as output:
        try:
            process = subprocess.Popen(
                command, cwd=folder, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
            )
        except OSError as error:
            raise InputError(
                say("cannot be run ({}); name an arducopter", error.strerror or error, place=binary)
            ) from error
    try:
        _wait_for_link(process, binary, said, monitor)
    except BaseException:
        _end(process)
        raise
    return process


def _wait_for_link(process: subprocess.Popen[bytes], binary: Path, output: Path, monitor: Monitor) -> None:
    """Wait until it listens; a link that is opened and closed again does no harm."""
    deadline_s = time.monotonic() + START_S
    while True:
        monitor.report(say("starting the simulation"), 0, 0)
        if process.poll() is not None:
            last_lines = output.read_text(errors="replace").strip().splitlines()[-1:] or ["it said nothing"]
            raise LinkError(say("ended at once with status {} ({})", process.returncode, last_lines[0], place=binary))
        try:
            open_link(SITL_LINK).close()
        except LinkError as error:
            if time.monotonic() > deadline_s:
                raise LinkError(say("opened no link at {} within {:g} s", SITL_LINK, START_S, place=binary)) from error
            time.sleep(0.1)
        else:
            return


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


# Use case of looking back: a flight compared with its plan, from logs of the autopilot or from its photos alone.


@dataclass(frozen=True, slots=True, eq=False)
class ReportedFlight:
    """A flight with its report, and what there is to say of the files it is from."""

    flight: Flight
    findings: tuple[Finding, ...]
    seconds: float


def report_files(
    plan_path: Path,
    site_path: Path,
    logs: Sequence[Path] = (),
    photos: Path | None = None,
    out: Path | None = None,
    heights: PhotoHeights = "auto",
    monitor: Monitor = QUIET,
) -> ReportedFlight:
    """Compare a flight with the plan in a file over the site in another; write it where `out` is given.

    Parameters
    ----------
    logs
        Of one flight, in the order of flight: .tlog, .BIN, .log or .ulg.
    photos
        Folder of its photos; instead of logs.
    heights
        What heights are counted from; with logs, `auto` is above take-off.

    Raises
    ------
    InputError
        A file cannot be read or written, or does not belong to the site; nothing is written then.
    ValueError
        Both logs and photos are given, or neither.
    """
    if bool(logs) == (photos is not None):
        raise ValueError("expected either logs or photos")
    started_s = time.perf_counter()
    if out is not None:
        check_not_index(out)
        check_output(out, [plan_path, site_path, *logs])
    plan, site_model = read_input_plan(plan_path), read_input_site(site_path)
    if plan.origin is not None and plan.origin != site_model.site.origin:
        raise InputError(
            say(
                "the origin of '{}' is not the one of the plan, which is for '{}'; name the site file that the "
                "plan was made for",
                site_model.site.name,
                plan.site,
                place=site_path,
            )
        )
    if photos is not None:
        found = read_photo_flights(photos, site_model.site, heights, monitor)
    else:
        found = _of_logs(logs, site_model.site, heights, monitor)
    timed = plan if found.autopilot is None else _timed(plan, site_model, found.autopilot)
    report = report_flight(timed, site_model, found.records, monitor=monitor)
    flight = flight_of(plan, site_model, found.records, report)
    if out is not None:
        write_flight(out, flight)
    return ReportedFlight(flight, found.findings, time.perf_counter() - started_s)


def report_of_log(case: Case, path: Path, monitor: Monitor = QUIET) -> tuple[FlightRecord, FlightReport, Path]:
    """The last flight of the vehicle's own log, compared with a plan; the flight file stands beside the log.

    Raises
    ------
    InputError
        The log cannot be read, holds no flight over this site, or the flight file cannot be written.
    """
    found = read_log(path, case.site_model.site, "takeoff", monitor)
    record = found.records[-1]
    timed = case.plan if found.autopilot is None else _timed(case.plan, case.site_model, found.autopilot)
    report = report_case(case.with_plan(timed), (record,))
    out = path.with_suffix(".json")
    write_flight(out, flight_of(case.plan, case.site_model, (record,), report))
    return record, report, out


def _of_logs(logs: Sequence[Path], site: Site, heights: PhotoHeights, monitor: Monitor) -> LogFlights:
    """Flights of all logs, one after the other."""
    found = [read_log(log, site, "sea-level" if heights == "absolute" else "takeoff", monitor) for log in logs]
    autopilots = {flights.autopilot for flights in found}
    return LogFlights(
        tuple(record for flights in found for record in flights.records),
        tuple(finding for flights in found for finding in flights.findings),
        autopilots.pop() if len(autopilots) == 1 else None,
    )


def _timed(plan: Plan, site_model: SiteModel, autopilot: Autopilot) -> Plan:
    """The plan with the durations of its items; as it is where no items can be made of it.

    Its own durations are those of an aircraft that turns at the waypoint, which MAVLink's do not.
    """
    try:
        missions = missions_from_plan(plan, site_model.site.origin, site_model.site.home_enu_m)
        orders = [sortie_orders(plan, site_model, mission) for mission in missions]
        return timed_by_items(plan, {each.number: items_duration_s(each, autopilot) for each in orders})
    except (InputError, MissionError, InfeasibleError):
        return plan  # It was flown all the same, in other items; the report on it must not be lost.


# Flying the vehicle at the end of a link: its telemetry log is always written, a broken link is opened again.


def fly_link(
    orders: SortieOrders,
    url: str,
    options: RunOptions,
    log_folder: Path,
    show: Callable[[RunView], None] | None = None,
    started: Callable[[FlightRun], None] | None = None,
    signer: Signer | None = None,
    companions: Sequence[Companion] = (),
    monitor: Monitor = QUIET,
) -> tuple[FlightRun, RunOutcome, Path]:
    """Fly a sortie: the run as it ended, how it ended, and its telemetry log.

    Parameters
    ----------
    started
        Called with the run before it begins: whoever keeps it may give it the pilot's orders from any thread.
    signer
        Signs what is sent, and lets nothing in that the vehicle did not sign; None: unsigned.
    companions
        What goes along on the link.

    Raises
    ------
    InputError
        The url is none, or the log cannot be made.
    LinkError
        The link cannot be opened.
    """
    run = FlightRun(orders, options, url)
    log = TelemetryLog(new_log_path(log_folder, time.time(), f"sortie-{orders.number}"))

    def opened() -> ChannelLink:
        link = open_link(url, signer=signer)
        link.observe(lambda frame, _sent, _time_s: log.write(frame, time.time()))
        return link

    reported_problem = ""

    def look(view: RunView) -> None:
        nonlocal reported_problem
        if log.problem and log.problem != reported_problem:
            run.note("log", log.problem)
        reported_problem = log.problem
        if show is not None:
            show(view)

    try:
        link = opened()
        if started is not None:
            started(run)
        outcome = conduct(
            run, link, time.perf_counter, reopen=opened, companions=companions, show=look, monitor=monitor
        )
    finally:
        log.close()
    return run, outcome, log.path


SIMULATED = "sim"
"""Name of the link to the simulated vehicle in this process."""

Show = Callable[[RunView], None]
Between = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class FlightRequest:
    """How a plan shall be flown.

    Parameters
    ----------
    link
        `sim`, or a url as `missions.mavlink.link` lists them.
    autopilot
        None: of the plan's profile in the simulation, whatever is found at a link.
    conditions, effects, seed
        Of the simulation: weather and devices (None: the wind that the plan expects), `on`, `off` or `auto` by effect,
        and of everything random.
    speedup
        Of the simulation against real time; None: as fast as it goes.
    simulations_only
        At a link: why only a vehicle is flown that says that it is a simulation; empty where any is.
    sets_parameters
        At a link: set the parameters of any vehicle; else those of a simulation, and tell what differs.
    overrules
        At a link: codes of checks before take-off that the pilot overrules.
    raised_m
        At a link: how much lower than planned the aircraft takes off; its heights above take-off are as much larger.
    log_folder
        For telemetry logs, which a flight over a link always has; None in the simulation.
    signer
        At a link: signs what is sent, and lets nothing in that the vehicle did not sign; None: unsigned.
    identity
        What the operator says of itself to vehicles with remote identification.
    camera_definition
        At a link: definition file of the camera, which is set by the names in it; None: the camera is asked for it.
    caster, caster_password
        At a link: where RTK corrections come from; None: from nowhere.
    """

    link: str = SIMULATED
    autopilot: Autopilot | None = None
    conditions: Conditions | None = None
    effects: Mapping[str, EffectSetting] = field(default_factory=dict)
    seed: int = 0
    speedup: float | None = None
    simulations_only: str = ""
    sets_parameters: bool = False
    needs_rtk: bool = False
    overrules: frozenset[str] = frozenset()
    raised_m: float = 0.0
    log_folder: Path | None = None
    signer: Signer | None = None
    identity: RemoteId = NOBODY
    camera_definition: CameraDefinition | None = None
    caster: Caster | None = None
    caster_password: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class FlownSortie:
    """One sortie: what the simulation took into account, and what was noted.

    `expected_s` is how long the autopilot should take for its items, from lift-off to touch-down.
    """

    number: int
    expected_s: float
    effects: tuple[Decision, ...]
    notes: tuple[FlightEvent, ...]
    log: Path | None


@dataclass(frozen=True, slots=True, eq=False)
class Flown:
    """A flight with its report, its sorties, and what there is to say of the plan.

    `error` is why sorties are missing at the end, None where none is.
    """

    flight: Flight
    sorties: tuple[FlownSortie, ...]
    findings: tuple[Finding, ...]
    seconds: float
    error: GroundStationError | None = None


def fly_files(
    plan_path: Path,
    site_path: Path,
    out: Path,
    request: FlightRequest,
    show: Show | None = None,
    monitor: Monitor = QUIET,
    between: Between | None = None,
) -> Flown:
    """Fly the plan in a file over the site in another, and write the flight.

    Raises
    ------
    InputError, MissionError, InfeasibleError, LinkError
        As `fly_plan`, or a file cannot be read or written; nothing is written then, but for what a vehicle at a link
        had already flown.
    """
    check_not_index(out)
    check_output(out, [plan_path, site_path])
    flown = fly_plan(read_input_plan(plan_path), read_input_site(site_path), request, show, monitor, between)
    write_flight(out, flown.flight)
    if flown.error is not None:
        raise type(flown.error)(say("{}; what was flown before is in {}", flown.error, out)) from flown.error
    return flown


def fly_plan(
    plan: Plan,
    site_model: SiteModel,
    request: FlightRequest,
    show: Show | None = None,
    monitor: Monitor = QUIET,
    between: Between | None = None,
) -> Flown:
    """Fly all sorties of a plan, one after the other.

    Parameters
    ----------
    between
        Called before each further sortie at a link, with its number: the time to change the battery.

    Raises
    ------
    InputError
        The plan is for another site, or an effect or a link has no such name.
    MissionError, InfeasibleError
        The plan cannot be flown as it stands.
    LinkError
        A sortie could not be flown to its end; the message says which, and why.
    """
    started_s = time.perf_counter()
    check_site(plan, site_model)
    planned = plan
    autopilot = request.autopilot or default_autopilot(plan.profile)
    plan, findings = within_item_limit(plan, site_model, ExportOptions(autopilot=autopilot))
    case = _Case(plan, site_model, request, autopilot, show, monitor)
    missions = missions_from_plan(plan, site_model.site.origin, site_model.site.home_enu_m)
    flown: list[tuple[FlightRecord, FlownSortie]] = []
    error: GroundStationError | None = None
    for mission in missions:
        if flown and between is not None and request.link != SIMULATED:
            between(mission.number)
        try:
            record, sortie, error = case.fly(sortie_orders(plan, site_model, mission, request.raised_m))
        except GroundStationError as failure:
            # A real flight cannot be flown again for its record.
            if not flown or request.link == SIMULATED or isinstance(failure, OperationCancelled):
                raise
            error = failure
            break
        flown.append((record, sortie))
        if error is not None:
            break
    records = tuple(record for record, _ in flown)
    sorties = tuple(sortie for _, sortie in flown)
    # The report compares with how long these items take: the plan's own durations are those of a DJI aircraft.
    timed = timed_by_items(plan, {sortie.number: sortie.expected_s for sortie in sorties})
    report = report_flight(timed, site_model, records, monitor=monitor)
    flight = flight_of(planned, site_model, records, report)
    return Flown(flight, sorties, findings, time.perf_counter() - started_s, error)


def check_site(plan: Plan, site_model: SiteModel) -> None:
    """Refuse a plan that was made for another site, and a site without panels.

    Raises
    ------
    InputError
        The plan says so itself, by its checksum or its origin; or the site has no panels.
    """
    require_panels(site_model.site)
    is_other = not is_planned_on(plan.site_sha256, site_model)
    if is_other or (plan.origin is not None and plan.origin != site_model.site.origin):
        raise InputError(
            say(
                "the plan was made for the site '{}' as it was then, and this is another site '{}'; name the "
                "site file that it was made for, or plan again",
                plan.site,
                site_model.site.name,
            )
            if plan.site != site_model.site.name
            else say(
                "the plan was made for the site '{}' as it was then, and this is a changed site '{}'; name the "
                "site file that it was made for, or plan again",
                plan.site,
                site_model.site.name,
            )
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Case:
    """What all sorties of a flight have in common."""

    plan: Plan
    site_model: SiteModel
    request: FlightRequest
    autopilot: Autopilot
    show: Show | None
    monitor: Monitor

    def fly(self, orders: SortieOrders) -> tuple[FlightRecord, FlownSortie, GroundStationError | None]:
        """Fly one; an error says which it was, and is returned where an aircraft at a link has flown all the same."""
        flies = self._simulate if self.request.link == SIMULATED else self._fly_link
        outcome, record, sortie = flies(orders)
        place = f"sortie {orders.number}: " if len(self.plan.sorties) > 1 else ""
        if outcome.error is not None:
            error = type(outcome.error)(f"{place}{outcome.error}")
            if record is None or self.request.link == SIMULATED:
                raise error from outcome.error
            return record, sortie, error
        if record is None:
            raise MissionError(say("{}nothing was recorded: the vehicle sent no positions in flight", place))
        return record, sortie, None

    def _simulate(self, orders: SortieOrders) -> tuple[RunOutcome, FlightRecord | None, FlownSortie]:
        """Fly with a vehicle of this process, on a fresh battery."""
        request, origin = self.request, self.site_model.site.origin
        seed = request.seed * 1000 + orders.number
        conditions = request.conditions or Conditions(wind_m_s=self.plan.rules.wind_m_s)
        airframe, effects = make_airframe(
            self.plan,
            self.site_model,
            self.plan.sorties[orders.number - 1],
            conditions=conditions,
            settings=request.effects,
            home_enu_m=orders.home_enu_m,
            seed=seed,
            autopilot=self.autopilot,
        )
        camera = simulated_camera(orders.mission)
        vehicle = SimulatedVehicle(self.autopilot, airframe, origin, orders.home_enu_m, camera=camera)
        direct = DirectLink(vehicle)
        truth, pace = TruthRecorder(vehicle), _Pace(request.speedup)
        # Nothing real moves: what needs a pilot's word elsewhere is only told.
        options = RunOptions(
            autopilot=self.autopilot, sets_parameters=True, needs_rtk=request.needs_rtk, overrules=OVERRULABLE
        )
        run = FlightRun(orders, options, "simulation")

        def look(view: RunView) -> None:
            truth.sample()
            pace.keep(view.time_s)
            if self.show is not None:
                self.show(view)

        link = through_air(direct, effects, conditions, lambda: vehicle.flight_s, seed)
        outcome = conduct(run, link, direct.clock, show=look, monitor=self.monitor)
        record = None if run.recorder is None else truth.record(run.recorder, orders)
        if record is not None:
            record = replace(record, vehicle=say("simulated {}", self.autopilot.product), effects=effects)
        expected_s = items_duration_s(orders, self.autopilot)
        return outcome, record, FlownSortie(orders.number, expected_s, effects, outcome.notes, None)

    def _fly_link(self, orders: SortieOrders) -> tuple[RunOutcome, FlightRecord | None, FlownSortie]:
        """Fly the vehicle at the end of the link."""
        request = self.request
        if request.log_folder is None:
            raise ValueError("log_folder: a flight over a link is always logged")
        fences, problem = own_fences(orders)
        options = RunOptions(
            autopilot=request.autopilot,
            simulations_only=request.simulations_only,
            sets_parameters=request.sets_parameters,
            needs_rtk=request.needs_rtk,
            overrules=request.overrules,
            own_fences=fences,
            camera_definition=request.camera_definition,
        )
        companions: list[Companion] = [RemoteIdSender(request.identity, orders.home, time.time)]
        with ExitStack() as stack:
            if request.caster is not None:
                corrections = Corrections(request.caster, request.caster_password, orders.home)
                corrections.start()
                stack.callback(corrections.close)
                companions.append(corrections)
            run, outcome, log = fly_link(
                orders,
                request.link,
                options,
                request.log_folder,
                self.show,
                signer=request.signer,
                companions=companions,
                monitor=self.monitor,
            )
        found = run.state.autopilot or self.autopilot
        of_fences = (FlightEvent(0.0, "fence", problem),) if problem else ()
        notes = (*of_fences, *outcome.notes, *self._entered(orders, run, outcome))
        sortie = FlownSortie(orders.number, items_duration_s(orders, found), (), notes, log)
        return outcome, outcome.record, sortie

    def _entered(self, orders: SortieOrders, run: FlightRun, outcome: RunOutcome) -> tuple[FlightEvent, ...]:
        """Enter a flight over a link in this user's log book; a note where that cannot be done."""
        ended = FlightEnded(orders.number, outcome.error, outcome.record, None, None)
        entry = entry_of(
            ended,
            self.plan,
            self.site_model.site,
            orders.home,
            time.time(),
            operator=self.request.identity.operator,
            is_simulated=run.is_simulation,
        )
        try:
            if entry is not None:
                enter(entry, (book_path(),))
        except InputError as error:
            return (FlightEvent(entry.duration_s, "log-book", str(error)),) if entry is not None else ()
        return ()


class _Pace:
    """Keeps simulated time from running ahead of real time by more than a factor."""

    def __init__(self, speedup: float | None) -> None:
        self._speedup = speedup
        self._start_s: float | None = None

    def keep(self, simulated_s: float) -> None:
        """Wait until real time has come as far."""
        if self._speedup is None:
            return
        now_s = time.perf_counter()
        if self._start_s is None:
            self._start_s = now_s - simulated_s / self._speedup
        time.sleep(max(0.0, self._start_s + simulated_s / self._speedup - now_s))
