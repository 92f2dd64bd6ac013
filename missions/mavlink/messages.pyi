# Written by `python -m tests.missions.mavlink.test_messages` from pymavlink's dialect.

from dataclasses import dataclass

from missions.mavlink.records import Address as Address
from missions.mavlink.records import Message as Message
from missions.mavlink.records import Received as Received

# HEARTBEAT (0).
@dataclass(frozen=True, slots=True)
class Heartbeat(Message):
    type: int  # MAV_TYPE
    autopilot: int  # MAV_AUTOPILOT
    base_mode: int  # MAV_MODE_FLAG
    custom_mode: int
    system_status: int  # MAV_STATE
    mavlink_version: int = ...

# AUTOPILOT_VERSION (148).
@dataclass(frozen=True, slots=True)
class AutopilotVersion(Message):
    capabilities: int  # MAV_PROTOCOL_CAPABILITY
    flight_sw_version: int = ...
    vendor_id: int = ...
    product_id: int = ...
    middleware_sw_version: int = ...
    os_sw_version: int = ...
    board_version: int = ...
    uid: int = ...
    flight_custom_version: tuple[int, ...] = ...
    middleware_custom_version: tuple[int, ...] = ...
    os_custom_version: tuple[int, ...] = ...
    uid2: tuple[int, ...] = ...

# STATUSTEXT (253). `severity` 0 emergency to 7 debug; longer texts come in chunks with one `id`.
@dataclass(frozen=True, slots=True)
class Statustext(Message):
    severity: int  # MAV_SEVERITY
    text: str
    id: int = ...
    chunk_seq: int = ...

# SYSTEM_TIME (2).
@dataclass(frozen=True, slots=True)
class SystemTime(Message):
    time_unix_usec: int  # us
    time_boot_ms: int  # ms

# TIMESYNC (111).
@dataclass(frozen=True, slots=True)
class Timesync(Message):
    tc1: int  # ns
    ts1: int  # ns

# RADIO_STATUS (109). Made by a telemetry radio itself: signal and noise at both ends, buffer left in percent.
@dataclass(frozen=True, slots=True)
class RadioStatus(Message):
    rssi: int
    remrssi: int
    txbuf: int  # %
    noise: int
    remnoise: int
    rxerrors: int
    fixed: int

# SETUP_SIGNING (256). Gives the vehicle a key of 32 bytes; all zero ends signing.
@dataclass(frozen=True, slots=True)
class SetupSigning(Message):
    target_system: int
    target_component: int
    secret_key: tuple[int, ...]
    initial_timestamp: int

# COMMAND_LONG (76).
@dataclass(frozen=True, slots=True)
class CommandLong(Message):
    target_system: int
    target_component: int
    command: int  # MAV_CMD
    param1: float = ...
    param2: float = ...
    param3: float = ...
    param4: float = ...
    param5: float = ...
    param6: float = ...
    param7: float = ...
    confirmation: int = ...

# COMMAND_INT (75).
@dataclass(frozen=True, slots=True)
class CommandInt(Message):
    target_system: int
    target_component: int
    command: int  # MAV_CMD
    frame: int = ...  # MAV_FRAME
    param1: float = ...
    param2: float = ...
    param3: float = ...
    param4: float = ...
    x: int = ...
    y: int = ...
    z: float = ...
    current: int = ...
    autocontinue: int = ...

# COMMAND_ACK (77). `result` is a MAV_RESULT; `progress` in percent while it is IN_PROGRESS.
@dataclass(frozen=True, slots=True)
class CommandAck(Message):
    command: int  # MAV_CMD
    result: int  # MAV_RESULT
    progress: int = ...
    result_param2: int = ...
    target_system: int = ...
    target_component: int = ...

# SET_MODE (11).
@dataclass(frozen=True, slots=True)
class SetMode(Message):
    target_system: int
    base_mode: int  # MAV_MODE
    custom_mode: int

# PARAM_REQUEST_READ (20). `param_index` -1: by name.
@dataclass(frozen=True, slots=True)
class ParamRequestRead(Message):
    target_system: int
    target_component: int
    param_id: str
    param_index: int = ...

# PARAM_REQUEST_LIST (21).
@dataclass(frozen=True, slots=True)
class ParamRequestList(Message):
    target_system: int
    target_component: int

# PARAM_SET (23). PX4 puts the bytes of an integer into the float, ArduPilot its value.
@dataclass(frozen=True, slots=True)
class ParamSet(Message):
    target_system: int
    target_component: int
    param_id: str
    param_value: float
    param_type: int  # MAV_PARAM_TYPE

# PARAM_VALUE (22).
@dataclass(frozen=True, slots=True)
class ParamValue(Message):
    param_id: str
    param_value: float
    param_type: int  # MAV_PARAM_TYPE
    param_count: int
    param_index: int

# REQUEST_DATA_STREAM (66). ArduPilot still knows it.
@dataclass(frozen=True, slots=True)
class RequestDataStream(Message):
    target_system: int
    target_component: int
    req_stream_id: int  # MAV_DATA_STREAM
    req_message_rate: int  # Hz
    start_stop: int

# MISSION_COUNT (44).
@dataclass(frozen=True, slots=True)
class MissionCount(Message):
    target_system: int
    target_component: int
    count: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_REQUEST_LIST (43).
@dataclass(frozen=True, slots=True)
class MissionRequestList(Message):
    target_system: int
    target_component: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_REQUEST (40). Deprecated; ArduPilot still asks with it.
@dataclass(frozen=True, slots=True)
class MissionRequest(Message):
    target_system: int
    target_component: int
    seq: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_REQUEST_INT (51).
@dataclass(frozen=True, slots=True)
class MissionRequestInt(Message):
    target_system: int
    target_component: int
    seq: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_ITEM_INT (73). `x`, `y` are 1e-7 degrees where the command has a position, raw numbers where not.
@dataclass(frozen=True, slots=True)
class MissionItemInt(Message):
    target_system: int
    target_component: int
    seq: int
    frame: int  # MAV_FRAME
    command: int  # MAV_CMD
    current: int
    autocontinue: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_ITEM (39). Deprecated: float positions, off by up to a metre.
@dataclass(frozen=True, slots=True)
class MissionItem(Message):
    target_system: int
    target_component: int
    seq: int
    frame: int  # MAV_FRAME
    command: int  # MAV_CMD
    current: int
    autocontinue: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: float
    y: float
    z: float
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_ACK (47). `type` is a MAV_MISSION_RESULT.
@dataclass(frozen=True, slots=True)
class MissionAck(Message):
    target_system: int
    target_component: int
    type: int  # MAV_MISSION_RESULT
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_CLEAR_ALL (45).
@dataclass(frozen=True, slots=True)
class MissionClearAll(Message):
    target_system: int
    target_component: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_WRITE_PARTIAL_LIST (38). A part of the list will be written anew.
@dataclass(frozen=True, slots=True)
class MissionWritePartialList(Message):
    target_system: int
    target_component: int
    start_index: int
    end_index: int
    mission_type: int = ...  # MAV_MISSION_TYPE

# MISSION_CHANGED (52). Deprecated: the vehicle says that a list was changed, and by whom.
@dataclass(frozen=True, slots=True)
class MissionChanged(Message):
    start_index: int
    end_index: int
    origin_sysid: int
    origin_compid: int
    mission_type: int = ...

# MISSION_CURRENT (42). `total` 65535: no mission, 0: not told; the numbers of the lists are 0 where not told.
@dataclass(frozen=True, slots=True)
class MissionCurrent(Message):
    seq: int
    total: int = ...
    mission_state: int = ...
    mission_mode: int = ...
    mission_id: int = ...
    fence_id: int = ...
    rally_points_id: int = ...

# MISSION_ITEM_REACHED (46).
@dataclass(frozen=True, slots=True)
class MissionItemReached(Message):
    seq: int

# MISSION_SET_CURRENT (41).
@dataclass(frozen=True, slots=True)
class MissionSetCurrent(Message):
    target_system: int
    target_component: int
    seq: int

# FILE_TRANSFER_PROTOCOL (110). `payload` is MAVFTP's own frame (`ftp.py`).
@dataclass(frozen=True, slots=True)
class FileTransferProtocol(Message):
    target_system: int
    target_component: int
    payload: tuple[int, ...]
    target_network: int = ...

# LOG_REQUEST_LIST (117).
@dataclass(frozen=True, slots=True)
class LogRequestList(Message):
    target_system: int
    target_component: int
    start: int
    end: int

# LOG_ENTRY (118).
@dataclass(frozen=True, slots=True)
class LogEntry(Message):
    id: int
    num_logs: int
    last_log_num: int
    time_utc: int  # s
    size: int  # bytes

# LOG_REQUEST_DATA (119).
@dataclass(frozen=True, slots=True)
class LogRequestData(Message):
    target_system: int
    target_component: int
    id: int
    ofs: int
    count: int  # bytes

# LOG_DATA (120).
@dataclass(frozen=True, slots=True)
class LogData(Message):
    id: int
    ofs: int
    count: int  # bytes
    data: tuple[int, ...]

# LOG_REQUEST_END (122).
@dataclass(frozen=True, slots=True)
class LogRequestEnd(Message):
    target_system: int
    target_component: int

# OPEN_DRONE_ID_BASIC_ID (12900).
@dataclass(frozen=True, slots=True)
class OpenDroneIdBasicId(Message):
    target_system: int
    target_component: int
    id_or_mac: tuple[int, ...]
    id_type: int  # MAV_ODID_ID_TYPE
    ua_type: int  # MAV_ODID_UA_TYPE
    uas_id: tuple[int, ...]

# OPEN_DRONE_ID_SELF_ID (12903).
@dataclass(frozen=True, slots=True)
class OpenDroneIdSelfId(Message):
    target_system: int
    target_component: int
    id_or_mac: tuple[int, ...]
    description_type: int  # MAV_ODID_DESC_TYPE
    description: str

# OPEN_DRONE_ID_SYSTEM (12904). Heights above the ellipsoid; `timestamp` counts seconds from 2019.
@dataclass(frozen=True, slots=True)
class OpenDroneIdSystem(Message):
    target_system: int
    target_component: int
    id_or_mac: tuple[int, ...]
    operator_location_type: int  # MAV_ODID_OPERATOR_LOCATION_TYPE
    classification_type: int  # MAV_ODID_CLASSIFICATION_TYPE
    operator_latitude: int  # degE7
    operator_longitude: int  # degE7
    area_count: int
    area_radius: int  # m
    area_ceiling: float  # m
    area_floor: float  # m
    category_eu: int  # MAV_ODID_CATEGORY_EU
    class_eu: int  # MAV_ODID_CLASS_EU
    operator_altitude_geo: float  # m
    timestamp: int  # s

# OPEN_DRONE_ID_OPERATOR_ID (12905).
@dataclass(frozen=True, slots=True)
class OpenDroneIdOperatorId(Message):
    target_system: int
    target_component: int
    id_or_mac: tuple[int, ...]
    operator_id_type: int  # MAV_ODID_OPERATOR_ID_TYPE
    operator_id: str

# OPEN_DRONE_ID_ARM_STATUS (12918). `status` 0: content; `error` says what is missing.
@dataclass(frozen=True, slots=True)
class OpenDroneIdArmStatus(Message):
    status: int  # MAV_ODID_ARM_STATUS
    error: str

# GPS_RTCM_DATA (233). `flags`: bit 0 fragmented, bits 1 and 2 which fragment, bits 3 to 7 which message.
@dataclass(frozen=True, slots=True)
class GpsRtcmData(Message):
    flags: int
    len: int  # bytes
    data: tuple[int, ...]

# GLOBAL_POSITION_INT (33). `alt` is above mean sea level.
@dataclass(frozen=True, slots=True)
class GlobalPositionInt(Message):
    time_boot_ms: int  # ms
    lat: int  # degE7
    lon: int  # degE7
    alt: int  # mm
    relative_alt: int  # mm
    vx: int  # cm/s
    vy: int  # cm/s
    vz: int  # cm/s
    hdg: int  # cdeg

# LOCAL_POSITION_NED (32).
@dataclass(frozen=True, slots=True)
class LocalPositionNed(Message):
    time_boot_ms: int  # ms
    x: float  # m
    y: float  # m
    z: float  # m
    vx: float  # m/s
    vy: float  # m/s
    vz: float  # m/s

# ATTITUDE (30). Yaw is clockwise from north.
@dataclass(frozen=True, slots=True)
class Attitude(Message):
    time_boot_ms: int  # ms
    roll: float  # rad
    pitch: float  # rad
    yaw: float  # rad
    rollspeed: float = ...  # rad/s
    pitchspeed: float = ...  # rad/s
    yawspeed: float = ...  # rad/s

# GPS_RAW_INT (24). `fix_type` 3 is 3-D, 4 DGPS, 5 RTK float, 6 RTK fixed.
@dataclass(frozen=True, slots=True)
class GpsRawInt(Message):
    time_usec: int  # us
    fix_type: int  # GPS_FIX_TYPE
    lat: int  # degE7
    lon: int  # degE7
    alt: int  # mm
    eph: int
    epv: int
    vel: int  # cm/s
    cog: int  # cdeg
    satellites_visible: int
    alt_ellipsoid: int = ...  # mm
    h_acc: int = ...  # mm
    v_acc: int = ...  # mm
    vel_acc: int = ...  # mm/s
    hdg_acc: int = ...  # degE5
    yaw: int = ...  # cdeg

# HOME_POSITION (242). `altitude` is above mean sea level.
@dataclass(frozen=True, slots=True)
class HomePosition(Message):
    latitude: int  # degE7
    longitude: int  # degE7
    altitude: int  # mm
    x: float = ...  # m
    y: float = ...  # m
    z: float = ...  # m
    q: tuple[float, float, float, float] = ...
    approach_x: float = ...  # m
    approach_y: float = ...  # m
    approach_z: float = ...  # m
    time_usec: int = ...  # us

# VFR_HUD (74).
@dataclass(frozen=True, slots=True)
class VfrHud(Message):
    airspeed: float  # m/s
    groundspeed: float  # m/s
    heading: int  # deg
    throttle: int  # %
    alt: float  # m
    climb: float  # m/s

# EXTENDED_SYS_STATE (245). `landed_state` 1 on the ground, 2 in the air, 3 taking off, 4 landing.
@dataclass(frozen=True, slots=True)
class ExtendedSysState(Message):
    vtol_state: int  # MAV_VTOL_STATE
    landed_state: int  # MAV_LANDED_STATE

# SYS_STATUS (1). -1 where it is not known.
@dataclass(frozen=True, slots=True)
class SysStatus(Message):
    onboard_control_sensors_present: int  # MAV_SYS_STATUS_SENSOR
    onboard_control_sensors_enabled: int  # MAV_SYS_STATUS_SENSOR
    onboard_control_sensors_health: int  # MAV_SYS_STATUS_SENSOR
    load: int  # d%
    voltage_battery: int  # mV
    current_battery: int  # cA
    battery_remaining: int  # %
    drop_rate_comm: int = ...  # c%
    errors_comm: int = ...
    errors_count1: int = ...
    errors_count2: int = ...
    errors_count3: int = ...
    errors_count4: int = ...
    onboard_control_sensors_present_extended: int = ...  # MAV_SYS_STATUS_SENSOR_EXTENDED
    onboard_control_sensors_enabled_extended: int = ...  # MAV_SYS_STATUS_SENSOR_EXTENDED
    onboard_control_sensors_health_extended: int = ...  # MAV_SYS_STATUS_SENSOR_EXTENDED

# BATTERY_STATUS (147). `voltages` of each cell or, in the first, of all.
@dataclass(frozen=True, slots=True)
class BatteryStatus(Message):
    id: int
    battery_function: int  # MAV_BATTERY_FUNCTION
    type: int  # MAV_BATTERY_TYPE
    temperature: int  # cdegC
    voltages: tuple[int, ...]  # mV
    current_battery: int  # cA
    current_consumed: int  # mAh
    energy_consumed: int  # hJ
    battery_remaining: int  # %
    time_remaining: int = ...  # s
    charge_state: int = ...  # MAV_BATTERY_CHARGE_STATE
    voltages_ext: tuple[int, int, int, int] = ...  # mV
    mode: int = ...  # MAV_BATTERY_MODE
    fault_bitmask: int = ...  # MAV_BATTERY_FAULT

# EKF_STATUS_REPORT (193). ArduPilot's.
@dataclass(frozen=True, slots=True)
class EkfStatusReport(Message):
    flags: int  # EKF_STATUS_FLAGS
    velocity_variance: float
    pos_horiz_variance: float
    pos_vert_variance: float
    compass_variance: float
    terrain_alt_variance: float
    airspeed_variance: float = ...

# ESTIMATOR_STATUS (230). PX4's.
@dataclass(frozen=True, slots=True)
class EstimatorStatus(Message):
    time_usec: int  # us
    flags: int  # ESTIMATOR_STATUS_FLAGS
    vel_ratio: float
    pos_horiz_ratio: float
    pos_vert_ratio: float
    mag_ratio: float
    hagl_ratio: float
    tas_ratio: float
    pos_horiz_accuracy: float  # m
    pos_vert_accuracy: float  # m

# WIND (168). ArduPilot's: where the wind comes from.
@dataclass(frozen=True, slots=True)
class Wind(Message):
    direction: float  # deg
    speed: float  # m/s
    speed_z: float  # m/s

# WIND_COV (231). PX4's: towards north, east, down.
@dataclass(frozen=True, slots=True)
class WindCov(Message):
    time_usec: int  # us
    wind_x: float  # m/s
    wind_y: float  # m/s
    wind_z: float  # m/s
    var_horiz: float  # m/s
    var_vert: float  # m/s
    wind_alt: float  # m
    horiz_accuracy: float  # m/s
    vert_accuracy: float  # m/s

# CAMERA_INFORMATION (259).
@dataclass(frozen=True, slots=True)
class CameraInformation(Message):
    time_boot_ms: int  # ms
    vendor_name: tuple[int, ...]
    model_name: tuple[int, ...]
    firmware_version: int
    focal_length: float  # mm
    sensor_size_h: float  # mm
    sensor_size_v: float  # mm
    resolution_h: int  # pix
    resolution_v: int  # pix
    lens_id: int
    flags: int  # CAMERA_CAP_FLAGS
    cam_definition_version: int
    cam_definition_uri: str
    gimbal_device_id: int = ...
    camera_device_id: int = ...

# VIDEO_STREAM_INFORMATION (269).
@dataclass(frozen=True, slots=True)
class VideoStreamInformation(Message):
    stream_id: int
    count: int
    type: int  # VIDEO_STREAM_TYPE
    flags: int  # VIDEO_STREAM_STATUS_FLAGS
    framerate: float  # Hz
    resolution_h: int  # pix
    resolution_v: int  # pix
    bitrate: int  # bits/s
    rotation: int  # deg
    hfov: int  # deg
    name: str
    uri: str
    encoding: int = ...  # VIDEO_STREAM_ENCODING
    camera_device_id: int = ...

# CAMERA_FEEDBACK (180). ArduPilot's: the attitude is the vehicle's, never the gimbal's.
@dataclass(frozen=True, slots=True)
class CameraFeedback(Message):
    time_usec: int  # us
    target_system: int
    cam_idx: int
    img_idx: int
    lat: int  # degE7
    lng: int  # degE7
    alt_msl: float  # m
    alt_rel: float  # m
    roll: float  # deg
    pitch: float  # deg
    yaw: float  # deg
    foc_len: float = ...  # mm
    flags: int = ...  # CAMERA_FEEDBACK_FLAGS
    completed_captures: int = ...

# CAMERA_CAPTURE_STATUS (262). `image_count` is the number of photos ever taken.
@dataclass(frozen=True, slots=True)
class CameraCaptureStatus(Message):
    time_boot_ms: int  # ms
    image_status: int = ...
    video_status: int = ...
    image_interval: float = ...  # s
    recording_time_ms: int = ...  # ms
    available_capacity: float = ...  # MiB
    image_count: int = ...
    camera_device_id: int = ...

# CAMERA_IMAGE_CAPTURED (263). `q` turns from the camera's axes to north, east, down; w first.
@dataclass(frozen=True, slots=True)
class CameraImageCaptured(Message):
    time_boot_ms: int  # ms
    time_utc: int  # us
    camera_id: int
    lat: int  # degE7
    lon: int  # degE7
    alt: int  # mm
    relative_alt: int  # mm
    q: tuple[float, float, float, float]
    image_index: int
    capture_result: int  # MAV_BOOL
    file_url: str = ...

# PARAM_EXT_REQUEST_READ (320).
@dataclass(frozen=True, slots=True)
class ParamExtRequestRead(Message):
    target_system: int
    target_component: int
    param_id: str
    param_index: int = ...

# PARAM_EXT_VALUE (322).
@dataclass(frozen=True, slots=True)
class ParamExtValue(Message):
    param_id: str
    param_value: bytes
    param_type: int  # MAV_PARAM_EXT_TYPE
    param_count: int
    param_index: int

# PARAM_EXT_SET (323).
@dataclass(frozen=True, slots=True)
class ParamExtSet(Message):
    target_system: int
    target_component: int
    param_id: str
    param_value: bytes
    param_type: int  # MAV_PARAM_EXT_TYPE

# PARAM_EXT_ACK (324).
@dataclass(frozen=True, slots=True)
class ParamExtAck(Message):
    param_id: str
    param_value: bytes
    param_type: int  # MAV_PARAM_EXT_TYPE
    param_result: int  # PARAM_ACK

# GIMBAL_DEVICE_ATTITUDE_STATUS (285). `q` w first; its yaw is the vehicle's or the earth's by `flags`.
@dataclass(frozen=True, slots=True)
class GimbalDeviceAttitudeStatus(Message):
    target_system: int
    target_component: int
    time_boot_ms: int  # ms
    flags: int  # GIMBAL_DEVICE_FLAGS
    q: tuple[float, float, float, float]
    angular_velocity_x: float = ...  # rad/s
    angular_velocity_y: float = ...  # rad/s
    angular_velocity_z: float = ...  # rad/s
    failure_flags: int = ...  # GIMBAL_DEVICE_ERROR_FLAGS
    delta_yaw: float = ...  # rad
    delta_yaw_velocity: float = ...  # rad/s
    gimbal_device_id: int = ...

# MOUNT_STATUS (158). Of older ArduPilots: 0.01 degrees, `pointing_a` pitch, `pointing_c` yaw from the nose.
@dataclass(frozen=True, slots=True)
class MountStatus(Message):
    target_system: int
    target_component: int
    pointing_a: int  # cdeg
    pointing_b: int  # cdeg
    pointing_c: int  # cdeg
    mount_mode: int = ...  # MAV_MOUNT_MODE

# MOUNT_ORIENTATION (265). Of older PX4s: `yaw` counts from the nose, `yaw_absolute` from north.
@dataclass(frozen=True, slots=True)
class MountOrientation(Message):
    time_boot_ms: int  # ms
    roll: float  # deg
    pitch: float  # deg
    yaw: float  # deg
    yaw_absolute: float = ...  # deg
