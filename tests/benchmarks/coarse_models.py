"""Photos of a first flight to a coarse model: time, memory and errors against the number and size of photos."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tests.benchmarks.fresh_process import run_command, run_measured
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.reconstruction.coarse.synthetic_flight import (
    Flight,
    fly_around,
    from_the_corner,
    position_errors_m,
    wall_errors_m,
)

SIZES_PX = (400, 800, 1600)
NUMBERS = (15, 30, 60)
WANTED_S = 600.0
"""For most and largest photos, on two cores."""


class _Point(NamedTuple):
    n_photos: int
    size_px: int
    processor_s: float
    error_m: float


def measure(context: Context) -> Iterator[Row]:
    """Each number of photos in each size; photos are rendered once, in the largest."""
    try:
        import pycolmap  # noqa: F401  (only whether it is there)
    except ImportError:
        raise Skipped("pycolmap is not installed (pip install .[colmap])") from None
    sizes, numbers = (SIZES_PX[:1], NUMBERS[:1]) if context.is_quick else (SIZES_PX, NUMBERS)
    points: list[_Point] = []
    with tempfile.TemporaryDirectory() as place:
        flight = fly_around(lambda *given: run_measured(["app.py", *given]), Path(place), NUMBERS[-1], sizes[-1])
        content = json.loads((flight.rendered / "scene.json").read_text("utf-8"))
        places = {photo["name"]: photo["position_enu_m"] for photo in content["photos"]}
        for n_photos in numbers:
            photos = Path(place) / f"{n_photos}"
            photos.mkdir()
            for name in from_the_corner(places)[:n_photos]:
                shutil.copy(flight.photos / name, photos)
            for size_px in sizes:
                yield from _coarse(flight, photos, size_px, points)
    if len(points) > 1:
        _draw(points, context.folder / "coarse.png")


def _coarse(flight: Flight, photos: Path, size_px: int, points: list[_Point]) -> Iterator[Row]:
    out = photos.with_name(f"{photos.name}-{size_px}")
    n_photos = len(list(photos.iterdir()))
    scene = f"synthetic flight, {n_photos} photos, {size_px} px"
    try:
        done = run_command(["coarse", photos, "-o", out, "--size", str(size_px)])
    except RuntimeError as refused:
        yield Row(scene, "no model", str(refused))
        return
    steps = ", ".join(f"{name} {seconds:.0f} s" for name, seconds in done.content["steps_s"].items())
    is_largest = (n_photos, size_px) == (NUMBERS[-1], SIZES_PX[-1])
    target = (f"under {WANTED_S:g} s", done.seconds < WANTED_S) if is_largest else ("", None)
    yield Row(scene, "time", round(done.seconds, 1), "s", None, steps, *target)
    yield Row(scene, "time of processors", round(done.processor_s, 1), "s")
    yield Row(scene, "peak memory", round(done.peak_mib / 1024.0, 2), "GiB")
    errors = position_errors_m(flight, out)
    beside = f"{len(errors)} of {n_photos} placed, the worst {100.0 * errors.max():.1f} cm"
    yield Row(scene, "positions, median error", round(100.0 * float(np.median(errors)), 2), "cm", None, beside)
    walls = wall_errors_m(flight, out)
    if len(walls):
        beside = f"{len(walls) // 2} of 4 sides seen"
        yield Row(
            scene, "sides that were seen, largest error", round(100.0 * float(walls.max()), 1), "cm", None, beside
        )
    else:
        yield Row(scene, "sides that were seen", "none")
    points.append(_Point(n_photos, size_px, done.processor_s, float(np.median(errors))))


def _draw(points: list[_Point], path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import FixedLocator, NullLocator, ScalarFormatter

    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    for n_photos in sorted({point.n_photos for point in points}):
        line = [point for point in points if point.n_photos == n_photos]
        times, errors = [point.processor_s for point in line], [100.0 * point.error_m for point in line]
        axes.semilogx(times, errors, "o-", label=f"{n_photos} photos")
        for point in line:
            place = (point.processor_s, 100.0 * point.error_m)
            axes.annotate(f"{point.size_px} px", place, (4, 4), textcoords="offset points", fontsize=8)
    axes.set_xlabel("time of processors, s")
    axes.set_ylabel("median error of positions, cm")
    axes.set_title("Coarse model: error against time", fontweight="bold")
    axes.set_ylim(bottom=0.0)
    axes.xaxis.set_major_locator(FixedLocator([10, 20, 50, 100, 200, 500, 1000]))
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110)


BENCHMARK = Benchmark(
    "coarse",
    "Coarse models of photos alone",
    "`coarse` on photos rendered around a pavilion with two walls of glass and two of bare concrete, with the errors "
    "of an RTK receiver and a gimbal; 15 photos are a quarter of the round, 30 half of it. Errors are against the "
    "truth; other programs may run beside it, so that time of processors stands beside time.",
    measure,
)
