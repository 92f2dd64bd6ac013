"""What a live flight talks to: a vehicle at the end of a link, or a simulated one in this process."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

from groundstation.services.fly.ground_truth import TruthRecorder
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.recorder import Recorder
from missions.flight.record import FlightRecord
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import FrameObserver, Link, memory_pair, open_link
from missions.mavlink.messages import Message
from missions.mavlink.signing import Signer
from missions.mavlink.wire import Counts
from missions.simulator.airframe.state import Airframe, Battery, Fix, Pose, Target
from missions.simulator.autopilot.profiles import vehicle_profile
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.battery import BatterySag
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.link_loss import through_air
from missions.simulator.server import MAX_SPEEDUP, serve
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.effects import Decision, EffectSetting
from planning.base.progress import Clock
from planning.geo.frames import Origin, Vec3
from planning.plan import Plan
from planning.site.records import SiteModel

# A simulated aircraft whose battery was flown before.


class FlownBefore:
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
    def believed(self) -> Pose:
        """Where the autopilot's estimator says it is."""
        return self._airframe.believed

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
    return FlownBefore(airframe, charge, sags=sags)


SAMPLE_S = 0.1
"""Simulated time between two notes of where the aircraft truly is."""

LONGEST_DISARM_DELAY_S = 127.0
"""Range of ArduPilot's DISARM_DELAY."""

CALM = Conditions()
"""No wind, RTK, no loss."""


class SampledVehicle(SimulatedVehicle):
    """A simulated vehicle that notes where it truly is, on the thread that flies it."""

    def __init__(
        self, autopilot: Autopilot, airframe: Airframe, origin: Origin, parameters: Mapping[str, float | None]
    ) -> None:
        super().__init__(autopilot, airframe, origin, parameters=parameters, is_ready=True)
        self._lock = threading.Lock()
        self._truth = TruthRecorder(self)

    def step(self, duration_s: float) -> list[Message]:
        """Fly on for a simulated time; what the vehicle says meanwhile."""
        said: list[Message] = []
        with self._lock:
            n_steps = max(1, math.ceil(duration_s / SAMPLE_S))
            for _ in range(n_steps):
                said += super().step(duration_s / n_steps)
                self._truth.sample()
        return said

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
    """

    link: Link
    effects: tuple[Decision, ...] = ()
    simulated: SampledVehicle | None = None
    counts: Counts | None = None
    is_signed: bool = False


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
    wishes
        On, off or auto by the name of an effect.
    charge
        Of the battery when the link is opened, 1 full to 0 empty.
    seed
        The same seed gives the same errors.
    stands_enu_m
        Where the aircraft stands; None: at home.
    parameters
        Of the vehicle, where they differ from its profile's; None for one that it does not have.
    """

    plan: Plan
    site_model: SiteModel
    autopilot: Autopilot = Autopilot.ARDUPILOT
    speed_up: float = 1.0
    conditions: Conditions = CALM
    wishes: Mapping[str, EffectSetting] = field(default_factory=dict)
    charge: float = 1.0
    seed: int = 0
    stands_enu_m: Vec3 | None = None
    parameters: Mapping[str, float | None] = field(default_factory=dict)
    is_simulated: bool = True

    def __post_init__(self) -> None:
        if not 0.1 <= self.speed_up <= MAX_SPEEDUP:
            raise ValueError(f"speed_up: expected 0.1 to {MAX_SPEEDUP:g}, got {self.speed_up:g}")

    @property
    def name(self) -> str:
        """For the flight record."""
        return f"simulation, {self.speed_up:g} times as fast"

    def open(self, orders: SortieOrders, clock: Clock, observe: FrameObserver) -> OpenedLink:
        """Put the aircraft at home, switched on a while ago."""
        sortie = self.plan.sorties[orders.number - 1]
        airframe, decisions = make_airframe(
            self.plan,
            self.site_model,
            sortie,
            conditions=self.conditions,
            settings=self.wishes,
            home_enu_m=self.stands_enu_m,
            seed=self.seed,
            autopilot=self.autopilot,
        )
        flown = with_charge(airframe, self.charge, decisions)
        vehicle = SampledVehicle(self.autopilot, flown, self.site_model.site.origin, self._parameters())
        ground, air = memory_pair(vehicle=vehicle.address, clock=clock)
        ground.observe(observe)
        link = through_air(ground, decisions, self.conditions, lambda: vehicle.flight_s, self.seed)
        # It ends when the link is closed.
        threading.Thread(
            target=serve,
            args=(vehicle, [air], self.speed_up),
            kwargs={"is_heard": ground.is_idle},
            name="simulated-vehicle",
            daemon=True,
        ).start()
        return OpenedLink(link, decisions, vehicle)

    def _parameters(self) -> dict[str, float | None]:
        """What a vehicle whose time runs faster than the orders to it needs to be set otherwise.

        ArduPilot stops its motors where it is not told to take off within DISARM_DELAY after arming: 10 s, which forty
        times as fast are over before the next order has come.
        """
        if self.autopilot is not Autopilot.ARDUPILOT or self.speed_up <= 1.0:
            return dict(self.parameters)
        usual_s = vehicle_profile(self.autopilot).parameters["DISARM_DELAY"]
        return {"DISARM_DELAY": min(usual_s * self.speed_up, LONGEST_DISARM_DELAY_S), **self.parameters}
