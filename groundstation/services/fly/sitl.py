"""ArduCopter's own simulation, started from its binary: at the plan's home, with a camera, in a folder of its own."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from missions.mavlink.link import open_link
from missions.mission.model import GeoPoint, altitude_amsl_m
from planning.base.errors import InputError, LinkError
from planning.base.files import real_path
from planning.base.progress import QUIET, Monitor

SITL_LINK = "tcp:127.0.0.1:5760"
"""Where its first instance listens."""

START_S, END_S = 30.0, 5.0

DEFAULTS = {
    "FRAME_CLASS": 1,
    "FRAME_TYPE": 1,
    "CAM1_TYPE": 1,
    "MNT1_TYPE": 1,
    "BATT_MONITOR": 4,
    "INS_ACCOFFS_X": 0.001,
    "INS_ACC2OFFS_X": 0.001,
}
"""Parameters at first power-up: a quadrotor with camera, gimbal and battery, whose accelerometers count as calibrated.
ArduPilot's own Tools/autotest/default_params/copter.parm, where it is given, comes first."""

MODEL = "x"
"""Motors as FRAME_TYPE 1 has them."""

CURRENT_A = 28.3
"""What its quadrotor draws in flight; measured, 4.7.0-dev."""

Restart = Callable[[int], None]
"""Starts the simulation again, with a full battery; the number is that of the sortie that comes next."""


@contextmanager
def sitl(
    binary: Path, home: GeoPoint, speedup: float, endurance_s: float, defaults: Path | None, monitor: Monitor = QUIET
) -> Iterator[Restart]:
    """Run ArduCopter's simulation at `SITL_LINK`, and end it afterwards; gives what starts it again.

    Parameters
    ----------
    endurance_s
        How long its battery shall last.
    defaults
        A file of parameters; None: those above are enough.

    Raises
    ------
    InputError
        The binary or the file of defaults is missing or cannot be run.
    LinkError
        It ended at once, or opened no link in time; the message holds its last words.
    """
    if defaults is not None and not defaults.is_file():
        raise InputError(f"{defaults}: there is no such file; expected ArduPilot's copter.parm")
    with tempfile.TemporaryDirectory(prefix="reflight-sitl-") as folder:
        own = Path(folder, "reflight.parm")
        values = {**DEFAULTS, "BATT_CAPACITY": round(CURRENT_A * endurance_s / 3.6)}
        own.write_text("".join(f"{name} {value}\n" for name, value in values.items()))
        place = f"{home.lat_deg:.9f},{home.lon_deg:.9f},{altitude_amsl_m(home):.2f},0"
        files = ",".join(str(real_path(path)) for path in (defaults, own) if path is not None)
        command = [str(real_path(binary)), "--model", MODEL, "--speedup", f"{speedup:g}", "--home", place]
        command += ["--defaults", files, "-I0"]
        process = _started([*command, "-w"], Path(folder), monitor)

        def restart(_number: int) -> None:
            nonlocal process
            _end(process)
            process = _started(command, Path(folder), monitor)

        try:
            yield restart
        finally:
            _end(process)


def _started(command: list[str], folder: Path, monitor: Monitor) -> subprocess.Popen[bytes]:
    """The running simulation, once it listens."""
    binary, said = Path(command[0]), folder / "output.txt"
    with said.open("w+b") as output:
        try:
            process = subprocess.Popen(
                command, cwd=folder, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
            )
        except OSError as error:
            raise InputError(f"{binary}: cannot be run ({error.strerror or error}); name an arducopter") from error
    try:
        _wait_for_link(process, binary, said, monitor)
    except BaseException:
        _end(process)
        raise
    return process


def _wait_for_link(process: subprocess.Popen[bytes], binary: Path, output: Path, monitor: Monitor) -> None:
    """Wait until it listens; a link that is opened and closed again does no harm."""
    deadline_s = time.monotonic() + START_S
    while True:
        monitor.report("starting the simulation", 0, 0)
        if process.poll() is not None:
            said = output.read_text(errors="replace").strip().splitlines()[-1:] or ["it said nothing"]
            raise LinkError(f"{binary}: ended at once with status {process.returncode} ({said[0]})")
        try:
            open_link(SITL_LINK).close()
        except LinkError as error:
            if time.monotonic() > deadline_s:
                raise LinkError(f"{binary}: opened no link at {SITL_LINK} within {START_S:g} s") from error
            time.sleep(0.1)
        else:
            return


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
