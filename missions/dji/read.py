"""A DJI mission read back: one sortie per wayline, with the photos that the aircraft would take."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from missions.dji.check import check_dji, is_on_globe
from missions.dji.container import DjiParts, load_parts
from missions.dji.fly import Flight, FlownPoint
from missions.dji.wpml import Folder
from missions.model import FileFormat, Finish, GeoPoint, HeightReference, ReadMission, ReadWaypoint, as_remark, reasons
from planning.errors import MissionError
from planning.findings import Finding, Severity

_FINISH = {"goHome": Finish.RETURN, "autoLand": Finish.LAND}


def read_dji(path: Path, *, strict: bool = False) -> tuple[ReadMission, ...]:
    """The waylines of a KMZ, or of a folder with its two unpacked parts.

    The waylines count, as for the aircraft; where the template says otherwise a finding tells. What an aircraft would
    refuse is a finding, too, and no reason to refuse, unless `strict` asks for it or the path is not known.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no DJI mission, its path is not in the file, or aircraft refuse it, if `strict`; the message says why.
    """
    parts = load_parts(path)
    findings = check_dji(parts)
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    unknown = [finding for finding in errors if _hides_path(finding)]
    if unknown or (strict and errors):
        others = [finding for finding in errors if finding not in unknown]
        raise MissionError(f"{path}: aircraft would refuse this mission: {reasons([*unknown, *others])}")
    remarks = tuple(map(as_remark, findings))
    return tuple(_read_wayline(path, parts, folder, remarks) for folder in parts.waylines.folders)


def _hides_path(error: Finding) -> bool:
    """Whether an error leaves open where the aircraft flies: no waypoints, no place, no height, heights of no kind."""
    return error.code in ("coordinates", "height-mode") or (
        error.code in ("height", "waypoint-count") and error.value in (None, 0.0)
    )


def _read_wayline(path: Path, parts: DjiParts, folder: Folder, findings: tuple[Finding, ...]) -> ReadMission:
    if folder.height_mode == "realTimeFollowSurface":
        raise MissionError(
            f"{path}: the mission follows the ground as the aircraft senses it, so its heights are not in the file; "
            "save it with fixed heights"
        )
    is_relative = folder.height_mode == "relativeToStartPoint"
    is_ours = _is_ours(parts)
    flight = Flight(folder, is_ours)
    flown = flight.points()
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
        speed_m_s=_possible(folder.speed_m_s),
        transit_speed_m_s=_possible(parts.waylines.config.transitional_speed_m_s),
        stated_s=None if is_ours else folder.duration_s,
        findings=(*findings, *flight.findings),
    )


def _possible(speed_m_s: float | None) -> float | None:
    """A speed, or None where it is none."""
    return speed_m_s if speed_m_s is not None and 0.0 < speed_m_s < math.inf else None


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
