"""What is read from missions of other programs: triggers, gimbal, yaw and regions of interest, one by one."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import MavlinkFile, MissionItem, plain
from missions.mavlink.read import autopilot_by_items, read_mavlink
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import Finish, GeoPoint, ReadMission, ReadPhoto, distance_m, point_at_amsl
from planning.base.errors import MissionError

HOME = point_at_amsl(52.0, 5.0, 10.0)
NORTH_100_M = 52.0 + 100.0 / 111_267.0
EAST_100_M = 5.0 + 100.0 / 68_678.0
NAN = math.nan


def at(command: int, lat: float, lon: float, altitude: float = 30.0, *params: float, frame: int = 3) -> MissionItem:
    p1, p2, p3, p4 = (*params, *[0.0] * (4 - len(params)))
    return MissionItem(command, frame, (p1, p2, p3, p4, lat, lon, altitude))


TAKEOFF = at(22, 52.0, 5.0)
FIRST, SECOND = at(16, NORTH_100_M, 5.0), at(16, NORTH_100_M, EAST_100_M)
SHOOT, CAPTURE = plain(203, 0, 0, 0, 0, 1), plain(2000, 0, 0, 1)


def read(
    *items: MissionItem, home: GeoPoint | None = HOME, autopilot: Autopilot | None = None, speed: float | None = None
) -> ReadMission:
    file = MavlinkFile(tuple(items), home, autopilot, speed)
    return read_mavlink(Path("m.plan"), file, FileFormat.MAVLINK_PLAN)


def photos(*items: MissionItem, **options: Autopilot | None) -> list[ReadPhoto]:
    return [photo for waypoint in read(*items, **options).waypoints for photo in waypoint.photos]  # type: ignore[arg-type]


def distances(*items: MissionItem, speed: float | None = None) -> list[float]:
    """Where photos are taken, metres north or east of home."""
    points = [w for w in read(*items, speed=speed).waypoints for _ in w.photos]
    return [distance_m(52.0, 5.0, p.lat_deg, p.lon_deg) for p in points]


def test_photo_is_taken_at_the_waypoint_before_its_trigger_with_the_nose_on_the_course() -> None:
    mission = read(TAKEOFF, FIRST, SHOOT, SECOND, CAPTURE)
    assert [len(w.photos) for w in mission.waypoints] == [0, 1, 1]
    taken = [w.photos[0] for w in mission.waypoints[1:]]
    assert [p.heading_deg for p in taken] == pytest.approx([0.0, 90.0], abs=0.01)
    assert [p.gimbal_pitch_deg for p in taken] == [None, None]


def test_digicam_without_its_1_takes_no_photo() -> None:
    assert photos(TAKEOFF, FIRST, plain(203, 1)) == []


def test_condition_yaw_turns_for_one_leg_only() -> None:
    taken = photos(TAKEOFF, plain(115, 200), FIRST, SHOOT, SECOND, SHOOT)
    assert [p.heading_deg for p in taken] == pytest.approx([-160.0, 90.0], abs=0.01)


def test_condition_yaw_behind_the_waypoint_is_meant_for_its_photo() -> None:
    assert photos(TAKEOFF, FIRST, plain(115, 45), SHOOT)[0].heading_deg == 45.0


@pytest.mark.parametrize(("direction", "expected"), [(1.0, 30.0), (-1.0, -30.0), (0.0, 30.0)])
def test_relative_condition_yaw_turns_from_the_nose(direction: float, expected: float) -> None:
    (photo,) = photos(TAKEOFF, FIRST, plain(115, 30, 0, direction, 1), SHOOT)
    assert photo.heading_deg == pytest.approx(expected, abs=0.01)


def test_yaw_of_a_waypoint_counts_for_px4_and_not_for_ardupilot() -> None:
    turned = at(16, NORTH_100_M, 5.0, 30.0, 0, 0, 0, 77.0)
    assert photos(TAKEOFF, turned, CAPTURE, autopilot=Autopilot.PX4)[0].heading_deg == 77.0
    assert photos(TAKEOFF, turned, CAPTURE, autopilot=Autopilot.ARDUPILOT)[0].heading_deg == pytest.approx(
        0.0, abs=0.01
    )


def test_yaw_0_is_north_for_px4_and_nothing_where_the_autopilot_is_not_known() -> None:
    east = at(16, 52.0, EAST_100_M, 30.0, 0, 0, 0, 0.0)
    assert photos(TAKEOFF, east, CAPTURE, autopilot=Autopilot.PX4)[0].heading_deg == 0.0
    assert photos(TAKEOFF, east, CAPTURE)[0].heading_deg == pytest.approx(90.0, abs=0.01)


def test_autopilot_is_known_by_what_only_one_understands() -> None:
    assert autopilot_by_items((TAKEOFF, plain(115, 10), FIRST)) is Autopilot.ARDUPILOT
    assert autopilot_by_items((TAKEOFF, at(16, 52.0, 5.0, 30.0, 0, 0, 0, NAN))) is Autopilot.PX4
    assert autopilot_by_items((TAKEOFF, plain(1001, -2, -2), FIRST)) is Autopilot.PX4
    assert autopilot_by_items((TAKEOFF, FIRST, SHOOT)) is None


@pytest.mark.parametrize(
    ("gimbal", "heading", "pitch"),
    [
        (plain(205, -45.67, 0, 0, 0, 0, 0, 2), 0.0, -45.67),
        (plain(205, -20, 0, 30, 0, 0, 0, 2), 30.0, -20.0),
        (plain(205, 0, 0, 0, 0, 0, 0, 1), 0.0, 0.0),
        (plain(1000, -15.5, 0, NAN, NAN, 12), 0.0, -15.5),
        (plain(1000, -15.5, 120, NAN, NAN, 16), 120.0, -15.5),
        (plain(1000, -15.5, -30, 0, 0, 0), -30.0, -15.5),
    ],
)
def test_gimbal_commands_set_pitch_and_yaw(gimbal: MissionItem, heading: float, pitch: float) -> None:
    (photo,) = photos(TAKEOFF, gimbal, FIRST, SHOOT)
    assert photo.heading_deg == pytest.approx(heading, abs=0.01)
    assert photo.gimbal_pitch_deg == pitch


def test_gimbal_stays_until_it_is_told_otherwise_and_nan_leaves_an_axis_alone() -> None:
    taken = photos(TAKEOFF, plain(1000, -30, 0, NAN, NAN, 12), FIRST, SHOOT, plain(1000, NAN, NAN), SECOND, SHOOT)
    assert [p.gimbal_pitch_deg for p in taken] == [-30.0, -30.0]


def test_region_of_interest_aims_every_photo_at_it() -> None:
    roi = at(201, 52.0, 5.0, 0.0, 3)
    taken = photos(
        TAKEOFF, roi, FIRST, SHOOT, SECOND, SHOOT, plain(197), plain(205, -5, 0, 0, 0, 0, 0, 2), FIRST, SHOOT
    )
    assert [p.heading_deg for p in taken] == pytest.approx([180.0, -135.0, -90.0], abs=0.1)
    down = [-math.degrees(math.atan2(30.0, 100.0)), -math.degrees(math.atan2(30.0, 141.42))]
    assert [p.gimbal_pitch_deg for p in taken[:2]] == pytest.approx(down, abs=0.05)
    assert taken[2].gimbal_pitch_deg == -5.0


def test_region_of_interest_above_sea_level_is_brought_to_the_waypoints_reference() -> None:
    roi = at(195, 52.0, 5.0, 10.0, frame=0)  # on the ground at home, 10 m above sea level
    (photo,) = photos(TAKEOFF, roi, FIRST, CAPTURE)
    assert photo.gimbal_pitch_deg == pytest.approx(-math.degrees(math.atan2(30.0, 100.0)), abs=0.05)


def test_distance_trigger_shoots_along_the_legs_until_it_is_stopped() -> None:
    stop = plain(206, 0)
    assert distances(TAKEOFF, plain(206, 40), FIRST, stop, SECOND) == pytest.approx([40.0, 80.0], abs=0.1)
    at_once = distances(TAKEOFF, plain(206, 40, 0, 1), FIRST, stop, SECOND)
    assert at_once == pytest.approx([0.0, 40.0, 80.0], abs=0.1)


def test_photos_by_distance_climb_with_the_leg() -> None:
    mission = read(TAKEOFF, plain(206, 50), at(16, NORTH_100_M, 5.0, 130.0))
    heights = [w.height_above_takeoff_m for w in mission.waypoints if w.photos]
    assert heights == pytest.approx([30.0 + 50.0 / math.sqrt(2.0), 30.0 + 100.0 / math.sqrt(2.0)], abs=0.1)


def test_photos_by_time_follow_the_speed_and_their_count() -> None:
    every_5_s = plain(2000, 0, 5, 0)
    assert distances(TAKEOFF, plain(178, 1, 8, -1), every_5_s, FIRST) == pytest.approx([0.0, 40.0, 80.0], abs=0.1)
    assert distances(TAKEOFF, plain(2000, 0, 5, 2), FIRST, speed=8.0) == pytest.approx([0.0, 40.0], abs=0.1)
    assert distances(TAKEOFF, every_5_s, plain(2001), FIRST, speed=8.0) == pytest.approx([0.0], abs=0.1)
    assert distances(TAKEOFF, plain(214, 5000), FIRST, plain(214, -1), SECOND, speed=8.0) == pytest.approx(
        [40, 80], abs=0.1
    )


def test_photo_at_the_end_of_a_leg_belongs_to_its_waypoint() -> None:
    mission = read(TAKEOFF, plain(206, distances(TAKEOFF, FIRST, SHOOT)[0]), FIRST, plain(206, 0), SECOND)
    assert [len(w.photos) for w in mission.waypoints] == [0, 1, 0]


def test_takeoff_here_is_above_home_and_without_home_only_a_height() -> None:
    here = at(22, 0.0, 0.0, 15.0)
    assert (read(here, FIRST).waypoints[0].lat_deg, len(read(here, FIRST).waypoints)) == (52.0, 2)
    without = read(here, FIRST, home=None)
    assert (len(without.waypoints), without.climb_above_takeoff_m) == (1, 15.0)


def test_landing_flies_level_to_above_its_place_and_ends_the_flight() -> None:
    mission = read(TAKEOFF, FIRST, at(21, 52.0, EAST_100_M, 0.0), SECOND)
    assert mission.finish is Finish.LAND
    assert [(w.lon_deg, w.height_above_takeoff_m) for w in mission.waypoints[2:]] == [(EAST_100_M, 30.0)]
    assert read(TAKEOFF, FIRST, plain(20), SECOND).finish is Finish.RETURN
    assert read(TAKEOFF, FIRST).finish is Finish.HOVER


def test_frames_say_the_reference_and_sea_level_becomes_the_ellipsoid() -> None:
    relative, absolute = (
        read(TAKEOFF, FIRST),
        read(at(22, 52.0, 5.0, 60.0, frame=0), at(16, 52.001, 5.0, 60.0, frame=5)),
    )
    assert relative.height_reference is HeightReference.ABOVE_TAKEOFF
    assert absolute.height_reference is HeightReference.AMSL
    assert absolute.waypoints[1].height_ellipsoid_m == point_at_amsl(52.001, 5.0, 60.0).height_ellipsoid_m


def test_mixed_heights_without_home_cannot_be_joined_by_a_distance_trigger() -> None:
    items = (FIRST, plain(206, 10), at(16, 52.0, 5.0, 60.0, frame=0))
    with pytest.raises(MissionError, match="mixed, and home is not known"):
        read(*items, home=None)
    assert read(*items).n_photos > 5


def test_what_is_simplified_is_said() -> None:
    mission = read(TAKEOFF, at(82, NORTH_100_M, 5.0), at(18, NORTH_100_M, 5.0), plain(177, 2, 3), plain(201, 1))
    assert [f.place.rpartition(" ")[2] for f in mission.findings if f.code == "simplified"] == ["2", "3", "4", "5"]


def test_what_a_plan_cannot_hold_is_said_once_for_each_command() -> None:
    gripper, unheard_of, gimbal = plain(211, 1, 1), plain(31999, 1), plain(1001)
    mission = read(TAKEOFF, FIRST, gripper, unheard_of, gripper, gimbal, plain(20), plain(178, 1), FIRST)
    told = [(f.place.rpartition(" ")[2], str(f.message)) for f in mission.findings if f.code == "left-out"]
    assert [place for place, _ in told] == ["3", "4", "7"]
    assert "(211, DO_GRIPPER; items: 2)" in told[0][1]
    assert "(31999; items: 1)" in told[1][1]
    assert "behind it is left out, items: 2" in told[2][1]
    assert "left-out" not in {f.code for f in read(TAKEOFF, FIRST, SHOOT, gimbal, plain(20)).findings}


def test_photo_before_the_first_waypoint_is_left_out_and_said() -> None:
    mission = read(SHOOT, FIRST, home=None)
    assert mission.n_photos == 0
    assert "photo-without-place" in {finding.code for finding in mission.findings}


@pytest.mark.parametrize("pitch", [-9000.0, 91.0, math.inf])
def test_pitch_that_is_no_angle_is_told_and_not_followed(pitch: float) -> None:
    mission = read(TAKEOFF, plain(205, pitch, 0, 0, 0, 0, 0, 2), FIRST, SHOOT)
    (told,) = [finding for finding in mission.findings if finding.code == "angle"]
    assert "param 1 is" in told.message
    assert told.place.endswith("item 2")
    assert mission.waypoints[1].photos[0].gimbal_pitch_deg is None


@pytest.mark.parametrize("item", [plain(115, NAN), plain(1000, 0.0, 9000.0), plain(206, 1e-4), plain(214, 1e-3)])
def test_what_cannot_be_followed_leaves_the_path(item: MissionItem) -> None:
    mission = read(TAKEOFF, FIRST, item, SECOND, speed=5.0)
    assert len(mission.waypoints) == 3
    assert {finding.code for finding in mission.findings} & {"angle", "trigger"}


def test_waypoint_at_0_0_is_where_the_vehicle_is() -> None:
    assert read(TAKEOFF, at(16, 0.0, 0.0, 50.0)).waypoints[1].lat_deg == 52.0
    with pytest.raises(MissionError, match="nothing says where"):
        read(at(16, 0.0, 0.0, 50.0), home=None)
