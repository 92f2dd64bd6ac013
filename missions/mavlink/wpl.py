r"""`QGC WPL` files (`.waypoints`, `.txt`): one item a line, as Mission Planner and QGroundControl keep them.

Line 0 of version 110 is the home position: QGroundControl, Mission Planner and pymavlink all take it for that, whatever
the autopilot. Lines end in \n, because MAVSDK reads no others; Mission Planner's own end in \r\n and are read as well.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.items import MavlinkFile, MissionItem, has_place, home_of
from missions.mission.model import GeoPoint, altitude_amsl_m
from missions.mission.safe_files import MAX_LINES, read_limited
from planning.base.errors import MissionError
from planning.base.files import check_lines
from planning.base.findings import Finding, Severity
from planning.base.messages import about, say

N_COLUMNS = 12
HOME_IN_LINE_0, NO_HOME = "110", "120"

_HEADER = re.compile(r"QGC WPL (\d+)")


def wpl_bytes(items: tuple[MissionItem, ...], home: GeoPoint) -> bytes:
    """Items behind the home position, tab-separated."""
    home_params = (0.0, 0.0, 0.0, 0.0, round(home.lat_deg, 9), round(home.lon_deg, 9), round(altitude_amsl_m(home), 4))
    with_home = (MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL, home_params), *items)
    lines = ["QGC WPL 110"]
    for seq, item in enumerate(with_home):
        current = "1" if seq == 0 else "0"
        numbers = [_number(value) for value in item.params]
        lines.append("\t".join([str(seq), current, str(item.frame), str(item.command), *numbers, "1"]))
    return ("\n".join(lines) + "\n").encode()


def _number(value: float) -> str:
    """At most 9 decimals, "nan" as QGroundControl spells it, never an exponent or "-0"."""
    text = f"{value:.9f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def read_wpl(path: Path) -> MavlinkFile:
    """Items and home of a file.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no such file, or a line is wrong; the message names the line.
    """
    try:
        content = read_limited(path)
        check_lines(content, MAX_LINES, path)
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise MissionError.say("expected text, found other bytes at offset {}", error.start, place=path) from error
    header = _HEADER.fullmatch(lines[0].strip()) if lines else None
    if header is None or header[1] not in (HOME_IN_LINE_0, NO_HOME):
        found = lines[0].strip()[:40] if lines else ""
        raise MissionError.say("expected 'QGC WPL 110' in the first line, found '{}'", found, place=path)
    items = [
        _read_line(line, say("{}, line {}", path, number))
        for number, line in enumerate(lines[1:], 2)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    findings: tuple[Finding, ...] = ()
    wrong = next((place for place, (seq, _) in enumerate(items) if seq != place), None)
    if wrong is not None:
        text = say("expected the items numbered from 0 in order, found {} in place {}", items[wrong][0], wrong)
        if sorted(seq for seq, _ in items) != list(range(len(items))):
            raise MissionError(about(path, text))
        items.sort(key=lambda item: item[0])
        findings = (Finding(Severity.WARNING, "order", say("{}; they are taken in the order of their numbers", text)),)
    home = None
    kept = [item for _, item in items]
    # Mission Planner writes command 0 where home was never set. A file that begins with a take-off has no home.
    if kept and header[1] == HOME_IN_LINE_0 and kept[0].command in (0, mavlink.MAV_CMD_NAV_WAYPOINT):
        home, on_home = home_of(*kept.pop(0).params[4:])
        findings += on_home
    elif kept and header[1] == HOME_IN_LINE_0:
        findings += tuple(_misplaced_home(kept))
    return MavlinkFile(tuple(kept), home, findings=findings)


def _misplaced_home(items: Sequence[MissionItem]) -> Iterator[Finding]:
    """The one waypoint above sea level of a mission above take-off, where home is missing from line 0: home is so."""
    placed = [(number, item) for number, item in enumerate(items) if has_place(item)]
    above_sea = [
        (number, item)
        for number, item in placed
        if item.frame == mavlink.MAV_FRAME_GLOBAL and item.command == mavlink.MAV_CMD_NAV_WAYPOINT
    ]
    if len(above_sea) == 1 and len(placed) > 2:
        number, item = above_sea[0]
        text = say(
            "item {} looks like home, which belongs into line 0: where it stands, vehicles fly to it, {:.0f} m above "
            "sea level; if it is home, make it line 0 and number the others anew",
            number,
            item.params[6],
        )
        yield Finding(Severity.WARNING, "home", text)


def _read_line(line: str, place: str) -> tuple[int, MissionItem]:
    columns = line.split()
    if len(columns) != N_COLUMNS:
        raise MissionError.say("expected {} columns, found {}", N_COLUMNS, len(columns), place=place)
    try:
        seq, frame, command = int(columns[0]), int(columns[2]), int(columns[3])
        p1, p2, p3, p4, p5, p6, p7 = (float(column) for column in columns[4:11])
    except ValueError as error:
        raise MissionError.say("expected numbers with a decimal point ({})", error, place=place) from error
    return seq, MissionItem(command, frame, (p1, p2, p3, p4, p5, p6, p7))
