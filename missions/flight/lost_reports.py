"""Photos that were taken but not told of: the camera numbers its photos, so a report lost on the radio leaves a gap.

Between two photos the gap is in their numbers. Before the first and after the last one it is between their numbers and
what the camera said, before and after the flight, of how many it had counted.
"""

from __future__ import annotations

import itertools

import numpy as np

from missions.flight.record import FlightRecord, TakenPhoto

FIRST_NUMBER = {"camera-feedback": 1, "image-captured": 0}
"""Sources that come over the radio, each photo once, and the number of a camera's first photo there (MAVLink: the index
in CAMERA_IMAGE_CAPTURED counts from 0). Other numbers (of files, of log entries) may have gaps of their own."""

LEAST_STEPS = 3
"""Equal steps between photos from which on they are the camera's way of counting."""

UNHEARD_S = 2.0
"""An aircraft at 5 m/s is 10 m further on by then, and may have been at a view meanwhile."""


def n_lost_between(record: FlightRecord, first: int, last: int) -> int:
    """How many photos the camera counted between two that it told of, without the others that it told of.

    Parameters
    ----------
    first, last
        Which of the record's photos, from 0.

    Returns
    -------
    int
        0 where the numbers say nothing: they began again, or the camera failed in between and may have counted that.
    """
    before, after = record.photos[first], record.photos[last]
    if before.source not in FIRST_NUMBER or after.source != before.source:
        return 0
    if _failed(record, before.time_s, after.time_s):
        return 0
    told = {photo.index for photo in record.photos[first:last] if before.index < photo.index < after.index}
    return max(0, after.index - before.index - 1 - len(told))


def is_unheard_between(record: FlightRecord, first: int, last: int) -> bool:
    """Whether the track has a pause between two photos, so that it does not say where the aircraft was meanwhile."""
    start_s, end_s = record.photos[first].time_s, record.photos[last].time_s
    time_s = record.track.time_s
    heard_s = [start_s, *time_s[(time_s > start_s) & (time_s < end_s)], end_s]
    return bool(np.max(np.diff(heard_s)) > UNHEARD_S)


def n_lost_before(record: FlightRecord, photo: int) -> int:
    """How many photos the camera counted from the beginning of the flight to one that it told of, and did not tell of.

    0 where it did not say how many there were before, as `n_lost_between` otherwise.
    """
    first, counted = record.photos[0], record.counted_before
    if counted is None or first.source not in FIRST_NUMBER or _failed(record, -float("inf"), first.time_s):
        return n_lost_between(record, 0, photo)
    return max(0, first.index - counted - _first_number(record, first)) + n_lost_between(record, 0, photo)


def n_lost_after(record: FlightRecord, photo: int) -> int:
    """How many photos the camera counted from one that it told of to the end of the flight, and did not tell of.

    0 where it did not say how many there were afterwards, as `n_lost_between` otherwise.
    """
    last, counted = record.photos[-1], record.counted_after
    end = len(record.photos) - 1
    if counted is None or last.source not in FIRST_NUMBER or _failed(record, last.time_s, float("inf")):
        return n_lost_between(record, photo, end)
    return max(0, counted - 1 - (last.index - _first_number(record, last))) + n_lost_between(record, photo, end)


def n_lost(record: FlightRecord) -> int:
    """How many photos the camera counted in the flight, and did not tell of, as far as its numbers say."""
    if not record.photos:
        before, after = record.counted_before, record.counted_after
        return 0 if before is None or after is None else max(0, after - before)
    pairs = itertools.pairwise(range(len(record.photos)))
    between = sum(n_lost_between(record, first, last) for first, last in pairs)
    return n_lost_before(record, 0) + between + n_lost_after(record, len(record.photos) - 1)


def counts_by_more(record: FlightRecord) -> bool:
    """Whether a camera's numbers rise by the same two or more from each photo to the next, of four or more."""
    steps = {after.index - before.index for before, after in itertools.pairwise(record.photos)}
    return len(record.photos) > LEAST_STEPS and len(steps) == 1 and min(steps) > 1


def _first_number(record: FlightRecord, photo: TakenPhoto) -> int:
    """Number of a camera's first photo; some that should count from 0 count from 1, which their last photo shows."""
    is_from_one = record.counted_after is not None and record.photos[-1].index == record.counted_after
    return max(FIRST_NUMBER[photo.source], int(is_from_one))


def _failed(record: FlightRecord, start_s: float, end_s: float) -> bool:
    return any(event.code == "camera-failed" and start_s <= event.time_s <= end_s for event in record.events)
