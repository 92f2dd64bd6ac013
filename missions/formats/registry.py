"""Every mission format behind one door: plans out, missions in.

Writing checks what it wrote with the format's own checks and refuses to leave a file that an aircraft would refuse.
Reading looks at the content, never only at the name of a file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from missions.formats.encode import DEFAULT_OPTIONS, EncodedFiles, ExportOptions, encode
from missions.mission.model import FileFormat, ReadMission
from missions.mission.safe_files import KMZ_FILE, MISSION_FILE
from planning.base.errors import InputError, MissionError
from planning.base.files import open_given
from planning.base.findings import Severity
from planning.base.json_file import write_together
from planning.geo.frames import Origin, Vec3
from planning.plan import Plan

HEAD_BYTES = 4096
"""Enough of a file to see what it is."""

_Reader = Callable[[Path, bool], tuple[ReadMission, ...]]
"""Takes the file, and whether to refuse what an aircraft would refuse."""


def export(
    plan: Plan,
    origin: Origin | None,
    home_enu_m: Vec3 | None,
    file_format: FileFormat,
    path: Path,
    options: ExportOptions = DEFAULT_OPTIONS,
) -> tuple[Path, ...]:
    """Write a plan as mission files, all of them or none.

    The first sortie gets exactly `path`, the next ones `<stem>-2<suffix>` and so on; KML and CSV hold all sorties.

    Parameters
    ----------
    origin, home_enu_m
        Of the site, for plans that do not carry them.

    Returns
    -------
    paths
        The files written.

    Raises
    ------
    InputError
        Something is missing from the plan, or the folder cannot be written.
    MissionError
        The plan cannot be flown as it stands, or not with this format; nothing is written.
    """
    return write_files(encode(plan, origin, home_enu_m, file_format, options), path)


def write_files(encoded: EncodedFiles, path: Path) -> tuple[Path, ...]:
    """Write encoded missions, all of them or none; see `export`."""
    errors = [finding for finding in encoded.findings if finding.severity is Severity.ERROR]
    if errors:
        first = f"{errors[0].place}: {errors[0].message}".removeprefix(": ")
        more = f" (and {len(errors) - 1} more errors)" if len(errors) > 1 else ""
        raise MissionError(f"the mission would be refused: {first}{more}")
    paths = tuple(sortie_path(path, number) for number in range(1, len(encoded.contents) + 1))
    write_together(dict(zip(paths, encoded.contents, strict=True)))
    return paths


def sortie_path(path: Path, number: int) -> Path:
    """File of a sortie, counted from 1."""
    return path if number == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}")


def read_missions(path: Path, *, strict: bool = False) -> tuple[ReadMission, ...]:
    """The sorties of a mission file of any format, or of a folder with the two unpacked parts of a DJI mission.

    A mission is read for what it would do, also where an aircraft might refuse it: findings tell.

    Parameters
    ----------
    strict
        Refuse what an aircraft would refuse.

    Raises
    ------
    InputError
        The file is missing, unreadable or of no format that is known.
    MissionError
        It is of a known format, but cannot be flown or understood; the message says why.
    """
    if path.is_dir():
        from missions.dji.read import read_dji

        return read_dji(path, strict=strict)
    return _reader(path)(path, strict)


def is_mission(head: bytes) -> bool:
    """Whether a file that begins like this is a mission file; JSON is not told from other JSON."""
    text = _without_mark(head)
    if text.startswith(b"<"):
        return b"<kml" in head
    return not text.startswith(b"{") and _reader_of(head) is not None


def _reader(path: Path) -> _Reader:
    with open_given(path, replace(KMZ_FILE, what=MISSION_FILE.what)) as file:
        head = file.read(HEAD_BYTES)
    reader = _reader_of(head)
    if reader is None:
        raise InputError(
            f"{path}: no mission file that is known; expected a DJI KMZ (or its unpacked folder), a QGroundControl "
            ".plan, a QGC WPL .waypoints, or a KML or CSV that Reflight wrote"
        )
    return reader


def _reader_of(head: bytes) -> _Reader | None:
    from missions.dji.read import read_dji
    from missions.formats.csv_table import is_csv_table, read_csv
    from missions.formats.kml_view import read_kml

    text = _without_mark(head)
    if head.startswith(b"PK") or b"/wpmz/" in head:
        return lambda path, strict: read_dji(path, strict=strict)
    if text.startswith(b"<"):
        return lambda path, _strict: read_kml(path)
    if text.startswith(b"{"):
        return _read_plan_json
    if text.startswith(b"QGC WPL"):
        return _read_wpl
    return (lambda path, _strict: read_csv(path)) if is_csv_table(head) else None


def _without_mark(head: bytes) -> bytes:
    """The beginning of a text file without the byte order mark that editors on Windows put in front."""
    return head.removeprefix(b"\xef\xbb\xbf").lstrip()


def _read_plan_json(path: Path, strict: bool) -> tuple[ReadMission, ...]:
    from missions.mavlink.plan_json import read_plan_json
    from missions.mavlink.read import read_mavlink

    return (read_mavlink(path, read_plan_json(path), FileFormat.MAVLINK_PLAN, strict=strict),)


def _read_wpl(path: Path, strict: bool) -> tuple[ReadMission, ...]:
    from missions.mavlink.read import read_mavlink
    from missions.mavlink.wpl import read_wpl

    return (read_mavlink(path, read_wpl(path), FileFormat.MAVLINK_WPL, strict=strict),)
