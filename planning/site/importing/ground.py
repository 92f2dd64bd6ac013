"""The ground below an imported building, found in its triangles where the file does not state it; strays are left out.

The file is looked at from above, on a grid of about a metre. Surfaces that are open to the sky and that things rise
from, but do not fall from, are ground. Its height is read in a ring around what rises highest and widest, by bearing,
so that neither single points nor bushes, cars or pits count. A file without such a surface has walls that end
somewhere: where they end at one height along the outline, that is the ground. Where two answers are left, or none, the
user is asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import Placement

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SPACING_M = 0.33
"""Of the points that stand for the surfaces: nine on each square metre."""

MAX_SAMPLES = 1_000_000
"""Beyond, they are set further apart; 2 s for a scan of a million triangles."""

CELLS_PER_SPACING = 3
"""Width of a cell of the map: 1 m, or more where the file is large."""

MIN_CELL_SHARE = 0.25
"""Cells with less surface in them than this share of their own are empty: slivers and spikes."""

MAX_CELLS_ACROSS = 1500
"""Of the map, so that its memory is bounded by some 100 MB."""

SMALL_SHARE = 0.01
"""Pieces with less area than this share of the largest one say nothing about the ground."""

STRAY_DEPTH_M = 0.5
"""Small pieces whose top lies deeper below the ground are strays."""

STRAY_REACH_M = 60.0
"""Small pieces further from the rest, seen from above, are strays: the airspace ends at 40 m by default."""

FAR_FACTOR = 10.0
"""A vertex that lies so many times the size of all others away from them is wrong in any unit."""

MANY_POINTS = 20_000

STEEP = 0.3
"""Vertical part of the normal below which a surface is a wall: within 17 degrees of upright."""

SMOOTH_SLOPE = 0.75
"""Neighbouring cells on one surface differ by less than this times their width: slopes to 37 degrees."""

RISE_M = 2.0
"""What rises so far within two cells stands on the ground: walls, trees, cars of some size."""

DROP_M = 1.0
"""What falls so far to the next cell is the edge of a roof or a terrace."""

MIN_FOOT_CELLS = 5
MIN_GROUND_CELLS = 10
"""Smaller surfaces, or such from which nearly nothing rises, are none of the ground."""

MASS_SHARE = 0.25
"""Of the largest volume above ground: what has less is no part of the building whose surroundings count."""

RING_CELLS = (1, 5)
"""The ground is read so far from the building's outline: beyond the rounded foot of scanned walls."""

MIN_OUTLINE_SHARE = 0.25
"""Ground along a smaller part of the outline is a patch."""

MIN_GROUND_AREA = 0.25
"""Of the ground, by the area of what stands on it."""

CANOPY_AREA = 3.0
"""What lies around a building in less than so many times its area may be a canopy, or its verandah's roof."""

N_BEARINGS = 24
LOW_QUANTILE = 0.25
"""Of the heights in one bearing: bushes and cars stand on the ground."""

END_QUANTILES = (0.1, 0.9)
"""Of the bearings: lowest and highest ground along the outline."""

EVEN_M = 0.5
"""Ground that differs by less is even, and its middle height counts; else the highest does."""

MIN_WALL_M = 1.5
"""Height of a wall within one cell; parapets of balconies and edges of eaves are lower."""

MIN_WALL_CELLS = 8

FOOT_QUANTILES = (0.1, 0.75)
"""Of the walls along the outline: less than a tenth are a pit, and bays that hang are up to a quarter."""

SAME_FOOT_M = 1.0

DEEPER_SHARE = 0.2
"""Of the footprint, from which on what lies below the outer walls is a storey and no pit."""

DECK_M = (1.0, 4.5)
"""Height of a podium or a terrace on which the building might stand: steps to a storey."""

SMALL_M = 3.0
"""What is smaller than this is no building, and its lowest point will do."""


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Height of the open ground on a square grid.

    Parameters
    ----------
    corner_enu_m
        East and north of the grid's south-west corner.
    cell_m
        Width of a cell.
    heights_enu_m
        Shape (columns to the east, rows to the north); NaN where no ground is known.
    """

    corner_enu_m: tuple[float, float]
    cell_m: float
    heights_enu_m: Array

    def at(self, points_enu_m: Array) -> Array:
        """Height of the ground below points, shape (n, 2 or 3) to (n,); NaN where it is not known."""
        place = np.floor((points_enu_m[:, :2] - np.array(self.corner_enu_m)) / self.cell_m).astype(np.int64)
        is_inside = np.all((place >= 0) & (place < self.heights_enu_m.shape), axis=1)
        found = np.full(len(points_enu_m), np.nan)
        found[is_inside] = self.heights_enu_m[tuple(place[is_inside].T)]
        return found

    def around(self, east_m: float, north_m: float, radius_m: float = 3.0) -> float | None:
        """Height of the ground around a place, by the middle one of the cells; None where it is not known."""
        steps = np.arange(-radius_m, radius_m + 1e-9, self.cell_m / 2.0)
        offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        heights = self.at(np.array([east_m, north_m]) + offsets)
        return None if np.isnan(heights).all() else float(np.nanmedian(heights))


class Ground(NamedTuple):
    """What is known of the ground.

    Parameters
    ----------
    z_m
        Its height.
    lowest_m, highest_m
        Along the building's outline.
    outline_share
        Of the outline, along which open ground was found; 0 where only walls tell.
    terrain
        The open ground, where there is any.
    other_m
        A second height that may be the ground.
    is_deck
        The second height is that of a deck around the building, not of walls that end there.
    is_known
        False where nothing tells the ground, and `z_m` is that of the lowest surface.
    """

    z_m: float
    lowest_m: float
    highest_m: float
    outline_share: float = 0.0
    terrain: Terrain | None = None
    other_m: float | None = None
    is_deck: bool = False
    is_known: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class GroundedBuilding:
    """A building on its ground.

    Parameters
    ----------
    placement
        How file coordinates become local ones.
    vertices_enu_m
        Of the file, shape (v, 3).
    is_kept
        False for triangles that are strays, shape (t,).
    terrain
        Open ground in the file.
    question
        What the user has to be asked about the ground; empty where it is clear.
    notes
        How the ground was found, and what was left out.
    """

    placement: Placement
    vertices_enu_m: Array
    is_kept: Mask
    terrain: Terrain | None
    question: str
    notes: tuple[str, ...]


class StatedGround(NamedTuple):
    """Third file coordinate of the ground as somebody states it, and a note on who does."""

    z: float
    note: str = ""


def stated_ground(options: ImportOptions) -> StatedGround | None:
    """The ground as the user states it; None where that is left to the file."""
    return None if options.ground_z is None else StatedGround(options.ground_z)


Placing = Callable[[Array, float], Placement]
"""Placement from points of the building, file coordinates, shape (n, 3), and the third coordinate of the ground."""


def place_on_ground(
    vertices: Array, triangles: NDArray[np.int64], stated: StatedGround | None, placing: Placing
) -> GroundedBuilding:
    """Put a building on its ground.

    Parameters
    ----------
    vertices
        File coordinates, shape (v, 3), finite.
    triangles
        Shape (t, 3), t > 0.
    stated
        The ground, where the user or the file states it.
    placing
        See `Placing`.

    Raises
    ------
    InputError
        As `placing`.
    """
    used = _named(triangles, len(vertices))
    is_wild = np.zeros(len(vertices), bool)
    is_wild[used] = _far_vertices(vertices[used], FAR_FACTOR, 0.0)
    # Points that are wrong in any unit need no place on earth.
    middle = np.median(vertices[used], axis=0)
    shifted = np.where(is_wild[:, None], middle, vertices)
    first = placing(middle[None], float(middle[2]) if stated is None else stated.z)
    local = first.enu(shifted)
    is_far = is_wild.copy()
    is_far[used] |= _far_vertices(local[used], 1.0, STRAY_REACH_M)
    stray = _strays(local[triangles], np.asarray(is_far[triangles].any(axis=1)))
    if stated is None:
        ground = find_ground(local[triangles][~stray.is_ignored])
        ground_m = ground.z_m
    else:
        ground, ground_m = None, float(first.enu(np.array([[middle[0], middle[1], stated.z]]))[0, 2])
    is_kept = ~stray.left_out(ground_m if ground is None else min(ground_m, ground.lowest_m))
    kept = _named(triangles[is_kept], len(vertices))

    def in_file(height_m: float) -> float:
        return float(first.file_coordinates(np.array([[0.0, 0.0, height_m]]))[0, 2])

    placement = placing(vertices[kept], in_file(ground_m) if stated is None else stated.z)
    moved = placement.enu(shifted)
    shift = moved[kept[0]] - local[kept[0]]
    notes = [] if stated is None or not stated.note else [stated.note]
    question = ""
    if ground is not None:
        question = _question(ground, in_file)
        notes += [_how(ground, in_file)]
    if not is_kept.all():
        tops = local[triangles[~is_kept]][..., 2]
        notes.append(
            say(
                "left out as strays, below the ground or far from everything else: {} triangles, from {} to {} "
                "in the file's heights",
                int((~is_kept).sum()),
                _z(in_file(float(tops.min()))),
                _z(in_file(float(tops.max()))),
            )
        )
    terrain = None if ground is None or ground.terrain is None else _moved(ground.terrain, shift)
    return GroundedBuilding(placement, moved, is_kept, terrain, question, tuple(notes))


def _named(triangles: NDArray[np.int64], n_vertices: int) -> NDArray[np.int64]:
    """Numbers of the vertices that triangles use, in order."""
    is_used = np.zeros(n_vertices, bool)
    is_used[triangles] = True
    return np.flatnonzero(is_used)


def _moved(terrain: Terrain, shift: Array) -> Terrain:
    east, north = terrain.corner_enu_m
    return replace(
        terrain,
        corner_enu_m=(east + float(shift[0]), north + float(shift[1])),
        heights_enu_m=terrain.heights_enu_m + shift[2],
    )


def _z(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}"


def _how(ground: Ground, in_file: Callable[[float], float]) -> str:
    z, low, high = (_z(in_file(height)) for height in (ground.z_m, ground.lowest_m, ground.highest_m))
    if ground.terrain is None:
        return say(
            "ground: z = {} of the file, where the outer walls end, as there is no ground around the "
            "building in the file (--ground names another)",
            z,
        )
    if ground.highest_m - ground.lowest_m <= EVEN_M:
        return say(
            "ground: z = {} of the file, by the open ground along {:.0f} % of the building's outline, which "
            "lies between {} and {} (--ground names another)",
            z,
            100.0 * ground.outline_share,
            low,
            high,
        )
    return say(
        "ground: along the building's outline it lies between z = {} and {} of the file; the highest is "
        "taken, so that heights above ground are safe on every side (--ground names another)",
        low,
        high,
    )


def _question(ground: Ground, in_file: Callable[[float], float]) -> str:
    z = _z(in_file(ground.z_m))
    if not ground.is_known:
        return say(
            "the file shows neither open ground around the building nor walls that reach down to it; its "
            "lowest surface is at z = {}. Name the height of the ground in the file with --ground Z",
            z,
        )
    if ground.other_m is None:
        return ""
    low, high = (_z(in_file(height)) for height in sorted((ground.z_m, ground.other_m)))
    what = (
        say("z = {}, where the building's foot is, and z = {}, a deck all around its upper part", low, high)
        if ground.is_deck
        else say(
            "z = {}, where its lowest outer walls end, and z = {}, where others do (a cellar, a slope, a "
            "torn edge, or storeys that hang over)",
            low,
            high,
        )
    )
    return say(
        "two heights of the file may be the ground: {}. Say which with --ground {} or --ground {}", what, low, high
    )


# --- strays ---


class _Strays(NamedTuple):
    """Triangles that say nothing about the ground, and what decides whether they are left out altogether.

    Parameters
    ----------
    is_ignored
        Shape (t,).
    is_far
        Ignored, and far from everything else, shape (t,).
    top_m
        Highest point of the piece that each triangle belongs to, shape (t,).
    """

    is_ignored: Mask
    is_far: Mask
    top_m: Array

    def left_out(self, ground_m: float) -> Mask:
        """Triangles that no flight can meet: far away or below the ground."""
        return np.asarray(self.is_ignored & (self.is_far | (self.top_m < ground_m - STRAY_DEPTH_M)))


def _far_vertices(points: Array, factor: float, least: float) -> Mask:
    """Few points that lie to the sides of all others, or below them, by more than `factor` times their size.

    Upwards nothing is too far: masts are thin and high.
    """
    # One point of several triangles counts once; where there are many, shares tell enough.
    different = points if len(points) > MANY_POINTS else np.unique(points, axis=0)
    n, is_far = len(different), np.zeros(len(points), bool)
    n_few = min(max(3, n // 500), n // 8)
    if n_few == 0:
        return is_far
    ordered = np.partition(different, (n_few, n - 1 - n_few), axis=0)
    lowest, highest = np.sort(ordered[: n_few + 1], axis=0), np.sort(ordered[n - 1 - n_few :], axis=0)
    size = highest[0] - lowest[-1]
    for axis, extent in ((0, max(size[0], size[1])), (1, max(size[0], size[1])), (2, size[2])):
        reach = max(factor * float(extent), least)
        if reach == 0.0:
            continue
        below = np.flatnonzero(np.diff(lowest[:, axis]) > reach)
        if len(below):
            is_far |= points[:, axis] <= lowest[below[-1], axis]
        above = np.flatnonzero(np.diff(highest[:, axis]) > reach)
        if len(above) and axis < 2:
            is_far |= points[:, axis] >= highest[above[0] + 1, axis]
    return is_far


def _strays(corners: Array, is_far: Mask) -> _Strays:
    """Strays among triangles, shape (t, 3, 3): what is far by its vertices, and small pieces apart from the rest."""
    areas = _areas(corners)
    tops = corners[..., 2].max(axis=1)
    if is_far.all():
        return _Strays(np.zeros(len(corners), bool), np.zeros(len(corners), bool), tops)
    near = np.flatnonzero(~is_far)
    piece = _pieces(corners[near], areas[near])
    area = np.bincount(piece, areas[near])
    is_small = area < SMALL_SHARE * area.max()
    top = np.full(len(area), -np.inf)
    np.maximum.at(top, piece, tops[near])
    main = corners[near[~is_small[piece]]][..., :2].reshape(-1, 2)
    low, high = main.min(axis=0), main.max(axis=0)
    low_points, high_points = corners[near][..., :2].min(axis=1), corners[near][..., :2].max(axis=1)
    gap = np.maximum(low - high_points, low_points - high).max(axis=1)
    nearest = np.full(len(area), np.inf)
    np.minimum.at(nearest, piece, gap)
    is_ignored, is_away, piece_top = is_far.copy(), is_far.copy(), tops.copy()
    is_ignored[near] = is_small[piece]
    is_away[near] = (is_small & (nearest > STRAY_REACH_M))[piece]
    piece_top[near] = top[piece]
    return _Strays(is_ignored, is_away, piece_top)


def _pieces(corners: Array, areas: Array) -> NDArray[np.int64]:
    """Number of the piece that each triangle belongs to, shape (t,): what lies within a cell or two is one piece."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    spacing_m = _spacing_m(corners, areas)
    points, owner, _ = _samples(corners, areas, spacing_m)
    # Two cells of the map: the few points that cover a surface leave no gaps so wide.
    voxels = np.floor(points / (CELLS_PER_SPACING * spacing_m)).astype(np.int64)
    voxels -= voxels.min(axis=0) - 1
    sizes = voxels.max(axis=0) + 2
    key, voxel = np.unique((voxels[:, 0] * sizes[1] + voxels[:, 1]) * sizes[2] + voxels[:, 2], return_inverse=True)
    n = len(corners)
    edges = [np.stack([owner, n + voxel.ravel()])]
    steps = [np.array(step) for step in np.ndindex(3, 3, 3)][14:]
    for step in steps:
        east, north, up = step - 1
        wanted = key + (east * sizes[1] + north) * sizes[2] + up
        found = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        is_there = key[found] == wanted
        edges.append(np.stack([n + np.flatnonzero(is_there), n + found[is_there]]))
    pairs = np.concatenate(edges, axis=1)
    graph = coo_array((np.ones(pairs.shape[1], bool), tuple(pairs)), shape=(n + len(key), n + len(key)))
    label = connected_components(graph, directed=False)[1][:n]
    return np.unique(label, return_inverse=True)[1].ravel()


def _areas(corners: Array) -> Array:
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(0.5 * np.linalg.norm(vectors, axis=1))


def _spacing_m(corners: Array, areas: Array) -> float:
    size_m = float(np.ptp(corners, axis=(0, 1)).max())
    return max(
        SPACING_M, float(np.sqrt(areas.sum() / MAX_SAMPLES)), size_m / (CELLS_PER_SPACING * (MAX_CELLS_ACROSS - 2))
    )


class _Samples(NamedTuple):
    """Points on triangles, shape (n, 3), the triangle of each, and the area that it stands for (none on edges)."""

    points: Array
    owner: NDArray[np.int64]
    area_m2: Array


def _samples(corners: Array, areas: Array, spacing_m: float) -> _Samples:
    """Points on triangles: evenly over their area, and along edges longer than the spacing."""
    counts = np.maximum(np.ceil(areas / spacing_m**2).astype(np.int64), 1)
    owner = np.repeat(np.arange(len(corners)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    # M. Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018): R2, begun at the middle.
    u, v = np.modf(1.0 / 3.0 + number * 0.7548776662466927)[0], np.modf(1.0 / 3.0 + number * 0.5698402909980532)[0]
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    a, b, c = (corners[owner, k] for k in range(3))
    points, owners = [a + u[:, None] * (b - a) + v[:, None] * (c - a)], [owner]
    area_m2 = areas[owner] / counts[owner]
    for k in range(3):
        ends = corners[:, k], corners[:, (k + 1) % 3]
        lengths = np.linalg.norm(ends[1] - ends[0], axis=1)
        long = np.flatnonzero(lengths > spacing_m)
        counts = np.ceil(lengths[long] / spacing_m).astype(np.int64)
        owner = np.repeat(long, counts)
        along = (np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)) / np.repeat(counts, counts)
        points.append(ends[0][owner] + along[:, None] * (ends[1] - ends[0])[owner])
        owners.append(owner)
    owner = np.concatenate(owners)
    return _Samples(np.concatenate(points), owner, np.append(area_m2, np.zeros(len(owner) - len(area_m2))))


# --- the ground ---


class _Map(NamedTuple):
    """A file seen from above; arrays of shape (columns, rows), NaN where nothing is.

    Parameters
    ----------
    corner, cell_m
        As in `Terrain`.
    top, bottom
        Highest and lowest point.
    wall_low, wall_high
        Of walls.
    samples, cell
        What the map was made of, and the cell of each, as a number in rows.
    """

    corner: Array
    cell_m: float
    top: Array
    bottom: Array
    wall_low: Array
    wall_high: Array
    samples: _Samples
    cell: NDArray[np.int64]

    def n_cells_below(self, height_m: float) -> int:
        """Number of cells with more than slivers below a height."""
        is_below = self.samples.points[:, 2] < height_m
        area = np.bincount(self.cell[is_below], self.samples.area_m2[is_below])
        return int((area >= MIN_CELL_SHARE * self.cell_m**2).sum())


class _Surfaces(NamedTuple):
    """Smooth surfaces open to the sky: the number of each cell's, -1 where there is nothing, and which are ground."""

    number: NDArray[np.int64]
    is_ground: Mask


def find_ground(corners: Array) -> Ground:
    """Ground below a building that is given by triangles in local metres, shape (t, 3, 3), t > 0."""
    if float(np.ptp(corners, axis=(0, 1)).max()) < SMALL_M:
        low = float(corners[..., 2].min())
        return Ground(low, low, low)
    seen = _seen_from_above(corners)
    surfaces = _surfaces(seen)
    ground = _open_ground(seen, surfaces) or _foot_of_walls(seen, corners)
    deck_m = None if ground.other_m is not None or not ground.is_known else _deck_m(seen, surfaces, ground.highest_m)
    return ground if deck_m is None else ground._replace(other_m=deck_m, is_deck=True)


def _seen_from_above(corners: Array) -> _Map:
    areas = _areas(corners)
    spacing_m = _spacing_m(corners, areas)
    samples = _samples(corners, areas, spacing_m)
    points = samples.points
    cell_m = CELLS_PER_SPACING * spacing_m
    corner = points[:, :2].min(axis=0) - cell_m
    place = np.floor((points[:, :2] - corner) / cell_m).astype(np.int64)
    n_columns, n_rows = (place.max(axis=0) + 2).tolist()
    cell = place[:, 0] * n_rows + place[:, 1]
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    is_wall = (np.abs(vectors[:, 2]) < STEEP * 2.0 * areas)[samples.owner]
    is_filled = np.bincount(cell, samples.area_m2, n_columns * n_rows) >= MIN_CELL_SHARE * cell_m**2

    def extreme(of: np.ufunc, chosen: Mask, start: float) -> Array:
        found = np.full(n_columns * n_rows, start)
        of.at(found, cell[chosen], points[chosen, 2])
        return np.where(np.isinf(found) | ~is_filled, np.nan, found).reshape(n_columns, n_rows)

    every = np.ones(len(points), bool)
    return _Map(
        corner,
        cell_m,
        top=extreme(np.maximum, every, -np.inf),
        bottom=extreme(np.minimum, every, np.inf),
        wall_low=extreme(np.minimum, is_wall, np.inf),
        wall_high=extreme(np.maximum, is_wall, -np.inf),
        samples=samples,
        cell=cell,
    )


def _surfaces(height_map: _Map) -> _Surfaces:
    """Smooth surfaces that are open to the sky.

    Ground is what things rise from, and what falls nowhere, or only on a shorter way than it goes on to the edge of the
    file, as above a retaining wall. Roofs and decks fall all around, to walls that go down.
    """
    from scipy import ndimage
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    top, is_there = height_map.top, ~np.isnan(height_map.top)
    index = np.full(top.shape, -1)
    index[is_there] = np.arange(int(is_there.sum()))
    pairs = []
    every, but_last, but_first = slice(None), slice(None, -1), slice(1, None)
    for a, b in (((but_last, every), (but_first, every)), ((every, but_last), (every, but_first))):
        is_smooth = np.abs(np.nan_to_num(top[a] - top[b], nan=np.inf)) <= SMOOTH_SLOPE * height_map.cell_m
        pairs.append(np.stack([index[a][is_smooth], index[b][is_smooth]]))
    edges, n = np.concatenate(pairs, axis=1), int(is_there.sum())
    graph = coo_array((np.ones(edges.shape[1], bool), tuple(edges)), shape=(n, n))
    number = np.full(top.shape, -1, np.int64)
    number[is_there] = connected_components(graph, directed=False)[1]
    rises = ndimage.maximum_filter(np.where(is_there, top, -np.inf), 5, mode="nearest") - top >= RISE_M
    falls = top - ndimage.minimum_filter(np.where(is_there, top, np.inf), 3, mode="nearest") >= DROP_M
    # At the edge of what the file holds, walls that go down tell a roof from the end of a scan.
    is_edge = ndimage.binary_dilation(~is_there, np.ones((3, 3), bool)) & is_there
    falls |= is_edge & (top - ndimage.minimum_filter(np.where(is_there, height_map.bottom, np.inf), 3) >= DROP_M)
    n_rising, n_falling, n_ending, n_cells = (
        np.bincount(number[is_there & mask], minlength=int(number.max()) + 1)
        for mask in (rises, falls, is_edge & ~falls, is_there)
    )
    is_low = (2 * n_falling <= n_rising) | (n_falling <= n_ending)
    return _Surfaces(number, (n_cells >= MIN_GROUND_CELLS) & (n_rising >= MIN_FOOT_CELLS) & is_low)


def _open_ground(height_map: _Map, surfaces: _Surfaces) -> Ground | None:
    """Ground around what rises from it; None where there is too little."""
    from scipy import ndimage

    if not surfaces.is_ground.any():
        return None
    is_ground = (surfaces.number >= 0) & surfaces.is_ground[surfaces.number]
    nearest = ndimage.distance_transform_edt(~is_ground, return_distances=False, return_indices=True)
    heights = np.where(is_ground, height_map.top, np.nan)
    above = np.nan_to_num(height_map.top - heights[tuple(nearest)], nan=0.0)
    around = np.ones((3, 3), bool)
    label, n = ndimage.label(above >= RISE_M, around)
    if n == 0:
        return None
    volume = ndimage.sum_labels(above, label, np.arange(1, n + 1))
    mass = np.isin(label, 1 + np.flatnonzero(volume >= MASS_SHARE * volume.max()))
    # A court is no part of the surroundings: its floor may be the roof of a cellar.
    mass = ndimage.binary_fill_holes(mass)
    least, most = RING_CELLS
    ring = is_ground & ndimage.binary_dilation(mass, around, most) & ~ndimage.binary_dilation(mass, around, least)
    outline = mass & ~ndimage.binary_erosion(mass, around)
    share = float((outline & ndimage.binary_dilation(ring, around, most)).sum() / outline.sum())
    area = float(is_ground.sum() / mass.sum())
    if share < MIN_OUTLINE_SHARE or area < MIN_GROUND_AREA:
        return None
    columns, rows = np.nonzero(ring)
    middle = np.argwhere(mass).mean(axis=0)
    bearing = np.arctan2(columns - middle[0], rows - middle[1]) % (2.0 * np.pi)
    sector = np.minimum((bearing * N_BEARINGS / (2.0 * np.pi)).astype(np.int64), N_BEARINGS - 1)
    found = heights[ring]
    feet = np.array([np.quantile(found[sector == k], LOW_QUANTILE) for k in np.unique(sector)])
    low, high = (float(value) for value in np.quantile(feet, END_QUANTILES))
    z = float(np.median(feet)) if high - low <= EVEN_M else high
    # A canopy around a building that stands below it: small, and the walls go on down.
    if (
        area < CANOPY_AREA
        and float(np.median(height_map.bottom[outline & ~np.isnan(height_map.bottom)])) < z - MIN_WALL_M
    ):
        return None
    corner = (float(height_map.corner[0]), float(height_map.corner[1]))
    return Ground(z, low, high, share, Terrain(corner, height_map.cell_m, heights))


def _foot_of_walls(height_map: _Map, corners: Array) -> Ground:
    """Where the walls along the outline end."""
    from scipy import ndimage

    is_there = ndimage.binary_fill_holes(~np.isnan(height_map.top))
    band = is_there & ~ndimage.binary_erosion(is_there, np.ones((3, 3), bool), 2)
    is_wall = band & (np.nan_to_num(height_map.wall_high - height_map.wall_low, nan=0.0) >= MIN_WALL_M)
    feet = height_map.wall_low[is_wall]
    if len(feet) < MIN_WALL_CELLS:
        low = float(np.quantile(corners[..., 2].min(axis=1), 0.005))
        return Ground(low, low, low, is_known=False)
    low, high = (float(value) for value in np.quantile(feet, FOOT_QUANTILES))
    if high - low > SAME_FOOT_M:
        return Ground(high, low, high, other_m=low)
    z = float(np.median(feet[feet <= high + SAME_FOOT_M]))
    # Walls further in that go deeper: a ground floor that stands back, or a cellar.
    if height_map.n_cells_below(z - SAME_FOOT_M) > DEEPER_SHARE * is_there.sum():
        is_deeper = np.nan_to_num(height_map.bottom, nan=np.inf) < z - SAME_FOOT_M
        return Ground(z, low, high, other_m=float(np.median(height_map.bottom[is_deeper])))
    return Ground(z, low, high)


def _deck_m(height_map: _Map, surfaces: _Surfaces, ground_m: float) -> float | None:
    """Height of a deck that lies all around the building's upper part, at most a storey above the ground."""
    from scipy import ndimage

    is_raised = np.nan_to_num(height_map.top - ground_m, nan=0.0)
    candidates = np.unique(surfaces.number[(is_raised >= DECK_M[0]) & (is_raised <= DECK_M[1])])
    for number in candidates[candidates >= 0]:
        deck = surfaces.number == number
        if deck.sum() < MIN_GROUND_CELLS:
            continue
        height = float(np.median(height_map.top[deck]))
        rise_m = height - ground_m
        inside = ndimage.binary_fill_holes(deck) & ~deck
        upper = inside & (np.nan_to_num(height_map.top, nan=-np.inf) >= height + max(RISE_M, 2.0 * rise_m))
        if DECK_M[0] <= rise_m <= DECK_M[1] and MIN_GROUND_CELLS <= upper.sum() <= deck.sum():
            return height
    return None
