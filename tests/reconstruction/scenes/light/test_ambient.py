"""Light from around: against integrals that can be worked out, hard cases, and the effect both ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planning.base import jit
from planning.geo.mesh import box_mesh, from_corners
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.light.shading import GROUND_ALBEDO
from reconstruction.scenes.light.tracing import Switches, Tracer
from reconstruction.scenes.parameters import NOISE, SKY_OCCLUSION, VIGNETTING, RenderSettings
from reconstruction.scenes.photos.lens_effects import grey_levels, metered_exposure
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Body, Layer, Scene, Sky
from reconstruction.scenes.world.bundled import bundled_scene
from tests.reconstruction.scenes.small_scenes import DULL, board, ground, photo, quad, scene

NOTHING = np.zeros((0, 4, 3))


def light_on(made: Scene, points: list[tuple[float, float, float]], normal: tuple[float, float, float]) -> np.ndarray:
    """Light from around, red, on surfaces just below or behind points, shape (n,)."""
    tracer = Tracer(made, Switches())
    assert tracer.ambient is not None
    at, n = np.array(points, float), np.broadcast_to(np.array(normal, float), (len(points), 3))
    hits = tracer.geometry.meet(at + 0.5 * n, -n)
    assert (hits.bodies >= 0).all()
    return tracer.ambient.on(hits.points_enu_m, hits.normals_enu, hits.triangles)[:, 0]


def black(body: Body) -> Body:
    return replace(body, albedo=(0.0, 0.0, 0.0))


def long_wall() -> Body:
    return black(quad([(-400, 10, 0), (400, 10, 0), (400, 10, 8), (-400, 10, 8)], "wall", Layer.NEAR))


def test_open_ground_gets_the_whole_sky() -> None:
    made = scene(ground(), corners=NOTHING, sky=DULL)
    assert light_on(made, [(0, 0, 0), (31.7, -20.2, 0)], (0, 0, 1)) == pytest.approx(0.5, abs=1e-3)


def test_a_long_black_wall_takes_the_sky_that_its_form_factor_says() -> None:
    # Of ground at a distance d from an endless wall of height h, (1 - cos(atan(h / d))) / 2 (M. Modest, 2013, App. D).
    made = scene(ground(), long_wall(), corners=NOTHING, sky=DULL)
    away = np.array([0.8, 2.0, 6.0, 20.0, 60.0])
    got = light_on(made, [(0.0, 10.0 - d, 0.0) for d in away], (0, 0, 1))
    expected = 0.5 * (1.0 - 0.5 * (1.0 - np.cos(np.arctan(8.0 / away))))
    # 64 rays, and linear between nodes a metre apart.
    assert np.abs(got - expected).max() < 0.025


def test_what_stands_around_sends_light_in_its_turn() -> None:
    # White ground before a black wall is as bright as above; of what it sends, an angle below the horizon counts with
    # half its cosine for a place high up on the wall.
    white = replace(ground(), albedo=(1.0, 1.0, 1.0))
    height = 4.5
    below = np.linspace(0.05, 0.5 * np.pi - 1e-6, 20_000)
    away = height / np.tan(below)
    sent = 0.5 * (1.0 - 0.5 * (1.0 - np.cos(np.arctan(8.0 / away))))
    from_ground = np.trapezoid(0.5 * np.cos(below) * sent, below) + 0.5 * 0.5 * np.sin(0.05)
    got = light_on(scene(white, long_wall(), corners=NOTHING, sky=DULL), [(0.0, 10.0, height)], (0, -1, 0))
    assert got == pytest.approx(0.25 + from_ground, abs=0.015)
    dark = light_on(scene(black(white), long_wall(), corners=NOTHING, sky=DULL), [(0.0, 10.0, height)], (0, -1, 0))
    # The ground ends after 100 m, where the sky below the horizon begins.
    assert dark == pytest.approx(0.25 + 0.5 * 0.5 * height / 110.0, abs=0.015)


def test_both_sides_of_a_face_get_their_own_light() -> None:
    roof = black(quad([(-50, -50, 5), (50, -50, 5), (50, 50, 5), (-50, 50, 5)], "roof", Layer.NEAR))
    made = scene(black(ground()), roof, corners=NOTHING, sky=DULL)
    assert light_on(made, [(0, 0, 5)], (0, 0, 1)) == pytest.approx(0.5, abs=1e-3)
    assert light_on(made, [(0, 0, 5)], (0, 0, -1))[0] < 0.05


def test_places_next_to_what_stands_on_them_are_not_lit_from_its_inside() -> None:
    # Grid nodes under the box are in the dark; the ground beside it sees three quarters of the sky or more.
    box = black(Body("box", Layer.NEAR, box_mesh(np.array([-5.5, -5.5, 0.0]), np.array([5.5, 5.5, 1.0]))))
    made = scene(ground(), box, corners=NOTHING, sky=DULL)
    around = [(x, y, 0.0) for x in (-5.9, 5.9) for y in np.linspace(-5.0, 5.0, 11)]
    assert light_on(made, around, (0, 0, 1)).min() > 0.25


@pytest.mark.slow
def test_no_place_gets_more_light_than_there_is_and_none_is_not_a_number() -> None:
    bright = Sky(sun=(0, 0, 0), zenith=(1, 1, 1), horizon=(1, 1, 1))
    made = bundled_scene("court")
    white = tuple(replace(body, albedo=(1.0, 1.0, 1.0), texture=None) for body in made.bodies)
    panes = replace(made.panes, rooms=np.ones_like(made.panes.rooms))
    made = replace(made, sky=bright, bodies=white, panes=panes, interiors=None)
    tracer = Tracer(made, Switches())
    view = photo((5.0, -12.0, 9.0), 20.0, width_px=32, height_px=24, focal_px=27.0)
    places = np.stack(np.meshgrid(np.arange(32) + 0.5, np.arange(24) + 0.5), axis=-1).reshape(-1, 2)
    light = tracer.trace(*view.rays(places), 0.02)
    total = light.diffuse + light.reflection
    assert np.isfinite(total).all()
    assert total.max() < 1.0 + 1e-5
    assert total.min() >= 0.0


@pytest.mark.parametrize("thin_m", [0.0, 1e-9, 1e-4])
def test_slivers_and_faces_without_area_get_light_that_is_a_number(thin_m: float) -> None:
    corners = np.array([[(0, 0, 3), (4, 0, 3), (2, 0, 3 + thin_m)]], float)
    sliver = Body("sliver", Layer.NEAR, from_corners(corners))
    tracer = Tracer(scene(ground(), sliver, corners=NOTHING), Switches())
    assert tracer.ambient is not None
    n = len(tracer.geometry.normals_enu)
    light = tracer.ambient.on(tracer.geometry.corners_enu_m[:, 0], np.tile([0.0, -1.0, 0.0], (n, 1)), np.arange(n))
    assert np.isfinite(light).all()


@pytest.mark.slow
def test_it_is_the_same_whatever_was_asked_for_before() -> None:
    made = bundled_scene("planar-far")
    view = photo((2.0, 14.0, 9.0), 180.0, width_px=40, height_px=30, focal_px=30.0)
    fresh = Renderer(made, RenderSettings(samples=1)).render(view)
    renderer = Renderer(made, RenderSettings(samples=1))
    renderer.render(photo((-9.0, 20.0, 4.0), 160.0, width_px=40, height_px=30, focal_px=30.0))
    assert np.array_equal(renderer.render(view).linear, fresh.linear)


def changed(made: Scene, view: PosedPhoto) -> float:
    """What the switch changes in a picture, root mean square in grey levels."""
    silent = {VIGNETTING: "off", NOISE: "off"}
    on, off = (
        Renderer(made, RenderSettings(samples=1, effects={**silent, SKY_OCCLUSION: setting})).render(view)  # type: ignore[dict-item]
        for setting in ("on", "off")
    )
    exposure = metered_exposure(on)
    change = grey_levels(exposure * on.linear) - grey_levels(exposure * off.linear)
    return float(np.sqrt(np.mean(change**2)))


@pytest.mark.slow
def test_it_is_on_in_a_court_and_changes_the_picture_by_more_than_its_tolerance() -> None:
    made = bundled_scene("court")
    view = photo((6.0, -10.0, 8.0), 30.0, width_px=40, height_px=30, focal_px=28.0)
    decided = decide_effects(made, [view], RenderSettings())[SKY_OCCLUSION]
    assert decided.on
    assert changed(made, view) > decided.tolerance
    assert "% of the light of an open sky" in decided.reason


def test_it_is_off_before_a_lone_wall_and_changes_the_picture_by_less() -> None:
    around = np.full((64, 128, 3), 0.5)
    around[32:] = GROUND_ALBEDO * 0.5
    made = scene(board(), corners=NOTHING, sky=replace(DULL, panorama=around.astype(np.float32)))
    view = photo((0.0, -5.0, 10.0), 180.0, width_px=64, height_px=48, focal_px=45.0)
    decided = decide_effects(made, [view], RenderSettings())[SKY_OCCLUSION]
    assert not decided.on
    assert changed(made, view) < decided.tolerance


def test_a_scene_without_bodies_needs_none() -> None:
    decided = decide_effects(scene(), [photo()], RenderSettings())[SKY_OCCLUSION]
    assert not decided.on


@pytest.mark.slow
def test_it_is_the_same_for_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    made = bundled_scene("concrete")
    view = photo((2.0, 12.0, 4.0), 170.0, -10.0, width_px=240, height_px=160, focal_px=160.0)
    several = Renderer(made, RenderSettings(samples=1)).render(view)
    monkeypatch.setattr(jit, "n_threads", lambda: 1)
    one = Renderer(made, RenderSettings(samples=1)).render(view)
    assert np.array_equal(several.linear, one.linear)
