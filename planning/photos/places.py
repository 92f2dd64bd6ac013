"""Where photos were taken, in the frame of a site: which of their heights count, and how far these agree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3
from planning.photos.record import PhotoMetadata
from planning.site.records import HEIGHT_DIFFERENCE_M, MAX_DISTANCE_M

Floats = NDArray[np.float64]

PhotoHeights = Literal["auto", "takeoff", "absolute"]
"""What heights are counted from: the site's home and the height above take-off; the absolute height, as the receiver
measured it; or the better one: absolute where every position is fixed by RTK, else above take-off."""

DISAGREEMENT_M = 0.5
"""Worth a word if the two positions in a file are further apart: they should be the same, and differ by rounding."""


class Locality(Protocol):
    """What photos need of a site: a `Site` is one, and a coarse model without panels has as much."""

    @property
    def name(self) -> str:
        """For messages."""

    @property
    def origin(self) -> Origin:
        """Of the local frame."""

    @property
    def home_enu_m(self) -> Vec3:
        """Where heights above take-off count from."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoPlaces:
    """Places of n photos.

    Parameters
    ----------
    points_enu_m
        Shape (n, 3), local frame of the site.
    is_absolute
        Shape (n,): whether a height is the absolute one; else it is counted from take-off.
    """

    points_enu_m: Floats
    is_absolute: NDArray[np.bool_]
    findings: tuple[Finding, ...]


def photos_near(
    photos: Sequence[PhotoMetadata], site: Locality, label: str
) -> tuple[list[PhotoMetadata], tuple[Finding, ...]]:
    """Photos of this site, wherever their heights count from; all given ones have a position.

    Raises
    ------
    InputError
        All were taken elsewhere.
    """
    from planning.geo.enu import enu_from_geodetic

    if not photos:
        return [], ()
    lat, lon = _columns(photos, "lat_deg", "lon_deg")
    away_m = np.linalg.norm(enu_from_geodetic(site.origin, lat, lon, site.origin.ellipsoid_height_m), axis=1)
    near = [photo for photo, m in zip(photos, away_m.tolist(), strict=True) if m <= MAX_DISTANCE_M]
    if not near:
        raise InputError.say(
            "the photos were taken {:.1f} km from the site '{}'; expected at most {:g} km; are they the "
            "right photos, and the right site?",
            away_m.min() / 1000.0,
            site.name,
            MAX_DISTANCE_M / 1000.0,
            place=label,
        )
    if len(near) == len(photos):
        return near, ()
    n = len(photos) - len(near)
    text = say("{} of {} photos were taken far from the site and are left out", n, len(photos))
    return near, (Finding(Severity.WARNING, "photos-elsewhere", text, "", float(n), 0.0, "photos"),)


def absolute_height_m(photo: PhotoMetadata) -> float | None:
    """The height that the receiver measured, above the ellipsoid or sea level, whichever the photo has."""
    return photo.height_ellipsoid_m if photo.height_ellipsoid_m is not None else photo.altitude_amsl_m


def receiver_heights_m(photos: Sequence[PhotoMetadata]) -> Floats:
    """Heights that receivers measured, above the ellipsoid, shape (n,); NaN where a photo has none.

    Parameters
    ----------
    photos
        All with a position.
    """
    from planning.geo.geoid import ellipsoid_from_amsl_m

    lat, lon, ellipsoid, amsl = _columns(photos, "lat_deg", "lon_deg", "height_ellipsoid_m", "altitude_amsl_m")
    return np.where(np.isfinite(ellipsoid), ellipsoid, ellipsoid_from_amsl_m(lat, lon, amsl))


def takeoff_height_m(photos: Sequence[PhotoMetadata]) -> float | None:
    """Height of take-off above the ellipsoid, the median of what photos say that have both kinds of height.

    None where none has both.
    """
    (above,) = _columns(photos, "height_above_takeoff_m")
    takeoff_m = receiver_heights_m(photos) - above
    is_known = np.isfinite(takeoff_m)
    return float(np.median(takeoff_m[is_known])) if is_known.any() else None


def photo_places(photos: Sequence[PhotoMetadata], site: Locality, heights: PhotoHeights, label: str) -> PhotoPlaces:
    """Places of photos, one way of counting heights for all.

    Parameters
    ----------
    photos
        All with a position, and a height of either kind.
    label
        Where they are from, for messages.

    Raises
    ------
    InputError
        No photo says its height in the way asked for.
    """
    from planning.geo.enu import enu_from_geodetic, geodetic_from_enu

    findings = []
    lat, lon, above = _columns(photos, "lat_deg", "lon_deg", "height_above_takeoff_m")
    home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
    absolute_m = receiver_heights_m(photos)
    takeoff_m = home_m + above
    n_fixed = sum(photo.is_rtk_fixed for photo in photos)
    chosen, reason = _choice(heights, absolute_m, takeoff_m, n_fixed)
    is_absolute = np.full(len(photos), chosen == "absolute")
    other_m, height_m = (absolute_m, takeoff_m) if chosen == "takeoff" else (takeoff_m, absolute_m)
    is_known = np.isfinite(height_m)
    if not is_known.all():
        n = int((~is_known).sum())
        what = say("above take-off") if chosen == "takeoff" else say("above sea level or ellipsoid")
        if not is_known.any():
            raise InputError.say(
                "no photo says its height {}; choose the other way of counting heights", what, place=label
            )
        text = say("{} of {} photos do not say their height {}; theirs is counted the other way", n, len(photos), what)
        findings.append(Finding(Severity.WARNING, "height-mixed", text, "", float(n), 0.0, "photos"))
        height_m = np.where(is_known, height_m, other_m)
    findings.append(Finding(Severity.NOTE, "height-reference", reason))
    apart_m = (other_m - height_m)[np.isfinite(other_m) & is_known]
    median_m = float(np.median(apart_m)) if len(apart_m) else 0.0
    if abs(median_m) > HEIGHT_DIFFERENCE_M:
        other = say("absolute heights") if chosen == "takeoff" else say("heights above take-off")
        text = (
            say(
                "by their {} the photos would lie {:.1f} m higher: the site's own height, the receiver, or the "
                "place of take-off is off by that",
                other,
                abs(median_m),
            )
            if median_m > 0.0
            else say(
                "by their {} the photos would lie {:.1f} m lower: the site's own height, the receiver, or the "
                "place of take-off is off by that",
                other,
                abs(median_m),
            )
        )
        findings.append(Finding(Severity.WARNING, "height-disagreement", text, "", median_m, HEIGHT_DIFFERENCE_M, "m"))
    points = enu_from_geodetic(site.origin, lat, lon, height_m)
    return PhotoPlaces(points, is_absolute ^ ~is_known, tuple(findings))


def receiver_findings(photos: Sequence[PhotoMetadata]) -> Iterator[Finding]:
    """What the photos say of their positions' quality."""
    apart = [photo.position_disagreement_m for photo in photos if photo.position_disagreement_m is not None]
    worst_m = max(apart, default=0.0)
    if worst_m > DISAGREEMENT_M:
        text = say("EXIF and XMP of a photo give positions {:.1f} m apart; EXIF's are taken", worst_m)
        yield Finding(Severity.WARNING, "position-disagreement", text, "", worst_m, DISAGREEMENT_M, "m")
    flags = [photo for photo in photos if photo.rtk_flag is not None]
    n_loose = sum(not photo.is_rtk_fixed for photo in flags)
    if n_loose and any(photo.rtk_flag for photo in flags):
        text = say(
            "RTK was not fixed in {} of {} photos: their positions are good to decimetres or metres",
            n_loose,
            len(flags),
        )
        yield Finding(Severity.WARNING, "rtk-not-fixed", text, "", float(n_loose), 0.0, "photos")


def _choice(heights: PhotoHeights, absolute_m: Floats, takeoff_m: Floats, n_fixed: int) -> tuple[str, str]:
    """Which heights count, `takeoff` or `absolute`, and why."""
    n = len(takeoff_m)
    if heights != "auto":
        return heights, say("heights are counted as asked for: {}", heights)
    if n_fixed == n and np.isfinite(absolute_m).all():
        return "absolute", say("heights are those above the ellipsoid, because RTK was fixed in all photos")
    if not np.isfinite(takeoff_m).any():
        return "absolute", say(
            "heights are absolute ones, good to some metres: the photos do not say those above take-off"
        )
    why = say("because RTK was fixed in only {} of {} photos", n_fixed, n)
    return "takeoff", say("heights are those above take-off, counted from the site's home, {}", why)


def _columns(photos: Sequence[PhotoMetadata], *names: str) -> Iterator[Floats]:
    """Fields of all photos, each shape (n,), NaN where one is None."""
    for name in names:
        values = [getattr(photo, name) for photo in photos]
        yield np.array([np.nan if value is None else value for value in values], np.float64)
