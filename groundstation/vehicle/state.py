"""What is known of a vehicle: one frozen record of values, each with the time at which it was heard."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Generic, TypeVar

from missions.flight.logs.raw import NEARBY_S, PhotoClock
from missions.flight.record import TakenPhoto
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address
from planning.geo.frames import Angles, Vec3

Value = TypeVar("Value")

LINK_LOST_S = 3.0
"""Without a heartbeat for longer than this, of which one comes every second, the link counts as lost."""

MAX_TEXTS = 100
"""The autopilot's last texts that are kept."""


@dataclass(frozen=True, slots=True)
class Timed(Generic[Value]):
    """A value and when it was heard, by the receiver's clock."""

    value: Value
    time_s: float

    def age_s(self, now_s: float) -> float:
        """Seconds since it was heard."""
        return now_s - self.time_s


class Landed(Enum):
    """Whether it flies, as the autopilot sees it."""

    UNKNOWN = "unknown"
    ON_GROUND = "on the ground"
    IN_AIR = "in the air"
    TAKING_OFF = "taking off"
    LANDING = "landing"


@dataclass(frozen=True, slots=True)
class Motion:
    """Place and speed in the site's frame.

    `height_above_home_m` is the vehicle's own, above where it was armed.
    """

    position_enu_m: Vec3
    velocity_enu_m_s: Vec3
    height_above_home_m: float


@dataclass(frozen=True, slots=True)
class GnssFix:
    """What the GNSS receiver says of itself: MAVLink's GPS_FIX_TYPE; accuracies, 1 sigma, None where it says none.

    `geoid_m` is how far its own geoid, from which it counts altitudes, lies above the ellipsoid; None where it does not
    tell. Receivers carry coarse geoids, some metres from EGM96 in places.
    """

    fix_type: int
    n_satellites: int
    horizontal_accuracy_m: float | None
    vertical_accuracy_m: float | None
    geoid_m: float | None = None


@dataclass(frozen=True, slots=True)
class BatteryLevel:
    """What the battery monitor says; None where it does not know. `remaining` is 1 full, 0 empty."""

    remaining: float | None
    voltage_v: float | None = None
    current_a: float | None = None
    consumed_mah: float | None = None


@dataclass(frozen=True, slots=True)
class EstimatorHealth:
    """Whether the autopilot knows where it is.

    `problem` says what it lacks, empty where it lacks nothing.
    """

    problem: str = ""


@dataclass(frozen=True, slots=True)
class MissionProgress:
    """Item that is being flown, and the item reached last (-1: none).

    `lists` is what tells one set of lists on board from another: the number of mission items (65535: none, 0: not
    told) and the vehicle's own numbers of its mission, fence and rally points (0: not told). None: not heard since they
    were read.
    """

    current: int = 0
    reached: int = -1
    lists: tuple[int, int, int, int] | None = None


@dataclass(frozen=True, slots=True)
class RemoteIdStatus:
    """What the module for remote identification says; `problem` is empty where it is content."""

    problem: str


@dataclass(frozen=True, slots=True)
class VehicleText:
    """A text of the autopilot; `severity` 0 emergency to 7 debug."""

    time_s: float
    severity: int
    text: str
    chunk_id: int = 0


@dataclass(frozen=True, slots=True)
class VehicleState:
    """Everything that a vehicle has told so far; None is what it has not.

    Parameters
    ----------
    address
        Of the autopilot that is listened to: the first that was heard.
    heard
        Time of its last message of any kind.
    heartbeat
        Its last heartbeat; the value counts them.
    boot_time_s, boot_time_heard_s
        The vehicle's own time: seconds since it was switched on, and when it told that. In a simulation faster than
        real time it runs ahead.
    photo_clock
        From the UNIX time of photos to the vehicle's own.
    home_altitude_amsl_m, home_heard_s
        From where it counts heights above home, as its positions tell, and when; PX4 corrects it in flight.
    home_position_amsl_m
        The same as HOME_POSITION tells it.
    camera
        Attitude of the camera as the gimbal reports it, against north and the horizon.
    wind_enu_m_s
        Wind that blows towards this direction.
    others
        Systems besides it on the link that are vehicles, too.
    turns_back_s
        When its own time last went back, by the receiver's clock: once at a restart, again and again where two vehicles
        go by one number.
    vehicle_type
        MAV_TYPE of its first heartbeat.
    impostor, left_enu_m
        Why there must be two vehicles with its number, empty where nothing says so; and the place that its positions
        last jumped away from.
    remote_id
        What its module for remote identification says; None for a vehicle without one.
    sensor_problems
        Names of enabled sensors that are not healthy.
    photos
        Every photo that was reported, once, in the order of arrival; times are the vehicle's own.
    """

    address: Address | None = None
    autopilot: Autopilot | None = None
    heard: float | None = None
    heartbeat: Timed[int] | None = None
    boot_time_s: float | None = None
    boot_time_heard_s: float = 0.0
    photo_clock: PhotoClock = field(default_factory=PhotoClock)
    mode: Timed[str] | None = None
    armed: Timed[bool] | None = None
    landed: Timed[Landed] | None = None
    motion: Timed[Motion] | None = None
    home_altitude_amsl_m: float | None = None
    home_heard_s: float = 0.0
    home_position_amsl_m: float | None = None
    attitude: Timed[Angles] | None = None
    camera: Timed[Angles] | None = None
    fix: Timed[GnssFix] | None = None
    battery: Timed[BatteryLevel] | None = None
    wind_enu_m_s: Timed[Vec3] | None = None
    estimator: Timed[EstimatorHealth] | None = None
    home_enu_m: Timed[Vec3] | None = None
    mission: Timed[MissionProgress] | None = None
    sensor_problems: Timed[tuple[str, ...]] | None = None
    remote_id: Timed[RemoteIdStatus] | None = None
    others: frozenset[int] = frozenset()
    turns_back_s: tuple[float, ...] = ()
    vehicle_type: int | None = None
    impostor: str = ""
    left_enu_m: Timed[Vec3] | None = None
    texts: tuple[VehicleText, ...] = ()
    photos: tuple[TakenPhoto, ...] = ()

    def is_link_alive(self, now_s: float) -> bool:
        """Whether a heartbeat came within the last `LINK_LOST_S`."""
        return self.heartbeat is not None and self.heartbeat.age_s(now_s) <= LINK_LOST_S

    @property
    def is_armed(self) -> bool:
        """Whether its last heartbeat said so."""
        return self.armed is not None and self.armed.value


def after_restart(state: VehicleState) -> VehicleState:
    """What is still known of a vehicle that was restarted."""
    return VehicleState(
        address=state.address,
        autopilot=state.autopilot,
        vehicle_type=state.vehicle_type,
        others=state.others,
        turns_back_s=state.turns_back_s,
        impostor=state.impostor,
    )


def is_restarted(before: VehicleState, after: VehicleState) -> bool:
    """Whether the vehicle's own time began anew between two states."""
    if before.boot_time_s is None or after.boot_time_s is None:
        return False
    return after.boot_time_s < before.boot_time_s - NEARBY_S
