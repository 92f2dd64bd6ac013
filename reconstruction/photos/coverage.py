"""What photos really show: hemisphere sections of panels by the plan's own definition, seen by the real cameras.

A section counts as in the plan (`planning.coverage.sections`), except that the picture is that of the real camera: with
its roll, its principal point and its distortion. For a camera as planned both are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import CoverageModel, exact_sections
from planning.coverage.sections import NOT_SEEN, sections_of
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from planning.plan import Viewpoint, viewpoint_arrays
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

CHUNK = 64
"""Photos between two reports of progress."""


@dataclass(frozen=True, slots=True, eq=False)
class AchievedCoverage:
    """Sections that photos show, against those that the plan promised.

    Parameters
    ----------
    sections
        Shape (n, m): the section of each of m panels that each of n photos shows, `NOT_SEEN` for none.
    counts, planned_counts
        Shape (m, n_sections): photos that show each section, and planned views that would; the latter is None without
        a plan.
    """

    sections: NDArray[np.int64]
    counts: NDArray[np.int64]
    planned_counts: NDArray[np.int64] | None
    findings: tuple[Finding, ...]

    @property
    def covered(self) -> int:
        """Sections that at least one photo shows."""
        return int(np.count_nonzero(self.counts))

    @property
    def missed(self) -> NDArray[np.bool_]:
        """Whether the plan promised a section that no photo shows, shape (m, n_sections)."""
        if self.planned_counts is None:
            return np.zeros(self.counts.shape, np.bool_)
        return np.asarray((self.planned_counts > 0) & (self.counts == 0))

    @property
    def unseen_panels(self) -> NDArray[np.int64]:
        """Indices of panels that no photo shows from anywhere."""
        return np.flatnonzero(self.counts.sum(axis=1) == 0)


def achieved_coverage(
    model: CoverageModel,
    photos: Sequence[PosedPhoto],
    planned: Sequence[Viewpoint] = (),
    panel_ids: Sequence[str] = (),
    monitor: Monitor = QUIET,
) -> AchievedCoverage:
    """Coverage of photos.

    Parameters
    ----------
    model
        That of the plan: occlusion, whole panels and largest distance count as they did there. Its camera is used for
        the planned views only.
    planned
        The plan's views; none where there is no plan.
    panel_ids
        Names of the panels, for findings.
    """
    sections = photo_sections(model, photos, monitor)
    counts = _counts(sections, model.grid.n_sections)
    planned_counts = None
    if planned:
        planned_counts = _counts(exact_sections(model, viewpoint_arrays(tuple(planned))), model.grid.n_sections)
    findings = _findings(counts, planned_counts, panel_ids)
    return AchievedCoverage(sections, counts, planned_counts, findings)


def photo_sections(model: CoverageModel, photos: Sequence[PosedPhoto], monitor: Monitor = QUIET) -> NDArray[np.int64]:
    """Section of each panel that each photo shows, shape (n, m), `NOT_SEEN` for none."""
    frames = model.frames
    found = np.full((len(photos), len(frames)), NOT_SEEN, np.int64)
    for index, photo in enumerate(photos):
        if index % CHUNK == 0:
            monitor.report(say("coverage of the photos"), index, len(photos))
        seen = photo.sees(frames.centroids)
        if model.whole_panel:
            seen &= photo.sees(frames.corners.reshape(-1, 3)).reshape(len(frames), -1).all(axis=1)
        if model.max_distance_m is not None:
            away_m = np.linalg.norm(frames.centroids - photo.pose.position_enu_m, axis=1)
            seen &= away_m <= model.max_distance_m
        section = sections_of(photo.pose.position_enu_m[None], frames, model.grid)[0]
        found[index] = np.where(seen, section, NOT_SEEN)
    if model.sight is not None:
        photo_index, panel = np.nonzero(found != NOT_SEEN)
        places = np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3)
        free = model.sight(places[photo_index], model.targets_enu_m[panel])
        found[photo_index[~free], panel[~free]] = NOT_SEEN
    return found


def distances_m(model: CoverageModel, photos: Sequence[PosedPhoto]) -> list[float | None]:
    """Distance from each photo to the nearest panel in its picture; None where it shows none."""
    found: list[float | None] = []
    for photo in photos:
        seen = photo.sees(model.frames.centroids)
        away_m = np.linalg.norm(model.frames.centroids[seen] - photo.pose.position_enu_m, axis=1)
        found.append(float(away_m.min()) if len(away_m) else None)
    return found


def distances_to_building_m(building: TriangleMesh, photos: Sequence[PosedPhoto]) -> list[float | None]:
    """Distance from each photo to a building, straight ahead; None where it looks past it."""
    places = np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3)
    ahead = np.array([photo.pose.forward_enu for photo in photos]).reshape(-1, 3)
    hits = RayCaster(building).cast(places, ahead)
    return [float(m) if hit else None for m, hit in zip(hits.distance_m, hits.is_hit, strict=True)]


def _counts(sections: NDArray[np.int64], n_sections: int) -> NDArray[np.int64]:
    view, panel = np.nonzero(sections != NOT_SEEN)
    elements = panel * n_sections + sections[view, panel]
    m = sections.shape[1]
    return np.bincount(elements, minlength=m * n_sections).reshape(m, n_sections)


def _findings(
    counts: NDArray[np.int64], planned: NDArray[np.int64] | None, panel_ids: Sequence[str]
) -> tuple[Finding, ...]:
    """What is missing, by panel, before the batteries are packed."""
    findings = []
    unseen = np.flatnonzero(counts.sum(axis=1) == 0)
    promised = np.arange(len(counts)) if planned is None else np.flatnonzero(planned.sum(axis=1) > 0)
    for panel in np.intersect1d(unseen, promised).tolist():
        name = panel_ids[panel] if panel_ids else str(panel)
        findings.append(
            Finding(Severity.WARNING, "panel-not-photographed", say("no photo shows panel '{}'", name), name, 0.0)
        )
    if planned is not None:
        n_missed = int(((planned > 0) & (counts == 0)).sum())
        n_planned = int((planned > 0).sum())
        severity = Severity.WARNING if n_missed else Severity.OK
        text = say("{} of the {} sections that the plan promised are on no photo", n_missed, n_planned)
        findings.append(Finding(severity, "sections-missed", text, "", float(n_missed), 0.0, "sections"))
    return tuple(findings)
