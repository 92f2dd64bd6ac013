"""A large model in the formats of other programs: time, size and memory; and the web page in a browser."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from reconstruction.objects.store import write_scene
from tests.benchmarks.exported_model import WRITERS
from tests.benchmarks.fresh_process import run_measured
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.objects import FULL, QUICK, made
from tests.reconstruction.exports.web_browser import CHROMIUM, DRIVER, chromium

WINDOW = (1280, 720)


def measure(context: Context) -> Iterator[Row]:
    """The scene of the benchmark `objects`, each format in a process of its own."""
    n, n_panels = QUICK if context.is_quick else FULL
    name = f"{n} Gaussians, {n_panels} panels"
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_scene(made(n, n_panels), folder / "scene")
        alone_mib = run_measured(_command(folder, "none")).peak_mib
        yield Row(name, "memory of a process that only reads the model", round(alone_mib), "MiB")
        ply_s = ply_bytes = 0.0
        for kind in WRITERS:
            done = run_measured(_command(folder, kind))
            found = json.loads(done.printed)
            if kind == "ply":
                ply_s, ply_bytes = found["cpu_s"], found["bytes"]
            size_mb = found["bytes"] / 1e6
            yield Row(name, f"{kind}: writing", round(found["cpu_s"], 2), "s", found["cpu_s"] / ply_s, "PLY")
            yield Row(name, f"{kind}: size", round(size_mb, 1), "MB", found["bytes"] / ply_bytes, "PLY")
            yield Row(name, f"{kind}: more memory than reading alone", round(done.peak_mib - alone_mib), "MiB")
        if CHROMIUM is None or DRIVER is None:
            yield Row(name, "web page in a browser", "not run: chromium or chromedriver is missing")
        else:
            yield from _page(name, folder)


def _command(folder: Path, kind: str) -> list[str | Path]:
    out = folder / kind.replace(", ", "-").replace(" ", "-") / "model"
    out.parent.mkdir()
    return ["-m", "tests.benchmarks.exported_model", folder / "scene", kind, out]


def _page(name: str, folder: Path) -> Iterator[Row]:
    with chromium(folder / "chromium") as browser:
        browser.window(*WINDOW)
        started = time.perf_counter()
        browser.open(next((folder / "web").rglob("*.html")))
        browser.settled()
        opened_s = time.perf_counter() - started
        yield Row(name, "web page: loaded, decoded and put in order in the browser", round(opened_s, 2), "s")


BENCHMARK = Benchmark(
    "model-exports",
    "Large models in other programs' formats",
    "The scene of [objects](#models-as-objects) with all its harmonics, written by a process for each format: "
    "processor time of writing, size of all files, and the process' largest memory less that of one "
    "that only reads the model. The web page has harmonics of degree 2; it is opened in headless Chromium. "
    "Drawing is not measured: without a graphics "
    "card the processor would do it.",
    measure,
)
