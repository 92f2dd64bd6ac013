"""Cameras, points and the description of a data set: COLMAP's model, nerfstudio's transforms.json, our dataset.json."""

from __future__ import annotations

import json
import threading
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.json_file import write_atomically
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from planning.site.records import Site
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.georeference import model_of
from reconstruction.colmap.record import ColmapPoints

# Points that reconstruction starts from: spread over the refined mesh, coloured by the photos that see them.

Array = NDArray[np.float64]

IN_FRONT_M = 0.05
"""A point is hidden if the mesh is hit this much before it."""

UNSEEN = 128
"""Grey of points that no photo sees."""


class ColouredPoints:
    """Points, shape (n, 3), ENU, whose colours are the means of what the photos added so far show there.

    Safe to add to from several threads.
    """

    def __init__(self, points_enu_m: Array) -> None:
        self.points_enu_m = points_enu_m
        self._sums = np.zeros((len(points_enu_m), 3))
        self._counts = np.zeros(len(points_enu_m), np.int64)
        self._lock = threading.Lock()

    def add(self, photo: PosedPhoto, image: NDArray[np.uint8], mesh: RayCaster) -> None:
        """Take in a straight photo's picture, shape (h, w, 3), blue, green, red."""
        seen = np.flatnonzero(photo.sees(self.points_enu_m))
        towards = self.points_enu_m[seen] - photo.pose.position_enu_m
        distance = np.linalg.norm(towards, axis=1)
        hits = mesh.cast(
            np.broadcast_to(photo.pose.position_enu_m, towards.shape), towards / np.maximum(distance, 1e-9)[:, None]
        )
        seen = seen[hits.distance_m >= distance - IN_FRONT_M]
        pixels = photo.pixels(self.points_enu_m[seen]).astype(np.int64)
        x = np.minimum(pixels[:, 0], image.shape[1] - 1)
        y = np.minimum(pixels[:, 1], image.shape[0] - 1)
        colours = image[y, x, ::-1].astype(float)
        with self._lock:
            self._sums[seen] += colours
            self._counts[seen] += 1

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """Shape (n, 3)."""
        mean = self._sums / np.maximum(self._counts, 1)[:, None]
        return np.where(self._counts[:, None] > 0, np.round(mean), UNSEEN).astype(np.uint8)


def start_points(mesh: TriangleMesh, n: int, seed: int = 0, cloud: Array | None = None) -> ColouredPoints:
    """Points spread evenly, by area, over a mesh; and before them up to as many that are known, shape (k, 3)."""
    rng = np.random.default_rng(seed)
    known = np.zeros((0, 3)) if cloud is None else cloud[np.sort(rng.permutation(len(cloud))[:n])]
    if not len(mesh.triangles) or n == 0:
        return ColouredPoints(known)
    a, b, c = np.moveaxis(mesh.corners_enu_m, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not areas.sum() > 0.0:
        return ColouredPoints(known)
    chosen = rng.choice(len(areas), n, p=areas / areas.sum())
    u, v = rng.random((2, n, 1))
    flip = u + v > 1.0
    u, v = np.where(flip, 1.0 - u, u), np.where(flip, 1.0 - v, v)
    spread = a[chosen] + u * (b[chosen] - a[chosen]) + v * (c[chosen] - a[chosen])
    return ColouredPoints(np.concatenate([known, spread]))


DATASET_FORMAT = "reflight-dataset/1"

OPENGL_FROM_CAM = np.diag([1.0, -1.0, -1.0])
"""nerfstudio's camera axes are x right, y up, z backwards."""


def write_records(
    folder: Path,
    photos: Sequence[PosedPhoto],
    site: Site,
    points: ColouredPoints,
    decisions: Sequence[Decision],
    normal_step: int,
) -> None:
    """Write sparse/0, points.ply, transforms.json and dataset.json; the world of all is the site's ENU frame."""
    n = len(points.points_enu_m)
    xyz, rgb = points.points_enu_m, points.rgb
    cloud = ColmapPoints(
        np.arange(1, n + 1), xyz, rgb, np.full(n, -1.0), np.zeros(n + 1, np.int64), np.zeros((0, 2), np.int64)
    )
    write_model(folder / "sparse" / "0", replace(model_of(photos), points=cloud))
    write_atomically(folder / "points.ply", coloured_ply(xyz, rgb))
    write_atomically(folder / "transforms.json", _json(transforms(photos)))
    write_atomically(folder / "dataset.json", _json(_description(photos, site, decisions, normal_step)))


def transforms(photos: Sequence[PosedPhoto]) -> dict[str, Any]:
    """Content of nerfstudio's transforms.json (docs.nerf.studio, "Data conventions").

    Facade masks do not stand under its `mask_path`, whose black pixels are not trained on. Where a picture is not
    straight, the camera model is its OPENCV.
    """
    is_straight = all(photo.intrinsics.is_straight for photo in photos)
    frames = []
    for photo in photos:
        lens, pose = photo.intrinsics, np.eye(4)
        pose[:3, :3] = photo.pose.cam_from_enu.T @ OPENGL_FROM_CAM
        pose[:3, 3] = photo.pose.position_enu_m
        frames.append(
            {
                "file_path": f"images/{photo.name}",
                "facade_mask_path": f"masks/{photo.name}.png",
                "panel_path": f"panels/{photo.name}.png",
                "normal_path": f"normals/{photo.name}.png",
                "w": lens.width_px,
                "h": lens.height_px,
                "fl_x": lens.fx_px,
                "fl_y": lens.fy_px,
                "cx": lens.cx_px,
                "cy": lens.cy_px,
                **({} if is_straight else dict(zip(("k1", "k2", "p1", "p2", "k3"), lens.distortion, strict=True))),
                "transform_matrix": pose.tolist(),
            }
        )
    model = "PINHOLE" if is_straight else "OPENCV"
    return {"camera_model": model, "ply_file_path": "points.ply", "frames": frames}


def _description(
    photos: Sequence[PosedPhoto], site: Site, decisions: Sequence[Decision], normal_step: int
) -> dict[str, Any]:
    panels = [(facade.id, panel) for facade in site.facades for panel in facade.panels]
    return {
        "format": DATASET_FORMAT,
        "site": site.name,
        "origin": asdict(site.origin),
        "panels": [
            {
                "index": number,
                "id": panel.id,
                "facade": facade,
                "corners_enu_m": panel.corners_enu_m,
                **({} if panel.source_id is None else {"source_id": panel.source_id}),
            }
            for number, (facade, panel) in enumerate(panels, 1)
        ],
        "photos": [
            {"name": photo.name, "taken_at": None if photo.taken_at is None else photo.taken_at.isoformat()}
            for photo in photos
        ],
        "normal_step": normal_step,
        "effects": [asdict(decision) for decision in decisions],
    }


def coloured_ply(points_enu_m: NDArray[np.float64], rgb: NDArray[np.uint8]) -> bytes:
    """Binary PLY of a coloured point cloud, coordinates as float32 as all readers of splats expect."""
    fields = [(axis, "<f4") for axis in "xyz"] + [(colour, "u1") for colour in ("red", "green", "blue")]
    table = np.empty(len(points_enu_m), fields)
    for i, axis in enumerate("xyz"):
        table[axis] = points_enu_m[:, i]
    for i, colour in enumerate(("red", "green", "blue")):
        table[colour] = rgb[:, i]
    properties = "".join(f"property float {axis}\n" for axis in "xyz")
    properties += "".join(f"property uchar {colour}\n" for colour in ("red", "green", "blue"))
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(table)}\n{properties}end_header\n"
    return header.encode("ascii") + table.tobytes()


def _json(content: dict[str, Any]) -> bytes:
    return json.dumps(content, indent=1).encode()
