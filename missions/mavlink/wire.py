"""MAVLink 2 on the wire: messages to bytes and back.

pymavlink's ardupilotmega dialect packs and unpacks. Frames are
found here, not by pymavlink: its parser throws away the whole length that a false start announces, and with it the good
frames behind it, and notes the time stamp of a forged signature before it has checked it.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from missions.mavlink.records import MESSAGES, Address, Field, Message, Received, layout, number
from missions.mavlink.signing import SIGNATURE_BYTES, Signer

MARKER_V1, MARKER_V2 = 0xFE, 0xFD
HEADER_V1, HEADER_V2, CHECKSUM = 6, 10, 2
SIGNED_FLAG = 0x01
HALF_ROUND = 128
"""A frame whose number is further ahead than this is taken for a late one, or a copy: nothing was lost."""

_MARKER = re.compile(b"[\xfd\xfe]")

FILL = {"voltages": 0xFFFF}
"""What fills an array that is shorter than the message's: no such cell. Others are filled with 0."""

_NAMES = {number(name): name for name in MESSAGES}


class Encoder:
    """Messages to frames of one sender; counts its frames and signs them where it has a signer."""

    def __init__(self, source: Address, signer: Signer | None = None) -> None:
        self._signer = signer
        self._mav = dialect.MAVLink(None, srcSystem=source.system, srcComponent=source.component)
        if signer is not None:
            self._mav.signing.secret_key = signer.key
            self._mav.signing.link_id = signer.link_id
            self._mav.signing.sign_outgoing = True

    def encode(self, message: Message) -> bytes:
        """Frame of a message.

        Raises
        ------
        ValueError
            A value does not fit into its field.
        """
        record_layout = layout(type(message).__name__)
        values = {each.name: _to_wire(message, each) for each in record_layout.fields}
        if self._signer is not None:
            self._mav.signing.timestamp = self._signer.next_timestamp()
        try:
            frame: bytes = record_layout.packet(**values).pack(self._mav)
        except (struct.error, OverflowError, TypeError) as error:
            raise ValueError(f"{message} does not fit into its MAVLink message: {error}") from error
        self._mav.seq = (self._mav.seq + 1) % 256
        return frame


def _to_wire(message: Message, field_: Field) -> Any:
    value = getattr(message, field_.name)
    if field_.kind is str:
        text: bytes = value.encode("ascii", errors="replace")
        if len(text) > field_.length:
            raise ValueError(f"{field_.name}: expected at most {field_.length} letters, got '{value}'")
        return text
    if not field_.length:
        return value
    if field_.kind is bytes and len(value) <= field_.length:
        return value.ljust(field_.length, b"\0")
    if len(value) > field_.length:
        raise ValueError(f"{field_.name}: expected at most {field_.length} values, got {len(value)}")
    return [*value, *[FILL.get(field_.name, 0)] * (field_.length - len(value))]


@dataclass(slots=True)
class Counts:
    """What a decoder has seen.

    Parameters
    ----------
    frames
        Whole and right, of messages known to us or not.
    unknown
        Of these, those that are not in `records.MESSAGES`.
    skipped_bytes
        Part of no frame: noise, and frames that came in broken.
    refused
        Frames without a signature that we believe.
    unsigned
        Of these, those without any.
    signed
        Frames with a signature that nobody looked at, because this end does not sign.
    lost
        Frames that never came, by the gaps in each sender's numbers.
    """

    frames: int = 0
    unknown: int = 0
    skipped_bytes: int = 0
    refused: int = 0
    unsigned: int = 0
    signed: int = 0
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame as it came in; `received` is None where its message is not one of ours."""

    data: bytes
    received: Received | None


@dataclass(slots=True)
class Decoder:
    """Bytes of one stream to messages; noise, broken frames and what is not signed as it must be are skipped."""

    signer: Signer | None = None
    counts: Counts = field(default_factory=Counts)
    _buffer: bytearray = field(init=False, default_factory=bytearray)
    _next_seq: dict[Address, int] = field(init=False, default_factory=dict)
    _mav: Any = field(init=False, default_factory=lambda: dialect.MAVLink(None))

    def feed(self, data: bytes, time_s: float, is_whole: bool = False) -> list[Frame]:
        """Frames that are complete with these bytes.

        Parameters
        ----------
        data
            As they came in.
        time_s
            When they came in.
        is_whole
            No frame goes on in the next bytes: datagrams.
        """
        self._buffer += data
        return [frame for raw, packet in self._packets(is_whole) if (frame := self._frame(raw, packet, time_s))]

    def _packets(self, is_whole: bool) -> Iterator[tuple[bytes, Any]]:
        """Frames whose checksum is right, and what pymavlink reads in each; eats the buffer up to the first open one.

        After a false start the search goes on one byte later, so that it costs no frame behind it.
        """
        buffer, position = self._buffer, 0
        try:
            while marker := _MARKER.search(buffer, position):
                self.counts.skipped_bytes += marker.start() - position
                position = marker.start()
                size = _size(buffer, position)
                if size is None or len(buffer) - position < size:
                    if not is_whole:
                        return
                    size = 0
                raw = bytes(buffer[position : position + size])
                packet = self._packet(raw, buffer[position + size : position + size + 1]) if size else None
                if packet is None:
                    self.counts.skipped_bytes += 1
                    position += 1
                    continue
                position += size
                yield raw, packet
            self.counts.skipped_bytes += len(buffer) - position
            position = len(buffer)
        finally:
            del buffer[:position]

    def _packet(self, raw: bytes, after: bytearray) -> Any:
        try:
            packet = self._mav.decode(bytearray(raw))
        except dialect.MAVError:
            return None
        # Nothing proves a frame of a message that the dialect does not know, but that another one follows.
        if isinstance(packet, dialect.MAVLink_unknown) and after and after[0] not in (MARKER_V1, MARKER_V2):
            return None
        return packet

    def _frame(self, raw: bytes, packet: Any, time_s: float) -> Frame | None:
        is_signed = raw[0] == MARKER_V2 and bool(raw[2] & SIGNED_FLAG)
        sequence, source, message_id = _header(raw)
        if self.signer is not None and not (
            self.signer.accepts(raw, source) if is_signed else message_id in self.signer.unsigned_accepted
        ):
            self.counts.refused += 1
            self.counts.unsigned += not is_signed
            return None
        self.counts.frames += 1
        self.counts.signed += is_signed and self.signer is None
        gap = (sequence - self._next_seq.get(source, sequence)) % 256
        if gap < HALF_ROUND:
            self.counts.lost += gap
            self._next_seq[source] = (sequence + 1) % 256
        message = message_of(packet)
        if message is None:
            self.counts.unknown += 1
            return Frame(raw, None)
        return Frame(raw, Received(message, source, time_s))


def _size(buffer: bytearray, start: int) -> int | None:
    """Length of the frame that begins at a marker: None where too little of it is there, 0 if it cannot be one."""
    if len(buffer) - start < 3:
        return None
    marker, length, flags = buffer[start : start + 3]
    if marker == MARKER_V1:
        return HEADER_V1 + int(length) + CHECKSUM
    if flags & ~SIGNED_FLAG:
        return 0
    return HEADER_V2 + int(length) + CHECKSUM + (SIGNATURE_BYTES if flags & SIGNED_FLAG else 0)


def _header(raw: bytes) -> tuple[int, Address, int]:
    """Number, sender and message id of a frame."""
    if raw[0] == MARKER_V1:
        return raw[2], Address(raw[3], raw[4]), raw[5]
    return raw[4], Address(raw[5], raw[6]), int.from_bytes(raw[7:10], "little")


def message_of(packet: Any) -> Message | None:
    """Our record of a message that pymavlink has decoded; None where it is none of ours."""
    name = _NAMES.get(packet.get_msgId())
    if name is None:
        return None
    record_layout = layout(name)
    return record_layout.record(**{each.name: _from_wire(packet, each) for each in record_layout.fields})


def message_id(record: type[Message]) -> int:
    """Number of a message of ours."""
    return number(record.__name__)


def _from_wire(packet: Any, field_: Field) -> Any:
    if field_.kind is bytes:
        return getattr(packet, f"_{field_.name}_raw").ljust(field_.length, b"\0")
    value = getattr(packet, field_.name)
    return tuple(value) if isinstance(value, list) else value
