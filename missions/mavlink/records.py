"""Records of MAVLink's messages, made from pymavlink's ardupilotmega dialect: frozen, typed, and without any link.

`MESSAGES` names the messages that are used here; a record is made when it is first asked for. Names and scales of its
fields are those of MAVLink's XML (`common.xml`, `ardupilotmega.xml`). First come fields that must be given, then those
that `MESSAGES` gives a value, then those that MAVLink 2 added later. `messages.pyi` says the same to type checkers and
readers; `python -m tests.missions.mavlink.test_messages` writes it anew.
"""

from __future__ import annotations

import inspect
import math
import re
import struct
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, make_dataclass
from functools import cache
from typing import Any, cast

from pymavlink.dialects.v20 import ardupilotmega as dialect


@dataclass(frozen=True, slots=True)
class Message:
    """Any of MAVLink's messages."""


@dataclass(frozen=True, slots=True)
class Address:
    """System and component of a sender or receiver; 0 is everybody."""

    system: int
    component: int


@dataclass(frozen=True, slots=True)
class Received:
    """A message as it came in.

    Parameters
    ----------
    time_s
        By the receiver's clock.
    """

    message: Message
    source: Address
    time_s: float


def _zeros(names: str, kind: float | str = 0) -> dict[str, Any]:
    return dict.fromkeys(names.split(), kind)


_PARAMS = _zeros("param1 param2 param3 param4 param5 param6 param7", 0.0)
_PARAMS_INT = _zeros("param1 param2 param3 param4", 0.0) | {"x": 0, "y": 0, "z": 0.0}
_VERSIONS = "flight_sw_version vendor_id product_id middleware_sw_version os_sw_version board_version uid"
_CUSTOM_VERSIONS = dict.fromkeys(("flight_custom_version", "middleware_custom_version", "os_custom_version"), (0,) * 8)
_LISTS = "total mission_state mission_mode mission_id fence_id rally_points_id"
_TURNING = _zeros("angular_velocity_x angular_velocity_y angular_velocity_z", math.nan)

MESSAGES: Mapping[str, Mapping[str, Any]] = {
    # Who is there
    "Heartbeat": {"mavlink_version": 3},
    "AutopilotVersion": _zeros(_VERSIONS) | _CUSTOM_VERSIONS,
    "Statustext": {},
    "SystemTime": {},
    "Timesync": {},
    "RadioStatus": {},
    "SetupSigning": {},
    # Commands and parameters
    "CommandLong": _PARAMS | {"confirmation": 0},
    "CommandInt": {"frame": 0} | _PARAMS_INT | _zeros("current autocontinue"),
    "CommandAck": {},
    "SetMode": {},
    "ParamRequestRead": {"param_index": -1},
    "ParamRequestList": {},
    "ParamSet": {},
    "ParamValue": {},
    "RequestDataStream": {},
    # Missions, fences, rally points
    "MissionCount": {},
    "MissionRequestList": {},
    "MissionRequest": {},
    "MissionRequestInt": {},
    "MissionItemInt": {},
    "MissionItem": {},
    "MissionAck": {},
    "MissionClearAll": {},
    "MissionWritePartialList": {},
    "MissionChanged": {"mission_type": 0},
    "MissionCurrent": _zeros(_LISTS),
    "MissionItemReached": {},
    "MissionSetCurrent": {},
    # Files on the vehicle
    "FileTransferProtocol": {"target_network": 0},
    "LogRequestList": {},
    "LogEntry": {},
    "LogRequestData": {},
    "LogData": {},
    "LogRequestEnd": {},
    # Remote identification, and corrections for the receiver
    "OpenDroneIdBasicId": {},
    "OpenDroneIdSelfId": {},
    "OpenDroneIdSystem": {},
    "OpenDroneIdOperatorId": {},
    "OpenDroneIdArmStatus": {},
    "GpsRtcmData": {},
    # Where it is and how it does
    "GlobalPositionInt": {},
    "LocalPositionNed": {},
    "Attitude": _zeros("rollspeed pitchspeed yawspeed", 0.0),
    "GpsRawInt": {},
    "HomePosition": _zeros("x y z", 0.0) | {"q": (math.nan,) * 4} | _zeros("approach_x approach_y approach_z", 0.0),
    "VfrHud": {},
    "ExtendedSysState": {},
    "SysStatus": _zeros("drop_rate_comm errors_comm errors_count1 errors_count2 errors_count3 errors_count4"),
    "BatteryStatus": {},
    "EkfStatusReport": {},
    "EstimatorStatus": {},
    "Wind": {},
    "WindCov": {},
    # Camera and gimbal
    "CameraInformation": {},
    "VideoStreamInformation": {"encoding": 0},
    "CameraFeedback": {"foc_len": 0.0, "flags": 0},
    "CameraCaptureStatus": _zeros("image_status video_status")
    | {"image_interval": 0.0, "recording_time_ms": 0, "available_capacity": math.nan},
    "CameraImageCaptured": {"file_url": ""},
    "ParamExtRequestRead": {"param_index": -1},
    "ParamExtValue": {},
    "ParamExtSet": {},
    "ParamExtAck": {},
    "GimbalDeviceAttitudeStatus": _TURNING | {"failure_flags": 0},
    "MountStatus": {},
    "MountOrientation": {},
}
"""The messages that are used, by the names of their records, and the fields that may be left out, with what they are
then."""


RAW = frozenset(("param_value",))
"""Fields of letters that hold the bytes of a number: pymavlink's text of them ends at the first zero."""


def _add_to_dialect(name: str, number: int, crc_extra: int, layout: str, fields: Mapping[str, str]) -> None:
    """Put a message's class into the dialect as pymavlink makes them, of single numbers in the order of the wire."""
    names = list(fields)
    unpacker = struct.Struct(layout)

    def init(self: Any, *values: float, **named: float) -> None:
        dialect.MAVLink_message.__init__(self, number, name)
        self._fieldnames = names
        self._instance_field, self._instance_offset = None, -1
        for field_name, value in (dict(zip(names, values, strict=False)) | named).items():
            setattr(self, field_name, value)

    def pack(self: Any, mav: Any, force_mavlink1: bool = False) -> Any:
        content = unpacker.pack(*(getattr(self, field_name) for field_name in names))
        return self._pack(mav, crc_extra, content, force_mavlink1=force_mavlink1)

    members = {
        **{"id": number, "msgname": name, "fieldnames": names, "ordered_fieldnames": names},
        **{"fieldtypes": list(fields.values()), "native_format": bytearray(layout, "ascii"), "unpacker": unpacker},
        **{"fielddisplays_by_name": {}, "fieldenums_by_name": {}, "fieldunits_by_name": {}},
        **{"orders": list(range(len(names))), "lengths": [1] * len(names), "array_lengths": [0] * len(names)},
        **{"crc_extra": crc_extra, "instance_field": None, "instance_offset": -1, "__init__": init, "pack": pack},
    }
    packet = type(f"MAVLink_{name.lower()}_message", (dialect.MAVLink_message,), members)
    dialect.mavlink_map[number] = packet
    setattr(dialect, f"MAVLINK_MSG_ID_{name}", number)
    setattr(dialect, packet.__name__, packet)


# What pymavlink 2.4.50 leaves out: the numbers of the lists in MISSION_CURRENT, which PX4 sends, and MISSION_CHANGED.
_CURRENT = {"seq": "uint16_t", "total": "uint16_t", "mission_state": "uint8_t", "mission_mode": "uint8_t"}
_CURRENT |= {"mission_id": "uint32_t", "fence_id": "uint32_t", "rally_points_id": "uint32_t"}
_CHANGED = {"start_index": "int16_t", "end_index": "int16_t"}
_CHANGED |= {"origin_sysid": "uint8_t", "origin_compid": "uint8_t", "mission_type": "uint8_t"}
_add_to_dialect("MISSION_CURRENT", 42, 28, "<HHBBIII", _CURRENT)
_add_to_dialect("MISSION_CHANGED", 52, 132, "<hhBBB", _CHANGED)


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message.

    Parameters
    ----------
    kind
        Of one value.
    length
        Of a text or list, 0 of a single number.
    is_extension
        MAVLink 2 added it to the message.
    default
        `MISSING` where the field must be given.
    """

    name: str
    kind: type[float] | type[str] | type[bytes]
    length: int
    is_extension: bool
    default: Any
    unit: str

    @property
    def annotation(self) -> str:
        """Type of its value."""
        kind = self.kind.__name__
        if not self.length or self.kind in (str, bytes):
            return kind
        return f"tuple[{', '.join([kind] * 4) if self.length == 4 else f'{kind}, ...'}]"


@dataclass(frozen=True, slots=True)
class Layout:
    """A message: our record of it, pymavlink's class, and the fields in the record's order."""

    record: type[Message]
    packet: Any
    fields: tuple[Field, ...]


def number(name: str) -> int:
    """Number of a message, by the name of its record.

    Raises
    ------
    AttributeError
        `MESSAGES` has no such name.
    """
    if name not in MESSAGES:
        raise AttributeError(f"no MAVLink message {name} is used here; MESSAGES in {__name__} names those that are")
    return int(getattr(dialect, "MAVLINK_MSG_ID_" + re.sub(r"(?<!^)(?=[A-Z])", "_", name).upper()))


@cache
def layout(name: str) -> Layout:
    """How a message looks, by the name of its record.

    Raises
    ------
    AttributeError
        `MESSAGES` has no such name.
    """
    packet = dialect.mavlink_map[number(name)]
    fields = _fields(packet, MESSAGES[name])
    record = make_dataclass(
        name,
        [(each.name, each.annotation, *([] if each.default is MISSING else [each.default])) for each in fields],
        bases=(Message,),
        namespace={"__doc__": f"{packet.msgname} ({packet.id}).", "__module__": "missions.mavlink.messages"},
        frozen=True,
        slots=True,
    )
    return Layout(cast(type[Message], record), packet, fields)


def _fields(packet: Any, defaults: Mapping[str, Any]) -> tuple[Field, ...]:
    signature = inspect.signature(packet.__init__).parameters
    lengths = dict(zip(packet.ordered_fieldnames, packet.array_lengths, strict=True))
    fields = []
    for name, kind in zip(packet.fieldnames, packet.fieldtypes, strict=True):
        letters = bytes if name in RAW else str
        python = {"float": float, "double": float, "char": letters}.get(kind, int)
        extension = signature[name].default if name in signature else inspect.Parameter.empty
        is_extension = extension is not inspect.Parameter.empty
        default = defaults.get(name, ("" if python is str else extension) if is_extension else MISSING)
        unit = packet.fieldunits_by_name.get(name) or packet.fieldenums_by_name.get(name, "")
        fields.append(Field(name, python, lengths[name], is_extension, default, unit))
    if unknown := set(defaults) - set(packet.fieldnames):
        raise ValueError(f"{packet.msgname} has no field {', '.join(sorted(unknown))}")
    order = list(defaults)
    late = {each.name: len(order) for each in fields if each.is_extension}
    places = late | {name: place for place, name in enumerate(order)}
    return tuple(sorted(fields, key=lambda each: places.get(each.name, -1)))
