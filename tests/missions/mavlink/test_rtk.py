"""RTCM 3 and its way over MAVLink, and what casters answer: published examples, properties, and hostile ones."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer

from missions.mavlink.messages import Address, GpsRtcmData
from missions.mavlink.ntrip import EXAMPLE_CASTER, MAX_HEAD, AnswerState, Caster, CasterAnswer, caster_of
from missions.mavlink.rtk import (
    MAX_MESSAGE,
    MAX_SENT,
    PIECE,
    RtcmAssembler,
    RtcmDecoder,
    RtcmFrame,
    crc24q,
    ecef_m,
    gga_sentence,
    rtcm_messages,
    types_text,
)
from missions.mavlink.wire import Decoder, Encoder
from missions.simulator.autopilot.corrections import CorrectionsReceiver
from planning.base.errors import InputError

EXAMPLE = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33360B98")
"""A message 1005 as RTCM 10403.x prints it: station 2003, and this place of its antenna."""

EXAMPLE_ECEF_M = (1114104.5999, -4850729.7108, 3975521.4643)


def framed(message: bytes) -> bytes:
    head = bytes([0xD3]) + len(message).to_bytes(2, "big") + message
    return head + crc24q(head).to_bytes(3, "big")


# RTCM


def test_the_standards_own_example_is_read():
    (frame,) = RtcmDecoder().feed(EXAMPLE)
    assert frame.type == 1005
    assert frame.base_ecef_m == pytest.approx(EXAMPLE_ECEF_M, abs=1e-9)
    assert framed(frame.message) == EXAMPLE


@given(st.binary(max_size=300))
def test_the_checksum_is_the_polynomials(data):
    """Bit by bit: x^24 + x^23 + x^18 + x^17 + x^14 + x^11 + x^10 + x^7 + x^6 + x^5 + x^4 + x^3 + x + 1."""
    register = 0
    for byte in data:
        for bit in range(7, -1, -1):
            out = register >> 23 ^ (byte >> bit & 1)
            register = register << 1 & 0xFFFFFF ^ (0x864CFB if out else 0)
    assert crc24q(data) == register


messages = st.lists(st.binary(max_size=MAX_MESSAGE), max_size=6)
noise = st.lists(st.binary(max_size=40).map(lambda data: data.replace(b"\xd3", b"\0")), min_size=7, max_size=7)


@given(messages, noise, st.integers(1, 400))
def test_frames_are_found_between_noise_however_the_bytes_are_cut(bodies, between, cut):
    stream = between[0] + b"".join(framed(body) + gap for body, gap in zip(bodies, between[1:], strict=False))
    decoder = RtcmDecoder()
    found = [frame for at in range(0, len(stream), cut) for frame in decoder.feed(stream[at : at + cut])]
    assert [frame.message for frame in found] == bodies
    assert decoder.n_skipped == len(stream) - sum(len(frame.data) for frame in found)


@given(st.binary(min_size=1, max_size=200), st.integers(0, 10**6), st.integers(1, 255))
def test_a_frame_with_a_changed_byte_is_skipped_and_the_next_one_is_found(body, place, change):
    damaged = bytearray(framed(body))
    damaged[3 + place % (len(damaged) - 3)] ^= change
    decoder = RtcmDecoder()
    # Enough behind it that a false start waits for no more bytes.
    found = decoder.feed(bytes(damaged) + framed(b"good") + bytes(1100))
    assert [frame.message for frame in found] == [b"good"]


@given(st.binary(max_size=3000))
def test_nonsense_is_skipped_and_never_kept_beyond_one_frame(data):
    decoder = RtcmDecoder()
    for frame in decoder.feed(data):
        assert frame.type >= 0
        assert frame.base_ecef_m is None or len(frame.base_ecef_m) == 3
    assert len(decoder._buffer) <= 1029


@given(st.integers(1, MAX_SENT), st.integers(0, 100), st.booleans())
def test_what_goes_in_pieces_comes_out_whole(size, sequence, is_wired):
    data = bytes(n % 251 for n in range(size))
    pieces = rtcm_messages(RtcmFrame(data), sequence)
    if is_wired:
        decoder, encoder = Decoder(), Encoder(Address(255, 190))
        pieces = [f.received.message for piece in pieces for f in decoder.feed(encoder.encode(piece), 0.0)]
    assembler = RtcmAssembler()
    came = [assembler.receive(piece) for piece in pieces]
    assert came[:-1] == [None] * (len(came) - 1)
    assert came[-1] == data
    assert len(pieces) == (1 if size <= PIECE else 4 if size == MAX_SENT else size // PIECE + 1)


def test_frames_that_cannot_be_carried_are_none():
    assert rtcm_messages(RtcmFrame(bytes(MAX_SENT + 1)), 0) == []


def test_a_frame_that_lacks_a_piece_never_comes_and_does_not_mix_with_the_next():
    assembler = RtcmAssembler()
    first, second = (rtcm_messages(RtcmFrame(bytes([n]) * 400), n) for n in (1, 2))
    assert [assembler.receive(piece) for piece in (first[0], first[2])] == [None, None]
    assert [assembler.receive(piece) for piece in second][-1] == bytes([2]) * 400
    assert assembler.receive(GpsRtcmData(0, 255, (7,) * 180)) == bytes([7]) * 180


def test_the_vehicles_fix_follows_its_corrections():
    receiver, frame = CorrectionsReceiver(needs=True), RtcmFrame(EXAMPLE)
    assert receiver.fix_type(6, 0.0) == 3
    for second in range(15):
        for piece in rtcm_messages(frame, second):
            receiver.receive(piece, float(second))
        assert receiver.fix_type(6, float(second)) == (5 if second < 10 else 6)
    assert receiver.fix_type(6, 25.0) == 3
    assert CorrectionsReceiver().fix_type(6, 0.0) == 6
    assert {each.type for each in receiver.frames} == {1005}


# Places


@given(st.floats(-90, 90), st.floats(-180, 180), st.floats(-500, 9000))
def test_earth_centred_places_are_projs(lat, lon, height):
    theirs = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True).transform(lon, lat, height)
    assert math.dist(ecef_m(lat, lon, height), theirs) < 1e-6


def test_a_gga_sentence_is_the_published_one():
    """Form and checksum as in NMEA 0183; the checksum is an exclusive or of all between the marks."""
    text = gga_sentence(48.1173, 11.516666666666667, 545.4, 46.9, 86400.0 * 20000 + 45319.0).decode()
    body, _, check = text[1:].strip().partition("*")
    assert body == "GPGGA,123519.00,4807.0380000,N,01131.0000000,E,1,12,1.0,545.400,M,46.900,M,,"
    value = 0
    for letter in body:
        value ^= ord(letter)
    assert check == f"{value:02X}"
    assert b",5959.9999999,S," in gga_sentence(-59.99999999833333, -0.5, 0.0, 0.0, 0.0)
    assert b",00030.0000000,W," in gga_sentence(-60.0, -0.5, 0.0, 0.0, 0.0)


# Casters


def test_addresses_are_taken_apart_and_passwords_are_refused():
    assert caster_of(EXAMPLE_CASTER) == Caster("rtk.example.org", 2101, "VRS", "me")
    assert caster_of("ntrip://me@x.org@h/M") == Caster("h", 2101, "M", "me@x.org")
    assert caster_of("10.0.0.1:80/A") == Caster("10.0.0.1", 80, "A")
    assert caster_of("ntrips://me@h/M") == caster_of("https://me@h/M") == Caster("h", 443, "M", "me", is_tls=True)
    assert caster_of("ntrips://h:2102/M") == Caster("h", 2102, "M", is_tls=True)
    with pytest.raises(InputError, match="leave it out of the address"):
        caster_of("me:secret@h/M")
    for text in ("", "h", "h/", "h:0/M", "h:70000/M", "h:x/M", "me@/M", "h/M N", "höst/M"):
        with pytest.raises(InputError, match="expected USER@HOST:PORT/MOUNTPOINT") as refused:
            caster_of(text)
        assert "secret" not in str(refused.value)


def test_the_request_is_of_version_2_and_basic():
    lines = caster_of(EXAMPLE_CASTER).request("pass", b"$GPGGA*00\r\n").decode().split("\r\n")
    assert lines[0] == "GET /VRS HTTP/1.1"
    assert {"Host: rtk.example.org:2101", "Ntrip-Version: Ntrip/2.0", "Authorization: Basic bWU6cGFzcw=="} <= set(lines)
    assert "Ntrip-GGA: $GPGGA*00" in lines
    assert lines[-2:] == ["", ""]
    assert "Authorization" not in caster_of("h/M").request().decode()


DATA = EXAMPLE * 3
CHUNKED = b"".join(f"{len(DATA[n : n + 7]):x}\r\n".encode() + DATA[n : n + 7] + b"\r\n" for n in range(0, len(DATA), 7))
GOOD = {
    "version 1": b"ICY 200 OK\r\n\r\n" + DATA,
    "version 1, no empty line": b"ICY 200 OK\r\n" + DATA,
    "version 2": b"HTTP/1.1 200 OK\r\nContent-Type: gnss/data\r\n\r\n" + DATA,
    "chunks": b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n" + CHUNKED,
    "chunks with names": b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
    + CHUNKED.replace(b"7\r\n", b"7;a=b\r\n", 1),
}


@pytest.mark.parametrize("name", GOOD)
@pytest.mark.parametrize("cut", [1, 5, 10_000])
def test_data_comes_out_however_the_answer_is_cut(name, cut):
    answer, stream = CasterAnswer(), GOOD[name]
    got = b"".join(answer.feed(stream[at : at + cut]) for at in range(0, len(stream), cut))
    assert got.lstrip(b"\r\n") == DATA
    assert answer.problem == ""


@pytest.mark.parametrize(
    ("stream", "why", "is_final"),
    [
        (b"HTTP/1.0 401 Unauthorized\r\n\r\n", "refuses user and password", True),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "knows no mountpoint", True),
        (b"HTTP/1.1 503 Busy\r\n\r\n", "answers with status 503", False),
        (b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n<html>", "a page and no data", True),
        (b"HTTP/1.1 200 OK\r\nContent-Type: gnss/sourcetable\r\n\r\nSTR;", "no mountpoint of this name", True),
        (b"SOURCETABLE 200 OK\r\nSTR;A;x\r\nSTR;B;x\r\nENDSOURCETABLE\r\n", "this name; it has A, B", True),
        (b"SOURCETABLE 200 OK\r\nSTR;<b>;x\r\nSTR;;x\r\nSTR\r\nENDSOURCETABLE\r\n", "no mountpoint", True),
        (b"SOURCETABLE 200 OK\r\n" + b"STR;A;x\r\n" * 40_000, "it has A, A, A, A, A, A, A, A, ...", True),
        (b"HTTP/1.1 200 OK\r\nContent-Encoding: gzip\r\n\r\n", "packs its data", True),
        (b"HTTP/1.1 301 Moved\r\nLocation: http://x\r\n\r\n", "answers with status 301", False),
        (b"HTTP/1.1 200 OK\r\n" + b"X: y\r\n" * MAX_HEAD, "its headers have no end", False),
        (b"SSH-2.0-OpenSSH\r\n", "no NTRIP caster", False),
        (b"x" * 5000, "no NTRIP caster", False),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n", "not in chunks as it says", False),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n", "not in chunks as it says", False),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n" + b"1" * 3000, "not in chunks as it says", False),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", "ended the stream", False),
    ],
)
def test_what_is_no_stream_is_said(stream, why, is_final):
    answer = CasterAnswer()
    assert b"".join(answer.feed(stream[at : at + 100]) for at in range(0, len(stream), 100)) == b""
    assert why in answer.problem
    assert answer.is_final is is_final
    assert len(answer._buffer) <= MAX_HEAD + 200


@given(st.lists(st.binary(max_size=200), max_size=20), st.sampled_from([b"", *(each[:60] for each in GOOD.values())]))
def test_no_answer_crashes_or_grows_without_end(pieces, begin):
    answer = CasterAnswer()
    answer.feed(begin)
    for piece in pieces:
        answer.feed(piece)
        assert len(answer._buffer) <= MAX_HEAD + 200
    stopped = (AnswerState.REFUSED, AnswerState.ENDED, AnswerState.TABLE)
    assert (answer.state in stopped) == bool(answer.problem)


def test_types_are_told_once_in_order():
    assert types_text([1087, 1005, 1087]) == "1005, 1087"
