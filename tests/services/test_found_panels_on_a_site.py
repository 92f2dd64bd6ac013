"""Found panels become panels of a site whatever their shape: rounding must not spoil them."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from groundstation.services.photos.panels import site_facade
from reconstruction.panels.solving.record import SolvedFacade, SolvedPanel
from tests.reconstruction.panels.rectify.test_surface import surface

coordinates = st.floats(-2.0, 2.0)


def facade_of(corners):
    panel = SolvedPanel("A-01-01", 0, 0, corners, np.zeros((4, 3, 3)), 1.0)
    return SolvedFacade("A", surface(0.0, lean_rad=0.0), (), (), (panel,), {})


@given(
    apex=st.tuples(st.floats(0.0, 3.0), st.floats(0.3, 2.5)),
    turn=st.integers(0, 2**32 - 1),
    shift=st.tuples(coordinates, coordinates, coordinates),
    first=st.integers(0, 3),
)
def test_a_triangle_with_a_fourth_corner_on_its_longest_side_is_a_panel(apex, turn, shift, first):
    flat = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [*apex, 0.0]])
    sides = np.linalg.norm(np.roll(flat, -1, axis=0) - flat, axis=1)
    longest = int(np.argmax(sides))
    middle = 0.5 * (flat[longest] + flat[(longest + 1) % 3])
    corners = np.roll(np.insert(flat, longest + 1, middle, axis=0), first, axis=0)
    corners = Rotation.random(random_state=turn).apply(corners) + shift
    made = site_facade(facade_of(corners)).panels[0]
    apart = np.linalg.norm(np.array(made.corners_enu_m) - corners, axis=1)
    assert apart.max() < 7e-4
    assert np.count_nonzero(apart > 2e-4) == 1


def test_corners_of_rectangles_stay_where_they_are():
    corners = np.array([[0.0, 0.0, 0.0], [1.23456, 0.0, 0.0], [1.23456, 0.0, 2.0], [0.0, 0.0, 2.0]])
    assert np.array(site_facade(facade_of(corners)).panels[0].corners_enu_m).tolist() == np.round(corners, 4).tolist()
