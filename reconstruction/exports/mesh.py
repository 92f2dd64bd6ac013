"""Panels as a mesh with pictures on them (.glb), for programs that know no Gaussians.

Each panel is an object of its own with its GlobalId. Its picture is what the model shows straight in front of it from
far away, mirrored light and all: the light that comes back the way it went. Seen from elsewhere it stays that picture.
What stands before a panel is cut off; frames and walls between panels are in no mesh, and are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.site.importing.polygons import area_vector
from reconstruction.exports.component_parts import check_scene
from reconstruction.exports.gaussian_blocks import raster_of
from reconstruction.exports.glb import (
    FLOAT,
    INDICES,
    NO_ATTRIBUTES,
    UINT16,
    VERTICES,
    Attributes,
    GlbBuffer,
    attributes_of,
    limits_of,
    plain,
    write_glb,
)
from reconstruction.exports.gltf import component_extras, frame_of, scene_extras
from reconstruction.light.ray_table import RayTable
from reconstruction.light.shading import display_from_linear, schlick, shade
from reconstruction.objects.gs_scene import GsComponent, GsElement, GsScene
from reconstruction.splats.harmonic_colour import display_colours, fitted_harmonics, light_of_display
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.render import render_view

# What panels show, mirrored light and all, put into their Gaussians' own colours: for programs that mirror nothing.
#
# Colours by direction are harmonics of degree 3, so what is mirrored becomes a blur of some tens of degrees that
# stays on
# the pane. The model itself keeps its sharp mirror images; `docs/reference/exports.md` says how much is lost.

N_DIRECTIONS = 96
"""From which a pane is looked at: six for each harmonic."""

DEGREE = 3

LEAST_COSINE = 0.05
"""Of directions against the pane's normal: at 87 degrees, glass mirrors nearly all, and nobody flies there."""

AT_ONCE = 200_000
"""Rays of one piece of work."""

ALMOST_NO_LOGIT = -20.0
"""Reflectivity that is left: 2e-9."""

FAR_M = 1e4


def needs_baking(model: SceneModel) -> bool:
    """Whether panels show light that is not in their Gaussians' own colours, and can be put there."""
    return model.light is not None


@torch.no_grad()
def baked(scene: GsScene, model: SceneModel, degree: int = DEGREE, monitor: Monitor = QUIET) -> GsScene:
    """The scene with Gaussians on panels that have, and no longer mirror, what the panels show.

    Parameters
    ----------
    scene
        Any of the components of `model`'s.
    degree
        Of the harmonics of what is written: they are fitted to half of all directions, where they are not orthogonal,
        so a fit of a higher degree that is cut comes out worse than one of the degree itself.

    Raises
    ------
    ValueError
        The model has no light that panels mirror.
    """
    if model.light is None:
        raise ValueError("model: expected one whose panels mirror light")
    table = RayTable.of([], model.planes, {})
    n_panels = sum(len(component.elements) for component in scene.components)
    done = 0
    components = []
    for component in scene.components:
        sh = component.gaussians.values["sh"].copy()
        reflectivity = component.gaussians.values["reflectivity_logits"].copy()
        for element in component.elements:
            monitor.report(say("baking panels"), done, n_panels)
            done += 1
            for rows in _pieces(element.start, element.stop):
                sh[rows] = _shown(component, rows, element.panel, model, table, np.asarray(scene.origin_enu_m), degree)
                reflectivity[rows] = ALMOST_NO_LOGIT
        values = {**component.gaussians.values, "sh": sh, "reflectivity_logits": reflectivity}
        components.append(replace(component, gaussians=replace(component.gaussians, values=values)))
    return replace(scene, components=tuple(components))


def _pieces(start: int, stop: int) -> Iterator[slice]:
    step = AT_ONCE // N_DIRECTIONS
    return (slice(first, min(first + step, stop)) for first in range(start, stop, step))


def _shown(
    component: GsComponent,
    rows: slice,
    panel: int,
    model: SceneModel,
    table: RayTable,
    origin_enu_m: NDArray[np.float64],
    degree: int,
) -> NDArray[np.float32]:
    """Coefficients, shape (n, 16, 3), of what Gaussians on a panel show from in front of it."""
    assert model.light is not None
    part = {name: torch.from_numpy(value[rows].copy()) for name, value in component.gaussians.values.items()}
    n = len(part["means"])
    outwards = outward_directions(table.normals[panel])
    k = len(outwards)
    panels = torch.full((n * k,), panel, dtype=torch.long)
    points = part["means"].double() + torch.from_numpy(origin_enu_m) - table.middle_m
    met = table.arriving(points.repeat_interleave(k, dim=0), (-outwards).repeat(n, 1), panels)
    omega_r, cosines = model.light.mirrored(table, met, panels)
    light = model.light.light(table.rescaled(met.points_m).float(), omega_r, panels)
    own = torch.stack(
        [
            display_colours(part["means"], part["sh"], (part["means"].mean(0) + FAR_M * each).float(), 3)
            for each in outwards
        ],
        dim=1,
    )
    colours = light_of_display(own).reshape(n * k, 3)
    reflectivity = torch.sigmoid(part["reflectivity_logits"]).repeat_interleave(k)[:, None]
    fresnel = schlick(torch.sigmoid(part["f0_logits"]).repeat_interleave(k, dim=0), cosines)
    shown = display_from_linear(shade(colours, reflectivity, fresnel, light)).clamp(max=1.0)
    return fitted_harmonics(-outwards, shown.reshape(n, k, 3), degree).numpy()


def outward_directions(normal: Tensor) -> Tensor:
    """Evenly spread over the hemisphere before a panel, but for its rim, shape (k, 3), float64, unit.

    A Fibonacci spiral, of equal solid angles.
    """
    number = torch.arange(N_DIRECTIONS, dtype=torch.float64) + 0.5
    height = 1.0 - (1.0 - LEAST_COSINE) * number / N_DIRECTIONS
    turn = number * math.pi * (3.0 - math.sqrt(5.0))
    flat = torch.sqrt(1.0 - height * height)
    # Any axis across the normal will do.
    other = torch.eye(3, dtype=torch.float64)[int(normal.abs().argmin())]
    u = torch.nn.functional.normalize(torch.linalg.cross(normal, other), dim=0)
    v = torch.linalg.cross(normal, u)
    across = torch.cos(turn)[:, None] * u + torch.sin(turn)[:, None] * v
    found: Tensor = height[:, None] * normal + flat[:, None] * across
    return found


# Many small pictures on few large ones: shelves from the highest to the lowest.


@dataclass(frozen=True, slots=True)
class Place:
    """Where a picture lies: its upper left pixel on a page."""

    page: int
    x_px: int
    y_px: int


@dataclass(frozen=True, slots=True)
class Atlas:
    """Places in the order of the pictures, and the sizes of the pages, width and height."""

    places: tuple[Place, ...]
    pages: tuple[tuple[int, int], ...]


def pack(sizes: Sequence[tuple[int, int]], page_px: int) -> Atlas:
    """Place pictures of given widths and heights on square pages of a side, cut to what is used of them.

    Raises
    ------
    ValueError
        A picture is larger than a page.
    """
    if any(max(size) > page_px or min(size) < 1 for size in sizes):
        raise ValueError(f"sizes: expected 1 to {page_px} pixels each way")
    places: list[Place | None] = [None] * len(sizes)
    used: list[tuple[int, int]] = []
    page, x, y, shelf = -1, 0, page_px, 0
    for number in sorted(range(len(sizes)), key=lambda number: (-sizes[number][1], -sizes[number][0], number)):
        width, height = sizes[number]
        if page >= 0 and x + width > page_px:
            x, y, shelf = 0, y + shelf, height
        if y + height > page_px:
            page, x, y, shelf = page + 1, 0, 0, height
            used.append((0, 0))
        places[number] = Place(page, x, y)
        used[page] = (max(used[page][0], x + width), max(used[page][1], y + height))
        x += width
    return Atlas(tuple(place for place in places if place is not None), tuple(used))


# Straight-on views of panels: pictures that cover them as a texture does.

Array = NDArray[np.float64]

AWAY = 20.0
"""Distance of the camera, as a multiple of a panel's size: rays to its corners are within 2 degrees of its normal."""

EDGE_PX = 2
"""Around a panel, of what is there: textures are smoothed across their pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class PanelView:
    """How a panel is looked at.

    Parameters
    ----------
    view
        Of a camera straight in front, whose picture has `EDGE_PX` more on all sides than the panel.
    distance_m
        Of the camera from the panel's plane.
    corners_px
        Of the panel in the picture, shape (4, 2): x to the right, y down.
    """

    view: View
    distance_m: float
    corners_px: Array


def panel_view(corners_m: Array, px_per_m: float) -> PanelView:
    """View of a panel that is `px_per_m` fine at least.

    Parameters
    ----------
    corners_m
        In the model's frame, counter-clockwise seen from outside, the lower left one first, shape (4, 3).

    Raises
    ------
    ValueError
        The panel has no area.
    """
    normal, right = area_vector(corners_m), corners_m[1] - corners_m[0]
    area = float(np.linalg.norm(normal))
    if not area > 0.0:
        raise ValueError("corners_m: expected a panel with an area")
    normal = normal / area
    right = right - (right @ normal) * normal
    right = right / np.linalg.norm(right)
    up = np.cross(normal, right)
    flat = (corners_m - corners_m[0]) @ np.stack([right, up], axis=1)
    low, size_m = flat.min(axis=0), np.ptp(flat, axis=0)
    size_px = np.maximum(1, np.ceil(size_m * px_per_m - 1e-6))
    distance_m = AWAY * float(size_m.max())
    middle = corners_m[0] + (low + 0.5 * size_m) @ np.stack([right, up])
    # What lies off the plane of the first corner: panels may be warped by centimetres.
    middle = middle + ((corners_m.mean(axis=0) - middle) @ normal) * normal
    world = np.eye(4)
    world[:3, :3] = np.stack([right, -up, -normal])
    world[:3, 3] = -world[:3, :3] @ (middle + distance_m * normal)
    focal_px = distance_m * size_px / size_m
    width_px, height_px = (int(size) + 2 * EDGE_PX for size in size_px)
    view = View(
        width_px,
        height_px,
        float(focal_px[0]),
        float(focal_px[1]),
        0.5 * width_px,
        0.5 * height_px,
        torch.tensor(world),
    )
    share = (flat - low) / size_m
    corners_px = EDGE_PX + np.column_stack([share[:, 0], 1.0 - share[:, 1]]) * size_px
    return PanelView(view, distance_m, corners_px)


TRIANGLES = 4

LINEAR, LINEAR_BETWEEN_SIZES, TO_EDGE = 9729, 9987, 33071
"""How textures are looked up."""

UNLIT = "KHR_materials_unlit"


@dataclass(frozen=True, slots=True)
class MeshOptions:
    """How fine pictures are.

    Parameters
    ----------
    px_per_m
        On the panels, 1 to 2000.
    page_px
        Largest side of a texture, 256 to 16 384; 4096 works everywhere.
    most_pages
        Textures in all: 4096 pixels square are 67 MB on a graphics card.
    in_front_m
        So far in front of a panel the model is still drawn: mullions and sills, but no crane.
    """

    px_per_m: float = 100.0
    page_px: int = 4096
    most_pages: int = 32
    in_front_m: float = 0.3

    def __post_init__(self) -> None:
        if not 1.0 <= self.px_per_m <= 2000.0:
            raise ValueError(f"px_per_m: expected 1 to 2000, got {self.px_per_m}")
        if not 256 <= self.page_px <= 16_384:
            raise ValueError(f"page_px: expected 256 to 16384, got {self.page_px}")
        if not 1 <= self.most_pages <= 1024:
            raise ValueError(f"most_pages: expected 1 to 1024, got {self.most_pages}")
        if not 0.0 < self.in_front_m <= 100.0:
            raise ValueError(f"in_front_m: expected more than 0, up to 100, got {self.in_front_m}")


DEFAULT = MeshOptions()


@dataclass(frozen=True, slots=True)
class WrittenMesh:
    """What came of it."""

    path: Path
    n_bytes: int
    n_panels: int
    n_pages: int


def write_mesh(
    scene: GsScene,
    model: SceneModel,
    path: Path,
    options: MeshOptions = DEFAULT,
    attributes: Attributes = NO_ATTRIBUTES,
    monitor: Monitor = QUIET,
) -> WrittenMesh:
    """Write the panels of a scene that are here, whole or not at all.

    Parameters
    ----------
    model
        That the scene is of; what it mirrors is rendered.
    attributes
        Of panels and facades by GlobalId; they go into the `extras` of nodes.

    Raises
    ------
    InputError
        There are no panels, one has no area, pictures would be too large, or the file cannot be written.
    """
    check_scene(scene, path)
    elements = [element for _, element in scene.elements]
    if not elements:
        raise InputError(say("not written: there are no panels; choose other components", place=path))
    views = [_view(scene, element, path, options) for element in elements]
    atlas = _packed(elements, views, path, options)
    raster = raster_of(scene)
    buffer = GlbBuffer()
    images = [
        {"bufferView": buffer.add(content), "mimeType": "image/png", "name": f"panels {page + 1}"}
        for page, content in enumerate(_pages(model, views, atlas, options, raster, monitor))
    ]
    write_glb(path, _content(scene, views, atlas, images, attributes, buffer, path), buffer)
    return WrittenMesh(path, path.stat().st_size, len(elements), len(atlas.pages))


def _view(scene: GsScene, element: GsElement, path: Path, options: MeshOptions) -> PanelView:
    corners_m = np.array(element.corners_enu_m, np.float64) - np.array(scene.origin_enu_m)
    try:
        return panel_view(corners_m, options.px_per_m)
    except ValueError as error:
        raise InputError(
            say("not written: panel '{}' has no area; import the site again", element.name, place=path)
        ) from error


def _packed(elements: Sequence[GsElement], views: Sequence[PanelView], path: Path, options: MeshOptions) -> Atlas:
    for element, each in zip(elements, views, strict=True):
        longest = max(each.view.width_px, each.view.height_px)
        if longest > options.page_px:
            fits = int(options.px_per_m * options.page_px / longest)
            raise InputError(
                say(
                    "not written: panel '{}' would have {} pixels on a side, and textures have {}; choose {} pixels "
                    "per metre or fewer",
                    element.name,
                    longest,
                    options.page_px,
                    fits,
                    place=path,
                )
            )
    atlas = pack([(each.view.width_px, each.view.height_px) for each in views], options.page_px)
    if len(atlas.pages) > options.most_pages:
        fits = int(options.px_per_m * (options.most_pages / len(atlas.pages)) ** 0.5)
        raise InputError(
            say(
                "not written: {} textures of {} pixels would be needed, and {} are the most; choose about {} "
                "pixels per metre, or single facades",
                len(atlas.pages),
                options.page_px,
                options.most_pages,
                fits,
                place=path,
            )
        )
    return atlas


def _pages(
    model: SceneModel,
    views: Sequence[PanelView],
    atlas: Atlas,
    options: MeshOptions,
    raster: RasterSettings,
    monitor: Monitor,
) -> list[bytes]:
    """PNG files; one page at a time is in memory."""
    found, done = [], 0
    for page, (width, height) in enumerate(atlas.pages):
        picture = np.zeros((height, width, 3), np.uint8)
        for each, place in zip(views, atlas.places, strict=True):
            if place.page == page:
                monitor.report(say("rendering panels"), done, len(views))
                rows = slice(place.y_px, place.y_px + each.view.height_px)
                columns = slice(place.x_px, place.x_px + each.view.width_px)
                picture[rows, columns] = _picture(model, each, options, raster)
                done += 1
        found.append(cv2.imencode(".png", picture[..., ::-1])[1].tobytes())
    return found


def _picture(model: SceneModel, each: PanelView, options: MeshOptions, raster: RasterSettings) -> NDArray[np.uint8]:
    """Display values, shape (h, w, 3), red first."""
    settings = replace(raster, near_m=max(0.5 * each.distance_m, each.distance_m - options.in_front_m))
    display = render_view(model, each.view, settings=settings).display
    return np.asarray(np.rint(255.0 * np.nan_to_num(display)), np.uint8)


def _content(
    scene: GsScene,
    views: Sequence[PanelView],
    atlas: Atlas,
    images: Sequence[dict[str, Any]],
    attributes: Attributes,
    buffer: GlbBuffer,
    path: Path,
) -> dict[str, Any]:
    nodes: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    corners = buffer.table(np.array([0, 1, 2, 0, 2, 3]), UINT16, INDICES)
    facades, number = [], 0
    for component in scene.components:
        children = []
        for element in component.elements:
            place, view = atlas.places[number], views[number]
            texels = (view.corners_px + np.array([place.x_px, place.y_px])) / np.array(atlas.pages[place.page])
            meshes.append(_mesh(scene, element, texels, place.page, corners, buffer))
            known = attributes_of(element.global_id, attributes, path)
            extras = {"layer": "element", "global_id": element.global_id, "attributes": known}
            nodes.append({"name": plain(element.name), "mesh": number, "extras": extras})
            children.append(number)
            number += 1
        facades.append((component, children))
    roots = [_facade_node(component, children, attributes, path) for component, children in facades if children]
    first = len(nodes)
    nodes += roots
    root = {"name": plain(scene.name), **frame_of(scene.origin_enu_m)}
    nodes.append({**root, "children": list(range(first, len(nodes)))})
    pages = range(len(images))
    return {
        "asset": {"version": "2.0", "generator": "Reflight", "extras": scene_extras(scene)},
        "extensionsUsed": [UNLIT],
        "scene": 0,
        "scenes": [{"name": plain(scene.name), "nodes": [len(nodes) - 1]}],
        "nodes": nodes,
        "meshes": meshes,
        "images": list(images),
        "samplers": [{"magFilter": LINEAR, "minFilter": LINEAR_BETWEEN_SIZES, "wrapS": TO_EDGE, "wrapT": TO_EDGE}],
        "textures": [{"source": page, "sampler": 0} for page in pages],
        "materials": [_material(page) for page in pages],
    }


def _facade_node(component: GsComponent, children: Sequence[int], attributes: Attributes, path: Path) -> dict[str, Any]:
    extras = component_extras(component, attributes, path)
    return {"name": plain(component.name), "children": list(children), "extras": extras}


def _mesh(
    scene: GsScene, element: GsElement, texels: NDArray[np.float64], page: int, corners: int, buffer: GlbBuffer
) -> dict[str, Any]:
    places = np.array(element.corners_enu_m, np.float64) - np.array(scene.origin_enu_m)
    positions = places.astype(np.float32)
    attributes = {
        "POSITION": buffer.table(positions, FLOAT, **limits_of(positions)),
        "TEXCOORD_0": _put_texels(texels, buffer),
    }
    primitive = {"attributes": attributes, "indices": corners, "material": page, "mode": TRIANGLES}
    return {"name": plain(element.name), "primitives": [primitive]}


def _put_texels(texels: NDArray[np.float64], buffer: GlbBuffer) -> int:
    """Number of their accessor."""
    view = buffer.view(8 * len(texels), VERTICES)
    buffer.accessors.append({"bufferView": view, "componentType": FLOAT, "count": len(texels), "type": "VEC2"})
    number = len(buffer.accessors) - 1
    buffer.fill(lambda put: put(buffer.offset(number), texels.astype("<f4")))
    return number


def _material(page: int) -> dict[str, Any]:
    """Drawn as it is: the light is in the picture."""
    surface = {"baseColorTexture": {"index": page}, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {"name": f"panels {page + 1}", "pbrMetallicRoughness": surface, "extensions": {UNLIT: {}}}
