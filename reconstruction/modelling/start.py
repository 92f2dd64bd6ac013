"""From a data set folder to a model that can be trained jointly: splats on what is known, light learned alone first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from planning.effects import Decision
from planning.errors import InputError
from planning.progress import QUIET, Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.modelling.config import TrainConfig
from reconstruction.modelling.exposures import Exposures
from reconstruction.modelling.given_splats import given_splats
from reconstruction.modelling.handover import hand_over
from reconstruction.modelling.light_stage import BegunLight, LightStage, checksum, write_light
from reconstruction.modelling.model import SceneModel
from reconstruction.modelling.photo_moves import Move, learned_moves, moved
from reconstruction.modelling.record import site_record
from reconstruction.modelling.shader import Shader
from reconstruction.modelling.shaders.made import Surroundings, as_method_has_them, shader_of, with_primitive
from reconstruction.modelling.stopwatch import Stopwatch
from reconstruction.reflections.choose_light import choose_light
from reconstruction.reflections.glass_rays import glass_rays
from reconstruction.reflections.light_training import Keeping
from reconstruction.reflections.photo_set import PhotoSet, held_out_names
from reconstruction.reflections.training import TrainedReflections, train_reflections
from reconstruction.splatting.initialise import InitialParameters, initial_splats
from reconstruction.splatting.sky import Sky
from reconstruction.splatting.splats import Splats, splats_from_tensors, splats_to_tensors
from reconstruction.splatting.start_data import known_scene, model_origin, points_alone

Array = NDArray[np.float64]

LEAST_LIGHT_S = 1.0
"""For learning light, where nearly all time is gone before it begins."""


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A model before its joint training.

    Parameters
    ----------
    learned, held_out
        Photos to learn from, and names of those that are kept for scoring.
    extent_m
        Size of the scene: how far the cameras are from their middle.
    light_name
        What mirrored light was learned with; "" for splats alone.
    decisions
        About effects.
    moves
        Corrections of the poses of photos learned from; none where they were not learned.
    notes
        What learning light had to survive.
    """

    model: SceneModel
    exposures: Exposures
    learned: tuple[PosedPhoto, ...]
    held_out: tuple[str, ...]
    extent_m: float
    light_name: str
    decisions: tuple[Decision, ...] = ()
    moves: tuple[Move, ...] = ()
    notes: tuple[str, ...] = ()


def start_model(
    source: PhotoSet,
    config: TrainConfig,
    monitor: Monitor = QUIET,
    watch: Stopwatch | None = None,
    checkpoint: Path | None = None,
    begun: BegunLight | None = None,
    given: Path | None = None,
) -> Start:
    """Place splats, learn the light that glass mirrors from its rays alone, and put both together.

    Parameters
    ----------
    watch
        Of the whole training; None for one that begins now.
    checkpoint
        File that learning light can go on from if it is interrupted; None for none.
    begun
        What it goes on from.
    given
        PLY file of splats to start from; None for new ones.

    Raises
    ------
    InputError
        The folder has too few photos, nothing to start from, or no glass to be seen; or `begun` is of other photos.
    ReconstructionError
        Learning light failed.
    OperationCancelled
        From `monitor`.
    """
    watch = watch or Stopwatch()
    held_out = held_out_names([photo.name for photo in source.photos], config.held_out, config.seed)
    learned = tuple(photo for photo in source.photos if photo.name not in held_out)
    scene = known_scene(source)
    origin = model_origin(scene)
    if begun is not None:
        splats = splats_from_tensors(begun.splats, str(checkpoint))
    elif given is not None:
        splats = given_splats(given, source, learned, origin, config.memory_bytes, monitor)
        splats = with_primitive(splats, config.trained_by.primitive)
    else:
        parameters = InitialParameters(n_splats=config.n_splats, seed=config.seed)
        if config.start_from == "points":
            known = points_alone(scene, source.folder, knows_panels=config.trained_by.knows_panels)
        else:
            known = scene
        splats = initial_splats(known, learned, origin, parameters, source.picture, monitor)
    light: TrainedReflections | None = None
    shader: Shader | None = None
    decisions: tuple[Decision, ...] = ()
    if not config.trained_by.knows_panels:
        triangles = (scene.mesh.corners_enu_m - origin).astype(np.float32).reshape(-1, 3, 3)
        shader = shader_of(config, Surroundings(triangles))
        splats = as_method_has_them(splats, config, shader)
    else:
        light, decisions = _learned_light(source, learned, config, splats, monitor, watch, checkpoint, begun)
    moves = learned_moves(None if light is None else light.panels.light, len(learned))
    cameras = np.array([photo.pose.position_enu_m for photo in moved(learned, moves)])
    if light is not None:
        hand_over(light.panels, splats, source.panels, origin, cameras)
    exposures = [source.own_exposures.get(photo.name, 1.0) for photo in learned]
    return Start(
        _joined(source, learned, splats, light, shader, origin, config),
        Exposures(exposures),
        learned,
        held_out,
        _extent_m(cameras),
        "" if light is None else light.model,
        decisions,
        moves,
        () if light is None else light.notes,
    )


def _learned_light(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    config: TrainConfig,
    splats: Splats,
    monitor: Monitor,
    watch: Stopwatch,
    checkpoint: Path | None,
    begun: BegunLight | None,
) -> tuple[TrainedReflections, tuple[Decision, ...]]:
    """The light, and the decisions about what learns it."""
    settings = replace(config.reflections, seed=config.seed, threads=config.threads, memory_bytes=config.memory_bytes)
    rays = glass_rays(source, learned, settings.memory_bytes, settings.seed, monitor)
    if not len(rays):
        raise InputError(
            f"{source.folder}: none of {len(learned)} photos has a pixel that lies whole on a panel; take larger "
            "photos or come closer, or train splats alone (--method 2dgs)"
        )
    digest = checksum(rays)
    no_decisions: tuple[Decision, ...] = ()
    if begun is None:
        name, decisions = config.light, no_decisions
        if name == "auto":
            tried = replace(settings, time_limit_s=_light_limit_s(config, watch))
            name, decisions = choose_light(rays, source.panels, tried, monitor, device=config.device)
        limit_s = _light_limit_s(config, watch)
        stage = LightStage(config, site_record(source.folder), name, decisions, limit_s, digest)
    else:
        stage = begun.stage
        if digest != stage.rays_sha256:
            raise InputError(
                f"{source.folder}: its photos, cameras or panels are not those that the training was begun with; name "
                "that data set"
            )
    keeping = None
    if checkpoint is not None:
        placed = splats_to_tensors(splats)
        write = lambda state: write_light(checkpoint, BegunLight(stage, placed, state, watch()))  # noqa: E731
        keeping = Keeping(write, config.checkpoint_every_s, None if begun is None else begun.state)
    settings = replace(settings, time_limit_s=stage.time_limit_s)
    try:
        trained = train_reflections(
            rays,
            source.panels,
            stage.name,
            settings,
            source.exposure,
            monitor=monitor,
            keeping=keeping,
            device=config.device,
            clock=watch.clock,
        )
    except ValueError as error:
        if begun is None:
            raise
        raise InputError(
            f"{checkpoint}: is of another version, or damaged ({error}); begin the training anew"
        ) from error
    return trained, stage.decisions


def _light_limit_s(config: TrainConfig, watch: Stopwatch) -> float | None:
    """For learning light: its share of the time that is left."""
    wished = config.reflections.time_limit_s
    if config.time_limit_s is None:
        return wished
    share_s = max(LEAST_LIGHT_S, config.light_share * (config.time_limit_s - watch()))
    return share_s if wished is None else min(share_s, wished)


def _joined(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    splats: Splats,
    light: TrainedReflections | None,
    shader: Shader | None,
    origin_enu_m: Array,
    config: TrainConfig,
) -> SceneModel:
    model = SceneModel(
        splats,
        Sky(),
        None if light is None else light.panels.light,
        source.panels,
        origin_enu_m,
        corner_square(learned),
        config.geometry,
        "float32" if light is None else light.precision,
        shader,
    )
    if light is not None:
        if model.light is not None:
            model.light.finish(config.reflections)
        with torch.no_grad():
            model.corner_loss.copy_(light.panels.corner_loss)
    return model


def corner_square(photos: Sequence[PosedPhoto]) -> float:
    """Squared tangent of the angle between the optical axis and the pictures' corners, mean over photos."""
    lenses = [photo.intrinsics for photo in photos]
    return float(np.mean([0.25 * ((x.width_px / x.fx_px) ** 2 + (x.height_px / x.fy_px) ** 2) for x in lenses]))


def _extent_m(cameras_enu_m: Array) -> float:
    return max(1.0, float(np.linalg.norm(cameras_enu_m - cameras_enu_m.mean(axis=0), axis=1).max()))
