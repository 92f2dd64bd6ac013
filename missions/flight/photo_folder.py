"""Flight records from the photos of a flight alone: where and when each was taken, out of its own metadata.

Photos say nothing of the way between them. Such a record has no track: distances are known where photos were taken
only, and why a view has no photo is not known at all.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from missions.flight.logs.flights import HEIGHT_DIFFERENCE_M, MAX_DISTANCE_M, LogFlights
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.errors import InputError
from planning.findings import Finding, Severity
from planning.photo_files.folder import clock_s, in_order, read_photos
from planning.photo_files.record import PhotoMetadata
from planning.progress import QUIET, Monitor
from planning.site import Site

Floats = NDArray[np.float64]

PhotoHeights = Literal["auto", "takeoff", "absolute"]
"""What heights are counted from: the site's home and the height above take-off; the absolute height, as the receiver
measured it; or the better one: absolute where every position is fixed by RTK, else above take-off."""

SORTIE_GAP_S = 60.0
"""Photos further apart are of two sorties: views follow each other in seconds, changing a battery takes minutes. A
sortie that is parted needlessly does no harm: several records may be of one."""

DISAGREEMENT_M = 0.5
"""Worth a word if the two positions in a file are further apart: they should be the same, and differ by rounding."""

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


def photo_flights(
    photos: Sequence[PhotoMetadata], site: Site, label: str, heights: PhotoHeights = "auto"
) -> LogFlights:
    """Flight records of photos.

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
    here = in_order(_near(_usable(photos, label, findings), site, label, findings))
    times_s = _times_s(here)
    points = _points_enu_m(here, site, heights, label, findings)
    findings += _receiver_findings(here)
    records = tuple(_record(here, times_s, points, group) for group in _sorties(here, times_s))
    return LogFlights(records, tuple(findings))


def _near(photos: list[PhotoMetadata], site: Site, label: str, findings: list[Finding]) -> list[PhotoMetadata]:
    """Photos of this site, wherever their heights count from."""
    from planning.geodesy.enu import enu_from_geodetic

    lat, lon = _columns(photos, "lat_deg", "lon_deg")
    away_m = np.linalg.norm(enu_from_geodetic(site.origin, lat, lon, site.origin.ellipsoid_height_m), axis=1)
    near = [photo for photo, m in zip(photos, away_m.tolist(), strict=True) if m <= MAX_DISTANCE_M]
    if not near:
        raise InputError(
            f"{label}: the photos were taken {away_m.min() / 1000.0:.1f} km from the site '{site.name}'; expected at "
            f"most {MAX_DISTANCE_M / 1000.0:g} km; are they the right photos, and the right site?"
        )
    if len(near) < len(photos):
        n = len(photos) - len(near)
        text = f"{n} of {len(photos)} photos were taken far from the site and are left out"
        findings.append(Finding(Severity.WARNING, "photos-elsewhere", text, "", float(n), 0.0, "photos"))
    return near


def _usable(photos: Sequence[PhotoMetadata], label: str, findings: list[Finding]) -> list[PhotoMetadata]:
    """Photos with a position, a time and a height, of the camera for visible light."""
    visible = [photo for photo in photos if photo.image_source != INFRARED]
    if visible and len(visible) < len(photos):
        n = len(photos) - len(visible)
        text = f"{n} thermal photos are left out; they were taken together with the others"
        findings.append(Finding(Severity.NOTE, "photos-thermal", text, "", float(n)))
        photos = visible
    usable = []
    missing: Counter[str] = Counter()
    by_exposure = all(photo.exposed_at is not None for photo in photos)
    for photo in photos:
        if photo.lat_deg is None:
            missing["a position"] += 1
        elif photo.taken_at is None and not by_exposure:
            missing["a time"] += 1
        elif _absolute_m(photo) is None and photo.height_above_takeoff_m is None:
            missing["a height"] += 1
        else:
            usable.append(photo)
    for what, n in missing.items():
        text = f"{n} of {len(photos)} photos do not say {what} and are left out; use the files as the camera wrote them"
        findings.append(Finding(Severity.WARNING, "photos-incomplete", text, "", float(n), 0.0, "photos"))
    if not usable:
        what = ", ".join(f"{n} without {what}" for what, n in missing.items())
        raise InputError(
            f"{label}: no photo says where and when it was taken ({what}); use the files as the camera wrote them: "
            "programs that edit, send or share photos often take that out"
        )
    return usable


def _times_s(photos: Sequence[PhotoMetadata]) -> Floats:
    """Times, shape (n,), of one clock for all."""
    by_exposure = all(photo.exposed_at is not None for photo in photos)
    clocks = (photo.exposed_at if by_exposure else photo.taken_at for photo in photos)
    return np.array([clock_s(time) for time in clocks if time is not None], np.float64)


def _absolute_m(photo: PhotoMetadata) -> float | None:
    return photo.height_ellipsoid_m if photo.height_ellipsoid_m is not None else photo.altitude_amsl_m


def _points_enu_m(
    photos: Sequence[PhotoMetadata], site: Site, heights: PhotoHeights, label: str, findings: list[Finding]
) -> Floats:
    """Positions in the site's frame, shape (n, 3); one way of counting heights for all."""
    from planning.geodesy.enu import enu_from_geodetic, geodetic_from_enu
    from planning.geodesy.geoid import ellipsoid_from_amsl_m

    lat, lon, ellipsoid, amsl, above = _columns(
        photos, "lat_deg", "lon_deg", "height_ellipsoid_m", "altitude_amsl_m", "height_above_takeoff_m"
    )
    home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
    absolute_m = np.where(np.isfinite(ellipsoid), ellipsoid, ellipsoid_from_amsl_m(lat, lon, amsl))
    takeoff_m = home_m + above
    n_fixed = sum(photo.is_rtk_fixed for photo in photos)
    chosen, reason = _choice(heights, absolute_m, takeoff_m, n_fixed)
    other_m, height_m = (absolute_m, takeoff_m) if chosen == "takeoff" else (takeoff_m, absolute_m)
    is_known = np.isfinite(height_m)
    if not is_known.all():
        n = int((~is_known).sum())
        what = "above take-off" if chosen == "takeoff" else "above sea level or ellipsoid"
        if not is_known.any():
            raise InputError(f"{label}: no photo says its height {what}; choose the other way of counting heights")
        text = f"{n} of {len(photos)} photos do not say their height {what}; theirs is counted the other way"
        findings.append(Finding(Severity.WARNING, "height-mixed", text, "", float(n), 0.0, "photos"))
        height_m = np.where(is_known, height_m, other_m)
    findings.append(Finding(Severity.NOTE, "height-reference", reason))
    apart_m = (other_m - height_m)[np.isfinite(other_m) & is_known]
    median_m = float(np.median(apart_m)) if len(apart_m) else 0.0
    if abs(median_m) > HEIGHT_DIFFERENCE_M:
        other = "absolute heights" if chosen == "takeoff" else "heights above take-off"
        text = (
            f"by their {other} the photos would lie {abs(median_m):.1f} m {'higher' if median_m > 0.0 else 'lower'}: "
            "the site's own height, the receiver, or the place of take-off is off by that"
        )
        findings.append(Finding(Severity.WARNING, "height-disagreement", text, "", median_m, HEIGHT_DIFFERENCE_M, "m"))
    return enu_from_geodetic(site.origin, lat, lon, height_m)


def _choice(heights: PhotoHeights, absolute_m: Floats, takeoff_m: Floats, n_fixed: int) -> tuple[str, str]:
    """Which heights count, `takeoff` or `absolute`, and why."""
    n = len(takeoff_m)
    if heights != "auto":
        return heights, f"heights are counted as asked for: {heights}"
    if n_fixed == n and np.isfinite(absolute_m).all():
        return "absolute", "heights are those above the ellipsoid, because RTK was fixed in all photos"
    if not np.isfinite(takeoff_m).any():
        return "absolute", "heights are absolute ones, good to some metres: the photos do not say those above take-off"
    why = f"because RTK was fixed in only {n_fixed} of {n} photos"
    return "takeoff", f"heights are those above take-off, counted from the site's home, {why}"


def _columns(photos: Sequence[PhotoMetadata], *names: str) -> Iterator[Floats]:
    """Fields of all photos, each shape (n,), NaN where one is None."""
    for name in names:
        values = [getattr(photo, name) for photo in photos]
        yield np.array([np.nan if value is None else value for value in values], np.float64)


def _receiver_findings(photos: Sequence[PhotoMetadata]) -> Iterator[Finding]:
    """What the photos say of their positions' quality."""
    apart = [photo.position_disagreement_m for photo in photos if photo.position_disagreement_m is not None]
    worst_m = max(apart, default=0.0)
    if worst_m > DISAGREEMENT_M:
        text = f"EXIF and XMP of a photo give positions {worst_m:.1f} m apart; EXIF's are taken"
        yield Finding(Severity.WARNING, "position-disagreement", text, "", worst_m, DISAGREEMENT_M, "m")
    flags = [photo for photo in photos if photo.rtk_flag is not None]
    n_loose = sum(not photo.is_rtk_fixed for photo in flags)
    if n_loose and any(photo.rtk_flag for photo in flags):
        text = (
            f"RTK was not fixed in {n_loose} of {len(flags)} photos: their positions are good to decimetres or metres"
        )
        yield Finding(Severity.WARNING, "rtk-not-fixed", text, "", float(n_loose), 0.0, "photos")


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
    name = first.drone_model or " ".join(part for part in (first.make, first.model) if part) or "an unknown camera"
    zero_s = float(times_s[group[0]])
    taken = tuple(
        _taken(photos[index], count, float(times_s[index]) - zero_s, points[index])
        for count, index in enumerate(group, 1)
    )
    nothing, nowhere = np.zeros(0), np.zeros((0, 3))
    track = Track(nothing, nowhere, nowhere, nothing, nothing, nothing, nothing)
    return FlightRecord(sortie=0, vehicle=f"photos of {name}", track=track, photos=taken)


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
