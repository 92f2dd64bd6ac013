"""Cameras, points and the description of a data set: COLMAP's model, nerfstudio's transforms.json, our dataset.json."""

from __future__ import annotations

import json
import math
import os
import threading
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import read_json, to_record, write_atomically
from planning.base.messages import about, say
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from planning.photos.folder import OTHER_PICTURES, SUFFIXES
from planning.site.records import Site
from reconstruction.base.cameras import STRAIGHT, Intrinsics, PosedPhoto
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.georeference import Similarity, model_of
from reconstruction.colmap.record import (
    ColmapCamera,
    ColmapImage,
    ColmapModel,
    ColmapPoints,
    camera_of,
    quaternion_of,
)
from reconstruction.photos.decode import PICTURE_FILE, picture_size

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

    def add(
        self, photo: PosedPhoto, image: NDArray[np.uint8], mesh: RayCaster, valid: NDArray[np.bool_] | None = None
    ) -> None:
        """Take in a straight photo's picture, shape (h, w, 3), blue, green, red, of its valid pixels, shape (h, w)."""
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
        if valid is not None:
            told = valid[y, x]
            seen, x, y = seen[told], x[told], y[told]
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


NEAR_PART, FAR_PART = 0.3, 1.7
"""Of the distance to what cameras show, between which it may lie where no point says it."""


def points_ahead(photos: Sequence[PosedPhoto], distance_m: float, n: int, seed: int = 0) -> Array:
    """Places that photos may show, shape (n, 3), for splats to start from where no point is known: at random.

    Parameters
    ----------
    distance_m
        Usual one from the cameras to what they show.
    """
    rng = np.random.default_rng(seed)
    of_each = np.bincount(rng.integers(0, len(photos), n), minlength=len(photos))
    places = []
    for photo, n_own in zip(photos, of_each.tolist(), strict=True):
        lens = photo.intrinsics
        origins, directions = photo.rays(rng.random((n_own, 2)) * (lens.width_px, lens.height_px))
        places.append(origins + directions * (distance_m * rng.uniform(NEAR_PART, FAR_PART, (n_own, 1))))
    return np.concatenate(places)


DATASET_FORMAT = "reflight-dataset/1"

VALID = "valid"
"""Layer of photos of which not all pixels count, black where they do not."""

OPENGL_FROM_CAM = np.diag([1.0, -1.0, -1.0])
"""nerfstudio's camera axes are x right, y up, z backwards."""


def write_records(
    folder: Path,
    photos: Sequence[PosedPhoto],
    site: Site,
    points: ColouredPoints,
    decisions: Sequence[Decision],
    normal_step: int,
    enu_from_model: Similarity | None = None,
) -> None:
    """Write sparse/0, points.ply, transforms.json and dataset.json; the world of all is the site's ENU frame.

    Parameters
    ----------
    enu_from_model
        What the photos' model was moved by, where nothing but it says what the frame is.
    """
    n = len(points.points_enu_m)
    xyz, rgb = points.points_enu_m, points.rgb
    cloud = ColmapPoints(
        np.arange(1, n + 1), xyz, rgb, np.full(n, -1.0), np.zeros(n + 1, np.int64), np.zeros((0, 2), np.int64)
    )
    write_model(folder / "sparse" / "0", replace(model_of(photos), points=cloud))
    write_atomically(folder / "points.ply", coloured_ply(xyz, rgb))
    write_atomically(folder / "transforms.json", _json(transforms(photos)))
    write_atomically(folder / "dataset.json", _json(_description(photos, site, decisions, normal_step, enu_from_model)))


def transforms(photos: Sequence[PosedPhoto]) -> dict[str, Any]:
    """Content of nerfstudio's transforms.json (docs.nerf.studio, "Data conventions").

    Its `mask_path`, whose black pixels are not trained on, names the valid pixels, not the facade. Where a picture is
    not straight, the camera model is its OPENCV.
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
                **({} if photo.mask is None else {"mask_path": f"{VALID}/{photo.name}.png"}),
                **({} if is_straight else dict(zip(("k1", "k2", "p1", "p2", "k3"), lens.distortion, strict=True))),
                "transform_matrix": pose.tolist(),
            }
        )
    model = "PINHOLE" if is_straight else "OPENCV"
    return {"camera_model": model, "ply_file_path": "points.ply", "frames": frames}


def _description(
    photos: Sequence[PosedPhoto],
    site: Site,
    decisions: Sequence[Decision],
    normal_step: int,
    enu_from_model: Similarity | None,
) -> dict[str, Any]:
    panels = [(facade.id, panel) for facade in site.facades for panel in facade.panels]
    return {
        "format": DATASET_FORMAT,
        "site": site.name,
        "origin": asdict(site.origin),
        **({} if enu_from_model is None else {"enu_from_model": _similarity(enu_from_model)}),
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


def _similarity(similarity: Similarity) -> dict[str, Any]:
    return {
        "scale": similarity.scale,
        "rotation": similarity.rotation.tolist(),
        "translation": similarity.translation.tolist(),
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


# Cameras of nerfstudio and instant-ngp, read (docs.nerf.studio, "Data conventions"; instant-ngp, "Tips for training").
#
# Numbers of the lens stand at the top, or with a frame, which goes first. Older files have a field of view alone.

TRANSFORMS_FILES = ("transforms.json", "transforms_train.json")
"""Names of such files, the usual first."""

FISHEYE, PERSPECTIVE = "OPENCV_FISHEYE", ("PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV")
"""Camera models: a fisheye's, and those that Brown's distortion tells."""

MOST_SHEAR = 1e-2
"""By which axes of a pose may miss unit length and right angles: files are rounded."""


@dataclass(frozen=True, slots=True)
class _Lens:
    """What a file or one of its frames says of the lens; None where it does not."""

    camera_model: str | None = None
    is_fisheye: bool = False
    w: float | None = None
    h: float | None = None
    fl_x: float | None = None
    fl_y: float | None = None
    camera_angle_x: float | None = None
    camera_angle_y: float | None = None
    cx: float | None = None
    cy: float | None = None
    k1: float | None = None
    k2: float | None = None
    k3: float | None = None
    k4: float | None = None
    p1: float | None = None
    p2: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Frame(_Lens):
    file_path: str
    transform_matrix: tuple[tuple[float, ...], ...]
    mask_path: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Transforms(_Lens):
    frames: tuple[_Frame, ...]
    ply_file_path: str | None = None


def read_transforms(path: Path) -> tuple[ColmapModel, Path | None, dict[str, Path]]:
    """Cameras and images of a `transforms.json`, without points; the file of points that it names; masks of images.

    Images' names are absolute paths of their files, and masks go by them. The world is the file's own.

    Raises
    ------
    InputError
        The file is damaged, has no frames, no focal length, or a camera that is not understood.
    """
    content = to_record(read_json(path, names_files=True), _Transforms, path)
    if not content.frames:
        raise InputError(say("has no frames", place=path))
    cameras: dict[ColmapCamera, int] = {}
    images: dict[int, ColmapImage] = {}
    nothing_seen = np.zeros((0, 2)), np.zeros(0, np.int64)
    for number, frame in enumerate(content.frames, 1):
        picture = _picture_of(path.parent, frame.file_path)
        place = f"{path}, {frame.file_path}"
        lens = camera_of(_intrinsics(content, frame, picture, place), 0)
        rotation, centre = _pose_of(frame, place)
        x, y, z = (-rotation @ centre).tolist()
        camera_id = cameras.setdefault(lens, len(cameras) + 1)
        images[number] = ColmapImage(
            number, quaternion_of(rotation), (x, y, z), camera_id, picture.as_posix(), *nothing_seen
        )
    names = [image.name for image in images.values()]
    if len(set(names)) < len(names):
        raise InputError(say("names {} pictures twice", len(names) - len(set(names)), place=path))
    model = ColmapModel({number: replace(camera, id=number) for camera, number in cameras.items()}, images)
    masks = {
        image.name: _normal(path.parent, frame.mask_path)
        for image, frame in zip(images.values(), content.frames, strict=True)
        if frame.mask_path is not None
    }
    points = None if content.ply_file_path is None else path.parent / content.ply_file_path
    return model, points, masks


def _picture_of(folder: Path, name: str) -> Path:
    """The file of a frame, an absolute path; names of rendered pictures have no ending."""
    picture = _normal(folder, name)
    if picture.suffix.lower() in SUFFIXES + OTHER_PICTURES or picture.is_file():
        return picture
    endings = (".png", *SUFFIXES, *OTHER_PICTURES)
    return next((found for end in endings if (found := Path(f"{picture}{end}")).is_file()), picture)


def _normal(folder: Path, name: str) -> Path:
    return Path(os.path.normpath((folder / name.replace("\\", "/")).absolute()))


def _pose_of(frame: _Frame, place: str) -> tuple[Array, Array]:
    """Camera from world, shape (3, 3), and the optical centre, shape (3,)."""
    rows = frame.transform_matrix
    if len(rows) not in (3, 4) or any(len(row) != 4 for row in rows):
        raise InputError(say("transform_matrix: expected 4 x 4 numbers", place=place))
    pose = np.array(rows[:3])
    if not np.isfinite(pose).all():
        raise InputError(say("transform_matrix: expected finite numbers", place=place))
    u, lengths, vt = np.linalg.svd(pose[:, :3])
    turn = u @ vt
    if np.abs(lengths - 1.0).max() > MOST_SHEAR or np.linalg.det(turn) < 0.0:
        raise InputError(say("transform_matrix: expected a rotation and a place, without scale", place=place))
    return OPENGL_FROM_CAM @ turn.T, pose[:, 3]


def _intrinsics(content: _Transforms, frame: _Frame, picture: Path, place: str) -> Intrinsics:
    def number(name: str, otherwise: float = 0.0) -> float:
        own, common = getattr(frame, name), getattr(content, name)
        return float(own if own is not None else common if common is not None else otherwise)

    model = frame.camera_model or content.camera_model or "OPENCV"
    is_fisheye = frame.is_fisheye or content.is_fisheye or model == FISHEYE
    if not is_fisheye and model not in PERSPECTIVE:
        raise InputError(
            say(
                "the camera model {} is not supported; expected one of {}; undistort the pictures first, such as with "
                "COLMAP's image_undistorter, whose model 'prepare --colmap' reads",
                model,
                ", ".join((*PERSPECTIVE, FISHEYE)),
                place=place,
            )
        )
    if number("k4") and not is_fisheye:
        raise InputError(say("k4: expected 0, as only k1, k2, k3, p1 and p2 are understood", place=place))
    width, height = number("w"), number("h")
    if not (width and height):
        size = picture_size(read_input_file(picture, PICTURE_FILE))
        if size is None:
            raise InputError(say("cannot be decoded as a picture", place=picture))
        width, height = size
    # A fisheye's field of view says its focal length with its distortion only, and is not written by anybody.
    half_x, half_y = (0.0 if is_fisheye else 0.5 * number(f"camera_angle_{axis}") for axis in "xy")
    fx = number("fl_x") or (0.5 * width / math.tan(half_x) if 0.0 < half_x < 0.5 * math.pi else 0.0)
    # Fields of view of both axes are rounded on their own, and pixels are square.
    fy = number("fl_y") or fx or (0.5 * height / math.tan(half_y) if 0.0 < half_y < 0.5 * math.pi else 0.0)
    if not fy:
        raise InputError(say("says no focal length: expected fl_x, or camera_angle_x", place=place))
    distortion = number("k1"), number("k2"), number("p1"), number("p2"), number("k3")
    fisheye = number("k1"), number("k2"), number("k3"), number("k4")
    try:
        return Intrinsics(
            *(round(width), round(height), fx or fy, fy),
            *(number("cx", 0.5 * width), number("cy", 0.5 * height)),
            *((STRAIGHT, fisheye) if is_fisheye else (distortion, None)),
        )
    except ValueError as error:
        raise InputError(about(place, error)) from error
