"""Photos to cameras in the frame of a site: where each stood, how it was turned, and how well both are known.

Angles in photos count from the north and the vertical of the place where the photo was taken. Those of the site differ
by the meridians' convergence and the earth's curvature: less than 0.1 degrees in 5 km at 60 degrees of latitude, but
anything at all near a pole, so they are turned exactly.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import about, joined, say
from planning.geo.frames import Origin
from planning.photos.folder import in_order
from planning.photos.places import (
    Locality,
    PhotoHeights,
    absolute_height_m,
    photo_places,
    photos_near,
    receiver_findings,
)
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import Pose, PosedPhoto, cam_from_enu
from reconstruction.photos.lens import CameraKind, Lens, lens_of, of_camera

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Standard deviations of what photos do not tell the accuracy of.

    Parameters
    ----------
    single_horizontal_m, single_vertical_m
        Of a receiver without corrections, per axis: 1.5 m RMS on both horizontal axes together and 3 m vertically
        (single-point accuracy in DJI's specifications of the D-RTK receivers).
    fixed_horizontal_m, fixed_vertical_m
        With RTK fixed, where a photo has the flag but no standard deviations: 1 cm + 1 ppm and 1.5 cm + 1 ppm (DJI,
        Mavic 3 Enterprise, specifications), doubled for the lever arm and the time of the exposure.
    takeoff_height_m
        Of heights above take-off: barometers wander by some decimetres in a flight, and the place of take-off is known
        no better. Our choice.
    hand_held_horizontal_m, hand_held_vertical_m
        Of photos that no aircraft took: telephones state 5 m under open sky, and are worse before walls. Our choice.
    heading_deg, tilt_deg
        Of the camera about the vertical, and about any horizontal axis. Makers publish how still gimbals hold (some
        thousandths of a degree), not how true their angles are. A heading rests on the compass, or on two antennas.
        Our choice.
    """

    single_horizontal_m: float = 1.5 / math.sqrt(2.0)
    single_vertical_m: float = 3.0
    fixed_horizontal_m: float = 0.02
    fixed_vertical_m: float = 0.03
    takeoff_height_m: float = 1.0
    hand_held_horizontal_m: float = 5.0
    hand_held_vertical_m: float = 10.0
    heading_deg: float = 2.0
    tilt_deg: float = 0.5

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")


DEFAULT_ACCURACY = Accuracy()


@dataclass(frozen=True, slots=True)
class Unposed:
    """A photo without a pose, and what it does not say."""

    name: str
    missing: str


@dataclass(frozen=True, slots=True, eq=False)
class PhotoSet:
    """Photos with their cameras, in the order of time.

    Parameters
    ----------
    metadata, lenses
        Of each of `photos`.
    unposed
        Photos that do not say enough; none of those that belong to another camera or another site.
    sizes_px
        Width and height of every photo that was looked at, by name.
    """

    photos: tuple[PosedPhoto, ...]
    metadata: tuple[PhotoMetadata, ...]
    lenses: tuple[Lens, ...]
    unposed: tuple[Unposed, ...]
    findings: tuple[Finding, ...]
    sizes_px: Mapping[str, tuple[int, int]] = field(default_factory=dict)


def pose_photos(
    photos: Sequence[PhotoMetadata],
    site: Locality,
    folder: Path,
    *,
    heights: PhotoHeights = "auto",
    camera: CameraKind | None = None,
    accuracy: Accuracy = DEFAULT_ACCURACY,
    posed_elsewhere: bool = False,
) -> PhotoSet:
    """Cameras of photos from what these say of themselves.

    Parameters
    ----------
    folder
        The photos' names are their paths below it.
    heights
        Which heights count.
    camera
        Which of several cameras; None for the wide one.
    posed_elsewhere
        Whether poses come from elsewhere, so that photos need not say any.

    Raises
    ------
    InputError
        No photo says enough, or all were taken elsewhere.
    """
    label = str(folder)
    chosen, findings = of_camera(photos, camera)
    usable, lens_by_path, unposed = _usable(chosen, folder)
    sizes_px = {name_in(folder, photo): (photo.width_px, photo.height_px) for photo in photos}
    if not usable and posed_elsewhere:
        return PhotoSet((), (), (), tuple(unposed), findings, sizes_px)
    if not usable:
        raise InputError(
            say(
                "no photo can be given a camera pose ({}); {}. Or make a coarse model of the photos, which finds their "
                "poses by itself, and take its poses",
                _counted(unposed),
                ADVICE,
                place=label,
            )
        )
    near, elsewhere = photos_near(usable, site, label)
    here = in_order(near)
    places = photo_places(here, site, heights, label)
    lenses = tuple(lens_by_path[photo.path] for photo in here)
    poses = [
        measured_pose(photo, site.origin, point, is_absolute, accuracy)
        for photo, point, is_absolute in zip(here, places.points_enu_m, places.is_absolute.tolist(), strict=True)
    ]
    posed = tuple(
        PosedPhoto(name_in(folder, photo), photo.path, lens.intrinsics, pose, photo.taken_at)
        for photo, lens, pose in zip(here, lenses, poses, strict=True)
    )
    findings += (*elsewhere, *places.findings, *receiver_findings(here))
    findings += (*unposed_findings(unposed, len(chosen)), *_lens_findings(lenses), *_turned(here))
    return PhotoSet(posed, here, lenses, tuple(unposed), findings, sizes_px)


UNPOSED = "photos-unposed"
"""Code of the findings about photos without a pose."""

ADVICE = say("use the files as the camera wrote them: programs that edit, send or share photos often take that out")


def name_in(folder: Path, photo: PhotoMetadata) -> str:
    """Name of a photo: its path below the folder of photos."""
    return (photo.path.relative_to(folder) if photo.path.is_relative_to(folder) else photo.path).as_posix()


def _usable(
    photos: Sequence[PhotoMetadata], folder: Path
) -> tuple[list[PhotoMetadata], dict[Path, Lens], list[Unposed]]:
    """Photos that say all that a pose needs, their lenses, and the others."""
    usable, lenses, unposed = [], {}, []
    for photo in photos:
        lens = lens_of(photo)
        missing = _missing(photo, lens)
        if missing or lens is None:
            unposed.append(Unposed(name_in(folder, photo), missing))
        else:
            usable.append(photo)
            lenses[photo.path] = lens
    return usable, lenses, unposed


def _missing(photo: PhotoMetadata, lens: Lens | None) -> str:
    """The first thing that a photo does not say; empty where it says all. A roll that is not recorded is 0."""
    if photo.lat_deg is None or photo.lon_deg is None:
        return say("a position")
    if absolute_height_m(photo) is None and photo.height_above_takeoff_m is None:
        return say("a height")
    if photo.gimbal_heading_deg is None or photo.gimbal_pitch_deg is None:
        return say("where the camera looked")
    return say("a focal length") if lens is None else ""


def measured_pose(
    photo: PhotoMetadata, origin: Origin, point_enu_m: Array, is_absolute: bool, accuracy: Accuracy = DEFAULT_ACCURACY
) -> Pose:
    """Where a photo was taken, and how it was turned: as its gimbal says, or level to the north where it does not.

    Parameters
    ----------
    point_enu_m, is_absolute
        As `photo_places` has them; the photo has a position.
    """
    assert photo.lat_deg is not None
    assert photo.lon_deg is not None
    heading_deg, pitch_deg = photo.gimbal_heading_deg or 0.0, photo.gimbal_pitch_deg or 0.0
    local_from_site = enu_axes(photo.lat_deg, photo.lon_deg) @ enu_axes(origin.lat_deg, origin.lon_deg).T
    cam_from_local = cam_from_enu(heading_deg, pitch_deg, photo.gimbal_roll_deg or 0.0)
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = (local_from_site.T * _position_variances(photo, is_absolute, accuracy)) @ local_from_site
    covariance[3:, 3:] = angle_covariance(
        cam_from_local,
        math.radians(photo.accuracy_heading_deg or accuracy.heading_deg),
        math.radians(photo.accuracy_tilt_deg or accuracy.tilt_deg),
    )
    return Pose(np.asarray(point_enu_m, float), cam_from_local @ local_from_site, covariance)


def angle_covariance(cam_from_enu: Array, heading_rad: float, tilt_rad: float) -> Array:
    """Covariance, shape (3, 3), rad^2, camera axes, of a rotation with these standard deviations.

    About the vertical by that of the heading, about every horizontal axis by that of the tilt. Errors of heading, pitch
    and roll as such would leave a direction without any error where the camera looks straight down, because heading and
    roll turn it about the same axis there.
    """
    up = cam_from_enu[:, 2]
    return np.asarray(tilt_rad**2 * np.eye(3) + (heading_rad**2 - tilt_rad**2) * np.outer(up, up))


def _position_variances(photo: PhotoMetadata, is_absolute: bool, accuracy: Accuracy) -> Array:
    """East, north, up, m^2, in the axes of the photo's own place."""
    stated_m = photo.rtk_std_lon_m, photo.rtk_std_lat_m, photo.rtk_std_height_m
    is_flown = photo.gimbal_pitch_deg is not None or photo.height_above_takeoff_m is not None
    horizontal_m = accuracy.single_horizontal_m if is_flown else accuracy.hand_held_horizontal_m
    vertical_m = accuracy.single_vertical_m if is_flown else accuracy.hand_held_vertical_m
    horizontal_m = photo.accuracy_horizontal_m or horizontal_m
    fallback = (
        (accuracy.fixed_horizontal_m, accuracy.fixed_horizontal_m, accuracy.fixed_vertical_m)
        if photo.is_rtk_fixed
        else (horizontal_m, horizontal_m, photo.accuracy_vertical_m or vertical_m)
    )
    # 0 stands in photos without RTK.
    east, north, up = (std or other for std, other in zip(stated_m, fallback, strict=True))
    return np.square([east, north, up if is_absolute else accuracy.takeoff_height_m])


def enu_axes(lat_deg: float, lon_deg: float) -> Array:
    """East, north and up at a place, as rows, shape (3, 3), in geocentric axes."""
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    sin_lat, cos_lat, sin_lon, cos_lon = math.sin(lat), math.cos(lat), math.sin(lon), math.cos(lon)
    return np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )


def _counted(unposed: Sequence[Unposed]) -> str:
    counts = Counter(photo.missing for photo in unposed)
    return joined(", ", (say("{} without {}", n, what) for what, n in counts.items())) or say("there are none")


def unposed_findings(unposed: Sequence[Unposed], n_all: int) -> list[Finding]:
    """What photos without a pose lack, of as many in all."""
    counts = Counter(photo.missing for photo in unposed)
    first = {photo.missing: photo.name for photo in reversed(unposed)}
    return [
        Finding(
            Severity.WARNING,
            UNPOSED,
            say("{} of {} photos do not say {} and get no pose, the first {}; {}", n, n_all, what, first[what], ADVICE),
            "",
            float(n),
            0.0,
            "photos",
        )
        for what, n in counts.items()
    ]


def _lens_findings(lenses: Sequence[Lens]) -> list[Finding]:
    """Where intrinsics are from, and what is wrong with them."""
    sources = Counter(lens.source for lens in lenses)
    counted = joined(", ", (say("{} ({} photos)", source, n) for source, n in sources.items()))
    text = about("focal lengths are from", counted)
    findings = [Finding(Severity.NOTE, "lens-source", text)]
    n_bent = sum(not lens.is_distortion_known for lens in lenses)
    if n_bent:
        text = say(
            "the distortion of the lens is not known for {} of {} photos: straight lines may be bent by tens "
            "of pixels near the edges; refine the cameras, or use photos with dewarp data",
            n_bent,
            len(lenses),
        )
        findings.append(Finding(Severity.NOTE, "lens-distortion-unknown", text, "", float(n_bent), None, "photos"))
    for source, n in Counter(source for lens in lenses for source in lens.passed_over).items():
        text = say(
            "the {} of {} photos is of another picture size and not used: it gives a focal length far from "
            "that of the 35 mm equivalent; {}",
            source,
            n,
            ADVICE,
        )
        findings.append(Finding(Severity.WARNING, "lens-of-other-size", text, "", float(n), 0.0, "photos"))
    return findings


def _turned(photos: Sequence[PhotoMetadata]) -> list[Finding]:
    n = sum(photo.orientation not in (None, 1) for photo in photos)
    if not n:
        return []
    text = say("{} photos are marked to be shown turned; pixels are counted in the pictures as they are stored", n)
    return [Finding(Severity.NOTE, "photos-turned", text, "", float(n), None, "photos")]
