"""Naming what is near and what is in the way: against a search through all triangles."""

import numpy as np
import pytest

from planning.insight.obstructions import (
    Obstruction,
    first_obstructions_hit,
    nearest_obstructions,
    nearest_triangles,
    obstructions_of,
)
from planning.site.free_space import unchecked_space
from tests.planning.insight.cases import scene
from tests.planning.plan_cases import distances, kiosk, lines_free

MODEL = kiosk()
SPACE = unchecked_space(MODEL, 5.0)
OBSTRUCTIONS = obstructions_of(MODEL, SPACE)
N_PANELS = 15


def triangles_of(number):
    """Triangles of one thing of the kiosk, from the site itself."""
    if number < N_PANELS:
        return np.array(MODEL.site.panels[number].corners_enu_m)[[[0, 1, 2], [0, 2, 3]]]
    if number == N_PANELS:
        return MODEL.building.corners_enu_m
    return (
        MODEL.obstacles[0].corners_enu_m
        if number == N_PANELS + 1
        else MODEL.site.airspace.no_fly[0].prism().corners_enu_m
    )


def test_things_are_panels_building_obstacles_and_no_fly_volumes_in_order():
    assert [str(obstruction) for obstruction in OBSTRUCTIONS.all[N_PANELS - 1 :]] == [
        "panel 'B-0005'",
        "the building",
        "obstacle 'tree'",
        "no-fly volume 'road'",
    ]
    assert OBSTRUCTIONS.all[0] == Obstruction("panel", "A-0000")
    assert set(OBSTRUCTIONS.no_fly_owner) == {N_PANELS + 2}


def test_the_nearest_thing_is_the_first_of_those_at_the_least_distance():
    points = np.random.default_rng(0).uniform([-40, -40, 0], [40, 40, 40], (300, 3))
    apart = np.stack([distances(points, triangles_of(number)) for number in range(N_PANELS + 2)])
    expected = np.argmax(apart <= apart.min(axis=0) + 1e-7, axis=0)
    found = nearest_obstructions(SPACE.solids, OBSTRUCTIONS.solid_owner, points)
    np.testing.assert_array_equal(found, expected)
    assert {0, N_PANELS, N_PANELS + 1} <= set(found)


def test_the_nearest_triangle_of_a_segment_is_as_near_as_the_segment_comes():
    rng = np.random.default_rng(1)
    a, b = rng.uniform([-30, -30, 0], [30, 30, 30], (2, 60, 3))
    triangle = nearest_triangles(SPACE.solids, OBSTRUCTIONS.solid_owner, a, b)
    along = np.linspace(0.0, 1.0, 2001)[:, None]
    exact = SPACE.solids.segment_distances_m(a, b)
    for i in range(len(a)):
        points = a[i] + along * (b[i] - a[i])
        sampled = distances(points, SPACE.solids.bvh.corners[triangle[i]][None]).min()
        assert exact[i] - 1e-9 <= sampled <= exact[i] + 0.03


def test_the_first_thing_hit_is_the_one_whose_hit_lies_nearest_to_the_start():
    rng = np.random.default_rng(2)
    a = rng.uniform([-20, -20, 0], [20, -2, 20], (200, 3))
    b = rng.uniform([-20, 2, 0], [20, 20, 12], (200, 3))
    found = first_obstructions_hit(SPACE.solids, OBSTRUCTIONS.solid_owner, a, b)
    free = lines_free(a, b, np.concatenate([triangles_of(number) for number in range(N_PANELS + 2)]))
    np.testing.assert_array_equal(found == -1, free)
    for i in np.flatnonzero(found >= 0)[::5]:
        # Shortened step by step, the line stays blocked as long as the first thing still stands in it.
        parts = np.linspace(0.0, 1.0, 400)
        ends = a[i] + parts[:, None] * (b[i] - a[i])
        starts = np.broadcast_to(a[i], ends.shape)
        reached = [lines_free(starts, ends, triangles_of(number)).sum() for number in range(N_PANELS + 2)]
        assert found[i] == np.argmin(reached)


def test_space_of_another_site_is_refused():
    with pytest.raises(ValueError, match="expected the space of this site"):
        obstructions_of(scene("single-panel"), SPACE)


def test_without_any_triangle_nothing_is_near():
    bare = scene("single-panel")
    space = unchecked_space(bare, 5.0)
    obstructions = obstructions_of(bare, space)
    assert nearest_obstructions(space.no_fly, obstructions.no_fly_owner, np.zeros((2, 3))).tolist() == [-1, -1]
    assert first_obstructions_hit(
        space.no_fly, obstructions.no_fly_owner, np.zeros((1, 3)), np.ones((1, 3))
    ).tolist() == [-1]
