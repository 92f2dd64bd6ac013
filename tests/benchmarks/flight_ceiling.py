"""How good a flight of so many photos could be at all: sets of photos that are chosen with the truth known."""

from __future__ import annotations

import json
import multiprocessing
import statistics
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import torch

from groundstation.services.scenes.views import as_written
from groundstation.services.worth import FlightResult, FlightTrial, WorthRequest, kept_folder, worth_tradeoff
from planning.aircraft.catalogue import profile
from planning.base.files import make_folder
from planning.base.jit import n_threads
from planning.base.json_file import read_json, write_atomically
from planning.parameters import DEFAULT_PROFILE, Constraints
from planning.plan import ViewpointArrays
from planning.viewpoints.prepare import prepare
from planning.viewpoints.problem import concatenate, take
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import GlassRays, glass_rays
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.light.training import TrainedReflections, score_views, train_reflections
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.flight_worth import UNSEEN_KINDS, Light, UnseenKind, model_quality, photograph, shots_of
from tests.benchmarks.flight_worth import KEPT, METHODS, N_SEEDS
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.image_error_terms import views_of

SCENE = "planar"

Chosen = tuple[int, ...]
"""Photos of the pool, in order."""


@dataclass(frozen=True, slots=True)
class Search:
    """How much is tried.

    Parameters
    ----------
    n_drawn
        Sets by lot, of each kind.
    swaps
        Photos that are exchanged in each round for others of the pool; two exchanges are tried.
    """

    request: WorthRequest
    n_drawn: int
    swaps: tuple[int, ...]

    @property
    def n_photos(self) -> int:
        """Of each set."""
        return self.request.views[0]


FULL = Search(
    WorthRequest(SCENE, METHODS, (100,), ("radiance-grid", "splats"), n_seeds=N_SEEDS), 12, (20,) * 3 + (10,) * 5
)
QUICK = Search(
    WorthRequest(SCENE, METHODS, (8,), ("radiance-grid",), n_seeds=1, n_unseen=6, seconds=1.0, plan_s=2.0), 1, (4,)
)
N_TRIED = 2
"""Exchanges in each round, of which the better one counts."""

POOL = "pool"
"""Folder of the photos of all flights."""

IN_WORDS: dict[Light, str] = {"radiance-grid": "light alone", "splats": "joint splats"}


@dataclass(frozen=True, slots=True, eq=False)
class Pool:
    """All photos that sets are chosen from, and unseen views."""

    source: PhotoSet
    rays: GlassRays
    unseen: Mapping[UnseenKind, PhotoSet]

    def learned(self, chosen: Chosen, seed: int) -> TrainedReflections:
        """A radiance grid of some of the photos."""
        rays = self.rays[torch.isin(self.rays.photos, torch.tensor(chosen))]
        config = replace(ReflectionConfig(), seed=seed)
        return train_reflections(rays, self.source.panels, "radiance-grid", config, self.source.exposure)


@cache
def opened(place: Path) -> Pool:
    """The pool of a folder, once in a process."""
    source = read_photo_set(place / POOL)
    unseen = {kind: read_photo_set(folder) for kind, folder in unseen_folders(place).items()}
    return Pool(source, glass_rays(source, source.photos), unseen)


def unseen_folders(place: Path) -> dict[UnseenKind, Path]:
    """Where unseen views were photographed, beside the folder of the sets."""
    return {kind: place.parent / f"unseen-{kind}" / "photos" for kind in UNSEEN_KINDS}


def photograph_all(folder: Path, views: ViewpointArrays, width_px: int) -> Path:
    """Photos of views, with the site's surfaces beside them."""
    scene = bundled_scene(SCENE)
    ready = prepare(scene.site, profile(DEFAULT_PROFILE).camera, Constraints())
    _, companions = as_written(scene.site)
    return photograph(scene, shots_of(views), ready, width_px, folder, companions=companions)


def photographed(place: Path, chosen: Chosen, name: str, width_px: int) -> Path:
    """A folder with the photos of a set."""
    views = views_of(place / POOL)
    if len(chosen) == len(views.heading_rad):
        return place / POOL
    return photograph_all(place / name.replace(" ", "-"), take(views, np.array(chosen)), width_px)


def light_db(place: Path, chosen: Chosen, seed: int) -> float:
    """PSNR of unseen views by light alone, the mean of the kinds."""
    pool = opened(place)
    learned = pool.learned(chosen, seed)
    means = [score_views(learned, each, [p.name for p in each.photos]).mean_db for each in pool.unseen.values()]
    return statistics.fmean(means)


def splats_db(place: Path, photos: Path, seed: int, seconds: float) -> float:
    """PSNR of unseen views by joint splats, the mean of the kinds."""
    return statistics.fmean(model_quality("splats", photos, unseen_folders(place), seed, seconds).values())


def in_order(numbers: Sequence[int] | np.ndarray) -> Chosen:
    """As plain numbers."""
    return tuple(sorted(int(k) for k in numbers))


class Trials:
    """PSNR by set of photos, light alone; what was tried stays in a file, with which the next run goes on."""

    def __init__(self, place: Path, workers: ProcessPoolExecutor) -> None:
        self._place, self._workers, self._path = place, workers, place / "tried.json"
        self._known: dict[str, float] = read_json(self._path) if self._path.is_file() else {}

    def of(self, sets: Sequence[Chosen], seed: int = 0) -> list[float]:
        """Several at a time."""
        keys = [json.dumps([seed, *chosen]) for chosen in sets]
        asked = {
            key: self._workers.submit(light_db, self._place, chosen, seed)
            for key, chosen in zip(keys, sets, strict=True)
            if key not in self._known
        }
        for key, each in asked.items():
            self._known[key] = each.result()
            write_atomically(self._path, json.dumps(self._known).encode())
        return [self._known[key] for key in keys]

    def best(self, sets: Sequence[Chosen]) -> tuple[Chosen, float]:
        """The one with the highest PSNR."""
        found = self.of(sets)
        k = int(np.argmax(found))
        return sets[k], found[k]

    def exchanged(self, chosen: Chosen, value: float, n_pool: int, swaps: Sequence[int]) -> Chosen:
        """After rounds of exchanges, each kept where it is better."""
        rng = np.random.default_rng(0)
        for n_swapped in swaps:
            others = np.setdiff1d(np.arange(n_pool), chosen)
            tried = []
            for _ in range(N_TRIED):
                stay = rng.choice(chosen, len(chosen) - n_swapped, replace=False)
                tried.append(in_order([*stay, *rng.choice(others, n_swapped, replace=False)]))
            better, reached = self.best(tried)
            if reached > value:
                chosen, value = better, reached
        return chosen


def measure(context: Context) -> Iterator[Row]:
    """Flights as they are planned, then sets chosen with the truth known, by light alone and by joint splats."""
    search = QUICK if context.is_quick else FULL
    request = search.request
    flights, kept = worth_tradeoff(request, KEPT, n_processes=n_threads()).found, kept_folder(request, KEPT)
    trials = [FlightTrial(f.planner, f.n_views, f.seed, f.flown) for f in flights]
    place = kept / f"sets-of-{search.n_photos}-{request.n_seeds}"
    make_folder(place)
    photograph_all(
        place / POOL, concatenate([views_of(kept / trial.name / "photos") for trial in trials]), request.width_px
    )
    # A process that was forked would share torch's threads, which do not live on in it.
    with ProcessPoolExecutor(n_threads(), multiprocessing.get_context("spawn")) as workers:
        tried = Trials(place, workers)
        sets = dict(_sets(tried, flights, search))
        seeds = range(request.n_seeds)
        by_seed = [tried.of([*sets.values()], seed) for seed in seeds]
        found: dict[Light, dict[str, list[float]]] = {
            "radiance-grid": {name: list(each) for name, each in zip(sets, zip(*by_seed, strict=True), strict=True)}
        }
        if "splats" in request.lights:
            folders = {
                name: workers.submit(photographed, place, chosen, name, request.width_px)
                for name, chosen in sets.items()
            }
            asked = {
                name: [workers.submit(splats_db, place, folder.result(), seed, request.seconds) for seed in seeds]
                for name, folder in folders.items()
            }
            found["splats"] = {name: [each.result() for each in of_set] for name, of_set in asked.items()}
    for light in request.lights:
        planned = {m: [flight.mean_db(light) for flight in flights if flight.planner == m] for m in METHODS}
        sections = statistics.fmean(planned["sections"])
        for name, each in (planned | found[light]).items():
            mean = statistics.fmean(each)
            above = f"{mean - sections:+.2f} dB above sections"
            yield Row(SCENE, f"{IN_WORDS[light]}: {name}", round(mean, 2), "dB", None, above, seeds=len(each))


def _sets(tried: Trials, flights: Sequence[FlightResult], search: Search) -> Iterator[tuple[str, Chosen]]:
    """Sets by how they are chosen."""
    methods = np.repeat([flight.planner for flight in flights], [flight.n_taken for flight in flights])
    rng, every = np.random.default_rng(1), np.arange(len(methods))

    def by_lot(which: np.ndarray) -> list[Chosen]:
        return [in_order(rng.choice(which, search.n_photos, replace=False)) for _ in range(search.n_drawn)]

    ends = np.cumsum([flight.n_taken for flight in flights])
    ours = [in_order(each) for each in np.split(every, ends[:-1]) if methods[each[0]] == "image-error"]
    best, highest = tried.best(ours)
    candidates = {
        f"best of {search.n_drawn} by lot from random places": by_lot(every[methods == "random"]),
        f"best of {search.n_drawn} by lot from all flights": by_lot(every),
    }
    for name, sets in candidates.items():
        chosen, value = tried.best(sets)
        yield name, chosen
        if value > highest:
            best, highest = chosen, value
    yield "best of exchanges", tried.exchanged(best, highest, len(every), search.swaps)
    yield f"photos of all {len(flights)} flights", in_order(every)


BENCHMARK = Benchmark(
    "worth-ceiling",
    "What the best flight could bring",
    f"Flights of {FULL.n_photos} photos as in `worth`, and sets of as many of their photos, chosen with the truth "
    f"known: of sets drawn by lot the one whose radiance grid has the best unseen views, and the best set of all, "
    f"planned ones too, after {N_TRIED * len(FULL.swaps)} exchanges of its photos. Chosen by one seed of light alone; "
    f"every set is learned from anew by light alone and by joint splats, with {N_SEEDS} seeds.",
    measure,
)
