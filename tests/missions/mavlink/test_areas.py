from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import Fence, FenceCircle, FencePolygon, fence_items, rally_items
from missions.mavlink.items import MissionItem
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.model import GeoPoint
from planning.base.errors import MissionError
from tests.missions.mavlink.driving import fences_of, from_wire

TRIANGLE = ((22.1, 114.1), (22.2, 114.1), (22.2, 114.2))
DEGREES = st.integers(-899_999_999, 899_999_999).map(lambda whole: whole / 1e7)
CORNERS = st.lists(st.tuples(DEGREES, DEGREES), min_size=3, max_size=6).map(tuple)
FENCES = st.one_of(
    st.builds(FencePolygon, CORNERS, st.booleans()),
    st.builds(FenceCircle, DEGREES, DEGREES, st.integers(1, 500).map(float), st.booleans()),
)


@given(fences=st.lists(FENCES, max_size=5).map(tuple), autopilot=st.sampled_from(Autopilot))
def test_fences_come_back_over_the_wire(fences: tuple[Fence, ...], autopilot: Autopilot) -> None:
    sent = to_wire(fence_items(fences), autopilot, MissionType.FENCE)
    assert fences_of(from_wire(sent, autopilot, MissionType.FENCE)) == fences


def test_each_corner_says_how_many_there_are() -> None:
    items = fence_items((FencePolygon(TRIANGLE, False), FenceCircle(22.0, 114.0, 30.0, True)))
    assert [(item.command, item.params[0]) for item in items] == [(5002, 3.0)] * 3 + [(5003, 30.0)]
    assert {item.frame for item in items} == {0}


@pytest.mark.parametrize("broken", ["missing", "mixed", "other"])
def test_polygon_that_is_not_whole_is_refused(broken: str) -> None:
    items = list(fence_items((FencePolygon(TRIANGLE, True),)))
    if broken == "missing":
        items.pop()
    elif broken == "mixed":
        items[1] = replace(items[1], command=5002)
    else:
        items[2] = replace(items[2], command=16)
    with pytest.raises(MissionError, match="fence item"):
        fences_of(items)


def test_return_point_is_left_out() -> None:
    point = MissionItem(5000, 0, (0.0, 0.0, 0.0, 0.0, 22.0, 114.0, 10.0))
    assert fences_of((point,)) == ()


def test_fence_without_area_is_refused() -> None:
    with pytest.raises(MissionError, match="2 corners"):
        FencePolygon(TRIANGLE[:2], True)
    for radius_m in (0.0, -1.0, float("nan")):
        with pytest.raises(MissionError, match="radius"):
            FenceCircle(22.0, 114.0, radius_m, True)


def test_rally_points_count_their_height_from_home() -> None:
    home = GeoPoint(22.0, 114.0, 60.0)
    (item,) = rally_items((GeoPoint(22.1, 114.1, 85.0),), home)
    assert (item.command, item.frame, item.params) == (5100, 3, (0.0, 0.0, 0.0, 0.0, 22.1, 114.1, 25.0))
