"""Branch and bound over the allowed space for one hemisphere section: a witness, a proof of none, or neither.

The airspace box is divided into smaller boxes (cells). A cell is dropped when no point of it can be a viewpoint that
covers the section:

- it lies wholly outside the section's cone, behind the panel, beyond the largest distance, or at elevations at which
  the gimbal cannot bring the centroid into the picture (all bounded by the cell's circumscribed sphere);
- it lies wholly too low above the terrain, where there is one: below its lowest node by more than what is kept;
- it lies wholly too close to something: distances change by at most one metre per metre, so distance(centre) + radius
  below the minimum distance is a proof; likewise inside a solid or a no-fly volume;
- with occlusion: its eight corners lie in the shadow of one convex group (`planning.coverage.reachability`).

Where all cells are dropped the section is proven unreachable. A cell's centre that passes every test with the margins
of real viewpoints is a witness. Cells that reach the smallest size leave the section undecided.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from planning.geo.bvh import Bvh, nearest_d2, segment_hits, segment_is_free
from planning.geo.height_field import heights_below
from planning.geo.solids import _is_inside

Array = NDArray[np.float64]

UNREACHABLE, REACHABLE, UNDECIDED = 0, 1, 2

ANGLE_MARGIN = 1e-5
"""Witnesses stay this far (radians) inside their section and the gimbal's range, out of reach of rounding."""

PROOF_SLACK_M = 1e-6
"""Proofs concede this much, far more than float64 rounding at local coordinates."""

MAX_STACK = 4096
"""Cells waiting; halving 4 096 m down to 1 cm on three axes keeps fewer than 60."""


MAX_NODES = 1024
"""Nodes of the terrain looked at below a cell; wider ones are divided first."""


class Limits(NamedTuple):
    """What viewpoints must keep. Distances `need_*` hold for witnesses, `proof_*` for proofs (never larger).

    `terrain` holds heights as those of a `HeightField` with its west, south and step in `grid`; without nodes, the
    ground is level and below `low`.
    """

    low: Array
    high: Array
    need_distance: float
    proof_distance: float
    need_no_fly: float
    lowest_sine: float
    highest_sine: float
    max_distance: float
    occlusion: bool
    margin: float
    terrain: Array
    grid: tuple[float, float, float]
    min_height: float


class Bodies(NamedTuple):
    """Everything solid: tree, closed parts and convex groups (both in the tree's order), and a length beyond all."""

    bvh: Bvh
    part: NDArray[np.int64]
    group: NDArray[np.int64]
    reach: float
    rays: Array


@inline
def _support(v: Array, half: Array) -> float:
    """How far a box with half sizes `half` reaches along v from its centre."""
    return float(abs(v[0]) * half[0] + abs(v[1]) * half[1] + abs(v[2]) * half[2])


@kernel
def _misses_section(offset: Array, half: Array, radius: float, panel: Array, bounds: Array, limits: Limits) -> bool:
    """Whether no point of the cell (centre at `offset` from the centroid) lies in the section's cone and range."""
    normal, tangent, bitangent = panel[3:6], panel[6:9], panel[9:12]
    along = offset[0] * normal[0] + offset[1] * normal[1] + offset[2] * normal[2]
    if along + _support(normal, half) <= 0.0:
        return True
    u = offset[0] * tangent[0] + offset[1] * tangent[1] + offset[2] * tangent[2]
    v = offset[0] * bitangent[0] + offset[1] * bitangent[1] + offset[2] * bitangent[2]
    low_side = np.cos(bounds[2]) * bitangent - np.sin(bounds[2]) * tangent
    high_side = np.sin(bounds[3]) * tangent - np.cos(bounds[3]) * bitangent
    if -np.sin(bounds[2]) * u + np.cos(bounds[2]) * v + _support(low_side, half) < -PROOF_SLACK_M:
        return True
    if np.sin(bounds[3]) * u - np.cos(bounds[3]) * v + _support(high_side, half) < -PROOF_SLACK_M:
        return True
    distance = np.sqrt(offset[0] ** 2 + offset[1] ** 2 + offset[2] ** 2)
    if distance - radius > limits.max_distance + PROOF_SLACK_M:
        return True
    if distance <= radius:
        return False
    spread = np.arcsin(radius / distance) + 1e-9
    theta = np.arccos(min(max(along / distance, -1.0), 1.0))
    if theta - spread >= bounds[1] or theta + spread < bounds[0]:
        return True
    elevation = np.arcsin(min(max(-offset[2] / distance, -1.0), 1.0))
    too_high = elevation - spread > np.arcsin(limits.highest_sine)
    return bool(too_high or elevation + spread < np.arcsin(limits.lowest_sine))


@kernel
def _is_shadowed(centre: Array, half: Array, target: Array, bodies: Bodies) -> bool:
    """Whether all lines from the target to the cell meet one and the same convex group."""
    corner = np.empty(3)
    hits = np.empty(64, np.int64)
    common = np.empty(64, np.int64)
    n_common = 0
    for c in range(8):
        for axis in range(3):
            corner[axis] = centre[axis] + (half[axis] if (c >> axis) & 1 else -half[axis])
        n = min(segment_hits(bodies.bvh, target, corner, hits), 64)
        if c == 0:
            for i in range(n):
                common[i] = bodies.group[hits[i]]
            n_common = n
        else:
            kept = 0
            for i in range(n_common):
                for k in range(n):
                    if bodies.group[hits[k]] == common[i]:
                        common[kept] = common[i]
                        kept += 1
                        break
            n_common = kept
        if n_common == 0:
            return False
    return True


@kernel
def _is_witness(p: Array, panel: Array, bounds: Array, limits: Limits) -> bool:
    """Whether p lies in the section, the range and the gimbal's reach, with margins; distances are tested elsewhere."""
    dx, dy, dz = p[0] - panel[0], p[1] - panel[1], p[2] - panel[2]
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    if distance <= 0.0 or distance >= limits.max_distance - limits.margin:
        return False
    along = (dx * panel[3] + dy * panel[4] + dz * panel[5]) / distance
    theta = np.arccos(min(max(along, -1.0), 1.0))
    if theta < bounds[0] + ANGLE_MARGIN * (bounds[0] > 0.0) or theta > bounds[1] - ANGLE_MARGIN:
        return False
    u = dx * panel[6] + dy * panel[7] + dz * panel[8]
    v = dx * panel[9] + dy * panel[10] + dz * panel[11]
    margin = ANGLE_MARGIN * distance
    if (
        -np.sin(bounds[2]) * u + np.cos(bounds[2]) * v < margin
        or np.sin(bounds[3]) * u - np.cos(bounds[3]) * v < margin
    ):
        return False
    sine = -dz / distance
    return bool(limits.lowest_sine + ANGLE_MARGIN < sine < limits.highest_sine - ANGLE_MARGIN)


@kernel
def is_too_low(centre: Array, half: Array, terrain: Array, grid: tuple[float, float, float], min_height: float) -> bool:
    """Whether the whole cell lies too low above the terrain, or where nothing is known of it; as in `Limits`."""
    n_rows, n_columns = terrain.shape
    west, south, step = grid
    first_column = int(max(np.floor((centre[0] - half[0] - west) / step), 0.0))
    last_column = int(min(np.ceil((centre[0] + half[0] - west) / step), n_columns - 1.0))
    first_row = int(max(np.floor((centre[1] - half[1] - south) / step), 0.0))
    last_row = int(min(np.ceil((centre[1] + half[1] - south) / step), n_rows - 1.0))
    if (last_column - first_column + 1) * (last_row - first_row + 1) > MAX_NODES:
        return False
    lowest = np.inf
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            if terrain[row, column] < lowest:
                lowest = terrain[row, column]
    return bool(centre[2] + half[2] < lowest + min_height - PROOF_SLACK_M)


@kernel
def terrain_below(p: Array, limits: Limits) -> float:
    """Upper bound of the terrain below a point; infinite where nothing is known."""
    ground = np.empty(1)
    west, south, step = limits.grid
    heights_below(limits.terrain, west, south, step, p.reshape(1, 3), ground)
    return ground[0] if ground[0] == ground[0] else np.inf


@kernel
def decide_section(
    panel: Array,
    target: Array,
    bounds: Array,
    limits: Limits,
    solids: Bodies,
    no_fly: Bodies,
    smallest: float,
    max_cells: int,
    witness: Array,
) -> int:
    """REACHABLE with `witness` filled, UNREACHABLE (proven) or UNDECIDED.

    Parameters
    ----------
    panel
        Centroid, normal, tangent, bitangent: shape (12,).
    target
        Where lines of sight end, shape (3,).
    bounds
        Lowest and highest theta, lowest and highest phi of the section, radians.
    smallest
        Cells with a smaller circumscribed radius are not divided, metres.
    max_cells
        Cells looked at before giving up.
    """
    centres, halves = np.empty((MAX_STACK, 3)), np.empty((MAX_STACK, 3))
    for axis in range(3):
        centres[0, axis] = 0.5 * (limits.low[axis] + limits.high[axis])
        halves[0, axis] = 0.5 * (limits.high[axis] - limits.low[axis])
    waiting, looked_at, undecided = 1, 0, False
    centre, half, offset = np.empty(3), np.empty(3), np.empty(3)
    while waiting > 0:
        waiting -= 1
        looked_at += 1
        if looked_at > max_cells:
            return UNDECIDED
        for axis in range(3):
            centre[axis], half[axis] = centres[waiting, axis], halves[waiting, axis]
            offset[axis] = centre[axis] - panel[axis]
        radius = np.sqrt(half[0] ** 2 + half[1] ** 2 + half[2] ** 2)
        if _misses_section(offset, half, radius, panel, bounds, limits):
            continue
        if limits.terrain.size > 0 and is_too_low(centre, half, limits.terrain, limits.grid, limits.min_height):
            continue
        reach = limits.need_distance + radius
        clearance = np.sqrt(nearest_d2(solids.bvh, centre, reach * reach))
        if clearance + radius < limits.proof_distance - PROOF_SLACK_M:
            continue
        if _is_inside(solids.bvh, solids.part, centre, solids.reach, solids.rays):
            if clearance > radius + PROOF_SLACK_M:
                continue
            clearance = -1.0
        forbidden = np.inf
        if len(no_fly.part) > 0:
            reach = limits.need_no_fly + radius
            forbidden = np.sqrt(nearest_d2(no_fly.bvh, centre, reach * reach))
            if _is_inside(no_fly.bvh, no_fly.part, centre, no_fly.reach, no_fly.rays):
                if forbidden > radius + PROOF_SLACK_M:
                    continue
                forbidden = -1.0
        if limits.occlusion and _is_shadowed(centre, half, target, solids):
            continue
        if (
            clearance >= limits.need_distance
            and forbidden >= limits.need_no_fly
            and _is_witness(centre, panel, bounds, limits)
            and (
                limits.terrain.size == 0
                or centre[2] - terrain_below(centre, limits) >= limits.min_height + limits.margin
            )
            and (not limits.occlusion or segment_is_free(solids.bvh, target, centre))
        ):
            witness[:] = centre
            return REACHABLE
        if radius < smallest or waiting + 2 > MAX_STACK:
            undecided = True
            continue
        longest = 0 if half[0] >= half[1] and half[0] >= half[2] else (1 if half[1] >= half[2] else 2)
        for side in range(2):
            for axis in range(3):
                centres[waiting, axis], halves[waiting, axis] = centre[axis], half[axis]
            halves[waiting, longest] = 0.5 * half[longest]
            centres[waiting, longest] += (side - 0.5) * half[longest]
            waiting += 1
    return UNDECIDED if undecided else UNREACHABLE


@kernel
def decide_sections(
    panels: Array,
    targets: Array,
    panel_of: NDArray[np.int64],
    bounds: Array,
    limits: Limits,
    solids: Bodies,
    no_fly: Bodies,
    smallest: float,
    max_cells: int,
    witnesses: Array,
    verdicts: NDArray[np.int8],
) -> None:
    """`decide_section` for k sections: panel numbers (k,), bounds (k, 4); fills witnesses (k, 3) and verdicts (k,)."""
    for i in range(len(panel_of)):
        j = panel_of[i]
        verdicts[i] = decide_section(
            panels[j], targets[j], bounds[i], limits, solids, no_fly, smallest, max_cells, witnesses[i]
        )
