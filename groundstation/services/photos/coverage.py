"""What the photos of a flight show of each panel, ready to be drawn: shares, sections, and which photo shows which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.intake import PhotoIntake, panel_ids
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid
from planning.insight.sections import SectionState
from planning.site.records import Site
from reconstruction.base.cameras import PosedPhoto
from reconstruction.photos.coverage import AchievedCoverage

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
