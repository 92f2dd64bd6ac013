"""A DJI mission read back: one sortie per wayline, with the photos that the aircraft would take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from missions.dji.check import check_dji, is_on_globe
from missions.dji.container import DjiParts, load_parts
from missions.dji.fly import Flight, FlownPoint
from missions.dji.wpml import Folder
from missions.model import FileFormat, Finish, GeoPoint, HeightReference, ReadMission, ReadWaypoint
from planning.errors import MissionError
from planning.findings import Finding, Severity

MAX_REASONS = 3
"""Kinds of errors that a refusal spells out; the others are counted."""


_FINISH = {"goHome": Finish.RETURN, "autoLand": Finish.LAND}


def read_dji(path: Path) -> tuple[ReadMission, ...]:
    """The waylines of a KMZ, or of a folder with its two unpacked parts.

    The waylines count, as for the aircraft; where the template says otherwise a finding tells.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no DJI mission, or one that aircraft refuse; the message says why.
    """
    parts = load_parts(path)
    findings = check_dji(parts)
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    if errors:
        raise MissionError(f"{path}: aircraft would refuse this mission: {_reasons(errors)}")
    return tuple(_read_wayline(path, parts, folder, findings) for folder in parts.waylines.folders)


def _reasons(errors: Sequence[Finding]) -> str:
    """One example of each kind of error, and how often it occurs."""
    kinds: dict[str, list[Finding]] = {}
    for error in errors:
        kinds.setdefault(error.code, []).append(error)
    reasons = []
    for found in list(kinds.values())[:MAX_REASONS]:
        place = found[0].place.strip(", ")
        times = f" ({len(found)} times)" if len(found) > 1 else ""
        reasons.append(f"{place}: {found[0].message}{times}" if place else f"{found[0].message}{times}")
    return "; ".join(reasons) + (f"; and {len(kinds) - MAX_REASONS} other kinds" if len(kinds) > MAX_REASONS else "")


def _read_wayline(path: Path, parts: DjiParts, folder: Folder, findings: tuple[Finding, ...]) -> ReadMission:
    if folder.height_mode == "realTimeFollowSurface":
        raise MissionError(
            f"{path}: the mission follows the ground as the aircraft senses it, so its heights are not in the file; "
            "save it with fixed heights"
        )
    is_relative = folder.height_mode == "relativeToStartPoint"
    is_ours = _is_ours(parts)
    flown = Flight(folder, is_ours).points()
    if is_ours:
        flown = [replace(point, stay=None) for point in flown]
    several = len(parts.waylines.folders) > 1
    return ReadMission(
        name=f"{path.stem}-{(folder.wayline_id or 0) + 1}" if several else path.stem,
        path=path,
        format=FileFormat.DJI_KMZ,
        waypoints=tuple(_waypoint(point, is_relative=is_relative) for point in flown),
        takeoff=_takeoff(parts),
        height_reference=HeightReference.ABOVE_TAKEOFF if is_relative else HeightReference.ELLIPSOID,
        finish=_FINISH.get(parts.waylines.config.finish_action, Finish.HOVER),
        climb_above_takeoff_m=parts.waylines.config.takeoff_security_height_m or 0.0,
        return_above_takeoff_m=parts.waylines.config.rth_height_m or 0.0,
        speed_m_s=folder.speed_m_s,
        stated_s=None if is_ours else folder.duration_s,
        findings=findings,
    )


def _is_ours(parts: DjiParts) -> bool:
    return parts.template is not None and parts.template.author == "Reflight"


def _waypoint(point: FlownPoint, *, is_relative: bool) -> ReadWaypoint:
    height = {"height_above_takeoff_m" if is_relative else "height_ellipsoid_m": point.height_m}
    return ReadWaypoint(
        point.lat_deg, point.lon_deg, photos=point.photos, stay=point.stay, speed_m_s=point.speed_m_s, **height
    )


def _takeoff(parts: DjiParts) -> GeoPoint | None:
    """The template's takeOffRefPoint; latitude and longitude 0 mean that only a height was recorded."""
    reference = None if parts.template is None else parts.template.config.takeoff_ref_lat_lon_height
    if reference is None or reference[:2] == (0.0, 0.0) or not is_on_globe(reference):
        return None
    return GeoPoint(*reference)
