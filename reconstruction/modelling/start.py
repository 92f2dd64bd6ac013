"""From a data set folder to a model that can be trained jointly: splats on what is known, light learned alone first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from planning.effects import Decision
from planning.errors import InputError
from planning.progress import QUIET, Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.modelling.config import TrainConfig
from reconstruction.modelling.exposures import Exposures
from reconstruction.modelling.handover import hand_over
from reconstruction.modelling.model import SceneModel
from reconstruction.reflections.choose_light import choose_light
from reconstruction.reflections.glass_rays import glass_rays
from reconstruction.reflections.photo_set import PhotoSet, held_out_names
from reconstruction.reflections.training import TrainedReflections, train_reflections
from reconstruction.splatting.initialise import InitialParameters, initial_splats
from reconstruction.splatting.sky import Sky
from reconstruction.splatting.splats import NO_PANEL, Splats
from reconstruction.splatting.start_data import known_scene, model_origin

Array = NDArray[np.float64]


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
    """

    model: SceneModel
    exposures: Exposures
    learned: tuple[PosedPhoto, ...]
    held_out: tuple[str, ...]
    extent_m: float
    light_name: str
    decisions: tuple[Decision, ...] = ()


def start_model(source: PhotoSet, config: TrainConfig, monitor: Monitor = QUIET) -> Start:
    """Place splats, learn the light that glass mirrors from its rays alone, and put both together.

    Raises
    ------
    InputError
        The folder has too few photos, nothing to start from, or no glass to be seen.
    ReconstructionError
        Learning light failed.
    OperationCancelled
        From `monitor`.
    """
    held_out = held_out_names([photo.name for photo in source.photos], config.held_out, config.seed)
    learned = tuple(photo for photo in source.photos if photo.name not in held_out)
    scene = known_scene(source)
    origin = model_origin(scene)
    parameters = InitialParameters(n_splats=config.n_splats, seed=config.seed)
    splats = initial_splats(scene, learned, origin, parameters, source.picture, monitor)
    cameras = np.array([photo.pose.position_enu_m for photo in learned])
    light: TrainedReflections | None = None
    decisions: tuple[Decision, ...] = ()
    if config.method == "2dgs":
        splats.panels.fill_(NO_PANEL)
    else:
        light, decisions = _learned_light(source, learned, config, monitor)
        hand_over(light.panels, splats, source.panels, origin, cameras)
    model = _joined(source, learned, splats, light, origin, config)
    known = [source.own_exposures.get(photo.name, 1.0) for photo in learned]
    return Start(
        model, Exposures(known), learned, held_out, _extent_m(cameras), "" if light is None else light.model, decisions
    )


def _learned_light(
    source: PhotoSet, learned: Sequence[PosedPhoto], config: TrainConfig, monitor: Monitor
) -> tuple[TrainedReflections, tuple[Decision, ...]]:
    """The light, and the decisions about what learns it."""
    settings = replace(config.reflections, seed=config.seed, threads=config.threads, memory_bytes=config.memory_bytes)
    if config.time_limit_s is not None:
        share_s = config.light_share * config.time_limit_s
        settings = replace(settings, time_limit_s=min(share_s, settings.time_limit_s or share_s))
    rays = glass_rays(source, learned, settings.memory_bytes, settings.seed, monitor)
    if not len(rays):
        raise InputError(
            f"{source.folder}: none of {len(learned)} photos has a pixel that lies whole on a panel; take larger "
            "photos or come closer, or train splats alone (--method 2dgs)"
        )
    decisions: tuple[Decision, ...] = ()
    name = config.light
    if name == "auto":
        name, decisions = choose_light(rays, source.panels, settings, monitor)
    return train_reflections(rays, source.panels, name, settings, source.exposure, None, monitor), decisions


def _joined(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    splats: Splats,
    light: TrainedReflections | None,
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
