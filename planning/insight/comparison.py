"""Two or more plans on one site side by side: a table, and which sections each covers that others do not.

All plans are held to one definition of coverage: the prepared site's, whatever each was planned under. Each keeps its
own camera. Sections count as reachable unless they are proven unreachable and no plan compared covers them, so that
shares of different plans have one denominator. Times and lengths are those that the plans state; findings are those of
each plan's own check.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.base.progress import QUIET, Monitor
from planning.checks import check_plan
from planning.coverage.model import exact_sections
from planning.coverage.reach_kernel import UNREACHABLE
from planning.insight.clearance import route_clearance
from planning.insight.obstructions import obstructions_of
from planning.insight.sections import PanelSampling, panel_sampling, section_counts
from planning.parameters import Constraints
from planning.plan import Plan, viewpoint_arrays
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared

MAX_DEPTH = 4
"""Sections are counted that are covered at least twice, and so on up to this often."""

CONSTRAINT_WORDS = {
    "min_distance_m": say("minimum distance (m)"),
    "section_step_deg": say("section step (degrees)"),
    "occlusion": "occlusion",
    "whole_panel": say("whole panels only"),
    "max_distance_m": say("largest distance (m)"),
    "wanted_gsd_mm": say("pixel of sharp views (mm)"),
}


class Better(StrEnum):
    """Which end of a row's values is the better one."""

    HIGHER = "higher"
    LOWER = "lower"
    NEITHER = "neither"


@dataclass(frozen=True, slots=True)
class Row:
    """One measure of every plan.

    Parameters
    ----------
    code
        Stable name, in kebab case.
    label
        The same in words; rows about one facade or depth name it.
    unit
        `m`, `m/px`, `s`, `share` (0 to 1) or empty for counts.
    values
        One a plan; None where it is not known.
    subject
        Facade, severity or number of views that the row is about, else empty.
    """

    code: str
    label: str
    unit: str
    better: Better
    values: tuple[float | None, ...]
    subject: str = ""

    @property
    def best(self) -> tuple[int, ...]:
        """Numbers of the plans with the better value; none where all are equal or neither end is better."""
        known = [value for value in self.values if value is not None]
        if self.better is Better.NEITHER or len(set(known)) < 2:
            return ()
        wanted = max(known) if self.better is Better.HIGHER else min(known)
        return tuple(number for number, value in enumerate(self.values) if value == wanted)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Plans beside each other: p plans, m panels, s sections a panel.

    Parameters
    ----------
    names
        Of the plans.
    constraints
        Under which all were evaluated, occlusion decided.
    notes
        What is not alike between the plans and how it was dealt with, for the reader of the table.
    rows
        The table.
    counts
        Number of each plan's views that cover each section, shape (p, m, s), int32.
    is_possible
        Sections that count as reachable, shape (m, s).
    sampling
        Ground sampling distances of the panels, one a plan.
    findings
        Of each plan's check.
    """

    names: tuple[str, ...]
    constraints: Constraints
    notes: tuple[str, ...]
    rows: tuple[Row, ...]
    counts: NDArray[np.int32]
    is_possible: NDArray[np.bool_]
    sampling: tuple[PanelSampling, ...]
    findings: tuple[tuple[Finding, ...], ...]

    def more_covered_per_panel(self, first: int, second: int) -> NDArray[np.int64]:
        """How many more sections of each panel the first of two plans covers, shape (m,); negative: fewer."""
        covered = np.count_nonzero(self.counts > 0, axis=2)
        return np.asarray(covered[first] - covered[second])


def compare_plans(
    site_model: SiteModel, prepared: Prepared, plans: Sequence[Plan], names: Sequence[str], monitor: Monitor = QUIET
) -> Comparison:
    """Compare plans under the constraints of the prepared site."""
    if len(plans) < 2 or len(plans) != len(names):
        raise ValueError(f"expected two plans or more and a name for each, got {len(plans)} and {len(names)} names")
    model, verdicts = prepared.problem.model, prepared.problem.reachability.verdicts
    counts, sampling, findings = [], [], []
    for number, plan in enumerate(plans):
        monitor.report(say("comparing plans"), number, len(plans))
        views = viewpoint_arrays(plan.viewpoints)
        sections = exact_sections(replace(model, camera=plan.camera), views)
        counts.append(section_counts(sections, model.grid.n_sections))
        sampling.append(panel_sampling(model.frames, plan.camera, views.positions_enu_m, sections))
        findings.append(check_plan(plan, site_model, monitor))
    all_counts = np.stack(counts)
    is_possible = (verdicts != UNREACHABLE) | (all_counts > 0).any(axis=0)
    rows = (
        *_effort_rows(plans),
        *_coverage_rows(site_model, all_counts, is_possible),
        *_quality_rows(site_model, prepared, plans, sampling),
        *_finding_rows(findings),
    )
    notes = tuple(_notes(prepared.constraints, plans, names))
    return Comparison(
        tuple(names), prepared.constraints, notes, rows, all_counts, is_possible, tuple(sampling), tuple(findings)
    )


def _effort_rows(plans: Sequence[Plan]) -> Iterator[Row]:
    yield Row("views", "views", "", Better.LOWER, tuple(float(len(plan.viewpoints)) for plan in plans))
    yield Row("sorties", "sorties", "", Better.LOWER, tuple(float(len(plan.sorties)) for plan in plans))
    yield Row("duration", say("time in the air"), "s", Better.LOWER, tuple(plan.duration_s for plan in plans))
    lengths = tuple(sum(sortie.length_m for sortie in plan.sorties) for plan in plans)
    yield Row("length", say("distance"), "m", Better.LOWER, lengths)
    found = tuple(plan.history[-1].t_s if plan.history else None for plan in plans)
    yield Row("found-after", say("views found after"), "s", Better.LOWER, found)


def _coverage_rows(site_model: SiteModel, counts: NDArray[np.int32], is_possible: NDArray[np.bool_]) -> Iterator[Row]:
    covered = counts > 0
    totals = covered.sum(axis=(1, 2))
    yield Row("covered", say("sections covered"), "", Better.HIGHER, _floats(totals))
    yield Row("covered-share", say("of all sections"), "share", Better.HIGHER, _floats(totals / is_possible.size))
    possible = max(int(is_possible.sum()), 1)
    yield Row("possible-share", say("of what can be covered"), "share", Better.HIGHER, _floats(totals / possible))
    facades = site_model.site.facades
    last = np.cumsum([len(facade.panels) for facade in facades])
    for facade, stop in zip(facades, last, strict=True):
        part = slice(stop - len(facade.panels), stop)
        possible = max(int(is_possible[part].sum()), 1)
        shares = covered[:, part].sum(axis=(1, 2)) / possible
        label = say("facade {}, of what can be covered", facade.id)
        yield Row("facade-share", label, "share", Better.HIGHER, _floats(shares), facade.id)
    alone = covered & (covered.sum(axis=0) == 1)
    yield Row("only-here", say("sections no other plan covers"), "", Better.HIGHER, _floats(alone.sum(axis=(1, 2))))
    for times in range(2, MAX_DEPTH + 1):
        deep = (counts >= times).sum(axis=(1, 2))
        yield Row("depth", say("covered at least {} times", times), "", Better.HIGHER, _floats(deep), str(times))


def _quality_rows(
    site_model: SiteModel, prepared: Prepared, plans: Sequence[Plan], sampling: Sequence[PanelSampling]
) -> Iterator[Row]:
    best = tuple(_extreme(found.best_m, np.fmin) for found in sampling)
    worst = tuple(_extreme(found.worst_m, np.fmax) for found in sampling)
    # The finest pixel on the panel that fares worst tells how sharp the model can become everywhere.
    coarsest = tuple(_extreme(found.best_m, np.fmax) for found in sampling)
    yield Row("gsd-best", say("finest pixel"), "m/px", Better.LOWER, best)
    yield Row("gsd-worst", say("coarsest pixel"), "m/px", Better.LOWER, worst)
    yield Row("gsd-worst-panel", say("finest pixel on the worst panel"), "m/px", Better.LOWER, coarsest)
    space = prepared.problem.space
    obstructions = obstructions_of(site_model, space)
    smallest: list[float | None] = []
    for plan in plans:
        on_way = [route_clearance(sortie, space, obstructions).solids.clearance_m for sortie in plan.sorties]
        smallest.append(_extreme(np.concatenate([*on_way, np.zeros(0)]), np.fmin))
    yield Row("clearance", say("smallest clearance"), "m", Better.HIGHER, tuple(smallest))


def _finding_rows(findings: Sequence[tuple[Finding, ...]]) -> Iterator[Row]:
    tallies = [Counter(finding.severity for finding in found) for found in findings]
    for severity in (Severity.ERROR, Severity.WARNING, Severity.NOTE):
        counts = tuple(float(tally[severity]) for tally in tallies)
        yield Row("findings", say("findings: {}", str(severity)), "", Better.LOWER, counts, str(severity))


def _floats(values: NDArray[np.generic]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _extreme(values: NDArray[np.float64], choose: np.ufunc) -> float | None:
    """Least or greatest of the values that are known."""
    known = values[np.isfinite(values)]
    return float(choose.reduce(known)) if len(known) else None


def _notes(constraints: Constraints, plans: Sequence[Plan], names: Sequence[str]) -> Iterator[str]:
    for plan, name in zip(plans, names, strict=True):
        own = plan.constraints
        if own.occlusion == "auto":
            own = replace(own, occlusion=constraints.occlusion)
        unlike = [
            say(f"{words} {{}} instead of {{}}", getattr(own, field), getattr(constraints, field))
            for field, words in CONSTRAINT_WORDS.items()
            if getattr(own, field) != getattr(constraints, field)
        ]
        if unlike:
            yield say("{} was made for other constraints ({}); what it states may differ", name, joined("; ", unlike))
    cameras = {plan.camera.name for plan in plans}
    if len(cameras) > 1:
        yield say("the cameras differ: each plan is seen with its own, what can be covered is that of the first")
