"""What the vehicle will do by itself, by its parameters, against what this sortie can bear.

ArduPilot: parameter documentation of Copter 4.5, `failsafe_gcs_check`, `AP_Rally`, and `compute_return_target` of RTL,
which never returns above the fence's height. PX4: parameter reference 1.16.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, auto

from groundstation.vehicle import fence_limits
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.preflight import PreflightCheck, Verdict
from groundstation.vehicle.watch import DISTANCE_TOLERANCE_M
from missions.mavlink.autopilots import Autopilot
from planning.frames import Vec3
from planning.rally import return_way

NAMES = {
    Autopilot.ARDUPILOT: (
        *("FS_GCS_ENABLE", "FS_GCS_TIMEOUT", "FS_OPTIONS", "RTL_ALT", "RTL_CONE_SLOPE"),
        *("RALLY_INCL_HOME", *fence_limits.NAMES[Autopilot.ARDUPILOT]),
    ),
    Autopilot.PX4: (
        *("NAV_DLL_ACT", "COM_DL_LOSS_T", "COM_DLL_EXCEPT"),
        *("RTL_RETURN_ALT", "RTL_TYPE", "RTL_CONE_ANG", "RTL_DESCEND_ALT"),
        *fence_limits.NAMES[Autopilot.PX4],
    ),
}
"""Parameters that decide it, by autopilot."""


class Deed(Enum):
    """What a vehicle does by itself."""

    GO_ON = auto()
    RETURN = auto()
    LAND = auto()
    HOVER = auto()
    FALL = auto()


LINK_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: Deed.GO_ON,
        1: Deed.RETURN,
        2: Deed.RETURN,
        3: Deed.RETURN,
        4: Deed.LAND,
        5: Deed.LAND,
        6: Deed.RETURN,
        7: Deed.HOVER,
    },
    Autopilot.PX4: {0: Deed.GO_ON, 1: Deed.HOVER, 2: Deed.RETURN, 3: Deed.LAND, 5: Deed.FALL, 6: Deed.FALL},
}
"""FS_GCS_ENABLE and NAV_DLL_ACT; SmartRTL (3, 4) flies back along its own way, or does what stands here."""

CONTINUE_MISSION, EXCEPT_MISSION = 2, 1
"""Bits of FS_OPTIONS and of COM_DLL_EXCEPT: a mission goes on without the ground station."""

FENCE_ACTIONS = {
    Autopilot.ARDUPILOT: {
        0: Deed.GO_ON,
        1: Deed.RETURN,
        2: Deed.LAND,
        3: Deed.RETURN,
        4: Deed.HOVER,
        5: Deed.LAND,
    },
    Autopilot.PX4: {0: Deed.GO_ON, 1: Deed.GO_ON, 2: Deed.HOVER, 3: Deed.RETURN, 4: Deed.FALL, 5: Deed.LAND},
}
"""FENCE_ACTION and GF_ACTION."""

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
    """What the vehicle does by itself when the link is lost, when it returns, and at the fence; takes some 0.1 s.

    Parameters
    ----------
    values
        Of the parameters in `NAMES`, as far as the vehicle knows them.
    """
    return (
        *_link(autopilot, values),
        *_return(autopilot, values, orders),
        *_fence(autopilot, values, orders),
        *fence_limits.fence_limit_checks(autopilot, values, orders),
    )


def _link(autopilot: Autopilot, values: Mapping[str, float]) -> Iterator[PreflightCheck]:
    is_ardupilot = autopilot is Autopilot.ARDUPILOT
    name, wait = ("FS_GCS_ENABLE", "FS_GCS_TIMEOUT") if is_ardupilot else ("NAV_DLL_ACT", "COM_DL_LOSS_T")
    number = values.get(name)
    if number is None:
        text = f"what the vehicle does when the link is lost is not known: it has no {name}"
        yield PreflightCheck("link-loss", Verdict.WARN, text)
        return
    wait_s, set_so = values.get(wait, 0.0), f"{name} {number:g}"
    options, bit = ("FS_OPTIONS", CONTINUE_MISSION) if is_ardupilot else ("COM_DLL_EXCEPT", EXCEPT_MISSION)
    deed = LINK_ACTIONS[autopilot].get(int(number))
    if deed is Deed.GO_ON or int(values.get(options, 0.0)) & bit:
        verdict, text = Verdict.OK, "without the link it flies the mission on, and lands at home"
    elif deed is Deed.RETURN:
        verdict = Verdict.OK
        text = f"{wait_s:g} s without the link, and it breaks the mission off and returns ({set_so})"
    elif deed is Deed.LAND:
        verdict, text = Verdict.WARN, f"{wait_s:g} s without the link, and it lands, whatever is below it ({set_so})"
    elif deed is Deed.HOVER:
        verdict = Verdict.WARN
        text = f"{wait_s:g} s without the link, and it hovers until its battery is low ({set_so})"
    elif deed is Deed.FALL:
        verdict = Verdict.BAD
        text = f"{wait_s:g} s without the link, and it stops its motors and falls ({set_so}): set it otherwise"
    else:
        verdict, text = Verdict.WARN, f"what the vehicle does when the link is lost is not known ({set_so})"
    yield PreflightCheck("link-loss", verdict, text)


def return_of(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Return | None:
    """How the vehicle returns; None where it does not say how high."""
    home, rally = orders.home_enu_m, tuple(point.position_enu_m for point in orders.site.rally_points)
    if autopilot is Autopilot.ARDUPILOT:
        if "RTL_ALT" not in values:
            return None
        has_home = not rally or bool(values.get("RALLY_INCL_HOME", 1.0))
        places = (home, *rally) if has_home else rally
        limits = fence_limits.fence_limits(autopilot, values)
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
        text = "how high the vehicle returns is not known; look before it is told to return"
        yield PreflightCheck("return", Verdict.WARN, text)
        return
    if len(around.path_enu_m) == 0:
        return
    limit_m = around.space.min_distance_m
    way = return_way(
        around.space,
        around.path_enu_m,
        found.destinations_enu_m,
        orders.home_enu_m[2] + found.height_m,
        found.cone_slope,
        upper_m=2.0 * limit_m + 10.0,
    )
    n_rally = len(orders.site.rally_points)
    where = f"{found.height_m:g} m above take-off, to the nearest of home and the rally points ({n_rally})"
    if not n_rally or found.destinations_enu_m == (orders.home_enu_m,):
        where = f"{found.height_m:g} m above take-off, to home"
    advice = f"set {found.height_name} so that it returns {orders.return_height_m:g} m above take-off"
    ceiling_m = float(around.space.high_enu_m[2]) - orders.home_enu_m[2]
    if found.height_m > ceiling_m + DISTANCE_TOLERANCE_M:
        text = f"it returns above the airspace, which ends {ceiling_m:.1f} m above take-off ({where}): {advice}"
        yield PreflightCheck("return", Verdict.BAD, text, found.height_m, ceiling_m, "m")
        return
    if way.gap_m <= 0.0:
        text = f"it returns straight through the building or an obstacle ({where}): {advice}"
    elif way.gap_m < limit_m - DISTANCE_TOLERANCE_M:
        text = f"it returns {way.gap_m:.1f} m from the building or an obstacle ({where}): {advice}"
    elif way.crosses_no_fly:
        text = f"it returns across a no-fly zone ({where}); fly it back by hand"
        yield PreflightCheck("return", Verdict.WARN, text, way.gap_m, limit_m, "m")
        return
    else:
        yield PreflightCheck("return", Verdict.OK, f"it returns {where}", way.gap_m, limit_m, "m")
        return
    yield PreflightCheck("return", Verdict.BAD, text, way.gap_m, limit_m, "m")


def _fence(autopilot: Autopilot, values: Mapping[str, float], orders: SortieOrders) -> Iterator[PreflightCheck]:
    if not orders.fences:
        return
    name = "FENCE_ACTION" if autopilot is Autopilot.ARDUPILOT else "GF_ACTION"
    number = values.get(name)
    deed = None if number is None else FENCE_ACTIONS[autopilot].get(int(number))
    is_off = autopilot is Autopilot.ARDUPILOT and not values.get("FENCE_ENABLE", 0.0)
    switch, value = ("FENCE_ENABLE", 0.0) if is_off else (name, number or 0.0)
    set_so = f"{switch} {value:g}"
    if is_off or deed is Deed.GO_ON:
        verdict = Verdict.WARN
        text = f"the geofence is on board, but nothing keeps the aircraft from leaving it ({set_so})"
    elif deed is Deed.RETURN:
        verdict, text = Verdict.OK, f"at the geofence it returns ({set_so})"
    elif deed is Deed.LAND:
        verdict, text = Verdict.OK, f"at the geofence it lands ({set_so})"
    elif deed is Deed.HOVER:
        verdict, text = Verdict.OK, f"at the geofence it hovers ({set_so})"
    elif deed is Deed.FALL:
        verdict, text = Verdict.BAD, f"at the geofence it stops its motors and falls ({set_so}): set it otherwise"
    else:
        verdict, text = Verdict.WARN, f"what the vehicle does at the geofence is not known: see {name}"
    yield PreflightCheck("fence-action", verdict, text)
