"""What the vehicle tells by itself: each message at its interval."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Message, RequestDataStream
from missions.simulator.autopilot.instruments import BUILDERS, Instruments

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
