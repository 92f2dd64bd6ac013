from __future__ import annotations

import math
import struct
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from missions.mavlink.messages import (
    Address,
    AutopilotVersion,
    BatteryStatus,
    CommandLong,
    Heartbeat,
    Message,
    MissionAck,
    MissionItemInt,
    ParamExtSet,
    ParamValue,
    SetupSigning,
    Statustext,
)
from missions.mavlink.records import MESSAGES, RAW, layout
from missions.mavlink.wire import Decoder, Encoder

OWN = Address(255, 190)
RECORDS = [layout(name).record for name in MESSAGES]
HEARTBEAT = Heartbeat(2, 3, 81, 4, 4)
ITEM = MissionItemInt(1, 1, 3, 3, 16, 0, 1, 2.0, 0.0, 0.0, math.nan, 223372000, 1142636000, 20.5)


def packet_of(record: type[Message]) -> Any:
    name = "".join("_" + letter if letter.isupper() else letter for letter in record.__name__).lower().strip("_")
    return getattr(dialect, f"MAVLink_{name}_message")


RANGES = {"uint8_t": (0, 255), "int8_t": (-128, 127), "uint16_t": (0, 65535), "int16_t": (-32768, 32767)}
RANGES |= {"uint32_t": (0, 2**32 - 1), "int32_t": (-(2**31), 2**31 - 1), "uint64_t": (0, 2**64 - 1)}
RANGES |= {"int64_t": (-(2**63), 2**63 - 1)}
LETTERS = st.characters(min_codepoint=32, max_codepoint=126)


def values(packet: Any, name: str) -> st.SearchStrategy[Any]:
    kind = packet.fieldtypes[packet.fieldnames.index(name)]
    length = packet.array_lengths[packet.ordered_fieldnames.index(name)]
    if kind == "char" and name in RAW:
        return st.binary(min_size=length, max_size=length)
    if kind == "char":
        return st.text(LETTERS, max_size=length)
    one: st.SearchStrategy[Any] = st.floats(width=32) if kind == "float" else st.integers(*RANGES[kind])
    return st.lists(one, min_size=length, max_size=length).map(tuple) if length else one


def messages_of(record: type[Message]) -> st.SearchStrategy[Message]:
    packet = packet_of(record)
    return st.builds(record, **{each.name: values(packet, each.name) for each in fields(record)})


def same(a: Message, b: Message) -> bool:
    """Equal, NaN like NaN."""
    return type(a) is type(b) and all(repr(getattr(a, f.name)) == repr(getattr(b, f.name)) for f in fields(a))


def decoded(data: bytes, is_whole: bool = False) -> list[Message | None]:
    return [each.received and each.received.message for each in Decoder().feed(data, 0.0, is_whole)]


@pytest.mark.long
@pytest.mark.few(11)
@given(data=st.data())
@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_every_message_comes_back_as_it_was(record: type[Message], data: st.DataObject) -> None:
    message = data.draw(messages_of(record))
    (frame,) = Decoder().feed(Encoder(OWN).encode(message), 7.5)
    assert frame.received is not None
    assert same(frame.received.message, message)
    assert (frame.received.source, frame.received.time_s) == (OWN, 7.5)


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_frames_are_those_that_pymavlink_reads(record: type[Message]) -> None:
    packet = packet_of(record)
    zeros = {each.name: 0 for each in fields(record)}
    for name, kind in zip(packet.fieldnames, packet.fieldtypes, strict=True):
        length = packet.array_lengths[packet.ordered_fieldnames.index(name)]
        if name in zeros:
            letters = b"" if name in RAW else ""
            zeros[name] = letters if kind == "char" else (0,) * length if length else 0
    frame = Encoder(Address(7, 8)).encode(record(**zeros))
    reader = dialect.MAVLink(None)
    (read,) = reader.parse_buffer(frame)
    assert (read.get_srcSystem(), read.get_srcComponent(), read.get_msgId()) == (7, 8, packet.id)


def test_frame_of_a_known_message_byte_by_byte() -> None:
    # Worked by hand from the MAVLink 2 serialisation page: header, payload with custom_mode first, no zeros at the end.
    frame = Encoder(OWN).encode(Heartbeat(6, 8, 0, 0, 4))
    assert frame[:10] == bytes([0xFD, 9, 0, 0, 0, 255, 190, 0, 0, 0])
    assert frame[10:19] == struct.pack("<IBBBBB", 0, 6, 8, 0, 4, 3)
    assert len(frame) == 21


def test_frames_are_numbered_and_gaps_are_counted_for_each_sender() -> None:
    one, other = Encoder(OWN), Encoder(Address(1, 1))
    frames = [one.encode(HEARTBEAT) for _ in range(300)]
    decoder = Decoder()
    for number in (0, 1, 5, 299):
        decoder.feed(frames[number], 0.0)
        decoder.feed(other.encode(HEARTBEAT), 0.0)
    # 2, 3, 4; then 6 to 298 with the number going round at 256.
    assert decoder.counts.lost == 3 + (299 - 6) % 256
    assert decoder.counts.frames == 8


def test_copies_and_late_frames_are_no_loss() -> None:
    encoder, decoder = Encoder(OWN), Decoder()
    frames = [encoder.encode(HEARTBEAT) for _ in range(6)]
    for number in (0, 0, 2, 1, 3, 3, 4, 5):
        decoder.feed(frames[number], 0.0)
    # The gap before number 2 counts, as nothing tells then that 1 will come late.
    assert decoder.counts.lost == 1


@given(pieces=st.lists(st.integers(1, 40), min_size=1, max_size=30))
def test_frames_are_found_however_the_bytes_are_cut(pieces: list[int]) -> None:
    encoder = Encoder(OWN)
    data = b"".join(encoder.encode(each) for each in (HEARTBEAT, ITEM, Statustext(4, "hello"))) * 3
    decoder, found, at = Decoder(), [], 0
    for size in (*pieces, len(data)):
        found += decoder.feed(data[at : at + size], 0.0)
        at += size
    assert [type(f.received.message) for f in found if f.received] == [Heartbeat, MissionItemInt, Statustext] * 3
    assert decoder.counts.skipped_bytes == 0


@given(noise=st.binary(max_size=60), cut=st.integers(0, 40))
def test_noise_and_cut_frames_cost_no_whole_frame_of_a_datagram(noise: bytes, cut: int) -> None:
    encoder = Encoder(OWN)
    broken = encoder.encode(ITEM)[:cut]
    found = decoded(noise + broken + encoder.encode(HEARTBEAT), is_whole=True)
    # A frame of a message that the dialect does not know has no checksum: noise that announces one may swallow bytes.
    assert HEARTBEAT in found or None in found


def test_frame_behind_a_false_start_is_found_where_pymavlink_loses_it() -> None:
    encoder = Encoder(OWN)
    data = b"\xfd\x40\x00" + b"".join(encoder.encode(HEARTBEAT) for _ in range(6))
    assert decoded(data) == [HEARTBEAT] * 6
    reader = dialect.MAVLink(None)
    reader.robust_parsing = True
    read = [each for each in reader.parse_buffer(bytearray(data)) or [] if each.get_type() == "HEARTBEAT"]
    assert len(read) < 6


@given(bit=st.integers(0, 8 * len(Encoder(OWN).encode(ITEM)) - 1))
def test_frame_with_any_bit_turned_is_not_taken(bit: int) -> None:
    frame = bytearray(Encoder(OWN).encode(ITEM))
    frame[bit // 8] ^= 1 << bit % 8
    assert not any(isinstance(each, MissionItemInt) for each in decoded(bytes(frame), is_whole=True))


def test_half_a_datagram_does_not_spoil_the_next() -> None:
    decoder, encoder = Decoder(), Encoder(OWN)
    assert decoder.feed(encoder.encode(ITEM)[:20], 0.0, is_whole=True) == []
    assert len(decoder.feed(encoder.encode(HEARTBEAT), 0.0, is_whole=True)) == 1


def test_unknown_messages_are_counted_and_kept_as_frames_for_the_log() -> None:
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    # SCALED_PRESSURE is in the dialect and not among our records.
    data = dialect.MAVLink_scaled_pressure_message(0, 1.0, 2.0, 3).pack(sender)
    decoder = Decoder()
    (frame,) = decoder.feed(data, 0.0)
    assert (frame.data, frame.received) == (data, None)
    assert (decoder.counts.frames, decoder.counts.unknown) == (1, 1)


def test_mavlink_1_frames_are_read() -> None:
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    data = dialect.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(sender, force_mavlink1=True)
    assert data[0] == 0xFE
    assert decoded(data) == [HEARTBEAT]


def test_frames_with_flags_that_we_do_not_know_are_not_taken() -> None:
    frame = bytearray(Encoder(OWN).encode(HEARTBEAT))
    frame[2] = 0x02
    assert decoded(bytes(frame), is_whole=True) == []


def test_fields_that_the_record_does_not_name_are_zero() -> None:
    packet = dialect.MAVLink(None).decode(bytearray(Encoder(OWN).encode(AutopilotVersion(7, 1))))
    assert (packet.capabilities, packet.uid, packet.flight_custom_version) == (7, 0, [0] * 8)


def test_message_with_more_fields_than_we_know_is_read_without_them() -> None:
    # A newer MISSION_ACK goes on with an opaque_id of 4 bytes; the checksum covers only how the message began.
    frame = bytearray(Encoder(OWN).encode(MissionAck(1, 1, 14, 2)))
    longer = bytearray([*frame[:1], 8, *frame[2:14], 1, 2, 3, 4])
    checksum = dialect.x25crc(longer[1:])
    checksum.accumulate(bytes([dialect.MAVLink_mission_ack_message.crc_extra]))
    assert decoded(bytes(longer + struct.pack("<H", checksum.crc))) == [MissionAck(1, 1, 14, 2)]


def test_fewer_battery_cells_are_filled_with_no_such_cell() -> None:
    battery = BatteryStatus(0, 0, 1, 2500, (4100, 4099), 100, 20, -1, 80)
    (found,) = decoded(Encoder(OWN).encode(battery))
    assert isinstance(found, BatteryStatus)
    assert found.voltages == (4100, 4099, *[65535] * 8)


def test_name_of_16_letters_needs_no_end() -> None:
    value = ParamValue("ABCDEFGHIJKLMNOP", 1.0, 9, 1, 0)
    assert decoded(Encoder(OWN).encode(value)) == [value]


def test_letters_that_are_not_ascii_are_replaced() -> None:
    (found,) = decoded(Encoder(OWN).encode(Statustext(4, "Höhe")))
    assert found == Statustext(4, "H?he")


@pytest.mark.parametrize(
    "message",
    [
        Heartbeat(256, 3, 0, 0, 0),
        CommandLong(-1, 1, 400),
        CommandLong(1, 1, 400, param1=1e39),
        Statustext(4, "x" * 51),
        ParamValue("ABCDEFGHIJKLMNOPQ", 1.0, 9, 1, 0),
        BatteryStatus(0, 0, 1, 2500, (4100,) * 11, 100, 20, -1, 80),
        SetupSigning(1, 1, (256,) * 32, 0),
        ParamExtSet(1, 100, "CAM_ISO", bytes(129), 5),
    ],
    ids=lambda message: type(message).__name__,
)
def test_value_that_does_not_fit_its_field_is_a_wrong_call(message: Message) -> None:
    with pytest.raises(ValueError, match=r"expected at most|does not fit"):
        Encoder(OWN).encode(message)
