"""Photos that the tables' models learn from and are scored on: plans, flown in simulation, rendered where they led."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from groundstation.services.flying import FlightWish, fly_files
from groundstation.services.planning import plan_site
from groundstation.services.scene_photos import photograph_files
from groundstation.services.scene_views import SITE_FILE, SceneWish
from planning.optimise.candidates import spread_candidates
from planning.optimise.problem import take
from planning.plan import Constraints, Plan
from planning.plan_file import write_plan
from planning.plan_records import as_written, viewpoints_of
from planning.planner import Planned
from planning.request import GreedyParameters, PlanRequest

FARTHEST_M = 40.0
"""Of all views: the panels of one that is further away are a few pixels wide at the tables' sizes."""

PLANNING_S = 60.0

DRAWN = 20
"""Times as many unseen views are drawn at first as are wanted."""

SITE_WIDTH_PX = 64
"""Of the one photo that is rendered to have the scene's site as a file, with the street that is built before it."""


Planner = Literal["greedy", "noto", "unseen"]


@dataclass(frozen=True, slots=True)
class Photos:
    """Photos of a bundled scene.

    Parameters
    ----------
    planner
        Of the flight; `unseen` for places and directions drawn at random, which nobody flies.
    """

    scene: str
    planner: Planner
    n_views: int
    width_px: int
    seed: int = 0

    @property
    def name(self) -> str:
        """Of their folder."""
        return f"{self.scene}-{self.planner}-{self.n_views}-{self.width_px}-{self.seed}"


def photos_in(work: Path, photos: Photos) -> Path:
    """The data set folder, rendered if it is not there yet."""
    folder = work / photos.name
    if (folder / "dataset.json").is_file():
        return folder
    site = _site_file(work, photos.scene)
    plan_path, flight_path = work / f"{photos.name}.plan.json", work / f"{photos.name}.flight.json"
    request = PlanRequest(
        method="greedy" if photos.planner == "unseen" else photos.planner,
        n_views=photos.n_views,
        constraints=Constraints(max_distance_m=FARTHEST_M),
        seed=photos.seed,
        time_budget_s=PLANNING_S,
    )
    if photos.planner == "unseen":
        few = replace(request, n_views=1, greedy=GreedyParameters(n_candidates=500, improve=False, certify=False))
        write_plan(plan_path, _drawn(plan_site(site, few, None), photos))
        wish = SceneWish(photos.scene, plan=plan_path, width_px=photos.width_px, n_points=0)
    else:
        plan_site(site, request, plan_path)
        fly_files(plan_path, site, flight_path, FlightWish(seed=photos.seed))
        wish = SceneWish(photos.scene, plan=plan_path, flight=flight_path, width_px=photos.width_px)
    photograph_files(wish, folder, 1)
    return folder


def _site_file(work: Path, scene: str) -> Path:
    folder = work / f"{scene}-site"
    if not (folder / SITE_FILE).is_file():
        photograph_files(SceneWish(scene, n_square=1, width_px=SITE_WIDTH_PX, n_points=0), folder, 1)
    return folder / SITE_FILE


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
