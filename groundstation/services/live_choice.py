"""How the pilot reaches the vehicle: what was chosen in the window, as a url, and kept for the next time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import msgspec

from groundstation.services.settings import settings_path
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import DEFAULT_BAUD
from planning.errors import InputError
from planning.json_file import read_toml, write_atomically


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


@dataclass(frozen=True, slots=True)
class ConnectionChoice:
    """What was chosen.

    Parameters
    ----------
    address
        `HOST:PORT`, or `DEVICE:BAUD`; empty for a simulation.
    autopilot, speed_up
        Of the simulation.
    """

    kind: LinkKind = LinkKind.SIMULATION
    address: str = ""
    autopilot: Autopilot = Autopilot.ARDUPILOT
    speed_up: float = 1.0

    @property
    def url(self) -> str:
        """As `missions.mavlink.link` takes it; empty for the embedded simulation."""
        return "" if self.kind is LinkKind.SIMULATION else f"{self.kind.value}:{self.address}"


def choice_path() -> Path:
    """Where the last choice is kept: beside the settings."""
    return settings_path().with_name("connection.toml")


def read_choice(path: Path) -> ConnectionChoice:
    """The last choice; the first one where none was kept, or what was kept cannot be read any more."""
    try:
        return read_toml(path, ConnectionChoice)
    except InputError:
        return ConnectionChoice()


def write_choice(path: Path, choice: ConnectionChoice) -> None:
    """Keep a choice.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    import tomli_w

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path.parent}: this folder cannot be made ({error.strerror or error})") from error
    write_atomically(path, tomli_w.dumps(msgspec.to_builtins(choice)).encode())
