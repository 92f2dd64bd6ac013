"""How PX4 flies a mission."""

from __future__ import annotations

import math

import pytest

from missions.mavlink.messages import CameraImageCaptured, MissionItemReached
from planning.motion.px4 import straight_s
from tests.missions.simulator.ground import PX4, Ground, at, item

TAKEOFF, LAND = at(22, 0, 0, 20, 0, 0, 0, math.nan), at(21, 0, 0, 0, 0, 0, 0, math.nan)
SHOOT = item(2000, 0, 0, 1, frame=2)
CONTROL = item(1001, -2, -2, -1, -1, frame=2)


def do(command: int, *params: float):
    return item(command, *params, frame=2)


def waypoint(
    east: float, north: float, hold: float = 0.0, yaw: float = math.nan, radius: float = 0.5, up: float = 20.0
):
    return at(16, east, north, up, hold, radius, 0, yaw)


def run(items, parameters=None) -> Ground:
    ground = Ground(PX4, parameters)
    ground.fly(items)
    return ground


def test_recommended_pattern_takes_every_photo_in_place_and_turned() -> None:
    items = [TAKEOFF, CONTROL]
    for i in range(6):
        items += [do(1000, -10.5, 0, math.nan, math.nan, 12), waypoint(10 + 3 * i, 5, 2.5, 60.5 * i), SHOOT, do(93, 1)]
    ground = run([*items, LAND])
    assert len(ground.vehicle.shots) == 6
    for i, shot in enumerate(ground.vehicle.shots):
        pose = shot.pose
        assert math.dist(pose.position_enu_m, (10 + 3 * i, 5, 20)) < 0.1
        assert abs(math.remainder(math.degrees(pose.heading_rad) - 60.5 * i, 360.0)) < 0.5
        assert math.degrees(pose.gimbal_pitch_rad) == pytest.approx(-10.5, abs=0.01)


@pytest.mark.parametrize(("hold_s", "taken_s"), [(0.5, 168 / 45), (6.0, None)])
def test_hold_runs_while_the_nose_still_turns(hold_s, taken_s) -> None:
    """A 180 deg turn at 45 deg/s is waited for until 12 deg are left, after 3.73 s; the hold is no wait of its own."""
    ground = Ground(PX4)
    assert ground.upload([TAKEOFF, waypoint(0, 1, hold_s, 180.0), SHOOT, do(93, 1), LAND]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.current == 1)
    start_s = ground.vehicle.now_s
    ground.until(lambda: bool(ground.vehicle.shots))
    leg_s = straight_s(1.0, 5.0, 3.0, 4.0, 0.5)
    assert ground.vehicle.now_s - start_s == pytest.approx(taken_s or leg_s + hold_s, abs=0.06)


def test_legs_take_as_long_as_on_px4_which_brakes_gently() -> None:
    ground = Ground(PX4)
    assert ground.upload([TAKEOFF, waypoint(0, 0, 1.0), waypoint(40, 0, 1.0, 0.0), LAND]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.current == 2)
    start_s = ground.vehicle.now_s
    ground.until(lambda: ground.vehicle.scheduler.current == 3)
    assert ground.vehicle.now_s - start_s == pytest.approx(straight_s(40.0, 5.0, 3.0, 4.0, 0.5) + 1.0, abs=0.2)


def test_holds_keep_fractions_of_a_second() -> None:
    ground = run([TAKEOFF, waypoint(5, 0, 1.0), SHOOT, do(93, 2.5), SHOOT, LAND])
    first, second = ground.vehicle.shots
    assert second.time_s - first.time_s == pytest.approx(2.5, abs=0.05)


def test_acceptance_radius_decides_where_a_waypoint_without_hold_ends() -> None:
    wide = run([TAKEOFF, waypoint(20, 0, radius=5.0), SHOOT, waypoint(20, 20, 1.0), LAND])
    narrow = run([TAKEOFF, waypoint(20, 0, radius=0.5), SHOOT, waypoint(20, 20, 1.0), LAND])
    away = [math.dist(each.vehicle.shots[0].pose.position_enu_m, (20, 0, 20)) for each in (wide, narrow)]
    assert 4.8 <= away[0] <= 5.0
    assert away[1] <= 0.51


def test_heading_follows_the_course_where_the_waypoint_leaves_it_open() -> None:
    ground = run([TAKEOFF, waypoint(20, 0, 2.0), SHOOT, LAND])
    assert math.degrees(ground.vehicle.shots[0].pose.heading_rad) == pytest.approx(90.0, abs=0.1)


def test_commands_wait_for_their_turn_in_the_list() -> None:
    """Unlike ArduPilot's, a command behind a waypoint is not done while the next is flown, nor dropped."""
    ground = run([TAKEOFF, waypoint(20, 0, 1.0), do(112, 4), SHOOT, waypoint(21, 0, 1.0), LAND])
    (shot,) = ground.vehicle.shots
    assert math.dist(shot.pose.position_enu_m, (20, 0, 20)) < 0.3
    assert ground.vehicle.scheduler.n_dropped == 0


def test_gimbal_obeys_the_mission_only_after_it_took_control() -> None:
    pitch = do(1000, -30, 0, math.nan, math.nan, 12)
    without = run([TAKEOFF, pitch, waypoint(5, 0, 2.0), SHOOT, LAND])
    with_control = run([TAKEOFF, CONTROL, pitch, waypoint(5, 0, 2.0), SHOOT, LAND])
    assert without.vehicle.shots[0].pose.gimbal_pitch_rad == 0.0
    assert math.degrees(with_control.vehicle.shots[0].pose.gimbal_pitch_rad) == pytest.approx(-30.0)


def test_every_item_is_told_as_reached() -> None:
    ground = run([TAKEOFF, CONTROL, waypoint(5, 0, 1.0), SHOOT, do(93, 1), LAND])
    assert ground.reached == [0, 1, 2, 3, 4, 5]


def test_photo_is_told_with_its_place_and_the_cameras_attitude() -> None:
    items = [TAKEOFF, CONTROL, do(1000, -30, 0, math.nan, math.nan, 12), waypoint(5, 0, 2.0, 120.0), SHOOT, LAND]
    (told,) = run(items).of(CameraImageCaptured)
    w, x, y, z = told.q
    # The camera's x axis in north, east, down.
    forward = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
    heading, pitch = math.radians(120.0), math.radians(-30.0)
    wanted = (math.cos(pitch) * math.cos(heading), math.cos(pitch) * math.sin(heading), -math.sin(pitch))
    assert forward == pytest.approx(wanted, abs=1e-6)
    assert (told.image_index, told.capture_result) == (0, 1)
    # Above home is what the positions say; this counts from the ground, which PX4 does not know.
    assert told.relative_alt == -1000


def test_new_mission_is_taken_up_in_flight() -> None:
    ground = Ground(PX4)
    assert ground.upload([TAKEOFF, waypoint(80, 0, 1.0), LAND]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > 20)
    assert ground.upload([TAKEOFF, waypoint(0, 30, 1.0), SHOOT, LAND]) == 0
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    (shot,) = ground.vehicle.shots
    assert math.dist(shot.pose.position_enu_m, (0, 30, 20)) < 0.3


@pytest.mark.parametrize(
    ("items", "parameters", "text"),
    [
        ([], {}, "No valid mission"),
        ([waypoint(5, 0, 1.0), LAND], {}, "takeoff missing"),
        ([TAKEOFF, waypoint(500, 0, 1.0), LAND], {"MIS_DIST_1WP": 100.0}, "too far away: 500m, 100m max"),
        ([TAKEOFF, waypoint(5, 0, 1.0, up=-3), LAND], {}, "below home"),
        ([TAKEOFF, waypoint(50, 0, 1.0), LAND], {"GF_MAX_HOR_DIST": 30.0}, "Geofence violation"),
    ],
)
def test_mission_that_is_not_feasible_is_refused(items, parameters, text) -> None:
    ground = Ground(PX4, parameters)
    assert ground.upload(items) == 0
    assert ground.command(300) == 1
    assert any(text in said for said in ground.said)
    assert not ground.vehicle.modes.is_armed


def test_jump_repeats_as_often_as_it_says() -> None:
    assert len(run([TAKEOFF, waypoint(5, 0, 1.0), SHOOT, do(93, 1), do(177, 1, 2), LAND]).vehicle.shots) == 3


def test_change_of_speed_holds_for_the_legs_behind_it() -> None:
    ground = Ground(PX4)
    assert ground.upload([TAKEOFF, do(178, 1, 3), waypoint(60, 0, 1.0), LAND]) == 0
    ground.take_off_with_mission()
    speeds = []
    ground.until(lambda: speeds.append(math.hypot(*ground.frame.velocity[:2])) or not ground.vehicle.modes.is_armed)
    assert max(speeds) == pytest.approx(3.0, abs=0.01)


def test_motors_stop_two_seconds_after_landing() -> None:
    ground = run([TAKEOFF, waypoint(5, 0, 1.0), LAND])
    landed = next(each.time_s for each in ground.heard if each.message == MissionItemReached(2))
    assert ground.vehicle.now_s - landed == pytest.approx(2.0, abs=0.1)
