"""Parts of the modelling that other parts wait for: D-SSIM, features, memory, and photos from the disk."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import torch
from torch import Tensor

from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.georeference import model_of
from reconstruction.dataset.prepare import layer_path
from reconstruction.light.reflection_mlp import MlpShape, ReflectionMlp
from reconstruction.splats.harmonic_colour import display_colours_reference, light_of_display
from reconstruction.training.losses import dssim, dssim_torch
from reconstruction.training.photos.decoded_photo import Decoding, decoded_bytes
from reconstruction.training.train import freed_memory_retained
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.reconstruction.light.synthetic_folder import cameras, corners_of
from tests.reconstruction.splats.learned_scenes import random_splats

SIZES = ((256, 192), (1024, 768))
MOST_MS = 8.0
REPEATS = 15
N_PHOTOS, QUICK_N_PHOTOS = 600, 60
LENS = Intrinsics(5280, 3956, 3700.0, 3700.0, 2640.0, 1978.0)
"""Of a DJI M3E."""

LIMIT_MIB, QUICK_LIMIT_MIB = 1024, 600
N_SAMPLES, QUICK_N_SAMPLES = 80, 8
NORMAL_STEP = 2
N_DISCS, QUICK_N_DISCS = 20_000, 1_000
N_RAYS, QUICK_N_RAYS = 5_000, 500
"""Pixels of glass in a photo of 128 x 96 that shows much of it; others show less, half of that at least."""

SHAPE = MlpShape(width=128, layers=6, position_order=4, direction_order=4)
N_STEPS, MOST_STEPS = 30, 200


def measure(context: Context) -> Iterator[Row]:
    """D-SSIM and features against torch's own operations, kept memory, and the memory of a stream of photos."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield from _dssim(context.is_quick)
    yield from _features(QUICK_N_DISCS if context.is_quick else N_DISCS)
    yield from _kept_memory(QUICK_N_RAYS if context.is_quick else N_RAYS)
    torch.set_num_threads(before)
    yield from _stream(context.is_quick)


def _dssim(is_quick: bool) -> Iterator[Row]:
    for width, height in SIZES[: 1 if is_quick else None]:
        found, truth = torch.rand(2, height, width, 3, generator=torch.Generator().manual_seed(0))
        found.requires_grad_()
        ms = _least_ms(lambda a=found, b=truth: dssim(a, b).backward(), REPEATS)
        ratio, target = None, ("", None)
        if (width, height) == SIZES[0]:
            ratio = round(ms / _least_ms(lambda a=found, b=truth: dssim_torch(a, b).backward(), 3), 4)
            target = f"under {MOST_MS:g} ms", ms < MOST_MS
        against = "torch's operations" if ratio else ""
        yield Row(f"{width} x {height}", "D-SSIM, value and gradient", round(ms, 2), "ms", ratio, against, *target)


def _features(n: int) -> Iterator[Row]:
    splats, eye = random_splats(n), torch.tensor([0.5, -40.0, 1.0])
    splats.panels[::2] = 1
    given = torch.randn(n, 11, generator=torch.Generator().manual_seed(0))
    light = given[:, :3]

    def in_torch() -> Tensor:
        return splats.features_reference(
            eye, light_of_display(display_colours_reference(splats.means, splats.sh, eye, 3))
        )

    def there_and_back(features: Callable[[], Tensor], gradient: Tensor) -> Callable[[], None]:
        def work() -> None:
            splats.zero_grad()
            features().backward(gradient)

        return work

    light_ms = _least_ms(there_and_back(lambda: splats.colours(eye), light), REPEATS)
    ms = _least_ms(there_and_back(lambda: splats.features(eye), given), REPEATS)
    ratio = round(ms / _least_ms(there_and_back(in_torch, given), REPEATS), 4)
    yield Row(f"{n} discs", "light by direction, value and gradient", round(light_ms, 2), "ms")
    target = "under half of torch's", ratio < 0.5
    yield Row(
        f"{n} discs", "all features, value and gradient", round(ms, 2), "ms", ratio, "torch's operations", *target
    )


def _kept_memory(n: int) -> Iterator[Row]:
    generator = torch.Generator().manual_seed(0)
    mlp = ReflectionMlp(SHAPE, 0.3, generator)
    points, directions = 2.0 * torch.rand(2, n, 3, generator=generator) - 1.0
    numbers = iter(torch.randint(n // 2, n, (MOST_STEPS,), generator=generator).tolist())

    def there_and_back() -> None:
        shown = next(numbers)
        mlp(points[:shown], directions[:shown]).sum().backward()

    plain_ms = _mean_ms(there_and_back, N_STEPS)
    with freed_memory_retained():
        kept_ms = _mean_ms(there_and_back, N_STEPS)
    name = f"{n} rays, Reflection MLP {SHAPE.layers} x {SHAPE.width}"
    yield Row(name, "forward and backward, memory given back to the system", round(plain_ms, 2), "ms")
    ratio = round(kept_ms / plain_ms, 4)
    yield Row(
        name, "forward and backward, memory kept", round(kept_ms, 2), "ms", ratio, "given back", "less", ratio < 1.0
    )


def _mean_ms(work: Callable[[], None], n: int) -> float:
    """Processor time, after a few calls that are not counted: pages do not come anew in each."""
    for _ in range(3):
        work()
    started = time.process_time()
    for _ in range(n):
        work()
    return 1e3 * (time.process_time() - started) / n


def _least_ms(work: Callable[[], None], n: int) -> float:
    """Processor time, so that what else runs matters little; the first call is not counted."""
    work()
    times = []
    for _ in range(n):
        started = time.process_time()
        work()
        times.append(time.process_time() - started)
    return 1e3 * min(times)


def _stream(is_quick: bool) -> Iterator[Row]:
    n_photos, limit_mib, n_samples = (
        (QUICK_N_PHOTOS, QUICK_LIMIT_MIB, QUICK_N_SAMPLES) if is_quick else (N_PHOTOS, LIMIT_MIB, N_SAMPLES)
    )
    scene = f"{n_photos} photos of {LENS.width_px} x {LENS.height_px}"
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "photos"
        _write(folder, n_photos)
        command = [sys.executable, "-m", "tests.benchmarks.stream_process", str(folder), str(limit_mib), str(n_samples)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    found = json.loads(done.stdout)
    one_mib = decoded_bytes(LENS, Decoding(with_normals=True), NORMAL_STEP) / 2**20
    yield Row(scene, "one photo, decoded, with its layers", round(one_mib, 1), "MiB")
    target = f"at most {limit_mib} MiB", found["peak_mib"] <= limit_mib
    yield Row(scene, "memory of a stream, largest", round(found["peak_mib"]), "MiB", None, "", *target)
    per_read = n_samples / found["n_read"]
    yield Row(scene, "samples of 1024 x 768 for each photo that is read", round(per_read, 2), "")
    yield Row(scene, "processor time for each photo that is read", round(found["cpu_s"] / found["n_read"], 2), "s")


def _write(folder: Path, n_photos: int) -> None:
    """A data set whose photos are links to one: what is measured is reading them."""
    photos = cameras(folder, n_photos, 0, LENS)
    layers = ("images", "panels", "masks", "normals")
    for layer in layers:
        (folder / layer).mkdir(parents=True)
    rng = np.random.default_rng(0)
    coarse = rng.integers(0, 255, (LENS.height_px // 10, LENS.width_px // 10, 3), np.uint8)
    size = LENS.width_px, LENS.height_px
    picture = cv2.imencode(".jpg", cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC))[1]
    panels = np.zeros((LENS.height_px, LENS.width_px), np.uint16)
    corners = corners_of()
    for number in range(len(corners)):
        x = 700 * number + 300
        panels[800:3200, x : x + 600] = number + 1
    normals = np.full((LENS.height_px // NORMAL_STEP, LENS.width_px // NORMAL_STEP, 3), 30000, np.uint16)
    contents = (picture, *(cv2.imencode(".png", each)[1] for each in (panels, np.uint8(255) * (panels > 0), normals)))
    first: dict[str, Path] = {}
    for photo in photos:
        for layer, content in zip(layers, contents, strict=True):
            path = photo.path if layer == "images" else layer_path(folder, layer, photo.name)
            if layer in first:
                os.link(first[layer], path)
            else:
                path.write_bytes(content.tobytes())
                first[layer] = path
    write_model(folder / "sparse" / "0", model_of(photos))
    listed = [
        {"index": k, "id": f"A-{k}", "facade": "A", "corners_enu_m": c.tolist()} for k, c in enumerate(corners, 1)
    ]
    content = {"format": "reflight-dataset/1", "normal_step": NORMAL_STEP, "panels": listed}
    (folder / "dataset.json").write_text(json.dumps(content))


BENCHMARK = Benchmark(
    "modelling-parts",
    "Parts of the modelling",
    "D-SSIM of random pictures, value and gradient, in processor time of one thread, against the same of torch's own "
    "convolutions; what discs add to pictures, against torch's operations; and a network asked as in steps of a "
    "training, about more rays or fewer, where the C library gives free memory back and where it keeps it. The stream "
    "of photos gives random windows of 1024 x 768 with normals; what it takes is the largest resident memory of its "
    "process less that before the first sample.",
    measure,
)
