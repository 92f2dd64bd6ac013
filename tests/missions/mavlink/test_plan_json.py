from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from missions.formats.options import ExportOptions
from missions.formats.registry import encode, read_missions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.plan_json import read_plan_json
from missions.mission.export_choices import FileFormat
from missions.mission.model import GeoPoint, altitude_amsl_m
from planning.base.errors import InputError, MissionError
from planning.geo.enu import enu_from_geodetic
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.records import RallyPoint
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk


def plan_file(tmp_path: Path, content: Any) -> Path:
    path = tmp_path / "m.plan"
    path.write_text(json.dumps(content))
    return path


def content_of(options: ExportOptions | None = None) -> dict[str, Any]:
    encoded = encode(example_plan(), None, None, FileFormat.MAVLINK_PLAN, options or ExportOptions())
    content: dict[str, Any] = json.loads(encoded.contents[0])
    return content


def item(command: int, *params: float | None, frame: int = 3) -> dict[str, Any]:
    filled = [*params, *[0] * (7 - len(params))]
    return {
        "type": "SimpleItem",
        "command": command,
        "frame": frame,
        "params": filled,
        "doJumpId": 1,
        "autoContinue": True,
    }


def plan_of(*items: dict[str, Any], **mission: Any) -> dict[str, Any]:
    whole = {
        "version": 2,
        "items": list(items),
        "firmwareType": 12,
        "plannedHomePosition": [52.0, 5.0, 10.0],
        **mission,
    }
    return {"fileType": "Plan", "version": 1, "mission": whole}


def test_plan_has_what_qgroundcontrol_demands() -> None:
    content = content_of()
    assert (content["fileType"], content["version"], content["mission"]["version"]) == ("Plan", 1, 2)
    assert (content["geoFence"]["version"], content["rallyPoints"]["version"]) == (2, 2)
    items = content["mission"]["items"]
    assert [i["doJumpId"] for i in items] == list(range(1, len(items) + 1))
    assert {i["type"] for i in items} == {"SimpleItem"}
    assert {i["AltitudeMode"] for i in items if "Altitude" in i} == {1}
    assert (content["mission"]["firmwareType"], content["mission"]["vehicleType"]) == (3, 2)


def test_px4_plan_has_null_where_a_parameter_is_left_to_the_vehicle() -> None:
    content = content_of(ExportOptions(autopilot=Autopilot.PX4))
    assert content["mission"]["firmwareType"] == 12
    passed = [i for i in content["mission"]["items"] if i["command"] == 16 and i["params"][3] is None]
    assert len(passed) == 3


def test_home_is_above_sea_level() -> None:
    lat, lon, altitude_m = content_of()["mission"]["plannedHomePosition"]
    plan = example_plan()
    assert plan.home_enu_m is not None
    assert plan.origin is not None
    height_m = plan.origin.ellipsoid_height_m + plan.home_enu_m[2]
    assert altitude_m == pytest.approx(altitude_amsl_m(GeoPoint(lat, lon, height_m)), abs=1e-3)


def test_viewpoint_ids_come_back(tmp_path: Path) -> None:
    (mission,) = read_missions(plan_file(tmp_path, content_of()))
    assert [p.viewpoint_id for w in mission.waypoints for p in w.photos] == [f"v{i:04d}" for i in range(6)]


class TestRealFiles:
    def test_sample_with_camera(self, shared_data: Path) -> None:
        (mission,) = read_missions(shared_data / "missions" / "mavsdk_qgroundcontrol_sample.plan")
        assert [len(w.photos) for w in mission.waypoints] == [0, 1, 0, 0]
        assert mission.waypoints[1].height_above_takeoff_m == 50.0
        assert mission.takeoff is not None
        assert mission.takeoff.height_ellipsoid_m == pytest.approx(488.93 + 47.3, abs=1.0)  # the geoid there is 47 m up
        assert mission.speed_m_s == 5.0

    def test_sample_with_a_camera_but_no_way_is_refused_with_the_reason(self, shared_data: Path) -> None:
        with pytest.raises(MissionError, match="no waypoint, so there is nothing to fly"):
            read_missions(shared_data / "missions" / "mavsdk_qgroundcontrol_sample_with_digicam_control.plan")

    def test_wrong_version_is_refused(self, shared_data: Path) -> None:
        with pytest.raises(MissionError, match=r"mission\.version is 7; expected 2"):
            read_missions(shared_data / "missions" / "mavsdk_qgroundcontrol_sample_wrong_mission_version.plan")

    def test_fences_are_read_and_only_those_to_stay_out_of_kept(self, shared_data: Path) -> None:
        file = read_plan_json(shared_data / "missions" / "px4_multicopter_mission_geofence_avoid.plan")
        assert [len(fence) for fence in file.fences] == [4]
        assert file.fences[0][0] == (47.3991036, 8.5368519)


def test_survey_is_read_from_the_items_it_generated(tmp_path: Path) -> None:
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "TransectStyleComplexItem": {
            "Items": [item(16, 0, 0, 0, None, 52.001, 5.0, 30), item(16, 0, 0, 0, None, 52.002, 5.0, 30)]
        },
    }
    path = plan_file(tmp_path, plan_of(item(22, 0, 0, 0, None, 52.0, 5.0, 30), survey))
    assert [w.lat_deg for w in read_missions(path)[0].waypoints] == [52.0, 52.001, 52.002]


def test_structure_scan_is_refused_because_its_items_are_not_in_the_file(tmp_path: Path) -> None:
    scan = {"type": "ComplexItem", "complexItemType": "StructureScan", "CameraCalc": {}}
    with pytest.raises(MissionError, match="item 2: the complex item 'StructureScan' does not hold the items"):
        read_missions(plan_file(tmp_path, plan_of(item(22, 0, 0, 0, 0, 52.0, 5.0, 30), scan)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([1, 2], "no mission file that is known"),
        ({"fileType": "Fence"}, "no QGroundControl plan"),
        ({"fileType": "Plan", "version": 1, "geoFence": {}}, "has no mission"),
        (plan_of() | {"version": 2}, "version is 2; expected 1"),
        (plan_of(items=None), "expected a list, got null"),
        (plan_of({"type": "Simple"}), "type is 'Simple'"),
        (plan_of(3), "expected an object, got 3$"),  # type: ignore[arg-type]
        (plan_of({"type": "SimpleItem", "command": "16", "frame": 3}), "expected numbers for command and frame"),
        (plan_of({"type": "SimpleItem", "command": 16, "frame": 3, "params": [1]}), "expected params to be 7 numbers"),
        (plan_of(item(16, 0, 0, 0, 0, 95.0, 5.0, 30)), "not on the globe"),
        (plan_of(item(16, 0, 0, 0, 0, 52.0, 5.0, None)), "not on the globe"),
        (plan_of(item(16, 0, 0, 0, 0, 52.0, 5.0, 30, frame=10)), "counts from the terrain"),
        (plan_of(item(16, 0, 0, 0, 0, 52.0, 5.0, 30, frame=1)), "frame 1 does not place it"),
    ],
)  # fmt: skip
def test_wrong_plan_is_refused_with_the_reason(tmp_path: Path, content: Any, message: str) -> None:
    with pytest.raises((MissionError, InputError), match=message):
        read_missions(plan_file(tmp_path, content))


def test_plan_that_is_no_json_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.plan"
    path.write_text('{"fileType": "Plan",')
    with pytest.raises(InputError, match="not valid JSON, line 1"):
        read_missions(path)


@pytest.mark.slow
def test_rally_points_of_the_site_go_into_the_plan_and_come_back(tmp_path: Path) -> None:
    """They count from home, as QGroundControl has them; a plan has none, so that reading them is told of."""
    model = kiosk()
    points = (RallyPoint("car park", (20.0, -28.0, 2.0)), RallyPoint("meadow", (-10.0, -30.0, 0.0)))
    model = replace(model, site=replace(model.site, rally_points=points))
    plan = plan_flight(model, PlanRequest(n_views=3, method="orbit")).plan
    options = ExportOptions(site=model)
    (content,) = encode(plan, model.site.origin, model.site.home_enu_m, FileFormat.MAVLINK_PLAN, options).contents
    path = tmp_path / "m.plan"
    path.write_bytes(content)
    read = read_plan_json(path).rally
    back = enu_from_geodetic(model.site.origin, *np.array([(lat, lon, 62.0 + up) for lat, lon, up in read]).T)
    np.testing.assert_allclose(back[:, :2], [point.position_enu_m[:2] for point in points], atol=1e-3)
    assert [up for _, _, up in read] == pytest.approx([2.0, 0.0], abs=1e-3)
    (mission,) = read_missions(path)
    assert [finding.value for finding in mission.findings if finding.code == "rally-points"] == [2.0]


@pytest.mark.parametrize("points", [None, 5, [None], [[1.0, 2.0]], [[100.0, 0.0, 0.0]], [["a", 0.0, 0.0]]])
def test_rally_points_that_are_none_are_left_out(tmp_path: Path, points: Any) -> None:
    content = plan_of(item(16, 0, 0, 0, 0, 52.0, 5.0, 10.0)) | {"rallyPoints": {"points": points, "version": 2}}
    assert read_plan_json(plan_file(tmp_path, content)).rally == ()


def test_a_home_that_cannot_be_is_told_and_not_used(tmp_path: Path) -> None:
    content = plan_of(item(16, 0, 0, 0, 0, 52.0, 5.0, 30), plannedHomePosition=[95, 5, 0])
    path = tmp_path / "m.plan"
    path.write_text(json.dumps(content))
    file = read_plan_json(path)
    assert file.home is None
    assert "home position 95, 5, 0 m is not on the globe" in file.findings[0].message
