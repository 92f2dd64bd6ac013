"""Made photos as files, with where and how they were taken written into them as DJI's cameras do."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.geo.frames import Origin
from reconstruction.base.cameras import PosedPhoto
from reconstruction.photos.write import photo_jpeg, photo_name

FIRST_AT, BETWEEN = datetime(2024, 5, 1, 10, 0, 0), timedelta(seconds=5)


def write_photos(
    folder: Path, photos: Sequence[tuple[PosedPhoto, NDArray[np.uint8]]], origin: Origin
) -> tuple[Path, ...]:
    """Write JPEG files with RTK positions, gimbal angles and a calibrated lens; returns their paths.

    Parameters
    ----------
    photos
        Cameras in the frame of `origin`, and their pictures, shape (h, w, 3), blue, green, red.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    paths = []
    for number, (photo, picture) in enumerate(photos):
        taken_at = FIRST_AT + number * BETWEEN
        path = folder / photo_name(number + 1, taken_at)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_atomically(path, photo_jpeg(picture, photo, origin, taken_at))
        except OSError as error:
            raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error
        paths.append(path)
    return tuple(paths)
