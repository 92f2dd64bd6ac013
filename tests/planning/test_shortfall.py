"""Why sections stay open, and that a share that cannot be reached says so."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.plan.planning import plan_document_site, planned_summary, why_open
from planning.aircraft.catalogue import profile
from planning.base.findings import Severity
from planning.coverage.model import exact_coverage
from planning.coverage.reach_kernel import REACHABLE, UNDECIDED
from planning.geo.mesh import box_mesh
from planning.parameters import Constraints, GreedyParameters
from planning.plan import viewpoint_arrays
from planning.planner import OpenReason, open_sections, plan_flight
from planning.request import PlanRequest
from planning.site.records import Obstacle, SiteModel
from planning.viewpoints.prepare import prepare
from tests.planning.plan_cases import StopAfter, turned_site

NEAR = Constraints(min_distance_m=8.0)
EVERYTHING = PlanRequest(share=1.0, constraints=NEAR, greedy=GreedyParameters(1000, certify=False))


def strip() -> SiteModel:
    """Sections of some panels are seen from a narrow strip above the ground only, where waypoints crowd."""
    return turned_site(33.0, n_rows=4, n_columns=10, panel_m=(1.2, 1.2), foot_m=6.0)


@pytest.mark.slow
def test_a_share_that_spacing_keeps_from_being_reached_names_it_and_the_panels() -> None:
    model = strip()
    planned = plan_document_site(model, EVERYTHING)
    coverage = planned.plan.coverage
    assert coverage.covered < coverage.reachable_upper_bound
    assert Counter(each.why for each in planned.open_sections) == {
        OpenReason.SPACING: coverage.reachable_upper_bound - coverage.covered
    }
    less, spacing = planned.findings
    assert (less.code, spacing.code, spacing.severity) == ("less-coverage", "open-spacing", Severity.WARNING)
    assert "time" not in less.message
    assert "less than 0.5 m from other viewpoints, which DJI M3E refuses; more time does not help" in spacing.message
    listed = planned_summary(planned, 1.0)["open"]
    assert len(listed) == len(planned.open_sections)
    assert {each["panel"] for each in listed} <= {panel.id for panel in model.site.panels}
    assert spacing.place in {each["panel"] for each in listed}
    free = plan_flight(model, replace(EVERYTHING, profile_id="ardupilot"))
    assert free.plan.coverage.covered == free.plan.coverage.reachable_upper_bound
    assert free.open_sections == ()


@pytest.mark.long
def test_sections_that_more_views_would_cover_are_told_from_those_never_decided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem = prepare(strip(), profile("m3e").camera, NEAR).problem
    reachable = problem.reachability.verdicts != 0
    nothing = np.zeros(reachable.shape, np.bool_)
    found = open_sections(problem, nothing, np.zeros((0, 3)), 0.5)
    assert len(found) == reachable.sum()
    assert {each.why for each in found} == {OpenReason.SEARCH}
    monkeypatch.setattr("planning.planner.OPEN_PER_BLOCK", 100)
    late = Counter(each.why for each in open_sections(problem, nothing, np.zeros((0, 3)), 0.5, StopAfter(1)))
    assert late == {OpenReason.SEARCH: 200, OpenReason.LATE: len(found) - 200}
    verdicts = problem.reachability.verdicts.copy()
    verdicts[verdicts == REACHABLE] = UNDECIDED
    undecided = replace(problem, reachability=replace(problem.reachability, verdicts=verdicts))
    assert {each.why for each in open_sections(undecided, nothing, np.zeros((0, 3)), 0.5)} == {OpenReason.UNDECIDED}
    covered = np.ones_like(nothing)
    covered[0] = False
    assert {each.panel for each in open_sections(problem, covered, np.zeros((0, 3)), 0.5)} == {0}


@pytest.mark.slow
def test_places_behind_a_wall_are_cut_off() -> None:
    """A wall across the airspace, up to its ceiling, with home on one side: the other side's places are cut off."""
    model = turned_site(0.0, n_rows=2, n_columns=3)
    wall = Obstacle("wall", box_enu_m=((-31.0, -31.0, 0.0), (-9.0, 31.0, 35.0)))
    low, high = (np.array(corner) for corner in wall.box_enu_m or ())
    gap = Constraints(min_distance_m=4.0)
    airspace = replace(model.site.airspace, min_enu_m=(-60.0, -30.0, 2.0))
    site = replace(model.site, obstacles=(wall,), airspace=airspace, home_enu_m=(-50.0, 0.0, 0.0))
    behind = SiteModel(site, model.building, (box_mesh(low, high),))
    problem = prepare(behind, profile("m3e").camera, gap).problem
    nothing = np.zeros(problem.reachability.verdicts.shape, np.bool_)
    assert {each.why for each in open_sections(problem, nothing, np.zeros((0, 3)), 0.5)} == {OpenReason.CUT_OFF}


@pytest.mark.slow
def test_a_reached_share_has_nothing_open_and_a_number_of_views_is_not_asked() -> None:
    model = turned_site(10.0, n_rows=2, n_columns=2)
    assert plan_flight(model, replace(EVERYTHING, share=0.5)).open_sections == ()
    planned = plan_flight(model, replace(EVERYTHING, share=None, n_views=3))
    assert planned.open_sections == ()
    views = viewpoint_arrays(planned.plan.viewpoints)
    assert (exact_coverage(planned.prepared.problem.model, views) > 0).sum() == planned.plan.coverage.covered


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("is_cut_short", [False, True])
def test_what_was_not_decided_asks_for_time_only_where_time_was_short(is_cut_short: bool) -> None:
    model = turned_site(20.0, n_rows=2, n_columns=2)
    prepared = prepare(model, profile("m3e").camera, NEAR, max_positions=512, max_cells=1)
    planned = plan_flight(model, EVERYTHING, prepared=replace(prepared, is_cut_short=is_cut_short))
    assert all(each.why is OpenReason.UNDECIDED for each in planned.open_sections)
    (finding,) = why_open(planned)
    assert finding.value == len(planned.open_sections) > 0
    assert finding.message.endswith("allow it more time" if is_cut_short else "more time does not help")
