"""Angles of camera and aircraft in one convention, whichever the maker used."""

from __future__ import annotations

import math
from typing import Any

from planning.frames import wrap_heading_deg
from planning.photo_files.maker_xmp import MakerXmp

Angles = tuple[float | None, float | None, float | None]
"""Heading, pitch, roll in degrees; None where a photo does not say."""

NORTH_DEG = 5.0
"""An aircraft whose nose is this close to north may have a gimbal at exactly 0, 0, 0."""

NEAR_NADIR_DEG = 45.0
"""From straight down: where gimbals can swing through, and angles be told as rolled by 180."""

LOCKED = 1e-9
"""Cosine of a pitch that is straight up or down, where heading and roll turn the same way."""


def angles(xmp: MakerXmp, make: str | None) -> dict[str, Any]:
    """Fields of `PhotoMetadata` that are angles."""
    flight = xmp.angle_deg("FlightYawDegree"), xmp.angle_deg("FlightPitchDegree"), xmp.angle_deg("FlightRollDegree")
    gimbal = upright(
        xmp.angle_deg("GimbalYawDegree", "CameraYawDegree", "CameraOrientationNED/Yaw"),
        xmp.angle_deg("GimbalPitchDegree", "CameraPitchDegree", "CameraOrientationNED/Pitch"),
        xmp.angle_deg("GimbalRollDegree", "CameraRollDegree", "CameraOrientationNED/Roll"),
    )
    if gimbal == (None, None, None):
        gimbal = _pix4d_tags(xmp, make)
    heading = flight[0]
    if gimbal == (0.0, 0.0, 0.0) and (heading is None or flight == (0.0, 0.0, 0.0) or abs(heading) > NORTH_DEG):
        gimbal = (None, None, None)  # all zero is what stands there when nothing was recorded
    return {
        "gimbal_heading_deg": gimbal[0],
        "gimbal_pitch_deg": gimbal[1],
        "gimbal_roll_deg": gimbal[2],
        "flight_heading_deg": None if heading is None else wrap_heading_deg(heading),
        "flight_pitch_deg": flight[1],
        "flight_roll_deg": flight[2],
    }


def upright(yaw_deg: float | None, pitch_deg: float | None, roll_deg: float | None) -> Angles:
    """The same orientation with a roll within 90 degrees, where a gimbal swung through the vertical.

    Turning by yaw, pitch and roll is turning by yaw + 180, 180 - pitch and roll + 180. A camera that looks elsewhere
    than down is mounted upside down if it is rolled so: its heading and pitch stand as they are.
    """
    if yaw_deg is None or pitch_deg is None or roll_deg is None:
        return (None if yaw_deg is None else wrap_heading_deg(yaw_deg)), pitch_deg, roll_deg
    roll_deg = wrap_heading_deg(roll_deg)
    if abs(roll_deg) > 90.0 and abs(pitch_deg + 90.0) <= NEAR_NADIR_DEG:
        return wrap_heading_deg(yaw_deg + 180.0), -180.0 - pitch_deg, wrap_heading_deg(roll_deg + 180.0)
    return wrap_heading_deg(yaw_deg), pitch_deg, roll_deg


def _pix4d_tags(xmp: MakerXmp, make: str | None) -> Angles:
    """Angles of Pix4D's camera tags.

    Autel's XL715 writes pitches of its own there, 0 level and negative down. By Pix4D's convention these would look
    backwards below the aircraft, where its gimbal cannot.
    """
    yaw_deg, pitch_deg, roll_deg = xmp.pix4d("Yaw"), xmp.pix4d("Pitch"), xmp.pix4d("Roll")
    if yaw_deg is None or pitch_deg is None:
        return None, None, None
    if pitch_deg < 0.0 and "autel" in (make or "").lower():
        return upright(yaw_deg, pitch_deg, roll_deg)
    return upright(*from_pix4d(yaw_deg, pitch_deg, roll_deg or 0.0))


def from_pix4d(yaw_deg: float, pitch_deg: float, roll_deg: float) -> tuple[float, float, float]:
    """Heading, pitch, roll of a camera given by Pix4D's yaw, pitch and roll ("Yaw, Pitch, Roll angles", Pix4D support).

    Theirs turn a camera that looks straight down, the top of its picture to the north: x of the turned axes is the
    picture's top, y its right, z the line of sight. So their roll tilts the camera sideways, while a gimbal's turns it
    about its line of sight; only with a roll of 0 do the two differ by 90 degrees of pitch alone.
    """
    y, p, r = map(math.radians, (yaw_deg, pitch_deg, roll_deg))
    # Line of sight, and the picture's right and bottom, in north, east, down: R = Rz(yaw) Ry(pitch) Rx(roll).
    forward = (
        math.cos(y) * math.sin(p) * math.cos(r) + math.sin(y) * math.sin(r),
        math.sin(y) * math.sin(p) * math.cos(r) - math.cos(y) * math.sin(r),
    )
    right = (
        math.cos(y) * math.sin(p) * math.sin(r) - math.sin(y) * math.cos(r),
        math.sin(y) * math.sin(p) * math.sin(r) + math.cos(y) * math.cos(r),
    )
    forward_down, right_down, bottom_down = math.cos(p) * math.cos(r), math.cos(p) * math.sin(r), math.sin(p)
    pitch = -math.atan2(forward_down, math.hypot(right_down, bottom_down))
    if math.hypot(*forward) < LOCKED:
        return math.degrees(math.atan2(-right[0], right[1])), math.degrees(pitch), 0.0
    heading, roll = math.atan2(forward[1], forward[0]), math.atan2(right_down, bottom_down)
    return math.degrees(heading), math.degrees(pitch), math.degrees(roll)
