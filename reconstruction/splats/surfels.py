"""Surfels to start from: even grids on panels, even samples of what rays hit, and loose points, in ENU metres."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.bvh import build_bvh, nearest_d2
from planning.geo.mesh import TriangleMesh, empty_mesh, read_mesh
from planning.site.file import read_site
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.record import ColmapModel
from reconstruction.dataset.layers import unit_normals
from reconstruction.light.photo_set import PhotoSet
from reconstruction.splats.ply import read_blocks, read_header

Array = NDArray[np.float64]


NEIGHBOURS = 3
"""Whose mean distance is a surfel's spacing, as in 3-D Gaussian splatting (Kerbl et al., 2023)."""

PLANE_NEIGHBOURS = 12
"""That a loose point's normal is told from."""

NARROWEST = 0.1
"""Of its spacing: a frame's surfel is not narrower, or it would be a needle."""

LEVELS = 4
"""Grids for each doubling of the spacing."""

TOO_NEAR = 0.6
"""Of its spacing: a sample nearer to a finer one than this is dropped."""


@dataclass(frozen=True, slots=True, eq=False)
class Surfels:
    """n pieces of surface.

    Parameters
    ----------
    points_enu_m, normals_enu, tangents_enu
        Shape (n, 3); normals and tangents unit and at right angles.
    spacings_m
        Distance to the next ones along the tangent and across it, shape (n, 2).
    panels
        Which panel, from 0, or -1, shape (n,).
    """

    points_enu_m: Array
    normals_enu: Array
    tangents_enu: Array
    spacings_m: Array
    panels: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points_enu_m)


def joined(parts: Sequence[Surfels]) -> Surfels:
    """All surfels of several."""
    return Surfels(
        np.concatenate([part.points_enu_m for part in parts]),
        np.concatenate([part.normals_enu for part in parts]),
        np.concatenate([part.tangents_enu for part in parts]),
        np.concatenate([part.spacings_m for part in parts]),
        np.concatenate([part.panels for part in parts]),
    )


def surfels_between(points_enu_m: Array, normals_enu: Array, spacings_m: Array, gaps_m: Array, edges: Array) -> Surfels:
    """Of no panel; beside glass they lie along its edge and are so narrow that they end there.

    Parameters
    ----------
    gaps_m, edges
        Of `panel_proximity`.
    """
    helper = np.zeros_like(normals_enu)
    helper[np.arange(len(helper)), np.abs(normals_enu).argmin(axis=1)] = 1.0
    along = edges - (edges * normals_enu).sum(axis=1, keepdims=True) * normals_enu
    # Of a frame's side, the edge may be the normal; away from glass there is no edge.
    is_along = (np.linalg.norm(along, axis=1) > 0.5) & (gaps_m < spacings_m)
    tangents = np.where(is_along[:, None], along, np.cross(normals_enu, helper))
    tangents /= np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12)
    across = np.where(is_along, np.clip(2.0 * gaps_m, NARROWEST * spacings_m, spacings_m), spacings_m)
    none = np.full(len(points_enu_m), -1, np.int32)
    return Surfels(points_enu_m, normals_enu, tangents, np.column_stack([spacings_m, across]), none)


def n_on_panel(corners_enu_m: Array, spacings_m: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Columns and rows of the grids on panels, each shape (m,), at least 1."""
    width, height = _sides(corners_enu_m)
    return tuple(np.maximum(1, np.rint(side / spacings_m)).astype(np.int64) for side in (width, height))  # type: ignore[return-value]


def panel_surfels(corners_enu_m: Array, spacings_m: Array) -> Surfels:
    """Even grids in the panels' planes, tangents along their lower edges.

    Parameters
    ----------
    corners_enu_m
        Shape (m, 4, 3), counter-clockwise from outside, the lower left one first.
    spacings_m
        Wanted on each panel, shape (m,).
    """
    if not len(corners_enu_m):
        blank = np.zeros((0, 3))
        return Surfels(blank, blank, blank, np.zeros((0, 2)), np.zeros(0, np.int32))
    columns, rows = n_on_panel(corners_enu_m, spacings_m)
    width, height = _sides(corners_enu_m)
    panels = np.repeat(np.arange(len(corners_enu_m)), columns * rows)
    within = np.arange(len(panels)) - np.repeat(np.cumsum(columns * rows) - columns * rows, columns * rows)
    a = ((within % columns[panels] + 0.5) / columns[panels])[:, None]
    b = ((within // columns[panels] + 0.5) / rows[panels])[:, None]
    first, second, third, fourth = np.moveaxis(corners_enu_m[panels], 1, 0)
    points = (1 - b) * ((1 - a) * first + a * second) + b * ((1 - a) * fourth + a * third)
    normals = unit_normals(corners_enu_m)
    edges = corners_enu_m[:, 1] - corners_enu_m[:, 0] + corners_enu_m[:, 2] - corners_enu_m[:, 3]
    edges -= (edges * normals).sum(axis=1, keepdims=True) * normals
    edges /= np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), 1e-12)
    spacings = np.column_stack([width / columns, height / rows])
    return Surfels(points, normals[panels], edges[panels], spacings[panels], panels.astype(np.int32))


def _sides(corners_enu_m: Array) -> tuple[Array, Array]:
    """Mean width and height of panels, each shape (m,)."""
    sides = np.linalg.norm(np.roll(corners_enu_m, -1, axis=1) - corners_enu_m, axis=2)
    return 0.5 * (sides[:, 0] + sides[:, 2]), 0.5 * (sides[:, 1] + sides[:, 3])


@dataclass(frozen=True, slots=True, eq=False)
class PanelProximity:
    """Where points lie as the panels see it.

    Parameters
    ----------
    panels
        Panel that a point is in front of or behind, shape (n,); -1 for none.
    gaps_m
        Distance to the next panel's outline, shape (n,); inf beyond the reach that was asked for.
    edges_enu
        Unit direction of that piece of outline, shape (n, 3).
    """

    panels: NDArray[np.int32]
    gaps_m: Array
    edges_enu: Array


def panel_proximity(points_enu_m: Array, corners_enu_m: Array, within_m: float, reach_m: float) -> PanelProximity:
    """Which points are a panel's, and how far the others are from glass.

    Parameters
    ----------
    within_m
        Off a panel's plane a point still is the panel's.
    reach_m
        To which gaps are told.
    """
    n = len(points_enu_m)
    found = PanelProximity(np.full(n, -1, np.int32), np.full(n, np.inf), np.zeros((n, 3)))
    if not n or not len(corners_enu_m):
        return found
    tree = cKDTree(points_enu_m)
    middles = corners_enu_m.mean(axis=1)
    reaches = np.linalg.norm(corners_enu_m - middles[:, None], axis=2).max(axis=1) + max(within_m, reach_m)
    normals = unit_normals(corners_enu_m)
    for number, (corners, normal) in enumerate(zip(corners_enu_m, normals, strict=True)):
        near = np.array(tree.query_ball_point(middles[number], reaches[number]), np.int64)
        if not len(near):
            continue
        points = points_enu_m[near]
        inside = np.abs((points - corners[0]) @ normal) <= within_m
        for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            edge = second - first
            inside &= (points - first) @ np.cross(normal, edge) >= 0.0
            share = np.clip((points - first) @ edge / max(edge @ edge, 1e-20), 0.0, 1.0)
            gaps = np.linalg.norm(points - first - share[:, None] * edge, axis=1)
            nearer = near[gaps < np.minimum(found.gaps_m[near], reach_m)]
            found.gaps_m[nearer] = gaps[gaps < np.minimum(found.gaps_m[near], reach_m)]
            found.edges_enu[nearer] = edge / max(float(np.linalg.norm(edge)), 1e-12)
        found.panels[near[inside]] = number
    return found


def thinned(points_enu_m: Array, spacings_m: Array, gaps_m: Array) -> NDArray[np.int64]:
    """Which of the points to keep so that they are about as far apart as told, finer ones first.

    First one point of each cell of a grid about as fine as told is kept: the one furthest from glass where that is near
    (the middle of a frame), else the one nearest to the cell's middle. Then those go that are too near to a finer one
    in the next cell.

    Parameters
    ----------
    gaps_m
        To the next panel, shape (n,).
    """
    if not len(points_enu_m):
        return np.zeros(0, np.int64)
    # Counted from the finest, so that cells grow as spacings do, and not by leaps.
    finest_m = spacings_m.min()
    levels = np.floor(LEVELS * np.log2(spacings_m / finest_m)).astype(np.int64)
    sides = (finest_m * np.exp2(levels / LEVELS))[:, None]
    cells = np.floor(points_enu_m / sides)
    off = np.abs(points_enu_m / sides - cells - 0.5).max(axis=1)
    off -= 2.0 * np.minimum(gaps_m / spacings_m, 1.0)
    keys = np.column_stack([levels, cells.astype(np.int64)])
    order = np.lexsort([off, *keys.T])
    is_first = np.ones(len(order), bool)
    is_first[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    kept = order[is_first]
    rank = np.empty(len(kept), np.int64)
    rank[np.argsort(spacings_m[kept], kind="stable")] = np.arange(len(kept))
    # Asked for a list of neighbours, the tree gives columns for one point, too.
    order_of_near = np.arange(1, min(8, len(kept)) + 1)
    distances, near = (
        np.asarray(part) for part in cKDTree(points_enu_m[kept]).query(points_enu_m[kept], order_of_near)
    )
    crowded = (distances < TOO_NEAR * spacings_m[kept, None]) & (rank[near] < rank[:, None])
    return np.sort(kept[~crowded.any(axis=1)])


def spacings_of(points_enu_m: Array, least_m: Array, most_m: Array, is_loose: NDArray[np.bool_]) -> Array:
    """Mean distance to the next `NEIGHBOURS` points, kept between two bounds, shape (n,).

    Loose points may be sparser than what is wanted of surfaces: they reach their neighbours, so that walls between them
    are closed, but no more than `SPARSEST` times as far as usual ones do.

    Parameters
    ----------
    is_loose
        Which points are of no known surface, shape (n,).
    """
    if len(points_enu_m) <= NEIGHBOURS:
        return most_m.copy()
    distances = np.asarray(cKDTree(points_enu_m).query(points_enu_m, NEIGHBOURS + 1)[0])[:, 1:].mean(axis=1)
    if is_loose.any():
        usual_m = float(np.median(distances[is_loose]))
        most_m = np.where(is_loose, np.maximum(most_m, SPARSEST * usual_m), most_m)
    return np.asarray(np.clip(distances, least_m, most_m))


SPARSEST = 4.0
"""Times the median distance of loose points: one that is farther from its neighbours is no part of a wall."""


def plane_normals(points_enu_m: Array, cloud_enu_m: Array) -> Array:
    """Unit normals of the planes that a cloud has around points, shape (n, 3); upwards where it has none."""
    n_near = min(PLANE_NEIGHBOURS, len(cloud_enu_m))
    normals = np.tile([0.0, 0.0, 1.0], (len(points_enu_m), 1))
    if n_near < 3 or not len(points_enu_m):
        return normals
    _, near = cKDTree(cloud_enu_m).query(points_enu_m, n_near)
    around = cloud_enu_m[near]
    around = around - around.mean(axis=1, keepdims=True)
    values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))
    # On a line, or with all points in one place, any direction across is as good.
    known = values[:, 1] > 1e-12
    normals[known] = vectors[known, :, 0]
    return normals


# What is known of the scene of a data set folder before splats are learned.

POINTS, MODEL = "points.ply", Path("sparse", "0")

MESHES = ("refined.ply", "building.ply")
"""Of `prepare`, and of `scene render`; the first that is there is taken."""

SITE = "site.json"
"""That `scene render` leaves in the folder."""

COLOURS = ("red", "green", "blue")

SAME_SURFACE_M = 0.3
"""Off a panel's plane, inside its outline: that is the panel, as a coarser model has it."""

WORST_PX = 2.0
"""Reprojection error from which on a COLMAP point is left out."""


@dataclass(frozen=True, slots=True, eq=False)
class KnownScene:
    """What is known of a scene before splats are learned; any part may be empty, but not all.

    Parameters
    ----------
    corners_enu_m
        Of panels, shape (m, 4, 3), counter-clockwise from outside, the lower left one first.
    mesh
        Refined or coarse.
    points_enu_m, rgb
        Coloured points, shapes (n, 3) and (n, 3), uint8.
    ground_z_m
        Height of the level ground that rays meet which nothing else stops; None where it is not known.
    """

    corners_enu_m: Array
    mesh: TriangleMesh
    points_enu_m: Array
    rgb: NDArray[np.uint8]
    ground_z_m: float | None = None


def model_origin(scene: KnownScene) -> Array:
    """Middle of the panels, else of the points, else of the mesh, shape (3,): the origin of the model's frame.

    Raises
    ------
    InputError
        There is nothing at all.
    """
    if len(scene.corners_enu_m):
        places = scene.corners_enu_m.reshape(-1, 3)
        return np.asarray(0.5 * (places.min(axis=0) + places.max(axis=0)))
    if len(scene.points_enu_m):
        return np.asarray(np.median(scene.points_enu_m, axis=0))
    if len(scene.mesh.triangles):
        return np.asarray(scene.mesh.corners_enu_m.reshape(-1, 3).mean(axis=0))
    raise InputError(say("there are no panels, no mesh and no points to start from; prepare the data set again"))


def known_scene(photo_set: PhotoSet) -> KnownScene:
    """Panels, mesh and points of a folder that `prepare` or `scene render` wrote; mesh and points may be missing.

    Points are those of `points.ply`, else of the COLMAP model.

    Raises
    ------
    InputError
        A file is damaged.
    """
    folder = photo_set.folder
    mesh_path = next((folder / name for name in MESHES if (folder / name).is_file()), None)
    mesh = empty_mesh() if mesh_path is None else read_mesh(mesh_path)
    points, rgb = np.zeros((0, 3)), np.zeros((0, 3), np.uint8)
    if (folder / POINTS).is_file():
        points, rgb = read_points(folder / POINTS)
    elif (folder / MODEL).is_dir():
        points, rgb = colmap_points(read_model(folder / MODEL))
    return KnownScene(photo_set.panels.corners_enu_m, mesh, points, rgb, _ground_z_m(folder, mesh))


def points_only(scene: KnownScene, folder: Path, *, knows_panels: bool) -> KnownScene:
    """What a method knows that begins at points of photogrammetry, none of which are on glass, and maybe of panels.

    Raises
    ------
    InputError
        There are no such points; the message names the folder that the scene is of.
    """
    corners = scene.corners_enu_m
    on_glass = panel_proximity(scene.points_enu_m, corners, SAME_SURFACE_M, 0.0).panels >= 0
    if on_glass.all():
        raise InputError(
            say(
                "of {} points of photogrammetry none is away from glass, so splats cannot start from points; put "
                "some there ({}, or a COLMAP model in {}), or start from surfaces",
                len(on_glass),
                POINTS,
                MODEL.as_posix(),
                place=folder,
            )
        )
    corners = corners if knows_panels else corners[:0]
    return KnownScene(corners, empty_mesh(), scene.points_enu_m[~on_glass], scene.rgb[~on_glass])


# A coarse wall goes straight across doors, niches and what stands before it. Splats that begin there stay there: in few
# photos each sees another part of what is behind. Without glass, whose mirror images are points behind it, points of
# photogrammetry say whether that is so.

OWN_M = 0.001
"""Off the mesh: such a point was spread over it, and says nothing about it."""

OFF, LEAST_OFF_M = 0.004, 0.05
"""Of the distance to the nearest camera, in the middle, and at least: nearer points lie on the mesh."""

BESIDE_MESH_M = 3.0
"""Points further off are trees and other houses."""

LEAST_CLOUD = 1000
"""Points that a scene can begin on."""


@dataclass(frozen=True, slots=True)
class OffMesh:
    """How many points of photogrammetry there are beside a mesh, the share that lies off it, and how far is off."""

    n_points: int
    share: float
    off_m: float


@dataclass(frozen=True, slots=True)
class PointsForMesh:
    """Begin on points of photogrammetry in the place of a mesh that they do not lie on.

    With 36 % of them off it, unseen photos of a castle gained 1.2 dB by it, with 73 % those of a door 5.5 dB (2DGS,
    60 s).
    """

    name: str = say("splats begin on points, not on the mesh")
    unit: str = say("of the points")
    tolerance: float = 0.3

    def assess(self, scene: OffMesh) -> Assessment:
        """Share of points off the mesh."""
        if scene.n_points < LEAST_CLOUD:
            return Assessment(0.0, say("there are too few points ({})", scene.n_points), 0.0)
        reason = say("{:.0f} % of the points lie more than {:.2g} m off the mesh", 100.0 * scene.share, scene.off_m)
        return Assessment(scene.share, reason, 0.0)


def scene_of_points(
    scene: KnownScene, cameras_enu_m: Array, setting: EffectSetting = "auto"
) -> tuple[KnownScene, Decision | None]:
    """The scene that splats begin on, points and ground alone where the decision is on; None where none is to be made.

    That is where glass is known, or no mesh.

    Parameters
    ----------
    cameras_enu_m
        Of the photos learned from, shape (k, 3).
    """
    if len(scene.corners_enu_m) or not len(scene.mesh.triangles):
        return scene, None
    bvh = build_bvh(scene.mesh.corners_enu_m)
    distances_m = np.array([math.sqrt(nearest_d2(bvh, point, math.inf)) for point in scene.points_enu_m])
    is_found = distances_m > OWN_M
    to_camera = cKDTree(cameras_enu_m).query(scene.points_enu_m[is_found])[0] if is_found.any() else np.zeros(1)
    off_m = max(LEAST_OFF_M, OFF * float(np.median(to_camera)))
    beside = distances_m[is_found & (distances_m <= BESIDE_MESH_M)]
    share = float((beside > off_m).mean()) if len(beside) else 0.0
    decision = decide(PointsForMesh(), OffMesh(len(beside), share, off_m), setting)
    if not decision.on or not is_found.any():
        return scene, decision
    points = scene.points_enu_m[is_found]
    return replace(scene, mesh=empty_mesh(), points_enu_m=points, rgb=scene.rgb[is_found]), decision


def _ground_z_m(folder: Path, mesh: TriangleMesh) -> float | None:
    """Of the folder's site, else the lowest place of the mesh: buildings stand on the ground."""
    if (folder / SITE).is_file():
        return read_site(folder / SITE).site.airspace.ground_z_m
    return float(mesh.corners_enu_m[..., 2].min()) if len(mesh.triangles) else None


def colmap_points(model: ColmapModel) -> tuple[Array, NDArray[np.uint8]]:
    """Points, shape (n, 3), and their colours, shape (n, 3), of a model, less those that fit their photos badly."""
    points = model.points
    kept = points.errors_px <= WORST_PX
    return points.xyz[kept], points.rgb[kept]


def read_points(path: Path) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Points, shape (n, 3), and their colours, shape (n, 3), of a PLY file; grey where it has no colours.

    Raises
    ------
    InputError
        The file cannot be read, has no coordinates, or some that are not finite.
    """
    header = read_header(path)
    missing = next((axis for axis in "xyz" if axis not in header.names), None)
    if missing is not None:
        raise InputError(say("its points have no '{}'", missing, place=path))
    is_coloured = header.names.issuperset(COLOURS) and all(dict(header.columns)[name] == "u1" for name in COLOURS)
    points = np.empty((header.n_rows, 3))
    rgb = np.full((header.n_rows, 3), 128, np.uint8)
    row = 0
    for block in read_blocks(path, header):
        for column, axis in enumerate("xyz"):
            points[row : row + len(block), column] = block[axis]
        if is_coloured:
            for column, colour in enumerate(COLOURS):
                rgb[row : row + len(block), column] = block[colour]
        row += len(block)
    if not np.isfinite(points).all():
        raise InputError(say("has points whose coordinates are not finite numbers; make it again", place=path))
    return points, rgb
