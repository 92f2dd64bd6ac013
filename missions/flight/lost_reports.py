"""Photos that were taken but not told of: the camera numbers its photos, so a report lost on the radio leaves a gap."""

from __future__ import annotations

import itertools

from missions.flight.record import FlightRecord

REPORTED = ("camera-feedback", "image-captured")
"""Sources that come over the radio, each photo once. Other numbers (of files, of log entries) may have gaps of their
own."""


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
    if before.source not in REPORTED or after.source != before.source:
        return 0
    if any(e.code == "camera-failed" and before.time_s <= e.time_s <= after.time_s for e in record.events):
        return 0
    told = {photo.index for photo in record.photos[first:last] if before.index < photo.index < after.index}
    return max(0, after.index - before.index - 1 - len(told))


def n_lost(record: FlightRecord) -> int:
    """How many photos the camera counted in all between its first and its last report, and did not tell of.

    What was lost before the first or after the last one leaves no gap and is not counted.
    """
    pairs = itertools.pairwise(range(len(record.photos)))
    return sum(n_lost_between(record, first, last) for first, last in pairs)
