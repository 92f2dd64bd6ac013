"""Legs that are proved to keep a distance, as they are flown: how often an aircraft comes nearer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from groundstation.services.fly.flying import FlightRequest, fly_plan
from missions.flight.record import FlightRecord
from missions.flight.report import closest
from missions.simulator.conditions import Conditions, FixKind
from planning.geo.solids import Solids
from planning.parameters import GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from tests.benchmarks.harness import Benchmark, Context, Row

RECEIVERS: tuple[FixKind, ...] = ("rtk-fixed", "single")
WINDS_M_S = (0.0, 8.0)
N_FLIGHTS = 8

NEARER_M = (0.1, 0.5, 1.0, 2.0, 3.0)
"""Than the distance that the plan keeps."""


def measure(context: Context) -> Iterator[Row]:
    """Share of legs that come nearer than the proved distance by so much, and the nearest of all flights."""
    few = GreedyParameters(n_candidates=400, improve=False, certify=False)
    site_model = SCENES["office"]()
    plan = plan_flight(site_model, PlanRequest(n_views=40, greedy=few)).plan
    limits = plan.constraints
    solids = free_space(site_model, limits.min_distance_m, limits.min_height_above_ground_m).solids
    n_flights = 2 if context.is_quick else N_FLIGHTS
    for receiver in RECEIVERS:
        for wind_m_s in WINDS_M_S:
            conditions = Conditions(wind_m_s=wind_m_s, fix=receiver)
            kept: list[float] = []
            for seed in range(n_flights):
                flown = fly_plan(plan, site_model, FlightRequest(conditions=conditions, seed=seed))
                kept += [distance for record in flown.flight.sorties for distance in _of_legs(solids, record)]
            short_m = limits.min_distance_m - np.array(kept)
            scene = f"office, {receiver}, wind {wind_m_s:g} m/s"
            for nearer_m in NEARER_M:
                share = round(100.0 * float((short_m > nearer_m).mean()), 2)
                beside = f"of {len(kept)} legs"
                yield Row(scene, f"nearer than proved by {nearer_m:g} m", share, "%", None, beside, seeds=n_flights)
            yield Row(
                scene, "nearest of all, off the proved distance", round(-float(short_m.max()), 2), "m", seeds=n_flights
            )


def _of_legs(solids: Solids, record: FlightRecord) -> Iterator[float]:
    """Least distance of each leg between photos, metres."""
    track, times = record.track, [photo.time_s for photo in record.photos]
    for begin_s, end_s in pairwise(times):
        rows = (track.time_s >= begin_s) & (track.time_s <= end_s)
        part = replace(track, **{name: getattr(track, name)[rows] for name in track.__slots__})
        found = closest(solids, part)
        if found is not None:
            yield found.distance_m


BENCHMARK = Benchmark(
    "distances-flown",
    "Proved distances, as they are flown",
    "A plan whose legs are proved to keep 10 m is flown in simulation; a leg goes from photo to photo, and its true "
    "distance from all glass and walls is exact between samples.",
    measure,
)
