"""A scene as binary glTF 2.0 (.glb): Gaussians by facade, and its panels as quads to pick, with what is known of them.

glTF is right-handed with y up. The root node turns east, north, up into that, and moves the model to its place in the
site's frame, so that the numbers of vertices stay small: float32 is then exact to less than 0.1 mm within 1 km.
Extensions: KHR_gaussian_splatting, EXT_mesh_features, EXT_structural_metadata, KHR_materials_unlit. No viewer needs to
know any of them to open the file, unless Gaussians are compressed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import Any, Literal

from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from reconstruction.exports.component_parts import check_scene
from reconstruction.exports.compression import PRESETS, Compression
from reconstruction.exports.glb import (
    FEATURES,
    N_OF_DEGREE,
    NO_ATTRIBUTES,
    SPLATTING,
    SPZ,
    Attributes,
    GlbBuffer,
    PanelTable,
    attributes_of,
    panel_material,
    panel_table,
    plain,
    put_compressed,
    put_gaussians,
    put_panels,
    write_glb,
)
from reconstruction.exports.spz import spz_of
from reconstruction.objects.gs_scene import GsComponent, GsScene

FORMAT = "reflight-gltf/1"

METADATA, UNLIT = "EXT_structural_metadata", "KHR_materials_unlit"

Gaussians = Literal["numbers", "spz", "points"]
"""How they are in a file: as numbers, compressed (as CesiumJS wants them), or only as coloured points."""

INVISIBLE = 0.001
"""Opacity of quads that nobody sees: it changes 8-bit colours by a quarter of a step at most. With 0, viewers that pick
by drawing (CesiumJS) would pass through them."""


@dataclass(frozen=True, slots=True)
class GltfOptions:
    """What a file has.

    Parameters
    ----------
    sh_degree
        Of the colours' harmonics, 0 to 3: 68, 104, 164 or 248 bytes for each Gaussian on a facade.
    panel_opacity
        Of the panels' quads, over 0 to 1.
    gaussians
        As `numbers`; `spz`: a tenth of that, without the panel of each, for viewers that know the draft extension
        (CesiumJS knows no other); `points`: means and diffuse colours, 24 bytes each on a facade, for viewers that fail
        at Gaussians.
    compression
        Of `spz`, but for its degree.
    """

    sh_degree: int = 3
    panel_opacity: float = INVISIBLE
    gaussians: Gaussians = "numbers"
    compression: Compression = PRESETS["balanced"]

    def __post_init__(self) -> None:
        if self.sh_degree not in N_OF_DEGREE:
            raise ValueError(f"sh_degree: expected 0 to 3, got {self.sh_degree}")
        if not 0.0 < self.panel_opacity <= 1.0:
            raise ValueError(f"panel_opacity: expected more than 0, and 1 at most, got {self.panel_opacity}")


DEFAULT = GltfOptions()


def write_gltf(
    scene: GsScene,
    path: Path,
    options: GltfOptions = DEFAULT,
    attributes: Attributes = NO_ATTRIBUTES,
    monitor: Monitor = QUIET,
) -> None:
    """Write a scene, or what of it is here, whole or not at all.

    Parameters
    ----------
    attributes
        Of panels, which become columns of the property table, and of facades, which go into the `extras` of nodes.

    Raises
    ------
    InputError
        Numbers are not finite, it is too large for one file, or it cannot be written.
    """
    check_scene(scene, path)
    table = panel_table(scene, attributes, path)
    document = Document(scene, scene.components, table, options, path, monitor)
    children = []
    for component in scene.components:
        parts = document.gaussian_nodes(component) + document.panel_nodes(component)
        extras = component_extras(component, attributes, path)
        children.append(document.node({"name": plain(component.name), "extras": extras}, parts))
    known = attributes_of(scene.global_id, attributes, path)
    extras = {"layer": "scene", "global_id": scene.global_id, "attributes": known}
    root = document.node({"name": plain(scene.name), **frame_of(scene.origin_enu_m), "extras": extras}, children)
    write_glb(path, document.content([root]), document.buffer)


def frame_of(origin_enu_m: Vec3) -> dict[str, Any]:
    """Of a node whose children are in the model's frame."""
    east, north, up = (float(value) for value in origin_enu_m)
    # (x, y, z) becomes (x, z, -y). As a matrix, column by column: CesiumJS passes over what nodes of Gaussians say
    # otherwise. Adding zero makes zero of minus zero.
    return {
        "matrix": [
            *(1.0, 0.0, 0.0, 0.0),
            *(0.0, 0.0, -1.0, 0.0),
            *(0.0, 1.0, 0.0, 0.0),
            *(east + 0.0, up + 0.0, 0.0 - north, 1.0),
        ]
    }


def component_extras(component: GsComponent, attributes: Attributes, path: Path) -> dict[str, Any]:
    """What a node says of a component."""
    return {
        "layer": "component",
        "kind": component.kind,
        "global_id": component.global_id,
        "attributes": attributes_of(component.global_id, attributes, path),
    }


class Document:
    """A file in the making: nodes and meshes, the table of its panels, and the buffer that their numbers go to.

    Parameters
    ----------
    components
        That the file has something of. All their panels are in one table: some readers look at one of a class only.
    path
        For messages.
    """

    def __init__(
        self,
        scene: GsScene,
        components: Sequence[GsComponent],
        table: PanelTable,
        options: GltfOptions,
        path: Path,
        monitor: Monitor,
    ) -> None:
        self.buffer = GlbBuffer()
        self._scene, self._schema, self._options, self._monitor = scene, table.schema, options, monitor
        self._path = path
        self._nodes: list[dict[str, Any]] = []
        self._meshes: list[dict[str, Any]] = []
        self._used: set[str] = set()
        elements = [element for component in components for element in component.elements]
        self._tables = [table.put(elements, "panels", self.buffer)] if elements else []
        starts = accumulate((len(component.elements) for component in components), initial=0)
        self._first_row = {id(component): row for component, row in zip(components, starts, strict=False)}

    def node(self, node: dict[str, Any], children: Sequence[int] = ()) -> int:
        """Add a node; returns its number."""
        self._nodes.append({**node, "children": list(children)} if children else node)
        return len(self._nodes) - 1

    def gaussian_nodes(self, component: GsComponent, more: dict[str, Any] | None = None) -> list[int]:
        """A node with a component's Gaussians; none where it has no Gaussians.

        Parameters
        ----------
        more
            Of the node.
        """
        if not len(component.gaussians):
            return []
        options = self._options
        if options.gaussians == "spz":
            return [self._mesh_node(self._compressed(component), more)]
        row = self._first_row[id(component)]
        degree = None if options.gaussians == "points" else options.sh_degree
        mesh = put_gaussians(component, degree, row, self.buffer, self._monitor)
        self._used |= mesh["primitives"][0]["extensions"].keys()
        return [self._mesh_node(mesh, more)]

    def _compressed(self, component: GsComponent) -> dict[str, Any]:
        """The mesh of all its Gaussians: also of those that nobody sees, so that no file is without any."""
        options = self._options
        compression = replace(options.compression, degree=options.sh_degree, least_opacity=0.0)
        alone = replace(self._scene, components=(component,))
        content, found = spz_of(alone, compression, "enu", self._path, self._monitor)
        self._used |= {SPLATTING, SPZ}
        return put_compressed(component, content, found.n_gaussians, options.sh_degree, self.buffer)

    def panel_nodes(self, component: GsComponent, more: dict[str, Any] | None = None) -> list[int]:
        """A node with a component's panels; none where it has no panels."""
        if not component.elements:
            return []
        self._used.add(UNLIT)
        row = self._first_row[id(component)]
        return [self._mesh_node(put_panels(component, self._scene.origin_enu_m, row, self.buffer), more)]

    def content(self, roots: Sequence[int]) -> dict[str, Any]:
        """The JSON, less what the buffer knows."""
        found: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "Reflight", "extras": scene_extras(self._scene)},
            "scene": 0,
            "scenes": [{"name": plain(self._scene.name), "nodes": list(roots)}],
            "nodes": self._nodes,
        }
        if self._meshes:
            found["meshes"] = self._meshes
        if UNLIT in self._used:
            found["materials"] = [panel_material(self._options.panel_opacity)]
        if self._tables:
            self._used |= {FEATURES, METADATA}
            found["extensions"] = {METADATA: {"schema": self._schema, "propertyTables": self._tables}}
        if self._used:
            found["extensionsUsed"] = sorted(self._used)
        if SPZ in self._used:
            found["extensionsRequired"] = [SPLATTING, SPZ]
        return found

    def _mesh_node(self, mesh: dict[str, Any], more: dict[str, Any] | None) -> int:
        self._meshes.append({**mesh, "name": plain(mesh["name"])})
        return self.node({"name": self._meshes[-1]["name"], "mesh": len(self._meshes) - 1, **(more or {})})


def scene_extras(scene: GsScene) -> dict[str, Any]:
    """What a file says of the scene."""
    return {
        "format": FORMAT,
        "site": plain(scene.name),
        "global_id": scene.global_id,
        "origin_wgs84": None if scene.origin is None else asdict(scene.origin),
        "origin_enu_m": [float(value) for value in scene.origin_enu_m],
        "axes": "root node: x east, y north, z up, metres, counted from origin_enu_m in the site's frame",
    }
