"""Use case on site, before leaving: what the photos on the card are worth, and what they show of each panel."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.poses import (
    ChosenPoses,
    RefineRequest,
    choose_poses,
    described,
    findings_that_hold,
    refined_summary,
)
from groundstation.services.project.input_files import read_input_plan, read_input_site
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import CoverageModel
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid
from planning.insight.sections import SectionState
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
    better: ChosenPoses
    folder: Path


def read_photo_intake(
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
    """Read a folder of photos over a site file, and a plan file where one was flown; see `photo_intake`.

    Raises
    ------
    InputError
        As `photo_intake`, or a plan is given for a site without panels.
    """
    model = read_input_site(site)
    flown = None if plan is None else read_input_plan(plan)
    if flown is not None:
        require_panels(model.site)
    return photo_intake(folder, model, flown, limits, heights=heights, colmap=colmap, refine=refine, monitor=monitor)


def photo_intake(
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
    read = read_photos(folder, monitor, posed_elsewhere=colmap is not None)
    posed = pose_photos(read.photos, model.site, folder, heights=heights, posed_elsewhere=colmap is not None)
    better = choose_poses(posed, folder, colmap, refine, monitor)
    photos = better.photos
    metadata = described(folder, read.photos, photos)
    counted, occlusion = _coverage_model(model, flown) if model.site.n_panels else (None, None)
    ahead_m = distances_to_building_m(model.building, photos) if counted is None else distances_m(counted, photos)
    quality = check_quality(
        [metadata[photo.name] for photo in photos], photos, ahead_m, limits or QualityLimits(), monitor
    )
    usable = tuple(found is not None for found in quality.photos)
    coverage = None if counted is None else _achieved(counted, photos, usable, model, flown, monitor)
    text = say("the site has no panels yet, so nothing is said of what the photos show of them")
    shown = (Finding(Severity.NOTE, NO_PANELS, text),) if coverage is None else coverage.findings
    everything = (
        *read.findings,
        *findings_that_hold(posed, better),
        *better.findings,
        *quality.findings,
        *shown,
    )
    return PhotoIntake(
        photos, quality, coverage, occlusion, usable, read.photos, everything, counted, posed, better, folder
    )


def recounted(intake: PhotoIntake, model: SiteModel, flown: Plan | None, monitor: Monitor = QUIET) -> PhotoIntake:
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
    intake: PhotoIntake, better: ChosenPoses, model: SiteModel, flown: Plan | None, monitor: Monitor = QUIET
) -> PhotoIntake:
    """The same photos with other poses, and what they show counted again; pictures are not looked at again.

    `ValueError` unless the poses are those of the photos of `intake`, in their order.
    """
    if [photo.name for photo in better.photos] != [photo.name for photo in intake.photos]:
        raise ValueError("expected poses of the same photos in the same order")
    about_poses = (*intake.posed.findings, *intake.better.findings)
    others = tuple(found for found in intake.findings if found not in about_poses)
    findings = (*others, *findings_that_hold(intake.posed, better), *better.findings)
    changed = replace(intake, photos=better.photos, better=better, findings=findings)
    return changed if intake.coverage is None else recounted(changed, model, flown, monitor)


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


# What a list of photos shows of each: its picture's file, where it was taken, and what is wrong with it.


class PhotoMark(StrEnum):
    """Why a photo may be no use."""

    UNREADABLE = "unreadable"
    CUT_OFF = "cut off"
    BLURRED = "blurred"
    DARK = "dark"
    BRIGHT = "bright"
    ALIKE = "alike"
    UNPOSED = "unposed"


CODES = {
    "photo-unreadable": PhotoMark.UNREADABLE,
    "photo-cut-off": PhotoMark.CUT_OFF,
    "photo-blurred": PhotoMark.BLURRED,
    "photo-dark": PhotoMark.DARK,
    "photo-bright": PhotoMark.BRIGHT,
    "photo-alike": PhotoMark.ALIKE,
}
"""Marks by the code of the finding that says so."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoCard:
    """One photo of a folder.

    Parameters
    ----------
    posed
        None where the photo does not say enough.
    """

    metadata: PhotoMetadata
    posed: PosedPhoto | None
    marks: tuple[PhotoMark, ...]

    @property
    def path(self) -> Path:
        """Of its file."""
        return self.metadata.path


def photo_cards(intake: PhotoIntake) -> tuple[PhotoCard, ...]:
    """All photos that could be read, in the order of time."""
    posed = {photo.path: photo for photo in intake.photos}
    marks: dict[str, set[PhotoMark]] = defaultdict(set)
    for finding in intake.findings:
        if finding.code in CODES:
            marks[finding.place].add(CODES[finding.code])
    cards = []
    for data in intake.metadata:
        found = marks[str(data.path)] | (set() if data.path in posed else {PhotoMark.UNPOSED})
        cards.append(PhotoCard(data, posed.get(data.path), tuple(mark for mark in PhotoMark if mark in found)))
    return tuple(cards)


def card_of_place(cards: tuple[PhotoCard, ...], place: str) -> int | None:
    """Number of the photo that a finding is about: findings name photos by path or by name; None for none."""
    for number, card in enumerate(cards):
        if place in (str(card.path), card.path.name) or (card.posed is not None and place == card.posed.name):
            return number
    return None


# What the photos of a flight show of each panel, ready to be drawn: shares, sections, and which photo shows which.

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Sighting:
    """A photo that shows a panel, and from which section of the panel's hemisphere."""

    photo: PosedPhoto
    section: int


@dataclass(frozen=True, slots=True, eq=False)
class PhotoCoverage:
    """Coverage of the panels of one site by photos.

    Parameters
    ----------
    panel_ids
        In the order of `achieved`.
    photos
        Those that count, in the order of `achieved`.
    """

    panel_ids: tuple[str, ...]
    frames: PanelFrames
    grid: SectionGrid
    photos: tuple[PosedPhoto, ...]
    achieved: AchievedCoverage

    @property
    def has_promise(self) -> bool:
        """Whether there is a plan to compare with."""
        return self.achieved.planned_counts is not None

    @property
    def seen_per_panel(self) -> NDArray[np.int64]:
        """Sections of each panel that photos show, shape (m,)."""
        return np.asarray(np.count_nonzero(self.achieved.counts, axis=1))

    def kept_promise(self) -> Array:
        """Share of the promised sections of each panel that photos show, 0 to 1, shape (m,).

        NaN where nothing was promised, and everywhere without a plan.
        """
        planned = self.achieved.planned_counts
        if planned is None:
            return np.full(len(self.panel_ids), np.nan)
        promised = np.count_nonzero(planned, axis=1)
        kept = np.count_nonzero((planned > 0) & (self.achieved.counts > 0), axis=1)
        return np.where(promised > 0, kept / np.maximum(promised, 1), np.nan)

    def number(self, panel_id: str) -> int | None:
        """Number of a panel; None for one that was not counted."""
        return self.panel_ids.index(panel_id) if panel_id in self.panel_ids else None

    def sightings(self, panel: int, section: int | None = None) -> tuple[Sighting, ...]:
        """Photos that show a panel, in the order of time; those that show one section of it where that is given."""
        seen = self.achieved.sections[:, panel]
        wanted = seen != NOT_SEEN if section is None else seen == section
        return tuple(Sighting(self.photos[k], int(seen[k])) for k in np.flatnonzero(wanted).tolist())

    def states(self, panel: int) -> tuple[SectionState, ...]:
        """Sections of a panel: covered by a photo, missed where only the plan would have, else undecided."""
        counts, missed = self.achieved.counts[panel], self.achieved.missed[panel]
        return tuple(
            SectionState.COVERED if count else SectionState.MISSED if is_missed else SectionState.UNDECIDED
            for count, is_missed in zip(counts.tolist(), missed.tolist(), strict=True)
        )

    def missing(self, panel: int) -> NDArray[np.int64]:
        """Sections that the plan promised and no photo shows; without a plan all that no photo shows."""
        missed = self.achieved.missed[panel] if self.has_promise else self.achieved.counts[panel] == 0
        return np.flatnonzero(missed)

    def directions_deg(self, panel: int) -> tuple[tuple[float, float], ...]:
        """Where the photos of a panel were taken: theta from its normal and phi around it, degrees."""
        places = np.array([sighting.photo.pose.position_enu_m for sighting in self.sightings(panel)]).reshape(-1, 3)
        rays = places - self.frames.centroids[panel]
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        theta = np.degrees(np.arccos(np.clip(rays @ self.frames.normals[panel], -1.0, 1.0)))
        phi = np.degrees(np.arctan2(rays @ self.frames.bitangents[panel], rays @ self.frames.tangents[panel])) % 360.0
        return tuple(zip(theta.tolist(), phi.tolist(), strict=True))


def photo_coverage(intake: PhotoIntake, site: Site) -> PhotoCoverage | None:
    """Coverage by the photos that were read over a site; None where that has no panels.

    `ValueError` for a site with other panels than were counted.
    """
    counted, achieved, ids = intake.counted, intake.coverage, tuple(panel_ids(site))
    if counted is None or achieved is None:
        return None
    if len(ids) != len(counted.frames):
        raise ValueError(f"expected the site with {len(counted.frames)} panels, got one with {len(ids)}")
    photos = tuple(photo for photo, is_usable in zip(intake.photos, intake.usable, strict=True) if is_usable)
    return PhotoCoverage(ids, counted.frames, counted.grid, photos, achieved)
