"""plan.json: what is written reads back, and every wrong input gets a message that names file and field."""

from __future__ import annotations

import copy
import functools
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.parameters import Constraints, FlightRules
from planning.plan import (
    Coverage,
    HistoryPoint,
    Plan,
    Sortie,
    Viewpoint,
    plan_to_json,
    read_plan,
    viewpoint_arrays,
    write_plan,
)

HOME = (0.0, -45.0, 0.0)


def small_plan() -> Plan:
    m3e = profile("m3e")
    places = ((0.0, -20.0, 10.0), (5.0, -20.0, 12.5))
    return Plan(
        site="office",
        site_sha256="ab" * 32,
        method="greedy",
        seed=7,
        camera=m3e.camera,
        aircraft=m3e.aircraft,
        constraints=Constraints(occlusion="off", max_distance_m=40.0),
        viewpoints=(Viewpoint("v0000", places[0], -12.345, -10.0), Viewpoint("v0001", places[1], 180.0, 35.0)),
        sorties=(Sortie(("v0000", "v0001"), (HOME, (0.0, -45.0, 5.0), *places, HOME), 90.5, 80.25),),
        coverage=Coverage(40, 10080, 9292),
        history=(HistoryPoint(0.5, 20), HistoryPoint(1.25, 40)),
        origin=Origin(22.0, 114.0, 60.0),
        home_enu_m=HOME,
        rules=FlightRules(wind_m_s=3.0, max_speed_m_s=8.0),
        profile="m3e",
    )


@functools.cache
def small_content() -> str:
    return json.dumps(plan_to_json(small_plan()))


def test_a_plan_reads_back_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(path, small_plan())
    assert read_plan(path) == small_plan()
    write_plan(tmp_path / "again.json", read_plan(path))
    assert (tmp_path / "again.json").read_bytes() == path.read_bytes()


def test_the_file_has_the_fields_of_the_contract() -> None:
    content = json.loads(small_content())
    assert content["format"] == "reflight-plan/1"
    assert next(iter(content)) == "format"
    assert content["camera"] == {
        "name": "DJI M3E",
        "sensor_width_mm": 17.3,
        "sensor_height_mm": 13.0,
        "focal_length_mm": 12.29,
        "image_width_px": 5280,
        "image_height_px": 3956,
        "gimbal_pitch_deg": [-90.0, 35.0],
    }
    assert {"name", "endurance_s", "max_speed_m_s"} <= set(content["aircraft"])
    assert {"min_distance_m": 10.0, "section_step_deg": 30.0, "occlusion": "off"}.items() <= content[
        "constraints"
    ].items()
    assert content["viewpoints"][0] == {
        "id": "v0000",
        "position_enu_m": [0.0, -20.0, 10.0],
        "heading_deg": -12.345,
        "gimbal_pitch_deg": -10.0,
    }
    assert set(content["sorties"][0]) == {"viewpoint_ids", "path_enu_m", "length_m", "duration_s"}
    assert content["coverage"] == {"covered": 40, "total": 10080, "reachable_upper_bound": 9292}
    assert content["history"] == [{"t_s": 0.5, "covered": 20}, {"t_s": 1.25, "covered": 40}]


def test_the_contract_s_own_fields_are_enough_and_unknown_ones_are_ignored(tmp_path: Path) -> None:
    content = json.loads(small_content())
    for key in ("origin", "home_enu_m", "rules", "effects", "profile", "history"):
        content.pop(key, None)
    content["aircraft"] = {"name": "DJI M3E", "endurance_s": 2520, "max_speed_m_s": 15}
    content["constraints"] = {"min_distance_m": 10, "section_step_deg": 30, "occlusion": "off"}
    content["weather"] = {"wind": "calm"}
    content["viewpoints"][0]["lens"] = "wide"
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(content))
    plan = read_plan(path)
    assert plan.viewpoints == small_plan().viewpoints
    assert plan.constraints.min_distance_m == 10.0
    assert plan.home_enu_m is None
    assert plan_to_json(plan).keys().isdisjoint({"origin", "home_enu_m"}), "what is not known is not written"


def put(*path_and_value: Any) -> Callable[[Any], None]:
    *path, value = path_and_value

    def change(content: Any) -> None:
        for key in path[:-1]:
            content = content[key]
        if value is KeyError:
            del content[path[-1]]
        else:
            content[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("format", "reflight-plan/2"), "format: expected 'reflight-plan/1', got 'reflight-plan/2'"),
        (put("camera", KeyError), "missing required field 'camera'"),
        (put("viewpoints", 1, "position_enu_m", [0, 1]), r"viewpoints\[1\]\.position_enu_m: expected list of length 3"),
        (
            put("viewpoints", 1, "position_enu_m", 2, math.nan),
            r"viewpoints\[1\]\.position_enu_m\[2\]: expected a finite",
        ),
        (put("viewpoints", 1, "position_enu_m", [691_000, 5e6, 9]), r"viewpoints\[1\].*position_enu_m.*local ENU.*UTM"),
        (put("viewpoints", 1, "heading_deg", 361.0), r"heading_deg: expected \(-180, 180\], got 361"),
        (put("viewpoints", 1, "gimbal_pitch_deg", 91.0), "gimbal_pitch_deg: expected -180 to 90, got 91"),
        (put("viewpoints", 1, "id", "v0000"), "expected unique ids, 'v0000' occurs twice"),
        (put("viewpoints", 1, "id", ""), "expected a name, got an empty text"),
        (put("viewpoints", 1, "id", 5), r"viewpoints\[1\]\.id: expected text, got whole number"),
        (put("sorties", 0, "viewpoint_ids", ["v0009"]), r"sorties\[0\]\.viewpoint_ids: there is no viewpoint 'v0009'"),
        (put("sorties", 0, "path_enu_m", 1, 0, math.inf), r"sorties\[0\]\.path_enu_m\[1\]\[0\]: expected a finite"),
        (put("sorties", 0, "path_enu_m", 1, 0, 3e4), r"sorties\[0\].*path_enu_m\[1\]: expected local ENU"),
        (put("sorties", 0, "length_m", "long"), r"sorties\[0\]\.length_m: expected number, got text"),
        (put("coverage", "covered", 9293), "expected 0 <= covered <= reachable_upper_bound <= total, got 9293, 9292"),
        (put("coverage", "total", 9000), "covered <= reachable_upper_bound <= total"),
        (put("coverage", "covered", -1), "0 <= covered"),
        (put("coverage", "covered", 1.5), r"coverage\.covered: expected whole number"),
        (put("constraints", "section_step_deg", 7), "section_step_deg: expected a divisor of 90"),
        (put("constraints", "min_distance_m", -1), "min_distance_m: expected 0 or more, got -1"),
        (put("constraints", "occlusion", "maybe"), "occlusion: expected auto, off, on, got 'maybe'"),
        (put("constraints", "max_distance_m", 5), "max_distance_m: expected more than the minimum distance 10"),
        (put("camera", "focal_length_mm", 0), "focal_length_mm: expected a positive number, got 0"),
        (put("camera", "gimbal_pitch_deg", [35, -90]), "expected .lowest, highest. within -180 to 90"),
        (put("aircraft", "endurance_s", -3), "endurance_s: expected a positive number"),
        (put("rules", "battery_reserve", 1.0), "battery_reserve: expected 0 to below 1"),
        (put("rules", "settle_s", -1.0), "settle_s: expected 0 or more"),
        (put("rules", "max_speed_m_s", 0), "max_speed_m_s: expected a positive speed"),
        (put("home_enu_m", [0, 0, 1e6]), "home_enu_m: expected local ENU"),
        (put("origin", "lat_deg", 91), r"lat_deg: expected -90 to 90, got 91"),
    ],
)
def test_wrong_fields_are_named_with_what_was_expected_and_found(
    tmp_path: Path, change: Callable[[Any], None], message: str
) -> None:
    content = json.loads(small_content())
    change(content)
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=message) as caught:
        read_plan(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def every_place(content: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths to all values of a JSON tree."""
    inner = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    return [path, *(place for key, value in inner for place in every_place(value, (*path, key)))]


PLACES = every_place(json.loads(small_content()))[1:]


@given(
    place=st.sampled_from(PLACES), value=st.sampled_from([None, "x", -1, 1e300, [], {}, True, [[]], {"a": 1}, KeyError])
)
@settings(max_examples=300)
def test_no_value_anywhere_raises_anything_but_an_input_error(
    tmp_path_factory: pytest.TempPathFactory, place: tuple[Any, ...], value: Any
) -> None:
    content = copy.deepcopy(json.loads(small_content()))
    put(*place, value)(content)
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    path.write_text(json.dumps(content))
    try:
        plan = read_plan(path)
    except InputError:
        return
    json.dumps(plan_to_json(plan), allow_nan=False)


def test_what_cannot_be_written_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    write_plan(path, small_plan())
    old = path.read_bytes()
    with pytest.raises(ValueError, match="JSON compliant"):
        write_plan(path, replace(small_plan(), history=(HistoryPoint(math.inf, 1),)))
    assert path.read_bytes() == old
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(InputError, match="cannot be written"):
        write_plan(tmp_path / "no folder" / "plan.json", small_plan())


def test_viewpoints_become_arrays_in_radians() -> None:
    views = viewpoint_arrays(small_plan().viewpoints)
    assert views.positions_enu_m.tolist() == [[0.0, -20.0, 10.0], [5.0, -20.0, 12.5]]
    assert views.heading_rad == pytest.approx([math.radians(-12.345), math.pi])
    assert views.pitch_rad == pytest.approx([math.radians(-10.0), math.radians(35.0)])
    assert viewpoint_arrays(()).positions_enu_m.shape == (0, 3)
    assert small_plan().duration_s == 80.25
