"""What reading a mesh file will cost, found out before a reader starts: some bytes of it can mean gigabytes.

Texts become several Python objects a line. A GLB file may name the same bytes in any number of views, put the same
vertices into any number of meshes, and set each of them into its scene any number of times.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from planning.errors import InputError
from planning.files import MAX_PARSED_BYTES, MIB, FileLimit
from planning.json_file import parse_json

MESH_FILE = FileLimit("a mesh file", 2048 * MIB, "reduce it, or cut out the building")

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
        raise InputError(
            f"{path}: this mesh would take about {n_bytes / 2**30:.1f} GiB of memory; expected at most "
            f"{most / 2**30:.1f} GiB of one of its size; reduce it, or export the building alone as binary PLY"
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
        raise InputError(f"{path}: is no GLB file, or cut off; export it again")
    length, kind = struct.unpack_from("<I4s", content, 12)
    if kind != b"JSON" or length > len(content) - 20:
        raise InputError(f"{path}: the GLB file does not begin with its description, or is cut off; export it again")
    header = parse_json(content[20 : 20 + length], path)
    try:
        return len(content) + sum(_glb_parts(header))
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError) as error:
        raise InputError(f"{path}: the description in the GLB file is damaged ({error!r}); export it again") from error
    except _NotRead as error:
        raise InputError(f"{path}: {error}") from error


class _NotRead(Exception):  # noqa: N818
    """A form of GLB files that is not read."""


def _glb_parts(header: dict[str, Any]) -> Iterator[int]:
    found = [name for name in COMPRESSED if name in header.get("extensionsRequired", ())]
    if found:
        raise _NotRead(f"its triangles are compressed ({found[0]}), which is not read; export it without compression")
    if any(not str(buffer.get("uri", "data:")).startswith("data:") for buffer in header.get("buffers", ())):
        raise _NotRead("its triangles are in another file; export it as one file, with everything in it")
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
        raise _NotRead("its triangles are stored as differences from zero (sparse accessors), which is not read")
    n_vertices, n_indices = (_count(accessors[each]["count"]) for each in (used[0], used[-1]))
    # A triangle has three indices, or one where it is of a strip.
    return _VERTEX_BYTES * n_vertices + _TRIANGLE_BYTES * (n_indices if primitive.get("mode") == 5 else n_indices // 3)


def _count(value: object) -> int:
    if not isinstance(value, int) or value < 0:
        raise ValueError(f"expected a count, found {str(value)[:20]}")
    return value
