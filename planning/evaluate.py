"""What a set of viewpoints covers on a site, by the definition in float64, as it stands in plan files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel, exact_coverage, exact_sections
from planning.coverage.sections import NOT_SEEN
from planning.plan import Coverage, Viewpoint, viewpoint_arrays
from planning.reach_kernel import UNREACHABLE
from planning.reachability import Reachability


@dataclass(frozen=True, slots=True)
class DepthCount:
    """Sections of `step_deg` that at least `n_views` views cover, and all there are."""

    step_deg: float
    n_views: int
    covered: int
    total: int


def coverage_counts(model: CoverageModel, viewpoints: Sequence[Viewpoint]) -> NDArray[np.int64]:
    """Number of viewpoints that cover each section, shape (m, n_sections)."""
    return exact_coverage(model, viewpoint_arrays(tuple(viewpoints)))


def coverage(model: CoverageModel, viewpoints: Sequence[Viewpoint], reachability: Reachability) -> Coverage:
    """Covered sections beside the bound on what is reachable.

    Viewpoints of other programs may break the rules that the bound rests on (stand too close, leave the airspace);
    sections that such a viewpoint covers count as reachable.
    """
    covered = coverage_counts(model, viewpoints) > 0
    bound = covered | (reachability.verdicts != UNREACHABLE)
    return Coverage(int(covered.sum()), model.n_elements, int(bound.sum()))


def depth(model: CoverageModel, viewpoints: Sequence[Viewpoint], max_views: int = 4) -> tuple[DepthCount, ...]:
    """How many sections are covered once, twice and so on up to `max_views` times."""
    counts = coverage_counts(model, viewpoints)
    return tuple(
        DepthCount(model.grid.step_deg, k, int(np.count_nonzero(counts >= k)), model.n_elements)
        for k in range(1, max_views + 1)
    )


def nearest_panel_m(model: CoverageModel, viewpoints: Sequence[Viewpoint]) -> NDArray[np.float64]:
    """Distance of each viewpoint to the nearest centroid of the panels it covers, shape (n,); inf where none."""
    positions = viewpoint_arrays(tuple(viewpoints)).positions_enu_m
    view, panel = np.nonzero(exact_sections(model, viewpoint_arrays(tuple(viewpoints))) != NOT_SEEN)
    nearest = np.full(len(positions), np.inf)
    np.minimum.at(nearest, view, np.linalg.norm(positions[view] - model.frames.centroids[panel], axis=1))
    return nearest


def ground_sampling_m(model: CoverageModel, viewpoints: Sequence[Viewpoint]) -> tuple[float, float]:
    """Best and worst ground sampling distance, metres per pixel, of all panels in all views that cover them.

    Measured across the line of sight at the centroid; on the pane itself it is larger by 1 / cos(theta) in one
    direction. (inf, 0) when nothing is covered.
    """
    views = viewpoint_arrays(tuple(viewpoints))
    view, panel = np.nonzero(exact_sections(model, views) != NOT_SEEN)
    if len(view) == 0:
        return np.inf, 0.0
    distances = np.linalg.norm(views.positions_enu_m[view] - model.frames.centroids[panel], axis=1)
    return model.camera.gsd_m(float(distances.min())), model.camera.gsd_m(float(distances.max()))
