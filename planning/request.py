"""What is asked of planning. Light to import: windows and projects hold requests long before anything is planned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from planning.aircraft.catalogue import DEFAULT_PROFILE
from planning.plan import Constraints, FlightRules, Viewpoint

Precision = Literal["f32", "f64"]
"""Of the coverage kernel; single precision is faster and differs on section borders only (docs/benchmarks.md)."""

N_CANDIDATES = 20_000
"""Spread candidates. With 56 to 560 views on the office 2000 do as well (fresh ones come with the improvement); with
200 views on the tower 2000 cover 0.7 % less after 60 s."""

DEFAULT_VIEWS = 560
"""For methods that need a number of views when none is given: the paper's for its planar case."""

LARGEST_SEED = 2**63 - 1
"""What 64-bit integers of files and other programs hold."""

DEFAULT_SHARE = 0.99
"""Share of the reachable sections that is covered when no number of views is given."""


@dataclass(frozen=True, slots=True)
class GreedyParameters:
    """Settings of the greedy method.

    Parameters
    ----------
    n_candidates
        Well-spread candidates; witnesses of rarely seen sections come on top.
    solid_angle_weights
        Weight sections by their solid angle instead of equally.
    improve
        Exchange candidates and refine poses after the greedy choice.
    certify
        Compute the dual bound for the number of views (about a second).
    """

    n_candidates: int = N_CANDIDATES
    solid_angle_weights: bool = False
    improve: bool = True
    certify: bool = True

    def __post_init__(self) -> None:
        if self.n_candidates < 1:
            raise ValueError(f"n_candidates: expected 1 or more, got {self.n_candidates}")


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What is wanted. At most one of `n_views`, `share` and `n_batteries` is set.

    Parameters
    ----------
    share
        Of what can be covered, 0 to 1, with as few views as possible.
    n_batteries
        Best coverage within so many sorties.
    profile_id
        Aircraft and camera: see `planning.aircraft.catalogue.profile`.
    time_budget_s
        Wall time for the whole plan; the search ends earlier when it finds nothing more.
    locked
        Viewpoints that the plan must contain as they are, with their identifiers. They count as views.
    """

    method: str = "greedy"
    n_views: int | None = None
    share: float | None = None
    n_batteries: int | None = None
    profile_id: str = DEFAULT_PROFILE
    constraints: Constraints = Constraints()
    rules: FlightRules = FlightRules()
    greedy: GreedyParameters = GreedyParameters()
    precision: Precision = "f32"
    seed: int = 0
    time_budget_s: float = 60.0
    locked: tuple[Viewpoint, ...] = ()

    def __post_init__(self) -> None:
        if sum(value is not None for value in (self.n_views, self.share, self.n_batteries)) > 1:
            raise ValueError("expected at most one of a number of views, a share and a number of batteries")
        if self.n_views is not None and not 1 <= self.n_views <= 20_000:
            raise ValueError(f"views: expected 1 to 20000, got {self.n_views}")
        if self.n_views is not None and self.n_views < len(self.locked):
            raise ValueError(f"views: expected at least the {len(self.locked)} locked ones, got {self.n_views}")
        if len({viewpoint.id for viewpoint in self.locked}) < len(self.locked):
            raise ValueError("locked: expected unique ids")
        if self.share is not None and not 0.0 < self.share <= 1.0:
            raise ValueError(f"coverage: expected more than 0 and at most 1, got {self.share}")
        if self.n_batteries is not None and not 1 <= self.n_batteries <= 100:
            raise ValueError(f"batteries: expected 1 to 100, got {self.n_batteries}")
        if not 0 <= self.seed <= LARGEST_SEED:
            raise ValueError(f"seed: expected 0 to {LARGEST_SEED}, got {self.seed}")
        if not self.time_budget_s > 0.0:
            raise ValueError(f"time budget: expected more than 0 s, got {self.time_budget_s}")
