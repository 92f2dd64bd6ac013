"""What is to be photographed and from where: a site or bundled scene, and the views of a plan, a flight, or its own."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from groundstation.services.plan.planning import plan_document_site
from groundstation.services.plan.top_up import flown_plan
from groundstation.services.project.input_files import read_input_plan, read_input_site
from missions.flight.flight_file import Flight, read_flight
from missions.flight.matching import PhotoRef, pose_of_photo, shutter_velocities, taken_poses
from missions.flight.record import TakenPhoto
from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.json_file import plain_values
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.parameters import Constraints, GreedyParameters
from planning.plan import Camera, Plan, Viewpoint, plan_to_json, read_plan
from planning.request import PlanRequest
from planning.site.file import is_planned_on, site_bytes, site_sha256, site_with_files
from planning.site.records import SiteModel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.parameters import DEFAULT_VIEWS, SceneRequest
from reconstruction.scenes.photos.flight_views import (
    Shot,
    flown_shots,
    lens_of,
    planned_shots,
    posed_photos,
    square_shots,
)
from reconstruction.scenes.record import Scene
from reconstruction.scenes.runs.run_record import RUN_FILE
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.bundled import SCENES, bundled_scene
from reconstruction.scenes.world.ground import MirroredTerrain
from reconstruction.scenes.world.look import read_look

# Photos of a flight file: where they were taken and looked, and how the aircraft moved meanwhile.


def shots_of_flight(path: Path, plan: Plan | None, model: SiteModel) -> tuple[tuple[Shot, ...], tuple[Finding, ...]]:
    """Shots of a flight over a site, and what there is to say of photos that are left out.

    Parameters
    ----------
    plan
        That was flown: its angles count where the flight knows none.

    Raises
    ------
    InputError
        The file cannot be read, is of another site, or none of its photos says where the camera looked.
    """
    flight, site = read_flight(path), model.site
    if flight.site != site.name or flight.origin != site.origin:
        raise InputError(
            say(
                "this is a flight over '{}', and not over '{}' at its origin; name the site that was flown over",
                flight.site,
                site.name,
                place=path,
            )
        )
    poses = _poses(flight, plan, model)
    n_photos = sum(len(record.photos) for record in flight.sorties)
    if not poses:
        raise InputError(
            say(
                "none of its {} photos says where the camera looked; name the plan that was flown as well (--plan)",
                n_photos,
                place=path,
            )
        )
    sorties, motions = [], []
    for number, record in enumerate(flight.sorties):
        velocities = shutter_velocities(record)
        posed = [(ref, photo) for ref, photo in _photos_of(flight, number) if ref in poses]
        sorties.append([(poses[ref], photo.time_s) for ref, photo in posed])
        motions.append([(velocities[ref.photo], photo.exposure_s) for ref, photo in posed])
    findings = (_without_direction(n_photos - len(poses), n_photos),) if len(poses) < n_photos else ()
    return flown_shots(sorties, motions), findings


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
    text = say(
        "{} of {} photos do not say where the camera looked, and are left out; name the plan that was flown", n, n_all
    )
    return Finding(Severity.WARNING, "photo-direction", text, "", float(n), 0.0, "photos")


SITE_FILE, PLAN_FILE = "site.json", "plan.json"
"""Written beside the photos: the site with what the scene adds to it, and the plan that was made for them."""

BUNDLED_TEXTS = {
    "planar": say("plane facade of 20 x 8 panels, street, buildings opposite, trees and cars before it"),
    "curved": say("the same on a convex facade"),
    "planar-far": say("the plane facade alone, with everything else far away"),
    "curved-far": say("the convex facade alone, with everything else far away"),
    "court": say("two facades at a right angle, whose glass sees glass"),
    "concrete": say("matt concrete with punched windows"),
}

QUICK = GreedyParameters(n_candidates=2000, improve=False, certify=False)
"""Views for trying things out need not be the best; they are found in seconds."""

FARTHEST_M = 40.0
"""Of views that are planned here: a few of them would otherwise see all panels at once, from far away and small."""


@dataclass(frozen=True, slots=True)
class SceneViews:
    """Where photos are taken, by which camera, and where that is from; `companions` as in `PhotoJob`."""

    shots: tuple[Shot, ...]
    camera: Camera
    made_from: Mapping[str, Any]
    companions: Mapping[str, bytes]
    findings: tuple[Finding, ...] = ()


def scene_of_request(request: SceneRequest) -> tuple[Scene, dict[str, Any]]:
    """The scene, and what it is made from.

    Raises
    ------
    InputError
        A file cannot be read, or there is no such scene.
    """
    path = Path(request.scene)
    if request.scene in SCENES and not path.is_file():  # a folder of photos is easily named after its scene
        if request.look is not None:
            raise InputError(
                say(
                    "bundled scenes have a look of their own; name a site file to give one, or leave it out",
                    place=request.look,
                )
            )
        return bundled_scene(request.scene, request.seed), {"bundled": request.scene}
    if not path.exists():
        raise InputError(
            say(
                "there is neither a site file nor a bundled scene of that name; bundled are: {}",
                ", ".join(SCENES),
                place=request.scene,
            )
        )
    model = read_input_site(path)
    look = None if request.look is None else read_look(request.look)
    made_from = {"site": model.site.name, "look": None if look is None else plain_values(look)}
    terrain = request.settings.effects.get(MirroredTerrain.name, "auto")
    return build_scene(model, look, request.seed, terrain), made_from


def as_written(model: SiteModel) -> tuple[SiteModel, dict[str, bytes]]:
    """A scene's site as it is written beside the photos, and the content of its files."""
    site, files = site_with_files(model)
    sources = dict(zip(model.site.zones, site.zones, strict=True))
    zones = tuple(replace(each, source=sources.get(each.source, each.source)) for each in model.zones)
    return replace(model, site=site, zones=zones, sha256=site_sha256(site)), {SITE_FILE: site_bytes(site), **files}


def scene_views(request: SceneRequest, scene: Scene, written: SiteModel, folder: Path, monitor: Monitor) -> SceneViews:
    """The views asked for: a plan's, a flight's, square ones, or some that are planned here.

    Parameters
    ----------
    written
        The scene's site as it is written beside the photos, which views are planned over.
    folder
        For the photos; a plan that an interrupted run left in it is taken again.

    Raises
    ------
    InputError
        A plan or flight cannot be read, or belongs to another site.
    InfeasibleError
        Views were to be planned, and none is possible.
    """
    model = scene.site
    plan = None if request.plan is None else plan_of_site(request.plan, model)
    if request.flight is not None:
        return _flown(request, request.flight, plan, model)
    if plan is not None and request.plan is not None:
        is_current = is_planned_on(plan.site_sha256, model) or is_planned_on(plan.site_sha256, written)
        findings = () if is_current else (SITE_CHANGED,)
        return SceneViews(planned_shots(plan), plan.camera, {"plan": request.plan.name}, {}, findings)
    if request.n_square is not None:
        camera = profile(request.profile_id).camera
        shots = square_shots(scene, lens_of(camera), request.n_square, request.seed)
        return SceneViews(shots, camera, {"square": {"n_views": request.n_square, "profile": request.profile_id}}, {})
    plan_made_here = _planned_here(request, written, folder, monitor)
    options = {"n_views": request.n_views or DEFAULT_VIEWS, "profile": request.profile_id}
    content = json.dumps(plan_to_json(plan_made_here), indent=1, allow_nan=False).encode()
    return SceneViews(planned_shots(plan_made_here), plan_made_here.camera, {"views": options}, {PLAN_FILE: content})


SITE_CHANGED = Finding(
    Severity.WARNING,
    "site-changed",
    say("the site file has changed since the plan was made; photos show it as it is now"),
)


def plan_of_site(path: Path, model: SiteModel) -> Plan:
    """The plan in a file.

    Raises
    ------
    InputError
        It cannot be read, or belongs to another site.
    """
    plan, site = read_input_plan(path), model.site
    if plan.site != site.name or (plan.origin is not None and plan.origin != site.origin):
        raise InputError(
            say(
                "this is a plan of '{}', and not of '{}' at its origin; name the site that it was made for, or "
                "another plan",
                plan.site,
                site.name,
                place=path,
            )
        )
    return plan


def planned_photos(
    request: SceneRequest, scene: Scene, folder: Path, monitor: Monitor = QUIET
) -> tuple[PosedPhoto, ...]:
    """Photos from views that are planned here, around what the scene has beside the building, to lie in `folder`."""
    plan = _planned_here(request, as_written(scene.site)[0], folder, monitor)
    return posed_photos(planned_shots(plan), lens_of(plan.camera, request.width_px), folder)


def _planned_here(request: SceneRequest, model: SiteModel, folder: Path, monitor: Monitor) -> Plan:
    """The plan that the folder has already, or a quick new one."""
    if (folder / PLAN_FILE).is_file() and (folder / RUN_FILE).is_file():
        return read_plan(folder / PLAN_FILE)
    n_views = request.n_views or DEFAULT_VIEWS
    near = Constraints(max_distance_m=FARTHEST_M)
    to_plan = PlanRequest(
        n_views=n_views, profile_id=request.profile_id, constraints=near, greedy=QUICK, seed=request.seed
    )
    return plan_document_site(model, to_plan, monitor=monitor).plan


def _flown(request: SceneRequest, flight: Path, plan: Plan | None, model: SiteModel) -> SceneViews:
    shots, findings = shots_of_flight(flight, plan, model)
    camera = profile(request.profile_id).camera if plan is None else plan.camera
    made_from = {"flight": flight.name, "plan": None if request.plan is None else request.plan.name}
    return SceneViews(shots, camera, made_from, {}, findings)
