"""Use case on site, before leaving: what the photos on the card are worth, and what they really show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.photos.poses import BetterPoses, RefineRequest, better_poses, refined_summary, still_true
from groundstation.services.project.input_files import read_given_plan, read_given_site
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import CoverageModel
from planning.parameters import DEFAULT_PROFILE, Constraints
from planning.photos.folder import read_photos
from planning.photos.places import PhotoHeights
from planning.photos.record import PhotoMetadata
from planning.plan import Plan
from planning.site.free_space import unchecked_space
from planning.site.records import Site, SiteModel, require_panels
from planning.viewpoints.prepare import coverage_model, decide_occlusion
from reconstruction.base.cameras import PosedPhoto
from reconstruction.photos.coverage import AchievedCoverage, achieved_coverage, distances_m, distances_to_building_m
from reconstruction.photos.poses import PhotoSet, pose_photos
from reconstruction.photos.quality import QualityLimits, QualityReport, check_quality

NO_PANELS = "no-panels"
"""Code of the finding that says why nothing is said of coverage."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoIntake:
    """Photos with poses, their quality, and the coverage that they achieve, where there are panels to cover.

    Parameters
    ----------
    quality
        Of `photos`, in their order.
    coverage, occlusion, counted
        What the photos show, and what counts as shown; None on a site without panels.
    usable
        Which of them count: those that could be decoded.
    metadata
        Of all photos that could be read, in the order of time, with a pose or without.
    posed
        Photos with the poses that their metadata give.
    better
        Where the poses of `photos` are from.
    folder
        What the photos' names are paths below.
    """

    photos: tuple[PosedPhoto, ...]
    quality: QualityReport
    coverage: AchievedCoverage | None
    occlusion: Decision | None
    usable: tuple[bool, ...]
    metadata: tuple[PhotoMetadata, ...]
    findings: tuple[Finding, ...]
    counted: CoverageModel | None
    posed: PhotoSet
    better: BetterPoses
    folder: Path


def take_in(
    folder: Path,
    site: Path,
    plan: Path | None = None,
    limits: QualityLimits | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> PhotoIntake:
    """Read a folder of photos over a site file, and a plan file where one was flown; see `take_in_photos`.

    Raises
    ------
    InputError
        As `take_in_photos`, or a plan is given for a site without panels.
    """
    model = read_given_site(site)
    flown = None if plan is None else read_given_plan(plan)
    if flown is not None:
        require_panels(model.site)
    return take_in_photos(folder, model, flown, limits, heights=heights, colmap=colmap, refine=refine, monitor=monitor)


def take_in_photos(
    folder: Path,
    model: SiteModel,
    flown: Plan | None = None,
    limits: QualityLimits | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> PhotoIntake:
    """Read a folder of photos over a site.

    Parameters
    ----------
    flown
        Plan that was flown: the coverage counts as it did there, and what it promised is compared. Nothing is counted
        on a site without panels.

    Raises
    ------
    InputError
        Photos, site, plan or COLMAP model cannot be used, or poses cannot be refined.
    ReconstructionError
        Poses are to be refined, and the photos do not fit together.
    """
    read = read_photos(folder, monitor)
    posed = pose_photos(read.photos, model.site, folder, heights=heights)
    better = better_poses(posed, folder, colmap, refine, monitor)
    photos = better.photos
    metadata = {photo.name: data for photo, data in zip(posed.photos, posed.metadata, strict=True)}
    counted, occlusion = _coverage_model(model, flown) if model.site.n_panels else (None, None)
    ahead_m = distances_to_building_m(model.building, photos) if counted is None else distances_m(counted, photos)
    quality = check_quality(
        [metadata[photo.name] for photo in photos], photos, ahead_m, limits or QualityLimits(), monitor
    )
    usable = tuple(found is not None for found in quality.photos)
    coverage = None if counted is None else _achieved(counted, photos, usable, model, flown, monitor)
    text = say("the site has no panels yet, so nothing is said of what the photos show of them")
    shown = (Finding(Severity.NOTE, NO_PANELS, text),) if coverage is None else coverage.findings
    everything = (*read.findings, *still_true(posed.findings, better), *better.findings, *quality.findings, *shown)
    return PhotoIntake(
        photos, quality, coverage, occlusion, usable, read.photos, everything, counted, posed, better, folder
    )


def counted_again(intake: PhotoIntake, model: SiteModel, flown: Plan | None, monitor: Monitor = QUIET) -> PhotoIntake:
    """The same photos, their coverage counted over other panels or against another plan.

    Raises
    ------
    InputError
        The site has no panels.
    """
    require_panels(model.site)
    counted, occlusion = _coverage_model(model, flown)
    coverage = _achieved(counted, intake.photos, intake.usable, model, flown, monitor)
    before = () if intake.coverage is None else intake.coverage.findings
    others = tuple(found for found in intake.findings if found not in before and found.code != NO_PANELS)
    findings = (*others, *coverage.findings)
    return replace(intake, coverage=coverage, occlusion=occlusion, findings=findings, counted=counted)


def with_poses(
    intake: PhotoIntake, better: BetterPoses, model: SiteModel, flown: Plan | None, monitor: Monitor = QUIET
) -> PhotoIntake:
    """The same photos with other poses, and what they show counted again; pictures are not looked at again.

    `ValueError` unless the poses are those of the photos of `intake`, in their order.
    """
    if [photo.name for photo in better.photos] != [photo.name for photo in intake.photos]:
        raise ValueError("expected poses of the same photos in the same order")
    about_poses = (*intake.posed.findings, *intake.better.findings)
    others = tuple(found for found in intake.findings if found not in about_poses)
    findings = (*others, *still_true(intake.posed.findings, better), *better.findings)
    changed = replace(intake, photos=better.photos, better=better, findings=findings)
    return changed if intake.coverage is None else counted_again(changed, model, flown, monitor)


def _achieved(
    counted: CoverageModel,
    photos: Sequence[PosedPhoto],
    usable: Sequence[bool],
    model: SiteModel,
    flown: Plan | None,
    monitor: Monitor,
) -> AchievedCoverage:
    shown = [photo for photo, is_usable in zip(photos, usable, strict=True) if is_usable]
    planned = () if flown is None else flown.viewpoints
    return achieved_coverage(counted, shown, planned, panel_ids(model.site), monitor)


def panel_ids(site: Site) -> list[str]:
    """Of all panels, in the order of coverage counts."""
    return [panel.id for facade in site.facades for panel in facade.panels]


def _coverage_model(model: SiteModel, plan: Plan | None) -> tuple[CoverageModel, Decision]:
    """What counts as covered: as the plan has it, or the usual; occlusion where the scene calls for it.

    Whether one could take off from home does not matter: the photos have been taken.
    """
    camera = profile(DEFAULT_PROFILE).camera if plan is None else plan.camera
    constraints = Constraints() if plan is None else plan.constraints
    space = unchecked_space(model, constraints.min_distance_m)
    decision = decide_occlusion(model, space, constraints.occlusion)
    decided = replace(constraints, occlusion="on" if decision.on else "off")
    return coverage_model(model, space, camera, decided), decision


def intake_summary(intake: PhotoIntake) -> dict[str, Any]:
    """For `--json`; says nothing of coverage where there are no panels."""
    blurs = [found.blur_px for found in intake.quality.photos if found is not None and found.blur_px is not None]
    codes = Counter(finding.code for finding in intake.findings)
    summary: dict[str, Any] = {
        "photos": len(intake.photos),
        "usable": sum(intake.usable),
        "blur_px_median": None if not blurs else float(np.median(blurs)),
        "alike": len(intake.quality.alike),
        "findings": dict(sorted(codes.items())),
    }
    if intake.better.refined is not None:
        summary["refined"] = refined_summary(intake.better.refined)
    coverage = intake.coverage
    if coverage is None:
        return summary
    summary["covered"], summary["total"] = coverage.covered, coverage.counts.size
    summary["unseen_panels"] = len(coverage.unseen_panels)
    summary["occlusion"] = str(intake.occlusion)
    if coverage.planned_counts is not None:
        summary["planned"] = int(np.count_nonzero(coverage.planned_counts))
        summary["missed"] = int(coverage.missed.sum())
    return summary
