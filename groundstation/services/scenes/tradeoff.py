"""Use case of asking which rays, sizes, renderers and effects of simulated photos are worth their time."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.services.scenes.views import SceneRequest, given_scene, plan_of_site, planned_photos
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.tradeoff.runner import Compared, Subject, compare
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.photos.flight_views import lens_of, planned_shots, posed_photos
from reconstruction.scenes.photos.square_views import square_photos
from reconstruction.scenes.record import Scene
from reconstruction.tradeoff.scene_tradeoff import (
    ERROR_AXIS,
    MakeRenderer,
    SceneTrial,
    SceneVariants,
    Truth,
    make_truth,
    run_scene_variants,
    scene_panel,
    scene_rows,
    scene_settings,
)

if TYPE_CHECKING:
    from reconstruction.light.config import ReflectionConfig
    from reconstruction.tradeoff.scene_downstream import EffectWorth

DEFAULT_VIEWS = 4

REFLECTIONS_WIDTH_PX = 128
"""Of photos that reflections are learned from: dozens of them, a minute of training on two cores."""


@dataclass(frozen=True, slots=True, eq=False)
class SceneTrials:
    """What `tradeoff scene` found.

    Parameters
    ----------
    title
        What was rendered, and what it was compared with.
    trials
        Every way to render.
    decisions
        What the scene decides.
    worths
        What effects are worth to who learns reflections from the photos; empty where that was not asked.
    """

    title: str
    trials: tuple[SceneTrial, ...]
    decisions: tuple[Decision, ...]
    truth: Truth
    worths: tuple[EffectWorth, ...] = ()


def _worth_tables(found: SceneTrials) -> dict[str, list[dict[str, Any]]]:
    from reconstruction.tradeoff.scene_downstream import worth_rows

    return {"reflections": worth_rows(found.worths)} if found.worths else {}


SCENES: Subject[SceneTrials] = Subject(
    "scene",
    ERROR_AXIS,
    rows=lambda found: scene_rows(found.truth, found.trials),
    title=lambda found: found.title,
    panels=lambda found: [scene_panel("error against time for one photo", found.trials, found.truth)],
    more=_worth_tables,
)


def scene_tradeoff(
    wish: SceneRequest,
    variants: SceneVariants,
    truth_rays: int | None,
    out: Path,
    monitor: Monitor = QUIET,
    *,
    n_reflection_views: int = 0,
    config: ReflectionConfig | None = None,
) -> Compared[SceneTrials]:
    """Turn the knobs of rendering one at a time; write `tradeoff-scene.csv` and `.png` into `out`.

    Photos are a plan's, or such as a first flight takes before each facade, where panels can be looked for.

    Parameters
    ----------
    truth_rays
        A pixel of the physically based truth; None: the embedded renderer with many rays is the truth.
    n_reflection_views
        Photos of `REFLECTIONS_WIDTH_PX` that reflections are learned from, with everything and without each effect;
        0 leaves that out.
    config
        How they are learned; the defaults where it is None.

    Raises
    ------
    InputError
        A file cannot be read, Mitsuba is asked for and not installed, or the folder cannot be written into.
    """
    make = _physically_based() if truth_rays is not None or variants.rays else None

    def run(folder: Path) -> SceneTrials:
        scene, _ = given_scene(wish)
        photos = _photos(wish, scene, folder)
        lens = photos[0].intrinsics
        decisions = tuple(decide_effects(scene, photos, wish.settings).values())
        judge = None if make is None or truth_rays is None else (make, truth_rays)
        truth = make_truth(scene, photos, judge, monitor)
        settings = scene_settings(wish.settings, decisions, variants, lens.width_px)
        trials = run_scene_variants(scene, photos, truth, settings, make, monitor)
        title = f"{scene.name}: {len(photos)} photos of {lens.width_px} x {lens.height_px} px\nagainst {truth.name}"
        worths: tuple[EffectWorth, ...] = ()
        if n_reflection_views:
            worths = _worths(replace(wish, n_views=n_reflection_views), scene, variants.effects, config, monitor)
        return SceneTrials(title, trials, decisions, truth, worths)

    return compare(SCENES, out, run)


def _worths(
    wish: SceneRequest, scene: Scene, effects: Sequence[str], config: ReflectionConfig | None, monitor: Monitor
) -> tuple[EffectWorth, ...]:
    from reconstruction.tradeoff.scene_downstream import effects_worth

    with tempfile.TemporaryDirectory(prefix="reflight-") as place:
        folder = Path(place)
        photos = planned_photos(replace(wish, width_px=REFLECTIONS_WIDTH_PX), scene, folder, monitor)
        decisions = tuple(decide_effects(scene, photos, wish.settings).values())
        return effects_worth(scene, photos, decisions, effects, folder, config=config, monitor=monitor)


def _physically_based() -> MakeRenderer:
    from reconstruction.scenes.mitsuba.plugins import mitsuba
    from reconstruction.scenes.mitsuba.renderer import MitsubaRenderer

    try:
        mitsuba()
    except InputError as error:
        raise InputError(
            say("{}; or let the embedded renderer be the truth (--truth-rays 0, no --rays)", error)
        ) from error
    return MitsubaRenderer


def _photos(wish: SceneRequest, scene: Scene, folder: Path) -> tuple[PosedPhoto, ...]:
    if wish.plan is None:
        lens = lens_of(profile(wish.profile_id).camera, wish.width_px)
        return square_photos(scene, lens, wish.n_views or DEFAULT_VIEWS, folder, wish.seed)
    plan = plan_of_site(wish.plan, scene.site)
    photos = posed_photos(planned_shots(plan), lens_of(plan.camera, wish.width_px), folder)
    # Spread over the plan: all of it would take as long as rendering it a dozen times.
    step = max(1, len(photos) // (wish.n_views or DEFAULT_VIEWS))
    return photos[::step][: wish.n_views or DEFAULT_VIEWS]
