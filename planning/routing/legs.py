"""Obstacle-avoiding legs between stops: costs of all pairs, and the polyline of each leg that is really flown.

Where the straight leg between two stops keeps every distance it is flown; elsewhere the way leads over the roadmap and
is then pulled tight. Every leg is certified on its whole length, not sampled.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist, pdist

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
STOPS_PER_STEP = 50
"""Stops that are joined to hubs at a time."""
MOST_VIA = 4
"""Stops, and home, over which ways lead between stops from which none are searched for lack of time."""
TIGHTEN_ROUNDS = 12

N_TRIED_LEGS = 400
"""Legs on which it is measured how long one takes."""
PAIRS_PER_LEG = 12
"""Pairs of stops that are put in order, and whose costs are filled in, while one leg is looked at."""


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
    _nodes: NDArray[np.int64]
    _nodes_enu_m: Array

    def part(self, stops_enu_m: Array) -> LegTable:
        """The same costs for some of the stops, shape (k, 3), in their order, without looking for ways again.

        Ways may still lead over the other stops. Stops at the same place share one of the table's.

        Raises
        ------
        ValueError
            One of them is not in the table.
        """
        numbers = {tuple(point): number for number, point in enumerate(self.points_enu_m.tolist()) if number > 0}
        found = [numbers.get(tuple(stop)) for stop in stops_enu_m.tolist()]
        if None in found:
            raise ValueError(f"stops_enu_m: expected stops of the table, got {stops_enu_m[found.index(None)]}")
        kept = np.array([0, *found], np.int64)
        both = np.ix_(kept, kept)
        return replace(
            self,
            points_enu_m=self.points_enu_m[kept],
            cost=self.cost[both],
            _is_straight=self._is_straight[both],
            _nodes=self._nodes[kept],
        )

    def polyline(self, start: int, end: int) -> Array:
        """The way from one stop to another, shape (k, 3), both ends included; the same in both directions.

        Raises
        ------
        InfeasibleError
            There is no way between them.
        """
        first, last = int(self._nodes[start]), int(self._nodes[end])
        if first > last:
            return self.polyline(end, start)[::-1]
        ends = self.points_enu_m[[start, end]]
        if start == end:
            return ends[:1]
        if self._is_straight[start, end] or first == last:
            return ends
        _, previous = dijkstra(self._graph, directed=False, indices=[first], return_predecessors=True)
        if previous[0, last] < 0:
            a, b = (", ".join(f"{value:.1f}" for value in place) for place in ends)
            raise InfeasibleError.say(
                "no way from ({:m}) to ({:m}) m was found that keeps {:g} m from everything; leave the place "
                "out, widen the airspace or lower the minimum distance",
                a,
                b,
                self.roadmap.space.min_distance_m,
            )
        way = [last]
        while way[-1] != first:
            way.append(int(previous[0, way[-1]]))
        points = self._nodes_enu_m[way[::-1]]
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
    roadmap: Roadmap,
    stops_enu_m: Array,
    metric: LegMetric,
    monitor: Monitor = QUIET,
    *,
    stop: Stop = never,
    hurry: Stop = never,
) -> LegTable:
    """Costs between home and stops, shape (n, 3), all of which must be allowed positions.

    When `stop` asks for an end, straight legs not yet looked at, the longest, are replaced by ways over shorter ones.
    When `hurry` does, stops not yet joined to hubs are not, and ways between stops from which none were searched yet
    are those over home or the first stops; they are no longer where they are drawn.
    """
    space = roadmap.space
    n = len(stops_enu_m) + 1
    points = np.concatenate([space.home_enu_m[None], stops_enu_m])
    i, j = np.triu_indices(n, 1)
    nearest_first = np.argsort(pdist(points), kind="stable")
    straight = np.zeros((n, n), np.bool_)
    for start, end in chunks(len(i), PAIRS_PER_STEP):
        monitor.report(say("checking legs"), start, len(i))
        if start > 0 and stop():
            break
        a, b = i[nearest_first[start:end]], j[nearest_first[start:end]]
        from_stop = a > 0
        straight[a[from_stop], b[from_stop]] = space.legs_clear(points[a[from_stop]], points[b[from_stop]])
    straight |= straight.T
    graph = _with_stops(roadmap, points, straight, metric, hurry)
    cost = np.full((n, n), np.inf)
    is_straight = straight[i, j]
    a, b = i[is_straight], j[is_straight]
    cost[a, b] = cost[b, a] = metric(points[b] - points[a])
    np.fill_diagonal(cost, 0.0)
    needs_way = np.flatnonzero(~np.isfinite(cost).all(axis=1))
    via: list[Array] = []
    for start, end in chunks(len(needs_way), ROWS_PER_STEP):
        monitor.report(say("finding ways around"), start, len(needs_way))
        rows = needs_way[start:end]
        if start > 0 and hurry():
            detour = np.min([around[:, None] + around for around in via], axis=0)
            cost = np.where(np.isfinite(cost), cost, detour)
            break
        around = dijkstra(graph, directed=False, indices=rows)[:, :n]
        cost[rows] = np.where(np.isfinite(cost[rows]), cost[rows], around)
        via += list(around[: MOST_VIA - len(via)])
    nodes = np.concatenate([points, roadmap.nodes_enu_m])
    return LegTable(roadmap, metric, points, np.minimum(cost, cost.T), straight, graph, np.arange(n), nodes)


def n_stops_within(roadmap: Roadmap, stops_enu_m: Array, metric: LegMetric, seconds: float) -> int:
    """Number of the stops, shape (n, 3), n > 0, for which a leg table can be made in so many seconds, in a hurry.

    At least one. The time that a leg and a search for ways take here and now is measured on a few of them.
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
    # In legs: n stops take 2 k n for their k nearest nodes and stops, and n^2 / 2 pairs.
    n_legs = (seconds - ROWS_PER_STEP * search_s) / leg_s - PAIRS_PER_STEP
    each = 2.0 * ROADMAP_NEIGHBOURS * PAIRS_PER_LEG
    return max(1, int(np.sqrt(each**2 + 2.0 * PAIRS_PER_LEG * max(0.0, n_legs)) - each))


def _with_stops(
    roadmap: Roadmap, points: Array, straight: NDArray[np.bool_], metric: LegMetric, hurry: Stop
) -> csr_array:
    """Roadmap plus stops: nodes 0 to n - 1 are home and stops, then the roadmap's."""
    n, nodes = len(points), roadmap.nodes_enu_m
    all_points = np.concatenate([points, nodes])
    column = np.stack([np.zeros(roadmap.n_column, np.int64), n + np.arange(roadmap.n_column)], axis=1)
    joined = joined_nodes(roadmap, points[1:], hurry) + np.array([1, n])
    distance = np.where(straight, cdist(points, points), np.inf)
    nearest = np.argpartition(distance, min(ROADMAP_NEIGHBOURS, n) - 1, axis=1)[:, :ROADMAP_NEIGHBOURS]
    a = np.repeat(np.arange(n), nearest.shape[1])
    direct = np.stack([a, nearest.ravel()], axis=1)
    direct = direct[straight[direct[:, 0], direct[:, 1]]]
    size = len(all_points)
    edges = unique_pairs(np.concatenate([column, joined, np.sort(direct, axis=1), roadmap.edges + n]), size)
    weight = np.maximum(metric(all_points[edges[:, 1]] - all_points[edges[:, 0]]), 1e-9)
    return csr_array(coo_array((weight, (edges[:, 0], edges[:, 1])), shape=(size, size)))


def joined_nodes(roadmap: Roadmap, stops_enu_m: Array, hurry: Stop = never) -> NDArray[np.int64]:
    """(stop, node) pairs, shape (p, 2), joined by a clear leg: nearest nodes, those above home, and hubs.

    When `hurry` asks for an end, stops not yet looked at get their nearest nodes alone.
    """
    near = roadmap.nearest_clear(stops_enu_m, ROADMAP_NEIGHBOURS)
    lost = np.setdiff1d(np.arange(len(stops_enu_m)), near[:, 0])
    further = roadmap.nearest_clear(stops_enu_m[lost], MOST_NEIGHBOURS)
    further[:, 0] = lost[further[:, 0]]
    n_nodes, n_column = len(roadmap.nodes_enu_m), roadmap.n_column
    hubs = np.concatenate([np.arange(n_column), np.arange(n_column, n_nodes, -(-n_nodes // N_HUBS))])
    joined = [near, further]
    for start, end in chunks(len(stops_enu_m), STOPS_PER_STEP):
        if hurry():
            break
        pairs = np.stack(np.meshgrid(np.arange(start, end), hubs, indexing="ij"), axis=-1).reshape(-1, 2)
        clear = roadmap.space.legs_clear(stops_enu_m[pairs[:, 0]], roadmap.nodes_enu_m[pairs[:, 1]])
        joined.append(pairs[clear])
    return np.concatenate(joined)
