"""Terrain: what a coarser grid costs in height and saves in time, and what flights over it cost in planning."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from planning.geo.height_field import HeightField
from planning.parameters import GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import ORIGIN, office
from planning.site.importing.attach_terrain import TerrainRequest, attach_terrain
from planning.site.importing.elevation import HeightOptions
from planning.site.importing.terrain import Area, sample_heights
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.planning.site.importing.height_files import transform_at, write_heights

CRS, PIXEL_M, HALF = "EPSG:32650", 0.5, 500
STEPS_M = (0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
WAVES_M = 80.0 / 2.0 ** np.arange(6)
N_LEGS = 200_000
N_VIEWS = 60


def rough(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A slope of a tenth with waves of 80 m to 2.5 m, each an eighth of its length high at most, and a wall of 3 m."""
    rng = np.random.default_rng(7)
    z = 0.1 * (y + 45.0) + np.where(x + 0.3 * y > 35.0, 3.0, 0.0)
    for length_m in WAVES_M:
        for _ in range(3):
            turn, phase = rng.uniform(0.0, 2.0 * np.pi, 2)
            z = z + length_m / 100.0 * np.sin(2.0 * np.pi / length_m * (np.cos(turn) * x + np.sin(turn) * y) + phase)
    return z


def write_hill(folder: Path) -> Path:
    """The rough slope as a GeoTIFF about the bundled sites' origin, ellipsoidal heights."""
    path = folder / "ground.tif"
    place = {"origin": ORIGIN, "crs": CRS, "transform": transform_at(ORIGIN, CRS, PIXEL_M, HALF)}
    write_heights(path, rough, size=(2 * HALF, 2 * HALF), **place)
    return path


def measure(context: Context) -> Iterator[Row]:
    """Grids of many steps from one file, legs over each, and plans with and without."""
    with tempfile.TemporaryDirectory() as folder:
        path = write_hill(Path(folder))
        yield from _grids(path, STEPS_M[1::3] if context.is_quick else STEPS_M)
        yield from _plans(path, 6.0 if context.is_quick else 15.0)


def _grids(path: Path, steps_m: tuple[float, ...]) -> Iterator[Row]:
    area = Area(np.array([-200.0, -200.0]), np.array([200.0, 200.0]), 0.0)
    options = HeightOptions(vertical="ellipsoid")
    rng = np.random.default_rng(0)
    a, b = (np.c_[rng.uniform(-200.0, 200.0, (N_LEGS, 2)), rng.uniform(10.0, 60.0, N_LEGS)] for _ in range(2))
    sample_heights(ORIGIN, area, [path], options, steps_m[-1])
    for step_m in steps_m:
        started = time.perf_counter()
        found = sample_heights(ORIGIN, area, [path], options, step_m)
        seconds = time.perf_counter() - started
        upper = HeightField(found.field.west_m, found.field.south_m, step_m, found.upper_m)
        points = rng.uniform(-200.0, 200.0, (100_000, 2))
        excess_m = upper.heights_m(points) - rough(points[:, 0], points[:, 1])
        started = time.perf_counter()
        upper.leg_heights_m(a, b)
        exact_us = 1e6 * (time.perf_counter() - started) / N_LEGS
        upper.legs_keep(a[:1], b[:1], 5.0)
        started = time.perf_counter()
        upper.legs_keep(a, b, 5.0)
        kept_us = 1e6 * (time.perf_counter() - started) / N_LEGS
        grid = f"steps of {step_m:g} m"
        yield Row(grid, "attach 400 x 400 m from posts 0.5 m apart", seconds, "s")
        yield Row(grid, "bound above the ground, mean of all places", float(excess_m.mean()), "m")
        yield Row(grid, "bound above the ground, 99 % of places below", float(np.quantile(excess_m, 0.99)), "m")
        yield Row(grid, "exact least height of a leg, 209 m in the mean", exact_us, "us")
        yield Row(grid, "whether it keeps 5 m", kept_us, "us", kept_us / exact_us, "the least height")


def _plans(path: Path, budget_s: float) -> Iterator[Row]:
    wanted = TerrainRequest((path,), options=HeightOptions(vertical="ellipsoid"), step_m=1.0, accuracy_m=0.0)
    hill = attach_terrain(office(), wanted, "hill").model
    assert hill.site.terrain is not None
    off = replace(hill, site=replace(hill.site, terrain=replace(hill.site.terrain, use="off")))
    request = PlanRequest(
        n_views=N_VIEWS, greedy=GreedyParameters(objective="sections", improve=False), time_budget_s=budget_s
    )
    seconds, lowest = {}, {}
    for name, model in (("off", off), ("on", hill)):
        plan_flight(model, request)
        started = time.perf_counter()
        plan = plan_flight(model, request).plan
        seconds[name] = time.perf_counter() - started
        paths = [np.array(sortie.path_enu_m)[1:-1] for sortie in plan.sorties]
        ways = [np.concatenate([p[:-1] + t * (p[1:] - p[:-1]) for t in np.linspace(0.0, 1.0, 100)]) for p in paths]
        along = np.concatenate(ways)
        lowest[name] = float((along[:, 2] - rough(along[:, 0], along[:, 1])).min())
    for name in ("off", "on"):
        ratio, against = (seconds["on"] / seconds["off"], "the effect off") if name == "on" else (None, "")
        yield Row("office on a hill", f"{N_VIEWS} views, terrain {name}", seconds[name], "s", ratio, against)
        target, met = ("at least 5 m", lowest[name] >= 5.0) if name == "on" else ("", None)
        yield Row("office on a hill", f"lowest point, terrain {name}", lowest[name], "m", target=target, met=met)


BENCHMARK = Benchmark(
    "terrain",
    "Terrain: height against time",
    "A rough slope with a wall, as GeoTIFF. Bounds enclose every post at any step; a coarser grid flies higher. Plans "
    "with the effect on and off are held against the surface itself.",
    measure,
)
