"""Sections that a plan does not cover, grouped by why: for a table that a pilot reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.insight.reasons import Reason, Rule, rules_of
from planning.insight.sections import PlanInsight, SectionState


@dataclass(frozen=True, slots=True)
class ReachGroup:
    """Sections with the same state and, where they cannot be reached, the same rules in the way.

    Parameters
    ----------
    rules
        Of the most helpful reason of each; empty where no reason is known or needed.
    panel, section
        The one that lacks least, or the first.
    reason
        Why that one cannot be reached; None where it can, or nothing is known.
    """

    state: SectionState
    rules: tuple[Rule, ...]
    n_sections: int
    n_panels: int
    panel: int
    section: int
    reason: Reason | None


def reach_groups(insight: PlanInsight) -> tuple[ReachGroup, ...]:
    """Groups of all sections that are not covered: those that more views would cover first, then the largest."""
    masks, lacks = _first_reasons(insight)
    groups = []
    for state in (SectionState.MISSED, SectionState.UNDECIDED, SectionState.UNREACHABLE):
        in_state = insight.states == state
        for mask in np.unique(masks[in_state]):
            panel, section = np.nonzero(in_state & (masks == mask))
            least = int(np.argmin(lacks[panel, section]))
            example = int(panel[least]), int(section[least])
            reasons = insight.reasons.of(*example)
            groups.append(
                ReachGroup(
                    state,
                    rules_of(int(mask)),
                    len(panel),
                    len(np.unique(panel)),
                    *example,
                    reasons[0] if reasons and mask else None,
                )
            )
    return tuple(sorted(groups, key=lambda group: (group.state is SectionState.UNREACHABLE, -group.n_sections)))


def _first_reasons(insight: PlanInsight) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Rules (as bits) and total amount of the first reason of each section, both shape (m, s); 0 without one."""
    reasons = insight.reasons
    lacks = np.zeros(reasons.shape[0] * reasons.shape[1])
    element, first = np.unique(reasons.elements, return_index=True)
    lacks[element] = reasons.amounts[first].sum(axis=1)
    return reasons.first_masks(), lacks.reshape(reasons.shape)
