"""Effects, both ways: leaving out what is skipped changes pictures by less than its tolerance, what is used by more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import EFFECTS, decide_effects
from reconstruction.scenes.light.pane_surfaces import pane_light
from reconstruction.scenes.parameters import (
    DISTORTION,
    DOUBLING,
    FRESNEL,
    NEAR_FIELD,
    NOISE,
    SECOND_BOUNCE,
    SHADOW,
    SKY_OCCLUSION,
    TILT,
    VIGNETTING,
    RenderSettings,
)
from reconstruction.scenes.photos.camera_model import CameraModel
from reconstruction.scenes.photos.lens_effects import Sensor, developed, grey_levels, metered_exposure, vignette
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Body, Glass, Layer, Scene, Sky, Texture
from reconstruction.scenes.world.bundled import bundled_scene
from tests.reconstruction.scenes.small_scenes import MIRROR, board, facing_south, ground, photo, ramp, scene, with_panes
from tests.slow import slow

SUNNY = Sky(sun_heading_deg=180.0, sun_elevation_deg=40.0)


def blobs(size_m: float) -> Texture:
    """Blurred noise that repeats after `size_m`: no part of it looks like another."""
    noise = np.random.default_rng(0).random((256, 256))
    smooth = cv2.GaussianBlur(np.tile(noise, (3, 3)), (0, 0), 4.0)[256:512, 256:512]
    smooth = (smooth - smooth.min()) / np.ptp(smooth)
    return Texture(np.repeat(smooth[:, :, None], 3, axis=2).astype(np.float32), 256 / size_m)


def both(made: Scene, camera: PosedPhoto, effect: str, *off: str) -> tuple[RenderedPhoto, RenderedPhoto]:
    """Photos with all effects but those that are off, and without one more."""
    with_it = RenderSettings(samples=1, effects=dict.fromkeys(off, "off"), environment_rows=400)
    without = replace(with_it, effects=dict.fromkeys((*off, effect), "off"))
    return Renderer(made, with_it).render(camera), Renderer(made, without).render(camera)


def moved_px(a: NDArray[np.float32], b: NDArray[np.float32]) -> float:
    """How far the second picture is shifted against the first, both shape (h, w): roughly, then to hundredths."""
    grey = [(255.0 * p / max(a.max(), b.max())).astype(np.uint8) for p in (a, b)]
    flow = cv2.calcOpticalFlowFarneback(grey[0], grey[1], np.zeros((*a.shape, 2), np.float32), 0.5, 3, 21, 5, 5, 1.1, 0)
    x, y = np.median(flow.reshape(-1, 2), axis=0)
    shift = np.array([[1.0, 0.0, x], [0.0, 1.0, y]], np.float32)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-7)
    _, shift = cv2.findTransformECC(a, b, shift, cv2.MOTION_TRANSLATION, criteria, None, 5)
    return float(np.hypot(*shift[:, 2]))


def mirror_image(taken: RenderedPhoto) -> NDArray[np.float32]:
    """The middle of what is mirrored, shape (96, 128)."""
    return np.ascontiguousarray(taken.reflection[48:144, 64:192, 1])


def change_grey(a: RenderedPhoto, b: RenderedPhoto) -> float:
    """Root mean square, grey levels, as developed with one exposure."""
    exposure = metered_exposure(a)
    return float(np.sqrt(((grey_levels(exposure * a.linear) - grey_levels(exposure * b.linear)) ** 2).mean()))


def decision(made: Scene, cameras: Sequence[PosedPhoto], effect: str) -> Decision:
    """What the scene decides."""
    return decide_effects(made, cameras, RenderSettings())[effect]


@pytest.mark.long
@pytest.mark.parametrize(("away_m", "used"), [(20.0, True), (20_000.0, False)])
def test_near_things_are_mirrored_from_where_they_are(away_m: float, used: bool) -> None:
    made = scene(board(-away_m, 3.0 * away_m, ramp(4.0 * away_m)), corners=facing_south(60.0, 12.0))
    camera = photo((3.0, -12.0, 10.0), 30.0)
    decided = decision(made, [camera], NEAR_FIELD)
    on, off = map(mirror_image, both(made, camera, NEAR_FIELD, SKY_OCCLUSION))
    # On a ramp in the same light everywhere a difference in light is a way along it.
    moved = float(np.median(np.abs((off - on) / np.gradient(on, axis=1))))
    assert decided.on == used == (moved > decided.tolerance)
    if used:
        # In the picture's middle, 9.9 m beside the facade's and 32 m from the board, it is 70 px.
        assert moved == pytest.approx(300.0 * 9.9 / 32.0 * np.cos(np.radians(30.0)) ** 2, rel=0.3)
        assert decided.size > moved


@pytest.mark.long
@pytest.mark.parametrize(("tilt_rad", "used"), [(0.004, True), (0.0002, False)])
def test_tilts_that_move_mirror_images_are_simulated(tilt_rad: float, used: bool) -> None:
    flat = scene(board(half_m=24.0, texture=blobs(12.0)), corners=facing_south(12.0, 8.0))
    made, camera = with_panes(flat, tilts_rad=np.array([[tilt_rad, 0.0]])), photo()
    decided = decision(made, [camera], TILT)
    on, off = both(made, camera, TILT)
    moved = moved_px(mirror_image(on), mirror_image(off))
    assert decided.on == used == (moved > decided.tolerance)
    # A camera 10 m from the pane, a board 20 m from it: 2 a t / (s + t) in radians, up to the board's edges.
    assert moved == pytest.approx(300.0 * 2.0 * tilt_rad * 20.0 / 30.0, rel=0.1, abs=0.03)
    assert decided.size == pytest.approx(moved, rel=0.25, abs=0.03)


@pytest.mark.few(1)
@pytest.mark.parametrize(("away_m", "used"), [(1.0, True), (20.0, False)])
def test_double_images_are_simulated_where_they_are_seen_apart(away_m: float, used: bool) -> None:
    glass = Glass(tint=(1.0, 1.0, 1.0))
    made = scene(board(-away_m, 8.0 + 2.0 * away_m, blobs(2.5 * away_m)), corners=facing_south(40.0, 12.0), glass=glass)
    camera = photo((0.0, -0.9, 10.0), 45.0)
    decided = decision(made, [camera], DOUBLING)
    on, off = both(made, camera, DOUBLING)
    _, d = camera.rays(np.stack(np.meshgrid(np.arange(256) + 0.5, np.arange(192) + 0.5), axis=-1).reshape(-1, 2))
    first, behind, _ = (part[:, 1].reshape(192, 256).astype(np.float32) for part in pane_light(d[:, 1], glass))
    off_all = off.reflection[..., 1] / (first + behind)
    second = (on.reflection[..., 1] - first * off_all) / behind
    moved = moved_px(np.ascontiguousarray(off_all[48:144, 64:192]), np.ascontiguousarray(second[48:144, 64:192]))
    assert decided.on == used == (moved > decided.tolerance)


@pytest.mark.long
@pytest.mark.parametrize(("heading_deg", "focal_px", "used"), [(70.0, 300.0, True), (0.0, 3000.0, False)])
def test_reflectance_by_the_angle_counts_where_panes_are_seen_from_the_side(
    heading_deg: float, focal_px: float, used: bool
) -> None:
    made = scene(ground(), corners=facing_south(60.0, 12.0), glass=Glass())
    camera = photo((0.0, -3.0, 10.0), heading_deg, focal_px=focal_px)
    decided = decision(made, [camera], FRESNEL)
    change = change_grey(*both(made, camera, FRESNEL))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.25, abs=0.05)


@pytest.mark.long
@pytest.mark.parametrize("used", [True, False])
def test_glass_is_mirrored_in_glass_where_panes_see_each_other(used: bool) -> None:
    corners = facing_south(8.0, 6.0)
    if used:
        opposite = corners * (-1.0, 1.0, 1.0) - (0.0, 12.0, 0.0)
        corners = np.concatenate([corners, opposite])
    made, camera = scene(ground(), corners=corners, glass=MIRROR), photo((2.0, -6.0, 10.0), -20.0)
    decided = decision(made, [camera], SECOND_BOUNCE)
    change = change_grey(*both(made, camera, SECOND_BOUNCE))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.25)


@pytest.mark.parametrize("used", [True, False])
def test_shadows_are_cast_where_something_stands_in_the_sun(used: bool) -> None:
    box = Body("box", Layer.NEAR, box_mesh(np.array([-2.0, -2.0, 0.0]), np.array([2.0, 2.0, 6.0])))
    bodies = (ground(), box) if used else (ground(),)
    made = scene(*bodies, corners=facing_south() - np.array([0.0, 80.0, 0.0]), sky=SUNNY)
    camera = photo((0.0, 0.0, 40.0), 0.0, -90.0)
    decided = decision(made, [camera], SHADOW)
    change = change_grey(*both(made, camera, SHADOW))
    assert decided.on == used == (change > decided.tolerance)
    assert decided.size == pytest.approx(change, rel=0.25)


@pytest.mark.few(1)
@pytest.mark.parametrize(("k1", "used"), [(-0.1, True), (-0.0005, False)])
def test_lenses_bend_pictures_where_it_shows(k1: float, used: bool) -> None:
    made = scene(board(texture=blobs(12.0)), corners=facing_south(30.0, 18.0))
    camera = photo(width_px=256, height_px=192)
    camera = replace(camera, intrinsics=replace(camera.intrinsics, distortion=(k1, 0.0, 0.0, 0.0, 0.0)))
    decided = decision(made, [camera], DISTORTION)
    on, off = (taken.reflection[:64, :64, 1].copy() for taken in both(made, camera, DISTORTION))
    moved = moved_px(on, off)
    assert decided.on == used == (moved > decided.tolerance)
    assert decided.size > moved


@pytest.mark.parametrize(("loss", "used"), [(0.25, True), (0.005, False)])
def test_dark_corners_are_simulated_where_they_show(loss: float, used: bool) -> None:
    made, camera, sensor = scene(corners=np.zeros((0, 4, 3))), photo(), Sensor(corner_loss=loss)
    decided = decide_effects(made, [camera], RenderSettings(), CameraModel(sensor=sensor))[VIGNETTING]
    light = 0.18 * vignette(192, 256, loss)
    change = float(grey_levels(np.array(0.18)) - grey_levels(light[0, 0]))
    assert decided.on == used == (change > decided.tolerance)
    settings = RenderSettings(effects={NOISE: "off"})
    picture = developed(Renderer(made, settings).render(camera), sensor=sensor)
    assert np.abs(picture.astype(float)[..., 0] - grey_levels(light)).max() <= 0.5 + 1e-6


@pytest.mark.parametrize(("full_well_e", "used"), [(20_000.0, True), (1e6, False)])
def test_noise_is_simulated_where_it_is_more_than_rounding(full_well_e: float, used: bool) -> None:
    made, camera, sensor = scene(corners=np.zeros((0, 4, 3))), photo(), Sensor(full_well_e=full_well_e)
    decided = decide_effects(made, [camera], RenderSettings(), CameraModel(sensor=sensor))[NOISE]
    settings = RenderSettings(effects={VIGNETTING: "off"})
    taken = Renderer(made, settings).render(camera, seed=3)
    noise = developed(taken, sensor=sensor).astype(float) - grey_levels(np.array(0.18))
    # Rounding adds the variance of one twelfth.
    measured = float(np.sqrt(max(noise.var() - 1.0 / 12.0, 0.0)))
    assert decided.on == used == (measured > decided.tolerance)
    assert decided.size == pytest.approx(measured, rel=0.1, abs=0.1)
    again = developed(Renderer(made, settings).render(camera, seed=4), sensor=sensor)
    assert np.array_equal(developed(taken, sensor=sensor), developed(taken, sensor=sensor))
    assert not np.array_equal(again, developed(taken, sensor=sensor)) or not used


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "near"), [("planar", True), slow("curved", True), slow("planar-far", False), ("curved-far", False)]
)
def test_bundled_scenes_are_near_or_far_as_they_say(name: str, near: bool) -> None:
    made = bundled_scene(name)
    pane = made.panes.corners_enu_m[len(made.panes.corners_enu_m) // 2]
    outwards = np.cross(pane[2] - pane[0], pane[3] - pane[1])
    position = pane.mean(axis=0) + 14.0 * outwards / np.linalg.norm(outwards) + (1.0, 0.0, 0.0)
    heading = float(np.degrees(np.arctan2(-outwards[0], -outwards[1])))
    camera = photo(tuple(position), heading, width_px=48, height_px=36, focal_px=45.0)
    assert decision(made, [camera], NEAR_FIELD).on == near
    truth = grey_levels(Renderer(made, RenderSettings(samples=4)).render(camera).linear)
    on, off = (grey_levels(taken.linear) for taken in both(made, camera, NEAR_FIELD))
    lost_db = 10.0 * np.log10(((off - truth) ** 2).mean() / ((on - truth) ** 2).mean())
    assert lost_db > 3.0 if near else lost_db < 0.1


def test_the_user_overrules_scenes_and_moves_tolerances() -> None:
    made, camera = scene(board()), photo()
    chosen = RenderSettings(effects={TILT: "on", NEAR_FIELD: "off"})
    decided = decide_effects(made, [camera], chosen)
    assert list(decided) == [effect.name for effect in EFFECTS]
    assert (decided[TILT].on, decided[TILT].decided_by) == (True, "user")
    assert (decided[NEAR_FIELD].on, decided[NEAR_FIELD].decided_by) == (False, "user")
    settings = chosen.decided(decided.values())
    assert all(settings.is_on(name) == decided[name].on for name in decided)
    patient = decide_effects(made, [camera], RenderSettings(tolerance=1e6))
    assert not any(d.on for d in patient.values())
    with pytest.raises(InputError, match="at least one"):
        decide_effects(made, [], chosen)
    with pytest.raises(InputError, match="no effect 'absent'"):
        decide_effects(made, [camera], RenderSettings(effects={"absent": "on"}))


def test_without_glass_in_sight_no_effect_of_glass_is_on() -> None:
    decided = decide_effects(scene(ground()), [photo(heading_deg=180.0)], RenderSettings())
    for name in (NEAR_FIELD, FRESNEL, SECOND_BOUNCE, TILT, DOUBLING):
        assert not decided[name].on
        assert decided[name].reason == "no photo shows glass"


def test_exposures_that_make_no_sense_are_refused() -> None:
    taken = Renderer(scene(), RenderSettings(samples=1)).render(photo(width_px=4, height_px=4))
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="exposure"):
            developed(taken, wrong)


def test_an_effect_that_there_is_not_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="no effect 'fog'; expected one of"):
        decide_effects(scene(), [photo()], RenderSettings(effects={"fog": "on"}))
