"""Viewpoints that a new plan must contain as they are: whether it can, and what they cover already."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.coverage.model import CoverageModel
from planning.plan import Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.site.free_space import LEG_MARGIN_M, FreeSpace
from planning.viewpoints.problem import ViewProblem

NONE_LOCKED = viewpoint_arrays(())


def locked_views(problem: ViewProblem, locked: Sequence[Viewpoint]) -> ViewpointArrays:
    """Locked viewpoints as arrays, in order.

    Raises
    ------
    InputError
        One of them cannot be flown; the message names it and says why.
    """
    views = viewpoint_arrays(tuple(locked))
    low, high = problem.model.camera.gimbal_pitch_deg
    flyable = problem.flyable(views.positions_enu_m, LEG_MARGIN_M)
    for viewpoint, can_be_flown in zip(locked, flyable, strict=True):
        reason = "" if can_be_flown else _why_not(problem.space, np.array(viewpoint.position_enu_m))
        if not low <= viewpoint.gimbal_pitch_deg <= high:
            reason = say(
                "it looks {:g} deg up, and the gimbal turns from {:g} to {:g} deg",
                viewpoint.gimbal_pitch_deg,
                low,
                high,
            )
        if reason:
            raise InputError(
                say(
                    "viewpoint '{}' is locked, but cannot be flown: {}; unlock it, or move it first",
                    viewpoint.id,
                    reason,
                )
            )
    return views


def _why_not(space: FreeSpace, position_enu_m: NDArray[np.float64]) -> str:
    """Why a position cannot be flown."""
    outside_m = float(np.maximum(space.low_enu_m - position_enu_m, position_enu_m - space.high_enu_m).max())
    if outside_m > -LEG_MARGIN_M:
        if outside_m == float(space.low_enu_m[2] - position_enu_m[2]):
            return say("it lies {:.3f} m below the lowest flight allowed or on its border", max(outside_m, 0.0))
        return say("it lies {:.3f} m outside the airspace or on its border", max(outside_m, 0.0))
    distance_m = float(space.solids.clearance_m(position_enu_m[None])[0])
    if distance_m < space.min_distance_m + LEG_MARGIN_M:
        where = say("inside a solid") if distance_m < 0.0 else say("from the building or an obstacle")
        return say(
            "it is {:.3f} m {}, and {:.3f} m are required", abs(distance_m), where, space.min_distance_m + LEG_MARGIN_M
        )
    if not space.is_allowed(position_enu_m[None], LEG_MARGIN_M)[0]:
        return say("it is in a no-fly volume or less than {:.3f} m from one", space.no_fly_distance_m + LEG_MARGIN_M)
    return say("no way from home to it was found")


def covered_by(model: CoverageModel, views: ViewpointArrays) -> NDArray[np.int32]:
    """How many of some views cover each element, shape (n_elements,)."""
    return np.bincount(model.elements(views).items, minlength=model.n_elements).astype(np.int32)
