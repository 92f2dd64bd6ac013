from __future__ import annotations

from pathlib import Path

import pytest

from missions.dji.wpml import load_parts
from missions.mission.model import GeoPoint, altitude_amsl_m, point_at_amsl


def test_flighthub_and_we_mean_the_same_sea_level() -> None:
    """The facade route of FlightHub 2 (geoyee_m3d_curtainwall_slope_mapping2d.kmz) gives both heights of one point.

    Its template has 16.6143 m above the ellipsoid and 20.1029 m above EGM96; its area begins at the corner used here.
    """
    corner = GeoPoint(22.5799776509191, 113.938284866256, 16.6143249983835)
    assert altitude_amsl_m(corner) == pytest.approx(20.1029016845329, abs=0.0005)


def test_pilot_2_agrees_with_egm96_to_half_a_metre_on_a_recording_with_rtk(shared_data: Path) -> None:
    """Known to differ by 0.26 m at this place in Quebec: Pilot 2 has another geoid there."""
    parts = load_parts(shared_data / "missions" / "traitlab_m3e_pilot2_Waypoint2_rtk")
    assert parts.template is not None
    for waypoint in parts.template.folders[0].waypoints:
        assert waypoint.lat_deg is not None
        assert waypoint.lon_deg is not None
        assert waypoint.ellipsoid_height_m is not None
        point = GeoPoint(waypoint.lat_deg, waypoint.lon_deg, waypoint.ellipsoid_height_m)
        assert altitude_amsl_m(point) == pytest.approx(waypoint.height_m, abs=0.5)


def test_altitude_and_height_are_inverse() -> None:
    point = GeoPoint(31.5, 35.5, -395.0)
    back = point_at_amsl(point.lat_deg, point.lon_deg, altitude_amsl_m(point))
    assert back.height_ellipsoid_m == pytest.approx(-395.0, abs=1e-9)
