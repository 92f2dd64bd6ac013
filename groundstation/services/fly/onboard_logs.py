"""Logs from the vehicle's card over the link: listed, fetched, proved by their checksums, and kept as files."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from groundstation.vehicle.onboard_logs import FetchedLogs, LogFetch, LogListing, OnboardFile, newest
from missions.flight.logs.read import LOG_FILE
from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.link import (
    GROUND_HEARTBEAT,
    GROUND_STATION,
    HEARTBEAT_EVERY_S,
    LONGEST_WAIT_S,
    Link,
    drive,
    open_link,
)
from missions.mavlink.messages import Address, Heartbeat
from missions.mavlink.signing import Signer
from missions.mavlink.transfer.exchange import Route
from planning.base.errors import InputError, LinkError, LinkTimeout
from planning.base.files import make_folder, read_input_file
from planning.base.json_file import write_atomically
from planning.base.messages import about
from planning.base.progress import QUIET, Clock, Monitor

HEARD_S = 10.0
"""Autopilots send a heartbeat each second; a lossy link loses some."""


@dataclass(frozen=True, slots=True)
class KeptLog:
    """A log that was fetched.

    Parameters
    ----------
    is_checked
        The vehicle's checksum proved it; else it knows none.
    was_there
        The same file was there already.
    """

    file: OnboardFile
    path: Path
    is_checked: bool
    was_there: bool = False


def list_logs(
    url: str, signer: Signer | None = None, monitor: Monitor = QUIET, clock: Clock = time.perf_counter
) -> tuple[OnboardFile, ...]:
    """Logs on the card of the vehicle at a link, the oldest first.

    Raises
    ------
    InputError
        The url is none.
    LinkError
        The link cannot be opened, no autopilot answers, or it does not list them.
    """
    with closing(open_link(url, signer=signer, clock=clock)) as link:
        return _listed(link, url, monitor, clock)


def fetch_logs(
    url: str,
    folder: Path,
    n: int = 1,
    names: Sequence[str] = (),
    signer: Signer | None = None,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> tuple[KeptLog, ...]:
    """Fetch the newest logs, or those of these names, into a folder; each file is written once all of it is there.

    Raises
    ------
    InputError
        The url is none, a name is not on the vehicle, or a file cannot be written.
    LinkError
        As `list_logs`, or a log does not come.
    """
    with closing(open_link(url, signer=signer, clock=clock)) as link:
        files = _listed(link, url, monitor, clock)
        chosen = newest(files, n) if not names else tuple(_named(files, name, url) for name in names)
        if not chosen:
            raise LinkError.say("the logs on the vehicle are empty", place=url)
        make_folder(folder)
        route, _ = _vehicle(link, url, clock)
        begun = {file.name: _begun(file, folder) for file in chosen if file.log_id is not None}
        fetched = drive(LogFetch(route, chosen, begun), link, clock, monitor)
    kept = keep_logs(fetched, folder)
    if fetched.problem:
        raise LinkError(fetched.problem)
    return kept


def keep_logs(fetched: FetchedLogs, folder: Path) -> tuple[KeptLog, ...]:
    """Write logs that came; another file of the same name stays, and the new one gets a number.

    What came of one that did not come whole stands beside them as `.part`, from which another try goes on.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    make_folder(folder)
    kept = tuple(_keep(file, content, is_checked, folder) for file, content, is_checked in fetched.files)
    for file, *_ in fetched.files:
        _part(file, folder).unlink(missing_ok=True)
    if fetched.begun is not None:
        write_atomically(_part(fetched.begun[0], folder), fetched.begun[1])
    return kept


def _part(file: OnboardFile, folder: Path) -> Path:
    return folder / f"{file.name}.{file.n_bytes}.part"


def _begun(file: OnboardFile, folder: Path) -> bytes:
    path = _part(file, folder)
    return read_input_file(path, LOG_FILE) if path.is_file() else b""


def _keep(file: OnboardFile, content: bytes, is_checked: bool, folder: Path) -> KeptLog:
    path, number = folder / file.name, 1
    while path.exists():
        if path.is_file() and path.stat().st_size == len(content) and read_input_file(path, LOG_FILE) == content:
            return KeptLog(file, path, is_checked, True)
        number += 1
        path = folder / f"{Path(file.name).stem}-{number}{Path(file.name).suffix}"
    write_atomically(path, content)
    return KeptLog(file, path, is_checked)


def _named(files: Sequence[OnboardFile], name: str, url: str) -> OnboardFile:
    found = next((each for each in files if name in (each.name, each.path)), None)
    if found is None:
        known = ", ".join(each.name for each in files[-5:])
        raise InputError.say("there is no log '{}' on the vehicle; the newest are: {}", name, known, place=url)
    return found


def _listed(link: Link, url: str, monitor: Monitor, clock: Clock) -> tuple[OnboardFile, ...]:
    listed = drive(LogListing(*_vehicle(link, url, clock)), link, clock, monitor)
    if listed.problem:
        raise LinkError(about(url, listed.problem))
    return listed.files


def _vehicle(link: Link, url: str, clock: Clock) -> tuple[Route, Autopilot]:
    """The first autopilot that is heard."""
    end_s, heartbeat_s = clock() + HEARD_S, clock()
    while clock() < end_s:
        if clock() >= heartbeat_s:
            heartbeat_s += HEARTBEAT_EVERY_S
            link.send(GROUND_HEARTBEAT)
        received = link.receive(LONGEST_WAIT_S)
        if received is None or not isinstance(received.message, Heartbeat):
            continue
        number = received.message.autopilot
        autopilot = next((each for each in Autopilot if facts(each).firmware_type == number), None)
        if autopilot is not None:
            return Route(_own(link), received.source), autopilot
    raise LinkTimeout.say("no ArduPilot or PX4 is heard within {:g} s; is it switched on?", HEARD_S, place=url)


def _own(link: Link) -> Address:
    return getattr(link, "address", GROUND_STATION)
