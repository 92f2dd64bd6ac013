"""Sending mission files to a card or a remote controller: written, read back from there, and compared with the plan.

Every file is written whole beside its place and read back before it takes the place of another one. Nothing is called
sent that was not read back byte by byte and understood as what was planned. A route of DJI Fly that is replaced is
first copied to this computer. A plan that breaks a rule of the pre-flight check is sent only where the pilot says so.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from groundstation.services.mission.compare import compare_with_plan
from groundstation.services.mission.export import find_site
from groundstation.services.mission.files import not_ready, prepare_export
from groundstation.services.mission.storages import App, Route, Storage
from groundstation.services.project.input_files import read_input_plan
from missions.formats.options import DEFAULT_OPTIONS, ExportOptions
from missions.formats.registry import read_missions
from missions.mission.export_choices import FileFormat
from missions.mission.model import ReadMission
from missions.mission.safe_files import KMZ_FILE
from planning.base.errors import GroundStationError, InputError, MissionError
from planning.base.files import make_folder, open_input_file, read_input_file
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.plan import Plan
from planning.site.records import SiteModel

_NOT_IN_NAMES = re.compile(r'[<>:"/|?*._\\\x00-\x1f]+')
"""What DJI's Cloud API forbids in the name of a wayline (`^[^<>:"/|?*._\\\\]+$`)."""

MAX_NAME = 60

FLY_WAYPOINTS = 99
"""DJI Fly's remote controllers fail above this."""

PART = ".{}.part"
"""Of a file in the making: no app takes it for a route."""

SPARE_BYTES = 64 * 1024
"""Folders and file tables of the card grow, too."""

GONE = frozenset({errno.ENOENT, errno.EIO, errno.ENODEV, errno.ENXIO, errno.ENOTCONN, errno.ESTALE, errno.EBADF})
"""What a system says of a device that was pulled out."""


@dataclass(frozen=True, slots=True, eq=False)
class Payload:
    """What is to be sent, one file a sortie.

    Parameters
    ----------
    name
        Of the mission; further sorties get a number behind it.
    plan, site_model
        What the files are to be once they are read back; None for files of others, which are to be what they were.
    missions
        As the files are read here.
    """

    name: str
    contents: tuple[bytes, ...]
    missions: tuple[ReadMission, ...]
    findings: tuple[Finding, ...] = ()
    plan: Plan | None = None
    site_model: SiteModel | None = None


@dataclass(frozen=True, slots=True)
class Target:
    """A file to be sent: its place there, and the route that it replaces."""

    path: Path
    content: bytes
    route: Route | None = None


@dataclass(frozen=True, slots=True)
class SentFile:
    """A file that is there now, read back and equal.

    Parameters
    ----------
    sha256
        Of its content, hexadecimal.
    backup
        Copy on this computer of what it replaced.
    was_there
        The same file was there already, and nothing was written.
    """

    path: Path
    n_bytes: int
    sha256: str
    backup: Path | None = None
    was_there: bool = False


@dataclass(frozen=True, slots=True)
class PreparedSending:
    """Where files would go, or the reason why they cannot.

    Parameters
    ----------
    replaced
        Files that are there and would be replaced.
    refusal
        What has to be put right first; empty where they can be sent.
    """

    targets: tuple[Target, ...] = ()
    findings: tuple[Finding, ...] = ()
    replaced: tuple[Path, ...] = ()
    refusal: str = ""

    @property
    def is_ready_to_fly(self) -> bool:
        """Whether the plan breaks no rule of the pre-flight check; else the pilot has to say that it is sent."""
        return not_ready(self.findings) is None


def payload_of_plan(plan: Plan, site_model: SiteModel, name: str, options: ExportOptions = DEFAULT_OPTIONS) -> Payload:
    """A plan as DJI missions, ready to be sent.

    Raises
    ------
    MissionError
        It cannot be exported, or an aircraft would refuse it.
    """
    prepared = prepare_export(plan, site_model, FileFormat.DJI_KMZ, options)
    if prepared.encoded is None:
        raise MissionError.say("cannot be sent: {}", prepared.refusal)
    errors = [found for found in prepared.findings if found.severity is Severity.ERROR]
    if errors:
        raise MissionError.say("not sent, the aircraft would refuse it: {}", errors[0].message)
    contents = prepared.encoded.contents
    return Payload(name, contents, _read_all(contents), prepared.findings, plan, site_model)


def payload_of_files(
    paths: Sequence[Path], site_path: Path | None = None, options: ExportOptions = DEFAULT_OPTIONS
) -> Payload:
    """A plan file, or DJI mission files of one flight, ready to be sent.

    Raises
    ------
    InputError, MissionError
        A file cannot be read, is no DJI mission, or an aircraft would refuse it.
    """
    first = paths[0]
    if len(paths) == 1 and first.suffix.lower() == ".json":
        plan = read_input_plan(first)
        site_model = find_site(plan, first, site_path)
        if site_model is None:
            raise InputError.say(
                "the site that this plan was made for is not beside it; name its file, too", place=first
            )
        return payload_of_plan(plan, site_model, first.name.removesuffix(".json").removesuffix(".plan"), options)
    missions: list[ReadMission] = []
    for path in paths:
        read = read_missions(path, strict=True)
        if path.is_dir() or read[0].format != FileFormat.DJI_KMZ:
            raise InputError.say(
                "expected a plan or a DJI mission (.kmz); remote controllers of DJI take nothing else", place=path
            )
        missions += read
    contents = tuple(read_input_file(path, KMZ_FILE) for path in paths)
    text = say("mission files were not checked on their site: send their plan, or look whether it is ready to fly")
    unknown = Finding(Severity.WARNING, "not-checked", text)
    findings = (unknown, *(found for mission in missions for found in mission.findings))
    return Payload(first.stem, contents, tuple(missions), findings)


def _read_all(contents: Sequence[bytes]) -> tuple[ReadMission, ...]:
    """What the files say, as anybody reads them."""
    import tempfile

    missions: list[ReadMission] = []
    with tempfile.TemporaryDirectory(prefix="reflight-") as folder:
        for number, content in enumerate(contents, 1):
            path = Path(folder) / f"{number}.kmz"
            path.write_bytes(content)
            missions += read_missions(path, strict=True)
    return tuple(missions)


def route_name(text: str) -> str:
    """A name as DJI's apps take it: without `< > : " / | ? * . _` and backslashes."""
    return re.sub(r"-{2,}", "-", _NOT_IN_NAMES.sub("-", text)).strip(" -")[:MAX_NAME].rstrip(" -") or "mission"


def targets_of(
    payload: Payload,
    storage: Storage,
    route_ids: Sequence[str] = (),
    *,
    may_replace: bool = False,
    despite_errors: bool = False,
) -> tuple[tuple[Target, ...], tuple[Finding, ...]]:
    """Where each file goes, and what the pilot must know first.

    Parameters
    ----------
    route_ids
        Routes of DJI Fly to be replaced, one for each sortie in order; the first letters are enough.
    may_replace
        Another mission of the same name may be replaced. Routes of DJI Fly are always.
    despite_errors
        A plan that is not ready to fly is sent, too.

    Raises
    ------
    InputError
        Routes are missing, or another mission has the name.
    MissionError
        The plan is not ready to fly.
    """
    against = not_ready(payload.findings)
    if against is not None and not despite_errors:
        raise MissionError.say(
            "not sent. {}. Correct the plan, or take the risk with --despite-errors: the aircraft flies what it is "
            "sent",
            against.message,
        )
    findings = list(_findings(payload, storage))
    if storage.app is App.DJI_FLY:
        targets = tuple(_fly_targets(payload, storage, route_ids))
        ids = ", ".join(target.path.stem for target in targets)
        text = say(
            "replaces what DJI Fly has as route {}; its name and picture in DJI Fly stay the old ones; do not save it "
            "again in DJI Fly, which would write it anew",
            ids,
        )
        return targets, (*findings, Finding(Severity.WARNING, "route-replaced", text))
    if route_ids:
        raise InputError.say("routes are named for DJI Fly only; {} takes files by their names", storage.app)
    name = route_name(payload.name)
    names = [name if number == 1 else f"{name}-{number}" for number in range(1, len(payload.contents) + 1)]
    # Cards are FAT: Office.kmz and office.kmz are one file there.
    there = {path.name.casefold(): path for path in _files(storage.folder)}
    targets = tuple(
        Target(there.get(f"{each}.kmz".casefold(), storage.folder / f"{each}.kmz"), content)
        for each, content in zip(names, payload.contents, strict=True)
    )
    others = replaced_files(targets)
    if others and not may_replace:
        raise InputError.say(
            "another mission of this name is there; send it under another name, or allow to replace it",
            place=others[0],
        )
    if name != payload.name:
        text = say("the mission is called '{}' there: DJI's apps take no dots and underscores in names", name)
        findings.append(Finding(Severity.NOTE, "route-name", text))
    return targets, tuple(findings)


def prepare_sending(payload: Payload, storage: Storage, route_ids: Sequence[str]) -> PreparedSending:
    """What sending would do; what the user can put right is part of the result, and nothing is raised for it."""
    try:
        targets, findings = targets_of(payload, storage, route_ids, may_replace=True, despite_errors=True)
        return PreparedSending(targets, findings, replaced_files(targets))
    except GroundStationError as error:
        return PreparedSending(refusal=str(error))


def _fly_targets(payload: Payload, storage: Storage, route_ids: Sequence[str]) -> Iterator[Target]:
    n = len(payload.contents)
    if len(route_ids) != n:
        raise InputError.say(
            "DJI Fly has no import, so each sortie replaces a route that is there: choose {} of the {} routes; make "
            "more in DJI Fly where there are too few",
            n,
            len(storage.routes),
            place=storage.root,
        )
    taken: set[str] = set()
    for typed, content in zip(route_ids, payload.contents, strict=True):
        fitting = [route for route in storage.routes if route.id.casefold().startswith(typed.casefold())]
        if len(fitting) != 1 or not typed:
            found = say("none begins so") if not fitting else say("{} begin so", len(fitting))
            raise InputError.say("route '{}': expected the beginning of one route's id, {}", typed, found)
        if fitting[0].id in taken:
            raise InputError.say("route {} is named twice; each sortie needs one of its own", fitting[0].id)
        taken.add(fitting[0].id)
        yield Target(fitting[0].path, content, fitting[0])


def _findings(payload: Payload, storage: Storage) -> Iterator[Finding]:
    yield from (found for found in payload.findings if found.severity is not Severity.OK)
    if storage.is_aircraft_card:
        text = say(
            "this looks like the card of a camera (it has a folder DCIM); DJI Pilot 2 reads the card in the remote "
            "controller"
        )
        yield Finding(Severity.WARNING, "camera-card", text, storage.name)
    if storage.app is App.DJI_FLY:
        if payload.plan is not None:
            text = say(
                "DJI Fly was not tried with this route: it is written for {}, which DJI Pilot 2 flies; look at every "
                "waypoint in DJI Fly before take-off",
                payload.plan.aircraft.name,
            )
            yield Finding(Severity.WARNING, "other-app", text)
        most = max((len(mission.waypoints) for mission in payload.missions), default=0)
        if most > FLY_WAYPOINTS:
            text = say("{} waypoints in a route; remote controllers with DJI Fly fail above {}", most, FLY_WAYPOINTS)
            yield Finding(Severity.WARNING, "fly-waypoints", text, "", float(most), float(FLY_WAYPOINTS), "waypoints")


def _files(folder: Path) -> tuple[Path, ...]:
    try:
        return tuple(folder.iterdir())
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise _lost(folder, error) from error


def replaced_files(targets: Sequence[Target]) -> tuple[Path, ...]:
    """Files that are there, and are others than those to be sent.

    Raises
    ------
    InputError
        They cannot be read.
    """
    return tuple(target.path for target in targets if _differs(target))


def _differs(target: Target) -> bool:
    return target.path.exists() and read_input_file(target.path, KMZ_FILE) != target.content


def send(
    payload: Payload,
    storage: Storage,
    targets: Sequence[Target],
    backups: Path,
    monitor: Monitor = QUIET,
    clock: Callable[[], float] = time.time,
) -> tuple[SentFile, ...]:
    """Write the files, read them back from the device and compare; all of them, or as it was before.

    Parameters
    ----------
    backups
        Folder of this computer for copies of what is replaced.
    clock
        Seconds since 1970 UTC, for the names of these copies.

    Raises
    ------
    InputError
        There is too little space, the device cannot be written or was removed, or what is read back is not what was
        written. Nothing half-written is left where the device can still be reached.
    """
    waiting = [target for target in targets if not (target.path.exists() and not _differs(target))]
    _check_space(storage, waiting)
    copies = _back_up(waiting, backups, clock())
    with _device(storage.folder):
        if not storage.folder.is_dir():
            storage.folder.mkdir()
        _remove_parts(targets)
        place = _place_by_mtp if storage.is_mtp else _place
        place(waiting, copies, monitor)
    monitor.report(say("reading back"), 0, len(targets))
    _compare(payload, targets)
    monitor.report(say("reading back"), len(targets), len(targets))
    return tuple(
        SentFile(
            target.path,
            len(target.content),
            hashlib.sha256(target.content).hexdigest(),
            copies.get(target.path),
            target not in waiting,
        )
        for target in targets
    )


def _check_space(storage: Storage, targets: Sequence[Target]) -> None:
    needed = sum(len(target.content) for target in targets) + SPARE_BYTES
    if targets and storage.free_bytes is not None and storage.free_bytes < needed:
        raise InputError.say(
            "has {:.1f} MB free, the files need {:.1f} MB; delete something there",
            storage.free_bytes / 1e6,
            needed / 1e6,
            place=storage.root,
        )


def _back_up(targets: Sequence[Target], folder: Path, now_s: float) -> dict[Path, Path]:
    """Copies of what is replaced, by its path; written before anything is touched."""
    copies: dict[Path, Path] = {}
    stamp = time.strftime("%Y%m%d-%H%M%S", time.gmtime(now_s))
    for target in targets:
        if not target.path.exists():
            continue
        content = read_input_file(target.path, KMZ_FILE)
        make_folder(folder)
        numbers = itertools.count(2)
        copy = folder / f"{target.path.stem}-{stamp}.kmz"
        while copy.exists():
            copy = folder / f"{target.path.stem}-{stamp}-{next(numbers)}.kmz"
        try:
            _write(copy, content)
        except OSError as error:
            raise InputError.say(
                "what is to be replaced cannot be copied here first ({}); nothing was sent",
                error.strerror or error,
                place=copy,
            ) from error
        copies[target.path] = copy
    return copies


@contextmanager
def _device(place: Path) -> Iterator[None]:
    """Say what happened to the device in one line."""
    try:
        yield
    except OSError as error:
        raise _lost(place, error) from error


def _lost(place: Path, error: OSError) -> InputError:
    if error.errno == errno.ENOSPC:
        return InputError.say("is full; delete something there and send again", place=place)
    if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        return InputError.say(
            "may not be written ({}); is the card locked by its slider, or the device by its screen?",
            error.strerror or error,
            place=place,
        )
    if error.errno in GONE:
        return InputError.say(
            "the device was removed, or no longer answers ({}); connect it and send again",
            error.strerror or error,
            place=place,
        )
    return InputError.say("cannot be written ({}); send again", error.strerror or error, place=place)


def _remove_parts(targets: Sequence[Target]) -> None:
    """What an earlier sending left behind when the device was pulled out."""
    for target in targets:
        target.path.with_name(PART.format(target.path.name)).unlink(missing_ok=True)


def _place(targets: Sequence[Target], copies: dict[Path, Path], monitor: Monitor) -> None:
    """Write all beside their places, read them back, then let each take its place; undone where that fails."""
    parts = [target.path.with_name(PART.format(target.path.name)) for target in targets]
    placed: list[Target] = []
    try:
        for number, (target, part) in enumerate(zip(targets, parts, strict=True)):
            monitor.report(say("writing"), number, len(targets))
            _write(part, target.content)
            _check_equal(part, target.content)
        for target, part in zip(targets, parts, strict=True):
            placed.append(target)
            part.replace(target.path)
        for folder in {target.path.parent for target in targets}:
            _sync_folder(folder)
    except BaseException:
        for part in parts:
            with suppress(OSError):
                part.unlink(missing_ok=True)
        _restore(placed, copies)
        raise


def _place_by_mtp(targets: Sequence[Target], copies: dict[Path, Path], monitor: Monitor) -> None:
    """Delete and write anew, one after the other: MTP has no renaming over a file, and no file is open twice."""
    placed: list[Target] = []
    try:
        for number, target in enumerate(targets):
            monitor.report(say("writing"), number, len(targets))
            placed.append(target)
            target.path.unlink(missing_ok=True)
            _write(target.path, target.content)
            _check_equal(target.path, target.content)
    except BaseException:
        _restore(placed, copies)
        raise


def _restore(placed: Sequence[Target], copies: dict[Path, Path]) -> None:
    """What was there before, where the device still answers; the copies on this computer stay in any case."""
    for target in placed:
        with suppress(OSError, InputError):
            copy = copies.get(target.path)
            if copy is None:
                target.path.unlink(missing_ok=True)
            else:
                _write(target.path, read_input_file(copy, KMZ_FILE))


def _write(path: Path, content: bytes) -> None:
    """Write a file and have the system put it on the medium."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0)
    file = os.open(path, flags, 0o644)
    try:
        view = memoryview(content)
        while view:
            view = view[os.write(file, view) :]
        try:
            os.fsync(file)
        except OSError as error:
            # Filesystems of FUSE may not know it; they write when the file is closed.
            if error.errno not in (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP):
                raise
    finally:
        os.close(file)


def _sync_folder(folder: Path) -> None:
    """The new names, too; not everywhere can a folder be synced."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    with suppress(OSError):
        file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(file)
        finally:
            os.close(file)


def _check_equal(path: Path, content: bytes) -> None:
    """Read a file back from the medium, not from the system's memory of what was written.

    Raises
    ------
    InputError
        It is another one.
    """
    with open_input_file(path, KMZ_FILE) as file:
        if hasattr(os, "posix_fadvise"):
            with suppress(OSError):
                os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
        found = file.read(len(content) + 1)
    if found != content:
        first = next((i for i, (a, b) in enumerate(zip(found, content, strict=False)) if a != b), len(found))
        raise InputError.say(
            "what is read back is not what was written (it differs from byte {} on); the card may be broken: use "
            "another one",
            first,
            place=path,
        )


def _compare(payload: Payload, targets: Sequence[Target]) -> None:
    """Read everything back once more where the app will look for it, and understand it.

    Raises
    ------
    InputError
        A file is another one, or what the files say together is not what was to be sent.
    """
    for target in targets:
        _check_equal(target.path, target.content)
    read = tuple(mission for target in targets for mission in read_missions(target.path))
    if payload.plan is not None and payload.site_model is not None:
        site = payload.site_model.site
        compared = compare_with_plan(read, payload.plan, site.origin, site.home_enu_m)
        is_same = compared.is_the_plan
    else:
        is_same = [_said(mission) for mission in read] == [_said(mission) for mission in payload.missions]
    if not is_same:
        raise InputError.say(
            "what is there now is not the plan when it is read; do not fly it", place=targets[0].path.parent
        )


def _said(mission: ReadMission) -> ReadMission:
    """A mission whatever its file is called."""
    return replace(mission, path=Path(), name="", findings=())
