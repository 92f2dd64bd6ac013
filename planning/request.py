"""What is asked of planning. Light enough for windows and projects, which hold requests long before any is planned."""

from __future__ import annotations

from dataclasses import dataclass

from planning.base.messages import say
from planning.parameters import PlanParameters
from planning.plan import Viewpoint


@dataclass(frozen=True, slots=True)
class PlanRequest(PlanParameters):
    """Parameters of a plan, and what of an earlier one it keeps.

    Parameters
    ----------
    locked
        Viewpoints that the plan must contain as they are, with their identifiers. They count as views.
    """

    locked: tuple[Viewpoint, ...] = ()

    def __post_init__(self) -> None:
        PlanParameters.__post_init__(self)
        if self.n_views is not None and self.n_views < len(self.locked):
            raise ValueError(
                say("expected at least the {} locked ones, got {}", len(self.locked), self.n_views, place="views")
            )
        if len({viewpoint.id for viewpoint in self.locked}) < len(self.locked):
            raise ValueError(say("expected unique ids", place="locked"))
