"""Rendered photos as photos to score: the surfaces of facades, and finding panels in what was rendered."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planning.base.progress import QUIET
from reconstruction.base.cameras import Intrinsics, Pose
from reconstruction.metrics.run import own_method, score_answer
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import square_photos
from reconstruction.scenes.photos.lens_effects import developed
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.world.bundled import RADIUS_M, bundled_scene, curved_site, planar_site
from reconstruction.tradeoff.scene_tradeoff import rendered_photo, walls

LENS = Intrinsics(480, 360, 384.0, 384.0, 240.0, 180.0)


def test_a_flat_facade_stands_on_a_plane_and_a_curved_one_on_its_cylinder():
    ((flat, low, high),) = walls(planar_site().site.facades)
    assert flat.is_flat
    assert high - low == pytest.approx([30.0 - 0.06 + 4.0, 20.0 - 0.06 + 4.0], abs=0.1)
    ((curved, low, high),) = walls(curved_site().site.facades)
    # Facets lie inside the circle through their corners.
    assert 1.0 / curved.curvature_per_m == pytest.approx(RADIUS_M, rel=0.005)
    assert high[0] - low[0] == pytest.approx(34.0, abs=0.1)


@pytest.mark.slow
def test_panels_are_found_in_a_rendered_photo_where_its_truth_has_them():
    scene = bundled_scene("planar-far")
    (photo,) = square_photos(scene, LENS, 1, Path(), seed=2)
    taken = Renderer(scene, RenderSettings()).render(photo)
    scored = rendered_photo(photo, developed(taken), taken.panel, walls(scene.site.site.facades))
    scores = score_answer(scored, own_method()(scored, QUIET))
    assert scores.n_true == 160
    assert scores.individual_miou is not None
    assert scores.individual_miou > 0.85


def test_a_facade_behind_the_camera_gives_no_view():
    scene = bundled_scene("planar-far")
    (photo,) = square_photos(scene, LENS, 1, Path(), seed=2)
    turned = replace(photo, pose=Pose.looking(photo.pose.position_enu_m, 0.0, 0.0))
    blank = np.zeros((360, 480), np.uint16)
    image = np.zeros((360, 480, 3), np.uint8)
    assert rendered_photo(turned, image, blank, walls(scene.site.site.facades)).views == ()
