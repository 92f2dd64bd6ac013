"""What lies behind everything on a web page: the model's sky, or a plain one. Display values (sRGB).

A picture of all directions: rows from the zenith to the nadir, twice as many columns clockwise from north.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.reflections.shading import display_from_linear
from reconstruction.splatting.sky import Sky

Bytes = NDArray[np.uint8]

N_ROWS = 64

_PLAIN = ((0.0, (150, 182, 212)), (0.49, (226, 234, 240)), (0.51, (176, 178, 178)), (1.0, (120, 122, 122)))
"""Colours by share of the way from the zenith to the nadir: overcast sky above, grey ground below."""


def sky_bytes(sky: Sky) -> Bytes:
    """Of a model, shape (h, 2 h, 3); light that is brighter than white becomes white."""
    with torch.no_grad():
        shown = display_from_linear(sky.picture()).clamp(0.0, 1.0)
    return np.rint(shown.cpu().numpy() * 255.0).astype(np.uint8)


def plain_sky_bytes() -> Bytes:
    """Where a model has none, shape (h, 2 h, 3)."""
    shares = (np.arange(N_ROWS) + 0.5) / N_ROWS
    places = [share for share, _ in _PLAIN]
    colours = np.stack([np.interp(shares, places, [colour[i] for _, colour in _PLAIN]) for i in range(3)], axis=1)
    return np.repeat(np.rint(colours).astype(np.uint8)[:, None], 2 * N_ROWS, axis=1)
