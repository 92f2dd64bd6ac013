"""Bowed and tilted panes: mirror images of cylinders where optics puts them, exact meetings, and hard cases."""

from __future__ import annotations

import itertools
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq

from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.light.geometry import Geometry
from reconstruction.scenes.light.pane_surfaces import PaneSurfaces, mirrored, pane_light
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Glass, Scene, Texture
from tests.reconstruction.scenes.small_scenes import MIRROR, board, checkerboard, facing_south, photo, scene, with_panes

Array = NDArray[np.float64]

PANE_M, BOARD_Y_M = 1.5, -20.0
STEEP = np.radians(60.0)


def cylinder(radius_m: float, square_m: float, turned_rad: float = 0.0) -> Scene:
    """Panes of 1.5 m with their corners on a convex cylinder that touches y = 0 and looks south, before a board."""
    step = 2.0 * np.arcsin(0.5 * PANE_M / radius_m)
    angles = step * (np.arange(10) - 4.5) + 0.3 * step + turned_rad
    ring = np.column_stack([radius_m * np.sin(angles), radius_m * (1.0 - np.cos(angles))])
    quads = [[(*a, 7.0), (*b, 7.0), (*b, 13.0), (*a, 13.0)] for a, b in itertools.pairwise(ring)]
    texture = Texture(checkerboard().picture, 32.0 / square_m)
    made = scene(board(BOARD_Y_M, 60.0, texture), corners=np.array(quads, float))
    return with_panes(made, bows_per_m=np.tile([1.0 / radius_m, 0.0], (len(quads), 1)))


def alhazen_px(camera: PosedPhoto, radius_m: float, points: Array) -> Array:
    """Pixels at which a cylinder mirrors points, shape (n, 3): by equal angles, solved for each by itself."""
    eye, middle = camera.pose.position_enu_m, np.array([0.0, radius_m])
    found = []
    for point in points:

        def place(angle: float) -> Array:
            return middle + radius_m * np.array([np.sin(angle), -np.cos(angle)])

        def sideways(angle: float, point: Array = point) -> float:
            along = np.array([np.cos(angle), np.sin(angle)])
            ways = (end[:2] - place(angle) for end in (eye, point))
            return float(sum(way @ along / np.linalg.norm(way) for way in ways))

        ends = [np.arctan2(end[0], radius_m - end[1]) for end in (eye, point)]
        on = place(brentq(sideways, min(ends), max(ends), xtol=1e-14))
        # The normal is level: heights grow with the way in plan.
        before, after = (np.linalg.norm(end[:2] - on) for end in (eye, point))
        found.append((*on, eye[2] + (point[2] - eye[2]) * before / (before + after)))
    return camera.pixels(np.array(found))


def board_places(made: Scene, camera: PosedPhoto, pixels: Array) -> Array:
    """x and z where mirrored rays meet the board's plane, shape (n, 2)."""
    geometry = Geometry(made)
    origins, directions = camera.rays(pixels)
    hits, normals = PaneSurfaces(made.panes, geometry.pane_frames).meet(geometry.meet(origins, directions), directions)
    out = mirrored(directions, normals)
    ahead = (BOARD_Y_M - hits.points_enu_m[:, 1]) / out[:, 1]
    places = hits.points_enu_m + ahead[:, None] * out
    places[hits.panes < 0] = np.nan
    return places[:, [0, 2]]


def missed_px(made: Scene, camera: PosedPhoto, pixels: Array, points: Array) -> Array:
    """How far from pixels the scene mirrors points of the board, shape (n,)."""
    wrong = board_places(made, camera, pixels) - points[:, [0, 2]]
    step = 0.05
    columns = [(board_places(made, camera, pixels + step * np.eye(2)[k]) - board_places(
        made, camera, pixels - step * np.eye(2)[k])) / (2.0 * step) for k in range(2)]  # fmt: skip
    return np.asarray(np.linalg.norm(np.linalg.solve(np.stack(columns, axis=-1), wrong[..., None])[..., 0], axis=1))


def corners_of_squares(square_m: float, x_m: tuple[float, float]) -> Array:
    steps = square_m * np.arange(-200, 200)
    x, z = np.meshgrid(steps[(steps > x_m[0]) & (steps < x_m[1])], steps[(steps > -10.0) & (steps < 30.0)])
    return np.column_stack([x.ravel(), np.full(x.size, BOARD_Y_M), z.ravel()])


def at_the_cylinder(steep: bool) -> PosedPhoto:
    """A camera 10 m from where the cylinder touches y = 0, straight before it or 60 degrees aside."""
    angle = STEEP if steep else 0.0
    position = (-10.0 * np.sin(angle), -10.0 * np.cos(angle), 9.0)
    return photo(position, np.degrees(angle), 4.0, width_px=240, height_px=180, focal_px=500.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("steep", [False, True], ids=["straight", "60 degrees"])
@pytest.mark.parametrize("radius_m", [26.0, 8.0])
def test_bowed_panes_mirror_as_the_cylinder_on_which_their_corners_lie(radius_m: float, steep: bool) -> None:
    made, camera = cylinder(radius_m, 2.0), at_the_cylinder(steep)
    points = corners_of_squares(2.0, (-40.0, 55.0))[::2]
    pixels = alhazen_px(camera, radius_m, points)
    inside = ((pixels > 8.0) & (pixels < [232.0, 172.0])).all(axis=1)
    points, pixels = points[inside], pixels[inside]
    assert len(points) > 20
    assert np.max(missed_px(made, camera, pixels, points)) < (0.01 if radius_m > 20.0 else 0.2)
    flat = with_panes(made, bows_per_m=np.zeros_like(made.panes.bows_per_m))
    assert np.nanmedian(missed_px(flat, camera, pixels, points)) > 5.0


@pytest.mark.slow
def test_corners_of_a_checkerboard_are_found_where_a_cylinder_mirrors_them() -> None:
    made, camera = cylinder(8.0, 2.0), at_the_cylinder(steep=False)
    points = corners_of_squares(2.0, (-40.0, 40.0))
    pixels = alhazen_px(camera, 8.0, points)
    pixels = pixels[((pixels > 15.0) & (pixels < [225.0, 165.0])).all(axis=1)]
    assert len(pixels) > 60
    taken = Renderer(made, RenderSettings(samples=3)).render(camera)
    grey = cv2.GaussianBlur(taken.reflection[..., 1], (0, 0), 1.0)
    start = (pixels - 0.5 + 0.3).astype(np.float32).reshape(-1, 1, 2)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 60, 1e-5)
    found = cv2.cornerSubPix(grey, start, (4, 4), (-1, -1), criteria).reshape(-1, 2) + 0.5
    assert np.linalg.norm(found - pixels, axis=1).max() < 0.2


def surface_m(made: Scene, points: Array) -> tuple[Array, Array]:
    """How far points stand before the glass of the only pane, 8 m x 6 m that looks south, and its normals there."""
    (tilt,), (bow,) = made.panes.tilts_rad, made.panes.bows_per_m
    u, v = points[:, 0], points[:, 2] - 10.0
    z = 0.5 * (bow[0] * (16.0 - u**2) + bow[1] * (9.0 - v**2)) - tilt[0] * u - tilt[1] * v
    normals = np.column_stack([tilt[0] + bow[0] * u, -np.ones(len(u)), tilt[1] + bow[1] * v])
    return -points[:, 1] - z, normals / np.linalg.norm(normals, axis=1, keepdims=True)


WINDOW = scene(corners=facing_south())
PLANE = Geometry(WINDOW)


@settings(max_examples=40, deadline=None)
@given(
    st.tuples(*[st.floats(-0.05, 0.05)] * 2),
    st.tuples(*[st.floats(-0.1, 0.1)] * 2),
    st.floats(0.02, 1.5),
    st.floats(-1.4, 1.4),
    st.sampled_from([3.0, 30.0, 10_000.0]),
    st.booleans(),
)
def test_rays_meet_the_glass_where_it_is(
    tilt: tuple[float, float], bow: tuple[float, float], rise: float, turn: float, away_m: float, behind: bool
) -> None:
    made = with_panes(WINDOW, tilts_rad=np.array([tilt]), bows_per_m=np.array([bow]))
    surfaces = PaneSurfaces(made.panes, PLANE.pane_frames)
    x, z = np.meshgrid(np.linspace(-3.9, 3.9, 7), np.linspace(7.1, 12.9, 5))
    towards = np.column_stack([x.ravel(), np.zeros(35), z.ravel()])
    side = 1.0 if behind else -1.0
    away = np.array([np.cos(rise) * np.cos(turn), side * np.sin(rise), np.cos(rise) * np.sin(turn)])
    directions = np.tile(-away, (35, 1))
    flat = PLANE.meet(towards + away_m * away, directions)
    assert (flat.panes == 0).all()
    hits, normals = surfaces.meet(flat, directions)
    off, expected = surface_m(made, hits.points_enu_m)
    moved = hits.distance_m != flat.distance_m
    # What passes the edge of a bulge comes closest there, along the glass.
    facing = np.einsum("nk,nk->n", normals, directions)
    assert ((np.abs(off) < 1e-8) | (np.abs(facing) < 1e-8))[moved].all()
    assert np.allclose(normals, -side * expected if behind else expected, atol=1e-12)
    assert np.allclose(towards + away_m * away + hits.distance_m[:, None] * directions, hits.points_enu_m, atol=1e-8)
    # Of a bulge, the near side: the glass faces the ray.
    assert (facing[moved] <= 1e-9).all()
    if np.sin(rise) > 0.9:
        assert moved.all() or not np.any([tilt, bow])


def test_a_pane_without_tilt_and_bow_is_met_where_it_was() -> None:
    made = scene(corners=facing_south())
    geometry = Geometry(made)
    surfaces = PaneSurfaces(made.panes, geometry.pane_frames)
    origins, directions = photo().rays(np.array([[100.0, 90.0], [128.0, 96.0], [3.0, 4.0]]))
    hits = geometry.meet(origins, directions)
    assert surfaces.is_flat
    assert surfaces.meet(hits, directions)[0] is hits
    tiny = with_panes(made, bows_per_m=np.full((1, 2), 1e-12), tilts_rad=np.full((1, 2), 1e-14))
    again, normals = PaneSurfaces(tiny.panes, geometry.pane_frames).meet(hits, directions)
    assert np.allclose(again.points_enu_m, hits.points_enu_m, atol=1e-10)
    assert np.allclose(normals, hits.normals_enu, atol=1e-10)


@pytest.mark.few(10)
@pytest.mark.parametrize("bow", [0.0, 1e-300, 0.02, -0.02, 3.0, -1e6])
@pytest.mark.parametrize(
    ("position", "heading_deg"),
    [
        ((0.0, -0.001, 10.0), 0.0),
        ((0.0, -0.001, 10.0), 89.9),
        ((-8.0, 0.0, 10.0), 90.0),
        ((-8.0, -0.02, 10.0), 90.0),
        ((0.0, 0.0, 10.0), 0.0),
        ((0.0, 5.0, 10.0), 180.0),
        ((0.0, -10_000.0, 10.0), 0.0),
    ],
    ids=["1 mm off", "1 mm off, along", "in the plane", "grazing", "on the pane", "behind", "10 km"],
)
def test_light_is_never_lost_nor_made_by_a_bow(
    bow: float, position: tuple[float, float, float], heading_deg: float
) -> None:
    """All that is seen is light of a half, on glass that swallows nothing."""
    made = scene(corners=facing_south(columns=3), glass=Glass(tint=(1.0, 1.0, 1.0), coating=0.3), room=0.5)
    made = with_panes(made, bows_per_m=np.full((3, 2), bow), tilts_rad=np.full((3, 2), 0.01))
    focal = 300_000.0 if abs(position[1]) > 100.0 else 30.0
    camera = photo(position, heading_deg, width_px=32, height_px=24, focal_px=0.5 * focal)
    taken = Renderer(made, RenderSettings(samples=1)).render(camera)
    assert np.abs(taken.linear - 0.5).max() < 1e-6
    assert np.isfinite(taken.normal_enu).all()
    assert not np.isnan(taken.depth_m).any()
    lengths = np.linalg.norm(taken.normal_enu[taken.is_glass], axis=1)
    assert np.allclose(lengths, 1.0, atol=1e-6)


@pytest.mark.parametrize(
    "changes", [{"tilts_rad": np.array([[0.03, 0.0]])}, {"bows_per_m": np.array([[-0.02, -0.02]])}]
)
def test_glass_that_hangs_back_does_not_mirror_its_own_outline(changes: dict[str, Array]) -> None:
    # Half of a tilted pane, and a hollow one, are behind their corners; the sky is all there is to mirror.
    opaque = scene(corners=facing_south(), glass=replace(MIRROR, tint=(0.0, 0.0, 0.0)))
    camera = photo((-3.0, -2.0, 10.0), 55.0, width_px=96, height_px=72)
    taken = Renderer(with_panes(opaque, **changes), RenderSettings(samples=1)).render(camera)
    directions = camera.rays(np.argwhere(taken.is_glass)[:, ::-1] + 0.5)[1]
    cosines = -np.einsum("nk,nk->n", directions, taken.normal_enu[taken.is_glass])
    expected = 0.5 * pane_light(np.abs(cosines), opaque.glasses[0])[0]
    assert np.allclose(taken.reflection[taken.is_glass], expected, atol=1e-5)
