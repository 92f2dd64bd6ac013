"""Ways between single places: straight where the leg is clear, else around obstacles, else straight all the same.

`planning.routing.legs` makes a table of all legs for a planner. An edit needs two or three of them, so each is found
for itself here, over the same roadmap and pulled tight in the same way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from planning.base.errors import InfeasibleError
from planning.geo.frames import Vec3
from planning.motion.timing import motion_limits, round_trip_metric
from planning.parameters import FlightRules
from planning.plan import POSITION_DECIMALS, Aircraft
from planning.routing.legs import joined_nodes, pull_tight
from planning.routing.roadmap import LegMetric, Roadmap, leg_length
from planning.site.free_space import LEG_MARGIN_M

Array = NDArray[np.float64]

HOME = None

Place = Vec3 | None
"""Position of a stop, or `HOME`."""


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """Ways over one roadmap.

    Parameters
    ----------
    metric
        What is kept small: flight time, or length where nothing can fly.
    edges
        (first node, second node), and weight, of the roadmap's edges.
    """

    roadmap: Roadmap
    metric: LegMetric
    edges: tuple[NDArray[np.int64], Array]

    @classmethod
    def over(cls, roadmap: Roadmap, aircraft: Aircraft, rules: FlightRules) -> Ways:
        """Ways for an aircraft; the shortest instead of the fastest where the wind allows no flight."""
        try:
            metric = round_trip_metric(motion_limits(aircraft, rules))
        except InfeasibleError:
            metric = leg_length
        nodes, edges = roadmap.nodes_enu_m, roadmap.edges
        return cls(roadmap, metric, (edges, metric(nodes[edges[:, 1]] - nodes[edges[:, 0]])))

    def between(self, pairs: Sequence[tuple[Place, Place]]) -> list[tuple[Vec3, ...]]:
        """The way of each pair of places, both ends included; what lies between is rounded as in plan files.

        Where an end is no allowed position, or no way is found, the way is straight: checks say what it comes too close
        to. From and to home it leads through the column above.
        """
        space = self.roadmap.space
        top = space.column_top_enu_m
        ends = np.array([[top if place is HOME else place for place in pair] for pair in pairs], np.float64)
        ends = ends.reshape(-1, 2, 3)
        is_clear = space.legs_clear(ends[:, 0], ends[:, 1])
        is_allowed = space.is_allowed(ends.reshape(-1, 3), LEG_MARGIN_M).reshape(-1, 2)
        # Home may stand on the border of the airspace, where viewpoints may not; it was checked when it was prepared.
        is_allowed |= np.array([[place is HOME for place in pair] for pair in pairs], np.bool_).reshape(-1, 2)
        found = []
        for (start, end), straight, clear, allowed in zip(pairs, ends, is_clear, is_allowed, strict=True):
            if clear and start is not HOME and end is not HOME:
                way: Array | None = straight
            else:
                way = self._around(start, end) if allowed.all() else None
            vertices = _rounded(self._straight(start, end) if way is None else way)
            first, last = (vertices[0] if start is HOME else start), (vertices[-1] if end is HOME else end)
            found.append((first, *vertices[1:-1], last))
        return found

    def _straight(self, start: Place, end: Place) -> Array:
        """Straight, but for the column above home."""
        column = [self.roadmap.space.home_enu_m, self.roadmap.space.column_top_enu_m]
        first = column if start is HOME else [np.array(start)]
        last = column[::-1] if end is HOME else [np.array(end)]
        return np.array([*first, *last])

    def _around(self, start: Place, end: Place) -> Array | None:
        """Shortest way over the roadmap, pulled tight, shape (k, 3); None where there is none."""
        if end is HOME and start is not HOME:
            from_home = self._around(end, start)
            return None if from_home is None else from_home[::-1]
        nodes = self.roadmap.nodes_enu_m
        n = len(nodes)
        points = np.array([self.roadmap.space.home_enu_m if place is HOME else place for place in (start, end)])
        joined = joined_nodes(self.roadmap, points)
        if start is HOME:
            column = np.arange(self.roadmap.n_column)
            joined = np.concatenate([joined[joined[:, 0] == 1], np.stack([np.zeros_like(column), column], axis=1)])
        joined = np.unique(joined, axis=0)  # a sparse matrix adds up what it is given twice
        weight = self.metric(nodes[joined[:, 1]] - points[joined[:, 0]])
        rows = np.concatenate([self.edges[0][:, 0], n + joined[:, 0]])
        columns = np.concatenate([self.edges[0][:, 1], joined[:, 1]])
        weights = np.maximum(np.concatenate([self.edges[1], weight]), 1e-9)
        graph = csr_array(coo_array((weights, (rows, columns)), shape=(n + 2, n + 2)))
        _, previous = dijkstra(graph, directed=False, indices=[n], return_predecessors=True)
        if previous[0, n + 1] < 0:
            return None
        way = [n + 1]
        while way[-1] != n:
            way.append(int(previous[0, way[-1]]))
        along = np.concatenate([nodes, points])[way[::-1]]
        n_kept = 1 if start is HOME else 0  # the vertical part above home
        return np.concatenate([along[:n_kept], pull_tight(self.roadmap, along[n_kept:], self.metric)])


def _rounded(way: Array) -> tuple[Vec3, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in way.round(POSITION_DECIMALS))
