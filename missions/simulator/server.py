"""Ways to the simulated vehicle: within the program as fast as it goes, or over links at a multiple of real time.

Here alone simulated time meets real time. A `DirectLink` knows only simulated time: to wait for a message is to fly on.
`serve` lets simulated time follow the clock, `speedup` times as fast; while a mission is being uploaded both run alike,
because the time-outs of the upload are the vehicle's and the ground station's answers are not sped up. Where it can be
known that the ground station is still busy with what it was told, simulated time waits for it; and one that takes its
time from a `FlownClock` waits for the vehicle. So the speed of the machine changes how long a flight takes, no flight.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress

from missions.mavlink.link import GROUND_STATION, FrameObserver, Link
from missions.mavlink.messages import Address, Message, Received
from missions.mavlink.wire import Encoder
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import LinkError
from planning.base.progress import Clock, Stop, never

MAX_SPEEDUP = 50.0
LISTEN_S = 0.005
"""How long each link is listened to before the vehicle flies on."""

MAX_STEP_S = 0.1
"""Of real time, flown in one go: a vehicle that cannot keep up, or was held up, gets slower instead of deaf."""

MAX_FLOWN_S = 0.5
"""Of simulated time, flown in one go: between two looks at what the ground station wants."""

DEAF_S = 30.0
"""How long simulated time waits for a ground station, in real time; one that takes longer does not listen at all."""


def always() -> bool:
    """Of links from whose other end nothing can be known: it listens."""
    return True


class FlownClock:
    """Real time, less that in which the vehicle could not fly: it stands still while the machine is busy.

    Time-outs of a ground station that reads it run out where the vehicle does not answer, and nowhere else.
    """

    def __init__(self, start_s: float = 0.0) -> None:
        self._now_s = start_s

    def __call__(self) -> float:
        """Seconds."""
        return self._now_s

    def advance(self, duration_s: float) -> None:
        """The vehicle has flown so long, in seconds of the ground station."""
        self._now_s += duration_s


LEAD_S = 0.05
"""How far, in real time, one of several vehicles may be ahead of the others: less than a pilot sees."""


class CommonTime:
    """Keeps vehicles together that are simulated at once, each on a thread of its own: none flies ahead of another.

    So the distance between them does not depend on how busy the machine is with which of them.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._clocks: dict[FlownClock, float] = {}

    def join(self, clock: FlownClock) -> None:
        """A vehicle flies from now on, as if it had flown as long as the one that is furthest behind."""
        with self._lock:
            self._clocks[clock] = clock() - self._least_s(clock, 0.0)

    def leave(self, clock: FlownClock) -> None:
        """A vehicle flies no more; nobody waits for it."""
        with self._lock:
            self._clocks.pop(clock, None)

    def may_fly(self, clock: FlownClock) -> bool:
        """Whether a vehicle is not ahead of another."""
        with self._lock:
            own_s = clock() - self._clocks[clock]
            return own_s <= self._least_s(clock, own_s) + LEAD_S

    def _least_s(self, own: FlownClock, usual_s: float) -> float:
        """How long the one that is furthest behind has flown, besides one's own."""
        return min((clock() - start_s for clock, start_s in self._clocks.items() if clock is not own), default=usual_s)


class DirectLink:
    """A link to a vehicle in the same process, without bytes and sockets: `receive` flies until there is a message.

    Everything runs in simulated time: timeouts, `Received.time_s` and `clock`.
    """

    def __init__(self, vehicle: SimulatedVehicle, address: Address = GROUND_STATION) -> None:
        self.vehicle, self.address = vehicle, address
        self._waiting: deque[Received] = deque()
        self._observers: list[FrameObserver] = []
        self._encoders = {True: Encoder(address), False: Encoder(vehicle.address)}
        self._lock = threading.Lock()
        self._is_closed = False

    def clock(self) -> float:
        """Simulated time, seconds."""
        return self.vehicle.now_s

    def observe(self, observer: FrameObserver) -> None:
        """Show every message as the frame that it would be on the wire, from now on."""
        self._observers.append(observer)

    def send(self, message: Message) -> None:
        """Hand the vehicle a message; safe from any thread.

        Raises
        ------
        LinkError
            The link is closed.
        """
        with self._lock:
            self._check_open()
            self._show(message, is_sent=True)
            self._take(self.vehicle.receive(Received(message, self.address, self.vehicle.now_s)))

    def receive(self, timeout_s: float) -> Received | None:
        """The next message; None where none came within `timeout_s` of simulated time.

        Raises
        ------
        LinkError
            The link is closed.
        """
        with self._lock:
            self._check_open()
            vehicle = self.vehicle
            deadline_s = vehicle.now_s + timeout_s
            # Less than half a step to go: one more step would end later than asked.
            while not self._waiting and deadline_s - vehicle.now_s > 0.5 * vehicle.control_step_s:
                self._take(vehicle.step(vehicle.control_step_s))
            return self._waiting.popleft() if self._waiting else None

    def close(self) -> None:
        """Close it."""
        self._is_closed = True

    def _check_open(self) -> None:
        if self._is_closed:
            raise LinkError.say("the link to the simulated vehicle is closed")

    def _take(self, messages: Iterable[Message]) -> None:
        for message in messages:
            self._show(message, is_sent=False)
            self._waiting.append(Received(message, self.vehicle.address, self.vehicle.now_s))

    def _show(self, message: Message, *, is_sent: bool) -> None:
        if self._observers:
            frame = self._encoders[is_sent].encode(message)
            for observer in self._observers:
                observer(frame, is_sent, self.vehicle.now_s)


def serve(
    vehicle: SimulatedVehicle,
    links: Sequence[Link],
    speedup: float = 1.0,
    stop: Stop = never,
    clock: Clock = time.perf_counter,
    is_heard: Callable[[], bool] = always,
    flown: FlownClock | None = None,
) -> None:
    """Fly a vehicle and answer for it on links, until told to stop or until the last link breaks.

    Parameters
    ----------
    links
        Opened with the vehicle's address, such as `open_link("tcpin:127.0.0.1:5760", vehicle.address)`, which several
        clients may use at once; all hear everything that the vehicle says.
    speedup
        Simulated seconds for each real one, above 0 to 50.
    is_heard
        Whether the ground station has dealt with all that it was told, and listens. Where not, the vehicle waits, so
        that a slow machine makes the flight longer and not another one.
    flown
        Goes on as the vehicle flies.

    Raises
    ------
    ValueError
        The speed-up is out of range.
    """
    if not 0.0 < speedup <= MAX_SPEEDUP:
        raise ValueError(f"speedup: expected more than 0, at most {MAX_SPEEDUP:g}, got {speedup}")
    listening = list(links)
    flown_until_s = heard_s = clock()
    while listening and not stop():
        messages: list[Message] = []
        for link in tuple(listening):
            try:
                received = link.receive(LISTEN_S / len(listening))
                while received is not None:
                    messages += vehicle.receive(received)
                    received = link.receive(0.0)
            except LinkError:
                listening.remove(link)
        now_s = clock()
        if is_heard():
            heard_s = now_s
        if now_s == heard_s or now_s - heard_s > DEAF_S:
            elapsed_s = min(now_s - flown_until_s, MAX_STEP_S)
            flown_until_s = now_s
            messages += vehicle.step(min(elapsed_s * (1.0 if vehicle.is_transferring else speedup), MAX_FLOWN_S))
            if flown is not None:
                flown.advance(elapsed_s)
        _send(listening, messages)


def _send(links: list[Link], messages: Sequence[Message]) -> None:
    for link in tuple(links):
        # A link that breaks while it is written to says so again when it is read.
        with suppress(LinkError):
            for message in messages:
                link.send(message)
