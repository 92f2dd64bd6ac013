"""A table of photos for spreadsheets and scripts: one row a photo, each height in a column of its own.

It holds the photos and nothing of the path between them, so a mission read back from it is for looking at its
coverage, not for flying.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import Mission, ReadMission, ReadPhoto, ReadWaypoint, altitude_amsl_m
from missions.mission.safe_files import MAX_LINES, read_limited
from planning.base.errors import MissionError
from planning.base.files import check_lines
from planning.base.findings import Finding, Severity
from planning.base.messages import say

COLUMNS = (
    "sortie",
    "sequence",
    "viewpoint_id",
    "lat_deg",
    "lon_deg",
    "height_ellipsoid_m",
    "altitude_amsl_m",
    "height_above_takeoff_m",
    "heading_deg",
    "gimbal_pitch_deg",
    "east_m",
    "north_m",
    "up_m",
)

NEEDED = ("sortie", "viewpoint_id", "lat_deg", "lon_deg", "height_ellipsoid_m", "heading_deg", "gimbal_pitch_deg")
"""Columns without which a table cannot be read back."""


def csv_bytes(missions: Sequence[Mission]) -> bytes:
    """All photos of all sorties in the order of flight; the last three columns are local ENU metres."""
    from planning.geo.enu import enu_from_geodetic

    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for mission in missions:
        views = [(waypoint.position, photo) for waypoint in mission.waypoints for photo in waypoint.photos]
        points = [point for point, _ in views]
        local = enu_from_geodetic(
            mission.origin,
            [point.lat_deg for point in points],
            [point.lon_deg for point in points],
            [point.height_ellipsoid_m for point in points],
        )
        for sequence, ((point, photo), (east_m, north_m, up_m)) in enumerate(zip(views, local, strict=True), 1):
            heights = (
                point.height_ellipsoid_m,
                altitude_amsl_m(point),
                mission.height_above_takeoff_m(point),
            )
            table.writerow(
                [
                    mission.number,
                    sequence,
                    photo.viewpoint_id,
                    f"{point.lat_deg:.9f}",
                    f"{point.lon_deg:.9f}",
                    *(f"{height:.4f}" for height in heights),
                    f"{photo.heading_deg:.3f}",
                    f"{photo.gimbal_pitch_deg:.3f}",
                    *(f"{value:.4f}" for value in (east_m, north_m, up_m)),
                ]
            )
    return text.getvalue().encode()


def is_csv_table(head: bytes) -> bool:
    """Whether a file that begins like this is such a table."""
    return head.removeprefix(b"\xef\xbb\xbf").startswith(",".join(COLUMNS[:5]).encode())


def read_csv(path: Path) -> tuple[ReadMission, ...]:
    """Photos by sortie; columns may stand in any order, and others among them.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        A column is missing or a row is wrong; the message names the line.
    """
    try:
        content = read_limited(path)
        check_lines(content, MAX_LINES, path)
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise MissionError.say(
            "expected text in UTF-8, found other bytes at offset {}", error.start, place=path
        ) from error
    table = csv.DictReader(text.splitlines())
    sorties: dict[int, list[ReadWaypoint]] = {}
    try:
        missing = [name for name in NEEDED if name not in (table.fieldnames or ())]
        if missing:
            raise MissionError.say("expected the column {} in the first line; it is missing", missing[0], place=path)
        for row in table:
            number, waypoint = _read_row(row, say("{}, line {}", path, table.line_num))
            sorties.setdefault(number, []).append(waypoint)
    except csv.Error as error:
        raise MissionError.say("no table of photos ({})", error, place=f"{path}, line {table.line_num}") from error
    if not sorties:
        raise MissionError.say("the table has no rows, so there is nothing to fly", place=path)
    text = say(
        "a table of photos does not say which way was flown between them; the path is straight from one to the next"
    )
    finding = Finding(Severity.NOTE, "no-path", text)
    return tuple(
        ReadMission(
            name=path.stem if len(sorties) == 1 else f"{path.stem}-{number}",
            path=path,
            format=FileFormat.CSV,
            waypoints=tuple(waypoints),
            takeoff=None,
            height_reference=HeightReference.ELLIPSOID,
            findings=(finding,),
        )
        for number, waypoints in sorted(sorties.items())
    )


def _read_row(row: dict[str, str], place: str) -> tuple[int, ReadWaypoint]:
    try:
        number = int(row["sortie"])
        names = ("lat_deg", "lon_deg", "height_ellipsoid_m", "heading_deg", "gimbal_pitch_deg")
        lat_deg, lon_deg, height_m, heading_deg, pitch_deg = (float(row[name]) for name in names)
        photo = ReadPhoto(heading_deg, pitch_deg, row["viewpoint_id"])
        return number, ReadWaypoint(lat_deg, lon_deg, height_ellipsoid_m=height_m, photos=(photo,))
    except (TypeError, ValueError) as error:
        raise MissionError.say("no photo ({}); expected numbers with a decimal point", error, place=place) from error
