"""The paper's three kinds of numbers (4.1, Table 1), of one photo and of a set of them.

Overall
    Intersection over union (IoU) of the region of glass: on a curtain wall the facade with its frames, on a wall with
    windows the windows. The paper does not say whether its mIoU is a mean over photos or over the classes glass and
    non-glass; `overall_iou` is that of glass, `overall_miou` the mean over both classes. Sets average over photos.
Coverage
    Of each true panel, the share inside the found region; its 20th, 10th and 5th percentile over the panels, of a set
    over the panels of all photos.
Individual
    IoU of each true panel with a found one, averaged. The paper knows which belong together, because its panels carry
    numbers. We take the found panel that overlaps most (`individual_miou`), or demand that each found panel serves one
    true panel only (`one_to_one_miou`, the assignment with the largest sum). Panels found with an IoU above one half
    can have no other partner, so the two differ only where panels were missed or merged; where every panel is found
    they are the paper's number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.metrics.overlaps import Overlaps

Array = NDArray[np.float64]

PERCENTILES = (20, 10, 5)

FOUND_IOU = 0.5
"""A panel is missed, or false, where no partner reaches this: above it partners are unique."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoScores:
    """Scores of one photo, each from 0 to 1.

    Parameters
    ----------
    ious, one_to_one_ious
        Of each true panel with its partner; None for a method that finds no single panels.
    coverages
        Of each true panel.
    n_missed, n_false
        True and found panels without a partner; None where there are no single panels.
    seconds
        That the method took.
    """

    name: str
    n_true: int
    n_found: int
    overall_iou: float
    overall_miou: float
    coverages: Array
    ious: Array | None
    one_to_one_ious: Array | None
    n_missed: int | None
    n_false: int | None
    seconds: float = 0.0

    @property
    def individual_miou(self) -> float | None:
        """Mean IoU of single panels."""
        return None if self.ious is None else _mean(self.ious)

    @property
    def one_to_one_miou(self) -> float | None:
        """The same with each found panel used once."""
        return None if self.one_to_one_ious is None else _mean(self.one_to_one_ious)

    def coverage_percentile(self, percent: float) -> float:
        """Share covered that all but `percent` % of the panels reach."""
        return _percentile(self.coverages, percent)


@dataclass(frozen=True, slots=True)
class Spread:
    """One score over the photos of a set."""

    mean: float
    worst: float
    worst_photo: str


@dataclass(frozen=True, slots=True, eq=False)
class SetScores:
    """Scores of a set of photos.

    Parameters
    ----------
    coverage
        Percentiles 20, 10 and 5 over all panels of all photos.
    individual_miou, one_to_one_miou
        None for a method that finds no single panels.
    """

    photos: tuple[PhotoScores, ...]
    overall_iou: Spread
    overall_miou: Spread
    individual_miou: Spread | None
    one_to_one_miou: Spread | None
    coverage: dict[int, float]
    n_panels: int
    n_missed: int | None
    n_false: int | None
    seconds: Spread


def score_overlaps(name: str, overlaps: Overlaps, has_panels: bool = True, seconds: float = 0.0) -> PhotoScores:
    """Scores of one photo.

    A photo without glass, in which none is found, is perfect; where there is nothing to divide by, a share is 1 if
    nothing was wrong and 0 otherwise.
    """
    rest = overlaps.picture - overlaps.true_region - overlaps.found_region + overlaps.joint_region
    glass_union = overlaps.true_region + overlaps.found_region - overlaps.joint_region
    overall = _ratio(overlaps.joint_region, glass_union)
    other = _ratio(rest, overlaps.picture - overlaps.joint_region)
    coverages = overlaps.covered / overlaps.true_areas
    ious = one_to_one = n_missed = n_false = None
    if has_panels:
        unions = overlaps.true_areas[:, None] + overlaps.found_areas[None] - overlaps.joint
        table = np.divide(overlaps.joint, unions, out=np.zeros_like(overlaps.joint), where=unions > 0.0)
        ious = table.max(axis=1, initial=0.0)
        one_to_one = _assigned(table)
        n_missed = int((ious <= FOUND_IOU).sum())
        n_false = int((table.max(axis=0, initial=0.0) <= FOUND_IOU).sum())
    return PhotoScores(
        name,
        len(overlaps.true_areas),
        len(overlaps.found_areas),
        overall,
        0.5 * (overall + other),
        coverages,
        ious,
        one_to_one,
        n_missed,
        n_false,
        seconds,
    )


def summarise(photos: Sequence[PhotoScores]) -> SetScores:
    """Scores of a set.

    Raises
    ------
    ValueError
        The set is empty.
    """
    if not photos:
        raise ValueError("expected at least one photo")
    names = [photo.name for photo in photos]
    singles = [(photo.individual_miou, photo.one_to_one_miou) for photo in photos]
    individual = [value for value, _ in singles if value is not None]
    one_to_one = [value for _, value in singles if value is not None]
    is_full = len(individual) == len(photos)
    coverages = np.concatenate([photo.coverages for photo in photos])
    return SetScores(
        tuple(photos),
        _spread(names, [photo.overall_iou for photo in photos]),
        _spread(names, [photo.overall_miou for photo in photos]),
        _spread(names, individual) if is_full else None,
        _spread(names, one_to_one) if is_full else None,
        {percent: _percentile(coverages, percent) for percent in PERCENTILES},
        sum(photo.n_true for photo in photos),
        sum(photo.n_missed or 0 for photo in photos) if is_full else None,
        sum(photo.n_false or 0 for photo in photos) if is_full else None,
        _spread(names, [photo.seconds for photo in photos], is_worst_largest=True),
    )


def _assigned(table: Array) -> Array:
    """IoU of each row with the column that the best one-to-one assignment gives it; 0 for rows left alone."""
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(table, maximize=True)
    ious = np.zeros(len(table))
    ious[rows] = table[rows, columns]
    return ious


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 1.0


def _mean(values: Array) -> float:
    return float(values.mean()) if len(values) else 1.0


def _percentile(values: Array, percent: float) -> float:
    return float(np.percentile(values, percent)) if len(values) else 1.0


def _spread(names: Sequence[str], values: Sequence[float], is_worst_largest: bool = False) -> Spread:
    worst = int(np.argmax(values) if is_worst_largest else np.argmin(values))
    return Spread(float(np.mean(values)), float(values[worst]), names[worst])
