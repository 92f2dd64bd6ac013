"""The sun as a disc that is seen: directly, and in panes.

Its light is that of `Sky.sun` exactly: a disc of radiance L that covers the solid angle w of the sky lights a
surface which faces it as a whole sky of radiance L w / pi, and such light is what `record` counts in.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reconstruction.scenes.record import Sky

Array = NDArray[np.float64]

RADIUS_RAD = math.radians(0.533 / 2.0)
"""Mean over the year (Astronomical Almanac: 0.524 to 0.542 degrees across)."""

LEAST_PIXELS = 1.0
"""Radius of a seen disc, in pixels: a smaller one is widened and dimmed, so that no ray misses it and its light stays.
"""

NARROWEST_RAD = 1e-9
"""Of a pixel."""


class Sun:
    """The disc of a sky's sun; there is none at and below the horizon."""

    def __init__(self, sky: Sky) -> None:
        self.direction_enu = sky.sun_direction_enu
        self._light = np.array(sky.sun, float)
        self.is_up = bool(self.direction_enu[2] > 0.0 and self._light.any())

    def radiance(self, radius_rad: float = RADIUS_RAD) -> Array:
        """Of a disc of this radius that sends the sun's light, shape (3,)."""
        return np.asarray(self._light / (2.0 * math.sin(0.5 * radius_rad)) ** 2)

    def seen(self, directions_enu: Array, beams_rad: Array | float) -> Array:
        """Light of the disc in unit directions, shape (n, 3), for pixels `beams_rad` wide, shape (n,) or ().

        Its edge is as soft as a pixel is wide, so that few rays sum up to its light wherever they pass.
        """
        light = np.zeros_like(directions_enu)
        if not self.is_up:
            return light
        beams = np.clip(beams_rad, NARROWEST_RAD, 1.0)
        # Nearly all rays go elsewhere.
        farthest = 2.0 * (RADIUS_RAD + float(np.max(beams, initial=0.0)))
        rows = np.flatnonzero(directions_enu @ self.direction_enu >= math.cos(farthest))
        beams = np.broadcast_to(beams, len(light))[rows]
        away = directions_enu[rows] - self.direction_enu
        # Chords, whose squares measure areas on the sphere.
        chords = np.sqrt(np.einsum("nk,nk->n", away, away))
        radii = 2.0 * np.sin(0.5 * np.maximum(RADIUS_RAD, LEAST_PIXELS * beams))
        inner, outer = np.maximum(radii - 0.5 * beams, 0.0), radii + 0.5 * beams
        shares = np.clip((outer - chords) / (outer - inner), 0.0, 1.0) * (directions_enu[rows, 2] > 0.0)
        # A cone without its tip over a circle.
        areas = (inner * inner + inner * outer + outer * outer) / 3.0
        light[rows] = (shares / areas)[:, None] * self._light
        return light
