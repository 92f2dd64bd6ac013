from __future__ import annotations

import inspect
import pickle
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path

import pytest

from missions.mavlink import messages
from missions.mavlink.records import MESSAGES, layout

STUB = Path(inspect.getfile(messages)).with_suffix(".pyi")
HEAD = """# Written by `python -m tests.missions.mavlink.test_messages` from pymavlink's dialect.

from dataclasses import dataclass

from missions.mavlink.records import Address as Address
from missions.mavlink.records import Message as Message
from missions.mavlink.records import Received as Received
"""


def stub() -> str:
    """`messages.pyi`: the records with the types of their fields, and units or enums beside them."""
    lines = []
    for name in MESSAGES:
        told = layout(name)
        lines += ["", f"# {told.packet.msgname} ({told.packet.id}). {NOTES.get(name, '')}".rstrip()]
        lines += ["@dataclass(frozen=True, slots=True)", f"class {name}(Message):"]
        for each in told.fields:
            value = "" if each.default is MISSING else " = ..."
            lines.append(f"    {each.name}: {each.annotation}{value}" + (f"  # {each.unit}" if each.unit else ""))
    return HEAD + "\n".join(lines) + "\n"


def test_type_checkers_read_what_the_dialect_says() -> None:
    assert STUB.read_text() == stub()


@pytest.mark.parametrize("name", MESSAGES)
def test_record_has_all_fields_of_its_message_and_may_lack_what_mavlink_2_added(name: str) -> None:
    told = layout(name)
    record = getattr(messages, name)
    assert record is told.record
    assert {each.name for each in fields(record)} == set(told.packet.fieldnames)
    required = {each.name for each in fields(record) if each.default is MISSING}
    assert not required & {each.name for each in told.fields if each.is_extension}


def test_records_travel_between_processes() -> None:
    message = messages.MissionAck(1, 1, 0)
    assert pickle.loads(pickle.dumps(message)) == message


def test_a_message_that_is_not_used_is_no_record() -> None:
    with pytest.raises(AttributeError, match="no MAVLink message Dragon is used here"):
        messages.Dragon  # type: ignore[attr-defined]  # noqa: B018


NOTES: Mapping[str, str] = {
    "Statustext": "`severity` 0 emergency to 7 debug; longer texts come in chunks with one `id`.",
    "RadioStatus": "Made by a telemetry radio itself: signal and noise at both ends, buffer left in percent.",
    "SetupSigning": "Gives the vehicle a key of 32 bytes; all zero ends signing.",
    "CommandAck": "`result` is a MAV_RESULT; `progress` in percent while it is IN_PROGRESS.",
    "ParamRequestRead": "`param_index` -1: by name.",
    "ParamSet": "PX4 puts the bytes of an integer into the float, ArduPilot its value.",
    "RequestDataStream": "ArduPilot still knows it.",
    "MissionRequest": "Deprecated; ArduPilot still asks with it.",
    "MissionItemInt": "`x`, `y` are 1e-7 degrees where the command has a position, raw numbers where not.",
    "MissionItem": "Deprecated: float positions, off by up to a metre.",
    "MissionAck": "`type` is a MAV_MISSION_RESULT.",
    "MissionWritePartialList": "A part of the list will be written anew.",
    "MissionChanged": "Deprecated: the vehicle says that a list was changed, and by whom.",
    "MissionCurrent": "`total` 65535: no mission, 0: not told; the numbers of the lists are 0 where not told.",
    "FileTransferProtocol": "`payload` is MAVFTP's own frame (`ftp.py`).",
    "OpenDroneIdSystem": "Heights above the ellipsoid; `timestamp` counts seconds from 2019.",
    "OpenDroneIdArmStatus": "`status` 0: content; `error` says what is missing.",
    "GpsRtcmData": "`flags`: bit 0 fragmented, bits 1 and 2 which fragment, bits 3 to 7 which message.",
    "GlobalPositionInt": "`alt` is above mean sea level.",
    "Attitude": "Yaw is clockwise from north.",
    "GpsRawInt": "`fix_type` 3 is 3-D, 4 DGPS, 5 RTK float, 6 RTK fixed.",
    "HomePosition": "`altitude` is above mean sea level.",
    "ExtendedSysState": "`landed_state` 1 on the ground, 2 in the air, 3 taking off, 4 landing.",
    "SysStatus": "-1 where it is not known.",
    "BatteryStatus": "`voltages` of each cell or, in the first, of all.",
    "EkfStatusReport": "ArduPilot's.",
    "EstimatorStatus": "PX4's.",
    "Wind": "ArduPilot's: where the wind comes from.",
    "WindCov": "PX4's: towards north, east, down.",
    "CameraFeedback": "ArduPilot's: the attitude is the vehicle's, never the gimbal's.",
    "CameraCaptureStatus": "`image_count` is the number of photos ever taken.",
    "CameraImageCaptured": "`q` turns from the camera's axes to north, east, down; w first.",
    "GimbalDeviceAttitudeStatus": "`q` w first; its yaw is the vehicle's or the earth's by `flags`.",
    "MountStatus": "Of older ArduPilots: 0.01 degrees, `pointing_a` pitch, `pointing_c` yaw from the nose.",
    "MountOrientation": "Of older PX4s: `yaw` counts from the nose, `yaw_absolute` from north.",
}
"""What autopilots make of a message, which its XML does not say."""


if __name__ == "__main__":
    STUB.write_text(stub())
