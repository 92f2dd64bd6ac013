"""Rendered photos: what rays, size, renderer and effects cost and bring, as `tradeoff scene` draws it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.tradeoff.runner import draw
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.mitsuba.plugins import mitsuba
from reconstruction.scenes.mitsuba.renderer import MitsubaRenderer
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import lens_of, square_photos
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.scene_tradeoff import (
    ERROR_AXIS,
    SceneVariants,
    make_truth,
    run_scene_variants,
    scene_panel,
    scene_rows,
    scene_settings,
    truth_error,
)
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped

SCENES_SHOWN, QUICK_SCENES = ("planar", "planar-far"), ("planar-far",)
WIDTH_PX, QUICK_WIDTH_PX, N_VIEWS = 512, 64, 1
TRUTH_RAYS, QUICK_RAYS = 128, 4


def measure(context: Context) -> Iterator[Row]:
    """Every knob on bundled scenes, seen square on."""
    try:
        mitsuba()
    except InputError as error:
        raise Skipped(str(error)) from error
    width_px = QUICK_WIDTH_PX if context.is_quick else WIDTH_PX
    truth_rays = QUICK_RAYS if context.is_quick else TRUTH_RAYS
    variants = SceneVariants((1, 2, 3), (width_px // 4, width_px // 2), (1,) if context.is_quick else (4, 16))
    panels = []
    for name in QUICK_SCENES if context.is_quick else SCENES_SHOWN:
        scene = bundled_scene(name)
        photos = square_photos(scene, lens_of(profile("m3e").camera, width_px), N_VIEWS, Path())
        decisions = tuple(decide_effects(scene, photos, RenderSettings()).values())
        truth = make_truth(scene, photos, (MitsubaRenderer, truth_rays))
        settings = scene_settings(RenderSettings(), decisions, variants, width_px)
        trials = run_scene_variants(scene, photos, truth, settings, MitsubaRenderer)
        panels.append(scene_panel(name, trials, truth))
        yield Row(name, "the truth itself is good to", round(255.0 * truth_error(truth), 2), "grey levels")
        for row in scene_rows(truth, trials):
            error = f"{row['psnr_db']} dB, {row['psnr_change_db']:+} dB; " if "psnr_db" in row else ""
            beside = f"{error}panels' mIoU {row['individual_miou']} ({row['individual_miou_change']:+})"
            yield Row(name, f"{row['setting']}: seconds a photo", row["seconds"], "s", None, beside)
    title = f"photos {width_px} px wide against Mitsuba with {truth_rays} rays a pixel"
    draw(title, panels, ERROR_AXIS, context.folder / "scene-tradeoff.png")


BENCHMARK = Benchmark(
    "scene-tradeoff",
    "What rendered photos cost and bring",
    "Photos of bundled scenes, seen square on, against the same by Mitsuba with every effect: seconds and peak "
    "signal-to-noise ratio of the embedded renderer for numbers of rays and sizes, of Mitsuba with fewer rays, and "
    "with each effect turned on or off against what the scene decides; and what each does to the search for panels in "
    "these photos, against the true ones. Noise counts for panels alone. `app.py tradeoff scene` does the "
    "same for any site.",
    measure,
)
