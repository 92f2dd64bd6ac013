"""Walls and roofs to closed blocks: a plane arrangement in the plan of the site.

The lines of all walls cut the plan into cells. Which of them are building is a minimum cut (Y. Boykov and V.
Kolmogorov, 2004): lines of sight say what is free, walls and roofs what is not, and an edge without a wall on it costs
its length. So glass, on which nothing is seen, is closed by the planes of its frames and by its neighbours; what was
closed so is marked as guessed. Lines of sight that cross a wall end there: what is seen behind it is a mirror image, or
a room.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh, empty_mesh, from_corners
from reconstruction.coarse.cloud import Cloud, FoundPlane
from reconstruction.coarse.walls import BuildingParameters, Ground, Wall, find_ground, find_roofs, find_walls
from reconstruction.colmap.pycolmap_run import look_one_way

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Face:
    """A side of a block.

    Parameters
    ----------
    seen_share
        Of its area, by points on the wall; 0 for a side that was guessed.
    wall
        Which wall it lies on; None for none.
    """

    ends_m: tuple[tuple[float, float], tuple[float, float]]
    bottom_m: float
    top_m: float
    seen_share: float
    wall: int | None

    @property
    def area_m2(self) -> float:
        """Of the face."""
        (x, y), (u, v) = self.ends_m
        return math.hypot(u - x, v - y) * (self.top_m - self.bottom_m)


@dataclass(frozen=True, slots=True, eq=False)
class Buildings:
    """What was made of a cloud.

    Parameters
    ----------
    mesh
        Closed blocks; empty where no wall was found.
    faces
        Upright sides of the blocks to the open.
    roofs
        Planes of roofs.
    others
        Boxes, low and high corner, of what stands on the ground and is no block: trees, cars, masts.
    """

    ground: Ground
    walls: tuple[Wall, ...]
    roofs: tuple[FoundPlane, ...]
    mesh: TriangleMesh
    faces: tuple[Face, ...]
    others: tuple[tuple[Array, Array], ...]
    notes: tuple[str, ...] = field(default=())


# The arrangement of cells in the plan.

N_RAYS = 20_000
STEP = 1.0
"""Of lines of sight, in cells of the map."""

SEEN_COST, UNSEEN_COST, EDGE_COST = 1.0, 0.02, 1.5
"""Of a cell of the map on the wrong side, of one that nothing is known of, and of an edge without a wall, by its length
in cells."""

SAME_LINE_M, SAME_LINE_DEG = 0.4, 2.0
"""Walls that are so alike cut the plan once."""

SAME_TOP_M = 0.75
"""Blocks whose tops differ by less are one."""


def make_buildings(
    cloud: Cloud,
    parameters: BuildingParameters | None = None,
    ground: Ground | None = None,
    monitor: Monitor = QUIET,
    around: Cloud | None = None,
) -> Buildings:
    """Ground, walls, roofs and blocks of a cloud, ENU metres.

    Parameters
    ----------
    ground
        Where it is known; else it is found.
    around
        The same cloud with all that stands beside the building; without it, all is the building's.
    """
    around = cloud if around is None else around
    parameters = parameters or BuildingParameters()
    ground = ground or find_ground(cloud.points, parameters.cell_m)
    walls = find_walls(cloud, ground, parameters, monitor)
    walls = without_mirrored(walls, cloud)
    roofs, roof_points = find_roofs(cloud, walls, ground, parameters)
    if not walls:
        note = say("no wall was found: the points say too little; come closer, and take photos that overlap more")
        return Buildings(ground, (), tuple(roofs), empty_mesh(), (), (), (note,))
    monitor.report(say("arranging blocks"), 0, 0)
    plan = _Plan.of(cloud, walls, ground, parameters)
    tops = [_top(cell, plan, walls, roofs, roof_points, cloud, ground) for cell in plan.cells]
    is_building = _labels(plan, walls, tops, ground)
    floor = min(ground.z_m, min(wall.bottom_m for wall in walls))
    blocks = _blocks(plan, tops, is_building, floor)
    notes: tuple[str, ...] = ()
    if not blocks:
        blocks = [(_behind(wall, parameters.depth_m), np.array([0.0, 0.0, wall.top_m])) for wall in walls]
        notes = (say("the walls do not close to blocks; each got a depth of {:g} m", parameters.depth_m),)
    meshes = [prism(polygon, floor, top) for polygon, top in blocks]
    corners = np.concatenate([mesh.corners_enu_m for mesh in meshes])
    faces = _faces(blocks, walls, floor)
    others = _others(around, blocks, ground, parameters)
    return Buildings(ground, tuple(walls), tuple(roofs), from_corners(corners), faces, others, notes)


def without_mirrored(walls: Sequence[Wall], cloud: Cloud) -> list[Wall]:
    """Walls without those that were seen through others alone: mirror images, and rooms behind windows.

    Larger walls come first, and count against smaller ones that stand behind them for most cameras that saw these; a
    wall on a lane is behind the house opposite for most of a ring, which did not see it.
    """
    kept: list[Wall] = []
    for wall in walls:
        middle = np.array([*wall.line.mean(axis=0), 0.5 * (wall.bottom_m + wall.top_m)])
        ahead = cloud.centres[_that_saw(wall, cloud)]
        ahead = ahead[ahead[:, :2] @ wall.normal > wall.offset_m]
        if not len(ahead):
            kept.append(wall)
            continue
        hidden = np.zeros(len(ahead), bool)
        for other in kept:
            share = _crossing(ahead, np.broadcast_to(middle, ahead.shape), other, grown_m=0.5)
            hidden |= share < 1.0 - 1e-3
        if hidden.mean() < 0.8:
            kept.append(wall)
    return kept


def _that_saw(wall: Wall, cloud: Cloud) -> NDArray[np.int64]:
    """Rows of the cameras that saw points on a wall, once for each point."""
    points = cloud.points
    along = points[:, :2] @ wall.along
    is_on = np.abs(points[:, :2] @ wall.normal - wall.offset_m) < max(ON_WALL_M, 3.0 * wall.rms_m)
    is_on &= (along >= wall.ends_m[0]) & (along <= wall.ends_m[1])
    is_on &= (points[:, 2] >= wall.bottom_m) & (points[:, 2] <= wall.top_m)
    return cloud.cameras[np.repeat(is_on, np.diff(cloud.starts))]


ON_WALL_M = 0.1
"""Points nearer to a wall are on it."""


def _crossing(starts: Array, ends: Array, wall: Wall, grown_m: float = 0.0, behind_m: float = 0.3) -> Array:
    """Where lines of sight cross a wall from its front, as the part of their length, shape (n,); 1 for never.

    Parameters
    ----------
    behind_m
        By how much they have to end behind the wall.
    """
    before = starts[:, :2] @ wall.normal - wall.offset_m
    after = ends[:, :2] @ wall.normal - wall.offset_m
    crosses = (before > 0.0) & (after < -behind_m)
    share = np.where(crosses, before / np.maximum(before - after, 1e-9), 1.0)
    at = starts + share[:, None] * (ends - starts)
    along = at[:, :2] @ wall.along
    low, high = wall.ends_m[0] - grown_m, wall.ends_m[1] + grown_m
    inside = (along > low) & (along < high) & (at[:, 2] > wall.bottom_m - 1.0) & (at[:, 2] < wall.top_m + grown_m)
    return np.asarray(np.where(crosses & inside, share, 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """The plan, cut into cells, and what lines of sight say on a map of it.

    Parameters
    ----------
    lowest_m
        Height above which nearly all of the map's cell is free, shape (h, w): the third lowest line of sight.
    corner, cell_m
        Of the map.
    """

    cells: list[shapely.Polygon]
    lowest_m: Array
    corner: Array
    cell_m: float

    @classmethod
    def of(cls, cloud: Cloud, walls: Sequence[Wall], ground: Ground, parameters: BuildingParameters) -> _Plan:
        strips = [_behind(wall, parameters.depth_m) for wall in walls]
        axis = max(walls, key=lambda wall: wall.length_m).normal
        frame = np.array([axis, [-axis[1], axis[0]]])
        # The box reaches a little in front of walls, and a depth behind those that stand alone.
        corners = np.concatenate([shapely.get_coordinates(strip) for strip in strips]) @ frame.T
        low, high = corners.min(axis=0) - 0.5, corners.max(axis=0) + 0.5
        ring = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]) @ frame
        box = shapely.Polygon(ring)
        lines = [box.exterior]
        reach = float(np.linalg.norm(high - low))
        for normal, offset in _different_lines(walls):
            along = np.array([-normal[1], normal[0]])
            middle = normal * offset + along * (along @ ring.mean(axis=0))
            line = shapely.LineString([middle - reach * along, middle + reach * along])
            # They cross the box's outline: such that ended on it would end short of it, by rounding, and cut nothing.
            lines.append(line)
        noded = shapely.unary_union(lines, grid_size=1e-4)
        found = shapely.get_parts(shapely.polygonize([noded]))
        cells = [cell for cell in found if cell.area > 0.05 and box.contains(cell.representative_point())]
        x, y = ring.min(axis=0), ring.max(axis=0)
        size = max(parameters.cell_m, float(np.max(y - x)) / 400.0)
        shape = np.ceil((y - x) / size).astype(int) + 1
        lowest = _lowest_sights(cloud, walls, x, size, (int(shape[1]), int(shape[0])), parameters.seed)
        return cls(cells, lowest, x, size)

    def map_points(self, cell: shapely.Polygon) -> tuple[Array, Array]:
        """Middles of the map's cells in a cell, shape (k, 2), and their free heights, shape (k,)."""
        low_x, low_y, high_x, high_y = cell.bounds
        height, width = self.lowest_m.shape
        columns = np.arange(
            max(0, int((low_x - self.corner[0]) / self.cell_m)),
            min(width, int((high_x - self.corner[0]) / self.cell_m) + 1),
        )
        rows = np.arange(
            max(0, int((low_y - self.corner[1]) / self.cell_m)),
            min(height, int((high_y - self.corner[1]) / self.cell_m) + 1),
        )
        x, y = np.meshgrid(columns, rows)
        middles = self.corner + (np.column_stack([x.ravel(), y.ravel()]) + 0.5) * self.cell_m
        inside = shapely.contains_xy(cell, middles[:, 0], middles[:, 1])
        return middles[inside], self.lowest_m[y.ravel()[inside], x.ravel()[inside]]


def _different_lines(walls: Sequence[Wall]) -> list[tuple[Array, float]]:
    """Lines of walls, nearly equal ones once: that of the larger wall."""
    kept: list[Wall] = []
    for wall in walls:
        middle = wall.line.mean(axis=0)
        same = [
            other
            for other in kept
            if abs(float(wall.normal @ other.along)) < math.sin(math.radians(SAME_LINE_DEG))
            and abs(float(middle @ other.normal) - other.offset_m) < SAME_LINE_M
        ]
        if not same:
            kept.append(wall)
    return [(wall.normal, wall.offset_m) for wall in kept]


def _behind(wall: Wall, depth_m: float) -> shapely.Polygon:
    line = wall.line
    back = line - depth_m * wall.normal
    return shapely.Polygon([line[0], line[1], back[1], back[0]])


def _lowest_sights(
    cloud: Cloud, walls: Sequence[Wall], corner: Array, cell_m: float, shape: tuple[int, int], seed: int
) -> Array:
    """Height of the third lowest line of sight over each cell of the map; infinite where fewer pass."""
    rng = np.random.default_rng(seed)
    counts = np.diff(cloud.starts)
    of_point = np.repeat(np.arange(len(cloud)), counts)
    chosen = rng.permutation(len(of_point))[:N_RAYS]
    starts, ends = cloud.centres[cloud.cameras[chosen]], cloud.points[of_point[chosen]]
    share = np.ones(len(chosen))
    for wall in walls:
        share = np.minimum(share, _crossing(starts, ends, wall, grown_m=0.3))
    # The end itself is not free.
    lengths = np.linalg.norm(ends - starts, axis=1)
    share = np.minimum(share, 1.0 - 1.5 * cell_m / np.maximum(lengths, 1e-9))
    keys, heights = [], []
    flat = np.linalg.norm((ends - starts)[:, :2], axis=1)
    n_steps = int(np.ceil(np.clip(flat / (STEP * cell_m), 1, 2000)).max())
    for step in range(n_steps):
        at = step * STEP * cell_m / np.maximum(flat, 1e-9)
        going = at < share
        if not going.any():
            break
        places = starts[going] + at[going, None] * (ends - starts)[going]
        cells = np.floor((places[:, :2] - corner) / cell_m).astype(np.int64)
        inside = ((cells >= 0) & (cells < (shape[1], shape[0]))).all(axis=1)
        keys.append(cells[inside, 1] * shape[1] + cells[inside, 0])
        heights.append(places[inside, 2])
    lowest = np.full(shape[0] * shape[1], np.inf)
    key = np.concatenate(keys) if keys else np.zeros(0, np.int64)
    height = np.concatenate(heights) if heights else np.zeros(0)
    order = np.lexsort((height, key))
    key, height = key[order], height[order]
    starts_of = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]])) if len(key) else np.zeros(0, np.int64)
    lengths_of = np.diff(np.concatenate([starts_of, [len(key)]]))
    enough = lengths_of >= 3
    lowest[key[starts_of[enough]]] = height[starts_of[enough] + 2]
    return lowest.reshape(shape)


def _top(
    cell: shapely.Polygon,
    plan: _Plan,
    walls: Sequence[Wall],
    roofs: Sequence[FoundPlane],
    roof_points: Array,
    cloud: Cloud,
    ground: Ground,
) -> Array:
    """Top of a cell as a plane z = a x + b y + c, shape (3,), by roofs in it, else by walls around it."""
    best, most = None, max(4.0, 0.02 * cell.area / plan.cell_m**2)
    for roof in roofs:
        own = roof_points[roof.rows]
        n_inside = int(shapely.contains_xy(cell, own[:, 0], own[:, 1]).sum())
        if n_inside > most:
            most, best = n_inside, roof
    if best is not None:
        normal = best.normal / best.normal[2]
        if math.hypot(normal[0], normal[1]) < math.tan(math.radians(4.0)):
            own = roof_points[best.rows]
            return np.array([0.0, 0.0, float(np.median(own[:, 2]))])
        return np.array([-normal[0], -normal[1], best.offset / best.normal[2]])
    tops = [(_overlap_m(cell, wall), wall.top_m) for wall in walls if wall.top_m > ground.z_m + 1.0]
    around = [(length, top) for length, top in tops if length > 0.3]
    if around:
        lengths, heights = np.array(around).T
        order = np.argsort(heights)
        at = np.searchsorted(np.cumsum(lengths[order]), 0.5 * lengths.sum())
        return np.array([0.0, 0.0, float(heights[order][min(at, len(order) - 1)])])
    behind = [wall for wall in walls if _behind(wall, 1e3).contains(cell.representative_point())]
    if behind:
        return np.array([0.0, 0.0, max(wall.top_m for wall in behind)])
    return np.array([0.0, 0.0, float(np.percentile(cloud.points[:, 2], 95.0))])


def _overlap_m(cell: shapely.Polygon, wall: Wall) -> float:
    """Length of a cell's outline that lies on a wall."""
    line = shapely.LineString(wall.line)
    return float(cell.exterior.intersection(line.buffer(SAME_LINE_M, cap_style="flat")).length)


def _labels(plan: _Plan, walls: Sequence[Wall], tops: Sequence[Array], ground: Ground) -> Mask:
    """Which cells are building, by a minimum cut."""
    n = len(plan.cells)
    inside_cost, outside_cost = np.zeros(n), np.zeros(n)
    strips = [(_front(wall), _back(wall)) for wall in walls]
    for i, (cell, top) in enumerate(zip(plan.cells, tops, strict=True)):
        places, lowest = plan.map_points(cell)
        if not len(places):
            continue
        height = places @ top[:2] + top[2] - ground.z_m
        free = lowest < ground.z_m + 0.75 * height
        seen_above = np.isfinite(lowest) & (lowest >= ground.z_m + 0.75 * height)
        front, behind = np.zeros(len(places), bool), np.zeros(len(places), bool)
        for before, after in strips:
            front |= shapely.contains_xy(before, places[:, 0], places[:, 1])
            behind |= shapely.contains_xy(after, places[:, 0], places[:, 1])
        inside_cost[i] = SEEN_COST * float(free.sum() + 0.5 * (front & ~behind).sum())
        inside_cost[i] += UNSEEN_COST * float((~free & ~behind).sum())
        outside_cost[i] = SEEN_COST * float((behind & ~free & ~front).sum() + (seen_above & behind).sum())
        if math.isclose(float(np.max(height)), 0.0) or float(np.max(height)) < 1.0:
            inside_cost[i] += 1e4
    pairs = _edges(plan, walls)
    return _cut(inside_cost, outside_cost, pairs)


def _front(wall: Wall, deep_m: float = 1.5) -> shapely.Polygon:
    line = wall.line
    return shapely.Polygon([line[0], line[1], line[1] + deep_m * wall.normal, line[0] + deep_m * wall.normal])


def _back(wall: Wall, deep_m: float = 1.5) -> shapely.Polygon:
    line = wall.line
    return shapely.Polygon([line[0], line[1], line[1] - deep_m * wall.normal, line[0] - deep_m * wall.normal])


def _edges(plan: _Plan, walls: Sequence[Wall]) -> list[tuple[int, int, float]]:
    """Neighbours, -1 for beyond the box, and what a boundary between them costs."""
    tree = shapely.STRtree(plan.cells)
    lines = shapely.union_all([shapely.LineString(wall.line).buffer(SAME_LINE_M, cap_style="flat") for wall in walls])
    found = []
    inner = np.zeros(len(plan.cells))
    for i, cell in enumerate(plan.cells):
        for j in tree.query(cell, "intersects").tolist():
            if j == i:
                continue
            shared = cell.exterior.intersection(plan.cells[j].exterior)
            inner[i] += shared.length
            if j > i and shared.length > 1e-3:
                bare = float(shared.length - shared.intersection(lines).length)
                found.append((i, j, EDGE_COST * max(0.0, bare) / plan.cell_m))
    for i, cell in enumerate(plan.cells):
        outer = float(cell.exterior.length - inner[i])
        if outer > 1e-2:
            found.append((i, -1, 0.2 * EDGE_COST * outer / plan.cell_m))
    return found


def _cut(inside_cost: Array, outside_cost: Array, pairs: Sequence[tuple[int, int, float]]) -> Mask:
    """Labels of least cost: source side is building."""
    n = len(inside_cost)
    source, sink = n, n + 1
    rows, columns, capacities = [], [], []

    def add(i: int, j: int, cost: float) -> None:
        rows.append(i)
        columns.append(j)
        capacities.append(round(100.0 * cost))

    for i in range(n):
        add(source, i, outside_cost[i])
        add(i, sink, inside_cost[i])
    for i, j, cost in pairs:
        if j < 0:
            add(i, sink, cost)
        else:
            add(i, j, cost)
            add(j, i, cost)
    graph = csr_array((np.array(capacities, np.int32), (rows, columns)), shape=(n + 2, n + 2))
    graph.sum_duplicates()
    flow = maximum_flow(graph, source, sink).flow
    residual = csr_array(graph - flow)
    residual.data[residual.data < 0] = 0
    residual.eliminate_zeros()
    reached = breadth_first_order(residual, source, return_predecessors=False)
    label = np.zeros(n + 2, bool)
    label[reached] = True
    return label[:n]


def _blocks(
    plan: _Plan, tops: Sequence[Array], is_building: Mask, floor_m: float
) -> list[tuple[shapely.Polygon, Array]]:
    """Building cells with tops that nearly agree, joined; each with the plane of its top."""
    middles = [np.array([*cell.centroid.coords[0], 1.0]) for cell in plan.cells]
    chosen = [int(i) for i in np.flatnonzero(is_building) if float(tops[int(i)] @ middles[int(i)]) > floor_m + 1.0]
    flat = [i for i in chosen if not tops[i][:2].any()]
    groups: list[list[int]] = []
    for i in sorted(flat, key=lambda i: tops[i][2]):
        if groups and tops[i][2] - tops[groups[-1][0]][2] < SAME_TOP_M:
            groups[-1].append(i)
        else:
            groups.append([i])
    blocks = []
    for group in groups:
        areas = np.array([plan.cells[i].area for i in group])
        top = float(np.average([tops[i][2] for i in group], weights=areas))
        whole = shapely.unary_union([plan.cells[i] for i in group])
        blocks += [(part, np.array([0.0, 0.0, top])) for part in shapely.get_parts(whole)]
    blocks += [(plan.cells[i], tops[i]) for i in chosen if tops[i][:2].any()]
    return [(_simple(polygon), top) for polygon, top in blocks if polygon.area > 0.5]


def _simple(polygon: shapely.Polygon) -> shapely.Polygon:
    """Without corners on straight edges."""
    return shapely.orient_polygons(shapely.simplify(polygon, 1e-3))


def prism(polygon: shapely.Polygon, floor_m: float, top: Array) -> TriangleMesh:
    """Closed prism over a polygon, which may have holes, up to the plane z = top . (x, y, 1); normals outwards."""
    polygon = shapely.orient_polygons(polygon)

    def raised(points: Array) -> Array:
        return np.column_stack([points, np.maximum(points @ top[:2] + top[2], floor_m + 0.1)])

    parts = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)):
        ring = shapely.get_coordinates(shapely.orient_polygons(triangle))[:3]
        parts.append(raised(ring))
        parts.append(np.column_stack([ring[::-1], np.full(3, floor_m)]))
    for ring in (polygon.exterior, *polygon.interiors):
        points = shapely.get_coordinates(ring)
        high = raised(points)
        low = np.column_stack([points, np.full(len(points), floor_m)])
        for k in range(len(points) - 1):
            parts.append(np.array([low[k], low[k + 1], high[k + 1]]))
            parts.append(np.array([low[k], high[k + 1], high[k]]))
    return from_corners(np.array(parts, dtype=np.float64))


def _faces(blocks: Sequence[tuple[shapely.Polygon, Array]], walls: Sequence[Wall], floor_m: float) -> tuple[Face, ...]:
    """Sides of the blocks that do not touch another one, with the wall that each lies on."""
    together = shapely.unary_union([polygon for polygon, _ in blocks]).buffer(-0.02)
    faces = []
    for polygon, top in blocks:
        for ring in (polygon.exterior, *polygon.interiors):
            points = shapely.get_coordinates(ring)
            for a, b in pairwise(points):
                middle = 0.5 * (a + b)
                along = (b - a) / max(1e-9, float(np.linalg.norm(b - a)))
                out = np.array([along[1], -along[0]])
                outside = middle + 0.1 * out
                if together.contains(shapely.Point(outside)):
                    continue
                number, share = _wall_of(a, b, out, walls)
                high = max(float(middle @ top[:2] + top[2]), floor_m + 0.1)
                ends = ((float(a[0]), float(a[1])), (float(b[0]), float(b[1])))
                faces.append(Face(ends, floor_m, high, share, number))
    return tuple(faces)


def _wall_of(a: Array, b: Array, out: Array, walls: Sequence[Wall]) -> tuple[int | None, float]:
    """The wall that most of an edge lies on, and the share of the edge that was seen on it."""
    best, most = None, 0.0
    length = float(np.linalg.norm(b - a))
    for number, wall in enumerate(walls):
        if float(out @ wall.normal) < math.cos(math.radians(2.0 * SAME_LINE_DEG)):
            continue
        if abs(float(0.5 * (a + b) @ wall.normal) - wall.offset_m) > SAME_LINE_M:
            continue
        one, other = sorted((float(a @ wall.along), float(b @ wall.along)))
        share = max(0.0, min(other, wall.ends_m[1]) - max(one, wall.ends_m[0])) / max(length, 1e-9)
        if share > most:
            most, best = share, number
    return best, 0.0 if best is None else most * walls[best].seen_share


MOST_OTHERS = 150
LEAST_OTHER_M = 1.5

FILLED, LEAST_BOX = 0.4, 4
"""A box is cut in two where less of its cells is filled, and it has so many along a side: rows of houses that stand at
an angle would be one box with the site inside it."""


def _others(
    cloud: Cloud, blocks: Sequence[tuple[shapely.Polygon, Array]], ground: Ground, parameters: BuildingParameters
) -> tuple[tuple[Array, Array], ...]:
    """Boxes around points that stand on the ground beside the blocks."""
    from scipy.ndimage import label

    near = shapely.unary_union([polygon for polygon, _ in blocks]).buffer(1.0)
    points = cloud.points[cloud.points[:, 2] > ground.z_m + LEAST_OTHER_M]
    points = points[~shapely.contains_xy(near, points[:, 0], points[:, 1])]
    if len(points) < 8:
        return ()
    size = max(1.0, 3.0 * parameters.cell_m)
    low = points[:, :2].min(axis=0)
    cells = np.floor((points[:, :2] - low) / size).astype(np.int64)
    shape = cells.max(axis=0) + 1
    if shape.prod() > 4_000_000:
        return ()
    filled = np.zeros(shape, np.int64)
    np.add.at(filled, (cells[:, 0], cells[:, 1]), 1)
    marks, _ = label(filled >= 2, np.ones((3, 3)))
    own = marks[cells[:, 0], cells[:, 1]]
    boxes = []
    for number in np.unique(own[own > 0]):
        rows = np.flatnonzero(own == number)
        for part in _parts_of(cells[rows]) if len(rows) >= 8 else ():
            inside = points[rows[part]]
            lowest = np.array([*inside[:, :2].min(axis=0), ground.z_m])
            boxes.append((len(inside), lowest, inside.max(axis=0) + 0.2))
    boxes.sort(key=lambda box: -box[0])
    return tuple((lowest, highest) for _, lowest, highest in boxes[:MOST_OTHERS])


def _parts_of(cells: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Rows of cells, shape (n, 2), in parts whose boxes are well filled."""
    waiting, parts = [np.arange(len(cells))], []
    while waiting:
        rows = waiting.pop()
        low, sides = cells[rows].min(axis=0), np.ptp(cells[rows], axis=0) + 1
        n_filled = len(np.unique(cells[rows], axis=0))
        longer = int(np.argmax(sides))
        if n_filled >= FILLED * sides.prod() or sides[longer] < LEAST_BOX:
            parts.append(rows)
            continue
        is_low = cells[rows, longer] < low[longer] + sides[longer] // 2
        waiting += [half for half in (rows[is_low], rows[~is_low]) if len(half)]
    return parts


def moved(buildings: Buildings, shift: Array) -> Buildings:
    """The same elsewhere, by a shift, shape (3,)."""
    flat, up = shift[:2], float(shift[2])
    walls = tuple(
        replace(
            wall,
            offset_m=wall.offset_m + float(wall.normal @ flat),
            ends_m=(wall.ends_m[0] + float(wall.along @ flat), wall.ends_m[1] + float(wall.along @ flat)),
            bottom_m=wall.bottom_m + up,
            top_m=wall.top_m + up,
        )
        for wall in buildings.walls
    )
    roofs = tuple(replace(roof, offset=roof.offset + float(roof.normal @ shift)) for roof in buildings.roofs)
    faces = tuple(
        replace(
            face,
            ends_m=tuple((x + float(flat[0]), y + float(flat[1])) for x, y in face.ends_m),  # type: ignore[arg-type]
            bottom_m=face.bottom_m + up,
            top_m=face.top_m + up,
        )
        for face in buildings.faces
    )
    mesh = TriangleMesh(buildings.mesh.vertices_enu_m + shift, buildings.mesh.triangles)
    others = tuple((low + shift, high + shift) for low, high in buildings.others)
    ground = replace(buildings.ground, z_m=buildings.ground.z_m + up)
    return replace(buildings, ground=ground, walls=walls, roofs=roofs, mesh=mesh, faces=faces, others=others)


# What is said of it.


def about_ground(buildings: Buildings) -> list[Finding]:
    """What is said of ground that was not seen, or that slopes."""
    ground, found = buildings.ground, []
    if not ground.is_seen:
        text = say("no ground was seen: it is taken to be where the lowest points are")
        found.append(Finding(Severity.WARNING, "ground-guessed", text))
    elif ground.slope_deg > 3.0:
        text = say("the ground falls by {:.1f} degrees; heights count from the building's foot", ground.slope_deg)
        found.append(Finding(Severity.NOTE, "ground-slopes", text, "", ground.slope_deg, 3.0, "deg"))
    return found


STRAIGHT_DOWN = math.sin(math.radians(65.0))

MOSTLY_GUESSED = 0.5
"""Share of walls from which on photos that look straight down are told to be why."""


def about_walls(buildings: Buildings, forwards: Array) -> list[Finding]:
    """What is said of walls that were not seen, and of heights.

    Parameters
    ----------
    forwards
        Of the cameras, ENU, shape (n, 3).
    """
    found = [Finding(Severity.WARNING, "walls-missing", note) for note in buildings.notes]
    looks_down = float(np.median(-forwards[:, 2])) > STRAIGHT_DOWN
    guessed = [face for face in buildings.faces if face.wall is None]
    share = sum(face.area_m2 for face in guessed) / max(1e-9, sum(face.area_m2 for face in buildings.faces))
    is_bare = not buildings.walls or share > MOSTLY_GUESSED
    if is_bare and looks_down:
        text = say(
            "the photos look straight down, where walls do not show: fly around the building too, with the camera 20 "
            "to 45 degrees below the horizon"
        )
        found = [Finding(Severity.WARNING, "looks-down", text)]
    if looks_down and look_one_way(forwards):
        text = say(
            "all photos look straight down: heights of ground and roofs are as good as their focal length only; photos "
            "that look to the side too, or control points, say them"
        )
        found.append(Finding(Severity.NOTE, "heights-by-lens", text))
    if guessed:
        text = say(
            "{} of {} sides of the building were not seen and are guessed, {:.0f} % of its walls; fly around it before "
            "you plan flights there",
            len(guessed),
            len(buildings.faces),
            100.0 * share,
        )
        found.append(Finding(Severity.WARNING, "walls-guessed", text, "", 100.0 * share, None, "%"))
    return found
