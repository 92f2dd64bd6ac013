"""Measurements of the real window, each in a fresh process on a virtual screen of its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.harness import Row, Skipped

GAP_TARGET_MS = 50.0

SCREEN_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
"""Left out, so that every measurement has a virtual screen of its own."""


def need_screen() -> None:
    """Raises `Skipped` without a program for virtual screens."""
    if shutil.which("Xvfb") is None:
        raise Skipped("Xvfb is not installed")


def run_window(what: str, folder: Path | None = None) -> dict[str, Any]:
    """What `window_run` measures.

    Parameters
    ----------
    folder
        With what it needs; None where it needs nothing.

    Raises
    ------
    Skipped
        From `need_screen`.
    """
    need_screen()
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "measured.json"
        needed = [] if folder is None else [str(folder)]
        command = [sys.executable, "-m", "tests.benchmarks.window_run", what, str(path), *needed]
        screenless = {name: value for name, value in os.environ.items() if name not in SCREEN_VARIABLES}
        subprocess.run(command, check=True, env=screenless)
        return dict(json.loads(path.read_text("utf-8")))


def gap_row(scene: str, what: str, gaps_ms: Sequence[float], idle_ms: Sequence[float], longest_ms: float | None) -> Row:
    """The longest of some gaps of the window's thread against an idle window's; None sets no target."""
    longest, idle = max(gaps_ms), max(idle_ms)
    name = f"{what} (99 %: {np.percentile(gaps_ms, 99):.1f} ms; idle: {idle:.1f} ms)"
    target = ("", None) if longest_ms is None else (f"under {longest_ms:g} ms", longest < longest_ms)
    return Row(scene, name, longest, "ms", longest / idle, "the idle window", *target)
