"""Other methods' results, as a user with their weights has them: a folder with one mask for each photo.

Made for EBLNet, GhostingNet and GlassSemNet, whose programs write such folders; nothing here depends on which it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from reconstruction.scores.pictures import pictures_in, read_labels

Mask = NDArray[np.bool_]

THRESHOLD = 0.5
"""Probability from which a pixel is glass."""

NAMES_IN_MESSAGE = 5


@dataclass(frozen=True, slots=True)
class MaskFolder:
    """Masks of glass by the names of their photos, without suffix."""

    folder: Path
    paths: dict[str, Path]

    def mask(self, name: str, width_px: int, height_px: int) -> Mask:
        """Where a photo of that size shows glass, shape (height_px, width_px).

        A mask of another size is resized, each pixel taking the nearest one's value.

        Raises
        ------
        InputError
            There is no mask of that name, or it is no mask.
        """
        if name not in self.paths:
            raise InputError(f"{self.folder}: expected a mask for the photo '{name}', found none of that name")
        is_glass = _is_glass(self.paths[name])
        if is_glass.shape == (height_px, width_px):
            return is_glass
        size = (width_px, height_px)
        resized = cv2.resize(is_glass.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST_EXACT)
        return np.asarray(resized, bool)

    def check(self, names: Sequence[str]) -> None:
        """See that there is a mask for each of these photos.

        Raises
        ------
        InputError
            Some are missing; the message names the first of them.
        """
        missing = [name for name in names if name not in self.paths]
        if missing:
            more = f" and {len(missing) - NAMES_IN_MESSAGE} more" if len(missing) > NAMES_IN_MESSAGE else ""
            raise InputError(
                f"{self.folder}: expected a mask for each of {len(names)} photos, named like it; missing: "
                f"{', '.join(missing[:NAMES_IN_MESSAGE])}{more}"
            )


def mask_folder(folder: Path) -> MaskFolder:
    """Find the masks in a folder.

    Raises
    ------
    InputError
        It is no folder or holds no pictures.
    """
    return MaskFolder(folder, pictures_in(folder))


def _is_glass(path: Path) -> Mask:
    """A mask from a picture of 0 and 1, 0 and 255, or probabilities over the whole range of 8 or 16 bit."""
    values = read_labels(path)
    if values.ndim == 3:
        colours = values[..., :3]
        if (colours != colours[..., :1]).any():
            raise InputError(f"{path}: expected a grey mask, found colours; write glass as white on black")
        values = colours[..., 0]
    highest = int(values.max(initial=0))
    full = 1 if highest <= 1 else int(np.iinfo(values.dtype).max)
    return np.asarray(values >= THRESHOLD * full)
