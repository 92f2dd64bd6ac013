"""How photos are taken: sensor, shutter, speed, exposure, lens, and errors of the stated positions and angles.

One frozen record, loadable from TOML. What is in it is simulated where the scene calls for it (`effects.flight`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import check_settings, read_toml, to_record
from planning.base.messages import say
from planning.geo.frames import Vec3
from reconstruction.base.cameras import STRAIGHT, Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.photos.lens_effects import Sensor
from reconstruction.scenes.photos.thin_lens import ThinLens

Array = NDArray[np.float64]

Fix = Literal["rtk", "single"]

SHUTTER_S = 0.002
"""Automatic exposure chooses 1/500 s on a bright day; the simulator of flights takes it, too."""

LONGEST_S, FASTEST_M_S = 30.0, 100.0
"""No aerial photo is exposed longer, and no multirotor is faster."""

DEVIATIONS_M: dict[Fix, tuple[float, float]] = {"rtk": (0.0071, 0.015), "single": (0.14, 0.4)}
"""Of one photo against the others of its sortie, horizontal per axis and vertical. RTK: 1 cm + 1 ppm on both horizontal
axes together and 1.5 cm + 1 ppm (DJI, Mavic 3 Enterprise, specifications), with a base within 1 km. Single: errors as
below that forget themselves in 600 s change by this much between photos 5 s apart."""

BIASES_M: dict[Fix, tuple[float, float]] = {"rtk": (0.0071, 0.015), "single": (1.06, 3.0)}
"""Of a whole sortie. RTK: as large as the deviation, for the place of the base and the way from antenna to camera, our
choice. Single: 1.5 m on both axes together and 3 m (DJI's specifications of D-RTK receivers)."""

LARGEST_M, LARGEST_DEG = 100.0, 45.0
"""Of errors: told worse, a photo belongs to another building, or looks at one."""

LARGEST_PUPIL_MM, NEAREST_FOCUS_M, FARTHEST_FOCUS_M = 100.0, 0.1, 1e6
"""No lens in the air is wider, or focuses nearer; farther is infinity."""

SHUTTERS_S = (1.0 / 8000.0, 8.0)
"""Shortest and longest of a camera that meters (DJI, Mavic 3 Enterprise, specifications)."""

STEPS_PER_STOP = 3
"""Exposures of cameras are a third of a stop apart (ISO 12232 and all makers' dials)."""


def _check(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name}: expected {low:g} to {high:g}, got {value}")


@dataclass(frozen=True, slots=True)
class PositionErrors:
    """How far off photos tell the positions of their cameras: standard deviations.

    Parameters
    ----------
    fix
        What the receiver reaches; gives the others where they are None.
    horizontal_m, vertical_m
        Of each photo by itself, horizontally per axis.
    horizontal_bias_m, vertical_bias_m
        Of all photos of a sortie together.
    """

    fix: Fix = "rtk"
    horizontal_m: float | None = None
    vertical_m: float | None = None
    horizontal_bias_m: float | None = None
    vertical_bias_m: float | None = None

    def __post_init__(self) -> None:
        for one in fields(self)[1:]:
            value = getattr(self, one.name)
            if value is not None:
                _check(one.name, value, 0.0, LARGEST_M)

    @property
    def deviation_m(self) -> tuple[float, float]:
        """Horizontal and vertical, of each photo."""
        return self._told(self.horizontal_m, self.vertical_m, DEVIATIONS_M[self.fix])

    @property
    def bias_m(self) -> tuple[float, float]:
        """Horizontal and vertical, of each sortie."""
        return self._told(self.horizontal_bias_m, self.vertical_bias_m, BIASES_M[self.fix])

    @property
    def total_m(self) -> tuple[float, float]:
        """Horizontal and vertical, of both together."""
        pairs = zip(self.deviation_m, self.bias_m, strict=True)
        horizontal, vertical = (math.hypot(*pair) for pair in pairs)
        return horizontal, vertical

    @staticmethod
    def _told(horizontal: float | None, vertical: float | None, usual: tuple[float, float]) -> tuple[float, float]:
        return usual[0] if horizontal is None else horizontal, usual[1] if vertical is None else vertical


@dataclass(frozen=True, slots=True)
class GimbalErrors:
    """How far off photos tell the angles of their cameras: standard deviations.

    Parameters
    ----------
    heading_deg, pitch_deg, roll_deg
        Of each photo by itself. DJI writes angles to tenths of a degree (0.029 by rounding); the M3E's gimbal holds to
        0.007 degrees (specifications).
    heading_bias_deg, pitch_bias_deg, roll_bias_deg
        Of all photos of a sortie together. Nobody publishes how true gimbals' angles are: our choice, half of what
        photos are trusted with when they are read (`reconstruction.photos.poses.Accuracy`).
    """

    heading_deg: float = 0.03
    pitch_deg: float = 0.03
    roll_deg: float = 0.03
    heading_bias_deg: float = 1.0
    pitch_bias_deg: float = 0.25
    roll_bias_deg: float = 0.25

    def __post_init__(self) -> None:
        for one in fields(self):
            _check(one.name, getattr(self, one.name), 0.0, LARGEST_DEG)

    @property
    def deviation_deg(self) -> Vec3:
        """Heading, pitch, roll, of each photo."""
        return self.heading_deg, self.pitch_deg, self.roll_deg

    @property
    def bias_deg(self) -> Vec3:
        """Heading, pitch, roll, of each sortie."""
        return self.heading_bias_deg, self.pitch_bias_deg, self.roll_bias_deg


@dataclass(frozen=True, slots=True)
class CameraModel:
    """How photos are taken.

    Parameters
    ----------
    shutter_s
        How long the shutter is open; None takes what a flight says of each photo, and 1/500 s where nothing does.
    speed_m_s
        At the shutter, from the photo before towards the one after; None takes what a flight says of each photo, and 0
        for plans, whose aircraft stop for every photo.
    exposure
        `locked`: one for all photos. `metered`: each photo's own, in thirds of a stop, by the shutter.
    distortion
        Brown's k1, k2, p1, p2, k3, as in DJI's DewarpData.
    pupil_mm
        Diameter of the lens's entrance pupil, focal length over f-number; None takes that of a plan whose aperture is
        stated, and a pinhole, which has all in focus, where none is.
    focus_m
        Depth that is in focus; None: infinity, or that of the plan.
    """

    shutter_s: float | None = None
    speed_m_s: float | None = None
    exposure: Literal["locked", "metered"] = "locked"
    distortion: tuple[float, float, float, float, float] = STRAIGHT
    sensor: Sensor = field(default_factory=Sensor)
    position: PositionErrors = field(default_factory=PositionErrors)
    gimbal: GimbalErrors = field(default_factory=GimbalErrors)
    pupil_mm: float | None = None
    focus_m: float | None = None

    def __post_init__(self) -> None:
        if self.pupil_mm is not None:
            _check("pupil_mm", self.pupil_mm, 0.0, LARGEST_PUPIL_MM)
        if self.focus_m is not None:
            _check("focus_m", self.focus_m, NEAREST_FOCUS_M, FARTHEST_FOCUS_M)
        if self.shutter_s is not None:
            _check("shutter_s", self.shutter_s, 0.0, LONGEST_S)
        if self.speed_m_s is not None:
            _check("speed_m_s", self.speed_m_s, 0.0, FASTEST_M_S)
        for value in self.distortion:
            _check("distortion", value, -100.0, 100.0)

    @property
    def lens(self) -> ThinLens | None:
        """What it sees through; None where all is in focus."""
        if not self.pupil_mm:
            return None
        return ThinLens(self.pupil_mm, math.inf if self.focus_m is None else self.focus_m)


USUAL_CAMERA_MODEL = CameraModel()


@dataclass(frozen=True, slots=True)
class Moment:
    """A photo's sortie, how its camera moved, and how long its shutter was open at the locked exposure."""

    sortie: int = 0
    velocity_enu_m_s: Vec3 = (0.0, 0.0, 0.0)
    exposure_s: float = SHUTTER_S

    @property
    def moved_m(self) -> float:
        """How far the camera moved while the shutter was open."""
        return math.hypot(*self.velocity_enu_m_s) * self.exposure_s


@dataclass(frozen=True, slots=True, eq=False)
class Capture:
    """One photo as it is taken, once effects are decided.

    Parameters
    ----------
    reported, reported_higher_m
        Its pose by its own metadata, and how much too high these tell the place of take-off as well.
    moved_enu_m
        How far the camera moves while the shutter is open, shape (3,); its pose is that of the middle.
    exposure
        Against that of all photos: 1 where it is locked.
    exposure_s
        How long the shutter is open.
    """

    reported: Pose
    reported_higher_m: float
    moved_enu_m: Array
    exposure: float
    exposure_s: float

    @classmethod
    def still(cls, photo: PosedPhoto) -> Capture:
        """Of a photo that is taken hovering and tells its true pose."""
        return cls(photo.pose, 0.0, np.zeros(3), 1.0, SHUTTER_S)


def read_camera_model(path: Path) -> CameraModel:
    """From a TOML file with any of the fields as keys, those of records as tables; the others keep their defaults.

    Raises
    ------
    InputError
        The file cannot be read, or a key or value is none of ours; the message names it.
    """
    content = read_toml(path, dict[str, Any])
    check_settings(content, CameraModel, path)
    for name, record in (("sensor", Sensor), ("position", PositionErrors), ("gimbal", GimbalErrors)):
        table = content.get(name)
        if isinstance(table, dict):
            check_settings(table, record, path, f"{name}.")
    return to_record(content, CameraModel, path)


ALONG = np.linspace(0.0, 1.0, 33)
"""Places from the middle of a picture to its edge, where it is asked whether a lens folds."""

THERE_AND_BACK_PX = 0.01


def bent_lens(lens: Intrinsics, distortion: tuple[float, float, float, float, float]) -> Intrinsics:
    """A lens with a distortion.

    Raises
    ------
    InputError
        Within the picture, the distortion shows one thing in two places, or bends more than can be undone.
    """
    bent = Intrinsics(lens.width_px, lens.height_px, lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, distortion)
    if bent.is_straight:
        return bent
    x, y = (np.linspace(0.0, size, 17) for size in (lens.width_px, lens.height_px))
    edge = np.array([(a, b) for a in x for b in y if a in (x[0], x[-1]) or b in (y[0], y[-1])])
    rays = bent.rays(edge)
    with np.errstate(all="ignore"):
        back = bent.pixels(rays)
        is_bad = not (np.abs(back - edge) <= THERE_AND_BACK_PX).all() or not _keeps_order(bent, rays)
    if is_bad:
        raise InputError(
            say(
                "distortion: {} folds the picture or bends it too far: a place in it belongs to no one "
                "direction; expected a lens that can be undistorted up to its corners (k1, k2, p1, p2, k3 for "
                "lengths in units of the focal length)",
                list(distortion),
            )
        )
    return bent


def _keeps_order(lens: Intrinsics, rays: Array) -> bool:
    """Whether no neighbours change places between the middle and rays, shape (n, 3): a positive Jacobian all along."""
    points = (ALONG[:, None, None] * rays[None, :, :2]).reshape(-1, 2)
    step = 1e-6
    centre = np.column_stack([points, np.ones(len(points))])
    moved = [(lens.pixels(centre + np.eye(3)[k] * step) - lens.pixels(centre)) / step for k in (0, 1)]
    return bool((moved[0][:, 0] * moved[1][:, 1] - moved[0][:, 1] * moved[1][:, 0] > 0.0).all())


def in_stops(factors: Array) -> Array:
    """Exposures, shape (n,), rounded to thirds of a stop against 1, as cameras set them."""
    return np.asarray(np.exp2(np.rint(STEPS_PER_STOP * np.log2(factors)) / STEPS_PER_STOP))
