"""MAVLink 2 signing: the key, time stamps that never go back, and whom to believe.

A signed frame ends with a link id, a time stamp of 48 bits in units of 10 microseconds since 2015-01-01 UTC, and the
first 6 bytes of SHA-256(key, everything before): MAVLink developer guide, "Message signing". A receiver refuses a stamp
that is not above the last one of the same sender, so a replay is refused; a sender's stamps must therefore grow even
when its clock was set back or the program was started anew; `KeyStore` keeps a stamp ahead of all that were used.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import stat
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

from missions.mavlink.messages import Address, SetupSigning
from planning.base.errors import InputError
from planning.base.files import FileLimit, read_input_file
from planning.base.json_file import part_file
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
        raise InputError.say("the passphrase for signing is empty; expected the one that the vehicle was given")
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


# The signing key and the last time stamp, kept from one start of the program to the next.
#
# The key lies in the system's key store where the package keyring and a key store are there, else in a file that only
# its owner may read; never in a project, which is copied and sent around. The time stamp is no secret, and lies in a
# file.

SERVICE = "reflight"
KEY_NAME = "mavlink-signing-key"
TIMESTAMP_NAME = "mavlink-signing-timestamp"
OWNER_ONLY = 0o600
KEY_FILE = FileLimit(say("a file of the signing key"), 1024)


@dataclass(frozen=True, slots=True)
class KeyStore:
    """Keeps one key.

    Parameters
    ----------
    folder
        The user's folder for settings.
    may_use_system
        Try the system's key store first.
    """

    folder: Path
    may_use_system: bool = True

    @property
    def key_path(self) -> Path:
        """Where the key lies if the system has no key store."""
        return self.folder / KEY_NAME

    @property
    def timestamp_path(self) -> Path:
        """Where the time stamp lies."""
        return self.folder / TIMESTAMP_NAME

    def save(self, key: bytes) -> None:
        """Keep a key instead of the one before.

        Raises
        ------
        InputError
            It cannot be written.
        """
        if len(key) != KEY_BYTES:
            raise ValueError(f"expected a key of {KEY_BYTES} bytes, got {len(key)}")
        if self._in_system(lambda keyring: keyring.set_password(SERVICE, KEY_NAME, key.hex())):
            self.key_path.unlink(missing_ok=True)
        else:
            self._write(self.key_path, key.hex())

    def load(self) -> bytes | None:
        """The key, None where there is none.

        Raises
        ------
        InputError
            Others may read the file, or it does not hold a key.
        """
        found: list[str | None] = []
        self._in_system(lambda keyring: found.append(keyring.get_password(SERVICE, KEY_NAME)))
        text = found[0] if found and found[0] is not None else self._read_own()
        if text is None:
            return None
        try:
            key = bytes.fromhex(text)
        except ValueError:
            key = b""
        if len(key) != KEY_BYTES:
            raise InputError.say(
                "{} does not hold a signing key of {} hex digits; set it anew", self.key_path, 2 * KEY_BYTES
            )
        return key

    def forget(self) -> None:
        """Keep no key."""
        self._in_system(lambda keyring: keyring.delete_password(SERVICE, KEY_NAME))
        self.key_path.unlink(missing_ok=True)

    def signer(self, link_id: int = 0, wall_clock: Callable[[], float] = time.time) -> Signer | None:
        """Signer with the key, whose stamps are above all that were ever used; None where there is no key.

        Raises
        ------
        InputError
            The key or the time stamp cannot be read.
        """
        key = self.load()
        if key is None:
            return None
        return Signer(key, link_id, wall_clock=wall_clock, timestamp=self._timestamp(), reserve=self._reserve)

    def _timestamp(self) -> int:
        try:
            if not self.timestamp_path.exists():
                return 0
            return int(read_input_file(self.timestamp_path, KEY_FILE).decode("ascii"))
        except (InputError, ValueError) as error:
            path = self.timestamp_path
            raise InputError.say("{} does not hold a time stamp for signing ({}); delete it", path, error) from error

    def _reserve(self, timestamp: int) -> None:
        self._write(self.timestamp_path, str(max(timestamp, self._timestamp())))

    def _read_own(self) -> str | None:
        try:
            mode = stat.S_IMODE(self.key_path.stat().st_mode)
            # Windows has no such modes; there the folder is the user's own.
            if os.name != "nt" and mode & ~OWNER_ONLY:
                raise InputError.say(
                    "others may read the signing key {} (mode {:04o}, expected {:04o}); give the vehicle a new "
                    "key, or run: chmod 600 '{}'",
                    self.key_path,
                    mode,
                    OWNER_ONLY,
                    self.key_path,
                )
            return read_input_file(self.key_path, KEY_FILE).decode("ascii")
        except FileNotFoundError:
            return None
        except (OSError, UnicodeDecodeError) as error:
            raise InputError.say("the signing key {} cannot be read: {}", self.key_path, error) from error

    def _write(self, path: Path, text: str) -> None:
        """Write a file for the owner only, all of it or nothing."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with part_file(path, OWNER_ONLY) as part:
                part.write_text(text, "ascii")
        except OSError as error:
            raise InputError.say("{} cannot be written: {}", path, error.strerror or error) from error

    def _in_system(self, use: Callable[[Any], object]) -> bool:
        """Do something with the system's key store; False where there is none, or it does not let us."""
        if not self.may_use_system:
            return False
        try:
            keyring = import_module("keyring")
        except ImportError:
            return False
        try:
            use(keyring)
        except import_module("keyring.errors").KeyringError:
            return False
        return True
