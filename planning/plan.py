"""The plan: camera, aircraft, constraints, viewpoints, sorties and what they cover; mirrors `plan.json` field by field.

Angles stand in degrees here because these records are the file; arrays of radians are made by `viewpoint_arrays`.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.files import read_input_file
from planning.base.json_file import JSON_FILE, expect_format, parse_json, plain_values, to_record, write_atomically
from planning.base.messages import joined, say
from planning.geo.frames import Origin, Vec3
from planning.optics import CameraControls, Lens
from planning.parameters import CameraSettings, Constraints, FlightRules
from planning.site.records import check_point

PLAN_FORMAT = "reflight-plan/1"

POSITION_DECIMALS = 4
ANGLE_DECIMALS = 3
"""Of positions (0.1 mm) and angles in degrees, in plan files and missions: what was counted is what is flown."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera with rectangular field of view and the limits of the gimbal that carries it."""

    name: str
    sensor_width_mm: float
    sensor_height_mm: float
    focal_length_mm: float
    image_width_px: int
    image_height_px: int
    gimbal_pitch_deg: tuple[float, float]

    def __post_init__(self) -> None:
        for field in ("sensor_width_mm", "sensor_height_mm", "focal_length_mm", "image_width_px", "image_height_px"):
            value = getattr(self, field)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(say("expected a positive number, got {}", value, place=field))
        low, high = self.gimbal_pitch_deg
        if not -180.0 <= low <= high <= 90.0:
            raise ValueError(
                say("expected [lowest, highest] within -180 to 90, got [{}, {}]", low, high, place="gimbal_pitch_deg")
            )

    @property
    def half_width(self) -> float:
        """Tangent of half the horizontal field of view."""
        return self.sensor_width_mm / (2.0 * self.focal_length_mm)

    @property
    def half_height(self) -> float:
        """Tangent of half the vertical field of view."""
        return self.sensor_height_mm / (2.0 * self.focal_length_mm)

    @property
    def pixel_angle_rad(self) -> float:
        """Angle that one pixel spans at the image centre."""
        return self.sensor_width_mm / (self.focal_length_mm * self.image_width_px)

    @property
    def pixel_mm(self) -> float:
        """Width of a pixel on the sensor."""
        return self.sensor_width_mm / self.image_width_px

    def lens(self, f_number: float) -> Lens:
        """The lens at an f-number."""
        return Lens(self.focal_length_mm, f_number, self.pixel_mm)

    def gsd_m(self, distance_m: float) -> float:
        """Ground sampling distance across the line of sight at `distance_m`, metres per pixel."""
        return distance_m * self.pixel_angle_rad

    def distance_for_gsd_m(self, gsd_m: float) -> float:
        """Distance at which `gsd_m` is reached, metres."""
        return gsd_m / self.pixel_angle_rad


@dataclass(frozen=True, slots=True)
class Aircraft:
    """What an aircraft can do. Speeds, rates and times are those used for durations and battery use."""

    name: str
    endurance_s: float
    max_speed_m_s: float
    max_acceleration_m_s2: float = 2.5
    max_jerk_m_s3: float | None = None
    """How fast acceleration may change; None where the maker says nothing. Decides the time of legs of a few metres."""
    max_ascent_m_s: float = 4.0
    max_descent_m_s: float = 3.0
    max_yaw_rate_deg_s: float = 60.0
    max_gimbal_rate_deg_s: float = 60.0
    max_wind_m_s: float = 10.0
    max_waypoints: int = 65535
    min_photo_interval_s: float = 0.7
    min_waypoint_spacing_m: float = 0.5
    """DJI's firmware refuses waypoints closer together; kept for aircraft that are not known, too. 0: no such rule."""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.min_waypoint_spacing_m) and self.min_waypoint_spacing_m >= 0.0):
            raise ValueError(
                say("expected 0 or more, got {}", self.min_waypoint_spacing_m, place="min_waypoint_spacing_m")
            )
        for field in self.__slots__:
            value = getattr(self, field)
            if field in ("name", "min_waypoint_spacing_m") or (field == "max_jerk_m_s3" and value is None):
                continue
            if not (math.isfinite(value) and value > 0):
                raise ValueError(say("expected a positive number, got {}", value, place=field))


USUAL_GSD_M = 0.020
"""Largest pixel with which a panel-by-panel model shows what it is for: the finest thing on a facade is the profile
between two panes, some 50 mm wide, which has to be two pixels to be seen at all (sampling theorem); half a pixel is
left for what demosaicing blurs. Profiles of 1 to 3 pixels are still measured (docs/concepts/segmentation.md)."""

NEAREST_REACH = 2.5
"""Views from so many times the minimum distance always count as sharp: from as near as is allowed, a facade is seen up
to 66 degrees aside, and no flight could do better."""


def usual_gsd_m(camera: Camera, min_distance_m: float) -> float:
    """Largest pixel on a panel with which a view counts as sharp where nothing else is wanted, metres."""
    return max(USUAL_GSD_M, camera.gsd_m(NEAREST_REACH * min_distance_m))


def sharp_distance_m(camera: Camera, constraints: Constraints) -> float | None:
    """Distance up to which views are sharp; None where any counts as that."""
    wanted_mm = constraints.wanted_gsd_mm
    gsd_m = usual_gsd_m(camera, constraints.min_distance_m) if wanted_mm is None else wanted_mm / 1000.0
    return camera.distance_for_gsd_m(gsd_m) if gsd_m > 0.0 else None


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """One photo: where the camera is and where it looks (roll 0)."""

    id: str
    position_enu_m: Vec3
    heading_deg: float
    gimbal_pitch_deg: float
    locked: bool = False
    """To be kept as it is: planning again keeps it, and it is not moved or deleted by hand."""

    def __post_init__(self) -> None:
        if not self.id:
            raise ValueError(say("expected a name, got an empty text", place="id"))
        check_point(self.position_enu_m, "position_enu_m")
        if not -180.0 <= self.heading_deg <= 360.0:
            raise ValueError(say("expected (-180, 180], got {}", self.heading_deg, place="heading_deg"))
        if not -180.0 <= self.gimbal_pitch_deg <= 90.0:
            raise ValueError(say("expected -180 to 90, got {}", self.gimbal_pitch_deg, place="gimbal_pitch_deg"))


@dataclass(frozen=True, slots=True)
class Sortie:
    """One flight on one battery, from take-off to landing.

    `path_enu_m` is the polyline really flown; the sortie's viewpoints are among its vertices, in order. Photos of those
    in `in_passing_ids` are taken without a stop, as missions of other programs do that release the camera by time or
    distance. Where several aircraft fly at once, `start_s` is when its motors are switched on, from the first start of
    all on, and `aircraft` by which one, from 1.
    """

    viewpoint_ids: tuple[str, ...]
    path_enu_m: tuple[Vec3, ...]
    length_m: float
    duration_s: float
    in_passing_ids: tuple[str, ...] = ()
    start_s: float | None = None
    aircraft: int | None = None

    def __post_init__(self) -> None:
        if (self.start_s is None) != (self.aircraft is None):
            raise ValueError(say("expected a start with its aircraft, or neither", place="start_s"))
        if self.start_s is not None and not 0.0 <= self.start_s < math.inf:
            raise ValueError(say("expected 0 or more, got {:g}", self.start_s, place="start_s"))
        for i, point in enumerate(self.path_enu_m):
            check_point(point, f"path_enu_m[{i}]")
        unknown = set(self.in_passing_ids).difference(self.viewpoint_ids)
        if unknown:
            raise ValueError(
                say("expected viewpoints of the sortie, got {}", repr(sorted(unknown)[0]), place="in_passing_ids")
            )


@dataclass(frozen=True, slots=True)
class Coverage:
    """Hemisphere sections covered, all there are, and an upper bound on what any allowed views could cover.

    `sharp` counts the covered sections of which a view is sharp (`sharp_distance_m`), and `coarsest_gsd_mm` is the
    pixel of the sharpest view of the section that is seen most coarsely; None in plans that do not say.
    """

    covered: int
    total: int
    reachable_upper_bound: int
    sharp: int | None = None
    coarsest_gsd_mm: float | None = None

    def __post_init__(self) -> None:
        if self.sharp is not None and not 0 <= self.sharp <= self.total:
            raise ValueError(say("expected sharp from 0 to {}, got {}", self.total, self.sharp, place="coverage"))
        if not 0 <= self.covered <= self.reachable_upper_bound <= self.total:
            raise ValueError(
                say(
                    "expected 0 <= covered <= reachable_upper_bound <= total, got {}, {}, {}",
                    self.covered,
                    self.reachable_upper_bound,
                    self.total,
                    place="coverage",
                )
            )


@dataclass(frozen=True, slots=True)
class BatteryWorth:
    """What a flight brings up to a battery: minutes in the air, photos, and expected PSNR of unseen views, dB."""

    n_batteries: int
    minutes: float
    n_photos: int
    psnr_db: float

    @property
    def text(self) -> str:
        """For people."""
        batteries = say("1 battery") if self.n_batteries == 1 else say("{} batteries", self.n_batteries)
        return say("{} {:.0f} min: {:.1f} dB", batteries, self.minutes, self.psnr_db)


@dataclass(frozen=True, slots=True)
class FlightWorth:
    """What the model of a plan's photos is expected to be like, battery by battery (`planning.coverage.image_error`).

    Parameters
    ----------
    batteries
        Up to each of the plan's sorties, in the order flown.
    another
        With one battery more, whose photos add most; None where none would add anything.
    deviation_db
        Standard deviation of models' PSNR from what is expected.
    poses_sha256
        `poses_sha256` of the viewpoints; empty where an earlier version did not tell.
    """

    batteries: tuple[BatteryWorth, ...]
    another: BatteryWorth | None
    deviation_db: float
    poses_sha256: str = ""

    def __post_init__(self) -> None:
        if not self.batteries:
            raise ValueError(say("expected at least one battery", place="worth.batteries"))

    @property
    def gain_db(self) -> float:
        """What another battery would bring."""
        return 0.0 if self.another is None else self.another.psnr_db - self.batteries[-1].psnr_db

    @property
    def text(self) -> str:
        """For people, in one line."""
        each = joined("; ", (battery.text for battery in self.batteries))
        expected = say("{} (± {:.1f} dB)", each, self.deviation_db)
        gain_db = max(0.0, self.gain_db)
        less = 100.0 * (1.0 - 10.0 ** (-gain_db / 20.0))
        return say("{}; another battery would bring {:.1f} dB more, {:.0f} % less error", expected, gain_db, less)


@dataclass(frozen=True, slots=True)
class HistoryPoint:
    """Sections covered by the best viewpoint set known `t_s` seconds after the start."""

    t_s: float
    covered: int


@dataclass(frozen=True, slots=True)
class Plan:
    """The content of `plan.json`."""

    site: str
    site_sha256: str
    method: str
    seed: int
    camera: Camera
    aircraft: Aircraft
    constraints: Constraints
    viewpoints: tuple[Viewpoint, ...]
    sorties: tuple[Sortie, ...]
    coverage: Coverage
    history: tuple[HistoryPoint, ...] = ()
    format: str = PLAN_FORMAT
    origin: Origin | None = None
    """Of the site; without it (plans of other programs) export needs the site file."""
    home_enu_m: Vec3 | None = None
    rules: FlightRules = FlightRules()
    effects: tuple[Decision, ...] = ()
    profile: str = ""
    """Identifier of the aircraft-and-camera profile in the catalogue, empty when they were given by hand."""
    worth: FlightWorth | None = None
    """What its photos were expected to bring when it was planned."""
    camera_settings: CameraSettings = CameraSettings()
    camera_controls: CameraControls | None = None
    """What can be set on the camera; None where nobody has stated it."""

    def __post_init__(self) -> None:
        if self.format != PLAN_FORMAT:
            raise ValueError(say("expected '{}', got '{}'", PLAN_FORMAT, self.format, place="format"))
        if self.home_enu_m is not None:
            check_point(self.home_enu_m, "home_enu_m")
        ids = [viewpoint.id for viewpoint in self.viewpoints]
        known = set(ids)
        if len(known) != len(ids):
            twice = next(i for i in ids if ids.count(i) > 1)
            raise ValueError(say("expected unique ids, '{}' occurs twice", twice, place="viewpoints"))
        for i, sortie in enumerate(self.sorties):
            for viewpoint_id in sortie.viewpoint_ids:
                if viewpoint_id not in known:
                    raise ValueError(
                        say("there is no viewpoint '{}'", viewpoint_id, place=f"sorties[{i}].viewpoint_ids")
                    )

    @property
    def present_worth(self) -> FlightWorth | None:
        """What its photos are expected to bring; None where it is not known, or views have changed since."""
        counts, n_photos = [], 0
        for sortie in self.sorties:
            n_photos += len(sortie.viewpoint_ids)
            if sortie.viewpoint_ids:
                counts.append(n_photos)
        if self.worth is None or [battery.n_photos for battery in self.worth.batteries] != counts:
            return None
        return self.worth if self.worth.poses_sha256 in ("", poses_sha256(self.viewpoints)) else None

    @property
    def duration_s(self) -> float:
        """Flight time of all sorties together."""
        return sum(sortie.duration_s for sortie in self.sorties)

    @property
    def landed_s(self) -> float | None:
        """When the last of several aircraft has landed, from the first start on; None where not all have starts."""
        if not self.sorties or any(sortie.start_s is None for sortie in self.sorties):
            return None
        return max((sortie.start_s or 0.0) + sortie.duration_s for sortie in self.sorties)


def poses_sha256(viewpoints: Sequence[Viewpoint]) -> str:
    """Checksum of poses, in whatever order."""
    poses = sorted((*view.position_enu_m, view.heading_deg, view.gimbal_pitch_deg) for view in viewpoints)
    return hashlib.sha256(np.array(poses, "<f8").tobytes()).hexdigest()


class ViewpointArrays(NamedTuple):
    """Viewpoints as arrays: positions shape (n, 3) ENU metres, heading and pitch shape (n,) radians."""

    positions_enu_m: NDArray[np.float64]
    heading_rad: NDArray[np.float64]
    pitch_rad: NDArray[np.float64]


def viewpoint_arrays(viewpoints: tuple[Viewpoint, ...]) -> ViewpointArrays:
    """Arrays of all viewpoints, in order."""
    return ViewpointArrays(
        np.array([v.position_enu_m for v in viewpoints], dtype=np.float64).reshape(-1, 3),
        np.radians(np.array([v.heading_deg for v in viewpoints], dtype=np.float64)),
        np.radians(np.array([v.gimbal_pitch_deg for v in viewpoints], dtype=np.float64)),
    )


# Reading and writing `plan.json` (format reflight-plan/1, docs/reference/file-formats.md).


def read_plan(path: Path) -> Plan:
    """Read a plan.

    Raises
    ------
    InputError
        The file is missing or wrong; the message names the file, the field and what was expected.
    """
    return plan_of(read_input_file(path, JSON_FILE), path)


def plan_of(written: bytes, path: Path) -> Plan:
    """A plan from the content of its file `path`; errors as `read_plan`."""
    content = parse_json(written, path)
    expect_format(content, PLAN_FORMAT, path)
    return to_record(content, Plan, path)


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """Content of `plan.json`; optional fields that are not set are left out."""
    content: dict[str, Any] = plain_values(plan)
    content = {"format": content.pop("format"), **content}
    content["camera_settings"] = {key: value for key, value in content["camera_settings"].items() if value is not None}
    content["coverage"] = {key: value for key, value in content["coverage"].items() if value is not None}
    for viewpoint in content["viewpoints"]:
        if not viewpoint["locked"]:
            del viewpoint["locked"]
    for sortie in content["sorties"]:
        if not sortie["in_passing_ids"]:
            del sortie["in_passing_ids"]
        if sortie["start_s"] is None:
            del sortie["start_s"], sortie["aircraft"]
    return {key: value for key, value in content.items() if value is not None}


def plan_bytes(plan: Plan) -> bytes:
    """The plan file of a plan, as `write_plan` writes it."""
    return json.dumps(plan_to_json(plan), indent=1, allow_nan=False).encode()


def write_plan(path: Path, plan: Plan) -> None:
    """Write a plan, whole or not at all."""
    write_atomically(path, plan_bytes(plan))
