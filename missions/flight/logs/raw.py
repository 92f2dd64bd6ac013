"""What log readers gather, whoever wrote the log: times in seconds of one clock, positions still on the globe.

A reader only says what stands in the file. Cleaning, splitting into flights and turning into the site's frame is done
once for all of them, in `flights.py`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from missions.flight.record import FlightEvent
from missions.mavlink.autopilots import Autopilot
from planning.base.findings import Finding, Severity
from planning.base.messages import say

# When a photo of CAMERA_FEEDBACK was taken: its UNIX time, by the vehicle's clock since power-up.
#
# A report is mostly as old as the message before it. Not the first one after a link loss: nothing else has told the
# time since before the gap.

NEARBY_S = 5.0
"""Two clocks that are further apart than this do not tell the same time."""

SILENT_S = 0.5
"""A vehicle that is watched tells its time ten times a second; what it told this long ago is old."""

LONGEST_GAP_S = 86400.0
"""A photo that seems to be later than this tells of a wrong clock, not of a link loss."""

LEAST_UNIX_USEC = 10**15
"""Of the year 2001; what is less counts from power-up or counts nothing."""


@dataclass(frozen=True, slots=True)
class PhotoClock:
    """How far the UNIX time of photos is ahead of the vehicle's own.

    Parameters
    ----------
    unix_less_own_s
        None before it is known.
    is_of_system_time
        SYSTEM_TIME told it; else it is from a photo, which may have been some tenths of a second on its way.
    """

    unix_less_own_s: float | None = None
    is_of_system_time: bool = False

    def after_system_time(self, time_unix_usec: int, own_s: float) -> PhotoClock:
        """The clock after SYSTEM_TIME, which gives both times; the same where the UNIX time is not known yet."""
        return PhotoClock(time_unix_usec / 1e6 - own_s, True) if time_unix_usec >= LEAST_UNIX_USEC else self

    def after_photo(self, time_usec: int, own_s: float, silent_s: float) -> PhotoClock:
        """The clock after a photo, which counts where nothing told of it, and only beside a fresh time."""
        if (
            self.is_of_system_time
            or self.unix_less_own_s is not None
            or time_usec < LEAST_UNIX_USEC
            or silent_s >= SILENT_S
        ):
            return self
        return replace(self, unix_less_own_s=time_usec / 1e6 - own_s)

    def taken_s(self, time_usec: int, own_s: float, silent_s: float) -> float:
        """When a photo was taken, by the vehicle's clock; `own_s` where its UNIX time is not known or cannot be true.

        Parameters
        ----------
        own_s
            What the vehicle's clock said last.
        silent_s
            How long ago that was, by the receiver's clock: if long, the photo may be much later.
        """
        if self.unix_less_own_s is None or time_usec < LEAST_UNIX_USEC:
            return own_s
        taken_s = time_usec / 1e6 - self.unix_less_own_s
        latest_s = own_s + (NEARBY_S if silent_s < SILENT_S else LONGEST_GAP_S)
        return taken_s if own_s - NEARBY_S < taken_s < latest_s else own_s


Floats = NDArray[np.float64]

NOT_KNOWN = math.nan

YAW_LOCK, YAW_IN_VEHICLE_FRAME, YAW_IN_EARTH_FRAME = 16, 32, 64
"""GIMBAL_DEVICE_FLAGS: from where a gimbal counts its yaw. ArduPilot sets the second also where it holds the yaw."""


@dataclass(frozen=True, slots=True)
class RawPhoto:
    """A photo as a log tells of it; NaN and None where it does not say.

    Parameters
    ----------
    heading_deg, gimbal_pitch_deg
        Of the camera, clockwise from north and against the horizon.
    q_wxyz
        Attitude that came with the photo, to north, east, down. It counts only where no gimbal is heard at that time,
        because it may be the vehicle's: PX4 gives the gimbal's if it has one, else its own.
    """

    index: int
    time_s: float
    lat_deg: float = NOT_KNOWN
    lon_deg: float = NOT_KNOWN
    altitude_amsl_m: float = NOT_KNOWN
    above_home_m: float = NOT_KNOWN
    heading_deg: float | None = None
    gimbal_pitch_deg: float | None = None
    source: str = "log"
    file: str = ""
    q_wxyz: tuple[float, float, float, float] | None = None


Row = tuple[float, ...]


@dataclass(slots=True)
class RawLog:
    """A log while it is read.

    Parameters
    ----------
    autopilot
        That flew the items of a mission; None where the log does not say, or it is none that is known.
    positions
        Rows of time, latitude and longitude (degrees), altitude above mean sea level, height above home (metres).
    velocities
        Rows of time, north, east, down (m/s).
    headings
        Rows of time, heading of the nose (rad).
    gimbal_pitches, gimbal_headings
        Rows of time, angle of the camera (rad), against the horizon and north.
    gimbal_yaws
        Rows of time, angle of the camera against the nose (rad): for gimbals that say no more.
    battery
        Rows of time, charge left (1 full).
    armed
        Time, and whether the motors were armed from then on.
    photos
        What the camera said it took.
    triggers
        What it was told to take; they count where it says nothing.
    counted
        Time, and how many photos the camera had counted by then.
    """

    vehicle: str = ""
    positions: list[Row] = field(default_factory=list)
    velocities: list[Row] = field(default_factory=list)
    headings: list[Row] = field(default_factory=list)
    gimbal_pitches: list[Row] = field(default_factory=list)
    gimbal_headings: list[Row] = field(default_factory=list)
    gimbal_yaws: list[Row] = field(default_factory=list)
    battery: list[Row] = field(default_factory=list)
    armed: list[tuple[float, bool]] = field(default_factory=list)
    photos: list[RawPhoto] = field(default_factory=list)
    triggers: list[RawPhoto] = field(default_factory=list)
    counted: list[tuple[float, int]] = field(default_factory=list)
    autopilot: Autopilot | None = None
    events: list[FlightEvent] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)

    def note(self, code: str, message: str, value: float | None = None) -> None:
        """Add a finding that the pilot should know of."""
        self.findings.append(Finding(Severity.WARNING, code, message, "", value))

    def arm(self, time_s: float, is_armed: bool) -> None:
        """Note the state of the motors; only changes are kept."""
        if not self.armed or self.armed[-1][1] != is_armed:
            self.armed.append((time_s, is_armed))
            self.events.append(FlightEvent(time_s, "armed" if is_armed else "disarmed", ""))

    def gimbal(self, time_s: float, q_wxyz: Sequence[float], flags: int) -> None:
        """Note how a gimbal device stands; an attitude that is none is passed over."""
        angles = camera_angles_rad(*q_wxyz)
        if angles is not None:
            heading, pitch = angles
            (self.gimbal_headings if is_yaw_from_north(flags) else self.gimbal_yaws).append((time_s, heading))
            self.gimbal_pitches.append((time_s, pitch))

    def camera_failed(self, time_s: float, index: int) -> None:
        """Note that the camera was told to take a photo and did not."""
        self.events.append(FlightEvent(time_s, "camera-failed", say("the camera says that photo {} failed", index)))

    def mode(self, time_s: float, name: str) -> None:
        """Note the flight mode; only changes are kept."""
        last = next((event.text for event in reversed(self.events) if event.code == "mode"), None)
        if name != last:
            self.events.append(FlightEvent(time_s, "mode", name))


def is_yaw_from_north(flags: int) -> bool:
    """Whether a gimbal device counts its yaw from north, not from the nose, by its GIMBAL_DEVICE_FLAGS.

    Without either of the two flags that say so, the yaw is from north while it is locked.
    """
    return not flags & YAW_IN_VEHICLE_FRAME and bool(flags & (YAW_IN_EARTH_FRAME | YAW_LOCK))


def camera_angles_rad(w: float, x: float, y: float, z: float) -> tuple[float, float] | None:
    """Heading (or yaw) and pitch of a camera from its quaternion, which turns its axes to north, east, down.

    The heading is read off the camera's right-hand axis, so that it is known straight down, too; that takes the roll as
    zero, as gimbals keep it. None where the quaternion is none (zero, NaN, not of length one within 2 %).
    """
    norm = math.sqrt(w * w + x * x + y * y + z * z) if all(map(math.isfinite, (w, x, y, z))) else 0.0
    if abs(norm - 1.0) > 0.02:
        return None
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    heading = math.atan2(2.0 * (w * z - x * y), 1.0 - 2.0 * (x * x + z * z))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - x * z))))
    return heading, pitch


def table(rows: list[Row], n_columns: int) -> Floats:
    """Rows as an array of shape (n, n_columns), in the order of time; rows with a time that is none are left out."""
    values = np.array(rows, np.float64).reshape(-1, n_columns)
    values = values[np.isfinite(values[:, 0])]
    return values[np.argsort(values[:, 0], kind="stable")]
