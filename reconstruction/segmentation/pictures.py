"""Pictures as the search for lines wants them."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError


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
            f"expected a grey or colour picture of 8 bit, found {image.dtype} of shape {image.shape}; "
            "convert it (for example to an 8-bit PNG or JPEG) first"
        )
    return np.asarray(image, np.uint8)
