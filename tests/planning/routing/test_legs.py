"""Legs around obstacles: clear along their whole length, tight, alike both ways, and close to the shortest there is."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, OperationCancelled
from planning.geo.mesh import box_mesh, empty_mesh
from planning.motion.timing import motion_limits, round_trip_metric
from planning.parameters import FlightRules
from planning.routing import legs
from planning.routing.legs import MIN_SPACING_M, LegTable, build_leg_table
from planning.routing.roadmap import build_roadmap, leg_length
from planning.site.bundled import ORIGIN, SCENES, panel_grid
from planning.site.free_space import LEG_MARGIN_M, free_space
from planning.site.records import Airspace, Obstacle, Site, SiteModel, box_geometry
from tests.planning.plan_cases import dense_points, distances, inside_zone, kiosk, solid_triangles
from tests.planning.routing_cases import Counting

Floats = NDArray[np.float64]

DISTANCE_M = 5.0


def block() -> SiteModel:
    """A block of 20 x 12 m that rises out of the airspace: ways around it lie in one plane."""
    facade = panel_grid("A", ((-10.0, -6.0, 0.0), (10.0, -6.0, 0.0), (-10.0, -6.0, 30.0)), 3, 4)
    airspace = Airspace((-60.0, -60.0, 3.0), (60.0, 60.0, 40.0), ground_z_m=0.0)
    site = Site("block", ORIGIN, (facade,), airspace, (0.0, -45.0, 0.0), "block.ply")
    return SiteModel(site, box_mesh(np.array([-10.0, -6.0, 0.0]), np.array([10.0, 6.0, 60.0])))


def shortest_around_block(a: Floats, b: Floats, distance_m: float) -> float:
    """Exact: around a convex region the shortest way follows the hull of the region and both ends."""
    region = shapely.box(-10.0, -6.0, 10.0, 6.0).buffer(distance_m, quad_segs=512)
    if not shapely.LineString([a, b]).crosses(region):
        return float(np.linalg.norm(a - b))
    ring = shapely.union(region, shapely.MultiPoint([a, b])).convex_hull.exterior
    apart = abs(ring.project(shapely.Point(a)) - ring.project(shapely.Point(b)))
    return float(min(apart, ring.length - apart))


def allowed_stops(model: SiteModel, n: int, distance_m: float = DISTANCE_M, height_m: float | None = None) -> Floats:
    space = free_space(model, distance_m)
    rng = np.random.default_rng(3)
    points = rng.uniform(space.low_enu_m, space.high_enu_m, (20 * n, 3))
    if height_m is not None:
        points[:, 2] = height_m
    return points[space.is_allowed(points)][:n]


@functools.cache
def table_of(scene: str, n: int = 14) -> LegTable:
    model = kiosk() if scene == "kiosk" else block() if scene == "block" else SCENES[scene]()
    stops = allowed_stops(model, n, height_m={"block": 20.0, "kiosk": 6.0}.get(scene))
    return build_leg_table(build_roadmap(free_space(model, DISTANCE_M)), stops, leg_length)


def drawn(table: LegTable) -> Floats:
    """Lengths of all polylines, shape (n + 1, n + 1)."""
    n = len(table.points_enu_m)
    return np.array([[leg_length(np.diff(table.polyline(i, j), axis=0)).sum() for j in range(n)] for i in range(n)])


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["kiosk", "block"])
def test_every_point_of_every_leg_keeps_every_distance_and_ways_around_are_tight(scene: str) -> None:
    table, model = table_of(scene), kiosk() if scene == "kiosk" else block()
    triangles, airspace = solid_triangles(model), model.site.airspace
    nearest = []
    for start in range(len(table.points_enu_m)):
        for end in range(start):
            path = table.polyline(start, end)
            points = dense_points(path, 0.2)
            clearance = float(distances(points, triangles).min())
            assert clearance >= DISTANCE_M
            assert not any(inside_zone(points, zone).any() for zone in airspace.no_fly)
            above = points[points[:, 2] >= 5.0]
            assert (above >= airspace.min_enu_m).all()
            assert (points <= airspace.max_enu_m).all()
            if len(path) > 2 and end > 0:
                nearest.append(clearance)
    assert len(nearest) > 5
    assert min(nearest) < DISTANCE_M + 0.3, "something is in the way, so the shortest way passes close to it"


@pytest.mark.parametrize("scene", ["block", "court"])
def test_legs_not_looked_at_in_time_become_ways_over_shorter_ones(scene: str, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = table_of(scene)
    monkeypatch.setattr(legs, "PAIRS_PER_STEP", 30)
    cut = build_leg_table(whole.roadmap, whole.points_enu_m[1:], leg_length, stop=lambda: True)
    assert np.isfinite(cut.cost).all()
    assert (cut.cost >= whole.cost - 1e-9).all()
    assert np.median(cut.cost[1:, 1:] / np.maximum(whole.cost[1:, 1:], 1e-9)) < 1.3
    triangles = solid_triangles(block() if scene == "block" else SCENES[scene]())
    for start, end in [(1, 3), (2, 9), (4, 11)]:
        assert float(distances(dense_points(cut.polyline(start, end), 0.3), triangles).min()) >= DISTANCE_M


@pytest.mark.long
@pytest.mark.parametrize("scene", ["block", "court"])
@pytest.mark.parametrize("n_asked", [0, 1, 3])
def test_in_a_hurry_ways_are_found_all_the_same_and_are_no_longer_than_was_said(
    scene: str, n_asked: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = table_of(scene)
    for name, value in {"PAIRS_PER_STEP": 30, "ROWS_PER_STEP": 2, "STOPS_PER_STEP": 5}.items():
        monkeypatch.setattr(legs, name, value)
    searches: list[int] = []

    def counted(*arguments: Any, **named: Any) -> Any:
        searches.append(1)
        return dijkstra(*arguments, **named)

    monkeypatch.setattr(legs, "dijkstra", counted)
    hurry = Counting(n_asked)
    cut = build_leg_table(whole.roadmap, whole.points_enu_m[1:], leg_length, stop=lambda: True, hurry=hurry)
    assert len(searches) == max(1, n_asked - 2)  # of blocks: two are joined to hubs before
    assert np.isfinite(cut.cost).all()
    np.testing.assert_array_equal(cut.cost, cut.cost.T)
    assert (drawn(cut) <= cut.cost + 1e-6).all()
    assert np.median(cut.cost[0, 1:] / whole.cost[0, 1:]) < 1.3
    triangles = solid_triangles(block() if scene == "block" else SCENES[scene]())
    for start, end in [(0, 1), (2, 9), (4, 11)]:
        assert float(distances(dense_points(cut.polyline(start, end), 0.3), triangles).min()) >= DISTANCE_M


@pytest.mark.parametrize("scene", ["kiosk", "block", "court"])
def test_a_part_of_a_table_has_the_same_legs(scene: str) -> None:
    table, kept = table_of(scene), np.array([11, 2, 7, 2])
    part = table.part(table.points_enu_m[kept])
    both = np.array([0, *kept])
    np.testing.assert_array_equal(part.cost, table.cost[np.ix_(both, both)])
    np.testing.assert_array_equal(part.points_enu_m, table.points_enu_m[both])
    for start, end in itertools.product(range(len(both)), repeat=2):
        if both[start] != both[end]:
            np.testing.assert_array_equal(part.polyline(start, end), table.polyline(both[start], both[end]))
        assert np.array_equal(part.polyline(start, end), part.polyline(end, start)[::-1])
    np.testing.assert_array_equal(part.part(table.points_enu_m[[7]]).polyline(0, 1), table.polyline(0, 7))
    with pytest.raises(ValueError, match="stops of the table"):
        table.part(table.points_enu_m[[3]] + 0.001)


@pytest.mark.parametrize("scene", ["kiosk", "block", "court"])
def test_costs_and_polylines_are_the_same_in_both_directions(scene: str) -> None:
    table = table_of(scene)
    np.testing.assert_array_equal(table.cost, table.cost.T)
    for start, end in [(0, 3), (2, 9), (5, 1), (7, 4)]:
        np.testing.assert_array_equal(table.polyline(start, end), table.polyline(end, start)[::-1])


@pytest.mark.parametrize("scene", ["kiosk", "block", "court"])
def test_a_straight_leg_costs_its_length_and_a_way_around_at_least_what_is_flown(scene: str) -> None:
    table = table_of(scene)
    length, straight = drawn(table), leg_length((table.points_enu_m[:, None] - table.points_enu_m).reshape(-1, 3))
    straight = straight.reshape(length.shape)
    is_straight = np.isclose(length, straight, atol=1e-9)
    assert 0.2 < is_straight[1:, 1:].mean() < 1.0
    np.testing.assert_allclose(table.cost[is_straight], straight[is_straight], atol=1e-6)
    assert (table.cost >= length - 1e-6).all()
    around = table.cost[~is_straight] / length[~is_straight]
    assert np.median(around) < 1.05
    assert around.max() < 1.6
    # Home is left straight up: no way from it is shorter than the column and the straight line from its top.
    top = table.roadmap.space.column_top_enu_m
    least = top[2] - table.points_enu_m[0, 2] + np.linalg.norm(table.points_enu_m[1:] - top, axis=1)
    sideways = np.linalg.norm((table.points_enu_m[1:] - top)[:, :2], axis=1)
    assert (length[0, 1:] >= np.hypot(sideways, table.points_enu_m[1:, 2] - table.points_enu_m[0, 2]) - 1e-9).all()
    assert np.median(length[0, 1:] / least) < 1.03


@pytest.mark.slow
def test_ways_around_a_block_are_close_to_the_shortest_there_is() -> None:
    stops = allowed_stops(block(), 40, height_m=20.0)
    table = build_leg_table(build_roadmap(free_space(block(), DISTANCE_M)), stops, leg_length)
    ratios = []
    for start in range(1, len(stops) + 1):
        for end in range(1, start):
            shortest = shortest_around_block(*stops[[start - 1, end - 1], :2], DISTANCE_M)
            path = table.polyline(start, end)
            flown = float(leg_length(np.diff(path, axis=0)).sum())
            assert flown >= shortest - 1e-3
            if len(path) > 2:
                ratios.append(flown / shortest)
    assert len(ratios) > 100
    assert np.median(ratios) < 1.03
    assert np.percentile(ratios, 90) < 1.08
    assert max(ratios) < 1.25


@pytest.mark.parametrize("gap_m", [-1e-4, 1e-4])
def test_a_leg_is_straight_where_it_just_keeps_the_distance_and_not_where_it_just_does_not(gap_m: float) -> None:
    y = -6.0 - DISTANCE_M - LEG_MARGIN_M - gap_m
    stops = np.array([[-30.0, y, 20.0], [30.0, y, 20.0]])
    table = build_leg_table(build_roadmap(free_space(block(), DISTANCE_M)), stops, leg_length)
    assert len(table.polyline(1, 2)) == (2 if gap_m > 0.0 else 3)


def test_flights_begin_and_end_in_the_column_above_home() -> None:
    table = table_of("kiosk")
    home, low = table.points_enu_m[0], table.roadmap.space.low_enu_m
    for stop in range(1, len(table.points_enu_m)):
        path = table.polyline(0, stop)
        np.testing.assert_array_equal(path[0], home)
        np.testing.assert_array_equal(path[1, :2], home[:2])
        assert path[1, 2] >= low[2]
        assert path[1, 2] - home[2] >= 2.0
        np.testing.assert_array_equal(path[-1], table.points_enu_m[stop])


@pytest.mark.slow
def test_pulling_a_way_tight_does_not_crowd_its_waypoints(monkeypatch: pytest.MonkeyPatch) -> None:
    # Around a corner, a centimetre off the distance kept, ways would end in vertices a few centimetres from the stops.
    angle = np.radians(np.linspace(185.0, 265.0, 9))
    ring = np.array([-6.0, 0.0]) + (DISTANCE_M + 0.01) * np.c_[np.cos(angle), np.sin(angle)]
    stops = np.concatenate([np.c_[ring, np.full(9, 5.0)], allowed_stops(kiosk(), 8)])
    table = build_leg_table(build_roadmap(free_space(kiosk(), DISTANCE_M)), stops, leg_length)

    def shortest_legs() -> Floats:
        ways = [table.polyline(start, end) for start in range(2, len(stops) + 1) for end in range(1, start)]
        return np.array([leg_length(np.diff(way, axis=0)).min() for way in ways if len(way) > 2])

    spaced = shortest_legs()
    monkeypatch.setattr("planning.routing.legs.MIN_SPACING_M", 0.0)
    crowded = shortest_legs()
    assert len(spaced) > 20
    assert crowded.min() < 0.2
    assert spaced.min() > 0.3, "nodes of the roadmap that lie there anyway"
    assert (spaced < MIN_SPACING_M).sum() < (crowded < MIN_SPACING_M).sum()


@pytest.mark.slow
def test_in_flight_time_ways_have_few_stops_and_legs_from_home_cost_what_they_take() -> None:
    metric = round_trip_metric(motion_limits(profile("m3e").aircraft, FlightRules()))
    for scene in ("court", "canyon"):
        model = SCENES[scene]()
        table = build_leg_table(build_roadmap(free_space(model, 10.0)), allowed_stops(model, 25, 10.0), metric)
        flown = [[metric(np.diff(table.polyline(i, j), axis=0)).sum() for j in range(i)] for i in range(26)]
        n_vertices = [len(table.polyline(i, j)) for i in range(26) for j in range(i)]
        ratio = np.array([table.cost[i, j] / flown[i][j] for i in range(26) for j in range(i)])
        from_home = np.array([table.cost[i, 0] / flown[i][0] for i in range(1, 26)])
        assert max(n_vertices) <= 6
        assert ratio.min() > 1.0 - 1e-9
        assert np.mean(ratio) < 1.05
        assert np.median(from_home) < 1.01
        assert from_home.max() < 1.2


def room() -> SiteModel:
    """The block with a closed hall of 40 x 40 x 30 m beside it, walls 1 m thick: inside there is air, but no way in."""
    low, high = np.array([15.0, 15.0, 0.0]), np.array([55.0, 55.0, 32.0])
    walls = []
    for axis, end in [(0, low), (0, high - 1.0), (1, low), (1, high - 1.0), (2, high - 1.0), (2, low)]:
        a, b = low.copy(), high.copy()
        a[axis], b[axis] = end[axis], end[axis] + 1.0
        walls.append(Obstacle(f"wall {len(walls)}", box_enu_m=(tuple(a.tolist()), tuple(b.tolist()))))  # type: ignore[arg-type]
    site = replace(block().site, obstacles=tuple(walls), building_mesh=None)
    return SiteModel(site, empty_mesh(), tuple(box_geometry(wall) for wall in walls))


def test_a_stop_without_any_way_to_it_is_told_with_its_place_and_what_to_do() -> None:
    space = free_space(room(), DISTANCE_M)
    stops = np.array([[35.0, 35.0, 16.0], [36.0, 30.0, 20.0], [-30.0, -30.0, 20.0]])
    assert space.is_allowed(stops).all()
    roadmap = build_roadmap(space)
    assert roadmap.connected_to_home(stops).tolist() == [False, False, True]
    table = build_leg_table(roadmap, stops, leg_length)
    assert np.isinf(table.cost[0]).tolist() == [False, True, True, False]
    assert table.cost[1, 2] == pytest.approx(math.sqrt(1.0 + 25.0 + 16.0))
    with pytest.raises(
        InfeasibleError, match=r"no way from \(0\.0, -45\.0, 0\.0\) to \(35\.0, 35\.0, 16\.0\) m .* 5 m"
    ):
        table.polyline(0, 1)


def test_a_stop_whose_nearest_nodes_are_all_hidden_is_still_reached() -> None:
    """A stop beside a thin wall: everything near it lies behind the wall, what can be seen from it is further away."""
    airspace = Airspace((-60.0, -60.0, 3.0), (60.0, 60.0, 40.0), ground_z_m=0.0)
    wall = Obstacle("wall", box_enu_m=((20.0, -59.0, 0.0), (20.1, 59.9, 80.0)))
    facade = panel_grid("A", ((-3.0, 0.0, 5.0), (3.0, 0.0, 5.0), (-3.0, 0.0, 9.0)), 1, 1)
    site = Site("thin", ORIGIN, (facade,), airspace, (0.0, -45.0, 0.0), None, (wall,))
    space = free_space(SiteModel(site, empty_mesh(), (box_geometry(wall),)), 0.5)
    roadmap = build_roadmap(space, n_spread=200, n_shell=0)
    stop = np.array([[19.0, 0.0, 20.0]])
    crowded = _with_nodes_behind(roadmap, stop, n=40)
    assert (crowded.nodes_enu_m[crowded.tree.query(stop[0], 30)[1], 0] > 20.0).all()
    assert crowded.connected_to_home(stop).all()
    table = build_leg_table(crowded, stop, leg_length)
    assert np.isfinite(table.cost).all()
    assert len(table.polyline(0, 1)) >= 3


def _with_nodes_behind(roadmap, stop: Floats, n: int):  # type: ignore[no-untyped-def]
    """The roadmap with `n` more nodes just behind the wall, joined to a node there."""
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(0)
    extra = stop + np.c_[np.full(n, 1.8), rng.uniform(-0.3, 0.3, (n, 2))]
    nodes = np.concatenate([roadmap.nodes_enu_m, extra])
    anchor = int(np.argmax(np.where(roadmap.nodes_enu_m[:, 0] > 21.0, -np.abs(roadmap.nodes_enu_m[:, 1]), -np.inf)))
    first = len(roadmap.nodes_enu_m)
    joined = np.c_[np.full(n, anchor), first + np.arange(n)]
    return replace(roadmap, nodes_enu_m=nodes, edges=np.concatenate([roadmap.edges, joined]), tree=cKDTree(nodes))


def test_no_stops_and_stops_at_one_place_are_fine() -> None:
    roadmap = build_roadmap(free_space(kiosk(), DISTANCE_M))
    assert build_leg_table(roadmap, np.zeros((0, 3)), leg_length).cost.shape == (1, 1)
    stops = np.repeat([[0.0, -20.0, 12.0]], 3, axis=0)
    table = build_leg_table(roadmap, stops, leg_length)
    assert (table.cost[1:, 1:] == 0.0).all()
    assert table.polyline(1, 2).tolist() == stops[:2].tolist()
    assert len(table.polyline(1, 1)) == 1


def test_cancelling_comes_through() -> None:
    class Cancelling:
        def report(self, stage: str, done: float, total: float) -> None:
            raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        build_leg_table(
            build_roadmap(free_space(kiosk(), 5.0)), np.array([[0.0, -20.0, 9.0]]), leg_length, Cancelling()
        )
