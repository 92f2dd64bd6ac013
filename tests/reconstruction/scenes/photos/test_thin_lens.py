"""Depth of field: circles of confusion as the thin lens has them, of things and of their mirror images; on and off."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from groundstation.services.scenes.photos import with_plans_lens
from planning.base.effects import EffectSetting
from planning.optics import Lens
from planning.parameters import CameraSettings
from planning.site.bundled import single_panel
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import DEPTH_OF_FIELD, RenderSettings
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.photos.thin_lens import (
    LEAST_PLACES,
    MOST_PLACES,
    ThinLens,
    n_places,
    out_of_focus,
    pinholes,
    pupil_places,
)
from reconstruction.scenes.runs.photo_job import RenderWorker
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look
from tests.missions.plans import example_plan
from tests.reconstruction.scenes.photos.test_motion_blur import DIRECT_M, MIRRORED_M, PLAIN, SMALL, half_board
from tests.reconstruction.scenes.runs.test_photo_folder import job_for
from tests.reconstruction.scenes.small_scenes import photo

DIRECT, MIRRORED = 180.0, 0.0
"""Headings: at the board itself, and at its image in the pane."""


def taken(heading_deg: float, lens: ThinLens) -> RenderedPhoto:
    renderer = Renderer(half_board(), replace(PLAIN, samples=1))
    return out_of_focus(photo(heading_deg=heading_deg, **SMALL), lens, renderer.render)


def spread_px(light: NDArray[np.float32]) -> float:
    """Standard deviation of what an edge of the middle row is spread by, pixels."""
    steps = np.abs(np.diff(light[12, 10:118, 0].astype(float)))
    steps /= steps.sum()
    x = np.arange(len(steps))
    mean = float((x * steps).sum())
    return math.sqrt(float(((x - mean) ** 2 * steps).sum()))


@pytest.mark.few(3)
@pytest.mark.parametrize("focus_m", [DIRECT_M, MIRRORED_M, math.inf])
@pytest.mark.parametrize(("heading_deg", "depth_m"), [(DIRECT, DIRECT_M), (MIRRORED, MIRRORED_M)])
def test_an_edge_is_spread_over_the_circle_of_the_thin_lens(heading_deg: float, depth_m: float, focus_m: float) -> None:
    """A disc of diameter c, seen from the side, has a standard deviation of c / 4; a pixel one of 1 / sqrt(12)."""
    lens = ThinLens(300.0, focus_m)
    circle_px = float(lens.circle_px(np.array([depth_m]), SMALL["focal_px"])[0])
    found = spread_px(taken(heading_deg, lens).linear)
    if focus_m == depth_m:
        assert circle_px == 0.0
        assert found < 0.35, "within a pixel, wherever in it the edge lies"
    else:
        assert circle_px > 2.0
        assert found == pytest.approx(math.sqrt((circle_px / 4.0) ** 2 + 1.0 / 12.0), abs=0.12 + 0.05 * circle_px)


def test_light_is_neither_lost_nor_won_and_layers_stay_those_of_the_middle() -> None:
    blurred, sharp = taken(DIRECT, ThinLens(300.0)), taken(DIRECT, ThinLens(1e-3))
    assert blurred.linear.mean() == pytest.approx(sharp.linear.mean(), rel=0.02)
    np.testing.assert_allclose(blurred.linear, blurred.diffuse + blurred.reflection, atol=1e-5)
    np.testing.assert_array_equal(blurred.panel, sharp.panel)
    np.testing.assert_array_equal(blurred.depth_m, sharp.depth_m)


@given(
    st.floats(0.1, 50.0), st.one_of(st.floats(1.0, 1e6), st.just(math.inf)), st.floats(0.5, 1e6), st.floats(-1.0, 1.0)
)
def test_what_is_in_focus_falls_on_one_pixel_and_the_rest_on_the_circle(
    pupil_mm: float, focus_m: float, depth_m: float, aside: float
) -> None:
    lens, one = ThinLens(pupil_mm, focus_m), photo(**SMALL)
    ray = np.array([0.3 * aside, 0.05, 1.0])

    def seen(depth: float) -> NDArray[np.float64]:
        point = one.pose.position_enu_m + depth * one.pose.cam_from_enu.T @ ray
        return np.concatenate([each.pixels(point[None]) for each in pinholes(one, lens, 16)])

    if math.isfinite(focus_m):
        assert np.ptp(seen(focus_m), axis=0).max() < 1e-6
    circle_px = float(lens.circle_px(np.array([depth_m]), SMALL["focal_px"])[0])
    at = seen(depth_m)
    away = np.linalg.norm(at - at.mean(axis=0), axis=1)
    assert away.max() <= 0.55 * circle_px + 1e-6
    assert away.max() >= 0.4 * circle_px - 1e-6


@given(st.floats(1.0, 20.0), st.floats(1.4, 16.0), st.floats(1.0, 1e5), st.floats(1.0, 1e5))
def test_the_circle_is_that_of_the_check_of_plans(
    focal: float, f_number: float, focus_m: float, depth_m: float
) -> None:
    """But for a focal length beside the distance, which the one of the check has."""
    pixel_mm = 0.0033
    ours = ThinLens(focal / f_number, focus_m).circle_px(np.array([depth_m]), focal / pixel_mm)[0]
    assert ours == pytest.approx(Lens(focal, f_number, pixel_mm).defocus_px(focus_m, depth_m), rel=0.03, abs=1e-9)


def test_places_of_a_pupil_are_even_over_its_disc() -> None:
    for n in (LEAST_PLACES, 9, MOST_PLACES, 500):
        places = pupil_places(n)
        assert np.allclose(places.mean(axis=0), 0.0)
        assert np.linalg.norm(places, axis=1).max() <= 0.56
    # Of a disc of diameter 1 along an axis: 1 / 4.
    assert pupil_places(500).std(axis=0) == pytest.approx([0.25, 0.25], rel=0.01)
    assert n_places(0.0) == LEAST_PLACES
    assert n_places(1e9) == MOST_PLACES


def decided(model: CameraModel, focal_px: float) -> tuple[bool, float, float]:
    views = [photo(heading_deg=each, width_px=128, height_px=24, focal_px=focal_px) for each in (DIRECT, MIRRORED)]
    found = decide_effects(half_board(), views, RenderSettings(), model)[DEPTH_OF_FIELD]
    return found.on, found.size, found.cost_s


def test_the_effect_is_off_below_half_a_pixel_on_above_and_costs_what_it_is_worth() -> None:
    assert decided(USUAL_CAMERA_MODEL, 300.0) == (False, 0.0, 0.0)
    on, size_px, cost = decided(CameraModel(pupil_mm=4.4, focus_m=10.0), 3700.0)
    assert on
    # The image of the board, at 30 m: f A (1 / 10 - 1 / 30); the sky beside it a half more.
    assert 1.08 <= size_px <= 1.63
    assert cost > 0.0
    assert not decided(CameraModel(pupil_mm=4.4, focus_m=10.0), 300.0)[0], "small pictures do not show it"
    assert not decided(CameraModel(pupil_mm=0.0), 3700.0)[0]


def test_what_is_left_out_changes_less_than_a_grey_level_and_what_is_simulated_more() -> None:
    """The same board by a pinhole and by a lens: turned both ways."""

    def change(pupil_mm: float) -> float:
        sharp, blurred = taken(MIRRORED, ThinLens(1e-6, DIRECT_M)), taken(MIRRORED, ThinLens(pupil_mm, DIRECT_M))
        return 255.0 * float(np.sqrt(((sharp.linear - blurred.linear) ** 2).mean())) / float(sharp.linear.max())

    # 0.3 and 12 px of circle.
    assert change(15.0) < 1.0 < 8.0 < change(600.0)


def test_a_plan_whose_aperture_is_stated_gives_lens_and_focus() -> None:
    plan = example_plan()
    assert with_plans_lens(USUAL_CAMERA_MODEL, plan).lens is None
    stated = replace(plan, camera_settings=CameraSettings(aperture=2.8))
    found = with_plans_lens(USUAL_CAMERA_MODEL, stated).lens
    assert found == ThinLens(plan.camera.focal_length_mm / 2.8, plan.constraints.min_distance_m)
    far = replace(plan, camera_settings=CameraSettings(aperture=2.8, focus="infinity"))
    assert with_plans_lens(USUAL_CAMERA_MODEL, far).lens == ThinLens(plan.camera.focal_length_mm / 2.8)
    own = CameraModel(pupil_mm=3.0)
    assert with_plans_lens(own, stated) is own


@pytest.mark.parametrize(
    ("field", "value"), [("pupil_mm", -1.0), ("pupil_mm", 1e3), ("focus_m", 0.0), ("focus_m", math.nan)]
)
def test_lenses_that_are_none_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        CameraModel(**{field: value})  # type: ignore[arg-type]


@pytest.mark.long
def test_a_rendered_photo_goes_through_the_lens_where_the_effect_is_on_alone(tmp_path: Path) -> None:
    def rendered(pupil_mm: float | None, setting: EffectSetting) -> dict[str, bytes]:
        job = job_for(build_scene(single_panel(), Look(near=False), 2), tmp_path)
        settings = RenderSettings(samples=1, effects={DEPTH_OF_FIELD: setting, "sky occlusion": "off"})
        model = CameraModel(pupil_mm=pupil_mm, focus_m=1.0)
        worker = RenderWorker(replace(job, camera_model=model, settings=settings), tmp_path, 1.0)
        return {name: content for name, content in worker.render(0).items() if name.lower().endswith(".jpg")}

    pinhole = rendered(None, "on")
    assert rendered(60.0, "off") == pinhole
    assert rendered(60.0, "on") != pinhole
