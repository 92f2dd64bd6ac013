"""Use case on site, before leaving: what the photos on the card are worth, and what they really show."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.given_files import read_given_plan, read_given_site
from groundstation.services.photo_poses import better_poses
from planning.catalogue import DEFAULT_PROFILE, profile
from planning.coverage.model import CoverageModel
from planning.effects import Decision
from planning.findings import Finding
from planning.photo_files.folder import read_photos
from planning.photo_files.places import PhotoHeights
from planning.photo_files.record import PhotoMetadata
from planning.plan import Constraints, Plan
from planning.prepare import coverage_model, decide_occlusion, wish_of
from planning.progress import QUIET, Monitor
from planning.site import Site, SiteModel
from planning.space import free_space
from reconstruction.cameras import PosedPhoto
from reconstruction.photos.coverage import AchievedCoverage, achieved_coverage, distances_m
from reconstruction.photos.poses import pose_photos
from reconstruction.photos.quality import QualityLimits, QualityReport, check_quality


@dataclass(frozen=True, slots=True, eq=False)
class PhotoIntake:
    """Photos with poses, their quality, and the coverage that they achieve.

    Parameters
    ----------
    quality
        Of `photos`, in their order.
    usable
        Which of them count: those that could be decoded.
    metadata
        Of all photos that could be read, in the order of time, with a pose or without.
    """

    photos: tuple[PosedPhoto, ...]
    quality: QualityReport
    coverage: AchievedCoverage
    occlusion: Decision
    usable: tuple[bool, ...]
    metadata: tuple[PhotoMetadata, ...]
    findings: tuple[Finding, ...]


def take_in(
    folder: Path,
    site: Path,
    plan: Path | None = None,
    limits: QualityLimits | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    monitor: Monitor = QUIET,
) -> PhotoIntake:
    """Read a folder of photos over a site file, and a plan file where one was flown; see `take_in_photos`."""
    model = read_given_site(site)
    flown = None if plan is None else read_given_plan(plan)
    return take_in_photos(folder, model, flown, limits, heights=heights, colmap=colmap, monitor=monitor)


def take_in_photos(
    folder: Path,
    model: SiteModel,
    flown: Plan | None = None,
    limits: QualityLimits | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    monitor: Monitor = QUIET,
) -> PhotoIntake:
    """Read a folder of photos over a site.

    Parameters
    ----------
    flown
        Plan that was flown: the coverage counts as it did there, and what it promised is compared.

    Raises
    ------
    InputError
        Photos, site, plan or COLMAP model cannot be used.
    """
    read = read_photos(folder, monitor)
    posed = pose_photos(read.photos, model.site, folder, heights=heights)
    photos, findings = better_poses(posed, colmap, folder)
    metadata = {photo.name: data for photo, data in zip(posed.photos, posed.metadata, strict=True)}
    counted, occlusion = _coverage_model(model, flown)
    quality = check_quality(
        [metadata[photo.name] for photo in photos],
        photos,
        distances_m(counted, photos),
        limits or QualityLimits(),
        monitor,
    )
    usable = tuple(found is not None for found in quality.photos)
    shown = [photo for photo, is_usable in zip(photos, usable, strict=True) if is_usable]
    planned = () if flown is None else flown.viewpoints
    coverage = achieved_coverage(counted, shown, planned, panel_ids(model.site), monitor)
    everything = (*read.findings, *posed.findings, *findings, *quality.findings, *coverage.findings)
    return PhotoIntake(photos, quality, coverage, occlusion, usable, read.photos, everything)


def panel_ids(site: Site) -> list[str]:
    """Of all panels, in the order of coverage counts."""
    return [panel.id for facade in site.facades for panel in facade.panels]


def _coverage_model(model: SiteModel, plan: Plan | None) -> tuple[CoverageModel, Decision]:
    """What counts as covered: as the plan has it, or the usual; occlusion where the scene calls for it."""
    camera = profile(DEFAULT_PROFILE).camera if plan is None else plan.camera
    constraints = Constraints() if plan is None else plan.constraints
    space = free_space(model, constraints.min_distance_m)
    decision = decide_occlusion(model, space, wish_of(constraints))
    decided = replace(constraints, occlusion="on" if decision.on else "off")
    return coverage_model(model, space, camera, decided), decision


def intake_summary(intake: PhotoIntake) -> dict[str, Any]:
    """For `--json`."""
    blurs = [found.blur_px for found in intake.quality.photos if found is not None and found.blur_px is not None]
    codes = Counter(finding.code for finding in intake.findings)
    coverage = intake.coverage
    summary: dict[str, Any] = {
        "photos": len(intake.photos),
        "usable": sum(intake.usable),
        "blur_px_median": None if not blurs else float(np.median(blurs)),
        "alike": len(intake.quality.alike),
        "covered": coverage.covered,
        "total": coverage.counts.size,
        "unseen_panels": len(coverage.unseen_panels),
        "occlusion": str(intake.occlusion),
        "findings": dict(sorted(codes.items())),
    }
    if coverage.planned_counts is not None:
        summary["planned"] = int(np.count_nonzero(coverage.planned_counts))
        summary["missed"] = int(coverage.missed.sum())
    return summary
