"""What the network says of a photo in several sizes, because it knows panes of 8 to 48 pixels; panes found in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.network.votes import STRIDE, Pane, Picture, gathered, signed_areas
from reconstruction.panels.rectify.surface import Rectification

if TYPE_CHECKING:
    from reconstruction.panels.network.network import PaneNetwork

Array = NDArray[np.float64]

LONG_SIDES_PX = (64, 96, 144, 216, 324, 486, 729, 1094)
"""Sizes in which a picture is looked at, those above its own and the parameters' limit left out."""


@dataclass(frozen=True, slots=True, eq=False)
class SizePrediction:
    """What the network says of one size of a photo.

    Parameters
    ----------
    size_px
        Width and height in which it was looked at.
    scale
        Pixels of that size per pixel of the photo.
    probability
        Shape (h, w): that a place lies on a pane.
    corners_px
        Shape (h, w, 4, 2), in that size: where that pane's corners are.
    """

    size_px: tuple[int, int]
    scale: float
    probability: NDArray[np.float32]
    corners_px: NDArray[np.float32]

    def panes(self) -> list[Pane]:
        """All that places agree on, in the photo, whatever other sizes show."""
        found = gathered(self.probability, self.corners_px, self.size_px)
        return [
            replace(pane, corners_px=pane.corners_px / self.scale, sigma_px=pane.sigma_px / self.scale)
            for pane in found
        ]


@dataclass(frozen=True, slots=True, eq=False)
class PhotoPrediction:
    """What the network says of a photo, by the longer side in which it was looked at, px."""

    by_size: Mapping[int, SizePrediction] = field(default_factory=dict)

    def probability_at(self, points_px: Array) -> Array:
        """How probably places of the photo, shape (n, 2), lie on a pane, shape (n,): by the size that says it most."""
        best = np.zeros(len(points_px))
        for look in self.by_size.values():
            last = np.array(look.probability.shape[::-1]) - 1
            column, row = np.clip(points_px * look.scale / STRIDE, 0, last).astype(int).T
            best = np.maximum(best, look.probability[row, column])
        return best


@dataclass(frozen=True, slots=True, eq=False)
class FoundPanes:
    """Panes of a photo, none of which covers another, the most probable first, and what they were found in."""

    panes: tuple[Pane, ...]
    predictions: PhotoPrediction = field(default_factory=PhotoPrediction)

    def within(self, view: Rectification) -> FoundPanes:
        """Only the panes whose middle a rectified view shows, from its front."""
        if not self.panes:
            return self
        middles = view.to_rectified(np.stack([pane.corners_px.mean(axis=0) for pane in self.panes]))
        corners = view.to_rectified(np.concatenate([pane.corners_px for pane in self.panes])).reshape(-1, 4, 2)
        shown = (middles >= 0.0).all(axis=1) & (middles <= [view.width_px, view.height_px]).all(axis=1)
        shown &= np.isfinite(corners).all(axis=(1, 2)) & (signed_areas(corners) > 0.0)
        return FoundPanes(tuple(pane for pane, is_in in zip(self.panes, shown, strict=True) if is_in), self.predictions)


def predict_photo(
    image: Picture,
    long_side_px: int,
    known: PhotoPrediction | None = None,
    monitor: Monitor = QUIET,
    by: PaneNetwork | None = None,
) -> PhotoPrediction:
    """Look at a photo, shape (h, w, 3), blue, green, red, in sizes up to `long_side_px`.

    Parameters
    ----------
    known
        What smaller sizes of the same photo showed: they are not looked at again.
    by
        Another network than the one that comes with the program.
    """
    from reconstruction.panels.network.network import pane_votes  # torch is heavy, and not always wanted

    longest = max(image.shape[:2])
    most = min(long_side_px, longest, LONG_SIDES_PX[-1])
    predictions = {} if known is None else dict(known.by_size)
    sizes = sorted({min(size, most) for size in LONG_SIDES_PX} - set(predictions))
    for number, size in enumerate(sizes):
        monitor.report(say("look for panes"), number, len(sizes))
        scale = size / longest
        width, height = max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale))
        smaller = np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
        predictions[size] = SizePrediction((width, height), scale, *pane_votes(smaller, by))
    return PhotoPrediction(predictions)
