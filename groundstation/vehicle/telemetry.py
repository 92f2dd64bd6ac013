"""From messages to `VehicleState`: a pure fold, one message at a time.

Heights are taken above the vehicle's home, which is where the mission counts them from: its altitude above sea level
rests on a geoid of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from groundstation.vehicle.commands import sensor_problems
from groundstation.vehicle.state import (
    MAX_TEXTS,
    BatteryLevel,
    EstimatorHealth,
    GnssFix,
    Landed,
    MissionProgress,
    Motion,
    RemoteIdStatus,
    Timed,
    VehicleState,
    VehicleText,
    is_restarted,
)
from missions.flight.logs.raw import PhotoClock, camera_angles_rad, is_yaw_from_north
from missions.flight.record import TakenPhoto
from missions.mavlink import messages
from missions.mavlink.autopilots import Autopilot, facts, mode_name
from planning.base.messages import say
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Angles, Origin, Vec3, wrap_heading_deg

MAV_COMP_ID_AUTOPILOT1 = 1
MAV_TYPE_GCS = 6
ARMED_FLAG = 128
"""MAV_MODE_FLAG_SAFETY_ARMED of HEARTBEAT's base_mode."""

CAMERA_AGE_S = 1.5
"""A photo gets the gimbal's angles of at most this long ago: gimbals report once a second or more often."""

POSITION_KNOWN, CONSTANT_POSITION = 16, 128
"""Bits of EKF_STATUS_REPORT and ESTIMATOR_STATUS: absolute horizontal position good; it is only assumed not to move.

PX4 sets the second with every vehicle that stands still, however well its place is known."""

TURNS_BACK, TURNS_BACK_S = 3, 20.0
"""A vehicle's own time that goes back so often within so long is that of two: a restart takes seconds."""

JUMP_M, BACK_M, JUMPS_S = 50.0, 5.0, 3.0
"""Between two positions, ten of which come every second, nothing flies so far, and is back again at once."""

OTHER_KIND = say("two vehicles of different kinds")
TWO_CLOCKS = say("two vehicles whose times since power-up differ")
TWO_PLACES = say("two vehicles at different places")

VELOCITY_KNOWN, HEIGHT_KNOWN = 2, 32
MAX_VARIANCE = 0.8
"""ArduPilot's default FS_EKF_THRESH; 1 is where measurements are thrown away."""

_LANDED = {1: Landed.ON_GROUND, 2: Landed.IN_AIR, 3: Landed.TAKING_OFF, 4: Landed.LANDING}


@dataclass(frozen=True, slots=True)
class LocalFrame:
    """The site's frame, and the height of the place from which heights above home are counted.

    Parameters
    ----------
    home_height_ellipsoid_m
        Of the planned take-off; the pilot may stand a step beside it, not a storey above it.
    """

    origin: Origin
    home_height_ellipsoid_m: float

    @classmethod
    def of_home(cls, origin: Origin, home_enu_m: Vec3) -> LocalFrame:
        """The frame of a site whose aircraft take off from home."""
        return cls(origin, float(geodetic_from_enu(origin, [home_enu_m]).ellipsoid_height_m[0]))

    def enu_m(self, lat_e7: int, lon_e7: int, above_home_m: float) -> Vec3:
        """Local coordinates of a position in 1e-7 degrees."""
        height_m = self.home_height_ellipsoid_m + above_home_m
        x, y, z = enu_from_geodetic(self.origin, lat_e7 * 1e-7, lon_e7 * 1e-7, height_m)[0]
        return (float(x), float(y), float(z))


def updated_state(state: VehicleState, received: messages.Received, frame: LocalFrame) -> VehicleState:
    """State after one more message; the same object where it says nothing new.

    Messages of other systems, and all that come before the first heartbeat of an autopilot, are passed over. Positions
    that are not on the globe are, too: a damaged message must not end a flight's telemetry.
    """
    message, source = received.message, received.source
    if isinstance(message, messages.Heartbeat):
        return _heartbeat(state, message, received)
    if state.address is None or source.system != state.address.system:
        return state
    state = replace(state, heard=received.time_s)
    if isinstance(message, messages.SystemTime) and source != state.address:
        return state
    handler = _HANDLERS.get(type(message))
    return state if handler is None else handler(state, message, received.time_s, frame)


def _heartbeat(state: VehicleState, message: messages.Heartbeat, received: messages.Received) -> VehicleState:
    autopilot = next((a for a in Autopilot if facts(a).firmware_type == message.autopilot), None)
    if received.source.component != MAV_COMP_ID_AUTOPILOT1 or message.type == MAV_TYPE_GCS or autopilot is None:
        return state
    if state.address not in (None, received.source):
        others = state.others | {received.source.system} - {state.address.system if state.address else 0}
        return state if others == state.others else replace(state, others=others)
    now_s = received.time_s
    is_other = state.vehicle_type not in (None, message.type) or state.autopilot not in (None, autopilot)
    count = 1 if state.heartbeat is None else state.heartbeat.value + 1
    return replace(
        state,
        address=received.source,
        autopilot=state.autopilot or autopilot,
        vehicle_type=state.vehicle_type or message.type,
        impostor=OTHER_KIND if is_other else state.impostor,
        heard=now_s,
        heartbeat=Timed(count, now_s),
        mode=Timed(mode_name(state.autopilot or autopilot, message.custom_mode), now_s),
        armed=Timed(bool(message.base_mode & ARMED_FLAG), now_s),
    )


def _position(
    state: VehicleState, message: messages.GlobalPositionInt, now_s: float, frame: LocalFrame
) -> VehicleState:
    state = _with_boot_time(state, message.time_boot_ms, now_s)
    if not _on_globe(message.lat, message.lon):
        return state
    above_m = message.relative_alt / 1000.0
    velocity = (message.vy / 100.0, message.vx / 100.0, -message.vz / 100.0)
    motion = Motion(frame.enu_m(message.lat, message.lon, above_m), velocity, above_m)
    state = _with_jump(state, motion, now_s)
    home_m = message.alt / 1000.0 - above_m
    return replace(state, motion=Timed(motion, now_s), home_altitude_amsl_m=home_m, home_heard_s=now_s)


def _attitude(state: VehicleState, message: messages.Attitude, now_s: float, _: LocalFrame) -> VehicleState:
    state = _with_boot_time(state, message.time_boot_ms, now_s)
    if not _finite(message.yaw, message.pitch, message.roll):
        return state
    return replace(state, attitude=Timed(Angles(_wrapped(message.yaw), message.pitch, message.roll), now_s))


def _system_time(state: VehicleState, message: messages.SystemTime, now_s: float, _: LocalFrame) -> VehicleState:
    state = _with_boot_time(state, message.time_boot_ms, now_s)
    return replace(
        state, photo_clock=state.photo_clock.after_system_time(message.time_unix_usec, message.time_boot_ms / 1000.0)
    )


def _gimbal(
    state: VehicleState, message: messages.GimbalDeviceAttitudeStatus, now_s: float, _: LocalFrame
) -> VehicleState:
    angles = camera_angles_rad(*message.q)
    if angles is None:
        return state
    heading, pitch = angles
    if not is_yaw_from_north(message.flags):
        if state.attitude is None:
            return state
        heading += state.attitude.value.heading_rad
    return replace(state, camera=Timed(Angles(_wrapped(heading), pitch, 0.0), now_s))


def _gps(state: VehicleState, message: messages.GpsRawInt, now_s: float, _: LocalFrame) -> VehicleState:
    h_acc, v_acc = (value / 1000.0 if value > 0 else None for value in (message.h_acc, message.v_acc))
    geoid_m = (message.alt_ellipsoid - message.alt) / 1000.0 if message.alt_ellipsoid != 0 else None
    fix = GnssFix(message.fix_type, message.satellites_visible, h_acc, v_acc, geoid_m)
    return replace(state, fix=Timed(fix, now_s))


def _sys_status(state: VehicleState, message: messages.SysStatus, now_s: float, _: LocalFrame) -> VehicleState:
    problems = sensor_problems(message.onboard_control_sensors_enabled, message.onboard_control_sensors_health)
    former = None if state.battery is None else state.battery.value
    level = BatteryLevel(
        remaining=message.battery_remaining / 100.0 if message.battery_remaining >= 0 else None,
        voltage_v=message.voltage_battery / 1000.0 if 0 < message.voltage_battery < 0xFFFF else None,
        current_a=message.current_battery / 100.0 if message.current_battery >= 0 else None,
        consumed_mah=None if former is None else former.consumed_mah,
    )
    return replace(state, battery=Timed(level, now_s), sensor_problems=Timed(problems, now_s))


def _battery_status(state: VehicleState, message: messages.BatteryStatus, now_s: float, _: LocalFrame) -> VehicleState:
    if message.id != 0:
        return state
    cells = [cell for cell in message.voltages if 0 < cell < 0xFFFF]
    level = BatteryLevel(
        remaining=message.battery_remaining / 100.0 if message.battery_remaining >= 0 else None,
        voltage_v=sum(cells) / 1000.0 if cells else None,
        current_a=message.current_battery / 100.0 if message.current_battery >= 0 else None,
        consumed_mah=float(message.current_consumed) if message.current_consumed >= 0 else None,
    )
    return replace(state, battery=Timed(level, now_s))


def _wind(state: VehicleState, message: messages.Wind, now_s: float, _: LocalFrame) -> VehicleState:
    if not _finite(message.direction, message.speed, message.speed_z):
        return state
    comes_from = math.radians(message.direction)
    towards = (-message.speed * math.sin(comes_from), -message.speed * math.cos(comes_from), -message.speed_z)
    return replace(state, wind_enu_m_s=Timed(towards, now_s))


def _wind_cov(state: VehicleState, message: messages.WindCov, now_s: float, _: LocalFrame) -> VehicleState:
    towards = (message.wind_y, message.wind_x, -message.wind_z if math.isfinite(message.wind_z) else 0.0)
    return replace(state, wind_enu_m_s=Timed(towards, now_s)) if _finite(*towards) else state


def _ekf(state: VehicleState, message: messages.EkfStatusReport, now_s: float, _: LocalFrame) -> VehicleState:
    worst = max(message.velocity_variance, message.pos_horiz_variance, message.pos_vert_variance)
    problem = _lacking(message.flags) or (say("its measurements contradict each other") if worst > MAX_VARIANCE else "")
    return replace(state, estimator=Timed(EstimatorHealth(problem), now_s))


def _estimator(state: VehicleState, message: messages.EstimatorStatus, now_s: float, _: LocalFrame) -> VehicleState:
    worst = max(message.vel_ratio, message.pos_horiz_ratio, message.pos_vert_ratio)
    flags = message.flags & ~CONSTANT_POSITION
    problem = _lacking(flags) or (say("its measurements contradict each other") if worst > 1.0 else "")
    return replace(state, estimator=Timed(EstimatorHealth(problem), now_s))


def _lacking(flags: int) -> str:
    """What an estimator does not know; the bits are the same for both autopilots."""
    if not flags & POSITION_KNOWN or flags & CONSTANT_POSITION:
        return say("no position yet")
    if not flags & HEIGHT_KNOWN:
        return say("no height yet")
    return "" if flags & VELOCITY_KNOWN else say("no velocity yet")


def _home(state: VehicleState, message: messages.HomePosition, now_s: float, frame: LocalFrame) -> VehicleState:
    if not _on_globe(message.latitude, message.longitude):
        return state
    place = Timed(frame.enu_m(message.latitude, message.longitude, 0.0), now_s)
    return replace(state, home_enu_m=place, home_position_amsl_m=message.altitude / 1000.0)


def _landed(state: VehicleState, message: messages.ExtendedSysState, now_s: float, _: LocalFrame) -> VehicleState:
    return replace(state, landed=Timed(_LANDED.get(message.landed_state, Landed.UNKNOWN), now_s))


def _mission_current(
    state: VehicleState, message: messages.MissionCurrent, now_s: float, _: LocalFrame
) -> VehicleState:
    former = MissionProgress() if state.mission is None else state.mission.value
    lists = (message.total, message.mission_id, message.fence_id, message.rally_points_id)
    return replace(state, mission=Timed(MissionProgress(message.seq, former.reached, lists), now_s))


def _reached(state: VehicleState, message: messages.MissionItemReached, now_s: float, _: LocalFrame) -> VehicleState:
    former = MissionProgress() if state.mission is None else state.mission.value
    return replace(state, mission=Timed(replace(former, reached=message.seq), now_s))


def _text(state: VehicleState, message: messages.Statustext, now_s: float, _: LocalFrame) -> VehicleState:
    last = state.texts[-1] if state.texts else None
    if last is not None and message.chunk_seq > 0 and message.id != 0 and last.chunk_id == message.id:
        whole = replace(last, text=last.text + message.text)
        return replace(state, texts=(*state.texts[:-1], whole))
    text = VehicleText(now_s, message.severity, message.text, message.id)
    return replace(state, texts=(*state.texts, text)[-MAX_TEXTS:])


def _feedback(state: VehicleState, message: messages.CameraFeedback, now_s: float, frame: LocalFrame) -> VehicleState:
    if not _on_globe(message.lat, message.lng) or not _finite(message.alt_rel):
        return state
    place = frame.enu_m(message.lat, message.lng, message.alt_rel)
    time_s = now_s
    if state.boot_time_s is not None:
        own_s, silent_s = state.boot_time_s, now_s - state.boot_time_heard_s
        clock = state.photo_clock.after_photo(message.time_usec, own_s, silent_s)
        state, time_s = replace(state, photo_clock=clock), clock.taken_s(message.time_usec, own_s, silent_s)
    return _with_photo(state, message.img_idx, time_s, place, "camera-feedback", now_s)


def _captured(
    state: VehicleState, message: messages.CameraImageCaptured, now_s: float, frame: LocalFrame
) -> VehicleState:
    if message.capture_result != 1 or not _on_globe(message.lat, message.lon):
        return state
    # Not relative_alt: that counts from the ground below, and PX4 says -1 m where it does not know the ground.
    home_amsl_m = state.home_altitude_amsl_m
    above_m = message.relative_alt / 1e3 if home_amsl_m is None else message.alt / 1e3 - home_amsl_m
    place = frame.enu_m(message.lat, message.lon, above_m)
    time_s = message.time_boot_ms / 1000.0
    if state.boot_time_s is not None and state.boot_time_s - time_s > CAMERA_AGE_S:
        # Its report was lost, and asked for again: camera and speed are others by now.
        return _with_late_photo(state, message, time_s, place)
    return _with_photo(state, message.image_index, time_s, place, "image-captured", now_s)


def _with_late_photo(
    state: VehicleState, message: messages.CameraImageCaptured, time_s: float, place: Vec3
) -> VehicleState:
    """State with a photo of a while ago, with the attitude that came with it."""
    if any(photo.index == message.image_index and photo.position_enu_m == place for photo in state.photos):
        return state
    heading_deg = pitch_deg = None
    if (angles := camera_angles_rad(*message.q)) is not None:
        heading_deg, pitch_deg = wrap_heading_deg(math.degrees(angles[0])), math.degrees(angles[1])
    photo = TakenPhoto(message.image_index, time_s, place, heading_deg, pitch_deg, None, "image-captured")
    return replace(state, photos=(*state.photos, photo))


def _with_photo(state: VehicleState, index: int, time_s: float, place: Vec3, source: str, now_s: float) -> VehicleState:
    """State with a photo, and with what the gimbal said of the camera and the position of the speed at that time.

    A photo that is reported again counts once; a camera that was restarted counts from the beginning, at other places.
    """
    if any(photo.index == index and photo.position_enu_m == place for photo in state.photos):
        return state
    camera, motion = state.camera, state.motion
    is_known = camera is not None and camera.age_s(now_s) <= CAMERA_AGE_S
    is_recent = motion is not None and motion.age_s(now_s) <= CAMERA_AGE_S
    photo = TakenPhoto(
        index,
        time_s,
        place,
        wrap_heading_deg(math.degrees(camera.value.heading_rad)) if is_known and camera is not None else None,
        math.degrees(camera.value.pitch_rad) if is_known and camera is not None else None,
        math.hypot(*motion.value.velocity_enu_m_s[:2]) if is_recent and motion is not None else None,
        source,
    )
    return replace(state, photos=(*state.photos, photo))


def _with_boot_time(state: VehicleState, time_boot_ms: int, now_s: float) -> VehicleState:
    """State with the vehicle's own time; where that began again, UNIX times are to be compared with it anew."""
    updated = replace(state, boot_time_s=time_boot_ms / 1000.0, boot_time_heard_s=now_s)
    if not is_restarted(state, updated):
        return updated
    turns_back_s = (*(at_s for at_s in state.turns_back_s if now_s - at_s < TURNS_BACK_S), now_s)
    impostor = TWO_CLOCKS if len(turns_back_s) >= TURNS_BACK else state.impostor
    return replace(updated, photo_clock=PhotoClock(), turns_back_s=turns_back_s, impostor=impostor)


def _with_jump(state: VehicleState, motion: Motion, now_s: float) -> VehicleState:
    """State that knows of a second vehicle, where positions go far away and come back to where they were."""
    former = None if state.motion is None else state.motion.value
    if former is None or math.dist(former.position_enu_m, motion.position_enu_m) < JUMP_M:
        return state
    left = state.left_enu_m
    is_back = left is not None and left.age_s(now_s) < JUMPS_S and math.dist(left.value, motion.position_enu_m) < BACK_M
    impostor = TWO_PLACES if is_back else state.impostor
    return replace(state, impostor=impostor, left_enu_m=Timed(former.position_enu_m, now_s))


def _on_globe(lat_e7: int, lon_e7: int) -> bool:
    """Whether a position was told; 0, 0 is what autopilots send before they know it."""
    return abs(lat_e7) <= 900_000_000 and abs(lon_e7) <= 1_800_000_000 and (lat_e7, lon_e7) != (0, 0)


def _wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, 2.0 * math.pi)


def _finite(*values: float) -> bool:
    return all(map(math.isfinite, values))


def _remote_id(
    state: VehicleState, message: messages.OpenDroneIdArmStatus, now_s: float, _frame: LocalFrame
) -> VehicleState:
    # A module that refuses without a reason still refuses.
    problem = "" if message.status == 0 else message.error or "?"
    return replace(state, remote_id=Timed(RemoteIdStatus(problem), now_s))


_HANDLERS: dict[type[messages.Message], Callable[..., VehicleState]] = {
    messages.SystemTime: _system_time,
    messages.GlobalPositionInt: _position,
    messages.Attitude: _attitude,
    messages.GimbalDeviceAttitudeStatus: _gimbal,
    messages.GpsRawInt: _gps,
    messages.SysStatus: _sys_status,
    messages.BatteryStatus: _battery_status,
    messages.Wind: _wind,
    messages.WindCov: _wind_cov,
    messages.EkfStatusReport: _ekf,
    messages.EstimatorStatus: _estimator,
    messages.HomePosition: _home,
    messages.ExtendedSysState: _landed,
    messages.MissionCurrent: _mission_current,
    messages.MissionItemReached: _reached,
    messages.Statustext: _text,
    messages.OpenDroneIdArmStatus: _remote_id,
    messages.CameraFeedback: _feedback,
    messages.CameraImageCaptured: _captured,
}
