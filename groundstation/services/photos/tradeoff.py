"""What accuracy costs in time when panels are searched for: one facade, searched in other ways than it was."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from groundstation.services.photos.found_panels import PanelDraft
from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from planning.photos.record import PhotoMetadata
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid
from reconstruction.panels.segment import segment_view
from reconstruction.panels.solving.record import SolvedFacade, SurfaceLine
from reconstruction.panels.solving.solve import solve_facade
from reconstruction.photos.decode import colour_picture

SCALES_PX = (400, 800, 1600, 3200, 5280)
"""Longest sides of the rectified picture that are tried; those beyond the photos' own are left out."""

Knob = Literal["scale", "photos"]


@dataclass(frozen=True, slots=True)
class Trial:
    """One way of searching.

    Parameters
    ----------
    knob, value
        What was turned, and to where: pixels of the rectified picture's longer side, or photos that were used.
    seconds
        That the search took, without reading the photos.
    n_panels
        That were found; 0 where there was no grid.
    sigma_m
        Usual standard deviation of a corner in space; None where there is none.
    """

    knob: Knob
    value: int
    seconds: float
    n_panels: int
    sigma_m: float | None


def facade_trials(
    draft: PanelDraft,
    metadata: Sequence[PhotoMetadata],
    facade_id: str,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> tuple[Trial, ...]:
    """Search a facade's photos at several scales with all photos, then at the finest with fewer of them.

    Raises
    ------
    InputError
        A photo cannot be read any more.
    """
    facade = draft.facade(facade_id)
    views = _views(draft, facade)
    by_path = {data.path: data for data in metadata}
    longest = max(max(view.width_px, view.height_px) for view in views.values())
    scales = [scale for scale in SCALES_PX if scale < longest]
    scales.append(min(longest, SCALES_PX[-1]))
    grids: dict[int, dict[int, FacadeGrid]] = {scale: {} for scale in scales}
    spent_s: dict[int, dict[int, float]] = {scale: {} for scale in scales}
    n_steps = len(views) * len(scales)
    for done, (number, view) in enumerate(views.items()):
        # One photo at a time: several of 20 megapixels would fill the memory for nothing.
        image = colour_picture(by_path[draft.photos[number].path])
        if done == 0:
            # The first search of a process loads the compiled kernels, which is no part of any scale's time.
            segment_view(image, view, _parameters(scales[0]), monitor, facade_id)
        for step, scale in enumerate(scales):
            monitor.report(say("trying scales"), done * len(scales) + step, n_steps)
            started = clock()
            grids[scale][number] = segment_view(image, view, _parameters(scale), QUIET, facade_id)
            spent_s[scale][number] = clock() - started
    trials = [_trial(draft, facade_id, "scale", s, grids[s], sum(spent_s[s].values())) for s in dict.fromkeys(scales)]
    finest, order = scales[-1], list(views)
    for n in range(1, len(order)):
        some = {number: grids[finest][number] for number in order[:n]}
        trials.append(_trial(draft, facade_id, "photos", n, some, sum(spent_s[finest][k] for k in some)))
    whole = next(trial for trial in trials if trial.value == finest)
    return (*trials, replace(whole, knob="photos", value=len(order)))


def corner_sigma_m(facade: SolvedFacade) -> float | None:
    """Usual standard deviation of a corner's place in space; None for a facade without panels."""
    traces = [np.trace(panel.covariance_m2, axis1=1, axis2=2) for panel in facade.panels]
    return float(np.sqrt(max(0.0, float(np.median(traces))))) if traces else None


def _parameters(scale_px: int) -> SegmentationParameters:
    usual = SegmentationParameters()
    return replace(usual, long_side_px=min(usual.long_side_px, scale_px), refined_long_side_px=scale_px)


def _views(draft: PanelDraft, facade: SolvedFacade) -> dict[int, SurfaceView]:
    """Views of the facade and of one panel's breadth around it, by the photo's number."""
    (left, right), (low, high) = _extent(facade.columns), _extent(facade.rows)
    surface = draft.found.fits[facade.id].surface
    return {
        place.photo: surface_view(draft.photos[place.photo], surface, np.array([left, low]), np.array([right, high]))
        for place in draft.places()
        if place.facade == facade.id
    }


def _extent(lines: Sequence[SurfaceLine]) -> tuple[float, float]:
    first, last = lines[0].position_m, lines[-1].position_m
    step = (last - first) / max(1, len(lines) - 1)
    return first - step, last + step


def _trial(
    draft: PanelDraft, facade_id: str, knob: Knob, value: int, grids: dict[int, FacadeGrid], seconds: float
) -> Trial:
    try:
        facade = solve_facade(facade_id, draft.photos, grids, draft.found.fits[facade_id])
    except InfeasibleError:
        return Trial(knob, value, seconds, 0, None)
    return Trial(knob, value, seconds, len(facade.panels), corner_sigma_m(facade))
