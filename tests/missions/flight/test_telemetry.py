"""What messages tell of a flight: the same live and from the telemetry log, and where the camera's angles come from."""

from __future__ import annotations

import math
import struct
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawLog
from missions.flight.logs.telemetry import TelemetryReader, read_tlog
from missions.flight.record import FlightRecord
from missions.mavlink.messages import (
    Address,
    Attitude,
    BatteryStatus,
    CameraFeedback,
    CameraImageCaptured,
    GimbalDeviceAttitudeStatus,
    GlobalPositionInt,
    Heartbeat,
    LocalPositionNed,
    Message,
    MountOrientation,
    MountStatus,
    Received,
    Statustext,
    SysStatus,
    SystemTime,
)
from missions.mavlink.wire import Decoder, Encoder
from missions.simulator.autopilot.instruments import camera_quaternion
from planning.geo.frames import wrap_heading_deg
from tests.missions.flight.log_writers import log_site

SITE = log_site()
LAT_E7, LON_E7 = round(SITE.origin.lat_deg * 1e7), round(SITE.origin.lon_deg * 1e7)

AUTOPILOT, CAMERA, OTHER, STATION = Address(1, 1), Address(1, 100), Address(2, 1), Address(255, 190)
ALIVE = Heartbeat(2, 3, 129, 3, 4)
NOSE_DEG, GIMBAL_DEG, OWN_DEG = (50.0, 0.0), (20.0, -30.0), (-100.0, -60.0)
"""Heading and pitch of the vehicle, of the gimbal, and of what comes with a photo."""

Sent = tuple[float, Address, Message]


def quaternion(heading_deg: float, pitch_deg: float) -> tuple[float, float, float, float]:
    return camera_quaternion(math.radians(heading_deg), math.radians(pitch_deg))


def captured(time_s: float, index: int = 1, east_m: float = 10.0, q_deg: tuple[float, float] = OWN_DEG) -> Message:
    lon_e7 = LON_E7 + round(east_m * 97.0)
    return CameraImageCaptured(
        round(time_s * 1e3), 0, 1, LAT_E7, lon_e7, 62000, 20000, quaternion(*q_deg), index, 1, "a.jpg"
    )


def flight(*, gimbal_s: tuple[float, float] | None = (0.0, 60.0), step_s: float = 0.5) -> list[Sent]:
    """A minute of a flight eastwards, the gimbal heard from and to some time."""
    sent: list[Sent] = []
    for n in range(int(60.0 / step_s)):
        t = n * step_s
        boot_ms = round((10.0 + t) * 1e3)
        sent.append((t, AUTOPILOT, ALIVE))
        place = LAT_E7, LON_E7 + round(t * 97.0), 62000, 20000
        sent.append((t, AUTOPILOT, GlobalPositionInt(boot_ms, *place, 0, 100, 0, 0)))
        sent.append((t, AUTOPILOT, Attitude(boot_ms, 0.0, 0.0, math.radians(NOSE_DEG[0]))))
        if gimbal_s is not None and gimbal_s[0] <= t <= gimbal_s[1]:
            q = quaternion(*GIMBAL_DEG)
            sent.append((t, AUTOPILOT, GimbalDeviceAttitudeStatus(0, 0, boot_ms, 64, q)))
    return sent


def read(sent: list[Sent]) -> RawLog:
    """What a reader makes of messages, each after its time of receipt."""
    reader = TelemetryReader()
    for time_s, source, message in sorted(sent, key=lambda each: each[0]):
        reader.take(Received(message, source, time_s))
    return reader.read()


def record(sent: list[Sent]) -> FlightRecord:
    (found,) = flights_of(read(sent), SITE, "test").records
    return found


def as_frames(sent: list[Sent]) -> list[tuple[float, bytes]]:
    """The same messages as they go through the air, each after its time of receipt."""
    encoders: dict[Address, Encoder] = {}
    return [
        (1.79e9 + time_s, encoders.setdefault(source, Encoder(source)).encode(message))
        for time_s, source, message in sorted(sent, key=lambda each: each[0])
    ]


CHOICES = st.one_of(
    st.builds(Heartbeat, st.sampled_from([2, 6, 26]), st.sampled_from([3, 8, 12]), st.sampled_from([1, 129]),
              st.sampled_from([3, 4, 0x04040000, 99]), st.just(4)),
    st.builds(SystemTime, st.sampled_from([0, 1_790_000_000_000_000]), st.integers(1, 200_000)),
    st.builds(Attitude, st.integers(0, 200_000), st.just(0.0), st.just(0.0), st.just(0.5)),
    st.builds(GlobalPositionInt, st.integers(0, 200_000), st.just(LAT_E7), st.just(LON_E7),
              *[st.integers(-9000, 90000)] * 2, *[st.integers(-300, 300)] * 3, st.just(0)),
    st.builds(SysStatus, *[st.just(0)] * 6, st.integers(-1, 100)),
    st.builds(BatteryStatus, st.integers(0, 1), *[st.just(0)] * 3, st.just((1,) * 10), *[st.just(0)] * 3,
              st.integers(-1, 100)),
    st.builds(GimbalDeviceAttitudeStatus, st.just(0), st.just(0), st.integers(0, 200_000),
              st.sampled_from([0, 12, 44, 64]), st.sampled_from([(1.0, 0.0, 0.0, 0.0), (0.0,) * 4])),
    st.builds(MountStatus, st.just(1), st.just(1), *[st.integers(-9000, 9000)] * 3),
    st.builds(MountOrientation, st.integers(0, 200_000), *[st.just(0.25)] * 4),
    st.builds(Statustext, st.just(6), st.sampled_from(["short", "x" * 50]), st.integers(0, 2), st.just(0)),
    st.builds(CameraFeedback, st.integers(0, 2_000_000_000_000_000), st.just(1), st.just(0), st.integers(0, 5),
              st.just(LAT_E7), st.just(LON_E7), *[st.just(20.0)] * 5),
    st.builds(captured, st.floats(0.0, 200.0), st.integers(0, 5)),
    st.builds(LocalPositionNed, st.integers(0, 200_000), *[st.just(0.0)] * 6),
)  # fmt: skip
STREAMS = st.lists(
    st.tuples(st.integers(0, 300).map(float), st.sampled_from([AUTOPILOT, AUTOPILOT, CAMERA, OTHER, STATION]), CHOICES),
    max_size=60,
)


@pytest.mark.slow
@given(STREAMS)
@settings(max_examples=150)
def test_any_stream_is_the_same_live_and_from_its_telemetry_log(sent: list[Sent]) -> None:
    frames = as_frames([(-1.0, AUTOPILOT, ALIVE), (-0.5, AUTOPILOT, Attitude(1000, 0.0, 0.0, 0.0)), *sent])
    live, decoder = TelemetryReader(), Decoder()
    for time_s, data in frames:
        for frame in decoder.feed(data, time_s):
            assert frame.received is not None
            live.take(frame.received)
    later = read_tlog(b"".join(struct.pack(">Q", round(time_s * 1e6)) + data for time_s, data in frames))
    assert later.vehicle.endswith("telemetry log")
    # By their text, so that NaN is like NaN.
    assert repr(replace(later, vehicle="")) == repr(live.read())


@pytest.mark.parametrize(
    ("gimbal_s", "looks_deg"),
    [
        ((0.0, 60.0), GIMBAL_DEG),
        ((0.0, 29.0), GIMBAL_DEG),
        ((0.0, 20.0), OWN_DEG),
        (None, OWN_DEG),
    ],
    ids=["gimbal heard", "heard a second ago", "lost ten seconds ago", "no gimbal"],
)
def test_a_photo_has_the_gimbals_angles_and_only_without_them_its_own(
    gimbal_s: tuple[float, float] | None, looks_deg: tuple[float, float]
) -> None:
    (photo,) = record([*flight(gimbal_s=gimbal_s), (30.2, AUTOPILOT, captured(40.0))]).photos
    assert photo.time_s == pytest.approx(30.0)
    assert (photo.heading_deg, photo.gimbal_pitch_deg) == pytest.approx(looks_deg, abs=1e-4)
    assert (photo.source, photo.file) == ("image-captured", "a.jpg")


def test_the_angles_of_camera_feedback_are_the_vehicles_and_count_for_nothing() -> None:
    feedback = CameraFeedback(0, 1, 0, 7, LAT_E7, LON_E7, 62.0, 20.0, 5.0, -45.0, 123.0)
    (photo,) = record([*flight(gimbal_s=None), (30.2, AUTOPILOT, feedback)]).photos
    assert photo.heading_deg == pytest.approx(NOSE_DEG[0])
    assert photo.gimbal_pitch_deg is None
    (photo,) = record([*flight(), (30.2, AUTOPILOT, feedback)]).photos
    assert (photo.heading_deg, photo.gimbal_pitch_deg) == pytest.approx(GIMBAL_DEG, abs=1e-4)


def test_of_two_kinds_of_messages_about_each_photo_one_counts() -> None:
    sent = flight()
    for n in range(1, 5):
        t = 10.0 * n
        sent.append((t + 0.1, AUTOPILOT, CameraFeedback(0, 1, 0, n, LAT_E7, LON_E7, 62.0, 20.0, 0.0, 0.0, 0.0)))
        if n != 3:
            sent += [(t + 0.2 * k, AUTOPILOT, captured(10.0 + t, n)) for k in (1, 2)]
    assert [(photo.index, photo.source) for photo in record(sent).photos] == [
        (n, "camera-feedback") for n in range(1, 5)
    ]


def test_a_camera_with_a_clock_of_its_own_does_not_turn_the_vehicles_back() -> None:
    sent = flight()
    sent += [(10.0 * n + 0.1, CAMERA, captured(3.0 + n, n, q_deg=GIMBAL_DEG)) for n in range(1, 5)]
    found = record(sent)
    assert [photo.time_s for photo in found.photos] == pytest.approx([10.0, 20.0, 30.0, 40.0])
    assert "reboot" not in {event.code for event in found.events}
    assert found.track.time_s[-1] == pytest.approx(59.5)


@pytest.mark.parametrize(("source", "time_s"), [(AUTOPILOT, 5.0), (CAMERA, 50.0)])
def test_a_report_that_was_asked_for_again_counts_from_when_it_was_taken_by_the_autopilots_clock(
    source: Address, time_s: float
) -> None:
    (photo,) = record([*flight(), (50.2, source, captured(15.0))]).photos
    assert photo.time_s == pytest.approx(time_s)


UNIX_LESS_BOOT_S = 1_790_000_000.0


def fed_back(taken_s: float, index: int) -> CameraFeedback:
    """A photo of `taken_s` seconds into the flight, with its UNIX time."""
    time_usec = round((UNIX_LESS_BOOT_S + 10.0 + taken_s) * 1e6)
    return CameraFeedback(time_usec, 1, 0, index, LAT_E7, LON_E7, 62.0, 20.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("speed_up", [1.0, 10.0])
@pytest.mark.parametrize("is_told", [True, False], ids=["by SYSTEM_TIME", "by a photo before"])
def test_the_first_message_after_a_link_loss_may_be_a_photo_and_is_not_dated_before_the_gap(
    is_told: bool, speed_up: float
) -> None:
    sent = [each for each in flight() if not 10.0 < each[0] < 55.5]
    if is_told:
        told = SystemTime(round((UNIX_LESS_BOOT_S + 15.0) * 1e6), 15_000)
        sent += [(5.0, AUTOPILOT, told), (6.0, CAMERA, SystemTime(1_000_000_000_000_000, 1))]
    else:
        sent.append((9.1, AUTOPILOT, fed_back(9.0, 1)))
    sent.append((55.2, AUTOPILOT, fed_back(55.0, 2)))
    faster = [(time_s / speed_up, source, message) for time_s, source, message in sent]
    assert record(faster).photos[-1].time_s == pytest.approx(55.0, abs=0.2)


@pytest.mark.parametrize("off_s", [-6.0, 6.0, 3600.0])
def test_a_photo_whose_clock_is_wrong_counts_from_when_it_was_told_of(off_s: float) -> None:
    told = SystemTime(round((UNIX_LESS_BOOT_S + 15.0) * 1e6), 15_000)
    sent = [*flight(), (5.0, AUTOPILOT, told), (30.2, AUTOPILOT, fed_back(30.0 + off_s, 1))]
    assert record(sent).photos[0].time_s == pytest.approx(30.0)


@pytest.mark.parametrize("from_ground_mm", [-1000, 3000])
def test_a_captured_images_height_above_the_ground_below_is_not_taken_for_that_above_home(from_ground_mm: int) -> None:
    message = replace(captured(40.0), relative_alt=from_ground_mm)  # type: ignore[call-arg]
    (photo,) = record([*flight(), (30.2, AUTOPILOT, message)]).photos
    (usual,) = record([*flight(), (30.2, AUTOPILOT, captured(40.0))]).photos
    assert photo.position_enu_m == usual.position_enu_m
    assert photo.position_enu_m[2] == pytest.approx(SITE.home_enu_m[2] + 20.0, abs=0.01)


def test_time_goes_on_when_the_vehicle_is_switched_off_and_on() -> None:
    first, pause_s = flight(), 20.0
    second = [(60.0 + pause_s + t, source, message) for t, source, message in flight()]
    log = read([*first, *second])
    (event,) = [event for event in log.events if event.code == "reboot"]
    assert event.time_s == pytest.approx(10.0 + 60.0 + pause_s)
    assert all(b[0] > a[0] for a, b in zip(log.positions, log.positions[1:], strict=False))


def test_a_photo_that_failed_is_an_event_and_no_photo() -> None:
    failed = replace(captured(40.0, 7), capture_result=0)  # type: ignore[type-var]
    log = read([*flight(), (30.2, AUTOPILOT, failed)])
    assert not log.photos
    (event,) = [event for event in log.events if event.code == "camera-failed"]
    assert "photo 7" in event.text


def test_texts_in_parts_are_one_text() -> None:
    parts = ["PreArm: the compass and the battery are not as they", " should be"]
    assert len(parts[0]) == 51
    parts = [parts[0][:50], parts[0][50:] + parts[1]]
    sent: list[Sent] = [(30.1 + 0.1 * n, AUTOPILOT, Statustext(3, text, 9, n)) for n, text in enumerate(parts)]
    log = read([*flight(), *sent, (31.0, AUTOPILOT, Statustext(6, "short"))])
    assert [event.text for event in log.events if event.code == "text"] == ["".join(parts), "short"]


@pytest.mark.parametrize(
    ("heartbeat", "name"),
    [
        (Heartbeat(2, 3, 129, 3, 4), "AUTO"),
        (Heartbeat(13, 3, 129, 17, 4), "BRAKE"),
        (Heartbeat(2, 3, 129, 77, 4), "mode 77"),
        (Heartbeat(1, 3, 129, 11, 4), "RTL"),
        (Heartbeat(2, 12, 129, 4 << 16 | 4 << 24, 4), "MISSION"),
        (Heartbeat(22, 12, 129, 4 << 16 | 5 << 24, 4), "RTL"),
    ],
    ids=["copter", "hexacopter", "unknown", "plane", "PX4", "PX4, VTOL"],
)
def test_modes_have_the_names_that_the_autopilots_own_logs_give_them(heartbeat: Heartbeat, name: str) -> None:
    log = read(
        [(0.0, AUTOPILOT, heartbeat), (0.1, AUTOPILOT, Attitude(1000, 0.0, 0.0, 0.0)), (1.0, AUTOPILOT, heartbeat)]
    )
    assert [event.text for event in log.events if event.code == "mode"] == [name]


@pytest.mark.parametrize(
    ("flags", "from_north"), [(0, False), (32, False), (64, True), (16, True), (32 | 16, False), (12, False)]
)
def test_the_gimbals_flags_say_from_where_its_yaw_counts(flags: int, from_north: bool) -> None:
    turned = [
        (t, source, replace(message, flags=flags) if isinstance(message, GimbalDeviceAttitudeStatus) else message)
        for t, source, message in flight()
    ]
    (photo,) = record([*turned, (30.2, AUTOPILOT, captured(40.0))]).photos
    assert photo.heading_deg is not None
    expected_deg = GIMBAL_DEG[0] if from_north else NOSE_DEG[0] + GIMBAL_DEG[0]
    assert wrap_heading_deg(photo.heading_deg - expected_deg) == pytest.approx(0.0, abs=1e-4)
