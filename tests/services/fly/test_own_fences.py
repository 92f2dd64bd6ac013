"""Fences that this ground station has put on vehicles are known again, and nothing else is."""

from dataclasses import replace

import pytest

from groundstation.services.fly.own_fences import MAX_FENCES, fences_path, own_fences
from groundstation.vehicle.orders import fence_messages
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import compare
from tests.vehicle.sortie.test_flight_run import orders

__all__ = ["orders"]


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))


def moved(orders, lat_deg):
    fences = {
        each: tuple(tuple((lat + lat_deg, lon) for lat, lon in polygon) for polygon in polygons)
        for each, polygons in orders.fences.items()
    }
    return replace(orders, fences=fences)


def test_a_fence_is_known_the_next_time_as_the_vehicle_gives_it_back(orders):
    own_fences(orders)
    known, problem = own_fences(replace(orders, fences={}))
    assert problem == ""
    sent = fence_messages(orders.fences[Autopilot.PX4], Autopilot.PX4)
    # PX4 keeps degrees as doubles, and cuts them off on their way back.
    back = [replace(item, x=item.x - 1, seq=seq) for seq, item in enumerate(sent)]
    assert any(not compare(each, back, Autopilot.PX4, MissionType.FENCE) for each in known)
    other = fence_messages(moved(orders, 1e-4).fences[Autopilot.PX4], Autopilot.PX4)
    assert all(compare(each, other, Autopilot.PX4, MissionType.FENCE) for each in known)


def test_the_newest_are_kept_each_once(orders):
    own_fences(orders)
    own_fences(orders)
    first, _ = own_fences(replace(orders, fences={}))
    for n in range(3):
        own_fences(moved(orders, 1e-3 * (n + 1)))
    last, _ = own_fences(replace(orders, fences={}))
    assert len(last) == len(first) + 3 <= MAX_FENCES
    assert last[: len(first)] == first


@pytest.mark.parametrize(
    "content", ["", "{", '{"format": "reflight-log-book/1"}', '{"format": "reflight-fences/1", "fences": [3]}']
)
def test_of_a_damaged_file_no_fence_is_known_and_it_is_said(orders, content):
    fences_path().parent.mkdir(parents=True)
    fences_path().write_text(content)
    known, problem = own_fences(replace(orders, fences={}))
    assert known == ()
    assert "geofences of earlier flights are not known from here" in problem
    assert len(own_fences(orders)[0]) == 1, "this sortie's own is ours all the same"
    assert fences_path().read_text() == content
