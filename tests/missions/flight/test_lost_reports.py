"""Photos that were taken but not told of, by the camera's numbers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.flight.matching import n_lost, n_lost_after, n_lost_before
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track

SOURCES = {"camera-feedback": 1, "image-captured": 0}


def record(indices, source="camera-feedback", before=None, after=None, events=()):
    nothing = np.zeros(0)
    track = Track(nothing, np.zeros((0, 3)), np.zeros((0, 3)), nothing, nothing, nothing, nothing)
    photos = tuple(TakenPhoto(i, float(i), (0.0, 0.0, 0.0), source=source) for i in indices)
    return FlightRecord(1, "toy", track, photos, events, counted_before=before, counted_after=after)


@given(
    source=st.sampled_from(sorted(SOURCES)),
    before=st.integers(0, 50),
    n_photos=st.integers(1, 30),
    data=st.data(),
)
def test_what_the_camera_counted_less_what_it_told_of_is_lost(source, before, n_photos, data):
    """Truth: photos numbered on from the count before; any of them, but not all, may be lost."""
    all_numbers = [SOURCES[source] + before + i for i in range(n_photos)]
    told = sorted(data.draw(st.sets(st.sampled_from(all_numbers), min_size=1)))
    found = record(told, source, before, before + n_photos)
    is_from_one = source == "image-captured" and told[-1] == before + n_photos
    assert not is_from_one  # counts from 0, so that its last number is below the count
    assert n_lost(found) == n_photos - len(told)
    assert n_lost_before(found, 0) == told[0] - all_numbers[0]
    assert n_lost_after(found, len(told) - 1) == all_numbers[-1] - told[-1]


@pytest.mark.parametrize("source", SOURCES)
def test_without_the_cameras_counts_only_gaps_are_known(source):
    assert n_lost(record([3, 4, 7], source)) == 2
    assert n_lost(record([])) == 0
    assert n_lost(record([], before=4, after=9)) == 5


def test_a_camera_that_counts_from_one_where_it_should_from_zero_has_lost_nothing():
    assert n_lost(record([1, 2, 3, 4], "image-captured", 0, 4)) == 0
    assert n_lost(record([1, 3, 4], "image-captured", 0, 4)) == 1


def test_counts_that_do_not_fit_the_numbers_say_nothing():
    """The camera was switched off and on in between, or its card was formatted."""
    assert n_lost(record([1, 2, 3], before=200, after=2)) == 0


def test_a_camera_that_failed_may_have_counted_that():
    event = FlightEvent(1.0, "camera-failed", "")
    assert n_lost(record([4, 5], before=0, after=5, events=(event,))) == 0
    assert n_lost(replace(record([4, 5], before=0, after=5), events=(FlightEvent(4.5, "camera-failed", ""),))) == 3


def test_numbers_of_files_have_gaps_of_their_own():
    assert n_lost(record([3, 9], "photo-file", 0, 20)) == 0
