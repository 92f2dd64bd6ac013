"""What becomes of the pilot's requests: the orders they are, when they are done, and what is said of them."""

from __future__ import annotations

from groundstation.services.live_events import Request
from groundstation.vehicle.run_records import Phase, PilotOrder

REFUSALS = {
    Request.UPLOAD: "nothing can be uploaded now: the vehicle must be heard, on the ground and disarmed",
    Request.START: "the pre-flight list is not all well, or nothing was uploaded yet",
    Request.PAUSE: "the vehicle does not fly its mission, so there is nothing to pause",
    Request.RESUME: "the vehicle is not in flight, so there is nothing to resume",
    Request.RETURN: "no vehicle was heard yet, so none can return",
    Request.LAND: "no vehicle was heard yet, so none can land",
    Request.DISCONNECT: "there is no link",
}
REACHED = {Request.UPLOAD: (Phase.CHECKING, Phase.READY), Request.START: (Phase.FLYING,)}
"""Phases in which the run has done what was asked for."""

DONE = {
    Request.UPLOAD: "the mission is on board, read back and equal",
    Request.START: "the aircraft flies its mission",
}

ORDERS = {
    Request.PAUSE: PilotOrder.PAUSE,
    Request.RESUME: PilotOrder.RESUME,
    Request.RETURN: PilotOrder.RETURN,
    Request.LAND: PilotOrder.LAND,
}
