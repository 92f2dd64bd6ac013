"""Gaussians and panels as meshes of glTF: KHR_gaussian_splatting, and quads that a viewer can pick.

Gaussians may be compressed (KHR_gaussian_splatting_compression_spz_2, a draft): then their numbers come from an SPZ
file within the file, in the axes of the mesh, as CesiumJS reads them. Such primitives say neither kernel nor colour
space and have diffuse colours and opacities as COLOR_0: programs tell the draft's two ways by that.

Viewers that do not know Gaussians draw their means as points in their diffuse colour. No viewer tells which Gaussian
was clicked on, so each facade has a mesh of its panels: invisible, and hit by picking as any mesh is. Both say by
`_FEATURE_ID_0` (EXT_mesh_features) which row of the table of properties they belong to.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import Monitor
from planning.geo.frames import Vec3
from reconstruction.exports.component_parts import element_numbers, ellipsoid_blocks, light_of
from reconstruction.exports.ellipsoids import Ellipsoids
from reconstruction.exports.glb import FLOAT, INDICES, UINT8, UINT16, UINT32, GlbBuffer, Put, limits_of
from reconstruction.exports.gltf_tables import area_vector
from reconstruction.objects.gs_scene import GsComponent

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
