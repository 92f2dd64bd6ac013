"""What a coarse model begins with: photos of the first flight, and what the user says beside them.

Photos are whole, of one camera, each once; of each there is what it says of its lens, of where it was taken, and of how
it was turned, as far as it says that.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Hashable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.files import open_input_file
from planning.base.findings import Finding, Severity
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin, Vec3
from planning.photos.jpeg import PHOTO_FILE
from planning.photos.places import (
    PhotoHeights,
    absolute_height_m,
    photo_places,
    receiver_heights_m,
    takeoff_height_m,
)
from planning.photos.record import PhotoMetadata
from planning.site.records import MAX_DISTANCE_M
from reconstruction.base.cameras import Intrinsics
from reconstruction.coarse.placing import Measured
from reconstruction.colmap.pycolmap_run import LEAST_PHOTOS
from reconstruction.photos.decode import mask_of_size, whole_content
from reconstruction.photos.lens import CameraKind, camera_kind, lens_of, of_camera
from reconstruction.photos.poses import DEFAULT_ACCURACY, measured_pose


@dataclass(frozen=True, slots=True, eq=False)
class ControlPoint:
    """A point whose place is known, and where photos show it.

    Parameters
    ----------
    lat_deg, lon_deg, ellipsoid_height_m
        WGS 84.
    seen
        Names of photos, and pixels in them.
    """

    name: str
    lat_deg: float
    lon_deg: float
    ellipsoid_height_m: float
    seen: tuple[tuple[str, float, float], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """What the user says beside the photos.

    Parameters
    ----------
    lens
        Of all photos, for one picture size; it is scaled to others.
    control
        Control points.
    distances
        Names of two photos, and the metres between where they were taken.
    origin
        Of the site, where the photos do not say where it is.
    camera
        Which of several cameras; None for the wide one.
    dense
        Whether walls without points are looked for in the photos.
    masks
        By photos' names; black where nothing counts: passers-by, vehicles, the aircraft itself.
    """

    lens: Intrinsics | None = None
    control: tuple[ControlPoint, ...] = ()
    distances: tuple[tuple[str, str, float], ...] = ()
    origin: Origin | None = None
    heights: PhotoHeights = "auto"
    camera: CameraKind | None = None
    dense: EffectSetting = "auto"
    masks: Mapping[str, Path] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class CoarseInputs:
    """Photos before they are matched: what each says, by its row.

    Parameters
    ----------
    lenses
        Pinhole and distortion, of the picture's own size; None where nothing says it.
    groups
        Equal for photos of one lens.
    measured
        Place and turn in the provisional frame: ENU about `origin`.
    origin
        None where nothing says where on earth this is.
    masks
        None where all of a photo counts.
    """

    names: tuple[str, ...]
    metadata: tuple[PhotoMetadata, ...]
    lenses: tuple[Intrinsics | None, ...]
    groups: tuple[Hashable, ...]
    measured: tuple[Measured, ...]
    origin: Origin | None
    masks: tuple[Path | None, ...]
    findings: tuple[Finding, ...]


def read_inputs(
    folder: Path, photos: Sequence[PhotoMetadata], stated: Stated, monitor: Monitor = QUIET
) -> CoarseInputs:
    """What photos say, of those that a coarse model can be made of.

    Parameters
    ----------
    folder
        What the photos' names are paths below.

    Raises
    ------
    InputError
        There are too few photos, or they are of places far apart.
    """
    mask_of = {photo.path: stated.masks.get(_name(photo, folder)) for photo in photos}
    whole, damaged = _whole(photos, mask_of, monitor)
    of_kind, findings = of_camera(whole, stated.camera)
    chosen, copies = _once(of_kind)
    if len(chosen) < LEAST_PHOTOS:
        raise InputError(_too_few(whole, of_kind, copies, damaged))
    lenses = tuple(_lens(photo, stated.lens) for photo in chosen)
    groups = tuple(
        (photo.make, photo.model, photo.camera_serial, photo.width_px, photo.height_px, photo.focal_length_mm, lens)
        for photo, lens in zip(chosen, lenses, strict=True)
    )
    origin, measured, lately = _measured(chosen, stated, str(folder))
    n_unknown = sum(lens is None for lens in lenses)
    if n_unknown:
        text = say("{} of {} photos do not say their focal length: it is found with the model", n_unknown, len(chosen))
        findings += (Finding(Severity.NOTE, "lens-found", text, "", float(n_unknown), None, "photos"),)
    findings = (*damaged, *days_apart(chosen), *copies, *findings, *lately)
    names, masks = tuple(_name(photo, folder) for photo in chosen), tuple(mask_of[photo.path] for photo in chosen)
    return CoarseInputs(names, chosen, lenses, groups, measured, origin, masks, findings)


def _too_few(
    whole: Sequence[PhotoMetadata],
    of_kind: Sequence[PhotoMetadata],
    copies: Sequence[Finding],
    damaged: Sequence[Finding],
) -> Any:
    n_once = len(of_kind) - sum(int(finding.value or 0) for finding in copies)
    if damaged and len(of_kind) == len(whole):
        return say(
            "a coarse model needs at least {} photos, and {} of {} are whole; the first other: {}",
            LEAST_PHOTOS,
            len(whole),
            len(whole) + len(damaged),
            damaged[0].message,
        )
    if copies:
        return say(
            "a coarse model needs at least {} photos taken from different places, got {}; {}",
            LEAST_PHOTOS,
            n_once,
            copies[0].message,
        )
    if len(of_kind) == len(whole):
        return say("a coarse model needs at least {} photos, got {}", LEAST_PHOTOS, n_once)
    kind = (camera_kind(of_kind[0]) or CameraKind.WIDE) if of_kind else CameraKind.WIDE
    return say(
        "a coarse model needs at least {} photos of one camera; of {} photos, {} are of the {} camera; choose "
        "another camera",
        LEAST_PHOTOS,
        len(whole),
        n_once,
        str(kind),
    )


@dataclass(frozen=True, slots=True)
class ProvisionalPlace:
    """The frame until there is a site: its zero in the middle of the photos, at the height of take-off."""

    name: str
    origin: Origin
    home_enu_m: Vec3 = (0.0, 0.0, 0.0)


def _whole(
    photos: Sequence[PhotoMetadata], mask_of: Mapping[Path, Path | None], monitor: Monitor
) -> tuple[tuple[PhotoMetadata, ...], tuple[Finding, ...]]:
    """Photos all of whose pictures are there, and findings about the others: matches in half a picture mislead."""

    def finding(photo: PhotoMetadata) -> Finding | None:
        try:
            whole_content(photo)
        except InputError as error:
            return Finding(Severity.WARNING, "photo-unreadable", str(error), str(photo.path))
        mask = mask_of[photo.path]
        try:
            if mask is not None:
                mask_of_size(mask, photo.width_px, photo.height_px)
        except InputError as error:
            text = say("its mask cannot be used ({}); it was left out", error)
            return Finding(Severity.WARNING, "photo-mask", text, str(photo.path))
        return None

    found: list[Finding | None] = []
    with ThreadPoolExecutor(n_threads()) as pool:
        for result in pool.map(finding, photos):
            monitor.report(say("reading photos"), len(found), len(photos))
            found.append(result)
    kept = tuple(photo for photo, result in zip(photos, found, strict=True) if result is None)
    return kept, tuple(result for result in found if result is not None)


def _once(photos: Sequence[PhotoMetadata]) -> tuple[tuple[PhotoMetadata, ...], tuple[Finding, ...]]:
    """Photos without copies of the same file under other names, which show nothing new."""
    first: dict[tuple[int, str], PhotoMetadata] = {}
    copies = []
    for photo in photos:
        content = photo.path.stat().st_size, start_of(photo.path)
        if first.setdefault(content, photo) is not photo:
            copies.append(photo)
    if not copies:
        return tuple(photos), ()
    text = say(
        "{} of {} photos are copies of others and are left out, the first {}",
        len(copies),
        len(photos),
        copies[0].path.name,
    )
    return tuple(first.values()), (Finding(Severity.WARNING, "photos-copied", text, "", float(len(copies)), 0.0, ""),)


MOST_DAYS = 2.0
"""Between the first photo and the last, from which on it is told: other light, leaves, cars and scaffolds."""


def days_apart(photos: Sequence[PhotoMetadata]) -> tuple[Finding, ...]:
    """A finding where the first photo and the last were taken on different days, by `MOST_DAYS`."""
    times = [photo.taken_at.timestamp() for photo in photos if photo.taken_at is not None]
    days = (max(times) - min(times)) / 86400.0 if times else 0.0
    if days < MOST_DAYS:
        return ()
    text = say(
        "the photos were taken over {:.0f} days: what has changed since, light, plants and vehicles, does not fit "
        "together; if photos are left out, put each flight into a folder of its own",
        days,
    )
    return (Finding(Severity.WARNING, "photos-days-apart", text, "", days, MOST_DAYS, "days"),)


def _name(photo: PhotoMetadata, folder: Path) -> str:
    return (photo.path.relative_to(folder) if photo.path.is_relative_to(folder) else photo.path).as_posix()


def _lens(photo: PhotoMetadata, stated: Intrinsics | None) -> Intrinsics | None:
    if stated is not None:
        shape = (photo.width_px / photo.height_px) / (stated.width_px / stated.height_px)
        if abs(math.log(shape)) > 0.01:
            return None
        return stated.scaled(photo.width_px, photo.height_px)
    lens = lens_of(photo)
    return None if lens is None else lens.intrinsics


def _measured(
    photos: Sequence[PhotoMetadata], stated: Stated, label: str
) -> tuple[Origin | None, tuple[Measured, ...], tuple[Finding, ...]]:
    """A provisional origin, and where each photo was taken and how it was turned, as far as it says so."""
    placed = _placed(photos)
    place = provisional_place(placed, label)
    if place is None:
        if not stated.control:
            return None, tuple(Measured() for _ in photos), ()
        points = stated.control
        origin = Origin(
            float(np.median([point.lat_deg for point in points])),
            float(np.median([point.lon_deg for point in points])),
            float(np.median([point.ellipsoid_height_m for point in points])),
        )
        return origin, tuple(Measured() for _ in photos), ()
    near, findings = _near_each_other(placed, place)
    where = photo_places(near, place, stated.heights, label)
    n_turned = sum(_is_turned(photo) for photo in near)
    found = {}
    for photo, point, is_absolute in zip(near, where.points_enu_m, where.is_absolute.tolist(), strict=True):
        pose = measured_pose(photo, place.origin, point, is_absolute, DEFAULT_ACCURACY)
        if pose is None or pose.covariance is None:
            continue
        information = np.linalg.inv(pose.covariance[3:, 3:]) / max(1, n_turned) if _is_turned(photo) else None
        turn = pose.cam_from_enu if _is_turned(photo) else None
        found[photo.path] = Measured(pose.position_enu_m, pose.covariance[:3, :3], turn, information)
    notes = tuple(finding for finding in where.findings if finding.code != "height-disagreement")
    return place.origin, tuple(found.get(photo.path, Measured()) for photo in photos), (*findings, *notes)


def _placed(photos: Sequence[PhotoMetadata]) -> list[PhotoMetadata]:
    return [
        photo
        for photo in photos
        if photo.lat_deg is not None
        and (absolute_height_m(photo) is not None or photo.height_above_takeoff_m is not None)
    ]


def provisional_place(photos: Sequence[PhotoMetadata], name: str) -> ProvisionalPlace | None:
    """A frame for photos that no site is known of; None where none says its place and a height."""
    placed = _placed(photos)
    if not placed:
        return None
    lat = float(np.median([photo.lat_deg for photo in placed if photo.lat_deg is not None]))
    lon = float(np.median([photo.lon_deg for photo in placed if photo.lon_deg is not None]))
    return ProvisionalPlace(name, Origin(lat, lon, float(np.clip(_zero_m(placed), -900.0, 9000.0))))


def says_height(photos: Sequence[PhotoMetadata]) -> bool:
    """Whether any photo says its place with a height above the sea or the ellipsoid."""
    return any(photo.lat_deg is not None and absolute_height_m(photo) is not None for photo in photos)


def _zero_m(photos: Sequence[PhotoMetadata]) -> float:
    """Height of the provisional frame above the ellipsoid: take-off, so that both kinds of height give one place."""
    takeoff_m = takeoff_height_m(photos)
    if takeoff_m is not None:
        return takeoff_m
    heights_m = receiver_heights_m(photos)
    is_known = np.isfinite(heights_m)
    return float(np.median(heights_m[is_known])) if is_known.any() else 0.0


def _near_each_other(photos: list[PhotoMetadata], place: ProvisionalPlace) -> tuple[list[PhotoMetadata], list[Finding]]:
    """Photos whose receivers say that they are of the same place as most."""
    lat, lon = (np.array([getattr(photo, name) for photo in photos], float) for name in ("lat_deg", "lon_deg"))
    away_m = np.linalg.norm(enu_from_geodetic(place.origin, lat, lon, place.origin.ellipsoid_height_m), axis=1)
    near = [photo for photo, far in zip(photos, away_m.tolist(), strict=True) if far <= MAX_DISTANCE_M]
    if 2 * len(near) < len(photos):
        raise InputError(
            say(
                "the photos were taken at places up to {:.0f} km apart; put those of one building into a folder of "
                "their own",
                2.0 * float(away_m.max()) / 1000.0,
                place=place.name,
            )
        )
    if len(near) == len(photos):
        return near, []
    n = len(photos) - len(near)
    text = say(
        "the positions of {} of {} photos are more than {:g} km from the others: they are not used",
        n,
        len(photos),
        MAX_DISTANCE_M / 1000.0,
    )
    return near, [Finding(Severity.WARNING, "photos-elsewhere", text, "", float(n), 0.0, "photos")]


def _is_turned(photo: PhotoMetadata) -> bool:
    return photo.gimbal_heading_deg is not None and photo.gimbal_pitch_deg is not None


START_BYTES = 1 << 16
"""Of a photo's file, which tell it from others of the same size: its metadata, and the first of its picture."""


def start_of(path: Path) -> str:
    """Digest of a file's start: copying keeps it, where it does not keep the time."""
    with open_input_file(path, PHOTO_FILE) as file:
        return hashlib.sha256(file.read(START_BYTES)).hexdigest()
