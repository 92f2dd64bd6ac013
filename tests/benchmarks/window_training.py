"""The window beside a training: whether it answers, and how soon a model in training is seen from elsewhere."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.benchmarks.experiments import QUICK_N_VIEWS, QUICK_WIDTH_PX, rendered
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.window_process import GAP_TARGET_MS, gap_row, need_screen, run_window

N_VIEWS, WIDTH_PX = 60, 256


def measure(context: Context) -> Iterator[Row]:
    """One training in the Reconstruct tab."""
    need_screen()
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if context.is_quick else (N_VIEWS, WIDTH_PX)
    with tempfile.TemporaryDirectory() as place:
        rendered("planar", Path(place) / "photos", n_views, width)
        found = run_window("training", Path(place))
    for name, key in (("a model trains", "watched_ms"), ("a model trains and is turned", "turned_ms")):
        yield gap_row("planar", f"longest gap while {name}", found[key], found["idle_ms"], GAP_TARGET_MS)
    waits_ms = found["waits_ms"]
    middle, high = np.percentile(waits_ms, [50, 95])
    yield Row(
        "planar",
        f"from a turn of the view to its first picture, median of {len(waits_ms)} (95 %: {high:.0f} ms)",
        float(middle),
        "ms",
    )


BENCHMARK = Benchmark(
    "window-training",
    "The window beside a training",
    "The Reconstruct tab with a training of the default method: the longest time in which the window's thread did not "
    "answer, by a timer of 2 ms; and how long the first picture is waited for when the view is turned meanwhile.",
    measure,
)
