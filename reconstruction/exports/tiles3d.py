"""A scene as 3D Tiles 1.1: a folder with `tileset.json`, and binary glTF files of Gaussians and of panels by facade.

Two more tilesets name the same files: `gaussians.json` and `panels.json`, for viewers in which Gaussians and meshes are
layers of their own. Tiles lie in the site's east-north-up frame, which the root's transform places on Earth.

Files are named after their content and written first; `tileset.json` is replaced last, in one step. So a folder that
had tiles has whole ones at every moment.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import make_folder, sha256_of_file
from planning.base.json_file import new_file_beside, write_together
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from reconstruction.exports.component_parts import check_scene, ellipsoid_blocks, extents_m
from reconstruction.exports.compression import PRESETS, Compression
from reconstruction.exports.glb import (
    NO_ATTRIBUTES,
    SPLATTING,
    SPZ,
    Attributes,
    PanelTable,
    panel_table,
    plain,
    write_glb,
)
from reconstruction.exports.gltf import (
    INVISIBLE,
    Document,
    Gaussians,
    GltfOptions,
    component_extras,
    frame_of,
    scene_extras,
)
from reconstruction.objects.gs_scene import GsComponent, GsGaussian, GsScene
from reconstruction.splats.merged_splats import splats_of_detail
from reconstruction.splats.splats import NO_PANEL, Splats

# How a component's Gaussians are shared among tiles: halves, by space, until each has few enough.
#
# Panels stay whole. Tiles that are shared out have merged Gaussians of their own (`coarser_part`): some of a
# building's
# would look like one with holes.

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Axis-aligned, ENU metres, shapes (3,)."""

    low: Array
    high: Array

    @property
    def diagonal_m(self) -> float:
        """From corner to corner."""
        return float(np.linalg.norm(self.high - self.low))

    def with_others(self, *others: Box) -> Box:
        """The smallest box around it and others."""
        boxes = (self, *others)
        return Box(np.min([box.low for box in boxes], axis=0), np.max([box.high for box in boxes], axis=0))


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """Gaussians that lie together: those of `part`, or those of two branches.

    Parameters
    ----------
    items
        Numbers of elements of a facade, or rows of the background, ascending.
    """

    items: NDArray[np.int64]
    halves: tuple[Branch, ...]


def branches_of(component: GsComponent, at_most: int) -> Branch:
    """A tree whose leaves have `at_most` Gaussians, or a single panel."""
    if component.kind == "facade":
        places = np.array([np.mean(element.corners_enu_m, axis=0) for element in component.elements]).reshape(-1, 3)
        weights = np.array([element.n_gaussians for element in component.elements], np.int64)
        items = np.flatnonzero(weights)
    else:
        places = component.gaussians.values["means"]
        weights = np.ones(len(places), np.int64)
        items = np.arange(len(places))
    return _branch(items, places, weights, at_most)


def _branch(items: NDArray[np.int64], places: NDArray[np.floating], weights: NDArray[np.int64], at_most: int) -> Branch:
    if len(items) < 2 or weights[items].sum() <= at_most:
        return Branch(items, ())
    within = places[items]
    axis = int(np.argmax(np.ptp(within, axis=0)))
    order = items[np.argsort(within[:, axis], kind="stable")]
    so_far = np.cumsum(weights[order])
    cut = int(np.clip(np.searchsorted(so_far, so_far[-1] / 2) + 1, 1, len(order) - 1))
    halves = (np.sort(order[:cut]), np.sort(order[cut:]))
    return Branch(items, tuple(_branch(half, places, weights, at_most) for half in halves))


def part_of_branch(component: GsComponent, branch: Branch) -> GsComponent:
    """A component of a branch's Gaussians alone: a copy."""
    if component.kind == "background":
        elements, rows = (), branch.items
    else:
        chosen = [component.elements[number] for number in branch.items]
        stops = np.cumsum([element.n_gaussians for element in chosen]).tolist()
        elements = tuple(
            replace(element, start=stop - element.n_gaussians, stop=stop)
            for element, stop in zip(chosen, stops, strict=True)
        )
        rows = np.concatenate([branch.items[:0], *(np.arange(element.start, element.stop) for element in chosen)])
    table = component.gaussians
    values = {name: value[rows] for name, value in table.values.items()}
    gaussians = GsGaussian(values, table.places[rows])
    return GsComponent(component.global_id, component.name, component.kind, elements, gaussians)


def box_of_gaussians(component: GsComponent, scene: GsScene) -> Box:
    """Around all that is drawn of a component's Gaussians, one at least."""
    origin = np.array(scene.origin_enu_m)
    boxes = list(_boxes(component))
    around = boxes[0].with_others(*boxes[1:])
    return Box(around.low + origin, around.high + origin)


def box_of_panels(component: GsComponent) -> Box:
    """Around the panels of a component, one at least."""
    corners = np.array([element.corners_enu_m for element in component.elements], np.float64).reshape(-1, 3)
    return Box(corners.min(axis=0), corners.max(axis=0))


def _boxes(component: GsComponent) -> Iterator[Box]:
    for _, block in ellipsoid_blocks(component):
        means, extents = block.means_m.astype(np.float64), extents_m(block)
        yield Box((means - extents).min(axis=0), (means + extents).max(axis=0))


# Parts of a component with fewer Gaussians, each in the place of some that lie together: for pictures from afar.

NO_PLACE = -1
"""Of merged Gaussians, which are not in the model."""


@dataclass(frozen=True, slots=True, eq=False)
class CoarserPart:
    """Of a component.

    Parameters
    ----------
    side_m
        Of the cubes in which Gaussians were merged: what is finer is lost.
    """

    component: GsComponent
    side_m: float


def coarser_part(parts: Sequence[GsComponent], at_most: int) -> CoarserPart | None:
    """Parts of one component in one, with its Gaussians merged until `at_most` are left; panels stay apart.

    None where so few would not do: panels that are too many, or too few Gaussians to begin with.

    Parameters
    ----------
    parts
        One at least; none has an element of another.
    """
    elements = [element for part in parts for element in part.elements]
    tables = [part.gaussians.values for part in parts]
    values = {name: torch.from_numpy(np.concatenate([table[name] for table in tables])) for name in tables[0]}
    owners = np.full(sum(len(part.gaussians) for part in parts), NO_PANEL, np.int64)
    stops = np.cumsum([element.n_gaussians for element in elements], dtype=np.int64)
    if elements:
        # Facades have no Gaussians but those of elements.
        owners[:] = np.repeat(np.arange(len(elements)), np.diff(stops, prepend=0))
    detail = splats_of_detail(Splats(values, torch.from_numpy(owners)))
    found = detail.tree.finest_cut(at_most)
    if found is None:
        return None
    rows, side_m = found
    owners = detail.all.panels.numpy()[rows]
    order = np.argsort(owners, kind="stable")
    merged = detail.all.some(torch.from_numpy(rows[order]))
    stops = np.searchsorted(owners[order], np.arange(len(elements)), side="right").tolist()
    starts = [0, *stops[:-1]] if stops else []
    table = {name: merged.get_parameter(name).detach().numpy() for name in values}
    component = GsComponent(
        parts[0].global_id,
        parts[0].name,
        parts[0].kind,
        tuple(
            replace(element, start=start, stop=stop)
            for element, start, stop in zip(elements, starts, stops, strict=True)
        ),
        GsGaussian(table, np.full(len(merged), NO_PLACE, np.int32)),
    )
    return CoarserPart(component, side_m)


EXTRAS = {"format": "reflight-3dtiles/1", "axes": "tiles: x east, y north, z up, metres, in the site's frame"}

TILESET = "tileset.json"

CONTENT = "3DTILES_content_gltf"
"""What tilesets tell by it of their files, CesiumJS has to know before it reads the first."""

Layer = Literal["gaussians", "panels"]

_OURS = re.compile(r"[A-Za-z0-9-]+-(?:gaussians|panels)-[0-9a-f]{12}\.glb")
"""Names of the files of tiles."""

TILESETS: dict[str, tuple[Layer, ...]] = {
    "gaussians.json": ("gaussians",),
    "panels.json": ("panels",),
    TILESET: ("gaussians", "panels"),
}
"""What they show; in the order in which they are written."""

SHARPER = 8.0
"""Geometric error of a tile, in sides of the cubes in which its Gaussians are merged. Viewers go on to finer ones where
the error is more than some pixels, 16 in CesiumJS unless it is told otherwise: cubes are of 2 pixels then."""

THINNEST_M = 0.001
"""Half a box: readers take none for no box at all."""


@dataclass(frozen=True, slots=True)
class TilesOptions:
    """What a tileset has.

    Parameters
    ----------
    sh_degree, panel_opacity, gaussians, compression
        As `GltfOptions` has them; CesiumJS shows Gaussians as `spz` only, and only those of `gaussians.json`.
    gaussians_per_tile
        At most, but for single panels that have more: 24 MB with harmonics of degree 3, a tenth of that as `spz`.
    has_coarser
        Whether tiles that are shared out among others have merged Gaussians of their own, for views from afar.
    place
        `earth`: where the site is; `local`: tiles stay in the site's frame, for viewers without a globe.
    """

    sh_degree: int = 3
    panel_opacity: float = INVISIBLE
    gaussians_per_tile: int = 100_000
    has_coarser: bool = True
    place: Literal["earth", "local"] = "earth"
    gaussians: Gaussians = "spz"
    compression: Compression = PRESETS["balanced"]

    def __post_init__(self) -> None:
        self.of_files  # noqa: B018  (it checks them)
        if self.gaussians_per_tile < 1:
            raise ValueError(f"gaussians_per_tile: expected 1 or more, got {self.gaussians_per_tile}")

    @property
    def of_files(self) -> GltfOptions:
        """Those of each file."""
        return GltfOptions(self.sh_degree, self.panel_opacity, self.gaussians, self.compression)


DEFAULT = TilesOptions()


@dataclass(frozen=True, slots=True, eq=False)
class _Tile:
    """With a file, or with children, or with a file that shows what those of its children show more finely.

    Parameters
    ----------
    error_m
        Of its file against the finest.
    more
        Of the tile's JSON.
    """

    box: Box
    layer: Layer | None = None
    file: str | None = None
    error_m: float = 0.0
    children: tuple[_Tile, ...] = ()
    more: dict[str, Any] | None = None

    def json(self, layers: Sequence[Layer]) -> dict[str, Any]:
        """As the specification has it."""
        found: dict[str, Any] = {"boundingVolume": {"box": _box(self.around(layers))}}
        found["geometricError"] = self.error_without_children_m(layers)
        found |= self.more or {}
        if self.file is not None:
            found["content"] = {"uri": self.file}
        children = [child.json(layers) for child in self.children if child.has(layers)]
        return found | ({"children": children} if children else {})

    def around(self, layers: Sequence[Layer]) -> Box:
        """The box around its files of some layers; its own where it has none of them."""
        boxes = [child.around(layers) for child in self.children if child.has(layers)]
        return self.box if self.file is not None or not boxes else boxes[0].with_others(*boxes[1:])

    def error_without_children_m(self, layers: Sequence[Layer]) -> float:
        """All of it, where it has no file; never less than those of its children."""
        own = self.around(layers).diagonal_m if self.file is None else self.error_m
        return max(own, *(child.error_without_children_m(layers) for child in self.children if child.has(layers)), 0.0)

    def has(self, layers: Sequence[Layer]) -> bool:
        """Whether it has files of some layers."""
        return self.layer in layers if self.file is not None else any(child.has(layers) for child in self.children)


def write_tiles(
    scene: GsScene,
    folder: Path,
    options: TilesOptions = DEFAULT,
    attributes: Attributes = NO_ATTRIBUTES,
    monitor: Monitor = QUIET,
) -> None:
    """Write a scene, or what of it is here; tiles that were in the folder stay whole until these are.

    Raises
    ------
    InputError
        The site's place on Earth is not known, numbers are not finite, there is nothing to write, or it cannot be
        written.
    """
    if options.place == "earth" and scene.origin is None:
        raise InputError(
            say(
                "3D Tiles lie on Earth, and the site's place is not known; set the site's origin, or ask for "
                "tiles in its local frame",
                place=folder,
            )
        )
    check_scene(scene, folder)
    table = panel_table(scene, attributes, folder)
    make_folder(folder)
    old = {path.name for path in folder.glob("*.glb") if _OURS.fullmatch(path.name)}
    tiles_folder = _Folder(folder, scene, table, options, monitor)
    try:
        tiles = tuple(tiles_folder.component(component, attributes) for component in scene.components)
        tiles = tuple(tile for tile in tiles if tile.children)
        if not tiles:
            raise InputError(say("nothing to write: the scene has neither Gaussians nor panels", place=folder))
        around = tiles[0].box.with_others(*(tile.box for tile in tiles[1:]))
        transform = {} if options.place == "local" else {"transform": _earth_from_enu(scene.origin)}
        root = _Tile(around, children=tiles, more={"refine": "ADD"} | transform)
        tilesets = {}
        for name, layers in TILESETS.items():
            # CesiumJS takes all content of a tileset for Gaussians where such are compressed.
            is_compressed = options.gaussians == "spz" and layers == ("gaussians",)
            needed = (SPLATTING, SPZ) if is_compressed else ()
            tilesets[folder / name] = _tileset(scene, table, root, layers, needed)
        write_together(tilesets)
    except BaseException:
        _remove(folder, tiles_folder.files - old)
        raise
    _remove(folder, old - tiles_folder.files)


class _Folder:
    """Files in the making."""

    def __init__(
        self, folder: Path, scene: GsScene, table: PanelTable, options: TilesOptions, monitor: Monitor
    ) -> None:
        self.files: set[str] = set()
        self._folder, self._scene, self._table, self._monitor = folder, scene, table, monitor
        self._options, self._at_most = options.of_files, options.gaussians_per_tile
        self._has_coarser = options.has_coarser

    def component(self, component: GsComponent, attributes: Attributes) -> _Tile:
        """A tile with those of its Gaussians and panels; without children where it has neither."""
        children = []
        if component.elements:
            children.append(_Tile(box_of_panels(component), "panels", self._file(component, "panels")))
        if len(component.gaussians):
            children.append(self._gaussians(component, branches_of(component, self._at_most))[0])
        if not children:
            return _Tile(Box(np.zeros(3), np.zeros(3)))
        around = children[0].box.with_others(*(child.box for child in children[1:]))
        known = {
            "global_id": component.global_id,
            "name": plain(component.name),
            "kind": component.kind,
            "n_panels": len(component.elements),
            "n_gaussians": len(component.gaussians),
        }
        extras = component_extras(component, attributes, self._folder)
        more = {"metadata": {"class": "component", "properties": known}, "extras": extras}
        return _Tile(around, children=tuple(children), more=more)

    def _gaussians(self, component: GsComponent, branch: Branch) -> tuple[_Tile, GsComponent | None]:
        """A tile, and what its own file shows; None where it has none."""
        if not branch.halves:
            part = part_of_branch(component, branch)
            return _Tile(box_of_gaussians(part, self._scene), "gaussians", self._file(part, "gaussians")), part
        halves = [self._gaussians(component, half) for half in branch.halves]
        tiles, shown = tuple(tile for tile, _ in halves), [part for _, part in halves if part is not None]
        around = tiles[0].box.with_others(*(tile.box for tile in tiles[1:]))
        is_whole = self._has_coarser and len(shown) == len(halves)
        merged = coarser_part(shown, self._at_most) if is_whole else None
        if merged is None:
            return _Tile(around, children=tiles), None
        around = around.with_others(box_of_gaussians(merged.component, self._scene))
        file, error_m = self._file(merged.component, "gaussians"), SHARPER * merged.side_m
        return _Tile(around, "gaussians", file, error_m, tiles, {"refine": "REPLACE"}), merged.component

    def _file(self, part: GsComponent, layer: Layer) -> str:
        """Write a file; returns its name."""
        document = Document(self._scene, (part,), self._table, self._options, self._folder, self._monitor)
        frame = frame_of(self._scene.origin_enu_m)
        nodes = document.gaussian_nodes(part, frame) if layer == "gaussians" else document.panel_nodes(part, frame)
        # Of a facade's name only what every file system and every URI has.
        name = re.sub(r"[^A-Za-z0-9]+", "-", part.name).strip("-")[:40] or "part"
        try:
            with new_file_beside(self._folder / f"{name}-{layer}.glb") as new:
                write_glb(new, document.content(nodes), document.buffer)
                file = f"{name}-{layer}-{sha256_of_file(new)[:12]}.glb"
                self.files.add(file)
                new.replace(self._folder / file)
        except OSError as error:
            raise InputError(say("cannot be written ({})", error.strerror or error, place=self._folder)) from error
        return file


def _tileset(scene: GsScene, table: PanelTable, root: _Tile, layers: Sequence[Layer], needed: Sequence[str]) -> bytes:
    """A tileset of layers, whose files need some extensions; where the scene has no layer, one that shows nothing."""
    text, number = {"type": "STRING", "required": True}, {"type": "SCALAR", "componentType": "UINT32", "required": True}
    schema = table.schema
    named = {"global_id": {**text, "semantic": "ID"}, "name": {**text, "semantic": "NAME"}}
    schema["classes"] |= {
        "site": {"name": "Site", "properties": named},
        "component": {
            "name": "Facade or background",
            "properties": {**named, "kind": text, "n_panels": number, "n_gaussians": number},
        },
    }
    content = {
        "asset": {"version": "1.1", "extras": scene_extras(scene) | EXTRAS},
        "schema": schema,
        "metadata": {"class": "site", "properties": {"global_id": scene.global_id, "name": plain(scene.name)}},
        "geometricError": root.error_without_children_m(layers),
        "root": root.json(layers),
    }
    if needed:
        content["extensionsUsed"] = [CONTENT]
        content["extensions"] = {CONTENT: {"extensionsUsed": [*needed], "extensionsRequired": [*needed]}}
    return json.dumps(content, indent=1, allow_nan=False).encode()


def _box(box: Box) -> list[float]:
    """Middle, and half the box along each axis."""
    middle, half = 0.5 * (box.low + box.high), np.maximum(0.5 * (box.high - box.low), THINNEST_M)
    return [float(value) for value in (*middle, *np.diag(half).ravel())]


def _earth_from_enu(origin: Origin | None) -> list[float]:
    """Transform from a site's frame to the Earth's (EPSG:4978), column by column, shape (16,)."""
    from pyproj import Transformer

    assert origin is not None  # asked for before
    cart = Transformer.from_pipeline("+proj=cart +ellps=WGS84")
    place = cart.transform(origin.lon_deg, origin.lat_deg, origin.ellipsoid_height_m)
    lat, lon = math.radians(origin.lat_deg), math.radians(origin.lon_deg)
    east = (-math.sin(lon), math.cos(lon), 0.0)
    north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
    up = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
    return [*east, 0.0, *north, 0.0, *up, 0.0, *(float(value) for value in place), 1.0]


def _remove(folder: Path, files: set[str]) -> None:
    for file in files:
        (folder / file).unlink(missing_ok=True)
