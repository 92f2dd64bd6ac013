"""Paths through cameras: they pass them, turn with them, and do not leave their box."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.training.model.render import cameras_between, frame_names

LENS = Intrinsics(40, 30, 36.0, 36.0, 20.0, 15.0)


def photo(number, place, heading=0.0, pitch=0.0):
    return PosedPhoto(f"p{number}", Path(f"p{number}"), LENS, Pose.looking(np.array(place, float), heading, pitch))


coordinates = st.floats(-50, 50, allow_nan=False)
places = st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=2, max_size=6)


@settings(max_examples=40, deadline=None)
@given(places, st.integers(2, 60))
def test_path_begins_and_ends_at_the_photos_and_stays_in_their_box(places, n_frames):
    photos = [photo(k, place, 30.0 * k, -5.0 * k) for k, place in enumerate(places)]
    path = cameras_between(photos, n_frames)
    found = np.array([view.pose.position_enu_m for view in path])
    assert len(path) == n_frames
    np.testing.assert_allclose(found[[0, -1]], np.array(places)[[0, -1]], atol=1e-9)
    np.testing.assert_allclose(path[-1].pose.cam_from_enu, photos[-1].pose.cam_from_enu, atol=1e-9)
    assert (found >= np.min(places, axis=0) - 1e-9).all()
    assert (found <= np.max(places, axis=0) + 1e-9).all()


def test_path_has_an_even_speed_on_a_straight_way():
    path = cameras_between([photo(0, (0, 0, 0)), photo(1, (1, 0, 0)), photo(2, (10, 0, 0))], 21)
    x = [view.pose.position_enu_m[0] for view in path]
    assert np.diff(x).min() > 0.0
    assert x[2] == pytest.approx(1.0)


def test_views_turn_the_short_way_round():
    path = cameras_between([photo(0, (0, 0, 0), 170.0), photo(1, (5, 0, 0), -170.0)], 3)
    assert abs(path[1].pose.heading_deg) == pytest.approx(180.0)


def test_names_sort_in_their_order():
    assert frame_names(12)[0] == "frame-0001"
    assert frame_names(12_345) == sorted(frame_names(12_345))


def test_one_camera_makes_no_path():
    with pytest.raises(InputError, match="leave --frames out"):
        cameras_between([photo(0, (0, 0, 0))], 5)
    with pytest.raises(ValueError, match="n_frames"):
        cameras_between([photo(0, (0, 0, 0)), photo(1, (1, 0, 0))], 1)
