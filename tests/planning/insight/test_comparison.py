"""Comparing plans: equal plans are equal, differences are found where they are, and all are counted in one way."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from planning.base.findings import Severity
from planning.checks import check_plan
from planning.coverage.model import exact_coverage
from planning.coverage.reach_kernel import UNREACHABLE
from planning.insight.comparison import Better, Row, compare_plans
from planning.parameters import Constraints
from planning.plan import viewpoint_arrays
from tests.planning.insight.cases import NEAR, plan, prepared, scene

model, site, planned = partial(scene, "kiosk"), partial(prepared, "kiosk"), partial(plan, "kiosk")


def compared(*plans, on=None):
    return compare_plans(model(), on or site(), plans, [f"plan {number}" for number in range(len(plans))])


def values(comparison, code, subject=""):
    (row,) = (row for row in comparison.rows if (row.code, row.subject) == (code, subject))
    return row.values


def first_views(n):
    return replace(planned(), viewpoints=planned().viewpoints[:n], sorties=())


@pytest.mark.long
def test_a_plan_beside_itself_is_equal_in_every_row_and_better_in_none():
    same = compared(planned(), planned())
    for row in same.rows:
        assert row.values[0] == row.values[1]
        assert row.best == ()
    assert not same.more_covered_per_panel(0, 1).any()
    assert same.notes == ()


@pytest.mark.long
def test_rows_hold_what_is_measured_one_by_one():
    found = compared(planned(), first_views(4))
    counts = [exact_coverage(site().problem.model, viewpoint_arrays(p.viewpoints)) for p in (planned(), first_views(4))]
    covered = [c > 0 for c in counts]
    assert values(found, "views") == (12.0, 4.0)
    assert values(found, "covered") == tuple(float(c.sum()) for c in covered)
    possible = (site().problem.reachability.verdicts != UNREACHABLE).sum()
    assert values(found, "possible-share") == pytest.approx([c.sum() / possible for c in covered])
    assert values(found, "depth", "2") == tuple(float((c >= 2).sum()) for c in counts)
    assert values(found, "only-here") == (float((covered[0] & ~covered[1]).sum()), 0.0)
    facade_a = (site().problem.reachability.verdicts[:9] != UNREACHABLE).sum()
    assert values(found, "facade-share", "A") == pytest.approx([c[:9].sum() / facade_a for c in covered])
    np.testing.assert_array_equal(found.more_covered_per_panel(0, 1), covered[0].sum(axis=1) - covered[1].sum(axis=1))
    measured = {f.code: f.value for f in check_plan(planned(), model())}
    assert values(found, "clearance") == (pytest.approx(measured["leg-distance"], abs=1e-5), None)
    errors = [f for f in check_plan(first_views(4), model()) if f.severity is Severity.ERROR]
    assert values(found, "findings", "error") == (0.0, float(len(errors)))
    assert errors


def test_the_better_value_is_the_one_that_its_row_says():
    def best(better, *row_values):
        return Row("code", "label", "", better, row_values).best

    assert best(Better.HIGHER, 1.0, 3.0, 3.0) == (1, 2)
    assert best(Better.LOWER, 1.0, 3.0, None) == (0,)
    assert best(Better.LOWER, 2.0, 2.0) == ()
    assert best(Better.NEITHER, 1.0, 2.0) == ()
    assert best(Better.LOWER, None, None) == ()
    assert best(Better.LOWER, None, 5.0) == ()


@pytest.mark.long
def test_plans_made_for_other_constraints_are_counted_under_the_first_ones_and_noted():
    other = replace(planned(), constraints=Constraints(8.0, section_step_deg=15.0, occlusion="auto"))
    found = compared(planned(), other)
    assert values(found, "covered")[0] == values(found, "covered")[1]
    (note,) = found.notes
    assert "plan 1 was made for other constraints" in note
    assert "minimum distance (m) 8.0 instead of 5.0" in note
    assert "section step (degrees) 15.0 instead of 30.0" in note
    assert "occlusion" not in note
    assert found.constraints.min_distance_m == NEAR.min_distance_m


def test_each_plan_is_seen_with_its_own_camera():
    tele = replace(planned(), camera=replace(planned().camera, name="tele", focal_length_mm=49.16))
    found = compared(planned(), tele)
    assert values(found, "covered")[1] < values(found, "covered")[0]
    best = values(found, "gsd-best")
    # Four times the focal length: a quarter of the pixel where the same panel is covered, if it is.
    assert best[1] < 0.5 * best[0]
    assert any("cameras differ" in note for note in found.notes)


def test_what_any_plan_covers_counts_as_possible_for_all():
    verdicts = site().problem.reachability.verdicts
    covered = exact_coverage(site().problem.model, viewpoint_arrays(planned().viewpoints)) > 0
    nothing = replace(site().problem.reachability, verdicts=np.full_like(verdicts, UNREACHABLE))
    hopeless = replace(site(), problem=replace(site().problem, reachability=nothing))
    found = compared(planned(), first_views(0), on=hopeless)
    np.testing.assert_array_equal(found.is_possible, covered)
    assert values(found, "possible-share") == (1.0, 0.0)


def test_plans_without_views_have_no_pixels_and_no_clearance():
    found = compared(first_views(0), first_views(0))
    for code in ("gsd-best", "gsd-worst", "gsd-worst-panel", "clearance"):
        assert values(found, code) == (None, None)
    assert values(found, "covered") == (0.0, 0.0)


@pytest.mark.parametrize("n", [0, 1])
def test_less_than_two_plans_are_refused(n):
    with pytest.raises(ValueError, match="expected two plans or more"):
        compared(*[planned()] * n)
