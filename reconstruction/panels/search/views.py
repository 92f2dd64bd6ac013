"""Views made of other views: the picture itself, a corrected view, and one of another size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.panels.rectify.surface import Rectification

# Pictures as the search for lines wants them.


def grey(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Grey values, shape (h, w)."""
    return picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)


def checked_image(image: NDArray[Any]) -> NDArray[np.uint8]:
    """The picture, if it is one of 8 bit with one or three channels.

    Raises
    ------
    InputError
        It is not.
    """
    fits = image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)
    if not fits or image.dtype != np.uint8 or image.size == 0:
        raise InputError(
            say(
                "expected a grey or colour picture of 8 bit, found {} of shape {}; convert it (for example to an "
                "8-bit PNG or JPEG) first",
                image.dtype,
                image.shape,
            )
        )
    return np.asarray(image, np.uint8)


Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class WholePicture:
    """A picture that is its own rectified view."""

    width_px: int
    height_px: int

    def to_photo(self, points_px: Array) -> Array:
        """The points themselves, shape (n, 2)."""
        return np.array(points_px, float)

    def to_rectified(self, points_px: Array) -> Array:
        """The points themselves, shape (n, 2)."""
        return np.array(points_px, float)


@dataclass(frozen=True, slots=True, eq=False)
class CorrectedView:
    """A rectified view seen through a homography: scaled, or with its last rotation and perspective taken out.

    Parameters
    ----------
    view_from_corrected
        Shape (3, 3), from this view's continuous pixels to those of `view`.
    """

    view: Rectification
    view_from_corrected: Array
    width_px: int
    height_px: int

    def to_photo(self, points_px: Array) -> Array:
        """Points of the corrected picture, shape (n, 2), in the photo."""
        return self.view.to_photo(mapped(self.view_from_corrected, points_px))

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the corrected picture."""
        return mapped(np.asarray(np.linalg.inv(self.view_from_corrected), float), self.view.to_rectified(points_px))


def mapped(homography: Array, points_px: Array) -> Array:
    """Points, shape (n, 2), through a homography; NaN where they go behind or through infinity."""
    points = np.atleast_2d(np.asarray(points_px, float))
    image = points @ homography[:, :2].T + homography[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(image[:, 2:] > 0.0, image[:, :2] / image[:, 2:], np.nan)


def scaled_view(view: Rectification, scale: float) -> Rectification:
    """The same view with `scale` times as many pixels along each side."""
    width, height = max(1, round(view.width_px * scale)), max(1, round(view.height_px * scale))
    if (width, height) == (view.width_px, view.height_px):
        return view
    shrink = np.diag([view.width_px / width, view.height_px / height, 1.0])
    return CorrectedView(view, shrink, width, height)
