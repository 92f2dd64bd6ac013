"""Layers of a model as pictures that somebody can look at."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np
from numpy.typing import NDArray

LIGHT = frozenset({"picture", "diffuse", "reflection", "mirrored"})
"""sRGB already."""

SHARES = frozenset({"reflectivity", "fresnel", "alpha"})

GOLDEN_TURN = 0.618033988749895
"""Of the hue, from one panel to the next: neighbours differ as much as can be."""

NOTHING = 40
"""Grey of pixels where a layer has no value."""

OUTLIERS = 2.0
"""Per cent of depths at either end that have the colours of the ends."""

Picture = NDArray[np.uint8]


def coloured(layer: str, values: NDArray[np.float32]) -> tuple[Picture, tuple[float, float] | None]:
    """A layer as a picture, shape (h, w, 3), red, green, blue; and the values at the ends of its colours, if any.

    Parameters
    ----------
    values
        As `render_view` has them: shape (h, w) or (h, w, 3); infinite depths are nothing.
    """
    if layer in LIGHT:
        return _bytes(values), None
    if layer == "normals":
        picture = _bytes(0.5 * (values + 1.0))
        picture[np.abs(values).max(axis=2) == 0.0] = NOTHING
        return picture, None
    if layer == "panels":
        return _numbered(values.astype(np.int64)), None
    if layer in SHARES:
        return _mapped(values, 0.0, 1.0), (0.0, 1.0)
    known = values[np.isfinite(values)]
    if not len(known):
        return np.full((*values.shape, 3), NOTHING, np.uint8), None
    low, high = (float(each) for each in np.percentile(known, (OUTLIERS, 100.0 - OUTLIERS)))
    high = max(high, low + 1e-3)
    return _mapped(values, low, high), (low, high)


def _bytes(values: NDArray[np.float32]) -> Picture:
    return np.asarray(np.round(255.0 * np.nan_to_num(values).clip(0.0, 1.0)), np.uint8)


def _mapped(values: NDArray[np.float32], low: float, high: float) -> Picture:
    is_known = np.isfinite(values)
    share = np.where(is_known, (values - low) / (high - low), 0.0).astype(np.float32)
    mapped = np.asarray(cv2.applyColorMap(_bytes(share), cv2.COLORMAP_VIRIDIS), np.uint8)
    picture = np.ascontiguousarray(mapped[..., ::-1])
    picture[~is_known] = NOTHING
    return picture


def _numbered(numbers: NDArray[np.int64]) -> Picture:
    n_panels = int(numbers.max(initial=-1)) + 1
    hues = [colorsys.hsv_to_rgb((GOLDEN_TURN * number) % 1.0, 0.65, 0.9) for number in range(n_panels)]
    palette = np.array([*hues, (NOTHING / 255.0,) * 3])
    colours: Picture = np.round(255.0 * palette).astype(np.uint8)
    return colours[np.where(numbers >= 0, numbers, n_panels)]
