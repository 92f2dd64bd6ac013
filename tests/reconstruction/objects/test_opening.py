"""From where a building is seen at first."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reconstruction.objects.store import LEAST_M, largest, middle_of, outward, places_of, standoff_m


def facade(width_m=20.0, height_m=10.0, n=5):
    """Panels side by side in the plane y = 0, seen from the south."""
    xs = np.linspace(-width_m / 2, width_m / 2, n + 1)
    return np.array(
        [[[left, 0, 0], [right, 0, 0], [right, 0, height_m], [left, 0, height_m]] for left, right in pairwise(xs)]
    )


def test_the_largest_facade_is_that_of_the_largest_area():
    assert outward(facade()) == pytest.approx([0, -1, 0])
    assert middle_of(facade()) == pytest.approx([0, 0, 5])
    assert largest([facade(n=50, height_m=2.0), facade(n=2), facade(n=3)]) == 1


def test_photos_tell_how_far_before_the_facade_one_can_stand():
    places = np.array([[0, -40, 5], [0, -8, 5], [30, -12, 5], [0, 30, 5], [0, -1, 5]], float)
    assert standoff_m(facade(), places) == pytest.approx(12.0)


@pytest.mark.parametrize(
    ("corners", "places"),
    [
        (facade(), np.zeros((0, 3))),
        (facade(), np.array([[0.0, 30.0, 5.0], [0.0, -1.0, 5.0], [0.0, 0.0, 5.0]])),
        (np.concatenate([facade(), facade()[:, ::-1]]), np.array([[0.0, -30.0, 5.0]])),
        (np.zeros((0, 4, 3)), np.array([[0.0, -30.0, 5.0]])),
    ],
    ids=["no photos", "behind it or at it", "panels on all sides", "no panels"],
)
def test_where_no_photo_was_taken_before_it_nothing_is_told(corners, places):
    assert standoff_m(corners, places) is None


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-200, 200)] * 3), max_size=12), st.floats(-1e5, 1e5), st.floats(0, 6.28))
def test_it_is_the_same_wherever_the_site_is(places, shift, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    # None is so near to the least distance that rounding decides.
    places = np.array([place for place in places if abs(-place[1] - LEAST_M) > 1e-3], float).reshape(-1, 3)
    there = standoff_m(facade(), places)
    moved = standoff_m(facade() @ turn.T + shift, places @ turn.T + shift)
    assert moved == (None if there is None else pytest.approx(there, abs=1e-6))


@pytest.mark.parametrize("content", [{}, {"places_enu_m": []}, {"places_enu_m": "here"}, {"places_enu_m": [[1, 2]]}])
def test_models_that_do_not_know_their_places_have_none(content):
    assert places_of(content).shape == (0, 3)


def test_places_are_those_that_are_numbers():
    assert places_of({"places_enu_m": [[1, 2, 3], [1, float("nan"), 3]]}).tolist() == [[1, 2, 3]]
