"""What the vehicle will do by itself, by its parameters, against what this sortie can bear.

ArduPilot: parameter documentation of Copter 4.5, `failsafe_gcs_check`, `failsafe_radio_on_event`, `AP_BattMonitor`,
`AP_Rally`, and `compute_return_target` of RTL, which never returns above the fence's height. PX4: parameter reference
1.16 and its page of safety settings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np

from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.preflight import FOREIGN_FENCE, PreflightCheck, Verdict
from groundstation.vehicle.surroundings import Surroundings
from groundstation.vehicle.watch import DISTANCE_TOLERANCE_M
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import FENCE_CLEARANCE_M, FenceFit, fence_fit, fences_of
from missions.mavlink.messages import MissionItemInt
from planning.base.errors import MissionError
from planning.base.messages import say
from planning.geo.frames import Vec3
from planning.routing.rally import return_route

# The vehicle's own limits, a height and a circle around home, against the sortie's path before take-off.
#
# A mission that goes beyond them takes off all the same and is broken off there. ArduPilot: FENCE_ALT_MAX and
# FENCE_RADIUS, where FENCE_TYPE has their bits. PX4: GF_MAX_VER_DIST and GF_MAX_HOR_DIST, 0 for none.

FENCE_NAMES = {
    Autopilot.ARDUPILOT: (
        *("FENCE_ENABLE", "FENCE_ACTION", "FENCE_TYPE"),
        *("FENCE_ALT_MAX", "FENCE_RADIUS", "FENCE_MARGIN"),
    ),
    Autopilot.PX4: ("GF_ACTION", "GF_MAX_VER_DIST", "GF_MAX_HOR_DIST"),
}
"""Parameters that decide it, by autopilot."""

HEIGHT_FENCE, CIRCLE_FENCE, POLYGON_FENCE = 1, 2, 4
"""Bits of ArduPilot's FENCE_TYPE."""

MARGIN_M = 2.0
"""FENCE_MARGIN as ArduPilot has it: an aircraft is decimetres off its path, and its home is where it stands."""


@dataclass(frozen=True, slots=True)
class FenceLimits:
    """How far from home the vehicle lets itself fly.

    Parameters
    ----------
    height_m, radius_m
        Above take-off, and level from home; infinite where there is no limit.
    acts
        It does something there, and does not only tell.
    """

    height_m: float
    radius_m: float
    margin_m: float
    acts: bool


def fence_limits(autopilot: Autopilot, values: Mapping[str, float]) -> FenceLimits:
    """Limits by the vehicle's parameters; one that it does not know does not limit it."""
    if autopilot is Autopilot.PX4:
        height_m, radius_m = (values.get(name) or np.inf for name in ("GF_MAX_VER_DIST", "GF_MAX_HOR_DIST"))
        return FenceLimits(height_m, radius_m, MARGIN_M, bool(values.get("GF_ACTION", 1.0)))
    kinds = int(values.get("FENCE_TYPE", 0.0)) if values.get("FENCE_ENABLE", 0.0) else 0
    return FenceLimits(
        values.get("FENCE_ALT_MAX", np.inf) if kinds & HEIGHT_FENCE else np.inf,
        values.get("FENCE_RADIUS", np.inf) if kinds & CIRCLE_FENCE else np.inf,
        values.get("FENCE_MARGIN", MARGIN_M),
        bool(values.get("FENCE_ACTION", 1.0)),
    )


def fence_limit_checks(
    autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders
) -> Iterator[PreflightCheck]:
    """A line for each limit that there is; one that the sortie goes beyond grounds it where the vehicle acts there."""
    limits, path_enu_m = fence_limits(autopilot, values), orders.surroundings[autopilot].path_enu_m
    if len(path_enu_m) == 0:
        return
    x, y, z = (path_enu_m - np.array(orders.home_enu_m)).T
    highest_m, farthest_m = float(z.max()), float(np.hypot(x, y).max())
    is_ardupilot = autopilot is Autopilot.ARDUPILOT
    if np.isfinite(limits.height_m):
        name = "FENCE_ALT_MAX" if is_ardupilot else "GF_MAX_VER_DIST"
        beyond = say(
            "the sortie climbs to {:.1f} m above take-off, the vehicle's fence ends at {:g} m: raise {}",
            highest_m,
            limits.height_m,
            name,
        )
        near = say(
            "the sortie climbs to {:.1f} m below the vehicle's fence: raise {}", limits.height_m - highest_m, name
        )
        fine = say("the sortie stays {:.1f} m below the vehicle's fence ({})", limits.height_m - highest_m, name)
        yield _judged("fence-height", limits.height_m - highest_m, limits, (beyond, near, fine))
    if np.isfinite(limits.radius_m):
        name = "FENCE_RADIUS" if is_ardupilot else "GF_MAX_HOR_DIST"
        beyond = say(
            "the sortie goes {:.1f} m away from home, the vehicle's fence ends at {:g} m: raise {}",
            farthest_m,
            limits.radius_m,
            name,
        )
        near = say(
            "the sortie comes within {:.1f} m of the vehicle's fence: raise {}", limits.radius_m - farthest_m, name
        )
        fine = say("the sortie stays {:.1f} m inside the vehicle's fence ({})", limits.radius_m - farthest_m, name)
        yield _judged("fence-radius", limits.radius_m - farthest_m, limits, (beyond, near, fine))


def _judged(code: str, room_m: float, limits: FenceLimits, texts: tuple[str, str, str]) -> PreflightCheck:
    beyond, near, fine = texts
    if room_m <= 0.0:
        return PreflightCheck(code, Verdict.BAD if limits.acts else Verdict.WARN, beyond, room_m, limits.margin_m, "m")
    verdict, text = (Verdict.WARN, near) if room_m < limits.margin_m else (Verdict.OK, fine)
    return PreflightCheck(code, verdict, text, room_m, limits.margin_m, "m")


NAMES = {
    Autopilot.ARDUPILOT: (
        *("FS_GCS_ENABLE", "FS_GCS_TIMEOUT", "FS_OPTIONS", "RTL_ALT", "RTL_CONE_SLOPE"),
        *("FS_THR_ENABLE", "RC_FS_TIMEOUT", "FS_EKF_ACTION", "FS_EKF_THRESH"),
        *("BATT_CAPACITY", "BATT_FS_LOW_ACT", "BATT_LOW_VOLT", "BATT_LOW_MAH"),
        *("BATT_FS_CRT_ACT", "BATT_CRT_VOLT", "BATT_CRT_MAH"),
        *("RALLY_INCL_HOME", *FENCE_NAMES[Autopilot.ARDUPILOT]),
    ),
    Autopilot.PX4: (
        *("NAV_DLL_ACT", "COM_DL_LOSS_T", "COM_DLL_EXCEPT"),
        *("NAV_RCL_ACT", "COM_RC_LOSS_T", "COM_RCL_EXCEPT", "COM_RC_IN_MODE", "COM_POSCTL_NAVL"),
        *("COM_LOW_BAT_ACT", "BAT_CRIT_THR", "BAT_EMERGEN_THR"),
        *("RTL_RETURN_ALT", "RTL_TYPE", "RTL_CONE_ANG", "RTL_DESCEND_ALT"),
        *FENCE_NAMES[Autopilot.PX4],
    ),
}
"""Parameters that decide it, by autopilot."""


class FailsafeAction(Enum):
    """What a vehicle does by itself."""

    GO_ON = auto()
    RETURN = auto()
    LAND = auto()
    HOVER = auto()
    DRIFT = auto()
    FALL = auto()


LINK_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.RETURN,
        2: FailsafeAction.RETURN,
        3: FailsafeAction.RETURN,
        4: FailsafeAction.LAND,
        5: FailsafeAction.LAND,
        6: FailsafeAction.RETURN,
        7: FailsafeAction.HOVER,
    },
    Autopilot.PX4: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.HOVER,
        2: FailsafeAction.RETURN,
        3: FailsafeAction.LAND,
        5: FailsafeAction.FALL,
        6: FailsafeAction.FALL,
    },
}
"""FS_GCS_ENABLE and NAV_DLL_ACT; SmartRTL (3, 4) flies back along its own way, or does what stands here."""

CONTINUE_MISSION, EXCEPT_MISSION = 2, 1
"""Bits of FS_OPTIONS and of COM_DLL_EXCEPT: a mission goes on without the ground station."""

NO_STICKS = 4
"""COM_RC_IN_MODE with which PX4 takes no sticks."""

REMOTE_CONTROL_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.RETURN,
        2: FailsafeAction.RETURN,
        3: FailsafeAction.LAND,
        4: FailsafeAction.RETURN,
        5: FailsafeAction.RETURN,
        6: FailsafeAction.RETURN,
        7: FailsafeAction.LAND,
    },
    Autopilot.PX4: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.HOVER,
        2: FailsafeAction.RETURN,
        3: FailsafeAction.LAND,
        5: FailsafeAction.FALL,
        6: FailsafeAction.FALL,
    },
}
"""FS_THR_ENABLE and NAV_RCL_ACT."""

BATTERY_ACTIONS_ARDUPILOT = {
    0: FailsafeAction.GO_ON,
    1: FailsafeAction.LAND,
    2: FailsafeAction.RETURN,
    3: FailsafeAction.RETURN,
    4: FailsafeAction.RETURN,
    5: FailsafeAction.FALL,
    6: FailsafeAction.RETURN,
    7: FailsafeAction.LAND,
}
"""BATT_FS_LOW_ACT and BATT_FS_CRT_ACT; they act where a voltage or a charge is set for it."""

BATTERY_STAGES_PX4 = {
    1: (("BAT_CRIT_THR", FailsafeAction.RETURN, False), ("BAT_EMERGEN_THR", FailsafeAction.LAND, True)),
    2: (("BAT_CRIT_THR", FailsafeAction.LAND, True),),
    3: (("BAT_CRIT_THR", FailsafeAction.RETURN, False), ("BAT_EMERGEN_THR", FailsafeAction.LAND, True)),
}
"""By COM_LOW_BAT_ACT, 0 only warns: the parameter with the charge, what is done below it, and whether more follows."""

POSITION_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: FailsafeAction.DRIFT,
        1: FailsafeAction.LAND,
        2: FailsafeAction.DRIFT,
        3: FailsafeAction.LAND,
    },
    Autopilot.PX4: {0: FailsafeAction.DRIFT, 1: FailsafeAction.LAND},
}
"""FS_EKF_ACTION (0 only reports, 2 keeps the height) and COM_POSCTL_NAVL."""

FENCE_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.RETURN,
        2: FailsafeAction.LAND,
        3: FailsafeAction.RETURN,
        4: FailsafeAction.HOVER,
        5: FailsafeAction.LAND,
    },
    Autopilot.PX4: {
        0: FailsafeAction.GO_ON,
        1: FailsafeAction.GO_ON,
        2: FailsafeAction.HOVER,
        3: FailsafeAction.RETURN,
        4: FailsafeAction.FALL,
        5: FailsafeAction.LAND,
    },
}
"""FENCE_ACTION and GF_ACTION."""

SAME_HEIGHT_M = 0.05

HOME_ONLY = (2, 4)
"""Values of RTL_TYPE with which PX4 passes rally points over."""

RALLY_FIRST = (1, 5)
"""Values of RTL_TYPE with which PX4 passes home over where there are rally points."""


@dataclass(frozen=True, slots=True)
class Return:
    """How the vehicle returns, by its parameters.

    Parameters
    ----------
    height_m
        Above take-off, to which it climbs first.
    height_name
        Of the parameter that says so.
    destinations_enu_m
        Home first, where home counts.
    """

    height_m: float
    height_name: str
    destinations_enu_m: tuple[Vec3, ...]
    cone_slope: float = 0.0


def failsafe_checks(
    autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders
) -> tuple[PreflightCheck, ...]:
    """What the vehicle does by itself without link, remote control, charge or position, when it returns, at the fence.

    Takes some 0.1 s.

    Parameters
    ----------
    values
        Of the parameters in `NAMES`, as far as the vehicle knows them.
    """
    return (
        *_link(autopilot, values),
        *_remote_control(autopilot, values),
        *_battery(autopilot, values, orders),
        *_position(autopilot, values),
        *_return(autopilot, values, orders),
        *_fence(autopilot, values, orders),
        *fence_limit_checks(autopilot, values, orders),
    )


def _stated(code: str, action: FailsafeAction | None, when: str, set_so: str) -> PreflightCheck:
    """One line: what happens then, as the parameters have it."""
    match action:
        case FailsafeAction.GO_ON:
            verdict, text = Verdict.OK, say("{}: continue mission ({})", when, set_so)
        case FailsafeAction.RETURN:
            verdict, text = Verdict.OK, say("{}, and it breaks the mission off and returns ({})", when, set_so)
        case FailsafeAction.LAND:
            verdict, text = Verdict.WARN, say("{}, and it lands, whatever is below it ({})", when, set_so)
        case FailsafeAction.HOVER:
            verdict, text = Verdict.WARN, say("{}, and it hovers until its battery is low ({})", when, set_so)
        case FailsafeAction.DRIFT:
            text = say(
                "{}, and it only keeps its height and drifts with the wind: take over at once ({})", when, set_so
            )
            verdict = Verdict.WARN
        case FailsafeAction.FALL:
            verdict, text = (
                Verdict.BAD,
                say("{}, and it stops its motors and falls ({}): set it otherwise", when, set_so),
            )
        case None:
            verdict, text = Verdict.WARN, say("{}, and what the vehicle does is not known ({})", when, set_so)
    return PreflightCheck(code, verdict, text)


def _link(autopilot: Autopilot, values: Mapping[str, float]) -> Iterator[PreflightCheck]:
    is_ardupilot = autopilot is Autopilot.ARDUPILOT
    name, wait = ("FS_GCS_ENABLE", "FS_GCS_TIMEOUT") if is_ardupilot else ("NAV_DLL_ACT", "COM_DL_LOSS_T")
    number = values.get(name)
    if number is None:
        text = say("what the vehicle does when the link is lost is not known: it has no {}", name)
        yield PreflightCheck("link-loss", Verdict.WARN, text)
        return
    options, bit = ("FS_OPTIONS", CONTINUE_MISSION) if is_ardupilot else ("COM_DLL_EXCEPT", EXCEPT_MISSION)
    action = LINK_ACTIONS[autopilot].get(int(number))
    if action is FailsafeAction.GO_ON or int(values.get(options, 0.0)) & bit:
        yield PreflightCheck("link-loss", Verdict.OK, say("continue mission, and land at home"))
    else:
        yield _stated("link-loss", action, say("{:g} s without the link", values.get(wait, 0.0)), f"{name} {number:g}")


def _remote_control(autopilot: Autopilot, values: Mapping[str, float]) -> Iterator[PreflightCheck]:
    is_ardupilot = autopilot is Autopilot.ARDUPILOT
    name, wait = ("FS_THR_ENABLE", "RC_FS_TIMEOUT") if is_ardupilot else ("NAV_RCL_ACT", "COM_RC_LOSS_T")
    number = values.get(name)
    if number is None:
        text = say("what the vehicle does without its remote control is not known: it has no {}", name)
        yield PreflightCheck("rc-loss", Verdict.WARN, text)
        return
    if not is_ardupilot and values.get("COM_RC_IN_MODE") == NO_STICKS:
        text = say("it takes no remote control (COM_RC_IN_MODE {}): only this ground station can take over", NO_STICKS)
        yield PreflightCheck("rc-loss", Verdict.WARN, text)
        return
    options = "FS_OPTIONS" if is_ardupilot else "COM_RCL_EXCEPT"
    goes_on = bool(int(values.get(options, 0.0)) & EXCEPT_MISSION)
    action = FailsafeAction.GO_ON if goes_on else REMOTE_CONTROL_ACTIONS[autopilot].get(int(number))
    set_so = f"{options} {values[options]:g}" if goes_on else f"{name} {number:g}"
    yield _stated("rc-loss", action, say("{:g} s without the remote control", values.get(wait, 1.0)), set_so)


def _battery(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Iterator[PreflightCheck]:
    """What it does when its battery is low; where that comes before the sortie is over, that it does."""
    stages = tuple(_battery_stages(autopilot, values))
    if not stages:
        text = say("nothing is done by itself when the battery is low: watch it, and land in time")
        yield PreflightCheck("battery-low", Verdict.WARN, text)
        return
    reserve = orders.surroundings[autopilot].rules.battery_reserve
    left = 1.0 - (orders.battery_needed_by(autopilot) - reserve)
    for stage in stages:
        if stage.level is not None and stage.level > left and stage.action is not FailsafeAction.GO_ON:
            text = say(
                "the vehicle breaks the mission off at a charge of {:.0%}, and the sortie ends with {:.0%}: set "
                "{} so that it lasts",
                stage.level,
                left,
                stage.name,
            )
            yield PreflightCheck("battery-low", Verdict.WARN, text, stage.level, left)
        else:
            when = say("battery below {}", stage.below)
            # To land where it is, with the last charge, is what is left.
            check = _stated("battery-low", stage.action, when, stage.set_so)
            yield replace(check, verdict=Verdict.OK) if stage.action is FailsafeAction.LAND and stage.is_last else check


@dataclass(frozen=True, slots=True)
class _Stage:
    """A level of charge at which the vehicle does something; `level` is its part of a full battery, where it is one."""

    action: FailsafeAction | None
    below: str
    name: str
    set_so: str
    level: float | None
    is_last: bool


def _battery_stages(autopilot: Autopilot, values: Mapping[str, float]) -> Iterator[_Stage]:
    if autopilot is Autopilot.PX4:
        number = values.get("COM_LOW_BAT_ACT", 0.0)
        for threshold, staged, is_last in BATTERY_STAGES_PX4.get(int(number), ()):
            level = values.get(threshold)
            if level is not None:
                yield _Stage(staged, f"{level:.0%}", threshold, say("COM_LOW_BAT_ACT {:g}", number), level, is_last)
        return
    capacity_mah = values.get("BATT_CAPACITY", 0.0)
    for kind in ("LOW", "CRT"):
        name = f"BATT_FS_{kind}_ACT"
        number, voltage_v = values.get(name, 0.0), values.get(f"BATT_{kind}_VOLT", 0.0)
        charge_mah = values.get(f"BATT_{kind}_MAH", 0.0)
        below = [f"{voltage_v:g} V"] if voltage_v > 0.0 else []
        level = charge_mah / capacity_mah if charge_mah > 0.0 and capacity_mah > 0.0 else None
        below += [say("{:g} mAh", charge_mah)] if charge_mah > 0.0 else []
        action = BATTERY_ACTIONS_ARDUPILOT.get(int(number))
        if below and action is not FailsafeAction.GO_ON:
            name = f"BATT_{kind}_MAH"
            yield _Stage(
                action, " / ".join(below), name, say("BATT_FS_{}_ACT {:g}", kind, number), level, kind == "CRT"
            )


def _position(autopilot: Autopilot, values: Mapping[str, float]) -> Iterator[PreflightCheck]:
    """What it does when it does not know any more where it is, which glass can bring about by mirroring satellites."""
    name = "FS_EKF_ACTION" if autopilot is Autopilot.ARDUPILOT else "COM_POSCTL_NAVL"
    number = values.get(name)
    if number is None:
        text = say("what the vehicle does when it loses its position is not known: it has no {}", name)
        yield PreflightCheck("position-loss", Verdict.WARN, text)
        return
    is_off = autopilot is Autopilot.ARDUPILOT and values.get("FS_EKF_THRESH", 1.0) <= 0.0
    action = FailsafeAction.DRIFT if is_off else POSITION_ACTIONS[autopilot].get(int(number))
    set_so = say("FS_EKF_THRESH {:g}", values["FS_EKF_THRESH"]) if is_off else f"{name} {number:g}"
    check = _stated("position-loss", action, say("position lost"), set_so)
    yield replace(check, verdict=Verdict.OK) if action is FailsafeAction.LAND else check


def return_of(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Return | None:
    """How the vehicle returns; None where it does not say how high."""
    home, rally = orders.home_enu_m, tuple(point.position_enu_m for point in orders.site.rally_points)
    if autopilot is Autopilot.ARDUPILOT:
        if "RTL_ALT" not in values:
            return None
        has_home = not rally or bool(values.get("RALLY_INCL_HOME", 1.0))
        places = (home, *rally) if has_home else rally
        limits = fence_limits(autopilot, values)
        height_m, name = values["RTL_ALT"] / 100.0, "RTL_ALT"
        if height_m > limits.height_m - limits.margin_m:
            height_m, name = limits.height_m - limits.margin_m, "FENCE_ALT_MAX"
        return Return(height_m, name, places, values.get("RTL_CONE_SLOPE", 0.0))
    if "RTL_RETURN_ALT" not in values:
        return None
    angle_deg = values.get("RTL_CONE_ANG", 0.0)
    slope = 1.0 / math.tan(math.radians(angle_deg)) if 0.0 < angle_deg < 90.0 else 0.0
    is_flat = angle_deg >= 90.0 and "RTL_DESCEND_ALT" in values
    name = "RTL_DESCEND_ALT" if is_flat else "RTL_RETURN_ALT"
    kind = int(values.get("RTL_TYPE", 0.0))
    places = (home,) if kind in HOME_ONLY or not rally else rally if kind in RALLY_FIRST else (home, *rally)
    return Return(values[name], name, places, slope)


def _return(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Iterator[PreflightCheck]:
    found, around = return_of(autopilot, values, orders), orders.surroundings[autopilot]
    if found is None:
        text = say("how high the vehicle returns is not known; look before it is told to return")
        yield PreflightCheck("return", Verdict.WARN, text)
        return
    if len(around.path_enu_m) == 0:
        return
    limit_m = around.space.min_distance_m
    way = return_route(
        around.space,
        around.path_enu_m,
        found.destinations_enu_m,
        orders.home_enu_m[2] + found.height_m,
        found.cone_slope,
        upper_m=2.0 * limit_m + 10.0,
    )
    n_rally = len(orders.site.rally_points)
    where = say("{:g} m above take-off, to the nearest of home and the rally points ({})", found.height_m, n_rally)
    if not n_rally or found.destinations_enu_m == (orders.home_enu_m,):
        where = say("{:g} m above take-off, to home", found.height_m)
    advice = say("set {} so that it returns {:g} m above take-off", found.height_name, orders.return_height_m)
    if abs(found.height_m - orders.return_height_m) < SAME_HEIGHT_M:
        advice = say("it climbs there on its way, and no other height mends that; be ready to fly it back by hand")
    ceiling_m = float(around.space.high_enu_m[2]) - orders.home_enu_m[2]
    if found.height_m > ceiling_m + DISTANCE_TOLERANCE_M:
        text = say(
            "it returns above the airspace, which ends {:.1f} m above take-off ({}): {}", ceiling_m, where, advice
        )
        yield PreflightCheck("return", Verdict.BAD, text, found.height_m, ceiling_m, "m")
        return
    if way.gap_m <= 0.0:
        text = say("it returns straight through the building or an obstacle ({}): {}", where, advice)
    elif way.gap_m < limit_m - DISTANCE_TOLERANCE_M and way.gap_m >= _gap_of_best_m(orders, around, found):
        # No height is better: it is the climb that comes near, straight up beside something that juts out.
        text = say("it climbs within {:.1f} m of the building or an obstacle before it returns ({})", way.gap_m, where)
        yield PreflightCheck("return", Verdict.WARN, text, way.gap_m, limit_m, "m")
        return
    elif way.gap_m < limit_m - DISTANCE_TOLERANCE_M:
        text = say("it returns {:.1f} m from the building or an obstacle ({}): {}", way.gap_m, where, advice)
    elif way.crosses_no_fly:
        text = say("it returns across a no-fly zone ({}); fly it back by hand", where)
        yield PreflightCheck("return", Verdict.WARN, text, way.gap_m, limit_m, "m")
        return
    else:
        yield PreflightCheck("return", Verdict.OK, say("it returns {}", where), way.gap_m, limit_m, "m")
        return
    yield PreflightCheck("return", Verdict.BAD, text, way.gap_m, limit_m, "m")


def _gap_of_best_m(orders: SortieOrders, around: Surroundings, found: Return) -> float:
    """Smallest distance of the ways of return at the height that the plan advises."""
    best_z_m = orders.home_enu_m[2] + orders.return_height_m
    upper_m = 2.0 * around.space.min_distance_m + 10.0
    way = return_route(around.space, around.path_enu_m, found.destinations_enu_m, best_z_m, found.cone_slope, upper_m)
    return way.gap_m


def _fence(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Iterator[PreflightCheck]:
    if not orders.fences.get(autopilot):
        return
    name = "FENCE_ACTION" if autopilot is Autopilot.ARDUPILOT else "GF_ACTION"
    number = values.get(name)
    action = None if number is None else FENCE_ACTIONS[autopilot].get(int(number))
    switched_off = _fence_off(autopilot, values)
    set_so = switched_off or f"{name} {number or 0.0:g}"
    if switched_off or action is FailsafeAction.GO_ON:
        verdict = Verdict.WARN
        text = say("the geofence is on board, but nothing keeps the aircraft from leaving it ({})", set_so)
    elif action is FailsafeAction.RETURN:
        verdict, text = Verdict.OK, say("at the geofence it returns ({})", set_so)
    elif action is FailsafeAction.LAND:
        verdict, text = Verdict.OK, say("at the geofence it lands ({})", set_so)
    elif action is FailsafeAction.HOVER:
        verdict, text = Verdict.OK, say("at the geofence it hovers ({})", set_so)
    elif action is FailsafeAction.FALL:
        verdict, text = Verdict.BAD, say("at the geofence it stops its motors and falls ({}): set it otherwise", set_so)
    else:
        verdict, text = Verdict.WARN, say("what the vehicle does at the geofence is not known: see {}", name)
    yield PreflightCheck("fence-action", verdict, text)


def _fence_off(autopilot: Autopilot, values: Mapping[str, float]) -> str:
    """The parameter that switches the areas of a fence off, with its value; empty where they count."""
    if autopilot is Autopilot.PX4:
        return "" if values.get("GF_ACTION", 1.0) else "GF_ACTION 0"
    if not values.get("FENCE_ENABLE", 0.0) and not values.get("FENCE_AUTOENABLE", 0.0):
        return "FENCE_ENABLE 0"
    kinds = int(values.get("FENCE_TYPE", POLYGON_FENCE))
    return "" if kinds & POLYGON_FENCE else f"FENCE_TYPE {kinds}"


# A fence that was on board before, and that this ground station did not put there

FOUND_FENCE_NAMES = {
    Autopilot.ARDUPILOT: ("FENCE_ENABLE", "FENCE_AUTOENABLE", "FENCE_TYPE", "FENCE_OPTIONS"),
    Autopilot.PX4: ("GF_ACTION",),
}
"""Parameters that decide what comes of it."""

UNION_OF_INCLUSIONS = 2
"""Bit of FENCE_OPTIONS: without it ArduPilot must be inside of every area to stay in."""


def fence_words(items: Sequence[MissionItemInt]) -> str:
    """What a fence that was read from a vehicle consists of."""
    try:
        fences = fences_of(items)
    except MissionError as error:
        return say("{} items that are no geofence: {}", len(items), error)
    n_in = sum(fence.is_inclusion for fence in fences)
    return say("areas to stay in: {}, to keep out of: {}", n_in, len(fences) - n_in)


def found_fence_check(
    autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders, items: Sequence[MissionItemInt]
) -> PreflightCheck:
    """What a fence of somebody else means for this sortie; it stays on board until the pilot says otherwise.

    It grounds a sortie that has a fence of its own, as there is room for one, and one that it does not let fly.

    Parameters
    ----------
    values
        Of the parameters in `FOUND_FENCE_NAMES`, as far as the vehicle knows them.
    """
    found = say("the vehicle has a geofence that this ground station did not put there ({})", fence_words(items))
    advice = say("overrule this line to remove it, or change it with the program that set it")
    if orders.fences.get(autopilot):
        text = say("{}, and this sortie has its own, which would replace it; {}", found, advice)
        return PreflightCheck(FOREIGN_FENCE, Verdict.BAD, text)
    try:
        fences = fences_of(items)
    except MissionError:
        text = say("{}; whether the sortie stays inside cannot be told; {}", found, advice)
        return PreflightCheck(FOREIGN_FENCE, Verdict.BAD, text)
    in_all = autopilot is Autopilot.ARDUPILOT and not int(values.get("FENCE_OPTIONS", 0.0)) & UNION_OF_INCLUSIONS
    fit = fence_fit(fences, orders.mission, in_all=in_all)
    room_m, limit_m = fit.room_m, FENCE_CLEARANCE_M
    if room_m >= 0.0:
        text = say("{}; it stays on board, and the sortie stays {:.0f} m inside", found, room_m)
        if room_m < limit_m:
            text = say("{}; it stays on board, and the sortie comes within {:.1f} m of its edge", found, room_m)
        return PreflightCheck(FOREIGN_FENCE, Verdict.WARN, text, room_m, limit_m, "m")
    beyond = _beyond(fit)
    if switched_off := _fence_off(autopilot, values):
        text = say("{}; {}, but it is switched off ({}): it stays on board", found, beyond, switched_off)
        return PreflightCheck(FOREIGN_FENCE, Verdict.WARN, text, room_m, limit_m, "m")
    text = say("{}; {}: the vehicle would refuse the mission or break it off; {}", found, beyond, advice)
    return PreflightCheck(FOREIGN_FENCE, Verdict.BAD, text, room_m, limit_m, "m")


def _beyond(fit: FenceFit) -> str:
    """Where a sortie leaves a fence."""
    if not math.isfinite(fit.room_m):
        return say("no place is allowed by it")
    off_m = -fit.room_m
    if fit.waypoint is None:
        return say("a leg of the sortie leaves it, by {:.0f} m", off_m)
    if fit.waypoint == 0:
        return say("the take-off lies outside of it, and the sortie leaves it by {:.0f} m", off_m)
    return say("waypoint {} lies outside of it, and the sortie leaves it by {:.0f} m", fit.waypoint, off_m)
