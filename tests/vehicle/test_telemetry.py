"""What is known of a vehicle from its messages."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.vehicle.state import LINK_LOST_S, Landed, VehicleState
from groundstation.vehicle.telemetry import LocalFrame, updated_state
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Address,
    Attitude,
    BatteryStatus,
    CameraFeedback,
    CameraImageCaptured,
    EkfStatusReport,
    EstimatorStatus,
    ExtendedSysState,
    GimbalDeviceAttitudeStatus,
    GlobalPositionInt,
    GpsRawInt,
    Heartbeat,
    HomePosition,
    MissionCurrent,
    MissionItemReached,
    Received,
    Statustext,
    SysStatus,
    SystemTime,
    Wind,
    WindCov,
)
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin

ORIGIN = Origin(22.3372, 114.2636, 62.0)
HOME = (10.0, -20.0, 1.5)
FRAME = LocalFrame.of_home(ORIGIN, HOME)
VEHICLE = Address(1, 1)
QUADROTOR, ARDUPILOT, PX4 = 2, 3, 12


NOTHING = VehicleState()


def heard(*messages, state=NOTHING, time_s=10.0, source=VEHICLE):
    for message in messages:
        state = updated_state(state, Received(message, source, time_s), FRAME)
    return state


def heartbeat(autopilot=ARDUPILOT, base_mode=0, custom_mode=0):
    return Heartbeat(QUADROTOR, autopilot, base_mode, custom_mode, 3)


def connected(**changes):
    return replace(heard(heartbeat()), **changes)


def e7(point_enu_m):
    lat, lon, _ = geodetic_from_enu(ORIGIN, [point_enu_m])
    return round(lat[0] * 1e7), round(lon[0] * 1e7)


def gimbal_quaternion(yaw, pitch):
    c, s = math.cos, math.sin
    return (c(yaw / 2) * c(pitch / 2), -s(yaw / 2) * s(pitch / 2), c(yaw / 2) * s(pitch / 2), s(yaw / 2) * c(pitch / 2))


def test_nothing_is_known_before_a_heartbeat():
    assert heard(Attitude(0, 0.1, 0.2, 0.3)) == VehicleState()


def test_the_heartbeat_tells_autopilot_mode_and_arming():
    state = heard(heartbeat(ARDUPILOT, 128, 3))
    assert (state.autopilot, state.mode.value, state.is_armed) == (Autopilot.ARDUPILOT, "AUTO", True)
    state = heard(heartbeat(PX4, 0, 4 << 16 | 4 << 24))
    assert (state.autopilot, state.mode.value, state.is_armed) == (Autopilot.PX4, "AUTO.MISSION", False)


def test_a_mode_that_is_not_known_is_shown_by_its_number():
    assert heard(heartbeat(ARDUPILOT, 0, 99)).mode.value == "mode 99"
    assert heard(heartbeat(PX4, 0, 9 << 16)).mode.value == "mode 9.0"


@pytest.mark.parametrize(
    ("message", "source"),
    [
        (Heartbeat(6, 8, 0, 0, 4), Address(255, 190)),
        (Heartbeat(26, 8, 0, 0, 4), Address(1, 154)),
        (Heartbeat(QUADROTOR, ARDUPILOT, 0, 0, 4), Address(1, 100)),
        (Heartbeat(QUADROTOR, 0, 0, 0, 4), VEHICLE),
    ],
    ids=["ground station", "gimbal", "camera", "other autopilot"],
)
def test_only_an_autopilot_we_know_is_a_vehicle(message, source):
    assert heard(message, source=source) == VehicleState()


def test_a_second_vehicle_on_the_link_changes_nothing_but_is_known_of():
    first = connected()
    both = heard(heartbeat(PX4), Attitude(0, 1, 1, 1), state=first, source=Address(2, 1))
    assert both == replace(first, others=frozenset({2}))


def test_the_link_is_alive_until_heartbeats_stay_away():
    state = heard(heartbeat(), time_s=10.0)
    assert state.is_link_alive(10.0 + LINK_LOST_S)
    assert not state.is_link_alive(10.1 + LINK_LOST_S)
    assert not VehicleState().is_link_alive(0.0)
    assert state.mode.age_s(12.0) == 2.0


@given(st.tuples(*(st.floats(-2000.0, 2000.0),) * 2, st.floats(-20.0, 300.0)))
def test_positions_are_exact_to_the_message(place):
    lat, lon = e7(place)
    height = geodetic_from_enu(ORIGIN, [place]).ellipsoid_height_m[0]
    above_mm = round(1000.0 * (height - FRAME.home_height_ellipsoid_m))
    state = heard(GlobalPositionInt(1000, lat, lon, 0, above_mm, 100, 200, -300, 0), state=connected())
    assert math.dist(state.motion.value.position_enu_m, place) < 0.02
    assert state.motion.value.velocity_enu_m_s == (2.0, 1.0, 3.0)
    assert state.boot_time_s == 1.0


@pytest.mark.parametrize(("lat", "lon"), [(0, 0), (910_000_000, 0), (0, 1_900_000_000)])
def test_a_position_that_is_none_is_passed_over(lat, lon):
    assert heard(GlobalPositionInt(0, lat, lon, 0, 0, 0, 0, 0, 0), state=connected()).motion is None
    assert heard(HomePosition(lat, lon, 0), state=connected()).home_enu_m is None
    assert heard(CameraFeedback(0, 0, 0, 1, lat, lon, 0, 0, 0, 0, 0), state=connected()).photos == ()


def test_home_is_told_in_the_sites_frame():
    state = heard(HomePosition(*e7(HOME), 0), state=connected())
    assert math.dist(state.home_enu_m.value, HOME) < 0.02


@pytest.mark.parametrize(
    ("flags", "expected_deg"),
    [(44, 120.0), (60, 120.0), (76, 30.0), (28, 30.0), (12, 120.0)],
    ids=["vehicle", "lock, yet vehicle", "earth", "lock", "neither"],
)
def test_the_gimbals_yaw_counts_from_where_its_flags_say(flags, expected_deg):
    nose = Attitude(0, 0.0, 0.0, math.radians(90.0))
    gimbal = GimbalDeviceAttitudeStatus(0, 0, 0, flags, gimbal_quaternion(math.radians(30.0), math.radians(-45.0)))
    state = heard(nose, gimbal, state=connected())
    assert math.degrees(state.camera.value.heading_rad) == pytest.approx(expected_deg)
    assert math.degrees(state.camera.value.pitch_rad) == pytest.approx(-45.0)


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi / 2, math.pi / 2))
def test_camera_angles_survive_at_every_pitch(yaw, pitch):
    gimbal = GimbalDeviceAttitudeStatus(0, 0, 0, 76, gimbal_quaternion(yaw, pitch))
    camera = heard(gimbal, state=connected()).camera.value
    assert camera.pitch_rad == pytest.approx(pitch, abs=1e-6)
    assert math.remainder(camera.heading_rad - yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("q", [(math.nan,) * 4, (0.0,) * 4])
def test_a_quaternion_that_is_none_is_passed_over(q):
    assert heard(GimbalDeviceAttitudeStatus(0, 0, 0, 76, q), state=connected()).camera is None


def test_without_the_nose_a_gimbal_that_counts_from_it_says_nothing():
    assert heard(GimbalDeviceAttitudeStatus(0, 0, 0, 44, (1, 0, 0, 0)), state=connected()).camera is None


def test_gnss_accuracies_that_are_not_told_are_not_zero():
    state = heard(GpsRawInt(0, 6, 1, 1, 0, 0, 0, 0, 0, 17, 0, 14, 0), state=connected())
    fix = state.fix.value
    assert (fix.fix_type, fix.n_satellites, fix.horizontal_accuracy_m, fix.vertical_accuracy_m) == (6, 17, 0.014, None)


def test_the_battery_is_known_as_far_as_it_is_told():
    state = heard(SysStatus(0, 0, 0, 0, 15200, 1250, 63), state=connected())
    assert (state.battery.value.remaining, state.battery.value.voltage_v, state.battery.value.current_a) == (
        0.63,
        15.2,
        12.5,
    )
    state = heard(SysStatus(0, 0, 0, 0, 0xFFFF, -1, -1), state=connected())
    assert (state.battery.value.remaining, state.battery.value.voltage_v) == (None, None)
    cells = (3800, 3810, 3790, 3800) + (0xFFFF,) * 6
    state = heard(BatteryStatus(0, 0, 0, 0, cells, 500, 420, -1, 88), state=connected())
    assert (state.battery.value.remaining, state.battery.value.voltage_v) == (0.88, pytest.approx(15.2))
    assert state.battery.value.consumed_mah == 420.0
    assert heard(BatteryStatus(1, 0, 0, 0, cells, 500, 420, -1, 5), state=state) == state


def test_sensors_that_are_not_healthy_are_named_only_where_they_are_in_use():
    gnss_and_log = 1 << 5 | 1 << 24
    state = heard(SysStatus(gnss_and_log, 1 << 5, 0, 0, 0, 0, 0), state=connected())
    assert state.sensor_problems.value == ("GNSS",)


def test_both_winds_blow_towards_the_same_side():
    from_west = heard(Wind(270.0, 5.0, 0.0), state=connected())
    to_east = heard(WindCov(0, 0.0, 5.0, math.nan, 0, 0, 0, 0, 0), state=connected())
    assert from_west.wind_enu_m_s.value == pytest.approx((5.0, 0.0, 0.0))
    assert to_east.wind_enu_m_s.value == (5.0, 0.0, 0.0)


def test_both_estimators_say_what_they_lack():
    good = 1 | 2 | 4 | 8 | 16 | 32
    for flags, problem in ((good, ""), (good & ~16, "no position yet"), (good & ~32, "no height yet")):
        ekf = heard(EkfStatusReport(flags, 0.1, 0.1, 0.1, 0.1, 0.0), state=connected())
        px4 = heard(EstimatorStatus(0, flags, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1.0, 1.0), state=connected())
        assert ekf.estimator.value.problem == px4.estimator.value.problem == problem
    # PX4 says of every aircraft that stands still that its position is taken as constant, however well it is known.
    assert heard(EkfStatusReport(good | 128, 0.1, 0.1, 0.1, 0.1, 0.0), state=connected()).estimator.value.problem
    px4 = heard(EstimatorStatus(0, 1023, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1.0, 1.0), state=connected())
    assert px4.estimator.value.problem == ""
    torn = heard(EkfStatusReport(good, 0.1, 0.9, 0.1, 0.1, 0.0), state=connected())
    assert "contradict" in torn.estimator.value.problem


def test_without_a_mission_none_is_counted():
    some = heard(MissionCurrent(3, 230, 3, 1), state=connected())
    assert heard(MissionCurrent(65535, 65535, 1, 2), state=some).mission.value.lists == (65535, 0, 0, 0)


def test_a_photos_height_counts_from_home_and_not_from_the_ground_below():
    """PX4 says a relative height of -1 m where it does not know the ground, and else the height above that."""
    (lat, lon), home_amsl_mm = e7((1.0, 2.0, 3.0)), 63_500
    taken = CameraImageCaptured(2000, 0, 1, lat, lon, home_amsl_mm + 21_500, -1000, (1, 0, 0, 0), 0, 1)
    before = heard(GlobalPositionInt(1900, lat, lon, home_amsl_mm + 21_000, 21_000, 0, 0, 0, 0), state=connected())
    (photo,) = heard(taken, state=before).photos
    assert photo.position_enu_m == pytest.approx((1.0, 2.0, HOME[2] + 21.5), abs=0.02)


def test_progress_keeps_the_item_that_was_reached():
    state = heard(MissionCurrent(4, 30), MissionItemReached(4), MissionCurrent(7, 30), state=connected())
    progress = state.mission.value
    assert (progress.current, progress.lists, progress.reached) == (7, (30, 0, 0, 0), 4)


def test_long_texts_are_put_together():
    state = heard(Statustext(4, "a" * 50, 7, 0), Statustext(4, "b", 7, 1), Statustext(6, "next"), state=connected())
    assert [text.text for text in state.texts] == ["a" * 50 + "b", "next"]


def test_landed_states_have_names():
    assert heard(ExtendedSysState(0, 1), state=connected()).landed.value is Landed.ON_GROUND
    assert heard(ExtendedSysState(0, 77), state=connected()).landed.value is Landed.UNKNOWN


def feedback(index, place, time_usec=0):
    return CameraFeedback(time_usec, 0, 0, index, *e7(place), 0.0, 30.0, 5.0, 6.0, 77.0)


def test_a_photo_takes_the_cameras_angles_never_the_vehicles():
    gimbal = GimbalDeviceAttitudeStatus(0, 0, 0, 76, gimbal_quaternion(math.radians(-170.0), math.radians(-20.0)))
    state = heard(gimbal, feedback(1, (1.0, 2.0, 3.0)), state=connected())
    (photo,) = state.photos
    assert (photo.heading_deg, photo.gimbal_pitch_deg) == (pytest.approx(-170.0), pytest.approx(-20.0))
    assert photo.source == "camera-feedback"


def test_a_photo_without_recent_gimbal_angles_has_none():
    gimbal = GimbalDeviceAttitudeStatus(0, 0, 0, 76, (1, 0, 0, 0))
    state = heard(gimbal, state=connected(), time_s=10.0)
    (photo,) = heard(feedback(1, (1.0, 2.0, 3.0)), state=state, time_s=20.0).photos
    assert (photo.heading_deg, photo.gimbal_pitch_deg) == (None, None)


UNIX_LESS_BOOT_S = 1_790_000_000.0


@pytest.mark.parametrize("is_told", [True, False], ids=["by SYSTEM_TIME", "by a photo before"])
def test_the_first_message_after_a_link_loss_may_be_a_photo_and_is_not_dated_before_the_gap(is_told):
    unix_usec = round((UNIX_LESS_BOOT_S + 30.0) * 1e6)
    state = heard(Attitude(30_000, 0.0, 0.0, 1.0), state=connected(), time_s=10.0)
    place = GlobalPositionInt(30_000, *e7(HOME), 0, 0, 500, 0, 0, 0)
    state = heard(place, SystemTime(unix_usec, 30_000) if is_told else feedback(1, HOME, unix_usec), state=state)
    another_clock = heard(SystemTime(unix_usec, 1), state=state, source=Address(1, 191))
    state = heard(feedback(2, HOME, unix_usec + 45_000_000), state=another_clock, time_s=55.0)
    photo = state.photos[-1]
    assert (photo.index, photo.time_s) == (2, pytest.approx(75.0))
    assert photo.speed_m_s is None


def test_a_vehicle_that_was_restarted_tells_its_clock_anew():
    unix_usec = round((UNIX_LESS_BOOT_S + 30.0) * 1e6)
    state = heard(SystemTime(unix_usec, 30_000), Attitude(1_000, 0.0, 0.0, 1.0), state=connected())
    (photo,) = heard(feedback(1, HOME, unix_usec + 4_000_000), state=state, time_s=12.0).photos
    assert photo.time_s == 1.0


def test_a_photo_that_is_reported_twice_counts_once_and_one_of_a_restarted_camera_counts():
    state = heard(feedback(1, (1, 2, 3)), feedback(1, (1, 2, 3)), feedback(1, (9, 2, 3)), state=connected())
    assert len(state.photos) == 2


def test_a_capture_that_failed_is_no_photo():
    lat, lon = e7((1.0, 2.0, 3.0))
    failed = CameraImageCaptured(2000, 0, 0, lat, lon, 0, 30_000, (1, 0, 0, 0), 1, 0)
    taken = replace(failed, capture_result=1)
    assert heard(failed, state=connected()).photos == ()
    (photo,) = heard(taken, state=connected()).photos
    assert (photo.time_s, photo.source) == (2.0, "image-captured")


@given(st.integers(-(2**31), 2**31 - 1), st.integers(-(2**31), 2**31 - 1), st.floats(), st.floats())
def test_no_damaged_message_ends_telemetry(a, b, x, y):
    state = connected()
    for message in (
        GlobalPositionInt(0, a, b, a, b, 0, 0, 0, 0),
        Attitude(0, x, y, x),
        Wind(x, y, x),
        GimbalDeviceAttitudeStatus(0, 0, 0, a & 0xFFFF, (x, y, x, y)),
        CameraFeedback(0, 0, 0, 1, a, b, 0.0, 20.0, x, y, x),
        EkfStatusReport(a & 0xFFFF, x, y, x, y, x),
    ):
        state = heard(message, state=state)
    if state.motion is not None:
        assert all(map(math.isfinite, state.motion.value.position_enu_m))
    if state.wind_enu_m_s is not None:
        assert all(map(math.isfinite, state.wind_enu_m_s.value))
