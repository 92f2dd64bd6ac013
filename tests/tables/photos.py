"""Photos that the tables' models learn from and are scored on: plans, flown in simulation, rendered where they led."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from groundstation.services.fly.flying import FlightRequest, fly_files
from groundstation.services.plan.planning import plan_site
from groundstation.services.scenes.photos import render_photos
from groundstation.services.scenes.views import SITE_FILE
from groundstation.services.scenes.views import as_written as site_as_written
from planning.parameters import Constraints, GreedyParameters
from planning.plan import Plan, Viewpoint, ViewpointArrays, write_plan
from planning.planner import Planned, _record, as_written
from planning.request import PlanRequest
from planning.viewpoints.candidates import spread_candidates
from planning.viewpoints.problem import take
from reconstruction.scenes.parameters import DEFAULT_POINTS, SceneRequest
from reconstruction.scenes.world.bundled import curved_site, planar_site

FARTHEST_M = 40.0
"""Of all views: the panels of one that is further away are a few pixels wide at the tables' sizes."""

PLANNING_S = 60.0

DRAWN = 20
"""Times as many unseen views are drawn at first as are wanted."""

SITE_WIDTH_PX = 64
"""Of the one photo that is rendered to have the scene's site as a file, with the street that is built before it."""


Planner = Literal["greedy", "noto", "unseen"]

BARE_SITES = {"planar": planar_site, "curved": curved_site}
"""Sites of scenes that can be given another street."""


@dataclass(frozen=True, slots=True)
class Photos:
    """Photos of a bundled scene.

    Parameters
    ----------
    planner
        Of the flight; `unseen` for places and directions drawn at random, which nobody flies.
    street_m
        To the buildings opposite, where that is not to be as in the scene; inf for nothing near at all. Photos are
        taken from where they would be in the scene itself.
    """

    scene: str
    planner: Planner
    n_views: int
    width_px: int
    seed: int = 0
    street_m: float | None = None

    @property
    def flight_name(self) -> str:
        """Of the files with where they are taken from."""
        return f"{self.scene}-{self.planner}-{self.n_views}-{self.seed}"

    @property
    def name(self) -> str:
        """Of their folder."""
        street = "" if self.street_m is None else f"-street-{self.street_m:g}"
        return f"{self.flight_name}-{self.width_px}{street}"


def photos_in(work: Path, photos: Photos) -> Path:
    """The data set folder, rendered if it is not there yet."""
    folder = work / photos.name
    if (folder / "dataset.json").is_file():
        return folder
    plan_path, flight_path = _flown(work, photos)
    look = None if photos.street_m is None else work / f"street-{photos.street_m:g}.toml"
    scene = photos.scene
    if look is not None:
        scene = str(_bare_site_file(work, photos.scene))
        look.write_text(f"street_m = {photos.street_m}\n" if math.isfinite(photos.street_m) else "near = false\n")
    n_points = 0 if flight_path is None else DEFAULT_POINTS
    request = SceneRequest(
        scene, plan=plan_path, flight=flight_path, look=look, width_px=photos.width_px, n_points=n_points
    )
    render_photos(request, folder, 1)
    return folder


def _flown(work: Path, photos: Photos) -> tuple[Path, Path | None]:
    """Files of the plan, and of the flight where there is one; made if they are not there yet."""
    plan_path, flight_path = (work / f"{photos.flight_name}.{kind}.json" for kind in ("plan", "flight"))
    site, is_unseen = site_file(work, photos.scene), photos.planner == "unseen"
    request = PlanRequest(
        method="noto" if photos.planner == "noto" else "greedy",
        n_views=photos.n_views,
        constraints=Constraints(max_distance_m=FARTHEST_M),
        greedy=GreedyParameters(objective="sections"),
        seed=photos.seed,
        time_budget_s=PLANNING_S,
    )
    if is_unseen and not plan_path.is_file():
        few = replace(request, n_views=1, greedy=GreedyParameters(n_candidates=500, improve=False, certify=False))
        write_plan(plan_path, _drawn(plan_site(site, few, None), photos))
    elif not is_unseen and not flight_path.is_file():
        plan_site(site, request, plan_path)
        fly_files(plan_path, site, flight_path, FlightRequest(seed=photos.seed))
    return plan_path, None if is_unseen else flight_path


def site_file(work: Path, scene: str) -> Path:
    """Of a scene, which all its photos have in common; made if it is not there yet, and not by several at once."""
    folder = work / f"{scene}-site"
    if not (folder / SITE_FILE).is_file():
        render_photos(SceneRequest(scene, n_square=1, width_px=SITE_WIDTH_PX, n_points=0), folder, 1)
    return folder / SITE_FILE


def _bare_site_file(work: Path, scene: str) -> Path:
    """The site alone, for a street to be built before it."""
    folder = work / f"{scene}-bare"
    folder.mkdir(exist_ok=True)
    path = folder / SITE_FILE
    if not path.is_file():
        _, files = site_as_written(BARE_SITES[scene]())
        for name, content in files.items():
            (folder / name).write_bytes(content)
    return path


def _drawn(planned: Planned, photos: Photos) -> Plan:
    """A plan that is never flown: views at random places that can be flown to, aimed at panels drawn by lot.

    Those that cover no section of any panel are left out: behind the building, or too far away.
    """
    problem = planned.prepared.problem
    rng = np.random.default_rng([photos.seed, len(photos.scene)])
    views = as_written(problem, spread_candidates(problem, DRAWN * photos.n_views, rng))
    views = take(views, np.diff(problem.model.elements(views).starts) > 0)
    if len(views.heading_rad) < photos.n_views:
        raise ValueError(f"{photos.scene}: expected {photos.n_views} views of {DRAWN} times as many to see panels")
    chosen = rng.permutation(len(views.heading_rad))[: photos.n_views]
    return replace(planned.plan, viewpoints=viewpoints_of(take(views, np.sort(chosen)), "u"), sorties=())


def viewpoints_of(views: ViewpointArrays, prefix: str) -> tuple[Viewpoint, ...]:
    """Viewpoints in the order of `views`, named with the prefix and a number from 0000 on; in no flight."""
    return tuple(_record(f"{prefix}{number:04d}", views, number) for number in range(len(views.heading_rad)))
