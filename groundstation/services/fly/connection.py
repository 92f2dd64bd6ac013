"""What a live flight talks to, a vehicle at a link or a simulated one here, and what it leaves: log, record, truth."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from groundstation.services.fly.events import FlightEnded
from groundstation.services.settings import data_folder
from groundstation.vehicle.duration import items_duration_s, timed_by_items
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.recorder import Recorder, TelemetryLog, new_log_path
from groundstation.vehicle.sortie.flight_run import FlightRun
from missions.flight.flight_file import flight_of, write_flight
from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawPhoto
from missions.flight.outcome import FlightReport
from missions.flight.record import FlightRecord
from missions.flight.report import report_case
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import FrameObserver, Link, memory_pair, open_link
from missions.mavlink.messages import Message, Received
from missions.mavlink.signing import Signer
from missions.mavlink.wire import Counts
from missions.simulator.airframe.state import Airframe, Battery, Fix, Pose, Target
from missions.simulator.autopilot.camera_parameters import CameraParameters, simulated_camera
from missions.simulator.autopilot.profiles import vehicle_profile
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.battery import BatterySag
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.link_loss import through_air
from missions.simulator.server import MAX_SPEEDUP, CommonTime, FlownClock, serve
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.effects import Decision, EffectSetting
from planning.base.errors import GroundStationError, InputError
from planning.base.findings import Finding
from planning.base.messages import say
from planning.base.progress import Clock
from planning.checks.case import Case
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin, Vec3, wrap_heading_deg
from planning.plan import Plan
from planning.site.records import SiteModel

# What really happened in a simulated flight: sampled from its airframe, as a record like that of any other flight.


class TruthRecorder:
    """Collects the true poses of a simulated vehicle, and its photos as they were really taken."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._poses: list[tuple[float, Pose]] = []

    def sample(self) -> None:
        """Note where it is now."""
        now_s = self._vehicle.now_s
        if not self._poses or now_s > self._poses[-1][0]:
            self._poses.append((now_s, self._vehicle.gimbal.turned(self._vehicle.airframe.truth)))

    def record(self, recorder: Recorder, orders: SortieOrders) -> FlightRecord | None:
        """The flight, with the battery and the events that telemetry told; None where nothing flew.

        The recorder's positions, angles and photos are replaced by the true ones.
        """
        log, origin = recorder.log, orders.site.origin
        if not self._poses:
            return None
        times = [time_s for time_s, _ in self._poses]
        places = _rows(origin, orders.home_enu_m, [pose.position_enu_m for _, pose in self._poses])
        log.positions = [(time_s, *row) for time_s, row in zip(times, places, strict=True)]
        log.velocities = [
            (t, p.velocity_enu_m_s[1], p.velocity_enu_m_s[0], -p.velocity_enu_m_s[2]) for t, p in self._poses
        ]
        log.headings = [(time_s, pose.heading_rad) for time_s, pose in self._poses]
        log.gimbal_pitches = [(time_s, pose.gimbal_pitch_rad) for time_s, pose in self._poses]
        log.gimbal_headings = [(time_s, pose.gimbal_heading_rad) for time_s, pose in self._poses]
        log.gimbal_yaws = []
        shots = self._vehicle.shots
        taken = _rows(origin, orders.home_enu_m, [shot.pose.position_enu_m for shot in shots])
        log.photos = [
            RawPhoto(
                shot.number,
                shot.time_s,
                *row,
                heading_deg=wrap_heading_deg(math.degrees(shot.pose.gimbal_heading_rad)),
                gimbal_pitch_deg=math.degrees(shot.pose.gimbal_pitch_rad),
                source="simulation",
            )
            for shot, row in zip(shots, taken, strict=True)
        ]
        try:
            flights = flights_of(log, orders.site, "simulation")
        except InputError:
            return None
        return replace(flights.records[-1], sortie=orders.number)


def _rows(origin: Origin, home_enu_m: Vec3, points: list[Vec3]) -> list[tuple[float, float, float, float]]:
    """Latitude, longitude, altitude (0: nobody asks for it) and height above home of local points."""
    lat, lon, height = geodetic_from_enu(origin, np.array([home_enu_m, *points], np.float64))
    above = height - height[0]
    return [(float(a), float(b), 0.0, float(c)) for a, b, c in zip(lat[1:], lon[1:], above[1:], strict=True)]


# A simulated aircraft whose battery was flown before.


class PartlyDischarged:
    """An `Airframe` that starts with part of its charge gone; all else is the airframe's own.

    Parameters
    ----------
    charge
        Of its battery at the start, 1 full to 0 empty.
    sags
        Whether the voltage follows the charge, as where battery sag is on.
    """

    def __init__(self, airframe: Airframe, charge: float, *, sags: bool) -> None:
        if not 0.0 <= charge <= 1.0:
            raise ValueError(f"charge: expected 0 to 1, got {charge}")
        facts = effect_facts().battery
        self._airframe, self._used = airframe, 1.0 - charge
        self._used_mah = self._used * facts.capacity_mah
        self._lower_v = self._used * (facts.full_v - facts.empty_v) if sags else 0.0

    @property
    def truth(self) -> Pose:
        """Where it really is."""
        return self._airframe.truth

    @property
    def estimate(self) -> Pose:
        """Where the autopilot's estimator says it is."""
        return self._airframe.estimate

    @property
    def fix(self) -> Fix:
        """State of the GNSS receiver."""
        return self._airframe.fix

    @property
    def battery(self) -> Battery:
        """State of the battery."""
        drawn = self._airframe.battery
        return replace(
            drawn,
            voltage_v=max(0.0, drawn.voltage_v - self._lower_v),
            consumed_mah=drawn.consumed_mah + self._used_mah,
            remaining=max(0.0, drawn.remaining - self._used),
        )

    @property
    def wind_enu_m_s(self) -> Vec3:
        """Wind that blows towards this direction."""
        return self._airframe.wind_enu_m_s

    def step(self, duration_s: float, target: Target) -> None:
        """Fly on for a time."""
        self._airframe.step(duration_s, target)

    def shutter(self) -> tuple[Pose, float]:
        """True pose of the camera at the middle of an exposure, and the exposure's length."""
        return self._airframe.shutter()


def with_charge(airframe: Airframe, charge: float, decisions: tuple[Decision, ...]) -> Airframe:
    """The airframe with so much of its battery left, 1 full to 0 empty."""
    if charge >= 1.0:
        return airframe
    sags = any(decision.effect == BatterySag.name and decision.on for decision in decisions)
    return PartlyDischarged(airframe, charge, sags=sags)


SAMPLE_S = 0.1
"""Simulated time between two notes of where the aircraft truly is."""

LONGEST_DISARM_DELAY_S = 127.0
"""Range of ArduPilot's DISARM_DELAY."""

CALM = Conditions()
"""No wind, RTK, no loss."""


class SampledVehicle(SimulatedVehicle):
    """A simulated vehicle that notes where it truly is, on the thread that flies it."""

    def __init__(
        self,
        autopilot: Autopilot,
        airframe: Airframe,
        origin: Origin,
        parameters: Mapping[str, float | None],
        camera: CameraParameters | None = None,
    ) -> None:
        super().__init__(autopilot, airframe, origin, parameters=parameters, is_ready=True, camera=camera)
        self._lock = threading.Lock()
        self._truth = TruthRecorder(self)

    def step(self, duration_s: float) -> list[Message]:
        """Fly on for a simulated time; what the vehicle says meanwhile."""
        messages: list[Message] = []
        with self._lock:
            n_steps = max(1, math.ceil(duration_s / SAMPLE_S))
            for _ in range(n_steps):
                messages += super().step(duration_s / n_steps)
                self._truth.sample()
        return messages

    def true_record(self, recorder: Recorder, orders: SortieOrders) -> FlightRecord | None:
        """The last flight as it really was; None where nothing flew."""
        with self._lock:
            return self._truth.record(recorder, orders)


@dataclass(frozen=True, slots=True, eq=False)
class OpenedLink:
    """A link that is open, and what is known of its other end.

    Parameters
    ----------
    effects
        Decisions of the simulation; none for a real vehicle.
    simulated
        The vehicle, where the other end is the embedded simulation.
    counts
        What came in; None for the embedded simulation.
    is_signed
        Whether what is sent is signed, and must be.
    clock
        That the vehicle has to be watched by; None for real time.
    """

    link: Link
    effects: tuple[Decision, ...] = ()
    simulated: SampledVehicle | None = None
    counts: Counts | None = None
    is_signed: bool = False
    clock: Clock | None = None


class Connection(Protocol):
    """How to reach a vehicle; opened again each time the link breaks."""

    @property
    def name(self) -> str:
        """For messages and the flight record."""

    @property
    def speed_up(self) -> float:
        """Simulated seconds in a real one; 1 for a real vehicle."""

    @property
    def is_simulated(self) -> bool:
        """Whether nothing real moves: its parameters may be set without asking."""

    def open(self, orders: SortieOrders, clock: Clock, observe: FrameObserver) -> OpenedLink:
        """Open the link; every frame of it is shown to `observe`.

        Raises
        ------
        InputError, LinkError
            It cannot be opened.
        """


@dataclass(frozen=True, slots=True)
class VehicleAt:
    """A vehicle, or another program's simulation, at a url of `missions.mavlink.link`.

    Parameters
    ----------
    signer
        Gives the link's signer, the same one each time, so that its time stamps grow when a link is opened again; None:
        unsigned.
    """

    url: str
    speed_up: float = 1.0
    is_simulated: bool = False
    signer: Callable[[], Signer] | None = None

    @property
    def name(self) -> str:
        """The url."""
        return self.url

    def open(self, _orders: SortieOrders, clock: Clock, observe: FrameObserver) -> OpenedLink:
        """Open the url."""
        signer = None if self.signer is None else self.signer()
        link = open_link(self.url, signer=signer, clock=clock)
        link.observe(observe)
        return OpenedLink(link, counts=link.counts, is_signed=signer is not None)


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """The embedded simulation of a plan's aircraft.

    Parameters
    ----------
    effects
        On, off or auto by the name of an effect.
    charge
        Of the battery when the link is opened, 1 full to 0 empty.
    seed
        The same seed gives the same errors.
    stands_enu_m
        Where the aircraft stands; None: at home.
    parameters
        Of the vehicle, where they differ from its profile's; None for one that it does not have.
    common
        Time that it shares with others that are simulated at once; None: it flies alone.
    """

    plan: Plan
    site_model: SiteModel
    autopilot: Autopilot = Autopilot.ARDUPILOT
    speed_up: float = 1.0
    conditions: Conditions = CALM
    effects: Mapping[str, EffectSetting] = field(default_factory=dict)
    charge: float = 1.0
    seed: int = 0
    stands_enu_m: Vec3 | None = None
    parameters: Mapping[str, float | None] = field(default_factory=dict)
    common: CommonTime | None = None
    is_simulated: bool = True

    def __post_init__(self) -> None:
        if not 0.1 <= self.speed_up <= MAX_SPEEDUP:
            raise ValueError(f"speed_up: expected 0.1 to {MAX_SPEEDUP:g}, got {self.speed_up:g}")

    @property
    def name(self) -> str:
        """For the flight record."""
        return say("simulation, {:g} times as fast", self.speed_up)

    def open(self, orders: SortieOrders, clock: Clock, observe: FrameObserver) -> OpenedLink:
        """Put the aircraft at home, switched on a while ago."""
        sortie = self.plan.sorties[orders.number - 1]
        airframe, decisions = make_airframe(
            self.plan,
            self.site_model,
            sortie,
            conditions=self.conditions,
            settings=self.effects,
            home_enu_m=self.stands_enu_m,
            seed=self.seed,
            autopilot=self.autopilot,
        )
        flown = with_charge(airframe, self.charge, decisions)
        camera = simulated_camera(orders.mission)
        vehicle = SampledVehicle(self.autopilot, flown, self.site_model.site.origin, self._parameters(), camera)
        watched = FlownClock(clock())
        ground, air = memory_pair(vehicle=vehicle.address, clock=watched)
        ground.observe(observe)
        link = through_air(ground, decisions, self.conditions, lambda: vehicle.flight_s, self.seed)
        common = CommonTime() if self.common is None else self.common
        common.join(watched)

        def fly() -> None:
            def is_heard() -> bool:
                return ground.is_idle() and common.may_fly(watched)

            try:
                serve(vehicle, [air], self.speed_up, is_heard=is_heard, flown=watched)
            finally:
                common.leave(watched)

        # It ends when the link is closed.
        threading.Thread(target=fly, name="simulated-vehicle", daemon=True).start()
        return OpenedLink(link, decisions, vehicle, clock=watched)

    def _parameters(self) -> dict[str, float | None]:
        """What a vehicle whose time runs faster than the orders to it needs to be set otherwise.

        ArduPilot stops its motors where it is not told to take off within DISARM_DELAY after arming: 10 s, which forty
        times as fast are over before the next order has come.
        """
        if self.autopilot is not Autopilot.ARDUPILOT or self.speed_up <= 1.0:
            return dict(self.parameters)
        usual_s = vehicle_profile(self.autopilot).parameters["DISARM_DELAY"]
        return {"DISARM_DELAY": min(usual_s * self.speed_up, LONGEST_DISARM_DELAY_S), **self.parameters}


# What a live flight leaves behind: its telemetry log, and the flight file with record and report.

FLIGHTS = "flights"
"""Folder of a project, or of the user's data where there is no project."""


def flights_folder(project: Path | None) -> Path:
    """Where flights are kept."""
    return (data_folder() if project is None else project) / FLIGHTS


def open_log(folder: Path, unix_time_s: float, name: str) -> tuple[TelemetryLog | None, str]:
    """A new telemetry log: in the folder, else in the user's data folder; and what went wrong, else empty."""
    problem = ""
    for place in dict.fromkeys((folder, flights_folder(None))):
        try:
            return TelemetryLog(new_log_path(place, unix_time_s, name)), problem
        except InputError as error:
            problem = problem or str(error)
    return None, problem


class FlightRecordings:
    """Keeps the sorties of a plan as they end, each time with the report on all of them.

    Parameters
    ----------
    records
        Of the same plan from before.
    """

    def __init__(self, case: Case, folder: Path, records: tuple[FlightRecord, ...]) -> None:
        self._case, self._folder, self._records = case, folder, records
        self._expected_s: dict[int, float] = {}

    def ended(
        self,
        run: FlightRun,
        record: FlightRecord,
        error: GroundStationError | None,
        opened: OpenedLink | None,
        name: str,
        findings: tuple[Finding, ...] = (),
    ) -> FlightEnded:
        """A sortie is over: write what was flown, under this name; `findings` of the flight go into its report.

        A simulated one is recorded as it truly was.
        """
        orders = run.orders
        if opened is not None and opened.simulated is not None and run.recorder is not None:
            true = opened.simulated.true_record(run.recorder, orders)
            record = replace(record if true is None else true, vehicle=record.vehicle, effects=opened.effects)
        self._records = (*self._records, record)
        autopilot = run.state.autopilot or Autopilot.ARDUPILOT
        self._expected_s[orders.number] = items_duration_s(orders, autopilot)
        path = self._folder / f"{name}.json"
        report, kept, problem = store_flight(self._case, self._records, self._expected_s, path, findings)
        return FlightEnded(orders.number, error, record, report, kept, problem)


def store_flight(
    case: Case,
    records: tuple[FlightRecord, ...],
    expected_s: Mapping[int, float],
    path: Path,
    findings: tuple[Finding, ...] = (),
) -> tuple[FlightReport, Path | None, str]:
    """Report on what was flown, and write both; returns where, and why not where it could not be.

    Parameters
    ----------
    expected_s
        How long the items of sorties take by their number; plans reckon with an aircraft that turns at its waypoints.
    findings
        Of the live flight, besides those of the report.
    """
    report = report_case(case.with_plan(timed_by_items(case.plan, expected_s)), records)
    report = replace(report, findings=(*report.findings, *findings))
    problem = ""
    for place in dict.fromkeys((path, flights_folder(None) / path.name)):
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            write_flight(place, flight_of(case.plan, case.site_model, records, report))
        except (InputError, OSError) as error:
            problem = problem or str(error)
        else:
            return report, place, problem
    return report, None, problem


# The link of a live flight: every frame goes into its telemetry log, and it is opened again when it breaks.

WAIT_S = 0.05
"""How soon somebody who waits for messages looks at something else."""

RETRY_S = 1.0
"""Pause before a link that broke is opened again."""


class LoggedLink:
    """Used by one thread.

    Parameters
    ----------
    folder
        Where the log goes; where it cannot be written, the user's data folder takes its place.
    problem
        Called with what is wrong with the log, when that changes to something.
    name
        That the log's begins with.

    Attributes
    ----------
    now_s
        Gives the time by which the vehicle is watched: real time, or that of a simulation.
    """

    def __init__(
        self,
        connection: Connection,
        folder: Path,
        problem: Callable[[str], None],
        clock: Clock,
        unix_clock: Clock,
        name: str = "flight",
    ) -> None:
        self._connection, self._folder, self._problem = connection, folder, problem
        self._clock, self._unix_clock, self._prefix = clock, unix_clock, name
        self._log: TelemetryLog | None = None
        self._log_problem = ""
        self._retry_s = 0.0
        self.opened: OpenedLink | None = None
        self.now_s: Clock = clock

    @property
    def name(self) -> str:
        """Of the log without its suffix; a name made of the time where there is no log."""
        return f"{self._prefix}-{self._unix_clock():.0f}" if self._log is None else self._log.path.stem

    def open_log(self) -> None:
        """Begin the log."""
        self._log, problem = open_log(self._folder, self._unix_clock(), self._prefix)
        self._say(problem)

    def open(self, orders: SortieOrders) -> None:
        """Open the link.

        Raises
        ------
        InputError, LinkError
            It cannot be opened.
        """
        self.opened = self._connection.open(orders, self.now_s, self._frame_passed)
        self.now_s = self.opened.clock or self.now_s

    def open_again(self, orders: SortieOrders) -> None:
        """Open a link that broke, once it is time to; returns after a moment in any case.

        Raises
        ------
        LinkError
            It still cannot be opened.
        """
        time.sleep(WAIT_S)
        if self._clock() >= self._retry_s:
            self.open(orders)

    def broke(self) -> bool:
        """Close what broke, to be opened again later; False where it was closed already."""
        self._retry_s = self._clock() + RETRY_S
        opened, self.opened = self.opened, None
        if opened is not None:
            opened.link.close()
        return opened is not None

    def receive(self, wait_s: float) -> Received | None:
        """The next message; None where none came in time, or there is no link."""
        return None if self.opened is None else self.opened.link.receive(wait_s)

    def send(self, message: Message) -> None:
        """Send, where there is a link."""
        if self.opened is not None:
            self.opened.link.send(message)

    def close(self) -> None:
        """Close link and log."""
        if self.opened is not None:
            self.opened.link.close()
        if self._log is not None:
            self._log.close()

    def _frame_passed(self, frame: bytes, _is_sent: bool, _time_s: float) -> None:
        if self._log is not None:
            self._log.write(frame, self._unix_clock())
            self._say(self._log.problem)

    def _say(self, problem: str) -> None:
        if problem and problem != self._log_problem:
            self._problem(problem)
        self._log_problem = problem
