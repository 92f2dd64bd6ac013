"""What flights are worth: the model that each brings, by the objective that its views were chosen for."""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from groundstation.services.worth import FlightResult, WorthRequest, worth_tradeoff
from tests.benchmarks.harness import Benchmark, Context, Row

COUNTS = {"planar": (50, 100, 200), "curved": (50, 100, 200), "court": (50, 100, 200), "planar-far": (100,)}
"""Photos of the flights over each scene."""

FAR = ("planar-far",)
NEAR = tuple(scene for scene in COUNTS if scene not in FAR)
NEAR_SCENES = "near scenes"
METHODS = ("random", "sections", "image-error")
N_SEEDS = 3

N_FURTHER = 100
FURTHER = {
    "other planners": ("planar", {"planners": ("orbit", "noto", "pso")}),
    "flown with RTK": ("planar", {"flown": ("rtk-fixed",)}),
    "flown with single GNSS": ("planar", {"flown": ("single",)}),
    "256 px": ("planar", {"width_px": 256}),
    "512 px": ("planar", {"width_px": 512, "views": (50, 100)}),
    "far": ("curved-far", {}),
    "Reflection MLP": ("planar", {"lights": ("mlp",), "n_seeds": N_SEEDS}),
    "joint splats": ("planar", {"lights": ("splats",), "n_seeds": N_SEEDS}),
    "joint splats, curved": ("curved", {"lights": ("splats",), "n_seeds": N_SEEDS}),
    "joint splats, court": ("court", {"lights": ("splats",), "n_seeds": N_SEEDS}),
}
"""What else models and flights may be, with one seed and so many photos: the scene, and what differs there. With
512 px a photo takes 4.5 s of a core, and a model some minutes."""

BETTER_DB, FAR_DB = 1.0, 0.2

KEPT = Path("benchmark-out")
"""Photos and results, with which the next run goes on: all of it takes hours."""


def measure(context: Context) -> Iterator[Row]:
    """Each scene's flights, then what an objective is above the others in the same minutes.

    What is recorded already of a scene, or of what else is asked, is not flown again.
    """
    gains: dict[str, list[float]] = {other: [] for other in METHODS[:-1]}
    means = [row for row in context.recorded if row.scene == NEAR_SCENES]
    for scene in ("planar",) if context.is_quick else (*NEAR, *FAR):
        counts = COUNTS[scene]
        known = [row for row in context.recorded if row.scene == scene and not row.what.startswith(tuple(FURTHER))]
        of_known = {row.what: float(row.value) for row in known}
        if of_known.keys() >= {_above_text(other) for other in METHODS[:-1]}:
            yield from known
            for other in METHODS[:-1] if scene in NEAR else ():
                gains[other].append(of_known[_above_text(other)])
            continue
        means = []
        request = request_of(scene)
        if context.is_quick:
            request = replace(request, views=(8, 12), n_unseen=6)
        compared = worth_tradeoff(request, KEPT, n_processes=2)
        shutil.copy(compared.picture_path, context.folder / f"worth-{scene}.png")
        results = compared.found
        for result in results:
            kinds = ", ".join(f"{kind} {value:.1f}" for kind, value in result.psnr_db["radiance-grid"].items())
            beside = f"{result.minutes:.1f} min, {100 * result.covered:.0f} % of the sections; {kinds} dB"
            what = f"{result.n_views} photos, {result.planner}, unseen views"
            yield Row(scene, what, round(result.mean_db("radiance-grid"), 2), "dB", None, beside, seeds=N_SEEDS)
        if context.is_quick:
            return
        curves = {method: curve_of(results, method) for method in METHODS}
        for other in METHODS[:-1]:
            above = [_above(curves, other, n_photos) for n_photos in counts]
            mean = sum(above) / len(above)
            if scene in NEAR:
                gains[other].append(mean)
            target = (f"at least -{FAR_DB:g} dB", min(above) >= -FAR_DB) if scene in FAR else ("", None)
            beside = ", ".join(f"{n} photos {value:+.2f}" for n, value in zip(counts, above, strict=True))
            yield Row(scene, _above_text(other), round(mean, 2), "dB", None, beside, *target)
    yield from _further(context.recorded)
    if means:
        yield from means
        return
    for other, each in gains.items():
        mean = sum(each) / len(each)
        target = (f"at least {BETTER_DB:g} dB" if other == "sections" else "above 0 dB",)
        is_met = mean >= BETTER_DB if other == "sections" else mean > 0.0
        what = f"{_above_text(other)}, mean of near scenes"
        yield Row(NEAR_SCENES, what, round(mean, 2), "dB", None, "", *target, is_met)


def _above_text(other: str) -> str:
    return f"image-error above {other} in as many minutes"


def _further(recorded: Sequence[Row]) -> Iterator[Row]:
    """The same question asked of other planners, flights, pictures and models."""
    for name in FURTHER:
        known = [row for row in recorded if row.what.startswith(f"{name}: ")]
        if known:
            yield from known
            continue
        request = further_request(name)
        (light,) = request.lights
        results = worth_tradeoff(request, KEPT, n_processes=2).found
        for result in results:
            beside = f"{result.minutes:.1f} min; " + ", ".join(
                f"{kind} {value:.1f}" for kind, value in result.psnr_db[light].items()
            )
            what = f"{name}: {result.n_views} photos, {result.planner}, unseen views"
            yield Row(
                result.scene, what, round(result.mean_db(light), 2), "dB", None, f"{beside} dB", seeds=request.n_seeds
            )


def further_request(name: str) -> WorthRequest:
    """Flights of one of `FURTHER`."""
    scene, changes = FURTHER[name]
    return replace(WorthRequest(scene, METHODS, (N_FURTHER,), ("radiance-grid",), n_seeds=1), **changes)


def request_of(scene: str) -> WorthRequest:
    """All flights over a scene."""
    return WorthRequest(scene, METHODS, COUNTS[scene], ("radiance-grid",), n_seeds=N_SEEDS)


Curve = tuple[Sequence[int], Sequence[float], Sequence[float]]
"""Numbers of photos, logarithms of minutes in the air, and dB, each the mean of the seeds."""


def curve_of(results: Sequence[FlightResult], method: str) -> Curve:
    """Of one method, by number of photos."""
    counts = sorted({result.n_views for result in results if result.planner == method})
    found = [[r for r in results if r.planner == method and r.n_views == n] for n in counts]
    minutes = [math.log(float(np.mean([r.minutes for r in each]))) for each in found]
    return counts, minutes, [float(np.mean([r.mean_db("radiance-grid") for r in each])) for each in found]


def _above(curves: Mapping[str, Curve], other: str, n_photos: int) -> float:
    """Decibels above another method's curve at the minutes that so many photos take; its ends go on level."""
    counts, minutes, decibels = curves["image-error"]
    at = list(counts).index(n_photos)
    return decibels[at] - float(np.interp(minutes[at], curves[other][1], curves[other][2]))


BENCHMARK = Benchmark(
    "worth",
    "What flights are worth",
    "Flights of random oblique views, of greedy choice by hemisphere sections (the paper's objective) and by the "
    "expected error of a model's pictures, over synthetic scenes: a radiance grid learns from all photos of a flight "
    "(128 x 96 pixels), and is scored on glass of 40 unseen views of each of three kinds, whose means count alike. "
    "Other methods are compared at the same minutes in the air: between their own flights, and below the shortest as "
    "if that took no longer.",
    measure,
)
