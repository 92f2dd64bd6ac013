"""What a plan covers, section by section: which views see what, how large its pixels are, what nobody can see."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid
from planning.insight.reasons import SectionReasons
from planning.parameters import Constraints
from planning.plan import Camera, Plan
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared

Array = NDArray[np.float64]


# Pixel sizes: ground sampling distance of every panel in the views that cover it.

Ints = NDArray[np.int64]

SMALLEST = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, slots=True, eq=False)
class PanelSampling:
    """Ground sampling distance at each panel's centroid, metres per pixel, shape (m,); NaN where no view covers it.

    Parameters
    ----------
    best_m, worst_m
        Across the line of sight: distance times the angle of a pixel.
    best_on_pane_m, worst_on_pane_m
        On the pane, in the direction in which it is seen foreshortened: larger by 1 / cos(theta). The best view here
        need not be the best across the line of sight.
    """

    best_m: Array
    worst_m: Array
    best_on_pane_m: Array
    worst_on_pane_m: Array


def panel_sampling(
    frames: PanelFrames,
    camera: Camera,
    positions_enu_m: Array,
    sections: NDArray[np.integer],
    panels: Ints | None = None,
) -> PanelSampling:
    """Sampling of all panels, or of some.

    Parameters
    ----------
    positions_enu_m
        Of the views, shape (n, 3).
    sections
        Section of each panel that each view covers, shape (n, m), `NOT_SEEN` for none.
    panels
        Numbers of the panels wanted, shape (k,): the result has as many. None for all.
    """
    if panels is None:
        panels = np.arange(len(frames))
    found = np.full((4, len(panels)), np.nan)
    _extremes(
        np.ascontiguousarray(positions_enu_m),
        np.ascontiguousarray(sections, np.int16),
        panels,
        frames.centroids,
        frames.normals,
        camera.pixel_angle_rad,
        found,
    )
    return PanelSampling(*found)


@kernel
def _extremes(
    positions_enu_m: Array,
    sections: NDArray[np.int16],
    panels: Ints,
    centroids: Array,
    normals: Array,
    pixel_angle_rad: float,
    found: Array,
) -> None:
    """Least and greatest sampling of each panel, put into `found`, shape (4, k), as `PanelSampling` has them."""
    for view in range(len(positions_enu_m)):
        for place in range(len(panels)):
            panel = panels[place]
            if sections[view, panel] == NOT_SEEN:
                continue
            squared, along = 0.0, 0.0
            for axis in range(3):
                ray = positions_enu_m[view, axis] - centroids[panel, axis]
                squared += ray * ray
                along += ray * normals[panel, axis]
            distance = np.sqrt(squared)
            across_m = distance * pixel_angle_rad
            # Covered means theta < 90 degrees, so the height above the pane is positive, though it may be tiny.
            on_pane_m = across_m * distance / max(along, SMALLEST)
            # Unlike `<`, these take a number rather than the NaN that stands there first.
            found[0, place] = np.fmin(found[0, place], across_m)
            found[1, place] = np.fmax(found[1, place], across_m)
            found[2, place] = np.fmin(found[2, place], on_pane_m)
            found[3, place] = np.fmax(found[3, place], on_pane_m)


# Shapes of hemisphere sections for drawing: on the unit hemisphere, in ENU, and on a flat disc.
#
# The panel's frame has the axes t, b, n (`planning.coverage.sections`): seen from outside, t points to the right and b
# up; where the panel faces the sky, t points east and b north.

STEPS_PER_SIDE = 4
"""A side of 30 degrees is drawn as four chords, which leave the arc by 0.2 % of the radius."""


@dataclass(frozen=True, slots=True, eq=False)
class SectionShapes:
    """Every section of one hemisphere, n_sections = s, in the order of section numbers.

    Parameters
    ----------
    ring, sector
        Shape (s,), from 0: rings from the pole to the horizon, sectors from t towards b.
    directions_panel
        Unit vectors to the middle of both angles, shape (s, 3), axes t, b, n.
    outlines_panel
        Unit vectors around each section, counter-clockwise seen from outside, not closed: shape (s, k, 3), axes t, b,
        n. Sections at the pole have one side of no length.
    outlines_disc
        The same points on a flat picture, shape (s, k, 2): x right (t), y up (b), radius theta / 90 degrees, so that
        rings are equally wide and the rim is the panel's plane.
    """

    ring: NDArray[np.int64]
    sector: NDArray[np.int64]
    directions_panel: Array
    outlines_panel: Array
    outlines_disc: Array


def section_shapes(grid: SectionGrid, steps_per_side: int = STEPS_PER_SIDE) -> SectionShapes:
    """Shapes of all sections; outlines have k = 4 `steps_per_side` points."""
    if steps_per_side < 1:
        raise ValueError(f"steps_per_side: expected 1 or more, got {steps_per_side}")
    step_rad = np.radians(grid.step_deg)
    ring, sector = np.divmod(np.arange(grid.n_sections), grid.n_sectors)
    rise = np.arange(steps_per_side) / steps_per_side
    low, high = np.zeros(steps_per_side), np.ones(steps_per_side)
    # Outwards, on along the outer arc, back inwards, and back along the inner arc.
    theta = (ring[:, None] + np.concatenate([rise, high, 1.0 - rise, low])) * step_rad
    phi = (sector[:, None] + np.concatenate([low, rise, high, 1.0 - rise])) * step_rad
    radius = theta / (0.5 * np.pi)
    return SectionShapes(
        ring,
        sector,
        _unit_vectors((ring + 0.5) * step_rad, (sector + 0.5) * step_rad),
        _unit_vectors(theta, phi),
        np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=-1),
    )


def _unit_vectors(theta_rad: Array, phi_rad: Array) -> Array:
    across = np.sin(theta_rad)
    return np.stack([across * np.cos(phi_rad), across * np.sin(phi_rad), np.cos(theta_rad)], axis=-1)


def in_enu(vectors_panel: Array, frames: PanelFrames, panels: NDArray[np.int64]) -> Array:
    """Vectors of the panel frame, shape (..., 3), in ENU for each panel asked for: shape (len(panels), ..., 3)."""
    enu_from_panel = np.stack([frames.tangents[panels], frames.bitangents[panels], frames.normals[panels]], axis=1)
    turned = vectors_panel.reshape(-1, 3) @ enu_from_panel
    return turned.reshape(len(panels), *vectors_panel.shape)


class SectionState(IntEnum):
    """Where a section stands."""

    UNREACHABLE = 0
    """Proven: no allowed viewpoint can cover it."""
    UNDECIDED = 1
    """Not covered, and neither a viewpoint that would nor a proof that there is none is known."""
    MISSED = 2
    """Some allowed viewpoint covers it, but none of the plan does."""
    COVERED = 3
    """By at least one view of the plan, be that view allowed or not."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanInsight:
    """A plan's coverage, ready to be drawn. n views, m panels, s sections a panel.

    Parameters
    ----------
    view_ids, panel_ids
        Names of rows and columns, as in the plan and the site.
    constraints, camera
        Under which it was evaluated, occlusion decided.
    frames, grid
        Panels, and sections of their hemispheres.
    sections
        Section of each panel that each view covers, by the definition in float64: shape (n, m), int16, -1 for none.
    counts
        Number of views that cover each section, shape (m, s), int32.
    states
        `SectionState` of each section, shape (m, s), int8.
    sampling
        Ground sampling distances of the panels.
    reasons
        Why sections are unreachable.
    """

    view_ids: tuple[str, ...]
    panel_ids: tuple[str, ...]
    constraints: Constraints
    camera: Camera
    frames: PanelFrames
    grid: SectionGrid
    sections: NDArray[np.int16]
    counts: NDArray[np.int32]
    states: NDArray[np.int8]
    sampling: PanelSampling
    reasons: SectionReasons

    def views_of(self, panel: int, section: int) -> NDArray[np.int64]:
        """Numbers of the views that cover a section, rising."""
        return np.flatnonzero(self.sections[:, panel] == section)

    def state(self, panel: int, section: int) -> SectionState:
        """Where one section stands."""
        return SectionState(int(self.states[panel, section]))

    @property
    def panels_per_view(self) -> NDArray[np.int64]:
        """Number of panels that each view covers, shape (n,)."""
        return np.asarray(np.count_nonzero(self.sections != NOT_SEEN, axis=1))

    @property
    def covered_per_panel(self) -> NDArray[np.int64]:
        """Covered sections of each panel, shape (m,)."""
        return np.asarray(np.count_nonzero(self.states == SectionState.COVERED, axis=1))

    @property
    def possible_per_panel(self) -> NDArray[np.int64]:
        """Sections of each panel that are covered or not proven unreachable, shape (m,)."""
        return np.asarray(np.count_nonzero(self.states != SectionState.UNREACHABLE, axis=1))

    @property
    def share_per_panel(self) -> NDArray[np.float64]:
        """Covered share of what is possible, 0 to 1, shape (m,); NaN for panels that nobody can see."""
        possible = self.possible_per_panel
        return np.where(possible > 0, self.covered_per_panel / np.maximum(possible, 1), np.nan)


def assembled(
    site_model: SiteModel,
    prepared: Prepared,
    plan: Plan,
    sections: NDArray[np.int16],
    counts: NDArray[np.int32],
    sampling: PanelSampling,
    reasons: SectionReasons,
) -> PlanInsight:
    """An insight from what was measured on a plan; see `PlanInsight`."""
    model = prepared.problem.model
    return PlanInsight(
        tuple(viewpoint.id for viewpoint in plan.viewpoints),
        tuple(panel.id for panel in site_model.site.panels),
        prepared.constraints,
        model.camera,
        model.frames,
        model.grid,
        sections,
        counts,
        section_states(counts, prepared.problem.reachability.verdicts),
        sampling,
        reasons,
    )


def section_counts(sections: NDArray[np.integer], n_sections: int) -> NDArray[np.int32]:
    """Number of views that cover each section, shape (m, n_sections), from their sections, shape (n, m)."""
    m = sections.shape[1]
    view, panel = np.nonzero(sections != NOT_SEEN)
    elements = panel * n_sections + sections[view, panel]
    return np.bincount(elements, minlength=m * n_sections).reshape(m, n_sections).astype(np.int32)


def section_states(counts: NDArray[np.int32], verdicts: NDArray[np.int8]) -> NDArray[np.int8]:
    """`SectionState` of each section, from counts and verdicts of shape (m, n_sections).

    Viewpoints of other programs may break the rules that a proof rests on: what they cover counts as covered.
    """
    states = np.full(counts.shape, SectionState.UNDECIDED, np.int8)
    states[verdicts == REACHABLE] = SectionState.MISSED
    states[verdicts == UNREACHABLE] = SectionState.UNREACHABLE
    states[counts > 0] = SectionState.COVERED
    return states
