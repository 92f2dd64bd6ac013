"""Video by RTP without RTSP, as companion boards and simulators send it: recognised by its packets, opened by an SDP.

RTP itself says nothing of dynamic payload types (96 to 127); who receives it needs a session description (SDP, RFC
8866). Where none is given, the first packets tell: MPEG transport streams by their sync bytes (RFC 2250), H.264 and
H.265 by the types of their units (RFC 6184, table 1; RFC 7798, section 1.1.4). A description that is given is read,
never passed on: the decoder gets one that is written here from its port, payload type and encoding alone.
"""

from __future__ import annotations

import ipaddress
import re
import socket
import struct
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from planning.base.errors import InputError

ENCODINGS = {"H264": 90000, "H265": 90000, "JPEG": 90000, "MP2T": 90000}
"""Names of RTP payloads (IANA) that are read, and their clocks."""

STATIC_TYPES = {26: "JPEG", 33: "MP2T"}
"""Payload types that RFC 3551 gives away."""

DYNAMIC = range(96, 128)
USUAL_TYPE = 96

ADDRESS = re.compile(
    r"rtp://(?P<host>[A-Za-z0-9.]+):(?P<port>\d{1,5})/(?P<encoding>H264|H265|JPEG|MP2T)(?:/(?P<type>\d{1,3}))?"
    r"(?:\?sprop-parameter-sets=(?P<sets>[A-Za-z0-9+/=,]+))?",
    re.ASCII,
)

TS_CELL, TS_SYNC = 188, 0x47
N_PACKETS, LISTEN_S = 64, 4.0
"""A keyframe with its parameter sets comes about every second."""

MAX_SDP_BYTES = 10_000


@dataclass(frozen=True, slots=True)
class RtpVideo:
    """A video stream by RTP.

    Parameters
    ----------
    host
        Where it is received: an address of this computer, or of a group of many.
    sets
        H.264's parameter sets in base64, where they do not come in the stream; empty: they do.
    """

    host: str
    port: int
    encoding: str
    payload_type: int = USUAL_TYPE
    sets: str = ""

    @property
    def url(self) -> str:
        """As `rtp_of` takes it."""
        sets = f"?sprop-parameter-sets={self.sets}" if self.sets else ""
        return f"rtp://{self.host}:{self.port}/{self.encoding}/{self.payload_type}{sets}"

    def sdp(self) -> str:
        """Session description for the decoder."""
        number, clock = self.payload_type, ENCODINGS[self.encoding]
        lines = [
            *("v=0", "o=- 0 0 IN IP4 127.0.0.1", "s=video", f"c=IN IP4 {self.host}", "t=0 0"),
            *(f"m=video {self.port} RTP/AVP {number}", f"a=rtpmap:{number} {self.encoding}/{clock}"),
        ]
        if self.encoding == "H264":
            sets = f";sprop-parameter-sets={self.sets}" if self.sets else ""
            packing = f"a=fmtp:{number} packetization-mode=1{sets}"
            lines.append(packing)
        return "\r\n".join([*lines, ""])


def rtp_of(url: str) -> RtpVideo | None:
    """The stream of an address `rtp://HOST:PORT/ENCODING[/TYPE]`; None for any other."""
    found = ADDRESS.fullmatch(url)
    if found is None:
        return None
    port, number = int(found["port"]), int(found["type"] or USUAL_TYPE)
    usual = next((each for each, name in STATIC_TYPES.items() if name == found["encoding"]), USUAL_TYPE)
    number = usual if found["type"] is None else number
    try:
        ipaddress.IPv4Address(found["host"])
    except ValueError:
        return None
    if not 0 < port < 65536 or not (number in DYNAMIC or STATIC_TYPES.get(number) == found["encoding"]):
        return None
    return RtpVideo(found["host"], port, found["encoding"], number, found["sets"] or "")


def read_sdp(text: str, place: object) -> RtpVideo:
    """The first video of a session description that is read here.

    Raises
    ------
    InputError
        There is none, or it is no description.
    """
    lines = [line.strip() for line in text[:MAX_SDP_BYTES].splitlines()]
    if not lines or lines[0] != "v=0":
        raise InputError.say("is no session description (SDP): expected it to begin with v=0", place=place)
    host, media = "0.0.0.0", None
    maps: dict[int, str] = {}
    sets: dict[int, str] = {}
    is_ours = True
    for line in lines:
        if found := re.fullmatch(r"m=(\w+) (\d{1,5})(?:/\d+)? RTP/AVP (\d{1,3})(?: .*)?", line):
            is_ours = found[1] == "video" and media is None
            media = (int(found[2]), int(found[3])) if is_ours else media
        elif line.startswith("m="):
            is_ours = False
        elif not is_ours:
            continue
        elif found := re.fullmatch(r"c=IN IP4 ([0-9.]+)(?:/\d+)*", line):
            host = found[1]
        elif found := re.fullmatch(r"a=rtpmap:(\d{1,3}) ([A-Za-z0-9-]+)/(\d+)(?:/.*)?", line):
            maps[int(found[1])] = found[2].upper()
        elif found := re.match(r"a=fmtp:(\d{1,3}) .*sprop-parameter-sets=([A-Za-z0-9+/=,]+)", line):
            sets[int(found[1])] = found[2]
    if media is None:
        raise InputError.say("describes no video by RTP", place=place)
    port, number = media
    encoding = maps.get(number, STATIC_TYPES.get(number, ""))
    own = RtpVideo(received_at(host), port, encoding, number, sets.get(number, ""))
    if encoding not in ENCODINGS or rtp_of(own.url) is None:
        known = ", ".join(ENCODINGS)
        raise InputError.say(
            "describes a video as '{}'; expected one of {} to a port", encoding[:20], known, place=place
        )
    return own


def received_at(host: str) -> str:
    """Where a stream for a host arrives: at the group's own address, or at any of this computer's."""
    try:
        return host if ipaddress.IPv4Address(host).is_multicast else "0.0.0.0"
    except ValueError:
        return "0.0.0.0"


def recognised(packets: Iterable[bytes], host: str, port: int) -> RtpVideo | None:
    """What packets of a port are: a video by RTP, or None for a transport stream and all that is not known."""
    votes: dict[tuple[str, int], int] = {}
    for packet in packets:
        if len(packet) < 14 or packet[0] >> 6 != 2:
            continue
        number, start = packet[1] & 0x7F, 12 + 4 * (packet[0] & 0x0F)
        if packet[0] & 0x10 and len(packet) >= start + 4:
            start += 4 + 4 * struct.unpack_from(">H", packet, start + 2)[0]
        payload = packet[start : start + 2]
        encoding = STATIC_TYPES.get(number) or (_unit(payload) if number in DYNAMIC and len(payload) == 2 else "")
        if encoding:
            votes[encoding, number] = votes.get((encoding, number), 0) + 1
    if not votes:
        return None
    encoding, number = max(votes, key=lambda each: votes[each])
    return RtpVideo(received_at(host), port, encoding, number)


H264_UNITS = frozenset((1, 5, 6, 7, 8, 9, 24, 28))
H265_UNITS = frozenset((0, 1, 19, 20, 21, 32, 33, 34, 35, 39, 48, 49))
"""Slices, parameter sets, delimiters and messages, and the aggregated and fragmented units of RTP."""


def _unit(header: bytes) -> str:
    """Encoding of the unit that begins so: H.265's second byte says layer 0 and the lowest sublayer, as all send it."""
    first, second = header
    if first & 0x80:
        return ""
    if not first & 0x01 and second == 0x01 and first >> 1 in H265_UNITS:
        return "H265"
    return "H264" if first & 0x1F in H264_UNITS else ""


def is_transport_stream(packet: bytes) -> bool:
    """Whether a packet is cells of an MPEG transport stream."""
    return len(packet) >= TS_CELL and len(packet) % TS_CELL == 0 and packet[0] == TS_SYNC


def listen(host: str, port: int, is_over: Callable[[], bool]) -> RtpVideo | None:
    """Look at what arrives at a port for some seconds; None where that is a transport stream, unknown, or nothing.

    Raises
    ------
    OSError
        The port cannot be opened.
    """
    packets: list[bytes] = []
    at = received_at(host)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        ear.bind(("", port))
        if at != "0.0.0.0":
            group = struct.pack("=4s4s", socket.inet_aton(at), socket.inet_aton("0.0.0.0"))
            ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        ear.settimeout(0.2)
        end_s = time.monotonic() + LISTEN_S
        while len(packets) < N_PACKETS and time.monotonic() < end_s and not is_over():
            try:
                packet = ear.recv(65536)
            except TimeoutError:
                continue
            if is_transport_stream(packet):
                return None
            packets.append(packet)
    return recognised(packets, host, port)
