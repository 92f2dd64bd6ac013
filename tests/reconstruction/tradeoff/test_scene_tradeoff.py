"""What rays, sizes and effects of rendered photos cost and bring."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import NEAR_FIELD, NOISE, SHADOW, RenderSettings
from reconstruction.scenes.photos.flight_views import square_photos
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.scene_tradeoff import (
    SceneVariants,
    make_truth,
    run_scene_variants,
    scene_panel,
    scene_rows,
    scene_settings,
    truth_error,
)

LENS = Intrinsics(32, 24, 25.6, 25.6, 16.0, 12.0)


class _Noisy:
    """Stands for a renderer whose pictures differ from seed to seed by one grey level, standard deviation."""

    def __init__(self, scene, settings, n_rays):
        self._renderer, self._n_rays = Renderer(scene, settings), n_rays

    def render(self, photo, seed=0):
        taken = self._renderer.render(photo, seed)
        shades = np.random.default_rng(seed).normal(1.0, 0.2 / math.sqrt(self._n_rays), taken.linear.shape)
        return replace(taken, linear=(taken.linear * np.maximum(shades, 0.0)).astype(np.float32))


@pytest.fixture(scope="module")
def small():
    """A scene with its photos, its truth, and all that was tried."""
    scene = bundled_scene("planar")
    photos = square_photos(scene, LENS, 2, Path(), seed=1)
    decisions = tuple(decide_effects(scene, photos, RenderSettings()).values())
    truth = make_truth(scene, photos, None)
    variants = SceneVariants((1, 3), (16, 32), (4,), (NEAR_FIELD, NOISE, SHADOW))
    settings = scene_settings(RenderSettings(environment_rows=64), decisions, variants, LENS.width_px)
    return scene, photos, truth, settings, run_scene_variants(scene, photos, truth, settings, _Noisy)


@pytest.mark.slow
def test_every_way_is_tried_once_and_sizes_that_change_nothing_are_left_out(small):
    names = [trial.setting.name for trial in small[4]]
    assert names == [
        "as the scene decides",
        "samples 1",
        "samples 3",
        "width 16",
        "rays 4",
        f"effect {NEAR_FIELD} off",
        f"effect {SHADOW} off",
        f"effect {NOISE} off",
        "all effects on",
        "all effects off",
    ]


@pytest.mark.slow
def test_more_rays_are_nearer_to_the_truth_and_effects_that_the_scene_calls_for_are_missed(small):
    by_name = {trial.setting.name: trial for trial in small[4]}
    decided = by_name["as the scene decides"].psnr_db
    assert by_name["samples 1"].psnr_db < by_name["samples 3"].psnr_db
    assert by_name["width 16"].psnr_db < decided - 5.0
    assert by_name[f"effect {NEAR_FIELD} off"].psnr_db < decided - 5.0
    assert by_name[f"effect {SHADOW} off"].psnr_db < decided - 3.0
    # Noise is in no comparison: no second picture repeats it.
    assert by_name[f"effect {NOISE} off"].psnr_db == pytest.approx(decided, abs=1e-9)
    assert by_name["rays 4"].psnr_db < decided


@pytest.mark.slow
def test_the_truth_says_how_far_it_has_converged(small):
    scene, photos, exact, _, _ = small
    assert truth_error(exact) == 0.0
    one, four = (make_truth(scene, photos[:1], (_Noisy, n)) for n in (16, 64))
    assert "64 rays" in four.name
    assert truth_error(one) == pytest.approx(2.0 * truth_error(four), rel=0.25)


@pytest.mark.slow
def test_the_table_compares_panels_with_those_found_in_the_truth(small):
    _, _, truth, _, trials = small
    first, base, *rest = scene_rows(truth, trials)
    assert (first["setting"], first["individual_miou_change"]) == ("the truth", 0.0)
    assert (base["setting"], base["psnr_change_db"]) == ("as the scene decides", 0.0)
    for row in (base, *rest):
        assert row["individual_miou_change"] == pytest.approx(
            row["individual_miou"] - first["individual_miou"], abs=2e-4
        )
    panel = scene_panel("a title", trials, truth)
    assert [line.name for line in panel.lines] == [
        "as the scene decides", "samples", "width", "rays", "effect", "all effects",
    ]  # fmt: skip
    assert panel.marks == ()


def test_what_makes_no_sense_is_refused():
    with pytest.raises(InputError, match="no effect 'fog'"):
        SceneVariants(effects=("fog",))
    with pytest.raises(InputError, match="--rays: expected 1 or more, got 0"):
        SceneVariants(rays=(0, 4))


@pytest.mark.slow
def test_rays_need_the_renderer_that_has_them(small):
    scene, photos, truth, settings, _ = small
    with pytest.raises(ValueError, match="rays 4"):
        run_scene_variants(scene, photos, truth, [one for one in settings if one.rays])
