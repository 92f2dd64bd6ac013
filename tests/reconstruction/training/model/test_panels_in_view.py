"""Which panel's plane mirrors at which pixel."""

from pathlib import Path

import numpy as np

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.splats.rasterising.views import View
from reconstruction.training.model.joint_model import panels_in_view, photo_of
from tests.reconstruction.light.synthetic_folder import LENS, corners_of


def view_at(position, heading=0.0, pitch=0.0, lens=LENS):

    photo = PosedPhoto("p", Path("p"), lens, Pose.looking(np.array(position, float), heading, pitch))
    return View.of(photo, np.zeros(3)), photo


def test_middles_on_panels_are_theirs_and_the_next_pixels_belong_to_them_too():
    corners = corners_of()
    view, photo = view_at((0.317, -6.03, 2.011))
    found = panels_in_view(view, corners)
    columns, rows = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
    origins, directions = photo.rays(np.column_stack([columns.ravel(), rows.ravel()]))
    places = origins - origins[:, 1:2] / directions[:, 1:2] * directions
    inside = np.full(len(places), -1)
    for number, panel in enumerate(corners):
        low, high = panel[:, [0, 2]].min(axis=0), panel[:, [0, 2]].max(axis=0)
        inside[((places[:, [0, 2]] > low) & (places[:, [0, 2]] < high)).all(axis=1)] = number
    inside = inside.reshape(30, 40)
    assert (found[inside >= 0] == inside[inside >= 0]).all()
    grown = found >= 0
    around = np.pad(inside >= 0, 1)
    beside = around[1:-1, :-2] | around[1:-1, 2:] | around[:-2, 1:-1] | around[2:, 1:-1]
    assert (grown == ((inside >= 0) | beside)).all()


def test_panels_seen_from_behind_do_not_mirror():
    view, _ = view_at((0.0, 6.0, 2.0), heading=180.0)
    assert (panels_in_view(view, corners_of()) == -1).all()


def test_a_window_shows_what_the_whole_picture_shows_there():
    view, _ = view_at((0.317, -6.03, 2.011))
    whole = panels_in_view(view, corners_of())
    window = panels_in_view(view.cropped(11, 7, 20, 15), corners_of())
    assert (window[1:-1, 1:-1] == whole[7:22, 11:31][1:-1, 1:-1]).all()


def test_cameras_of_views_are_those_of_their_photos():
    lens = Intrinsics(40, 30, 36.0, 33.0, 21.0, 14.0)
    origin = np.array([100.0, -20.0, 7.0])

    photo = PosedPhoto("p", Path("p"), lens, Pose.looking(np.array([90.0, -30.0, 12.0]), 40.0, -20.0))
    back = photo_of(View.of(photo, origin), origin)
    np.testing.assert_allclose(back.pose.position_enu_m, photo.pose.position_enu_m, atol=1e-9)
    np.testing.assert_allclose(back.pose.cam_from_enu, photo.pose.cam_from_enu, atol=1e-12)
    assert back.intrinsics == lens
