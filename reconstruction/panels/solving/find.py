"""All panels of a building out of posed photos and a coarse model: the first step of the paper (3.1), end to end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from planning.site.importing.facades import facade_name
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.panels_file import PanelsFile
from reconstruction.panels.rectify.fit import (
    VIEW_KINDS,
    PatchParameters,
    SurfaceFit,
    ViewKind,
    decide_view,
    drawn_view,
    facades_in_photo,
)
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, GridLine
from reconstruction.panels.search.segment import segment_views
from reconstruction.panels.segment import segment_view
from reconstruction.panels.solving.association import TOGETHER, associate, observed_lines
from reconstruction.panels.solving.facades import Facade, building_facades, files_by_photo, grid_from_file
from reconstruction.panels.solving.record import ObservedLine, SolvedFacade, SurfaceLine
from reconstruction.panels.solving.register import registered
from reconstruction.panels.solving.solve import REACH_SIGMAS, reach_m, solve_facade

# Facades whose photos do not agree, searched in all photos at once: an effect that the scene calls for or not.

Array = NDArray[np.float64]
LoadPhoto = Callable[[PosedPhoto], NDArray[np.uint8]]

DOUBTFUL = 0.25
"""Sightings that may be missing. A photo misses one line in five (`association.MISSED`), and lines that it shows have a
confidence of 0.9 and more."""

COST_S_PER_PHOTO = 0.7
"""To bring a photo onto the others and to search it again with them: one core, windows of 700 to 1000 px."""

LEAST_AGREEMENT = 0.3
"""Of a photo's edges with the first photo's. Photos brought onto it to a pixel had 0.35 and more, those that ended on
other lines 0.2 and more: some of these are kept, and are outvoted."""

FAINTER = 0.55
"""Of the share of a line that must be seen: what is mirrored lies elsewhere in each photo and drowns less."""

LEAST_SIDE_PX = 60
"""Of the window: smaller ones have no cells to bring photos together by."""

LEAST_OF_ALL = 0.05
"""The least that `SegmentationParameters` takes."""

LEAST_LEFT = 0.5
"""A grid found in all photos at once counts if it has at least this share of the cells that single photos show."""


@dataclass(frozen=True, slots=True, eq=False)
class SeparateSearch:
    """What was found in the photos of a facade one by one: `grids` by the number of the photo."""

    photos: Sequence[PosedPhoto]
    grids: Mapping[int, FacadeGrid]
    surface: FacadeSurface


@dataclass(frozen=True, slots=True)
class Fusion:
    """Search all photos of a facade at once: where one by one they show no grid, or each another one."""

    name: str = "photos searched together"
    unit: str = "of the sightings"
    tolerance: float = DOUBTFUL

    def assess(self, scene: SeparateSearch) -> Assessment:
        """The share of sightings that is missing: of each line in each photo that shows its place."""
        n = len(scene.grids)
        if n < 2:
            return Assessment(0.0, say("there is one photo"), 0.0)
        n_bare = sum(len(grid.rows) < 2 or len(grid.columns) < 2 for grid in scene.grids.values())
        bare = say(", {} of them without a grid", n_bare) if n_bare else ""
        return Assessment(
            missing_share(scene), say("how far {} photos disagree on their lines{}", n, bare), COST_S_PER_PHOTO * n
        )


def missing_share(found: SeparateSearch) -> float:
    """Share of sightings that is missing, 0 to 1, each counted by its confidence.

    Every photo that shows the place of a line should show the line; a line that the others outvote counts as one that
    is missing.
    """
    lines = [
        line
        for number, grid in found.grids.items()
        for line in observed_lines(found.photos[number], number, grid, found.surface)
    ]
    reach = max((reach_m(found.photos[number], found.surface) for number in found.grids), default=0.0)
    groups = associate(lines, 2.0 * reach)
    n_looks = len(lines) - sum(len(group.members) for group in groups)
    shown = 0.0
    for group in groups:
        shown += sum(line.confidence for line in group.members)
        places = found.surface.to_enu(_along(group.members))
        seeing = {number for number in found.grids if found.photos[number].sees(places).mean() >= 0.5}
        n_looks += len(seeing | {line.photo for line in group.members})
    return 1.0 - shown / n_looks if n_looks else 1.0


def _along(members: Sequence[ObservedLine]) -> Array:
    """Ends and middle of a line on the surface, metres, shape (3, 2)."""
    across = np.full(3, np.median([line.position_m for line in members]))
    along = np.linspace(min(line.from_m for line in members), max(line.to_m for line in members), 3)
    return np.column_stack([across, along] if members[0].axis == "column" else [along, across])


@dataclass(frozen=True, slots=True, eq=False)
class FusedSearch:
    """What was found in several photos at once.

    Parameters
    ----------
    grids
        By the number of the photo: the same lines in each, through its own view.
    moved_px
        How far photos were moved in the rectified picture to lie on the first, the largest.
    """

    grids: dict[int, FacadeGrid]
    moved_px: float


def fused_search(
    photos: Sequence[PosedPhoto],
    facade: Facade,
    numbers: Sequence[int],
    load: LoadPhoto,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> FusedSearch | None:
    """Find the panels of one facade in several photos at once; None where they show no grid together.

    A line is one look at all photos, so that each photo answers for its part only: of the line's log odds, and of its
    standard deviation.

    Parameters
    ----------
    numbers
        Of the photos, the most useful first: the others are brought onto it.
    """
    views = _same_window(photos, facade, numbers, parameters.long_side_px)
    if len(views) < 2 or min(min(view.width_px, view.height_px) for view in views.values()) < LEAST_SIDE_PX:
        return None
    images = []
    for done, number in enumerate(views):
        monitor.report(say("fuse views"), done, len(views))
        images.append(load(photos[number]))
    placed = registered(images, list(views.values()), parameters.seed)
    kept = [i for i, one in enumerate(placed) if one.agreement >= LEAST_AGREEMENT]
    if len(kept) < 2:
        return None
    fainter = replace(parameters, least_seen=max(LEAST_OF_ALL, FAINTER * parameters.least_seen))
    found = segment_views([images[i] for i in kept], [placed[i].view for i in kept], fainter, monitor, facade_id)
    if len(found[0].rows) < 2 or len(found[0].columns) < 2:
        return None
    order = list(views)
    grids = {order[i]: _part(grid, len(kept)) for i, grid in zip(kept, found, strict=True)}
    return FusedSearch(grids, max(placed[i].moved_px for i in kept))


def holds_enough(together: FusedSearch, singly: Mapping[int, FacadeGrid]) -> bool:
    """Whether the grid of all photos has not lost most of what single photos show."""
    least = LEAST_LEFT * float(np.median([_n_cells(grid) for grid in singly.values()]))
    return _n_cells(next(iter(together.grids.values()))) >= least


def _n_cells(grid: FacadeGrid) -> int:
    return max(0, len(grid.rows) - 1) * max(0, len(grid.columns) - 1)


def _same_window(
    photos: Sequence[PosedPhoto], facade: Facade, numbers: Sequence[int], long_side_px: int
) -> dict[int, SurfaceView]:
    """Views of what any of the photos shows of the facade, at the finest of their scales, by the photo's number."""
    views = {}
    for number in numbers:
        try:
            views[number] = surface_view(photos[number], facade.fit.surface, facade.low_st_m, facade.high_st_m)
        except InfeasibleError:
            continue
    if not views:
        return {}
    low = np.min([view.low_st_m for view in views.values()], axis=0)
    high = np.max([view.high_st_m for view in views.values()], axis=0)
    px_per_m = min(max(view.px_per_m for view in views.values()), (long_side_px - 1) / float((high - low).max()))
    return {number: replace(view, low_st_m=low, high_st_m=high, px_per_m=px_per_m) for number, view in views.items()}


def _part(grid: FacadeGrid, n: int) -> FacadeGrid:
    """One photo's part of a grid that n photos show together."""
    rows, columns = (tuple(_part_of_line(line, n) for line in lines) for lines in (grid.rows, grid.columns))
    return facade_grid(grid.id, grid.rectification, rows, columns, grid.inclined)


def _part_of_line(line: GridLine, n: int) -> GridLine:
    inside = min(0.9999, max(0.0001, line.confidence))
    odds = (inside / (1.0 - inside)) ** (1.0 / n)
    return replace(line, confidence=odds / (1.0 + odds), sigma_px=line.sigma_px * float(np.sqrt(n)))


# What a user should know of a solved facade.

REPEATS = 0.7
"""Share of lines that lie on others after a step, from which on a grid looks the same one panel further."""

MOST_PANELS = 3
"""In a step: alternating widths repeat after two."""


def facade_findings(facade: SolvedFacade, photos: Sequence[PosedPhoto]) -> list[Finding]:
    """Everything worth saying of a facade; `photos` are counted as in its `pose_changes`."""
    return [*reduced_panels(facade), *photos_a_panel_apart(facade, photos)]


def reduced_panels(facade: SolvedFacade) -> list[Finding]:
    """What is said of panels whose shape a site cannot hold."""
    outlines = [panel.outline_enu_m for panel in facade.panels if panel.outline_enu_m is not None]
    many = [outline for outline in outlines if len(outline) > 4]
    if not many:
        return []
    text = say(
        "{} of {} panels have more than four corners; a site's panels have four, so that the largest "
        "four-cornered part of each is kept",
        len(many),
        len(facade.panels),
    )
    return [Finding(Severity.NOTE, "panels-with-more-corners", text, facade.id, float(len(many)))]


def photos_a_panel_apart(facade: SolvedFacade, photos: Sequence[PosedPhoto]) -> list[Finding]:
    """A warning where photos may have been matched a panel apart.

    A regular grid looks the same one panel further, so that poses must tell which panel is which: to half a panel.
    """
    steps = [step for lines in (facade.columns, facade.rows) if (step := repeated_step_m(lines)) is not None]
    sigmas = [reach_m(photos[number], facade.surface) / REACH_SIGMAS for number in facade.pose_changes]
    if not steps or max(sigmas, default=0.0) <= 0.5 * min(steps):
        return []
    text = say(
        "panels repeat every {:.2f} m, and a photo may lie {:.2f} m off (one standard deviation), so "
        "that the facade may stand a panel off, or photos were matched a panel apart; refine the poses, "
        "or compare with a measured corner",
        min(steps),
        max(sigmas),
    )
    return [Finding(Severity.WARNING, "photos-a-panel-apart", text, facade.id, max(sigmas))]


def repeated_step_m(lines: Sequence[SurfaceLine]) -> float | None:
    """The shortest step, of one to three panels, that leads from lines to lines; None in grids that do not repeat."""
    places = np.sort([line.position_m for line in lines])
    if len(places) < 3:
        return None
    tolerance = TOGETHER * float(np.diff(places).min())
    for n_panels in range(1, min(MOST_PANELS, len(places) - 2) + 1):
        step = float(np.median(places[n_panels:] - places[:-n_panels]))
        off = np.abs(places[:-n_panels, None] + step - places[None, :]).min(axis=1)
        if float(np.mean(off <= tolerance)) >= REPEATS:
            return step
    return None


# The grid of one facade in its photos: searched in each, in all of them together, or given.


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
    known_grids: Mapping[int, PanelsFile],
    monitor: Monitor,
) -> SearchedFacade:
    """Find the grid of a facade.

    Parameters
    ----------
    known_grids
        Panels by the number of their photo: such photos are not searched, and are used in any case.
    """
    by_hand = [number for number in facade.photos if number in known_grids]
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
        if number in known_grids:
            grid = grid_from_file(known_grids[number], photos[number], facade, drawn, name)
            if grid is not None:
                grids[number] = grid
        else:
            grids[number] = segment_view(load(photos[number]), drawn, parameters.segmentation, monitor, name)
    if by_hand:
        return SearchedFacade(grids, (unrolling,))
    fusion = decide(Fusion(), SeparateSearch(photos, grids, facade.fit.surface), parameters.fuse)
    if not fusion.on or len(grids) < 2:
        return SearchedFacade(grids, (unrolling, fusion))
    together = fused_search(photos, facade, numbers, load, parameters.segmentation, monitor, name)
    if together is None or not holds_enough(together, grids):
        text = say("{} photos searched together showed no more than each by itself", len(grids))
        return SearchedFacade(
            grids, (unrolling, fusion), (Finding(Severity.NOTE, "photos-together-in-vain", text, name),)
        )
    text = say(
        "its lines were found in {} photos together, which were moved onto one another by up to {:.1f} px",
        len(together.grids),
        together.moved_px,
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
    curvature: EffectSetting = "auto"
    view: ViewKind = "auto"
    fuse: EffectSetting = "auto"
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
    known_grids: Mapping[str, PanelsFile] | None = None,
) -> FoundPanels:
    """Find the panels of all facades.

    Parameters
    ----------
    model
        The coarse model, ENU.
    load
        Reads a photo: shape (h, w, 3), of the size that its intrinsics say.
    known_grids
        Panels by the name of their photo, in place of a search of that photo.

    Raises
    ------
    InputError
        Panels are given for none of the photos, or for a picture of another size.
    InfeasibleError
        No photo shows an upright facade of the model, or no grid was found on any.
    """
    parameters = parameters or FindParameters()
    by_hand = files_by_photo(photos, known_grids or {})
    patches = []
    for number, photo in enumerate(photos):
        monitor.report(say("looking for facades"), number, len(photos))
        patches.append(facades_in_photo(photo, model, parameters.patches))
    facades = building_facades(photos, patches, parameters.curvature)
    if not facades:
        raise InfeasibleError(
            say(
                "none of the {} photos shows an upright facade of the coarse model; do poses and model belong to "
                "the same origin?",
                len(photos),
            )
        )
    solved: list[SolvedFacade] = []
    grids: dict[tuple[str, int], FacadeGrid] = {}
    fits: dict[str, SurfaceFit] = {}
    decisions: dict[str, Decision] = {}
    search_decisions: dict[str, tuple[Decision, ...]] = {}
    findings: list[Finding] = []
    for order, facade in enumerate(facades):
        monitor.report(say("finding panels"), order, len(facades))
        name = facade_name(len(solved))
        found = search_facade(photos, facade, name, load, parameters, by_hand, monitor)
        try:
            result = solve_facade(name, photos, found.grids, facade.fit)
        except InfeasibleError as error:
            findings.append(
                Finding(Severity.NOTE, "facade-without-grid", say("a facade was left out: {}", error), name)
            )
            continue
        if len(result.panels) < parameters.least_panels:
            findings.append(
                Finding(
                    Severity.NOTE,
                    "facade-too-small",
                    say("a wall with {} panel was left out", len(result.panels)),
                    name,
                )
            )
            continue
        findings += [*found.findings, *facade_findings(result, photos)]
        solved.append(result)
        fits[name], decisions[name] = facade.fit, facade.curvature
        search_decisions[name] = found.decisions
        grids |= {(name, number): grid for number, grid in found.grids.items()}
    if not solved:
        raise InfeasibleError(
            say("no grid of panels was found on any facade; choose sharper photos taken from the front")
        )
    return FoundPanels(tuple(solved), grids, fits, decisions, tuple(findings), search_decisions)
