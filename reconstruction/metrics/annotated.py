"""Photos of real facades that people annotated: where they lie, and which pixels are which window.

A *panel* of these sets is a window. They break what the search for panels assumes: between their windows there is
wall, so not every cell of the grid is a window, and the lines around one window need not go on to the next.

The sets and their licences: CMP facade base (Tylecek and Sara, 2013; research use), ECP (Teboul et al., 2010; research
use), and night photos of offices (Hwang, 2023; CC BY 4.0), which are in perspective; the others are rectified.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_given
from planning.base.json_file import read_json
from reconstruction.metrics.pictures import read_labels, read_picture
from reconstruction.metrics.raster import index_image

ECP_WINDOW_BGR = (0, 0, 255)
"""Windows are red in ECP's masks."""

COCO_FILE = "_annotations.coco.json"

TABLE_FILE = FileLimit("a CSV table", 64 * MIB)
COCO_WINDOW = "window"


@dataclass(frozen=True, slots=True, eq=False)
class AnnotatedPhoto:
    """A photo with its true windows.

    Parameters
    ----------
    image
        Shape (height, width, 3), uint8, blue, green, red.
    index
        Shape (height, width), uint16: number of the window, 0 elsewhere.
    """

    name: str
    image: NDArray[np.uint8]
    index: NDArray[np.uint16]


def cmp_photos(folder: Path) -> Iterator[AnnotatedPhoto]:
    """CMP facade base: `NAME.jpg` with the windows' rectangles in `NAME.windows.csv` (x0, y0, x1, y1 in pixels).

    Raises
    ------
    InputError
        The folder holds none, or a file is not as described.
    """
    for path in _files(folder, "*.windows.csv"):
        name = path.name.removesuffix(".windows.csv")
        image = read_picture(path.with_name(f"{name}.jpg"))
        height, width = image.shape[:2]
        boxes = [np.array([[a, b], [c, b], [c, d], [a, d]]) for a, b, c, d in _rectangles(path)]
        yield AnnotatedPhoto(name, image, index_image(boxes, width, height))


def ecp_photos(folder: Path) -> Iterator[AnnotatedPhoto]:
    """ECP: `image/NAME.jpg` with `ground_truth/NAME.png`, in which each red area is a window.

    Raises
    ------
    InputError
        The folder holds none, or a file is not as described.
    """
    for path in _files(folder / "ground_truth", "*.png"):
        labels = read_labels(path)
        is_window = (labels == ECP_WINDOW_BGR).all(axis=-1) if labels.ndim == 3 else np.zeros(labels.shape, bool)
        if not is_window.any():
            raise InputError(f"{path}: expected windows painted red (255, 0, 0), found none")
        _, index = cv2.connectedComponents(is_window.astype(np.uint8), connectivity=4)
        image = read_picture(folder / "image" / f"{path.stem}.jpg")
        yield AnnotatedPhoto(path.stem, image, _checked(np.asarray(index, np.uint16), image, path))


def coco_photos(folder: Path) -> Iterator[AnnotatedPhoto]:
    """Photos with a polygon for each window in one COCO file, `_annotations.coco.json`.

    Raises
    ------
    InputError
        The file is missing or not as described.
    """
    path = folder / COCO_FILE
    try:
        content = read_json(path)
        windows = {entry["id"] for entry in content["categories"] if entry["name"] == COCO_WINDOW}
        images = sorted(content["images"], key=lambda entry: str(entry["file_name"]))
        polygons: dict[int, list[NDArray[np.float64]]] = {entry["id"]: [] for entry in images}
        for annotation in content["annotations"]:
            if annotation["category_id"] in windows:
                polygons[annotation["image_id"]] += _coco_polygons(annotation)
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: expected annotations in COCO's form, found {error!r}") from error
    for entry in images:
        image = read_picture(folder / entry["file_name"])
        height, width = image.shape[:2]
        index = index_image(polygons[entry["id"]], width, height)
        yield AnnotatedPhoto(_short(Path(entry["file_name"]).stem), image, index)


READERS: dict[str, tuple[str, Callable[[Path], Iterator[AnnotatedPhoto]]]] = {
    "cmp": ("cmp", cmp_photos),
    "ecp": ("ecp", ecp_photos),
    "offices": ("offices_at_night", coco_photos),
}
"""Sets by name: their folder among real facades, and their reader."""

RECTIFIED_SETS = ("cmp", "ecp")
"""Whose photos are fronto-parallel already."""

SHOWABLE_SETS = ("offices",)
"""Whose licence lets their photos be shown."""


def _files(folder: Path, pattern: str) -> list[Path]:
    found = sorted(folder.glob(pattern))
    if not found:
        raise InputError(f"{folder}: expected annotated photos ({pattern}) in this folder, found none")
    return found


def _rectangles(path: Path) -> list[tuple[float, float, float, float]]:
    try:
        rows = list(csv.DictReader(read_given(path, TABLE_FILE).decode("utf-8").splitlines()))
        return [(float(row["x0"]), float(row["y0"]), float(row["x1"]), float(row["y1"])) for row in rows]
    except (csv.Error, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: expected columns x0, y0, x1, y1 of numbers, found {error!r}") from error


def _coco_polygons(annotation: Any) -> list[NDArray[np.float64]]:
    """Polygons of one annotation; a window in several parts becomes several."""
    return [np.array(part, float).reshape(-1, 2) for part in annotation["segmentation"]]


def _short(stem: str) -> str:
    """A name without the marks that the annotation tool added."""
    return stem.split("_png_jpg.rf.", maxsplit=1)[0]


def _checked(index: NDArray[np.uint16], image: NDArray[np.uint8], path: Path) -> NDArray[np.uint16]:
    if index.shape != image.shape[:2]:
        (h, w), (ih, iw) = index.shape, image.shape[:2]
        raise InputError(f"{path}: the annotation has {w} x {h} pixels, its photo {iw} x {ih}")
    return index
