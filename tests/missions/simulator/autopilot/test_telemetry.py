"""What the vehicle tells of itself, of its camera and of its gimbal."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from missions.mavlink.messages import (
    Attitude,
    BatteryStatus,
    CameraFeedback,
    EkfStatusReport,
    EstimatorStatus,
    GimbalDeviceAttitudeStatus,
    GlobalPositionInt,
    GpsRawInt,
    HomePosition,
    LocalPositionNed,
    RequestDataStream,
    SysStatus,
    Timesync,
    Wind,
    WindCov,
)
from missions.mission.model import GeoPoint, altitude_amsl_m
from missions.simulator.airframe.state import Fix
from missions.simulator.vehicle import UNIX_START_S
from tests.missions.simulator.ground import ARDUPILOT, ORIGIN, PX4, Ground, PointMass, at, item

SHOOT = item(203, 0, 0, 0, 0, 1)


class Leaning(PointMass):
    """Leans, and tilts its camera elsewhere than told."""

    @property
    def truth(self):
        return replace(super().truth, pitch_rad=0.1, roll_rad=-0.05, gimbal_pitch_rad=-0.5)

    estimate = truth


def quaternion_pitch_yaw_deg(q) -> tuple[float, float]:
    w, x, y, z = q
    pitch = math.asin(2 * (w * y - z * x))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return math.degrees(pitch), math.degrees(yaw)


def test_camera_feedback_holds_the_vehicles_attitude_never_the_gimbals() -> None:
    ground = Ground(airframe=Leaning(heading_rad=math.radians(-30)), parameters={"WP_YAW_BEHAVIOR": 0})
    ground.fly(
        [at(22, 0, 0, 20), item(205, -45), item(115, 330), at(16, 5, 0, 20, 4), SHOOT, item(93, 1), at(21, 0, 0, 0)]
    )
    (told,) = ground.of(CameraFeedback)
    assert told.pitch == pytest.approx(math.degrees(0.1))
    assert told.roll == pytest.approx(math.degrees(-0.05))
    assert told.yaw == pytest.approx(330.0, abs=0.1)
    assert (told.img_idx, told.flags, told.completed_captures) == (1, 0, 0)
    assert told.alt_rel == pytest.approx(20.0, abs=0.02)
    assert told.alt_msl == pytest.approx(altitude_amsl_m(GeoPoint(ORIGIN.lat_deg, ORIGIN.lon_deg, 82.0)), abs=0.02)
    assert told.lat == pytest.approx(at(16, 5, 0, 20).x, abs=3)


def test_photo_times_are_unix_time_plus_simulated_time() -> None:
    ground = Ground(parameters={"WP_YAW_BEHAVIOR": 0})
    ground.fly([at(22, 0, 0, 20), at(16, 5, 0, 20, 2), SHOOT, item(93, 2), SHOOT, item(93, 1), at(21, 0, 0, 0)])
    first, second = ground.of(CameraFeedback)
    assert second.time_usec - first.time_usec == pytest.approx(2e6, abs=3e4)
    shot = ground.vehicle.shots[0]
    assert first.time_usec == pytest.approx((UNIX_START_S + shot.time_s) * 1e6, abs=2)
    assert (first.img_idx, second.img_idx) == (1, 2)


def test_servo_gimbal_reports_where_it_was_sent_and_others_where_they_stand() -> None:
    for mount_type, pitch in ((1, -40.0), (4, math.degrees(-0.5))):
        ground = Ground(airframe=Leaning(), parameters={"MNT1_TYPE": mount_type})
        ground.command(205, -40)
        told = ground.wait(GimbalDeviceAttitudeStatus)
        assert quaternion_pitch_yaw_deg(told.q)[0] == pytest.approx(pitch, abs=1e-6)
        assert told.flags == 44
    ground = Ground(parameters={"MNT1_TYPE": 0})
    ground.until(lambda: ground.vehicle.now_s > 44)
    assert ground.of(GimbalDeviceAttitudeStatus) == []


def test_gimbal_locked_to_earth_still_reports_its_yaw_against_the_nose() -> None:
    """Set to +30 with lock, vehicle at 90: flags 60, reported -60."""
    ground = Ground(airframe=PointMass(heading_rad=math.radians(90)), parameters={"SERVO10_FUNCTION": 6})
    ground.command(1000, -10, 30, 0, 0, 16)
    told = ground.wait(GimbalDeviceAttitudeStatus)
    assert told.flags == 60
    assert quaternion_pitch_yaw_deg(told.q) == pytest.approx((-10.0, -60.0), abs=1e-6)


def test_positions_and_heights_agree_with_each_other() -> None:
    ground = Ground(airframe=PointMass(home=(30.0, -40.0, 1.5), heading_rad=1.0))
    place, gps = ground.wait(GlobalPositionInt), ground.wait(GpsRawInt)
    home, local = ground.wait(HomePosition, 10.0), ground.wait(LocalPositionNed)
    there = at(16, 30.0, -40.0, 1.5)
    assert (place.lat, place.lon) == (there.x, there.y) == (home.latitude, home.longitude)
    assert place.relative_alt == 0
    assert (place.alt, gps.alt) == (home.altitude, home.altitude)
    assert gps.alt_ellipsoid == pytest.approx(63_500, abs=1)
    assert place.hdg == pytest.approx(math.degrees(1.0) * 100, abs=1)
    assert (local.x, local.y, local.z) == (0.0, 0.0, 0.0)
    assert ground.wait(Attitude).yaw == 1.0


def test_velocities_are_north_east_down() -> None:
    ground = Ground(parameters={"WP_YAW_BEHAVIOR": 0})
    ground.upload([at(22, 0, 0, 20), at(16, 200, 100, 60, 1), item(93, 1), at(21, 0, 0, 0)])
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > 50)
    ground.heard.clear()
    told = ground.wait(GlobalPositionInt)
    vx, vy, vz = ground.frame.velocity
    assert (told.vx, told.vy, told.vz) == pytest.approx((vy * 100, vx * 100, -vz * 100), abs=1)
    local = ground.wait(LocalPositionNed)
    assert (local.x, local.y, -local.z) == pytest.approx([ground.frame.position[i] for i in (1, 0, 2)], abs=5.0)


def test_without_position_estimate_no_position_is_told() -> None:
    ground = Ground(is_ready=False)
    ground.until(lambda: ground.vehicle.now_s > 30)
    assert ground.of(GlobalPositionInt) == ground.of(HomePosition) == ground.of(LocalPositionNed) == []
    assert ground.of(EkfStatusReport)[0].flags & 16 == 0
    assert (
        ground.of(SysStatus)[0].onboard_control_sensors_health
        != ground.of(SysStatus)[0].onboard_control_sensors_enabled
    )
    ground.until(lambda: ground.vehicle.now_s > 44)
    assert ground.of(GlobalPositionInt)
    assert ground.of(EkfStatusReport)[-1].flags & 16


def test_receiver_wind_and_battery_are_told_as_the_airframe_has_them() -> None:
    ground, px4 = Ground(), Ground(PX4)
    for each in (ground, px4):
        each.frame.fix = Fix(5, 14, 0.35, 0.6)
        each.frame.wind_enu_m_s = (3.0, -4.0, 0.0)
        each.frame.remaining = 0.405
    gps = ground.wait(GpsRawInt)
    assert (gps.fix_type, gps.satellites_visible, gps.h_acc, gps.v_acc) == (5, 14, 350, 600)
    wind = ground.wait(Wind)
    # Wind towards the south-east comes from the north-west.
    assert wind.speed == 5.0
    assert wind.direction == pytest.approx(math.degrees(math.atan2(-3.0, 4.0)))
    assert (px4.wait(WindCov).wind_x, px4.of(WindCov)[0].wind_y) == (-4.0, 3.0)
    assert px4.wait(EstimatorStatus).pos_horiz_accuracy == 0.35
    battery = ground.wait(BatteryStatus)
    assert (battery.battery_remaining, battery.voltages[:2]) == (40, (15200, 65535))
    assert ground.wait(SysStatus).battery_remaining == 40


def test_streams_are_set_the_old_way_on_ardupilot_only() -> None:
    for autopilot, n_expected in ((ARDUPILOT, 100), (PX4, 40)):
        ground = Ground(autopilot)
        ground.link.send(RequestDataStream(1, 1, 10, 10, 1))
        start_s = ground.vehicle.now_s
        ground.until(lambda start_s=start_s, ground=ground: ground.vehicle.now_s >= start_s + 10.0)
        assert len(ground.of(Attitude)) == pytest.approx(n_expected, abs=2)


def test_time_is_told_to_who_asks() -> None:
    ground = Ground()
    ground.link.send(Timesync(0, 123456))
    assert ground.wait(Timesync) == Timesync(42_000_000_000, 123456)
