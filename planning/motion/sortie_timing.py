"""How a sortie of a plan is flown and how long it takes, from its record."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.motion.timing import FlightPath, flight_path, motion_limits, stopping_times_s
from planning.parameters import FlightRules
from planning.plan import Aircraft, Plan, Sortie, Viewpoint, viewpoint_arrays

SAME_PLACE_M = 1e-3
"""Vertices and viewpoints this close together are one place: coordinates in files are rounded to 0.1 mm."""


def beside_column(path_enu_m: NDArray[np.float64], home_enu_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether each leg of a path, shape (k, 3), leaves the vertical column above home; shape (k - 1,)."""
    in_column = np.linalg.norm(path_enu_m[:, :2] - home_enu_m[:2], axis=1) <= SAME_PLACE_M
    return np.asarray(~(in_column[:-1] & in_column[1:]))


def photo_vertices(sortie: Sortie, by_id: Mapping[str, Viewpoint]) -> NDArray[np.int64] | None:
    """Vertex of each of a sortie's viewpoints, in order, shape (m,); None where one is missing.

    Viewpoints at one place have a vertex each where the path has as many there, else they share one.
    """
    path, found = sortie.path_enu_m, [-1]
    for viewpoint_id in sortie.viewpoint_ids:
        position, last = by_id[viewpoint_id].position_enu_m, found[-1]
        vertex = last + 1
        while vertex < len(path) and math.dist(path[vertex], position) > SAME_PLACE_M:
            vertex += 1
        is_next = vertex == last + 1 < len(path)
        if not is_next and last >= 0 and math.dist(path[last], position) <= SAME_PLACE_M:
            vertex = last
        if vertex == len(path):
            return None
        found.append(vertex)
    return np.array(found[1:], np.int64)


def sortie_flight_path(
    sortie: Sortie,
    by_id: Mapping[str, Viewpoint],
    aircraft: Aircraft,
    rules: FlightRules,
    *,
    stop_at_corners: bool = True,
) -> tuple[FlightPath, NDArray[np.int64]] | None:
    """Flight path of a sortie and the vertices of its photos; None where the path is none or misses a viewpoint.

    A vertex that several photos share is repeated, so that each has one.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    vertices = photo_vertices(sortie, by_id)
    if vertices is None or len(sortie.path_enu_m) < 2:
        return None
    views = viewpoint_arrays(tuple(by_id[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids))
    repeats = np.maximum(1, np.bincount(vertices, minlength=len(sortie.path_enu_m)))
    path = np.repeat(np.array(sortie.path_enu_m, np.float64), repeats, axis=0)
    first = np.cumsum(repeats) - repeats
    vertices = first[vertices] + np.arange(len(vertices)) - np.searchsorted(vertices, vertices)
    angles = views.heading_rad, views.pitch_rad
    passing = frozenset(sortie.in_passing_ids)
    in_passing = np.array([viewpoint_id in passing for viewpoint_id in sortie.viewpoint_ids], np.bool_)
    flown = flight_path(
        path, vertices, *angles, aircraft, rules, stop_at_corners=stop_at_corners, in_passing=in_passing
    )
    return flown, vertices


def with_stops(plan: Plan) -> Plan:
    """The plan as aircraft that stop for every photo fly it: what an imported mission takes in passing is a stop, too.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    if not any(sortie.in_passing_ids for sortie in plan.sorties):
        return plan
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    sorties = []
    for sortie in plan.sorties:
        stopping = replace(sortie, in_passing_ids=())
        timed = sortie_flight_path(stopping, by_id, plan.aircraft, plan.rules) if sortie.in_passing_ids else None
        if timed is not None:
            stopping = replace(stopping, duration_s=stopping_duration_s(timed[0], plan.aircraft, plan.rules))
        sorties.append(stopping)
    return replace(plan, sorties=tuple(sorties))


def stopping_duration_s(flown: FlightPath, aircraft: Aircraft, rules: FlightRules) -> float:
    """Duration of a sortie that stops at every vertex, take-off and landing included, seconds.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    arrival_s = stopping_times_s(flown, motion_limits(aircraft, rules))
    return rules.takeoff_landing_s + float(arrival_s[-1] + flown.hover_s[-1])
