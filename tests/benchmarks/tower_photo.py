"""Two photos of a tower with all their files: `python -m tests.benchmarks.tower_photo WIDTH` writes seconds as JSON.

A process of its own, so that its largest memory is that of the photos.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from datetime import timedelta
from pathlib import Path

from planning.aircraft.catalogue import profile
from planning.plan import Viewpoint
from planning.site.bundled import tower
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import Shot, lens_of, posed_photos
from reconstruction.scenes.runs.photo_folder import render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob
from reconstruction.scenes.world.build import build_scene


class Stages:
    """Processor time and wall time when each photo begins, and when all are done."""

    def __init__(self) -> None:
        self.began: list[tuple[float, float]] = []
        self._last = ""

    def report(self, stage: str, done: float, total: float) -> None:
        """Note the time."""
        if stage == "rendering photos" or self._last == "rendering photos":
            self.began.append((time.process_time(), time.perf_counter()))
        self._last = stage


def measured(width_px: int) -> dict[str, float]:
    """Seconds for the second photo, which compiles and loads nothing any more: of all cores together, and on the wall.

    The camera is 25 m before the middle of a facade.
    """
    scene = build_scene(tower())
    lens = lens_of(profile("m3e").camera, width_px)
    views = [Viewpoint(f"v{i}", (3.0 * i, -40.0, 60.0), 0.0, -5.0) for i in range(2)]
    stages = Stages()
    with tempfile.TemporaryDirectory() as name:
        shots = [Shot(view, timedelta(seconds=5 * i)) for i, view in enumerate(views)]
        photos = posed_photos(shots, lens, Path(name) / "images")
        render_photo_folder(PhotoJob(scene, photos, RenderSettings(), {}, n_points=0), Path(name), 1, stages)
    (cpu_s, wall_s), (last_cpu_s, last_wall_s) = stages.began[1:3]
    return {"cpu_s": last_cpu_s - cpu_s, "wall_s": last_wall_s - wall_s, "height_px": lens.height_px}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measured(int(sys.argv[1]))))
