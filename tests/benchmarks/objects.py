"""A model as objects at full size: written, read whole and in parts, and picked from, against the splats as PLY."""

from __future__ import annotations

import itertools
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.objects.gs_scene import GsComponent, GsElement, GsScene
from reconstruction.objects.picking import Quads, picked
from reconstruction.objects.store import StoredScene, write_scene
from reconstruction.records.entries import global_id_of
from reconstruction.splats.ply import read_splats, write_splats
from reconstruction.splats.splats import Splats
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.reconstruction.objects.synthetic_scene import ORIGIN, gaussians, pane

N_FACADES = 4
FULL, QUICK = (1_000_000, 5_000), (20_000, 100)
"""Gaussians and panels."""

SHARE_ON_GLASS = 0.6
MOST_LOAD_S, MOST_PICK_MS = 5.0, 10.0
N_PICKS = 200
REPEATS = 3


def measure(context: Context) -> Iterator[Row]:
    """One scene of random Gaussians; least of some repeats."""
    n, n_panels = QUICK if context.is_quick else FULL
    scene = made(n, n_panels)
    name = f"{n} Gaussians, {n_panels} panels"
    with tempfile.TemporaryDirectory() as made_folder:
        folder = Path(made_folder)
        yield Row(name, "write", round(_least_s(lambda: write_scene(scene, folder / "scene")), 2), "s")
        size = sum(path.stat().st_size for path in (folder / "scene").iterdir())
        yield Row(name, "size of the folder", round(size / 2**20, 1), "MiB")
        ply_s, ply_mib = _as_ply(scene, folder / "splats.ply")
        whole_s = _least_s(lambda: StoredScene(folder / "scene").read())
        target = (f"at most {MOST_LOAD_S:g} s", whole_s <= MOST_LOAD_S)
        yield Row(name, "read, every checksum looked at", round(whole_s, 2), "s", whole_s / ply_s, "PLY", *target)
        memory = _peak_mib(lambda: StoredScene(folder / "scene").read())
        yield Row(name, "memory while it is read", round(memory, 1), "MiB", memory / ply_mib, "PLY")
        part_s = _least_s(lambda: StoredScene(folder / "scene").read(["F1"]))
        yield Row(name, f"read one of {N_FACADES} facades", round(part_s, 3), "s", part_s / whole_s, "all of it")
        element = scene.components[1].elements[-1].global_id
        one_s = _least_s(lambda: StoredScene(folder / "scene").element(element))
        yield Row(name, "open, and read one panel", round(1000.0 * one_s, 1), "ms", one_s / whole_s, "all of it")
        yield Row(name, "open only", round(1000.0 * _least_s(lambda: StoredScene(folder / "scene")), 1), "ms")
        yield from _queries(name, scene)


def _queries(name: str, scene: GsScene) -> Iterator[Row]:
    quads = Quads.of(np.array([element.corners_enu_m for _, element in scene.elements]))
    camera = PosedPhoto(
        "",
        Path(),
        Intrinsics(1280, 960, 1000.0, 1000.0, 640.0, 480.0),
        Pose(np.array([40.0, -30.0, 20.0]), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])),
    )
    rng = np.random.default_rng(0)
    places = rng.uniform((0.0, 0.0), (1280.0, 960.0), (N_PICKS, 2))
    begun = time.perf_counter()
    found = [picked(quads, camera, place[None])[0] for place in places]
    pick_ms = 1000.0 * (time.perf_counter() - begun) / N_PICKS
    share = np.mean(np.array(found) >= 0)
    target = (f"at most {MOST_PICK_MS:g} ms", pick_ms <= MOST_PICK_MS)
    yield Row(name, f"pick a panel ({share:.0%} of the places have one)", round(pick_ms, 3), "ms", None, "", *target)
    ids = [element.global_id for _, element in scene.elements]
    begun = time.perf_counter()
    for each in ids:
        scene.element(each)
    yield Row(name, "find an element by its GlobalId", round(1e6 * (time.perf_counter() - begun) / len(ids), 2), "us")


def made(n: int, n_panels: int) -> GsScene:
    """Facades side by side with as many Gaussians on each panel, and a background."""
    rng = np.random.default_rng(0)
    each = int(SHARE_ON_GLASS * n / n_panels)
    columns = n_panels // N_FACADES // 25 or 1
    components, numbers = [], itertools.count()
    places = rng.permutation(n)
    first = 0
    for facade in range(N_FACADES):
        elements = []
        for k in range(n_panels // N_FACADES):
            corners = pane(facade * (columns + 1) + k % columns, k // columns)
            named = f"F{facade}-{k:04d}"
            panel = next(numbers)
            elements.append(GsElement(global_id_of("made", named), named, panel, corners, k * each, (k + 1) * each))
        size = each * len(elements)
        table = gaussians(size, rng, places[first : first + size])
        components.append(GsComponent(f"c{facade}", f"F{facade}", "facade", tuple(elements), table))
        first += size
    components.append(GsComponent("b", "background", "background", (), gaussians(n - first, rng, places[first:])))
    return GsScene("s", "made", ORIGIN, (0.0, 0.0, 0.0), tuple(components), (), {}, n)


def _as_ply(scene: GsScene, path: Path) -> tuple[float, float]:
    """Seconds and MiB that reading the same splats from one file takes; without objects, checksums or parts."""
    import torch

    tables = [component.gaussians.values for component in scene.components]
    values = {key: torch.from_numpy(np.concatenate([table[key] for table in tables])) for key in tables[0]}
    write_splats(path, Splats(values, torch.zeros(scene.n_gaussians, dtype=torch.int32)), "2dgs")
    return _least_s(lambda: read_splats(path)), _peak_mib(lambda: read_splats(path))


def _least_s(work: Callable[[], object]) -> float:
    found = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        work()
        found.append(time.perf_counter() - begun)
    return min(found)


def _peak_mib(work: Callable[[], object]) -> float:
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / 2**20


BENCHMARK = Benchmark(
    "objects",
    "Models as objects",
    "A scene of random Gaussians on panels of four facades and behind them, as a folder of objects and, for "
    "comparison, as one PLY file, which has neither objects nor checksums. Files are in the system's memory already. "
    "Memory is what Python and NumPy ask for at most (PLY: torch's is NumPy's).",
    measure,
)
