"""Effects of photographs of glass: each looks at scene and flight and says how much pictures would lack without it.

Displacements are in pixels, changes of light in grey levels: root mean square over the pictures.
"""

from __future__ import annotations

from collections.abc import Sequence

from planning.base.effects import Decision, Effect, decide
from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.camera import Distortion, Noise, Vignetting
from reconstruction.scenes.effects.flight import ExposureChanges, GimbalError, MotionBlur, PositionError
from reconstruction.scenes.effects.light import Interior, Occlusion, Shadow, SkyOcclusion
from reconstruction.scenes.effects.mirror import Curvature, Doubling, Fresnel, NearField, SecondBounce, Tilt
from reconstruction.scenes.effects.probe import TOLERANCE_GREY, TOLERANCE_PX, Probe
from reconstruction.scenes.effects.sun import SunGlare
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel, Moment
from reconstruction.scenes.photos.lens_effects import USUAL_SENSOR, Sensor
from reconstruction.scenes.record import Scene


def effects(tolerance: float = 1.0, sensor: Sensor = USUAL_SENSOR) -> tuple[Effect[Probe], ...]:
    """All of them; `tolerance` multiplies that of each."""
    px, grey = tolerance * TOLERANCE_PX, tolerance * TOLERANCE_GREY
    mirrors = (NearField(px), Fresnel(grey), SecondBounce(grey), Tilt(px), Curvature(px), Doubling(px))
    light = (*mirrors, Shadow(grey), Interior(grey), SunGlare(grey), Occlusion(grey), SkyOcclusion(grey))
    camera = (Distortion(px), Vignetting(sensor, grey), Noise(sensor, grey))
    return (*light, *camera, MotionBlur(px), ExposureChanges(grey), PositionError(px), GimbalError(px))


def decide_effects(
    scene: Scene,
    photos: Sequence[PosedPhoto],
    settings: RenderSettings,
    camera_model: CameraModel = USUAL_CAMERA_MODEL,
    moments: Sequence[Moment] = (),
) -> dict[str, Decision]:
    """What is simulated in photographs of a scene, and why, by the effects' names.

    `settings.decided` takes the decisions' values. Without moments, all photos are taken hovering.

    Raises
    ------
    InputError
        There are no photos.
    """
    if not photos:
        raise InputError(say("effects are decided by the photos of a flight; expected at least one, got none"))
    probe = Probe(scene, photos, camera_model, moments)
    chosen, requested = effects(settings.tolerance, camera_model.sensor), settings.effects
    return {effect.name: decide(effect, probe, requested.get(effect.name, "auto")) for effect in chosen}
