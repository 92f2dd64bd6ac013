"""Which photo is of which planned view, and why a view has none.

Photos and views of a sortie are aligned in the order of flight by a dynamic programme: of all ways to pair them in
order, the one with the largest sum of 1 - e^2, where e is how far a photo is from a view in parts of the gates. What
was flown out of order (again, later, the other way round) is paired afterwards, by an optimal assignment. A photo is
only ever paired with the view that it fits best, or nearly so: one that is missing does not shift all that follow.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from missions.flight.outcome import Reason
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.geo.frames import Vec3, heading_difference_rad, wrap_heading_deg
from planning.plan import Plan, Viewpoint, ViewpointArrays, viewpoint_arrays

# How the aircraft moved at the shutter of each photo of a flight.

Array = NDArray[np.float64]

WITHIN_S = 1.0
"""A track says nothing of moments that are further from its samples."""

STANDSTILL_M_S = 0.05
"""Below this speed, a velocity has no direction to speak of."""


def shutter_velocities(record: FlightRecord) -> tuple[Vec3, ...]:
    """Velocities at the shutters of a record's photos, ENU, m/s; 0 where nothing is known.

    By the track, with the speed over ground that the photo has itself. A photo with a speed, of which the track does
    not say the direction, flies from the photo before towards the one after.
    """
    times = np.array([photo.time_s for photo in record.photos], np.float64)
    velocities = _by_track(record.track, times)
    places = np.array([photo.position_enu_m for photo in record.photos], np.float64).reshape(-1, 3)
    last = max(len(times) - 1, 0)
    for number, photo in enumerate(record.photos):
        if photo.speed_m_s is None:
            continue
        way = velocities[number, :2]
        if np.hypot(*way) < STANDSTILL_M_S:
            way = (places[min(number + 1, last)] - places[max(number - 1, 0)])[:2]
        length = float(np.hypot(*way))
        velocities[number, :2] = way / length * photo.speed_m_s if length > 0.0 else 0.0
    return tuple((east, north, up) for east, north, up in velocities.tolist())


def _by_track(track: Track, times_s: Array) -> Array:
    """Velocities between the samples that have one, shape (n, 3)."""
    known = np.isfinite(track.velocity_enu_m_s).all(axis=1)
    if not known.any():
        return np.zeros((len(times_s), 3))
    at_s, velocities = track.time_s[known], track.velocity_enu_m_s[known]
    found = np.column_stack([np.interp(times_s, at_s, velocities[:, axis]) for axis in range(3)])
    after = np.clip(np.searchsorted(at_s, times_s), 0, len(at_s) - 1)
    away_s = np.minimum(np.abs(at_s[after] - times_s), np.abs(at_s[np.maximum(after - 1, 0)] - times_s))
    found[away_s > WITHIN_S] = 0.0
    return np.asarray(found)


# Photos that were taken but not told of: the camera numbers its photos, so a report lost on the radio leaves a gap.
#
# Between two photos the gap is in their numbers. Before the first and after the last one it is between their numbers
# and what the camera said, before and after the flight, of how many it had counted.

FIRST_NUMBER = {"camera-feedback": 1, "image-captured": 0}
"""Sources that come over the radio, each photo once, and the number of a camera's first photo there (MAVLink: the index
in CAMERA_IMAGE_CAPTURED counts from 0). Other numbers (of files, of log entries) may have gaps of their own."""

LEAST_STEPS = 3
"""Equal steps between photos from which on they are the camera's way of counting."""

UNHEARD_S = 2.0
"""An aircraft at 5 m/s is 10 m further on by then, and may have been at a view meanwhile."""


def _n_lost_between(record: FlightRecord, first: int, last: int) -> int:
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
    reported_indices = {photo.index for photo in record.photos[first:last] if before.index < photo.index < after.index}
    return max(0, after.index - before.index - 1 - len(reported_indices))


def _is_unheard_between(record: FlightRecord, first: int, last: int) -> bool:
    """Whether the track has a pause between two photos, so that it does not say where the aircraft was meanwhile."""
    start_s, end_s = record.photos[first].time_s, record.photos[last].time_s
    time_s = record.track.time_s
    heard_s = [start_s, *time_s[(time_s > start_s) & (time_s < end_s)], end_s]
    return bool(np.max(np.diff(heard_s)) > UNHEARD_S)


def n_lost_before(record: FlightRecord, photo: int) -> int:
    """How many photos the camera counted from the beginning of the flight to one that it told of, and did not tell of.

    0 where it did not say how many there were before, as `_n_lost_between` otherwise.
    """
    first, counted = record.photos[0], record.counted_before
    if counted is None or first.source not in FIRST_NUMBER or _failed(record, -float("inf"), first.time_s):
        return _n_lost_between(record, 0, photo)
    return max(0, first.index - counted - _first_number(record, first)) + _n_lost_between(record, 0, photo)


def n_lost_after(record: FlightRecord, photo: int) -> int:
    """How many photos the camera counted from one that it told of to the end of the flight, and did not tell of.

    0 where it did not say how many there were afterwards, as `_n_lost_between` otherwise.
    """
    last, counted = record.photos[-1], record.counted_after
    end = len(record.photos) - 1
    if counted is None or last.source not in FIRST_NUMBER or _failed(record, last.time_s, float("inf")):
        return _n_lost_between(record, photo, end)
    return max(0, counted - 1 - (last.index - _first_number(record, last))) + _n_lost_between(record, photo, end)


def n_lost(record: FlightRecord) -> int:
    """How many photos the camera counted in the flight, and did not tell of, as far as its numbers say."""
    if not record.photos:
        before, after = record.counted_before, record.counted_after
        return 0 if before is None or after is None else max(0, after - before)
    pairs = itertools.pairwise(range(len(record.photos)))
    between = sum(_n_lost_between(record, first, last) for first, last in pairs)
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


@dataclass(frozen=True, slots=True)
class Gates:
    """How far a photo may be from a view and still be taken for it; not how far it should be.

    Parameters
    ----------
    position_m
        Autopilots that trigger while they fly miss a view by metres (ArduCopter 4.5.6 by 3.7 to 7.2 m).
    angle_deg
        Of heading and pitch, each.
    slack
        A photo may be paired with another view than the one it fits best, if that fits as well within this part of the
        gates: GNSS errors blur what is closer together.
    reached_m
        An aircraft that came this close was at the view.
    """

    position_m: float = 5.0
    angle_deg: float = 20.0
    slack: float = 0.15
    reached_m: float = 2.0

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")


DEFAULT_GATES = Gates()

TOO_FAR = 3.0
"""Photos up to this many gates away are told of as taken too far away; beyond they have nothing to do with a view."""


@dataclass(frozen=True, slots=True)
class PhotoRef:
    """A photo of a flight: which record, and which of its photos, both from 0."""

    record: int
    photo: int


@dataclass(frozen=True, slots=True)
class ViewMatch:
    """A view with its photo, or the reason why there is none; `nearest` is the photo that the reason is about."""

    view_id: str
    sortie: int
    reason: Reason
    photo: PhotoRef | None = None
    nearest: PhotoRef | None = None


@dataclass(frozen=True, slots=True)
class Matching:
    """Views of a plan against the records of a flight.

    Parameters
    ----------
    views
        In the order of the plan's sorties.
    sortie_of_record
        Which sortie each record flew, from 1; 0 for none.
    extra
        Photos that belong to no view.
    """

    views: tuple[ViewMatch, ...]
    sortie_of_record: tuple[int, ...]
    extra: tuple[PhotoRef, ...]


def match_flight(
    plan: Plan,
    records: Sequence[FlightRecord],
    gates: Gates = DEFAULT_GATES,
    are_cut_off: Sequence[bool] = (),
) -> Matching:
    """Tie every planned view to a photo or a reason.

    Parameters
    ----------
    are_cut_off
        For each record, whether it ends while the aircraft flies on; none does where this is empty.
    """
    by_id = {view.id: view for view in plan.viewpoints}
    sorties = [tuple(by_id[identifier] for identifier in sortie.viewpoint_ids) for sortie in plan.sorties]
    flown = tuple(_sortie_flown(record, sorties, gates) for record in records)
    views: list[ViewMatch] = []
    used: set[PhotoRef] = set()
    for number, planned in enumerate(sorties, 1):
        own = [index for index, sortie in enumerate(flown) if sortie == number]
        ends = Reason.NOT_RECORDED if are_cut_off and any(are_cut_off[index] for index in own) else Reason.FLIGHT_ENDED
        found = _match_sortie(number, planned, own, records, gates, ends)
        used.update(match.photo for match in found if match.photo is not None)
        views += found
    every = (PhotoRef(r, p) for r, record in enumerate(records) for p in range(len(record.photos)))
    return Matching(tuple(views), flown, tuple(photo for photo in every if photo not in used))


def _sortie_flown(record: FlightRecord, sorties: Sequence[tuple[Viewpoint, ...]], gates: Gates) -> int:
    """The sortie that fits a record best, by its photos, or by its track where no photo fits any; 0 for none.

    The record's own number decides between equals only.
    """
    by_photos = [float(_aligned(_misfits(views, record.photos, gates))[1]) for views in sorties]
    scores = by_photos if max(by_photos, default=0.0) > 0.0 else [_share_reached(v, record, gates) for v in sorties]
    best = max(scores, default=0.0)
    if best <= 0.0:
        return 0
    equals = [number for number, score in enumerate(scores, 1) if score >= best - 1e-9]
    return record.sortie if record.sortie in equals else equals[0]


def _share_reached(views: Sequence[Viewpoint], record: FlightRecord, gates: Gates) -> float:
    if not views:
        return 0.0
    return float(np.mean([away_m <= gates.reached_m for away_m in _closest_m(views, record)]))


def _closest_m(views: Sequence[Viewpoint], record: FlightRecord) -> list[float]:
    """How close a record's track comes to each view, between its samples, too; inf where there is no track."""
    points = record.track.position_enu_m[np.isfinite(record.track.position_enu_m).all(axis=1)]
    if len(points) == 0:
        return [math.inf] * len(views)
    start, step = points, np.diff(points, axis=0, append=points[-1:])
    length2 = np.maximum((step**2).sum(axis=1), 1e-12)
    found = []
    for view in views:
        to_view = np.array(view.position_enu_m) - start
        share = np.clip((to_view * step).sum(axis=1) / length2, 0.0, 1.0)
        found.append(float(np.linalg.norm(to_view - share[:, None] * step, axis=1).min()))
    return found


def _misfits(views: Sequence[Viewpoint], photos: Sequence[TakenPhoto], gates: Gates) -> Array:
    """How far each photo is from each view in parts of the gates, shape (n, m): the largest of position and angles."""
    planned, taken = viewpoint_arrays(tuple(views)), _photo_arrays(photos)
    position = np.linalg.norm(planned.positions_enu_m[:, None] - taken.positions_enu_m[None], axis=2)
    return np.asarray(np.maximum(position / gates.position_m, _angles_off(planned, taken, gates)))


def _angles_off(planned: ViewpointArrays, taken: ViewpointArrays, gates: Gates) -> Array:
    """The larger of heading and pitch error in parts of the gate, shape (n, m); angles that are not known fit."""
    heading = np.abs(heading_difference_rad(planned.heading_rad[:, None], taken.heading_rad[None]))
    # Looking steeply down a heading hardly matters: what counts is how far the picture turns and moves.
    heading = heading * np.cos(planned.pitch_rad)[:, None]
    pitch = np.abs(planned.pitch_rad[:, None] - taken.pitch_rad[None])
    off: Array = np.nan_to_num(np.fmax(heading, pitch)) / math.radians(gates.angle_deg)
    return off


def _photo_arrays(photos: Sequence[TakenPhoto]) -> ViewpointArrays:
    """Poses of photos; NaN for angles that are not known."""
    angles = np.array([(photo.heading_deg, photo.gimbal_pitch_deg) for photo in photos], np.float64).reshape(-1, 2)
    positions = np.array([photo.position_enu_m for photo in photos], np.float64).reshape(-1, 3)
    return ViewpointArrays(positions, np.radians(angles[:, 0]), np.radians(angles[:, 1]))


def _gains(misfits: Array, gates: Gates) -> Array:
    """What pairing each view and photo is worth: 1 - e^2, and nothing where they are not to be paired."""
    best = misfits.min(axis=0, initial=np.inf)
    fits = (misfits <= 1.0) & (misfits <= best + gates.slack)
    return np.where(fits, 1.0 - np.minimum(misfits, 1.0) ** 2, 0.0)


def _aligned(misfits: Array, gates: Gates = DEFAULT_GATES) -> tuple[list[tuple[int, int]], float]:
    """The best pairs of view and photo in order, and their worth.

    `best[i, j]` is the worth of the first i views and j photos: the larger of leaving out view i, leaving out photo j,
    and pairing them (Needleman and Wunsch, 1970, with gaps that cost nothing).
    """
    gains = _gains(misfits, gates)
    n, m = gains.shape
    best = np.zeros((n + 1, m + 1))
    for i in range(n):
        with_view = np.maximum(best[i, 1:], best[i, :-1] + gains[i])
        best[i + 1, 1:] = np.maximum.accumulate(with_view)
    pairs = []
    i, j = n, m
    while i > 0 and j > 0:
        if best[i, j] == best[i - 1, j]:
            i -= 1
        elif best[i, j] == best[i, j - 1]:
            j -= 1
        else:
            i, j = i - 1, j - 1
            pairs.append((i, j))
    return pairs[::-1], float(best[n, m])


def _match_sortie(
    number: int,
    views: Sequence[Viewpoint],
    own: list[int],
    records: Sequence[FlightRecord],
    gates: Gates,
    ends: Reason,
) -> list[ViewMatch]:
    """Matches of one sortie's views with the photos of the records that flew it; `ends` is why the last have none."""
    refs = [PhotoRef(index, photo) for index in own for photo in range(len(records[index].photos))]
    photos = [records[ref.record].photos[ref.photo] for ref in refs]
    misfits = _misfits(views, photos, gates)
    photo_of = dict(_aligned(misfits, gates)[0])
    photo_of.update(_out_of_order(misfits, photo_of, gates))
    found = {view: ViewMatch(views[view].id, number, Reason.TAKEN, refs[photo]) for view, photo in photo_of.items()}
    missing = [view for view in range(len(views)) if view not in found]
    if missing:
        left = np.flatnonzero(misfits.min(axis=0, initial=np.inf) > 1.0).tolist()  # the others are of some view
        reasons = _reasons(views, missing, [records[index] for index in own], set(photo_of), gates, ends)
        for view in missing:
            near = _near_miss(views[view], [photos[photo] for photo in left], gates)
            reason = reasons[view] if near is None else near[0]
            nearest = None if near is None else refs[left[near[1]]]
            found[view] = ViewMatch(views[view].id, number, reason, None, nearest)
    return _with_lost_reports([found[view] for view in range(len(views))], records, own)


def _with_lost_reports(found: list[ViewMatch], records: Sequence[FlightRecord], own: list[int]) -> list[ViewMatch]:
    """The matches, with the views whose photo was taken but not told of.

    Between two photos of views, before the first and after the last one, they are known where the camera counted as
    many as there are views without any photo; where it counted fewer or more, which of them were photographed is not
    known. Where the track has a pause, because the link was lost, views that it passes by count, too. A sortie that was
    flown in several pieces has no one beginning and end.
    """
    photographed = [(view, match.photo) for view, match in enumerate(found) if match.photo is not None]
    without_photo = {Reason.NO_PHOTO}
    stretches: list[tuple[range, int, set[Reason]]] = []
    for (before, first), (after, last) in itertools.pairwise(photographed):
        if first.record == last.record and first.photo <= last.photo:
            ends = records[first.record], first.photo, last.photo
            reasons = without_photo | ({Reason.NOT_REACHED} if _is_unheard_between(*ends) else set())
            stretches.append((range(before + 1, after), _n_lost_between(*ends), reasons))
    if len(own) == 1 and photographed:
        (first_view, first), (last_view, last) = photographed[0], photographed[-1]
        stretches.append((range(first_view), n_lost_before(records[own[0]], first.photo), without_photo))
        stretches.append((range(last_view + 1, len(found)), n_lost_after(records[own[0]], last.photo), without_photo))
    elif len(own) == 1:
        stretches.append((range(len(found)), n_lost(records[own[0]]), without_photo))
    for views, n_photos, reasons in stretches:
        silent = [view for view in views if found[view].reason in reasons]
        if n_photos == len(silent):
            for view in silent:
                found[view] = replace(found[view], reason=Reason.REPORT_LOST)
    return found


def _out_of_order(misfits: Array, photo_of: dict[int, int], gates: Gates) -> dict[int, int]:
    """Pairs of what is left after pairing in order."""
    from scipy.optimize import linear_sum_assignment

    views = [view for view in range(misfits.shape[0]) if view not in photo_of]
    photos = sorted(set(range(misfits.shape[1])) - set(photo_of.values()))
    if not views or not photos:
        return {}
    gains = _gains(misfits, gates)[np.ix_(views, photos)]
    rows, columns = linear_sum_assignment(gains, maximize=True)
    return {views[row]: photos[column] for row, column in zip(rows, columns, strict=True) if gains[row, column] > 0.0}


def _near_miss(view: Viewpoint, photos: Sequence[TakenPhoto], gates: Gates) -> tuple[Reason, int] | None:
    """The photo that was probably meant for a view but is not of it, and what is wrong with it."""
    if not photos:
        return None
    planned, taken = viewpoint_arrays((view,)), _photo_arrays(photos)
    away = np.linalg.norm(taken.positions_enu_m - planned.positions_enu_m, axis=1) / gates.position_m
    turned = _angles_off(planned, taken, gates)[0]
    at_place = np.flatnonzero((away <= 1.0) & (turned > 1.0))
    if len(at_place):
        return Reason.WRONG_ANGLE, int(at_place[np.argmin(turned[at_place])])
    aimed = np.flatnonzero((away > 1.0) & (away <= TOO_FAR) & (turned <= 1.0))
    if len(aimed):
        return Reason.TOO_FAR, int(aimed[np.argmin(away[aimed])])
    return None


def _reasons(
    views: Sequence[Viewpoint],
    missing: list[int],
    records: Sequence[FlightRecord],
    taken: set[int],
    gates: Gates,
    ends: Reason,
) -> dict[int, Reason]:
    """Why views without any photo near them have none."""
    if not records:
        return dict.fromkeys(missing, Reason.NOT_FLOWN)
    closest = [min(away) for away in zip(*(_closest_m(views, record) for record in records), strict=True)]
    if not any(map(math.isfinite, closest)):
        return dict.fromkeys(missing, Reason.NO_TRACK)
    reached = {view for view in missing if closest[view] <= gates.reached_m}
    last = max(taken | reached, default=-1)
    reasons = {}
    for view in missing:
        if view in reached:
            reasons[view] = Reason.NO_PHOTO
        else:
            reasons[view] = ends if view > last else Reason.NOT_REACHED
    return reasons


# From where, and in which direction, the photos of a flight were really taken.


def taken_poses(plan: Plan, records: Sequence[FlightRecord], matching: Matching) -> dict[PhotoRef, Viewpoint]:
    """Poses of all photos whose direction is known; that of a view has the view's angles where its source does not say.

    The photos that are missing here belong to no view, and nothing says where they look.
    """
    by_id = {view.id: view for view in plan.viewpoints}
    view_of = {match.photo: by_id[match.view_id] for match in matching.views if match.photo is not None}
    refs = (PhotoRef(record, photo) for record, flown in enumerate(records) for photo in range(len(flown.photos)))
    poses = ((ref, pose_of_photo(records[ref.record].photos[ref.photo], view_of.get(ref))) for ref in refs)
    return {ref: pose for ref, pose in poses if pose is not None}


def pose_of_photo(photo: TakenPhoto, view: Viewpoint | None) -> Viewpoint | None:
    """Where a photo was taken from and looks to; None where neither it nor its view says the direction."""
    heading_deg, pitch_deg = photo.heading_deg, photo.gimbal_pitch_deg
    if view is not None:
        heading_deg = view.heading_deg if heading_deg is None else heading_deg
        pitch_deg = view.gimbal_pitch_deg if pitch_deg is None else pitch_deg
    if heading_deg is None or pitch_deg is None:
        return None
    return Viewpoint("photo", photo.position_enu_m, wrap_heading_deg(heading_deg), min(90.0, max(-180.0, pitch_deg)))
