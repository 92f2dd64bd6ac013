"""Views put together: no two places too close unless that costs coverage, nothing moved that need not be."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from planning.catalogue import profile
from planning.coverage.model import CoverageModel
from planning.coverage.sections import SectionGrid, panel_frames
from planning.optimise.problem import ViewProblem, take
from planning.optimise.restore import with_lost_restored
from planning.optimise.spacing import MAX_LOST, MAX_LOST_SHARE, MIN_SPACING_M, merge_close_views
from planning.plan import ViewpointArrays
from planning.positions import aimed_views, spread_positions
from planning.reachability import find_reachable
from planning.routing.roadmap import build_roadmap
from planning.site import panel_corners
from planning.space import free_space
from tests.planning.plan_cases import kiosk

Floats = NDArray[np.float64]


@functools.cache
def problem() -> ViewProblem:
    site_model = kiosk()
    space = free_space(site_model, 5.0)
    model = CoverageModel(panel_frames(panel_corners(site_model.site)), profile("m3e").camera, SectionGrid(30.0))
    return ViewProblem(model, space, find_reachable(model, space, stop=lambda: True), build_roadmap(space))


@functools.cache
def spread() -> Floats:
    return spread_positions(problem().space, problem().model.frames, 300, np.random.default_rng(0))


def clustered_views(seed: int, n_places: int, n_views: int, size_m: float) -> ViewpointArrays:
    """Views around a few places, `size_m` wide clusters, each aimed at a panel."""
    rng = np.random.default_rng(seed)
    places = spread()[rng.choice(len(spread()), n_places, replace=False)]
    positions = places[rng.integers(0, n_places, n_views)] + rng.normal(size=(n_views, 3)) * size_m / 2.0
    centroids = problem().model.frames.centroids
    return aimed_views(positions, centroids[rng.integers(0, len(centroids), n_views)], problem().model.camera)


def covered(views: ViewpointArrays) -> int:
    return problem().model.covered_count(views)


@given(seed=st.integers(0, 10_000), n_places=st.integers(1, 6), n_views=st.integers(1, 25))
@settings(max_examples=60)
def test_places_that_stay_close_are_worth_more_than_the_loss_allowed(seed: int, n_places: int, n_views: int) -> None:
    views = clustered_views(seed, n_places, n_views, 0.4)
    merged = merge_close_views(problem(), views)
    before, after = {tuple(p) for p in views.positions_enu_m}, {tuple(p) for p in merged.positions_enu_m}
    assert after <= before, "views move to where others stand"
    np.testing.assert_array_equal(merged.heading_rad, views.heading_rad)
    np.testing.assert_array_equal(merged.pitch_rad, views.pitch_rad)
    allowed = max(MAX_LOST, int(MAX_LOST_SHARE * covered(views)))
    assert covered(merged) >= covered(views) - allowed * (len(before) - len(after))
    moved = np.linalg.norm(merged.positions_enu_m - views.positions_enu_m, axis=1)
    assert moved[moved > 0.0].size == 0 or moved.max() < 3.0
    places = np.array(sorted(after))
    for a in range(len(places)):
        for b in range(len(places)):
            if a != b and np.linalg.norm(places[a] - places[b]) <= MIN_SPACING_M:
                put = merged.positions_enu_m.copy()
                put[(put == places[a]).all(axis=1)] = places[b]
                assert covered(merged._replace(positions_enu_m=put)) < covered(merged), "this move was for free"


def test_views_further_apart_stay_where_they_are() -> None:
    positions = np.array([[0.0, -20.0, 10.0], [0.51, -20.0, 10.0], [0.0, -20.51, 10.0]])
    views = aimed_views(positions, np.repeat(problem().model.frames.centroids[:1], 3, axis=0), problem().model.camera)
    np.testing.assert_array_equal(merge_close_views(problem(), views).positions_enu_m, positions)


def test_a_chain_of_places_is_thinned_and_never_gets_longer() -> None:
    positions = np.array([0.0, -20.0, 10.0]) + np.arange(8)[:, None] * [0.4, 0.0, 0.0]
    views = aimed_views(positions, np.repeat(problem().model.frames.centroids[4:5], 8, axis=0), problem().model.camera)
    merged = merge_close_views(problem(), views)
    places = np.unique(merged.positions_enu_m, axis=0)
    assert len(places) <= 4
    assert pdist(places).min() > MIN_SPACING_M


@pytest.mark.parametrize("n", [0, 1])
def test_none_and_one_view_are_fine(n: int) -> None:
    views = take(clustered_views(0, 1, 1, 0.1), np.arange(n))
    assert len(merge_close_views(problem(), views).heading_rad) == n


def test_the_caller_s_views_stay_as_they_are() -> None:
    views = clustered_views(3, 2, 12, 0.3)
    kept = views.positions_enu_m.copy()
    merge_close_views(problem(), views)
    np.testing.assert_array_equal(views.positions_enu_m, kept)


@given(seed=st.integers(0, 10_000), n_places=st.integers(1, 6), n_views=st.integers(2, 25))
@settings(max_examples=60)
def test_what_moving_lost_is_restored_from_places_of_its_own(seed: int, n_places: int, n_views: int) -> None:
    before = clustered_views(seed, n_places, n_views, 0.4)
    after = merge_close_views(problem(), before)
    restored = with_lost_restored(problem(), before, after)
    n = len(after.heading_rad)
    np.testing.assert_array_equal(restored.positions_enu_m[:n], after.positions_enu_m)
    assert len(restored.heading_rad) == n or covered(restored) > covered(after)
    for i in range(n, len(restored.heading_rad)):
        away_m = np.linalg.norm(restored.positions_enu_m[:i] - restored.positions_enu_m[i], axis=1)
        assert away_m.min() >= MIN_SPACING_M


def test_each_section_that_was_lost_gets_a_view_where_it_has_a_witness() -> None:
    """All views but the first are lost: whatever they showed and has a witness away from that one is shown again."""
    before = clustered_views(3, 6, 25, 20.0)
    after = take(before, np.array([0]))
    restored = with_lost_restored(problem(), before, after)
    witnesses = problem().reachability.witnesses_enu_m.reshape(-1, 3)
    is_far = np.linalg.norm(witnesses - after.positions_enu_m, axis=1) >= 1.0
    lost = problem().model.covered(before) & ~problem().model.covered(after)
    again = problem().model.covered(restored)
    assert lost.sum() > 20
    assert (lost & again).sum() >= 0.95 * (lost & is_far).sum()
