"""What a set of viewpoints covers on a site, by the definition in float64, as it stands in plan files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel, exact_coverage, exact_sections
from planning.coverage.reach_kernel import UNREACHABLE
from planning.coverage.reachability import Reachability
from planning.coverage.sections import NOT_SEEN
from planning.plan import Coverage, Viewpoint, viewpoint_arrays

GSD_DECIMALS = 3
"""Of pixels in plan files, in millimetres."""


@dataclass(frozen=True, slots=True)
class DepthCount:
    """Sections of `step_deg` that at least `n_views` views cover, and all there are."""

    step_deg: float
    n_views: int
    covered: int
    total: int


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What one view covers.

    Parameters
    ----------
    elements
        Panel * n_sections + section of each panel that it covers, shape (k,), rising.
    distances_m
        Of the panels' centroids, shape (k,).
    nearest_m, furthest_m
        Distances to the centroids of the nearest and the furthest of these panels; inf and 0 where there is none.
    """

    elements: NDArray[np.int32]
    distances_m: NDArray[np.float64]
    nearest_m: float
    furthest_m: float


def sights(model: CoverageModel, viewpoints: Sequence[Viewpoint]) -> tuple[Sight, ...]:
    """What each viewpoint covers, by the definition; the same whichever others are asked for with it."""
    views = viewpoint_arrays(tuple(viewpoints))
    sections = exact_sections(model, views)
    view, panel = np.nonzero(sections != NOT_SEEN)
    elements = (panel * model.grid.n_sections + sections[view, panel]).astype(np.int32)
    distances = np.linalg.norm(views.positions_enu_m[view] - model.frames.centroids[panel], axis=1)
    nearest, furthest = np.full(len(sections), np.inf), np.zeros(len(sections))
    np.minimum.at(nearest, view, distances)
    np.maximum.at(furthest, view, distances)
    ends = np.cumsum(np.bincount(view, minlength=len(sections)))
    return tuple(
        Sight(elements[start:end].copy(), distances[start:end].copy(), float(near), float(far))
        for start, end, near, far in zip(ends - np.diff(ends, prepend=0), ends, nearest, furthest, strict=True)
    )


def section_counts(model: CoverageModel, seen: Sequence[Sight]) -> NDArray[np.int64]:
    """Number of views that cover each section, shape (m, n_sections), from what each covers."""
    elements = np.concatenate([np.zeros(0, np.int32), *(sight.elements for sight in seen)])
    return np.bincount(elements, minlength=model.n_elements).reshape(len(model.frames), model.grid.n_sections)


def nearest_views_m(model: CoverageModel, seen: Iterable[Sight]) -> NDArray[np.float64]:
    """Distance of the nearest view of each section, shape (n_elements,), inf where there is none."""
    nearest_m, chosen = np.full(model.n_elements, np.inf), tuple(seen)
    if chosen:
        elements, distances_m = (
            np.concatenate(parts) for parts in zip(*((s.elements, s.distances_m) for s in chosen), strict=True)
        )
        np.minimum.at(nearest_m, elements, distances_m)
    return nearest_m


def coverage_counts(model: CoverageModel, viewpoints: Sequence[Viewpoint]) -> NDArray[np.int64]:
    """Number of viewpoints that cover each section, shape (m, n_sections)."""
    return exact_coverage(model, viewpoint_arrays(tuple(viewpoints)))


def coverage(model: CoverageModel, viewpoints: Sequence[Viewpoint], reachability: Reachability) -> Coverage:
    """Covered sections beside the bound on what is reachable; see `coverage_of_sights`."""
    return coverage_of_sights(model, sights(model, viewpoints), reachability)


def coverage_of_sights(model: CoverageModel, seen: Iterable[Sight], reachability: Reachability) -> Coverage:
    """Covered sections beside the bound on what is reachable, from what each view covers.

    Viewpoints of other programs may break the rules that the bound rests on (stand too close, leave the airspace);
    sections that such a viewpoint covers count as reachable.
    """
    nearest_m = nearest_views_m(model, seen)
    covered = np.isfinite(nearest_m)
    bound = covered | (reachability.verdicts != UNREACHABLE).reshape(-1)
    sharp_m = np.inf if model.sharp_m is None else model.sharp_m
    return Coverage(
        int(covered.sum()),
        len(covered),
        int(bound.sum()),
        int(np.count_nonzero(covered & (nearest_m <= sharp_m))),
        round(1000.0 * model.camera.gsd_m(float(nearest_m[covered].max(initial=0.0))), GSD_DECIMALS),
    )


def depth(model: CoverageModel, counts: NDArray[np.int64], max_views: int = 4) -> tuple[DepthCount, ...]:
    """How many sections are covered once, twice and so on up to `max_views` times, from `section_counts`."""
    return tuple(
        DepthCount(model.grid.step_deg, k, int(np.count_nonzero(counts >= k)), model.n_elements)
        for k in range(1, max_views + 1)
    )
