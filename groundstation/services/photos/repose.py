"""The Photos tab's work with other poses: photos read, coverage counted and panels found stay, and are placed anew."""

from __future__ import annotations

from dataclasses import dataclass, replace

from groundstation.services.photos.found_panels import PanelDraft, solved_draft
from groundstation.services.photos.intake import PhotoIntake, with_poses
from groundstation.services.photos.poses import BetterPoses
from planning.base.progress import QUIET, Monitor
from planning.plan import Plan
from planning.site.records import SiteModel


@dataclass(frozen=True, slots=True, eq=False)
class Reposed:
    """Photos and panels with other poses; without panels where none had been found."""

    intake: PhotoIntake
    draft: PanelDraft | None


def repose(
    intake: PhotoIntake,
    draft: PanelDraft | None,
    better: BetterPoses,
    model: SiteModel,
    flown: Plan | None,
    monitor: Monitor = QUIET,
) -> Reposed:
    """Count coverage and solve panels again with other poses of the same photos; corrections of grids stay.

    Raises
    ------
    InfeasibleError
        With these poses a facade's photos do not show it.
    """
    counted = with_poses(intake, better, model, flown, monitor)
    if draft is None:
        return Reposed(counted, None)
    posed = {photo.name: photo for photo in better.photos}
    facades = frozenset(facade.id for facade in draft.found.facades)
    moved = replace(draft, photos=tuple(posed[photo.name] for photo in draft.photos), unsolved=facades)
    return Reposed(counted, solved_draft(moved, monitor))
