"""Our plan against a nap-of-the-object plan, on views that neither has: by resolution, and by how far things are."""

from __future__ import annotations

import math
import multiprocessing
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

from planning.base.jit import n_threads
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import score_views, train_reflections
from tests.benchmarks.experiments import QUICK, QUICK_N_VIEWS, QUICK_WIDTH_PX
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.tables.photos import Photos, Planner, photos_in

SCENE, N_VIEWS, N_UNSEEN = "planar", 200, 40
USUAL_STREET_M, USUAL_WIDTH_PX = 28.0, 128
WIDTHS_PX, STREETS_M = (64, 128, 256), (20.0, 28.0, 56.0, math.inf)
LIGHTS: tuple[ModelName, ...] = ("mlp", "radiance-grid")
PLANNERS: tuple[Planner, ...] = ("noto", "greedy")


class _Case(NamedTuple):
    """Photos of a street of some width, in some size."""

    street_m: float
    width_px: int

    @property
    def name(self) -> str:
        """For people."""
        street = "nothing near" if math.isinf(self.street_m) else f"street of {self.street_m:g} m"
        return f"{self.width_px} px, {street}"


def measure(context: Context) -> Iterator[Row]:
    """The gap for each width of photos, and for each of the street."""
    is_quick = context.is_quick
    usual = _Case(USUAL_STREET_M, QUICK_WIDTH_PX if is_quick else USUAL_WIDTH_PX)
    cases = [usual] if is_quick else [_Case(USUAL_STREET_M, width) for width in WIDTHS_PX]
    cases += [] if is_quick else [_Case(street, USUAL_WIDTH_PX) for street in STREETS_M if street != USUAL_STREET_M]
    n_views, n_unseen = (QUICK_N_VIEWS, 4) if is_quick else (N_VIEWS, N_UNSEEN)
    with tempfile.TemporaryDirectory() as place:
        work = Path(place)
        folders = {
            (case, planner): photos_in(
                work,
                Photos(SCENE, planner, n_unseen if planner == "unseen" else n_views, case.width_px, 0, case.street_m),
            )
            for case in cases
            for planner in (*PLANNERS, "unseen")
        }
        with ProcessPoolExecutor(n_threads(), multiprocessing.get_context("spawn")) as pool:
            asked = {
                (case, light, planner): pool.submit(
                    unseen_db, folders[case, planner], folders[case, "unseen"], light, is_quick
                )
                for case in cases
                for light in LIGHTS
                for planner in PLANNERS
            }
            for case in cases:
                for light in LIGHTS:
                    noto_db, ours_db = (asked[case, light, planner].result() for planner in PLANNERS)
                    beside = f"NOTO {noto_db:.1f}, ours {ours_db:.1f} dB"
                    what = f"{case.name}, {light}: our plan above NOTO"
                    yield Row(SCENE, what, round(ours_db - noto_db, 2), "dB", None, beside)


def unseen_db(learned: Path, unseen: Path, light: ModelName, is_quick: bool) -> float:
    """PSNR, dB, of the glass of unseen views, of one model of light as it is by default."""
    source, others = read_photo_set(learned), read_photo_set(unseen)
    config = QUICK if is_quick else ReflectionConfig()
    rays = glass_rays(source, source.photos)
    trained = train_reflections(rays, source.panels, light, config, source.exposure, clock=time.process_time)
    return float(score_views(trained, others, [photo.name for photo in others.photos]).mean_db)


BENCHMARK = Benchmark(
    "plan-gap",
    "Our plan against NOTO, by resolution and depth",
    f"{N_VIEWS} views of each plan, flown in simulation, and {N_UNSEEN} from places and directions drawn at random to "
    "be scored on. Mirrored light alone is learned, as it is by default: `mlp` by the Reflection MLP of 4 x 128, "
    "`radiance-grid` by a scene that mirrored rays march through. Photos 64 to 256 pixels wide; buildings opposite 20 "
    "to 56 m away with the same flights, or nothing near at all.",
    measure,
)
