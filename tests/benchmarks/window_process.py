"""Measurements of the real window, each in a fresh process on a virtual screen of its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.benchmarks.harness import Skipped

SCREEN_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
"""Left out, so that every measurement has a virtual screen of its own."""


def run_window(what: str, folder: Path | None = None) -> dict[str, Any]:
    """What `window_run` measures.

    Parameters
    ----------
    folder
        With what it needs; None where it needs nothing.

    Raises
    ------
    Skipped
        Without a program for virtual screens.
    """
    if shutil.which("Xvfb") is None:
        raise Skipped("Xvfb is not installed")
    with tempfile.TemporaryDirectory() as place:
        path = (Path(place) if folder is None else folder) / "measured.json"
        command = [sys.executable, "-m", "tests.benchmarks.window_run", str(path), what]
        screenless = {name: value for name, value in os.environ.items() if name not in SCREEN_VARIABLES}
        subprocess.run(command, check=True, env=screenless)
        return dict(json.loads(path.read_text("utf-8")))
