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
import itertools
import queue
import select
import socket
import ssl
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar, runtime_checkable

from missions.mavlink.messages import Address, Heartbeat, Message, Received
from missions.mavlink.signing import Signer
from missions.mavlink.wire import Counts, Decoder, Encoder
from planning.base.errors import InputError, LinkError, LinkRejected, LinkTimeout, OperationCancelled
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor

# Bytes to and from the other end: datagrams, TCP, a serial line, or memory. The only place that opens sockets.

CONNECT_S = 5.0
READ_BYTES = 65536
SERIAL_WAIT_S = 0.05
"""Wait for the first byte; fixed, because pyserial sets the whole line up anew where it changes."""

PEER_KEPT_S = 30.0
"""A UDP sender is answered until it was silent for this long."""

MAX_PEERS = 16

UDP_BUFFER_BYTES = 4 << 20
"""Datagrams that may wait to be read; the usual 0.2 MB are full within 0.1 s of a fast simulation: photos were lost."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes that came in; a frame never goes on in bytes of another origin, nor of another datagram."""

    origin: Hashable
    data: bytes
    is_datagram: bool = False


class Channel(Protocol):
    """Bytes to and from the other end."""

    def read(self, timeout_s: float) -> Chunk | None:
        """What came in; None where nothing came in time, or before the time is up."""

    def write(self, data: bytes) -> None:
        """Send one frame."""

    def note_peer(self, origin: Hashable) -> None:
        """Note that this origin speaks MAVLink."""

    def close(self) -> None:
        """Close it."""


@dataclass(slots=True)
class MemoryChannel:
    """Bytes through two queues; None in one says that the other end was closed."""

    inbox: queue.SimpleQueue[bytes | None]
    outbox: queue.SimpleQueue[bytes | None]
    _is_closed: bool = field(init=False, default=False)
    _is_reading: bool = field(init=False, default=False)

    def read(self, timeout_s: float) -> Chunk | None:
        """Next frame."""
        if self._is_closed:
            raise LinkError.say("the link is closed")
        self._is_reading = True
        try:
            data = self.inbox.get(timeout=timeout_s) if timeout_s > 0.0 else self.inbox.get_nowait()
        except queue.Empty:
            return None
        finally:
            self._is_reading = False
        if data is None:
            self._is_closed = True
            raise LinkError.say("the other end closed the link")
        return Chunk("memory", data, is_datagram=True)

    def write(self, data: bytes) -> None:
        """Hand a frame over."""
        if self._is_closed:
            raise LinkError.say("the link is closed")
        self.outbox.put(data)

    def note_peer(self, origin: Hashable) -> None:
        """Nothing to note: there is one other end."""

    def is_idle(self) -> bool:
        """Whether all that came was read, and the next is being waited for; from any thread."""
        return self._is_reading and self.inbox.empty()

    def close(self) -> None:
        """Tell the other end."""
        if not self._is_closed:
            self._is_closed = True
            self.outbox.put(None)


def _ready(sockets: list[socket.socket], timeout_s: float) -> list[socket.socket]:
    """Those with something to read; raises LinkError where one was closed meanwhile."""
    try:
        return select.select(sockets, [], [], timeout_s)[0]
    except (OSError, ValueError) as error:
        raise LinkError.say("the link is closed") from error


class UdpChannel:
    """Datagrams: from anybody, answered to all that speak MAVLink, or from and to one address only."""

    def __init__(self, bind_to: tuple[str, int] | None, send_to: tuple[str, int] | None, clock: Clock) -> None:
        host, port = bind_to or send_to or ("", 0)
        family, kind, protocol, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        self._socket = socket.socket(family, kind, protocol)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, UDP_BUFFER_BYTES)
        self._clock = clock
        self._is_connected = send_to is not None
        self._peers: dict[Any, float] = {}
        try:
            if self._is_connected:
                self._socket.connect(where)
            else:
                self._socket.bind(where)
        except OSError:
            self._socket.close()
            raise

    @property
    def port(self) -> int:
        """Own port."""
        return int(self._socket.getsockname()[1])

    def read(self, timeout_s: float) -> Chunk | None:
        """Next datagram."""
        if not _ready([self._socket], timeout_s):
            return None
        try:
            data, origin = self._socket.recvfrom(READ_BYTES)
        except (ConnectionRefusedError, ConnectionResetError):
            # The other end does not listen yet, or not any more: UDP hears that, and can only go on.
            return None
        except OSError as error:
            raise LinkError.say("the UDP link broke: {}", error.strerror or error) from error
        return Chunk(origin, data, is_datagram=True)

    def write(self, data: bytes) -> None:
        """Send to the address, or to all that were heard of late."""
        try:
            if self._is_connected:
                self._socket.send(data)
                return
            oldest_s = self._clock() - PEER_KEPT_S
            for peer, heard_s in list(self._peers.items()):
                if heard_s >= oldest_s:
                    self._socket.sendto(data, peer)
                else:
                    del self._peers[peer]
        except (ConnectionRefusedError, ConnectionResetError):
            return
        except OSError as error:
            raise LinkError.say("the UDP link broke: {}", error.strerror or error) from error

    def note_peer(self, origin: Hashable) -> None:
        """Answer this one from now on."""
        if origin in self._peers or len(self._peers) < MAX_PEERS:
            self._peers[origin] = self._clock()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class TcpChannel:
    """One TCP connection to a server."""

    def __init__(self, host: str, port: int) -> None:
        self._socket = socket.create_connection((host, port), CONNECT_S)
        self._name = f"{host}:{port}"
        _prepare(self._socket)

    def read(self, timeout_s: float) -> Chunk | None:
        """Bytes as they come."""
        if not _ready([self._socket], timeout_s):
            return None
        try:
            data = self._socket.recv(READ_BYTES)
        except OSError as error:
            raise LinkError.say("the TCP link to {} broke: {}", self._name, error.strerror or error) from error
        if not data:
            raise LinkError.say("{} closed the TCP link", self._name)
        return Chunk("tcp", data)

    def write(self, data: bytes) -> None:
        """Send all of it."""
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise LinkError.say("the TCP link to {} broke: {}", self._name, error.strerror or error) from error

    def note_peer(self, origin: Hashable) -> None:
        """Nothing to note: there is one other end."""

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


class TlsChannel:
    """One TLS connection to a server whose certificate this computer trusts (RFC 8446); never an unprotected one.

    Parameters
    ----------
    context
        None: the certificate authorities of this computer, and those of the file that `SSL_CERT_FILE` names.

    Raises
    ------
    LinkRejected
        The server's certificate is none to trust, or it speaks no TLS; to ask again changes nothing.
    LinkError
        The connection broke while it was being made.
    """

    def __init__(self, host: str, port: int, context: ssl.SSLContext | None = None) -> None:
        plain = socket.create_connection((host, port), CONNECT_S)
        self._name = f"{host}:{port}"
        _prepare(plain)
        context = ssl.create_default_context() if context is None else context
        try:
            self._socket = context.wrap_socket(plain, server_hostname=host)
        except ssl.SSLEOFError as error:
            plain.close()
            raise LinkError.say("it hung up while TLS began: is this its TLS port?") from error
        except ssl.SSLError as error:
            plain.close()
            raise LinkRejected(tls_problem(error, host)) from error
        except OSError as error:
            plain.close()
            raise LinkError.say("the connection broke while TLS began ({})", error.strerror or error) from error

    def read(self, timeout_s: float) -> Chunk | None:
        """Bytes as they come."""
        # What was decrypted already makes no socket ready.
        if not self._socket.pending() and not _ready([self._socket], timeout_s):
            return None
        try:
            data = self._socket.recv(READ_BYTES)
        except TimeoutError:
            return None  # a part of a record
        except OSError as error:
            raise LinkError.say("the TLS link to {} broke: {}", self._name, error.strerror or error) from error
        if not data:
            raise LinkError.say("{} closed the TLS link", self._name)
        return Chunk("tls", data)

    def write(self, data: bytes) -> None:
        """Send all of it."""
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise LinkError.say("the TLS link to {} broke: {}", self._name, error.strerror or error) from error

    def note_peer(self, origin: Hashable) -> None:
        """Nothing to note: there is one other end."""

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


NO_TLS = ("WRONG_VERSION_NUMBER", "HTTP_REQUEST", "RECORD_LAYER_FAILURE", "PACKET_LENGTH_TOO_LONG")
"""What OpenSSL says where the answer is no TLS."""

CERTIFICATE_EARLY, CERTIFICATE_OVER, CERTIFICATE_REVOKED = 9, 10, 23
CERTIFICATE_NAMES = (62, 64)
CERTIFICATE_ISSUERS = (2, 18, 19, 20, 21)
"""Numbers of OpenSSL (X509_verify_cert_error_string)."""


def tls_problem(error: ssl.SSLError, host: str) -> str:
    """Why TLS does not begin, in words that say what to do."""
    if not isinstance(error, ssl.SSLCertVerificationError):
        if error.reason in NO_TLS:
            return say("it speaks no TLS at this port: ask for its TLS port, or leave ntrips:// out")
        return say("TLS fails ({}): ask its operator which versions it speaks", error.reason or str(error))
    code = error.verify_code
    if code == CERTIFICATE_OVER:
        return say("its certificate is over: is the clock of this computer right? Else its operator has to renew it")
    if code == CERTIFICATE_EARLY:
        return say("its certificate is not valid yet: is the clock of this computer right?")
    if code == CERTIFICATE_REVOKED:
        return say("its certificate was revoked: do not send it a password, and ask its operator")
    if code in CERTIFICATE_NAMES:
        return say("its certificate is for another name than '{}': is the address right?", host)
    if code in CERTIFICATE_ISSUERS:
        return say(
            "nobody whom this computer trusts vouches for its certificate; where it is the operator's own, save it as "
            ".pem, name that file in the environment as SSL_CERT_FILE, and start again"
        )
    return say("its certificate is refused ({})", error.verify_message)


class TcpServerChannel:
    """TCP server: what is written goes to every client; clients come and go."""

    def __init__(self, host: str, port: int) -> None:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        self._server = socket.create_server((host, port), family=family)
        self._clients: dict[socket.socket, int] = {}
        self._numbers = itertools.count()

    @property
    def port(self) -> int:
        """Own port."""
        return int(self._server.getsockname()[1])

    def read(self, timeout_s: float) -> Chunk | None:
        """Bytes of one client; takes in clients that knock."""
        for ready in _ready([self._server, *self._clients], timeout_s):
            if ready is self._server:
                self._accept()
                continue
            try:
                data = ready.recv(READ_BYTES)
            except OSError:
                data = b""
            if data:
                return Chunk(self._clients[ready], data)
            del self._clients[ready]
            ready.close()
        return None

    def _accept(self) -> None:
        # A client may be gone before it is let in.
        with suppress(OSError):
            client, _ = self._server.accept()
            _prepare(client)
            self._clients[client] = next(self._numbers)

    def write(self, data: bytes) -> None:
        """Send to every client; one that is gone is dropped with the next `read`."""
        for client in list(self._clients):
            try:
                client.sendall(data)
            except OSError:
                with suppress(OSError):
                    client.shutdown(socket.SHUT_RDWR)

    def note_peer(self, origin: Hashable) -> None:
        """Nothing to note: every client is answered."""

    def close(self) -> None:
        """Close the server and all connections."""
        for each in (*self._clients, self._server):
            each.close()


def _prepare(connection: socket.socket) -> None:
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    # A client that stopped reading must not hold up the sender for ever.
    connection.settimeout(CONNECT_S)


class SerialChannel:
    """Serial line, through pyserial."""

    def __init__(self, device: str, baud: int) -> None:
        try:
            import serial
        except ImportError as error:
            raise LinkError.say(
                "serial links need the package pyserial; install it, or use a UDP or TCP link"
            ) from error
        self._broken: type[Exception] = serial.SerialException
        self._device = device
        try:
            self._port = serial.Serial(device, baud, timeout=SERIAL_WAIT_S, write_timeout=CONNECT_S)
        except (serial.SerialException, ValueError) as error:
            raise LinkError.say("the serial line {} cannot be opened: {}", device, error) from error

    def read(self, timeout_s: float) -> Chunk | None:
        """Bytes as they come; may come back before the time is up."""
        try:
            data = self._port.read(1) if timeout_s > 0.0 else b""
            data += self._port.read(self._port.in_waiting)
        except (self._broken, OSError, TypeError) as error:
            raise LinkError.say("the serial line {} broke: {}", self._device, error) from error
        return Chunk("serial", data) if data else None

    def write(self, data: bytes) -> None:
        """Send all of it."""
        try:
            self._port.write(data)
        except (self._broken, OSError) as error:
            raise LinkError.say("the serial line {} broke: {}", self._device, error) from error

    def note_peer(self, origin: Hashable) -> None:
        """Nothing to note: there is one other end."""

    def close(self) -> None:
        """Close the line."""
        self._port.close()


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
        """The next message of those in `records.py`, or None; from one thread only.

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
            self.channel.note_peer(chunk.origin)
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
            raise InputError.say("link '{}': expected serial:DEVICE:BAUD, such as serial:/dev/ttyUSB0:57600", url)
        return kind, device, int(baud)
    host, _, port = rest.rpartition(":")
    if kind not in _SOCKETS or not host or not port.isdecimal() or int(port) > 65535:
        kinds = ", ".join((*_SOCKETS, "serial"))
        raise InputError.say("link '{}': expected KIND:HOST:PORT, such as tcp:127.0.0.1:5760; kinds are {}", url, kinds)
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
        raise LinkTimeout.say("no answer within {:g} s; is the address right?", CONNECT_S, place=url) from error
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise LinkError.say(
                "{} cannot be opened: another program has this port; end it, or take another", url
            ) from error
        raise LinkError.say("{} cannot be opened: {}; is the address right?", url, error.strerror or error) from error


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


HEARTBEAT_EVERY_S = 1.0


GROUND_HEARTBEAT = Heartbeat(type=6, autopilot=8, base_mode=0, custom_mode=0, system_status=4)
"""MAV_TYPE_GCS, MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE: a vehicle that hears none may think the link lost."""


# State machines without a link, such as transfers, are run over one.

SHORTEST_WAIT_S = 0.02
"""The control step of a simulated vehicle, whose clock stands still in any shorter wait."""

LONGEST_WAIT_S = 0.25
"""How soon a cancelled drive notices."""

Outcome_co = TypeVar("Outcome_co", covariant=True)


class Machine(Protocol[Outcome_co]):
    """A state machine without input and output; times are of one clock that the caller chooses."""

    @property
    def outcome(self) -> Outcome_co | None:
        """None while it runs."""

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called at the latest."""

    def start(self, now_s: float) -> list[Message]:
        """Messages that begin it."""

    def receive(self, received: Received) -> list[Message]:
        """Messages that answer one; those that are none of its business it ignores."""

    def tick(self, now_s: float) -> list[Message]:
        """Messages that are due."""


@runtime_checkable
class Transfer(Protocol):
    """What a machine with much to send has besides."""

    @property
    def progress(self) -> tuple[str, float, float]:
        """What it does, how much of it is done, and of how much."""

    def cancel(self) -> list[Message]:
        """Messages that tell the other end that it is given up."""


def drive(
    machine: Machine[Outcome_co],
    link: Link,
    clock: Clock,
    monitor: Monitor = QUIET,
    watch: Callable[[Received], None] | None = None,
) -> Outcome_co:
    """Run a machine to its outcome; sends a heartbeat each second besides.

    Parameters
    ----------
    clock
        The link's clock.
    watch
        Sees every message that comes in meanwhile, also those that are none of the machine's business.

    Raises
    ------
    LinkError
        The link broke; what the vehicle made of the messages so far is not known.
    OperationCancelled
        By the monitor; the other end was told.
    """
    transfer = machine if isinstance(machine, Transfer) else None
    outgoing = machine.start(clock())
    heartbeat_s = clock()
    try:
        while (outcome := machine.outcome) is None:
            _send(link, outgoing)
            now_s = clock()
            if now_s >= heartbeat_s:
                link.send(GROUND_HEARTBEAT)
                heartbeat_s = now_s + HEARTBEAT_EVERY_S
            monitor.report(*transfer.progress if transfer else ("waiting", 0.0, 0.0))
            received = link.receive(min(LONGEST_WAIT_S, max(SHORTEST_WAIT_S, machine.next_deadline_s - now_s)))
            outgoing = []
            if received is not None:
                if watch is not None:
                    watch(received)
                outgoing = machine.receive(received)
            if machine.outcome is None and clock() >= machine.next_deadline_s:
                outgoing = [*outgoing, *machine.tick(clock())]
    except OperationCancelled:
        if transfer is not None:
            _send(link, transfer.cancel())
        raise
    _send(link, outgoing)
    return outcome


def _send(link: Link, messages: list[Message]) -> None:
    for message in messages:
        link.send(message)
