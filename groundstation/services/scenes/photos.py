"""Use case of trying things out: photos of a site or a bundled scene, rendered from where a flight takes them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.scenes.views import SITE_FILE, SceneRequest, as_written, given_scene, scene_views
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.json_file import plain_values
from planning.base.messages import about, say
from planning.base.parallel_map import cluster_client
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.plan import Camera
from planning.site.records import SiteModel
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.scenes.mitsuba.plugins import mitsuba
from reconstruction.scenes.photos.camera_model import USUAL_TAKING, Taking, read_taking
from reconstruction.scenes.photos.flight_views import lens_of, moments, posed_photos
from reconstruction.scenes.runs.photo_folder import ScenePhotos, photograph
from reconstruction.scenes.runs.photo_job import PhotoJob
from reconstruction.scenes.runs.run_record import check_folder


@dataclass(frozen=True, slots=True)
class RenderedScene:
    """What was written, and what there is to say of what it was made from."""

    scene: str
    written: ScenePhotos
    findings: tuple[Finding, ...]
    seconds: float


def photograph_files(
    wish: SceneRequest,
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
        wished for and not installed, or as `photograph` says.
    InfeasibleError
        Views were to be planned, and none is possible.
    """
    n_given = sum(given is not None for given in (wish.n_views, wish.n_square))
    if n_given and (wish.plan is not None or wish.flight is not None):
        raise InputError("a number of views is for scenes without a plan or flight; leave it out, or them")
    if n_given > 1:
        raise InputError("views are planned or square to the facades; give one number, not both")
    check_folder(folder)
    if wish.settings.mitsuba_rays is not None:
        mitsuba()
    with nullcontext() if address is None else cluster_client(address) as cluster:
        return _photographed(wish, folder, n_processes, monitor, cluster)


def _photographed(
    wish: SceneRequest, folder: Path, n_processes: int | None, monitor: Monitor, cluster: Any
) -> RenderedScene:
    started_s = time.perf_counter()
    monitor.report(say("building the scene"), 0, 1)
    taking = USUAL_TAKING if wish.camera is None else read_taking(wish.camera)
    scene, made_from = given_scene(wish)
    written_site, companions = as_written(scene.site)
    views = scene_views(wish, scene, written_site, folder, monitor)
    lens = _lens(wish, views.camera, taking)
    photos = posed_photos(views.shots, lens, folder / "images")
    findings = (*views.findings, *_walled_in(photos, scene.site))
    job = PhotoJob(
        scene,
        photos,
        wish.settings,
        {**made_from, **views.made_from},
        {**companions, **views.companions},
        wish.n_points,
        taking,
        moments(views.shots, taking),
    )
    written = photograph(job, folder, n_processes, monitor, cluster=cluster)
    return RenderedScene(scene.name, written, findings, time.perf_counter() - started_s)


def _lens(wish: SceneRequest, camera: Camera, taking: Taking) -> Intrinsics:
    try:
        return lens_of(camera, wish.width_px, taking)
    except InputError as error:
        raise InputError(about(wish.camera, error)) from error


def _walled_in(photos: Sequence[PosedPhoto], model: SiteModel) -> Iterator[Finding]:
    """A warning where cameras stand in what the scene has beside the building, which the plan may not have known."""
    solids = Solids.of(join(list(model.obstacles)).corners_enu_m)
    clearances_m = solids.clearance_m(np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3))
    n = int((clearances_m < 0.0).sum())
    if n:
        text = (
            f"{n} of {len(photos)} views stand inside buildings opposite or trees, which the scene adds to the site; "
            f"plan over the {SITE_FILE} beside the photos, which has them, or give the site a look with a wider street"
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
