"""Compile all kernels once and keep them on disk: `python -m planning.warm_up` (part of `make setup`)."""

from __future__ import annotations

import gc
import itertools
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np

from planning.aircraft.catalogue import profile
from planning.checks import check_plan
from planning.coverage.model import CoverageModel
from planning.coverage.sections import PanelFrames, SectionGrid, panel_frames
from planning.geo.bvh import first_hits
from planning.geo.height_field import HeightField
from planning.geo.sun import sun_track
from planning.insight.clearance import route_clearance
from planning.insight.obstructions import first_obstructions_hit, obstructions_of
from planning.insight.reasons import section_reasons
from planning.insight.sections import panel_sampling
from planning.insight.sunlight import MIRRORS, SunSite, sun_day
from planning.motion import speed_profile
from planning.parameters import DEFAULT_PROFILE, Constraints, GreedyParameters, Precision
from planning.plan import Sortie, Viewpoint, ViewpointArrays
from planning.planner import plan_flight
from planning.proof import boxes, make, separation
from planning.request import PlanRequest
from planning.routing import at_once, lower_bound, orienteering, sorties, tour
from planning.site.bundled import SCENES
from planning.site.records import panel_corners
from planning.viewpoints.prepare import prepare


def _analyse() -> None:
    """Run every kernel of `planning.insight` on a site with unreachable sections."""
    model = SCENES["single-panel"]()
    prepared = prepare(model, profile(DEFAULT_PROFILE).camera, Constraints())
    section_reasons(model, prepared)
    frames, camera = prepared.problem.model.frames, prepared.problem.model.camera
    panel_sampling(frames, camera, frames.centroids + frames.normals, np.zeros((len(frames), len(frames)), np.int16))
    space = prepared.problem.space
    obstructions = obstructions_of(model, space)
    route_clearance(Sortie((), ((0.0, -20.0, 5.0), (5.0, -20.0, 5.0)), 5.0, 5.0), space, obstructions)
    ends = space.home_enu_m[None], space.column_top_enu_m[None]
    first_obstructions_hit(space.solids, obstructions.solid_owner, *ends)
    space.solids.lines_free(*ends)
    first_hits(space.solids.bvh, *ends, 1.0, np.empty(1), np.empty(1, np.int64))
    noon = datetime(2026, 6, 21, 4, tzinfo=UTC)
    track = sun_track(model.site.origin.lat_deg, model.site.origin.lon_deg, noon, noon + timedelta(minutes=10))
    view = Viewpoint("v", (0.0, -20.0, 5.0), 0.0, 0.0)
    sun_day(SunSite(model), track, (view,), camera, {MIRRORS: "on"})


LONG_ENOUGH_S = 3600.0
"""Compiling counts as planning time: with less, searches would be stopped before their kernels ran, on a busy computer
with 60 s, too. They end by themselves after a few seconds."""


def compile_kernels() -> None:
    """Run every kernel on small inputs: the planning methods in both precisions and both widths, and the routing."""
    few = GreedyParameters(n_candidates=200, improve=False, objective="sections")
    for_error = replace(few, objective="image-error")
    occluded, fine = Constraints(occlusion="on"), Constraints(section_step_deg=15.0)
    requests = (
        PlanRequest(n_views=1, greedy=replace(few, improve=True), time_budget_s=LONG_ENOUGH_S),
        PlanRequest(n_views=6, greedy=few, time_budget_s=LONG_ENOUGH_S, precision="f64", constraints=fine),
        PlanRequest(share=0.5, greedy=few, time_budget_s=LONG_ENOUGH_S, constraints=fine),
        PlanRequest(share=0.5, greedy=few, time_budget_s=LONG_ENOUGH_S, precision="f64", constraints=occluded),
        PlanRequest(n_batteries=1, greedy=few, time_budget_s=2.0),
        PlanRequest(n_views=6, greedy=for_error, time_budget_s=LONG_ENOUGH_S),
        PlanRequest(n_batteries=1, greedy=for_error, time_budget_s=2.0),
    )
    model = SCENES["roof"]()
    for request in requests:
        check_plan(plan_flight(model, request).plan, model)
    _analyse()
    _count_coverage(panel_frames(panel_corners(model.site)))
    field = HeightField(0.0, 0.0, 1.0, np.zeros((2, 2)))
    field.leg_heights_m(np.ones((1, 3)), np.ones((1, 3)))
    field.legs_keep(np.ones((1, 3)), np.ones((1, 3)), 1.0)
    field.heights_m(np.ones((1, 3)))
    field.spread_departures(np.ones((1, 3)), np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((1, 1)))
    # The last one says that all are there: see `groundstation.services.plan.planning.compile_once`.
    for module in (at_once, boxes, lower_bound, make, orienteering, sorties, speed_profile, tour, separation):
        module.compile_kernels()


def _count_coverage(frames: PanelFrames) -> None:
    """Coverage of a set of views at once, which particle swarms and orbits count; few plans above do."""
    view = ViewpointArrays(np.zeros((1, 3)), np.zeros(1), np.zeros(1))
    precisions: tuple[Precision, ...] = ("f32", "f64")
    for precision, step_deg in itertools.product(precisions, (30.0, 15.0)):
        CoverageModel(frames, profile(DEFAULT_PROFILE).camera, SectionGrid(step_deg), precision=precision).covered(view)


if __name__ == "__main__":
    gc.disable()  # a compiler leaves little garbage, and looking for it takes a twentieth of the time
    compile_kernels()
