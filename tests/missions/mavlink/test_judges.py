"""Our files as two other programs read them: MAVSDK's importer and pymavlink's waypoint loader, item by item."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from missions.formats.options import ExportOptions
from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import MissionItem, mission_items
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat, HeightReference
from tests.missions.plans import example_plan, export

SCALE = 1e7
"""Latitude and longitude are whole numbers on the wire, of positions; other items carry params 5 and 6 as they are."""


@pytest.fixture(scope="module", params=list(Autopilot))
def judge(request: pytest.FixtureRequest) -> Iterator[tuple[Autopilot, Any]]:
    """MAVSDK's mission plugin, which believes to talk to an autopilot: one heartbeat, by no link, is enough."""
    mavsdk = pytest.importorskip("mavsdk")
    mission_raw = pytest.importorskip("mavsdk.plugins.mission_raw")
    from pymavlink.dialects.v20 import common

    autopilot: Autopilot = request.param
    sdk = mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION))
    sdk.add_any_connection("raw://")
    sender = common.MAVLink(None, srcSystem=1, srcComponent=1)
    heartbeat = sender.heartbeat_encode(common.MAV_TYPE_QUADROTOR, facts(autopilot).firmware_type, 0, 0, 3)
    sdk.pass_received_raw_bytes(heartbeat.pack(sender))
    system = sdk.first_autopilot(5.0)
    assert system is not None
    yield autopilot, mission_raw.MissionRaw(system)
    sdk.destroy()


def exported(tmp_path: Path, file_format: FileFormat, autopilot: Autopilot) -> tuple[Path, tuple[MissionItem, ...]]:
    plan = example_plan()
    options = ExportOptions(autopilot=autopilot)
    paths = export(plan, None, None, file_format, tmp_path / "m.mission", options)
    return paths[0], mission_items(missions_from_plan(plan)[0], autopilot, HeightReference.ABOVE_TAKEOFF)


def assert_same(found: Any, item: MissionItem, scale_place: float) -> None:
    """Whether an item as a program read it is ours: 32 bit floats, and 1e-7 degrees."""
    assert (found.command, found.frame) == (item.command, item.frame)
    for name, value in zip(("param1", "param2", "param3", "param4"), item.params[:4], strict=True):
        same = getattr(found, name) == pytest.approx(value, rel=1e-6)
        assert same or (math.isnan(value) and math.isnan(getattr(found, name)))
    is_place = item.frame == 3
    scale, off = (scale_place, 0.51 * scale_place / SCALE) if is_place else (1.0, 0.0)
    assert abs(found.x - item.params[4] * scale) <= off
    assert abs(found.y - item.params[5] * scale) <= off
    assert found.z == pytest.approx(item.params[6], rel=1e-6)


def test_mavsdk_reads_our_plan_item_by_item(judge: tuple[Autopilot, Any], tmp_path: Path) -> None:
    autopilot, plugin = judge
    path, items = exported(tmp_path, FileFormat.MAVLINK_PLAN, autopilot)
    found = plugin.import_qgroundcontrol_mission(str(path)).mission_items
    # For ArduPilot MAVSDK puts the planned home before the items.
    found = found[1:] if autopilot is Autopilot.ARDUPILOT else found
    assert len(found) == len(items)
    for theirs, ours in zip(found, items, strict=True):
        assert_same(theirs, ours, SCALE)


def test_mavsdk_reads_our_waypoints_item_by_item(judge: tuple[Autopilot, Any], tmp_path: Path) -> None:
    autopilot, plugin = judge
    path, items = exported(tmp_path, FileFormat.MAVLINK_WPL, autopilot)
    found = plugin.import_mission_planner_mission(str(path)).mission_items
    # MAVSDK takes line 0, the home position of every other program, for an item; for ArduPilot it doubles it.
    extra = 2 if autopilot is Autopilot.ARDUPILOT else 1
    assert len(found) == len(items) + extra
    assert found[extra - 1].command == 16
    for theirs, ours in zip(found[extra:], items, strict=True):
        assert_same(theirs, ours, SCALE)


def test_mavsdk_refuses_crlf_which_is_why_we_write_lf(judge: tuple[Autopilot, Any], tmp_path: Path) -> None:
    autopilot, plugin = judge
    path, _ = exported(tmp_path, FileFormat.MAVLINK_WPL, autopilot)
    with pytest.raises(Exception, match="FAILED_TO_PARSE_MISSION_PLANNER_PLAN"):
        plugin.import_mission_planner_mission_from_string(path.read_text().replace("\n", "\r\n"))


@pytest.mark.parametrize("autopilot", list(Autopilot))
def test_pymavlink_reads_our_waypoints_item_by_item(tmp_path: Path, autopilot: Autopilot) -> None:
    from pymavlink import mavwp

    path, items = exported(tmp_path, FileFormat.MAVLINK_WPL, autopilot)
    loader = mavwp.MAVWPLoader()
    assert loader.load(str(path)) == len(items) + 1
    assert (loader.wp(0).command, loader.wp(0).frame, loader.wp(0).current) == (16, 0, 1)
    for number, ours in enumerate(items, 1):
        assert_same(loader.wp(number), ours, 1.0)
