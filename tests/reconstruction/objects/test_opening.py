"""From where a building is seen at first."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reconstruction.objects.opening import middle_of, opening_place, outward, places_of

HALF_FIELD = 0.5


def facade(width_m=20.0, height_m=10.0, n=5):
    """Panels side by side in the plane y = 0, seen from the south."""
    xs = np.linspace(-width_m / 2, width_m / 2, n + 1)
    return np.array(
        [[[left, 0, 0], [right, 0, 0], [right, 0, height_m], [left, 0, height_m]] for left, right in pairwise(xs)]
    )


def test_a_place_straight_before_the_facade_that_shows_all_of_it_is_taken():
    places = np.array([[0, -40, 5], [0, -8, 5], [30, -30, 5], [0, 30, 5], [0, -300, 200]], float)
    assert outward(facade()) == pytest.approx([0, -1, 0])
    assert middle_of(facade()) == pytest.approx([0, 0, 5])
    assert opening_place(facade(), places, HALF_FIELD).tolist() == [0, -40, 5]


def test_where_none_shows_all_of_it_the_farther_one_is_taken():
    places = np.array([[0, -8, 5], [0, -12, 5], [0, -3, 5]], float)
    assert opening_place(facade(), places, HALF_FIELD).tolist() == [0, -12, 5]


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
def test_where_there_is_no_such_place_none_is_found(corners, places):
    assert opening_place(corners, places, HALF_FIELD) is None


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-200, 200)] * 3), max_size=12), st.floats(-1e6, 1e6), st.floats(0, 6.28))
def test_it_is_one_of_them_before_the_facade_wherever_the_site_is(places, shift, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    places = np.array(places, float).reshape(-1, 3)
    there = opening_place(facade(), places, HALF_FIELD)
    moved = opening_place(facade() @ turn.T + shift, places @ turn.T + shift, HALF_FIELD)
    if there is None:
        assert moved is None or (-(places[:, 1]) >= 1.99).any()
        return
    assert (places == there).all(axis=1).any()
    assert there[1] <= -2.0
    assert moved is not None


@pytest.mark.parametrize("content", [{}, {"places_enu_m": []}, {"places_enu_m": "here"}, {"places_enu_m": [[1, 2]]}])
def test_models_that_do_not_know_their_places_have_none(content):
    assert places_of(content).shape == (0, 3)


def test_places_are_those_that_are_numbers():
    assert places_of({"places_enu_m": [[1, 2, 3], [1, float("nan"), 3]]}).tolist() == [[1, 2, 3]]
