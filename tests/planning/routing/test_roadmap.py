"""The roadmap: certified edges, all of it joined to home, the column included, repeatable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from planning.routing.roadmap import Roadmap, build_roadmap, unique_pairs
from planning.site.bundled import SCENES
from planning.site.free_space import FreeSpace, free_space
from planning.site.records import Airspace
from tests.planning.plan_cases import dense_points, distances, inside_zone, kiosk, solid_triangles


def kiosk_space(distance_m: float = 5.0) -> FreeSpace:
    return free_space(kiosk(), distance_m)


def labels(roadmap: Roadmap) -> np.ndarray:
    n = len(roadmap.nodes_enu_m)
    edges = roadmap.edges
    return connected_components(coo_array((np.ones(len(edges)), edges.T), shape=(n, n)), directed=False)[1]


@pytest.mark.parametrize("scene", ["kiosk", "court", "canyon"])
def test_all_nodes_are_allowed_and_joined_to_the_first_above_home(scene: str) -> None:
    model = kiosk() if scene == "kiosk" else SCENES[scene]()
    space = free_space(model, 5.0)
    roadmap = build_roadmap(space)
    assert len(roadmap.nodes_enu_m) > 1000
    assert space.is_allowed(roadmap.nodes_enu_m).all()
    assert (labels(roadmap) == 0).all()
    np.testing.assert_array_equal(roadmap.nodes_enu_m[0], space.column_top_enu_m)
    above_home = roadmap.nodes_enu_m[: roadmap.n_column]
    np.testing.assert_array_equal(above_home[:, :2], np.broadcast_to(space.home_enu_m[:2], (roadmap.n_column, 2)))
    assert (np.diff(above_home[:, 2]) > 0.0).all()


def test_edges_keep_every_distance_along_their_whole_length() -> None:
    roadmap, model = build_roadmap(kiosk_space()), kiosk()
    rng = np.random.default_rng(0)
    triangles = solid_triangles(model)
    for a, b in roadmap.edges[rng.choice(len(roadmap.edges), 150, replace=False)]:
        points = dense_points(roadmap.nodes_enu_m[[a, b]], 0.2)
        assert distances(points, triangles).min() >= 5.0
        assert not any(inside_zone(points, zone).any() for zone in model.site.airspace.no_fly)


def test_nodes_above_home_are_joined_to_each_other_however_many_others_are_nearer() -> None:
    airspace = Airspace((-9.0, -14.0, 3.0), (9.0, -7.0, 40.0), ground_z_m=0.0)
    space = free_space(kiosk(airspace=airspace, home_enu_m=(0.0, -10.0, 0.0), obstacles=()), 2.0)
    roadmap = build_roadmap(space, n_spread=4000)
    edges = set(map(tuple, roadmap.edges.tolist()))
    assert roadmap.n_column > 5
    assert {(i, i + 1) for i in range(roadmap.n_column - 1)} <= edges


def test_the_column_ends_below_what_is_in_the_way() -> None:
    from planning.site.records import Obstacle

    bridge = Obstacle("bridge", box_enu_m=((-12.0, -40.0, 25.0), (12.0, -20.0, 27.0)))
    roadmap = build_roadmap(free_space(kiosk(obstacles=(bridge,)), 5.0))
    heights = roadmap.nodes_enu_m[: roadmap.n_column, 2]
    assert 15.0 < heights.max() <= 20.0, "5 m below the bridge, at the last of the steps of 4 m"


def test_without_any_other_node_home_alone_is_left() -> None:
    roadmap = build_roadmap(kiosk_space(), n_spread=0, n_shell=0)
    assert len(roadmap.nodes_enu_m) == roadmap.n_column
    assert (labels(roadmap) == 0).all()
    near, hidden = np.array([[3.0, -28.0, 10.0]]), np.array([[0.0, 20.0, 5.0]])
    assert roadmap.connected_to_home(np.concatenate([near, hidden])).tolist() == [True, False]
    assert roadmap.connected_to_home(np.zeros((0, 3))).shape == (0,)


def test_pairs_of_points_and_nodes_are_near_and_clear() -> None:
    roadmap = build_roadmap(kiosk_space())
    points = np.array([[0.0, -20.0, 10.0], [0.0, 14.0, 5.0]])
    pairs = roadmap.nearest_clear(points, 10)
    assert roadmap.space.legs_clear(points[pairs[:, 0]], roadmap.nodes_enu_m[pairs[:, 1]]).all()
    for i in (0, 1):
        nearest = np.argsort(np.linalg.norm(roadmap.nodes_enu_m - points[i], axis=1))[:10]
        assert set(pairs[pairs[:, 0] == i, 1]) <= set(nearest)


@given(n=st.integers(1, 9), data=st.data())
def test_pairs_are_in_order_and_each_once(n: int, data: st.DataObject) -> None:
    number = st.integers(0, n - 1)
    pairs = np.array(data.draw(st.lists(st.tuples(number, number))), dtype=np.int64).reshape(-1, 2)
    found = unique_pairs(pairs, n)
    assert found.dtype == np.int64
    np.testing.assert_array_equal(found, np.unique(pairs, axis=0))


def test_same_seed_same_roadmap() -> None:
    one, same, other = (build_roadmap(kiosk_space(), seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.nodes_enu_m, same.nodes_enu_m)
    np.testing.assert_array_equal(one.edges, same.edges)
    assert one.nodes_enu_m.shape != other.nodes_enu_m.shape or (one.nodes_enu_m != other.nodes_enu_m).any()


def test_a_larger_distance_leaves_fewer_places() -> None:
    near, far = (build_roadmap(kiosk_space(d)) for d in (2.0, 15.0))
    assert (near.space.solids.clearance_m(near.nodes_enu_m) >= 2.0).all()
    assert (far.space.solids.clearance_m(far.nodes_enu_m) >= 15.0).all()
    tight = replace(near.space, min_distance_m=15.0)
    assert not tight.is_allowed(near.nodes_enu_m).all()
