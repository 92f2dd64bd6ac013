"""The sun's disc has the sun's light, in the sky and in panes, whatever the pixels; lenses scatter without loss."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.light.pane_surfaces import pane_light
from reconstruction.scenes.light.tracing import RADIUS_RAD, Sun
from reconstruction.scenes.parameters import SUN_GLARE, RenderSettings
from reconstruction.scenes.photos.lens_effects import SCATTERED, bloomed, developed, metered_exposure
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Body, Glass, Layer, Sky
from tests.reconstruction.scenes.small_scenes import MIRROR, facing_south, ground, photo, scene, with_panes

Array = NDArray[np.float64]

BLACK = (0.0, 0.0, 0.0)
BEHIND = Sky(sun_heading_deg=185.0, sun_elevation_deg=10.0, sun=(0.8, 0.7, 0.6), zenith=BLACK, horizon=BLACK)
"""A sun behind the usual camera, which the pane mirrors into it."""


def arrived(taken: RenderedPhoto, camera: PosedPhoto) -> Array:
    """Light of all pixels on a surface that faces it, as `Sky.sun` counts it, shape (3,)."""
    height, width = taken.panel.shape
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    lens = camera.intrinsics
    rays = lens.rays(np.column_stack([columns.ravel(), rows.ravel()]))
    solid_sr = 1.0 / (lens.fx_px * lens.fy_px * np.linalg.norm(rays, axis=1) ** 3)
    return np.asarray((solid_sr[:, None] * taken.linear.reshape(-1, 3)).sum(axis=0) / math.pi)


def middle_px(taken: RenderedPhoto) -> Array:
    """Where the light's middle is, shape (2,)."""
    rows, columns = np.indices(taken.panel.shape) + 0.5
    light = taken.linear[..., 0]
    return np.array([(light * columns).sum(), (light * rows).sum()]) / light.sum()


def mirrored_px(camera: PosedPhoto, normal: Array, sun: Array) -> Array:
    """Where a flat mirror shows the sun."""
    direction = sun - 2.0 * (sun @ normal) * normal
    return camera.pixels(camera.pose.position_enu_m + direction[None])[0]


@pytest.mark.parametrize(
    ("focal_px", "samples", "within"), [(3000.0, 2, 0.01), (300.0, 4, 0.01), (300.0, 1, 0.05), (40.0, 1, 0.1)]
)
def test_a_picture_of_the_sun_has_its_light_however_coarse(focal_px: float, samples: int, within: float) -> None:
    made = scene(corners=np.zeros((0, 4, 3)), sky=replace(BEHIND, sun_heading_deg=0.0))
    camera = photo((0.0, 0.0, 5.0), 0.1, 10.05, width_px=64, height_px=48, focal_px=focal_px)
    taken = Renderer(made, RenderSettings(samples=samples)).render(camera)
    assert arrived(taken, camera) == pytest.approx(np.array(BEHIND.sun), rel=within)
    if focal_px > 1000.0:
        width_rad = (
            2.0 * math.sqrt((taken.linear[..., 0] > 0.5 * taken.linear[..., 0].max()).sum() / math.pi) / focal_px
        )
        assert math.degrees(width_rad) == pytest.approx(0.533, rel=0.03)


def test_a_disc_sends_what_the_sun_lights_surfaces_with() -> None:
    sun = Sun(BEHIND)
    solid_sr = 2.0 * math.pi * (1.0 - math.cos(RADIUS_RAD))
    assert sun.radiance() * solid_sr / math.pi == pytest.approx(np.array(BEHIND.sun), rel=1e-6)


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.01, -0.006)])
def test_the_sun_is_mirrored_where_panes_turn_it_with_the_light_they_mirror(tilt: tuple[float, float]) -> None:
    made = with_panes(scene(sky=BEHIND, room=0.0), tilts_rad=np.array([tilt]))
    camera = photo(heading_deg=-3.0, pitch_deg=8.0, width_px=96, height_px=72, focal_px=400.0)
    taken = Renderer(made, RenderSettings(samples=4)).render(camera)
    normal = np.array([tilt[0], -1.0, tilt[1]]) / np.linalg.norm([*tilt, 1.0])
    sun = BEHIND.sun_direction_enu
    assert np.abs(middle_px(taken) - mirrored_px(camera, normal, sun)).max() < 0.1
    first, behind, _ = pane_light(np.array([sun @ normal]), MIRROR)
    assert arrived(taken, camera) == pytest.approx((first + behind)[0] * BEHIND.sun, rel=0.05)
    assert not taken.diffuse.any()


def test_a_bowed_pane_makes_the_suns_image_narrower_and_its_light_less() -> None:
    flat = scene(sky=BEHIND, room=0.0)
    camera = photo(heading_deg=-4.0, pitch_deg=9.0, width_px=96, height_px=72, focal_px=1000.0)
    light = [
        arrived(Renderer(made, RenderSettings(samples=3)).render(camera), camera)[0]
        for made in (flat, with_panes(flat, bows_per_m=np.array([[0.1, 0.0]])))
    ]
    # A convex mirror of 10 m radius that bulges by 0.8 m, to 9.2 m from the eye: 1 / (1 + 2 * 9.2 / 10) as wide.
    assert light[1] / light[0] == pytest.approx(1.0 / 2.84, rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize("near_field", ["on", "off"])
def test_what_stands_before_the_sun_hides_its_mirror_image(near_field: str) -> None:
    made = scene(ground(), sky=BEHIND)
    wall = Body("wall", Layer.NEAR, box_mesh(np.array([-9.0, -31.0, 0.0]), np.array([3.0, -30.0, 40.0])))
    camera = photo(heading_deg=-4.0, pitch_deg=9.0, width_px=64, height_px=48, focal_px=300.0)
    effects = {"near-field reflection": near_field}
    free, hidden = (
        Renderer(one, RenderSettings(samples=1, effects=effects, environment_rows=128)).render(camera).linear.max()
        for one in (made, replace(made, bodies=(*made.bodies, wall)))
    )
    assert free > 1000.0
    assert hidden < 1.5


@pytest.mark.parametrize(
    ("sky", "position"),
    [
        (replace(BEHIND, sun_heading_deg=5.0), (0.0, -10.0, 10.0)),
        (replace(BEHIND, sun_elevation_deg=0.0), (0.0, -10.0, 10.0)),
        (replace(BEHIND, sun_elevation_deg=-5.0), (0.0, -10.0, 10.0)),
        (replace(BEHIND, sun=BLACK), (0.0, -10.0, 10.0)),
    ],
    ids=["behind the facade", "on the horizon", "below", "none"],
)
def test_no_sun_is_mirrored_where_there_is_none(sky: Sky, position: tuple[float, float, float]) -> None:
    camera = photo(position, width_px=64, height_px=48, focal_px=75.0)
    assert Renderer(scene(sky=sky), RenderSettings(samples=1)).render(camera).reflection.max() == 0.0


def test_a_sun_in_the_picture_makes_it_neither_black_nor_grey() -> None:
    made = scene(ground(), corners=facing_south(), sky=replace(Sky(), sun_heading_deg=10.0, sun_elevation_deg=30.0))
    camera = photo((0.0, -20.0, 10.0), 0.0, 15.0, width_px=64, height_px=48, focal_px=60.0)
    settings = [RenderSettings(samples=1, effects={SUN_GLARE: setting}) for setting in ("on", "off")]
    with_sun, without = (Renderer(made, one).render(camera) for one in settings)
    assert with_sun.linear.max() > 1000.0 > without.linear.max()
    assert metered_exposure(with_sun) == pytest.approx(metered_exposure(without), rel=0.1)
    assert SUN_GLARE in with_sun.in_camera
    grey = [developed(taken, metered_exposure(without)).astype(float).mean() for taken in (with_sun, without)]
    assert grey[0] > grey[1] + 2.0


@pytest.mark.parametrize("shape", [(48, 64), (37, 91), (5, 3), (1, 1), (300, 2)])
def test_scattered_light_is_neither_lost_nor_made(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    light = rng.uniform(0.0, 0.6, (*shape, 3))
    light[shape[0] // 2, shape[1] // 2] = (4000.0, 3000.0, 2.0)
    light[0, 0] = 50.0
    spread = bloomed(light)
    assert spread.reshape(-1, 3).sum(axis=0) == pytest.approx(light.reshape(-1, 3).sum(axis=0), rel=1e-6)
    assert spread.min() >= 0.0
    assert spread[0, 0, 0] >= 1.0


def test_pictures_without_anything_brighter_than_white_stay_as_they_are() -> None:
    light = np.random.default_rng(0).uniform(0.0, 1.0, (20, 30, 3))
    assert bloomed(light) is light
    assert np.allclose(bloomed(np.full((9, 9, 3), 7.0)), 7.0)


def test_the_veil_falls_with_the_square_of_the_distance() -> None:
    light = np.zeros((241, 321, 3))
    light[120, 160] = 1.0 + 1e6
    spread = bloomed(light)[..., 1]
    diagonal = math.hypot(241, 321)
    near, far = spread[120, 160 + 6], spread[120, 160 + 60]
    assert near / far == pytest.approx(100.0, rel=0.35)
    assert spread[120, 160] > 1.0 + (1.0 - SCATTERED) * 1e6
    # The same picture with pixels of half the size.
    fine = np.zeros((482, 642, 3))
    fine[240:242, 320:322] = 1.0 + 1e6
    again = bloomed(fine)[..., 1]
    for away in (0.05, 0.1, 0.3):
        step = round(away * diagonal)
        assert again[240, 320 + 2 * step] == pytest.approx(spread[120, 160 + step], rel=0.1)


def test_dust_keeps_its_share_of_the_sun() -> None:
    camera = photo(heading_deg=-4.0, pitch_deg=9.0, width_px=64, height_px=48, focal_px=400.0)
    clean, dirty = (
        Renderer(scene(sky=BEHIND, glass=Glass(dirt=dirt), room=0.0), RenderSettings(samples=3)).render(camera)
        for dirt in (0.0, 0.5)
    )
    assert dirty.reflection.sum() == pytest.approx(0.5 * clean.reflection.sum(), rel=1e-5)
