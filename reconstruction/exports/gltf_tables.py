"""Panels as a table of properties in glTF and 3D Tiles (EXT_structural_metadata; 3D Metadata Specification 1.1).

A row is a panel, a column what is known of all: GlobalId, name, facade, sizes, and attributes that the caller gives.
Columns and their types follow from all panels of a scene, so that the files of a tileset have the same.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.exports.glb import GlbBuffer
from reconstruction.objects.gs_scene import GsElement, GsScene

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

_DTYPES: dict[Kind, str] = {"FLOAT64": "<f8", "INT32": "<i4", "INT64": "<i8"}
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
        column, made = _column(key, name, semantic, values, path)
        if column is not None:
            columns.append(column)
            cells.append(made)
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
            limits = np.iinfo(_DTYPES[kind])
            if int(limits.min) + (not is_full) <= min(numbers) and max(numbers) <= int(limits.max):
                return kind
        return "STRING"
    # Whole numbers beside others keep all their digits, or are texts.
    return "FLOAT64" if all(abs(value) < -NO_NUMBER and float(value) == value for value in numbers) else "STRING"


def _no_data(kind: Kind, cells: Sequence[Value]) -> Value:
    if kind == "FLOAT64":
        return NO_NUMBER
    if kind != "STRING":
        return int(np.iinfo(_DTYPES[kind]).min)
    taken, text, number = set(cells), NO_TEXT, 1
    while text in taken:
        text, number = f"{NO_TEXT} {number}", number + 1
    return text


def _put(cells: Sequence[Value], kind: Kind, buffer: GlbBuffer) -> dict[str, Any]:
    """Values of a column, into the buffer."""
    if kind != "STRING":
        return {"values": buffer.add(np.array(cells, _DTYPES[kind]).tobytes())}
    texts = [str(cell).encode() for cell in cells]
    offsets = np.cumsum([0, *map(len, texts)])
    values, starts = buffer.add(b"".join(texts)), buffer.add(offsets.astype("<u4").tobytes())
    return {"values": values, "stringOffsets": starts, "stringOffsetType": "UINT32"}
