"""A CUDA device against the processor: splats to pictures and back, and whole trainings by time and by step."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from reconstruction.splats.rasterising.gsplat_backend import why_not_gsplat
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.tradeoff.train_tradeoff import Setting, Trial, run_settings
from reconstruction.training.config import TrainConfig
from reconstruction.training.presets import preset
from reconstruction.training.ranks import cuda_devices
from tests.benchmarks.experiments import rendered
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.benchmarks.rasteriser import N_CHANNELS, Scene, synthetic_scene

CASES = (((256, 192), 20_000), ((1024, 768), 100_000), ((2048, 1536), 1_000_000))
QUICK_CASES = CASES[:1]
MOST_REPEATS, MOST_S = 9, 2.0

N_VIEWS, WIDTH_PX = 60, 320
BUDGET_S, QUICK_BUDGET_S = 20.0, 10.0
LOOKS = 4
LIGHTS = ("radiance-grid", "mlp")
"""That is learned with: the one is written for the processor, the other is products of matrices."""

SAME_STEPS = 200
MOST_APART_DB = 0.5
"""Of two trainings of as many steps: sums are added up in another order, and rims of splats differ."""

FOLDER = "REFLIGHT_BENCHMARK_PHOTOS"
"""Variable of the environment with a folder of rendered photos, for computers that cannot render."""


def measure(context: Context) -> Iterator[Row]:
    """Calls of both rasterisers, then trainings on both.

    Raises
    ------
    Skipped
        There is no CUDA device, or gsplat does not work.
    """
    if reason := why_not_gsplat():
        raise Skipped(reason)
    device = cuda_devices()[0]
    yield Row(device, "beside it, threads of the processor", torch.get_num_threads())
    for size, n in QUICK_CASES if context.is_quick else CASES:
        yield from _of_rasterisers(synthetic_scene(size, n), f"{size[0]} x {size[1]}, {n} splats")
    with tempfile.TemporaryDirectory() as place:
        given = os.environ.get(FOLDER)
        folder = Path(given) if given else rendered("planar", Path(place) / "planar", N_VIEWS, WIDTH_PX)
        for light in LIGHTS[:1] if context.is_quick else LIGHTS:
            yield from _of_trainings(folder, light, context.is_quick)


def _of_rasterisers(scene: Scene, name: str) -> Iterator[Row]:
    there = Scene(tuple(t.detach().cuda().requires_grad_() for t in scene.inputs), scene.view, _moved(scene.wanted))
    here_ms, there_ms = _both_ms(scene, lambda: None), _both_ms(there, torch.cuda.synchronize)
    yield Row(name, "forward and backward, processor", round(here_ms, 1), "ms")
    yield Row(
        name, "forward and backward, CUDA", round(there_ms, 2), "ms", here_ms / there_ms, "as fast as the processor"
    )
    torch.cuda.reset_peak_memory_stats()
    before = torch.cuda.memory_allocated()
    _there_and_back(there)
    used = torch.cuda.max_memory_allocated() - before
    yield Row(name, "memory for both, CUDA", round(used / 2**20, 1), "MiB")
    for part, a, b in zip(
        ("places", "turns", "sizes", "opacities", "features"), scene.inputs, there.inputs, strict=True
    ):
        if a.grad is not None and b.grad is not None:
            off = float((a.grad - b.grad.cpu()).norm() / a.grad.norm())
            yield Row(name, f"gradients to {part}, CUDA against the processor, apart", round(off, 4), "of 1")


def _moved(wanted: tuple[Tensor, Tensor, Tensor]) -> tuple[Tensor, Tensor, Tensor]:
    return wanted[0].cuda(), wanted[1].cuda(), wanted[2].cuda()


def _there_and_back(scene: Scene) -> None:
    for values in scene.inputs:
        values.grad = None
    raster = rasterise(*scene.inputs, scene.view)
    torch.autograd.backward((raster.features, raster.alphas, raster.depths), scene.wanted)


def _both_ms(scene: Scene, wait: Callable[[], None]) -> float:
    """Least of some calls."""
    _there_and_back(scene)
    wait()
    runs, began = [], time.perf_counter()
    while len(runs) < MOST_REPEATS and time.perf_counter() - began < MOST_S:
        started = time.perf_counter()
        _there_and_back(scene)
        wait()
        runs.append(time.perf_counter() - started)
    return 1e3 * min(runs)


def _of_trainings(folder: Path, light: str, is_quick: bool) -> Iterator[Row]:
    def config(**changes: Any) -> TrainConfig:
        return replace(preset("10min"), light=light, score_every_s=1e6, **changes)

    budget_s = QUICK_BUDGET_S if is_quick else BUDGET_S
    timed = {"time_limit_s": budget_s, "score_every_s": budget_s / LOOKS}
    stepped = {"time_limit_s": None, "iterations": SAME_STEPS}
    found: dict[tuple[str, str], Trial] = {}
    for device in ("cpu", "cuda"):
        for name, changes in (("time", timed), ("steps", stepped)):
            setting = Setting("device", device, config(device=device, **changes))
            found[device, name] = run_settings(folder, [setting], clock=time.perf_counter)[0]
    for device in ("cpu", "cuda"):
        trial = found[device, "time"]
        for point in trial.history:
            yield Row(
                f"planar, {light}", f"{device}, after {point.t_s:.0f} s, some unseen views", round(point.value, 2), "dB"
            )
        beside = f"{trial.n_steps} steps, {trial.n_splats} splats"
        yield Row(f"planar, {light}", f"{device}, facades of unseen views, after {budget_s:.0f} s",
                  round(trial.facade_db, 2), "dB", None, beside)  # fmt: skip
    here, there = found["cpu", "steps"], found["cuda", "steps"]
    apart = there.facade_db - here.facade_db
    yield Row(f"planar, {light}", f"{SAME_STEPS} steps, CUDA against the processor", round(apart, 2), "dB", None, "",
              f"{MOST_APART_DB:g} dB apart at most", abs(apart) <= MOST_APART_DB)  # fmt: skip
    yield Row(f"planar, {light}", f"{SAME_STEPS} steps, CUDA", round(there.seconds, 1), "s",
              there.seconds / here.seconds, "the processor")  # fmt: skip


BENCHMARK = Benchmark(
    "cuda",
    "A CUDA device",
    f"One call of each rasteriser with {N_CHANNELS} channels and its gradients, on a CUDA device by gsplat and on all "
    "cores of the processor beside it; then whole trainings on both, by time and by steps. Photos are those of the "
    f"bundled planar scene, {N_VIEWS} of {WIDTH_PX} pixels' width; a folder named by {FOLDER} stands in for them on "
    "computers that cannot render. Skipped where there is no device: the rows are of the last computer that had one.",
    measure,
)
