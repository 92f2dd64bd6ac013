"""What an edit changed is told as it is, and the document takes the edited plan over."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.plan.editing import (
    BESIDE_M,
    above_home,
    coverage_change,
    edit_effect,
    has_same_panels,
    viewpoint_beside,
    with_edited_plan,
)
from groundstation.services.project.document import Document, PlanEntry
from planning.plan import Viewpoint
from planning.revision.edits import delete, lock, move
from planning.site.bundled import canyon, roof
from tests.planning.revision.cases import planned


@pytest.mark.slow
def test_an_edit_s_effect_is_the_difference_of_both_plans_and_its_reverse_takes_it_back() -> None:
    before = planned("kiosk")
    after = move(before, "v0003", (5.0, -14.0, 9.0), 20.0, 0.0)
    effect, back = edit_effect(before, after), edit_effect(after, before)
    assert effect.gained - effect.lost == after.plan.coverage.covered - before.plan.coverage.covered
    assert effect.gained > 0
    assert effect.lost > 0
    assert (back.gained, back.lost) == (effect.lost, effect.gained)
    assert effect.added_s == pytest.approx(after.plan.duration_s - before.plan.duration_s)
    assert back.added_s == pytest.approx(-effect.added_s)
    assert back.added_m == pytest.approx(-effect.added_m)
    assert (back.problems, back.solved) == (effect.solved, effect.problems)
    np.testing.assert_array_equal(coverage_change(before, after), -coverage_change(after, before))


@pytest.mark.long
def test_problems_that_come_and_go_with_an_edit_are_told_and_those_that_stay_are_not() -> None:
    start = planned("kiosk")
    inside = move(start, "v0003", (0.0, -2.0, 5.0))
    came = edit_effect(start, inside)
    assert {"distance", "leg-distance"} <= {found.code for found in came.problems}
    deeper = move(inside, "v0003", (0.0, 3.0, 5.0))
    assert not {"distance"} & {found.code for found in edit_effect(inside, deeper).problems}
    gone = edit_effect(deeper, delete(deeper, ["v0003"]))
    assert {"distance", "leg-distance"} <= {found.code for found in gone.solved}
    assert gone.problems == ()


@pytest.mark.long
def test_locking_changes_nothing_that_is_measured() -> None:
    start = planned("kiosk")
    effect = edit_effect(start, lock(start, ["v0001"]))
    assert (effect.gained, effect.lost, effect.added_s, effect.added_m) == (0, 0, 0.0, 0.0)
    assert (effect.problems, effect.solved) == ((), ())


def test_the_document_takes_the_plan_over_without_the_bound_of_the_planner_s_choice() -> None:
    start = planned("kiosk")
    entries = (PlanEntry("plan-1", "first", start.plan, None, 123.0), PlanEntry("plan-2", "second", start.plan))
    document = Document(start.prepared.site_model, entries, "plan-1")
    edited = delete(start, ["v0001"])
    after = with_edited_plan(document, edited)
    assert after.current is not None
    assert after.current.plan is edited.plan
    assert (after.current.title, after.current.bound_for_views) == ("first", None)
    assert after.plans[1] is document.plans[1]
    with pytest.raises(ValueError, match="expected a current plan"):
        with_edited_plan(Document(), edited)


@pytest.mark.parametrize("heading_deg", [0.0, 90.0, -136.5, 180.0])
def test_a_new_viewpoint_stands_beside_the_other_and_inside_the_airspace(heading_deg: float) -> None:
    site = roof().site
    low, high = (np.array(corner) for corner in (site.airspace.min_enu_m, site.airspace.max_enu_m))
    for corner in (low, high, 0.5 * (low + high)):
        old = Viewpoint("v", tuple(corner.tolist()), heading_deg, 5.0, locked=True)
        new = viewpoint_beside(old, site.airspace)
        place = np.array(new.position_enu_m)
        assert np.linalg.norm(place - corner) == pytest.approx(BESIDE_M)
        assert place[2] == corner[2]
        assert (new.heading_deg, new.gimbal_pitch_deg, new.locked) == (heading_deg, 5.0, False)
        inside = [(low <= p).all() and (p <= high).all() for p in (place, 2.0 * corner - place)]
        assert inside[0] or not inside[1], "there was room on the other side"


def test_the_first_viewpoint_stands_above_home_inside_the_airspace() -> None:
    site = roof().site
    x, y, z = above_home(site).position_enu_m
    assert (x, y) == site.home_enu_m[:2]
    assert site.airspace.min_enu_m[2] <= z <= site.airspace.max_enu_m[2]


def test_a_plan_fits_a_site_that_was_edited_and_not_one_that_was_replaced() -> None:
    site = roof()
    moved = replace(site, site=replace(site.site, home_enu_m=(1.0, -30.0, 0.0)))
    assert has_same_panels(site, moved)
    assert not has_same_panels(site, canyon())
    assert not has_same_panels(site, None)
