"""Obstacle-avoiding legs between stops: costs of all pairs, and the polyline of each leg that is really flown.

Where the straight leg between two stops keeps every distance it is flown; elsewhere the way leads over the roadmap and
is then pulled tight. Every leg is certified on its whole length, not sampled.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from planning.base.errors import InfeasibleError
from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, never
from planning.routing.roadmap import MOST_NEIGHBOURS, LegMetric, Roadmap, unique_pairs

Array = NDArray[np.float64]

ROADMAP_NEIGHBOURS = 16
N_HUBS = 100
"""Nodes spread over the roadmap to which every stop is joined where a clear leg leads there, beside all nodes above
home. With the nearest nodes alone, ways are made of many short legs: on office, court and canyon flights from home took
7 to 13 % longer and ways around 2 to 4 % (mean), and the table had the former 18 to 32 % too long (median), now 0 %."""

MIN_SPACING_M = 0.5
"""Smallest distance between waypoints that DJI's firmware accepts (Payload SDK, waypoint errors)."""

PAIRS_PER_STEP = 20_000
ROWS_PER_STEP = 8
"""Shortest ways are searched from so many stops at a time: SciPy holds the interpreter's lock for 1 to 2 ms each."""
TIGHTEN_ROUNDS = 12

N_TRIED_LEGS = 400
"""Legs on which it is measured how long one takes."""


@dataclass(frozen=True, slots=True, eq=False)
class LegTable:
    """Costs between home (index 0) and stops (1 to n), and what is needed to draw the legs.

    Parameters
    ----------
    points_enu_m
        Home on the ground and the stops, shape (n + 1, 3).
    cost
        Symmetric, shape (n + 1, n + 1), in the metric's unit; infinite where no way was found.
    """

    roadmap: Roadmap
    metric: LegMetric
    points_enu_m: Array
    cost: Array
    _is_straight: NDArray[np.bool_]
    _graph: csr_array

    def polyline(self, start: int, end: int) -> Array:
        """The way from one stop to another, shape (k, 3), both ends included; the same in both directions.

        Raises
        ------
        InfeasibleError
            There is no way between them.
        """
        if start > end:
            return self.polyline(end, start)[::-1]
        ends = self.points_enu_m[[start, end]]
        if start == end:
            return ends[:1]
        if self._is_straight[start, end]:
            return ends
        _, previous = dijkstra(self._graph, directed=False, indices=[start], return_predecessors=True)
        if previous[0, end] < 0:
            a, b = (", ".join(f"{value:.1f}" for value in place) for place in ends)
            raise InfeasibleError.say(
                "no way from ({:m}) to ({:m}) m was found that keeps {:g} m from everything; leave the place "
                "out, widen the airspace or lower the minimum distance",
                a,
                b,
                self.roadmap.space.min_distance_m,
            )
        way = [end]
        while way[-1] != start:
            way.append(int(previous[0, way[-1]]))
        points = np.concatenate([self.points_enu_m, self.roadmap.nodes_enu_m])[way[::-1]]
        # The vertical part above home is kept.
        first = 1 if start == 0 else 0
        return np.concatenate([points[:first], pull_tight(self.roadmap, points[first:], self.metric)])


def pull_tight(roadmap: Roadmap, points: Array, metric: LegMetric) -> Array:
    """Drop vertices that a clear leg can skip, and move the others towards the line between their neighbours.

    None is moved closer to a neighbour than waypoints may be.
    """
    clear = roadmap.space.legs_clear
    for _ in range(TIGHTEN_ROUNDS):
        before = metric(np.diff(points, axis=0)).sum()
        points = _skip_vertices(points, clear)
        for i in range(1, len(points) - 1):
            a, b, c = points[i - 1 : i + 2]
            foot = a + np.clip((b - a) @ (c - a) / max((c - a) @ (c - a), 1e-12), 0.0, 1.0) * (c - a)
            tries = b + np.array([1.0, 0.75, 0.5, 0.25, 0.1, 0.03])[:, None] * (foot - b)
            good = np.linalg.norm(tries[:, None] - [a, c], axis=2).min(axis=1) >= MIN_SPACING_M
            good &= clear(np.broadcast_to(a, tries.shape), tries) & clear(tries, np.broadcast_to(c, tries.shape))
            if good.any():
                points[i] = tries[np.argmax(good)]
        if metric(np.diff(points, axis=0)).sum() > before - 1e-3:
            break
    return points


def _skip_vertices(points: Array, clear: Callable[[Array, Array], NDArray[np.bool_]]) -> Array:
    """Greedy shortcut: from each kept vertex jump to the furthest one that a clear leg reaches."""
    kept = [0]
    while kept[-1] < len(points) - 1:
        here = kept[-1]
        further = np.arange(here + 1, len(points))
        reached = clear(np.broadcast_to(points[here], (len(further), 3)), points[further])
        kept.append(int(further[reached][-1]) if reached.any() else here + 1)
    return points[kept].copy()


def build_leg_table(
    roadmap: Roadmap, stops_enu_m: Array, metric: LegMetric, monitor: Monitor = QUIET, *, stop: Stop = never
) -> LegTable:
    """Costs between home and stops, shape (n, 3), all of which must be allowed positions.

    When `stop` asks for an end, straight legs not yet looked at, the longest, are replaced by ways over shorter ones.
    """
    space = roadmap.space
    n = len(stops_enu_m) + 1
    points = np.concatenate([space.home_enu_m[None], stops_enu_m])
    i, j = np.triu_indices(n, 1)
    nearest_first = np.argsort(np.linalg.norm(points[j] - points[i], axis=1), kind="stable")
    straight = np.zeros((n, n), np.bool_)
    for start, end in chunks(len(i), PAIRS_PER_STEP):
        monitor.report(say("checking legs"), start, len(i))
        if start > 0 and stop():
            break
        a, b = i[nearest_first[start:end]], j[nearest_first[start:end]]
        from_stop = a > 0
        straight[a[from_stop], b[from_stop]] = space.legs_clear(points[a[from_stop]], points[b[from_stop]])
    straight |= straight.T
    graph = _with_stops(roadmap, points, straight, metric)
    monitor.report(say("finding ways around"), 0, n)
    cost = np.full((n, n), np.inf)
    cost[i, j] = np.where(straight[i, j], metric(points[j] - points[i]), np.inf)
    cost = np.minimum(cost, cost.T)
    np.fill_diagonal(cost, 0.0)
    needs_way = np.flatnonzero(~np.isfinite(cost).all(axis=1))
    for start, end in chunks(len(needs_way), ROWS_PER_STEP):
        monitor.report(say("finding ways around"), start, len(needs_way))
        rows = needs_way[start:end]
        around = dijkstra(graph, directed=False, indices=rows)[:, :n]
        cost[rows] = np.where(np.isfinite(cost[rows]), cost[rows], around)
    return LegTable(roadmap, metric, points, np.minimum(cost, cost.T), straight, graph)


def n_stops_within(roadmap: Roadmap, stops_enu_m: Array, metric: LegMetric, seconds: float) -> int:
    """Number of the stops, shape (n, 3), n > 0, for which a leg table can be made in so many seconds, at least one.

    The time that a leg and a search for ways take here and now is measured on a few of them.
    """
    nodes, n_nodes = roadmap.nodes_enu_m, len(roadmap.nodes_enu_m)
    number = np.arange(N_TRIED_LEGS)
    started_s = time.perf_counter()
    roadmap.space.legs_clear(stops_enu_m[number % len(stops_enu_m)], nodes[number * 31 % n_nodes])
    leg_s = (time.perf_counter() - started_s) / N_TRIED_LEGS
    a, b = roadmap.edges.T
    graph = csr_array((metric(nodes[b] - nodes[a]), (a, b)), shape=(n_nodes, n_nodes))
    started_s = time.perf_counter()
    dijkstra(graph, directed=False, indices=[0])
    search_s = time.perf_counter() - started_s
    per_stop_s = (N_HUBS + roadmap.n_column + 2 * ROADMAP_NEIGHBOURS) * leg_s + search_s
    return max(1, int((seconds - PAIRS_PER_STEP * leg_s) / per_stop_s))


def _with_stops(roadmap: Roadmap, points: Array, straight: NDArray[np.bool_], metric: LegMetric) -> csr_array:
    """Roadmap plus stops: nodes 0 to n - 1 are home and stops, then the roadmap's."""
    n, nodes = len(points), roadmap.nodes_enu_m
    all_points = np.concatenate([points, nodes])
    column = np.stack([np.zeros(roadmap.n_column, np.int64), n + np.arange(roadmap.n_column)], axis=1)
    joined = joined_nodes(roadmap, points[1:]) + np.array([1, n])
    distance = np.where(straight, cdist(points, points), np.inf)
    nearest = np.argpartition(distance, min(ROADMAP_NEIGHBOURS, n) - 1, axis=1)[:, :ROADMAP_NEIGHBOURS]
    a = np.repeat(np.arange(n), nearest.shape[1])
    direct = np.stack([a, nearest.ravel()], axis=1)
    direct = direct[straight[direct[:, 0], direct[:, 1]]]
    size = len(all_points)
    edges = unique_pairs(np.concatenate([column, joined, np.sort(direct, axis=1), roadmap.edges + n]), size)
    weight = np.maximum(metric(all_points[edges[:, 1]] - all_points[edges[:, 0]]), 1e-9)
    return csr_array(coo_array((weight, (edges[:, 0], edges[:, 1])), shape=(size, size)))


def joined_nodes(roadmap: Roadmap, stops_enu_m: Array) -> NDArray[np.int64]:
    """(stop, node) pairs, shape (p, 2), joined by a clear leg: nearest nodes, those above home, and hubs."""
    near = roadmap.nearest_clear(stops_enu_m, ROADMAP_NEIGHBOURS)
    lost = np.setdiff1d(np.arange(len(stops_enu_m)), near[:, 0])
    further = roadmap.nearest_clear(stops_enu_m[lost], MOST_NEIGHBOURS)
    further[:, 0] = lost[further[:, 0]]
    n_nodes, n_column = len(roadmap.nodes_enu_m), roadmap.n_column
    hubs = np.concatenate([np.arange(n_column), np.arange(n_column, n_nodes, -(-n_nodes // N_HUBS))])
    pairs = np.stack(np.meshgrid(np.arange(len(stops_enu_m)), hubs, indexing="ij"), axis=-1).reshape(-1, 2)
    clear = roadmap.space.legs_clear(stops_enu_m[pairs[:, 0]], roadmap.nodes_enu_m[pairs[:, 1]])
    return np.concatenate([near, further, pairs[clear]])
