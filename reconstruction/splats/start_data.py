"""What is known of the scene of a data set folder before splats are learned."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.mesh import TriangleMesh, empty_mesh, read_mesh
from planning.site.file import read_site
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.record import ColmapModel
from reconstruction.light.photo_set import PhotoSet
from reconstruction.splats.ply_file import read_blocks, read_header
from reconstruction.splats.surfels import beside_panels

Array = NDArray[np.float64]

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


def points_alone(scene: KnownScene, folder: Path, *, knows_panels: bool) -> KnownScene:
    """What a method knows that begins at points of photogrammetry, none of which are on glass, and maybe of panels.

    Raises
    ------
    InputError
        There are no such points; the message names the folder that the scene is of.
    """
    corners = scene.corners_enu_m
    on_glass = beside_panels(scene.points_enu_m, corners, SAME_SURFACE_M, 0.0).panels >= 0
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
