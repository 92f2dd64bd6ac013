"""Models of mirrored light that are trained on some photos and scored on others, several at a time."""

from __future__ import annotations

import multiprocessing
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from groundstation.services.scenes.photos import render_photos
from planning.base.jit import n_threads
from reconstruction.light.config import GridSettings, ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import held_out_names, read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import score_views, train_reflections
from reconstruction.scenes.parameters import RenderSettings, SceneRequest
from reconstruction.training.config import TrainConfig
from tests.benchmarks.harness import Row

QUICK_N_VIEWS, QUICK_WIDTH_PX = 12, 64
QUICK = ReflectionConfig(
    mlp=MlpShape(32, 4, 4, 3), grid=GridSettings(most_cells=4096, levels=1), steps=60, batch=1024, environment_rows=32
)


@dataclass(frozen=True, slots=True)
class Run:
    """PSNR, dB, of glass pixels of unseen views: mean and worst view; and processor time of the training."""

    score_db: float
    worst_db: float
    seconds: float


Results = dict[str, Run]
"""Lessons with one seed, by what is learned."""


def rendered(scene: str, folder: Path, n_views: int, width_px: int) -> Path:
    """Photos of a bundled scene."""
    request = SceneRequest(scene, n_views=n_views, width_px=width_px, n_points=0, settings=RenderSettings())
    render_photos(request, folder, 1)
    return folder


def on_one_thread(config: TrainConfig) -> TrainConfig:
    """The same, drawing splats on one thread, for trainings that are compared by their processor time."""
    return replace(config, raster=replace(config.raster, threads=1))


class Experiment:
    """Photos to learn from and to be scored on, with the rays read once for all lessons of a seed."""

    def __init__(self, folder: Path, seed: int) -> None:
        self._source = read_photo_set(folder)
        names = [photo.name for photo in self._source.photos]
        self._held_out = held_out_names(names, ReflectionConfig().held_out, seed)
        self._photos = [photo for photo in self._source.photos if photo.name not in self._held_out]
        self._rays = glass_rays(self._source, self._photos)
        self._seed = seed

    def run(self, model: ModelName, config: ReflectionConfig, share: float = 1.0, limit_s: float | None = None) -> Run:
        """Of a share of the photos that are not held out, within a limit of processor time."""
        rays = self._rays
        if share < 1.0:
            order = np.random.default_rng(self._seed).permutation(len(self._photos))
            some = torch.from_numpy(order[: round(share * len(order))])
            rays = rays[torch.isin(rays.photos, some)]
        config = replace(config, seed=self._seed, time_limit_s=limit_s)
        source = self._source
        trained = train_reflections(rays, source.panels, model, config, source.exposure, clock=time.process_time)
        score = score_views(trained, source, self._held_out)
        return Run(score.mean_db, score.worst_db, trained.seconds)


def courses(
    results: Callable[[Path, int], Results], folders: Sequence[Path], seeds: Sequence[int]
) -> Iterator[list[Results]]:
    """A course for each folder with each seed, as many at a time as there are cores; those of a folder together.

    Parameters
    ----------
    course
        A function of a module, asked in another process.
    """
    # A process that was forked would share torch's threads, which do not live on in it.
    with ProcessPoolExecutor(n_threads(), multiprocessing.get_context("spawn")) as pool:
        asked = [[pool.submit(results, folder, seed) for seed in seeds] for folder in folders]
        for of_folder in asked:
            yield [each.result() for each in of_folder]


def result_rows(scene: str, found: Sequence[Results]) -> Iterator[Row]:
    """Scores and times of each kind of lesson: means of the seeds, and the worst view of all."""
    for name in found[0]:
        runs = [results[name] for results in found]
        scores = [each.score_db for each in runs]
        worst = min(each.worst_db for each in runs)
        beside = f"worst view {worst:.1f} dB; seeds {', '.join(f'{score:.2f}' for score in scores)}"
        mean, seconds = statistics.fmean(scores), statistics.fmean(each.seconds for each in runs)
        yield Row(scene, f"{name}, unseen views", round(mean, 2), "dB", None, beside, seeds=len(found))
        yield Row(scene, f"{name}, learning", round(seconds, 1), "s", seeds=len(found))


def gain_row(
    scene: str, what: str, found: Sequence[Results], better: str, others: Iterable[str], least_db: float | None
) -> Row:
    """By how much one is above the best of others, mean of the seeds and worst; `least_db` is what the mean has to be.

    With None there is no target.
    """
    gains = [results[better].score_db - max(results[other].score_db for other in others) for results in found]
    mean = statistics.fmean(gains)
    target = ("", None) if least_db is None else (f"at least {least_db:g} dB", mean >= least_db)
    return Row(scene, what, round(mean, 2), "dB", None, f"worst {min(gains):.2f} dB", *target, seeds=len(found))
