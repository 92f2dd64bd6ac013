"""After an edit an active plan is what it would be if it were activated anew."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from groundstation.services.plan.plan_cache import ActivePlan, PreparedSite, insight_of
from planning.insight.reasons import section_reasons
from planning.insight.sections import PanelSampling
from planning.revision.edits import Revision, add, delete, lock, move
from tests.planning.revision.cases import planned


@pytest.fixture(scope="module")
def in_hand() -> ActivePlan:
    revision = planned("kiosk")
    prepared = revision.prepared
    reasons = section_reasons(prepared.site_model, prepared)
    return ActivePlan(PreparedSite(prepared, reasons), revision, insight_of(revision, reasons))


def edits(revision: Revision) -> list[Revision]:
    first, second = (viewpoint.id for viewpoint in revision.plan.viewpoints[:2])
    moved = move(revision, first, (5.0, -14.0, 9.0), 20.0, 0.0)
    return [
        moved,
        move(revision, second, None, 170.0, -10.0),
        add(revision, (3.0, -15.0, 8.0), 0.0, 0.0),
        delete(moved, [first]),
        delete(revision, [viewpoint.id for viewpoint in revision.plan.viewpoints[1:]]),
        lock(revision, [second]),
    ]


def test_pixel_sizes_after_an_edit_are_those_of_the_whole_plan(in_hand: ActivePlan) -> None:
    changed = 0
    for revision in edits(in_hand.revision):
        found = in_hand.with_revision(revision).insight.sampling
        anew = insight_of(revision, in_hand.insight.reasons).sampling
        for field in fields(PanelSampling):
            np.testing.assert_array_equal(getattr(found, field.name), getattr(anew, field.name))
        changed += not np.array_equal(anew.best_m, in_hand.insight.sampling.best_m, equal_nan=True)
    assert changed >= 3, "edits that change nothing test nothing"


def test_edits_one_after_another_end_where_all_at_once_do(in_hand: ActivePlan) -> None:
    found = in_hand
    for revision in edits(in_hand.revision):
        found = found.with_revision(revision)
    anew = insight_of(found.revision, in_hand.insight.reasons)
    np.testing.assert_array_equal(found.insight.sampling.worst_m, anew.sampling.worst_m)
    np.testing.assert_array_equal(found.insight.counts, anew.counts)


def test_views_at_one_pose_and_a_plan_without_views_are_measured_like_others(in_hand: ActivePlan) -> None:
    first = in_hand.revision.plan.viewpoints[0]
    twice = add(in_hand.revision, first.position_enu_m, first.heading_deg, first.gimbal_pitch_deg)
    none = delete(twice, [viewpoint.id for viewpoint in twice.plan.viewpoints])
    found = in_hand
    for revision in (twice, delete(twice, [first.id]), none, add(none, (3.0, -15.0, 8.0), 0.0, 0.0)):
        found = found.with_revision(revision)
        anew = insight_of(revision, in_hand.insight.reasons)
        np.testing.assert_array_equal(found.insight.sections, anew.sections)
        np.testing.assert_array_equal(found.insight.states, anew.states)
        for field in fields(PanelSampling):
            np.testing.assert_array_equal(
                getattr(found.insight.sampling, field.name), getattr(anew.sampling, field.name)
            )
