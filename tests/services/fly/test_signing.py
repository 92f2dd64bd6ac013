"""The key of signed links: made, handed out and taken back; the vehicle is the other end of a real link."""

import threading
from contextlib import closing

import pytest

from groundstation.services.fly import signing
from missions.mavlink.link import open_link
from missions.mavlink.messages import Address, Heartbeat, SetupSigning
from missions.mavlink.signing import KeyStore, Signer, key_from_passphrase
from missions.mavlink.wire import Counts
from planning.base.errors import InputError, LinkError

PASSPHRASE = "correct horse battery staple"
VEHICLE = Address(1, 1)
HEARTBEAT = Heartbeat(2, 3, 81, 0, 4)


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    monkeypatch.setattr(signing, "key_store", lambda: KeyStore(tmp_path, may_use_system=False))


class Vehicle:
    """Sends heartbeats, and signs from when it is given a key until it is given one of zeros."""

    def __init__(self, knows_signing=True, key=None):
        self.knows_signing, self.key, self.ended = knows_signing, key, threading.Event()
        signer = None if key is None else Signer(key)
        self.link = open_link("tcpin:127.0.0.1:0", VEHICLE, signer)
        self.port = self.link.channel.port
        self.thread = threading.Thread(target=self._run)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        self.link.close()

    @property
    def url(self):
        return f"tcp:127.0.0.1:{self.port}"

    def _run(self):
        while not self.ended.is_set():
            self.link.send(HEARTBEAT)
            received = self.link.receive(0.1)
            if received is not None and isinstance(received.message, SetupSigning) and self.knows_signing:
                key = bytes(received.message.secret_key)
                self.key = key if any(key) else None
                self.link.sign_with(None if self.key is None else Signer(self.key))


def test_there_is_no_key_until_one_is_set_and_none_after_it_is_forgotten():
    with pytest.raises(InputError, match="signing set"):
        signing.link_signer()
    signing.set_passphrase(PASSPHRASE)
    assert signing.link_signer().key == key_from_passphrase(PASSPHRASE)
    signing.key_store().forget()
    with pytest.raises(InputError, match="no signing key"):
        signing.link_signer()


def test_a_short_passphrase_is_refused_and_keeps_the_old_key():
    signing.set_passphrase(PASSPHRASE)
    with pytest.raises(InputError, match="12 characters"):
        signing.set_passphrase("hunter2")
    assert signing.link_signer().key == key_from_passphrase(PASSPHRASE)


def test_a_vehicle_is_given_the_key_and_signs_with_it_and_is_told_to_stop():
    signing.set_passphrase(PASSPHRASE)
    with Vehicle() as vehicle:
        assert signing.give_key(vehicle.url) == VEHICLE
        assert vehicle.key == key_from_passphrase(PASSPHRASE)
        assert signing.withdraw_key(vehicle.url) == VEHICLE
        with closing(open_link(vehicle.url)) as link:
            while vehicle.key is not None:
                link.receive(0.1)


@pytest.mark.long
def test_a_vehicle_that_does_not_know_signing_is_told_apart(monkeypatch):
    monkeypatch.setattr(signing, "HEARD_S", 1.0)
    signing.set_passphrase(PASSPHRASE)
    with Vehicle(knows_signing=False) as vehicle, pytest.raises(LinkError, match="may not know signing"):
        signing.give_key(vehicle.url)


@pytest.mark.long
def test_a_vehicle_with_another_key_is_not_heard(monkeypatch):
    monkeypatch.setattr(signing, "HEARD_S", 1.0)
    signing.set_passphrase(PASSPHRASE)
    with Vehicle(key=bytes(range(32))) as vehicle, pytest.raises(LinkError, match="does it use this key"):
        signing.withdraw_key(vehicle.url)


def test_nothing_is_sent_to_anybody_without_a_key():
    with pytest.raises(InputError, match="no signing key"):
        signing.give_key("tcp:127.0.0.1:1")


@pytest.mark.parametrize(
    ("counts", "is_signed", "is_heard", "words"),
    [
        (Counts(), True, False, ""),
        (Counts(refused=3, unsigned=3), True, False, "does not sign"),
        (Counts(refused=3, unsigned=2), True, False, "another key"),
        (Counts(refused=3, unsigned=3), True, True, ""),  # a camera beside an autopilot that signs
        (Counts(frames=9, signed=4), False, True, "may not obey"),
        (Counts(frames=9), False, True, ""),
    ],
)
def test_ends_that_do_not_sign_alike_are_told_what_to_do(counts, is_signed, is_heard, words):
    told = signing.signing_problem(counts, is_signed=is_signed, is_heard=is_heard)
    assert words in told
    assert bool(told) == bool(words)
