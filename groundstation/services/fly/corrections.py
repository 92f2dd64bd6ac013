"""RTK corrections of an NTRIP caster, on a thread of their own: connected, kept up, and handed to a flight.

A connection that breaks, or that brings nothing, is made again, at first at once and then with longer pauses. What
cannot become well by itself (a wrong password, an unknown mountpoint) is said, and not tried again. Only frames whose
checksum is right go on.
"""

from __future__ import annotations

import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from groundstation.vehicle.preflight import PreflightCheck, Verdict
from missions.mavlink.link import Channel, TcpChannel, TlsChannel
from missions.mavlink.messages import Message, Received
from missions.mavlink.ntrip import AnswerState, Caster, CasterAnswer
from missions.mavlink.rtk import RtcmDecoder, RtcmFrame, distance_m, ecef_m, gga_sentence, rtcm_messages, types_text
from missions.mission.model import GeoPoint, altitude_amsl_m
from planning.base.errors import LinkError, LinkRejected
from planning.base.messages import say
from planning.base.progress import Clock
from planning.geo.frames import Vec3

GGA_EVERY_S = 10.0
SILENT_S = 15.0
"""Casters send every second; a connection that brings nothing for so long is made again."""

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 60.0
READ_S = 0.25

RATE_S = 10.0
"""Over which bytes a second and kinds of messages are counted."""

STALE_S = 5.0
"""Receivers use corrections of some seconds; RTK is lost with older ones."""

FAR_M = 20_000.0
"""From a base this far away a fix takes long and is worse by some millimetres a kilometre (1 ppm)."""

MAX_WAITING = 200

MAX_NOISE = 8 * 1024
"""Bytes without one right frame, before a connection is given up: to look for frames in them costs time."""


@dataclass(frozen=True, slots=True)
class CorrectionsStatus:
    """How corrections come.

    Parameters
    ----------
    age_s
        Since the last frame; None before the first.
    bytes_per_s, types
        Of the last ten seconds.
    base_m
        From the base to the take-off; None where it does not say where it stands.
    n_broken
        Bytes that were part of no frame.
    n_too_long
        Frames that MAVLink cannot carry.
    problem
        Why none come, in words; empty where they do.
    """

    name: str
    age_s: float | None = None
    bytes_per_s: float = 0.0
    types: tuple[int, ...] = ()
    base_m: float | None = None
    n_broken: int = 0
    n_too_long: int = 0
    problem: str = ""


def corrections_check(status: CorrectionsStatus) -> PreflightCheck:
    """The line of the list before take-off; whether RTK is needed is the line on the receiver's business."""
    is_fresh = status.age_s is not None and status.age_s <= STALE_S
    if status.problem and not is_fresh:
        text = say("none from {}: {}", status.name, status.problem)
        return PreflightCheck("corrections", Verdict.WARN, text)
    if status.age_s is None:
        return PreflightCheck("corrections", Verdict.WARN, say("none from {} yet", status.name))
    if not is_fresh:
        text = say("the last is {:.0f} s old, from {}", status.age_s, status.name)
        return PreflightCheck("corrections", Verdict.WARN, text, status.age_s, STALE_S, "s")
    text = say("{:.0f} bytes/s, messages {}", status.bytes_per_s, types_text(status.types))
    if status.base_m is None:
        text += say("; where their base stands is not known")
        return PreflightCheck("corrections", Verdict.OK, text)
    text += say("; their base stands {:.1f} km away", status.base_m / 1e3)
    verdict = Verdict.OK if status.base_m <= FAR_M else Verdict.WARN
    return PreflightCheck("corrections", verdict, text, status.base_m, FAR_M, "m")


@dataclass(slots=True)
class Corrections:
    """Corrections for one place; `start` begins, `close` ends.

    Parameters
    ----------
    password
        Of the caster's user; kept as long as this is.
    place
        Where the aircraft takes off: told to casters of virtual stations.
    connect
        Opens the connection; raises OSError or LinkError. None: over TCP, or TLS where the caster's address says so.
    wait
        Waits for some seconds, or until the event is set.
    """

    caster: Caster
    password: str
    place: GeoPoint
    clock: Clock = time.perf_counter
    unix_clock: Callable[[], float] = time.time
    connect: Callable[[str, int], Channel] | None = None
    _frames: queue.Queue[RtcmFrame] = field(init=False, default_factory=lambda: queue.Queue(MAX_WAITING))
    _ending: threading.Event = field(init=False, default_factory=threading.Event)
    _lock: threading.Lock = field(init=False, default_factory=threading.Lock)
    _thread: threading.Thread | None = field(init=False, default=None)
    _recent: deque[tuple[float, int, int]] = field(init=False, default_factory=deque)
    _heard_s: float | None = field(init=False, default=None)
    _base: Vec3 | None = field(init=False, default=None)
    _problem: str = field(init=False, default="")
    _n_broken: int = field(init=False, default=0)
    _n_too_long: int = field(init=False, default=0)
    _sequence: int = field(init=False, default=0)

    def start(self) -> None:
        """Connect, and keep that up until `close`."""
        self._thread = threading.Thread(target=self._keep_up, name="rtk-corrections", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End; returns at once, the connection closes within a moment."""
        self._ending.set()

    # A companion of a flight

    def receive(self, _received: Received) -> list[Message]:
        """Nothing that the vehicle says matters here."""
        return []

    def tick(self, _now_s: float) -> list[Message]:
        """Corrections that came since, as messages to the vehicle."""
        sent: list[Message] = []
        while not self._frames.empty():
            frame = self._frames.get()
            messages = rtcm_messages(frame, self._sequence)
            self._sequence += 1
            if not messages:
                with self._lock:
                    self._n_too_long += 1
            sent += messages
        return sent

    def status(self) -> CorrectionsStatus:
        """How they come now; from any thread."""
        now_s = self.clock()
        with self._lock:
            recent = [each for each in self._recent if each[0] > now_s - RATE_S]
            base_m = None if self._base is None else distance_m(self._base, _ecef(self.place))
            return CorrectionsStatus(
                self.caster.name,
                None if self._heard_s is None else now_s - self._heard_s,
                sum(size for _, size, _ in recent) / RATE_S,
                tuple(sorted({kind for *_, kind in recent})),
                base_m,
                self._n_broken,
                self._n_too_long,
                self._problem,
            )

    # The thread

    def _keep_up(self) -> None:
        pause_s = FIRST_PAUSE_S
        while not self._ending.is_set():
            heard_s = self._heard_s
            is_final = self._connected()
            if self._ending.is_set() or is_final:
                return
            pause_s = FIRST_PAUSE_S if self._heard_s != heard_s else min(2.0 * pause_s, LONGEST_PAUSE_S)
            self._ending.wait(pause_s)

    def _connected(self) -> bool:
        """One connection to its end; whether another one would end the same way."""
        connect = self.connect or (TlsChannel if self.caster.is_tls else TcpChannel)
        try:
            channel = connect(self.caster.host, self.caster.port)
        except LinkRejected as error:
            self._say(str(error))
            return True
        except (OSError, LinkError) as error:
            self._say(say("it cannot be reached ({})", getattr(error, "strerror", None) or error))
            return False
        try:
            return self._listen(channel)
        except LinkError as error:
            self._say(str(error))
            return False
        finally:
            channel.close()

    def _listen(self, channel: Channel) -> bool:
        answer, decoder = CasterAnswer(), RtcmDecoder()
        channel.write(self.caster.request(self.password, self._gga()))
        heard_s = told_s = self.clock()
        n_noise = 0
        while not self._ending.is_set():
            try:
                chunk = channel.read(READ_S)
            except LinkError as error:
                # Casters that refuse close the connection behind it.
                self._say(answer.problem or str(error))
                return answer.is_final
            now_s = self.clock()
            frames = [] if chunk is None else decoder.feed(answer.feed(chunk.data))
            if frames:
                heard_s, n_noise = now_s, decoder.n_skipped
                self._take(frames, now_s, decoder.n_skipped)
            if answer.state in (AnswerState.REFUSED, AnswerState.ENDED):
                self._say(answer.problem)
                return answer.is_final
            if now_s - heard_s > SILENT_S or decoder.n_skipped - n_noise > MAX_NOISE:
                nothing = say("it is connected and sends nothing that is RTCM")
                silent = say("it does not answer") if answer.state is AnswerState.HEAD else nothing
                self._say(answer.problem or silent)
                return answer.is_final
            if answer.state in (AnswerState.DATA, AnswerState.CHUNKED) and now_s - told_s > GGA_EVERY_S:
                told_s = now_s
                channel.write(self._gga())
        return False

    def _take(self, frames: list[RtcmFrame], now_s: float, n_broken: int) -> None:
        with self._lock:
            self._heard_s, self._problem, self._n_broken = now_s, "", n_broken
            while self._recent and self._recent[0][0] < now_s - RATE_S:
                self._recent.popleft()
            for frame in frames:
                self._recent.append((now_s, len(frame.data), frame.type))
                self._base = frame.base_ecef_m or self._base
        for frame in frames:
            if self._frames.full():
                # Old corrections are worth nothing: those that nobody took make room.
                self._frames.get()
            self._frames.put(frame)

    def _say(self, problem: str) -> None:
        with self._lock:
            self._problem = problem

    def _gga(self) -> bytes:
        place = self.place
        amsl_m = altitude_amsl_m(place)
        geoid_m = place.height_ellipsoid_m - amsl_m
        return gga_sentence(place.lat_deg, place.lon_deg, amsl_m, geoid_m, self.unix_clock())


def _ecef(place: GeoPoint) -> Vec3:
    return ecef_m(place.lat_deg, place.lon_deg, place.height_ellipsoid_m)
