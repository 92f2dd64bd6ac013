"""Occlusion: whether something stands between a camera and a panel, and whether a scene calls for asking.

Lines of sight run to a point 0.15 m in front of the panel's centroid.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.jit import chunks
from planning.base.messages import say
from planning.coverage.sections import PanelFrames
from planning.geo.line_of_sight import OCCLUSION_OFFSET_M, line_of_sight

Array = NDArray[np.float64]


N_PROBES = 3000
PROBE_PANELS = 400
"""Sample of places and panels from which the share of blocked lines is estimated (at most 1.2 million lines)."""

RAYS_PER_SECOND = 5e6
"""Rate assumed for the stated cost; 1 to 2 cores reach 10 to 30 million."""


@dataclass(frozen=True, slots=True, eq=False)
class OcclusionScene:
    """What the effect looks at: panels, everything that could hide them, and places where a camera may be."""

    frames: PanelFrames
    corners_enu_m: Array
    places_enu_m: Array


def rises_above_a_panel(frames: PanelFrames, corners_enu_m: Array) -> bool:
    """Whether any triangle reaches in front of any panel's plane (through the point lines of sight run to).

    Where none does, no line of sight from in front of a panel can be blocked: an exact answer for planar and convex
    buildings that stand alone.
    """
    vertices = np.unique(corners_enu_m.reshape(-1, 3), axis=0)
    targets = frames.centroids + OCCLUSION_OFFSET_M * frames.normals
    offsets = np.einsum("mk,mk->m", targets, frames.normals)
    for start, stop in chunks(len(vertices), max(1, 4_000_000 // len(frames))):
        if (vertices[start:stop] @ frames.normals.T > offsets).any():
            return True
    return False


class Occlusion:
    """The effect: the share of lines of sight, in per cent, that something blocks."""

    name = "occlusion"
    unit = say("% of the lines of sight")
    tolerance = 0.5

    def assess(self, scene: OcclusionScene) -> Assessment:
        """Exactly zero where nothing rises in front of a panel; else estimated on a sample of lines."""
        if not rises_above_a_panel(scene.frames, scene.corners_enu_m):
            return Assessment(0.0, say("nothing stands in front of any panel"), 0.0)
        if len(scene.places_enu_m) == 0:
            return Assessment(0.0, say("there is no place to look from"), 0.0)
        started = time.perf_counter()
        rng = np.random.default_rng(0)
        places = scene.places_enu_m[_sample(rng, len(scene.places_enu_m), N_PROBES)]
        chosen = _sample(rng, len(scene.frames), PROBE_PANELS)
        centroids, normals = scene.frames.centroids[chosen], scene.frames.normals[chosen]
        in_front = np.einsum("nmk,mk->nm", places[:, None, :] - centroids[None, :, :], normals) > 0.0
        place, panel = np.nonzero(in_front)
        if len(place) == 0:
            return Assessment(0.0, say("no allowed place lies in front of a panel"), 0.0)
        targets = centroids + OCCLUSION_OFFSET_M * normals
        free = line_of_sight(scene.corners_enu_m)(places[place], targets[panel])
        share = 100.0 * float(np.mean(~free))
        n_hit = len(np.unique(panel[~free]))
        reason = say("something stands in front of {:.0f} % of the panels", 100 * n_hit / len(chosen))
        cost = time.perf_counter() - started + len(scene.frames) * 40_000 / RAYS_PER_SECOND
        return Assessment(share, reason, cost)


def _sample(rng: np.random.Generator, n: int, size: int) -> NDArray[np.int64]:
    """At most `size` different indices below n, in order."""
    return np.sort(rng.choice(n, min(n, size), replace=False))
