"""RTK corrections: RTCM 3 out of bytes, what a message says of its base, and its way to the receiver over MAVLink.

RTCM 10403.x: a frame is 0xD3, six bits zero, ten bits of length, the message, and CRC-24Q over all before it. The
station's place is in messages 1005 and 1006. GPS_RTCM_DATA carries a frame in up to four pieces of 180 bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from missions.mavlink.messages import GpsRtcmData, Message
from planning.geo.frames import Vec3

PREAMBLE = 0xD3
HEADER, CRC = 3, 3
MAX_MESSAGE = 1023

PIECE = 180
PIECES = 4
MAX_SENT = PIECE * PIECES
"""A longer frame cannot be carried: MAVLink has two bits for the number of a piece."""

SEQUENCES = 32
BASE_MESSAGES = (1005, 1006)


def _table() -> tuple[int, ...]:
    """CRC-24Q (polynomial 0x1864CFB, from 0) of each byte."""
    table = []
    for byte in range(256):
        register = byte << 16
        for _ in range(8):
            register = (register << 1) ^ (0x1864CFB if register & 0x800000 else 0)
        table.append(register & 0xFFFFFF)
    return tuple(table)


_TABLE = _table()


def crc24q(data: bytes) -> int:
    """CRC-24Q of RTCM 3 (and of SBAS)."""
    register = 0
    for byte in data:
        register = (register << 8 & 0xFFFFFF) ^ _TABLE[(register >> 16) ^ byte]
    return register


@dataclass(frozen=True, slots=True)
class RtcmFrame:
    """A frame whose checksum is right, as it is sent on."""

    data: bytes

    @property
    def message(self) -> bytes:
        """What is in it."""
        return self.data[HEADER:-CRC]

    @property
    def type(self) -> int:
        """Number of the message; 0 for a message too short to have one."""
        return int.from_bytes(self.message[:2], "big") >> 4 if len(self.message) >= 2 else 0

    @property
    def base_ecef_m(self) -> Vec3 | None:
        """Antenna's reference point of the station (1005, 1006): DF025 to DF027, 0.1 mm; None for other messages."""
        if self.type not in BASE_MESSAGES or len(self.message) < 19:
            return None
        bits, size = int.from_bytes(self.message, "big"), 8 * len(self.message)

        def signed(first: int) -> float:
            value = bits >> (size - first - 38) & (1 << 38) - 1
            return 1e-4 * (value - (1 << 38) if value >> 37 else value)

        return (signed(34), signed(74), signed(114))


@dataclass(slots=True)
class RtcmDecoder:
    """Bytes of one stream to frames; what is none, or came in broken, is skipped byte by byte and counted."""

    n_skipped: int = 0
    _buffer: bytearray = field(default_factory=bytearray)

    def feed(self, data: bytes) -> list[RtcmFrame]:
        """Frames that are complete with these bytes."""
        self._buffer += data
        frames, at, buffer = [], 0, self._buffer
        while True:
            start = buffer.find(PREAMBLE, at)
            if start < 0:
                self.n_skipped += len(buffer) - at
                at = len(buffer)
                break
            self.n_skipped += start - at
            at = start
            if len(buffer) - at < HEADER:
                break
            # The six bits before the length are zero: most false starts end here.
            length = (buffer[at + 1] << 8 | buffer[at + 2]) if buffer[at + 1] < 4 else -1
            end = at + HEADER + length + CRC
            if length >= 0 and end > len(buffer):
                break
            if length >= 0 and crc24q(bytes(buffer[at : end - CRC])) == int.from_bytes(buffer[end - CRC : end], "big"):
                frames.append(RtcmFrame(bytes(buffer[at:end])))
                at = end
            else:
                self.n_skipped += 1
                at += 1
        del buffer[:at]
        return frames


def rtcm_messages(frame: RtcmFrame, sequence: int) -> list[Message]:
    """A frame as GPS_RTCM_DATA; nothing where it is too long to be carried.

    A receiver takes a frame for complete with the first piece that is not full, or with the fourth: a frame of 360
    bytes needs a third piece with nothing in it.

    Parameters
    ----------
    sequence
        Of the frame; 5 bits of it are sent.
    """
    data = frame.data
    if len(data) > MAX_SENT:
        return []
    number = (sequence % SEQUENCES) << 3
    if len(data) <= PIECE:
        return [_piece(data, number)]
    pieces = [data[start : start + PIECE] for start in range(0, len(data), PIECE)]
    if len(pieces) < PIECES and len(pieces[-1]) == PIECE:
        pieces.append(b"")
    return [_piece(piece, 1 | place << 1 | number) for place, piece in enumerate(pieces)]


def _piece(data: bytes, flags: int) -> Message:
    return GpsRtcmData(flags, len(data), tuple(data.ljust(PIECE, b"\0")))


@dataclass(slots=True)
class RtcmAssembler:
    """The vehicle's end: pieces to what was sent; a frame of which a piece is lost never comes."""

    _sequence: int = -1
    _pieces: dict[int, bytes] = field(default_factory=dict)

    def receive(self, message: GpsRtcmData) -> bytes | None:
        """Take a piece; the whole frame where it completes one."""
        data = bytes(message.data[: min(message.len, PIECE)])
        if not message.flags & 1:
            return data
        place, sequence = message.flags >> 1 & 3, message.flags >> 3
        if sequence != self._sequence:
            self._sequence, self._pieces = sequence, {}
        self._pieces[place] = data
        short = next((n for n in range(PIECES) if len(self._pieces.get(n, bytes(PIECE))) < PIECE), PIECES - 1)
        if all(n in self._pieces for n in range(short + 1)):
            whole = b"".join(self._pieces[n] for n in range(short + 1))
            self._sequence, self._pieces = -1, {}
            return whole
        return None


def gga_sentence(lat_deg: float, lon_deg: float, altitude_amsl_m: float, geoid_m: float, utc_s: float) -> bytes:
    """A GGA sentence (NMEA 0183) that tells a caster of virtual stations where the aircraft is.

    Parameters
    ----------
    utc_s
        Seconds since 1970 UTC.
    """

    def angle(value: float, width: int) -> str:
        # Whole numbers, so that no minutes are rounded to 60.
        degrees, rest = divmod(round(abs(value) * 60e7), 60 * 10**7)
        return f"{degrees:0{width}d}{rest / 1e7:010.7f}"

    in_day = utc_s % 86400.0
    time = f"{int(in_day // 3600):02d}{int(in_day // 60 % 60):02d}{in_day % 60 // 1:02.0f}.00"
    latitude = f"{angle(lat_deg, 2)},{'S' if lat_deg < 0 else 'N'}"
    longitude = f"{angle(lon_deg, 3)},{'W' if lon_deg < 0 else 'E'}"
    body = f"GPGGA,{time},{latitude},{longitude},1,12,1.0,{altitude_amsl_m:.3f},M,{geoid_m:.3f},M,,"
    check = 0
    for character in body.encode():
        check ^= character
    return f"${body}*{check:02X}\r\n".encode()


WGS84_A_M, WGS84_F = 6378137.0, 1.0 / 298.257223563


def ecef_m(lat_deg: float, lon_deg: float, height_ellipsoid_m: float) -> Vec3:
    """Earth-centred place on WGS 84 (Hofmann-Wellenhof and others, 2008, Eq. 8.3).

    Stations state theirs in the ITRF or a national realisation, decimetres from it: far less than what is asked here.
    """
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    e2 = WGS84_F * (2.0 - WGS84_F)
    normal_m = WGS84_A_M / math.sqrt(1.0 - e2 * math.sin(lat) ** 2)
    level_m = (normal_m + height_ellipsoid_m) * math.cos(lat)
    return (
        level_m * math.cos(lon),
        level_m * math.sin(lon),
        (normal_m * (1.0 - e2) + height_ellipsoid_m) * math.sin(lat),
    )


def distance_m(one: Vec3, other: Vec3) -> float:
    """Straight distance of two ECEF places."""
    return math.dist(one, other)


def types_text(types: Sequence[int]) -> str:
    """Numbers of messages: `1005, 1077, 1087`."""
    return ", ".join(map(str, sorted(set(types))))
