"""Every mission format behind one door: plans out, missions in.

Writing checks what it wrote with the format's own checks and refuses to leave a file that an aircraft would refuse.
Reading looks at the content, never only at the name of a file. Plug-ins add formats: an entry point of the group
`reflight.mission_formats` stands for a `MissionFormat`. What takes time is imported by the functions that need it: the
command line describes itself from this table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

from missions.formats.options import DEFAULT_OPTIONS, EncodedFiles, ExportOptions
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.safe_files import KMZ_FILE, MISSION_FILE
from planning.base.errors import InputError, MissionError
from planning.base.files import open_input_file
from planning.base.findings import Finding, Severity
from planning.base.messages import about, glue, say
from planning.base.plugins import (
    Plugin,
    PluginGroup,
    expect_type,
    guarded,
    guarded_question,
    load_plugins,
    plugin_problem,
)

if TYPE_CHECKING:
    from missions.mission.model import Mission, ReadMission
    from planning.geo.frames import Origin, Vec3
    from planning.plan import Plan

    _Reader = Callable[[Path, bool], tuple[ReadMission, ...]]
    """Takes the file, and whether to refuse what an aircraft would refuse."""

    _Encoder = Callable[[Plan, Sequence[Mission], ExportOptions], EncodedFiles]

HEAD_BYTES = 4096
"""Enough of a file to see what it is."""


@dataclass(frozen=True, slots=True)
class MissionFormat:
    """A format of mission files.

    Parameters
    ----------
    endings
        Of the names of its files, with the dot; the first is proposed.
    encode
        Takes a plan, its sorties, and what the pilot chose; gives the contents of the files, one for each sortie or one
        for all, and findings on them. With an error among the findings nothing is written.
    begins, read
        Whether a file that begins with these bytes (up to `HEAD_BYTES`) is of this format, and the sorties in it. None:
        the format is only written.
    title
        In the window's list: such as "Table of photos (.csv)".
    options
        What it takes of `ExportOptions`, by name; None for all.
    heights
        References of heights that it knows.
    """

    endings: tuple[str, ...]
    encode: _Encoder
    begins: Callable[[bytes], bool] | None = None
    read: _Reader | None = None
    title: str = ""
    options: frozenset[str] | None = None
    heights: tuple[HeightReference, ...] = tuple(HeightReference)

    def __post_init__(self) -> None:
        if not self.endings or not all(ending.startswith(".") for ending in self.endings):
            raise ValueError(f"endings: expected such as ('.csv',), got {self.endings}")
        if (self.begins is None) != (self.read is None):
            raise ValueError("begins and read: expected both or none of them")

    def takes(self, option: str) -> bool:
        """Whether the format has a use for one of `ExportOptions`."""
        return self.options is None or option in self.options


def _encode_dji(plan: Plan, missions: Sequence[Mission], options: ExportOptions) -> EncodedFiles:
    from missions.formats.encode import encode_dji

    return encode_dji(plan, missions, options)


def _encode_mavlink(
    file_format: FileFormat, plan: Plan, missions: Sequence[Mission], options: ExportOptions
) -> EncodedFiles:
    from missions.formats.camera_steps import camera_steps
    from missions.formats.encode import default_autopilot, encode_mavlink

    encoded = encode_mavlink(missions, file_format, options)
    steps = camera_steps(plan, file_format, options.autopilot or default_autopilot(plan.profile))
    return replace(encoded, findings=(*encoded.findings, *steps.findings()))


def _encode_kml(_plan: Plan, missions: Sequence[Mission], _options: ExportOptions) -> EncodedFiles:
    from missions.formats.kml_view import kml_bytes

    return EncodedFiles((kml_bytes(missions),), ())


def _encode_csv(_plan: Plan, missions: Sequence[Mission], _options: ExportOptions) -> EncodedFiles:
    from missions.formats.csv_table import csv_bytes

    return EncodedFiles((csv_bytes(missions),), ())


OF_DJI = frozenset(("height_reference", "link_loss", "rth_height_m"))
OF_MAVLINK = frozenset(("height_reference", "autopilot"))
MAVLINK_HEIGHTS = (HeightReference.ABOVE_TAKEOFF, HeightReference.AMSL)

FORMATS: dict[str, MissionFormat] = {
    FileFormat.DJI_KMZ: MissionFormat((".kmz",), _encode_dji, title=say("DJI (.kmz)"), options=OF_DJI),
    FileFormat.MAVLINK_PLAN: MissionFormat(
        (".plan",),
        partial(_encode_mavlink, FileFormat.MAVLINK_PLAN),
        title=say("QGroundControl (.plan)"),
        options=OF_MAVLINK,
        heights=MAVLINK_HEIGHTS,
    ),
    FileFormat.MAVLINK_WPL: MissionFormat(
        (".waypoints", ".txt"),
        partial(_encode_mavlink, FileFormat.MAVLINK_WPL),
        title=say("Mission Planner (.waypoints)"),
        options=OF_MAVLINK,
        heights=MAVLINK_HEIGHTS,
    ),
    FileFormat.KML: MissionFormat(
        (".kml",), _encode_kml, title=say("Google Earth (.kml), to look at"), options=frozenset()
    ),
    FileFormat.CSV: MissionFormat((".csv",), _encode_csv, title=say("Table of photos (.csv)"), options=frozenset()),
}
"""Of this program, by the name on the command line; `_reader_of` tells their files apart."""


@cache
def mission_formats() -> dict[str, MissionFormat]:
    """All formats by the name on the command line: those of this program, then those of plug-ins."""
    return FORMATS | load_plugins(PluginGroup.MISSION_FORMATS, _of_plugin, FORMATS)


def _of_plugin(plugin: Plugin, found: object) -> MissionFormat:
    own = expect_type(found, MissionFormat)
    return replace(
        own,
        title=own.title or plugin.name,
        encode=guarded(plugin, own.encode, EncodedFiles),
        begins=None if own.begins is None else guarded_question(plugin, own.begins),
        read=None if own.read is None else guarded(plugin, own.read, tuple),
    )


def mission_format(name: str) -> MissionFormat:
    """A format by its name.

    Raises
    ------
    InputError
        There is none; the message lists all, or says why a plug-in was left out.
    """
    if name in FORMATS:
        return FORMATS[name]
    if name not in mission_formats():
        problem = plugin_problem(PluginGroup.MISSION_FORMATS, name)
        known = ", ".join(mission_formats())
        raise InputError(
            say("there is no mission format '{}'; known are: {}", name, known) if problem is None else str(problem)
        )
    return mission_formats()[name]


def encode(
    plan: Plan,
    origin: Origin | None,
    home_enu_m: Vec3 | None,
    file_format: str,
    options: ExportOptions = DEFAULT_OPTIONS,
) -> EncodedFiles:
    """Contents that `export` writes, with all findings instead of a refusal at the first.

    Raises
    ------
    InputError, MissionError
        As `export`, where there is nothing to check.
    """
    from missions.mission.build import missions_from_plan

    missions = missions_from_plan(plan, origin, home_enu_m)
    encoded = mission_format(file_format).encode(plan, missions, options)
    return replace(encoded, findings=(*_on_passing(plan, missions), *encoded.findings))


def _on_passing(plan: Plan, missions: Sequence[Mission]) -> Iterator[Finding]:
    """An imported mission that takes photos in passing is another one when it is written: it stops for each."""
    for sortie, mission in zip(plan.sorties, missions, strict=True):
        n = len(sortie.in_passing_ids)
        if n:
            text = say(
                "{} photos that the imported mission takes in passing are stops in these files, so the sortie "
                "takes {:.0f} s instead of {:.0f} s",
                n,
                mission.duration_s,
                sortie.duration_s,
            )
            place = say("sortie {}", mission.number)
            yield Finding(Severity.WARNING, "in-passing", text, place, mission.duration_s, sortie.duration_s, "s")


def write_files(encoded: EncodedFiles, path: Path, beside: Mapping[Path, bytes] | None = None) -> tuple[Path, ...]:
    """Write encoded missions, and what goes beside them, all of them or none; paths of the missions; see `export`."""
    from planning.base.json_file import write_together

    errors = [finding for finding in encoded.findings if finding.severity is Severity.ERROR]
    if errors:
        first = about(errors[0].place, errors[0].message) if errors[0].place else errors[0].message
        more = say(" (and {} more errors)", len(errors) - 1) if len(errors) > 1 else ""
        raise MissionError.say("the mission would be refused: {}", glue(first, more))
    paths = tuple(sortie_path(path, number) for number in range(1, len(encoded.contents) + 1))
    write_together({**dict(zip(paths, encoded.contents, strict=True)), **(beside or {})})
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
    if _plugin_reader_of(head) is not None:
        return True
    text = _without_mark(head)
    if text.startswith(b"<"):
        return b"<kml" in head
    return not text.startswith(b"{") and _reader_of(head) is not None


def _reader(path: Path) -> _Reader:
    with open_input_file(path, replace(KMZ_FILE, what=MISSION_FILE.what)) as file:
        head = file.read(HEAD_BYTES)
    reader = _reader_of(head)
    if reader is None:
        raise InputError.say(
            "no mission file that is known; expected a DJI KMZ (or its unpacked folder), a QGroundControl "
            ".plan, a QGC WPL .waypoints, or a KML or CSV that Reflight wrote",
            place=path,
        )
    return reader


def _plugin_reader_of(head: bytes) -> _Reader | None:
    """Of a plug-in that knows the file: asked first, as their ZIP, XML or JSON may look like that of this program."""
    of_plugins = (each for name, each in mission_formats().items() if name not in FORMATS)
    return next((each.read for each in of_plugins if each.begins is not None and each.begins(head)), None)


def _reader_of(head: bytes) -> _Reader | None:
    from missions.dji.read import read_dji
    from missions.formats.csv_table import is_csv_table, read_csv
    from missions.formats.kml_view import read_kml

    of_plugin = _plugin_reader_of(head)
    if of_plugin is not None:
        return of_plugin
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
