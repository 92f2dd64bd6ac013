"""A quick look at photos: how far away is what panes mirror, and photos from a card at a part of their size."""

import time

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh
from planning.site.records import Airspace, Facade, Panel, Site, SiteModel
from reconstruction.base.cameras import Intrinsics
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.quick_look import WIDEST_PX, CardPhotos, quick_look
from tests.reconstruction.light.synthetic_folder import (
    BOARD_M,
    cameras,
    corners_of,
    far,
    near,
    panel_numbers,
    picture,
    write_folder,
)


@pytest.mark.long
@pytest.mark.parametrize(("light", "is_near"), [(near, True), pytest.param(far, False, marks=pytest.mark.slow)])
def test_what_is_mirrored_is_as_far_away_as_it_is(tmp_path, light, is_near):
    write_folder(tmp_path / "set", light, 24)
    # Processor time: what else a busy machine does makes nothing less sharp.
    look = quick_look(read_photo_set(tmp_path / "set"), 3.0, clock=time.process_time)
    distances = look.places.distances_m
    before_m = -look.places.places_enu_m[np.isfinite(distances), 1]
    assert set(look.places.halves.tolist()) == {0, 1}
    assert look.n_photos == 24
    assert look.psnr_db > 18.0
    if is_near:
        assert np.median(before_m) == pytest.approx(BOARD_M, rel=0.25)
    else:
        assert np.isinf(distances).mean() + (before_m > 3.0 * BOARD_M).mean() > 0.5


def test_too_few_photos_with_glass_are_refused_in_words(tmp_path):
    write_folder(tmp_path / "set", far, 5)
    with pytest.raises(InputError, match=r"5 of 5 photos show glass .* 8 are needed"):
        quick_look(read_photo_set(tmp_path / "set"), 1.0)


def site_of(corners) -> SiteModel:
    panels = tuple(Panel(f"A-{k}", tuple(map(tuple, each.tolist()))) for k, each in enumerate(corners))
    facade = Facade("A", panels)
    airspace = Airspace((-50.0, -50.0, 0.0), (50.0, 50.0, 50.0), 0.0)
    site = Site("wall", Origin(48.0, 11.0, 500.0), (facade,), airspace, (0.0, -20.0, 0.0))
    return SiteModel(site, TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64)))


@pytest.mark.parametrize("times", [1, 20, pytest.param(40, marks=pytest.mark.slow)])
def test_photos_of_a_card_are_read_at_a_part_of_their_size_and_show_the_panels(tmp_path, times):
    lens = Intrinsics(*(times * value for value in (40, 30, 36.0, 36.0, 20.0, 15.0)))
    photos = cameras(tmp_path, 2, lens=lens)
    (tmp_path / "images").mkdir()
    for photo in photos:
        index = panel_numbers(photo, corners_of())
        cv2.imwrite(str(photo.path), picture(photo, index > 0, far, 1.0)[..., ::-1])
    card = CardPhotos.of(photos, site_of(corners_of()), tmp_path)
    for photo, small in zip(photos, card.photos, strict=True):
        assert small.intrinsics.width_px <= WIDEST_PX
        exact = panel_numbers(small, corners_of()).astype(int) - 1
        assert (card.panel_numbers(small) == exact).mean() > 0.98
        assert card.picture(small).shape == (small.intrinsics.height_px, small.intrinsics.width_px, 3)
        assert photo.pose is small.pose
