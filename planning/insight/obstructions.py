"""What stands where: which panel, building, obstacle or no-fly volume a triangle of the free space belongs to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel, run_chunks
from planning.base.messages import say
from planning.geo.bvh import (
    MAX_DEPTH,
    Bvh,
    nearest_d2,
    point_segment_d2,
    segment_d2,
    segment_hits,
    segment_hits_triangle,
    segment_triangle_d2,
)
from planning.geo.solids import MAX_HITS, Solids
from planning.site.free_space import FreeSpace
from planning.site.records import SiteModel
from planning.site.zones.keep_out import no_fly_volumes

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

ObstructionKind = Literal["panel", "building", "obstacle", "no-fly"]

TIE_M = 1e-6
"""Things that are nearer to each other than this at the nearest point share the place; the first in order is named."""

SEGMENTS_PER_CHUNK = 1024


@dataclass(frozen=True, slots=True)
class Obstruction:
    """Something to keep away from; the building has no identifier."""

    kind: ObstructionKind
    id: str = ""

    def __str__(self) -> str:
        """As it stands in a sentence."""
        name = {
            "panel": "panel",
            "building": say("the building"),
            "obstacle": "obstacle",
            "no-fly": say("no-fly volume"),
        }
        return f"{name[self.kind]} '{self.id}'" if self.id else name[self.kind]


@dataclass(frozen=True, slots=True, eq=False)
class Obstructions:
    """All things of a site, and the owner of every triangle of its free space.

    Parameters
    ----------
    all
        Panels in the site's order, the building, obstacles, no-fly volumes.
    n_panels
        The building is number `n_panels`.
    solid_owner, no_fly_owner
        Number of the thing that each triangle belongs to, in the order of the trees of `FreeSpace.solids` and
        `FreeSpace.no_fly`.
    """

    all: tuple[Obstruction, ...]
    n_panels: int
    solid_owner: Indices
    no_fly_owner: Indices


def obstructions_of(site_model: SiteModel, space: FreeSpace) -> Obstructions:
    """Owners of the triangles of a site's free space.

    Raises
    ------
    ValueError
        The space is not of this site.
    """
    site = site_model.site
    m, zones = site.n_panels, no_fly_volumes(site_model)
    named = (
        *(Obstruction("panel", panel.id) for panel in site.panels),
        Obstruction("building"),
        *(Obstruction("obstacle", obstacle.id) for obstacle in site.obstacles),
        *(Obstruction("no-fly", zone.id) for zone in zones),
    )
    # In the order in which `planning.site.free_space.unchecked_space` joins them.
    meshes = (site_model.building, *site_model.obstacles)
    sizes = np.array([2] * m + [len(mesh.triangles) for mesh in meshes])
    solid_owner = np.repeat(np.arange(len(sizes)), sizes)
    no_fly_owner = len(sizes) + np.repeat(np.arange(len(zones)), [len(zone.prism().triangles) for zone in zones])
    for owner, solids in ((solid_owner, space.solids), (no_fly_owner, space.no_fly)):
        if len(owner) != len(solids.bvh.source):
            raise ValueError(f"expected the space of this site, {len(owner)} triangles, got {len(solids.bvh.source)}")
    return Obstructions(
        named, m, solid_owner[space.solids.bvh.source], no_fly_owner.astype(np.int64)[space.no_fly.bvh.source]
    )


@kernel
def _nearest_triangles(bvh: Bvh, owner: Indices, a: Array, b: Array, slack: float, result: Indices) -> None:
    """Of the triangles nearest to segments, ends of shape (n, 3), the one with the least owner."""
    stack = np.empty(MAX_DEPTH, np.int64)
    for i in range(len(a)):
        d2 = segment_d2(bvh, a[i], b[i], np.inf) if (a[i] != b[i]).any() else nearest_d2(bvh, a[i], np.inf)
        margin = np.sqrt(d2) + slack
        stack[0], depth, best = 0, 1, -1
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if _is_farther(a[i], b[i], bvh.low[node], bvh.high[node], margin):
                continue
            child = bvh.child[node]
            if child >= 0:
                stack[depth], stack[depth + 1] = child, child + 1
                depth += 2
                continue
            for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                better = best < 0 or owner[k] < owner[best]
                if better and segment_triangle_d2(a[i], b[i], bvh.corners[k]) <= margin * margin:
                    best = k
        result[i] = best


@kernel
def _is_farther(a: Array, b: Array, low: Array, high: Array, margin: float) -> bool:
    """True only where segment ab is further than `margin` from the box: its box is, or ab from the other's sphere."""
    centre, radius2, gap2 = np.empty(3), 0.0, 0.0
    for axis in range(3):
        gap = max(min(a[axis], b[axis]) - high[axis], low[axis] - max(a[axis], b[axis]), 0.0)
        gap2 += gap * gap
        centre[axis] = 0.5 * (low[axis] + high[axis])
        radius2 += (0.5 * (high[axis] - low[axis])) ** 2
    reach = margin + np.sqrt(radius2)
    return gap2 > margin * margin or point_segment_d2(centre, a, b) > reach * reach


@kernel
def _first_hits(bvh: Bvh, owner: Indices, a: Array, b: Array, slack: float, result: Indices) -> None:
    """Least owner among the triangles that segments meet first, -1 for none; ends of shape (n, 3)."""
    hits = np.empty(MAX_HITS, np.int64)
    for i in range(len(a)):
        n, nearest = min(segment_hits(bvh, a[i], b[i], hits), MAX_HITS), np.inf
        for h in range(n):
            nearest = min(nearest, segment_hits_triangle(a[i], b[i], bvh.corners[hits[h]]))
        length2 = (b[i, 0] - a[i, 0]) ** 2 + (b[i, 1] - a[i, 1]) ** 2 + (b[i, 2] - a[i, 2]) ** 2
        tie = nearest + slack / np.sqrt(length2) if n > 0 else 0.0
        result[i] = -1
        for h in range(n):
            better = result[i] < 0 or owner[hits[h]] < result[i]
            if better and segment_hits_triangle(a[i], b[i], bvh.corners[hits[h]]) <= tie:
                result[i] = owner[hits[h]]


def nearest_triangles(solids: Solids, owner: Indices, a_enu_m: Array, b_enu_m: Array) -> Indices:
    """Triangle (in the tree's order) nearest to each segment, ends of shape (n, 3), which may coincide.

    Of several that are as near, one whose owner comes first; -1 where there is no triangle at all.

    Parameters
    ----------
    owner
        Of the triangles of `solids`, in the tree's order.
    """
    result = np.full(len(a_enu_m), -1, np.int64)
    if len(owner) == 0:
        return result
    a, b = np.ascontiguousarray(a_enu_m), np.ascontiguousarray(b_enu_m)

    def work(start: int, stop: int) -> None:
        _nearest_triangles(solids.bvh, owner, a[start:stop], b[start:stop], TIE_M, result[start:stop])

    run_chunks(work, chunks(len(result), SEGMENTS_PER_CHUNK))
    return result


def nearest_obstructions(solids: Solids, owner: Indices, points_enu_m: Array) -> Indices:
    """Number of the thing nearest to each point, shape (n, 3); -1 where there is nothing."""
    triangle = nearest_triangles(solids, owner, points_enu_m, points_enu_m)
    return owner[triangle] if len(owner) else triangle


def first_obstructions_hit(solids: Solids, owner: Indices, a_enu_m: Array, b_enu_m: Array) -> Indices:
    """Number of the thing that lines from a to b, shape (n, 3), meet first; -1 for none."""
    result = np.full(len(a_enu_m), -1, np.int64)
    _first_hits(solids.bvh, owner, np.ascontiguousarray(a_enu_m), np.ascontiguousarray(b_enu_m), TIE_M, result)
    return result
