"""Flight records from the photos of a flight alone: where and when each was taken, out of its own metadata.

Photos say nothing of the way between them. Such a record has no track: distances are known where photos were taken
only, and why a view has no photo is not known at all.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from missions.flight.logs.flights import LogFlights
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.base.progress import QUIET, Monitor
from planning.photos.folder import clock_s, in_order, read_photos
from planning.photos.places import PhotoHeights, absolute_height_m, photo_places, photos_near, receiver_findings
from planning.photos.record import PhotoMetadata
from planning.site.records import Site

Floats = NDArray[np.float64]

SORTIE_GAP_S = 60.0
"""Photos further apart are of two sorties: views follow each other in seconds, changing a battery takes minutes. A
sortie that is parted needlessly does no harm: several records may be of one."""

INFRARED = "InfraredCamera"


def read_photo_flights(
    folder: Path, site: Site, heights: PhotoHeights = "auto", monitor: Monitor = QUIET
) -> LogFlights:
    """Flights of a folder of photos.

    Raises
    ------
    InputError
        The folder holds no photos, or none of them says where and when it was taken, or they belong to another site.
    """
    found = read_photos(folder, monitor)
    flights = photo_flights(found.photos, site, str(folder), heights)
    return LogFlights(flights.records, (*found.findings, *flights.findings))


@dataclass(frozen=True, slots=True, eq=False)
class FlownPhotos:
    """Photos with the places and times that they say.

    Parameters
    ----------
    points_enu_m, times_s
        Shapes (n, 3) and (n,); times of one clock for all.
    sorties
        Numbers of photos by aircraft and sortie, in the order of flight.
    """

    photos: tuple[PhotoMetadata, ...]
    points_enu_m: Floats
    times_s: Floats
    sorties: tuple[list[int], ...]
    findings: tuple[Finding, ...]

    def flights(self) -> LogFlights:
        """A record of each sortie."""
        records = (_record(self.photos, self.times_s, self.points_enu_m, sortie) for sortie in self.sorties)
        return LogFlights(tuple(records), self.findings)


def photo_flights(
    photos: Sequence[PhotoMetadata], site: Site, label: str, heights: PhotoHeights = "auto"
) -> LogFlights:
    """Flight records of photos, as `flown_photos` has them."""
    return flown_photos(photos, site, label, heights).flights()


def flown_photos(
    photos: Sequence[PhotoMetadata], site: Site, label: str, heights: PhotoHeights = "auto"
) -> FlownPhotos:
    """Photos that say where and when they were taken, shared out among sorties.

    Parameters
    ----------
    photos
        In any order.
    label
        Where they are from, for messages.

    Raises
    ------
    InputError
        As `read_photo_flights`.
    """
    findings: list[Finding] = []
    near, elsewhere = photos_near(_usable(photos, label, findings), site, label)
    here = in_order(near)
    times_s = _times_s(here)
    places = photo_places(here, site, heights, label)
    findings += [*elsewhere, *places.findings, *receiver_findings(here)]
    return FlownPhotos(tuple(here), places.points_enu_m, times_s, tuple(_sorties(here, times_s)), tuple(findings))


def _usable(photos: Sequence[PhotoMetadata], label: str, findings: list[Finding]) -> list[PhotoMetadata]:
    """Photos with a position, a time and a height, of the camera for visible light."""
    visible = [photo for photo in photos if photo.image_source != INFRARED]
    if visible and len(visible) < len(photos):
        n = len(photos) - len(visible)
        text = say("{} thermal photos are left out; they were taken together with the others", n)
        findings.append(Finding(Severity.NOTE, "photos-thermal", text, "", float(n)))
        photos = visible
    usable = []
    missing: Counter[str] = Counter()
    by_exposure = all(photo.exposed_at is not None for photo in photos)
    for photo in photos:
        if photo.lat_deg is None:
            missing[say("a position")] += 1
        elif photo.taken_at is None and not by_exposure:
            missing[say("a time")] += 1
        elif absolute_height_m(photo) is None and photo.height_above_takeoff_m is None:
            missing[say("a height")] += 1
        else:
            usable.append(photo)
    for what, n in missing.items():
        text = say(
            "{} of {} photos do not say {} and are left out; use the files as the camera wrote them",
            n,
            len(photos),
            what,
        )
        findings.append(Finding(Severity.WARNING, "photos-incomplete", text, "", float(n), 0.0, "photos"))
    if not usable:
        what = joined(", ", (say("{} without {}", n, what) for what, n in missing.items()))
        raise InputError.say(
            "no photo says where and when it was taken ({}); use the files as the camera wrote them: "
            "programs that edit, send or share photos often take that out",
            what,
            place=label,
        )
    return usable


def _times_s(photos: Sequence[PhotoMetadata]) -> Floats:
    """Times, shape (n,), of one clock for all."""
    by_exposure = all(photo.exposed_at is not None for photo in photos)
    clocks = (photo.exposed_at if by_exposure else photo.taken_at for photo in photos)
    return np.array([clock_s(time) for time in clocks if time is not None], np.float64)


def _sorties(photos: Sequence[PhotoMetadata], times_s: Floats) -> list[list[int]]:
    """Indices of photos by aircraft and sortie, in the order of flight."""
    groups: list[list[int]] = []
    named = {photo.drone_serial for photo in photos if photo.drone_serial is not None}
    aircraft = [photo.drone_serial or "" if len(named) > 1 else "" for photo in photos]
    for serial in sorted(set(aircraft)):
        own = [index for index, its in enumerate(aircraft) if its == serial]
        groups.append(own[:1])
        for before, index in itertools.pairwise(own):
            if times_s[index] - times_s[before] > SORTIE_GAP_S:
                groups.append([])
            groups[-1].append(index)
    return sorted(groups, key=lambda group: float(times_s[group[0]]))


def _record(photos: Sequence[PhotoMetadata], times_s: Floats, points: Floats, group: list[int]) -> FlightRecord:
    first = photos[group[0]]
    name = first.drone_model or " ".join(part for part in (first.make, first.model) if part) or say("an unknown camera")
    zero_s = float(times_s[group[0]])
    taken = tuple(
        _taken(photos[index], count, float(times_s[index]) - zero_s, points[index])
        for count, index in enumerate(group, 1)
    )
    nothing, nowhere = np.zeros(0), np.zeros((0, 3))
    track = Track(nothing, nowhere, nowhere, nothing, nothing, nothing, nothing)
    return FlightRecord(sortie=0, vehicle=say("photos of {}", name), track=track, photos=taken)


def _taken(photo: PhotoMetadata, count: int, time_s: float, point: Floats) -> TakenPhoto:
    east, north, up = point.tolist()
    return TakenPhoto(
        index=count if photo.image_index is None else photo.image_index,
        time_s=time_s,
        position_enu_m=(east, north, up),
        heading_deg=photo.gimbal_heading_deg,
        gimbal_pitch_deg=photo.gimbal_pitch_deg,
        speed_m_s=photo.speed_m_s,
        source="photo-file",
        file=photo.path.name,
        exposure_s=photo.exposure_s,
    )
