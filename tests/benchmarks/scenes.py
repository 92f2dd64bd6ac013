"""Photographs of scenes: what samples cost and bring, and what leaving an effect out loses."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import NEAR_FIELD, RenderSettings
from reconstruction.scenes.photos.lens_effects import grey_levels, metered_exposure
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Scene
from reconstruction.scenes.world.bundled import SCENES, bundled_scene
from tests.benchmarks.fresh_process import run_measured
from tests.benchmarks.harness import Benchmark, Context, Row, timer

SIZE_PX, QUICK_SIZE_PX = (512, 384), (96, 72)
QUICK_SCENES = ("planar", "planar-far")
AWAY_M = 14.0
TRUTH_SAMPLES = 8
SAMPLES: tuple[int, ...] = (1, 2, 3, 4)
A_SECOND, NEAR_DB, FAR_DB = 1.0, 3.0, 0.1
TOWER_PX, TOWER_PHOTOS, MEMORY_GB = 5280, 600, 4.0


def measure(context: Context) -> Iterator[Row]:
    """Every bundled scene from the front of its middle pane."""
    size = QUICK_SIZE_PX if context.is_quick else SIZE_PX
    for name in QUICK_SCENES if context.is_quick else SCENES:
        scene = bundled_scene(name)
        photo = facing_photo(scene, *size)
        truth = _grey(scene, photo, RenderSettings(samples=TRUTH_SAMPLES))
        yield from _samples(name, scene, photo, truth)
        yield from _near_field(name, scene, photo, truth)
    yield from _tower(QUICK_SIZE_PX[0] if context.is_quick else TOWER_PX)


def _samples(name: str, scene: Scene, photo: PosedPhoto, truth: NDArray[np.float64]) -> Iterator[Row]:
    """Time and error of a photo, everything else as the scene decides."""
    decided = RenderSettings().decided(decide_effects(scene, [photo], RenderSettings()).values())
    for samples in (*SAMPLES, "auto"):
        settings = RenderSettings(samples=samples, effects=decided.effects)  # type: ignore[arg-type]
        renderer = Renderer(scene, settings)
        renderer.render(photo)
        with timer() as seconds:
            taken = renderer.render(photo)
        error = _psnr_db(grey_levels(_exposed(taken.linear, scene, photo)), truth)
        what = "rays where detail calls for them" if samples == "auto" else f"{samples} x {samples} rays a pixel"
        is_target = samples == "auto" and photo.intrinsics.width_px == SIZE_PX[0]
        target = (f"under {A_SECOND:g} s", seconds() < A_SECOND) if is_target else ("", None)
        yield Row(
            name, what, seconds(), "s", None, f"{error:.1f} dB against {TRUTH_SAMPLES} x {TRUTH_SAMPLES}", *target
        )


def _near_field(name: str, scene: Scene, photo: PosedPhoto, truth: NDArray[np.float64]) -> Iterator[Row]:
    """What is lost where one picture of the surroundings stands in for what is near."""
    decision = decide_effects(scene, [photo], RenderSettings())[NEAR_FIELD]
    with_it, without = (
        _psnr_db(_grey(scene, photo, RenderSettings(effects={NEAR_FIELD: setting})), truth) for setting in ("on", "off")
    )
    lost = with_it - without
    target, met = (
        (f"more than {NEAR_DB:g} dB", lost > NEAR_DB) if decision.on else (f"under {FAR_DB:g} dB", lost < FAR_DB)
    )
    state = "on" if decision.on else "off"
    beside = f"{without:.1f} dB without; the scene says {state}, {decision.size:.3g} {decision.unit}"
    yield Row(name, "lost without near-field reflection", round(lost, 2), "dB", None, beside, target, met)


def _tower(width_px: int) -> Iterator[Row]:
    """What a large job takes."""
    done = run_measured(["-m", "tests.benchmarks.tower_photo", str(width_px)])
    photo = json.loads(done.printed)
    scene = f"tower of 3640 panels, {width_px} x {photo['height_px']} pixels"
    yield Row(scene, "a photo with its files, on all cores", photo["wall_s"], "s")
    yield Row(scene, "processor time of a photo with its files", photo["cpu_s"], "s")
    yield Row(scene, f"processor time of {TOWER_PHOTOS} photos", TOWER_PHOTOS * photo["cpu_s"] / 3600.0, "h")
    peak_gb = done.peak_mib * 2**20 / 1e9
    yield Row(
        scene, "largest memory of the process", peak_gb, "GB", None, "", f"under {MEMORY_GB:g} GB", peak_gb < MEMORY_GB
    )


def facing_photo(scene: Scene, width_px: int, height_px: int) -> PosedPhoto:
    """From `AWAY_M` before the middle pane, towards it."""
    pane = scene.panes.corners_enu_m[len(scene.panes.corners_enu_m) // 2]
    outwards = np.cross(pane[2] - pane[0], pane[3] - pane[1])
    position = pane.mean(axis=0) + AWAY_M * outwards / np.linalg.norm(outwards) + np.array([1.0, 0.5, 1.0])
    heading = float(np.degrees(np.arctan2(-outwards[0], -outwards[1])))
    focal = 0.9 * width_px
    lens = Intrinsics(width_px, height_px, focal, focal, width_px / 2, height_px / 2)
    return PosedPhoto("a", Path("a.jpg"), lens, Pose.looking(position, heading, -3.0))


def _exposed(linear: NDArray[np.float32], scene: Scene, photo: PosedPhoto) -> NDArray[np.float64]:
    exposure = metered_exposure(Renderer(scene, RenderSettings(samples=1)).render(photo))
    return np.asarray(exposure * linear, np.float64)


def _grey(scene: Scene, photo: PosedPhoto, settings: RenderSettings) -> NDArray[np.float64]:
    return grey_levels(_exposed(Renderer(scene, settings).render(photo).linear, scene, photo))


def _psnr_db(found: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    return float(10.0 * np.log10(255.0**2 / np.mean((found - truth) ** 2)))


BENCHMARK = Benchmark(
    "scenes",
    "Photographs of scenes",
    "Photos of 512 x 384 pixels of every bundled scene by the embedded renderer, 14 m before a pane: seconds and "
    "peak signal-to-noise ratio against 64 rays a pixel with all effects, for fixed numbers of rays and for rays where "
    "detail calls for them; and what is lost where one picture of the surroundings stands in for what is near. Then a "
    "photo of a large tower at a camera's full size, with all its files: time, and memory of one process.",
    measure,
)
