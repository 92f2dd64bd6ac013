"""What a plan covers, section by section: which views see what, what is missed, and what nobody can see."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import exact_sections
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid
from planning.insight.reasons import SectionReasons
from planning.insight.sampling import PanelSampling, panel_sampling
from planning.parameters import Constraints
from planning.plan import Camera, Plan, viewpoint_arrays
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared


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


def plan_insight(
    site_model: SiteModel, prepared: Prepared, plan: Plan, reasons: SectionReasons, monitor: Monitor = QUIET
) -> PlanInsight:
    """What a plan covers on a prepared site, seen with the prepared camera under the prepared constraints.

    Parameters
    ----------
    reasons
        Of the same prepared site (`planning.insight.reasons.section_reasons`); they do not depend on the plan.
    """
    model, verdicts = prepared.problem.model, prepared.problem.reachability.verdicts
    if reasons.shape != verdicts.shape:
        raise ValueError(f"reasons: expected those of this site, shape {verdicts.shape}, got {reasons.shape}")
    monitor.report(say("counting what each view covers"), 0, 1)
    views = viewpoint_arrays(plan.viewpoints)
    sections = exact_sections(model, views)
    counts = section_counts(sections, model.grid.n_sections)
    sampling = panel_sampling(model.frames, model.camera, views.positions_enu_m, sections)
    return assembled(site_model, prepared, plan, sections.astype(np.int16), counts, sampling, reasons)


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
