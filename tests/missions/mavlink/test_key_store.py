from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

from missions.mavlink.signing import RESERVE, KeyStore, key_from_passphrase, timestamp_of
from planning.base.errors import InputError

KEY = key_from_passphrase("blue sky")
NOW_S = 1_800_000_000.0


@pytest.fixture
def store(tmp_path: Path) -> KeyStore:
    return KeyStore(tmp_path / "settings", may_use_system=False)


def test_key_comes_back_from_a_file_that_only_its_owner_may_read(store: KeyStore) -> None:
    assert store.load() is None
    store.save(KEY)
    assert store.load() == KEY
    assert store.key_path.stat().st_mode & 0o777 == 0o600
    assert sorted(path.name for path in store.folder.iterdir()) == [store.key_path.name]


def test_new_key_takes_the_place_of_the_old_and_forgetting_leaves_none(store: KeyStore) -> None:
    store.save(KEY)
    store.save(bytes(32))
    assert store.load() == bytes(32)
    store.forget()
    store.forget()
    assert store.load() is None
    assert store.signer() is None


@pytest.mark.skipif(os.name == "nt", reason="Windows has no file modes")
@pytest.mark.parametrize("mode", [0o640, 0o604, 0o660, 0o644])
def test_key_that_others_may_read_is_refused_with_what_to_do(store: KeyStore, mode: int) -> None:
    store.save(KEY)
    store.key_path.chmod(mode)
    with pytest.raises(InputError, match=f"mode {mode:04o}, expected 0600.*chmod 600"):
        store.load()


@pytest.mark.parametrize("text", ["", "xyz", "00", "é" * 10, "ab" * 31])
def test_file_without_a_key_is_refused(store: KeyStore, text: str) -> None:
    store.save(KEY)
    store.key_path.write_text(text, "utf-8")
    with pytest.raises(InputError, match=store.key_path.name):
        store.load()


def test_stamps_grow_from_one_start_to_the_next_though_the_clock_went_back(store: KeyStore) -> None:
    store.save(KEY)
    last = 0
    for start_s in (NOW_S, NOW_S - 86_400.0, 0.0, NOW_S - 5.0):
        signer = store.signer(wall_clock=lambda now_s=start_s: now_s)
        assert signer is not None
        for _ in range(3):
            stamp = signer.next_timestamp()
            assert stamp > last
            last = stamp
    assert last < timestamp_of(NOW_S) + 5 * RESERVE


def test_damaged_time_stamp_is_said_and_not_taken_for_0(store: KeyStore) -> None:
    store.save(KEY)
    store.timestamp_path.write_text("never")
    with pytest.raises(InputError, match="time stamp for signing"):
        store.signer()


def test_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        KeyStore(tmp_path / "file", may_use_system=False).save(KEY)


class KeyringError(Exception):
    """As in the package keyring."""


class Keyring(ModuleType):
    """Enough of the package keyring; `is_locked`: there is no key store behind it."""

    def __init__(self, is_locked: bool) -> None:
        super().__init__("keyring")
        self.is_locked = is_locked
        self.kept: dict[tuple[str, str], str] = {}

    def _check(self) -> None:
        if self.is_locked:
            raise KeyringError("no backend")

    def set_password(self, service: str, name: str, text: str) -> None:
        self._check()
        self.kept[service, name] = text

    def get_password(self, service: str, name: str) -> str | None:
        self._check()
        return self.kept.get((service, name))

    def delete_password(self, service: str, name: str) -> None:
        self._check()
        if self.kept.pop((service, name), None) is None:
            raise KeyringError("not found")


@pytest.mark.parametrize("is_locked", [False, True])
def test_system_key_store_is_used_where_it_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_locked: bool
) -> None:
    keyring, errors = Keyring(is_locked), ModuleType("keyring.errors")
    errors.KeyringError = KeyringError  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "keyring", keyring)
    monkeypatch.setitem(sys.modules, "keyring.errors", errors)
    store = KeyStore(tmp_path)
    store.save(KEY)
    assert store.key_path.exists() is is_locked
    assert store.load() == KEY
    store.forget()
    assert store.load() is None
