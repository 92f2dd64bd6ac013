"""Effects of photographs of glass: each looks at scene and flight and says how much pictures would lack without it.

Displacements are in pixels, changes of light in grey levels: root mean square over the pictures.
"""

from __future__ import annotations

from collections.abc import Sequence

from planning.base.effects import Decision, Effect, decide
from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects import camera, flight, light, mirror, sun
from reconstruction.scenes.effects.probe import Probe
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel, Moment
from reconstruction.scenes.record import Scene
from reconstruction.scenes.world.ground import MirroredTerrain

EFFECTS: tuple[Effect[Probe], ...] = (
    *mirror.EFFECTS,
    *light.EFFECTS,
    *sun.EFFECTS,
    *camera.EFFECTS,
    *flight.EFFECTS,
)


def effect_names() -> tuple[str, ...]:
    """Of all effects; the last one is decided when a scene is built."""
    return (*(effect.name for effect in EFFECTS), MirroredTerrain.name)


def decide_effects(
    scene: Scene,
    photos: Sequence[PosedPhoto],
    settings: RenderSettings,
    camera_model: CameraModel = USUAL_CAMERA_MODEL,
    moments: Sequence[Moment] = (),
) -> dict[str, Decision]:
    """What is simulated in photographs of a scene, and why, by the effects' names.

    What was decided when the scene was built comes first. `settings.decided` takes the decisions' values. Without
    moments, all photos are taken hovering.

    Raises
    ------
    InputError
        There are no photos, or the settings name an effect that there is not.
    """
    names = effect_names()
    unknown = [name for name in settings.effects if name not in names]
    if unknown:
        raise InputError(say("there is no effect '{}'; expected one of {}", unknown[0], ", ".join(names)))
    if not photos:
        raise InputError(say("effects are decided by the photos of a flight; expected at least one, got none"))
    probe = Probe(scene, photos, camera_model, moments)
    built = {} if scene.terrain is None else {scene.terrain.effect: scene.terrain}
    return built | {
        effect.name: decide(effect, probe, settings.effects.get(effect.name, "auto"), settings.tolerance)
        for effect in EFFECTS
    }
