"""How long an autopilot takes for a mission's items: the plan's motion, and the waits that are in the items.

Plans reckon with an aircraft that turns at the waypoint, as DJI's do. Both MAVLink autopilots turn nose and gimbal on
the way, and what is left of the turn is in the hold. PX4 brakes more gently (`planning.motion.px4`), but its hold
counts from when the place is within the item's radius, before the aircraft rests or the nose points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from pymavlink.dialects.v20 import common as mavlink

from groundstation.vehicle.setup import landing, leg_late_s
from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import MissionItem
from missions.mission.model import Mission
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Vec3, wrap_heading_deg
from planning.motion.px4 import px4_legs_s, px4_turn_s
from planning.motion.timing import MotionLimits, leg_times_s, motion_limits
from planning.plan import Plan


class TimedOrders(Protocol):
    """What of a sortie's orders its time depends on (`orders.SortieOrders`)."""

    @property
    def mission(self) -> Mission:
        """The sortie."""

    @property
    def items(self) -> Mapping[Autopilot, Sequence[MissionItem]]:
        """Its items as each autopilot gets them."""

    @property
    def home_enu_m(self) -> Vec3:
        """Where it takes off."""


def items_duration_s(orders: TimedOrders, autopilot: Autopilot) -> float:
    """Time from lift-off to touch-down, seconds, as `autopilot` flies a sortie's items.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the wind that the plan expects.
    """
    mission = orders.mission
    rules = replace(mission.rules, max_speed_m_s=None)
    limits = replace(motion_limits(mission.aircraft, rules), horizontal_m_s=mission.speed_m_s)
    if mission.aircraft.max_jerk_m_s3 is None:
        limits = replace(limits, jerk_m_s3=facts(autopilot).own_jerk_m_s3 or math.inf)
    headings = {photo.viewpoint_id: photo.heading_deg for waypoint in mission.waypoints for photo in waypoint.photos}
    items, here, nose_deg, total_s = orders.items[autopilot], orders.home_enu_m, 0.0, 0.0
    for item, following in zip(items, (*items[1:], None), strict=True):
        if item.command in (mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT):
            there = _place(item, mission)
            item_s = float(leg_times_s(np.array([np.subtract(there, here)]), limits)[0]) + item.params[0]
            if autopilot is Autopilot.PX4 and item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
                leg = np.array([np.subtract(there, here)])
                item_s = float(px4_legs_s(leg, limits, item.params[1])[0]) + item.params[0]
            if autopilot is Autopilot.PX4 and following is not None and following.viewpoint_id:
                turn_deg = abs(wrap_heading_deg(headings[following.viewpoint_id] - nose_deg))
                item_s = max(item_s, px4_turn_s(turn_deg, math.degrees(limits.yaw_rate_rad_s)))
                nose_deg = headings[following.viewpoint_id]
            here = there
            total_s += item_s
            total_s += leg_late_s(autopilot) if item.command == mavlink.MAV_CMD_NAV_WAYPOINT else 0.0
        elif item.command == mavlink.MAV_CMD_NAV_DELAY:
            total_s += item.params[0]
        elif item.command == mavlink.MAV_CMD_NAV_LAND:
            total_s += _landing_s(here, orders.home_enu_m, autopilot, limits)
    return total_s


def timed_by_items(plan: Plan, items_s: Mapping[int, float]) -> Plan:
    """A plan whose sorties take as long as their items, and the time on the ground besides.

    Parameters
    ----------
    items_s
        From lift-off to touch-down, by the number of the sortie; the others stay as they are.
    """
    ground_s = plan.rules.takeoff_landing_s
    sorties = (
        replace(sortie, duration_s=items_s[number] + ground_s) if number in items_s else sortie
        for number, sortie in enumerate(plan.sorties, 1)
    )
    return replace(plan, sorties=tuple(sorties))


def _place(item: MissionItem, mission: Mission) -> Vec3:
    """Local position of an item whose height counts from take-off."""
    lat_deg, lon_deg, above_m = item.params[4:]
    height_m = mission.takeoff.height_ellipsoid_m + above_m
    x, y, z = enu_from_geodetic(mission.origin, lat_deg, lon_deg, height_m)[0]
    return (float(x), float(y), float(z))


def _landing_s(here: Vec3, home: Vec3, autopilot: Autopilot, limits: MotionLimits) -> float:
    """From above home to the ground: at the autopilot's usual speed, then slowly."""
    slow = landing(autopilot)
    height_m = max(0.0, here[2] - home[2])
    fast_m = max(0.0, height_m - slow.below_m)
    return fast_m / limits.descent_m_s + (height_m - fast_m) / slow.speed_m_s
