"""Mitsuba's path tracer as judge: where both models say the same, pictures agree up to the noise of random rays.

Two seeds tell that noise. What a picture lies off their mean by, less the noise, is a disagreement: in squares of grey
levels it must be under a quarter of that noise (half a grey level besides, for the embedded renderer's fixed rays and
for light that goes to and fro between surfaces). In each test something is also broken on Mitsuba's side alone, and
must lie off by more than the noise: four times as much, a distance of 6 dB.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("mitsuba", reason="the optional extra 'mitsuba' is not installed")

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.geo.mesh import box_mesh
from planning.site.bundled import single_panel
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.scenes.light.pane_surfaces import fresnel, pane_light
from reconstruction.scenes.light.shading import GROUND_ALBEDO
from reconstruction.scenes.mitsuba import plugins as mitsuba_plugins
from reconstruction.scenes.mitsuba.plugins import SheetRole, mitsuba, sheet_shares, survives
from reconstruction.scenes.mitsuba.renderer import SAMPLES, MitsubaRenderer, renderer_of
from reconstruction.scenes.parameters import INTERIOR, SUN_GLARE, RenderSettings
from reconstruction.scenes.photos.flight_views import square_photos
from reconstruction.scenes.photos.lens_effects import grey_levels
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Body, Glass, Layer, Rgb, Scene, Sky, Texture
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look
from tests.reconstruction.scenes.small_scenes import BOARD_Y_M, checkerboard, photo, quad, scene, with_panes

Array = NDArray[np.float64]

N_RAYS = 12
OWN_GREY = 0.5
"""Half a grey level."""


def grey(
    renderer: Renderer | MitsubaRenderer, taken: PosedPhoto, seed: int = 1, moved_enu_m: Array | None = None
) -> Array:
    return grey_levels(renderer.render(taken, seed, moved_enu_m).linear.astype(float))


def judge(made: Scene, effects: dict[str, EffectSetting] | None = None, n_rays: int = N_RAYS) -> MitsubaRenderer:
    return MitsubaRenderer(made, RenderSettings(effects=effects or {}), n_rays, "scalar_rgb")


def assert_agree_unless(
    broken: Callable[[Scene], Scene],
    made: Scene,
    taken: PosedPhoto,
    effects: dict[str, EffectSetting] | None = None,
    n_rays: int = N_RAYS,
    moved_enu_m: Array | None = None,
) -> None:
    """Agreement of the scene, and none where Mitsuba gets a broken one or effects are switched off there."""
    embedded = grey(Renderer(made, RenderSettings(samples=16)), taken, 1, moved_enu_m)
    renderer = judge(made, None, n_rays)
    lights = [renderer.render(taken, seed, moved_enu_m).linear.astype(float) for seed in (1, 2)]
    one, two, both = (grey_levels(light) for light in (*lights, 0.5 * (lights[0] + lights[1])))
    wrong = grey(judge(broken(made), effects, n_rays), taken, 1, moved_enu_m)
    noise = 0.25 * float(np.mean((one - two) ** 2))
    off = float(np.mean((embedded - both) ** 2)) - noise
    off_broken = float(np.mean((embedded - wrong) ** 2)) - 2.0 * noise
    band = noise + OWN_GREY**2
    assert off < 0.25 * band
    assert off_broken > band


def same(made: Scene) -> Scene:
    return made


def camera(
    position: tuple[float, float, float] = (0.0, -10.0, 10.0), heading_deg: float = 0.0, pitch_deg: float = 0.0
) -> PosedPhoto:
    return photo(position, heading_deg, pitch_deg, width_px=24, height_px=18, focal_px=22.0)


def wall(texture: Texture) -> Body:
    """An upright wall along the whole south that faces north."""
    corners = [(90.0, BOARD_Y_M, 0.0), (-90.0, BOARD_Y_M, 0.0), (-90.0, BOARD_Y_M, 20.0), (90.0, BOARD_Y_M, 20.0)]
    return quad(corners, "wall", Layer.NEAR, texture)


LOW_SUN = Sky(sun_heading_deg=-60.0, sun_elevation_deg=1.0, sun=(1.0, 0.9, 0.8), zenith=(0, 0, 0), horizon=(0, 0, 0))
"""Alone in the dark, out of sight, and so low that it lights nothing but what stands upright."""


def even_sky(light: float, sun: Rgb, sun_heading_deg: float, sun_elevation_deg: float) -> Sky:
    """Above ground as the embedded renderer assumes it, of which nothing else is in the scene."""
    ground = GROUND_ALBEDO * (np.array(sun) * math.sin(math.radians(sun_elevation_deg)) + light)
    around = np.full((64, 128, 3), light)
    around[32:] = ground
    return Sky(sun_heading_deg, sun_elevation_deg, sun, panorama=around.astype(np.float32))


COARSE = replace(checkerboard(), px_per_m=8.0)
"""Squares of four metres, 32 texels along each side."""

GLAZED = Glass(index=1.52, coating=0.1, tint=(0.7, 0.8, 0.9), sheets=2, gap_m=0.016)


@pytest.mark.slow
def test_a_textured_wall_is_mirrored_alike() -> None:
    def shifted(made: Scene) -> Scene:
        """By a texel, an eighth of a metre; a pixel shows a metre."""
        return replace(made, bodies=(wall(replace(COARSE, picture=np.roll(COARSE.picture, 1, axis=1))),))

    assert_agree_unless(shifted, scene(wall(COARSE), sky=LOW_SUN), camera((0.0, -3.0, 10.0)))


@pytest.mark.slow
@pytest.mark.parametrize(("heading_deg", "index"), [(10.0, 2.2), (65.0, 1.1)])
def test_double_panes_mirror_alike_at_all_angles(heading_deg: float, index: float) -> None:
    def of_other_glass(made: Scene) -> Scene:
        return replace(made, glasses=(replace(GLAZED, index=index),))

    made = scene(wall(COARSE), glass=GLAZED, sky=LOW_SUN, room=0.05)
    position = (-4.0 * math.sin(math.radians(heading_deg)), -4.0 * math.cos(math.radians(heading_deg)), 10.0)
    assert_agree_unless(of_other_glass, made, camera(position, heading_deg))


@pytest.mark.slow
def test_without_fresnel_both_mirror_at_a_slant_as_at_normal_incidence() -> None:
    made = scene(wall(COARSE), glass=replace(GLAZED, coating=0.0), sky=LOW_SUN, room=0.05)
    assert_agree_unless(same, made, camera((-6.0, -2.0, 10.0), 70.0), {"Fresnel": "off"})


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["panel tilt", "curvature"])
def test_tilted_and_bowed_panes_mirror_alike(effect: str) -> None:
    bent = {"tilts_rad": np.array([[0.03, -0.02]]), "bows_per_m": np.array([[0.01, 0.02]])}
    made = with_panes(scene(wall(COARSE), sky=LOW_SUN), **bent)
    assert_agree_unless(same, made, camera((0.0, -3.0, 10.0)), {effect: "off"})


@pytest.mark.slow
def test_a_textured_wall_lies_alike_in_sun_and_shadow() -> None:
    def elsewhere(made: Scene) -> Scene:
        return replace(made, sky=replace(made.sky, sun_heading_deg=made.sky.sun_heading_deg + 8.0))

    pole = Body("pole", Layer.NEAR, box_mesh(np.array([-6.5, -6.3, 0.0]), np.array([-5.9, -5.7, 30.0])))
    light = even_sky(0.9, (0.7, 0.6, 0.5), -30.0, 20.0)
    made = scene(wall(COARSE), pole, sky=light, corners=np.zeros((0, 4, 3)))
    assert_agree_unless(elsewhere, made, camera((0.0, -2.0, 10.0), 180.0), n_rays=8 * N_RAYS)


@pytest.mark.slow
def test_the_sky_is_seen_and_mirrored_alike() -> None:
    def turned_over(made: Scene) -> Scene:
        assert made.sky.panorama is not None
        return replace(made, sky=replace(made.sky, panorama=np.ascontiguousarray(made.sky.panorama[:, ::-1])))

    heading, row = np.meshgrid(np.arange(32) / 32.0, np.arange(16) / 16.0)
    around = np.stack([heading, row, 0.5 + 0.5 * np.sin(4.0 * math.pi * heading)], axis=-1)
    made = scene(sky=replace(LOW_SUN, panorama=around.astype(np.float32)))
    assert_agree_unless(turned_over, made, camera((3.0, -4.0, 12.0), 20.0, 10.0))


@pytest.mark.slow
def test_lenses_that_bend_and_pixels_that_are_not_square_show_the_same() -> None:
    straight = camera((0.0, -5.0, 10.0), 180.0)
    inner = replace(straight.intrinsics, fy_px=26.0, cx_px=10.0, distortion=(-0.15, 0.02, 0.003, -0.002, 0.0))
    bent = replace(straight, intrinsics=inner)
    made = scene(wall(COARSE), sky=replace(LOW_SUN, sun_heading_deg=-30.0), corners=np.zeros((0, 4, 3)))
    assert_agree_unless(same, made, bent, {"lens distortion": "off"})


@pytest.mark.slow
def test_a_camera_that_moves_blurs_alike() -> None:
    made = scene(wall(COARSE), sky=replace(LOW_SUN, sun_heading_deg=-30.0), corners=np.zeros((0, 4, 3)))
    assert_agree_unless(
        same, made, camera((0.0, -5.0, 10.0), 180.0), {"motion blur": "off"}, moved_enu_m=np.array([3.0, 0.0, 0.5])
    )


def test_fresnel_terms_of_both_agree_at_all_angles() -> None:
    mi = mitsuba("scalar_rgb")
    for index in (1.0, 1.33, 1.52, 2.4):
        cosines = np.cos(np.radians([0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.9]))
        theirs = [mi.fresnel(float(cosine), index)[0] for cosine in cosines]
        assert fresnel(cosines, index) == pytest.approx(theirs, abs=2e-6)


def test_a_thin_dielectric_is_a_single_pane_but_for_its_polarisation() -> None:
    # Mitsuba averages polarisations before it adds up reflections to and fro, which mirrors more at a slant.
    thin = mitsuba("scalar_rgb").load_dict({"type": "thindielectric", "int_ior": 1.52, "ext_ior": 1.0})
    found = []
    cosines = np.cos(np.radians([0.0, 40.0, 60.0, 75.0]))
    for cosine in cosines:
        mi = mitsuba("scalar_rgb")
        si = mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(math.sqrt(1.0 - cosine**2), 0.0, cosine)
        sample, weight = thin.sample(mi.BSDFContext(), si, 0.0, mi.Point2f(0.5, 0.5))
        assert sample.wo.z > 0.0
        found.append(sample.pdf * weight[0])
    first, _, _ = pane_light(cosines, Glass(tint=(1.0, 1.0, 1.0), sheets=1))
    above = np.array(found) - first[:, 0]
    assert abs(above[0]) < 1e-5
    assert (above[1:] > 0.001).all()
    assert (above < 0.03).all()


@pytest.mark.parametrize("glass", [Glass(), GLAZED, Glass(sheets=1, coating=0.3), Glass(coating=0.97)])
def test_sheets_share_light_out_as_panes_do(glass: Glass) -> None:
    mi = mitsuba("scalar_rgb")
    cosines = np.linspace(0.0, 1.0, mitsuba_plugins.STEPS + 1)
    first, behind, through = pane_light(cosines, glass)
    parts = ("front", "back", "whole")
    front, back, whole = (sheet_shares(mi, SheetRole(glass, part, True)).transpose(1, 0, 2) for part in parts)
    assert np.abs(front[0] - first).max() < 1e-5
    assert np.abs(front[1] - through).max() < 1e-5
    assert np.abs(front[1] * back[0] - behind).max() < 1e-5
    assert np.abs(whole[0] - first - behind).max() < 1e-5
    assert np.abs(whole[1] - through).max() < 1e-5


@pytest.mark.slow
def test_the_same_seed_gives_the_same_picture_and_another_another() -> None:
    renderer = judge(scene(sky=Sky()))
    taken = camera((0.0, -3.0, 10.0))
    one, again, other = (renderer.render(taken, seed).linear for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_without_mitsuba_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(InputError, match=r"reflight-groundstation\[mitsuba\]"):
        mitsuba()
    monkeypatch.undo()
    with pytest.raises(InputError, match="no_such_variant"):
        mitsuba("no_such_variant")


@pytest.mark.slow
def test_a_variant_that_ends_its_process_is_told_from_one_that_works() -> None:
    assert survives("scalar_rgb")
    assert not survives("no_such_variant")


@pytest.mark.slow
def test_settings_choose_the_renderer() -> None:
    made = scene()
    assert isinstance(renderer_of(made, RenderSettings()), Renderer)
    assert isinstance(renderer_of(made, RenderSettings(mitsuba_rays=1)), MitsubaRenderer)
    with pytest.raises(ValueError, match="rays: expected 1 to"):
        RenderSettings(mitsuba_rays=0)


@pytest.mark.slow
def test_rooms_that_mitsuba_lacks_are_added_and_light_adds_up() -> None:
    made = build_scene(single_panel(), Look(near=False), 2)
    (taken,) = square_photos(made, Intrinsics(16, 12, 14.0, 14.0, 8.0, 6.0), 1, Path())
    with_it, without = (
        judge(made, {INTERIOR: setting, SUN_GLARE: "off"}, 2).render(taken, 3) for setting in ("on", "off")
    )
    wanted, plain = (
        Renderer(made, RenderSettings(samples=SAMPLES, effects={INTERIOR: setting, SUN_GLARE: "off"}))
        .render(taken)
        .linear
        for setting in ("on", "off")
    )
    assert np.abs(wanted - plain).max() > 0.01
    np.testing.assert_allclose(with_it.linear, np.maximum(without.linear + (wanted - plain), 0.0), atol=1e-6)
    for one in (with_it, without):
        np.testing.assert_allclose(one.diffuse + one.reflection, one.linear, atol=1e-6)
