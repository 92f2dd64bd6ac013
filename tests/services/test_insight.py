"""What a plan shows, asked for as the window does."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.insight import insight, route_insight
from planning.errors import InfeasibleError, OperationCancelled
from planning.plan import FlightRules
from planning.reach_kernel import UNREACHABLE
from tests.planning.insight.cases import plan, prepared, reasons, scene


def test_a_plan_alone_is_prepared_and_explained():
    found = insight(scene("single-panel"), plan("single-panel"))
    given = insight(scene("single-panel"), plan("single-panel"), prepared("single-panel"), reasons("single-panel"))
    np.testing.assert_array_equal(found.counts, given.counts)
    np.testing.assert_array_equal(found.states, given.states)
    assert given.reasons is reasons("single-panel")
    assert (found.counts > 0).sum() == plan("single-panel").coverage.covered


def test_reasons_are_found_where_none_are_given():
    found = insight(scene("kiosk"), plan("kiosk"), prepared("kiosk"))
    explained = found.reasons.first_masks() > 0
    np.testing.assert_array_equal(explained, prepared("kiosk").problem.reachability.verdicts == UNREACHABLE)


def test_a_site_that_cannot_be_prepared_is_refused_in_words():
    model = scene("kiosk")
    model = replace(model, site=replace(model.site, home_enu_m=(0.0, 4.0, 0.0)))
    with pytest.raises(InfeasibleError, match="move it outside"):
        insight(model, plan("kiosk"))


def test_routes_have_a_clearance_and_a_profile_for_each_sortie():
    found = route_insight(scene("kiosk"), plan("kiosk"))
    for sortie, clearance, profile in zip(plan("kiosk").sorties, found.clearances, found.profiles, strict=True):
        assert clearance.solids.smallest_m >= 5.0 - 1e-4
        assert clearance.distance_m[-1] == pytest.approx(sortie.length_m, abs=0.01)
        assert profile.photo_ids == sortie.viewpoint_ids
        assert {found.things[thing].kind for thing in clearance.solids.thing} <= {"panel", "building", "obstacle"}


def test_in_a_storm_there_is_no_profile_but_still_a_clearance():
    stormy = replace(plan("kiosk"), rules=FlightRules(wind_m_s=40.0))
    found = route_insight(scene("kiosk"), stormy)
    assert found.profiles == (None,) * len(stormy.sorties)
    assert len(found.clearances) == len(stormy.sorties)


def test_a_plan_without_sorties_has_no_routes():
    found = route_insight(scene("kiosk"), replace(plan("kiosk"), sorties=()))
    assert (found.clearances, found.profiles) == ((), ())


def test_cancelling_ends_it():
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        insight(scene("kiosk"), plan("kiosk"), monitor=Cancelling())
    with pytest.raises(OperationCancelled):
        route_insight(scene("kiosk"), plan("kiosk"), Cancelling())
