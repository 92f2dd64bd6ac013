"""Effects of photographs of glass: each looks at scene and flight and says how much pictures would lack without it.

Displacements are in pixels: what 95 % of the rays on glass do not exceed. Changes of light are in grey levels: root
mean square over the pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.effects import Assessment, Decision, Effect, decide
from planning.errors import InputError
from reconstruction.cameras import PosedPhoto
from reconstruction.scenes.effects_probe import Probe
from reconstruction.scenes.environment import ROWS
from reconstruction.scenes.lens_effects import MIDDLE_GREY, USUAL_SENSOR, Sensor, grey_levels
from reconstruction.scenes.record import Scene
from reconstruction.scenes.renderer import (
    DISTORTION,
    DOUBLING,
    FRESNEL,
    NEAR_FIELD,
    NOISE,
    SECOND_BOUNCE,
    SHADOW,
    TILT,
    VIGNETTING,
    RenderSettings,
)
from reconstruction.scenes.tracing import Switches

Array = NDArray[np.float64]

TOLERANCE_PX = 0.5
"""Half a pixel: less than what neighbouring pixels blur into each other."""

TOLERANCE_GREY = 0.5
"""Half a grey level: what rounding to whole ones changes at most; 54 dB."""

RAYS_PER_PIXEL = 4.0
"""On average over a picture: one, and nine more where detail calls for them (a third of the bundled scenes' pixels)."""

SECONDS_PER_RAY, SECONDS_PER_SHADOW, SECONDS_PER_ANGLE = 7e-7, 2.5e-7, 5e-8
"""Of one core: for a ray cast and shaded, for one that asks for the sun or shades alone, and for arithmetic on one;
measured on `planar` and `court`, where 0.8 million rays with their mirror images take 1.2 s."""


@dataclass(frozen=True, slots=True)
class NearField:
    """Parallax of mirror images against one picture of the surroundings from the facade's middle."""

    tolerance: float = TOLERANCE_PX
    name = NEAR_FIELD
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """Nothing where panes mirror the sky and the building itself alone."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, _NO_GLASS, 0.0)
        share = float(seen.is_around.mean())
        # Mirrored things are shaded, and the picture of the surroundings is saved.
        shaded = _cost(probe, probe.glass_share * share, SECONDS_PER_SHADOW)
        cost = max(shaded - 2.0 * ROWS * ROWS * SECONDS_PER_RAY, 0.0)
        if share == 0.0:
            return Assessment(0.0, "the panes mirror nothing but the sky and the building itself", cost)
        away = np.median(seen.path_m[seen.is_around])
        reason = f"{_percent(seen.is_around)} of the mirrored rays meet what is around, {away:.0f} m from the panes"
        return Assessment(probe.displacement_px(seen.parallax_rad), reason, cost)


@dataclass(frozen=True, slots=True)
class Fresnel:
    """Reflectance by the angle of incidence, against that at normal incidence."""

    tolerance: float = TOLERANCE_GREY
    name = FRESNEL
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, _NO_GLASS, 0.0)
        steep, flat = np.degrees(np.arccos(np.clip(np.quantile(seen.cosines, [0.95, 0.05]), 0.0, 1.0)))
        reason = f"light falls on the panes at {steep:.0f} to {flat:.0f} degrees"
        cost = _cost(probe, probe.glass_share, SECONDS_PER_ANGLE)
        return Assessment(probe.change_without(Switches(fresnel=False)), reason, cost)


@dataclass(frozen=True, slots=True)
class SecondBounce:
    """Glass mirrored in glass."""

    tolerance: float = TOLERANCE_GREY
    name = SECOND_BOUNCE
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Nothing where no mirrored ray meets a pane."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, _NO_GLASS, 0.0)
        meets = seen.after.panes >= 0
        reason = f"{_percent(meets)} of the mirrored rays meet glass"
        size = probe.change_without(Switches(second_bounce=False)) if meets.any() else 0.0
        return Assessment(size, reason, _cost(probe, probe.glass_share * float(meets.mean()), SECONDS_PER_RAY))


@dataclass(frozen=True, slots=True)
class Tilt:
    """Displacement of mirror images by panes that are not quite flat in their facade."""

    tolerance: float = TOLERANCE_PX
    name = TILT
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """A mirror turned by a moves an image by 2 a t / (s + t), s from the camera to it and t from there on."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, _NO_GLASS, 0.0)
        share = np.where(seen.is_sky, 1.0, 1.0 / (1.0 + seen.sight_m / seen.path_m))
        reason = f"panes are turned by up to {np.degrees(seen.tilts_rad.max()):.2f} degrees"
        cost = _cost(probe, probe.glass_share, SECONDS_PER_ANGLE)
        return Assessment(probe.displacement_px(2.0 * share * seen.tilts_rad), reason, cost)


@dataclass(frozen=True, slots=True)
class Doubling:
    """Displacement of the second sheet's mirror image against the first's."""

    tolerance: float = TOLERANCE_PX
    name = DOUBLING
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """Parallel sheets g apart shift rays by 2 g sin(angle); at the distance s + t that is an angle."""
        seen, scene = probe.mirrored, probe.scene
        if not len(seen):
            return Assessment(0.0, _NO_GLASS, 0.0)
        gaps = np.array([glass.gap_m if glass.sheets == 2 else 0.0 for glass in scene.glasses])
        gap = gaps[scene.panes.glass[seen.met.panes]]
        if not gap.any():
            return Assessment(0.0, "the panes are single", 0.0)
        shift = 2.0 * gap * np.sqrt(np.clip(1.0 - seen.cosines**2, 0.0, 1.0))
        away = seen.sight_m + seen.path_m
        reason = f"sheets are {1000.0 * gap.max():.0f} mm apart, the mirror images {_far(away[seen.is_around])}"
        size = probe.displacement_px(shift / away)
        return Assessment(size, reason, _cost(probe, probe.glass_share, SECONDS_PER_RAY))


@dataclass(frozen=True, slots=True)
class Shadow:
    """Places that the sun does not reach."""

    tolerance: float = TOLERANCE_GREY
    name = SHADOW
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        sky = probe.scene.sky
        if sky.sun_elevation_deg <= 0.0 or not any(sky.sun):
            return Assessment(0.0, "there is no sun", 0.0)
        reason = f"the sun stands {sky.sun_elevation_deg:.0f} degrees high"
        return Assessment(probe.change_without(Switches(shadow=False)), reason, _cost(probe, 1.0, SECONDS_PER_SHADOW))


@dataclass(frozen=True, slots=True)
class Distortion:
    """Displacement by the lens at the pictures' edges."""

    tolerance: float = TOLERANCE_PX
    name = DISTORTION
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """The largest one of all cameras."""
        lenses = {photo.intrinsics for photo in probe.photos}
        bent = [lens for lens in lenses if not lens.is_straight]
        if not bent:
            return Assessment(0.0, "the pictures are straight already", 0.0)
        size = 0.0
        for lens in bent:
            x, y = np.meshgrid(np.linspace(0, lens.width_px, 21), np.linspace(0, lens.height_px, 21))
            places = np.column_stack([x.ravel(), y.ravel()])
            straight = lens.straight().pixels(lens.rays(places))
            size = max(size, float(np.linalg.norm(straight - places, axis=1).max()))
        return Assessment(size, "the lens bends straight lines", _cost(probe, 1.0, SECONDS_PER_RAY))


@dataclass(frozen=True, slots=True)
class Vignetting:
    """Light that the lens loses in the corners."""

    sensor: Sensor = USUAL_SENSOR
    tolerance: float = TOLERANCE_GREY
    name = VIGNETTING
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Of middle grey, in a corner."""
        kept = 1.0 - self.sensor.corner_loss
        size = float(grey_levels(np.array(MIDDLE_GREY)) - grey_levels(np.array(MIDDLE_GREY * kept)))
        reason = f"the lens loses {100.0 * self.sensor.corner_loss:.0f} % of the light in the corners"
        return Assessment(size, reason, probe.n_pixels * SECONDS_PER_ANGLE)


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of the sensor."""

    sensor: Sensor = USUAL_SENSOR
    tolerance: float = TOLERANCE_GREY
    name = NOISE
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Of middle grey."""
        grey = np.array(MIDDLE_GREY)
        size = float(grey_levels(grey + self.sensor.noise(grey)) - grey_levels(grey))
        reason = f"a white pixel holds {self.sensor.white_e:.0f} electrons"
        return Assessment(size, reason, 3.0 * probe.n_pixels * SECONDS_PER_ANGLE)


def effects(tolerance: float = 1.0, sensor: Sensor = USUAL_SENSOR) -> tuple[Effect[Probe], ...]:
    """All of them; `tolerance` multiplies that of each."""
    px, grey = tolerance * TOLERANCE_PX, tolerance * TOLERANCE_GREY
    light = (NearField(px), Fresnel(grey), SecondBounce(grey), Tilt(px), Doubling(px), Shadow(grey))
    return (*light, Distortion(px), Vignetting(sensor, grey), Noise(sensor, grey))


_NO_GLASS = "no photo shows glass"


def decide_effects(
    scene: Scene, photos: Sequence[PosedPhoto], settings: RenderSettings, sensor: Sensor = USUAL_SENSOR
) -> dict[str, Decision]:
    """What is simulated in photographs of a scene, and why, by the effects' names.

    `settings.decided` takes the decisions' values.

    Raises
    ------
    InputError
        There are no photos.
    """
    if not photos:
        raise InputError("effects are decided by the photos of a flight; expected at least one, got none")
    probe = Probe(scene, photos)
    chosen, wishes = effects(settings.tolerance, sensor), settings.wishes
    return {effect.name: decide(effect, probe, wishes.get(effect.name, "auto")) for effect in chosen}


def _cost(probe: Probe, share: float, seconds_per_ray: float) -> float:
    """Of something done for a share of all rays of the flight."""
    return probe.n_pixels * RAYS_PER_PIXEL * share * seconds_per_ray


def _percent(mask: NDArray[np.bool_]) -> str:
    return f"{100.0 * float(mask.mean()):.0f} %"


def _far(metres: Array) -> str:
    return f"{np.median(metres):.0f} m away" if len(metres) else "as far as the sky"
