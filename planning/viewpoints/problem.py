"""What optimisers work on, what they are asked for and what they return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError, InputError
from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.model import CoverageModel
from planning.coverage.reachability import Reachability
from planning.plan import Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.routing.legs import LegTable
from planning.routing.roadmap import Roadmap
from planning.site.free_space import LEG_MARGIN_M, SAFETY_MARGIN_M, FreeSpace


@dataclass(frozen=True, slots=True, eq=False)
class ViewProblem:
    """A site ready for optimisation: what counts, where viewpoints may be, what can be reached and flown to."""

    model: CoverageModel
    space: FreeSpace
    reachability: Reachability
    roadmap: Roadmap

    def flyable(self, positions_enu_m: NDArray[np.float64], margin_m: float = SAFETY_MARGIN_M) -> NDArray[np.bool_]:
        """Positions, shape (n, 3), that are allowed and can be flown to from home."""
        allowed = self.space.is_allowed(positions_enu_m, margin_m)
        to_check = np.flatnonzero(allowed)
        allowed[to_check] = self.roadmap.connected_to_home(positions_enu_m[to_check])
        return allowed


@dataclass(frozen=True, slots=True)
class Goal:
    """How many views, or how much coverage with as few as possible. Exactly one is set.

    `share` is relative to the sections known to be reachable.
    """

    n_views: int | None = None
    share: float | None = None

    def __post_init__(self) -> None:
        if (self.n_views is None) == (self.share is None):
            raise ValueError("expected either n_views or share")
        if self.n_views is not None and self.n_views < 1:
            raise ValueError(f"n_views: expected 1 or more, got {self.n_views}")
        if self.share is not None and not 0.0 < self.share <= 1.0:
            raise ValueError(f"share: expected more than 0 and at most 1, got {self.share}")


@dataclass(frozen=True, slots=True, eq=False)
class ViewSet:
    """Chosen views, in no order that matters.

    `bound` is an upper bound on what as many views of the same candidates could cover, and `least_error` a lower one on
    the expected error that they could leave; None where a method has none. `is_cut_short` says that fewer candidates
    were compared than there are, since an end was asked for, and `are_all_taken` that all compared are in the set while
    there are more. `legs` has the views among its stops, where they were chosen by their routes.
    """

    views: ViewpointArrays
    bound: float | None = None
    least_error: float | None = None
    is_cut_short: bool = False
    are_all_taken: bool = False
    legs: LegTable | None = None


class Optimiser(Protocol):
    """One method of choosing views."""

    def __call__(
        self, problem: ViewProblem, goal: Goal, *, seed: int, stop: Stop, trace: Trace, monitor: Monitor
    ) -> ViewSet:
        """Choose views; when `stop` asks for an end, return the best so far.

        Raises
        ------
        InfeasibleError
            There is no allowed viewpoint that sees anything.
        """


def concatenate(parts: list[ViewpointArrays]) -> ViewpointArrays:
    """All views of several arrays, in order."""
    return ViewpointArrays(
        np.concatenate([part.positions_enu_m for part in parts]).reshape(-1, 3),
        np.concatenate([part.heading_rad for part in parts]),
        np.concatenate([part.pitch_rad for part in parts]),
    )


def take(views: ViewpointArrays, index: NDArray[np.int64] | NDArray[np.bool_]) -> ViewpointArrays:
    """Some of the views."""
    return ViewpointArrays(views.positions_enu_m[index], views.heading_rad[index], views.pitch_rad[index])


def nothing_to_see() -> InfeasibleError:
    """The error for a site on which no allowed viewpoint sees a panel."""
    return InfeasibleError.say(
        "no allowed viewpoint sees any panel: the airspace may be empty or too close to the building, "
        "the panels' corners clockwise (normals pointing inwards), or the minimum distance too large"
    )


# Viewpoints that a new plan must contain as they are: whether it can, and what they cover already.

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
            raise InputError.say(
                "viewpoint '{}' is locked, but cannot be flown: {}; unlock it, or move it first", viewpoint.id, reason
            )
    return views


def _why_not(space: FreeSpace, position_enu_m: NDArray[np.float64]) -> str:
    """Why a position cannot be flown."""
    outside_m = float(np.maximum(space.low_enu_m - position_enu_m, position_enu_m - space.high_enu_m).max())
    if outside_m > -LEG_MARGIN_M:
        if outside_m == float(space.low_enu_m[2] - position_enu_m[2]):
            return say("it lies {:.3f} m below the lowest flight allowed or on its border", max(outside_m, 0.0))
        return say("it lies {:.3f} m outside the airspace or on its border", max(outside_m, 0.0))
    if space.ground.terrain is not None and space.min_height_m is not None:
        height_m = float(space.ground.least_m(position_enu_m[None], position_enu_m[None])[0])
        if not np.isfinite(height_m):
            return say("the terrain has no heights below it")
        if height_m < space.min_height_m + LEG_MARGIN_M:
            return say("it is {:.3f} m above the terrain, and {:.3f} m are required", height_m, space.min_height_m)
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
