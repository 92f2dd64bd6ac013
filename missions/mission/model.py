"""The mission: one sortie as an aircraft is told it, before any file format, and what is read back from a file.

Two families of records. `Mission` is complete and is written: every height is known, every photo has its angles.
`ReadMission` is what a file says, no more: heights in the file's own reference, angles that may be missing.

Heights have three references and three names, never mixed:

- `height_ellipsoid_m`: above the WGS 84 ellipsoid (GNSS receivers, RTK, photogrammetry);
- `altitude_amsl_m`: above the EGM96 geoid ("mean sea level"; MAVLink's absolute altitude, DJI's EGM96, KML);
- `height_above_takeoff_m`: above the point where this sortie takes off, as a difference of ellipsoid heights.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from missions.mission.export_choices import HeightReference
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import glue, joined, say
from planning.geo.frames import Origin
from planning.optics import CameraControls
from planning.parameters import CameraSettings, ExposureMode, FlightRules, FocusMode
from planning.plan import Aircraft, Camera

if TYPE_CHECKING:
    from pyproj import Geod


# Lengths, courses and points along the legs of a geodetic polyline.

VERTICAL_LEG_M = 0.05
"""A leg that moves less than this sideways is vertical: no course can be read from it. GNSS noise is larger."""

MAX_SHOTS = 10_000
"""Photos on one leg, far more than a camera takes on a battery; only a wrong number asks for more."""


@cache
def _geod() -> Geod:
    from pyproj import Geod

    return Geod(ellps="WGS84")


def leg_lengths_m(lat_deg: ArrayLike, lon_deg: ArrayLike, height_m: ArrayLike) -> NDArray[np.float64]:
    """Straight lengths between consecutive points, shape (n - 1,) from n points; heights in any one reference."""
    from planning.geo.enu import enu_from_geodetic

    lat, lon, height = (np.asarray(values, np.float64) for values in (lat_deg, lon_deg, height_m))
    if len(lat) < 2:
        return np.zeros(0)
    # Heights above take-off are counted from some height near sea level; 1 km more would stretch legs by 0.02 %.
    first = Origin(float(lat[0]), float((lon[0] + 180.0) % 360.0 - 180.0), 0.0)
    points = enu_from_geodetic(first, lat, lon, height)
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def courses_deg(lat_deg: Sequence[float], lon_deg: Sequence[float]) -> list[float | None]:
    """Course at the start of each leg, clockwise from north in (-180, 180]; None for vertical legs."""
    if len(lat_deg) < 2:
        return []
    azimuth, _, distance_m = _geod().inv(lon_deg[:-1], lat_deg[:-1], lon_deg[1:], lat_deg[1:])
    pairs = zip(azimuth, distance_m, strict=True)
    return [None if away_m < VERTICAL_LEG_M else _wrapped(float(angle)) for angle, away_m in pairs]


def bearing_deg(from_lat_deg: float, from_lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> float:
    """Direction from one point to another, clockwise from north in (-180, 180]."""
    azimuth, _, _ = _geod().inv(from_lon_deg, from_lat_deg, to_lon_deg, to_lat_deg)
    return _wrapped(float(azimuth))


def distance_m(from_lat_deg: float, from_lon_deg: float, to_lat_deg: float, to_lon_deg: float) -> float:
    """Horizontal distance of two points along the ellipsoid, metres."""
    _, _, away_m = _geod().inv(from_lon_deg, from_lat_deg, to_lon_deg, to_lat_deg)
    return float(away_m)


def point_between(
    start_lat_deg: float, start_lon_deg: float, end_lat_deg: float, end_lon_deg: float, fraction: float
) -> tuple[float, float]:
    """Latitude and longitude at `fraction` (0 to 1) of the geodesic from start to end."""
    geod: Any = _geod()
    azimuth, _, away_m = geod.inv(start_lon_deg, start_lat_deg, end_lon_deg, end_lat_deg)
    lon, lat, _ = geod.fwd(start_lon_deg, start_lat_deg, azimuth, away_m * fraction)
    return float(lat), float(lon)


def are_too_many(length: float, spacing: float) -> bool:
    """Whether a camera that triggers every `spacing` would take more photos on a leg than any camera can."""
    return spacing > 0.0 and not length / spacing <= MAX_SHOTS


def too_many_shots(length: float, spacing: float) -> str:
    """What is to be said then."""
    return say(
        "a camera trigger every {:g} would take {:.3g} photos on one leg; it is not followed", spacing, length / spacing
    )


def shots_on_leg(travelled: float, length: float, spacing: float) -> list[float]:
    """Where on a leg a camera triggers that triggers every `spacing`, as fractions of the leg in (0, 1].

    Parameters
    ----------
    travelled
        Way (or time) since the trigger was armed, at the start of the leg; a shot at its very start belongs to the
        leg before.
    length, spacing
        Of the leg and between shots, in the unit of `travelled`.

    Raises
    ------
    MissionError
        There would be more than `MAX_SHOTS` shots.
    """
    if length <= 0.0 or spacing <= 0.0:
        return []
    if are_too_many(length, spacing):
        raise MissionError(too_many_shots(length, spacing))
    # A shot within 1e-9 of a spacing after the end is that of the end itself, moved by rounding.
    first, last = np.floor(travelled / spacing + 1e-9) + 1.0, np.floor((travelled + length) / spacing + 1e-9)
    shots = (np.arange(first, last + 1.0) * spacing - travelled) / length
    return [min(1.0, float(shot)) for shot in shots]


def _wrapped(angle_deg: float) -> float:
    return angle_deg if angle_deg > -180.0 else 180.0


@dataclass(frozen=True, slots=True)
class GeoPoint:
    """A point on WGS 84: degrees, and metres above the ellipsoid."""

    lat_deg: float
    lon_deg: float
    height_ellipsoid_m: float


@dataclass(frozen=True, slots=True)
class Photo:
    """One photo taken at a waypoint: heading clockwise from true north in (-180, 180], gimbal pitch 0 level."""

    viewpoint_id: str
    heading_deg: float
    gimbal_pitch_deg: float


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A vertex of the flown path; without photos it is only passed, to stay on the checked path."""

    position: GeoPoint
    photos: tuple[Photo, ...] = ()


@dataclass(frozen=True, slots=True)
class Mission:
    """One sortie, ready to be written in any format.

    The aircraft climbs vertically from `takeoff` to the height of the first waypoint, which is straight above it,
    flies straight lines through the waypoints, and from the last one, again above `takeoff`, descends vertically.

    Parameters
    ----------
    number
        Of the sortie in its plan, from 1.
    profile
        Identifier in the aircraft catalogue; empty when the plan's aircraft is in none.
    speed_m_s
        Cruise speed of all legs.
    length_m, duration_s
        Of the whole sortie, take-off and landing included, by the plan's own time model.
    origin
        Of the plan's local frame, which tables of local coordinates use.
    """

    name: str
    number: int
    takeoff: GeoPoint
    waypoints: tuple[Waypoint, ...]
    aircraft: Aircraft
    camera: Camera
    profile: str
    rules: FlightRules
    speed_m_s: float
    length_m: float
    duration_s: float
    origin: Origin
    camera_settings: CameraSettings = CameraSettings()
    camera_controls: CameraControls | None = None
    f_number: float | None = None
    """With which photos are taken, stated or chosen; None where it is not known."""

    @property
    def n_photos(self) -> int:
        """Number of photos."""
        return sum(len(waypoint.photos) for waypoint in self.waypoints)

    def height_above_takeoff_m(self, point: GeoPoint) -> float:
        """Height of `point` above the take-off point, as a difference of ellipsoid heights."""
        return point.height_ellipsoid_m - self.takeoff.height_ellipsoid_m


@dataclass(frozen=True, slots=True)
class ReadPhoto:
    """One photo that a file tells the aircraft to take; an angle is None where the file leaves it open.

    `viewpoint_id` is empty where the file names none. A photo `in_passing` costs no stop: the camera is released by
    time or distance, or at a waypoint that the aircraft flies through.
    """

    heading_deg: float | None
    gimbal_pitch_deg: float | None
    viewpoint_id: str = ""
    in_passing: bool = False

    def __post_init__(self) -> None:
        if self.heading_deg is not None and not -180.0 <= self.heading_deg <= 360.0:
            raise ValueError(f"heading_deg: expected -180 to 360, got {self.heading_deg}")
        if self.gimbal_pitch_deg is not None and not -180.0 <= self.gimbal_pitch_deg <= 90.0:
            raise ValueError(f"gimbal_pitch_deg: expected -180 to 90, got {self.gimbal_pitch_deg}")


@dataclass(frozen=True, slots=True)
class Stay:
    """What an aircraft does at a waypoint, as far as it takes time.

    Parameters
    ----------
    passing_m
        It flies through, and leaves its leg so far before the waypoint (infinite: as early as it likes); None where it
        stops.
    wait_s
        Time at rest without turning.
    turn_deg
        What nose and gimbal turn while it rests, the longer of the two each time.
    """

    passing_m: float | None = None
    wait_s: float = 0.0
    turn_deg: float = 0.0

    @property
    def is_stop(self) -> bool:
        """Whether it comes to rest."""
        return self.passing_m is None or self.wait_s > 0.0 or self.turn_deg > 0.0


ON_THE_WAY = Stay(passing_m=math.inf)
"""A place on a leg."""


@dataclass(frozen=True, slots=True)
class ReadWaypoint:
    """A point of a mission that was read; exactly one of the two heights is known.

    `stay` is None where the file says nothing about it: then every photo takes the time that plans give it. `speed_m_s`
    is that of the leg which begins here, None where it is the mission's.
    """

    lat_deg: float
    lon_deg: float
    height_ellipsoid_m: float | None = None
    height_above_takeoff_m: float | None = None
    photos: tuple[ReadPhoto, ...] = ()
    stay: Stay | None = None
    speed_m_s: float | None = None

    def __post_init__(self) -> None:
        if (self.height_ellipsoid_m is None) == (self.height_above_takeoff_m is None):
            raise ValueError("expected one of height_ellipsoid_m and height_above_takeoff_m, got both or neither")
        if not (abs(self.lat_deg) <= 90.0 and abs(self.lon_deg) <= 180.0):
            raise ValueError(f"expected a position on the globe, got {self.lat_deg}, {self.lon_deg}")
        height_m = self.height_above_takeoff_m if self.height_ellipsoid_m is None else self.height_ellipsoid_m
        if height_m is None or not math.isfinite(height_m):
            raise ValueError(f"expected a finite height, got {height_m}")


class Finish(StrEnum):
    """What the aircraft does after the last waypoint of a mission that was read."""

    RETURN = "return"
    """It flies straight home and lands there."""
    LAND = "land"
    """It lands where it is."""
    HOVER = "hover"
    """It waits for the pilot."""


@dataclass(frozen=True, slots=True)
class ReadCamera:
    """What a file tells the camera besides to take photos, as `CameraSettings`; None where it does not say."""

    exposure: ExposureMode | None = None
    shutter_s: float | None = None
    aperture: float | None = None
    iso: int | None = None
    focus: FocusMode | None = None
    focus_distance_m: float | None = None

    def over(self, settings: CameraSettings) -> CameraSettings:
        """Settings with what the file says; a focus at a distance that the file does not name stays as it was."""
        said = {name: value for name in self.__slots__ if (value := getattr(self, name)) is not None}
        if self.focus == "distance" and self.focus_distance_m is None:
            del said["focus"]
        elif self.focus is not None:
            said["focus_distance_m"] = self.focus_distance_m
        if self.exposure == "manual" and (self.shutter_s is None or self.iso is None):
            del said["exposure"]
        return replace(settings, **said)


NOTHING_SAID = ReadCamera()


@dataclass(frozen=True, slots=True)
class ReadMission:
    """One sortie as a file describes it.

    Parameters
    ----------
    takeoff
        Where the file expects the take-off; None where it does not say.
    height_reference
        Of the heights in the file.
    climb_above_takeoff_m, return_above_takeoff_m
        Heights above take-off to which the aircraft climbs at least before it leaves the take-off column, and before
        it flies home after the last waypoint; 0 where the file does not say.
    speed_m_s
        Cruise speed; None where the file does not say.
    transit_speed_m_s
        Speed to the first waypoint and home from the last; None where it is the cruise speed.
    stated_s
        Time from the first to the last waypoint as the file states it; None where it does not.
    findings
        What the file's checks found and what had to be assumed; never an error, a file with errors is not read.
    camera
        What it tells the camera.
    """

    name: str
    path: Path
    format: str
    waypoints: tuple[ReadWaypoint, ...]
    takeoff: GeoPoint | None
    height_reference: HeightReference
    finish: Finish = Finish.RETURN
    climb_above_takeoff_m: float = 0.0
    return_above_takeoff_m: float = 0.0
    speed_m_s: float | None = None
    transit_speed_m_s: float | None = None
    stated_s: float | None = None
    findings: tuple[Finding, ...] = ()
    camera: ReadCamera = NOTHING_SAID

    @property
    def n_photos(self) -> int:
        """Number of photos."""
        return sum(len(waypoint.photos) for waypoint in self.waypoints)


def as_warning(finding: Finding) -> Finding:
    """A check's error, which grounds a file but not the evaluation of what it would do, as a warning."""
    if finding.severity is not Severity.ERROR:
        return finding
    return replace(finding, severity=Severity.WARNING, message=say("the vehicle would refuse it: {}", finding.message))


MAX_REASONS = 3
"""Kinds of errors that a refusal spells out; the others are counted."""


def reasons(errors: Sequence[Finding]) -> str:
    """One example of each kind of error, and how often it occurs."""
    kinds: dict[str, list[Finding]] = {}
    for error in errors:
        kinds.setdefault(error.code, []).append(error)
    examples = []
    for found in list(kinds.values())[:MAX_REASONS]:
        place = found[0].place.strip(", ")
        times = say(" ({} times)", len(found)) if len(found) > 1 else ""
        examples.append(glue(f"{place}: " if place else "", found[0].message, times))
    return joined("; ", examples) + (
        say("; and {} other kinds", len(kinds) - MAX_REASONS) if len(kinds) > MAX_REASONS else ""
    )


# Heights between the WGS 84 ellipsoid and mean sea level, which in every mission format means the EGM96 geoid.


def altitude_amsl_m(point: GeoPoint) -> float:
    """Altitude of a point above the EGM96 geoid, metres."""
    from planning.geo.geoid import amsl_from_ellipsoid_m

    return float(amsl_from_ellipsoid_m(point.lat_deg, point.lon_deg, point.height_ellipsoid_m))


def point_at_amsl(lat_deg: float, lon_deg: float, altitude_amsl_m: float) -> GeoPoint:
    """Point that is given by its altitude above the EGM96 geoid."""
    from planning.geo.geoid import ellipsoid_from_amsl_m

    return GeoPoint(lat_deg, lon_deg, float(ellipsoid_from_amsl_m(lat_deg, lon_deg, altitude_amsl_m)))
