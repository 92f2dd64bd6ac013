"""Profiles of sorties: they fit the path, the plan's durations and the moments of the photos."""

from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InfeasibleError
from planning.insight.flight_profile import LOW_M, low_flight, lowest_flight, sortie_profile
from planning.parameters import FlightRules
from planning.plan import Sortie
from planning.site.ground import Ground
from tests.planning.insight.cases import plan


def planned():
    return plan("kiosk")


def profile_of(number=0, **changes):
    changed = replace(planned(), **changes)
    return sortie_profile(changed, changed.sorties[number])


@pytest.mark.parametrize("in_flight", [False, True])
@pytest.mark.parametrize("jerk", [None, 1.0])
def test_the_flight_passes_every_vertex_at_rest_and_takes_as_long_as_planned(in_flight, jerk):
    rules = FlightRules(turn_in_flight=in_flight)
    aircraft = replace(planned().aircraft, max_jerk_m_s3=jerk)
    found = profile_of(rules=rules, aircraft=aircraft)
    for times in (found.arrival_s, found.departure_s):
        at = found.at(times)
        np.testing.assert_allclose(at.positions_enu_m, found.vertices_enu_m, atol=1e-6)
        np.testing.assert_allclose(at.speed_m_s, 0.0, atol=1e-6)
    np.testing.assert_allclose(found.arrival_s[1:] - found.departure_s[:-1], found.ramps.duration_s, atol=1e-9)
    if not in_flight and jerk is None:
        assert found.duration_s + rules.takeoff_landing_s == pytest.approx(planned().sorties[0].duration_s, abs=0.01)
    assert found.at(found.departure_s[-1:]).distance_m[0] == pytest.approx(planned().sorties[0].length_m, abs=0.01)


def test_photos_are_taken_at_rest_at_their_viewpoints_after_settling():
    found = profile_of()
    by_id = {viewpoint.id: viewpoint for viewpoint in planned().viewpoints}
    at = found.at(found.photo_s)
    assert found.photo_ids == planned().sorties[0].viewpoint_ids
    for position, viewpoint_id in zip(at.positions_enu_m, found.photo_ids, strict=True):
        assert position == pytest.approx(by_id[viewpoint_id].position_enu_m, abs=1e-4)
    np.testing.assert_allclose(at.speed_m_s, 0.0, atol=1e-9)
    stop = np.searchsorted(found.departure_s, found.photo_s)
    waited = found.photo_s - found.arrival_s[stop]
    assert (waited >= planned().rules.settle_s - 1e-9).all()
    np.testing.assert_allclose(found.departure_s[stop] - found.photo_s, planned().rules.photo_s)


def test_samples_rise_in_time_and_hold_the_top_speed_of_every_leg():
    found = profile_of()
    samples = found.samples()
    assert (np.diff(samples.t_s) > 0.0).all()
    assert (np.diff(samples.distance_m) >= -1e-9).all()
    for leg in range(len(found.ramps.peak_m_s)):
        within = (samples.t_s >= found.departure_s[leg]) & (samples.t_s <= found.arrival_s[leg + 1])
        assert samples.speed_m_s[within].max() == pytest.approx(found.ramps.peak_m_s[leg])
    fine = found.at(np.linspace(0.0, found.duration_s, 20_000))
    drawn = np.interp(fine.t_s, samples.t_s, samples.speed_m_s)
    assert np.abs(drawn - fine.speed_m_s).max() <= 0.04 * samples.speed_m_s.max() + 1e-6


def test_how_low_a_sortie_flies_is_what_a_fine_sampling_of_it_finds():
    found, sortie, ground_m = profile_of(), planned().sorties[0], -1.5
    home = sortie.path_enu_m[0]
    low = low_flight(planned(), sortie, home, Ground(ground_m))
    t_s = np.linspace(0.0, found.duration_s, 400_001)
    at = found.at(t_s)
    beside = np.linalg.norm(at.positions_enu_m[:, :2] - home[:2], axis=1) > 1e-3
    heights = at.heights_m(ground_m)
    assert low.lowest_m == pytest.approx(heights[beside].min(), abs=1e-3)
    assert low.below_s == pytest.approx((beside & (heights < LOW_M)).mean() * found.duration_s, rel=0.01, abs=0.1)
    assert 0.0 < low.below_s < low.duration_s == pytest.approx(found.duration_s)
    together = lowest_flight(planned(), home, Ground(ground_m))
    each = [low_flight(planned(), other, home, Ground(ground_m)) for other in planned().sorties]
    assert together.below_s == pytest.approx(sum(other.below_s for other in each))
    assert together.lowest_m == min(other.lowest_m for other in each)


def test_a_sortie_that_only_goes_up_and_down_does_not_fly_low_and_an_untimed_one_says_how_low():
    home = planned().home_enu_m
    up = Sortie((), (home, (home[0], home[1], 30.0), home), 60.0, 60.0)
    assert low_flight(planned(), up, home, Ground(0.0)) is None
    assert lowest_flight(replace(planned(), sorties=(up,), viewpoints=()), home, Ground(0.0)) is None
    aside = Sortie((), (home, (home[0] + 5.0, home[1], 30.0), home), 60.0, 60.0)
    assert low_flight(planned(), aside, home, Ground(-2.0)).lowest_m == home[2] + 2.0
    still = replace(planned(), rules=FlightRules(wind_m_s=50.0))
    low = low_flight(still, still.sorties[0], home, Ground(0.0))
    assert low.lowest_m >= 5.0
    assert low.below_s is low.duration_s is None


def test_heights_are_measured_from_the_level_asked_for():
    found = profile_of()
    at = found.at(found.arrival_s)
    np.testing.assert_allclose(at.heights_m(2.5), found.vertices_enu_m[:, 2] - 2.5, atol=1e-6)


def test_times_before_and_after_the_flight_are_at_home():
    found = profile_of()
    at = found.at(np.array([-5.0, found.duration_s + 5.0]))
    np.testing.assert_allclose(at.positions_enu_m, found.vertices_enu_m[[0, -1]], atol=1e-6)
    np.testing.assert_allclose(at.speed_m_s, 0.0, atol=1e-6)


def test_paths_without_legs_or_without_their_viewpoints_have_no_profile():
    sortie = planned().sorties[0]
    assert profile_of(sorties=(Sortie((), (), 0.0, 0.0),), viewpoints=()) is None
    assert profile_of(sorties=(replace(sortie, path_enu_m=sortie.path_enu_m[:2]),)) is None


def test_a_storm_is_refused_in_words():
    with pytest.raises(InfeasibleError, match="wait for less wind"):
        profile_of(rules=FlightRules(wind_m_s=30.0))
