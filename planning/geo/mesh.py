"""Triangle meshes in the local frame: reading, writing, and telling closed (solid) parts from open skins."""

from __future__ import annotations

import io
import itertools
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MAX_PARSED_BYTES, MIB, FileLimit, read_input_file
from planning.base.json_file import parse_json, write_atomically
from planning.base.messages import about, say

# What reading a mesh file will cost, found out before a reader starts: some bytes of it can mean gigabytes.
#
# Texts become several Python objects a line. A GLB file may name the same bytes in any number of views, put the same
# vertices into any number of meshes, and set each of them into its scene any number of times.

MESH_FILE = FileLimit(say("a mesh file"), 2048 * MIB, say("reduce it, or cut out the building"))

_LINE_BYTES, _TEXT_FACTOR = 200, 6
"""That trimesh's readers of text take for a line, and for each of its characters (measured: 100 to 200, and 4 to 6)."""

_FREE_BYTES, _MOST_FACTOR = 2**30, 40
"""What any mesh may take, and how many times the bytes of its file; texts of short lines come nearest."""

_BINARY_FACTOR = 16
"""The same of bytes in PLY and STL files (measured: 12 to 19)."""

_VERTEX_BYTES, _TRIANGLE_BYTES, _NODE_BYTES = 72, 72, 6000
"""Of a mesh in a scene: float64 and int64 in the mesh, moved to its place, and joined with the others."""

_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
"""Of accessors (glTF 2.0, 3.6.2.2): bytes of a component by its type, and how many there are."""

COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")

BINARY_STL_HEADER = struct.Struct("<80sI")
STL_TRIANGLE_BYTES = 50


def check_mesh_size(content: bytes, kind: str, path: Path) -> None:
    """Refuse a mesh file that would take more memory than there may be.

    Parameters
    ----------
    kind
        The ending of its name, in small letters.

    Raises
    ------
    InputError
        As said, or a GLB file is damaged, or in a form that is not read.
    """
    if kind == ".glb":
        n_bytes = _glb_bytes(content, path)
    elif _is_text(content, kind):
        n_bytes = _TEXT_FACTOR * len(content) + _LINE_BYTES * (content.count(b"\n") + content.count(b"\r"))
    else:
        n_bytes = _BINARY_FACTOR * len(content)
    most = min(2 * MAX_PARSED_BYTES, max(_FREE_BYTES, _MOST_FACTOR * len(content)))
    _refuse(n_bytes, most, path)


def _refuse(n_bytes: int, most: int, path: Path) -> None:
    if n_bytes > most:
        raise InputError.say(
            "this mesh would take about {:.1f} GiB of memory; expected at most {:.1f} GiB of one of its "
            "size; reduce it, or export the building alone as binary PLY",
            n_bytes / 2**30,
            most / 2**30,
            place=path,
        )


def _is_text(content: bytes, kind: str) -> bool:
    if kind == ".ply":
        return b"format ascii" in content[:1000]
    if kind == ".stl" and len(content) >= BINARY_STL_HEADER.size:
        _, n_triangles = BINARY_STL_HEADER.unpack_from(content)
        return len(content) - STL_TRIANGLE_BYTES * int(n_triangles) != BINARY_STL_HEADER.size
    return True


def _glb_bytes(content: bytes, path: Path) -> int:
    """Memory for a GLB file."""
    if len(content) < 20 or content[:4] != b"glTF":
        raise InputError.say("is no GLB file, or cut off; export it again", place=path)
    length, kind = struct.unpack_from("<I4s", content, 12)
    if kind != b"JSON" or length > len(content) - 20:
        raise InputError.say(
            "the GLB file does not begin with its description, or is cut off; export it again", place=path
        )
    header = parse_json(content[20 : 20 + length], path)
    try:
        return len(content) + sum(_glb_parts(header))
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError) as error:
        raise InputError.say(
            "the description in the GLB file is damaged ({}); export it again", repr(error), place=path
        ) from error
    except _NotRead as error:
        raise InputError(about(path, error)) from error


class _NotRead(Exception):  # noqa: N818
    """A form of GLB files that is not read."""


def _glb_parts(header: dict[str, Any]) -> Iterator[int]:
    found = [name for name in COMPRESSED if name in header.get("extensionsRequired", ())]
    if found:
        raise _NotRead(
            say("its triangles are compressed ({}), which is not read; export it without compression", found[0])
        )
    if any(not str(buffer.get("uri", "data:")).startswith("data:") for buffer in header.get("buffers", ())):
        raise _NotRead(say("its triangles are in another file; export it as one file, with everything in it"))
    for view in header.get("bufferViews", ()):
        yield _count(view["byteLength"])
    accessors = header.get("accessors", ())
    for accessor in accessors:
        yield 2 * _count(accessor["count"]) * _SIZES[accessor["componentType"]] * _COLUMNS[accessor["type"]]
    parts = [mesh["primitives"] for mesh in header.get("meshes", ())]
    meshes = [sum(_primitive_bytes(primitive, accessors) for primitive in part) for part in parts]
    yield sum(meshes)
    n_parents = [0] * len(header.get("nodes", ()))
    for node in header.get("nodes", ()):
        for child in node.get("children", ()):
            n_parents[child] += 1
    for node, n in zip(header.get("nodes", ()), n_parents, strict=True):
        n_primitives = len(parts[node["mesh"]]) if "mesh" in node else 0
        yield max(1, n) * (_NODE_BYTES * (1 + n_primitives) + (meshes[node["mesh"]] if "mesh" in node else 0))


def _primitive_bytes(primitive: dict[str, Any], accessors: Any) -> int:
    if primitive.get("mode", 4) not in (4, 5):
        return 0
    used = [primitive["attributes"]["POSITION"], *([primitive["indices"]] if "indices" in primitive else [])]
    if any("bufferView" not in accessors[each] or "sparse" in accessors[each] for each in used):
        raise _NotRead(say("its triangles are stored as differences from zero (sparse accessors), which is not read"))
    n_vertices, n_indices = (_count(accessors[each]["count"]) for each in (used[0], used[-1]))
    # A triangle has three indices, or one where it is of a strip.
    return _VERTEX_BYTES * n_vertices + _TRIANGLE_BYTES * (n_indices if primitive.get("mode") == 5 else n_indices // 3)


def _count(value: object) -> int:
    if not isinstance(value, int) or value < 0:
        raise ValueError(f"expected a count, found {str(value)[:20]}")
    return value


MESH_SUFFIXES = (".ply", ".obj", ".glb", ".stl")

MAX_COORDINATE_M = 20_000.0
"""Largest local coordinate accepted: beyond it float32 is coarser than 2 mm, and the file is likely in UTM metres."""


@dataclass(frozen=True, slots=True, eq=False)
class TriangleMesh:
    """Triangles in ENU metres.

    Parameters
    ----------
    vertices_enu_m
        Shape (v, 3), float64, finite.
    triangles
        Shape (t, 3), int64 indices into the vertices.
    """

    vertices_enu_m: NDArray[np.float64]
    triangles: NDArray[np.int64]

    def __post_init__(self) -> None:
        if self.vertices_enu_m.ndim != 2 or self.vertices_enu_m.shape[1] != 3:
            raise ValueError(f"expected vertices of shape (v, 3), got {self.vertices_enu_m.shape}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"expected triangles of shape (t, 3), got {self.triangles.shape}")
        if not np.isfinite(self.vertices_enu_m).all():
            raise ValueError("a vertex has a coordinate that is not finite")
        if self.triangles.size and not 0 <= self.triangles.min() <= self.triangles.max() < len(self.vertices_enu_m):
            raise ValueError("a triangle names a vertex that does not exist")

    @property
    def corners_enu_m(self) -> NDArray[np.float64]:
        """Triangle corners, shape (t, 3, 3)."""
        return self.vertices_enu_m[self.triangles]


def empty_mesh() -> TriangleMesh:
    """Mesh without triangles."""
    return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))


def join(meshes: list[TriangleMesh]) -> TriangleMesh:
    """All triangles in one mesh."""
    if not meshes:
        return empty_mesh()
    offsets = np.cumsum([0] + [len(m.vertices_enu_m) for m in meshes[:-1]])
    return TriangleMesh(
        np.concatenate([m.vertices_enu_m for m in meshes]),
        np.concatenate([m.triangles + offset for m, offset in zip(meshes, offsets, strict=True)]),
    )


def box_mesh(min_enu_m: NDArray[np.float64], max_enu_m: NDArray[np.float64]) -> TriangleMesh:
    """Closed box between two corners, twelve triangles, normals outwards."""
    corners = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], dtype=bool)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return TriangleMesh(np.where(corners, max_enu_m, min_enu_m).astype(float), triangles.astype(np.int64))


def extrude(polygon_enu_m: NDArray[np.float64], floor_m: float, ceiling_m: float) -> TriangleMesh:
    """Closed vertical prism over a simple polygon, normals outwards.

    Parameters
    ----------
    polygon_enu_m
        Shape (k, 2), either direction, not closed, k >= 3.
    floor_m, ceiling_m
        ENU z of the bottom and the top.
    """
    import shapely

    polygon = shapely.orient_polygons(shapely.Polygon(polygon_enu_m))
    parts = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)):
        ring = shapely.get_coordinates(shapely.orient_polygons(triangle))[:3]
        parts.append(np.c_[ring, np.full(3, ceiling_m)])
        parts.append(np.c_[ring[::-1], np.full(3, floor_m)])
    for a, b in itertools.pairwise(shapely.get_coordinates(polygon)):
        low_a, low_b, high_a, high_b = (*a, floor_m), (*b, floor_m), (*a, ceiling_m), (*b, ceiling_m)
        parts.append(np.array([low_a, low_b, high_b]))
        parts.append(np.array([low_a, high_b, high_a]))
    return from_corners(np.array(parts, dtype=np.float64))


def from_corners(corners_enu_m: NDArray[np.float64]) -> TriangleMesh:
    """Mesh of separate triangles from their corners, shape (t, 3, 3)."""
    n = len(corners_enu_m)
    return TriangleMesh(corners_enu_m.reshape(-1, 3), np.arange(3 * n, dtype=np.int64).reshape(n, 3))


def mesh_content(path: Path) -> tuple[bytes, str]:
    """Bytes of a mesh file and its kind, the ending of its name in small letters.

    Raises
    ------
    InputError
        The file is missing, of another kind, or too large.
    """
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InputError.say("expected a mesh file ({}), got '{}'", ", ".join(MESH_SUFFIXES), path.suffix, place=path)
    if not path.exists():
        raise InputError.say("there is no such mesh file", place=path)
    return read_input_file(path, MESH_FILE), path.suffix.lower()


def load_triangles(content: bytes, kind: str, path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices and triangles of a mesh file as they stand in it, neither checked.

    Raises
    ------
    InputError
        It cannot be read, or would take too much memory.
    """
    check_mesh_size(content, kind, path)
    if (written := _as_written(content)) is not None:
        return written
    import trimesh

    # What is wrong with a file is said in an error, and once.
    trimesh.util.log.disabled = True
    try:
        # No resolver: what a file names beside itself (materials, textures) is neither needed nor to be trusted.
        # Numbers beyond all bounds overflow in between; they are refused by those who ask.
        with np.errstate(all="ignore"):
            loaded = trimesh.load_mesh(
                io.BytesIO(content), file_type=kind[1:], process=False, maintain_order=True, skip_materials=True
            )
            if isinstance(loaded, trimesh.Scene):
                loaded = loaded.to_mesh()
        vertices, triangles = np.asarray(loaded.vertices, np.float64), np.asarray(loaded.faces, np.int64)
    except Exception as error:  # trimesh's readers raise whatever their parsers raise
        raise InputError.say("this mesh cannot be read ({})", error, place=path) from error
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InputError.say("this mesh cannot be read (its vertices do not have three coordinates each)", place=path)
    return vertices, triangles


def read_mesh(path: Path, max_coordinate_m: float = MAX_COORDINATE_M) -> TriangleMesh:
    """Read a PLY, OBJ, GLB or STL file; its coordinates are taken as they stand.

    Raises
    ------
    InputError
        The file is missing, is of another kind, cannot be read, has no triangles, or has coordinates that are not
        finite or further than `max_coordinate_m` from the origin.
    """
    content, kind = mesh_content(path)
    vertices, triangles = load_triangles(content, kind, path)
    if triangles.ndim != 2 or len(triangles) == 0:
        raise InputError.say("the mesh has no triangles (a point cloud cannot serve as a building)", place=path)
    if not 0 <= triangles.min() <= triangles.max() < len(vertices):
        wrong = triangles.min() if triangles.min() < 0 else triangles.max()
        raise InputError.say(
            "a triangle names vertex {}, which is not there (vertices: 0 to {}); export the mesh again",
            wrong,
            len(vertices) - 1,
            place=path,
        )
    used = vertices[triangles]
    if not np.isfinite(used).all():
        raise InputError.say("the mesh has coordinates that are not finite numbers", place=path)
    if np.abs(used).max() > max_coordinate_m:
        raise InputError.say(
            "the mesh has a coordinate of {:.10g} m; local ENU metres near the site's origin are expected. "
            "Shift it (site import does) before using it",
            np.abs(used).max(),
            place=path,
        )
    return TriangleMesh(np.where(np.isfinite(vertices), vertices, 0.0), triangles)


PLY_HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment https://github.com/mikedh/trimesh\nelement vertex {}\n"
    "property float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\n"
    "end_header\n"
)
"""As trimesh writes it, to the letter: meshes of older projects are told by their bytes."""

_AS_WRITTEN = re.compile(re.escape(PLY_HEADER).replace(r"\{\}", "([0-9]{1,9})").encode())
_FACE = np.dtype([("n", "u1"), ("corners", "<i4", (3,))])


def ply_bytes(mesh: TriangleMesh) -> bytes:
    """Content of a binary PLY file; coordinates in single precision.

    Without trimesh: loading it, 200 modules, would hold up a window that keeps a project for the first time.
    """
    faces = np.empty(len(mesh.triangles), _FACE)
    faces["n"], faces["corners"] = 3, mesh.triangles
    header = PLY_HEADER.format(len(mesh.vertices_enu_m), len(faces))
    return header.encode() + mesh.vertices_enu_m.astype("<f4").tobytes() + faces.tobytes()


def _as_written(content: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Vertices and triangles of a file as `ply_bytes` writes it; None for any other.

    Without trimesh for the same reason: loading it took half as long as all else that is loaded to plan a flight.
    """
    found = _AS_WRITTEN.match(content)
    if found is None:
        return None
    n_vertices, n_faces = int(found[1]), int(found[2])
    start = found.end() + 12 * n_vertices
    if len(content) != start + _FACE.itemsize * n_faces:
        return None
    vertices = np.frombuffer(content, "<f4", 3 * n_vertices, found.end()).reshape(-1, 3)
    faces = np.frombuffer(content, _FACE, n_faces, start)
    if (faces["n"] != 3).any():
        return None
    with np.errstate(invalid="ignore"):  # of numbers that are none, which are refused by those who ask
        return vertices.astype(np.float64), faces["corners"].astype(np.int64)


def write_mesh(path: Path, mesh: TriangleMesh) -> None:
    """Write a binary PLY file, whole or not at all; errors as `write_atomically`."""
    write_atomically(path, ply_bytes(mesh))


def closed_parts(corners_enu_m: NDArray[np.float64]) -> NDArray[np.int64]:
    """Number of the closed part that each triangle belongs to, -1 for triangles of open skins.

    Vertices at equal coordinates are one vertex; triangles that share an edge belong together. A part is closed when
    each of its edges lies in exactly two (or another even number of) triangles.

    Parameters
    ----------
    corners_enu_m
        Shape (t, 3, 3), metres.

    Returns
    -------
    part
        Shape (t,), int64.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = len(corners_enu_m)
    if n == 0:
        return np.zeros(0, np.int64)
    triangles = row_numbers(corners_enu_m.reshape(-1, 3).round(6)).reshape(n, 3)
    degenerate = (
        (triangles[:, 0] == triangles[:, 1])
        | (triangles[:, 1] == triangles[:, 2])
        | (triangles[:, 2] == triangles[:, 0])
    )
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(n), 3)
    kept = ~degenerate[owner]
    edges, owner = edges[kept], owner[kept]
    if len(edges) == 0:
        return np.full(n, -1, np.int64)
    edge = row_numbers(edges)
    count = np.bincount(edge)
    n_edges = len(count)
    graph = coo_array((np.ones(len(edge)), (owner, n + edge)), shape=(n + n_edges, n + n_edges))
    _, label = connected_components(graph, directed=False)
    open_labels = np.unique(label[n:][count % 2 == 1])
    part = np.where(np.isin(label[:n], open_labels) | degenerate, -1, label[:n])
    _, compact = np.unique(part, return_inverse=True)
    return (compact - (1 if (part == -1).any() else 0)).astype(np.int64).ravel()


def row_numbers(rows: NDArray[Any]) -> NDArray[np.int64]:
    """Equal numbers for equal rows, shape (n, k), in their order from 0 on, shape (n,).

    As the inverse of `np.unique` with `axis=0`, but column by column: twelve times as fast for corners of meshes.
    """
    numbers = np.zeros(len(rows), np.int64)
    for column in rows.T:
        values, place = np.unique(column, return_inverse=True)
        _, numbers = np.unique(numbers * len(values) + place, return_inverse=True)
    return numbers
