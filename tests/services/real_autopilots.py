"""Real autopilots for tests and benchmarks: at a link where one runs, or from ArduPilot's simulation, a binary."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from groundstation.services.fly.flying import SITL_LINK, sitl
from missions.mavlink.autopilots import Autopilot
from missions.mission.model import GeoPoint

SPEEDUP = 10.0
ENDURANCE_S = 1500.0


def variable(autopilot: Autopilot) -> str:
    """Name of the environment variable that names the vehicle."""
    return f"REFLIGHT_SITL_{autopilot.name}"


def binary() -> Path | None:
    """ArduPilot's simulation, where the variable names one."""
    named = Path(os.environ.get(variable(Autopilot.ARDUPILOT), ""))
    return named if named.is_file() else None


@contextmanager
def real_vehicle(autopilot: Autopilot, home: GeoPoint) -> Iterator[str | None]:
    """Url of a vehicle; None where the variable names none. From the binary it stands at `home`."""
    program = binary() if autopilot is Autopilot.ARDUPILOT else None
    if program is None:
        yield os.environ.get(variable(autopilot)) or None
        return
    with sitl(program, home, SPEEDUP, ENDURANCE_S, None):
        yield SITL_LINK
