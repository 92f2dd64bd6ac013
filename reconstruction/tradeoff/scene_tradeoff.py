"""What accuracy of rendered photos costs in time: rays, size, renderer and effects, one at a time, against the truth.

The truth is the same photo by the physically based renderer with every effect and many rays. Pictures are compared as
the camera develops them, without its noise, which no second picture repeats.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.errors import InfeasibleError, InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from planning.site.records import Facade
from planning.tradeoff.runner import GapAxis, Panel, knob_lines
from reconstruction.base.cameras import PosedPhoto
from reconstruction.metrics.metrics import PhotoScores, SetScores, summarise
from reconstruction.metrics.run import own_method, score_answer
from reconstruction.metrics.sets import EXTENT_MARGIN_M, ScoredPhoto
from reconstruction.panels.rectify.fit import fit_cylinder, fit_plane
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.scenes.effects.registry import EFFECTS
from reconstruction.scenes.parameters import (
    DEPTH_OF_FIELD,
    DISTORTION,
    EXPOSURE,
    GIMBAL_ERROR,
    MOTION_BLUR,
    NOISE,
    POSITION_ERROR,
    RenderSettings,
)
from reconstruction.scenes.photos.lens_effects import developed, metered_exposure
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Scene

# Rendered photos of scenes as photos to score: what they show of each facade is known from pose and site.

Array = NDArray[np.float64]

FLAT_M = 0.005
"""Panels whose points keep this close to a plane stand on it; facets of a curved facade do not."""

ALONG = np.linspace(0.0, 1.0, 3)
"""Where points are taken along a panel's sides, so that one panel alone makes a surface as well."""

Wall = tuple[FacadeSurface, Array, Array]
"""A facade's surface and its extent on it, from low to high, each shape (2,), metres."""


def walls(facades: Sequence[Facade]) -> tuple[Wall, ...]:
    """Planes or cylinders that the panels of facades stand on, as far as `EXTENT_MARGIN_M` around them.

    Facades whose panels make no surface are left out.
    """
    found = []
    for facade in facades:
        with suppress(InfeasibleError):
            found.append(_wall(facade))
    return tuple(found)


def _wall(facade: Facade) -> Wall:
    corners = np.array([panel.corners_enu_m for panel in facade.panels], float)
    u, v = np.meshgrid(ALONG, ALONG)
    weights = np.stack([(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v], axis=-1).reshape(-1, 4)
    points = np.einsum("wk,mkx->mwx", weights, corners).reshape(-1, 3)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]).sum(axis=0)
    outside = points.mean(axis=0) + 100.0 * normal / np.linalg.norm(normal)
    surface = fit_plane(points, outside).surface
    if np.abs(surface.height_m(points)).max() > FLAT_M:
        surface = fit_cylinder(points, outside).surface
    st = surface.to_surface(points)
    return surface, st.min(axis=0) - EXTENT_MARGIN_M, st.max(axis=0) + EXTENT_MARGIN_M


def rendered_photo(
    photo: PosedPhoto, image: NDArray[np.uint8], panel: NDArray[np.uint16], walls_seen: Sequence[Wall]
) -> ScoredPhoto:
    """A rendered photo with its truth.

    Parameters
    ----------
    image
        Shape (h, w, 3): blue, green, red.
    panel
        Shape (h, w): 1 + number of the panel that each pixel shows, 0 for none.
    walls_seen
        Of the site; those that the photo does not show from their front are passed over.
    """
    views: list[SurfaceView] = []
    for surface, low, high in walls_seen:
        with suppress(InfeasibleError):
            views.append(surface_view(photo, surface, low, high))
    return ScoredPhoto(photo.name, image, panel, views=tuple(views))


WHITE = 255.0

OF_A_FLIGHT = (DISTORTION, DEPTH_OF_FIELD, MOTION_BLUR, EXPOSURE, POSITION_ERROR, GIMBAL_ERROR)
"""Effects that single photos of a straight camera at rest do not show."""

OF_A_PHOTO = tuple(effect.name for effect in EFFECTS if effect.name not in OF_A_FLIGHT)

ERROR_AXIS = GapAxis(
    label="error against the truth (PSNR)",
    ticks=tuple(10.0 ** (-db / 20.0) for db in (10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60)),
    text=lambda gap: f"{-20.0 * math.log10(gap):.0f} dB",
    floor=10.0 ** (-65 / 20.0),
    bound_text="the truth",
)


class CanRender(Protocol):
    """Something that takes photographs of a scene."""

    def render(self, photo: PosedPhoto, seed: int = 0) -> RenderedPhoto:
        """Take one."""


MakeRenderer = Callable[[Scene, RenderSettings, int], CanRender]
"""A physically based renderer of a scene, its settings and rays a pixel."""


@dataclass(frozen=True, slots=True)
class SceneVariants:
    """Values of each knob; all others stay as they are.

    Parameters
    ----------
    samples
        Rays along each side of a pixel, of the embedded renderer.
    widths_px
        Of photos that are rendered smaller and enlarged again.
    rays
        A pixel, of the physically based renderer.
    effects
        That are turned off where the scene wants them, and on where it does not.
    """

    samples: tuple[int, ...] = (1, 2, 3, 4)
    widths_px: tuple[int, ...] = ()
    rays: tuple[int, ...] = ()
    effects: tuple[str, ...] = OF_A_PHOTO

    def __post_init__(self) -> None:
        unknown = [name for name in self.effects if name not in OF_A_PHOTO]
        if unknown:
            raise InputError(
                say("there is no effect '{}' of single photos; expected one of {}", unknown[0], ", ".join(OF_A_PHOTO))
            )
        for option, least, values in (
            ("--samples", 1, self.samples),
            ("--widths", 16, self.widths_px),
            ("--rays", 1, self.rays),
        ):
            if any(value < least for value in values):
                raise InputError(say("expected {} or more, got {}", least, min(values), place=option))


Knob = Literal["", "samples", "width", "rays", "effect", "all effects"]


@dataclass(frozen=True, slots=True)
class SceneSetting:
    """One way to render.

    Parameters
    ----------
    knob, value
        What was turned, and to where; the first is empty for what the others start from.
    width_px
        None: that of the photos.
    rays
        A pixel of the physically based renderer; None for the embedded one.
    """

    knob: Knob
    value: str
    settings: RenderSettings
    width_px: int | None = None
    rays: int | None = None

    @property
    def name(self) -> str:
        """For tables."""
        return f"{self.knob} {self.value}" if self.knob else "as the scene decides"


@dataclass(frozen=True, slots=True, eq=False)
class SceneTrial:
    """A way to render and what came of it.

    Parameters
    ----------
    prepare_s, seconds
        Of making the renderer, once, and of rendering a photo.
    error
        Root mean square of the difference to the truth, 1 for white.
    panels
        How well panels are found in these photos.
    """

    setting: SceneSetting
    prepare_s: float
    seconds: float
    error: float
    panels: SetScores

    @property
    def knob(self) -> str:
        """What was turned."""
        return self.setting.knob

    @property
    def value(self) -> str:
        """To where."""
        return self.setting.value

    @property
    def gap(self) -> float:
        """Its error."""
        return self.error

    @property
    def psnr_db(self) -> float:
        """Peak signal-to-noise ratio against the truth."""
        return -20.0 * math.log10(max(self.error, 1e-12))


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What photos are compared with.

    Parameters
    ----------
    name
        How it was made.
    rendered
        The photographs.
    again
        The same with another seed, which says how far the truth itself has converged; None where nothing is random.
    seconds
        That a photograph of it took.
    panels
        How well panels are found in its photographs.
    """

    name: str
    rendered: tuple[RenderedPhoto, ...]
    again: tuple[RenderedPhoto, ...] | None
    seconds: float
    panels: SetScores


def scene_settings(
    base: RenderSettings, decisions: Sequence[Decision], variants: SceneVariants, width_px: int
) -> tuple[SceneSetting, ...]:
    """Every way to render that is asked for, what the scene decides first."""
    decided = base.decided(decisions)
    found = [SceneSetting("", "", decided)]
    found += [SceneSetting("samples", str(n), replace(decided, samples=n)) for n in variants.samples]
    found += [SceneSetting("width", str(w), decided, width_px=w) for w in variants.widths_px if w < width_px]
    found += [SceneSetting("rays", str(n), decided, rays=n) for n in variants.rays]
    for decision in decisions:
        if decision.effect in variants.effects:
            turned: Literal["on", "off"] = "off" if decision.on else "on"
            effects = {**decided.effects, decision.effect: turned}
            found.append(SceneSetting("effect", f"{decision.effect} {turned}", replace(decided, effects=effects)))
    if variants.effects:
        for turned in ("on", "off"):
            effects = {decision.effect: turned for decision in decisions}
            found.append(SceneSetting("all effects", turned, replace(decided, effects=effects)))
    return tuple(found)


def make_truth(
    scene: Scene,
    photos: Sequence[PosedPhoto],
    make: tuple[MakeRenderer, int] | None,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> Truth:
    """Photographs with every effect, by a physically based renderer and its rays a pixel, or by the embedded one."""
    settings = RenderSettings(samples=TRUTH_SAMPLES, effects={effect.name: "on" for effect in EFFECTS})
    renderer = Renderer(scene, settings) if make is None else make[0](scene, settings, make[1])
    passes, started = (1 if make is None else 2), clock()
    rendered: list[list[RenderedPhoto]] = [[] for _ in range(passes)]
    for again in range(passes):
        for number, photo in enumerate(photos):
            monitor.report(say("rendering the truth"), again * len(photos) + number, passes * len(photos))
            rendered[again].append(renderer.render(photo, seed=again * len(photos) + number))
    seconds = (clock() - started) / (passes * len(photos))
    if make is None:
        name = say("embedded, {} x {} rays", TRUTH_SAMPLES, TRUTH_SAMPLES)
    else:
        name = say("Mitsuba, {} rays", make[1])
    seen = walls(scene.site.site.facades)
    scores = [
        _panel_scores(photo, one, metered_exposure(one), seen) for photo, one in zip(photos, rendered[0], strict=True)
    ]
    return Truth(name, tuple(rendered[0]), tuple(rendered[1]) if passes == 2 else None, seconds, summarise(scores))


TRUTH_SAMPLES = 8
"""Rays along a pixel's side, where the embedded renderer has to be the truth."""


def truth_error(truth: Truth) -> float:
    """Error of the truth itself: half the variance between two of its pictures is each one's; 0 without a second."""
    if truth.again is None:
        return 0.0
    squares = []
    for one, other in zip(truth.rendered, truth.again, strict=True):
        exposure = metered_exposure(one)
        squares.append(_mean_square(_grey(one, exposure), _grey(other, exposure)))
    return math.sqrt(0.5 * float(np.mean(squares)))


def run_scene_variants(
    scene: Scene,
    photos: Sequence[PosedPhoto],
    truth: Truth,
    settings: Sequence[SceneSetting],
    make: MakeRenderer | None = None,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> tuple[SceneTrial, ...]:
    """Render the photos in every way, measure time and error, and look for panels in them.

    Parameters
    ----------
    make
        The physically based renderer, where settings ask for it.

    Raises
    ------
    OperationCancelled
        The user cancelled.
    """
    grey = [_grey(taken, metered_exposure(taken)) for taken in truth.rendered]
    seen, trials = walls(scene.site.site.facades), []
    # Compiling and loading is in no setting's time; light that is gathered once for all photos is in each's.
    Renderer(scene, settings[0].settings).render(photos[0])
    for step, setting in enumerate(settings):
        started = clock()
        renderer: CanRender
        if setting.rays is None:
            renderer = Renderer(scene, setting.settings)
        elif make is None:
            raise ValueError(f"'{setting.name}' needs a physically based renderer")
        else:
            renderer = make(scene, setting.settings, setting.rays)
        prepare_s = clock() - started
        spent_s, squares, scores = 0.0, [], []
        for number, photo in enumerate(photos):
            monitor.report(setting.name, step * len(photos) + number, len(settings) * len(photos))
            small = photo if setting.width_px is None else _narrowed(photo, setting.width_px)
            started = clock()
            taken = renderer.render(small, seed=number)
            spent_s += clock() - started
            exposure = metered_exposure(truth.rendered[number])
            squares.append(_mean_square(_enlarged(_grey(taken, exposure), grey[number]), grey[number]))
            scores.append(_panel_scores(small, taken, exposure, seen))
        trials.append(
            SceneTrial(setting, prepare_s, spent_s / len(photos), math.sqrt(float(np.mean(squares))), summarise(scores))
        )
    return tuple(trials)


def _panel_scores(photo: PosedPhoto, rendered: RenderedPhoto, exposure: float, walls: Sequence[Wall]) -> PhotoScores:
    scored = rendered_photo(photo, developed(rendered, exposure), rendered.panel, walls)
    return score_answer(scored, own_method()(scored, QUIET))


def _narrowed(photo: PosedPhoto, width_px: int) -> PosedPhoto:
    lens = photo.intrinsics
    return replace(photo, intrinsics=lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px))))


def _grey(rendered: RenderedPhoto, exposure: float) -> NDArray[np.uint8]:
    return developed(replace(rendered, in_camera=rendered.in_camera - {NOISE}), exposure)


def _enlarged(picture: NDArray[np.uint8], other: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if picture.shape == other.shape:
        return picture
    size = other.shape[1::-1]
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_CUBIC), np.uint8)


def _mean_square(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    return float((((one.astype(np.float64) - other) / WHITE) ** 2).mean())


def scene_rows(truth: Truth, trials: Sequence[SceneTrial]) -> list[dict[str, Any]]:
    """Rows of the table, the truth first.

    Changes of the error are against what the scene decides, those of the panels' score against the truth: what a
    search would wrongly seem better or worse by.
    """
    base = trials[0]
    rows: list[dict[str, Any]] = [{"setting": "the truth", "seconds": round(truth.seconds, 4), **_found(truth, truth)}]
    for trial in trials:
        rows.append(
            {
                "setting": trial.setting.name,
                "seconds": round(trial.seconds, 4),
                "prepare_s": round(trial.prepare_s, 3),
                "psnr_db": round(trial.psnr_db, 2),
                "psnr_change_db": round(trial.psnr_db - base.psnr_db, 2),
                **_found(trial, truth),
            }
        )
    return rows


def _found(trial: SceneTrial | Truth, truth: Truth) -> dict[str, Any]:
    mine, true = trial.panels.individual_miou, truth.panels.individual_miou
    if mine is None or true is None:
        return {"individual_miou": None, "individual_miou_change": None, "missed": None}
    change = round(mine.mean - true.mean, 4)
    return {"individual_miou": round(mine.mean, 4), "individual_miou_change": change, "missed": trial.panels.n_missed}


def scene_panel(title: str, trials: Sequence[SceneTrial], truth: Truth) -> Panel:
    """A line for each knob; the truth's own error as a mark."""
    lines = knob_lines(trials, "as the scene decides", lambda best: f"{best.psnr_db:.1f} dB in {best.seconds:.2f} s")
    own = truth_error(truth)
    return Panel(title, lines, (("the truth itself", own),) if own > 0.0 else ())
