"""What looking for walls in photos adds to coarse models: sides found, their errors, and the time it takes."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.benchmarks.fresh_process import run_command, run_measured
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.reconstruction.coarse.synthetic_flight import Flight, fly_around, from_the_corner, wall_errors_m

SIZE_PX = 800
NUMBERS = (15, 30, 60)


def measure(context: Context) -> Iterator[Row]:
    """Each number of photos without and with it; features and matches are made once."""
    try:
        import pycolmap  # noqa: F401  (only whether it is there)
    except ImportError:
        raise Skipped("pycolmap is not installed (pip install .[colmap])") from None
    with tempfile.TemporaryDirectory() as place:
        flight = fly_around(lambda *given: run_measured(["app.py", *given]), Path(place), NUMBERS[-1], SIZE_PX)
        content = json.loads((flight.rendered / "scene.json").read_text("utf-8"))
        places = {photo["name"]: photo["position_enu_m"] for photo in content["photos"]}
        for n_photos in NUMBERS[:1] if context.is_quick else NUMBERS:
            photos = Path(place) / f"{n_photos}"
            photos.mkdir()
            for name in from_the_corner(places)[:n_photos]:
                shutil.copy(flight.photos / name, photos)
            yield from _both_ways(flight, photos, n_photos)


def _both_ways(flight: Flight, photos: Path, n_photos: int) -> Iterator[Row]:
    guessed_m2 = {}
    for setting in ("off", "on"):
        scene = f"synthetic flight, {n_photos} photos, --dense {setting}"
        out = photos.with_name(f"{n_photos}-model")
        report = run_command(["coarse", photos, "-o", out, "--size", str(SIZE_PX), "--dense", setting]).content
        guessed_m2[setting] = report["guessed_m2"]
        target = ("less than off", guessed_m2["on"] < guessed_m2["off"]) if setting == "on" else ("", None)
        is_last = n_photos == NUMBERS[-1]
        yield Row(
            scene,
            "walls guessed",
            report["guessed_m2"],
            "m2",
            None,
            f"of {report['walls_m2']:.0f} m2",
            *(target if is_last else ("", None)),
        )
        yield Row(scene, "holes in walls that were seen", report["holes_m2"], "m2")
        for with_guessed, name in ((False, "sides that were seen"), (True, "all sides")):
            errors = wall_errors_m(flight, out, with_guessed)
            if len(errors):
                beside = f"{len(errors) // 2} sides"
                yield Row(scene, f"{name}, largest error", round(100.0 * float(errors.max()), 1), "cm", None, beside)
            else:
                yield Row(scene, name, "none")
        if setting == "on":
            yield Row(scene, "time of it", round(report["steps_s"]["dense depth"], 1), "s")


BENCHMARK = Benchmark(
    "dense-depth",
    "Walls of coarse models by photos where points are too few",
    "`coarse` without and with `--dense`, on photos (800 pixels) around the pavilion of two walls of glass and two of "
    "bare concrete; 15 photos are a quarter of the round, 30 half of it. Errors are against the truth, those of all "
    "sides include the guessed ones.",
    measure,
)
