"""Which parts of an IFC model are glass to be photographed, and where their panes lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.site_import.window_faces import MIN_GLASS_SHARE, Pane, covered_area, facing_axis, pane_of

Array = NDArray[np.float64]

MIN_TRANSPARENCY = 0.05

MAX_NESTING = 10
"""Parts of parts are followed so far: a file may go in circles."""

GLASS_WORDS = re.compile(
    r"gla[sz]|verre|vitr|vidri|cristal|acrist|vetr[oai]|szyb|szk[lł]|sklo|üveg|lasi\b|стекл|玻璃|ガラス|유리",
    re.IGNORECASE,
)
"""Glass in names of plates and materials, in the languages BIM programs speak."""

NOT_GLASS_WORDS = re.compile(r"wool|fib(er|re)|faser|wolle|laine|lana|opaque|opak|spandrel|brüstung", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """Triangles of one element, metres, in model coordinates.

    Parameters
    ----------
    guid, kind
        GlobalId and class (IfcWindow).
    triangles
        Shape (t, 3, 3).
    transparency
        Of the surface style of each triangle, shape (t,); NaN where it has none.
    """

    guid: str
    kind: str
    triangles: Array
    transparency: Array

    @property
    def glass(self) -> Array:
        """Triangles that one can see through."""
        return np.asarray(self.triangles[self.transparency >= MIN_TRANSPARENCY])


def glass_names(element: Any) -> bool | None:
    """What the names of an element, its type and its materials say: glass, not glass, or nothing."""
    from ifcopenshell.util.element import get_materials, get_type

    kind = get_type(element)
    names = [element.Name, element.ObjectType, getattr(kind, "Name", None)]
    names += [getattr(material, "Name", None) for material in get_materials(element)]
    text = " ".join(str(name) for name in names if name)
    if NOT_GLASS_WORDS.search(text):
        return False
    return True if GLASS_WORDS.search(text) else None


def window_pane(shape: Shape, axes: Array) -> Pane:
    """Pane of a window: its transparent faces where they fill it, else its whole body.

    Parameters
    ----------
    axes
        Of the window's own placement, rows of shape (3, 3); a body without glass is thinnest along one of them.
    """
    glass = shape.glass
    if len(glass):
        axis = facing_axis(glass)
        if covered_area(glass, axis) >= MIN_GLASS_SHARE * covered_area(shape.triangles, axis):
            return pane_of(glass, axis)
    points = shape.triangles.reshape(-1, 3)
    return pane_of(shape.triangles, axes[int(np.argmin(np.ptp(points @ axes.T, axis=0)))])


def plate_pane(shape: Shape) -> Pane:
    """Pane of a plate."""
    return pane_of(shape.triangles, facing_axis(shape.triangles))


def joined(guid: str, parts: list[Shape]) -> Shape:
    """A window made of parts, as one shape."""
    return Shape(
        guid,
        "IfcWindow",
        np.concatenate([part.triangles for part in parts]),
        np.concatenate([part.transparency for part in parts]),
    )


def glazed_plates(plates: dict[str, Any], shapes: dict[str, Shape]) -> list[str]:
    """GlobalIds of the plates that are glass.

    A plate of a curtain wall is glass unless the file says otherwise: by its names, or by an opaque surface where other
    plates of the walls are recognised as glass. A plate elsewhere (steelwork, cladding) must be recognised as glass.
    """
    known = {guid: _is_glass(element, shapes[guid]) for guid, element in plates.items()}
    in_wall = {guid for guid, element in plates.items() if is_in_curtain_wall(element)}
    tells_glass_apart = any(known[guid] for guid in in_wall)
    glazed = []
    for guid in plates:
        is_opaque = np.isfinite(shapes[guid].transparency).all()
        if known[guid] or (known[guid] is None and guid in in_wall and not (tells_glass_apart and is_opaque)):
            glazed.append(guid)
    return glazed


def _is_glass(element: Any, shape: Shape) -> bool | None:
    """Whether a plate is glass by its surface or its names; None where neither tells."""
    if 2 * len(shape.glass) >= len(shape.triangles):
        return True
    return glass_names(element)


def is_in_curtain_wall(element: Any) -> bool:
    """Whether an element is a part of a curtain wall, at any depth, or a curtain wall panel by its own type."""
    if getattr(element, "PredefinedType", None) == "CURTAIN_PANEL":
        return True
    for _ in range(MAX_NESTING):
        wholes = [relation.RelatingObject for relation in element.Decomposes]
        if not wholes:
            return False
        element = wholes[0]
        if element.is_a("IfcCurtainWall"):
            return True
    return False


def skin_panes(shape: Shape) -> list[Pane]:
    """Panes of a curtain wall that is one body: one for each connected piece of its glass."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    glass = shape.glass
    _, vertex = np.unique(glass.reshape(-1, 3).round(4), axis=0, return_inverse=True)
    vertex = vertex.ravel()
    triangle = np.repeat(np.arange(len(glass)), 3)
    n = len(glass) + int(vertex.max()) + 1
    graph = coo_array((np.ones(len(vertex)), (triangle, len(glass) + vertex)), shape=(n, n))
    label = connected_components(graph, directed=False)[1][: len(glass)]
    pieces = [glass[label == piece] for piece in np.unique(label)]
    return [pane_of(piece, facing_axis(piece)) for piece in pieces]
