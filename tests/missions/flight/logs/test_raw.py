"""Directions of cameras from quaternions, and what telemetry says of gimbals of every kind."""

from __future__ import annotations

import math
import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.flight.logs.raw import camera_angles_rad
from missions.flight.logs.telemetry import read_tlog


def quaternion(heading: float, pitch: float) -> tuple[float, float, float, float]:
    """Of a camera without roll, to north, east, down: first the pitch, then the heading."""
    cos_h, sin_h, cos_p, sin_p = (f(x / 2.0) for x in (heading, pitch) for f in (math.cos, math.sin))
    return cos_h * cos_p, -sin_h * sin_p, cos_h * sin_p, sin_h * cos_p


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi / 2.0, math.pi / 2.0), st.sampled_from((1.0, -1.0)))
def test_a_direction_comes_back_from_its_quaternion_straight_down_too(
    heading: float, pitch: float, sign: float
) -> None:
    w, x, y, z = quaternion(heading, pitch)
    angles = camera_angles_rad(sign * w, sign * x, sign * y, sign * z)
    assert angles is not None
    assert math.remainder(angles[0] - heading, math.tau) == pytest.approx(0.0, abs=1e-7)
    assert angles[1] == pytest.approx(pitch, abs=1e-7)


@pytest.mark.parametrize("q", [(0.0, 0.0, 0.0, 0.0), (math.nan, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0), (math.inf,) * 4])
def test_what_is_no_rotation_has_no_direction(q: tuple[float, float, float, float]) -> None:
    assert camera_angles_rad(*q) is None


def telemetry(*messages: Any) -> bytes:
    """A log of an ArduPilot vehicle that says these things, a second apart."""
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    sender = mavlink.MAVLink(None, 1, 1)
    heartbeat = mavlink.MAVLink_heartbeat_message(2, 3, 129, 3, 4, 3)
    clock = mavlink.MAVLink_system_time_message(0, 1000)
    frames = [struct.pack(">Q", 1_790_000_000_000_000) + m.pack(sender) for m in (heartbeat, clock, *messages)]
    return b"".join(frames)


@pytest.mark.parametrize(
    ("flags", "is_of_earth"),
    [(44, False), (60, False), (32 + 16, False), (64 + 16, True), (64, True), (16, True), (0, False)],
)
def test_a_gimbals_yaw_is_the_vehicles_or_the_earths_by_its_flags(flags: int, is_of_earth: bool) -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    q = list(quaternion(0.5, -0.7))
    message = mavlink.MAVLink_gimbal_device_attitude_status_message(0, 0, 2000, flags, q, 0.0, 0.0, 0.0, 0)
    log = read_tlog(telemetry(message))
    assert log.gimbal_pitches == [(2.0, pytest.approx(-0.7, abs=1e-6))]
    found, empty = (log.gimbal_headings, log.gimbal_yaws) if is_of_earth else (log.gimbal_yaws, log.gimbal_headings)
    assert found == [(2.0, pytest.approx(0.5, abs=1e-6))]
    assert empty == []


def test_older_mounts_are_understood() -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    status = mavlink.MAVLink_mount_status_message(0, 0, -3000, 0, 1500)
    orientation = mavlink.MAVLink_mount_orientation_message(2000, 0.0, -45.0, 10.0, 100.0)
    log = read_tlog(telemetry(status, orientation))
    assert [math.degrees(pitch) for _, pitch in log.gimbal_pitches] == pytest.approx([-30.0, -45.0])
    assert [math.degrees(yaw) for _, yaw in log.gimbal_yaws] == pytest.approx([15.0])
    assert [math.degrees(heading) for _, heading in log.gimbal_headings] == pytest.approx([100.0])


def test_a_photo_that_the_camera_says_failed_is_no_photo() -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    q = quaternion(math.radians(170.0), -0.2)

    def shot(result: int, lat: int) -> Any:
        return mavlink.MAVLink_camera_image_captured_message(
            2000, 0, 1, lat, 5, 10, 10, list(q), result + 7, result, b""
        )

    log = read_tlog(telemetry(shot(0, 5), shot(1, 2**31 - 1)))
    (photo,) = log.photos
    assert math.isnan(photo.lat_deg)
    assert photo.q_wxyz == pytest.approx(q, abs=1e-6)
    assert [event.code for event in log.events] == ["camera-failed"]


def test_only_one_vehicle_is_read_and_no_ground_station() -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    other = mavlink.MAVLink(None, 7, 1)
    position = mavlink.MAVLink_global_position_int_message(5000, 1, 1, 1, 1, 0, 0, 0, 0)
    content = telemetry() + struct.pack(">Q", 1_790_000_000_000_000) + position.pack(other)
    assert read_tlog(content).positions == []


def test_a_long_text_in_parts_is_one_event() -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    parts = [
        mavlink.MAVLink_statustext_message(4, text.encode(), 9, number)
        for number, text in enumerate(("A" * 50, "B" * 50, "end"))
    ]
    texts = [event.text for event in read_tlog(telemetry(*parts)).events if event.code == "text"]
    assert texts == ["A" * 50 + "B" * 50 + "end"]
