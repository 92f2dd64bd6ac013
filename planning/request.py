"""What is asked of planning. Light enough for windows and projects, which hold requests long before any is planned."""

from __future__ import annotations

from dataclasses import dataclass

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
            raise ValueError(f"views: expected at least the {len(self.locked)} locked ones, got {self.n_views}")
        if len({viewpoint.id for viewpoint in self.locked}) < len(self.locked):
            raise ValueError("locked: expected unique ids")
