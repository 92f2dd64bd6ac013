"""Pictures for tests: random facades with known blur, as files."""

from __future__ import annotations

import itertools
from pathlib import Path

import cv2
import numpy as np

from planning.photos.metadata import read_photo
from planning.photos.record import PhotoMetadata


def facade(seed: int, size: tuple[int, int] = (480, 640), contrast: float = 90.0) -> np.ndarray:
    """Grey picture, shape `size`, of panes of random brightness with frames, drawn at four times the size."""
    rng = np.random.default_rng(seed)
    height, width = size[0] * 4, size[1] * 4
    picture = np.full((height, width), 128.0, np.float32)
    rows, columns = (np.sort(rng.integers(0, n, 14)) for n in (height, width))
    for top, bottom in itertools.pairwise(rows):
        for left, right in itertools.pairwise(columns):
            picture[top:bottom, left:right] = 128.0 + contrast * rng.uniform(-1.0, 1.0)
    for _ in range(12):  # diagonals, as of reflections and braces
        a, b = rng.integers(0, [width, height], (2, 2)).tolist()
        cv2.line(picture, a, b, float(128.0 + contrast * rng.uniform(-1.0, 1.0)), int(rng.integers(20, 80)))
    return np.clip(cv2.resize(picture, (size[1], size[0]), interpolation=cv2.INTER_AREA), 5.0, 250.0).astype(np.uint8)


def moved(grey: np.ndarray, length_px: int) -> np.ndarray:
    """The picture after a movement along x by an odd number of pixels while the shutter was open."""
    return cv2.blur(grey, (length_px, 1))


def write(path: Path, grey: np.ndarray, quality: int = 95) -> PhotoMetadata:
    """As a JPEG file, read back as a photo."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes())
    return read_photo(path)
