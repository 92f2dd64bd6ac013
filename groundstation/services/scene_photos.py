"""Use case of trying things out: photos of a site or a bundled scene, rendered from where a flight takes them."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from groundstation.services.given_files import read_given_plan, read_given_site
from groundstation.services.planning import plan_document_site
from groundstation.services.top_up import flown_plan
from missions.flight.flight_file import Flight, read_flight
from missions.flight.matching import PhotoRef
from missions.flight.poses import pose_of_photo, taken_poses
from missions.flight.record import TakenPhoto
from planning.catalogue import profile
from planning.errors import InputError
from planning.findings import Finding, Severity
from planning.geometry.solids import Solids
from planning.mesh import join, ply_bytes
from planning.plan import Camera, Constraints, Plan, Viewpoint
from planning.plan_file import plan_to_json, read_plan
from planning.progress import QUIET, Monitor
from planning.request import GreedyParameters, PlanRequest
from planning.site import SiteModel
from planning.site_file import is_planned_on, site_bytes, site_sha256
from reconstruction.cameras import PosedPhoto
from reconstruction.scenes.build import build_scene
from reconstruction.scenes.bundled import SCENES, bundled_scene
from reconstruction.scenes.flight_views import WIDTHS_PX, Shot, flown_shots, lens_of, planned_shots, posed_photos
from reconstruction.scenes.look import read_look
from reconstruction.scenes.photo_folder import ScenePhotos, photograph
from reconstruction.scenes.photographers import DEFAULT_POINTS, PhotoJob
from reconstruction.scenes.record import Scene
from reconstruction.scenes.renderer import RenderSettings
from reconstruction.scenes.run_record import RUN_FILE

SITE_FILE, PLAN_FILE = "site.json", "plan.json"
"""Written beside the photos: the site with what the scene adds to it, and the plan that was made for them."""

DEFAULT_VIEWS, MAX_VIEWS = 24, 20_000
DEFAULT_WIDTH_PX = 1024
DEFAULT_PROFILE = "m3e"

BUNDLED_TEXTS = {
    "planar": "plane facade of 20 x 8 panels, street, buildings opposite, trees and cars before it",
    "curved": "the same on a convex facade",
    "planar-far": "the plane facade alone, with everything else far away",
    "curved-far": "the convex facade alone, with everything else far away",
    "court": "two facades at a right angle, whose glass sees glass",
    "concrete": "matt concrete with punched windows",
}

QUICK = GreedyParameters(n_candidates=2000, improve=False, certify=False)
"""Views for trying things out need not be the best; they are found in seconds."""

FARTHEST_M = 40.0
"""Of views that are planned here: a few of them would otherwise see all panels at once, from far away and small."""


@dataclass(frozen=True, slots=True)
class SceneWish:
    """What is to be photographed, from where, and how.

    Parameters
    ----------
    scene
        Name of a bundled scene where there is no file of that name; else path of a site file.
    plan, flight
        Views of a plan; or the poses of a flight, with the plan's camera, and with its angles where the flight knows
        none.
    n_views
        To be planned where neither is given.
    profile_id
        Whose camera takes photos that no plan says the camera of.
    look
        File with the look of a site's scene.
    """

    scene: str
    plan: Path | None = None
    flight: Path | None = None
    n_views: int | None = None
    profile_id: str = DEFAULT_PROFILE
    look: Path | None = None
    seed: int = 0
    width_px: int | None = DEFAULT_WIDTH_PX
    n_points: int = DEFAULT_POINTS
    settings: RenderSettings = field(default_factory=RenderSettings)

    def __post_init__(self) -> None:
        if self.n_views is not None and not 1 <= self.n_views <= MAX_VIEWS:
            raise ValueError(f"views: expected 1 to {MAX_VIEWS}, got {self.n_views}")
        if self.width_px is not None and not WIDTHS_PX[0] <= self.width_px <= WIDTHS_PX[1]:
            raise ValueError(f"width_px: expected {WIDTHS_PX[0]} to {WIDTHS_PX[1]}, got {self.width_px}")
        if self.n_points < 0:
            raise ValueError(f"n_points: expected 0 or more, got {self.n_points}")


@dataclass(frozen=True, slots=True)
class RenderedScene:
    """What was written, and what there is to say of what it was made from."""

    scene: str
    written: ScenePhotos
    findings: tuple[Finding, ...]
    seconds: float


@dataclass(frozen=True, slots=True)
class _Views:
    """Where photos are taken, by which camera, and where that is from; `companions` as in `PhotoJob`."""

    shots: tuple[Shot, ...]
    camera: Camera
    made_from: Mapping[str, Any]
    companions: Mapping[str, bytes]
    findings: tuple[Finding, ...] = ()


def photograph_files(
    wish: SceneWish, folder: Path, n_processes: int | None = None, monitor: Monitor = QUIET
) -> RenderedScene:
    """Render the photos of a plan or flight over a site or a bundled scene into a folder.

    Raises
    ------
    InputError
        A file cannot be read or belongs to another site, there is no such scene, or as `photograph` says.
    InfeasibleError
        Views were to be planned, and none is possible.
    """
    started_s = time.perf_counter()
    if wish.n_views is not None and (wish.plan is not None or wish.flight is not None):
        raise InputError("a number of views is for scenes without a plan or flight; leave it out, or them")
    monitor.report("building the scene", 0, 1)
    scene, made_from = _given_scene(wish)
    written_site, companions = _as_written(scene.site)
    views = _views(wish, scene.site, written_site, folder, monitor)
    photos = posed_photos(views.shots, lens_of(views.camera, wish.width_px), folder / "images")
    findings = (*views.findings, *_walled_in(photos, scene.site))
    job = PhotoJob(
        scene,
        photos,
        wish.settings,
        {**made_from, **views.made_from},
        {**companions, **views.companions},
        wish.n_points,
    )
    written = photograph(job, folder, n_processes, monitor)
    return RenderedScene(scene.name, written, findings, time.perf_counter() - started_s)


def _given_scene(wish: SceneWish) -> tuple[Scene, dict[str, Any]]:
    """The scene, and what it is made from."""
    path = Path(wish.scene)
    if wish.scene in SCENES and not path.is_file():  # a folder of photos is easily named after its scene
        if wish.look is not None:
            raise InputError(
                f"{wish.look}: bundled scenes have a look of their own; name a site file to give one, or leave it out"
            )
        return bundled_scene(wish.scene, wish.seed), {"bundled": wish.scene}
    if not path.exists():
        raise InputError(
            f"{wish.scene}: there is neither a site file nor a bundled scene of that name; bundled are: "
            f"{', '.join(SCENES)}"
        )
    model = read_given_site(path)
    look = None if wish.look is None else read_look(wish.look)
    made_from = {"site": model.site.name, "look": None if look is None else msgspec.to_builtins(look)}
    return build_scene(model, look, wish.seed), made_from


def _as_written(model: SiteModel) -> tuple[SiteModel, dict[str, bytes]]:
    """A scene's site as it is written beside the photos, and the content of its files."""
    site, files = model.site, {}
    if site.building_mesh is not None:
        site = replace(site, building_mesh="building.ply")
        files["building.ply"] = ply_bytes(model.building)
    obstacles = []
    for number, (obstacle, mesh) in enumerate(zip(site.obstacles, model.obstacles, strict=True), 1):
        if obstacle.mesh is not None:
            obstacle = replace(obstacle, mesh=f"obstacle-{number}.ply")
            files[f"obstacle-{number}.ply"] = ply_bytes(mesh)
        obstacles.append(obstacle)
    site = replace(site, obstacles=tuple(obstacles))
    return replace(model, site=site, sha256=site_sha256(site)), {SITE_FILE: site_bytes(site), **files}


def _views(wish: SceneWish, model: SiteModel, written: SiteModel, folder: Path, monitor: Monitor) -> _Views:
    plan = None if wish.plan is None else _given_plan(wish.plan, model)
    if wish.flight is not None:
        return _flown(wish, plan, model)
    if plan is not None and wish.plan is not None:
        is_current = is_planned_on(plan.site_sha256, model) or is_planned_on(plan.site_sha256, written)
        findings = () if is_current else (SITE_CHANGED,)
        return _Views(planned_shots(plan), plan.camera, {"plan": wish.plan.name}, {}, findings)
    made = _planned_here(wish, written, folder, monitor)
    request = {"n_views": wish.n_views or DEFAULT_VIEWS, "profile": wish.profile_id}
    content = json.dumps(plan_to_json(made), indent=1, allow_nan=False).encode()
    return _Views(planned_shots(made), made.camera, {"views": request}, {PLAN_FILE: content})


SITE_CHANGED = Finding(
    Severity.WARNING, "site-changed", "the site file has changed since the plan was made; photos show it as it is now"
)


def _given_plan(path: Path, model: SiteModel) -> Plan:
    plan, site = read_given_plan(path), model.site
    if plan.site != site.name or (plan.origin is not None and plan.origin != site.origin):
        raise InputError(
            f"{path}: this is a plan of '{plan.site}', and not of '{site.name}' at its origin; name the site that it "
            "was made for, or another plan"
        )
    return plan


def _planned_here(wish: SceneWish, model: SiteModel, folder: Path, monitor: Monitor) -> Plan:
    """The plan that the folder has already, or a quick new one."""
    if (folder / PLAN_FILE).is_file() and (folder / RUN_FILE).is_file():
        return read_plan(folder / PLAN_FILE)
    n_views = wish.n_views or DEFAULT_VIEWS
    near = Constraints(max_distance_m=FARTHEST_M)
    request = PlanRequest(n_views=n_views, profile_id=wish.profile_id, constraints=near, greedy=QUICK, seed=wish.seed)
    return plan_document_site(model, request, monitor=monitor).plan


def _flown(wish: SceneWish, plan: Plan | None, model: SiteModel) -> _Views:
    assert wish.flight is not None
    flight, site = read_flight(wish.flight), model.site
    if flight.site != site.name or flight.origin != site.origin:
        raise InputError(
            f"{wish.flight}: this is a flight over '{flight.site}', and not over '{site.name}' at its origin; name the "
            "site that was flown over"
        )
    poses = _poses(flight, plan, model)
    n_photos = sum(len(record.photos) for record in flight.sorties)
    if not poses:
        raise InputError(
            f"{wish.flight}: none of its {n_photos} photos says where the camera looked; name the plan that was flown "
            "as well (--plan)"
        )
    sorties = [
        [(poses[ref], photo.time_s) for ref, photo in _photos_of(flight, number) if ref in poses]
        for number in range(len(flight.sorties))
    ]
    camera = profile(wish.profile_id).camera if plan is None else plan.camera
    findings = (_without_direction(n_photos - len(poses), n_photos),) if len(poses) < n_photos else ()
    made_from = {"flight": wish.flight.name, "plan": None if wish.plan is None else wish.plan.name}
    return _Views(flown_shots(sorties), camera, made_from, {}, findings)


def _poses(flight: Flight, plan: Plan | None, model: SiteModel) -> dict[PhotoRef, Viewpoint]:
    """Poses of all photos whose direction is known."""
    if plan is not None:
        return taken_poses(plan, flight.sorties, flown_plan(flight, plan, model).matching)
    refs = (pair for number in range(len(flight.sorties)) for pair in _photos_of(flight, number))
    poses = ((ref, pose_of_photo(photo, None)) for ref, photo in refs)
    return {ref: pose for ref, pose in poses if pose is not None}


def _photos_of(flight: Flight, record: int) -> Iterator[tuple[PhotoRef, TakenPhoto]]:
    return ((PhotoRef(record, number), photo) for number, photo in enumerate(flight.sorties[record].photos))


def _without_direction(n: int, n_all: int) -> Finding:
    text = f"{n} of {n_all} photos do not say where the camera looked, and are left out; name the plan that was flown"
    return Finding(Severity.WARNING, "photo-direction", text, "", float(n), 0.0, "photos")


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
        "effects": msgspec.to_builtins(written.decisions),
        "findings": msgspec.to_builtins(rendered.findings),
        "seconds": round(rendered.seconds, 3),
    }
