"""How long pictures of finished models take, by Gaussians, pixels and what panels mirror, and what coarse ones lack."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from functools import partial

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from groundstation.services.reconstruct.render_queue import LARGE, QUICK_PX
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import untrained_panels
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.splats.merged_splats import splats_of_detail
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import NO_PANEL, Splats
from reconstruction.training.config import ANTIALIASED
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.render import render_view
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.reconstruction.objects.synthetic_scene import pane

WALL_M, GROUND_M = (60.0, 40.0), 120.0
COLUMNS, ROWS = 40, 20
"""Panels of the wall."""

NUMBERS, QUICK_NUMBERS = (10_000, 100_000, 1_000_000), (2_000,)
WIDTHS, QUICK_WIDTHS = (160, 320, 640, 1280), (40, 80)
LIGHTS: tuple[ModelName, ...] = ("environment-map", "mlp")
MOST_S = 0.1
"""Of a picture while the model is led about, which has as many pixels as that allows."""

LED_WIDTH = 320
REPEATS = 3


def measure(context: Context) -> Iterator[Row]:
    """Least of some repeats, all threads."""
    numbers, widths = (QUICK_NUMBERS, QUICK_WIDTHS) if context.is_quick else (NUMBERS, WIDTHS)
    first: dict[int, float] = {}
    for n in numbers:
        model = building(n)
        fine = picture(model, widths[-1])
        for width in widths:
            seconds = _least_s(model, width)
            against = seconds / first.setdefault(width, seconds)
            yield Row(_name(n), _what(width), round(1000 * seconds, 1), "ms", against, _name(numbers[0]))
        for width in widths[:-1]:
            coarse = cv2.resize(picture(model, width), fine.shape[1::-1], interpolation=cv2.INTER_LINEAR)
            quality = psnr_db(float(np.square(coarse - fine).mean()))
            yield Row(_name(n), f"{_what(width)}, against {widths[-1]} wide", round(quality, 1), "dB")
        if context.is_quick or n >= LARGE:
            yield from _quick(model, fine, widths[:-1])
    n, plain_s = numbers[0], {width: _least_s(building(numbers[0]), width) for width in widths[1:3]}
    for light in LIGHTS:
        model = building(n, light)
        for width, without_s in plain_s.items():
            seconds = _least_s(model, width)
            name = f"{_name(n)}, panels that mirror: {light}"
            yield Row(name, _what(width), round(1000 * seconds, 1), "ms", seconds / without_s, "without")


def _quick(model: SceneModel, fine: NDArray[np.float32], widths: tuple[int, ...]) -> Iterator[Row]:
    """Rows of pictures in which splats finer than pixels are drawn as one."""
    n = len(model.splats)
    begun = time.perf_counter()
    detail = splats_of_detail(model.splats)
    yield Row(_name(n), "made ready for quick pictures", round(time.perf_counter() - begun, 2), "s")
    for width in widths:
        whole_s = _least_s(model, width)

        def drawn(width: int = width) -> NDArray[np.float32]:
            return picture(model.with_splats(detail.for_view(view(width), QUICK_PX)), width)

        seconds, name = _least_of(drawn), f"{_what(width)}, quick"
        target = _target(width, n, seconds)
        yield Row(_name(n), name, round(1000 * seconds, 1), "ms", seconds / whole_s, "all of it", *target)
        coarse = cv2.resize(drawn(), fine.shape[1::-1], interpolation=cv2.INTER_LINEAR)
        quality = psnr_db(float(np.square(coarse - fine).mean()))
        yield Row(_name(n), f"{name}, against {fine.shape[1]} wide", round(quality, 1), "dB")


def building(n: int, light: ModelName | None = None) -> SceneModel:
    """A wall of panels and the ground before it, evenly covered by discs whose colours change along both."""
    rng = np.random.default_rng(0)
    n_wall = n // 2
    width, height = WALL_M
    wall = np.column_stack([rng.uniform(0, width, n_wall), np.zeros(n_wall), rng.uniform(0, height, n_wall)])
    ground = rng.uniform((-GROUND_M / 2, -GROUND_M, 0), (width + GROUND_M / 2, 0, 0), (n - n_wall, 3))
    areas = np.repeat([width * height, GROUND_M * (width + GROUND_M)], [n_wall, n - n_wall])
    sizes = 0.7 * np.sqrt(areas / (n / 2))
    upright = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    means = np.concatenate([wall, ground])
    waves = np.sin(means @ rng.normal(scale=1.5, size=(3, 3))) + 0.3 * rng.normal(size=(n, 3))
    columns, rows = np.floor(wall[:, 0] / width * COLUMNS), np.floor(wall[:, 2] / height * ROWS)
    panels = np.concatenate([rows * COLUMNS + columns, np.full(n - n_wall, NO_PANEL)])
    as_floats = partial(torch.tensor, dtype=torch.float32)
    splats = Splats.of(
        as_floats(means),
        as_floats(np.repeat([upright, (1.0, 0.0, 0.0, 0.0)], [n_wall, n - n_wall], axis=0)),
        as_floats(np.column_stack([sizes, sizes])),
        torch.full((n,), 0.9),
        as_floats(np.clip(0.5 + 0.2 * waves, 0.0, 1.0)),
        torch.tensor(panels).int(),
    )
    corners = np.array(
        [pane(k % COLUMNS, k // COLUMNS, width / COLUMNS, height / ROWS) for k in range(COLUMNS * ROWS)], np.float64
    )
    planes = PanelPlanes(corners)
    glass = None
    if light is not None:
        generator = torch.Generator().manual_seed(0)
        means_of_panels = torch.full((len(corners), 3), 0.2)
        glass = untrained_panels(planes, light, ReflectionConfig(), means_of_panels, generator).light
    return SceneModel(splats, Sky(), glass, planes, np.zeros(3), 1.0).eval()


def view(width: int) -> View:
    """As the Model tab shows it at first: the wall, from in front."""
    height, focal = 3 * width // 4, 1.0 * width
    from_world = np.eye(4)
    from_world[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    from_world[:3, 3] = -from_world[:3, :3] @ (0.5 * WALL_M[0], -65.0, 0.45 * WALL_M[1])
    return View(width, height, focal, focal, width / 2, height / 2, torch.tensor(from_world))


def picture(model: SceneModel, width: int) -> NDArray[np.float32]:
    """Of `view`, display values."""
    return render_view(model, view(width), settings=ANTIALIASED).display


def _least_s(model: SceneModel, width: int) -> float:
    return _least_of(lambda: picture(model, width))


def _least_of(work: Callable[[], object]) -> float:
    found = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        work()
        found.append(time.perf_counter() - begun)
    return min(found)


def _target(width: int, n: int, seconds: float) -> tuple[str, bool] | tuple[()]:
    if (width, n) != (LED_WIDTH, NUMBERS[-1]):
        return ()
    return f"at most {1000 * MOST_S:g} ms", seconds <= MOST_S


def _name(n: int) -> str:
    return f"{n} Gaussians"


def _what(width: int) -> str:
    return f"{width} x {3 * width // 4}"


BENCHMARK = Benchmark(
    "model-frames",
    "Pictures of finished models: time against pixels and Gaussians",
    "A wall of 800 panels and the ground before it, evenly covered by discs; the more there are, the smaller they are. "
    "Pictures as the Model tab shows them, with all threads, and what coarse ones, made larger, lack against the "
    "finest; quick ones, while the camera is led about, draw splats finer than pixels as one, and none out of sight. "
    "Light that panels mirror is that of untrained models, which takes as long.",
    measure,
)
