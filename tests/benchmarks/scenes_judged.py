"""Photographs of scenes against those of Mitsuba's path tracer: what rays, resolution and each effect bring."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.mitsuba.renderer import MitsubaRenderer
from reconstruction.scenes.parameters import (
    CURVATURE,
    DOUBLING,
    FRESNEL,
    INTERIOR,
    NEAR_FIELD,
    OCCLUSION,
    SECOND_BOUNCE,
    SHADOW,
    SKY_OCCLUSION,
    SUN_GLARE,
    TILT,
    RenderSettings,
)
from reconstruction.scenes.photos.lens_effects import MIDDLE_GREY, grey_levels
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Scene
from reconstruction.scenes.world.bundled import SCENES, bundled_scene
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped, timer
from tests.benchmarks.scenes import facing_photo

Picture = NDArray[np.float64]

SIZE_PX, QUICK_SIZE_PX = (192, 144), (32, 24)
N_RAYS, QUICK_RAYS = 192, 4
"""Of each of two pictures by Mitsuba."""

QUICK_SCENES = ("planar-far",)
SAMPLES: tuple[int, ...] = (1, 2, 4)
EFFECTS_OF_LIGHT = (
    NEAR_FIELD, FRESNEL, SECOND_BOUNCE, TILT, CURVATURE, DOUBLING, SHADOW, OCCLUSION, SKY_OCCLUSION,
)  # fmt: skip
JUDGED = RenderSettings(effects={INTERIOR: "off", SUN_GLARE: "off"})
"""Without what Mitsuba's scene has not."""

CLOSE_DB = 38.0


@dataclass(frozen=True, slots=True)
class _Case:
    """A photo and its judge: linear light, shape (h, w, 3), and what makes light of it middle grey."""

    name: str
    scene: Scene
    photo: PosedPhoto
    judged: Picture
    exposure: float

    def error_db(self, linear: NDArray[np.floating], mask: NDArray[np.bool_] | None = None) -> float:
        """Peak signal-to-noise ratio, of the pixels of a mask."""
        change = self.grey(linear) - self.grey(self.judged)
        change = change if mask is None else change[mask]
        return float(10.0 * np.log10(255.0**2 / np.mean(change**2))) if change.size else float("nan")

    def grey(self, linear: NDArray[np.floating]) -> Picture:
        return grey_levels(self.exposure * linear.astype(np.float64))


def measure(context: Context) -> Iterator[Row]:
    """Every bundled scene from the front of its middle pane."""
    size, n_rays = (QUICK_SIZE_PX, QUICK_RAYS) if context.is_quick else (SIZE_PX, N_RAYS)
    for name in QUICK_SCENES if context.is_quick else SCENES:
        scene = bundled_scene(name)
        photo = facing_photo(scene, *size)
        try:
            renderer = MitsubaRenderer(scene, JUDGED, n_rays)
        except InputError as error:
            raise Skipped(str(error)) from error
        with timer() as seconds:
            one, two = (renderer.render(photo, seed).linear.astype(np.float64) for seed in (1, 2))
        judged = 0.5 * (one + two)
        case = _Case(name, scene, photo, judged, MIDDLE_GREY / float(judged.mean()))
        # Both pictures are as far from the truth as each other, and their mean is half their difference from it.
        noise_db = 20.0 * np.log10(2.0 * 255.0 / np.sqrt(np.mean((case.grey(one) - case.grey(two)) ** 2)))
        yield Row(
            name, f"Mitsuba, {2 * n_rays} rays a pixel", seconds(), "s", None, f"its own noise: {noise_db:.1f} dB"
        )
        yield from _embedded(case)


def _embedded(case: _Case) -> Iterator[Row]:
    decided = JUDGED.decided(decide_effects(case.scene, [case.photo], JUDGED).values())
    as_decided = _taken(case, decided)[0]
    best = case.error_db(as_decided.linear)
    for samples in (*SAMPLES, "auto"):
        taken, first_s, again_s = _taken(case, replace(decided, samples=samples))  # type: ignore[arg-type]
        what = "rays where detail calls for them" if samples == "auto" else f"{samples} x {samples} rays a pixel"
        glass, sky = taken.is_glass, ~np.isfinite(taken.depth_m)
        parts = (("glass", glass), ("matt", ~(glass | sky)))
        where = ", ".join(f"{part} {case.error_db(taken.linear, mask):.1f}" for part, mask in parts if mask.any())
        total = case.error_db(taken.linear)
        is_target = samples == "auto" and case.photo.intrinsics.width_px == SIZE_PX[0]
        target = (f"over {CLOSE_DB:g} dB", total > CLOSE_DB) if is_target else ("", None)
        beside = f"{where}; {again_s:.2f} s, the first photo {first_s:.2f} s"
        yield Row(case.name, f"embedded, {what}", round(total, 2), "dB", None, beside, *target)
    for factor in (0.5, 2.0):
        error, seconds = _at_resolution(case, decided, factor)
        yield Row(
            case.name, f"embedded, {factor:g} times the resolution", round(error, 2), "dB", None, f"{seconds:.2f} s"
        )
    on = [effect for effect in EFFECTS_OF_LIGHT if decided.is_on(effect)]
    for effect in on:
        without = case.error_db(_taken(case, replace(decided, effects={**decided.effects, effect: "off"}))[0].linear)
        yield Row(case.name, f"lost without {effect}", round(best - without, 2), "dB", None, f"{without:.1f} dB")
    everything = {**decided.effects, **dict.fromkeys(EFFECTS_OF_LIGHT, "on")}
    brought = case.error_db(_taken(case, replace(decided, effects=everything))[0].linear) - best  # type: ignore[arg-type]
    left_out = ", ".join(effect for effect in EFFECTS_OF_LIGHT if effect not in on) or "none"
    yield Row(case.name, "brought by what the scene leaves out", round(brought, 2), "dB", None, left_out)


def _taken(case: _Case, settings: RenderSettings) -> tuple[RenderedPhoto, float, float]:
    """A photo, and seconds for it as the first and as another one."""
    renderer = Renderer(case.scene, settings)
    with timer() as first_s:
        renderer.render(case.photo)
    with timer() as again_s:
        taken = renderer.render(case.photo)
    return taken, first_s(), again_s()


def _at_resolution(case: _Case, settings: RenderSettings, factor: float) -> tuple[float, float]:
    """Error of a photo taken larger or smaller and brought to the judge's size, and seconds."""
    lens = case.photo.intrinsics
    other = lens.scaled(round(factor * lens.width_px), round(factor * lens.height_px))
    taken, _, seconds = _taken(replace(case, photo=replace(case.photo, intrinsics=other)), settings)
    how = cv2.INTER_AREA if factor > 1.0 else cv2.INTER_LINEAR
    return case.error_db(
        np.asarray(cv2.resize(taken.linear, (lens.width_px, lens.height_px), interpolation=how))
    ), seconds


BENCHMARK = Benchmark(
    "scenes-judged",
    "Photographs of scenes, judged by Mitsuba",
    f"Photos of {SIZE_PX[0]} x {SIZE_PX[1]} pixels of every bundled scene by the embedded renderer, 14 m before a "
    f"pane, against those of Mitsuba's path tracer with {2 * N_RAYS} rays a pixel: peak signal-to-noise ratio for "
    "numbers of rays and resolutions, and what leaving out each effect loses. Rooms are one mean light each and the "
    "sun's disc is not seen, since Mitsuba's scene has neither. Mitsuba's own noise, measured with two seeds, bounds "
    "what can be scored.",
    measure,
)
