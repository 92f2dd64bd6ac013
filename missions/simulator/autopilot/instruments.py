"""What the vehicle knows of itself, as MAVLink messages, and how often it sends them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.messages import (
    Attitude,
    AutopilotVersion,
    BatteryStatus,
    CameraCaptureStatus,
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
    LocalPositionNed,
    Message,
    MissionCurrent,
    RequestDataStream,
    SysStatus,
    SystemTime,
    VfrHud,
    Wind,
    WindCov,
)
from missions.simulator.airframe.state import Pose
from missions.simulator.autopilot.corrections import CorrectionsReceiver
from missions.simulator.autopilot.guidance import DEG, Guidance, Place, WirePlace
from missions.simulator.autopilot.modes import FlightModes
from missions.simulator.autopilot.payload import GimbalControl
from missions.simulator.autopilot.profiles import Activity
from missions.simulator.autopilot.scheduler import MissionState, Scheduler

SENSORS = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_GPS
    | mavlink.MAV_SYS_STATUS_SENSOR_BATTERY
    | mavlink.MAV_SYS_STATUS_AHRS
    | mavlink.MAV_SYS_STATUS_PREARM_CHECK
)
NEEDS_POSITION = mavlink.MAV_SYS_STATUS_SENSOR_GPS | mavlink.MAV_SYS_STATUS_AHRS | mavlink.MAV_SYS_STATUS_PREARM_CHECK
CAPABILITIES = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    | mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
)
VERSIONS = {Autopilot.ARDUPILOT: (4, 5, 6), Autopilot.PX4: (1, 15, 0)}
"""Whose behaviour the simulated vehicle has."""

OFFICIAL = 255
NO_CELL_MV = 65535
POSITION_KNOWN = (
    mavlink.ESTIMATOR_ATTITUDE
    | mavlink.ESTIMATOR_VELOCITY_HORIZ
    | mavlink.ESTIMATOR_VELOCITY_VERT
    | mavlink.ESTIMATOR_POS_HORIZ_REL
    | mavlink.ESTIMATOR_POS_HORIZ_ABS
    | mavlink.ESTIMATOR_POS_VERT_ABS
)
POSITION_UNKNOWN = mavlink.ESTIMATOR_ATTITUDE | mavlink.ESTIMATOR_CONST_POS_MODE


@dataclass(slots=True)
class Instruments:
    """Builds messages from what it reads.

    Parameters
    ----------
    unix_start_s
        UNIX time of power-up; simulated time is added to it.
    """

    autopilot: Autopilot
    guidance: Guidance
    place: Place
    gimbal: GimbalControl
    modes: FlightModes
    scheduler: Scheduler
    n_items: Callable[[], int]
    unix_start_s: float
    corrections: CorrectionsReceiver = field(default_factory=CorrectionsReceiver)
    _place_at: tuple[Pose, WirePlace] | None = None
    _n_photos: int = 0
    _told: dict[int, Message] = field(default_factory=dict)

    @property
    def time_boot_ms(self) -> int:
        """Simulated time since power-up."""
        return round(self.guidance.now_s * 1000.0)

    @property
    def time_unix_us(self) -> int:
        """UNIX time of power-up and simulated time since."""
        return round((self.unix_start_s + self.guidance.now_s) * 1e6)

    def message(self, message_id: int) -> Message | None:
        """One message as of now; None for those that are not known, or not to be had."""
        builder = BUILDERS.get(message_id)
        return None if builder is None else builder(self)

    def here(self) -> WirePlace:
        """Where the vehicle believes to be; computed once for each pose."""
        pose = self._pose()
        if self._place_at is None or self._place_at[0] is not pose:
            self._place_at = (pose, self.place.wire_place(pose.position_enu_m))
        return self._place_at[1]

    def _pose(self) -> Pose:
        return self.guidance.airframe.estimate

    def heartbeat(self) -> Message:
        """HEARTBEAT."""
        modes = self.modes
        base = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
        if modes.is_armed:
            base |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED
        if modes.activity is not Activity.HOLD:
            base |= mavlink.MAV_MODE_FLAG_AUTO_ENABLED | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
        status = mavlink.MAV_STATE_STANDBY if modes.is_landed else mavlink.MAV_STATE_ACTIVE
        if modes.is_warned and modes.is_armed:
            status = mavlink.MAV_STATE_CRITICAL
        elif not modes.has_position:
            status = mavlink.MAV_STATE_CALIBRATING if modes.is_landed else mavlink.MAV_STATE_CRITICAL
        firmware = facts(self.autopilot).firmware_type
        number = modes.number
        return Heartbeat(mavlink.MAV_TYPE_QUADROTOR, firmware, base, number, status)

    def sys_status(self) -> Message:
        """SYS_STATUS."""
        battery = self.guidance.airframe.battery
        health = SENSORS if self.modes.has_position else SENSORS & ~NEEDS_POSITION
        percent = _percent(battery.remaining)
        return SysStatus(
            SENSORS, SENSORS, health, 300, _millivolts(battery.voltage_v), round(battery.current_a * 100.0), percent
        )

    def battery_status(self) -> Message:
        """BATTERY_STATUS."""
        battery = self.guidance.airframe.battery
        millivolts = _millivolts(battery.voltage_v)
        return BatteryStatus(
            id=0,
            battery_function=mavlink.MAV_BATTERY_FUNCTION_ALL,
            type=mavlink.MAV_BATTERY_TYPE_LIPO,
            temperature=2**15 - 1,
            voltages=(millivolts, *(NO_CELL_MV,) * 9),
            current_battery=round(battery.current_a * 100.0),
            current_consumed=round(battery.consumed_mah),
            energy_consumed=-1,
            battery_remaining=_percent(battery.remaining),
        )

    def system_time(self) -> Message:
        """SYSTEM_TIME."""
        return SystemTime(self.time_unix_us, self.time_boot_ms)

    def gps_raw(self) -> Message:
        """GPS_RAW_INT."""
        fix, place, (vx, vy, _) = self.guidance.airframe.fix, self.here(), self._pose().velocity_enu_m_s
        course_deg = math.degrees(math.atan2(vx, vy)) % 360.0
        return GpsRawInt(
            time_usec=self.time_boot_ms * 1000,
            fix_type=self.corrections.fix_type(fix.fix_type, self.guidance.now_s),
            lat=place.lat_e7,
            lon=place.lon_e7,
            alt=round(place.altitude_amsl_m * 1000.0),
            eph=100,
            epv=100,
            vel=round(math.hypot(vx, vy) * 100.0),
            cog=round(course_deg * 100.0) % 36000,
            satellites_visible=fix.n_satellites,
            alt_ellipsoid=round(place.ellipsoid_height_m * 1000.0),
            h_acc=round(fix.horizontal_accuracy_m * 1000.0),
            v_acc=round(fix.vertical_accuracy_m * 1000.0),
        )

    def attitude(self) -> Message:
        """ATTITUDE."""
        pose = self._pose()
        yaw_rad = math.remainder(pose.heading_rad, 2.0 * math.pi)
        return Attitude(self.time_boot_ms, pose.roll_rad, pose.pitch_rad, yaw_rad, yawspeed=pose.yaw_rate_rad_s)

    def local_position(self) -> Message | None:
        """LOCAL_POSITION_NED: from where the estimator started, which is home here."""
        if not self.modes.has_position:
            return None
        pose, home = self._pose(), self.place.home_enu_m
        x, y, z = (a - b for a, b in zip(pose.position_enu_m, home, strict=True))
        vx, vy, vz = pose.velocity_enu_m_s
        return LocalPositionNed(self.time_boot_ms, y, x, -z, vy, vx, -vz)

    def global_position(self) -> Message | None:
        """GLOBAL_POSITION_INT."""
        if not self.modes.has_position:
            return None
        pose, place = self._pose(), self.here()
        vx, vy, vz = pose.velocity_enu_m_s
        return GlobalPositionInt(
            self.time_boot_ms,
            place.lat_e7,
            place.lon_e7,
            round(place.altitude_amsl_m * 1000.0),
            round(place.above_home_m * 1000.0),
            round(vy * 100.0),
            round(vx * 100.0),
            round(-vz * 100.0),
            round(math.degrees(pose.heading_rad) % 360.0 * 100.0) % 36000,
        )

    def mission_current(self) -> Message:
        """MISSION_CURRENT: the navigation item that is being flown."""
        n_items = self.n_items()
        if n_items == 0:
            state = mavlink.MISSION_STATE_NO_MISSION
        elif self.scheduler.state is MissionState.RUNNING:
            state = mavlink.MISSION_STATE_ACTIVE
        elif self.scheduler.state is MissionState.ENDED:
            state = mavlink.MISSION_STATE_COMPLETE
        else:
            is_begun = self.modes.is_armed and self.scheduler.current > 0
            state = mavlink.MISSION_STATE_PAUSED if is_begun else mavlink.MISSION_STATE_NOT_STARTED
        # ArduPilot does not count home.
        total = max(0, n_items - 1) if self.autopilot is Autopilot.ARDUPILOT else n_items
        mode = 1 if self.modes.activity is Activity.MISSION else 2
        return MissionCurrent(self.scheduler.current, total, state, mode)

    def vfr_hud(self) -> Message:
        """VFR_HUD."""
        pose, modes = self._pose(), self.modes
        vx, vy, vz = pose.velocity_enu_m_s
        speed_m_s = math.hypot(vx, vy)
        heading = round(math.degrees(pose.heading_rad)) % 360
        throttle = 0 if modes.is_landed else 50
        return VfrHud(speed_m_s, speed_m_s, heading, throttle, self.here().altitude_amsl_m, vz)

    def home_position(self) -> Message | None:
        """HOME_POSITION: known once the vehicle knows where it is."""
        if not self.modes.has_position:
            return None
        home = self.place.home_item()
        return HomePosition(home.x, home.y, round(home.z * 1000.0), time_usec=self.time_boot_ms * 1000)

    def extended_state(self) -> Message:
        """EXTENDED_SYS_STATE."""
        return ExtendedSysState(0, self.modes.landed_state)

    def gimbal_attitude(self) -> Message | None:
        """GIMBAL_DEVICE_ATTITUDE_STATUS."""
        if not self.gimbal.is_mounted:
            return None
        quaternion, flags = self.gimbal.attitude(self._pose())
        return GimbalDeviceAttitudeStatus(0, 0, self.time_boot_ms, flags, quaternion)

    def capture_status(self) -> Message:
        """CAMERA_CAPTURE_STATUS."""
        return CameraCaptureStatus(self.time_boot_ms, image_count=self._n_photos)

    def repeated_photo_message(self, index: int) -> Message | None:
        """What told of a photo, once more, as a camera that speaks MAVLink does; None where it cannot be had."""
        return self._told.get(index)

    def photo_taken(self, number: int) -> Message:
        """What tells of a photo: ArduPilot's has the vehicle's attitude, PX4's the camera's."""
        self._n_photos = number
        message = self._photo(number)
        if isinstance(message, CameraImageCaptured):
            self._told[message.image_index] = message
        return message

    def _photo(self, number: int) -> Message:
        estimate, place = self._pose(), self.here()
        if self.autopilot is Autopilot.ARDUPILOT:
            return CameraFeedback(
                time_usec=self.time_unix_us,
                target_system=0,
                cam_idx=0,
                img_idx=number,
                lat=place.lat_e7,
                lng=place.lon_e7,
                alt_msl=place.altitude_amsl_m,
                alt_rel=place.above_home_m,
                roll=estimate.roll_rad / DEG,
                pitch=estimate.pitch_rad / DEG,
                yaw=estimate.heading_rad / DEG % 360.0,
            )
        turned = self.gimbal.turned(estimate)
        return CameraImageCaptured(
            time_boot_ms=self.time_boot_ms,
            time_utc=self.time_unix_us,
            camera_id=1,
            lat=place.lat_e7,
            lon=place.lon_e7,
            alt=round(place.altitude_amsl_m * 1000.0),
            # Above the ground, which PX4 does not know without a range finder.
            relative_alt=-1000,
            q=camera_quaternion(turned.gimbal_heading_rad, turned.gimbal_pitch_rad),
            # Counted from 0, as MAVLink's XML says.
            image_index=number - 1,
            capture_result=1,
        )

    def ekf_status(self) -> Message:
        """EKF_STATUS_REPORT, whose flags are ESTIMATOR_STATUS's own."""
        fix = self.guidance.airframe.fix
        flags = POSITION_KNOWN if self.modes.has_position else POSITION_UNKNOWN
        variance = min(1.0, fix.horizontal_accuracy_m / 10.0), min(1.0, fix.vertical_accuracy_m / 10.0)
        return EkfStatusReport(flags, 0.05, *variance, 0.05, 0.0)

    def estimator_status(self) -> Message:
        """ESTIMATOR_STATUS."""
        fix = self.guidance.airframe.fix
        flags = POSITION_KNOWN if self.modes.has_position else POSITION_UNKNOWN
        if self.modes.is_landed:
            # PX4 says so of every aircraft that stands still.
            flags |= mavlink.ESTIMATOR_CONST_POS_MODE
        return EstimatorStatus(
            self.time_boot_ms * 1000, flags, 0.05, 0.05, 0.05, 0.05, 0.0, 0.0,
            fix.horizontal_accuracy_m, fix.vertical_accuracy_m,
        )  # fmt: skip

    def wind(self) -> Message:
        """WIND: where it comes from."""
        x, y, z = self.guidance.airframe.wind_enu_m_s
        return Wind(math.degrees(math.atan2(-x, -y)), math.hypot(x, y), -z)

    def wind_cov(self) -> Message:
        """WIND_COV: where it goes."""
        x, y, z = self.guidance.airframe.wind_enu_m_s
        return WindCov(self.time_boot_ms * 1000, y, x, -z, 0.0, 0.0, self.here().altitude_amsl_m, 0.0, 0.0)

    def autopilot_version(self) -> Message:
        """AUTOPILOT_VERSION."""
        major, minor, patch = VERSIONS[self.autopilot]
        # PX4 carries parameters as bytes, ArduPilot as their value.
        is_px4 = self.autopilot is Autopilot.PX4
        encoding = (
            mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
            if is_px4
            else mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
        )
        return AutopilotVersion(CAPABILITIES | encoding, major << 24 | minor << 16 | patch << 8 | OFFICIAL)


def camera_quaternion(heading_rad: float, pitch_rad: float) -> tuple[float, float, float, float]:
    """Rotation from a camera without roll (x forward, y right, z down) to north, east, down; w first.

    The product of a turn about down by the heading and one about right by the pitch.
    """
    ch, sh = math.cos(0.5 * heading_rad), math.sin(0.5 * heading_rad)
    cp, sp = math.cos(0.5 * pitch_rad), math.sin(0.5 * pitch_rad)
    return ch * cp, -sh * sp, ch * sp, sh * cp


def _percent(remaining: float) -> int:
    return math.floor(100.0 * min(max(remaining, 0.0), 1.0))


def _millivolts(voltage_v: float) -> int:
    return round(min(max(voltage_v, 0.0), 65.0) * 1000.0)


BUILDERS: dict[int, Callable[[Instruments], Message | None]] = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: Instruments.heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: Instruments.sys_status,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: Instruments.battery_status,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: Instruments.system_time,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: Instruments.gps_raw,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: Instruments.attitude,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: Instruments.local_position,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: Instruments.global_position,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: Instruments.mission_current,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: Instruments.vfr_hud,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: Instruments.home_position,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: Instruments.extended_state,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: Instruments.gimbal_attitude,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: Instruments.ekf_status,
    mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: Instruments.estimator_status,
    mavlink.MAVLINK_MSG_ID_WIND: Instruments.wind,
    mavlink.MAVLINK_MSG_ID_WIND_COV: Instruments.wind_cov,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: Instruments.autopilot_version,
    mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS: Instruments.capture_status,
}
"""Builders by message id."""


# What the vehicle tells by itself: each message at its interval.

USUAL_INTERVAL_S = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 0.25,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 0.5,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.25,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 0.5,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 2.0,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: 5.0,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: 0.25,
}
"""Of both autopilots: about what ground stations ask for."""

OWN_INTERVAL_S = {
    Autopilot.ARDUPILOT: {mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 1.0, mavlink.MAVLINK_MSG_ID_WIND: 1.0},
    Autopilot.PX4: {mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 1.0, mavlink.MAVLINK_MSG_ID_WIND_COV: 1.0},
}

DATA_STREAMS = {
    mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: (1, 24, 42, 245),
    mavlink.MAV_DATA_STREAM_POSITION: (32, 33),
    mavlink.MAV_DATA_STREAM_EXTRA1: (30,),
    mavlink.MAV_DATA_STREAM_EXTRA2: (74,),
    mavlink.MAV_DATA_STREAM_EXTRA3: (2, 147, 168, 193, 285),
}
"""Messages of ArduPilot's streams, of those that are sent here; stream 0 is all of them."""


class Telemetry:
    """Knows when each message is due."""

    def __init__(self, instruments: Instruments) -> None:
        self._read = instruments
        self._usual_s = USUAL_INTERVAL_S | OWN_INTERVAL_S[instruments.autopilot]
        self._interval_s = dict(self._usual_s)
        self._due_s = dict.fromkeys(self._interval_s, 0.0)
        self._next_s = 0.0

    def due(self) -> list[Message]:
        """Messages whose time has come."""
        now_s = self._read.guidance.now_s + 1e-9
        if now_s < self._next_s:
            return []
        messages = []
        for message_id, due_s in self._due_s.items():
            if now_s >= due_s:
                interval_s = self._interval_s[message_id]
                self._due_s[message_id] = due_s + interval_s if due_s + interval_s > now_s else now_s + interval_s
                message = self._read.message(message_id)
                if message is not None:
                    messages.append(message)
        self._next_s = min(self._due_s.values(), default=math.inf)
        return messages

    def set_interval(self, message_id: int, interval_s: float) -> bool:
        """Send a message at an interval from now on: 0 the usual one, below 0 never; False where it is not known."""
        if message_id not in BUILDERS:
            return False
        if interval_s == 0.0:
            interval_s = self._usual_s.get(message_id, -1.0)
        self._due_s.pop(message_id, None)
        if interval_s > 0.0:
            self._interval_s[message_id] = interval_s
            self._due_s[message_id] = self._read.guidance.now_s
        self._next_s = min(self._due_s.values(), default=math.inf)
        return True

    def request_stream(self, message: RequestDataStream) -> None:
        """REQUEST_DATA_STREAM, ArduPilot's older way to set intervals."""
        ids = DATA_STREAMS.get(message.req_stream_id, ())
        if message.req_stream_id == mavlink.MAV_DATA_STREAM_ALL:
            ids = tuple(message_id for group in DATA_STREAMS.values() for message_id in group)
        is_on = message.start_stop == 1 and message.req_message_rate > 0
        for message_id in ids:
            self.set_interval(message_id, 1.0 / message.req_message_rate if is_on else -1.0)
