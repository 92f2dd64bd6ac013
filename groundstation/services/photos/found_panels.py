"""Found panels while a user works on them: searched, solved again with corrections or other poses, put into a site."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.intake import PhotoIntake, with_poses
from groundstation.services.photos.panels import site_facade
from groundstation.services.photos.poses import ChosenPoses
from groundstation.services.site.edits import with_site
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.photos.record import PhotoMetadata
from planning.plan import Plan
from planning.site.records import SiteModel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.search.record import FacadeGrid
from reconstruction.panels.solving.find import FindParameters, FoundPanels, find_panels
from reconstruction.panels.solving.record import SolvedFacade
from reconstruction.panels.solving.solve import solve_facade
from reconstruction.photos.decode import colour_picture


@dataclass(frozen=True, slots=True)
class GridPlace:
    """One facade in one photo: `photo` is its number in the draft."""

    facade: str
    photo: int


@dataclass(frozen=True, slots=True, eq=False)
class PanelDraft:
    """Panels as found and corrected so far.

    Parameters
    ----------
    photos
        In the order that `found` counts them.
    unsolved
        Facades whose grids have been corrected since they were solved.
    """

    photos: tuple[PosedPhoto, ...]
    found: FoundPanels
    unsolved: frozenset[str] = frozenset()

    def places(self) -> tuple[GridPlace, ...]:
        """Where there is a grid to correct."""
        kept = {facade.id for facade in self.found.facades}
        return tuple(GridPlace(facade, photo) for facade, photo in self.found.grids if facade in kept)

    def grid(self, place: GridPlace) -> FacadeGrid:
        """The grid at a place; `KeyError` where there is none."""
        return self.found.grids[place.facade, place.photo]

    def facade(self, facade_id: str) -> SolvedFacade:
        """A facade by its identifier; `StopIteration` where there is none."""
        return next(facade for facade in self.found.facades if facade.id == facade_id)


def search_panels(
    photos: Sequence[PosedPhoto],
    metadata: Sequence[PhotoMetadata],
    model: SiteModel,
    parameters: FindParameters | None = None,
    monitor: Monitor = QUIET,
) -> PanelDraft:
    """Find the panels of a site's building in photos.

    Parameters
    ----------
    metadata
        Of at least these photos, in any order.

    Raises
    ------
    InputError
        The site has no building mesh, or a photo cannot be read any more.
    InfeasibleError
        No panels were found.
    """
    if not len(model.building.triangles):
        raise InputError(
            say("this site has no building mesh, and panels are found on one; import the coarse model of the building")
        )
    if not photos:
        raise InputError(say("none of the photos says where it was taken, so that panels cannot be put into 3-D"))
    by_path = {data.path: data for data in metadata}

    def load(photo: PosedPhoto) -> NDArray[np.uint8]:
        return colour_picture(by_path[photo.path])

    return PanelDraft(tuple(photos), find_panels(photos, model.building, load, parameters, monitor))


def solved_draft(draft: PanelDraft, monitor: Monitor = QUIET) -> PanelDraft:
    """With every corrected facade solved again.

    Raises
    ------
    InfeasibleError
        What is left of a facade's grids has no panel.
    """
    facades = []
    for number, facade in enumerate(draft.found.facades):
        monitor.report(say("solving facades"), number, len(draft.found.facades))
        if facade.id in draft.unsolved:
            grids = {photo: grid for (name, photo), grid in draft.found.grids.items() if name == facade.id}
            facade = solve_facade(facade.id, draft.photos, grids, draft.found.fits[facade.id])
        facades.append(facade)
    return replace(draft, found=replace(draft.found, facades=tuple(facades)), unsolved=frozenset())


def with_found_panels(model: SiteModel, draft: PanelDraft) -> SiteModel:
    """The site with the draft's facades in the place of its own; a draft that is not solved is a wrong call.

    Raises
    ------
    InputError
        All panels were taken out.
    """
    if draft.unsolved:
        raise ValueError(f"expected a solved draft, got corrections of {sorted(draft.unsolved)}")
    facades = tuple(site_facade(one) for one in draft.found.facades if one.panels)
    if not facades:
        raise InputError(say("no panel is left: put one back before these panels are used"))
    return with_site(model, replace(model.site, facades=facades))


# The Photos tab's work with other poses: photos read, coverage counted and panels found stay, and are placed anew.


@dataclass(frozen=True, slots=True, eq=False)
class AppliedPoses:
    """Photos and panels with other poses; without panels where none had been found."""

    intake: PhotoIntake
    draft: PanelDraft | None


def apply_poses(
    intake: PhotoIntake,
    draft: PanelDraft | None,
    better: ChosenPoses,
    model: SiteModel,
    flown: Plan | None,
    monitor: Monitor = QUIET,
) -> AppliedPoses:
    """Count coverage and solve panels again with other poses of the same photos; corrections of grids stay.

    Raises
    ------
    InfeasibleError
        With these poses a facade's photos do not show it.
    """
    counted = with_poses(intake, better, model, flown, monitor)
    if draft is None:
        return AppliedPoses(counted, None)
    posed = {photo.name: photo for photo in better.photos}
    facades = frozenset(facade.id for facade in draft.found.facades)
    moved = replace(draft, photos=tuple(posed[photo.name] for photo in draft.photos), unsolved=facades)
    return AppliedPoses(counted, solved_draft(moved, monitor))
