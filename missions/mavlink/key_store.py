"""The signing key and the last time stamp, kept from one start of the program to the next.

The key lies in the system's key store where the package keyring and a key store are there, else in a file that only its
owner may read; never in a project, which is copied and sent around. The time stamp is no secret, and lies in a file.
"""

from __future__ import annotations

import os
import stat
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from missions.mavlink.signing import KEY_BYTES, Signer
from planning.base.errors import InputError
from planning.base.files import FileLimit, read_given
from planning.base.json_file import part_file
from planning.base.messages import say

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
            raise InputError(
                say("{} does not hold a signing key of {} hex digits; set it anew", self.key_path, 2 * KEY_BYTES)
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
            return int(read_given(self.timestamp_path, KEY_FILE).decode("ascii"))
        except (InputError, ValueError) as error:
            path = self.timestamp_path
            raise InputError(say("{} does not hold a time stamp for signing ({}); delete it", path, error)) from error

    def _reserve(self, timestamp: int) -> None:
        self._write(self.timestamp_path, str(max(timestamp, self._timestamp())))

    def _read_own(self) -> str | None:
        try:
            mode = stat.S_IMODE(self.key_path.stat().st_mode)
            # Windows has no such modes; there the folder is the user's own.
            if os.name != "nt" and mode & ~OWNER_ONLY:
                raise InputError(
                    say(
                        "others may read the signing key {} (mode {:04o}, expected {:04o}); give the vehicle a new "
                        "key, or run: chmod 600 '{}'",
                        self.key_path,
                        mode,
                        OWNER_ONLY,
                        self.key_path,
                    )
                )
            return read_given(self.key_path, KEY_FILE).decode("ascii")
        except FileNotFoundError:
            return None
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(say("the signing key {} cannot be read: {}", self.key_path, error)) from error

    def _write(self, path: Path, text: str) -> None:
        """Write a file for the owner only, all of it or nothing."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with part_file(path, OWNER_ONLY) as part:
                part.write_text(text, "ascii")
        except OSError as error:
            raise InputError(say("{} cannot be written: {}", path, error.strerror or error)) from error

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
