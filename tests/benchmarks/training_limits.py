"""What trainings of many and large photos take: parts are measured on few small photos, and added up."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import torch

from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.training import train_reflections
from reconstruction.training.callbacks import Callbacks
from reconstruction.training.photos.decoded_photo import Decoding, decode_photo, decoded_bytes, normal_step_of
from reconstruction.training.presets import preset
from reconstruction.training.timer import Timer
from reconstruction.training.train import train_model
from tests.benchmarks.experiments import on_one_thread, rendered
from tests.benchmarks.harness import Benchmark, Context, Row

N_VIEWS, WIDTH_PX = 8, 768
QUICK_N_VIEWS, QUICK_WIDTH_PX = 6, 64

N_STEPS, N_LIGHT_STEPS = 7, 40
PRESETS = ("10min", "1h", "overnight")
"""Whose windows and numbers of splats are measured."""

LOOKS = 12
"""At each pixel, on average: about 1000 steps of the preset `10min` on 85 photos of 256 x 192 pixels."""

N_PHOTOS = (100, 560)
WIDTHS_PX = (512, 1320, 2640, 5280)
RATIO = 0.75
"""Height of a photo, of its width."""


@dataclass(frozen=True, slots=True)
class _Costs:
    """Processor seconds.

    Parameters
    ----------
    reading
        Of a photo, for each megapixel: its rays of glass, and its pixels.
    light
        Of a step of learning light alone.
    joint
        Of a joint step, for each megapixel of its window, by preset.
    bytes_per_px
        Of a photo in memory.
    """

    reading: float
    light: float
    joint: dict[str, float]
    bytes_per_px: float


def measure(context: Context) -> Iterator[Row]:
    """Costs of the parts, and what trainings of so many photos would take."""
    is_quick = context.is_quick
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    with tempfile.TemporaryDirectory() as place:
        costs = _costs(rendered("planar", Path(place) / "planar", n_views, width), is_quick)
    torch.set_num_threads(before)
    on = f"{n_views} photos, {width} px"
    yield Row(on, "reading, for each megapixel of photos", round(costs.reading, 3), "s")
    yield Row(on, "step of learning light", round(1e3 * costs.light, 1), "ms")
    for name, seconds in costs.joint.items():
        yield Row(on, f"joint step of {name}, for each megapixel of its window", round(seconds, 2), "s")
    yield Row(on, "photos in memory", round(costs.bytes_per_px, 1), "bytes per pixel")
    for n_photos in N_PHOTOS:
        for width_px in WIDTHS_PX:
            yield _row(costs, n_photos, width_px)


def _costs(folder: Path, is_quick: bool) -> _Costs:
    source = read_photo_set(folder)
    lens = source.photos[0].intrinsics
    glass_rays(source, source.photos[:1])
    begun_s = time.process_time()
    rays = glass_rays(source, source.photos)
    decoding, step = Decoding(1, True), normal_step_of(folder)
    for photo in source.photos:
        decode_photo(source, photo, decoding, step)
    reading = (time.process_time() - begun_s) / (len(source.photos) * lens.width_px * lens.height_px / 1e6)
    steps = ReflectionConfig(steps=N_LIGHT_STEPS)
    trained = train_reflections(rays, source.panels, "radiance-grid", steps, clock=time.process_time)
    joint = {name: _joint(folder, name) for name in (("smoke",) if is_quick else PRESETS)}
    n_bytes = decoded_bytes(lens, decoding, step) / (lens.width_px * lens.height_px)
    return _Costs(reading, trained.seconds / trained.n_steps, joint, n_bytes)


def _joint(folder: Path, name: str) -> float:
    """Processor seconds of a joint step for each megapixel of its window: the median of a few."""
    base = on_one_thread(preset(name))
    config = replace(
        base,
        light="radiance-grid",
        time_limit_s=None,
        iterations=N_STEPS,
        reflections=replace(base.reflections, steps=4),
        device="cpu",
    )
    times: list[float] = []
    train_model(folder, config, Callbacks(visit=lambda at: times.append(at.seconds)), watch=Timer(time.process_time))
    lens = read_photo_set(folder).photos[0].intrinsics
    window_px = min(config.window_px, lens.width_px * lens.height_px)
    # The first step compiles, and the last visit is after the end.
    took = [later - earlier for earlier, later in pairwise(times[1:-1])]
    return statistics.median(took) / (window_px / 1e6)


def _row(costs: _Costs, n_photos: int, width_px: int) -> Row:
    """Hours by the preset whose steps are the cheapest for each pixel, and how much memory holds all photos."""
    name = min(costs.joint, key=lambda each: costs.joint[each])
    megapixels = n_photos * width_px * RATIO * width_px / 1e6
    settings = preset(name).reflections.for_grid
    light_s = settings.steps * costs.light
    seconds = costs.reading * megapixels + light_s + LOOKS * costs.joint[name] * megapixels
    beside = (
        f"by {name}; {light_s / 3600.0:.1f} h of it for light, and {costs.bytes_per_px * megapixels / 1024.0:.1f} GiB "
        "would hold all photos at once"
    )
    return Row(
        f"{n_photos} photos, {width_px} px", "extrapolated: a core", round(seconds / 3600.0, 2), "h", None, beside
    )


BENCHMARK = Benchmark(
    "training-limits",
    "Practical limits of trainings",
    f"Processor time of the parts of a training, on one thread and {N_VIEWS} rendered photos of {WIDTH_PX} px of the "
    f"bundled planar scene, and what trainings of real flights come to by these: all photos read once, light learned "
    f"alone, and each pixel looked at {LOOKS} times by steps of the preset that is cheapest for each pixel. The hours "
    "are extrapolated, not measured; rendering splats uses all cores and divides them by their number at best. On "
    "graphics cards nothing was measured here.",
    measure,
)
