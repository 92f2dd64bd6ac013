"""What effects have in common: how large is large enough, and what simulating costs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from reconstruction.scenes.effects.probe import Probe

TOLERANCE_PX = 0.5
"""Half a pixel: less than what neighbouring pixels blur into each other."""

TOLERANCE_GREY = 0.5
"""Half a grey level: what rounding to whole ones changes at most; 54 dB."""

RAYS_PER_PIXEL = 4.0
"""On average over a picture: one, and nine more where detail calls for them (a third of the bundled scenes' pixels)."""

SECONDS_PER_RAY, SECONDS_PER_SHADOW, SECONDS_PER_ANGLE = 7e-7, 2.5e-7, 5e-8
"""Of one core: for a ray cast and shaded, for one that asks for the sun or shades alone, and for arithmetic on one;
measured on `planar` and `court`, where 0.8 million rays with their mirror images take 1.2 s."""

NO_GLASS = say("no photo shows glass")


def cost_s(probe: Probe, share: float, seconds_per_ray: float) -> float:
    """Of something done for a share of all rays of the flight."""
    return probe.n_pixels * RAYS_PER_PIXEL * share * seconds_per_ray


def percent(mask: NDArray[np.bool_]) -> str:
    """Share of a mask that is set, as text."""
    return f"{100.0 * float(mask.mean()):.0f} %"
