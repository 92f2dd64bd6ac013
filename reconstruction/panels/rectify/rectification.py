"""What every rectification of a photo is: a map there and back."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Rectification(Protocol):
    """A map between a photo and its fronto-parallel view, where grid lines run along rows and columns.

    Coordinates of both are continuous pixels as in `reconstruction.base.cameras`. Points may lie outside both pictures;
    where the map does not exist (behind the horizon of a plane, beyond the rim of a cylinder) the result is NaN.
    """

    @property
    def width_px(self) -> int:
        """Of the rectified picture."""

    @property
    def height_px(self) -> int:
        """Of the rectified picture."""

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo."""

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture."""
