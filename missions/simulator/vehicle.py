"""The simulated vehicle: an autopilot that speaks MAVLink and flies an airframe, without links, threads or real time.

Messages go in with `receive`, simulated time goes on with `step`, and both return what the vehicle says. The same
messages at the same simulated times give the same flight, bit for bit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import VEHICLE
from missions.mavlink.messages import (
    Address,
    CommandAck,
    CommandInt,
    CommandLong,
    FileTransferProtocol,
    GpsRtcmData,
    Heartbeat,
    LogRequestData,
    LogRequestEnd,
    LogRequestList,
    Message,
    MissionItemReached,
    MissionSetCurrent,
    OpenDroneIdBasicId,
    OpenDroneIdOperatorId,
    OpenDroneIdSelfId,
    OpenDroneIdSystem,
    ParamExtRequestRead,
    ParamExtSet,
    ParamRequestList,
    ParamRequestRead,
    ParamSet,
    Received,
    RequestDataStream,
    SetMode,
    Statustext,
    Timesync,
    VideoStreamInformation,
)
from missions.simulator.airframe.state import Airframe, Pose
from missions.simulator.autopilot.ardupilot_scheduler import ArduPilotScheduler
from missions.simulator.autopilot.camera_parameters import CAMERA_COMPONENT, CameraParameters
from missions.simulator.autopilot.commands import Commands
from missions.simulator.autopilot.corrections import CorrectionsReceiver
from missions.simulator.autopilot.failsafe import Failsafe
from missions.simulator.autopilot.file_server import FileServer
from missions.simulator.autopilot.guidance import DEG, Guidance, Place
from missions.simulator.autopilot.instruments import Instruments, Telemetry
from missions.simulator.autopilot.log_server import LogServer
from missions.simulator.autopilot.manoeuvres import CM, Manoeuvres, Returning
from missions.simulator.autopilot.mission_store import MissionStores, TransferMessage
from missions.simulator.autopilot.modes import FlightModes, ModeContext
from missions.simulator.autopilot.onboard_log import Event, OnboardLog
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.payload import Actions, CameraControl, GimbalControl
from missions.simulator.autopilot.profiles import vehicle_profile
from missions.simulator.autopilot.px4_scheduler import Px4Scheduler
from missions.simulator.autopilot.remote_id import RemoteIdModule
from missions.simulator.autopilot.scheduler import MissionState, Scheduler, SchedulerContext
from planning.geo.frames import Origin, Vec3

CONTROL_STEP_S = 0.02
"""How often the autopilot decides. ArduPilot's distance trigger was measured at 5.03 to 5.10 m for 5 m at 5 m/s: it
looks about 50 times a second. The airframe's motion does not depend on it."""

UNIX_START_S = 1_767_225_600.0
"""Midnight of 2026-01-01, UTC: when every simulated vehicle is switched on, unless it is told otherwise."""

MAX_TEXT = 50
"""Letters of one STATUSTEXT."""


@dataclass(frozen=True, slots=True)
class Shot:
    """One photo as it was really taken: the camera's count from 1, and its true pose at the middle of the exposure."""

    number: int
    time_s: float
    pose: Pose
    exposure_s: float


class SimulatedVehicle:
    """A vehicle that behaves as ArduCopter or PX4.

    Parameters
    ----------
    airframe
        What it flies; stands at home.
    origin
        Of the local frame that the airframe flies in.
    home_enu_m
        Where the vehicle takes its home to be; where it stands, if None.
    parameters
        Values that differ from those of `data/simulator.toml`, None for what the vehicle does not have.
    control_step_s
        Simulated time between two decisions of the autopilot.
    camera
        Its camera's parameters by the camera protocol; None: it does not speak that.
    is_ready
        The position estimate is there from the start, as if it had been switched on some time ago.
    """

    def __init__(
        self,
        autopilot: Autopilot,
        airframe: Airframe,
        origin: Origin,
        home_enu_m: Vec3 | None = None,
        parameters: Mapping[str, float | None] | None = None,
        address: Address = VEHICLE,
        control_step_s: float = CONTROL_STEP_S,
        unix_start_s: float = UNIX_START_S,
        is_ready: bool = False,
        camera: CameraParameters | None = None,
    ) -> None:
        if not (math.isfinite(control_step_s) and control_step_s > 0.0):
            raise ValueError(f"control_step_s: expected more than 0 seconds, got {control_step_s}")
        profile = vehicle_profile(autopilot)
        self.autopilot, self.airframe, self.address = autopilot, airframe, address
        self.control_step_s = control_step_s
        self.shots: list[Shot] = []
        self.camera_parameters = camera
        self._out: list[Message] = []
        self._reached: int | None = None
        self._n_steps = 0
        self._lift_off_s = math.inf
        self._owed_s = 0.0
        self._start_s = profile.estimator_ready_s if is_ready else 0.0
        self.parameters = ParameterTable(autopilot, parameters)
        self._parameters_revision = self.parameters.revision
        self.remote_id = RemoteIdModule(self.parameters)
        self.place = Place(origin, airframe.estimate.position_enu_m if home_enu_m is None else home_enu_m)
        self._guidance = Guidance(airframe)
        self._guidance.now_s = self._start_s
        self._take_speeds()
        self.gimbal = GimbalControl(autopilot, self.parameters, self._guidance)
        self.camera = CameraControl(autopilot, self.parameters, self._guidance, self._shoot)
        actions = Actions(autopilot, self._guidance, self.gimbal, self.camera, self.place)
        self.stores = MissionStores(autopilot, self.place.home_item, self._may_clear, self._say)
        returning = Returning(autopilot, self.parameters, self.place, self.stores.rally, self._is_forbidden)
        manoeuvres = Manoeuvres(autopilot, self.parameters, self.place, self._guidance, returning)
        context = SchedulerContext(
            self.stores.mission, self._guidance, actions, manoeuvres, self.parameters, self.place,
            self._note_reached, self._say, self._is_forbidden,
        )  # fmt: skip
        self.scheduler: Scheduler = (
            ArduPilotScheduler(context, profile) if autopilot is Autopilot.ARDUPILOT else Px4Scheduler(context, profile)
        )
        deck = ModeContext(
            autopilot,
            profile,
            self._guidance,
            manoeuvres,
            self.scheduler,
            self.parameters,
            self._take_speeds,
            self._say,
            lambda: self.remote_id.arming_refusal(self.now_s, self.modes.has_position),
        )
        self.modes = FlightModes(deck)
        self._failsafe = Failsafe(
            autopilot, profile, self._guidance, self.modes, self.parameters, self.place, self.stores.fence, self._say
        )
        self.corrections = CorrectionsReceiver()
        self.instruments = Instruments(
            autopilot, self._guidance, self.place, self.gimbal, self.modes, self.scheduler,
            lambda: len(self.stores.mission), unix_start_s, self.corrections,
        )  # fmt: skip
        self._telemetry = Telemetry(self.instruments)
        self.log = OnboardLog(autopilot, self.place, unix_start_s)
        self._file_server = FileServer(self._files)
        self._log_server = LogServer(autopilot, self.log.files, unix_start_s, lambda: self.modes.is_armed)
        self.has_file_transfer = True
        self.video_streams: tuple[VideoStreamInformation, ...] = ()
        self._commands = Commands(
            autopilot, profile, self.modes, self.scheduler, actions, self.instruments, self._telemetry, self._say
        )

    @property
    def now_s(self) -> float:
        """Simulated time since power-up."""
        return self._guidance.now_s

    @property
    def flight_s(self) -> float:
        """Simulated time since it first took off; minus infinity before."""
        return self.now_s - self._lift_off_s

    @property
    def is_transferring(self) -> bool:
        """Whether an upload is going on."""
        return self.stores.is_receiving

    def receive(self, received: Received) -> list[Message]:
        """Take a message; what the vehicle answers at once. Messages to others, or that it does not know, are left."""
        message, source = received.message, received.source
        if not self._is_for_me(message):
            return []
        if isinstance(message, Heartbeat):
            self._failsafe.hear_heartbeat(source)
        match message:
            case message if isinstance(message, TransferMessage):
                self._out += self.stores.receive(received, self.now_s)
            case CommandLong(command=2504) if self.video_streams:
                self._out += [CommandAck(2504, 0), *self.video_streams]
            case CommandLong(command=512, param1=259.0) if self.camera_parameters is not None:
                self._out += [CommandAck(512, 0), self.camera_parameters.information]
            case CommandLong() | CommandInt():
                self._out += self._commands.receive(message, source)
            case SetMode():
                self._out += self._commands.receive_set_mode(message, source)
            case ParamSet() | ParamRequestRead() | ParamRequestList():
                self._out += self.parameters.receive(message)
            case ParamExtSet() | ParamExtRequestRead():
                if self.camera_parameters is not None:
                    self._out += self.camera_parameters.receive(message)
            case GpsRtcmData():
                self.corrections.receive(message, self.now_s)
            case LogRequestList() | LogRequestData() | LogRequestEnd():
                self._out += self._log_server.receive(message)
            case FileTransferProtocol() if self.has_file_transfer:
                self._out += self._file_server.receive(message, source)
            case OpenDroneIdBasicId() | OpenDroneIdOperatorId() | OpenDroneIdSelfId() | OpenDroneIdSystem():
                self.remote_id.receive(message, self.now_s)
            case MissionSetCurrent():
                self.scheduler.set_current(message.seq)
                self._out.append(self.instruments.mission_current())
            case RequestDataStream():
                if self.autopilot is Autopilot.ARDUPILOT:
                    self._telemetry.request_stream(message)
            case Timesync(tc1=0):
                self._out.append(Timesync(round(self.now_s * 1e9), message.ts1))
        return self._said()

    def step(self, duration_s: float) -> list[Message]:
        """Fly on for a simulated time; what the vehicle says meanwhile.

        Whole control steps are flown; what is left over is flown with the next call.
        """
        if not (math.isfinite(duration_s) and duration_s >= 0.0):
            raise ValueError(f"duration_s: expected 0 or more seconds, got {duration_s}")
        self._owed_s += duration_s
        n_steps = math.floor(self._owed_s / self.control_step_s + 1e-9)
        self._owed_s -= n_steps * self.control_step_s
        for _ in range(n_steps):
            self._control_step()
        return self._said()

    def _control_step(self) -> None:
        guidance = self._guidance
        guidance.step(self.control_step_s)
        self._n_steps += 1
        guidance.now_s = self._start_s + self._n_steps * self.control_step_s
        self.camera.tick()
        self._failsafe.update()
        self.modes.update()
        self.log.update(guidance.now_s, self.modes.is_armed, self.modes.mode, self._believed)
        self._out += self._file_server.tick()
        self._out += self._log_server.tick()
        self._out += self.remote_id.tick(guidance.now_s, self.modes.has_position)
        if self._lift_off_s == math.inf and not self.modes.is_landed:
            self._lift_off_s = guidance.now_s
        if self.stores.is_receiving:
            self._out += self.stores.tick(guidance.now_s)
        if self._reached is not None:
            # One that follows within the same step has taken the place of an earlier one.
            self._out.append(MissionItemReached(self._reached))
            self._reached = None
        if self.parameters.revision != self._parameters_revision:
            self._parameters_revision = self.parameters.revision
            self._take_speeds()
        self._out += self._telemetry.due()

    # Inside

    def _files(self) -> dict[str, bytes]:
        """What can be fetched: logs, and what its camera has."""
        return {**self.log.files(), **({} if self.camera_parameters is None else self.camera_parameters.files)}

    def _said(self) -> list[Message]:
        messages, self._out = self._out, []
        return messages

    def _is_for_me(self, message: Message) -> bool:
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        is_camera = component == CAMERA_COMPONENT and isinstance(message, ParamExtSet | ParamExtRequestRead)
        return system in (0, self.address.system) and (component in (0, self.address.component) or is_camera)

    def _say(self, severity: int, text: str) -> None:
        self.log.note(Event(self.now_s, "text", text))
        self._out.append(Statustext(severity, text[:MAX_TEXT]))

    def _believed(self) -> tuple[Pose, float]:
        """Where the autopilot believes to be, its camera turned, and the charge that is left."""
        return self.gimbal.turned(self.airframe.estimate), self.airframe.battery.remaining

    def _note_reached(self, seq: int) -> None:
        if self.autopilot is Autopilot.PX4:
            self._out.append(MissionItemReached(seq))
        else:
            self._reached = seq

    def _may_clear(self) -> bool:
        is_flying = self.modes.is_mission_active and self.scheduler.state is MissionState.RUNNING
        return self.autopilot is Autopilot.PX4 or not is_flying

    def _is_forbidden(self, position_enu_m: Vec3) -> bool:
        return self._failsafe.is_forbidden(position_enu_m)

    def _take_speeds(self) -> None:
        """Speeds as the parameters have them: at power-up, at each start of the motors, and when one changes."""
        values, guidance = self.parameters, self._guidance
        if self.autopilot is Autopilot.ARDUPILOT:
            speeds = (values[f"WPNAV_SPEED{suffix}"] * CM for suffix in ("", "_UP", "_DN"))
            guidance.yaw_rate_rad_s = values["ATC_SLEW_YAW"] / 100.0 * DEG
        else:
            speeds = (values[name] for name in ("MPC_XY_CRUISE", "MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN"))
            guidance.yaw_rate_rad_s = values["MPC_YAWRAUTO_MAX"] * DEG
        guidance.set_speeds(*speeds)

    def _shoot(self, number: int) -> None:
        pose, exposure_s = self.airframe.shutter()
        true = self.gimbal.turned(pose)
        self.shots.append(Shot(number, self._start_s + pose.time_s, true, exposure_s))
        self._out.append(self.instruments.photo_taken(number))
        self.log.note(Event(self.now_s, "photo", number=number, pose=self._believed()[0]))
