"""What lies behind everything on a web page: the model's sky, or a plain one. Linear light: 1 is as bright as white.

A picture of all directions as `reconstruction.splats.sky.Sky` has it: rows from the zenith to the nadir, twice as
many columns clockwise from south, so that north is in the middle.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.splats.harmonic_colour import light_of_display
from reconstruction.splats.sky import Sky

Halves = NDArray[np.float16]

N_ROWS = 64

_PLAIN = ((0.0, (150, 182, 212)), (0.49, (226, 234, 240)), (0.51, (176, 178, 178)), (1.0, (120, 122, 122)))
"""sRGB colours by share of the way from the zenith to the nadir: overcast sky above, grey ground below."""


def sky_light(sky: Sky) -> Halves:
    """Of a model, shape (h, 2 h, 3); as bright as the model has it, which what is thin before it lets through."""
    with torch.no_grad():
        return sky.picture().cpu().numpy().astype(np.float16)


def plain_sky_light() -> Halves:
    """Where a model has none, shape (h, 2 h, 3)."""
    shares = (np.arange(N_ROWS) + 0.5) / N_ROWS
    places = [share for share, _ in _PLAIN]
    colours = np.stack([np.interp(shares, places, [colour[i] for _, colour in _PLAIN]) for i in range(3)], axis=1)
    light = light_of_display(torch.from_numpy(colours / 255.0)).numpy().astype(np.float16)
    return np.repeat(light[:, None], 2 * N_ROWS, axis=1)
