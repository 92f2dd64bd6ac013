"""Effects of what panes mirror: where the images lie, and how strong they are.

Displacements are in pixels: what 95 % of the rays on glass do not exceed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.scenes.effects.probe import (
    NO_GLASS,
    SECONDS_PER_ANGLE,
    SECONDS_PER_RAY,
    SECONDS_PER_SHADOW,
    TOLERANCE_GREY,
    TOLERANCE_PX,
    Probe,
    cost_s,
    percent,
)
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.light.tracing import Switches
from reconstruction.scenes.parameters import CURVATURE, DOUBLING, FRESNEL, NEAR_FIELD, ROWS, SECOND_BOUNCE, TILT

Array = NDArray[np.float64]


NEAREST_M = 1e-3
"""Closer things are taken to be this far away."""


@dataclass(frozen=True, slots=True)
class NearField:
    """Parallax of mirror images against one picture of the surroundings from the facade's middle."""

    tolerance: float = TOLERANCE_PX
    name = NEAR_FIELD
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """Nothing where panes mirror the sky and the building itself alone."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        share = float(seen.is_around.mean())
        # Mirrored things are shaded, and the picture of the surroundings is saved.
        shaded = cost_s(probe, probe.glass_share * share, SECONDS_PER_SHADOW)
        cost = max(shaded - 2.0 * ROWS * ROWS * SECONDS_PER_RAY, 0.0)
        if share == 0.0:
            return Assessment(0.0, say("the panes mirror nothing but the sky and the building itself"), cost)
        away = np.median(seen.path_m[seen.is_around])
        reason = say(
            "{} of the mirrored rays meet what is around, {:.0f} m from the panes", percent(seen.is_around), away
        )
        return Assessment(probe.displacement_px(seen.parallax_rad), reason, cost)


@dataclass(frozen=True, slots=True)
class Fresnel:
    """Reflectance by the angle of incidence, against that at normal incidence."""

    tolerance: float = TOLERANCE_GREY
    name = FRESNEL
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        steep, flat = np.degrees(np.arccos(np.clip(np.quantile(seen.cosines, [0.95, 0.05]), 0.0, 1.0)))
        reason = say("light falls on the panes at {:.0f} to {:.0f} degrees", steep, flat)
        cost = cost_s(probe, probe.glass_share, SECONDS_PER_ANGLE)
        return Assessment(probe.change_without(Switches(fresnel=False)), reason, cost)


@dataclass(frozen=True, slots=True)
class SecondBounce:
    """Glass mirrored in glass."""

    tolerance: float = TOLERANCE_GREY
    name = SECOND_BOUNCE
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Nothing where no mirrored ray meets a pane."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        meets = seen.after.panes >= 0
        reason = say("{} of the mirrored rays meet glass", percent(meets))
        size = probe.change_without(Switches(second_bounce=False)) if meets.any() else 0.0
        return Assessment(size, reason, cost_s(probe, probe.glass_share * float(meets.mean()), SECONDS_PER_RAY))


@dataclass(frozen=True, slots=True)
class Tilt:
    """Displacement of mirror images by panes that are not quite parallel to their facade."""

    tolerance: float = TOLERANCE_PX
    name = TILT
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """A mirror turned by a moves an image by 2 a t / (s + t), s from the camera to it and t from there on."""
        seen = probe.mirrored
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        share = np.where(seen.is_sky, 1.0, 1.0 / (1.0 + seen.sight_m / seen.path_m))
        reason = say("panes are tilted by up to {:.2f} degrees", np.degrees(seen.tilts_rad.max()))
        cost = cost_s(probe, probe.glass_share, SECONDS_PER_ANGLE)
        return Assessment(probe.displacement_px(2.0 * share * seen.tilts_rad), reason, cost)


@dataclass(frozen=True, slots=True)
class Curvature:
    """Displacement of mirror images by panes that are bowed, which makes them smaller or larger, too."""

    tolerance: float = TOLERANCE_PX
    name = CURVATURE
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """Against where flat panes show the same, followed with the rays of the probe."""
        seen, bows = probe.mirrored, probe.scene.panes.bows_per_m
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        turns = np.degrees(np.arctan(np.abs(bows) * half_sides_m(probe.scene.panes, probe.geometry.pane_frames)))
        most = float(turns[seen.hits.panes].max())
        if most == 0.0:
            return Assessment(0.0, say("the panes are flat"), 0.0)
        # As of a spherical mirror's image, seen from s and t away: 1 / (1 + 2 s t / (R (s + t))).
        between = 1.0 / (1.0 / np.maximum(seen.sight_m, NEAREST_M) + 1.0 / np.maximum(seen.path_m, NEAREST_M))
        size = np.median(1.0 / np.abs(1.0 + 2.0 * between * bows[seen.hits.panes, 0]))
        reason = say(
            "panes turn by up to {:.2f} degrees to their edges; mirror images appear {:.2f} times as wide", most, size
        )
        cost = cost_s(probe, probe.glass_share, SECONDS_PER_ANGLE)
        return Assessment(probe.displacement_px(probe.bent_rad()), reason, cost)


@dataclass(frozen=True, slots=True)
class Doubling:
    """Displacement of the second sheet's mirror image against the first's."""

    tolerance: float = TOLERANCE_PX
    name = DOUBLING
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """Parallel sheets g apart shift rays by 2 g sin(angle); at the distance s + t that is an angle."""
        seen, scene = probe.mirrored, probe.scene
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        gaps = np.array([glass.gap_m if glass.sheets == 2 else 0.0 for glass in scene.glasses])
        gap = gaps[scene.panes.glass[seen.hits.panes]]
        if not gap.any():
            return Assessment(0.0, say("the panes are single"), 0.0)
        shift = 2.0 * gap * np.sqrt(np.clip(1.0 - seen.cosines**2, 0.0, 1.0))
        away = seen.sight_m + seen.path_m
        reason = say("sheets are {:.0f} mm apart, the mirror images {}", 1000.0 * gap.max(), _far(away[seen.is_around]))
        size = probe.displacement_px(shift / away)
        return Assessment(size, reason, cost_s(probe, probe.glass_share, SECONDS_PER_RAY))


def _far(metres: Array) -> str:
    return say("{:.0f} m away", np.median(metres)) if len(metres) else say("as far as the sky")


EFFECTS = (NearField(), Fresnel(), SecondBounce(), Tilt(), Curvature(), Doubling())
