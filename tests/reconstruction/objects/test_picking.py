"""Panels at places of pictures, against truth and a slow twin."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.scenes.photos import render_photos
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.light.photo_set import read_photo_set
from reconstruction.objects.picking import Quads, picked, rays_of
from reconstruction.scenes.parameters import SceneRequest
from tests.reconstruction.objects.synthetic_scene import pane

LENS = Intrinsics(64, 48, 60.0, 60.0, 32.0, 24.0)
NORTH = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def camera(position=(0.0, -20.0, 2.0), cam_from_enu=NORTH):
    return PosedPhoto("", Path(), LENS, Pose(np.array(position), cam_from_enu))


def middles(lens=LENS):
    x, y = np.meshgrid(np.arange(lens.width_px) + 0.5, np.arange(lens.height_px) + 0.5)
    return np.column_stack([x.ravel(), y.ravel()])


def one_by_one(corners, origin, ray):
    """Moeller and Trumbore's test of two triangles, one panel after the other."""
    best = (np.inf, -1)
    for number, quad in enumerate(corners):
        for one, other in ((1, 2), (2, 3)):
            first, second = quad[one] - quad[0], quad[other] - quad[0]
            across = np.cross(ray, second)
            scale = first @ across
            if abs(scale) < 1e-12:
                continue
            off = origin - quad[0]
            u, v = (off @ across) / scale, (ray @ np.cross(off, first)) / scale
            t = (second @ np.cross(off, first)) / scale
            if u >= 0 and v >= 0 and u + v <= 1 and t > 0:
                best = min(best, (t, number))
    return best[1]


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**31))
def test_the_nearest_panel_is_found_as_by_triangles_one_by_one(seed):
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-4, 4, (6, 1, 3)) + np.array([0.0, 8.0, 0.0])
    u, v = rng.normal(size=(2, 6, 1, 3))
    # A parallelogram is convex, whatever its edges are.
    corners = middle + np.concatenate([-u - v, u - v, u + v, v - u], axis=1)
    rays = rng.normal(size=(40, 3)) * 0.3 + (0.0, 1.0, 0.0)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    origin = rng.normal(size=3)
    found, distances = Quads.of(corners).first_hits(origin, rays)
    assert found.tolist() == [one_by_one(corners, origin, ray) for ray in rays]
    assert np.array_equal(np.isfinite(distances), found >= 0)


def test_a_panel_is_met_where_it_is_drawn_and_nowhere_else():
    quads = Quads.of(np.array([pane(column, row) for row in range(3) for column in range(-4, 4)]))
    found = picked(quads, camera(), middles()).reshape(48, 64)
    points = camera().pose.position_enu_m + 20.0 / rays_of(camera(), middles())[:, 1:2] * rays_of(camera(), middles())
    columns, rows = np.floor(points[:, 0] / 1.5), np.floor(points[:, 2] / 2.0)
    is_glass = (points[:, 0] / 1.5 - columns <= 0.9) & (points[:, 2] / 2.0 - rows <= 0.9)
    is_glass &= (columns >= -4) & (columns < 4) & (rows >= 0) & (rows < 3)
    expected = np.where(is_glass, 8 * rows + columns + 4, -1).reshape(48, 64)
    assert np.array_equal(found, expected)


def test_what_stands_well_before_a_panel_hides_it_and_what_shines_through_does_not():
    quads = Quads.of(np.array([pane(0, 0)]))
    place = np.array([[34.0, 26.0]])
    assert picked(quads, camera(), place).tolist() == [0]
    for depth_m, number in ((np.inf, 0), (35.0, 0), (19.5, 0), (12.0, -1), (np.nan, 0)):
        assert picked(quads, camera(), place, np.array([depth_m])).tolist() == [number]


def test_panels_are_met_from_behind_and_not_behind_the_camera():
    quads = Quads.of(np.array([pane(0, 0)]))
    ray = np.array([[0.0, -1.0, 0.0]])
    assert quads.first_hits(np.array([0.5, 3.0, 0.5]), ray)[0].tolist() == [0]
    assert quads.first_hits(np.array([0.5, -3.0, 0.5]), ray)[0].tolist() == [-1]


@pytest.mark.parametrize(
    "corners", [np.zeros((0, 4, 3)), np.zeros((1, 4, 3)), np.array([pane(0, 0)]) * 1e-9, np.array([pane(0, 0)]) * 1e6]
)
def test_no_panel_and_points_for_panels_are_no_trouble(corners):
    found, distances = Quads.of(corners).first_hits(np.array([0.1, -5.0, 0.1]), rays_of(camera(), middles()))
    assert found.shape == distances.shape == (64 * 48,)
    assert not np.isnan(distances).any()


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["planar", "curved"])
def test_of_the_glass_of_made_photos_next_to_every_pixel_is_picked_right(tmp_path, scene):
    render_photos(SceneRequest(scene, n_square=2, width_px=160, n_points=0), tmp_path / scene, 1)
    source = read_photo_set(tmp_path / scene)
    quads = Quads.of(source.panels.corners_enu_m)
    n_right = n_glass = 0
    for photo in source.photos:
        truth = cv2.imread(str(tmp_path / scene / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        glass = cv2.imread(str(tmp_path / scene / "glass" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED) > 0
        depth = np.load(tmp_path / scene / "depth" / f"{photo.name}.npy").astype(float)
        found = picked(quads, photo, middles(photo.intrinsics), depth.ravel()).reshape(truth.shape)
        n_right += int((found[glass] == truth[glass].astype(int) - 1).sum())
        n_glass += int(glass.sum())
    assert n_glass > 0.4 * len(source.photos) * 160 * 120
    assert n_right >= 0.999 * n_glass
