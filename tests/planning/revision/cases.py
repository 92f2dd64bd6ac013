"""Small plans on prepared sites, made once, and random edits of them."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.checks import check_plan
from planning.coverage.evaluate import coverage, coverage_counts
from planning.geo.frames import Vec3
from planning.parameters import Constraints, FlightRules, GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.edits import Revision, add, delete, lock, move, revise
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from tests.planning.plan_cases import kiosk

QUICK = GreedyParameters(n_candidates=400, improve=False, certify=False, objective="sections")


class Setting(NamedTuple):
    """A site with a request."""

    site: Callable[[], SiteModel]
    request: PlanRequest


NEAR = Constraints(min_distance_m=5.0)
SETTINGS = {
    "kiosk": Setting(kiosk, PlanRequest(n_views=7, constraints=NEAR, greedy=QUICK)),
    "short sorties": Setting(
        kiosk, PlanRequest(n_views=12, constraints=NEAR, greedy=QUICK, rules=FlightRules(battery_reserve=0.95))
    ),
    "near and whole": Setting(
        kiosk,
        PlanRequest(
            n_views=6,
            constraints=replace(NEAR, max_distance_m=22.0, whole_panel=True, section_step_deg=15.0),
            greedy=QUICK,
            rules=FlightRules(turn_in_flight=True),
        ),
    ),
    "canyon": Setting(SCENES["canyon"], PlanRequest(n_views=10, constraints=Constraints(8.0), greedy=QUICK)),
}


@functools.cache
def prepared(name: str) -> Prepared:
    setting = SETTINGS[name]
    camera = profile(setting.request.profile_id).camera
    return prepare(setting.site(), camera, setting.request.constraints, max_positions=1024, max_cells=50)


@functools.cache
def planned(name: str) -> Revision:
    """A plan as the planner leaves it, measured."""
    found = plan_flight(prepared(name).site_model, SETTINGS[name].request, prepared=prepared(name))
    return revise(found.plan, prepared(name))


def errors(revision: Revision) -> dict[str, Finding]:
    """Findings that ground the flight, by code."""
    return {found.code: found for found in revision.findings if found.severity is Severity.ERROR}


def assert_is_as_from_scratch(revision: Revision) -> None:
    """Everything that a revision knows, against the plan measured anew by the functions that whole plans are given."""
    plan, model = revision.plan, revision.prepared.problem.model
    assert revision.findings == check_plan(plan, revision.prepared.site_model)
    assert plan.coverage == coverage(model, plan.viewpoints, revision.prepared.problem.reachability)
    np.testing.assert_array_equal(revision.counts, coverage_counts(model, plan.viewpoints))
    for viewpoint in plan.viewpoints:
        alone = np.flatnonzero(coverage_counts(model, (viewpoint,)))
        np.testing.assert_array_equal(np.sort(revision.elements_of_pose(viewpoint)), alone)
    solids = revision.case.space.solids
    for sortie in plan.sorties:
        path = np.array(sortie.path_enu_m)
        np.testing.assert_array_equal(
            revision.leg_clearances_m(sortie), solids.segment_distances_m(path[:-1], path[1:])
        )


Edit = Callable[[Revision], Revision]


def _kept_where_locked(edit: Edit) -> Edit:
    def tried(revision: Revision) -> Revision:
        try:
            return edit(revision)
        except InputError:
            return revision

    return tried


def _some_id(revision: Revision, number: int) -> str:
    return revision.plan.viewpoints[number % len(revision.plan.viewpoints)].id


def edits() -> st.SearchStrategy[Edit]:
    """Edits with values that are allowed, forbidden and at the borders; places are half in, half out of the air."""
    coordinate = st.floats(-45.0, 45.0, allow_nan=False)
    place = st.one_of(
        st.tuples(coordinate, coordinate, st.floats(-5.0, 45.0)),
        st.sampled_from([(0.0, 4.0, 4.0), (0.0, -5.0, 6.0), (-30.0, 0.0, 12.0), (40.0, 40.0, 40.0), (0.0, -30.0, 5.0)]),
    )
    heading, pitch = st.floats(-720.0, 720.0), st.one_of(st.floats(-95.0, 60.0), st.sampled_from([-90.0, 35.0, 35.001]))
    number = st.integers(0, 99)

    def moved(i: int, p: Vec3, h: float, q: float) -> Edit:
        return lambda r: move(r, _some_id(r, i), p, h, q) if r.plan.viewpoints else r

    def turned(i: int, h: float | None, q: float | None) -> Edit:
        return lambda r: move(r, _some_id(r, i), None, h, q) if r.plan.viewpoints else r

    def onto(i: int, j: int) -> Edit:
        def edit(r: Revision) -> Revision:
            if not r.plan.viewpoints:
                return r
            anchor = r.viewpoint(_some_id(r, j))
            return move(r, _some_id(r, i), anchor.position_enu_m, anchor.heading_deg, anchor.gimbal_pitch_deg)

        return edit

    def added(p: Vec3, h: float, q: float) -> Edit:
        return lambda r: add(r, p, h, q)

    def deleted(chosen: set[int]) -> Edit:
        return lambda r: delete(r, {_some_id(r, i) for i in chosen}) if r.plan.viewpoints else r

    def locked(i: int, on: bool) -> Edit:
        return lambda r: lock(r, [_some_id(r, i)], on) if r.plan.viewpoints else r

    return st.one_of(
        st.builds(moved, number, place, heading, pitch),
        st.builds(turned, number, heading, st.none()),
        st.builds(turned, number, st.none(), pitch),
        st.builds(onto, number, number),
        st.builds(added, place, heading, pitch),
        st.builds(deleted, st.sets(number, min_size=1, max_size=3)),
        st.builds(locked, number, st.booleans()),
    ).map(_kept_where_locked)
