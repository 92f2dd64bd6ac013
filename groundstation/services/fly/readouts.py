"""From what is known of a vehicle to what the pilot reads, and what may be asked for now: pure functions."""

from __future__ import annotations

import math

import numpy as np

from groundstation.services.fly.events import LinkState, LiveView, Readouts, Request
from groundstation.services.fly.to_go import ToGo
from groundstation.services.project.steps import FlightState
from groundstation.vehicle.commands import MISSION_MODE
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.surroundings import Surroundings

NOT_KNOWN = ToGo()

BEFORE_TAKE_OFF = (None, Phase.CHECKING, Phase.READY, Phase.ENDED)
"""Phases in which a mission may be uploaded, again or for the first time."""


def link_state(state: VehicleState, now_s: float, *, is_open: bool) -> LinkState:
    """How the link is; a link that broke is lost once a vehicle was heard on it, and opening before."""
    if state.heartbeat is None:
        return LinkState.SILENT if is_open else LinkState.OPENING
    return LinkState.ALIVE if is_open and state.is_link_alive(now_s) else LinkState.LOST


def allowed_requests(
    link: LinkState, phase: Phase | None, state: VehicleState, *, is_ready: bool
) -> frozenset[Request]:
    """What the pilot may ask for now.

    Returning and landing is refused only where the vehicle surely stands: it is disarmed on a live link, and no start
    or flight is under way.
    """
    if link is LinkState.CLOSED:
        return frozenset()
    allowed = {Request.DISCONNECT}
    if link not in (LinkState.ALIVE, LinkState.LOST):
        return frozenset(allowed)
    if link is LinkState.LOST or state.is_armed or phase in (Phase.STARTING, Phase.FLYING):
        allowed |= {Request.RETURN, Request.LAND}
    if link is LinkState.LOST:
        return frozenset(allowed)
    if phase in BEFORE_TAKE_OFF and not state.is_armed:
        allowed |= {Request.UPLOAD, Request.LOG}
    if phase is Phase.READY and is_ready and not state.is_armed:
        allowed.add(Request.START)
    if state.is_armed and phase is not Phase.STARTING:
        allowed.add(Request.PAUSE if flies_mission(state) else Request.RESUME)
    return frozenset(allowed)


def flight_state(view: LiveView) -> FlightState:
    """Which step of a flight comes next; after a landing the mission can be sent again."""
    if view.state.is_armed:
        return FlightState.IN_AIR
    if Request.START in view.may:
        return FlightState.READY
    if view.phase in (Phase.CHECKING, Phase.READY):
        return FlightState.ON_BOARD
    return FlightState.CONNECTED if Request.UPLOAD in view.may else FlightState.BUSY


def flies_mission(state: VehicleState) -> bool:
    """Whether it is in the mode in which it flies its mission."""
    return state.autopilot is not None and state.mode is not None and state.mode.value == MISSION_MODE[state.autopilot]


def battery_left_s(remaining: float, reserve: float, endurance_s: float) -> float:
    """Time until a battery is at its reserve, at the aircraft's endurance."""
    return max(0.0, remaining - reserve) * endurance_s


def readouts(
    state: VehicleState, around: Surroundings, ground_z_m: float | None = None, left: ToGo = NOT_KNOWN
) -> Readouts:
    """What the pilot reads at a glance; `ground_z_m` is the site's level ground, None where nobody knows it."""
    height = above_ground = speed = facade = battery = left_s = wind = wind_from = None
    if state.motion is not None:
        motion = state.motion.value
        if ground_z_m is not None and around.space.ground.terrain is not None:
            below = float(around.space.ground.heights_m(np.array([motion.position_enu_m]))[0])
            ground_z_m = below if math.isfinite(below) else None
        above_ground = None if ground_z_m is None else motion.position_enu_m[2] - ground_z_m
        height, speed = motion.height_above_home_m, math.hypot(*motion.velocity_enu_m_s)
        facade = float(around.space.solids.clearance_m(np.array([motion.position_enu_m]))[0])
    if state.battery is not None and state.battery.value.remaining is not None:
        battery = state.battery.value.remaining
        left_s = battery_left_s(battery, around.rules.battery_reserve, around.aircraft.endurance_s)
    if state.wind_enu_m_s is not None:
        east, north, _ = state.wind_enu_m_s.value
        wind, wind_from = math.hypot(east, north), math.degrees(math.atan2(-east, -north)) % 360.0
    fix = None if state.fix is None else state.fix.value
    return Readouts(
        height_m=height,
        above_ground_m=above_ground,
        speed_m_s=speed,
        facade_m=facade,
        least_facade_m=around.space.min_distance_m,
        battery=battery,
        battery_left_s=left_s,
        wind_m_s=wind,
        wind_from_deg=wind_from,
        fix_type=None if fix is None else fix.fix_type,
        n_satellites=None if fix is None else fix.n_satellites,
        to_go_s=left.landed_s,
        next_photo_s=left.photo_s,
    )
