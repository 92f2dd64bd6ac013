"""Multipath: near large glass the receiver hears satellites twice, mirrored in the facade, and others not at all.

The share of the sky that a place sees mirrored or hidden is counted on rays. A ray from the antenna that meets a pane
is turned at it as light is: where it then goes to the sky, a satellite there is heard by way of the pane, later by the
extra way t (1 - m . d) of a plane wave (t: way to the pane, m and d: directions before and after it). Walls without
glass only hide.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from missions.simulator.airframe.state import Fix, Receiver
from missions.simulator.conditions import FixKind
from missions.simulator.effects.facts import MultipathFacts, ReceiverFacts, effect_facts
from missions.simulator.effects.gnss import AboveStart
from missions.simulator.effects.noise import SmoothNoise
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say
from planning.geo.bvh import build_bvh, first_hits
from planning.geo.frames import Vec3
from planning.site.records import SiteModel, panel_corners, panel_triangles

Floats = NDArray[np.float64]

N_RAYS = 2048
"""On the whole sphere; shares of the sky come out to about 1 %."""

GLASS_IN_FRONT_M = 0.01
"""Panes are put this far before the wall that they stand in, so that rays meet them first."""

MOVED_M = 1.0
"""The sky is counted anew after this way."""

BLEND_S = 2.0
"""Time in which the error's size follows that of the place: nothing jumps where the sky is counted anew."""

FARTHEST_M = 1e5
"""Longer than any way on a site."""

MAX_PLACES = 64
"""Views at which the size of the effect is estimated."""

COST_PER_STEP_S = 6e-6
COST_PER_METRE_S = 1.5e-3


def sphere(n: int) -> Floats:
    """Directions, n of them, spread evenly over the sphere, shape (n, 3), by the golden angle."""
    z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
    angle = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(n)
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(angle), level * np.sin(angle), z], axis=1)


@dataclass(frozen=True, slots=True)
class Sky:
    """What one place hears.

    Parameters
    ----------
    hidden, mirrored
        Shares of the sky above the mask that something hides, and that is heard mirrored.
    code_error_m
        Root mean square of the code's error over the satellites that are not hidden.
    phase_error_m
        The same for the carrier's phase.
    """

    hidden: float
    mirrored: float
    code_error_m: float
    phase_error_m: float


class GlassSky:
    """Counts the sky of places on a site."""

    def __init__(self, model: SiteModel, facts: MultipathFacts) -> None:
        corners = panel_corners(model.site)
        across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        self._normals = across / np.linalg.norm(across, axis=1, keepdims=True)
        glass = panel_triangles(corners + GLASS_IN_FRONT_M * self._normals[:, None, :])
        walls = [mesh.corners_enu_m for mesh in (model.building, *model.obstacles) if len(mesh.triangles)]
        # Not Open3D, whose loading alone would hold the interpreter of a window for 0.2 s at a stretch.
        self._bvh = build_bvh(np.concatenate([glass, *walls]))
        self._facts, self._rays = facts, sphere(N_RAYS)
        self._is_sky = self._rays[:, 2] > math.sin(math.radians(facts.mask_deg))

    def at(self, position_enu_m: Vec3) -> Sky:
        """Sky of one place."""
        facts, rays = self._facts, self._rays
        way_m, pane = self._cast(np.broadcast_to(np.array(position_enu_m), rays.shape), rays)
        hidden = float(np.mean(np.isfinite(way_m[self._is_sky])))
        at_glass = np.flatnonzero((pane >= 0) & (pane < len(self._normals)))
        m, n = rays[at_glass], self._normals[pane[at_glass]]
        facing = np.einsum("ij,ij->i", m, n)
        d = m - 2.0 * facing[:, None] * n
        to_sky = (facing < 0.0) & (d[:, 2] > math.sin(math.radians(facts.mask_deg)))
        at_glass, m, n, d = at_glass[to_sky], m[to_sky], n[to_sky], d[to_sky]
        if len(at_glass):
            points = np.array(position_enu_m) + way_m[at_glass, None] * m + 2.0 * GLASS_IN_FRONT_M * n
            is_free = ~np.isfinite(self._cast(points, d)[0])
            at_glass, m, d = at_glass[is_free], m[is_free], d[is_free]
        n_sky = int(self._is_sky.sum())
        extra_m = way_m[at_glass] * (1.0 - np.einsum("ij,ij->i", m, d))
        n_received = max(1.0, n_sky * (1.0 - hidden))
        # A reflection in phase or against it: the code is late by a share of the extra way, up to half the correlator's
        # spacing (Kaplan and Hegarty 2006, Understanding GPS, section 6.3); its phase is anything, hence the root of 2.
        widest_m = 0.5 * facts.spacing_chips * facts.chip_m
        code_m = facts.amplitude * np.minimum(extra_m, widest_m) / math.sqrt(2.0)
        phase_m = facts.wavelength_m / (2.0 * math.pi) * math.asin(facts.amplitude) / math.sqrt(2.0)
        share = min(1.0, len(at_glass) / n_received)
        code_error_m = min(float(np.sqrt((code_m**2).sum() / n_received)), facts.amplitude * widest_m)
        return Sky(hidden, len(at_glass) / n_sky, code_error_m, phase_m * math.sqrt(share))

    def _cast(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.int64]]:
        """Way to the first thing on each ray (infinite: none), and which pane it is (none: -1, or their number)."""
        way_m, triangle = np.empty(len(origins)), np.empty(len(origins), np.int64)
        first_hits(self._bvh, np.ascontiguousarray(origins), directions, FARTHEST_M, way_m, triangle)
        return way_m, triangle // 2


def position_error_m(sky: Sky, kind: FixKind, facts: MultipathFacts, receivers: dict[str, ReceiverFacts]) -> Vec3:
    """1 sigma of the position by axis: dilution of precision times the error of the ranges.

    With ambiguities fixed the carrier's error counts, alone the code's; in between the code's in the proportion of the
    receivers' own errors. Dilution grows as the root of the satellites lost.
    """
    if kind == "rtk-fixed":
        range_m = sky.phase_error_m
    else:
        range_m = sky.code_error_m * receivers[kind].horizontal_m / receivers["single"].horizontal_m
    dilution = 1.0 / math.sqrt(max(1.0 - sky.hidden, 0.1))
    level_m = dilution * facts.hdop / math.sqrt(2.0) * range_m
    return level_m, level_m, dilution * facts.vdop * range_m


class ReflectedReceiver:
    """The part of the aircraft: an error that grows near glass, and what the receiver says then.

    Parameters
    ----------
    inner
        The receiver without reflections.
    """

    def __init__(
        self, sky: GlassSky, kind: FixKind, inner: Receiver, *, gives_height: bool, rng: np.random.Generator
    ) -> None:
        facts = effect_facts()
        self._sky, self._kind, self._inner, self._facts = sky, kind, inner, facts
        self._gives_height = gives_height
        self._noise = SmoothNoise((1.0, 1.0, 1.0), facts.multipath.correlation_s, rng)
        self._above_start = AboveStart()
        self._counted_at: Vec3 | None = None
        self._here = Sky(0.0, 0.0, 0.0, 0.0)
        self._goal = self._sigma = (0.0, 0.0, 0.0)
        self.offset_enu_m: Vec3 = (0.0, 0.0, 0.0)

    @property
    def fix(self) -> Fix:
        """Fewer satellites, and errors added in squares."""
        inner, (x, y, z) = self._inner.fix, self._sigma
        n = round(inner.n_satellites * (1.0 - self._here.hidden))
        level_m = math.hypot(inner.horizontal_accuracy_m, x, y)
        return Fix(inner.fix_type, n, level_m, math.hypot(inner.vertical_accuracy_m, z))

    def step(self, duration_s: float, position_enu_m: Vec3, *, flies: bool) -> None:
        """Let the error change for a time, at a place."""
        if self._counted_at is None or math.dist(self._counted_at, position_enu_m) > MOVED_M:
            self._here = self._sky.at(position_enu_m)
            self._goal = position_error_m(self._here, self._kind, self._facts.multipath, self._facts.receivers)
            if self._counted_at is None:
                self._sigma = self._goal
            self._counted_at = position_enu_m
        keep = math.exp(-duration_s / BLEND_S)
        sx, sy, sz = (goal + keep * (now - goal) for now, goal in zip(self._sigma, self._goal, strict=True))
        self._sigma = sx, sy, sz
        self._noise.step(duration_s)
        x, y, z = self._noise.value
        height_m = sz * z if self._gives_height else 0.0
        self.offset_enu_m = sx * x, sy * y, self._above_start(height_m, flies=flies)


class Multipath:
    """The effect: error of the position at the shutter by reflections."""

    name = "multipath"
    unit = say("m at the shutter")
    tolerance = 0.05
    """A tenth of the 0.5 m by which a photo may be off its viewpoint."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Root mean square over the views of the error, all axes that the receiver gives."""
        n = len(scene.views_enu_m)
        if n == 0:
            return Assessment(0.0, say("there are no views"), 0.0)
        facts, kind = effect_facts(), scene.conditions.fix
        sky = GlassSky(scene.site_model, facts.multipath)
        chosen = np.unique(np.linspace(0, n - 1, min(n, MAX_PLACES)).astype(np.int64))
        skies = [sky.at((float(x), float(y), float(z))) for x, y, z in scene.views_enu_m[chosen]]
        errors = np.array([position_error_m(one, kind, facts.multipath, facts.receivers) for one in skies])
        if not scene.conditions.height_by_gnss:
            errors[:, 2] = 0.0
        hidden, mirrored = (float(np.mean([getattr(one, name) for one in skies])) for name in ("hidden", "mirrored"))
        reason = (
            say(
                "at the views {:.0%} of the sky are mirrored in glass and {:.0%} hidden, carrier phase counts",
                mirrored,
                hidden,
            )
            if kind == "rtk-fixed"
            else say(
                "at the views {:.0%} of the sky are mirrored in glass and {:.0%} hidden, code counts", mirrored, hidden
            )
        )
        cost_s = scene.n_steps * COST_PER_STEP_S + scene.length_m / MOVED_M * COST_PER_METRE_S
        return Assessment(float(np.sqrt((errors**2).sum(axis=1).mean())), reason, cost_s)
