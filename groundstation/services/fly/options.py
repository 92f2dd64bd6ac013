"""What the pilot decides about a live flight, and how he reaches the vehicle; kept for the next time."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from groundstation.services.settings import Tell, read_preferences, settings_path
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import DEFAULT_BAUD
from missions.mavlink.remote_id import RemoteId

# How the pilot reaches the vehicle: what was chosen in the window, as a url, and kept for the next time.


class LinkKind(StrEnum):
    """What stands at the other end, and how it is reached."""

    SIMULATION = "simulation"
    UDP = "udp"
    TCP = "tcp"
    SERIAL = "serial"


USUAL_ADDRESS = {
    LinkKind.SIMULATION: "",
    LinkKind.UDP: "0.0.0.0:14550",
    LinkKind.TCP: "127.0.0.1:5760",
    LinkKind.SERIAL: f"/dev/ttyUSB0:{DEFAULT_BAUD}",
}
"""Where ground stations listen, where simulators serve, and where a telemetry radio usually is."""


REHEARSAL_SPEED_UP = 10.0
"""Of the first simulated flight: a battery's flight takes minutes, and its readouts can still be followed."""


@dataclass(frozen=True, slots=True)
class ConnectionChoice:
    """What was chosen.

    Parameters
    ----------
    address
        `HOST:PORT`, or `DEVICE:BAUD`; empty for a simulation.
    autopilot, speed_up
        Of the simulation.
    signed
        Every url whose link is signed, whichever is chosen now.
    """

    kind: LinkKind = LinkKind.SIMULATION
    address: str = ""
    autopilot: Autopilot = Autopilot.ARDUPILOT
    speed_up: float = REHEARSAL_SPEED_UP
    signed: tuple[str, ...] = ()

    @property
    def url(self) -> str:
        """As `missions.mavlink.link` takes it; empty for the embedded simulation."""
        return "" if self.kind is LinkKind.SIMULATION else f"{self.kind.value}:{self.address}"

    @property
    def is_signed(self) -> bool:
        """Whether the link to the chosen address is signed; a simulation's never is."""
        return self.url in self.signed

    def with_signed(self, url: str, *, is_signed: bool) -> ConnectionChoice:
        """The same choice, with the link to an address signed from now on, or no longer."""
        others = tuple(one for one in self.signed if one != url)
        return replace(self, signed=(*others, url) if is_signed and url else others)


FIRST_CHOICE = ConnectionChoice()

PORT_STEP = 10
"""Between the ports of aircraft at one address, as ArduPilot's simulators count them."""


def beside(choice: ConnectionChoice, number: int) -> ConnectionChoice:
    """The choice for another aircraft, from 1, beside the first one: a port or a device of its own."""
    is_serial = choice.kind is LinkKind.SERIAL
    found = re.fullmatch(r"(.*?)(\d+)(:\d+)" if is_serial else r"(.*:)(\d+)()", choice.address)
    if found is None:
        return replace(choice, signed=())
    own = int(found[2]) + (number - 1) * (1 if is_serial else PORT_STEP)
    return replace(choice, address=f"{found[1]}{own}{found[3]}", signed=())


def choice_path(number: int = 1) -> Path:
    """Where the last choice for an aircraft, from 1, is kept: beside the settings."""
    return settings_path().with_name("connection.toml" if number == 1 else f"connection-{number}.toml")


def read_choice(path: Path, tell: Tell = lambda _: None, usual: ConnectionChoice = FIRST_CHOICE) -> ConnectionChoice:
    """The last choice, as `read_preferences`; the usual one where none was kept."""
    return read_preferences(path, usual, tell)


@dataclass(frozen=True, slots=True)
class FlightSettings:
    """What the pilot chose.

    Parameters
    ----------
    needs_rtk
        Do not start without RTK, and warn when it is lost.
    operator, serial_number
        For remote identification: public part of the operator's number, and the aircraft's serial number; empty: none.
    battery
        What the pilot calls the battery on board, for the log book; empty: nobody said.
    corrections
        Where RTK corrections come from, `USER@HOST:PORT/MOUNTPOINT`; empty: nowhere. A password is never kept.
    speaks
        Warnings are spoken, where the computer can.
    video
        Address of the camera's stream, as `services.fly.video.video_url` takes it; empty: none.
    camera_definition
        Path of the camera's definition file, by which it is set over a link; empty: the camera is asked for its own.
    """

    needs_rtk: bool = False
    operator: str = ""
    serial_number: str = ""
    corrections: str = ""
    battery: str = ""
    speaks: bool = True
    video: str = ""
    camera_definition: str = ""

    @property
    def identity(self) -> RemoteId:
        """What the operator says of itself; a file that was edited by hand may hold what does not fit."""
        try:
            return RemoteId(self.operator, self.serial_number)
        except ValueError:
            return RemoteId()


USUAL = FlightSettings()


def flight_settings_path(number: int = 1) -> Path:
    """Where they are kept for the next start of an aircraft, from 1: beside the settings of the program."""
    return settings_path().with_name("flight.toml" if number == 1 else f"flight-{number}.toml")


def read_flight_settings(path: Path, tell: Tell = lambda _: None, usual: FlightSettings = USUAL) -> FlightSettings:
    """What was kept, as `read_preferences`; the usual ones where nothing was."""
    return read_preferences(path, usual, tell)
