"""Optics of photos: depth of field, smear of what moves, skew of rolling shutters, exposure; and what cameras can set.

Lenses are thin, and circles of confusion are measured in pixels: one pixel counts as sharp. Distances run along the
optical axis from the lens, and may be infinite. A plane mirror shows things behind itself: what a pane mirrors lies at
the pane's distance and as far again as the thing is from the pane, and that is where the lens has to focus for it.

Sources: S. F. Ray, Applied Photographic Optics, 3rd ed., 2002, ch. 22 (depth of field, hyperfocal distance); ISO 2720
(exposure value); Born and Wolf, Principles of Optics, 8.5.2 (Airy's disc).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.parameters import FocusMode, ShutterKind, WhiteBalance

Array = NDArray[np.float64]

MM_PER_M = 1000.0

GREEN_MM = 0.00055
"""Wavelength that eyes and sensors see best."""

LARGEST_AIRY_PX = 3.0
"""Diameter of Airy's disc up to which stopping down still sharpens: its radius is the distance of two points that are
told apart (Rayleigh), and colour filters cost as much as 1.5 pixels anyway."""

STOPS = (
    *(1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.5, 2.8, 3.2, 3.5, 4.0, 4.5, 5.0, 5.6, 6.3, 7.1, 8.0, 9.0),
    *(10.0, 11.0, 13.0, 14.0, 16.0, 18.0, 20.0, 22.0),
)
"""f-numbers in third stops, as cameras name them."""

SHUTTERS = (
    *(8000, 6400, 5000, 4000, 3200, 2500, 2000, 1600, 1250, 1000, 800, 640, 500, 400, 320, 240, 200, 160, 120),
    *(100, 80, 60, 50, 40, 30, 25, 20, 15, 12, 10, 8, 6, 5, 4, 3, 2, 1),
)
"""Shutter times in third stops, as parts of a second."""

MavlinkControl = Literal["focus", "exposure", "parameters"]


def _positive(value: float, name: str, *, infinite: bool = False) -> float:
    """A number above 0; raises `ValueError` otherwise, for NaN, too."""
    if not value > 0.0 or (math.isinf(value) and not infinite):
        raise ValueError(say("expected a number above 0, got {:g}", value, place=name))
    return value


def _at_least_0(value: float, name: str) -> float:
    if not 0.0 <= value < math.inf:
        raise ValueError(say("expected 0 or more, got {:g}", value, place=name))
    return value


def _range(values: tuple[float, float] | None, name: str) -> None:
    if values is not None and not 0.0 < values[0] <= values[1] < math.inf:
        raise ValueError(say("expected [lowest, highest], both above 0, got {}", list(values), place=name))


@dataclass(frozen=True, slots=True)
class CameraControls:
    """What can be set on a camera, as far as it is known.

    Parameters
    ----------
    aperture
        Smallest and largest f-number; the same where it is fixed.
    iso
        Lowest and highest.
    mechanical_shutter_s, electronic_shutter_s
        Shortest and longest times; None where there is no such shutter.
    readout_s
        From the first row to the last of a photo by the electronic shutter; None where nobody has published it.
    white_balance_k
        Lowest and highest colour temperature; None where only presets can be chosen.
    white_balances, focus
        What can be chosen.
    compensation_ev
        Largest exposure compensation, up and down.
    nearest_focus_m
        Shortest distance that it focuses on.
    mavlink
        What the camera takes by MAVLink: focus and exposure from items of missions, or its parameters by the camera
        protocol. A camera on a trigger cable takes nothing.
    """

    aperture: tuple[float, float]
    iso: tuple[int, int]
    mechanical_shutter_s: tuple[float, float] | None = None
    electronic_shutter_s: tuple[float, float] | None = None
    readout_s: float | None = None
    white_balance_k: tuple[int, int] | None = None
    white_balances: tuple[WhiteBalance, ...] = ("auto", "sunny", "cloudy", "kelvin")
    focus: tuple[FocusMode, ...] = ("auto", "lock", "infinity", "distance")
    compensation_ev: float = 3.0
    nearest_focus_m: float = 1.0
    mavlink: tuple[MavlinkControl, ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        for name in ("aperture", "iso", "mechanical_shutter_s", "electronic_shutter_s", "white_balance_k"):
            _range(getattr(self, name), name)
        if self.mechanical_shutter_s is None and self.electronic_shutter_s is None:
            raise ValueError(say("expected the times of a shutter, got none", place="mechanical_shutter_s"))
        if self.readout_s is not None:
            _at_least_0(self.readout_s, "readout_s")
        _at_least_0(self.compensation_ev, "compensation_ev")
        _positive(self.nearest_focus_m, "nearest_focus_m")
        if not (self.white_balances and self.focus):
            raise ValueError(say("expected at least one way to choose, got none", place="white_balances, focus"))

    def shutter_kind(self, wanted: ShutterKind) -> ShutterKind:
        """The shutter that is used: the one wanted where the camera has it, else the one it has."""
        has = {"mechanical": self.mechanical_shutter_s, "electronic": self.electronic_shutter_s}
        other: ShutterKind = "electronic" if wanted == "mechanical" else "mechanical"
        return wanted if has[wanted] is not None else other

    def shutter_times_s(self, kind: ShutterKind) -> tuple[float, float]:
        """Shortest and longest time of a shutter.

        Raises
        ------
        ValueError
            The camera has no such shutter.
        """
        times = self.mechanical_shutter_s if kind == "mechanical" else self.electronic_shutter_s
        if times is None:
            raise ValueError(f"the camera has no {kind} shutter")
        return times


@dataclass(frozen=True, slots=True)
class Lens:
    """A lens before pixels: focal length and f-number, and the width of a pixel on the sensor, millimetres."""

    focal_length_mm: float
    f_number: float
    pixel_mm: float

    def __post_init__(self) -> None:
        for name in self.__slots__:
            _positive(getattr(self, name), name)

    @property
    def hyperfocal_m(self) -> float:
        """Nearest focus at which infinity is sharp to a pixel: f^2 / (N c) + f (Ray, 22.2)."""
        return (self._depth_mm + self.focal_length_mm) / MM_PER_M

    @property
    def _depth_mm(self) -> float:
        """f^2 / (N c): all that depth of field depends on, but for a focal length."""
        return self.focal_length_mm**2 / (self.f_number * self.pixel_mm)

    def sharp_between_m(self, focus_m: float) -> tuple[float, float]:
        """Nearest and farthest distance that are sharp to a pixel with the focus at a distance (Ray, 22.3).

        With h = f^2 / (N c), both distances are s h / (h +- (s - f)): reciprocals of distances add up, which is what
        keeps this stable up to an infinite focus. The farthest is infinite from the hyperfocal distance on.
        """
        at = self._reciprocal(focus_m, "focus_m")
        half = (1.0 - self.focal_length_mm / MM_PER_M * at) / (self._depth_mm / MM_PER_M)
        farthest = at - half
        return 1.0 / (at + half), math.inf if farthest <= 0.0 else 1.0 / farthest

    @overload
    def defocus_px(self, focus_m: float, distance_m: float) -> float: ...
    @overload
    def defocus_px(self, focus_m: Array, distance_m: Array) -> Array: ...
    def defocus_px(self, focus_m: float | Array, distance_m: float | Array) -> float | Array:
        """Diameter of the circle that a point becomes, in pixels: f^2 / (N c) |1/s - 1/d| / (1 - f/s), c a pixel.

        Arrays have shapes that fit each other.
        """
        at, where = self._reciprocal(focus_m, "focus_m"), self._reciprocal(distance_m, "distance_m")
        share = 1.0 - self.focal_length_mm / MM_PER_M * at
        circle: float | Array = self._depth_mm / MM_PER_M * abs(at - where) / share
        return circle

    def _reciprocal(self, distance_m: float | Array, name: str) -> Any:
        """One over a distance, 0 for infinity; nothing nearer than the focal length has an image."""
        nearest_m = float(np.min(distance_m))  # NaN where there is one
        _positive(nearest_m, name, infinite=True)
        if nearest_m * MM_PER_M <= self.focal_length_mm:
            raise ValueError(
                say(
                    "expected more than the focal length of {:g} mm, got {:g} m",
                    self.focal_length_mm,
                    nearest_m,
                    place=name,
                )
            )
        return 1.0 / distance_m


def sharpest_f_number(pixel_mm: float) -> float:
    """f-number beyond which diffraction blurs more than stopping down sharpens: Airy's disc is 2.44 wavelengths * N."""
    return LARGEST_AIRY_PX * _positive(pixel_mm, "pixel_mm") / (2.44 * GREEN_MM)


def smear_px(time_s: float, speed_m_s: float, turn_rad_s: float, gsd_m: float, pixel_angle_rad: float) -> float:
    """How far the picture moves in a time, in pixels: v t / GSD + w t / (angle of a pixel).

    An upper bound: all of the speed counts as across the line of sight, and adds up with the turn. Over the shutter
    time it is motion blur, over the readout of a rolling shutter the skew between first and last row.

    Raises
    ------
    ValueError
        A time, speed or rate is negative or no number, or a pixel has no size.
    """
    _at_least_0(time_s, "time_s")
    _at_least_0(speed_m_s, "speed_m_s")
    _at_least_0(turn_rad_s, "turn_rad_s")
    across = speed_m_s / _positive(gsd_m, "gsd_m", infinite=True)
    return time_s * (across + turn_rad_s / _positive(pixel_angle_rad, "pixel_angle_rad"))


def exposure_value(f_number: float, shutter_s: float, iso: float) -> float:
    """Exposure value at ISO 100 that settings expose for: log2(N^2 / t) - log2(ISO / 100) (ISO 2720)."""
    _positive(f_number, "f_number")
    _positive(shutter_s, "shutter_s")
    return 2.0 * math.log2(f_number) - math.log2(shutter_s) - math.log2(_positive(iso, "iso") / 100.0)


CLEAR_W_M2, CLEAR_LOSS_W_M2 = 910.0, 30.0
"""Irradiance of the ground under a clear sky: 910 sin(h) - 30 W/m2 (Kasten and Czeplak, Solar Energy 24, 1980, 177)."""

DAYLIGHT_LM_W = 110.0
"""Luminous efficacy of sun and clear sky together (Littlefair, Lighting Research and Technology 20, 1988, 177)."""

INCIDENT_LUX = 2.5
"""Illuminance of EV 0 at ISO 100: the constant of incident light meters, 250, over 100 (ISO 2720)."""


def clear_sky_ev(sun_elevation_rad: float) -> float:
    """Exposure value at ISO 100 of things in the sun under a clear sky; minus infinity where the sun gives no light."""
    power = CLEAR_W_M2 * math.sin(sun_elevation_rad) - CLEAR_LOSS_W_M2
    return math.log2(DAYLIGHT_LM_W * power / INCIDENT_LUX) if power > 0.0 else -math.inf


def shutter_text(shutter_s: float) -> str:
    """A shutter time as cameras show it: `1/500 s`, `0.5 s`."""
    parts = 1.0 / _positive(shutter_s, "shutter_s")
    return f"1/{round(parts)} s" if shutter_s < 0.3 else f"{shutter_s:.3g} s"


def shutter_within(longest_s: float) -> float:
    """The longest usual shutter time that is no longer than `longest_s`; that itself below the shortest of them."""
    _positive(longest_s, "longest_s", infinite=True)
    return next((1.0 / parts for parts in reversed(SHUTTERS) if 1.0 / parts <= longest_s * (1.0 + 1e-9)), longest_s)
