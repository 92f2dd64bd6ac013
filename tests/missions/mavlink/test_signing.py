from __future__ import annotations

import hashlib
import itertools
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from missions.mavlink.messages import Address, Heartbeat, RadioStatus, SetupSigning
from missions.mavlink.signing import (
    LARGEST_TIMESTAMP,
    NEW_STREAM_LATENESS,
    RESERVE,
    Signer,
    forget_key,
    key_from_passphrase,
    timestamp_of,
)
from missions.mavlink.wire import Decoder, Encoder
from planning.base.errors import InputError

KEY, OTHER = key_from_passphrase("blue sky"), key_from_passphrase("grey sky")
GROUND, VEHICLE = Address(255, 190), Address(1, 1)
HEARTBEAT = Heartbeat(2, 3, 81, 4, 4)
NOW_S = 1_800_000_000.0


@dataclass
class Clock:
    now_s: float = NOW_S

    def __call__(self) -> float:
        return self.now_s


def signer(key: bytes = KEY, clock: Clock | None = None, link_id: int = 0) -> Signer:
    return Signer(key, link_id, wall_clock=clock or Clock())


def test_signed_frames_are_taken_both_ways() -> None:
    ground, vehicle = signer(), signer()
    for sender, source, receiver in ((ground, GROUND, vehicle), (vehicle, VEHICLE, ground)):
        encoder, decoder = Encoder(source, sender), Decoder(receiver)
        for _ in range(3):
            (frame,) = decoder.feed(encoder.encode(HEARTBEAT), 0.0)
            assert frame.received is not None
            assert frame.received.message == HEARTBEAT


def test_wrong_key_is_refused() -> None:
    decoder = Decoder(signer())
    assert decoder.feed(Encoder(VEHICLE, signer(OTHER)).encode(HEARTBEAT), 0.0) == []
    assert decoder.counts.refused == 1


def test_replay_is_refused_and_so_is_an_older_frame() -> None:
    encoder, decoder = Encoder(VEHICLE, signer()), Decoder(signer())
    first, second = encoder.encode(HEARTBEAT), encoder.encode(HEARTBEAT)
    assert len(decoder.feed(second, 0.0)) == 1
    assert decoder.feed(second, 0.0) == []
    assert decoder.feed(first, 0.0) == []


def test_unsigned_frame_is_refused_but_that_of_a_radio() -> None:
    decoder, encoder = Decoder(signer()), Encoder(VEHICLE)
    assert decoder.feed(encoder.encode(HEARTBEAT), 0.0) == []
    assert len(decoder.feed(encoder.encode(RadioStatus(180, 175, 100, 40, 45, 0, 0)), 0.0)) == 1
    strict = Decoder(Signer(KEY, unsigned_accepted=frozenset(), wall_clock=Clock()))
    assert strict.feed(encoder.encode(RadioStatus(180, 175, 100, 40, 45, 0, 0)), 0.0) == []


def test_signed_frame_is_taken_by_one_who_has_no_key() -> None:
    assert len(Decoder().feed(Encoder(VEHICLE, signer()).encode(HEARTBEAT), 0.0)) == 1


@given(bit=st.integers(0, 8 * 34 - 1))
def test_signed_frame_with_any_bit_turned_is_refused(bit: int) -> None:
    frame = bytearray(Encoder(VEHICLE, signer()).encode(HEARTBEAT))
    assert len(frame) == 34
    frame[bit // 8] ^= 1 << bit % 8
    assert Decoder(signer()).feed(bytes(frame), 0.0, is_whole=True) == []


def test_forged_frame_does_not_lock_the_true_sender_out() -> None:
    # A stamp far in the future must not be noted before the signature was checked.
    decoder, encoder = Decoder(signer()), Encoder(VEHICLE, signer())
    forged = bytearray(encoder.encode(HEARTBEAT))
    forged[-12:-6] = LARGEST_TIMESTAMP.to_bytes(6, "little")
    assert decoder.feed(bytes(forged), 0.0) == []
    assert len(decoder.feed(encoder.encode(HEARTBEAT), 0.0)) == 1


def test_new_sender_may_be_a_minute_behind_not_more() -> None:
    # The sender's stamps of half a second, and of one and a half seconds, less than the limit.
    for behind_s, is_taken in ((59.0, True), (61.0, False)):
        encoder = Encoder(VEHICLE, signer(clock=Clock(NOW_S - behind_s)))
        assert bool(Decoder(signer()).feed(encoder.encode(HEARTBEAT), 0.0)) is is_taken
    assert NEW_STREAM_LATENESS == 60 * 100_000


def test_stamps_grow_though_the_clock_stands_still_or_goes_back() -> None:
    clock = Clock()
    one = signer(clock=clock)
    stamps = [one.next_timestamp() for _ in range(5)]
    clock.now_s -= 3600.0
    stamps += [one.next_timestamp() for _ in range(5)]
    clock.now_s += 7200.0
    stamps.append(one.next_timestamp())
    assert all(later > earlier for earlier, later in itertools.pairwise(stamps))
    assert stamps[0] == timestamp_of(NOW_S)
    assert stamps[-1] == timestamp_of(NOW_S + 3600.0)


def test_our_stamps_follow_those_that_are_received() -> None:
    ours = signer()
    ahead = Encoder(VEHICLE, signer(clock=Clock(NOW_S + 1000.0)))
    Decoder(ours).feed(ahead.encode(HEARTBEAT), 0.0)
    assert ours.next_timestamp() > timestamp_of(NOW_S + 1000.0)


def test_stamps_are_reserved_before_they_are_used_and_seldom() -> None:
    clock, reserved = Clock(), list[int]()
    one = Signer(KEY, wall_clock=clock, reserve=reserved.append)
    for _ in range(1000):
        stamp = one.next_timestamp()
        assert reserved[-1] >= stamp
        clock.now_s += 0.2
    assert 3 <= len(reserved) <= 5
    assert RESERVE == 60 * 100_000


def test_pymavlink_takes_our_signature_and_we_take_its() -> None:
    theirs = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    theirs.signing.secret_key = KEY
    theirs.signing.sign_outgoing = True
    theirs.signing.timestamp = timestamp_of(NOW_S)
    theirs.signing.link_id = 3
    theirs.robust_parsing = False
    (read,) = theirs.parse_buffer(Encoder(GROUND, signer(link_id=5)).encode(HEARTBEAT))
    assert read.get_signed()
    assert read.get_link_id() == 5
    packed = dialect.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(theirs)
    assert len(Decoder(signer()).feed(packed, 0.0)) == 1


def test_passphrase_becomes_a_key_as_in_other_ground_stations() -> None:
    assert key_from_passphrase("Ä key") == hashlib.sha256("Ä key".encode()).digest()
    with pytest.raises(InputError, match="empty"):
        key_from_passphrase("")


def test_setup_message_carries_the_key_and_a_stamp_and_can_take_it_back() -> None:
    setup = signer().setup(VEHICLE)
    assert setup == SetupSigning(1, 1, tuple(KEY), timestamp_of(NOW_S))
    assert forget_key(VEHICLE) == SetupSigning(1, 1, (0,) * 32, 0)


def test_key_is_not_shown() -> None:
    assert "key" not in repr(signer())


def test_time_before_2015_is_0_and_the_far_future_fits() -> None:
    assert timestamp_of(0.0) == 0
    assert timestamp_of(1e12) == LARGEST_TIMESTAMP


def test_wrong_key_lengths_and_link_ids_are_wrong_calls() -> None:
    with pytest.raises(ValueError, match="32 bytes"):
        Signer(b"short")
    with pytest.raises(ValueError, match="0 to 255"):
        Signer(KEY, 256)
