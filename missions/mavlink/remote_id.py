"""Remote identification (Open Drone ID): what the operator says of itself, sent to vehicles whose module asks for it.

A module that is there says once a second whether it is content (OPEN_DRONE_ID_ARM_STATUS), through the autopilot or
beside it. From then on it gets the operator's number and place, and what the flight is for. Nothing is sent to a
vehicle that never asks. The module itself sends the aircraft's place.

How often (ASTM F3411-22a: what moves once a second, what stands every 3 s): the operator's place once a second, all
else every 3 s. ArduRemoteID takes 3 s and 22 s; ArduPilot does not arm where SYSTEM is older than 3 s.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from missions.mavlink.messages import (
    Address,
    Message,
    OpenDroneIdArmStatus,
    OpenDroneIdBasicId,
    OpenDroneIdOperatorId,
    OpenDroneIdSelfId,
    OpenDroneIdSystem,
    Received,
)
from missions.mission.model import GeoPoint
from planning.base.errors import InputError
from planning.base.messages import joined, say

# The operator's number.

EU_STATES = frozenset(
    (
        *("AUT", "BEL", "BGR", "CHE", "CYP", "CZE", "DEU", "DNK", "ESP", "EST", "FIN", "FRA", "GRC", "HRV", "HUN"),
        *("IRL", "ISL", "ITA", "LIE", "LTU", "LUX", "LVA", "MLT", "NLD", "NOR", "POL", "PRT", "ROU", "SVK", "SVN"),
        "SWE",
    )
)
"""ISO 3166-1 alpha-3 codes of the states of EASA."""

_EU_NUMBER = re.compile(r"([A-Z]{3})([0-9a-z]{12})([0-9a-z])(?:-([0-9a-z]{3}))?")
_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"

EXAMPLE = "FIN87astrdge12k8-xyz"
"""Of an operator's number: EASA's own."""

MAX_ID = 20
MAX_DESCRIPTION = 23


@dataclass(frozen=True, slots=True)
class OperatorNumber:
    """The number of an operator, as it is sent.

    Parameters
    ----------
    public
        Without the three secret characters behind the hyphen: they prove that it was typed right, and are never sent.
    is_eu
        It has the form of EN 4709-002.
    is_proved
        Its checksum was compared, which takes the secret characters.
    """

    public: str
    is_eu: bool
    is_proved: bool


def check_character(base: str, secret: str) -> str:
    """Checksum of an operator's number: the Luhn algorithm modulo 36 over its 12 and its 3 secret characters.

    EN 4709-002 names it; EASA's example FIN87astrdge12k8-xyz agrees. Characters count 0 to 9, then a to z.
    """
    total = 0
    for place, character in enumerate(reversed(base + secret)):
        value = _DIGITS.index(character) * (2 if place % 2 == 0 else 1)
        total += value // 36 + value % 36
    return _DIGITS[-total % 36]


def operator_number(typed: str) -> OperatorNumber:
    """An operator's number as it was typed.

    Numbers of EASA's states are checked: country, length, characters and, where the secret part is typed, too, the
    checksum. Spaces and the size of letters, which say nothing in them, are mended. What is none of them is taken as
    it is where it fits into the message; nothing about it can be proved.

    Raises
    ------
    InputError
        It begins as one of these numbers and is none, or does not fit.
    """
    text = typed.strip()
    written = "".join(text.split())
    found = _EU_NUMBER.fullmatch(written[:3].upper() + written[3:].lower())
    if found is None or found[1] not in EU_STATES:
        if text[:3] in EU_STATES and len(text) > 10:
            raise InputError.say(
                "operator number '{}': expected 3 capitals for the state, 13 small letters and digits, and perhaps a "
                "hyphen and 3 more, such as FIN87astrdge12k8-xyz",
                public_part(text),
            )
        if not text or len(text) > MAX_ID or not text.isascii() or not text.isprintable():
            raise InputError.say("operator number: expected 1 to {} letters and digits, got {}", MAX_ID, len(text))
        return OperatorNumber(text, False, False)
    state, base, check, secret = found.groups()
    if secret is not None and check_character(base, secret) != check:
        raise InputError.say(
            "operator number '{}': its checksum is wrong; compare it with your registration, letter by letter",
            public_part(text),
        )
    return OperatorNumber(f"{state}{base}{check}", True, secret is not None)


def serial_number(typed: str) -> str:
    """A serial number as it was typed; that it is one (ANSI/CTA-2063-A) is the maker's business.

    Raises
    ------
    InputError
        It does not fit into the message.
    """
    text = typed.strip()
    if len(text) > MAX_ID or not text.isascii() or not text.isalnum():
        raise InputError.say("serial number '{}': expected at most {} letters and digits", text, MAX_ID)
    return text


def public_part(text: str) -> str:
    """A number without what stands behind a hyphen, for messages and files."""
    return text.partition("-")[0]


# What a module says.

_SILENT = say("the remote ID module is silent: look at its power, its wiring and DID_MAVPORT")
_NO_PLACE = say("it does not know where the operator stands")
_NO_SERIAL = say("the aircraft's serial number is missing: enter it in the settings, or set it in the module")
_NO_SYSTEM = say("it has not heard for seconds where the operator stands: the link to it is bad")

REFUSALS = {
    "UA_TYPE required in BasicID": _NO_SERIAL,
    "operator location must be set": _NO_PLACE,
    "ARM_STATUS not available": _SILENT,
    "SYSTEM not available": _NO_SYSTEM,
    "DID_ENABLE must be 1": say("remote ID is demanded and switched off: set DID_ENABLE to 1"),
}
"""What ArduPilot (AP_OpenDroneID) says before it arms."""

TOKENS = {
    "LOC": say("it has no position of the aircraft yet"),
    "ID": _NO_SERIAL,
    "SELF_ID": say("it was not told what the flight is for"),
    "OP_ID": say("it has no operator number: enter yours in the settings"),
    "SYS": _NO_SYSTEM,
    "OP_LOC": _NO_PLACE,
}
"""What ArduRemoteID lists as missing."""


def refusal_text(text: str) -> str:
    """What a module or autopilot says against arming, in words that a pilot understands; its own where none are known.

    Parameters
    ----------
    text
        Of ARM_STATUS, or of the autopilot, which puts "OpenDroneID: " in front.
    """
    own = text.rpartition("OpenDroneID:")[2].strip()
    if own in REFUSALS:
        return REFUSALS[own]
    words = own.split()
    if words and all(word in TOKENS for word in words):
        return joined("; ", dict.fromkeys(TOKENS[word] for word in words))
    return say("it says: {}", own) if own else say("it does not say why")


# What is sent to it.

EPOCH_UNIX_S = 1_546_300_800.0
"""00:00 UTC of 1 January 2019, from which Open Drone ID counts."""

SYSTEM_EVERY_S, OTHERS_EVERY_S = 1.0, 3.0

UNKNOWN_M = -1000.0
MULTIROTOR = 2
"""MAV_ODID_UA_TYPE_HELICOPTER_OR_MULTIROTOR."""

SERIAL_NUMBER, TAKE_OFF, EU, UNDECLARED = 1, 0, 1, 0
"""MAV_ODID_ID_TYPE, MAV_ODID_OPERATOR_LOCATION_TYPE, and MAV_ODID_CLASSIFICATION_TYPE."""

_NO_MODULE = (0,) * 20
"""Of `id_or_mac`: messages are for whatever module is there."""


@dataclass(frozen=True, slots=True)
class RemoteId:
    """What the operator says of itself.

    Parameters
    ----------
    operator
        Public part of the operator's number; empty: none is sent.
    serial_number
        Of the aircraft (ANSI/CTA-2063-A); empty: that of the module.
    description
        What the flight is for, at most 23 letters.
    """

    operator: str = ""
    serial_number: str = ""
    description: str = "Facade photos"

    def __post_init__(self) -> None:
        for name, text, most in (
            ("operator", self.operator, MAX_ID),
            ("serial_number", self.serial_number, MAX_ID),
            ("description", self.description, MAX_DESCRIPTION),
        ):
            if len(text) > most or not text.isascii():
                raise ValueError(f"{name}: expected at most {most} letters, got '{text}'")

    def messages(self, place: GeoPoint, unix_s: float) -> tuple[Message, Sequence[Message]]:
        """The operator's place, and all else; `place` is where the operator stands: at the take-off."""
        is_eu = _EU_NUMBER.fullmatch(self.operator) is not None
        system = OpenDroneIdSystem(
            target_system=0,
            target_component=0,
            id_or_mac=_NO_MODULE,
            operator_location_type=TAKE_OFF,
            classification_type=EU if is_eu else UNDECLARED,
            operator_latitude=round(1e7 * place.lat_deg),
            operator_longitude=round(1e7 * place.lon_deg),
            area_count=1,
            area_radius=0,
            area_ceiling=UNKNOWN_M,
            area_floor=UNKNOWN_M,
            category_eu=0,
            class_eu=0,
            operator_altitude_geo=place.height_ellipsoid_m,
            timestamp=max(0, int(unix_s - EPOCH_UNIX_S)),
        )
        others: list[Message] = [OpenDroneIdSelfId(0, 0, _NO_MODULE, 0, self.description)]
        if self.operator:
            others.append(OpenDroneIdOperatorId(0, 0, _NO_MODULE, 0, self.operator))
        if self.serial_number:
            number = tuple(self.serial_number.encode("ascii").ljust(MAX_ID, b"\0"))
            others.append(OpenDroneIdBasicId(0, 0, _NO_MODULE, SERIAL_NUMBER, MULTIROTOR, number))
        return system, others


NOBODY = RemoteId()
"""Who has not said anything of itself."""


@dataclass(slots=True)
class RemoteIdSender:
    """Sends to a vehicle whose module was heard, as long as the link is open; a state machine without a link.

    Parameters
    ----------
    place
        Where the operator stands.
    unix_clock
        Seconds since 1970 UTC.
    """

    identity: RemoteId
    place: GeoPoint
    unix_clock: Callable[[], float]
    _asks: Address | None = field(init=False, default=None)
    _system_s: float = field(init=False, default=-math.inf)
    _others_s: float = field(init=False, default=-math.inf)

    @property
    def is_asked(self) -> bool:
        """Whether a module was heard."""
        return self._asks is not None

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        if isinstance(received.message, OpenDroneIdArmStatus):
            self._asks = received.source
        return []

    def tick(self, now_s: float) -> list[Message]:
        """What is due."""
        if self._asks is None:
            return []
        sent: list[Message] = []
        system, others = self.identity.messages(self.place, self.unix_clock())
        if now_s >= self._system_s + SYSTEM_EVERY_S:
            self._system_s = now_s
            sent.append(system)
        if now_s >= self._others_s + OTHERS_EVERY_S:
            self._others_s = now_s
            sent += others
        return sent
