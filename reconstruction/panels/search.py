"""The grid of one facade in its photos: searched in each, in all of them together, or given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from planning.effects import Decision, decide
from planning.errors import InfeasibleError
from planning.findings import Finding, Severity
from planning.progress import Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.facades import Facade
from reconstruction.panels.fusing import FoundSingly, Fusion, LoadPhoto, holds_enough, search_together
from reconstruction.panels.given import given_grid
from reconstruction.panels_file import PanelsFile
from reconstruction.rectify.curvature import decide_view, drawn_view
from reconstruction.rectify.view import SurfaceView, surface_view
from reconstruction.segmentation.record import FacadeGrid
from reconstruction.segmentation.segment import segment_view

if TYPE_CHECKING:
    from reconstruction.panels.find import FindParameters


@dataclass(frozen=True, slots=True, eq=False)
class SearchedFacade:
    """What was found on a facade: `grids` by the number of the photo."""

    grids: dict[int, FacadeGrid]
    decisions: tuple[Decision, ...] = ()
    findings: tuple[Finding, ...] = ()


def search_facade(
    photos: Sequence[PosedPhoto],
    facade: Facade,
    name: str,
    load: LoadPhoto,
    parameters: FindParameters,
    given: Mapping[int, PanelsFile],
    monitor: Monitor,
) -> SearchedFacade:
    """Find the grid of a facade.

    Parameters
    ----------
    given
        Panels by the number of their photo: such photos are not searched, and are used in any case.
    """
    by_hand = [number for number in facade.photos if number in given]
    numbers = tuple(dict.fromkeys((*by_hand, *facade.photos[: parameters.photos_per_facade])))
    views = _views(photos, facade, numbers)
    if not views:
        return SearchedFacade({})
    unrolling = decide_view(list(views.values()), parameters.view)
    grids: dict[int, FacadeGrid] = {}
    for number, view in views.items():
        try:
            drawn = drawn_view(view, parameters.view, unrolling)
        except InfeasibleError:
            continue
        if number in given:
            grid = given_grid(given[number], photos[number], facade, drawn, name)
            if grid is not None:
                grids[number] = grid
        else:
            grids[number] = segment_view(load(photos[number]), drawn, parameters.segmentation, monitor, name)
    if by_hand:
        return SearchedFacade(grids, (unrolling,))
    fusion = decide(Fusion(), FoundSingly(photos, grids, facade.fit.surface), parameters.fuse)
    if not fusion.on or len(grids) < 2:
        return SearchedFacade(grids, (unrolling, fusion))
    together = search_together(photos, facade, numbers, load, parameters.segmentation, monitor, name)
    if together is None or not holds_enough(together, grids):
        text = f"{len(grids)} photos searched together showed no more than each by itself"
        return SearchedFacade(
            grids, (unrolling, fusion), (Finding(Severity.NOTE, "photos-together-in-vain", text, name),)
        )
    text = (
        f"its lines were found in {len(together.grids)} photos together, which were moved onto one another by up to "
        f"{together.moved_px:.1f} px"
    )
    found = Finding(Severity.NOTE, "photos-together", text, name, together.moved_px, None, "px")
    return SearchedFacade(together.grids, (unrolling, fusion), (found,))


def _views(photos: Sequence[PosedPhoto], facade: Facade, numbers: Sequence[int]) -> dict[int, SurfaceView]:
    """Views of the facade by the photo's number; photos that do not show it from its front are left out."""
    views = {}
    for number in numbers:
        try:
            views[number] = surface_view(photos[number], facade.fit.surface, facade.low_st_m, facade.high_st_m)
        except InfeasibleError:
            continue
    return views
