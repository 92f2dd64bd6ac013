"""The way back from local to file coordinates is the inverse of the way there, whatever the file's coordinates are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.crs import crs_conversion
from planning.geo.frames import Origin
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import LocalFrame, place

ZURICH = Origin(47.3769, 8.5417, 457.0)

CASES = {
    "turned model": (LocalFrame(ZURICH, (120.0, -30.0, 2.0), 0.7), np.array([[100.0, 0.0, 2.0], [150.0, 40.0, 30.0]])),
    "utm": ("EPSG:32632", np.array([[678_000.0, 5_403_600.0, 413.0], [678_060.0, 5_403_650.0, 430.0]])),
    "feet": ("EPSG:2263", np.array([[983_000.0, 199_000.0, 30.0], [983_200.0, 199_150.0, 400.0]])),
    "north first": ("EPSG:31468", np.array([[4_468_000.0, 5_333_000.0, 520.0], [4_468_050.0, 5_333_050.0, 540.0]])),
    "degrees": ("EPSG:4326", np.array([[8.5417, 47.3769, 410.0], [8.5421, 47.3771, 440.0]])),
    "high latitude": (LocalFrame(Origin(89.9, 10.0, 0.0)), np.array([[-10.0, -10.0, 0.0], [10.0, 10.0, 9.0]])),
}


def placement(case):
    frame, points = CASES[case]
    if isinstance(frame, str):
        frame = crs_conversion(frame, points, "xy")
    return place(frame, points, float(points[:, 2].min()), ImportOptions())


@pytest.mark.few(2)
@pytest.mark.parametrize("case", sorted(CASES))
@given(point=st.tuples(st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0), st.floats(-50.0, 300.0)))
def test_file_coordinates_lead_back_to_the_local_point(case, point):
    placed = placement(case)
    points = np.array([point, (0.0, 0.0, 0.0)])
    np.testing.assert_allclose(placed.enu(placed.file_coordinates(points)), points, atol=1e-6)


@pytest.mark.parametrize("case", sorted(CASES))
def test_corners_of_the_building_come_back_in_file_coordinates(case):
    placed, points = placement(case), CASES[case][1]
    tolerance = 1e-10 if case == "degrees" else 1e-6
    found = placed.file_coordinates(placed.enu(points))
    np.testing.assert_allclose(found[:, :2], points[:, :2], atol=tolerance, rtol=0.0)
    np.testing.assert_allclose(found[:, 2], points[:, 2], atol=1e-6, rtol=0.0)
