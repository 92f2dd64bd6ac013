"""Why sections that may be seen stay open: no viewpoint of a plan covers them, and none is proven not to see them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.viewpoints.candidates import places_around
from planning.viewpoints.problem import ViewProblem
from planning.viewpoints.spacing import Apart


class WhyOpen(StrEnum):
    """What keeps a section from being covered."""

    UNDECIDED = "undecided"
    """No place is known from which it is seen, and none is proven not to exist."""
    CUT_OFF = "cut-off"
    """Places are known, but no way from home to one of them was found."""
    SPACING = "spacing"
    """Only places closer to other viewpoints than the aircraft accepts were found."""
    SEARCH = "search"
    """Nothing: more viewpoints, or a longer search, would cover it."""


@dataclass(frozen=True, slots=True)
class OpenSection:
    """A section that stays open; `panel` is its number on the site."""

    panel: int
    section: int
    why: WhyOpen


def open_sections(
    problem: ViewProblem, covered: NDArray[np.bool_], positions_enu_m: NDArray[np.float64], spacing_m: float
) -> tuple[OpenSection, ...]:
    """All sections that may be seen and are not covered, and why.

    Parameters
    ----------
    covered
        Whether each section is, shape (m, n_sections).
    positions_enu_m
        Of the plan's viewpoints, shape (n, 3).
    spacing_m
        How far apart the aircraft wants waypoints; 0: no matter.
    """
    reachability = problem.reachability
    elements = np.flatnonzero((reachability.verdicts != UNREACHABLE) & ~covered)
    is_known = reachability.verdicts.reshape(-1)[elements] == REACHABLE
    known = elements[is_known]
    places, number = places_around(
        problem, known, reachability.witnesses_enu_m.reshape(-1, 3)[known], np.random.default_rng(0)
    )
    kept = problem.flyable(places)
    places, number = places[kept], number[kept]
    is_apart = ~Apart(places, positions_enu_m, spacing_m).are_too_close(places)
    flyable, apart = set(number.tolist()), set(number[is_apart].tolist())
    of_known = iter(
        WhyOpen.SEARCH if k in apart else WhyOpen.SPACING if k in flyable else WhyOpen.CUT_OFF
        for k in range(len(known))
    )
    panel, section = np.divmod(elements, problem.model.grid.n_sections)
    return tuple(
        OpenSection(int(panel[k]), int(section[k]), next(of_known) if is_known[k] else WhyOpen.UNDECIDED)
        for k in range(len(elements))
    )
