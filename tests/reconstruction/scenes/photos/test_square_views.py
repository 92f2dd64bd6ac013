"""Photos that a first flight takes: square to facades, where nothing stands in the way."""

from pathlib import Path

import numpy as np
import pytest

from planning.geo.mesh import join
from planning.geo.solids import Solids
from reconstruction.base.cameras import Intrinsics
from reconstruction.scenes.photos.flight_views import MOST_ABOVE_DEG, MOST_ASIDE_DEG, square_photos
from reconstruction.scenes.world.bundled import bundled_scene

LENS = Intrinsics(80, 60, 64.0, 64.0, 40.0, 30.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["planar-far", "curved-far"])
def test_every_photo_shows_the_whole_facade_from_nearly_square_on(name):
    scene = bundled_scene(name)
    corners = scene.panes.corners_enu_m
    middle = corners.reshape(-1, 3).mean(axis=0)
    for photo in square_photos(scene, LENS, 5, Path(), seed=3):
        assert photo.sees(corners.reshape(-1, 3)).all()
        line = photo.pose.position_enu_m - middle
        aside = np.degrees(np.arctan2(abs(line[0]), line[1]))
        above = np.degrees(np.arctan2(abs(line[2]), np.hypot(line[0], line[1])))
        assert aside <= MOST_ASIDE_DEG + 3.0
        assert above <= MOST_ABOVE_DEG + 3.0


@pytest.mark.slow
def test_all_facades_of_a_court_are_photographed_from_where_nothing_stands():
    scene = bundled_scene("court")
    photos = square_photos(scene, LENS, 6, Path("somewhere"), seed=1)
    places = np.array([photo.pose.position_enu_m for photo in photos])
    assert (Solids.of(join(list(scene.site.obstacles)).corners_enu_m).clearance_m(places) > 0.0).all()
    n_facades = len(scene.site.site.facades)
    for number, facade in enumerate(scene.site.site.facades):
        middle = np.mean([panel.corners_enu_m for panel in facade.panels], axis=(0, 1))
        for photo in photos[number::n_facades]:
            assert photo.sees(middle[None]).all()
    assert len({photo.name for photo in photos}) == 6
    assert photos[0].path == Path("somewhere") / photos[0].name


@pytest.mark.slow
def test_the_seed_decides():
    scene = bundled_scene("planar-far")
    one, same, other = (square_photos(scene, LENS, 2, Path(), seed)[1].pose.position_enu_m for seed in (4, 4, 5))
    assert (one == same).all()
    assert not np.allclose(one, other)
