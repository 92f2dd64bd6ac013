"""How ArduCopter really flies a mission; the figures are those measured on ArduCopter 4.5.6 in its own simulation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missions.mavlink.messages import CameraFeedback, MissionCurrent, MissionSetCurrent
from tests.missions.simulator.ground import ARDUPILOT, Ground, at, item

YAW_KEEP = {"WP_YAW_BEHAVIOR": 0}
WITH_PAN = {"SERVO10_FUNCTION": 6}
"""The measured vehicle: its gimbal pans, so that 205 does not turn the vehicle."""

TAKEOFF, LAND = at(22, 0, 0, 20), at(21, 0, 0, 0)
SHOOT = item(203, 0, 0, 0, 0, 1)


def mount(pitch: float = 0.0, yaw: float = 0.0):
    return item(205, pitch, 0, yaw, 0, 0, 0, 2)


def circle(n: int = 6, radius: float = 15.0):
    """Places on a circle and the headings to its centre, degrees."""
    for i in range(n):
        angle = 2 * math.pi * i / n
        yield (radius * math.sin(angle), radius * math.cos(angle), 20.0), (math.degrees(angle) + 180.0) % 360.0


def errors(ground: Ground, views) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position error, speed and yaw error of each photo."""
    assert len(ground.vehicle.shots) == len(views)
    rows = []
    for shot, (place, heading) in zip(ground.vehicle.shots, views, strict=True):
        pose = shot.pose
        yaw = abs(math.remainder(math.degrees(pose.heading_rad) - heading, 360.0))
        rows.append((math.dist(pose.position_enu_m, place), math.hypot(*pose.velocity_enu_m_s), yaw))
    away, speed, yaw = np.array(rows).T
    return away, speed, yaw


def run(items, parameters=YAW_KEEP) -> Ground:
    ground = Ground(ARDUPILOT, parameters)
    ground.fly(items)
    return ground


def test_naive_order_takes_its_photos_on_the_next_leg() -> None:
    """WP, YAW, MOUNT, DIGICAM: measured 3.7 to 7.2 m off at 3.4 to 3.6 m/s, the last 0.24 m.

    This airframe turns without having to get going first, so it is ready to shoot earlier.
    """
    views = list(circle())
    items = [TAKEOFF]
    for place, heading in views:
        items += [at(16, *place), item(115, heading), mount(), SHOOT]
    # The last view has a navigation item behind it that does not move.
    away, speed, _ = errors(run([*items, item(93, 5), LAND], WITH_PAN), views)
    assert ((away[:-1] > 1.4) & (away[:-1] < 8.0)).all()
    assert ((speed[:-1] > 3.2) & (speed[:-1] < 6.0)).all()
    assert away[-1] < 0.35


def test_naive_order_loses_nearly_all_photos_on_legs_of_a_metre() -> None:
    """180 deg turns on 1 m legs: 7 of 8 photos never happened."""
    items = [TAKEOFF]
    for i in range(8):
        items += [at(16, 10 + i, 0, 20), item(115, 180.0 * (i % 2)), mount(), SHOOT]
    ground = run([*items, LAND], WITH_PAN)
    assert 1 <= len(ground.vehicle.shots) <= 2
    # With each photo its MOUNT is gone, too; the CONDITION_YAW had at least begun.
    assert ground.vehicle.scheduler.n_dropped == 2 * (8 - len(ground.vehicle.shots))


def test_photos_behind_waypoints_with_hold_0_are_taken_in_flight() -> None:
    """YAW, MOUNT, WP(0), DIGICAM: 1.0 to 1.4 m off at 1.9 to 3.2 m/s; the last, before the landing, stands still."""
    views = list(circle())
    items = [TAKEOFF]
    for place, heading in views:
        items += [item(115, heading), mount(), at(16, *place, 0), SHOOT]
    away, speed, _ = errors(run([*items, LAND], WITH_PAN), views)
    assert ((away[:-1] >= 1.0) & (away[:-1] <= 1.4)).all()
    assert ((speed[:-1] >= 1.9) & (speed[:-1] <= 3.2)).all()
    assert away[-1] <= 0.3


@pytest.mark.few(1)
@pytest.mark.parametrize("hold", [1, 2, 4])
def test_photos_behind_waypoints_with_a_hold_are_taken_in_place(hold: int) -> None:
    """YAW, MOUNT, WP(2), DIGICAM: 0.24 m, 0.12 m/s and 0.02 deg at most."""
    views = list(circle())
    items = [TAKEOFF]
    for place, heading in views:
        items += [item(115, heading), mount(), at(16, *place, hold), SHOOT]
    away, speed, yaw = errors(run([*items, LAND], WITH_PAN), views)
    assert away.max() <= 0.24
    assert speed.max() <= 0.12
    assert yaw.max() <= 0.02


def test_delay_between_waypoint_and_aiming_takes_photos_on_the_next_leg() -> None:
    """WP, NAV_DELAY, YAW, MOUNT, CONDITION_DELAY, DIGICAM: 1.0 to 6.0 m off."""
    views = list(circle())
    items = [TAKEOFF]
    for place, heading in views:
        items += [at(16, *place, 1), item(93, 2), item(115, heading), mount(), item(112, 1), SHOOT]
    away, _, _ = errors(run([*items, item(93, 5), LAND], WITH_PAN), views)
    assert (away[:-1] >= 1.0).all()


def test_waypoint_then_aiming_then_delay_then_photo_works_too() -> None:
    """WP, YAW, MOUNT, NAV_DELAY(4), DIGICAM: 0.06 to 0.10 m, also good."""
    views = list(circle())
    items = [TAKEOFF]
    for place, heading in views:
        items += [at(16, *place, 1), item(115, heading), mount(), item(93, 4), SHOOT]
    away, speed, yaw = errors(run([*items, LAND], WITH_PAN), views)
    assert away.max() <= 0.1
    assert speed.max() <= 0.12
    assert yaw.max() <= 0.5


def test_slow_yaw_does_not_hold_up_the_photo_behind_the_waypoint_and_drops_the_mount() -> None:
    """At 5 deg/s on a 10 m leg with 2 s of hold the photo came at 45 deg instead of 180, the tilt never came."""
    ground = Ground(ARDUPILOT, {**YAW_KEEP, "WPNAV_SPEED": 200.0})
    ground.fly([TAKEOFF, item(115, 180, 5), mount(-30), at(16, 0, 10, 20, 2), SHOOT, item(93, 1), LAND])
    (shot,) = ground.vehicle.shots
    assert 30.0 <= abs(math.degrees(shot.pose.heading_rad)) <= 60.0
    assert shot.pose.gimbal_pitch_rad == 0.0
    assert ground.vehicle.scheduler.n_dropped == 1


def test_half_a_turn_takes_3_seconds_at_the_usual_rate() -> None:
    """3.1 s from rest at 60 deg/s."""
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, item(115, 180), item(93, 10), LAND]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.current == 3)
    start = ground.vehicle.now_s
    ground.until(lambda: abs(abs(ground.frame.heading) - math.pi) < 1e-3)
    assert 2.9 <= ground.vehicle.now_s - start <= 3.2


@pytest.mark.parametrize(("hold", "stays"), [(2.9, 2.0), (0.5, 0.0)])
def test_holds_are_whole_seconds(hold: float, stays: float) -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, at(16, 10, 0, 20, hold), item(93, 1), LAND]) == 0
    assert ground.download()[2].param1 == stays


def test_nav_delay_keeps_fractions_of_a_second() -> None:
    ground = run([TAKEOFF, at(16, 10, 0, 20, 1), SHOOT, item(93, 2.5), SHOOT, LAND])
    first, second = ground.vehicle.shots
    assert second.time_s - first.time_s == pytest.approx(2.5, abs=0.05)


def test_five_triggers_in_a_row_are_one_photo() -> None:
    ground = run([TAKEOFF, at(16, 10, 0, 20, 2), *[SHOOT] * 5, item(93, 2), LAND])
    assert len(ground.vehicle.shots) == 1
    assert ground.vehicle.camera.n_lost == 4


def test_with_a_least_interval_one_of_five_triggers_waits_and_three_are_lost() -> None:
    ground = run(
        [TAKEOFF, at(16, 10, 0, 20, 2), *[SHOOT] * 5, item(93, 4), LAND], {**YAW_KEEP, "CAM1_INTRVAL_MIN": 1.0}
    )
    first, second = ground.vehicle.shots
    assert second.time_s - first.time_s == pytest.approx(1.0, abs=0.03)
    assert ground.vehicle.camera.n_lost == 3


def test_without_camera_the_trigger_is_carried_out_and_nothing_comes_of_it() -> None:
    ground = run([TAKEOFF, at(16, 10, 0, 20, 2), SHOOT, item(93, 1), LAND], {**YAW_KEEP, "CAM1_TYPE": 0})
    assert ground.of(CameraFeedback) == []
    assert not any("amera" in text for text in ground.said)


def test_trigger_scaled_like_a_coordinate_is_accepted_and_takes_no_photo() -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, at(16, 5, 0, 20, 1), item(203, 0, 0, 0, 0, 10_000_000), LAND]) == 0
    assert ground.download()[3].x == 128
    ground.take_off_with_mission()
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    assert ground.vehicle.shots == []


def test_series_goes_on_while_the_vehicle_flies_on() -> None:
    """IMAGE_START_CAPTURE with 3 photos every second: one in place, the others on the next leg unless it is held."""
    ground = run([TAKEOFF, at(16, 10, 0, 20, 2), item(2000, 0, 1, 3), at(16, 40, 0, 20, 2), LAND])
    assert len(ground.vehicle.shots) == 3
    assert np.diff([shot.time_s for shot in ground.vehicle.shots]) == pytest.approx([1.0, 1.0], abs=0.03)
    assert [shot.pose.position_enu_m[0] > 10.3 for shot in ground.vehicle.shots] == [False, True, True]


def test_image_stop_ends_a_series() -> None:
    stopped = [TAKEOFF, item(2000, 0, 1, 0), at(16, 10, 0, 20, 3), item(2001), item(93, 10), LAND]
    n_photos = len(run(stopped).vehicle.shots)
    assert 5 <= n_photos <= 9


def test_distance_trigger_shoots_at_once_and_then_every_5_03_to_5_10_m() -> None:
    items = [TAKEOFF, item(178, 1, 5), at(16, 0, 2, 20, 1), item(206, 5, 0, 1), at(16, 0, 60, 20, 1), item(206), LAND]
    ground = run(items)
    north = np.array([shot.pose.position_enu_m[1] for shot in ground.vehicle.shots])
    assert north[0] == pytest.approx(2.0, abs=0.3)
    assert len(north) == 12
    steps = np.diff(north)
    assert (steps >= 5.0).all()
    assert (steps <= 5.1 + 1e-6).all()


def test_mount_control_without_pan_axis_turns_the_vehicle_to_north() -> None:
    """On a gimbal without pan axis 205 behind CONDITION_YAW made every photo face north."""
    items = [TAKEOFF, item(115, 180), mount(-10, 0), at(16, 10, 0, 20, 4), SHOOT, item(93, 1), LAND]
    (shot,) = run(items).vehicle.shots
    assert abs(math.degrees(shot.pose.heading_rad)) < 1.0
    cured = [items[0], items[2], items[1], *items[3:]]
    (shot,) = run(cured).vehicle.shots
    assert abs(math.degrees(shot.pose.heading_rad)) == pytest.approx(180.0, abs=0.1)


def test_mount_control_with_pan_axis_turns_the_gimbal_against_the_nose() -> None:
    items = [TAKEOFF, item(115, 90), mount(-10, 30), at(16, 10, 0, 20, 4), SHOOT, item(93, 1), LAND]
    (shot,) = run(items, {**YAW_KEEP, "SERVO10_FUNCTION": 6}).vehicle.shots
    assert math.degrees(shot.pose.heading_rad) == pytest.approx(90.0, abs=0.1)
    assert math.degrees(shot.pose.gimbal_heading_rad) == pytest.approx(120.0, abs=0.1)


def test_gimbal_manager_pitchyaw_turns_no_vehicle_and_knows_whole_degrees() -> None:
    items = [TAKEOFF, item(115, 90), item(1000, -45.67, 30.9), at(16, 10, 0, 20, 4), SHOOT, item(93, 1), LAND]
    (shot,) = run(items).vehicle.shots
    assert math.degrees(shot.pose.heading_rad) == pytest.approx(90.0, abs=0.1)
    assert math.degrees(shot.pose.gimbal_pitch_rad) == pytest.approx(-45.0, abs=1e-6)


def test_pitch_is_clipped_without_a_word() -> None:
    ground = run([TAKEOFF, mount(35), at(16, 10, 0, 20, 4), SHOOT, item(93, 1), LAND])
    assert math.degrees(ground.vehicle.shots[0].pose.gimbal_pitch_rad) == pytest.approx(20.0)
    assert not any("pitch" in text.lower() for text in ground.said)


@pytest.mark.parametrize("has_pan", [False, True])
def test_region_of_interest_turns_camera_and_without_pan_the_nose(has_pan: bool) -> None:
    items = [TAKEOFF, at(201, 30, 0, 0), at(16, 0, 10, 20, 4), SHOOT, item(93, 1), LAND]
    parameters = {"WP_YAW_BEHAVIOR": 2, "SERVO10_FUNCTION": 6 if has_pan else 0}
    (shot,) = run(items, parameters).vehicle.shots
    wanted = math.degrees(math.atan2(30, -10))
    assert math.degrees(shot.pose.gimbal_heading_rad) % 360.0 == pytest.approx(wanted, abs=0.5)
    assert math.degrees(shot.pose.gimbal_pitch_rad) == pytest.approx(math.degrees(math.atan2(-20, 31.6)), abs=0.5)
    assert abs(math.degrees(shot.pose.heading_rad) - (0.0 if has_pan else wanted)) < 1.0


@pytest.mark.parametrize(("behaviour", "heading"), [(0, 0.0), (2, 90.0)])
def test_wp_yaw_behavior_says_where_the_nose_points_on_a_leg(behaviour: int, heading: float) -> None:
    ground = run([TAKEOFF, at(16, 30, 0, 20, 1), SHOOT, item(93, 1), LAND], {"WP_YAW_BEHAVIOR": behaviour})
    assert math.degrees(ground.vehicle.shots[0].pose.heading_rad) == pytest.approx(heading, abs=0.5)


def test_next_waypoint_turns_the_nose_back_into_the_course() -> None:
    items = [TAKEOFF, item(115, 180), at(16, 30, 0, 20, 2), SHOOT, at(16, 60, 0, 20, 4), SHOOT, item(93, 1), LAND]
    first, second = run(items, {"WP_YAW_BEHAVIOR": 2}).vehicle.shots
    assert abs(math.degrees(first.pose.heading_rad)) == pytest.approx(180.0, abs=2.0)
    assert math.degrees(second.pose.heading_rad) == pytest.approx(90.0, abs=0.5)


def test_condition_distance_waits_until_the_waypoint_is_near() -> None:
    ground = run([TAKEOFF, at(16, 0, 2, 20, 1), item(114, 10), SHOOT, at(16, 0, 40, 20, 1), LAND])
    (shot,) = ground.vehicle.shots
    assert 29.5 <= shot.pose.position_enu_m[1] <= 30.3


def test_condition_delay_waits_on_the_leg() -> None:
    ground = run([TAKEOFF, at(16, 0, 2, 20, 1), SHOOT, item(112, 3), SHOOT, at(16, 0, 60, 20, 1), LAND])
    first, second = ground.vehicle.shots
    assert second.time_s - first.time_s == pytest.approx(3.0, abs=0.05)


def test_loiter_time_stays_at_its_place() -> None:
    ground = run([TAKEOFF, at(19, 10, 0, 20, 6), SHOOT, at(16, 20, 0, 20, 1), SHOOT, item(93, 1), LAND])
    first, second = ground.vehicle.shots
    assert math.dist(first.pose.position_enu_m, (10, 0, 20)) < 0.3
    reached = {
        each.message.seq: each.time_s for each in ground.heard if type(each.message).__name__.endswith("Reached")
    }
    assert reached[2] - reached[1] >= 6.0 if 1 in reached else second.time_s > first.time_s


def test_items_reached_are_told_for_navigation_conditions_and_some_others_only() -> None:
    items = [
        TAKEOFF,  # 1
        at(16, 5, 0, 20, 2),  # 2
        SHOOT,  # 3
        item(206, 0),  # 4
        item(1000, -10),  # 5
        item(112, 1),  # 6
        item(93, 3),  # 7
        LAND,  # 8
    ]
    ground = run(items)
    assert ground.reached == [1, 2, 6, 7, 8]


def test_take_off_is_not_told_as_reached_where_an_instant_command_follows() -> None:
    ground = run([TAKEOFF, item(178, 1, 5), at(16, 5, 0, 20, 1), LAND])
    assert 1 not in ground.reached
    assert ground.reached[0] == 2


def test_mission_current_shows_navigation_items_only() -> None:
    ground = run([TAKEOFF, mount(), item(115, 90), at(16, 20, 0, 20, 3), SHOOT, item(93, 3), LAND])
    flown = [each.seq for each in ground.of(MissionCurrent)]
    assert set(flown) <= {0, 1, 4, 6, 7}
    assert {4, 6} <= set(flown)


def test_jump_repeats_as_often_as_it_says() -> None:
    items = [TAKEOFF, at(16, 5, 0, 20, 1), SHOOT, at(16, 10, 0, 20, 1), item(177, 2, 2), LAND]
    assert len(run(items).vehicle.shots) == 3


def test_mission_of_a_jump_to_itself_ends() -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, item(177, 2, -1)]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.state.name == "ENDED", 60.0)


def test_command_that_a_copter_cannot_fly_is_skipped_aloud() -> None:
    ground = run([TAKEOFF, at(84, 5, 0, 20), at(16, 10, 0, 20, 1), LAND])
    assert "Skipping invalid cmd #84" in ground.said


def test_change_of_speed_holds_for_the_legs_behind_it() -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, at(16, 1, 0, 20, 1), item(178, 1, 3), at(16, 60, 0, 20, 1), LAND]) == 0
    ground.take_off_with_mission()
    speeds = []
    ground.until(lambda: speeds.append(math.hypot(*ground.frame.velocity[:2])) or not ground.vehicle.modes.is_armed)
    assert max(speeds) == pytest.approx(3.0, abs=0.01)


def test_mission_that_ends_in_the_air_hovers_in_auto() -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, at(16, 10, 0, 20, 1)]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.state.name == "ENDED")
    ground.until(lambda: ground.vehicle.now_s >= 120, 200.0)
    assert ground.vehicle.modes.mode == "AUTO"
    assert ground.vehicle.modes.is_armed
    assert math.dist(ground.frame.position, (10, 0, 20)) < 0.3


def test_starting_at_a_waypoint_leaves_out_the_aiming_before_it() -> None:
    """The trap of resuming after a battery change: photos are taken, and look anywhere."""
    items = [TAKEOFF, mount(-30), item(115, 90), at(16, 10, 0, 20, 3), SHOOT, item(93, 1), LAND]
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload(items) == 0
    assert [ground.command(176, 1, 4), ground.command(400, 1), ground.command(22, 0, 0, 0, 0, 0, 0, 20)] == [0, 0, 0]
    ground.until(lambda: ground.frame.position[2] > 19.9)
    ground.link.send(MissionSetCurrent(1, 1, 4))
    assert ground.wait(MissionCurrent).seq in (0, 4)
    assert ground.command(176, 1, 3) == 0
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    (shot,) = ground.vehicle.shots
    assert (shot.pose.gimbal_pitch_rad, shot.pose.heading_rad) == (0.0, 0.0)


def test_upload_in_flight_changes_what_comes_next() -> None:
    ground = Ground(ARDUPILOT, YAW_KEEP)
    assert ground.upload([TAKEOFF, at(16, 60, 0, 20, 1), at(16, 60, 60, 20, 1), LAND]) == 0
    ground.take_off_with_mission()
    ground.until(lambda: ground.vehicle.scheduler.current == 2)
    assert ground.upload([TAKEOFF, at(16, 0, 60, 20, 1), at(16, 60, -30, 20, 1), LAND]) == 0
    seen = []
    ground.until(lambda: seen.append(ground.frame.position) or not ground.vehicle.modes.is_armed)
    corners = [min(math.dist(place, (x, y, 20)) for place in seen) for x, y in ((60, 0), (60, -30), (0, 60), (60, 60))]
    assert corners[0] < 0.3
    assert corners[1] < 0.3
    assert corners[2] > 10
    assert corners[3] > 10
