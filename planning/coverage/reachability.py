"""What can be reached at all: for every hemisphere section a witness viewpoint, a proof that none exists, or neither.

Witnesses are first looked for on well-spread positions, many at a time; what is left is decided one by one by branch
and bound (`planning.coverage.reach_kernel`). Sections that neither settles count as reachable, so the number of
sections that are not proven unreachable is an upper bound on what any set of allowed viewpoints covers.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from planning.base.jit import chunks, n_threads, run_parallel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, never
from planning.coverage.model import CoverageModel, codes_all_around
from planning.coverage.positions import spread_positions
from planning.coverage.reach_kernel import (
    ANGLE_MARGIN,
    REACHABLE,
    UNDECIDED,
    UNREACHABLE,
    Bodies,
    Limits,
    decide_sections,
)
from planning.geo.mesh import closed_parts, row_numbers
from planning.geo.solids import INSIDE_RAYS, Solids
from planning.plan import Camera
from planning.site.free_space import SAFETY_MARGIN_M, FreeSpace

Array = NDArray[np.float64]


# Convex groups of triangles: what can hide a whole region of space at once.
#
# From an apex outside a convex body, the points whose line to the apex meets the body form a convex set (its shadow).
# So a box lies in the shadow as soon as its eight corners do. Triangles are grouped into bodies for which that holds:
# closed convex parts, flat convex patches, and single triangles for the rest.

FLATNESS = 1e-6
"""Vertices this far (times the extent of the group) on the wrong side of a plane still count as on it."""


def convex_groups(corners_enu_m: Array) -> NDArray[np.int64]:
    """Number of the convex group of each triangle, shape (t,), from corners of shape (t, 3, 3)."""
    n = len(corners_enu_m)
    group = np.arange(n)
    part = closed_parts(corners_enu_m)
    grouped = np.zeros(n, np.bool_)
    for closed in range(part.max() + 1 if n else 0):
        members = np.flatnonzero(part == closed)
        if _is_convex_body(corners_enu_m[members]):
            group[members] = members[0]
            grouped[members] = True
    rest = np.flatnonzero(~grouped)
    for members in _flat_patches(corners_enu_m[rest]):
        patch = rest[members]
        if len(patch) > 1 and _is_convex_patch(corners_enu_m[patch]):
            group[patch] = patch[0]
    return group


def _plane(corners: Array) -> tuple[Array, Array]:
    """Unit normals (zero for degenerate triangles) and offsets along them, shapes (t, 3) and (t,)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return normals, np.einsum("tk,tk->t", normals, corners[:, 0])


def _is_convex_body(corners: Array) -> bool:
    """Whether all vertices lie on one side of every face."""
    vertices = np.unique(corners.reshape(-1, 3), axis=0)
    normals, offsets = _plane(corners)
    if len(vertices) * len(normals) > 4_000_000:
        return False  # so finely meshed a part is not worth the test; its patches still count
    heights = vertices @ normals.T - offsets
    slack = FLATNESS * float(np.ptp(vertices, axis=0).max())
    return bool(((heights <= slack).all(axis=0) | (heights >= -slack).all(axis=0)).all())


def _flat_patches(corners: Array) -> list[NDArray[np.int64]]:
    """Triangles that share edges and a plane, patch by patch."""
    n = len(corners)
    if n == 0:
        return []
    triangles = row_numbers(corners.reshape(-1, 3).round(6)).reshape(n, 3)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(n), 3)
    edge = row_numbers(edges)
    order = np.argsort(edge, kind="stable")
    same = np.flatnonzero(np.diff(edge[order]) == 0)
    a, b = owner[order[same]], owner[order[same + 1]]
    normals, offsets = _plane(corners)
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    parallel = np.abs(np.einsum("tk,tk->t", normals[a], normals[b])) > 1.0 - 1e-10
    level = (
        np.abs(np.einsum("tck,tk->tc", corners[b], normals[a]) - offsets[a][:, None]).max(axis=1) < FLATNESS * extent
    )
    joined = parallel & level
    graph = coo_array((np.ones(joined.sum()), (a[joined], b[joined])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def _is_convex_patch(corners: Array) -> bool:
    """Whether flat triangles that cover each point once fill their convex hull."""
    import shapely

    normals, _ = _plane(corners)
    normal = normals[np.argmax(np.linalg.norm(normals, axis=1))]
    first = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    basis = np.stack([first, np.cross(normal, first)], axis=1)
    flat = corners @ basis
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()
    hull = shapely.MultiPoint(flat.reshape(-1, 2)).convex_hull.area
    union = shapely.union_all(shapely.polygons(flat)).area if abs(area - hull) > 1e-9 * hull else area
    return bool(abs(union - hull) <= 1e-9 * hull)


POSITIONS_PER_BLOCK = 512
MAX_POSITIONS = 24_576
IDLE_BLOCKS = 6
"""The search on spread positions ends after this many blocks in a row that settled under 0.02 % of the sections."""

PASSES = ((0.1, 1.0), (0.02, 1.0))
"""Smallest cell (metres) and share of `max_cells` of each pass over the sections that are still open. Cells of 0.1 m
alone left 18 sections of the library undecided, the second pass none; fine cells at once spend the effort in one place.
"""

MAX_CELLS = 6000
"""Effort per section."""


@dataclass(frozen=True, slots=True, eq=False)
class Reachability:
    """Verdict and witness of every section.

    Parameters
    ----------
    verdicts
        REACHABLE, UNREACHABLE (proven) or UNDECIDED, shape (m, n_sections), int8.
    witnesses_enu_m
        A viewpoint position for each reachable section, shape (m, n_sections, 3), NaN for the others.
    seconds
        Time it took.
    """

    verdicts: NDArray[np.int8]
    witnesses_enu_m: Array
    seconds: float

    @property
    def n_reachable(self) -> int:
        """Sections with a witness."""
        return int((self.verdicts == REACHABLE).sum())

    @property
    def n_undecided(self) -> int:
        """Sections with neither witness nor proof."""
        return int((self.verdicts == UNDECIDED).sum())

    @property
    def upper_bound(self) -> int:
        """Sections not proven unreachable: no set of allowed viewpoints covers more."""
        return int((self.verdicts != UNREACHABLE).sum())


def elevation_range_rad(camera: Camera) -> tuple[float, float]:
    """Lowest and highest elevation, seen from the camera, that the gimbal can bring into the picture.

    With image coordinates x, y (tangents) and pitch p, a point's elevation is asin((sin p + y cos p) / sqrt(1 + x^2 +
    y^2)); its extremes over the picture and the gimbal's range lie on the borders or at a pole.
    """
    lowest, highest = np.radians(camera.gimbal_pitch_deg)
    half = float(np.arctan(camera.half_height))
    extremes = []
    for sign, pitch in ((1.0, highest), (-1.0, -lowest)):
        # Upwards as it stands, downwards as the mirror image.
        if pitch + half >= 0.5 * np.pi:
            extremes.append(sign * 0.5 * np.pi)
            continue
        y = np.array([-camera.half_height, camera.half_height])
        x = np.array([0.0, camera.half_width])[:, None]
        if np.sin(pitch) != 0.0:
            # The derivative along y vanishes at y = (1 + x^2) / tan p.
            inner = np.clip((1.0 + x**2) * np.cos(pitch) / np.sin(pitch), y[0], y[1])
            y = np.concatenate([np.broadcast_to(y, (2, 2)), inner], axis=1)
        sine = (np.sin(pitch) + y * np.cos(pitch)) / np.sqrt(1.0 + x**2 + y**2)
        extremes.append(sign * float(np.arcsin(sine.max())))
    return extremes[1], extremes[0]


def find_reachable(
    model: CoverageModel,
    space: FreeSpace,
    seed: int = 0,
    max_positions: int = MAX_POSITIONS,
    max_cells: int = MAX_CELLS,
    stop: Stop = never,
    monitor: Monitor = QUIET,
) -> Reachability:
    """Decide every section of every panel.

    `max_positions` and `max_cells` trade time for fewer undecided sections; the bound holds whatever they are. When
    `stop` asks for an end, sections not yet looked at stay undecided.
    """
    started = time.perf_counter()
    m, n_sections = len(model.frames), model.grid.n_sections
    verdicts = np.full(m * n_sections, UNDECIDED, np.int8)
    witnesses = np.full((m * n_sections, 3), np.nan)
    _search_spread_positions(model, space, seed, max_positions, verdicts, witnesses, stop, monitor)
    _branch_and_bound(model, space, max_cells, verdicts, witnesses, stop, monitor)
    return Reachability(
        verdicts.reshape(m, n_sections),
        witnesses.reshape(m, n_sections, 3),
        time.perf_counter() - started,
    )


def _search_spread_positions(
    model: CoverageModel,
    space: FreeSpace,
    seed: int,
    max_positions: int,
    verdicts: NDArray[np.int8],
    witnesses: Array,
    stop: Stop,
    monitor: Monitor,
) -> None:
    """Settle sections that some well-spread position sees; fills `verdicts` and `witnesses` in place."""
    positions = spread_positions(space, model.frames, max_positions, np.random.default_rng(seed))
    idle = 0
    for start, end in chunks(len(positions), POSITIONS_PER_BLOCK):
        monitor.report(say("looking for viewpoints"), start, len(positions))
        if stop() or idle >= IDLE_BLOCKS:
            return
        points = positions[start:end]
        panel, section, point = _open_pairs(model, points, verdicts)
        kept = keeps_margins(model, points[point], panel, section)
        panel, section, point = panel[kept], section[kept], point[kept]
        if model.sight is not None:
            free = model.sight(points[point], model.targets_enu_m[panel])
            panel, section, point = panel[free], section[free], point[free]
        element, first = np.unique(panel * model.grid.n_sections + section, return_index=True)
        verdicts[element] = REACHABLE
        witnesses[element] = points[point[first]]
        idle = idle + 1 if len(element) < 2e-4 * len(verdicts) else 0


def _open_pairs(
    model: CoverageModel, points: Array, verdicts: NDArray[np.int8]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Panel, section and point number of the pairs whose section is still undecided."""
    codes = codes_all_around(model, points)
    panel, point = np.nonzero(codes)
    section = codes[panel, point].astype(np.int64) - 1
    still_open = verdicts[panel * model.grid.n_sections + section] == UNDECIDED
    return panel[still_open], section[still_open], point[still_open]


def keeps_margins(
    model: CoverageModel, points: Array, panel: NDArray[np.int64], section: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether points lie well inside their sections, the range and the gimbal's reach; arrays of k pairs."""
    frames, grid = model.frames, model.grid
    rays = points - frames.centroids[panel]
    distance = np.linalg.norm(rays, axis=1)
    d = rays / distance[:, None]
    step = np.radians(grid.step_deg)
    theta = np.arccos(np.clip(np.einsum("kc,kc->k", d, frames.normals[panel]), -1.0, 1.0))
    u, v = (np.einsum("kc,kc->k", d, axis[panel]) for axis in (frames.tangents, frames.bitangents))
    phi = np.mod(np.arctan2(v, u), 2.0 * np.pi)
    ring, sector = section // grid.n_sectors, section % grid.n_sectors
    theta_gap = np.minimum(np.where(ring == 0, np.inf, theta - ring * step), (ring + 1) * step - theta)
    phi_gap = np.minimum(phi - sector * step, (sector + 1) * step - phi) * np.sin(theta)
    lowest, highest = elevation_range_rad(model.camera)
    elevation = np.arcsin(np.clip(-d[:, 2], -1.0, 1.0))
    elevation_gap = np.minimum(elevation - lowest, highest - elevation)
    in_range = True if model.max_distance_m is None else distance < model.max_distance_m - SAFETY_MARGIN_M
    smallest_gap = np.minimum(np.minimum(theta_gap, phi_gap), elevation_gap)
    return np.asarray((smallest_gap > ANGLE_MARGIN) & in_range)


def _branch_and_bound(
    model: CoverageModel,
    space: FreeSpace,
    max_cells: int,
    verdicts: NDArray[np.int8],
    witnesses: Array,
    stop: Stop,
    monitor: Monitor,
) -> None:
    """Decide the sections that are left, one by one, on all cores."""
    frames, grid = model.frames, model.grid
    panels = np.concatenate([frames.centroids, frames.normals, frames.tangents, frames.bitangents], axis=1)
    all_bounds = np.array([grid.bounds_rad(section) for section in range(grid.n_sections)])
    limits = reach_limits(model, space)
    solids, no_fly = reach_bodies(space.solids, model.sight is not None), reach_bodies(space.no_fly, False)

    def decide(elements: NDArray[np.int64], smallest_m: float, n_cells: int) -> None:
        found, verdict = np.full((len(elements), 3), np.nan), np.empty(len(elements), np.int8)
        panel, section = elements // grid.n_sections, elements % grid.n_sections
        bounds, targets = all_bounds[section], model.targets_enu_m
        decide_sections(panels, targets, panel, bounds, limits, solids, no_fly, smallest_m, n_cells, found, verdict)
        verdicts[elements], witnesses[elements] = verdict, found

    for smallest_m, share in PASSES:
        still_open = np.flatnonzero(verdicts == UNDECIDED)
        size = max(1, min(64, len(still_open) // (4 * n_threads())))
        for first, last in chunks(len(still_open), 4 * n_threads() * size):
            monitor.report(say("proving what cannot be seen"), first, len(still_open))
            if stop():
                return
            parts = [still_open[first:last][start:end] for start, end in chunks(last - first, size)]
            run_parallel(decide, [(part, smallest_m, int(share * max_cells)) for part in parts])


def reach_limits(model: CoverageModel, space: FreeSpace) -> Limits:
    """What the compiled search must know of camera, airspace and distances."""
    lowest, highest = elevation_range_rad(model.camera)
    terrain = None if space.ground.terrain is None or space.min_height_m is None else space.ground.terrain.upper
    return Limits(
        low=space.low_enu_m,
        high=space.high_enu_m,
        need_distance=space.min_distance_m + SAFETY_MARGIN_M,
        proof_distance=space.min_distance_m,
        need_no_fly=space.no_fly_distance_m + SAFETY_MARGIN_M,
        lowest_sine=float(np.sin(lowest)),
        highest_sine=float(np.sin(highest)),
        max_distance=np.inf if model.max_distance_m is None else model.max_distance_m,
        occlusion=model.sight is not None,
        margin=SAFETY_MARGIN_M,
        terrain=np.zeros((0, 0)) if terrain is None else terrain.z_m,
        grid=(0.0, 0.0, 1.0) if terrain is None else (terrain.west_m, terrain.south_m, terrain.step_m),
        min_height=0.0 if space.min_height_m is None else space.min_height_m,
    )


def reach_bodies(solids: Solids, with_groups: bool) -> Bodies:
    """Solids as the compiled search takes them; groups of convex parts are needed for occlusion only."""
    n = len(solids.part)
    group = np.arange(n)
    if with_groups:
        corners = np.empty_like(solids.bvh.corners)
        corners[solids.bvh.source] = solids.bvh.corners
        group = convex_groups(corners)[solids.bvh.source]
    return Bodies(solids.bvh, solids.part, group, solids.reach_m, INSIDE_RAYS)
