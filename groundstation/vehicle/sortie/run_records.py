"""What a sortie being flown takes and shows: its phases, the pilot's orders, options, outcome, and how it stands."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from groundstation.vehicle.commands import LAND_MODE, MISSION_MODE, PAUSE_MODE, RETURN_MODE, CommandOutcome
from groundstation.vehicle.preflight import OnBoard, PreflightCheck
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.watch import Watch
from missions.flight.record import FlightEvent, FlightRecord
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.camera_definition import CameraDefinition
from missions.mavlink.messages import MissionItemInt
from planning.base.errors import GroundStationError


class Phase(Enum):
    """Where a sortie stands; `flight_run.py` has the transitions."""

    CONNECTING = "connecting"
    PREPARING = "preparing the vehicle"
    UPLOADING = "uploading"
    CHECKING = "checking before take-off"
    READY = "ready for take-off"
    STARTING = "starting"
    FLYING = "flying"
    ENDED = "ended"


class PilotOrder(Enum):
    """What the pilot may order at any time."""

    PAUSE = "pausing"
    RESUME = "resuming the mission"
    RETURN = "returning home"
    LAND = "landing here"


ORDER_MODES = {
    PilotOrder.PAUSE: PAUSE_MODE,
    PilotOrder.RESUME: MISSION_MODE,
    PilotOrder.RETURN: RETURN_MODE,
    PilotOrder.LAND: LAND_MODE,
}
"""The mode that carries out each order, by autopilot."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What a run may do without asking.

    Parameters
    ----------
    autopilot
        That is expected; None takes any.
    simulations_only
        Why only a vehicle may be flown that says itself that it is a simulation; empty where any may.
    sets_parameters
        The pilot agreed that the vehicle's parameters are set as the plan needs them. Those of a vehicle that says that
        it is a simulation are set in any case; else differences are told, and set by `FlightRun.set_parameters`.
    starts_itself
        Start without waiting for the pilot.
    needs_rtk
        Do not start without RTK, and say so when it is lost.
    overrules
        Codes of checks that shall not ground the flight (`preflight.OVERRULABLE`).
    own_fences
        Fences that this ground station has put on vehicles: only these are cleared without the pilot's word.
    camera_definition
        Of the camera, from a file; None: the camera is asked for its own.
    connect_s, ready_s
        Longest waits for the first heartbeat, and for the pre-flight list.
    link_lost_s
        Give up watching after so long without the link.
    """

    autopilot: Autopilot | None = None
    simulations_only: str = ""
    sets_parameters: bool = False
    starts_itself: bool = True
    needs_rtk: bool = False
    overrules: frozenset[str] = frozenset()
    own_fences: tuple[tuple[MissionItemInt, ...], ...] = ()
    camera_definition: CameraDefinition | None = None
    connect_s: float = 30.0
    ready_s: float = 180.0
    link_lost_s: float = 300.0


@dataclass(frozen=True, slots=True)
class RunOutcome:
    """How a sortie ended.

    Parameters
    ----------
    record
        What was flown, also of a sortie that failed in flight.
    notes
        What was noticed from the first heartbeat on; times by the receiver's clock.
    """

    error: GroundStationError | None
    record: FlightRecord | None
    notes: tuple[FlightEvent, ...]

    @property
    def succeeded(self) -> bool:
        """Whether it was flown to its end."""
        return self.error is None


@dataclass(frozen=True, slots=True)
class RunView:
    """A run as it stands, for views: nothing in it changes any more.

    Parameters
    ----------
    doing
        What is done now, with how much of it and of how much.
    answers
        What the vehicle said to the pilot's orders, the last at the end.
    """

    time_s: float
    phase: Phase
    state: VehicleState
    checks: tuple[PreflightCheck, ...]
    watch: Watch
    on_board: OnBoard
    doing: tuple[str, float, float]
    answers: tuple[CommandOutcome, ...]
    notes: tuple[FlightEvent, ...]
    is_link_alive: bool
