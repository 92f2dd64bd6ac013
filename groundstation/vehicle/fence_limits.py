"""The vehicle's own limits, a height and a circle around home, against the sortie's path before take-off.

A mission that goes beyond them takes off all the same and is broken off there. ArduPilot: FENCE_ALT_MAX and
FENCE_RADIUS, where FENCE_TYPE has their bits. PX4: GF_MAX_VER_DIST and GF_MAX_HOR_DIST, 0 for none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.preflight import PreflightCheck, Verdict
from missions.mavlink.autopilots import Autopilot
from planning.base.messages import say

NAMES = {
    Autopilot.ARDUPILOT: (
        *("FENCE_ENABLE", "FENCE_ACTION", "FENCE_TYPE"),
        *("FENCE_ALT_MAX", "FENCE_RADIUS", "FENCE_MARGIN"),
    ),
    Autopilot.PX4: ("GF_ACTION", "GF_MAX_VER_DIST", "GF_MAX_HOR_DIST"),
}
"""Parameters that decide it, by autopilot."""

HEIGHT_FENCE, CIRCLE_FENCE = 1, 2
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
