"""Panels as photos show them: which photo is taken, where it lies, and what stands before a panel."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from groundstation.services.photos.intake import photo_intake
from groundstation.services.scenes.panel_pictures import MOST_TILES, TILE_M, best_photos, panel_pictures, wall_tiles
from groundstation.services.scenes.surfaces import Part
from planning.coverage.sections import panel_frames
from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh
from planning.site.records import Obstacle, panel_corners
from tests.services.photo_cases import site_model, true_photos, write_photos


def with_wall(model, before_m):
    """The site with a wall so far before its facade, as wide and high as a house."""
    frames = panel_frames(panel_corners(model.site))
    middle = frames.centroids.mean(axis=0) + before_m * frames.normals[0]
    half = np.where(np.abs(frames.normals[0]) > 0.5, 0.5, 60.0)
    low, high = middle - half, middle + half
    obstacle = Obstacle("wall", box_enu_m=(tuple(low), tuple(high)))
    return replace(
        model,
        site=replace(model.site, obstacles=(*model.site.obstacles, obstacle)),
        obstacles=(*model.obstacles, box_mesh(low, high)),
    )


def test_each_panel_is_taken_from_the_photo_that_shows_it_largest_unless_something_is_before_it():
    model, photos = site_model(), true_photos()
    frames = panel_frames(panel_corners(model.site))
    best = best_photos(frames, photos, model)
    assert (best >= 0).any()

    def area(photo, corners):
        a, b, c, d = photo.pixels(corners)
        one, other = c - a, d - b
        return 0.5 * abs(one[0] * other[1] - one[1] * other[0])

    for panel in np.flatnonzero(best >= 0):
        corners = frames.corners[panel]
        sizes = [area(photo, corners) if photo.sees(corners).all() else 0.0 for photo in photos]
        assert int(np.argmax(sizes)) == best[panel]
    assert (best_photos(frames, photos, with_wall(model, 5.0)) == -1).all()
    turned = type(frames)(
        frames.centroids, -frames.normals, frames.tangents, frames.bitangents, frames.corners[:, ::-1]
    )
    assert (best_photos(turned, photos, model) == -1).all(), "nobody sees the back of a panel"


@pytest.mark.slow
def test_a_panel_is_drawn_upright_and_whole(tmp_path, monkeypatch):
    """Photos that are painted so that their colours say where on the panel a pixel lies."""
    write_photos(tmp_path)
    model = site_model()
    intake = photo_intake(tmp_path, model, None)
    frames = panel_frames(panel_corners(model.site))
    panel = int(np.flatnonzero(best_photos(frames, intake.photos, model) >= 0)[0])
    photo_of = {photo.path: photo for photo in intake.photos}
    first, second, _, fourth = frames.corners[panel]

    def painted(about, scale=1):
        photo = photo_of[about.path]
        y, x = np.mgrid[: about.height_px : scale, : about.width_px : scale] + 0.5 * scale
        origins, rays = photo.rays(np.stack([x.ravel(), y.ravel()], axis=1))
        along = (first - origins) @ frames.normals[panel] / (rays @ frames.normals[panel])
        met = origins + along[:, None] * rays - first
        parts = [met @ side / (side @ side) for side in (second - first, fourth - first)]
        colours = np.clip(np.stack([np.zeros(len(met)), *parts[::-1]], axis=1), 0.0, 1.0)
        return np.rint(255.0 * colours).astype(np.uint8).reshape(*x.shape, 3)

    monkeypatch.setattr("reconstruction.photos.decode.colour_picture", painted)
    surface, *_walls = panel_pictures(model, intake.photos, intake.metadata)
    height, width = surface.picture.shape[:2]
    for corners, uv in zip(surface.corners_enu_m[:2], surface.uv[:2], strict=True):
        for weights in ([0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8], [1 / 3, 1 / 3, 1 / 3]):
            u, v = np.array(weights) @ uv
            red, green, blue = surface.picture[int((1.0 - v) * height), int(u * width)].astype(float) / 255.0
            place = np.array(weights) @ corners - first
            expected = [place @ side / (side @ side) for side in (second - first, fourth - first)]
            assert [red, green] == pytest.approx(expected, abs=0.03)
            assert blue == 0.0


def test_tiles_are_all_of_the_walls_and_lie_in_them():
    for size_m in ((36.0, 20.0, 42.0), (2.0, 1.0, 4.0), (900.0, 700.0, 300.0)):
        building = box_mesh(np.zeros(3), np.array(size_m))
        tiles = wall_tiles(building)
        frames = panel_frames(tiles)
        pieces = np.linalg.norm(np.cross(tiles[:, 1] - tiles[:, 0], tiles[:, 2] - tiles[:, 0]), axis=1) / 2.0
        x, y, z = size_m
        assert pieces.sum() == pytest.approx(2.0 * (x * y + y * z + z * x))
        assert len(tiles) <= MOST_TILES
        outside = frames.centroids + 1e-3 * frames.normals
        assert ((outside < 0.0) | (outside > np.array(size_m))).any(axis=1).all(), "they look outwards as the walls do"
        if len(tiles) < MOST_TILES / 2:
            assert np.linalg.norm(tiles[:, 2] - tiles[:, 0], axis=1).max() <= TILE_M + 1e-9
    assert len(wall_tiles(empty_mesh())) == 0
    line = TriangleMesh(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([[0, 1, 2]]))
    assert len(wall_tiles(line)) == 0


@pytest.mark.long
def test_walls_have_the_colours_of_the_places_that_photos_show(monkeypatch):
    """Photos painted by where in the world each pixel lies, on the plane of the wall."""
    model = site_model()
    photos = [replace(photo, path=Path(f"{number}.jpg")) for number, photo in enumerate(true_photos())]
    frames = panel_frames(panel_corners(model.site))
    first, normal = frames.corners[0, 0], frames.normals[0]
    low, high = first - 60.0, first + 60.0

    class About:
        def __init__(self, photo):
            self.path, self.photo, self.width_px = photo.path, photo, photo.intrinsics.width_px

    def painted(about, scale=1):
        lens = about.photo.intrinsics
        y, x = np.mgrid[: lens.height_px : scale, : lens.width_px : scale] + 0.5 * scale
        origins, rays = about.photo.rays(np.stack([x.ravel(), y.ravel()], axis=1))
        met = origins + ((first - origins) @ normal / (rays @ normal))[:, None] * rays
        colours = np.clip((met - low) / (high - low), 0.0, 1.0)[:, ::-1]
        return np.rint(255.0 * colours).astype(np.uint8).reshape(*x.shape, 3)

    monkeypatch.setattr("reconstruction.photos.decode.colour_picture", painted)
    made = panel_pictures(model, photos, [About(photo) for photo in photos])
    (walls,) = [surface for surface in made if surface.part is Part.WALLS]
    height, width = walls.picture.shape[:2]
    on_plane = np.abs((walls.corners_enu_m - first) @ normal).max(axis=1) < 0.5
    assert on_plane.sum() > 20
    for corners, uv in zip(walls.corners_enu_m[on_plane], walls.uv[on_plane], strict=True):
        u, v = uv.mean(axis=0)
        seen = walls.picture[int((1.0 - v) * height), int(u * width)] / 255.0
        assert seen == pytest.approx((corners.mean(axis=0) - low) / (high - low), abs=0.02)
