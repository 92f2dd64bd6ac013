"""Coverage of a plan section by section: by the contract's words, and at the edges."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from planning.coverage.model import exact_coverage
from planning.coverage.reach_kernel import UNREACHABLE
from planning.insight.reasons import section_reasons
from planning.insight.sections import SectionState
from planning.parameters import Constraints
from planning.plan import Viewpoint, viewpoint_arrays
from planning.site.bundled import SCENES
from planning.viewpoints.prepare import prepare
from tests.planning.insight.cases import CAMERA, NEAR, plan, plan_insight, prepared, reasons, scene
from tests.planning.plan_cases import seen_by_contract


def insight_of(name, viewpoints=None, constraints=NEAR):
    its_plan = plan(name)
    if viewpoints is not None:
        its_plan = replace(its_plan, viewpoints=tuple(viewpoints), sorties=())
    return plan_insight(scene(name), prepared(name, constraints), its_plan, reasons(name, constraints))


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["kiosk", "roof"])
def test_counts_and_views_are_those_of_the_contract(name):
    found = insight_of(name)
    model = scene(name)
    occlusion = found.constraints.occlusion == "on"
    expected = seen_by_contract(model, CAMERA, plan(name).viewpoints, 30.0, occlusion)
    counts = Counter({(j, s): int(found.counts[j, s]) for j, s in zip(*np.nonzero(found.counts), strict=True)})
    assert counts == expected
    for (panel, section), times in list(expected.items())[::7]:
        views = found.views_of(panel, section)
        assert len(views) == times
        for view in views:
            alone = seen_by_contract(model, CAMERA, (plan(name).viewpoints[view],), 30.0, occlusion)
            assert alone[panel, section] == 1


def test_states_shares_and_sums_fit_together_and_agree_with_the_plan():
    found = insight_of("kiosk")
    stated = plan("kiosk").coverage
    assert found.covered_per_panel.sum() == (found.counts > 0).sum() == stated.covered
    assert found.possible_per_panel.sum() == stated.reachable_upper_bound
    assert found.state(0, int(np.argmax(found.counts[0]))) is SectionState.COVERED
    np.testing.assert_allclose(found.share_per_panel, found.covered_per_panel / found.possible_per_panel)
    assert found.view_ids == tuple(viewpoint.id for viewpoint in plan("kiosk").viewpoints)
    assert found.panel_ids[9] == "B-0000"
    unreachable = found.states == SectionState.UNREACHABLE
    assert unreachable.any()
    assert all(found.reasons.of(panel, section) for panel, section in zip(*np.nonzero(unreachable), strict=True))


def test_a_plan_without_views_misses_everything_that_can_be_reached():
    found = insight_of("kiosk", ())
    assert found.sections.shape == (0, 15)
    assert not found.counts.any()
    assert set(np.unique(found.states)) <= {SectionState.UNREACHABLE, SectionState.UNDECIDED, SectionState.MISSED}
    assert (found.share_per_panel == 0.0).all()
    assert np.isnan(found.sampling.best_m).all()


def test_views_of_other_programs_count_even_where_they_must_not_fly():
    forbidden = prepared("kiosk").problem.reachability.verdicts == UNREACHABLE
    frames = prepared("kiosk").problem.model.frames
    panel = int(np.argmax(forbidden.any(axis=1)))
    # Two metres in front of the pane, too close; far outside the airspace; and inside the building.
    near = frames.centroids[panel] + 2.0 * frames.normals[panel] - 1.5 * frames.bitangents[panel]
    heading = 0.0 if panel < 9 else -90.0
    outside = Viewpoint("outside", (0.0, -300.0, 5.0), 0.0, 0.0)
    inside = Viewpoint("inside", (0.0, 4.0, 4.0), 180.0, 0.0)
    found = insight_of("kiosk", (Viewpoint("near", tuple(near), heading, 35.0), outside, inside))
    for view, expected in ((0, True), (1, True), (2, False)):
        assert (found.sections[view] >= 0).any() == expected
    below = found.sections[0, panel]
    assert forbidden[panel, below]
    assert found.state(panel, below) is SectionState.COVERED
    assert found.counts.sum() == (found.sections >= 0).sum()


@pytest.mark.slow
def test_fine_sections_and_the_precision_of_the_fast_kernel_change_nothing():
    fine = Constraints(min_distance_m=5.0, section_step_deg=5.0)
    model, views = scene("single-panel"), plan("single-panel")
    found = []
    for precision in ("f32", "f64"):
        site = prepare(model, CAMERA, fine, precision=precision)
        found.append(plan_insight(model, site, views, section_reasons(model, site)))
        expected = exact_coverage(site.problem.model, viewpoint_arrays(views.viewpoints))
        np.testing.assert_array_equal(found[-1].counts, expected)
    assert found[0].counts.shape == (1, 1296)
    np.testing.assert_array_equal(found[0].sections, found[1].sections)
    coarse = insight_of("single-panel")
    assert found[0].counts.sum() == coarse.counts.sum()


@pytest.mark.long
def test_a_panel_that_nobody_sees_has_no_share():
    model = SCENES["single-panel"]()
    south, airspace = model.site.facades[0], model.site.airspace
    # The same pane facing the other way, with the airspace ending at its back.
    turned = replace(south.panels[0], id="back", corners_enu_m=south.panels[0].corners_enu_m[::-1])
    facade = replace(south, panels=(*south.panels, turned))
    space = replace(airspace, max_enu_m=(50.0, -0.5, 50.0))
    model = replace(model, site=replace(model.site, facades=(facade,), airspace=space))
    site = prepare(model, CAMERA, NEAR)
    found = plan_insight(model, site, plan("single-panel"), section_reasons(model, site))
    assert found.possible_per_panel[1] == 0
    assert np.isnan(found.share_per_panel).tolist() == [False, True]


def test_reasons_of_another_site_are_refused():
    with pytest.raises(ValueError, match="reasons: expected those of this site"):
        plan_insight(scene("kiosk"), prepared("kiosk"), plan("kiosk"), reasons("single-panel"))
