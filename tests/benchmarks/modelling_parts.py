"""Parts of the modelling that other parts wait for: D-SSIM, and photos from the disk within a memory limit."""

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

from reconstruction.cameras import Intrinsics
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.georeference import model_of
from reconstruction.dataset.prepare import layer_path
from reconstruction.modelling.decoded_photo import Decoding, decoded_bytes
from reconstruction.modelling.dssim import dssim, dssim_torch
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.reconstruction.reflections.made_folder import cameras, corners_of

SIZES = ((256, 192), (1024, 768))
MOST_MS = 8.0
REPEATS = 15
N_PHOTOS, QUICK_N_PHOTOS = 600, 60
LENS = Intrinsics(5280, 3956, 3700.0, 3700.0, 2640.0, 1978.0)
"""Of a DJI M3E."""

LIMIT_MIB, QUICK_LIMIT_MIB = 1024, 600
N_SAMPLES, QUICK_N_SAMPLES = 80, 8
NORMAL_STEP = 2


def measure(context: Context) -> Iterator[Row]:
    """D-SSIM against torch's own operations, and the memory of a stream of photos."""
    yield from _dssim(context.is_quick)
    yield from _stream(context.is_quick)


def _dssim(is_quick: bool) -> Iterator[Row]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    for width, height in SIZES[: 1 if is_quick else None]:
        found, truth = torch.rand(2, height, width, 3, generator=torch.Generator().manual_seed(0))
        found.requires_grad_()
        ms = _least_ms(lambda a=found, b=truth: dssim(a, b).backward(), REPEATS)
        ratio, wished = None, ("", None)
        if (width, height) == SIZES[0]:
            ratio = round(ms / _least_ms(lambda a=found, b=truth: dssim_torch(a, b).backward(), 3), 4)
            wished = f"under {MOST_MS:g} ms", ms < MOST_MS
        against = "torch's operations" if ratio else ""
        yield Row(f"{width} x {height}", "D-SSIM, value and gradient", round(ms, 2), "ms", ratio, against, *wished)
    torch.set_num_threads(before)


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
    wished = f"at most {limit_mib} MiB", found["peak_mib"] <= limit_mib
    yield Row(scene, "memory of a stream, largest", round(found["peak_mib"]), "MiB", None, "", *wished)
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
    "convolutions. The stream of photos gives random windows of 1024 x 768 with normals; what it takes is the largest "
    "resident memory of its process less that before the first sample.",
    measure,
)
