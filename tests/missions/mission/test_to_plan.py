from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from missions.formats.registry import read_missions
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import Finish, GeoPoint, ReadMission, ReadPhoto, ReadWaypoint
from missions.mission.to_plan import viewpoints_and_sorties
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.parameters import FlightRules
from tests.missions.plans import HOME, HONG_KONG, make_plan


def point(x: float, y: float, above_home_m: float, *photos: ReadPhoto) -> ReadWaypoint:
    lat, lon, _ = geodetic_from_enu(HONG_KONG, [(x, y, HOME[2] + above_home_m)])
    return ReadWaypoint(float(lat[0]), float(lon[0]), height_above_takeoff_m=above_home_m, photos=photos)


def mission(*waypoints: ReadWaypoint, **changes: object) -> ReadMission:
    values: dict[str, object] = {
        "name": "m", "path": Path("m.plan"), "format": FileFormat.MAVLINK_PLAN, "waypoints": waypoints, "takeoff": None,
        "height_reference": HeightReference.ABOVE_TAKEOFF,
    }  # fmt: skip
    return ReadMission(**{**values, **changes})  # type: ignore[arg-type]


SEEN = ReadPhoto(10.0, -20.0)
NEAR, FAR = point(30.0, 0.0, 20.0, SEEN), point(30.0, 40.0, 25.0, SEEN)


def path_of(*missions: ReadMission) -> list[tuple[float, float, float]]:
    return list(viewpoints_and_sorties(missions, HONG_KONG, HOME).sorties[0].path_enu_m)


def z(above_home_m: float) -> float:
    return HOME[2] + above_home_m


def test_relative_heights_count_from_the_sites_home_and_it_is_said() -> None:
    parts = viewpoints_and_sorties([mission(NEAR, FAR)], HONG_KONG, HOME)
    assert [v.position_enu_m[2] for v in parts.viewpoints] == pytest.approx([z(20.0), z(25.0)], abs=1e-3)
    assert ("height-reference", Severity.NOTE) in {(f.code, f.severity) for f in parts.findings}


def test_climb_and_return_that_the_autopilot_flies_by_itself_are_part_of_the_path() -> None:
    (x, y, _), (near_x, near_y), (far_x, far_y) = HOME, (30.0, 0.0), (30.0, 40.0)
    flown = path_of(mission(NEAR, FAR, climb_above_takeoff_m=22.0, return_above_takeoff_m=60.0))
    expected = [
        HOME, (x, y, z(22.0)), (near_x, near_y, z(22.0)), (near_x, near_y, z(20.0)), (far_x, far_y, z(25.0)),
        (far_x, far_y, z(60.0)), (x, y, z(60.0)), HOME,
    ]  # fmt: skip
    for a, b in zip(flown, expected, strict=True):
        assert math.dist(a, b) < 0.01
    low = path_of(mission(NEAR, FAR, climb_above_takeoff_m=5.0, return_above_takeoff_m=10.0))
    assert [round(p[2] - HOME[2]) for p in low] == [0, 20, 20, 25, 25, 0]


def test_mission_within_the_column_above_home_starts_and_ends_there() -> None:
    column = point(HOME[0], HOME[1], 20.0)
    flown = path_of(mission(column, NEAR, column, return_above_takeoff_m=100.0))
    assert [round(p[2] - HOME[2]) for p in flown] == [0, 20, 20, 20, 0]


def test_return_from_nearby_lands_at_once() -> None:
    assert max(p[2] for p in path_of(mission(NEAR, point(6.0, -40.0, 20.0), return_above_takeoff_m=80.0))) < z(21.0)


def test_landing_and_hovering_end_where_they_are() -> None:
    assert path_of(mission(NEAR, FAR, finish=Finish.LAND))[-1] == pytest.approx((30.0, 40.0, HOME[2]), abs=0.01)
    parts = viewpoints_and_sorties([mission(NEAR, FAR, finish=Finish.HOVER)], HONG_KONG, HOME)
    assert parts.sorties[0].path_enu_m[-1] == pytest.approx((30.0, 40.0, z(25.0)), abs=0.01)
    assert "finish" in {finding.code for finding in parts.findings}


def test_ids_of_the_file_are_kept_and_the_others_numbered_without_doubles() -> None:
    named = replace(NEAR, photos=(ReadPhoto(0.0, 0.0, "v0001"), ReadPhoto(0.0, 0.0), ReadPhoto(0.0, 0.0, "v0001")))
    parts = viewpoints_and_sorties([mission(named), mission(FAR)], HONG_KONG, HOME)
    assert [v.id for v in parts.viewpoints] == ["v0001", "v0000", "v0002", "v0003"]
    assert [s.viewpoint_ids for s in parts.sorties] == [("v0001", "v0000", "v0002"), ("v0003",)]


def test_viewpoints_are_vertices_of_their_path() -> None:
    parts = viewpoints_and_sorties([mission(NEAR, FAR)], HONG_KONG, HOME)
    assert all(v.position_enu_m in parts.sorties[0].path_enu_m for v in parts.viewpoints)


def test_gimbal_that_was_never_told_anything_is_taken_as_level_and_it_is_said() -> None:
    open_pitch = replace(NEAR, photos=(ReadPhoto(5.0, None), SEEN))
    parts = viewpoints_and_sorties([mission(open_pitch)], HONG_KONG, HOME)
    assert [v.gimbal_pitch_deg for v in parts.viewpoints] == [0.0, -20.0]
    (finding,) = [f for f in parts.findings if f.code == "no-gimbal-pitch"]
    assert (finding.severity, finding.value) == (Severity.WARNING, 1)


def test_photo_whose_heading_the_pilot_steers_is_left_out_and_it_is_said() -> None:
    parts = viewpoints_and_sorties([mission(replace(NEAR, photos=(ReadPhoto(None, 0.0), SEEN)))], HONG_KONG, HOME)
    assert len(parts.viewpoints) == 1
    assert ("no-heading", Severity.WARNING) in {(f.code, f.severity) for f in parts.findings}


def test_mission_of_another_site_is_refused_with_the_distance() -> None:
    with pytest.raises(InputError, match=r"is 5\d\.\d km from the site's home; expected at most 5 km"):
        viewpoints_and_sorties([mission(NEAR)], Origin(22.8372, 114.2636, 62.0), HOME)
    with pytest.raises(InputError, match="no waypoints"):
        viewpoints_and_sorties([mission()], HONG_KONG, HOME)


def test_take_off_point_far_from_home_is_a_warning() -> None:
    lat, lon, height_m = geodetic_from_enu(HONG_KONG, [HOME])
    home = GeoPoint(float(lat[0]), float(lon[0]), float(height_m[0]))

    def codes(takeoff: GeoPoint) -> set[str]:
        found = viewpoints_and_sorties([mission(NEAR, takeoff=takeoff)], HONG_KONG, HOME).findings
        return {f.code for f in found if f.severity is Severity.WARNING}

    assert codes(home) == set()
    assert codes(replace(home, lat_deg=home.lat_deg + 0.001)) == {"takeoff-moved"}
    assert codes(replace(home, height_ellipsoid_m=home.height_ellipsoid_m + 5.0)) == {"takeoff-lifted"}


def test_durations_are_those_that_a_plan_would_state() -> None:
    rules = FlightRules(settle_s=3.0, photo_s=1.0, takeoff_landing_s=20.0)
    parts = viewpoints_and_sorties([mission(NEAR, FAR, speed_m_s=4.0)], HONG_KONG, HOME, rules)
    (sortie,) = parts.sorties
    legs_m = [math.dist(a, b) for a, b in zip(sortie.path_enu_m, sortie.path_enu_m[1:], strict=False)]
    assert sortie.length_m == pytest.approx(sum(legs_m))
    # Take-off, photos, half a turn to the first of them, and the legs at up to 4 m/s with 2.5 m/s2.
    least_s = 20.0 + 2 * 4.0 + 3.0 + sum(legs_m) / 4.0
    assert least_s < sortie.duration_s <= least_s + len(legs_m) * 4.0 / 2.5 + 3.0
    slower = viewpoints_and_sorties([mission(NEAR, FAR, speed_m_s=1.0)], HONG_KONG, HOME, rules).sorties[0]
    assert slower.duration_s > sortie.duration_s + sum(legs_m) / 2.0


def test_what_was_read_can_be_written_again() -> None:
    column = point(HOME[0], HOME[1], 20.0)
    parts = viewpoints_and_sorties([mission(column, NEAR, FAR, column)], HONG_KONG, HOME)
    plan = replace(make_plan([]), viewpoints=parts.viewpoints, sorties=parts.sorties)
    (again,) = missions_from_plan(plan)
    assert again.n_photos == 2


class TestRealFiles:
    def test_djis_facade_route_stands_20_m_before_its_facade(self, shared_data: Path) -> None:
        """Its polygon is the curtain wall: all photos look at it, 20 m away, as its documentation says."""
        missions = read_missions(shared_data / "missions" / "geoyee_m3d_curtainwall_slope_mapping2d.kmz")
        origin = Origin(22.57998, 113.93844, 16.0)
        parts = viewpoints_and_sorties(missions, origin, (200.0, 100.0, 0.0))
        assert len(parts.viewpoints) == 46
        assert {v.heading_deg for v in parts.viewpoints} == {0.717664889797475}
        wall_south_edge_m = (22.5799740671102 - origin.lat_deg) * 110_740.0
        away_m = [wall_south_edge_m - v.position_enu_m[1] for v in parts.viewpoints]
        assert min(away_m) == pytest.approx(15.5, abs=1.0)  # it leans: the route follows its slope
        assert max(away_m) == pytest.approx(20.0, abs=1.0)

    def test_survey_point_of_qgroundcontrol_becomes_a_viewpoint(self, shared_data: Path) -> None:
        missions = read_missions(shared_data / "missions" / "mavsdk_qgroundcontrol_sample.plan")
        parts = viewpoints_and_sorties(missions, Origin(47.3977507, 8.5456075, 536.0), (0.0, 0.0, 0.0))
        (view,) = parts.viewpoints
        assert view.position_enu_m[2] == pytest.approx(50.0, abs=0.01)
        assert view.heading_deg == pytest.approx(88.3, abs=0.5)  # flown eastwards, no yaw given

    def test_mission_at_the_other_end_of_the_world_is_refused(self, shared_data: Path) -> None:
        missions = read_missions(shared_data / "missions" / "qgc_test_MissionPlanner.waypoints")
        with pytest.raises(InputError, match="km from the site's home"):
            viewpoints_and_sorties(missions, HONG_KONG, HOME)
