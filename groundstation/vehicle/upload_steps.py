"""What a sortie puts on board, and reads back: geofence, rally points, mission. Part of the steps in `steps.py`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from groundstation.vehicle.orders import fence_messages, rally_messages
from groundstation.vehicle.preflight import PreflightCheck, Verdict
from groundstation.vehicle.reread import MissionReread
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address
from missions.mavlink.transfer.download import Download, DownloadOutcome
from missions.mavlink.transfer.exchange import Ending, MissionType, Route
from missions.mavlink.transfer.verified import NotVerified, Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import to_wire
from planning.errors import LinkRejected

if TYPE_CHECKING:
    from groundstation.vehicle.flight_run import FlightRun, Steps


def vehicle_of(run: FlightRun) -> tuple[Autopilot, Address]:
    """Kind and address of the vehicle, once one was heard."""
    autopilot, address = run.state.autopilot, run.state.address
    assert autopilot is not None
    assert address is not None
    return autopilot, address


def upload(run: FlightRun) -> Steps:
    """Geofence first: a mission is never on board without its fence."""
    autopilot, address = vehicle_of(run)
    if run.orders.fences:
        route = Route(run.own, address, MissionType.FENCE)
        yield from _put(run, "geofence", VerifiedUpload(route, fence_messages(run.orders.fences, autopilot), autopilot))
        run.on_board = replace(run.on_board, fence=True)
    yield from _put_rally_points(run)
    messages = to_wire(run.orders.items[autopilot], autopilot)
    yield from _put(run, "mission", VerifiedUpload(Route(run.own, address), messages, autopilot))
    run.on_board = replace(run.on_board, mission=True)


def _put_rally_points(run: FlightRun) -> Steps:
    """Rally points of the site; those of another place are never left on board."""
    autopilot, address = vehicle_of(run)
    route = Route(run.own, address, MissionType.RALLY)
    if run.orders.rally:
        yield from _put(
            run, "list of rally points", VerifiedUpload(route, rally_messages(run.orders, autopilot), autopilot)
        )
        run.on_board = replace(run.on_board, rally=True)
        return
    read: DownloadOutcome = yield Download(route)
    text = ""
    if read.ending is Ending.SILENT:
        text = "the vehicle does not say whether it has rally points; look before it returns by itself"
    elif read.items:
        yield from _put(run, "list of rally points", VerifiedUpload(route, (), autopilot))
        text = f"the vehicle had {len(read.items)} rally points of another flight; they are cleared"
    if text:
        run.note("warning-rally", text)
        told = PreflightCheck("rally", Verdict.WARN, text)
        run.on_board = replace(run.on_board, failsafes=(told, *run.on_board.failsafes))


def _put(run: FlightRun, what: str, upload: VerifiedUpload) -> Steps:
    outcome: Verified | NotVerified = yield upload
    if isinstance(outcome, NotVerified):
        raise LinkRejected(f"the {what} is not on the vehicle: {outcome}")
    run.note("uploaded", f"{what}: {len(outcome.items)} items, read back and equal")


def reread_mission(run: FlightRun) -> MissionReread:
    """What is on board now, compared with what was uploaded."""
    autopilot, address = vehicle_of(run)

    def done(text: str, is_equal: bool | None) -> None:
        run.note("mission-reread", text)
        run.on_board = replace(run.on_board, mission=is_equal)

    return MissionReread(Route(run.own, address), to_wire(run.orders.items[autopilot], autopilot), autopilot, done)
