"""MAVLink 2 signing: the key, time stamps that never go back, and whom to believe.

A signed frame ends with a link id, a time stamp of 48 bits in units of 10 microseconds since 2015-01-01 UTC, and the
first 6 bytes of SHA-256(key, everything before): MAVLink developer guide, "Message signing". A receiver refuses a stamp
that is not above the last one of the same sender, so a replay is refused; a sender's stamps must therefore grow even
when its clock was set back or the program was started anew; `key_store.py` keeps a stamp ahead of all that were used.
"""

from __future__ import annotations

import hashlib
import hmac
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from missions.mavlink.messages import Address, SetupSigning
from planning.base.errors import InputError
from planning.base.messages import say

KEY_BYTES = 32
SIGNATURE_BYTES = 13
"""Link id, six bytes of time stamp, six bytes of hash."""

EPOCH_UNIX_S = 1_420_070_400
TICKS_PER_S = 100_000
LARGEST_TIMESTAMP = (1 << 48) - 1

NEW_STREAM_LATENESS = 60 * TICKS_PER_S
"""A sender heard for the first time may be this far behind our own stamp: one minute, says the developer guide."""

RESERVE = 60 * TICKS_PER_S
"""How far ahead a stamp is written down, so that the file is written once a minute and not with every frame."""

RADIO_STATUS, RADIO = 109, 166
UNSIGNED_ACCEPTED = frozenset({RADIO_STATUS, RADIO})
"""Messages believed without a signature: a telemetry radio makes them itself and does not know the key."""


def key_from_passphrase(passphrase: str) -> bytes:
    """Key of a passphrase, as QGroundControl and Mission Planner make it: SHA-256 of its UTF-8 bytes.

    Raises
    ------
    InputError
        The passphrase is empty.
    """
    if not passphrase:
        raise InputError(say("the passphrase for signing is empty; expected the one that the vehicle was given"))
    return hashlib.sha256(passphrase.encode()).digest()


def timestamp_of(unix_s: float) -> int:
    """Time stamp of a time; 0 before 2015."""
    return min(LARGEST_TIMESTAMP, max(0, int((unix_s - EPOCH_UNIX_S) * TICKS_PER_S)))


@dataclass(slots=True)
class Signer:
    """Stamps what is sent and judges what comes in, on one link.

    Parameters
    ----------
    key
        32 bytes, shared with the vehicle.
    link_id
        Number of this link, so that two links to one vehicle do not spoil each other's stamps.
    unsigned_accepted
        Message ids that are believed without a signature.
    wall_clock
        UNIX time in seconds; may go back.
    timestamp
        Lowest stamp to use.
    reserve
        Called with a stamp that must not be used again after a restart, before any up to it is used.
    """

    key: bytes = field(repr=False)
    link_id: int = 0
    unsigned_accepted: frozenset[int] = UNSIGNED_ACCEPTED
    wall_clock: Callable[[], float] = time.time
    timestamp: int = 0
    reserve: Callable[[int], None] | None = None
    _reserved: int = field(init=False, default=0)
    _last: dict[tuple[int, Address], int] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.key) != KEY_BYTES:
            raise ValueError(f"expected a key of {KEY_BYTES} bytes, got {len(self.key)}")
        if not 0 <= self.link_id <= 255:
            raise ValueError(f"link_id: expected 0 to 255, got {self.link_id}")

    def next_timestamp(self) -> int:
        """Stamp for the next frame: the time, or one more than the last stamp where the clock stands behind it."""
        self.timestamp = max(self.timestamp + 1, timestamp_of(self.wall_clock()))
        if self.reserve is not None and self.timestamp > self._reserved:
            self._reserved = self.timestamp + RESERVE
            self.reserve(self._reserved)
        return self.timestamp

    def accepts(self, frame: bytes, source: Address) -> bool:
        """Whether a signed frame was made with our key and is not a replay; remembers its stamp if so."""
        if len(frame) < SIGNATURE_BYTES:
            return False
        signed, signature = frame[:-6], frame[-6:]
        if not hmac.compare_digest(hashlib.sha256(self.key + signed).digest()[:6], signature):
            return False
        link_id, timestamp = signed[-7], int.from_bytes(signed[-6:], "little")
        stream = (link_id, source)
        lowest = self._last.get(stream)
        if lowest is None:
            lowest = max(self.timestamp, timestamp_of(self.wall_clock())) - NEW_STREAM_LATENESS - 1
        if timestamp <= lowest:
            return False
        self._last[stream] = timestamp
        self.timestamp = max(self.timestamp, timestamp)
        return True

    def setup(self, vehicle: Address) -> SetupSigning:
        """Message that gives the vehicle our key; only over a link that nobody listens to, such as USB."""
        return SetupSigning(vehicle.system, vehicle.component, tuple(self.key), self.next_timestamp())


def forget_key(vehicle: Address) -> SetupSigning:
    """Message that ends signing on the vehicle: a key of zeros."""
    return SetupSigning(vehicle.system, vehicle.component, (0,) * KEY_BYTES, 0)
