"""All panels of a building out of posed photos and a coarse model: the first step of the paper (3.1), end to end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from planning.effects import Decision, Wish
from planning.errors import InfeasibleError
from planning.findings import Finding, Severity
from planning.mesh import TriangleMesh
from planning.progress import QUIET, Monitor
from planning.site_import.facades import facade_name
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.facades import building_facades
from reconstruction.panels.findings import facade_findings
from reconstruction.panels.fusing import LoadPhoto
from reconstruction.panels.given import files_by_photo
from reconstruction.panels.record import SolvedFacade
from reconstruction.panels.search import search_facade
from reconstruction.panels.solve import solve_facade
from reconstruction.panels_file import PanelsFile
from reconstruction.rectify.curvature import VIEW_KINDS, ViewKind
from reconstruction.rectify.fit import SurfaceFit
from reconstruction.rectify.patches import PatchParameters, facades_in_photo
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.record import FacadeGrid


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
    view
        How photos are rectified: by arc length (`exact`), flattened onto the tangent plane (`tangent`), by the paper's
        polynomial (`polynomial`), or `auto`: by arc length where the flattened view would differ.
    fuse
        Search the photos of a facade together: where one by one they do not agree, always, or never.
    least_panels
        Facades with fewer are dropped: walls on which something looked like a grid.
    """

    photos_per_facade: int = 4
    curvature: Wish = "auto"
    view: ViewKind = "auto"
    fuse: Wish = "auto"
    least_panels: int = 2
    patches: PatchParameters = field(default_factory=PatchParameters)
    segmentation: SegmentationParameters = field(default_factory=SegmentationParameters)

    def __post_init__(self) -> None:
        if self.photos_per_facade < 1:
            raise ValueError(f"photos_per_facade: expected at least 1, got {self.photos_per_facade}")
        if self.view not in VIEW_KINDS:
            raise ValueError(f"view: expected one of {', '.join(VIEW_KINDS)}, got {self.view}")


@dataclass(frozen=True, slots=True, eq=False)
class FoundPanels:
    """Result of `find_panels`.

    Parameters
    ----------
    grids
        By the facade's id and the photo's number: what was found in each photo.
    fits
        By the facade's id: its surface as the coarse model has it, from which `solve_facade` starts.
    decisions
        By the facade's id: whether it is a plane or a cylinder.
    search_decisions
        By the facade's id: how its photos were rectified, and whether they were searched together.
    """

    facades: tuple[SolvedFacade, ...]
    grids: dict[tuple[str, int], FacadeGrid]
    fits: dict[str, SurfaceFit]
    decisions: dict[str, Decision]
    findings: tuple[Finding, ...]
    search_decisions: dict[str, tuple[Decision, ...]] = field(default_factory=dict)


def find_panels(
    photos: Sequence[PosedPhoto],
    model: TriangleMesh,
    load: LoadPhoto,
    parameters: FindParameters | None = None,
    monitor: Monitor = QUIET,
    given: Mapping[str, PanelsFile] | None = None,
) -> FoundPanels:
    """Find the panels of all facades.

    Parameters
    ----------
    model
        The coarse model, ENU.
    load
        Reads a photo: shape (h, w, 3), of the size that its intrinsics say.
    given
        Panels by the name of their photo, in place of a search of that photo.

    Raises
    ------
    InputError
        Panels are given for none of the photos, or for a picture of another size.
    InfeasibleError
        No photo shows an upright facade of the model, or no grid was found on any.
    """
    parameters = parameters or FindParameters()
    by_hand = files_by_photo(photos, given or {})
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
    search_decisions: dict[str, tuple[Decision, ...]] = {}
    findings: list[Finding] = []
    for order, facade in enumerate(facades):
        monitor.report("finding panels", order, len(facades))
        name = facade_name(len(solved))
        found = search_facade(photos, facade, name, load, parameters, by_hand, monitor)
        try:
            result = solve_facade(name, photos, found.grids, facade.fit)
        except InfeasibleError as error:
            findings.append(Finding(Severity.NOTE, "facade-without-grid", f"a facade was left out: {error}", name))
            continue
        if len(result.panels) < parameters.least_panels:
            findings.append(
                Finding(Severity.NOTE, "facade-too-small", f"a wall with {len(result.panels)} panel was left out", name)
            )
            continue
        findings += [*found.findings, *facade_findings(result, photos)]
        solved.append(result)
        fits[name], decisions[name] = facade.fit, facade.curvature
        search_decisions[name] = found.decisions
        grids |= {(name, number): grid for number, grid in found.grids.items()}
    if not solved:
        raise InfeasibleError("no grid of panels was found on any facade; choose sharper photos taken from the front")
    return FoundPanels(tuple(solved), grids, fits, decisions, tuple(findings), search_decisions)
