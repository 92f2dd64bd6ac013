"""Mesh files (OBJ, PLY, GLB, STL) as buildings: axes, units and far-off coordinates put right."""

from __future__ import annotations

import copy
import json
import re
import struct
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import parse_json
from planning.base.messages import say
from planning.base.progress import Monitor
from planning.geo.mesh import TriangleMesh, check_mesh_size, empty_mesh, load_triangles, mesh_content
from planning.site.importing.ground import place_on_ground, stated_ground
from planning.site.importing.options import UNITS_M, ImportOptions
from planning.site.importing.placement import place
from planning.site.importing.source import SourceModel, left_out_notes

# Mesh files whose parts are not all whole: what can be read is, and what is left out has a name.
#
# A file that is cut off is refused: nobody knows what is missing. Everything else is read by the usual reader where
# it
# can be; a text that this refuses, or of which it drops lines without a word, is gone through line by line here, and
# of a
# GLB file the primitives and nodes that lead nowhere are taken out before.

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_NUMBER = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_BROKEN_OBJ = re.compile(
    rb"^[ \t]*(?:v[ \t]+(?!%b[ \t]+%b[ \t]+%b(?:[ \t\r]|$))|f[ \t]+(?!(?:%b[ \t]+){2,}%b[ \t\r]*$)).*$"
    % (_NUMBER, _NUMBER, _NUMBER, rb"-?[1-9]\d*(?:/-?\d*){0,2}", rb"-?[1-9]\d*(?:/-?\d*){0,2}"),
    re.MULTILINE,
)
"""Lines of an OBJ file that should be vertices or faces and are none; in another program's extras nothing is lost."""

_FACET = re.compile(rb"facet\b(.*?)endfacet", re.DOTALL)
_CORNER = re.compile(rb"vertex\s+(%b)\s+(%b)\s+(%b)\s" % (_NUMBER, _NUMBER, _NUMBER))

_PLY_HEAD = re.compile(rb"ply\s+format\s+ascii\b.*?end_header[^\n]*\n", re.DOTALL)

STL_HEADER = struct.Struct("<80sI")
STL_FACET_BYTES = 50

GLB_HEADER, GLB_CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
NO_DATA = {"componentType": 5126, "type": "SCALAR", "count": 1}
"""An accessor of zeros, in the place of one that leads nowhere: readers look at all of them."""

COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class _Found(NamedTuple):
    """Vertices, shape (v, 3), triangles, shape (t, 3), and what was left out."""

    vertices: Array
    triangles: Ints
    left_out: list[str]


def read_mesh_parts(path: Path, max_coordinate: float) -> tuple[TriangleMesh, tuple[str, ...]]:
    """The triangles of a mesh file that are whole, and the names of what is not: also what lies beyond all bounds.

    Raises
    ------
    InputError
        The file is missing, of another kind, cut off or beyond reading, or no triangle is whole.
    """
    content, kind = mesh_content(path)
    if kind != ".glb":  # of those it is looked at without what is taken out
        check_mesh_size(content, kind, path)
    found = {".obj": _obj, ".ply": _ply, ".stl": _stl, ".glb": _glb}[kind](content, kind, path)
    in_range = ((found.triangles >= 0) & (found.triangles < len(found.vertices))).all(axis=1)
    inside = found.triangles[in_range]
    is_whole = (np.abs(found.vertices[inside]) <= max_coordinate).all(axis=(1, 2)) if len(inside) else np.zeros(0, bool)
    n_broken = len(found.triangles) - int(is_whole.sum())
    left_out = [*found.left_out, *[say("a triangle without one of its corners")] * n_broken]
    if not is_whole.any():
        raise InputError.say(
            "the mesh has no triangles that are whole (a point cloud cannot serve as a building)", place=path
        )
    vertices = np.where(np.abs(found.vertices) <= max_coordinate, found.vertices, 0.0)
    return TriangleMesh(vertices, inside[is_whole]), tuple(left_out)


def _as_usual(content: bytes, kind: str, path: Path) -> _Found | None:
    """What the usual reader finds; None where it refuses."""
    try:
        return _Found(*load_triangles(content, kind, path), [])
    except InputError:
        return None


def _fans(polygons: Iterable[Sequence[int]]) -> Ints:
    """Triangles of polygons, each as a fan, shape (t, 3)."""
    fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    return np.array(fans, np.int64).reshape(-1, 3)


# --- texts ---


def _obj(content: bytes, kind: str, path: Path) -> _Found:
    if _BROKEN_OBJ.search(content) is None:
        found = _as_usual(content, kind, path)
        if (
            found is not None
            and len(found.triangles)
            and 0 <= found.triangles.min() <= found.triangles.max() < len(found.vertices)
        ):
            return found
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    left_out: list[str] = []
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split()
        if words[:1] == [b"v"]:
            point = _numbers(words[1:4])
            left_out += [say("line {}", number)] * (point is None)
            vertices.append(point or [np.nan] * 3)
        elif words[:1] == [b"f"]:
            polygon = _references(words[1:], len(vertices))
            left_out += [say("line {}", number)] * (polygon is None)
            polygons += [] if polygon is None else [polygon]
    return _Found(np.array(vertices, np.float64).reshape(-1, 3), _fans(polygons), left_out)


def _numbers(words: Sequence[bytes]) -> list[float] | None:
    """Three finite numbers; None where there are none."""
    try:
        values = [float(word) for word in words]
    except ValueError:
        return None
    return values if len(values) == 3 and np.isfinite(values).all() else None


def _references(words: Sequence[bytes], n_vertices: int) -> list[int] | None:
    """Vertices of a face, from 0; None where it is none. Numbers below 0 count back from the vertex before it."""
    try:
        numbers = [int(word.split(b"/")[0]) for word in words]
    except ValueError:
        return None
    if len(numbers) < 3 or 0 in numbers:
        return None
    return [number - 1 if number > 0 else n_vertices + number for number in numbers]


def _stl(content: bytes, kind: str, path: Path) -> _Found:
    is_binary = len(content) >= STL_HEADER.size and not (
        content.lstrip()[:5] == b"solid" and b"facet" in content[:1024]
    )
    if is_binary:
        n_wanted, n_there = STL_HEADER.unpack_from(content)[1], (len(content) - STL_HEADER.size) // STL_FACET_BYTES
        if n_there < n_wanted:
            raise InputError.say(
                "the file is cut off: it announces {} triangles, and {} are there; copy or export it again",
                n_wanted,
                n_there,
                place=path,
            )
        return _Found(*load_triangles(content, kind, path), [])
    found = _as_usual(content, kind, path)
    n_begun = len(re.findall(rb"\bfacet\s+normal\b", content))
    if found is not None and len(found.triangles) == n_begun:
        return found
    corners: list[list[list[float]]] = []
    left_out: list[str] = []
    for number, facet in enumerate(_FACET.finditer(content), 1):
        points = [[float(value) for value in corner.groups()] for corner in _CORNER.finditer(facet[1] + b" ")]
        if len(points) == 3:
            corners.append(points)
        else:
            left_out.append(say("facet {}", number))
    vertices = np.array(corners, np.float64).reshape(-1, 3)
    return _Found(vertices, np.arange(len(vertices), dtype=np.int64).reshape(-1, 3), left_out)


def _ply(content: bytes, kind: str, path: Path) -> _Found:
    head = _PLY_HEAD.match(content)
    found = _as_usual(content, kind, path)
    if head is None:
        if found is None:
            raise InputError.say(
                "this PLY file cannot be read: it is cut off, or its header announces something else than what "
                "is there; copy or export it again",
                place=path,
            )
        return found
    elements = [
        (name.decode("latin-1"), int(count)) for name, count in re.findall(rb"element\s+(\S+)\s+(\d+)", head[0])
    ]
    rows = content[head.end() :].splitlines()
    n_wanted = sum(count for _, count in elements)
    if len(rows) < n_wanted:
        raise InputError.say(
            "the file is cut off: it announces {} rows, and {} are there; copy or export it again",
            n_wanted,
            len(rows),
            place=path,
        )
    n_faces = sum(count for name, count in elements if name == "face")
    if found is not None and len(found.triangles) >= n_faces and np.isfinite(found.vertices).all():
        return found
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    left_out: list[str] = []
    first_line = head[0].count(b"\n") + 1
    for name, number, row in _rows(elements, rows):
        words = row.split()
        if name == "vertex":
            point = _numbers(words[:3])
            left_out += [say("line {}", first_line + number)] * (point is None)
            vertices.append(point or [np.nan] * 3)
        elif name == "face":
            polygon = _counted(words)
            left_out += [say("line {}", first_line + number)] * (polygon is None)
            polygons += [] if polygon is None else [polygon]
    return _Found(np.array(vertices, np.float64).reshape(-1, 3), _fans(polygons), left_out)


def _rows(elements: Sequence[tuple[str, int]], rows: Sequence[bytes]) -> Iterator[tuple[str, int, bytes]]:
    """Rows with the element that each belongs to, and their number from 0."""
    number = 0
    for name, count in elements:
        for _ in range(count):
            yield name, number, rows[number]
            number += 1


def _counted(words: Sequence[bytes]) -> list[int] | None:
    """A list that begins with its length, as in a row of faces; None where it is none."""
    try:
        n = int(words[0])
        numbers = [int(word) for word in words[1 : n + 1]]
    except (ValueError, IndexError):
        return None
    return numbers if len(numbers) == n >= 3 else None


# --- GLB ---


def _glb(content: bytes, kind: str, path: Path) -> _Found:
    document, rest = _glb_parts(content, path)
    if document is None:
        return _Found(*load_triangles(content, kind, path), [])
    whole = copy.deepcopy(document)
    left_out = list(_take_out(whole, len(rest)))
    if whole != document:
        content = _glb_of(whole, rest)
    return _Found(*load_triangles(content, kind, path), left_out)


def _glb_parts(content: bytes, path: Path) -> tuple[dict[str, Any] | None, bytes]:
    """The JSON of a GLB file, None where it is none, and what follows it."""
    try:
        magic, _, _ = GLB_HEADER.unpack_from(content)
        length, name = GLB_CHUNK.unpack_from(content, GLB_HEADER.size)
        start = GLB_HEADER.size + GLB_CHUNK.size
        document = parse_json(content[start : start + length], path)
    except (struct.error, InputError):
        return None, b""
    is_one = magic == b"glTF" and name == b"JSON" and isinstance(document, dict)
    return (document if is_one else None), content[start + length :]


def _glb_of(document: dict[str, Any], rest: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = GLB_CHUNK.pack(len(text), b"JSON") + text + rest
    return GLB_HEADER.pack(b"glTF", 2, GLB_HEADER.size + len(body)) + body


def _take_out(document: dict[str, Any], n_bytes: int) -> Iterator[str]:
    """Take primitives out whose data are not there, and nodes' meshes that are not; their names."""
    meshes = document.get("meshes")
    meshes = meshes if isinstance(meshes, list) else []
    accessors = document.get("accessors")
    accessors = accessors if isinstance(accessors, list) else []
    readable = [_is_there(accessor, document, n_bytes) for accessor in accessors]
    for number in (k for k, is_there in enumerate(readable) if not is_there):
        accessors[number] = dict(NO_DATA)
    views = document.get("bufferViews")
    views = views if isinstance(views, list) else []
    for number, view in enumerate(views):
        if not _lies_within(view, n_bytes):
            views[number] = {"buffer": 0, "byteLength": 1}
    for number, mesh in enumerate(meshes):
        primitives = mesh.get("primitives") if isinstance(mesh, dict) else None
        kept = [each for each in primitives or () if _is_readable(each, readable)]
        name = mesh.get("name") if isinstance(mesh, dict) else None
        for _ in range(len(primitives or ()) - len(kept)):
            yield say("mesh '{}'", name or number)
        if not isinstance(mesh, dict) or len(kept) < len(primitives or ()):
            meshes[number] = {**mesh, "primitives": kept} if isinstance(mesh, dict) else {"primitives": []}
    empty = {number for number, mesh in enumerate(meshes) if not mesh.get("primitives")}
    nodes = document.get("nodes")
    for number, node in enumerate(nodes if isinstance(nodes, list) else ()):
        wanted = node.get("mesh") if isinstance(node, dict) else None
        if wanted is None:
            continue
        is_known = isinstance(wanted, int) and 0 <= wanted < len(meshes)
        if not is_known:
            yield say("node '{}'", node.get("name") or number)
        if not is_known or wanted in empty:
            del node["mesh"]


def _is_readable(primitive: Any, readable: Sequence[bool]) -> bool:
    """Whether vertices and indices of a primitive are there."""
    if not isinstance(primitive, dict) or not isinstance(primitive.get("attributes"), dict):
        return False
    wanted = [primitive["attributes"].get("POSITION")]
    wanted += [primitive["indices"]] if "indices" in primitive else []
    return all(isinstance(each, int) and 0 <= each < len(readable) and readable[each] for each in wanted)


def _is_there(accessor: Any, document: dict[str, Any], n_bytes: int) -> bool:
    """Whether the bytes that an accessor names lie in its view, and that in the file."""
    try:
        if "bufferView" not in accessor:
            return True
        view = document["bufferViews"][accessor["bufferView"]]
        wide = COMPONENT_BYTES[accessor["componentType"]] * COLUMNS[accessor["type"]]
        stride = view.get("byteStride") or wide
        n = accessor["count"]
        last = accessor.get("byteOffset", 0) + stride * (n - 1) + wide
        return bool(n > 0 and last <= view["byteLength"] and _lies_within(view, n_bytes))
    except (KeyError, TypeError, IndexError, AttributeError):
        return False


def _lies_within(view: Any, n_bytes: int) -> bool:
    """Whether the bytes of a view are in the file."""
    try:
        return bool(view.get("byteOffset", 0) >= 0 and view.get("byteOffset", 0) + view["byteLength"] <= n_bytes)
    except (KeyError, TypeError, AttributeError):
        return False


MAX_SOURCE_COORDINATE = 1e12
"""A projected coordinate has 1e7 metres, or 1e10 millimetres."""

COARSE_M = 0.01
"""Coordinates stored in steps coarser than this are worth a note."""


def read_mesh_source(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Building from a mesh file; it has no windows, so panels come from the grid the user states, or later.

    Raises
    ------
    InputError
        The file cannot be read or has no triangles, no panel grid is given though panels are
        required, or the place is not known.
    """
    if options.panels_required and not options.panel_grids:
        raise InputError.say(
            "a mesh does not tell windows from walls; state where the panels are, for example --panel-grid "
            "'0,0,0 36,0,0 0,0,42' --rows 14 --columns 20 (lower left, lower right and upper left corner of "
            "a facade, seen from outside), or import the building alone with --without-panels and find them "
            "in photos with 'panels'",
            place=path,
        )
    monitor.report(say("reading the mesh"), 0, 1)
    mesh, left_out = read_mesh_parts(path, MAX_SOURCE_COORDINATE)
    vertices, triangles = mesh.vertices_enu_m, mesh.triangles
    up = options.up or ("y" if path.suffix.lower() == ".glb" else "z")
    if up == "y":
        vertices = np.stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]], axis=-1)
    notes = [
        say("axes: {} is up", up) + (say(" (glTF's rule)") if up == "y" and options.up is None else "") + " (--up)"
    ]
    unit_m = UNITS_M[options.unit]
    if options.crs is None:
        vertices = vertices * unit_m
        notes.append(say("lengths are in {} (--units)", options.unit))
    elif options.unit != "m":
        raise InputError.say(
            "--units and --crs both say what the coordinates are in; the system of --crs has its own units"
        )
    used = np.unique(triangles)
    step_m = float(np.spacing(np.abs(vertices[used]).max().astype(np.float32)))
    if step_m > COARSE_M and (vertices[used] / unit_m == (vertices[used] / unit_m).astype(np.float32)).all():
        notes.append(
            say(
                "the file stores coordinates this far from zero in steps of {:.2g} m (single precision), so the "
                "building's shape is that rough; export it again with a local offset",
                step_m,
            )
        )
    stands = place_on_ground(
        vertices, triangles, stated_ground(options), lambda points, z: place(None, points, z, options)
    )
    return SourceModel(
        "",
        (),
        TriangleMesh(stands.vertices_enu_m, triangles[stands.is_kept]),
        empty_mesh(),
        stands.placement,
        notes=(*stands.placement.georeference.notes, *notes, *stands.notes, *left_out_notes(left_out)),
        terrain=stands.terrain,
        question=stands.question,
    )
