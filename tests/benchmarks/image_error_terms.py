"""The expected error of models against the error they have, and the variances that would fit best.

It looks at what the benchmark `worth` kept: each flight's photos, and how its models did.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from groundstation.services.worth import kept_folder
from planning.aircraft.catalogue import profile
from planning.coverage.image_error import ImageErrorModel, Term, decibels
from planning.coverage.mirrored_rays import Surroundings
from planning.coverage.sections import panel_frames
from planning.parameters import DEFAULT_PROFILE, Constraints
from planning.plan import ViewpointArrays
from planning.site.records import panel_corners
from planning.viewpoints.least_error import expected_psnr_db, image_error_model
from planning.viewpoints.prepare import prepare
from reconstruction.light.photo_set import read_photo_set
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.flight_worth import UNSEEN_KINDS
from tests.benchmarks.flight_worth import FAR, KEPT, NEAR, further_request, request_of
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped

Array = NDArray[np.float64]

LEARNED_FROM, FAR_LEARNED_FROM = ("planar",), ("planar-far", "curved-far")
"""Scenes whose flights variances are fitted to, and how much better models are where little near is mirrored; the
others test them."""

REQUESTS = {scene: request_of(scene) for scene in (*NEAR, *FAR)} | {"curved-far": further_request("far")}

SHARES = (0.00025, 0.0025, 0.025, 0.25)
SIZES = (
    Term("room", 1.0, 1.0),
    Term("room", 1.0, 1.0, places=5),
    Term("room", 1.0, 1.0, directions=8),
    Term("room", 1.0, 1.0, places=2, directions=8),
    *(Term("surroundings", 1.0, 1.0, side_m=side_m) for side_m in (8.0, 4.0, 2.0, 1.0)),
    Term("surroundings", 1.0, 1.0, side_m=2.0, directions=8),
    Term("image", 1.0, 1.0, directions=8),
    Term("tilt", 1.0, 1.0),
)
TRIED = tuple(replace(size, share=share) for size in SIZES for share in SHARES)


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A flight and a kind of unseen views: the error that a model of its photos had, and by terms of variance 1."""

    scene: str
    error: float
    tried: Array


def measure(context: Context) -> Iterator[Row]:
    """Deviations of what is expected by scene, then of a fresh fit, and its terms."""
    kept = {scene: kept_folder(request, KEPT) for scene, request in REQUESTS.items()}
    cases = [case for scene, folder in kept.items() for case in _cases(folder, scene)]
    if not cases:
        raise Skipped("the benchmark `worth` has kept nothing here; run it first")
    flights = {scene: list(_flights(folder, scene)) for scene, folder in kept.items()}
    for scene, found in flights.items():
        if found:
            off = np.array([measured - expected_psnr_db(error, share) for measured, error, share in found])
            is_learned = scene in (*LEARNED_FROM, *FAR_LEARNED_FROM)
            role = "calibrated on" if is_learned else "not calibrated on"
            beside = f"{off.mean():+.2f} dB in the mean of {len(off)} flights, {off.std():.2f} dB about that; {role}"
            yield Row(scene, "deviation of the expected PSNR", round(rms(off), 2), "dB", None, beside)
    learned_flights = [flight for scene in LEARNED_FROM for flight in flights[scene]]
    if len(learned_flights) > 1:
        measured, expected, _ = (np.array(column) for column in zip(*learned_flights, strict=True))
        slope, least = np.polyfit([decibels(error) for error in expected], measured, 1)
        yield Row("fresh fit", "PSNR against that of the expected error", f"{least:.1f} + {slope:.3f} x")
    learned = [case for case in cases if case.scene in LEARNED_FROM]
    parts = fitted(learned)
    for scene in dict.fromkeys(case.scene for case in cases):
        chosen = [case for case in cases if case.scene == scene]
        off = np.array([decibels(case.error) - decibels(parts @ _row(case)) for case in chosen])
        yield Row(scene, "deviation of variances fitted anew, each kind of views", round(rms(off), 2), "dB")
    yield Row("fresh fit", "floor", float(f"{parts[0]:.2g}"))
    for term, variance in zip(TRIED, parts[1:], strict=True):
        if variance > 0.0:
            size = f"places {term.places}, side {term.side_m:g} m, directions {term.directions}, share {term.share:g}"
            yield Row("fresh fit", f"{term.of}: {size}", float(f"{variance:.2g}"))


def fitted(cases: Sequence[Case]) -> Array:
    """Floor and variances, none negative, that make relative errors of expected errors least; shape (1 + terms,)."""
    rows = np.array([_row(case) / case.error for case in cases])
    return np.asarray(nnls(rows, np.ones(len(rows)))[0])


def _row(case: Case) -> Array:
    return np.concatenate([[1.0], case.tried])


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def _flights(folder: Path, scene: str) -> Iterator[tuple[float, float, float]]:
    """Of each flight, the PSNR of its model, the mean over kinds of views; the error that the planner expects; and the
    share of what is mirrored that is near."""
    results = sorted(folder.glob("*/result.json"))
    if not results:
        return
    site = bundled_scene(scene).site
    ready = prepare(site, profile(DEFAULT_PROFILE).camera, Constraints())
    model, _ = image_error_model(ready.problem, site)
    for path in results:
        scores = json.loads(path.read_text("utf-8"))["psnr_db"].get("radiance-grid")
        if scores:
            expected = model.expected_error(views_of(path.parent / "photos"))
            yield float(np.mean(list(scores.values()))), expected, model.near_share


def _cases(folder: Path, scene: str) -> Iterator[Case]:
    results = sorted(folder.glob("*/result.json"))
    if not results:
        return
    site, camera = bundled_scene(scene).site, profile(DEFAULT_PROFILE).camera
    surroundings = Surroundings(site, panel_frames(panel_corners(site.site)))
    unseen = {kind: views_of(folder / f"unseen-{kind}" / "photos") for kind in UNSEEN_KINDS}
    tried = {kind: ImageErrorModel(surroundings, camera, TRIED, [views]) for kind, views in unseen.items()}
    for path in results:
        views, scores = views_of(path.parent / "photos"), json.loads(path.read_text("utf-8"))["psnr_db"]
        for kind, value in scores.get("radiance-grid", {}).items():
            shown = tried[kind].shown(views)
            sums = np.bincount(shown.items, shown.amounts, tried[kind].n_elements)
            yield Case(scene, 10.0 ** (-value / 10.0), tried[kind].errors_by_term(sums))


def views_of(folder: Path) -> ViewpointArrays:
    """The views of a data set's photos."""
    poses = [photo.pose for photo in read_photo_set(folder).photos]
    angles = np.radians(np.array([pose.angles_deg for pose in poses]))
    return ViewpointArrays(np.array([pose.position_enu_m for pose in poses]), angles[:, 0], angles[:, 1])


BENCHMARK = Benchmark(
    "image-error",
    "What a flight is expected to bring, against what it brings",
    "The PSNR of unseen views that the planner expects of each flight of the benchmark above against that of the "
    "radiance grid that learned from its photos; then calibration and variances fitted anew to the flights over one "
    "scene (variances by non-negative least squares of relative errors) and tested on the others.",
    measure,
)
