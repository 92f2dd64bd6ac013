from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mission.model import bearing_deg, courses_deg, distance_m, leg_lengths_m, point_between, shots_on_leg
from planning.base.errors import MissionError
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin


@pytest.mark.parametrize("origin", [Origin(52.0, 5.0, 0.0), Origin(0.0, 180.0, 0.0), Origin(-75.0, -179.9999, 0.0)])
def test_lengths_and_courses_are_those_of_the_local_frame(origin: Origin) -> None:
    points = np.array([[0.0, 0.0, 10.0], [30.0, 0.0, 10.0], [30.0, 0.0, 50.0], [0.0, -40.0, 50.0]])
    lat, lon, height = geodetic_from_enu(origin, points)
    assert leg_lengths_m(lat, lon, height) == pytest.approx([30.0, 40.0, 50.0], rel=1e-4)
    east, up, back = courses_deg(list(lat), list(lon))
    assert east == pytest.approx(90.0, abs=0.01)
    assert up is None
    assert back == pytest.approx(math.degrees(math.atan2(-30.0, -40.0)), abs=0.01)


def test_fewer_than_two_points_have_no_legs() -> None:
    assert leg_lengths_m([1.0], [2.0], [3.0]).shape == (0,)
    assert courses_deg([1.0], [2.0]) == []


def test_bearing_and_distance_across_the_antimeridian_take_the_short_way() -> None:
    assert bearing_deg(0.0, 179.999, 0.0, -179.999) == pytest.approx(90.0)
    assert distance_m(0.0, 179.999, 0.0, -179.999) == pytest.approx(222.639, abs=0.01)
    lat, lon = point_between(0.0, 179.999, 0.0, -179.999, 0.5)
    assert (lat, abs(lon)) == pytest.approx((0.0, 180.0))


@given(
    lengths=st.lists(st.floats(0.0, 300.0), min_size=1, max_size=8),
    spacing=st.floats(0.5, 50.0),
)
def test_shots_lie_one_spacing_apart_across_legs_and_none_is_missed(lengths: list[float], spacing: float) -> None:
    shots, travelled = [], 0.0
    for length in lengths:
        fractions = shots_on_leg(travelled, length, spacing)
        assert all(0.0 < fraction <= 1.0 for fraction in fractions)
        shots += [travelled + fraction * length for fraction in fractions]
        travelled += length
    assert len(shots) in (math.floor(travelled / spacing - 1e-6), math.floor(travelled / spacing + 1e-6))
    assert shots == pytest.approx([spacing * (i + 1) for i in range(len(shots))], rel=1e-6, abs=1e-6)


def test_trigger_that_would_take_thousands_of_photos_is_a_mistake() -> None:
    with pytest.raises(MissionError, match="every 1e-05 would take 1e"):
        shots_on_leg(0.0, 10.0, 1e-5)


def test_no_spacing_and_no_length_give_no_shots() -> None:
    assert shots_on_leg(0.0, 10.0, 0.0) == []
    assert shots_on_leg(0.0, 0.0, 5.0) == []
