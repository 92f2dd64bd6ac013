"""Where an IFC model is on earth: on the map of its map conversion, or around the place of its site."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.geodesy.crs import CrsConversion, HeightReference, crs_conversion
from planning.geodesy.crs_name import horizontal_part, parse_crs
from planning.geodesy.enu import Geodetic
from planning.geodesy.geoid import ellipsoid_from_amsl_m, undulation_m
from planning.site import Origin
from planning.site_import.ifc_content import IfcContent
from planning.site_import.ifc_place import MapParameters, SitePlace
from planning.site_import.options import ImportOptions
from planning.site_import.placement import Georeference, LocalFrame

Array = NDArray[np.float64]

SCALE_TOLERANCE = 0.01
"""A map scale is within 0.1 % of 1; what is further off is a change of units."""


@dataclass(frozen=True, slots=True)
class MapFrame:
    """Model coordinates in metres, turned, scaled and shifted onto a map.

    Parameters
    ----------
    conversion
        Of the map's coordinates.
    shift
        Map coordinates of the model's zero, in the map system's units.
    units_per_m
        Map units per metre of the model, horizontally and vertically.
    turn_rad
        Direction of the model's x axis on the map, counter-clockwise from east.
    notes
        See `Georeference`.
    """

    conversion: CrsConversion
    shift: tuple[float, float, float]
    units_per_m: tuple[float, float]
    turn_rad: float
    notes: tuple[str, ...]

    def geodetic(self, coordinates: Array) -> Geodetic:
        """WGS 84 positions of model coordinates, shape (n, 3), metres."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        map_from_model = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        scale = np.array([self.units_per_m[0], self.units_per_m[0], self.units_per_m[1]])
        return self.conversion.geodetic(coordinates @ map_from_model.T * scale + np.array(self.shift))


def ifc_georeference(content: IfcContent, options: ImportOptions) -> Georeference | None:
    """Georeference of an IFC model; None where the file has none, or the user says where it is.

    A map conversion that makes no sense gives way to the place of the site. `--crs` names the map of a map conversion;
    without one it is the system of the model's own coordinates.

    Raises
    ------
    InputError
        The map conversion makes no sense, and there is no other place to fall back on.
    """
    if options.origin is not None or (options.crs is not None and content.map is None):
        return None
    if content.map is None:
        return None if content.site is None else _site_frame(content.site, content.north_rad)
    try:
        return _map_frame(content.map, content.unit_m, options)
    except InputError as error:
        if content.site is None or options.crs is not None:
            raise
        note = f"the map conversion is left aside ({error})"
        return _site_frame(content.site, content.north_rad, (note,))


def _map_frame(found: MapParameters, unit_m: float, options: ImportOptions) -> MapFrame:
    """Frame on the map of the file, or on the one the user names."""
    name = options.crs or found.crs
    if name is None:
        raise InputError("the map conversion names no coordinate reference system; give it with --crs EPSG:CODE")
    vertical_code = re.search(r"(?i)epsg\D*(\d+)", found.vertical or "")
    if options.crs is None and vertical_code and not parse_crs(name).is_compound:
        name = f"{name}+{vertical_code[1]}"
    reference: HeightReference = options.height_reference
    if reference == "auto" and re.search(r"(?i)ellipsoid", found.vertical or ""):
        reference = "ellipsoid"
    axis_unit_m = horizontal_part(parse_crs(name)).axis_info[0].unit_conversion_factor
    # The unit of the map's numbers is often left out: then it is the system's own, or the drawing's, whichever fits.
    units_m = [axis_unit_m, unit_m] if found.map_unit_m is None else [found.map_unit_m]
    for map_unit_m in units_m:
        east, north = found.eastings * map_unit_m / axis_unit_m, found.northings * map_unit_m / axis_unit_m
        try:
            conversion = crs_conversion(name, np.array([[east, north, 0.0]]), "xy", reference)
            break
        except InputError:
            if map_unit_m == units_m[-1]:
                raise
    scale, note = _true_scale(found.scale, map_unit_m / unit_m)
    scale_z, _ = _true_scale(found.scale_z, map_unit_m / unit_m)
    height_unit_m = conversion.height_unit_m
    return MapFrame(
        conversion=conversion,
        shift=(east, north, found.height * map_unit_m / height_unit_m),
        units_per_m=(scale / axis_unit_m, scale_z / height_unit_m),
        turn_rad=math.atan2(found.ordinate, found.abscissa),
        notes=("place and rotation from IfcMapConversion", *note, *conversion.notes),
    )


def _true_scale(given: float, map_unit_per_file_unit: float) -> tuple[float, tuple[str, ...]]:
    """Scale of the map, near 1, from one that may also hold the change of units."""
    true = given * map_unit_per_file_unit
    if abs(true - 1.0) <= SCALE_TOLERANCE:
        return true, ()
    if abs(given - 1.0) <= SCALE_TOLERANCE:
        return given, ("the scale of IfcMapConversion leaves out the change of units, which is put right",)
    raise InputError(
        f"IfcMapConversion has the scale {given:g}, which is neither near 1 nor the change of units "
        f"({1.0 / map_unit_per_file_unit:g}); give the place with --origin"
    )


def _site_frame(site: SitePlace, north_rad: float, notes: tuple[str, ...] = ()) -> LocalFrame:
    """Frame around the place of the site."""
    height_m = float(ellipsoid_from_amsl_m(site.lat_deg, site.lon_deg, site.altitude_amsl_m))
    geoid_m = float(undulation_m(site.lat_deg, site.lon_deg))
    notes += (
        "place from latitude and longitude of IfcSite, which is often just the city that the BIM program assumes: "
        "check it, or give --origin",
        f"elevation of IfcSite ({site.altitude_amsl_m:g} m) is above sea level; EGM96, here {geoid_m:.1f} m above the "
        "ellipsoid, makes it ellipsoidal, to about 1 m",
        f"true north is {round(math.degrees(north_rad), 2) + 0.0:g} degrees counter-clockwise from the model's y axis",
    )
    origin = Origin(site.lat_deg, site.lon_deg, height_m)
    return LocalFrame(origin, site.zero_m, north_rad, notes, place_from="ifc-site")
