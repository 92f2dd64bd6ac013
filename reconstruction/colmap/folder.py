"""A COLMAP model as a folder: cameras, images and points in binary or text files.

COLMAP 3.12 added files about rigs and frames. The images' own poses stand in the images file as before, which is all
that is read here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, read_given
from planning.base.json_file import write_atomically
from planning.base.messages import say
from reconstruction.colmap import binary, text
from reconstruction.colmap.camera_models import check_camera
from reconstruction.colmap.record import NO_POINTS, ColmapCamera, ColmapImage, ColmapModel, ColmapPoints

FileKind = Literal["bin", "txt"]

NAMES = ("cameras", "images", "points3D", "rigs", "frames")

COLMAP_FILE, MAX_LINES = FileLimit("a file of a COLMAP model", 8192 * MIB), 5_000_000
"""A model of ten thousand 20-megapixel photos has about 3 GiB of observations."""

Content = TypeVar("Content")


def read_model(folder: Path) -> ColmapModel:
    """Model in a folder; binary files go before text, and a model may have no points.

    Raises
    ------
    InputError
        There is no model, a file is damaged, or a camera is of a model that is not understood.
    """
    kind = _kind(folder)
    cameras: list[ColmapCamera] = _read(folder, "cameras", kind, binary.read_cameras, text.read_cameras)
    images: list[ColmapImage] = _read(folder, "images", kind, binary.read_images, text.read_images)
    points: ColmapPoints = NO_POINTS
    if (folder / f"points3D.{kind}").exists():
        points = _read(folder, "points3D", kind, binary.read_points, text.read_points)
    model = ColmapModel({camera.id: camera for camera in cameras}, {image.id: image for image in images}, points)
    for what, n, n_ids in (
        ("cameras", len(cameras), len(model.cameras)),
        ("images", len(images), len(model.images)),
        ("images", len(images), len({image.name for image in images})),
    ):
        if n != n_ids:
            raise InputError(f"{folder / f'{what}.{kind}'}: holds {n - n_ids} {what} twice, by id or by name")
    check_model(model, str(folder))
    return model


def check_model(model: ColmapModel, place: str) -> None:
    """Raise `InputError` unless all numbers are finite, poses are poses, and every image has a known camera."""
    for camera in model.cameras.values():
        check_camera(camera, place)
    for image in model.images.values():
        if image.camera_id not in model.cameras:
            raise InputError(f"{place}: image '{image.name}' has camera {image.camera_id}, which is not in the model")
        numbers = np.concatenate([image.q_wxyz, image.t, image.points_px.ravel()])
        if not np.isfinite(numbers).all() or not any(image.q_wxyz):
            raise InputError(f"{place}: image '{image.name}' holds a number that is not finite, or no rotation")
    if not np.isfinite(model.points.xyz).all():
        raise InputError(f"{place}: a 3-D point has a coordinate that is not finite")


def write_model(folder: Path, model: ColmapModel, kind: FileKind = "bin") -> None:
    """Write a model into a folder that holds none yet.

    Raises
    ------
    InputError
        The folder holds files of another model, cannot be written, or a name cannot stand in a text file.
    """
    there = [f"{name}.{end}" for name in NAMES for end in ("bin", "txt") if (folder / f"{name}.{end}").exists()]
    if there:
        raise InputError(f"{folder}: holds a COLMAP model already ({', '.join(there)}); name an empty folder")
    cameras, images = list(model.cameras.values()), list(model.images.values())
    if kind == "txt":
        _check_names(images)
    contents = {
        "cameras": binary.cameras_bytes(cameras) if kind == "bin" else _encoded(text.cameras_text(cameras)),
        "images": binary.images_bytes(images) if kind == "bin" else _encoded(text.images_text(images)),
        "points3D": binary.points_bytes(model.points) if kind == "bin" else _encoded(text.points_text(model.points)),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(say("cannot be made ({})", error.strerror or error, place=folder)) from error
    for name, content in contents.items():
        write_atomically(folder / f"{name}.{kind}", content)


def _check_names(images: Sequence[ColmapImage]) -> None:
    for image in images:
        if image.name != image.name.strip() or not image.name.isprintable():
            raise InputError(
                f"image '{image.name}': a name with spaces at its ends or control characters cannot stand in COLMAP's "
                "text files; write the binary ones"
            )


def _kind(folder: Path) -> FileKind:
    kinds: tuple[FileKind, ...] = ("bin", "txt")
    for kind in kinds:
        if (folder / f"cameras.{kind}").is_file() and (folder / f"images.{kind}").is_file():
            return kind
    found = say("a file") if folder.is_file() else "no folder" if not folder.is_dir() else "a folder without them"
    raise InputError(
        f"{folder}: expected a COLMAP model (cameras and images as .bin or .txt), found {found}; models are often in "
        "sparse/0"
    )


def _read(
    folder: Path,
    name: str,
    kind: FileKind,
    of_bytes: Callable[[bytes, str], Content],
    of_text: Callable[[str, str], Any],
) -> Content:
    path = folder / f"{name}.{kind}"
    content = read_given(path, COLMAP_FILE)
    if kind == "bin":
        return of_bytes(content, str(path))
    check_lines(content, MAX_LINES, path)
    found: Content = of_text(content.decode("utf-8", "surrogateescape"), str(path))
    return found


def _encoded(content: str) -> bytes:
    return content.encode("utf-8", "surrogateescape")
