"""MAVLink messages as plain records: what state machines and the simulated vehicle speak, without any link.

Fields are named and scaled exactly as in MAVLink's XML (`common.xml`, `ardupilotmega.xml`), unit by unit as written
there; only those that are used here are listed, `wire.py` sends the others as zero. A record's name is the message's in
camel case: `MissionItemInt` is MISSION_ITEM_INT. Who sent a message stands beside it, in `Received`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

NO_QUATERNION = (math.nan, math.nan, math.nan, math.nan)


@dataclass(frozen=True, slots=True)
class Message:
    """Any of the messages below."""


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


# Who is there


@dataclass(frozen=True, slots=True)
class Heartbeat(Message):
    """HEARTBEAT (0)."""

    type: int
    autopilot: int
    base_mode: int
    custom_mode: int
    system_status: int
    mavlink_version: int = 3


@dataclass(frozen=True, slots=True)
class AutopilotVersion(Message):
    """AUTOPILOT_VERSION (148)."""

    capabilities: int
    flight_sw_version: int = 0
    vendor_id: int = 0
    product_id: int = 0


@dataclass(frozen=True, slots=True)
class Statustext(Message):
    """STATUSTEXT (253). `severity` 0 emergency to 7 debug; longer texts come in chunks with one `id`."""

    severity: int
    text: str
    id: int = 0
    chunk_seq: int = 0


@dataclass(frozen=True, slots=True)
class SystemTime(Message):
    """SYSTEM_TIME (2)."""

    time_unix_usec: int
    time_boot_ms: int


@dataclass(frozen=True, slots=True)
class Timesync(Message):
    """TIMESYNC (111)."""

    tc1: int
    ts1: int


@dataclass(frozen=True, slots=True)
class RadioStatus(Message):
    """RADIO_STATUS (109), made by a telemetry radio itself: signal and noise here and there, buffer left in percent."""

    rssi: int
    remrssi: int
    txbuf: int
    noise: int
    remnoise: int
    rxerrors: int
    fixed: int


@dataclass(frozen=True, slots=True)
class SetupSigning(Message):
    """SETUP_SIGNING (256): gives the vehicle a key of 32 bytes; all zero ends signing."""

    target_system: int
    target_component: int
    secret_key: tuple[int, ...]
    initial_timestamp: int


# Commands and parameters


@dataclass(frozen=True, slots=True)
class CommandLong(Message):
    """COMMAND_LONG (76)."""

    target_system: int
    target_component: int
    command: int
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    param5: float = 0.0
    param6: float = 0.0
    param7: float = 0.0
    confirmation: int = 0


@dataclass(frozen=True, slots=True)
class CommandInt(Message):
    """COMMAND_INT (75)."""

    target_system: int
    target_component: int
    command: int
    frame: int = 0
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    x: int = 0
    y: int = 0
    z: float = 0.0


@dataclass(frozen=True, slots=True)
class CommandAck(Message):
    """COMMAND_ACK (77). `result` is a MAV_RESULT; `progress` in percent while it is IN_PROGRESS."""

    command: int
    result: int
    progress: int = 0
    result_param2: int = 0
    target_system: int = 0
    target_component: int = 0


@dataclass(frozen=True, slots=True)
class SetMode(Message):
    """SET_MODE (11)."""

    target_system: int
    base_mode: int
    custom_mode: int


@dataclass(frozen=True, slots=True)
class ParamRequestRead(Message):
    """PARAM_REQUEST_READ (20). `param_index` -1: by name."""

    target_system: int
    target_component: int
    param_id: str
    param_index: int = -1


@dataclass(frozen=True, slots=True)
class ParamRequestList(Message):
    """PARAM_REQUEST_LIST (21)."""

    target_system: int
    target_component: int


@dataclass(frozen=True, slots=True)
class ParamSet(Message):
    """PARAM_SET (23). PX4 puts the bytes of an integer into the float, ArduPilot its value."""

    target_system: int
    target_component: int
    param_id: str
    param_value: float
    param_type: int


@dataclass(frozen=True, slots=True)
class ParamValue(Message):
    """PARAM_VALUE (22)."""

    param_id: str
    param_value: float
    param_type: int
    param_count: int
    param_index: int


@dataclass(frozen=True, slots=True)
class RequestDataStream(Message):
    """REQUEST_DATA_STREAM (66), which ArduPilot still knows."""

    target_system: int
    target_component: int
    req_stream_id: int
    req_message_rate: int
    start_stop: int


# Missions, fences, rally points


@dataclass(frozen=True, slots=True)
class MissionCount(Message):
    """MISSION_COUNT (44)."""

    target_system: int
    target_component: int
    count: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionRequestList(Message):
    """MISSION_REQUEST_LIST (43)."""

    target_system: int
    target_component: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionRequest(Message):
    """MISSION_REQUEST (40), deprecated; ArduPilot still asks with it."""

    target_system: int
    target_component: int
    seq: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionRequestInt(Message):
    """MISSION_REQUEST_INT (51)."""

    target_system: int
    target_component: int
    seq: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionItemInt(Message):
    """MISSION_ITEM_INT (73). `x`, `y` are 1e-7 degrees where the command has a position, raw numbers where not."""

    target_system: int
    target_component: int
    seq: int
    frame: int
    command: int
    current: int
    autocontinue: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionItem(Message):
    """MISSION_ITEM (39), deprecated: float positions, off by up to a metre."""

    target_system: int
    target_component: int
    seq: int
    frame: int
    command: int
    current: int
    autocontinue: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: float
    y: float
    z: float
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionAck(Message):
    """MISSION_ACK (47). `type` is a MAV_MISSION_RESULT."""

    target_system: int
    target_component: int
    type: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionClearAll(Message):
    """MISSION_CLEAR_ALL (45)."""

    target_system: int
    target_component: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionWritePartialList(Message):
    """MISSION_WRITE_PARTIAL_LIST (38): a part of the list will be written anew."""

    target_system: int
    target_component: int
    start_index: int
    end_index: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionChanged(Message):
    """MISSION_CHANGED (52), deprecated: the vehicle says that a list was changed, and by whom."""

    start_index: int
    end_index: int
    origin_sysid: int
    origin_compid: int
    mission_type: int = 0


@dataclass(frozen=True, slots=True)
class MissionCurrent(Message):
    """MISSION_CURRENT (42). `total` 65535: no mission, 0: not told; the numbers of the lists are 0 where not told."""

    seq: int
    total: int = 0
    mission_state: int = 0
    mission_mode: int = 0
    mission_id: int = 0
    fence_id: int = 0
    rally_points_id: int = 0


@dataclass(frozen=True, slots=True)
class MissionItemReached(Message):
    """MISSION_ITEM_REACHED (46)."""

    seq: int


@dataclass(frozen=True, slots=True)
class MissionSetCurrent(Message):
    """MISSION_SET_CURRENT (41)."""

    target_system: int
    target_component: int
    seq: int


# Where it is and how it does


@dataclass(frozen=True, slots=True)
class GlobalPositionInt(Message):
    """GLOBAL_POSITION_INT (33): 1e-7 degrees, mm (`alt` above mean sea level), cm/s north, east, down, 0.01 degrees."""

    time_boot_ms: int
    lat: int
    lon: int
    alt: int
    relative_alt: int
    vx: int
    vy: int
    vz: int
    hdg: int


@dataclass(frozen=True, slots=True)
class LocalPositionNed(Message):
    """LOCAL_POSITION_NED (32): m and m/s."""

    time_boot_ms: int
    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float


@dataclass(frozen=True, slots=True)
class Attitude(Message):
    """ATTITUDE (30): rad, rad/s; yaw clockwise from north."""

    time_boot_ms: int
    roll: float
    pitch: float
    yaw: float
    rollspeed: float = 0.0
    pitchspeed: float = 0.0
    yawspeed: float = 0.0


@dataclass(frozen=True, slots=True)
class GpsRawInt(Message):
    """GPS_RAW_INT (24): `fix_type` 3 is 3-D, 4 DGPS, 5 RTK float, 6 RTK fixed; `h_acc`, `v_acc` in mm."""

    time_usec: int
    fix_type: int
    lat: int
    lon: int
    alt: int
    eph: int
    epv: int
    vel: int
    cog: int
    satellites_visible: int
    alt_ellipsoid: int = 0
    h_acc: int = 0
    v_acc: int = 0


@dataclass(frozen=True, slots=True)
class HomePosition(Message):
    """HOME_POSITION (242): 1e-7 degrees, mm above mean sea level."""

    latitude: int
    longitude: int
    altitude: int
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    q: tuple[float, float, float, float] = NO_QUATERNION
    time_usec: int = 0


@dataclass(frozen=True, slots=True)
class VfrHud(Message):
    """VFR_HUD (74): m/s, degrees, percent, m above mean sea level."""

    airspeed: float
    groundspeed: float
    heading: int
    throttle: int
    alt: float
    climb: float


@dataclass(frozen=True, slots=True)
class ExtendedSysState(Message):
    """EXTENDED_SYS_STATE (245): `landed_state` 1 on the ground, 2 in the air, 3 taking off, 4 landing."""

    vtol_state: int
    landed_state: int


@dataclass(frozen=True, slots=True)
class SysStatus(Message):
    """SYS_STATUS (1): mV, cA, percent; -1 where it is not known."""

    onboard_control_sensors_present: int
    onboard_control_sensors_enabled: int
    onboard_control_sensors_health: int
    load: int
    voltage_battery: int
    current_battery: int
    battery_remaining: int
    drop_rate_comm: int = 0


@dataclass(frozen=True, slots=True)
class BatteryStatus(Message):
    """BATTERY_STATUS (147): mV for each cell or, in the first, of all; cA; mAh; percent; seconds."""

    id: int
    battery_function: int
    type: int
    temperature: int
    voltages: tuple[int, ...]
    current_battery: int
    current_consumed: int
    energy_consumed: int
    battery_remaining: int
    time_remaining: int = 0


@dataclass(frozen=True, slots=True)
class EkfStatusReport(Message):
    """EKF_STATUS_REPORT (193), ArduPilot's."""

    flags: int
    velocity_variance: float
    pos_horiz_variance: float
    pos_vert_variance: float
    compass_variance: float
    terrain_alt_variance: float


@dataclass(frozen=True, slots=True)
class EstimatorStatus(Message):
    """ESTIMATOR_STATUS (230), PX4's: m for the accuracies."""

    time_usec: int
    flags: int
    vel_ratio: float
    pos_horiz_ratio: float
    pos_vert_ratio: float
    mag_ratio: float
    hagl_ratio: float
    tas_ratio: float
    pos_horiz_accuracy: float
    pos_vert_accuracy: float


@dataclass(frozen=True, slots=True)
class Wind(Message):
    """WIND (168), ArduPilot's: degrees that it comes from, m/s."""

    direction: float
    speed: float
    speed_z: float


@dataclass(frozen=True, slots=True)
class WindCov(Message):
    """WIND_COV (231), PX4's: m/s towards north, east, down."""

    time_usec: int
    wind_x: float
    wind_y: float
    wind_z: float
    var_horiz: float
    var_vert: float
    wind_alt: float
    horiz_accuracy: float
    vert_accuracy: float


# Camera and gimbal


@dataclass(frozen=True, slots=True)
class CameraFeedback(Message):
    """CAMERA_FEEDBACK (180), ArduPilot's: the attitude is the vehicle's, never the gimbal's."""

    time_usec: int
    target_system: int
    cam_idx: int
    img_idx: int
    lat: int
    lng: int
    alt_msl: float
    alt_rel: float
    roll: float
    pitch: float
    yaw: float
    foc_len: float = 0.0
    flags: int = 0
    completed_captures: int = 0


@dataclass(frozen=True, slots=True)
class CameraCaptureStatus(Message):
    """CAMERA_CAPTURE_STATUS (262): `image_count` is the number of photos ever taken."""

    time_boot_ms: int
    image_status: int = 0
    video_status: int = 0
    image_interval: float = 0.0
    recording_time_ms: int = 0
    available_capacity: float = math.nan
    image_count: int = 0


@dataclass(frozen=True, slots=True)
class CameraImageCaptured(Message):
    """CAMERA_IMAGE_CAPTURED (263): `q` turns from the camera's axes to north, east, down; w first."""

    time_boot_ms: int
    time_utc: int
    camera_id: int
    lat: int
    lon: int
    alt: int
    relative_alt: int
    q: tuple[float, float, float, float]
    image_index: int
    capture_result: int
    file_url: str = ""


@dataclass(frozen=True, slots=True)
class GimbalDeviceAttitudeStatus(Message):
    """GIMBAL_DEVICE_ATTITUDE_STATUS (285): `q` w first; its yaw is the vehicle's or the earth's by `flags`."""

    target_system: int
    target_component: int
    time_boot_ms: int
    flags: int
    q: tuple[float, float, float, float]
    angular_velocity_x: float = math.nan
    angular_velocity_y: float = math.nan
    angular_velocity_z: float = math.nan
    failure_flags: int = 0


@dataclass(frozen=True, slots=True)
class MountStatus(Message):
    """MOUNT_STATUS (158), of older ArduPilots: 0.01 degrees, `pointing_a` pitch, `pointing_c` yaw from the nose."""

    target_system: int
    target_component: int
    pointing_a: int
    pointing_b: int
    pointing_c: int


@dataclass(frozen=True, slots=True)
class MountOrientation(Message):
    """MOUNT_ORIENTATION (265), of older PX4s: degrees; `yaw` counts from the nose, `yaw_absolute` from north."""

    time_boot_ms: int
    roll: float
    pitch: float
    yaw: float
    yaw_absolute: float = 0.0
