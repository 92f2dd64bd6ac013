"""How the aircraft moved at each shutter: by the track, by the photo's own speed, or by its neighbours."""

import numpy as np
import pytest

from missions.flight.matching import shutter_velocities
from missions.flight.record import FlightRecord, TakenPhoto, Track


def track(times, velocities):
    n = len(times)
    nothing = np.full(n, np.nan)
    return Track(
        np.array(times, float),
        np.zeros((n, 3)),
        np.array(velocities, float).reshape(n, 3),
        nothing,
        nothing,
        nothing,
        nothing,
    )


def record(photos, times=(), velocities=()):
    return FlightRecord(1, "test", track(times, velocities), tuple(photos))


def photo(time_s, speed_m_s=None, east_m=0.0):
    return TakenPhoto(1, time_s, (east_m, 0.0, 5.0), speed_m_s=speed_m_s)


def test_the_track_tells_the_velocity_between_its_samples():
    flown = record([photo(0.5), photo(1.0)], [0.0, 1.0, 2.0], [[0, 0, 0], [2, 1, -1], [np.nan] * 3])
    assert np.array(shutter_velocities(flown)) == pytest.approx(np.array([[1.0, 0.5, -0.5], [2.0, 1.0, -1.0]]))


def test_a_track_says_nothing_of_moments_far_from_its_samples():
    flown = record([photo(-5.0), photo(5.0), photo(9.5)], [0.0, 10.0], [[3, 0, 0], [3, 0, 0]])
    assert shutter_velocities(flown) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))


def test_the_photos_own_speed_counts_in_the_tracks_direction():
    flown = record([photo(0.0, 10.0)], [0.0], [[3, 4, 1]])
    assert shutter_velocities(flown)[0] == pytest.approx((6.0, 8.0, 1.0))


def test_without_a_direction_it_is_that_of_the_photos_neighbours():
    flown = record([photo(0.0, 2.0, 0.0), photo(1.0, 2.0, -3.0), photo(2.0, 0.0, -6.0)])
    assert np.array(shutter_velocities(flown)) == pytest.approx(np.array([[-2, 0, 0], [-2, 0, 0], [0, 0, 0]], float))
    assert shutter_velocities(record([photo(0.0, 2.0)])) == ((0.0, 0.0, 0.0),)
    assert shutter_velocities(record([photo(0.0)])) == ((0.0, 0.0, 0.0),)
    assert shutter_velocities(record([])) == ()
