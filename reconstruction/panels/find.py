"""All panels of a building out of posed photos and a coarse model: the first step of the paper (3.1), end to end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planning.effects import Decision, Wish
from planning.errors import InfeasibleError
from planning.findings import Finding, Severity
from planning.mesh import TriangleMesh
from planning.progress import QUIET, Monitor
from planning.site_import.facades import facade_name
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.facades import Facade, building_facades
from reconstruction.panels.record import SolvedFacade
from reconstruction.panels.solve import solve_facade
from reconstruction.rectify.fit import SurfaceFit
from reconstruction.rectify.patches import PatchParameters, facades_in_photo
from reconstruction.rectify.view import surface_view
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.record import FacadeGrid
from reconstruction.segmentation.segment import segment_view

Image = NDArray[np.uint8]
LoadPhoto = Callable[[PosedPhoto], Image]


@dataclass(frozen=True, slots=True)
class FindParameters:
    """How panels are found.

    Parameters
    ----------
    photos_per_facade
        The most useful ones that are searched: what more photos cost in time and bring in accuracy is measured in
        docs/benchmarks.md.
    curvature
        Take facades for cylinders: as the scene calls for, always, or never.
    least_panels
        Facades with fewer are dropped: walls on which something looked like a grid.
    """

    photos_per_facade: int = 4
    curvature: Wish = "auto"
    least_panels: int = 2
    patches: PatchParameters = field(default_factory=PatchParameters)
    segmentation: SegmentationParameters = field(default_factory=SegmentationParameters)

    def __post_init__(self) -> None:
        if self.photos_per_facade < 1:
            raise ValueError(f"photos_per_facade: expected at least 1, got {self.photos_per_facade}")


@dataclass(frozen=True, slots=True, eq=False)
class FoundPanels:
    """Result of `find_panels`.

    Parameters
    ----------
    grids
        By the facade's id and the photo's number: what was found in each photo.
    fits
        By the facade's id: its surface as the coarse model has it, from which `solve_facade` starts.
    """

    facades: tuple[SolvedFacade, ...]
    grids: dict[tuple[str, int], FacadeGrid]
    fits: dict[str, SurfaceFit]
    decisions: dict[str, Decision]
    findings: tuple[Finding, ...]


def find_panels(
    photos: Sequence[PosedPhoto],
    model: TriangleMesh,
    load: LoadPhoto,
    parameters: FindParameters | None = None,
    monitor: Monitor = QUIET,
) -> FoundPanels:
    """Find the panels of all facades.

    Parameters
    ----------
    model
        The coarse model, ENU.
    load
        Reads a photo: shape (h, w, 3), of the size that its intrinsics say.

    Raises
    ------
    InfeasibleError
        No photo shows an upright facade of the model, or no grid was found on any.
    """
    parameters = parameters or FindParameters()
    patches = []
    for number, photo in enumerate(photos):
        monitor.report("looking for facades", number, len(photos))
        patches.append(facades_in_photo(photo, model, parameters.patches))
    facades = building_facades(photos, patches, parameters.curvature)
    if not facades:
        raise InfeasibleError(
            f"none of the {len(photos)} photos shows an upright facade of the coarse model; do poses and model belong "
            "to the same origin?"
        )
    solved: list[SolvedFacade] = []
    grids: dict[tuple[str, int], FacadeGrid] = {}
    fits: dict[str, SurfaceFit] = {}
    decisions: dict[str, Decision] = {}
    findings: list[Finding] = []
    for order, facade in enumerate(facades):
        monitor.report("finding panels", order, len(facades))
        name = facade_name(len(solved))
        found = _grids(photos, facade, name, load, parameters, monitor)
        try:
            result = solve_facade(name, photos, found, facade.fit)
        except InfeasibleError as error:
            findings.append(Finding(Severity.NOTE, "facade-without-grid", f"a facade was left out: {error}", name))
            continue
        if len(result.panels) < parameters.least_panels:
            findings.append(
                Finding(Severity.NOTE, "facade-too-small", f"a wall with {len(result.panels)} panel was left out", name)
            )
            continue
        solved.append(result)
        fits[name], decisions[name] = facade.fit, facade.curvature
        grids |= {(name, number): grid for number, grid in found.items()}
    if not solved:
        raise InfeasibleError("no grid of panels was found on any facade; choose sharper photos taken from the front")
    return FoundPanels(tuple(solved), grids, fits, decisions, tuple(findings))


def _grids(
    photos: Sequence[PosedPhoto],
    facade: Facade,
    name: str,
    load: LoadPhoto,
    parameters: FindParameters,
    monitor: Monitor,
) -> dict[int, FacadeGrid]:
    grids: dict[int, FacadeGrid] = {}
    for number in facade.photos[: parameters.photos_per_facade]:
        photo = photos[number]
        try:
            view = surface_view(photo, facade.fit.surface, facade.low_st_m, facade.high_st_m)
        except InfeasibleError:
            continue
        grids[number] = segment_view(load(photo), view, parameters.segmentation, monitor, name)
    return grids
