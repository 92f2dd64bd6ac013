"""Use cases around editing a plan by hand: what an edit changed, and the document with the edited plan."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.project.document import Document
from planning.base.findings import Finding, Severity
from planning.geo.frames import camera_axes
from planning.plan import Viewpoint
from planning.revision.edits import Revision
from planning.site.records import Airspace, Site, SiteModel

BESIDE_M = 2.0
"""A new viewpoint stands this far beside the one it is added to: two aircraft lengths, clearly another place."""

KEEPING_METHODS = frozenset({"greedy"})
"""Methods of planning that can keep viewpoints; `planning.planner` refuses to keep any with the others."""


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


def viewpoint_beside(viewpoint: Viewpoint, airspace: Airspace) -> Viewpoint:
    """A viewpoint that looks as another one does, `BESIDE_M` to its right or, where the airspace ends, to its left.

    Where both lie outside, as they do for a viewpoint that is outside itself, it stands to the right.
    """
    _, right, _ = camera_axes(math.radians(viewpoint.heading_deg), 0.0)
    here = np.array(viewpoint.position_enu_m)
    places = [here + BESIDE_M * right, here - BESIDE_M * right]
    low, high = np.array(airspace.min_enu_m), np.array(airspace.max_enu_m)
    place = next((place for place in places if ((low <= place) & (place <= high)).all()), places[0])
    x, y, z = (float(value) for value in place)
    return replace(viewpoint, position_enu_m=(x, y, z), locked=False)


def above_home(site: Site) -> Viewpoint:
    """A viewpoint to begin with: straight above home, just inside the airspace, looking north."""
    x, y, z = site.home_enu_m
    airspace = site.airspace
    floor_m = max(airspace.min_enu_m[2], airspace.ground_z_m + airspace.lowest_height_m())
    ceiling_m = airspace.max_enu_m[2]
    return Viewpoint("new", (x, y, min(max(z, floor_m) + BESIDE_M, ceiling_m)), 0.0, 0.0)


def has_same_panels(site: SiteModel, other: SiteModel | None) -> bool:
    """Whether a plan for one site says something about another: it was edited meanwhile, but not replaced."""
    return other is not None and (other is site or other.site.panels == site.site.panels)
