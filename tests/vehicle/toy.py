"""A toy of a vehicle for tests: obeys, jumps from photo to photo, and misbehaves where told to."""

from collections import deque
from dataclasses import dataclass, field, replace

from missions.mavlink.autopilots import Autopilot, facts, mode_numbers
from missions.mavlink.messages import (
    Address,
    Attitude,
    CameraFeedback,
    CommandAck,
    CommandLong,
    ExtendedSysState,
    GimbalDeviceAttitudeStatus,
    GlobalPositionInt,
    GpsRawInt,
    Heartbeat,
    HomePosition,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionCurrent,
    MissionItemInt,
    MissionRequestInt,
    MissionRequestList,
    ParamRequestRead,
    ParamSet,
    ParamValue,
    Received,
    Statustext,
    SysStatus,
)
from planning.base.errors import LinkError

ACCEPTED, FAILED = 0, 4
GROUND = Address(255, 190)
STEP_S = 0.05
PER_ITEM_S = 0.5
WAYPOINT, TAKEOFF, LAND, TRIGGER = 16, 22, 21, 203


@dataclass
class Toy:
    """One vehicle.

    Parameters
    ----------
    refuses
        MAV_RESULT by command number.
    refusals
        How often each of them is refused before it is accepted; for ever where it is not named.
    silent
        Times between which it neither hears nor says anything.
    drops_photo
        Photo, from 1, that is never reported.
    clock_rate
        How much faster its time goes than ours, as in a simulation that is sped up.
    forgets_requests
        After a reboot it sends heartbeats only, until it is asked for more.
    home_amsl_m
        Where it stands, and counts its heights from.
    told_home_amsl_m
        What HOME_POSITION says of it; None: nothing.
    moves_home_m
        How far its home moves up when it is armed.
    tells_total
        MISSION_CURRENT says how many items it has.
    """

    home: tuple[int, int]
    autopilot: Autopilot = Autopilot.ARDUPILOT
    refuses: dict[int, int] = field(default_factory=dict)
    refusals: dict[int, int] = field(default_factory=dict)
    silent: tuple[float, float] = (0.0, 0.0)
    drops_photo: int = 0
    clock_rate: float = 1.0
    forgets_requests: bool = False
    home_amsl_m: float = 0.0
    told_home_amsl_m: float | None = None
    moves_home_m: float = 0.0
    tells_total: bool = True
    takes_off: bool = True
    disarms_itself: bool = True
    is_armed: bool = False
    battery: int = 99
    fix_type: int = 6
    parameters: dict[str, float] = field(default_factory=lambda: {"CAM1_TYPE": 1.0, "MNT1_TYPE": 1.0})
    fences: list = field(default_factory=list)
    rally: list = field(default_factory=list)

    def __post_init__(self):
        self.now_s = 0.0
        self.mode = "STABILIZE" if self.autopilot is Autopilot.ARDUPILOT else "AUTO.LOITER"
        self.items, self.awaited, self.incoming = [], None, []
        self.place = (*self.home, 0)
        self.current, self.since_s, self.is_flying, self.n_photos = 0, 0.0, False, 0
        self.has_flown = False
        self.out: deque = deque()
        self.commands = []
        self.boot_s = -60.0  # it was switched on a minute ago
        self.tells_all = True
        self.texts = []

    @property
    def is_silent(self):
        return self.silent[0] <= self.now_s < self.silent[1]

    # What comes in

    def hear(self, message):
        if self.is_silent:
            return
        match message:
            case CommandLong():
                self.commands.append((message.command, message.param1, message.param2))
                self.say(CommandAck(message.command, self.obey(message), 0, 0, 255, 190))
            case MissionCount():
                self.awaited, self.incoming = message.count, []
                self.ask(message.mission_type)
            case MissionItemInt() if message.seq == len(self.incoming) and self.awaited is not None:
                self.incoming.append(message)
                self.ask(message.mission_type)
            case MissionRequestList():
                kept = self.kept(message.mission_type)
                self.say(MissionCount(*self.to(), len(kept), message.mission_type))
            case MissionRequestInt():
                kept = self.kept(message.mission_type)
                self.say(replace(kept[message.seq], target_system=GROUND.system, target_component=GROUND.component))
            case MissionClearAll():
                self.kept(message.mission_type).clear()
                self.say(MissionAck(*self.to(), ACCEPTED, message.mission_type))
            case ParamRequestRead() if message.param_id in self.parameters:
                self.say(ParamValue(message.param_id, self.parameters[message.param_id], 9, 1, 0))
            case ParamSet():
                self.parameters[message.param_id] = message.param_value
                self.say(ParamValue(message.param_id, message.param_value, 9, 1, 0))

    def ask(self, mission_type):
        if len(self.incoming) < self.awaited:
            self.say(MissionRequestInt(*self.to(), len(self.incoming), mission_type))
            return
        self.awaited = None
        self.kept(mission_type)[:] = self.incoming
        self.say(MissionAck(*self.to(), ACCEPTED, mission_type))

    def kept(self, mission_type):
        return (self.items, self.fences, self.rally)[mission_type]

    def to(self):
        return (GROUND.system, GROUND.component)

    def obey(self, command):
        result = self.refuses.get(command.command, ACCEPTED)
        if result != ACCEPTED and self.refusals.get(command.command, 1) > 0:
            if command.command in self.refusals:
                self.refusals[command.command] -= 1
            self.texts.append(Statustext(2, "PreArm: test says no"))
            return result
        match command.command:
            case 176:
                names = {number: name for name, number in mode_numbers(self.autopilot).items()}
                px4 = self.autopilot is Autopilot.PX4
                first, second = int(command.param2), int(command.param3)
                self.mode = names[first << 16 | second << 24 if px4 else first]
                if self.mode == "AUTO.MISSION":
                    self.take_off()
            case 400:
                self.is_armed = command.param1 == 1.0
            case 300:
                self.take_off()
            case 246:
                self.boot_s, self.mode = self.now_s, "STABILIZE"
                self.silent = (self.now_s, self.now_s + 5.0)
                self.tells_all = not self.forgets_requests
            case 511:
                self.tells_all = True
        return ACCEPTED

    def take_off(self):
        self.is_flying, self.since_s = self.takes_off, self.now_s
        self.has_flown = self.has_flown or self.takes_off
        self.current = 1 if self.autopilot is Autopilot.ARDUPILOT else 0

    # What goes on

    def step(self, duration_s):
        before, self.now_s = self.now_s, self.now_s + duration_s
        if self.is_flying and self.mode in ("AUTO", "AUTO.MISSION", "LAND", "RTL") and self.is_armed:
            self.fly()
        if int(before / STEP_S) != int(self.now_s / STEP_S):
            self.report(int(before) != int(self.now_s))

    def fly(self):
        if self.mode in ("LAND", "RTL"):
            self.land()
        while self.is_flying and self.now_s > self.since_s + PER_ITEM_S:
            self.since_s += PER_ITEM_S
            item = self.items[self.current]
            if item.command in (WAYPOINT, TAKEOFF):
                self.place = (item.x, item.y, round(item.z * 1000.0))
            if item.command in (TRIGGER, 2000):
                self.shoot()
            self.current += 1
            if item.command == LAND:
                self.land()

    def land(self):
        self.place = (*self.place[:2], 0)
        self.is_flying = False
        self.is_armed = not self.disarms_itself

    def shoot(self):
        self.n_photos += 1
        if self.n_photos != self.drops_photo:
            lat, lon, up = self.place
            self.say(CameraFeedback(self.n_photos, 0, 0, self.n_photos, lat, lon, 0.0, up / 1000.0, 0.0, 0.0, 0.0))

    def report(self, every_second):
        boot_ms = round(1000.0 * self.clock_rate * (self.now_s - self.boot_s)) + 1
        lat, lon, up = self.place
        if self.tells_all:
            amsl_mm = round(1000.0 * self.home_amsl_m) + up
            shift_mm = round(1000.0 * self.moves_home_m) if self.is_armed else 0
            self.say(GlobalPositionInt(boot_ms, lat, lon, amsl_mm, up - shift_mm, 0, 0, 0, 0))
            if self.told_home_amsl_m is not None:
                self.say(HomePosition(*self.home, round(1000.0 * self.told_home_amsl_m)))
            self.say(Attitude(boot_ms, 0.0, 0.0, 0.0))
            self.say(GimbalDeviceAttitudeStatus(0, 0, boot_ms, 44, (1.0, 0.0, 0.0, 0.0)))
        self.say(ExtendedSysState(0, 2 if self.is_flying else 1))
        if every_second:
            mode = mode_numbers(self.autopilot)[self.mode]
            self.say(Heartbeat(2, facts(self.autopilot).firmware_type, 128 if self.is_armed else 0, mode, 3))
            self.say(SysStatus(0, 0, 0, 0, 15000, 100, self.battery))
            self.say(GpsRawInt(0, self.fix_type, lat, lon, 0, 0, 0, 0, 0, 20, 0, 12, 15))
            self.say(MissionCurrent(self.current, len(self.items) if self.tells_total else 0))
            while self.texts:
                self.say(self.texts.pop())

    def say(self, message):
        if not self.is_silent:
            self.out.append(message)


@dataclass
class ToyLink:
    """A link whose waiting is the toy's time."""

    toy: Toy
    address: Address = GROUND
    breaks_at_s: float = float("inf")
    is_closed: bool = False

    def send(self, message):
        self.check()
        self.toy.hear(message)

    def receive(self, timeout_s):
        self.check()
        if not self.toy.out:
            self.toy.step(min(max(timeout_s, 0.001), STEP_S))
        return Received(self.toy.out.popleft(), Address(1, 1), self.toy.now_s) if self.toy.out else None

    def check(self):
        if self.toy.now_s >= self.breaks_at_s:
            raise LinkError("the cable was pulled")

    def close(self):
        self.is_closed = True
