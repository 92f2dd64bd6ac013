"""Where on earth a file's coordinates are, and how they become local ENU metres near the building."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.crs import HeightReference, crs_conversion
from planning.geo.enu import Geodetic, enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin, Vec3
from planning.geo.geoid import ellipsoid_from_amsl_m
from planning.site.importing.options import ImportOptions

Array = NDArray[np.float64]

FAR_FROM_ZERO_M = 5_000.0
"""Coordinates further out are projected or shifted ones: their zero cannot be the place that --origin means."""


NEWTON_STEPS = 5
"""Of the way back from local to file coordinates."""

SMALL_STEP = 1e-5
"""Of file coordinates, for their derivatives: 1 m where they are degrees, and where they are metres still 10 000 times
what rounding makes of UTM coordinates."""


class Georeference(Protocol):
    """Brings file coordinates to WGS 84."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was decided about place and height, for the user."""

    def geodetic(self, coordinates: Array) -> Geodetic:
        """WGS 84 positions of file coordinates, shape (n, 3)."""


@dataclass(frozen=True, slots=True)
class LocalFrame:
    """File coordinates in metres, z up, around a point whose place is known.

    Parameters
    ----------
    origin
        Where that point is.
    zero
        Its file coordinates.
    north_rad
        Direction of true north in the file's x-y plane, counter-clockwise from its y axis.
    notes
        See `Georeference`.
    place_from
        Of the site: `ifc-site` where the place may be just the city; else empty.
    """

    origin: Origin
    zero: Vec3 = (0.0, 0.0, 0.0)
    north_rad: float = 0.0
    notes: tuple[str, ...] = ()
    place_from: str = ""

    def geodetic(self, coordinates: Array) -> Geodetic:
        """WGS 84 positions of file coordinates, shape (n, 3)."""
        cos, sin = np.cos(self.north_rad), np.sin(self.north_rad)
        enu_from_file = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        return geodetic_from_enu(self.origin, (coordinates - np.array(self.zero)) @ enu_from_file.T)


@dataclass(frozen=True, slots=True)
class Placement:
    """The site's origin and the way from file coordinates to local ones.

    Parameters
    ----------
    origin
        Of the site.
    georeference
        Of the file.
    ground_z_m
        Of the ground in local coordinates.
    middle
        A point of the building, file coordinates.
    """

    origin: Origin
    georeference: Georeference
    ground_z_m: float
    middle: Vec3 = (0.0, 0.0, 0.0)

    def enu(self, coordinates: Array) -> Array:
        """Local ENU metres of file coordinates, shape (n, 3); every point is converted exactly."""
        return enu_from_geodetic(self.origin, *self.georeference.geodetic(coordinates))

    def file_coordinates(self, points_enu_m: Array) -> Array:
        """File coordinates of local ENU points near the building, shape (n, 3): the inverse of `enu`.

        By Newton's method from the building's middle. The way between the two is a turn, a scale and the curvature of
        the earth, so that every step gains some four digits; from 1 km away the result is good to 1e-8 m.
        """
        middle = np.array([self.middle])
        probes = np.diag([SMALL_STEP, SMALL_STEP, 1.0])
        file_from_enu = np.linalg.inv(np.linalg.inv(probes) @ (self.enu(middle + probes) - self.enu(middle)))
        found = np.repeat(middle, len(points_enu_m), axis=0)
        for _ in range(NEWTON_STEPS):
            found = found + (points_enu_m - self.enu(found)) @ file_from_enu
        return np.asarray(found)


def place(
    found: Georeference | None,
    points: Array,
    ground_z: float,
    options: ImportOptions,
    north_rad: float = 0.0,
) -> Placement:
    """Decide the origin of the site.

    What the user says (`--origin`, `--crs`) goes before what the file says. An origin that the user names stays the
    origin; else it is put on the ground below the middle of the building.

    Parameters
    ----------
    found
        The file's own georeference.
    points
        Of the building, file coordinates, shape (n, 3).
    ground_z
        Third file coordinate of the ground.
    north_rad
        True north in the file's plane, where the file tells; used with a named origin.

    Raises
    ------
    InputError
        Neither the file nor the user says where this is, or the place is impossible.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (float(low[0] + high[0]) / 2.0, float(low[1] + high[1]) / 2.0, ground_z)
    if options.origin is not None and options.crs is not None:
        raise InputError.say("--origin and --crs both say where the file is; give one of them")
    if options.origin is not None:
        origin, note = _named_origin(options.origin, options.height_reference)
        return _at_named_origin(origin, note, float(np.abs([low[:2], high[:2]]).max()), middle, north_rad)
    if options.crs is not None:
        found = crs_conversion(options.crs, points, options.axis_order, options.height_reference)
    if found is None:
        raise InputError.say(
            "the file does not say where on earth it is; give --origin LAT,LON,HEIGHT (of its zero point) or "
            "--crs EPSG:CODE (of its coordinates)"
        )
    if isinstance(found, LocalFrame):
        away_m = float(np.hypot(middle[0] - found.zero[0], middle[1] - found.zero[1]))
        if away_m > FAR_FROM_ZERO_M:
            raise InputError.say(
                "the building lies {:.0f} km from the point whose place the file gives, so its coordinates are "
                "projected ones; name their system with --crs EPSG:CODE",
                away_m / 1000.0,
            )
    lat, lon, height = (float(value[0]) for value in found.geodetic(np.array([middle])))
    try:
        origin = Origin(round(lat, 9), round(lon, 9), round(height, 4))
    except ValueError as error:
        raise InputError.say(
            "the building would stand at an impossible place ({}); check --crs and units", error
        ) from error
    return Placement(origin, found, 0.0, middle)


def _named_origin(named: Origin, height_reference: HeightReference) -> tuple[Origin, str]:
    """The origin that the user means, and what its height was taken for."""
    if height_reference != "orthometric":
        return named, say("its height is above the ellipsoid (--height-reference orthometric for sea level)")
    height_m = float(ellipsoid_from_amsl_m(named.lat_deg, named.lon_deg, named.ellipsoid_height_m))
    note = say("its height above sea level is {:.1f} m above the ellipsoid (EGM96, good to about 1 m)", height_m)
    return Origin(named.lat_deg, named.lon_deg, round(height_m, 4)), note


def _at_named_origin(origin: Origin, note: str, far_m: float, middle: Vec3, north_rad: float) -> Placement:
    """The file's zero at the origin, or the building's middle where the coordinates reach `far_m` too far from zero."""
    if far_m <= FAR_FROM_ZERO_M:
        notes = (say("the file's zero point is at the origin you named"), note)
        return Placement(origin, LocalFrame(origin, north_rad=north_rad, notes=notes), middle[2], middle)
    notes = (
        say(
            "the file's coordinates lie up to {:.0f} km from zero, so the origin you named is taken as the "
            "middle of the building's footprint, on the ground; if they are projected coordinates, --crs "
            "converts them exactly (grid north is not true north)",
            far_m / 1000.0,
        ),
        note,
    )
    return Placement(origin, LocalFrame(origin, middle, north_rad, notes), 0.0, middle)
