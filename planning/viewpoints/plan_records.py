"""Chosen views and flights as the records of a plan: rounded as in files, named, in the order of flight."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from planning.coverage.positions import rounded
from planning.plan import ANGLE_DECIMALS, Sortie, Viewpoint, ViewpointArrays
from planning.routing.flights import Flight
from planning.site.free_space import LEG_MARGIN_M
from planning.viewpoints.problem import ViewProblem, take


def as_written(problem: ViewProblem, views: ViewpointArrays, n_fixed: int = 0) -> ViewpointArrays:
    """Views as a plan file holds them: rounded, pitch within the gimbal's range, none twice, all flyable.

    The first `n_fixed` views stay as they are.
    """
    written = rounded(views, problem.model.camera)
    is_fixed = np.arange(len(views.heading_rad)) < n_fixed
    _, first = np.unique(np.column_stack(written), axis=0, return_index=True)
    kept = is_fixed.copy()
    kept[first] = True
    asked = np.flatnonzero(kept & ~is_fixed)
    kept[asked] = problem.flyable(written.positions_enu_m[asked], LEG_MARGIN_M)
    both = ViewpointArrays(
        np.where(is_fixed[:, None], views.positions_enu_m, written.positions_enu_m),
        np.where(is_fixed, views.heading_rad, written.heading_rad),
        np.where(is_fixed, views.pitch_rad, written.pitch_rad),
    )
    return take(both, kept)


def plan_records(
    views: ViewpointArrays, flights: tuple[Flight, ...], locked: tuple[Viewpoint, ...] = ()
) -> tuple[tuple[Viewpoint, ...], tuple[Sortie, ...]]:
    """Viewpoints in the order of flight, named v0000 and on, and sorties.

    The first views are the `locked` ones, which keep their names; no other gets one of these.
    """
    viewpoints: list[Viewpoint] = []
    sorties = []
    taken = {viewpoint.id for viewpoint in locked}
    names = (name for number in itertools.count() if (name := f"v{number:04d}") not in taken)
    for flight in flights:
        flown = [
            replace(locked[view], locked=True) if view < len(locked) else _record(next(names), views, int(view))
            for view in flight.views
        ]
        viewpoints += flown
        path = [(float(x), float(y), float(z)) for x, y, z in flight.path_enu_m]
        for vertex, viewpoint in zip(flight.photo_vertices, flown, strict=True):
            path[vertex] = viewpoint.position_enu_m  # locked ones may have more decimals
        ids = tuple(viewpoint.id for viewpoint in flown)
        sorties.append(Sortie(ids, tuple(path), round(flight.length_m, 3), round(flight.duration_s, 2)))
    return tuple(viewpoints), tuple(sorties)


def viewpoints_of(views: ViewpointArrays, prefix: str) -> tuple[Viewpoint, ...]:
    """Viewpoints in the order of `views`, named with the prefix and a number from 0000 on; in no flight."""
    return tuple(_record(f"{prefix}{number:04d}", views, number) for number in range(len(views.heading_rad)))


def _record(viewpoint_id: str, views: ViewpointArrays, view: int) -> Viewpoint:
    x, y, z = (float(value) for value in views.positions_enu_m[view])
    heading_deg = round(float(np.degrees(views.heading_rad[view])), ANGLE_DECIMALS)
    pitch_deg = round(float(np.degrees(views.pitch_rad[view])), ANGLE_DECIMALS)
    return Viewpoint(viewpoint_id, (x, y, z), heading_deg, pitch_deg)
