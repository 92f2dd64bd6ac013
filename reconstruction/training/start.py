"""From a data set folder to a model that can be trained jointly: splats on what is known, light learned alone first."""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.effects import Assessment, Decision, decide
from planning.base.errors import InputError
from planning.base.json_file import to_record
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, PartOf
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.choose_light import (
    LightTrials,
    chosen,
    contenders,
    standard_error,
    surely_more,
    try_lights,
    white_of,
    with_splats,
)
from reconstruction.light.glass_rays import GlassRays, glass_rays
from reconstruction.light.light_training import CheckpointSettings
from reconstruction.light.photo_set import PanelPlanes, PhotoSet, held_out_names
from reconstruction.light.reflective_panels import ModelName, ReflectivePanels
from reconstruction.light.shading import display_from_linear, reflected_directions
from reconstruction.light.training import TrainedReflections, train_reflections
from reconstruction.splats.harmonic_colour import fitted_harmonics
from reconstruction.splats.initialise import InitialParameters, initial_splats
from reconstruction.splats.panel_of_splats import assign_panels
from reconstruction.splats.ply import read_splats
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import NO_PANEL, Splats, splats_from_tensors, splats_to_tensors
from reconstruction.splats.surfels import KnownScene, known_scene, model_origin, points_only, scene_of_points
from reconstruction.training.callbacks import Callbacks, HeldOut, Show, quality_db, unshown
from reconstruction.training.config import TrainConfig
from reconstruction.training.methods.shader import Shader, Surroundings
from reconstruction.training.methods.shaders import converted_for_method, shader_of, with_primitive
from reconstruction.training.model.joint_model import Picture, SceneModel
from reconstruction.training.model.record import SiteRecord, site_record
from reconstruction.training.photos.decoded_photo import usual_reduce
from reconstruction.training.photos.exposures import Exposures, told_by_points
from reconstruction.training.photos.photo_stream import PhotoStream, StreamSettings
from reconstruction.training.photos.poses import Move, PoseCorrections, learned_moves, moved
from reconstruction.training.photos.transients import Transients
from reconstruction.training.timer import Timer
from reconstruction.training.trainer import Trainer, strategy_of
from reconstruction.training.training_state import write_checkpoint

# The first stage of a training, learning light alone: what it needs to go on after it was interrupted.

STAGE = "light stage"
"""Of a checkpoint's content; the joint training's has none."""


@dataclass(frozen=True, slots=True)
class LightStage:
    """What is settled when light begins to be learned.

    Parameters
    ----------
    name
        Of the model of light.
    decisions
        That led to it.
    time_limit_s
        For learning it.
    rays_sha256
        Checksum of the rays learned from.
    """

    config: TrainConfig
    site: SiteRecord
    name: ModelName
    decisions: tuple[Decision, ...]
    time_limit_s: float | None
    rays_sha256: str


@dataclass(frozen=True, slots=True, eq=False)
class InterruptedLightStage:
    """A first stage that was interrupted.

    Parameters
    ----------
    splats
        That were placed before.
    state
        Of `LightTraining`.
    spent_s
        That the whole training had taken until then.
    """

    stage: LightStage
    splats: dict[str, Tensor]
    state: dict[str, Any]
    spent_s: float


def write_light(path: Path, interrupted: InterruptedLightStage) -> None:
    """Write a checkpoint, whole or not at all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    write_checkpoint(
        path,
        {
            STAGE: asdict(interrupted.stage),
            "splats": interrupted.splats,
            "training": interrupted.state,
            "spent_s": interrupted.spent_s,
        },
    )


def interrupted_light_stage(content: dict[str, Any], path: Path) -> InterruptedLightStage | None:
    """The first stage in the content of a checkpoint; None where it is of the joint training.

    Raises
    ------
    InputError
        It is damaged.
    """
    if STAGE not in content:
        return None
    stage = to_record(content[STAGE], LightStage, path)
    splats, state, spent_s = (content.get(name) for name in ("splats", "training", "spent_s"))
    if not isinstance(splats, dict) or not isinstance(state, dict) or not isinstance(spent_s, float):
        raise InputError(say("holds no state of a training; begin the training anew", place=path))
    return InterruptedLightStage(stage, splats, state, spent_s)


def checksum(rays: GlassRays) -> str:
    """SHA-256 of rays: of their pixels, colours, cameras and panels."""
    found = hashlib.sha256()
    for record in (rays, rays.table):
        for each in fields(record):
            value = getattr(record, each.name)
            if isinstance(value, Tensor):
                found.update(value.cpu().contiguous().numpy().data)
    return found.hexdigest()


Array = NDArray[np.float64]

# What the learning of light alone found out about panes, put into the splats on them.
#
# Both models say the same picture then, so that the joint training starts where the other ended: with reflectivity,
# base reflectance and colour from elsewhere, the light that was learned would be wrong for them.

MOST_DIRECTIONS = 96
"""That a pane's colour is fitted to: far more than a degree has harmonics."""

DEGREE = 2
"""Of the harmonics that are fitted: cameras see a pane from one side only, which tells no more."""


@torch.no_grad()
def warm_start_splats(
    panels: ReflectivePanels, splats: Splats, planes: PanelPlanes, origin_enu_m: Array, cameras_enu_m: Array
) -> None:
    """Give the splats on each pane its r and F0, and the colour c that its places have.

    Parameters
    ----------
    cameras_enu_m
        From which the colour is to be right, shape (k, 3).
    """
    numbers = splats.panels.long()
    glass = torch.nonzero(numbers >= 0).squeeze(-1)
    splats.reflectivity_logits[glass] = panels.reflectivity[numbers[glass], 0].to(splats.means)
    splats.f0_logits[glass] = panels.base_reflectance[numbers[glass]].to(splats.means)
    middle = planes.middle_enu_m - origin_enu_m
    points = (splats.means.detach() - torch.from_numpy(middle).to(splats.means)) / planes.half_side_m
    for panel in torch.unique(numbers[glass]).tolist():
        rows = torch.nonzero(numbers == panel).squeeze(-1)
        omega_o = _directions(planes, panel, cameras_enu_m)
        if omega_o is not None:
            splats.sh[rows] = _fitted(panels, points[rows], omega_o, planes, panel)


def _directions(planes: PanelPlanes, panel: int, cameras_enu_m: Array) -> Array | None:
    """Unit directions from cameras that see the pane's front to its middle, shape (j, 3); None where there are none."""
    towards = planes.corners_enu_m[panel].mean(axis=0) - cameras_enu_m
    directions = towards / np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    seen = directions[directions @ planes.normals_enu[panel] < -1e-2]
    chosen = np.unique(np.linspace(0, len(seen) - 1, min(len(seen), MOST_DIRECTIONS)).astype(int))
    return seen[chosen] if len(seen) else None


def _fitted(panels: ReflectivePanels, points: Tensor, omega_o: Array, planes: PanelPlanes, panel: int) -> Tensor:
    """Coefficients, shape (n, 16, 3), of the display colours that places of a pane have from some directions."""
    directions = torch.from_numpy(omega_o).float()
    normal = torch.from_numpy(planes.normals_enu[panel]).float()
    mirrored = reflected_directions(directions, normal)
    n, k = len(points), len(directions)
    colours = panels.diffuse(
        points.repeat_interleave(k, dim=0), mirrored.repeat(n, 1), torch.full((n * k,), panel, dtype=torch.long)
    )
    return fitted_harmonics(directions, display_from_linear(colours).reshape(n, k, 3), DEGREE)


# Splats of a file to start a training from: of an earlier training, or of another program.

PANEL_VIEWS = 32
"""Photos, evenly chosen, that tell which panel splats belong to."""

PANEL_PX = 256 * 192
"""About as many pixels of each are looked at."""

REACH_M = 1000.0
"""From the model's middle; further splats are the sky's business, as of those that are placed."""


def splats_of_file(
    path: Path,
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    origin_enu_m: Array,
    memory_bytes: int,
    monitor: Monitor = QUIET,
) -> Splats:
    """Splats of a PLY file in the model's frame, ENU less `origin_enu_m`.

    Where the file says of no splat which panel it belongs to, photos tell (`assign_panels`). What is too far away is
    left out.

    Raises
    ------
    InputError
        The file cannot be read, or is of another site.
    OperationCancelled
        From `monitor`.
    """
    found = read_splats(path)
    splats, n_panels = found.splats, len(source.panels.corners_enu_m)
    if int(splats.panels.max()) >= n_panels:
        raise InputError(
            say(
                "has splats on panel {}, and {} has {} panels; name a file of the same site",
                int(splats.panels.max()) + 1,
                source.folder,
                n_panels,
                place=path,
            )
        )
    means = splats.means.detach().double() + torch.from_numpy(np.array(found.origin_enu_m) - origin_enu_m)
    kept = means.norm(dim=1) <= REACH_M
    if not bool(kept.any()):
        raise InputError(
            say(
                "has no splat within {:g} m of the panels of {}; are both in one frame?",
                REACH_M,
                source.folder,
                place=path,
            )
        )
    values = {name: value.detach()[kept] for name, value in splats.named_parameters()}
    splats = Splats(values | {"means": means[kept].float()}, splats.panels[kept])
    if bool((splats.panels == NO_PANEL).all()):
        seen = _panels_seen(source, photos, origin_enu_m, memory_bytes)
        splats.panels.copy_(assign_panels(splats, seen, source.panels.corners_enu_m - origin_enu_m, monitor=monitor))
    return splats


def _panels_seen(
    source: PhotoSet, photos: Sequence[PosedPhoto], origin_enu_m: Array, memory_bytes: int
) -> Iterator[tuple[View, NDArray[np.int32]]]:
    """Views, and the panels of their pixels."""
    chosen = np.unique(np.linspace(0, len(photos) - 1, min(len(photos), PANEL_VIEWS)).round().astype(int))
    most = max(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in photos)
    settings = StreamSettings(memory_bytes, reduce=max(1, math.isqrt(most // PANEL_PX)))
    with PhotoStream(source, [photos[number].name for number in chosen], origin_enu_m, settings) as stream:
        for number in range(len(stream.photos)):
            sample = stream.frame(number)
            yield sample.view, sample.panels.numpy()


def _said_smaller(photos: Sequence[PosedPhoto], reduce: int) -> str:
    """That photos are made smaller."""
    largest = max((photo.intrinsics for photo in photos), key=lambda lens: lens.width_px * lens.height_px)
    wide, high = largest.width_px, largest.height_px
    return say(
        "photos of {} x {} pixels are learned from at {} x {}, which steps see more often; with the setting 'reduce' "
        "at 1 all pixels count, and a training needs {} times as long",
        *(wide, high, wide // reduce, high // reduce, reduce**2),
    )


def _placed_splats(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    scene: KnownScene,
    origin: NDArray[np.float64],
    config: TrainConfig,
    monitor: Monitor,
) -> tuple[Splats, tuple[Decision, ...]]:
    """New splats, and whether they begin on points where a mesh is there, too."""
    decisions: tuple[Decision, ...] = ()
    finest_px = InitialParameters().finest_px * config.reduce
    parameters = InitialParameters(n_splats=config.n_splats, finest_px=finest_px, seed=config.seed)
    if config.start_from == "points":
        start = points_only(scene, source.folder, knows_panels=config.trained_by.knows_panels)
    else:
        places = np.array([photo.pose.position_enu_m for photo in learned])
        start, on_points = scene_of_points(scene, places, config.points_for_mesh)
        decisions = () if on_points is None else (on_points,)
    return initial_splats(start, learned, origin, parameters, source.picture, monitor), decisions


LEAST_LIGHT_S = 1.0
"""For learning light, where nearly all time is gone before it begins."""


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A model before its joint training.

    Parameters
    ----------
    config
        As asked, with what the photos call for.
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
    transients
        Blocks of photos that were left out meanwhile.
    history
        PSNR, dB, of held-out views whenever somebody was shown the model, by seconds.
    """

    config: TrainConfig
    model: SceneModel
    exposures: Exposures
    learned: tuple[PosedPhoto, ...]
    held_out: tuple[str, ...]
    extent_m: float
    light_name: str
    decisions: tuple[Decision, ...] = ()
    moves: tuple[Move, ...] = ()
    notes: tuple[str, ...] = ()
    transients: NDArray[np.bool_] | None = None
    history: tuple[tuple[float, float], ...] = ()


def start_model(
    source: PhotoSet,
    config: TrainConfig,
    monitor: Monitor = QUIET,
    watch: Timer | None = None,
    checkpoint: Path | None = None,
    interrupted: InterruptedLightStage | None = None,
    splats_path: Path | None = None,
    show: Show = unshown,
) -> Start:
    """Place splats, learn the light that glass mirrors from its rays alone, and put both together.

    Parameters
    ----------
    watch
        Of the whole training; None for one that begins now.
    checkpoint
        File that learning light can go on from if it is interrupted; None for none.
    interrupted
        What it goes on from.
    splats_path
        PLY file of splats to start from; None for new ones.
    show
        See `Callbacks.show_before`.

    Raises
    ------
    InputError
        The folder has too few photos, nothing to start from, or no glass to be seen; `interrupted` is of other photos.
    ReconstructionError
        Learning light failed.
    OperationCancelled
        From `monitor`.
    """
    watch = watch or Timer()
    notes: tuple[str, ...] = ()
    if config.reduce == 0:
        config = replace(config, reduce=usual_reduce([photo.intrinsics for photo in source.photos], config.window_px))
        notes = () if config.reduce == 1 else (_said_smaller(source.photos, config.reduce),)
    held_out = held_out_names([photo.name for photo in source.photos], config.held_out, config.seed)
    learned = tuple(photo for photo in source.photos if photo.name not in held_out)
    scene = known_scene(source)
    origin = model_origin(scene)
    told = told_by_points(
        *(source, learned, scene.points_enu_m, scene.mesh),
        *(config.own_exposures, config.outlier_photos, monitor),
    )
    kept = [number for number in range(len(learned)) if number not in told.outliers]
    learned, point_gains = tuple(learned[number] for number in kept), told.gains[kept]
    has_gains = told.own_exposures.on
    config = replace(
        config,
        own_exposures="on" if has_gains else "off",
        outlier_photos="on" if told.outlier_photos.on else "off",
    )
    decisions: tuple[Decision, ...] = (told.own_exposures, told.outlier_photos)
    exposures, source = _exposures(source, learned, point_gains if has_gains else None)
    if interrupted is not None:
        splats = splats_from_tensors(interrupted.splats, str(checkpoint))
    elif splats_path is not None:
        given = splats_of_file(splats_path, source, learned, origin, config.memory_bytes, monitor)
        splats = with_primitive(given, config.trained_by.primitive)
    else:
        splats, on_points = _placed_splats(source, learned, scene, origin, config, monitor)
        decisions += on_points
    look = None
    if show is not unshown:
        look = _Look(show, config, watch, shown_views(source, held_out, origin, config.memory_bytes))
        look(_joined(source, learned, splats, None, None, origin, config))
    light: TrainedReflections | None = None
    shader, is_told = None, False
    if interrupted is None and config.trained_by.knows_panels:
        white, decision = white_of(source, learned, config.overexposed)
        config = with_white(config, white)
        decisions = (*decisions, decision)
    if not config.trained_by.knows_panels:
        triangles = (scene.mesh.corners_enu_m - origin).astype(np.float32).reshape(-1, 3, 3)
        shader = shader_of(config, Surroundings(triangles))
        splats = converted_for_method(splats, config, shader)
    else:
        done = _learned_light(source, learned, config, splats, monitor, watch, checkpoint, interrupted, decisions, look)
        light, splats, decisions, is_told = done.light, done.splats, done.decisions, done.is_in_splats
    moves = learned_moves(None if light is None else light.panels.light, len(learned))
    cameras = np.array([photo.pose.position_enu_m for photo in moved(learned, moves)])
    if light is not None and not is_told:
        warm_start_splats(light.panels, splats, source.panels, origin, cameras)
    return Start(
        config,
        _joined(source, learned, splats, light, shader, origin, config),
        exposures,
        learned,
        held_out,
        _extent_m(cameras),
        "" if light is None else light.model,
        decisions,
        moves,
        notes if light is None else (*notes, *light.notes),
        None if light is None else light.transients,
        () if look is None else tuple(look.history),
    )


@dataclass(slots=True, eq=False)
class _Look:
    """Shows somebody a model before its first step, and scores the views that trainings are looked at by."""

    show: Show
    config: TrainConfig
    watch: Timer
    views: tuple[HeldOut, ...]
    history: list[tuple[float, float]] = field(default_factory=list)

    @torch.no_grad()
    def __call__(self, model: SceneModel) -> None:
        model.eval()
        settings, degree = self.config.raster, self.config.degree_at(0.0)

        def displayed(held_out: HeldOut) -> Tensor:
            picture: Picture = model(held_out.sample.view, held_out.gain, degree, settings=settings)
            return picture.display.clamp(0.0, 1.0)

        self.history.append((self.watch(), quality_db(self.views, displayed)))
        self.show(model, settings, self.history)


def _exposures(
    source: PhotoSet, learned: Sequence[PosedPhoto], point_gains: Array | None
) -> tuple[Exposures, PhotoSet]:
    """Gains of photos to start from, as points tell them, shape (n, 3), or as is known; and the photo set with them."""
    known = np.array([source.own_exposures.get(photo.name, 1.0) for photo in learned])
    if point_gains is None:
        return Exposures(known), source
    gains = np.exp(np.log(point_gains).mean(axis=1)) * known
    own = dict(zip([photo.name for photo in learned], gains.tolist(), strict=True))
    return Exposures(known[:, None] * point_gains), replace(source, own_exposures={**source.own_exposures, **own})


SHOWN_VIEWS = 4
"""Held-out views that the quality is measured on while training runs."""

SHOWN_SHARE = 0.25
"""Of the memory for photos, at most, for held-out ones that the quality is measured on."""

SHOWN_PX = 512 * 384
"""About as many pixels of held-out views are looked at: larger ones are made smaller, so that looking takes no time."""


def shown_views(source: PhotoSet, names: Sequence[str], origin: Array, memory_bytes: int) -> tuple[HeldOut, ...]:
    """Of all held-out views, those that are looked at while a training runs, in their share of the memory."""
    some = names[:: -(-len(names) // SHOWN_VIEWS)]
    return held_out_views(source, some, origin, round(SHOWN_SHARE * memory_bytes))


def held_out_views(
    source: PhotoSet, names: Sequence[str], origin_enu_m: Array, memory_bytes: int
) -> tuple[HeldOut, ...]:
    """Views that the quality is measured on while a training runs, made smaller."""
    most = max(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in source.photos)
    few = StreamSettings(max(1, memory_bytes), reduce=max(1, math.isqrt(most // SHOWN_PX)))
    with PhotoStream(source, names, origin_enu_m, few) as shown:
        return tuple(
            HeldOut(shown.frame(number), source.own_exposures.get(photo.name, 1.0))
            for number, photo in enumerate(shown.photos)
        )


# Whether light apart from the splats is worth it: both ways are tried for a short while, and scored on views held back.
#
# Where mirror images differ from photo to photo, or too little is known of where cameras were, light that is learned
# apart tells unseen photos worse than splats alone do, although it tells glass better than harmonics of a pane do.

CLEAR_DB = 3.0
"""That light apart gains on harmonics, on rays of unseen photos, from which on nobody need ask further."""

TRIAL_SHARE = 0.08
"""Of a training, for all ways together."""

LEAST_TRIAL_STEPS = 20

ALONE_MODEL: ModelName = "harmonics"
"""Of panes, where splats are alone."""

LOOKS, MOST_SCORED = 3, 8
"""At photos held back, evenly spread over both trials, which end where one is surely better; and photos looked at."""

NEVER_S = 1e9


@dataclass(frozen=True, slots=True)
class SeparateLight:
    """Whether light that is learned apart from the splats tells unseen views better.

    It has learned for a while before the trial begins, which it therefore leads by more than it does later: of a real
    wall 0.1 dB became -0.6 dB in the end, where its processor was slow.
    """

    name: str = say("light apart from the splats")
    unit: str = "dB"
    tolerance: float = 0.3

    def assess(self, scene: tuple[float, float, float, float] | None) -> Assessment:
        """By PSNR, dB, of views held back with it and without, the difference's standard error, and its cost, seconds.

        A gain counts as far as it is beyond that error. None: nobody has tried.
        """
        if scene is None:
            return Assessment(0.0, say("nothing was tried"), 0.0)
        apart, alone, unsure, cost_s = scene
        reason = say("views held back have {:.1f} dB with it, {:.1f} dB with splats alone", apart, alone)
        return Assessment(apart - alone - unsure, reason, cost_s)


@dataclass(frozen=True, slots=True, eq=False)
class _Worth:
    """What came of it: the decision, the model of light that is best, PSNR of all, dB, and the best one's splats.

    What these have learned is not thrown away: a training goes on with them.
    """

    decision: Decision
    name: ModelName
    scores_db: Mapping[ModelName, float]
    splats: Splats


@dataclass(slots=True, eq=False)
class _JointTrial:
    """One way: its training, its own time, and the views that it is scored on."""

    trainer: Trainer
    watch: Timer
    shown: tuple[HeldOut, ...]


@contextmanager
def _turn(trials: Collection[_JointTrial], of: _JointTrial | None = None) -> Iterator[None]:
    """Let the time of one trial go on within a block, and that of no other."""
    with ExitStack() as waiting:
        for trial in trials:
            if trial is not of:
                waiting.enter_context(trial.watch.paused())
        yield


def _is_worth(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    splats: Splats,
    tried: LightTrials,
    names: Sequence[ModelName],
    config: TrainConfig,
    watch: Timer,
    monitor: Monitor,
    look: _Look | None,
) -> _Worth:
    """Train with light apart, of one model or several, and without for a short while; score all on unseen photos.

    Trainings go on in turns. One whose photos are surely worse than those of another light ends, and all end as soon as
    photos tell whether light apart is better.
    """
    unseen = [learned[number].name for number in tried.unseen]
    seen = tuple(photo for photo in learned if photo.name not in unseen)
    scored = unseen[:MOST_SCORED]
    n_looks, tolerance_db = LOOKS * len(names), SeparateLight().tolerance
    with ExitStack() as closing:
        trials: dict[ModelName, _JointTrial] = {}
        for name in (*names, ALONE_MODEL):
            with _turn(trials.values()):
                light = tried.found[name]
                trials[name] = _joint_trial(source, seen, scored, splats, light, config, len(names) + 1, watch, closing)
        going = [*names]
        scores: dict[ModelName, NDArray[np.float64]] = {}
        for number in range(1, LOOKS + 1):
            for name in (*going, ALONE_MODEL):
                done = sum(trial.trainer.progress for other, trial in trials.items() if other != name) / len(trials)
                part = PartOf(monitor, say("trying light together with splats"), done, done + 1.0 / len(trials))
                with _turn(trials.values(), trials[name]):
                    trials[name].trainer.run(Callbacks(part), number / LOOKS)
            with _turn(trials.values()):
                scores |= {name: np.array(_of_views(trials[name])) for name in (*going, ALONE_MODEL)}
            best = max(going, key=lambda name: float(scores[name].mean()))
            going = [x for x in going if x == best or not surely_more(scores[best] - scores[x], 0.0, n_looks)]
            is_better = surely_more(scores[best] - scores[ALONE_MODEL], tolerance_db, n_looks)
            if is_better is not None and (len(going) == 1 or not is_better):
                break
    means = {name: float(scores[name].mean()) for name in trials}
    unsure_db = standard_error(scores[best] - scores[ALONE_MODEL])
    worth = decide(SeparateLight(), (means[best], means[ALONE_MODEL], unsure_db, tried.trials.seconds))
    better = trials[best if worth.on else ALONE_MODEL]
    if look is not None:
        look(better.trainer.model)
    kept = splats_from_tensors(splats_to_tensors(better.trainer.model.splats), str(source.folder))
    return _Worth(worth, best if worth.on else ALONE_MODEL, means, kept)


def _of_views(trial: _JointTrial) -> list[float]:
    return trial.trainer.qualities_db(trial.shown)


def _joint_trial(
    source: PhotoSet,
    seen: Sequence[PosedPhoto],
    scored: Sequence[str],
    splats: Splats,
    light: TrainedReflections,
    config: TrainConfig,
    n_trials: int,
    watch: Timer,
    closing: ExitStack,
) -> _JointTrial:
    """One of several short trainings on some photos, not yet begun; photos are open until `closing` ends."""
    share = TRIAL_SHARE / n_trials
    limit_s = None if config.time_limit_s is None else share * config.time_limit_s
    short = replace(
        config,
        time_limit_s=limit_s,
        iterations=max(LEAST_TRIAL_STEPS, round(share * config.iterations)),
        densification="none",
        own_poses="off",
        transients="off",
        score_every_s=NEVER_S,
        checkpoint_every_s=NEVER_S,
    )
    origin, model = model_origin(known_scene(source)), _with_light(source, seen, splats, light, config)
    with_normals = config.losses.normal_prior > 0.0
    memory_bytes = config.memory_bytes // (2 * n_trials)
    settings = StreamSettings(memory_bytes, config.window_px, config.reduce, with_normals)
    photos = closing.enter_context(PhotoStream(source, [photo.name for photo in seen], origin, settings))
    shown = held_out_views(source, scored, origin, memory_bytes)
    timer = Timer(watch.clock)
    trainer = Trainer(
        model,
        Exposures([source.own_exposures.get(photo.name, 1.0) for photo in seen]),
        PoseCorrections(seen, origin),
        Transients([(photo.intrinsics.width_px, photo.intrinsics.height_px) for photo in seen]),
        photos,
        strategy_of(short, len(model.splats)),
        short,
        extent_m=_extent_m(np.array([photo.pose.position_enu_m for photo in seen])),
        watch=timer,
    )
    return _JointTrial(trainer, timer, shown)


def _with_light(
    source: PhotoSet, photos: Sequence[PosedPhoto], splats: Splats, light: TrainedReflections, config: TrainConfig
) -> SceneModel:
    """The model of copies of splats, which show what the light does."""
    origin = model_origin(known_scene(source))
    own = splats_from_tensors(splats_to_tensors(splats), str(source.folder))
    cameras = np.array([photo.pose.position_enu_m for photo in photos])
    warm_start_splats(light.panels, own, source.panels, origin, cameras)
    return _joined(source, photos, own, light, None, origin, config)


def with_white(config: TrainConfig, white: float) -> TrainConfig:
    """Settings with a value from which on photos are taken as overexposed."""
    losses, reflections = replace(config.losses, white=white), replace(config.reflections, white=white)
    return replace(config, losses=losses, reflections=reflections)


@dataclass(frozen=True, slots=True, eq=False)
class _LightLearned:
    """What is learned before the joint training, and all decisions so far.

    Parameters
    ----------
    splats
        Those that were placed, or what trials have made of them.
    is_in_splats
        Whether they show what `light` does.
    """

    light: TrainedReflections
    splats: Splats
    decisions: tuple[Decision, ...]
    is_in_splats: bool = False


def _learned_light(
    source: PhotoSet,
    learned: Sequence[PosedPhoto],
    config: TrainConfig,
    splats: Splats,
    monitor: Monitor,
    watch: Timer,
    checkpoint: Path | None,
    interrupted: InterruptedLightStage | None,
    before: tuple[Decision, ...],
    look: _Look | None,
) -> _LightLearned:
    """The light, or harmonics where splats alone tell more, after what was decided `before`."""
    settings = replace(
        config.reflections,
        transients=config.transients,
        seed=config.seed,
        threads=config.threads,
        memory_bytes=config.memory_bytes,
    )
    rays = glass_rays(source, learned, settings.memory_bytes, settings.seed, monitor)
    if not len(rays):
        raise InputError(
            say(
                "none of {} photos has a pixel that lies whole on a panel; take larger photos or come closer, or "
                "train splats alone (--method 2dgs)",
                len(learned),
                place=source.folder,
            )
        )
    digest = checksum(rays)
    no_decisions: tuple[Decision, ...] = ()

    def look_at(light: TrainedReflections) -> None:
        if look is not None:
            look(_with_light(source, learned, splats, light, config))

    if interrupted is None:
        name, decisions = config.light, no_decisions
        if name == "auto" and config.light_apart == "off":
            name, decisions = "harmonics", (decide(SeparateLight(), None, "off"),)
        elif name == "auto":
            quick = replace(settings, transients="off", time_limit_s=_light_limit_s(config, watch))
            tried = try_lights(rays, source.panels, quick, monitor, device=config.tensors_on)
            name, decisions = ("environment-map", no_decisions) if tried is None else chosen(tried.trials)
            if tried is not None and look is not None:
                look_at(copy.deepcopy(tried.found[name]))
            if config.light_apart == "on":
                decisions = (*decisions, decide(SeparateLight(), None, "on"))
            elif tried is not None and name != ALONE_MODEL and decisions[0].size < CLEAR_DB:
                names = (name, *contenders(tried.trials, name))
                worth = _is_worth(source, learned, splats, tried, names, config, watch, monitor, look)
                name, splats = worth.name, worth.splats
                if len(names) > 1:
                    decisions = (decisions[0], with_splats(worth.scores_db, tried.trials.seconds))
                decisions = (*decisions, worth.decision)
                if not worth.decision.on:
                    return _LightLearned(tried.found[name], splats, (*before, *decisions), True)
        limit_s = _light_limit_s(config, watch)
        stage = LightStage(config, site_record(source.folder), name, (*before, *decisions), limit_s, digest)
    else:
        stage = interrupted.stage
        if digest != stage.rays_sha256:
            raise InputError(
                say(
                    "its photos, cameras or panels are not those that the training was begun with; name that data set",
                    place=source.folder,
                )
            )
    keeping = None
    if checkpoint is not None:
        placed = splats_to_tensors(splats)
        write = lambda state: write_light(checkpoint, InterruptedLightStage(stage, placed, state, watch()))  # noqa: E731
        keeping = CheckpointSettings(
            write, config.checkpoint_every_s, None if interrupted is None else interrupted.state
        )
    # Harmonics cannot show what is mirrored: all of it would be a transient.
    of_rays = "off" if stage.name == "harmonics" else settings.transients
    settings = replace(settings, transients=of_rays, time_limit_s=stage.time_limit_s)
    try:
        trained = train_reflections(
            rays,
            source.panels,
            stage.name,
            settings,
            source.exposure,
            monitor=monitor,
            keeping=keeping,
            device=config.tensors_on,
            clock=watch.clock,
            look=None if look is None else look_at,
        )
    except ValueError as error:
        if interrupted is None:
            raise
        raise InputError(
            say("is of another version, or damaged ({}); begin the training anew", error, place=checkpoint)
        ) from error
    return _LightLearned(trained, splats, (*stage.decisions, *trained.decisions))


def _light_limit_s(config: TrainConfig, watch: Timer) -> float | None:
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
