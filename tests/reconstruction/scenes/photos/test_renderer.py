"""Photographs: mirror images where optics puts them, energy, truth of pixels, and places where formulas break."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base import jit
from planning.base.errors import InputError
from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import Intrinsics
from reconstruction.scenes.light.pane_surfaces import pane_light
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer
from reconstruction.scenes.record import Body, Glass, Layer, Scene, Sky
from reconstruction.scenes.world.bundled import bundled_scene
from tests.reconstruction.scenes.small_scenes import (
    BOARD_Y_M,
    DULL,
    MIRROR,
    SQUARE_M,
    board,
    facing_south,
    ground,
    photo,
    ramp,
    scene,
    with_panes,
)

RAMP_M = 24.0


def take(made: Scene, *args: object, samples: int = 1, **kwargs: object) -> RenderedPhoto:
    """A photo of the usual camera, or of another one."""
    return Renderer(made, RenderSettings(samples=samples)).render(photo(*args, **kwargs))  # type: ignore[arg-type]


def is_finite(taken: RenderedPhoto) -> bool:
    """All light and normals; depth may be infinite, but is never NaN."""
    numbers = (taken.linear, taken.diffuse, taken.reflection, taken.normal_enu)
    return all(np.isfinite(a).all() for a in numbers) and not np.isnan(taken.depth_m).any()


@pytest.mark.slow
def test_corners_of_a_mirrored_checkerboard_are_where_optics_puts_them() -> None:
    made = scene(board(), corners=facing_south(30.0, 18.0))
    camera = photo((3.0, -6.0, 9.0), -14.0, 4.0, width_px=240, height_px=180, focal_px=1200.0)
    taken = Renderer(made, RenderSettings(samples=4)).render(camera)
    steps = np.arange(-10.0, 10.0, SQUARE_M)
    x, z = np.meshgrid(steps, steps + 10.0)
    # The plane of the pane is y = 0: the board's image stands as far behind it.
    virtual = np.column_stack([x.ravel(), np.full(x.size, -BOARD_Y_M), z.ravel()])
    expected = camera.pixels(virtual)
    inside = ((expected > 15.0) & (expected < np.array([225.0, 165.0]))).all(axis=1)
    expected = expected[inside]
    assert len(expected) > 60
    # Detectors of corners are exact to a hundredth of a pixel in pictures without steps.
    grey = cv2.GaussianBlur(taken.reflection[..., 1], (0, 0), 1.5)
    start = (expected - 0.5 + 0.4).astype(np.float32).reshape(-1, 1, 2)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 60, 1e-5)
    found = cv2.cornerSubPix(grey, start.copy(), (8, 8), (-1, -1), criteria).reshape(-1, 2) + 0.5
    assert np.linalg.norm(found - expected, axis=1).max() < 0.05


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("tilt", "bow"), [((0.0, 0.0), (0.0, 0.0)), ((0.005, -0.003), (0.0, 0.0)), ((0.002, 0.001), (0.002, -0.001))]
)
def test_tilted_and_bowed_panes_mirror_by_the_normal_of_each_point(
    tilt: tuple[float, float], bow: tuple[float, float]
) -> None:
    made = with_panes(
        scene(board(texture=ramp(RAMP_M))), tilts_rad=np.array([tilt], float), bows_per_m=np.array([bow], float)
    )
    camera = photo((-1.0, -8.0, 9.0), 6.0, 5.0)
    taken = Renderer(made, RenderSettings(samples=1, effects={"sky occlusion": "off"})).render(camera)
    rows, columns = np.nonzero(taken.is_glass)
    origins, d = camera.rays(np.column_stack([columns, rows]) + 0.5)
    p = origins
    # Step by step to where the glass stands before the flat pane, 8 m x 6 m.
    for _ in range(30):
        x, z = p[:, 0], p[:, 2] - 10.0
        before = 0.5 * (bow[0] * (16.0 - x**2) + bow[1] * (9.0 - z**2)) - tilt[0] * x - tilt[1] * z
        p = origins - ((origins[:, 1] + before) / d[:, 1])[:, None] * d
    right, up = tilt[0] + bow[0] * p[:, 0], tilt[1] + bow[1] * (p[:, 2] - 10.0)
    n = np.column_stack([right, np.full(len(p), -1.0), up])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    cosine = -(d * n).sum(axis=1)
    r = d + 2.0 * cosine[:, None] * n
    x = p[:, 0] + (BOARD_Y_M - p[:, 1]) / r[:, 1] * r[:, 0]
    z = p[:, 2] + (BOARD_Y_M - p[:, 1]) / r[:, 1] * r[:, 2]
    # A board that faces north has the east on its left.
    light = 0.6 * ((-x / RAMP_M) % 1.0) * (0.5 + 0.2 * 0.5) / 2.0
    first, behind, _ = pane_light(cosine, MIRROR)
    whole = (np.abs(x) > 0.5) & (np.abs(x) < 11.5) & (np.abs(z - 10.0) < 11.5)
    assert whole.sum() > 1000
    got = taken.reflection[rows, columns, 1] / (first + behind)[:, 1]
    # One texel of the ramp is 0.1 % of white.
    assert np.abs(got - light)[whole].max() < 5e-4
    assert np.abs(taken.normal_enu[rows, columns] - n).max() < 1e-6
    along = (p - origins) @ camera.pose.forward_enu
    assert np.abs(taken.depth_m[rows, columns] - along).max() < 2e-6, "a float32 at 10 m"


def test_in_light_that_is_the_same_everywhere_nothing_is_brighter() -> None:
    sky = replace(DULL)
    clear = Glass(tint=(1.0, 1.0, 1.0), coating=0.3)
    everything = scene(corners=facing_south(200.0, 18.0, 7), glass=clear, sky=sky, room=0.5)
    taken = take(everything, (0.0, -0.5, 10.0), 80.0)
    assert taken.is_glass.any()
    assert np.abs(taken.linear - 0.5).max() < 1e-6
    tinted = replace(everything, glasses=(Glass(coating=0.3),))
    assert take(tinted, (0.0, -0.5, 10.0), 80.0).linear.max() <= 0.5 + 1e-6


def test_a_photograph_knows_what_its_pixels_show() -> None:
    taken = take(scene(ground(), corners=facing_south(4.0, 3.0, columns=4)))
    assert np.array_equal(np.unique(taken.panel), np.arange(5))
    row = taken.panel[96]
    assert np.array_equal(row[np.flatnonzero(np.diff(row)) + 1], [1, 2, 3, 4, 0])
    assert np.array_equal(taken.is_glass, taken.panel > 0)
    assert np.allclose(taken.depth_m[taken.is_glass], 10.0)
    assert np.allclose(taken.normal_enu[taken.is_glass], (0.0, -1.0, 0.0))
    sky = taken.depth_m == np.inf
    assert sky[0].all()
    assert (taken.normal_enu[sky] == 0.0).all()
    assert np.allclose(taken.normal_enu[~sky & ~taken.is_glass], (0.0, 0.0, 1.0))
    assert (taken.reflection[~taken.is_glass] == 0.0).all()
    assert np.array_equal(taken.linear, taken.diffuse + taken.reflection)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("position", "heading_deg", "focal_px"),
    [
        ((0.0, -0.001, 10.0), 0.0, 300.0),
        ((0.0, -0.001, 10.0), 89.9, 300.0),
        ((-8.0, 0.0, 10.0), 90.0, 300.0),
        ((0.0, 0.0, 10.0), 0.0, 300.0),
        ((0.0, 5.0, 10.0), 180.0, 300.0),
        ((4.0, -1.0, 13.0), -50.0, 300.0),
        ((0.0, -10_000.0, 10.0), 0.0, 300_000.0),
        ((9_999.9, -1.0, 10.0), -90.0, 300_000.0),
    ],
    ids=["1 mm off", "1 mm off, along", "in the plane", "on the pane", "behind", "corner", "10 km", "10 km, grazing"],
)
def test_no_light_is_lost_to_arithmetic(
    position: tuple[float, float, float], heading_deg: float, focal_px: float
) -> None:
    corners = facing_south(columns=3)
    tilted = with_panes(
        scene(board(), ground(), corners=corners, glass=Glass()),
        tilts_rad=np.full((3, 2), 0.01),
        bows_per_m=np.full((3, 2), 0.003),
    )
    assert is_finite(take(tilted, position, heading_deg, focal_px=focal_px))


def test_panes_ten_kilometres_away_are_where_they_are() -> None:
    made = scene(corners=facing_south(6.0, 4.0))
    camera = photo((900.0, -10_000.0, 1510.0), -5.1428, -8.4986, focal_px=300_000.0)
    taken = Renderer(made, RenderSettings(samples=1)).render(camera)
    corners = camera.pixels(made.panes.corners_enu_m[0])
    area = cv2.contourArea(corners.astype(np.float32))
    assert taken.is_glass.sum() == pytest.approx(area, rel=0.01)
    rows, columns = np.nonzero(taken.is_glass)
    box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1])
    assert np.abs(box - np.concatenate([corners.min(axis=0), corners.max(axis=0)])).max() <= 0.6


@pytest.mark.slow
def test_the_number_of_threads_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    # More than one chunk of rays.
    renderer = Renderer(scene(board(), ground()), RenderSettings())
    several = renderer.render(photo(width_px=200, height_px=200))
    monkeypatch.setattr(jit, "n_threads", lambda: 1)
    one = renderer.render(photo(width_px=200, height_px=200))
    assert np.array_equal(several.linear, one.linear)
    assert np.array_equal(several.normal_enu, one.normal_enu)


@pytest.mark.slow
def test_several_rays_where_detail_calls_for_them_do_nearly_as_well_as_everywhere() -> None:
    made = bundled_scene("planar")
    camera = photo((3.0, 13.0, 9.0), 178.0, width_px=120, height_px=90, focal_px=90.0)
    settings = [RenderSettings(samples=6), RenderSettings(samples=1), RenderSettings()]
    truth, single, auto = (np.sqrt(Renderer(made, s).render(camera).linear) for s in settings)
    one_ray, some = (-10.0 * np.log10(((p - truth) ** 2).mean()) for p in (single, auto))
    # Measured in larger pictures: 36 and 45 dB.
    assert 28.0 < one_ray < 40.0
    assert some > one_ray + 6.0


def test_textures_far_away_are_their_mean() -> None:
    facing_camera = board(20.0, 30.0)
    upright = replace(facing_camera, mesh=replace(facing_camera.mesh, triangles=facing_camera.mesh.triangles[:, ::-1]))
    made = scene(upright)
    taken = take(made, (0.0, -300.0, 10.0), width_px=16, height_px=12, focal_px=300.0)
    # Squares of half a metre are half a pixel here; a board's light is 0.6 of half white, in sky light all around.
    seen = taken.linear[~taken.is_glass & (taken.depth_m < 400.0)]
    assert seen == pytest.approx(0.6 * 0.5 * 0.5, rel=0.05)


def test_a_shadow_lies_where_the_sun_puts_it() -> None:
    sky = Sky(sun_heading_deg=90.0, sun_elevation_deg=45.0, sun=(1.0, 1.0, 1.0), zenith=(0, 0, 0), horizon=(0, 0, 0))
    box = Body("box", Layer.NEAR, box_mesh(np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 3.0])))
    made = scene(box, ground(), sky=sky)
    camera = photo((-3.0, 0.0, 50.0), 0.0, -90.0)
    taken = Renderer(made, RenderSettings(samples=1)).render(camera)
    # The top's west edge, x = -1, z = 3, throws its shadow to x = -4.
    for x, lit in ((-1.5, False), (-3.9, False), (-4.1, True), (1.5, True)):
        column, row = (camera.pixels(np.array([[x, 0.3, 0.0]]))[0]).astype(int)
        assert (taken.linear[row, column, 0] > 0.3) == lit


def test_a_lens_bends_the_picture_unless_that_is_switched_off() -> None:
    made, straight = scene(board()), photo()
    bent = replace(straight, intrinsics=replace(straight.intrinsics, distortion=(-0.2, 0.0, 0.0, 0.0, 0.0)))
    edge = bent.pixels(np.array([[-4.0, 0.0, 10.0]]))[0]
    taken = Renderer(made, RenderSettings(samples=1)).render(bent)
    assert abs(np.flatnonzero(taken.is_glass[int(edge[1])])[0] - edge[0]) <= 0.5
    off = Renderer(made, RenderSettings(samples=1, effects={"lens distortion": "off"})).render(bent)
    assert np.array_equal(off.linear, take(made).linear)
    assert not np.array_equal(off.linear, taken.linear)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"samples": 0}, "samples"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"environment_rows": 1}, "environment_rows"),
    ],
)
def test_settings_that_make_no_sense_are_refused(wrong: dict[str, object], said: str) -> None:
    with pytest.raises((InputError, ValueError), match=said):
        RenderSettings(**wrong)  # type: ignore[arg-type]


def test_a_scene_without_anything_is_sky() -> None:
    nothing: NDArray[np.float64] = np.zeros((0, 4, 3))
    taken = Renderer(scene(corners=nothing), RenderSettings(effects={"near-field reflection": "off"})).render(
        replace(photo(), intrinsics=Intrinsics(1, 1, 10.0, 10.0, 0.5, 0.5))
    )
    assert np.allclose(taken.linear, 0.5)
    assert taken.depth_m[0, 0] == np.inf
