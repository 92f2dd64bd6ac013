"""A graphics card by WebGPU against the processor: splats to pictures and back, and a training by step."""

from __future__ import annotations

import math
import statistics
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from unittest import mock

import numpy as np
import torch

from reconstruction.base.adam import Adam
from reconstruction.gpu import device as devices
from reconstruction.gpu.device import Adapter, adapters, open_device, why_no_gpu
from reconstruction.light.reflective_panels import ModelName
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.splats.card_splats import OTHER_FEATURES, RATED, AdamStep, CardSplats
from reconstruction.splats.densification.strategy import NO_CHANGES, Limits
from reconstruction.splats.rasterising import wgpu_backend
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats
from reconstruction.training.callbacks import Callbacks, TrainingSnapshot
from reconstruction.training.config import ANTIALIASED, Device, TrainConfig
from reconstruction.training.devices import LEAST_DB, training_bytes
from reconstruction.training.model.card_pictures import CardPictures
from reconstruction.training.model.render import Rendered, render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.train import train_model
from tests.benchmarks.experiments import rendered
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.benchmarks.model_frames import building, view
from tests.benchmarks.rasteriser import N_CHANNELS, Scene, synthetic_scene

CASES = (((256, 192), 20_000), ((1024, 768), 100_000), ((2304, 1728), 1_000_000))
QUICK_CASES = (((64, 48), 1_000),)
MAIN = CASES[0]
REPEATS, MOST_S = 9, 4.0

MOST_STEP = 3.0
"""Times as much of the processor as without a card, of a step of training, where the card is a program on it."""
MOST_APART_DB = 0.2

N_VIEWS, WIDTH_PX = 12, 256

OTHER_BINS_PX, BIN_TURNS = (8, 32), 2

ADDING_LANES = 1 << 18
MULTIPLY_ADDS = """
enable f16;
@group(0) @binding(0) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) lane: vec3u) {
    var sums = vec4<KIND>(KIND(lane.x % 7u));
    let factors = vec4<KIND>(KIND(0.5), KIND(0.25), KIND(0.125), KIND(0.75));
    for (var turn = 0u; turn < 256u; turn++) {
        sums = fma(sums, factors, factors);
    }
    found[lane.x] = f32(sums.x + sums.y + sums.z + sums.w);
}
"""

MANY, MANY_PX, MOST_BYTES = 10_000_000, (512, 384), 8e9
"""Splats that a card of 8 GB is to learn, and a window of a photo."""

DEVICES: dict[Device, str] = {"cpu": "processor", "gpu": "card"}

LIGHTS: tuple[ModelName | None, ...] = (None, "environment-map", "mlp")
VIEWS = 3
"""Pictures of a model, of which the least time counts."""
STEPS, CURVE_STEPS, QUICK_STEPS = 30, 120, 5
CURVE_POINTS = 4


def measure(context: Context) -> Iterator[Row]:
    """Calls of both rasterisers, and trainings with both.

    Raises
    ------
    Skipped
        There is neither a card nor a program that stands in for one.
    """
    if reason := why_no_gpu():
        raise Skipped(reason)
    card = adapters()[0]
    kind = "software: a program on the processor" if card.is_software else f"{card.kind} card"
    yield Row(card.name, f"{card.backend}, {card.driver}", kind)
    cases = QUICK_CASES if context.is_quick else CASES
    for size, n in cases:
        scene, name = synthetic_scene(size, n), f"{size[0]} x {size[1]}, {n} splats"
        yield from _of_rasterisers(scene, name)
        if (size, n) == cases[0]:
            yield from _of_bins(scene, name)
    yield from _of_half_precision(card)
    (width, _), n = cases[0] if card.is_software else cases[-1]
    # A network of its own for each pixel takes a program in the place of a card minutes.
    for light in LIGHTS[:2] if card.is_software else LIGHTS:
        yield from _of_views(width, n, light)
    with tempfile.TemporaryDirectory() as place:
        folder = rendered("planar", Path(place) / "planar", N_VIEWS, WIDTH_PX)
        yield from _of_trainings(folder, card, QUICK_STEPS if context.is_quick else STEPS)
        yield from _of_curves(folder, QUICK_STEPS if context.is_quick else CURVE_STEPS)
    if not context.is_quick:
        yield from _of_memory()


def _of_rasterisers(scene: Scene, name: str) -> Iterator[Row]:
    """Least time of a call, forward and backward, and how far gradients are apart."""
    here = _both(scene, ANTIALIASED)
    yield Row(name, "forward and backward, processor, all cores", round(1e3 * here[0], 1), "ms")
    yield Row(name, "forward and backward, processor, time of all cores", round(1e3 * here[1], 1), "ms")
    expected = _gradients(scene)
    for what, settings in (
        ("sums in a fixed order", replace(ANTIALIASED, on_gpu=True)),
        ("atomic sums", replace(ANTIALIASED, on_gpu=True, deterministic=False)),
    ):
        there = _both(scene, settings)
        for number, kind in enumerate(("", ", time of the processor")):
            yield Row(
                name, f"forward and backward, card, {what}{kind}", round(1e3 * there[number], 1), "ms",
                there[number] / here[number], "as long as the processor",
            )  # fmt: skip
        apart = max(float((a - b).norm() / b.norm()) for a, b in zip(_gradients(scene), expected, strict=True))
        yield Row(name, f"gradients, card, {what}, from the processor's, at most", f"{apart:.1e}", "of 1")


def _of_bins(scene: Scene, name: str) -> Iterator[Row]:
    """Sides of the squares that splats are listed by, against the one in use; in turns, so that load hits all alike."""
    patch_rows = open_device().group // wgpu_backend.PATCH_COLUMNS * wgpu_backend.LANE_ROWS
    sides = (wgpu_backend.BIN_PX, *(side for side in OTHER_BINS_PX if side >= patch_rows))
    found = dict.fromkeys(sides, (math.inf, math.inf))
    for _ in range(BIN_TURNS):
        for side in sides:
            constants = wgpu_backend.CONSTANTS | {"BIN": side}
            with mock.patch.multiple(wgpu_backend, BIN_PX=side, CONSTANTS=constants):
                found[side] = min(
                    found[side], _both(scene, replace(ANTIALIASED, on_gpu=True)), key=lambda each: each[1]
                )
    for side in sides[1:]:
        ratio = found[side][1] / found[sides[0]][1]
        what = f"forward and backward, card, bins of {side} pixels, time of the processor"
        against = f"as long as with bins of {sides[0]} pixels"
        yield Row(name, what, round(1e3 * found[side][1], 1), "ms", ratio, against)


def _of_half_precision(card: Adapter) -> Iterator[Row]:
    """Multiply-adds alone in float16, against float32: what it could bring at most."""
    raw = dict(devices._found())[card]
    if "shader-f16" not in raw.features:
        yield Row(card.name, "multiply-adds in float16", "not offered by the driver")
        return
    device = raw.request_device_sync(required_features=["shader-f16"])
    out = device.create_buffer(size=4 * ADDING_LANES, usage="STORAGE | COPY_SRC")
    seconds = {}
    for kind in ("f32", "f16"):
        module = device.create_shader_module(code=MULTIPLY_ADDS.replace("KIND", kind))
        pipeline = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": "main"})
        layout = pipeline.get_bind_group_layout(0)
        group = device.create_bind_group(layout=layout, entries=[{"binding": 0, "resource": {"buffer": out}}])
        runs = []
        for _ in range(REPEATS):
            encoder = device.create_command_encoder()
            work = encoder.begin_compute_pass()
            work.set_pipeline(pipeline)
            work.set_bind_group(0, group)
            work.dispatch_workgroups(ADDING_LANES // 64)
            work.end()
            started, processor = time.perf_counter(), time.process_time()
            device.queue.submit([encoder.finish()])
            device.queue.read_buffer(out, 0, 4)
            lasted = time.process_time() - processor if card.is_software else time.perf_counter() - started
            runs.append(lasted)
        seconds[kind] = min(runs)
    ratio = seconds["f16"] / seconds["f32"]
    of = "time of the processor" if card.is_software else "time"
    what = f"multiply-adds in float16, {of}"
    yield Row(card.name, what, round(1e3 * seconds["f16"], 1), "ms", ratio, "as long as in float32")


def _gradients(scene: Scene) -> list[torch.Tensor]:
    return [values.grad.clone() for values in scene.inputs if values.grad is not None]


def _both(scene: Scene, settings: RasterSettings) -> tuple[float, float]:
    """Seconds by the clock and of the processor, the least of some calls after one that compiles."""
    runs, began = [], time.perf_counter()
    while len(runs) < 3 or (len(runs) < REPEATS and time.perf_counter() - began < MOST_S):
        for values in scene.inputs:
            values.grad = None
        started, processor = time.perf_counter(), time.process_time()
        raster = rasterise(*scene.inputs, scene.view, settings=settings)
        torch.autograd.backward((raster.features, raster.alphas, raster.depths), scene.wanted)
        runs.append((time.perf_counter() - started, time.process_time() - processor))
    return min(run[0] for run in runs[1:]), min(run[1] for run in runs[1:])


def _of_views(width: int, n: int, light: ModelName | None) -> Iterator[Row]:
    """Pictures as the window shows them: least time, and how far they are from the processor's."""
    model, at = building(n, light), view(width)
    staying = CardPictures(model, open_device())
    name = f"{at.width_px} x {at.height_px}, {n} splats of a model, mirrored light: {light or 'none'}"
    drawing: dict[str, Callable[[], Rendered]] = {
        "processor": lambda: render_view(model, at, ("depth",), settings=ANTIALIASED),
        "card": lambda: staying.picture(at, 1.0, ANTIALIASED),
    }
    pictures, first = {}, (0.0, 0.0)
    for by, draw in drawing.items():
        pictures[by] = draw().display
        runs = []
        for _ in range(VIEWS):
            started, processor = time.perf_counter(), time.process_time()
            draw()
            runs.append((time.perf_counter() - started, time.process_time() - processor))
        found = min(run[0] for run in runs), min(run[1] for run in runs)
        first = found if by == "processor" else first
        for kind, seconds, own in (("", found[0], first[0]), (", time of the processor", found[1], first[1])):
            ratio = (None, "") if by == "processor" else (seconds / own, "as long as the processor")
            yield Row(name, f"a picture, {by}{kind}", round(1e3 * seconds, 1), "ms", *ratio)
    error = float(np.mean((pictures["card"] - pictures["processor"]).astype(float) ** 2))
    target = f"{LEAST_DB:g} dB at least", psnr_db(error) >= LEAST_DB
    yield Row(name, "a picture, card, against the processor's", round(psnr_db(error), 1), "dB", None, "", *target)


def around_camera(n: int, size: tuple[int, int]) -> tuple[Splats, View]:
    """Splats all around a camera that looks at a quarter of them."""
    g, (width, height) = torch.Generator().manual_seed(0), size
    # A quarter of a turn is as wide as the picture, and none of it is above or below.
    focal_px, highest = width / 2, math.sqrt(0.5) * height / width
    turns, far_m = 2.0 * math.pi * torch.rand(n, generator=g), 4.0 + 26.0 * torch.rand(n, generator=g)
    high_m = far_m * highest * (2.0 * torch.rand(n, generator=g) - 1.0)
    means = torch.stack([far_m * turns.sin(), high_m, far_m * turns.cos()], dim=1)
    scales = torch.exp(0.4 * torch.randn(n, 2, generator=g)) * 0.02
    quats, opacities = torch.randn(n, 4, generator=g), torch.rand(n, generator=g)
    splats = Splats.of(means, quats, scales, opacities, torch.rand(n, 3, generator=g))
    eye = torch.eye(4, dtype=torch.float64)
    return splats, View(width, height, focal_px, focal_px, width / 2, height / 2, eye)


def _of_memory() -> Iterator[Row]:
    """What a step of very many splats takes of a card's memory, by a device that holds nothing else."""
    splats, at = around_camera(MANY, MANY_PX)
    needed = training_bytes(splats, at, ANTIALIASED, MANY, adapters()[0].is_software)
    # Another key than that of the device in use, and the same limit.
    device = open_device(most_bytes=devices.LARGEST_BINDING)
    optimiser = Adam([{"name": name, "params": [getattr(splats, name)]} for name in splats.names], lr=0.0)
    pull = torch.rand((at.height_px, at.width_px, 4 * OTHER_FEATURES + 4), generator=torch.Generator().manual_seed(0))
    device.forget_peak()
    card = CardSplats(device, splats, optimiser, with_glass=False)
    held, started = device.held_bytes, time.perf_counter()
    by = AdamStep(dict.fromkeys((*RATED, "details"), 0.0), 1.0, 1.0, 0.0, Limits(), NO_CHANGES, 0)
    card.try_step(at, ANTIALIASED, pull.numpy(), by)
    step_s = time.perf_counter() - started
    n_drawn = card.drawing(at, ANTIALIASED, 3).drawing.n
    name = f"{at.width_px} x {at.height_px}, {MANY} splats, {100.0 * n_drawn / MANY:.0f} % in view"
    yield Row(name, "memory of splats with moments, of each", round(held / MANY), "bytes")
    target = f"{MOST_BYTES / 1e9:g} GB at most", device.peak_bytes <= MOST_BYTES
    yield Row(name, "a step, memory at most", round(device.peak_bytes / 1e9, 2), "GB", None, "", *target)
    is_told = "as told at least", needed >= device.peak_bytes
    yield Row(name, "a step, memory as it is told before", round(needed / 1e9, 2), "GB", None, "", *is_told)
    yield Row(name, "a first step, card", round(step_s, 1), "s")


@dataclass(frozen=True, slots=True)
class _Trained:
    """What a training took and came to.

    Parameters
    ----------
    step_s
        Of the processor, the median of all steps but the first.
    psnr_db
        Of facades of unseen views, in the end.
    curve_db
        The same after each step at which they were looked at, by its number.
    """

    step_s: float
    psnr_db: float
    curve_db: Mapping[int, float]


def _in_turns(folder: Path, config: TrainConfig) -> dict[Device, _Trained]:
    """A training by each device; steps are taken in turns, so that load hits both."""
    turns: dict[Device, threading.Semaphore] = {device: threading.Semaphore(0) for device in ("cpu", "gpu")}
    seconds: dict[Device, list[float]] = {device: [] for device in turns}
    curves: dict[Device, dict[int, float]] = {device: {} for device in turns}

    def trained(device: Device) -> TrainedModel:
        own, other = turns[device], turns["gpu" if device == "cpu" else "cpu"]
        own.acquire()
        began = time.process_time()

        def visit(now: TrainingSnapshot) -> None:
            nonlocal began
            seconds[device].append(time.process_time() - began)
            if now.history:
                curves[device].setdefault(now.step, now.history[-1][1])
            other.release()
            own.acquire()
            began = time.process_time()

        try:
            return train_model(folder, replace(config, device=device), Callbacks(visit=visit))
        finally:
            # For as many turns as the other may still take.
            other.release(config.iterations + 2)

    with ThreadPoolExecutor(len(turns)) as threads:
        running = {device: threads.submit(trained, device) for device in turns}
        turns["cpu"].release()
        qualities = {device: each.result().quality for device, each in running.items()}
    # The first one is of the start, the second compiles.
    return {
        device: _Trained(
            statistics.median(seconds[device][2:-1]), math.nan if each is None else each.psnr_db, curves[device]
        )
        for device, each in qualities.items()
    }


def _of_trainings(folder: Path, card: Adapter, steps: int) -> Iterator[Row]:
    """A training of as many steps by both: what they take, and how good the models are."""
    n = MAIN[1]
    config = TrainConfig(
        method="2dgs", iterations=steps, n_splats=n, max_splats=n, densification="none", score_every_s=1e9
    )
    name, found = f"planar, 2dgs, {n} splats, {steps} steps", _in_turns(folder, config)
    ratio = found["gpu"].step_s / found["cpu"].step_s
    yield Row(name, "a step, processor, its time", round(1e3 * found["cpu"].step_s, 1), "ms")
    target = (f"{MOST_STEP:g} times at most", ratio <= MOST_STEP) if card.is_software else ("", None)
    yield Row(
        name, "a step, card, time of the processor", round(1e3 * found["gpu"].step_s, 1), "ms", ratio,
        "that without a card", *target,
    )  # fmt: skip
    yield Row(name, "unseen views, processor", round(found["cpu"].psnr_db, 2), "dB")
    yield _as_good(name, "unseen views, card", found["gpu"].psnr_db, found["cpu"].psnr_db)


def _of_curves(folder: Path, steps: int) -> Iterator[Row]:
    """A training with mirrored light and new splats by both: how good models are after so many steps."""
    config = TrainConfig(iterations=steps, n_splats=5000, max_splats=8000, light="radiance-grid", score_every_s=1e-6)
    name, found = f"planar, ours, up to 8000 splats, {steps} steps", _in_turns(folder, config)
    common = sorted(found["cpu"].curve_db.keys() & found["gpu"].curve_db.keys())
    for number in range(1, CURVE_POINTS + 1):
        step = common[max(0, math.ceil(number / CURVE_POINTS * len(common)) - 1)]
        for device, by in DEVICES.items():
            each = found[device]
            beside = f"{step * each.step_s:.1f} s of the processor"
            yield Row(name, f"unseen views after {step} steps, {by}", round(each.curve_db[step], 2), "dB", None, beside)
    yield Row(name, "unseen views in the end, processor", round(found["cpu"].psnr_db, 2), "dB")
    yield _as_good(name, "unseen views in the end, card", found["gpu"].psnr_db, found["cpu"].psnr_db)


def _as_good(name: str, what: str, found_db: float, wanted_db: float) -> Row:
    target = f"{MOST_APART_DB:g} dB apart at most", abs(found_db - wanted_db) <= MOST_APART_DB
    return Row(name, what, round(found_db, 2), "dB", None, "", *target)


BENCHMARK = Benchmark(
    "gpu",
    "A graphics card by WebGPU",
    f"One call of the rasteriser with {N_CHANNELS} channels, antialiased, and its gradients, on the first adapter that "
    "WebGPU finds and on the processor; then a training on both. Where the adapter is software (lavapipe), the figures "
    "say that the kernels are right and not too slow to be tested: speed on cards has not been measured. "
    "`make benchmark-gpu` on a computer with a card records it here with its name.",
    measure,
)
