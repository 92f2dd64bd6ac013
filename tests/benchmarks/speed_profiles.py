"""The fastest way to fly a path: the sweep against the nonlinear programme, and both against stopping everywhere."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from planning.aircraft.catalogue import profile
from planning.motion.speed_profile import fastest_profile
from planning.motion.timing import FlightPath, flight_path, motion_limits, stopping_times_s
from planning.parameters import FlightRules
from tests.benchmarks.harness import Benchmark, Context, Row, timer

RADIUS_M, HEIGHT_M, SPACING_M = 45.0, 25.0, 8.0
SOLVERS: tuple[Literal["sweep", "nlp"], ...] = ("sweep", "nlp")


def ring_flight(n_rounds: int, photo_every: int) -> FlightPath:
    """Rounds around a building in legs of about 8 m, looking inwards; a photo at every so many vertices."""
    n = round(2.0 * np.pi * RADIUS_M / SPACING_M) * n_rounds
    angle = 2.0 * np.pi * n_rounds * np.arange(n + 1) / n
    vertices = np.c_[RADIUS_M * np.sin(angle), RADIUS_M * np.cos(angle), np.full(n + 1, HEIGHT_M)]
    photos = np.arange(photo_every, n, photo_every)
    heading_rad = np.angle(np.exp(1j * (angle[photos] + np.pi)))
    aircraft = profile("m3e").aircraft
    pitch_rad = np.zeros(len(photos))
    rules = FlightRules()
    return flight_path(vertices, photos, heading_rad, pitch_rad, aircraft, rules, stop_at_corners=False)


def measure(context: Context) -> Iterator[Row]:
    """Duration of the flight, and time to find it."""
    limits = motion_limits(profile("m3e").aircraft, FlightRules())
    for n_rounds, photo_every in ((1, 5),) if context.is_quick else ((1, 1), (1, 5), (5, 5), (20, 5)):
        path = ring_flight(n_rounds, photo_every)
        n_legs = len(path.is_stop) - 1
        scene = f"{n_legs} legs, a photo every {photo_every}"
        with timer() as seconds:
            stopping_s = float(stopping_times_s(path, limits)[-1] + path.hover_s[-1])
        yield Row(scene, f"stopping at every vertex, {1e3 * seconds():.2g} ms", stopping_s, "s")
        durations_s = {}
        for solver in SOLVERS:
            fastest_profile(path, limits, solver=solver)
            with timer() as seconds:
                found = fastest_profile(path, limits, solver=solver)
            durations_s[solver] = found.duration_s
            what = f"{solver} ({len(found.distance_m)} nodes, {found.iterations} iterations), {1e3 * seconds():.2g} ms"
            yield Row(scene, what, found.duration_s, "s", found.duration_s / stopping_s, "stopping everywhere")
        difference = 1e6 * abs(durations_s["nlp"] / durations_s["sweep"] - 1.0)
        yield Row(scene, "nlp against sweep", difference, "ppm", target="at most 100 ppm", met=difference <= 100.0)


BENCHMARK = Benchmark(
    "speed-profile",
    "Speed profile",
    "Rounds of 45 m radius around a building in legs of 8 m, with a stop for a photo now and then: flight times by "
    "the closed form (stopping at every vertex), by the sweep over squared speeds that flies through the other "
    "corners, and by the nonlinear programme (CasADi, Ipopt) of the same problem.",
    measure,
)
