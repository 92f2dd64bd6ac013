"""Heights between the WGS 84 ellipsoid and mean sea level, which in every mission format means the EGM96 geoid."""

from __future__ import annotations

from missions.model import GeoPoint


def altitude_amsl_m(point: GeoPoint) -> float:
    """Altitude of a point above the EGM96 geoid, metres."""
    from planning.geodesy.geoid import amsl_from_ellipsoid_m

    return float(amsl_from_ellipsoid_m(point.lat_deg, point.lon_deg, point.height_ellipsoid_m))


def point_at_amsl(lat_deg: float, lon_deg: float, altitude_amsl_m: float) -> GeoPoint:
    """Point that is given by its altitude above the EGM96 geoid."""
    from planning.geodesy.geoid import ellipsoid_from_amsl_m

    return GeoPoint(lat_deg, lon_deg, float(ellipsoid_from_amsl_m(lat_deg, lon_deg, altitude_amsl_m)))
