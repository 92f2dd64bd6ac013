"""A MAVLink mission file read back: the sortie it describes, with the photos that the vehicle would take."""

from __future__ import annotations

from pathlib import Path

from missions.mavlink.check import check_items
from missions.mavlink.fly import MavlinkFlight
from missions.mavlink.items import MavlinkFile
from missions.model import FileFormat, HeightReference, ReadMission, as_remark, reasons
from planning.errors import MissionError
from planning.findings import Finding, Severity


def read_mavlink(path: Path, file: MavlinkFile, file_format: FileFormat, *, strict: bool = False) -> ReadMission:
    """The sortie that the items of a file describe.

    What an autopilot would refuse is a finding here and no reason to refuse: the file may be for another autopilot.
    Only what keeps the flight from being known is refused, unless `strict` asks for more.

    Raises
    ------
    MissionError
        There is no waypoint, or one whose place or height cannot be known; or, if `strict`, autopilots refuse it.
    """
    flight = MavlinkFlight(file, f"{path}: ")
    flight.fly()
    if not flight.flown:
        raise MissionError(f"{path}: the mission has no waypoint, so there is nothing to fly")
    is_relative = any(point.height_above_takeoff_m is not None for point in flight.flown)
    checks = check_items(file, flight.autopilot)
    errors = [finding for finding in checks if finding.severity is Severity.ERROR]
    if strict and errors:
        raise MissionError(f"{path}: the vehicle would refuse this mission: {reasons(errors)}")
    return ReadMission(
        name=path.stem,
        path=path,
        format=file_format,
        waypoints=tuple(flight.flown),
        takeoff=file.home,
        height_reference=HeightReference.ABOVE_TAKEOFF if is_relative else HeightReference.AMSL,
        finish=flight.finish,
        climb_above_takeoff_m=flight.climb_m,
        speed_m_s=file.cruise_speed_m_s or flight.speed_m_s,
        findings=(*file.findings, *map(as_remark, checks), *flight.findings, *_on_rally(file)),
    )


def _on_rally(file: MavlinkFile) -> tuple[Finding, ...]:
    if not file.rally:
        return ()
    text = f"the file has {len(file.rally)} rally points, which belong to a site and not to a plan; mark them there"
    return (Finding(Severity.NOTE, "rally-points", text, "", float(len(file.rally))),)
