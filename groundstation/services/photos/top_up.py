"""Use case between two batteries: what the photos of the last flight lack, and the sorties that bring most of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from groundstation.services.photos.poses import RefineRequest, photos_with_poses
from groundstation.services.plan.planning import finding_summary, planned_summary
from groundstation.services.project.input_files import read_input_plan, read_input_site
from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.json_file import check_output
from planning.base.messages import say
from planning.base.parameters import check, like, parameter
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.geo.frames import Vec3
from planning.parameters import GreedyParameters, PlanParameters
from planning.photos.places import PhotoHeights
from planning.plan import Plan, ViewpointArrays, write_plan
from planning.planner import Planned, plan_flight
from planning.request import PlanRequest
from planning.revision.seen_bodies import SeenBody, bodies_not_in, with_bodies
from planning.revision.top_up import METHOD
from planning.site.records import SiteModel, require_panels
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.prepare import DATA_SET
from reconstruction.light.photo_set import PhotoSet, read_photo_set

if TYPE_CHECKING:
    from reconstruction.light.quick_look import QuickLook


@dataclass(frozen=True, slots=True)
class PhotoTopUpRequest:
    """What a top-up from photos may take.

    Parameters
    ----------
    battery
        Charge of the battery on board, 0 to 1, that flies the one sortie; None: it has been changed.
    n_batteries
        Full batteries otherwise.
    learn_s
        Wall time for learning from the photos.
    time_budget_s
        Wall time for the plan, after that.
    """

    battery: float | None = parameter(None, least=0.0, most=1.0, expected="a charge from 0 to 1")
    n_batteries: int = like(PlanParameters, "n_batteries", 1)
    seed: int = like(PlanParameters, "seed", 0)
    learn_s: float = parameter(40.0, above=0.0, option="--learn")
    time_budget_s: float = like(PlanParameters, "time_budget_s", 60.0)

    def __post_init__(self) -> None:
        check(self)
        if self.battery is not None and self.n_batteries != 1:
            raise InputError(
                say("the battery on board flies one sortie; ask for it, or for full ones", place="--batteries")
            )


@dataclass(frozen=True, slots=True, eq=False)
class PhotoTopUp:
    """A top-up from photos.

    Parameters
    ----------
    planned
        The sorties, clear of `bodies`, too.
    look
        What the photos told.
    bodies
        That the panes mirror and the site lacks.
    """

    planned: Planned
    look: QuickLook
    bodies: tuple[SeenBody, ...]
    findings: tuple[Finding, ...]


def photo_top_up(
    source: PhotoSet,
    flown: Plan,
    site_model: SiteModel,
    request: PhotoTopUpRequest = PhotoTopUpRequest(),
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> PhotoTopUp:
    """Learn from photos, and plan what adds most to them.

    Bodies that the panes mirror and the site lacks are kept clear of like obstacles.

    Parameters
    ----------
    flown
        The plan flown last: its aircraft, camera, constraints and rules hold for the top-up.

    Raises
    ------
    InputError
        The photos cannot be used, or the plan's aircraft is not known.
    InfeasibleError
        Nothing can be seen within the battery.
    ReconstructionError
        Learning came to nothing.
    OperationCancelled
        From `monitor`.
    """
    from reconstruction.light.quick_look import quick_look  # loads torch

    photos = poses_of(source.photos)
    look = quick_look(source, request.learn_s, request.seed, monitor)
    clear_m = flown.constraints.min_distance_m
    bodies = bodies_not_in(site_model, look.places, photos.positions_enu_m, clear_m)
    rules = flown.rules
    if request.battery is not None:
        # Landing with the reserve on a battery that is not full: as if the full one had to keep what is missing, too.
        rules = replace(rules, battery_reserve=min(0.99, rules.battery_reserve + 1.0 - request.battery))
    wanted = PlanRequest(
        n_batteries=request.n_batteries,
        profile_id=flown.profile,
        constraints=flown.constraints,
        rules=rules,
        camera=flown.camera_settings,
        greedy=GreedyParameters(objective="image-error"),
        seed=request.seed,
        time_budget_s=request.time_budget_s,
    )
    known = profile(flown.profile)
    if (known.aircraft, known.camera) != (flown.aircraft, flown.camera):
        raise InputError(
            say("the plan's aircraft is not the one of its profile '{}' now; plan the first flight again", known.id)
        )
    seen_site = with_bodies(site_model, bodies)
    planned = plan_flight(seen_site, wanted, photos=photos, stop=stop, trace=trace, monitor=monitor)
    planned = replace(planned, plan=replace(planned.plan, rules=flown.rules, method=METHOD))
    findings = (*planned.findings, *(lacking(body, site_model.site.home_enu_m) for body in bodies))
    return PhotoTopUp(planned, look, tuple(bodies), findings)


def poses_of(photos: tuple[PosedPhoto, ...]) -> ViewpointArrays:
    """Poses of photos as those of views; a camera's roll shows other corners, and no other middle."""
    poses = [photo.pose for photo in photos]
    return ViewpointArrays(
        np.array([pose.position_enu_m for pose in poses], np.float64).reshape(-1, 3),
        np.radians([pose.heading_deg for pose in poses]),
        np.radians([pose.pitch_deg for pose in poses]),
    )


def lacking(body: SeenBody, home_enu_m: Vec3) -> Finding:
    """That the site lacks a body, and where it is from where the pilot stands."""
    east_m, north_m = (body.low_enu_m + 0.5 * body.size_m - np.array(home_enu_m))[:2]
    text = say(
        "the panes mirror something that the site lacks: {:.0f} x {:.0f} m, {:.0f} m high, {:.0f} m from home at "
        "bearing {:03.0f}; the flight keeps clear of what is seen of it, but look before you fly, and enter it into "
        "the site",
        *body.size_m,
        math.hypot(east_m, north_m),
        math.degrees(math.atan2(east_m, north_m)) % 360.0,
    )
    return Finding(Severity.WARNING, "site-lacks", text, "", float(body.size_m.max()), 0.0, "m")


def photo_top_up_in_process(
    photos: tuple[PosedPhoto, ...],
    folder: Path,
    flown: Plan,
    site_model: SiteModel,
    request: PhotoTopUpRequest,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[Plan, float, tuple[Finding, ...]]:
    """The plan of `photo_top_up` of photos from a card, what is expected before it, and its findings.

    For a process of its own: learning would keep a window waiting.
    """
    from reconstruction.light.quick_look import CardPhotos  # loads torch

    source = CardPhotos.of(photos, site_model, folder)
    found = photo_top_up(source, flown, site_model, request, stop=stop, trace=trace, monitor=monitor)
    return found.planned.plan, found.planned.before_db or 0.0, found.findings


def photo_top_up_files(
    photos: Path,
    plan_path: Path,
    site_path: Path,
    out: Path,
    request: PhotoTopUpRequest,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> PhotoTopUp:
    """`photo_top_up` of a folder from the camera's card, or of a data set; the plan is written where `out` says.

    Raises
    ------
    InputError, InfeasibleError, ReconstructionError
        A file cannot be read or written, or as `photo_top_up`.
    """
    from reconstruction.light.quick_look import CardPhotos  # loads torch

    check_output(out, [plan_path, site_path])
    flown, site_model = read_input_plan(plan_path), read_input_site(site_path)
    require_panels(site_model.site)
    findings: tuple[Finding, ...] = ()
    if (photos / DATA_SET).is_file():
        source = read_photo_set(photos)
    else:
        posed = photos_with_poses(
            photos, site_model.site, heights=heights, colmap=colmap, refine=refine, monitor=monitor
        )
        findings = posed.findings
        if not posed.photos:
            raise InputError(say("none of the photos says where it was taken; name their COLMAP model", place=photos))
        source = CardPhotos.of(posed.photos, site_model, photos)
    found = photo_top_up(source, flown, site_model, request, stop=stop, trace=trace, monitor=monitor)
    write_plan(out, found.planned.plan)
    return replace(found, findings=(*findings, *found.findings))


def photo_top_up_summary(found: PhotoTopUp, seconds: float) -> dict[str, Any]:
    """What `topup --photos --json` prints: what `plan --json` does, and what the photos told."""
    return {
        **planned_summary(found.planned, seconds),
        "photos": found.look.n_photos,
        "left_out_psnr_db": round(found.look.psnr_db, 2),
        "expected_before_db": found.planned.before_db,
        "bodies": [{"low_enu_m": body.low_enu_m.tolist(), "size_m": body.size_m.tolist()} for body in found.bodies],
        "findings": [finding_summary(finding) for finding in found.findings],
    }
