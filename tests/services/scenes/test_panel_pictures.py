"""Panels as photos show them: which photo is taken, where it lies, and what stands before a panel."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.intake import photo_intake
from groundstation.services.scenes.panel_pictures import best_photos, panel_pictures
from planning.coverage.sections import panel_frames
from planning.geo.mesh import box_mesh
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
    (surface,) = panel_pictures(model, intake.photos, intake.metadata)
    height, width = surface.picture.shape[:2]
    for corners, uv in zip(surface.corners_enu_m[:2], surface.uv[:2], strict=True):
        for weights in ([0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8], [1 / 3, 1 / 3, 1 / 3]):
            u, v = np.array(weights) @ uv
            red, green, blue = surface.picture[int((1.0 - v) * height), int(u * width)].astype(float) / 255.0
            place = np.array(weights) @ corners - first
            expected = [place @ side / (side @ side) for side in (second - first, fourth - first)]
            assert [red, green] == pytest.approx(expected, abs=0.03)
            assert blue == 0.0
