"""Effects of light that reaches the scene, comes through its panes, or is kept from the camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.scenes.effects.probe import NO_GLASS, SECONDS_PER_SHADOW, TOLERANCE_GREY, Probe, cost_s
from reconstruction.scenes.light.pane_surfaces import pane_light
from reconstruction.scenes.light.tracing import Switches
from reconstruction.scenes.parameters import INTERIOR, OCCLUSION, SHADOW, SKY_OCCLUSION

# Effect of what stands around on the light that reaches a place.

SECONDS_PER_PLACE = 1.9e-4
"""Of one core, for all rays of a place and what they meet: measured on `planar`, `curved` and `court`."""

PLACES_PER_PROBED = 5.0
"""Places that a flight's photos show for each that the probe's rays meet: on `planar`, 24 photos."""


@dataclass(frozen=True, slots=True)
class SkyOcclusion:
    """Light from around by what a place sees of sky and surroundings, against that of open sky and even ground."""

    tolerance: float = TOLERANCE_GREY
    name = SKY_OCCLUSION
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        if not probe.scene.bodies:
            return Assessment(0.0, say("there is nothing that light falls on"), 0.0)
        light = probe.surroundings_light()
        reason = say("what is seen gets {:.0f} % of the light of an open sky", 100.0 * light.share)
        return Assessment(light.change_grey, reason, light.n_places * PLACES_PER_PROBED * SECONDS_PER_PLACE)


SECONDS_PER_ROOM = 1.5e-7
"""Of one core, for a ray into a room."""


@dataclass(frozen=True, slots=True)
class Shadow:
    """Places that the sun does not reach."""

    tolerance: float = TOLERANCE_GREY
    name = SHADOW
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        sky = probe.scene.sky
        if sky.sun_elevation_deg <= 0.0 or not any(sky.sun):
            return Assessment(0.0, say("there is no sun"), 0.0)
        reason = say("the sun stands {:.0f} degrees high", sky.sun_elevation_deg)
        return Assessment(probe.change_without(Switches(shadow=False)), reason, cost_s(probe, 1.0, SECONDS_PER_SHADOW))


@dataclass(frozen=True, slots=True)
class Interior:
    """Rooms seen through panes, against their mean light."""

    tolerance: float = TOLERANCE_GREY
    name = INTERIOR
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        seen, scene = probe.mirrored, probe.scene
        if not len(seen):
            return Assessment(0.0, NO_GLASS, 0.0)
        if scene.interiors is None:
            return Assessment(0.0, say("there are no rooms behind the panes"), 0.0)
        kinds = scene.panes.glass[seen.hits.panes]
        through = np.zeros(len(seen))
        for number, glass in enumerate(scene.glasses):
            through[kinds == number] = pane_light(seen.cosines[kinds == number], glass)[2].mean(axis=1)
        reason = say("panes let {:.0f} % of the light through that comes from behind them", 100.0 * through.mean())
        cost = cost_s(probe, probe.glass_share, SECONDS_PER_ROOM)
        return Assessment(probe.change_without(Switches(interior=False)), reason, cost)


@dataclass(frozen=True, slots=True)
class Occlusion:
    """Trees, cars, people and other buildings that stand between camera and facade."""

    tolerance: float = TOLERANCE_GREY
    name = OCCLUSION
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe; what is left out is still mirrored."""
        share = probe.hidden_share()
        if share == 0.0:
            return Assessment(0.0, say("nothing near stands before the facade"), 0.0)
        reason = say("what is near hides {:.1f} % of the facade", 100.0 * share)
        # Without it, rays have further to go.
        return Assessment(probe.change_without(Switches(occlusion=False)), reason, 0.0)


EFFECTS = (Shadow(), Interior(), Occlusion(), SkyOcclusion())
