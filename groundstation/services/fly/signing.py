"""MAVLink 2 signing: one key on this computer, which vehicles are given and their links then prove."""

from __future__ import annotations

import time
from contextlib import closing

from groundstation.services.settings import settings_path
from missions.mavlink.link import ChannelLink, open_link
from missions.mavlink.messages import Address, Heartbeat, Message
from missions.mavlink.signing import KeyStore, Signer, forget_key, key_from_passphrase
from missions.mavlink.wire import Counts
from planning.base.errors import InputError, LinkError, LinkTimeout
from planning.base.messages import about, say
from planning.base.progress import Clock

MIN_PASSPHRASE = 12
"""Characters. The key is one SHA-256 of the passphrase, as others make it, too: short ones are guessed fast."""

HEARD_S = 5.0
"""Autopilots send a heartbeat each second."""

N_SENT = 3
"""SETUP_SIGNING is not acknowledged; some may be lost."""

NO_AUTOPILOT = 8
"""MAV_AUTOPILOT_INVALID: heartbeats of ground stations, cameras and radios."""


def key_store() -> KeyStore:
    """Where the key is kept: with the user's settings, never in a project."""
    return KeyStore(settings_path().parent)


def set_passphrase(passphrase: str) -> None:
    """Keep the key of a passphrase; other ground stations make the same key of it.

    Raises
    ------
    InputError
        It is too short, or the key cannot be kept.
    """
    if len(passphrase) < MIN_PASSPHRASE:
        raise InputError(say("expected a passphrase of {} characters or more, got {}", MIN_PASSPHRASE, len(passphrase)))
    key_store().save(key_from_passphrase(passphrase))


def link_signer() -> Signer:
    """Signer for a link.

    Raises
    ------
    InputError
        There is no key, or it cannot be read.
    """
    signer = key_store().signer()
    if signer is None:
        raise InputError(
            say("there is no signing key on this computer; set one ('signing set', or Key in the Fly tab)")
        )
    return signer


def has_key() -> bool:
    """Whether there is a key on this computer.

    Raises
    ------
    InputError
        It is there, and cannot be read.
    """
    return key_store().load() is not None


def forget_passphrase() -> None:
    """Keep no key on this computer; vehicles that know it keep it."""
    key_store().forget()


def signing_problem(counts: Counts, *, is_signed: bool, is_heard: bool) -> str:
    """Why two ends of a link that is open do not understand each other, and what to do; empty where nothing shows it.

    Parameters
    ----------
    counts
        What came in.
    is_signed
        Whether this end signs, and lets nothing else in.
    is_heard
        Whether an autopilot was heard.
    """
    if is_signed and not is_heard and counts.refused > counts.unsigned:
        return say(
            "the vehicle signs with another key than this computer's; set the passphrase that it was given, "
            "or give it this computer's key over a cable"
        )
    if is_signed and not is_heard and counts.unsigned > 0:
        return say(
            "the vehicle does not sign what it sends; give it this computer's key over a cable, or connect "
            "without signing"
        )
    if not is_signed and counts.signed > 0:
        return say(
            "the vehicle signs what it sends, and may not obey a link that is not signed; disconnect, and "
            "connect signed with its key"
        )
    return ""


def give_key(url: str, clock: Clock = time.perf_counter) -> Address:
    """Give the vehicle at the end of a link our key, and hear that it signs; only over a cable that nobody listens to.

    Raises
    ------
    InputError
        There is no key, or the url is none.
    LinkError
        The link cannot be opened, no autopilot is heard, or it does not sign afterwards.
    """
    signer = link_signer()
    with closing(open_link(url, clock=clock)) as link:
        vehicle = _vehicle(link, url, clock)
        _send(link, signer.setup(vehicle))
        link.sign_with(signer)
        try:
            return _vehicle(link, url, clock)
        except LinkTimeout as error:
            text = say("the vehicle was given the key and does not sign with it; it may not know signing")
            raise LinkError(about(url, text)) from error


def withdraw_key(url: str, clock: Clock = time.perf_counter) -> Address:
    """Tell the vehicle to sign no more, over a link that is signed with our key.

    Raises
    ------
    InputError, LinkError
        As `give_key`.
    """
    with closing(open_link(url, signer=link_signer(), clock=clock)) as link:
        vehicle = _vehicle(link, url, clock)
        _send(link, forget_key(vehicle))
    return vehicle


def _vehicle(link: ChannelLink, url: str, clock: Clock) -> Address:
    end_s = clock() + HEARD_S
    while clock() < end_s:
        received = link.receive(0.2)
        message = None if received is None else received.message
        if received is not None and isinstance(message, Heartbeat) and message.autopilot != NO_AUTOPILOT:
            return received.source
    raise LinkTimeout(
        say("no autopilot is heard within {:g} s; is it switched on, and does it use this key?", HEARD_S, place=url)
    )


def _send(link: ChannelLink, message: Message) -> None:
    for _ in range(N_SENT):
        link.send(message)
