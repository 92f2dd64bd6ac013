"""Use cases around editing a plan by hand: what an edit changed, and the document with the edited plan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.document import Document
from planning.findings import Finding, Severity
from planning.revision import Revision


@dataclass(frozen=True, slots=True)
class EditEffect:
    """What an edit changed.

    Parameters
    ----------
    gained, lost
        Sections that are covered only since, and only before.
    added_s, added_m
        Flight time and length of all sorties, as stated; negative where the edit saves some.
    problems, solved
        Findings that are not OK: those that came with the edit, and those that went. A finding that only measures
        something else than before is neither.
    """

    gained: int
    lost: int
    added_s: float
    added_m: float
    problems: tuple[Finding, ...]
    solved: tuple[Finding, ...]


def edit_effect(before: Revision, after: Revision) -> EditEffect:
    """What the edits between two revisions of a plan changed."""
    change = coverage_change(before, after)
    old, new = before.plan.sorties, after.plan.sorties
    return EditEffect(
        gained=int(np.count_nonzero(change > 0)),
        lost=int(np.count_nonzero(change < 0)),
        added_s=sum(sortie.duration_s for sortie in new) - sum(sortie.duration_s for sortie in old),
        added_m=sum(sortie.length_m for sortie in new) - sum(sortie.length_m for sortie in old),
        problems=_only_in(after, before),
        solved=_only_in(before, after),
    )


def coverage_change(before: Revision, after: Revision) -> NDArray[np.int8]:
    """Sections that are covered only since (1), only before (-1), or as they were (0), shape (m, n_sections)."""
    return (after.counts > 0).astype(np.int8) - (before.counts > 0).astype(np.int8)


def _only_in(revision: Revision, other: Revision) -> tuple[Finding, ...]:
    """Problems of one revision that the other does not have, by rule, place and severity."""
    known = {(found.severity, found.code, found.place) for found in other.findings}
    return tuple(
        found
        for found in revision.findings
        if found.severity is not Severity.OK and (found.severity, found.code, found.place) not in known
    )


def with_edited_plan(document: Document, revision: Revision) -> Document:
    """The document with its current plan as it was edited.

    The bound on what as many views could cover goes: it was for the views that the planner chose among, and is not
    proven for poses set by hand.

    Raises
    ------
    ValueError
        There is no current plan.
    """
    entry = document.current
    if entry is None:
        raise ValueError("document: expected a current plan, there is none")
    return document.with_plan(replace(entry, plan=revision.plan, bound_for_views=None))
