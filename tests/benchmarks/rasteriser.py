"""Splats to pictures, forward and backward: time and memory by splats and pixels, against torch's operations."""

from __future__ import annotations

import math
import time
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import torch
from torch import Tensor

from reconstruction.splats.rasterising.raster_types import Raster, RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.training.config import ANTIALIASED
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.torch_tiles import rasterise_in_torch

N_CHANNELS = 16
SPLATS_A_PIXEL = 25.0
"""That count in a pixel, about: splats get smaller as they get more."""

Size = tuple[int, int]
SIZES: tuple[Size, ...] = ((256, 192), (512, 384), (1024, 768))
COUNTS = (5_000, 20_000, 100_000)
MAIN: tuple[Size, int] = (SIZES[0], 20_000)
AGAINST_TORCH = ((SIZES[0], 5_000), MAIN)
QUICK: tuple[Size, int] = ((64, 48), 1_000)

MOST_MS, LEAST_RATIO, MOST_AGAINST_DISCS, MOST_AGAINST_PLAIN = 25.0, 25.0, 1.3, 1.1
REPEATS, TORCH_REPEATS = 9, 2


@dataclass(frozen=True, slots=True)
class Scene:
    """Splats all over a picture, and the gradients that come back from it."""

    inputs: tuple[Tensor, ...]
    view: View
    wanted: tuple[Tensor, Tensor, Tensor]


@dataclass(frozen=True, slots=True)
class Times:
    """Least milliseconds of a call: forward, backward, and processor time of both."""

    forward: float
    backward: float
    processor: float

    @property
    def both(self) -> float:
        """Forward and backward."""
        return self.forward + self.backward


def measure(context: Context) -> Iterator[Row]:
    """All sizes and counts, and both methods where torch's takes seconds at most."""
    cases = [(size, n) for size in SIZES for n in COUNTS] if not context.is_quick else [QUICK]
    repeats = 2 if context.is_quick else REPEATS
    found: dict[tuple[Size, int], Times] = {}
    for size, n in cases:
        scene = synthetic_scene(size, n)
        name = f"{size[0]} x {size[1]}, {n} splats"
        times = _compiled_times(scene, 0, repeats)
        found[size, n] = times
        is_main = (size, n) == MAIN
        yield Row(name, "forward", round(times.forward, 1), "ms")
        yield Row(name, "forward and backward", round(times.both, 1), "ms")
        target = (f"2 x {MOST_MS:g} ms at most", times.processor <= 2.0 * MOST_MS) if is_main else ("", None)
        yield Row(name, "forward and backward, processor time", round(times.processor, 1), "ms", None, "", *target)
        yield Row(name, "memory for both", round(_peak_mib(scene), 1), "MiB")
        if is_main:
            one = _compiled_times(scene, 1, repeats)
            yield Row(
                name, "forward and backward, one thread", round(one.both, 1), "ms", one.both / times.both, "all cores"
            )
        if is_main or context.is_quick:
            solid = _compiled_times(as_ellipsoids(scene), 0, repeats)
            ratio = solid.processor / times.processor
            is_met = (f"{MOST_AGAINST_DISCS:g} times as long at most", ratio <= MOST_AGAINST_DISCS)
            what = "3-D Gaussians forward and backward, processor time"
            against = is_met if is_main else ("", None)
            yield Row(name, what, round(solid.processor, 1), "ms", ratio, "discs", *against)
            antialiased = _compiled_times(scene, 0, repeats, is_antialiased=True)
            ratio = antialiased.processor / times.processor
            is_met = (f"{MOST_AGAINST_PLAIN:g} times as long at most", ratio <= MOST_AGAINST_PLAIN)
            against = is_met if is_main else ("", None)
            what = "antialiased forward and backward, processor time"
            yield Row(name, what, round(antialiased.processor, 1), "ms", ratio, "plain discs", *against)
        if context.is_quick or (size, n) in AGAINST_TORCH:
            yield from _against_torch(name, scene, times, is_main)
    if len(found) > 1:
        _draw(found, context.folder / "rasteriser.png")


def synthetic_scene(size: Size, n: int) -> Scene:
    """Surfels as of a facade 8 to 12 m away, up to some 60 degrees from square, at random."""
    g = torch.Generator().manual_seed(0)
    (width, height), focal_px = size, 0.9 * size[0]
    z = 8.0 + 4.0 * torch.rand(n, generator=g)
    across = (torch.rand(n, 2, generator=g) - 0.5) * 1.05 * torch.tensor([width, height]) / focal_px
    sigma_px = math.sqrt(SPLATS_A_PIXEL * width * height / n / (6.0 * math.pi))
    scales = torch.exp(0.4 * torch.randn(n, 2, generator=g)) * sigma_px * 10.0 / focal_px
    quats = torch.randn(n, 4, generator=g) * torch.tensor([1.0, 0.35, 0.35, 1.0])
    opacities = torch.sigmoid(1.5 * torch.randn(n, generator=g) - 1.0)
    features = torch.rand(n, N_CHANNELS, generator=g)
    inputs = (torch.cat([across * z[:, None], z[:, None]], dim=1), quats, scales, opacities, features)
    view = View(width, height, focal_px, focal_px, width / 2 + 0.3, height / 2 - 0.2, torch.eye(4, dtype=torch.float64))
    shapes = ((height, width, N_CHANNELS), (height, width), (height, width))
    wanted = tuple(torch.randn(shape, generator=g) for shape in shapes)
    return Scene(tuple(t.requires_grad_() for t in inputs), view, (wanted[0], wanted[1], wanted[2]))


def as_ellipsoids(scene: Scene) -> Scene:
    """The same splats with a third of their smaller size across."""
    means, quats, scales, *others = scene.inputs
    thickness = scales.detach().min(dim=1, keepdim=True).values / 3.0
    solid = torch.cat([scales.detach(), thickness], dim=1).requires_grad_()
    return Scene((means, quats, solid, *others), scene.view, scene.wanted)


def _compiled(scene: Scene, threads: int, is_antialiased: bool = False) -> Raster:
    settings = replace(ANTIALIASED if is_antialiased else RasterSettings(), threads=threads)
    return rasterise(*scene.inputs, scene.view, settings=settings, backend="numba")


def _compiled_times(scene: Scene, threads: int, repeats: int, is_antialiased: bool = False) -> Times:
    def forward() -> tuple[Tensor, Tensor, Tensor]:
        raster = _compiled(scene, threads, is_antialiased)
        return raster.features, raster.alphas, raster.depths

    forward()
    return _times(scene, forward, repeats)


def _times(scene: Scene, forward: Callable[[], tuple[Tensor, Tensor, Tensor]], repeats: int) -> Times:
    runs = []
    for _ in range(repeats):
        for values in scene.inputs:
            values.grad = None
        started, processor = time.perf_counter(), time.process_time()
        pictures = forward()
        between = time.perf_counter()
        torch.autograd.backward(pictures, scene.wanted)
        ended = time.perf_counter()
        runs.append((between - started, ended - between, time.process_time() - processor))
    return Times(*(1e3 * min(parts) for parts in zip(*runs, strict=True)))


def _against_torch(name: str, scene: Scene, compiled: Times, is_main: bool) -> Iterator[Row]:
    """The same picture by torch's operations, compared by processor time: its threads wait for each other busily."""
    raster = _compiled(scene, 0)
    counted = []

    def forward() -> tuple[Tensor, Tensor, Tensor]:
        *pictures, n_counted = rasterise_in_torch(*scene.inputs, scene.view)
        counted.append((pictures, n_counted))
        return pictures[0], pictures[1], pictures[2]

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    times = _times(scene, forward, TORCH_REPEATS)
    torch.set_num_threads(before)
    pictures, n_counted = counted[-1]
    off = float((pictures[0] - raster.features).detach().abs().max())
    yield Row(name, "splats that count in a pixel", round(n_counted, 1))
    yield Row(name, "largest difference between the two pictures", off, "", None, "of 1")
    ratio, least = times.processor / compiled.processor, LEAST_RATIO
    target = (f"at least {least:g} times as long", ratio >= least) if is_main else ("", None)
    what = "forward and backward, torch by squares, processor time"
    yield Row(name, what, round(times.processor), "ms", ratio, "compiled", *target)


def _peak_mib(scene: Scene) -> float:
    """Largest memory of NumPy's arrays from the start to the gradients, without the inputs."""
    tracemalloc.start()
    raster = _compiled(scene, 0)
    torch.autograd.backward((raster.features, raster.alphas, raster.depths), scene.wanted)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak / 2**20


def _draw(found: dict[tuple[Size, int], Times], path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    for size, colour in zip(SIZES, ("#0072b2", "#d55e00", "#009e73"), strict=True):
        counts = [n for s, n in found if s == size]
        label = f"{size[0]} x {size[1]}"
        axes.plot(counts, [found[size, n].processor for n in counts], "o-", color=colour, linewidth=2, label=label)
        axes.plot(counts, [found[size, n].both for n in counts], "o:", color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(COUNTS, [f"{n // 1000} 000" for n in COUNTS])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("splats")
    axes.set_ylabel("ms")
    axes.set_title(f"{N_CHANNELS} channels forward and backward: processor time; dotted: time on all cores")
    axes.grid(color="#dddddd", which="both")
    axes.legend()
    figure.savefig(path, dpi=110)


BENCHMARK = Benchmark(
    "rasteriser",
    "Splats to pictures, forward and backward",
    f"One call of the rasteriser for processors, {N_CHANNELS} channels, depth and alpha, and its gradients back to "
    "places, turns, sizes, opacities and features; projection and sorting count, too. The least of nine. Splats are "
    "smaller where there are more, so that about as many count in each pixel. Against it, in the same run, the same "
    "picture by torch's operations on one thread, square by square with autograd, by processor time. The two pictures "
    "may differ by 1/255, where a splat is at its cut. On cores that others use, too, trust processor time: half of "
    "it is what two free cores take. 3-D Gaussians are the same splats with a third size.",
    measure,
)
