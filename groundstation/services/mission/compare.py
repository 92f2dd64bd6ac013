"""Is this mission file the plan? Photo by photo: where, looking where, in which order, and along which path."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from missions.mission.export_choices import FileFormat
from missions.mission.model import ReadMission
from missions.mission.to_plan import viewpoints_and_sorties
from planning.base.errors import InputError
from planning.base.findings import Finding
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3, camera_axes, heading_difference_rad
from planning.plan import Plan, Sortie, Viewpoint, viewpoint_arrays

SAME_M, SAME_DEG = 0.1, 0.2
"""Within these a photo is the planned one: files of other programs round coordinates to 1e-6 deg (0.11 m) and angles to
0.1 deg; an aircraft with RTK holds no better."""

PAIR_M, PAIR_DEG = 5.0, 45.0
"""Beyond these a photo is another one, not a planned one that was moved or turned."""

DEG_PER_M = 9.0
"""Degrees that weigh as much as a metre when photos are paired: the ratio of the two limits above."""

MAX_PAIRS = 25_000_000
"""5 000 photos on both sides, 40 batteries: a few hundred megabytes while they are paired."""

SAMPLE_M = 0.5
"""Spacing along paths whose deviation is measured."""

SAMPLES_AT_ONCE = 2000
"""Bounds the memory of one block of distances to about 50 MB."""


class Difference(StrEnum):
    """How a photo of the file and one of the plan compare."""

    SAME = "same"
    CHANGED = "changed"
    MISSING = "missing"
    """Planned, not in the file."""
    EXTRA = "extra"
    """In the file, not planned."""


@dataclass(frozen=True, slots=True)
class PhotoComparison:
    """One photo of the plan, of the file, or of both.

    Parameters
    ----------
    viewpoint_id, sortie
        In the plan; empty and 0 for extra photos.
    file_sortie, file_number
        Which mission of the file and which photo of it, from 1; 0 for missing photos.
    distance_m, heading_deg, pitch_deg
        From the planned to the file's: distance of the two places, turn in (-180, 180], change of gimbal pitch. None
        where there are no two.
    is_out_of_order
        Taken before a photo that the plan takes earlier.
    """

    difference: Difference
    viewpoint_id: str
    sortie: int
    file_sortie: int
    file_number: int
    distance_m: float | None = None
    heading_deg: float | None = None
    pitch_deg: float | None = None
    is_out_of_order: bool = False


@dataclass(frozen=True, slots=True)
class MissionComparison:
    """What a mission file has of a plan.

    Parameters
    ----------
    photos
        The plan's in the order of flight, then the extra ones.
    path_deviation_m
        Largest distance between the two flights' paths, either way; None where the file holds no path (tables of
        photos) or one of the two has none.
    findings
        On the reading of the file.
    """

    photos: tuple[PhotoComparison, ...]
    path_deviation_m: float | None
    findings: tuple[Finding, ...]

    def count(self, difference: Difference) -> int:
        """Number of photos that compare so."""
        return sum(photo.difference is difference for photo in self.photos)

    @property
    def n_out_of_order(self) -> int:
        """Number of photos that are taken in another order."""
        return sum(photo.is_out_of_order for photo in self.photos)

    @property
    def has_the_photos(self) -> bool:
        """Whether the file takes all photos of the plan and none else, in whatever order."""
        return bool(self.photos) and all(photo.difference is Difference.SAME for photo in self.photos)

    @property
    def missing_sorties(self) -> tuple[int, ...]:
        """Sorties of the plan of which the file has nothing, where all else is as planned; empty otherwise."""
        kinds = (Difference.SAME, Difference.MISSING)
        there = {photo.sortie for photo in self.photos if photo.difference is Difference.SAME}
        missing = {photo.sortie for photo in self.photos if photo.difference is Difference.MISSING}
        is_rest_planned = self.n_out_of_order == 0 and all(photo.difference in kinds for photo in self.photos)
        return tuple(sorted(missing)) if there and is_rest_planned and not there & missing else ()

    @property
    def is_the_plan(self) -> bool:
        """Whether the file flies the plan: all photos, none else, in order, along the same path."""
        deviates = self.path_deviation_m is not None and self.path_deviation_m > SAME_M
        return self.has_the_photos and self.n_out_of_order == 0 and not deviates


def compare_with_plan(
    missions: Sequence[ReadMission], plan: Plan, origin: Origin, home_enu_m: Vec3
) -> MissionComparison:
    """Compare the missions of a file, in order, with a plan.

    Photos are paired by place and direction, never by name: other programs rename them. The pairing has the smallest
    sum of differences (assignment problem).

    Raises
    ------
    InputError
        The mission belongs to another place, or there are too many photos to compare.
    """
    parts = viewpoints_and_sorties(missions, origin, home_enu_m, plan.rules, plan.aircraft)
    planned, read = _in_order(plan.viewpoints, plan.sorties), _in_order(parts.viewpoints, parts.sorties)
    pairs = _pairs([view for view, _, _ in planned], [view for view, _, _ in read])
    out_of_order = _out_of_order([pairs[i] for i in sorted(pairs)])
    photos = []
    for i, (view, sortie, _) in enumerate(planned):
        j = pairs.get(i)
        if j is None:
            photos.append(PhotoComparison(Difference.MISSING, view.id, sortie, 0, 0))
        else:
            photos.append(_compared(view, sortie, *read[j], is_out_of_order=j in out_of_order))
    found = set(pairs.values())
    photos += [
        PhotoComparison(Difference.EXTRA, "", 0, sortie, number)
        for j, (_, sortie, number) in enumerate(read)
        if j not in found
    ]
    has_path = all(mission.format != FileFormat.CSV for mission in missions)
    deviation_m = _path_deviation_m(plan.sorties, parts.sorties) if has_path else None
    return MissionComparison(tuple(photos), deviation_m, parts.findings)


def _in_order(viewpoints: Sequence[Viewpoint], sorties: Sequence[Sortie]) -> list[tuple[Viewpoint, int, int]]:
    """Viewpoints in the order of flight with their sortie and number in it, both from 1."""
    by_id = {view.id: view for view in viewpoints}
    return [
        (by_id[viewpoint_id], number, nth)
        for number, sortie in enumerate(sorties, 1)
        for nth, viewpoint_id in enumerate(sortie.viewpoint_ids, 1)
    ]


def _compared(
    view: Viewpoint, sortie: int, other: Viewpoint, file_sortie: int, number: int, *, is_out_of_order: bool
) -> PhotoComparison:
    distance_m = math.dist(view.position_enu_m, other.position_enu_m)
    headings = math.radians(view.heading_deg), math.radians(other.heading_deg)
    turned_deg = math.degrees(float(heading_difference_rad(*headings)))
    tilted_deg = other.gimbal_pitch_deg - view.gimbal_pitch_deg
    is_same = distance_m <= SAME_M and max(abs(turned_deg), abs(tilted_deg)) <= SAME_DEG
    difference = Difference.SAME if is_same else Difference.CHANGED
    return PhotoComparison(
        difference, view.id, sortie, file_sortie, number, distance_m, turned_deg, tilted_deg, is_out_of_order
    )


def _pairs(planned: Sequence[Viewpoint], read: Sequence[Viewpoint]) -> dict[int, int]:
    """Photo of the file for each planned one that has one."""
    if not planned or not read:
        return {}
    if len(planned) * len(read) > MAX_PAIRS:
        raise InputError(
            say(
                "{} planned photos and {} in the file are too many to compare one by one; compare smaller plans",
                len(planned),
                len(read),
            )
        )
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial.distance import cdist

    ours, theirs = viewpoint_arrays(tuple(planned)), viewpoint_arrays(tuple(read))
    distance_m = cdist(ours.positions_enu_m, theirs.positions_enu_m)
    looks, others_look = camera_axes(*ours[1:])[0], camera_axes(*theirs[1:])[0]
    angle_deg = np.degrees(np.arccos(np.clip(looks @ others_look.T, -1.0, 1.0)))
    is_near = (distance_m <= PAIR_M) & (angle_deg <= PAIR_DEG)
    # What is no pair costs as much as the two worst that are: good pairs are not given up for bad ones.
    cost = np.where(is_near, distance_m + angle_deg / DEG_PER_M, 4.0 * PAIR_M)
    rows, columns = linear_sum_assignment(cost)
    return {int(i): int(j) for i, j in zip(rows, columns, strict=True) if is_near[i, j]}


def _out_of_order(sequence: Sequence[int]) -> set[int]:
    """What must be taken out so that the rest rises: all but the longest rising subsequence (patience sorting)."""
    ends: list[int] = []
    at_end: list[int] = []
    before: list[int] = []
    for index, value in enumerate(sequence):
        length = bisect_left(ends, value)
        ends[length : length + 1] = [value]
        at_end[length : length + 1] = [index]
        before.append(at_end[length - 1] if length else -1)
    kept, index = set(), at_end[-1] if at_end else -1
    while index >= 0:
        kept.add(sequence[index])
        index = before[index]
    return set(sequence) - kept


def _path_deviation_m(planned: Sequence[Sortie], read: Sequence[Sortie]) -> float | None:
    paths = [[np.array(s.path_enu_m) for s in sorties if len(s.path_enu_m) > 1] for sorties in (planned, read)]
    if not all(paths):
        return None
    ours, theirs = paths
    return max(_furthest_m(ours, theirs), _furthest_m(theirs, ours))


def _furthest_m(paths: Sequence[NDArray[np.float64]], others: Sequence[NDArray[np.float64]]) -> float:
    """Largest distance from points along `paths` to `others`; samples, so it may be short by half their spacing."""
    points = np.concatenate([_samples(path) for path in paths])
    starts, ends = (np.concatenate([other[part] for other in others]) for part in (slice(None, -1), slice(1, None)))
    legs = ends - starts
    squared = np.maximum((legs**2).sum(axis=1), 1e-12)
    furthest = 0.0
    for first in range(0, len(points), SAMPLES_AT_ONCE):
        rays = points[first : first + SAMPLES_AT_ONCE, None] - starts[None]
        along = np.clip((rays * legs).sum(axis=2) / squared, 0.0, 1.0)
        away = np.linalg.norm(rays - along[..., None] * legs, axis=2).min(axis=1)
        furthest = max(furthest, float(away.max()))
    return furthest


def _samples(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vertices of a path and points between them, at most `SAMPLE_M` apart."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    at_m = np.concatenate([[0.0], np.cumsum(lengths)])
    extra = np.arange(0.0, at_m[-1], SAMPLE_M)
    where = np.union1d(at_m, extra)
    return np.stack([np.interp(where, at_m, path[:, axis]) for axis in range(3)], axis=1)
