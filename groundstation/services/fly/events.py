"""What a live flight tells and what it is asked for: frozen records that cross from its thread to whoever watches."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from groundstation.services.fly.video_offer import OfferedVideo
from groundstation.vehicle.preflight import OnBoard, PreflightCheck
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.watch import FlightWarning
from missions.flight.outcome import FlightReport
from missions.flight.record import FlightRecord, TakenPhoto
from planning.base.errors import GroundStationError


class LinkState(StrEnum):
    """How the link to the vehicle is."""

    OPENING = "opening"
    SILENT = "silent"
    """It is open, and no autopilot was heard on it yet."""
    ALIVE = "alive"
    LOST = "lost"
    CLOSED = "closed"


class Request(StrEnum):
    """What the pilot asks for."""

    UPLOAD = "upload"
    START = "start"
    PAUSE = "pause"
    RESUME = "resume"
    RETURN = "return"
    LAND = "land"
    LOG = "log"
    """Fetch the vehicle's own log of the last flight; asked for again while it comes: stop that."""
    DISCONNECT = "disconnect"


class ViewState(StrEnum):
    """A planned view in flight."""

    TO_COME = "to come"
    NEXT = "next"
    TAKEN = "taken"
    OFF = "off"
    """Taken, further from its place than a flight is judged by."""
    MISSING = "missing"


@dataclass(frozen=True, slots=True)
class Readouts:
    """What the pilot reads at a glance; None where it is not known. Metric.

    Parameters
    ----------
    height_m, above_ground_m
        Above the place of take-off, and above the ground that the site knows.
    facade_m
        Distance to the nearest panel, mesh or obstacle; negative inside one.
    least_facade_m
        That the plan keeps.
    battery_left_s
        Time until the battery is at the reserve, at the aircraft's endurance.
    wind_from_deg
        Where the wind comes from, clockwise from north.
    to_go_s, next_photo_s
        Until the landing, and until the next photo; before take-off, the whole flight.
    """

    height_m: float | None = None
    above_ground_m: float | None = None
    speed_m_s: float | None = None
    facade_m: float | None = None
    least_facade_m: float = 0.0
    battery: float | None = None
    battery_left_s: float | None = None
    wind_m_s: float | None = None
    wind_from_deg: float | None = None
    fix_type: int | None = None
    n_satellites: int | None = None
    to_go_s: float | None = None
    next_photo_s: float | None = None


@dataclass(frozen=True, slots=True)
class LiveView:
    """The flight as it stands.

    Parameters
    ----------
    silent_s
        Since the last heartbeat; None before the first.
    phase
        Of the sortie; None while none was uploaded.
    checks
        The pre-flight list; empty in flight.
    doing
        What is done now, how much of it, and of how much.
    may
        What can be asked for now.
    view_states
        By identifier, in the order of flight.
    speed_up
        Of a simulation; 1 for a real vehicle.
    fetching
        How far the vehicle's own log has come, as `doing`; None while none is fetched.
    video
        What the vehicle's camera tells of its video; None while it tells nothing.
    """

    link: LinkState
    silent_s: float | None
    phase: Phase | None
    state: VehicleState
    checks: tuple[PreflightCheck, ...]
    warnings: tuple[FlightWarning, ...]
    on_board: OnBoard
    doing: tuple[str, float, float]
    may: frozenset[Request]
    readouts: Readouts
    view_states: tuple[tuple[str, ViewState], ...]
    speed_up: float = 1.0
    fetching: tuple[str, float, float] | None = None
    video: OfferedVideo | None = None


@dataclass(frozen=True, slots=True)
class FlightChanged:
    """Published at most ten times a second, and at once when the link, the phase or what can be asked for changes."""

    view: LiveView


@dataclass(frozen=True, slots=True, eq=False)
class PhotoCounted:
    """A photo was taken.

    Parameters
    ----------
    view_id
        The planned view that it is of; empty for none.
    n_new
        Sections that no photo before it showed.
    covered, covered_planned
        Sections covered by all photos so far, and by the sorties flown as they were planned.
    counts
        Shape (m, n_sections): photos that show each section. Never changed after it was published.
    seconds
        Time that the counting took.
    """

    number: int
    photo: TakenPhoto
    view_id: str
    position_error_m: float | None
    heading_error_deg: float | None
    gimbal_pitch_error_deg: float | None
    n_new: int
    covered: int
    covered_planned: int
    counts: NDArray[np.int64]
    seconds: float


@dataclass(frozen=True, slots=True)
class WarningRaised:
    """A warning appeared."""

    warning: FlightWarning


@dataclass(frozen=True, slots=True)
class WarningCleared:
    """A warning went."""

    code: str


@dataclass(frozen=True, slots=True)
class Answered:
    """What became of a request."""

    request: Request
    is_accepted: bool
    text: str


@dataclass(frozen=True, slots=True)
class LinkChanged:
    """The link opened, was lost, came back, or was closed; `text` says more."""

    link: LinkState
    text: str


@dataclass(frozen=True, slots=True)
class LinkProblem:
    """The link is open, and something about it has to be put right before vehicle and ground station understand."""

    text: str


@dataclass(frozen=True, slots=True)
class LogProblem:
    """The telemetry log cannot be written."""

    text: str


@dataclass(frozen=True, slots=True, eq=False)
class FlightEnded:
    """A sortie is over, or was given up.

    Parameters
    ----------
    sortie
        In the plan, from 1.
    error
        Why it was not flown to its end; None where it was.
    record
        None where nothing flew.
    report
        Of all that was flown of the plan on this connection.
    path
        The flight file; None where there is none.
    problem
        Why the flight file could not be written; else empty.
    """

    sortie: int
    error: GroundStationError | None
    record: FlightRecord | None
    report: FlightReport | None
    path: Path | None
    problem: str = ""


@dataclass(frozen=True, slots=True)
class LogFetched:
    """The vehicle's own log is here, or did not come.

    Parameters
    ----------
    path
        None where it did not come; `problem` says why then.
    is_checked
        The vehicle's checksum proved it.
    """

    path: Path | None
    is_checked: bool = False
    problem: str = ""


LiveEvent = (
    FlightChanged
    | PhotoCounted
    | WarningRaised
    | WarningCleared
    | Answered
    | LinkChanged
    | LinkProblem
    | LogProblem
    | LogFetched
    | FlightEnded
)
