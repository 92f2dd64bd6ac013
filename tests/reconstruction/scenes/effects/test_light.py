"""Curvature, rooms, sun and occlusion, both ways: what is skipped changes pictures by less than its tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from planning.base.effects import Decision
from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import (
    CURVATURE,
    INTERIOR,
    NOISE,
    OCCLUSION,
    SUN_GLARE,
    TILT,
    VIGNETTING,
    RenderSettings,
)
from reconstruction.scenes.photos.lens_effects import developed, grey_levels, metered_exposure
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Body, Glass, Interiors, Layer, Scene, Sky
from tests.reconstruction.scenes.small_scenes import DULL, board, facing_south, ground, photo, ramp, scene, with_panes

BEHIND = Sky(sun_heading_deg=185.0, sun_elevation_deg=10.0)


def both(made: Scene, camera: PosedPhoto, effect: str, samples: int = 1) -> tuple[RenderedPhoto, RenderedPhoto]:
    """Photos with all effects of light, and without one."""
    photos = []
    for setting in ("on", "off"):
        settings = RenderSettings(samples=samples, effects={effect: setting, VIGNETTING: "off", NOISE: "off"})
        photos.append(Renderer(made, settings).render(camera))
    return photos[0], photos[1]


def change_grey(pair: Sequence[RenderedPhoto]) -> float:
    """Root mean square, grey levels, as developed with one exposure."""
    exposure = metered_exposure(pair[0])
    a, b = (grey_levels(exposure * taken.linear) for taken in pair)
    return float(np.sqrt(((a - b) ** 2).mean()))


def decision(made: Scene, cameras: Sequence[PosedPhoto], effect: str) -> Decision:
    """What the scene decides."""
    return decide_effects(made, cameras, RenderSettings())[effect]


@pytest.mark.few(2)
@pytest.mark.parametrize(("bow", "used"), [(0.03, True), (0.002, True), (0.0001, False), (0.0, False)])
def test_bows_that_move_mirror_images_are_simulated(bow: float, used: bool) -> None:
    made = scene(board(half_m=24.0, texture=ramp(12.0)), corners=facing_south(8.0, 6.0))
    made = with_panes(made, bows_per_m=np.array([[bow, 0.0]]))
    camera = photo(width_px=128, height_px=64, focal_px=500.0)
    decided = decision(made, [camera], CURVATURE)
    # The ramp begins anew in the middle, where nothing moves.
    on, off = (taken.reflection[:, 70:, 1].astype(float) for taken in both(made, camera, CURVATURE))
    # On a ramp a difference in light is a way along it; reflectance changes as little as the angle.
    slope = np.median(np.gradient(off, axis=1))
    moved = float(np.quantile(np.abs((on - off) / slope), 0.95))
    assert decided.on == used == (moved > decided.tolerance)
    assert decided.size == pytest.approx(moved, rel=0.12, abs=0.02)
    assert decision(made, [camera], TILT).size == 0.0


def test_a_bow_says_by_how_much_it_makes_mirror_images_narrower() -> None:
    made = with_panes(scene(board(half_m=30.0)), bows_per_m=np.array([[0.1, 0.0]]))
    # 10 m to a convex mirror of 10 m radius and 20 m on: 1 / (1 + 2 * 10 * 20 / (10 * 30)).
    camera = photo(width_px=64, height_px=48, focal_px=600.0)
    assert "appear 0.43 times as wide" in decision(made, [camera], CURVATURE).reason


def room(contrast: float) -> Interiors:
    """A bright room with dark furniture, or none."""
    block = np.array([[[-3.0, 0.0, 3.0 * contrast, 0.5, 1.0, 0.1]]])
    box = np.array([[-4.0, 4.0, -3.0, 3.0, 5.0]])
    return Interiors(box, block, np.array([1.0]), np.full((1, 3), 0.5), np.zeros(1), np.zeros((1, 3)))


@pytest.mark.few(1)
@pytest.mark.parametrize("used", [True, False])
def test_rooms_are_simulated_where_they_are_seen_through_the_glass(used: bool) -> None:
    glass = Glass(sheets=1) if used else Glass(coating=0.9, tint=(0.1, 0.1, 0.1))
    made = replace(scene(ground(), glass=glass, room=0.3), interiors=room(1.0))
    camera = photo(width_px=128, height_px=96, focal_px=150.0)
    decided = decision(made, [camera], INTERIOR)
    change = change_grey(both(made, camera, INTERIOR))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.15, abs=0.05)


def test_a_scene_without_rooms_has_none_to_see_through() -> None:
    decided = decision(scene(ground()), [photo()], INTERIOR)
    assert (decided.on, decided.size, decided.reason) == (False, 0.0, "there are no rooms behind the panes")


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(("heading_deg", "width_px", "used"), [(-4.0, 96, True), (-4.0, 256, True), (40.0, 96, False)])
def test_suns_that_panes_mirror_are_simulated(heading_deg: float, width_px: int, used: bool) -> None:
    made = with_panes(scene(ground(), sky=BEHIND, glass=Glass()), tilts_rad=np.array([[0.004, -0.003]]))
    camera = photo(
        heading_deg=heading_deg, pitch_deg=9.0, width_px=width_px, height_px=width_px * 3 // 4, focal_px=1.2 * width_px
    )
    decided = decision(made, [camera], SUN_GLARE)
    pair = both(made, camera, SUN_GLARE, 2)
    exposure = metered_exposure(pair[1])
    a, b = (developed(taken, exposure).astype(float) for taken in pair)
    change = float(np.sqrt(((a - b) ** 2).mean()))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.4)


@pytest.mark.parametrize("hidden", [False, True])
def test_a_sun_in_the_picture_is_simulated_unless_something_hides_it(hidden: bool) -> None:
    sky = replace(BEHIND, sun_heading_deg=20.0, sun_elevation_deg=20.0)
    wall = Body("wall", Layer.NEAR, box_mesh(np.array([0.0, 40.0, 0.0]), np.array([60.0, 41.0, 60.0])))
    made = scene(ground(), *([wall] if hidden else []), corners=facing_south() - [30.0, 0.0, 0.0], sky=sky)
    camera = photo(heading_deg=15.0, pitch_deg=15.0, width_px=96, height_px=72, focal_px=100.0)
    decided = decision(made, [camera], SUN_GLARE)
    pair = both(made, camera, SUN_GLARE, 2)
    exposure = metered_exposure(pair[1])
    a, b = (developed(taken, exposure).astype(float) for taken in pair)
    change = float(np.sqrt(((a - b) ** 2).mean()))
    assert decided.on == (not hidden) == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.4)
    assert decided.reason.startswith("no photo" if hidden else "1 of 1 photos see the sun, 0 its mirror image")


@pytest.mark.parametrize(
    ("sky", "reason"),
    [(DULL, "there is no sun"), (replace(BEHIND, sun_elevation_deg=0.0), "there is no sun"),
     (replace(BEHIND, sun_heading_deg=5.0), "no photo sees the sun or its mirror image")],
)  # fmt: skip
def test_no_glare_without_a_sun_before_the_facade(sky: Sky, reason: str) -> None:
    decided = decision(scene(ground(), sky=sky), [photo(), photo((2.0, -10.0, 9.0))], SUN_GLARE)
    assert (decided.on, decided.size, decided.reason) == (False, 0.0, reason)


@pytest.mark.slow
def test_a_sun_over_many_small_panes_counts_once() -> None:
    # The disc covers 9 cm of them.
    row = facing_south(0.72, 0.03, 24)
    corners = np.concatenate([row + np.array([-0.87, 0.0, 1.5 + 0.03 * k]) for k in range(18)])
    made, camera = scene(ground(), corners=corners, sky=BEHIND), photo(heading_deg=-4.0, pitch_deg=9.0)
    camera = replace(camera, intrinsics=camera.intrinsics.scaled(96, 72))
    decided = decision(made, [camera], SUN_GLARE)
    pair = both(made, camera, SUN_GLARE, 2)
    exposure = metered_exposure(pair[1])
    change = np.subtract(*(developed(taken, exposure).astype(float) for taken in pair))
    assert decided.size == pytest.approx(float(np.sqrt((change**2).mean())), rel=0.4)


def test_a_sun_that_glass_mirrors_in_glass_is_found() -> None:
    # A pane that looks south, and one at its right that looks west; the sun in the south-west, behind the camera.
    wing = np.array([(4, 0, 7), (4, -8, 7), (4, -8, 13), (4, 0, 13)], float)[None]
    corners = np.concatenate([facing_south(), wing])
    made = scene(ground(), corners=corners, sky=replace(BEHIND, sun_heading_deg=225.0))
    made = with_panes(made, tilts_rad=np.array([[0.003, -0.002], [-0.004, 0.003]]))
    camera = photo((0.0, -7.0, 9.0), 45.0, 10.0, width_px=96, height_px=72, focal_px=150.0)
    decided = decision(made, [camera], SUN_GLARE)
    pair = both(made, camera, SUN_GLARE, 3)
    exposure = metered_exposure(pair[1])
    change = np.subtract(*(developed(taken, exposure).astype(float) for taken in pair))
    assert decided.on
    assert decided.size == pytest.approx(float(np.sqrt((change**2).mean())), rel=0.5)


@pytest.mark.slow
def test_on_a_bowed_pane_the_sun_is_found_where_it_is() -> None:
    made = with_panes(scene(ground(), sky=BEHIND), bows_per_m=np.array([[0.12, 0.05]]))
    camera = photo(heading_deg=-4.0, pitch_deg=2.0, width_px=128, height_px=96, focal_px=120.0)
    decided = decision(made, [camera], SUN_GLARE)
    pair = both(made, camera, SUN_GLARE, 3)
    exposure = metered_exposure(pair[1])
    change = np.subtract(*(developed(taken, exposure).astype(float) for taken in pair))
    assert decided.on
    assert decided.size == pytest.approx(float(np.sqrt((change**2).mean())), rel=0.4)


@pytest.mark.long
@pytest.mark.parametrize("used", [True, False])
def test_what_stands_before_the_facade_hides_it(used: bool) -> None:
    y = -5.0 if used else -16.0
    box = Body("box", Layer.NEAR, box_mesh(np.array([-1.0, y - 1.0, 0.0]), np.array([1.0, y, 12.0])), (0.9, 0.2, 0.2))
    made, camera = scene(ground(), box), photo(width_px=128, height_px=96, focal_px=150.0)
    decided = decision(made, [camera], OCCLUSION)
    on, off = both(made, camera, OCCLUSION)
    change = change_grey((on, off))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.25)
    # Before the pane the box is gone; below it, where there is no facade, and in the mirror, it stays.
    bare = Renderer(replace(made, bodies=made.bodies[:1]), RenderSettings(samples=1)).render(camera)
    assert np.array_equal(off.panel, bare.panel)
    assert np.allclose(off.depth_m[off.is_glass], 10.0)
    assert (off.linear != bare.linear)[off.is_glass].any()
    if used:
        assert (on.panel != off.panel).sum() > 500
        row, column = 95, 64
        assert off.depth_m[row, column] == on.depth_m[row, column] < 6.0


def test_rays_pass_one_thing_after_another_but_not_the_buildings_own_walls() -> None:
    trees = [
        Body(f"tree {k}", Layer.NEAR, box_mesh(np.array([-3.0, y - 0.3, 0.0]), np.array([3.0, y, 20.0])))
        for k, y in enumerate((-2.0, -4.0, -6.0))
    ]
    wing = Body("wing", Layer.BUILDING, box_mesh(np.array([0.0, -3.5, 0.0]), np.array([3.0, -3.0, 20.0])))
    made, camera = scene(ground(), *trees, wing), photo(width_px=64, height_px=48, focal_px=90.0)
    _, off = both(made, camera, OCCLUSION)
    assert off.depth_m[24, 28] == pytest.approx(10.0, abs=1e-4)
    assert off.panel[24, 28] == 1
    assert off.depth_m[24, 36] == pytest.approx(6.5, abs=1e-4)
    reason = decision(made, [camera], OCCLUSION).reason
    assert reason.startswith("what is near hides ")
