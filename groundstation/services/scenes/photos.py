"""Use cases of trying things out: rendered photos of a site or scene, and which settings are worth their time."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from groundstation.services.scenes.views import (
    PLAN_FILE,
    SITE_FILE,
    as_written,
    plan_of_site,
    planned_photos,
    scene_of_request,
    scene_views,
)
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.json_file import plain_values
from planning.base.messages import about, joined, say
from planning.base.parallel_map import cluster_client
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.plan import Camera, Plan, write_plan
from planning.site.records import SiteModel
from planning.tradeoff.runner import ComparisonFiles, Subject, compare
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.mitsuba.plugins import mitsuba
from reconstruction.scenes.parameters import SceneRequest
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel, read_camera_model
from reconstruction.scenes.photos.flight_views import lens_of, moments, planned_shots, posed_photos, square_photos
from reconstruction.scenes.record import Scene
from reconstruction.scenes.runs.photo_folder import ScenePhotos, render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob
from reconstruction.scenes.runs.run_record import check_folder
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


# Use case of asking which rays, sizes, renderers and effects of simulated photos are worth their time.

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
    request: SceneRequest,
    variants: SceneVariants,
    truth_rays: int | None,
    out: Path,
    monitor: Monitor = QUIET,
    *,
    n_reflection_views: int = 0,
    config: ReflectionConfig | None = None,
) -> ComparisonFiles[SceneTrials]:
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
        scene, _ = scene_of_request(request)
        photos = _photos(request, scene, folder)
        lens = photos[0].intrinsics
        decisions = tuple(decide_effects(scene, photos, request.settings).values())
        judge = None if make is None or truth_rays is None else (make, truth_rays)
        truth = make_truth(scene, photos, judge, monitor)
        settings = scene_settings(request.settings, decisions, variants, lens.width_px)
        trials = run_scene_variants(scene, photos, truth, settings, make, monitor)
        size = say("{} photos of {} x {} px", len(photos), lens.width_px, lens.height_px, place=scene.name)
        title = joined("\n", (size, say("compared with the reference: {}", truth.name)))
        worths: tuple[EffectWorth, ...] = ()
        if n_reflection_views:
            worths = _worths(replace(request, n_views=n_reflection_views), scene, variants.effects, config, monitor)
        return SceneTrials(title, trials, decisions, truth, worths)

    return compare(SCENES, out, run)


def _worths(
    request: SceneRequest, scene: Scene, effects: Sequence[str], config: ReflectionConfig | None, monitor: Monitor
) -> tuple[EffectWorth, ...]:
    from reconstruction.tradeoff.scene_downstream import effects_worth

    with tempfile.TemporaryDirectory(prefix="reflight-") as place:
        folder = Path(place)
        photos = planned_photos(replace(request, width_px=REFLECTIONS_WIDTH_PX), scene, folder, monitor)
        decisions = tuple(decide_effects(scene, photos, request.settings).values())
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


def _photos(request: SceneRequest, scene: Scene, folder: Path) -> tuple[PosedPhoto, ...]:
    if request.plan is None:
        lens = lens_of(profile(request.profile_id).camera, request.width_px)
        return square_photos(scene, lens, request.n_views or DEFAULT_VIEWS, folder, request.seed)
    plan = plan_of_site(request.plan, scene.site)
    photos = posed_photos(planned_shots(plan), lens_of(plan.camera, request.width_px), folder)
    # Spread over the plan: all of it would take as long as rendering it a dozen times.
    step = max(1, len(photos) // (request.n_views or DEFAULT_VIEWS))
    return photos[::step][: request.n_views or DEFAULT_VIEWS]


@dataclass(frozen=True, slots=True)
class RenderedScene:
    """What was written, and what there is to say of what it was made from."""

    scene: str
    written: ScenePhotos
    findings: tuple[Finding, ...]
    seconds: float


def render_photos(
    request: SceneRequest,
    folder: Path,
    n_processes: int | None = None,
    monitor: Monitor = QUIET,
    *,
    address: str | None = None,
) -> RenderedScene:
    """Render the photos of a plan or flight over a site or a bundled scene into a folder.

    Parameters
    ----------
    address
        Scheduler of a Dask cluster that renders in place of processes, such as `tcp://10.0.0.5:8786`.

    Raises
    ------
    InputError
        A file cannot be read or belongs to another site, there is no such scene, no cluster answers, Mitsuba is
        asked for and not installed, or as `render_photo_folder` says.
    InfeasibleError
        Views were to be planned, and none is possible.
    """
    n_given = sum(given is not None for given in (request.n_views, request.n_square))
    if n_given and (request.plan is not None or request.flight is not None):
        raise InputError(say("a number of views is for scenes without a plan or flight; leave it out, or them"))
    if n_given > 1:
        raise InputError(say("views are planned or square to the facades; give one number, not both"))
    check_folder(folder)
    if request.settings.mitsuba_rays is not None:
        mitsuba()
    with nullcontext() if address is None else cluster_client(address) as cluster:
        return _photographed(request, folder, n_processes, monitor, cluster)


def render_flight(
    model: SiteModel,
    plan: Plan,
    flight: Path,
    folder: Path,
    width_px: int | None,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> RenderedScene:
    """Render the photos that a flight took over a site, of a plan that needs no file.

    Parameters
    ----------
    folder
        For the photos: new, or with those that a run left that was cancelled.
    width_px
        Of the photos; None for that of the camera.

    Raises
    ------
    InputError
        As `render_photos`.
    """
    with tempfile.TemporaryDirectory() as made:
        for name, written in as_written(model)[1].items():
            Path(made, name).write_bytes(written)
        write_plan(Path(made, PLAN_FILE), plan)
        request = SceneRequest(str(Path(made, SITE_FILE)), Path(made, PLAN_FILE), flight, width_px=width_px)
        return render_photos(request, folder, monitor=monitor)


def _photographed(
    request: SceneRequest, folder: Path, n_processes: int | None, monitor: Monitor, cluster: Any
) -> RenderedScene:
    started_s = time.perf_counter()
    monitor.report(say("building the scene"), 0, 1)
    camera_model = USUAL_CAMERA_MODEL if request.camera is None else read_camera_model(request.camera)
    scene, made_from = scene_of_request(request)
    written_site, companions = as_written(scene.site)
    views = scene_views(request, scene, written_site, folder, monitor)
    if request.plan is not None:
        camera_model = with_plans_lens(camera_model, plan_of_site(request.plan, scene.site))
    lens = _lens(request, views.camera, camera_model)
    photos = posed_photos(views.shots, lens, folder / "images")
    findings = (*views.findings, *_walled_in(photos, scene.site))
    job = PhotoJob(
        scene,
        photos,
        request.settings,
        {**made_from, **views.made_from},
        {**companions, **views.companions},
        request.n_points,
        camera_model,
        moments(views.shots, camera_model),
    )
    written = render_photo_folder(job, folder, n_processes, monitor, cluster=cluster)
    return RenderedScene(scene.name, written, findings, time.perf_counter() - started_s)


def with_plans_lens(camera_model: CameraModel, plan: Plan) -> CameraModel:
    """A camera model with the aperture and focus of a plan that states one, where it states none itself.

    An automatic focus lies at the plan's least distance, where panes are.
    """
    settings = plan.camera_settings
    if camera_model.pupil_mm is not None or settings.aperture is None:
        return camera_model
    pupil_mm = plan.camera.focal_length_mm / settings.aperture
    focus_m = camera_model.focus_m
    if focus_m is None and settings.focus != "infinity":
        focus_m = settings.focus_distance_m or plan.constraints.min_distance_m
    return replace(camera_model, pupil_mm=pupil_mm, focus_m=focus_m)


def _lens(request: SceneRequest, camera: Camera, camera_model: CameraModel) -> Intrinsics:
    try:
        return lens_of(camera, request.width_px, camera_model)
    except InputError as error:
        raise InputError(about(request.camera, error)) from error


def _walled_in(photos: Sequence[PosedPhoto], model: SiteModel) -> Iterator[Finding]:
    """A warning where cameras stand in what the scene has beside the building, which the plan may not have known."""
    solids = Solids.of(join(list(model.obstacles)).corners_enu_m)
    clearances_m = solids.clearance_m(np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3))
    n = int((clearances_m < 0.0).sum())
    if n:
        text = say(
            "{} of {} views stand inside buildings opposite or trees, which the scene adds to the site; plan over the "
            "{} beside the photos, which has them, or give the site a look with a wider street",
            n,
            len(photos),
            SITE_FILE,
        )
        yield Finding(Severity.WARNING, "views-walled-in", text, "", float(n), 0.0, "photos")


def rendered_summary(rendered: RenderedScene) -> dict[str, Any]:
    """For `--json`."""
    written = rendered.written
    return {
        "folder": str(written.folder),
        "scene": rendered.scene,
        "photos": len(written.photos),
        "kept": written.n_kept,
        "effects": plain_values(written.decisions),
        "findings": plain_values(rendered.findings),
        "seconds": round(rendered.seconds, 3),
    }
