"""What an IFC file says about its place: map conversion, latitude and longitude of the site, true north. Plain data."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from planning.base.errors import InputError
from planning.base.messages import say


@dataclass(frozen=True, slots=True)
class SitePlace:
    """Place of IfcSite.

    Parameters
    ----------
    zero_m
        Origin of the site's placement, model coordinates, metres: the point whose place is given.
    """

    lat_deg: float
    lon_deg: float
    altitude_amsl_m: float
    zero_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class MapParameters:
    """IfcMapConversion and IfcProjectedCRS in the file's own units; None where it says nothing.

    Parameters
    ----------
    crs, vertical
        Name of the projected system, and of the vertical datum.
    map_unit_m
        Metres per unit of the map's numbers.
    eastings, northings, height
        Of the model's zero, in map units.
    abscissa, ordinate
        Direction of the model's x axis on the map.
    scale, scale_z
        From file units to map units.
    """

    crs: str | None
    vertical: str | None
    map_unit_m: float | None
    eastings: float
    northings: float
    height: float
    abscissa: float
    ordinate: float
    scale: float
    scale_z: float


def map_parameters(model: Any) -> MapParameters | None:
    """From IfcMapConversion and IfcProjectedCRS, or the property sets that stand for them in IFC 2x3."""
    if model.schema == "IFC2X3":
        sets = _property_sets(model)
        conversion, crs = sets.get("epset_mapconversion"), sets.get("epset_projectedcrs", {})
        map_unit_m = _named_unit_m(str(crs.get("MapUnit")))
    else:
        conversions = model.by_type("IfcMapConversion")
        conversion = conversions[0].get_info() if conversions else None
        target = conversions[0].TargetCRS if conversions else None
        crs = {} if target is None else target.get_info()
        map_unit_m = _entity_unit_m(crs.get("MapUnit"))
    if not conversion:
        return None

    def number(key: str, default: float) -> float:
        value = conversion.get(key)
        return default if value is None else float(value)

    scale = number("Scale", 1.0) or 1.0
    abscissa, ordinate = number("XAxisAbscissa", 0.0), number("XAxisOrdinate", 0.0)
    return MapParameters(
        crs=crs.get("Name") or None,
        vertical=crs.get("VerticalDatum") or None,
        map_unit_m=map_unit_m,
        eastings=number("Eastings", 0.0),
        northings=number("Northings", 0.0),
        height=number("OrthogonalHeight", 0.0),
        abscissa=abscissa if abscissa or ordinate else 1.0,
        ordinate=ordinate,
        scale=scale * number("FactorX", 1.0),
        scale_z=scale * number("FactorZ", 1.0),
    )


def _property_sets(model: Any) -> dict[str, dict[str, Any]]:
    """Property sets of site and project by name in lower case."""
    from ifcopenshell.util.element import get_psets

    found: dict[str, dict[str, Any]] = {}
    for item in (*model.by_type("IfcSite"), *model.by_type("IfcProject")):
        found |= {name.lower(): values for name, values in get_psets(item).items()}
    return found


def _entity_unit_m(unit: Any) -> float | None:
    if unit is None:
        return None
    from ifcopenshell.util.unit import get_unit_scale

    return float(get_unit_scale(unit))


def _named_unit_m(name: str) -> float | None:
    return {"METRE": 1.0, "METER": 1.0, "M": 1.0, "MILLIMETRE": 0.001, "FOOT": 0.3048}.get(name.upper())


def site_place(model: Any, unit_m: float) -> SitePlace | None:
    """Place of the first IfcSite that has one; zero latitude and longitude together stand for none."""
    from ifcopenshell.util.placement import get_local_placement

    for site in model.by_type("IfcSite"):
        lat_deg, lon_deg = _angle_deg(site.RefLatitude), _angle_deg(site.RefLongitude)
        if lat_deg is None or lon_deg is None or (lat_deg == 0.0 and lon_deg == 0.0):
            continue
        if abs(lat_deg) > 90.0 or abs(lon_deg) > 180.0:
            raise InputError(
                say(
                    "IfcSite lies at latitude {:g}, longitude {:g}, which is nowhere on earth; give --origin",
                    lat_deg,
                    lon_deg,
                )
            )
        x, y, z = (float(v) * unit_m for v in get_local_placement(site.ObjectPlacement)[:3, 3])
        return SitePlace(lat_deg, lon_deg, float(site.RefElevation or 0.0) * unit_m, (x, y, z))
    return None


def _angle_deg(parts: Any) -> float | None:
    """Degrees from whole degrees, minutes, seconds and millionths of seconds, which all carry the sign."""
    if not parts:
        return None
    return sum(float(part) / size for part, size in zip(parts, (1.0, 60.0, 3600.0, 3.6e9), strict=False))


def true_north_rad(model: Any) -> float:
    """Direction of true north in the model's plane, counter-clockwise from its y axis; 0 if the file says nothing."""
    for context in model.by_type("IfcGeometricRepresentationContext", include_subtypes=False):
        north = context.TrueNorth
        if north is not None and context.ContextType == "Model":
            x, y = (float(v) for v in north.DirectionRatios[:2])
            return math.atan2(-x, y) if math.hypot(x, y) > 0.0 else 0.0
    return 0.0
