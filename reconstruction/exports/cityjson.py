"""CityJSON 2.0: the panels of a model as windows of a building, for city models and GIS.

Each panel is a `Window` of its facade's `WallSurface`; the wall between panels is not known, so it has no polygon. The
system is the UTM zone of the origin on WGS 84 (EPSG 326xx, 327xx), which every reader knows, with heights above sea
level by EGM96, which is what readers take heights beside a plane system for. Distances in UTM are up to 0.1 % off true
ones; importing turns that back. A site without a place on Earth is written in its own east, north, up.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import amsl_from_ellipsoid_m
from reconstruction.exports.glb import NO_ATTRIBUTES, Attributes, Value, attributes_of, plain
from reconstruction.objects.gs_scene import GsComponent, GsScene

STEP_M = 1e-4
"""Of vertices, which are whole numbers: they are off by half of it at most."""

LOD = "3"
"""A model with windows."""

RESERVED = ("type", "id", "name", "parent", "children")
"""Of what a surface means."""

UTM_LATITUDE_DEG = (-80.0, 84.0)

ZONE_DEG = 6.0


@dataclass(frozen=True, slots=True)
class WrittenCity:
    """What came of it.

    Parameters
    ----------
    epsg
        Of the horizontal system; None where the site has no place on Earth.
    """

    path: Path
    n_bytes: int
    n_facades: int
    n_panels: int
    epsg: int | None


def write_cityjson(
    scene: GsScene, path: Path, attributes: Attributes = NO_ATTRIBUTES, monitor: Monitor = QUIET
) -> WrittenCity:
    """Write the facades of a scene that are here, whole or not at all.

    Parameters
    ----------
    attributes
        By GlobalId: of the scene they go to the building, of facades to walls, of panels to windows.

    Raises
    ------
    InputError
        There are no panels, a number is not finite, the site lies beyond UTM, or the file cannot be written.
    """
    facades = [component for component in scene.components if component.elements]
    if not facades:
        raise InputError(say("not written: there are no panels; choose other components", place=path))
    corners = np.array([element.corners_enu_m for facade in facades for element in facade.elements], np.float64)
    if not np.isfinite(corners).all():
        raise InputError(say("not written: a panel has corners that are not finite", place=path))
    epsg = None if scene.origin is None else utm_epsg(scene.origin, path)
    monitor.report(say("writing panels"), 0, 2)
    points = corners.reshape(-1, 3) if scene.origin is None or epsg is None else _projected(scene.origin, epsg, corners)
    low = np.floor(points.min(axis=0))
    vertices, numbers = np.unique(np.rint((points - low) / STEP_M).astype(np.int64), axis=0, return_inverse=True)
    rings = numbers.reshape(-1, 4).tolist()
    surfaces, values = _meanings(facades, attributes, path)
    geometry = {
        "type": "MultiSurface",
        "lod": LOD,
        "boundaries": [[ring] for ring in rings],
        "semantics": {"surfaces": surfaces, "values": values},
    }
    system = "local east, north, up, metres" if epsg is None else "above sea level by EGM96"
    building = {"name": plain(scene.name), "heights": system, **attributes_of(scene.global_id, attributes, path)}
    content: dict[str, Any] = {
        "type": "CityJSON",
        "version": "2.0",
        "transform": {"scale": [STEP_M] * 3, "translate": low.tolist()},
        "metadata": _metadata(scene, points, epsg),
        "CityObjects": {scene.global_id: {"type": "Building", "attributes": building, "geometry": [geometry]}},
        "vertices": vertices.tolist(),
    }
    monitor.report(say("writing panels"), 1, 2)
    data = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    write_atomically(path, data)
    return WrittenCity(path, len(data), len(facades), len(corners), epsg)


def utm_epsg(origin: Origin, path: Path) -> int:
    """EPSG code of the UTM zone on WGS 84 that a place lies in.

    Raises
    ------
    InputError
        It lies in none.
    """
    low, high = UTM_LATITUDE_DEG
    if not low <= origin.lat_deg <= high:
        raise InputError(
            say(
                "not written: its latitude is {:.1f}°, and UTM has {:g}° to {:g}°",
                origin.lat_deg,
                low,
                high,
                place=path,
            )
        )
    zone = math.floor((origin.lon_deg + 180.0) / ZONE_DEG) % 60 + 1
    return (32600 if origin.lat_deg >= 0.0 else 32700) + zone


def _projected(origin: Origin, epsg: int, corners_enu_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """East, north in the zone and height above sea level, shape (n, 3)."""
    from pyproj import Transformer

    place = geodetic_from_enu(origin, corners_enu_m.reshape(-1, 3))
    transformer = Transformer.from_crs("EPSG:4326", f"EPSG:{epsg}", always_xy=True)
    east, north = transformer.transform(place.lon_deg, place.lat_deg)
    height = amsl_from_ellipsoid_m(place.lat_deg, place.lon_deg, place.ellipsoid_height_m)
    return np.column_stack([east, north, height])


def _meanings(
    facades: Sequence[GsComponent], attributes: Attributes, path: Path
) -> tuple[list[dict[str, Any]], list[int]]:
    """Surfaces' meanings, walls before their windows, and the number of each panel's."""
    surfaces: list[dict[str, Any]] = []
    values = []
    for facade in facades:
        wall = len(surfaces)
        windows = range(wall + 1, wall + 1 + len(facade.elements))
        own = _own(facade.global_id, attributes, path)
        surfaces.append(
            {
                "type": "WallSurface",
                "id": facade.global_id,
                "name": plain(facade.name),
                **own,
                "children": list(windows),
            }
        )
        for number, element in zip(windows, facade.elements, strict=True):
            own = _own(element.global_id, attributes, path)
            surfaces.append(
                {"type": "Window", "id": element.global_id, "name": plain(element.name), **own, "parent": wall}
            )
            values.append(number)
    return surfaces, values


def _own(global_id: str, attributes: Attributes, path: Path) -> dict[str, Value]:
    """Attributes of a surface; names that mean something to the format get an underscore."""
    found = attributes_of(global_id, attributes, path)
    return {f"{name}_" if name in RESERVED else name: value for name, value in found.items()}


def _metadata(scene: GsScene, points: NDArray[np.float64], epsg: int | None) -> dict[str, Any]:
    extent = [round(float(value), 4) for value in (*points.min(axis=0), *points.max(axis=0))]
    metadata: dict[str, Any] = {"title": plain(scene.name), "identifier": scene.global_id, "geographicalExtent": extent}
    if epsg is not None:
        metadata["referenceSystem"] = f"https://www.opengis.net/def/crs/EPSG/0/{epsg}"
    return metadata
