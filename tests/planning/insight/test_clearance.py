"""Clearance along routes: against dense samples by a slow twin, and at the edges."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.insight.clearance import MAX_SAMPLES, route_clearance
from planning.insight.obstructions import obstructions_of
from planning.plan import Sortie
from planning.site.free_space import unchecked_space
from tests.planning.insight.cases import plan, scene
from tests.planning.plan_cases import dense_points, distances, kiosk, solid_triangles

MODEL = kiosk()
SPACE = unchecked_space(MODEL, 5.0)
OBSTRUCTIONS = obstructions_of(MODEL, SPACE)


def along(*points, spacing_m=0.5):
    return route_clearance(Sortie((), tuple(points), 0.0, 0.0), SPACE, OBSTRUCTIONS, spacing_m)


point = st.tuples(st.floats(-38, 38), st.floats(-38, -0.5), st.floats(0.5, 30))


@pytest.mark.slow
@settings(max_examples=40)
@given(st.lists(point, min_size=2, max_size=6))
def test_samples_and_minima_are_those_of_a_slow_twin(points):
    found = along(*points, spacing_m=2.0)
    triangles = solid_triangles(MODEL)
    inside_nothing = found.solids.clearance_m >= 0.0
    np.testing.assert_allclose(np.abs(found.solids.clearance_m), distances(found.positions_enu_m, triangles), atol=1e-9)
    path = np.array(points)
    for leg in range(len(points) - 1):
        dense = distances(dense_points(path[leg : leg + 2], 0.1), triangles).min()
        if inside_nothing[found.leg == leg].all():
            assert dense - 0.1 <= found.solids.leg_minimum_m[leg] <= dense + 1e-6
    if inside_nothing.all():
        exact = SPACE.solids.segment_distances_m(path[:-1], path[1:])
        np.testing.assert_allclose(found.solids.leg_minimum_m, exact, atol=1e-5)
    assert found.solids.smallest_m == found.solids.leg_minimum_m.min()


@given(st.lists(point, min_size=1, max_size=5))
def test_samples_follow_the_path_and_are_close_together(points):
    found = along(*points)
    path = np.array(points)
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert found.distance_m[0] == 0.0
    assert found.distance_m[-1] == pytest.approx(lengths.sum(), abs=1e-9)
    steps = np.diff(found.distance_m)
    assert (steps >= -1e-9).all()
    assert steps.max(initial=0.0) <= 0.5 + 1e-9
    moved = np.linalg.norm(np.diff(found.positions_enu_m, axis=0), axis=1)
    assert (moved <= steps + 1e-6).all()
    for value in (found.solids.clearance_m, found.no_fly.clearance_m, found.positions_enu_m):
        assert np.isfinite(value).all()


def test_a_flight_past_the_tree_names_it_and_the_place_where_it_is_nearest():
    found = along((-10.0, -20.0, 5.0), (30.0, -20.0, 5.0))
    # The tree reaches from x 18 to 21 and to y -14: 6 m away.
    assert found.solids.leg_minimum_m == pytest.approx([6.0])
    assert OBSTRUCTIONS.all[found.solids.leg_obstruction[0]].id == "tree"
    nearest = int(np.argmin(found.solids.clearance_m))
    assert 28.0 - 1e-6 <= found.distance_m[nearest] <= 31.0 + 1e-6
    assert {OBSTRUCTIONS.all[i].kind for i in found.solids.obstruction} == {"panel", "obstacle"}


def test_a_leg_that_slants_past_an_edge_has_a_sample_at_its_nearest_point():
    # Nearest to the tree's upper edge x = 18, z = 11 between two samples.
    found = along((12.0, -12.5, 8.0), (19.0, -12.5, 19.3))
    direction = np.array([7.0, 11.3]) / np.hypot(7.0, 11.3)
    expected = abs((18.0 - 12.0) * direction[1] - (11.0 - 8.0) * direction[0])
    assert found.solids.leg_minimum_m[0] == pytest.approx(expected, abs=1e-9)
    assert found.solids.clearance_m.min() == pytest.approx(expected, abs=1e-9)


def test_legs_into_the_building_and_the_no_fly_volume_have_negative_clearance():
    found = along((0.0, -10.0, 4.0), (0.0, 4.0, 4.0), (-30.0, 4.0, 4.0))
    assert found.solids.leg_minimum_m[0] == pytest.approx(-4.0, abs=0.01)
    assert found.solids.smallest_m < -3.9
    # The zone reaches from the ground up: 4 m below the path.
    assert found.no_fly.leg_minimum_m[1] == pytest.approx(-4.0, abs=1e-6)
    assert {OBSTRUCTIONS.all[i].id for i in found.no_fly.obstruction} == {"road"}
    assert (found.no_fly.clearance_m[found.leg == 0] > 0.0).all()


@pytest.mark.long
def test_sites_without_no_fly_volumes_have_no_clearance_from_them():
    bare = scene("single-panel")
    space = unchecked_space(bare, 5.0)
    found = route_clearance(plan("single-panel").sorties[0], space, obstructions_of(bare, space))
    assert found.no_fly is None
    assert found.solids.smallest_m >= 5.0 - 1e-4


@pytest.mark.slow
def test_the_smallest_clearance_of_a_plan_is_the_one_its_check_measures():
    for sortie in plan("kiosk").sorties:
        found = route_clearance(sortie, SPACE, OBSTRUCTIONS)
        path = np.array(sortie.path_enu_m)
        expected = SPACE.solids.segment_distances_m(path[:-1], path[1:])
        np.testing.assert_allclose(found.solids.leg_minimum_m, expected, atol=1e-6)


def test_paths_of_no_or_one_vertex_and_legs_of_no_length_are_measured_where_they_are():
    nowhere = along()
    assert len(nowhere.distance_m) == 0
    assert np.isnan(nowhere.solids.smallest_m)
    for points in (((0.0, -10.0, 5.0),), ((0.0, -10.0, 5.0),) * 3):
        found = along(*points)
        assert found.solids.clearance_m == pytest.approx(10.0)
        assert found.distance_m == pytest.approx(0.0)


@pytest.mark.slow
def test_very_long_flights_are_sampled_more_coarsely_but_keep_their_minima():
    found = along((-19_000.0, -8.0, 5.0), (19_000.0, -8.0, 5.0))
    assert len(found.distance_m) <= MAX_SAMPLES + 5
    # The tree's near side is at y -11.
    assert found.solids.leg_minimum_m == pytest.approx([3.0], abs=1e-6)


def test_a_spacing_of_nothing_is_refused():
    with pytest.raises(ValueError, match="spacing_m: expected more than 0"):
        along((0.0, 0.0, 20.0), (1.0, 0.0, 20.0), spacing_m=0.0)
