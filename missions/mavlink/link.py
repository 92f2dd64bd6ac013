"""Links to a vehicle, or to a ground station: serial, UDP, TCP, or in memory; messages in and out.

    serial:DEVICE:BAUD      telemetry radio or USB
    udp:HOST:PORT           listen; answers whoever was heard there (14550 is the usual port of a ground station)
    udpout:HOST:PORT        send to one address, hear only that one
    tcp:HOST:PORT           connect to a server, such as a simulator
    tcpin:HOST:PORT         be the server: what a simulated vehicle does

A link that broke says `LinkError` at once, from `send` and from `receive`; opening it again is the caller's business.
UDP knows no broken link: silence is all that can be noticed there.
"""

from __future__ import annotations

import errno
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Protocol

from missions.mavlink.channels import (
    CONNECT_S,
    Channel,
    Chunk,
    MemoryChannel,
    SerialChannel,
    TcpChannel,
    TcpServerChannel,
    UdpChannel,
)
from missions.mavlink.messages import Address, Message, Received
from missions.mavlink.signing import Signer
from missions.mavlink.wire import Counts, Decoder, Encoder
from planning.errors import InputError, LinkError, LinkTimeout
from planning.progress import Clock

GROUND_STATION = Address(255, 190)
"""What QGroundControl and Mission Planner call themselves; 190 is MAV_COMP_ID_MISSIONPLANNER."""

VEHICLE = Address(1, 1)
DEFAULT_BAUD = 57600

FrameObserver = Callable[[bytes, bool, float], None]
"""Called with every whole frame, whether it was sent, and the link's time: what a telemetry log is made of."""


class Link(Protocol):
    """Messages to and from the other end."""

    address: Address

    def send(self, message: Message) -> None:
        """Send a message; safe from any thread. Raises LinkError where the link is broken."""

    def receive(self, timeout_s: float) -> Received | None:
        """The next message, None where none came in time. Raises LinkError where the link is broken."""

    def close(self) -> None:
        """Close it; more than once does no harm."""


@dataclass(slots=True)
class ChannelLink:
    """A link over a channel of bytes.

    Parameters
    ----------
    address
        Own system and component, written into each frame.
    clock
        What `Received.time_s` is read from.
    """

    channel: Channel
    address: Address = GROUND_STATION
    signer: Signer | None = None
    clock: Clock = time.perf_counter
    counts: Counts = field(default_factory=Counts)
    _encoder: Encoder = field(init=False)
    _decoders: dict[Hashable, Decoder] = field(init=False, default_factory=dict)
    _waiting: deque[Received] = field(init=False, default_factory=deque)
    _observers: list[FrameObserver] = field(init=False, default_factory=list)
    _sending: threading.Lock = field(init=False, default_factory=threading.Lock)

    def __post_init__(self) -> None:
        self._encoder = Encoder(self.address, self.signer)

    def sign_with(self, signer: Signer | None) -> None:
        """Sign, and want signatures, from now on; None: no longer. Between messages, in the thread that receives."""
        with self._sending:
            self.signer, self._encoder = signer, Encoder(self.address, signer)
            self._decoders.clear()

    def observe(self, observer: FrameObserver) -> None:
        """Show every frame that is sent or received, from now on, in the thread that sends or receives it."""
        self._observers.append(observer)

    def send(self, message: Message) -> None:
        """Send a message; safe from any thread.

        Raises
        ------
        LinkError
            The link is broken or closed.
        """
        with self._sending:
            frame = self._encoder.encode(message)
            self.channel.write(frame)
            self._show(frame, True, self.clock())

    def receive(self, timeout_s: float) -> Received | None:
        """The next message of those in `messages.py`, or None; from one thread only.

        Raises
        ------
        LinkError
            The link is broken or closed.
        """
        deadline_s = time.perf_counter() + timeout_s
        while not self._waiting:
            chunk = self.channel.read(max(0.0, deadline_s - time.perf_counter()))
            if chunk is not None:
                self._take(chunk)
            if not self._waiting and time.perf_counter() >= deadline_s:
                return None
        return self._waiting.popleft()

    def _take(self, chunk: Chunk) -> None:
        origin = None if chunk.is_datagram else chunk.origin
        decoder = self._decoders.get(origin)
        if decoder is None:
            decoder = self._decoders[origin] = Decoder(self.signer, self.counts)
        now_s = self.clock()
        for frame in decoder.feed(chunk.data, now_s, chunk.is_datagram):
            self.channel.heard(chunk.origin)
            self._show(frame.data, False, now_s)
            if frame.received is not None:
                self._waiting.append(frame.received)

    def _show(self, frame: bytes, is_sent: bool, time_s: float) -> None:
        for observer in self._observers:
            observer(frame, is_sent, time_s)

    def close(self) -> None:
        """Close the channel."""
        self.channel.close()


class MemoryLink(ChannelLink):
    """A link whose other end is in the same process."""

    channel: MemoryChannel

    def is_idle(self) -> bool:
        """Whether all that came was received and dealt with, and more is being waited for; safe from any thread."""
        return self.channel.is_idle()


def parsed_url(url: str) -> tuple[str, str, int]:
    """Kind, host or device, and port or baud rate of a url, without opening anything.

    Raises
    ------
    InputError
        The url is not one of those that the module lists.
    """
    kind, _, rest = url.partition(":")
    if kind == "serial":
        device, _, baud = rest.rpartition(":") if rest.count(":") else (rest, "", str(DEFAULT_BAUD))
        if not device or not baud.isdecimal():
            raise InputError(f"link '{url}': expected serial:DEVICE:BAUD, such as serial:/dev/ttyUSB0:57600")
        return kind, device, int(baud)
    host, _, port = rest.rpartition(":")
    if kind not in _SOCKETS or not host or not port.isdecimal() or int(port) > 65535:
        kinds = ", ".join((*_SOCKETS, "serial"))
        raise InputError(f"link '{url}': expected KIND:HOST:PORT, such as tcp:127.0.0.1:5760; kinds are {kinds}")
    return kind, host, int(port)


def open_link(
    url: str, address: Address = GROUND_STATION, signer: Signer | None = None, clock: Clock = time.perf_counter
) -> ChannelLink:
    """Open a link; the module lists the urls.

    Raises
    ------
    InputError
        The url is not one of those.
    LinkError
        It cannot be opened.
    """
    kind, place, number = parsed_url(url)
    if kind == "serial":
        return ChannelLink(SerialChannel(place, number), address, signer, clock)
    try:
        return ChannelLink(_SOCKETS[kind](place.strip("[]"), number), address, signer, clock)
    except TimeoutError as error:
        raise LinkTimeout(f"{url}: no answer within {CONNECT_S:g} s; is the address right?") from error
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            text = f"{url} cannot be opened: another program has this port; end it, or take another"
            raise LinkError(text) from error
        raise LinkError(f"{url} cannot be opened: {error.strerror or error}; is the address right?") from error


def memory_pair(
    ground: Address = GROUND_STATION, vehicle: Address = VEHICLE, clock: Clock = time.perf_counter
) -> tuple[MemoryLink, MemoryLink]:
    """Two links whose bytes go to each other, without sockets: the ground station's and the vehicle's."""
    up: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
    down: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
    return (
        MemoryLink(MemoryChannel(down, up), ground, clock=clock),
        MemoryLink(MemoryChannel(up, down), vehicle, clock=clock),
    )


def _udp_listen(host: str, port: int) -> UdpChannel:
    return UdpChannel((host, port), None, time.perf_counter)


def _udp_out(host: str, port: int) -> UdpChannel:
    return UdpChannel(None, (host, port), time.perf_counter)


_SOCKETS: dict[str, Callable[[str, int], Channel]] = {
    "udp": _udp_listen,
    "udpout": _udp_out,
    "tcp": TcpChannel,
    "tcpin": TcpServerChannel,
}
