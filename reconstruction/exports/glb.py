"""Binary glTF files (.glb): JSON, and numbers laid out before they are written, in blocks.

Format: glTF 2.0, section 4.4. Numbers are little-endian.
"""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import Monitor
from planning.geo.frames import Vec3
from reconstruction.exports.component_parts import Ellipsoids, element_numbers, ellipsoid_blocks, light_of
from reconstruction.exports.compression import whole_file
from reconstruction.objects.gs_scene import GsComponent, GsElement, GsScene

FLOAT, UINT8, UINT16, UINT32 = 5126, 5121, 5123, 5125
"""Types of accessors."""

TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
"""Of accessors, by the numbers in one item."""

VERTICES, INDICES = 34962, 34963
"""What views of the buffer are for."""

ALIGNMENT = 8
"""Of views, bytes: columns of a property table may have items of 8 bytes."""

LARGEST_BYTES = 2**32 - 1
"""A .glb says its length in 32 bits."""

HEADER_BYTES = 28
"""Of the file and its two chunks."""

Put = Callable[[int, NDArray[Any]], None]
"""Writes numbers from a byte of the buffer on."""

_DTYPES = {FLOAT: "<f4", UINT16: "<u2", UINT32: "<u4"}


class GlbBuffer:
    """The numbers of a file: where each lies, and who writes them when it is time."""

    def __init__(self) -> None:
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []
        self.n_bytes = 0
        self._fills: list[Callable[[Put], None]] = []

    def view(self, n_bytes: int, target: int | None = None) -> int:
        """Room for bytes; returns the view's number."""
        offset = -(-self.n_bytes // ALIGNMENT) * ALIGNMENT
        self.views.append({"buffer": 0, "byteOffset": offset, "byteLength": n_bytes})
        if target is not None:
            self.views[-1]["target"] = target
        self.n_bytes = offset + n_bytes
        return len(self.views) - 1

    def add(self, content: bytes) -> int:
        """A view of given bytes; there must be one at least."""
        number = self.view(len(content))
        offset, numbers = self.views[number]["byteOffset"], np.frombuffer(content, np.uint8)
        self._fills.append(lambda put: put(offset, numbers))
        return number

    def accessor(self, n: int, width: int, kind: int, target: int = VERTICES, **more: Any) -> int:
        """Room for n items of `width` numbers each; returns the accessor's number.

        Parameters
        ----------
        more
            Of the accessor: `min`, `max`, `normalized`.
        """
        view = self.view(n * width * np.dtype(_DTYPES[kind]).itemsize, target)
        self.accessors.append({"bufferView": view, "componentType": kind, "count": n, "type": TYPES[width], **more})
        return len(self.accessors) - 1

    def unfilled(self, n: int, width: int, kind: int, **more: Any) -> int:
        """An accessor of numbers that an extension gives; returns its number."""
        self.accessors.append({"componentType": kind, "count": n, "type": TYPES[width], **more})
        return len(self.accessors) - 1

    def fill(self, write: Callable[[Put], None]) -> None:
        """Have numbers written later, by a function that may put them in any order."""
        self._fills.append(write)

    def table(self, values: NDArray[Any], kind: int, target: int = VERTICES, **more: Any) -> int:
        """An accessor of few numbers, shape (n,) or (n, width); returns its number."""
        number = self.accessor(len(values), 1 if values.ndim == 1 else values.shape[1], kind, target, **more)
        self.fill(lambda put: put(self.offset(number), values.astype(_DTYPES[kind])))
        return number

    def offset(self, accessor: int) -> int:
        """Of an accessor's first byte."""
        view: int = self.accessors[accessor]["bufferView"]
        return self.views[view]["byteOffset"]

    def write(self, stream: BinaryIO, start: int) -> None:
        """Write all, from byte `start` of a file on; what is between views is zero."""

        def put(offset: int, numbers: NDArray[Any]) -> None:
            stream.seek(start + offset)
            stream.write(np.ascontiguousarray(numbers).data)

        for fill in self._fills:
            fill(put)


def limits_of(values: NDArray[np.float32]) -> dict[str, Any]:
    """Of an accessor of positions: the least and the largest of its numbers."""
    return {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}


def write_glb(path: Path, content: Mapping[str, Any], buffer: GlbBuffer) -> None:
    """Write a file, whole or not at all.

    Parameters
    ----------
    content
        Of the JSON, less what the buffer knows.

    Raises
    ------
    InputError
        It is too large for a .glb, or cannot be written.
    """
    n_bytes = -(-buffer.n_bytes // ALIGNMENT) * ALIGNMENT
    parts: dict[str, Any] = dict(content)
    if n_bytes:
        parts |= {"buffers": [{"byteLength": n_bytes}], "bufferViews": buffer.views}
    if buffer.accessors:
        parts["accessors"] = buffer.accessors
    text = json.dumps(parts, separators=(",", ":"), allow_nan=False).encode()
    # Numbers begin at a multiple of 8 bytes of the file, too.
    text += b" " * (-(len(text) + HEADER_BYTES) % ALIGNMENT)
    total = HEADER_BYTES + len(text) + n_bytes if n_bytes else HEADER_BYTES - 8 + len(text)
    if total > LARGEST_BYTES:
        raise InputError(
            say(
                "would have {:.1f} GB, and a .glb has less than 4.3; choose a lower degree of harmonics, fewer "
                "facades, or 3D Tiles, which are many files",
                total / 1000000000.0,
                place=path,
            )
        )
    with whole_file(path) as temporary, temporary.open("wb") as stream:
        stream.truncate(total)
        stream.write(struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON") + text)
        if n_bytes:
            stream.write(struct.pack("<I4s", n_bytes, b"BIN\0"))
            buffer.write(stream, HEADER_BYTES + len(text))


# Panels as a table of properties in glTF and 3D Tiles (EXT_structural_metadata; 3D Metadata Specification 1.1).
#
# A row is a panel, a column what is known of all: GlobalId, name, facade, sizes, and attributes that the caller
# gives.
# Columns and their types follow from all panels of a scene, so that the files of a tileset have the same.

Value = str | float | int | None
Attributes = Mapping[str, Mapping[str, Value]]
"""Of objects, by their GlobalId and the attribute's name; None, or an empty text, where it is not known."""

NO_ATTRIBUTES: Attributes = {}

Kind = Literal["STRING", "FLOAT64", "INT32", "INT64"]

CLASS = "panel"

NO_NUMBER = -1e300
"""Of a column of numbers, where a panel has none; NaN is not allowed there."""

NO_TEXT = "no data"
"""Likewise of texts: an empty one would do, but a column of nothing has no place in a buffer."""

_TABLE_DTYPES: dict[Kind, str] = {"FLOAT64": "<f8", "INT32": "<i4", "INT64": "<i8"}
_WHOLE: tuple[Kind, ...] = ("INT32", "INT64")


@dataclass(frozen=True, slots=True)
class Column:
    """Of the table.

    Parameters
    ----------
    key
        ASCII letters, digits and underscores, not a digit first.
    name
        For people.
    no_data
        What stands where a panel has no value; None where all have.
    semantic
        Of the specification: `ID` or `NAME`.
    """

    key: str
    name: str
    kind: Kind
    no_data: Value = None
    semantic: str | None = None

    @property
    def description(self) -> dict[str, Any]:
        """As a schema has it."""
        found: dict[str, Any] = {"name": self.name}
        found |= {"type": "STRING"} if self.kind == "STRING" else {"type": "SCALAR", "componentType": self.kind}
        if self.no_data is None:
            found["required"] = True
        else:
            found["noData"] = self.no_data
        if self.semantic is not None:
            found["semantic"] = self.semantic
        return found


@dataclass(frozen=True, slots=True, eq=False)
class PanelTable:
    """Panels of a scene.

    Parameters
    ----------
    rows
        By GlobalId, a value for each column.
    """

    columns: tuple[Column, ...]
    rows: Mapping[str, tuple[Value, ...]]

    @property
    def schema(self) -> dict[str, Any]:
        """Its classes, as EXT_structural_metadata and tilesets have them."""
        properties = {column.key: column.description for column in self.columns}
        return {"id": "reflight", "classes": {CLASS: {"name": "Glass panel", "properties": properties}}}

    def put(self, elements: Sequence[GsElement], name: str, buffer: GlbBuffer) -> dict[str, Any]:
        """Put the rows of elements, one at least, into a buffer; returns the property table."""
        rows = [self.rows[element.global_id] for element in elements]
        properties = {}
        for number, column in enumerate(self.columns):
            cells = [row[number] for row in rows]
            # Also columns of which no panel has a value here: some readers miss columns that a table leaves out.
            known = [column.no_data if cell is None else cell for cell in cells]
            properties[column.key] = _put(known, column.kind, buffer)
        return {"name": name, "class": CLASS, "count": len(rows), "properties": properties}


def panel_table(scene: GsScene, attributes: Attributes, path: Path) -> PanelTable:
    """The table of all panels of a scene.

    Parameters
    ----------
    path
        Of the file it is for, for messages.

    Raises
    ------
    InputError
        A number is not finite, or two panels have the same GlobalId.
    """
    found = list(scene.elements)
    elements = [element for _, element in found]
    sizes = [panel_sizes_m(element) for element in elements]
    known: list[tuple[str, str, str | None, list[Value]]] = [
        ("global_id", "IFC GlobalId", "ID", [element.global_id for element in elements]),
        ("name", "Name", "NAME", [element.name for element in elements]),
        ("facade", "Facade", None, [component.name for component, _ in found]),
        ("panel", "Number in the model", None, [element.panel for element in elements]),
        ("area_m2", "Area, m2", None, [area for _, _, area in sizes]),
        ("width_m", "Width, m", None, [width for width, _, _ in sizes]),
        ("height_m", "Height, m", None, [height for _, height, _ in sizes]),
    ]
    of_panels = [attributes.get(element.global_id, {}) for element in elements]
    for name in sorted({name for values in of_panels for name in values}):
        known.append((identifier(name), name, None, [values.get(name) for values in of_panels]))
    keys = one_after_the_other(key for key, *_ in known)
    columns, cells = [], []
    for key, (_, name, semantic, values) in zip(keys, known, strict=True):
        column, column_cells = _column(key, name, semantic, values, path)
        if column is not None:
            columns.append(column)
            cells.append(column_cells)
    rows = {element.global_id: tuple(row) for element, row in zip(elements, zip(*cells, strict=True), strict=True)}
    if len(rows) != len(elements):
        raise InputError(say("several panels have the same GlobalId; organise the model again", place=path))
    return PanelTable(tuple(columns), rows)


def panel_sizes_m(element: GsElement) -> tuple[float, float, float]:
    """Width (mean of c0 c1 and c3 c2), height (of c0 c3 and c1 c2) and area, m2."""
    corners = np.asarray(element.corners_enu_m, np.float64)
    bottom, right, top, left = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).tolist()
    return 0.5 * (bottom + top), 0.5 * (right + left), float(np.linalg.norm(area_vector(corners)))


def area_vector(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outward normal of a panel, as long as its area, shape (3,)."""
    return 0.5 * np.cross(corners[2] - corners[0], corners[3] - corners[1])


def attributes_of(global_id: str, attributes: Attributes, path: Path) -> dict[str, Value]:
    """Those of one object that are known, by name."""
    values = attributes.get(global_id, {})
    found = {plain(name): _checked(values[name], name, path) for name in sorted(values)}
    return {name: value for name, value in found.items() if value is not None}


def identifier(text: str) -> str:
    """A text as the name of something in a schema: ASCII letters, digits and underscores, no digit first."""
    found = re.sub(r"[^A-Za-z0-9_]+", "_", text).strip("_")
    return f"_{found}" if not found or found[0].isdigit() else found


def one_after_the_other(names: Iterable[str]) -> tuple[str, ...]:
    """Different names: one that was there before gets a number."""
    taken: dict[str, int] = {}
    found = []
    for name in names:
        candidate = name
        while candidate in taken:
            taken[name] += 1
            candidate = f"{name}_{taken[name]}"
        taken[candidate] = 1
        found.append(candidate)
    return tuple(found)


def plain(text: str) -> str:
    """Text that is Unicode: what stands for half a character is replaced."""
    return text.encode("utf-8", "replace").decode()


def _checked(value: Value, name: str, path: Path) -> Value:
    if isinstance(value, float) and not math.isfinite(value):
        raise InputError(say("attribute '{}': expected finite numbers, got {}", name[:80], value, place=path))
    # An empty text is none.
    return (plain(value) or None) if isinstance(value, str) else value


def _column(
    key: str, name: str, semantic: str | None, values: Sequence[Value], path: Path
) -> tuple[Column | None, list[Value]]:
    """A column and its cells; no column where no panel has a value."""
    cells = [_checked(value, name, path) for value in values]
    present = [cell for cell in cells if cell is not None]
    if not present:
        return None, []
    kind = _kind(present, len(present) == len(cells))
    if kind == "STRING":
        cells = [None if cell is None else str(cell) for cell in cells]
    elif kind == "FLOAT64":
        cells = [None if cell is None else float(cell) for cell in cells]
    no_data = None if len(present) == len(cells) else _no_data(kind, cells)
    return Column(key, plain(name), kind, no_data, semantic), cells


def _kind(present: Sequence[str | float | int], is_full: bool) -> Kind:
    """The narrowest type that holds all values, and something for none where some panel has none."""
    numbers = [value for value in present if not isinstance(value, str)]
    if len(numbers) < len(present):
        return "STRING"
    if all(isinstance(value, int) for value in numbers):
        for kind in _WHOLE:
            limits = np.iinfo(_TABLE_DTYPES[kind])
            if int(limits.min) + (not is_full) <= min(numbers) and max(numbers) <= int(limits.max):
                return kind
        return "STRING"
    # Whole numbers beside others keep all their digits, or are texts.
    return "FLOAT64" if all(abs(value) < -NO_NUMBER and float(value) == value for value in numbers) else "STRING"


def _no_data(kind: Kind, cells: Sequence[Value]) -> Value:
    if kind == "FLOAT64":
        return NO_NUMBER
    if kind != "STRING":
        return int(np.iinfo(_TABLE_DTYPES[kind]).min)
    taken, text, number = set(cells), NO_TEXT, 1
    while text in taken:
        text, number = f"{NO_TEXT} {number}", number + 1
    return text


def _put(cells: Sequence[Value], kind: Kind, buffer: GlbBuffer) -> dict[str, Any]:
    """Values of a column, into the buffer."""
    if kind != "STRING":
        return {"values": buffer.add(np.array(cells, _TABLE_DTYPES[kind]).tobytes())}
    texts = [str(cell).encode() for cell in cells]
    offsets = np.cumsum([0, *map(len, texts)])
    values, starts = buffer.add(b"".join(texts)), buffer.add(offsets.astype("<u4").tobytes())
    return {"values": values, "stringOffsets": starts, "stringOffsetType": "UINT32"}


# Gaussians and panels as meshes of glTF: KHR_gaussian_splatting, and quads that a viewer can pick.
#
# Gaussians may be compressed (KHR_gaussian_splatting_compression_spz_2, a draft): then their numbers come from an SPZ
# file within the file, in the axes of the mesh, as CesiumJS reads them. Such primitives say neither kernel nor colour
# space and have diffuse colours and opacities as COLOR_0: programs tell the draft's two ways by that.
#
# Viewers that do not know Gaussians draw their means as points in their diffuse colour. No viewer tells which
# Gaussian
# was clicked on, so each facade has a mesh of its panels: invisible, and hit by picking as any mesh is. Both say by
# `_FEATURE_ID_0` (EXT_mesh_features) which row of the table of properties they belong to.

SPLATTING, FEATURES = "KHR_gaussian_splatting", "EXT_mesh_features"

SPZ = "KHR_gaussian_splatting_compression_spz_2"
"""After version 2 of Niantic's library, whose files say that they are of version 3."""

KERNEL = {
    "kernel": "ellipse",
    "colorSpace": "srgb_rec709_display",
    "projection": "perspective",
    "sortingMethod": "cameraDistance",
}

FEATURE_ID = "_FEATURE_ID_0"

LABEL = "panel"

POINTS, TRIANGLES = 0, 4

MEAN_HARMONIC = 0.28209479177387814
"""Harmonic of degree 0: 1 / (2 sqrt(pi))."""

N_OF_DEGREE = {0: 1, 1: 4, 2: 9, 3: 16}


def put_gaussians(
    component: GsComponent, degree: int | None, row: int, buffer: GlbBuffer, monitor: Monitor
) -> dict[str, Any]:
    """Put a component's Gaussians, one at least, into a buffer; returns their mesh.

    Parameters
    ----------
    degree
        Of the harmonics, 0 to 3; None for points alone.
    row
        Of the component's first panel in the table of properties.
    """
    n = len(component.gaussians)
    attributes = {"POSITION": buffer.accessor(n, 3, FLOAT, **limits_of(component.gaussians.values["means"]))}
    attributes["COLOR_0"] = buffer.accessor(n, 4, UINT16, normalized=True)
    extensions: dict[str, Any] = {}
    if degree is not None:
        for name, width in (("ROTATION", 4), ("SCALE", 3), ("OPACITY", 1), *((name, 3) for name in _harmonics(degree))):
            attributes[f"{SPLATTING}:{name}"] = buffer.accessor(n, width, FLOAT)
        extensions[SPLATTING] = KERNEL
    if component.elements:
        attributes[FEATURE_ID] = buffer.accessor(n, 1, FLOAT)
        extensions[FEATURES] = _features(sum(element.n_gaussians > 0 for element in component.elements))

    def fill(put: Put) -> None:
        for start, block in ellipsoid_blocks(component):
            monitor.report(say("writing Gaussians"), start, n)
            columns = _columns(block, degree or 0)
            if component.elements:
                columns[FEATURE_ID] = (row + element_numbers(component, start, start + len(block))).astype("<f4")
            for name, number in attributes.items():
                put(buffer.offset(number) + start * columns[name][0].nbytes, columns[name])

    buffer.fill(fill)
    return {"name": f"{component.name}: Gaussians", "primitives": [_primitive(POINTS, attributes, extensions)]}


def put_compressed(component: GsComponent, content: bytes, n: int, degree: int, buffer: GlbBuffer) -> dict[str, Any]:
    """Put the SPZ file of a component's Gaussians into a buffer; returns their mesh.

    Parameters
    ----------
    n, degree
        Gaussians in the file, and of the harmonics, 0 to 3.
    """
    view = buffer.add(content)
    attributes = {"POSITION": buffer.unfilled(n, 3, FLOAT, **limits_of(component.gaussians.values["means"]))}
    attributes["COLOR_0"] = buffer.unfilled(n, 4, UINT8, normalized=True)
    for name, width in (("ROTATION", 4), ("SCALE", 3), *((name, 3) for name in _harmonics(degree)[1:])):
        attributes[f"{SPLATTING}:{name}"] = buffer.unfilled(n, width, FLOAT)
    extensions = {SPLATTING: {"extensions": {SPZ: {"bufferView": view}}}}
    return {"name": f"{component.name}: Gaussians", "primitives": [_primitive(POINTS, attributes, extensions)]}


def put_panels(component: GsComponent, origin_enu_m: Vec3, row: int, buffer: GlbBuffer) -> dict[str, Any]:
    """Put the quads of a component's panels, one at least, into a buffer; returns their mesh, of material 0.

    Parameters
    ----------
    row
        Of the component's first panel in the table of properties.
    """
    corners = np.array([element.corners_enu_m for element in component.elements], np.float64)
    n = len(corners)
    places = (corners - np.array(origin_enu_m)).reshape(-1, 3).astype(np.float32)
    normals = np.array([_normal(each) for each in corners])
    # glTF has no whole numbers of 32 bits in vertices: float32 is exact for 16 million panels.
    ids = np.repeat(row + np.arange(n), 4)
    corner = 4 * np.arange(n)[:, None] + np.array([0, 1, 2, 0, 2, 3])
    attributes = {
        "POSITION": buffer.table(places, FLOAT, **limits_of(places)),
        "NORMAL": buffer.table(np.repeat(normals, 4, axis=0), FLOAT),
        FEATURE_ID: buffer.table(ids, FLOAT),
    }
    primitive = _primitive(TRIANGLES, attributes, {FEATURES: _features(n)})
    indices = buffer.table(corner.ravel(), UINT32, INDICES)
    return {
        "name": say("panels", place=component.name),
        "primitives": [{**primitive, "indices": indices, "material": 0}],
    }


def panel_material(alpha: float) -> dict[str, Any]:
    """Of the quads: white, drawn as it is, seen from both sides."""
    return {
        "name": "panels",
        "pbrMetallicRoughness": {"baseColorFactor": [1.0, 1.0, 1.0, alpha], "metallicFactor": 0.0},
        "alphaMode": "BLEND",
        "doubleSided": True,
        "extensions": {"KHR_materials_unlit": {}},
    }


def _harmonics(degree: int) -> list[str]:
    return [f"SH_DEGREE_{of}_COEF_{order}" for of in range(degree + 1) for order in range(2 * of + 1)]


def _primitive(mode: int, attributes: dict[str, int], extensions: dict[str, Any]) -> dict[str, Any]:
    return {"mode": mode, "attributes": attributes, "extensions": extensions}


def _features(n: int) -> dict[str, Any]:
    return {"featureIds": [{"featureCount": n, "attribute": 0, "label": LABEL, "propertyTable": 0}]}


def _normal(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit, outwards; up where the panel has no area."""
    vector = area_vector(corners)
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0.0 else np.array([0.0, 0.0, 1.0])


def _columns(block: Ellipsoids, degree: int) -> dict[str, NDArray[Any]]:
    """Of Gaussians, by the attribute's name, as the file has them."""
    diffuse = np.clip(0.5 + MEAN_HARMONIC * block.sh[:, 0], 0.0, 1.0)
    colours = np.column_stack([light_of(diffuse), block.opacities])
    found = {
        "POSITION": block.means_m,
        "COLOR_0": np.rint(colours * 65535.0).astype("<u2"),
        f"{SPLATTING}:ROTATION": block.quats[:, [1, 2, 3, 0]],
        f"{SPLATTING}:SCALE": block.scales_m,
        f"{SPLATTING}:OPACITY": block.opacities,
    }
    for number, name in enumerate(_harmonics(degree)):
        found[f"{SPLATTING}:{name}"] = block.sh[:, number]
    return {name: values if name == "COLOR_0" else values.astype("<f4", copy=False) for name, values in found.items()}
