"""Sets of photos with truth: synthetic facades, annotated real ones, or a folder of the user's own."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, parse_xml, read_input_file
from planning.base.json_file import read_json
from planning.base.messages import say
from reconstruction.base.cameras import Intrinsics
from reconstruction.metrics.overlaps import MOST_PANELS, index_image
from reconstruction.metrics.pictures import pictures_in, read_labels, read_picture
from reconstruction.panels.rectify.surface import FacadeSurface, Rectification
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.panels.search.views import WholePicture
from reconstruction.panels.solving.adjustment import moved_pose
from reconstruction.scenes.facades.cases import Shape, case_name, photo_of, random_case
from reconstruction.scenes.facades.record import Case, SyntheticFacade
from reconstruction.scenes.facades.render import render_facade
from reconstruction.scenes.facades.scene import BASE_ABOVE_GROUND_M, BORDER_M

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

# Photos of real facades that people annotated: where they lie, and which pixels are which window.
#
# A *panel* of these sets is a window. They break what the search for panels assumes: between their windows there is
# wall, so not every cell of the grid is a window, and the lines around one window need not go on to the next.
#
# The sets and their licences: CMP facade base (Tylecek and Sara, 2013; research use), ECP (Teboul et al., 2010;
# research
# use), and night photos of offices (Hwang, 2023; CC BY 4.0), which are in perspective; the others are rectified.

ECP_WINDOW_BGR = (0, 0, 255)
"""Windows are red in ECP's masks."""

COCO_FILE = "_annotations.coco.json"

CMP_TABLE, CMP_WINDOW = ".windows.csv", "window"
CMP_FILE = FileLimit("annotations of the CMP facade base", 16 * MIB)
XML_DECLARATION = re.compile(rb"^\s*(?:\xef\xbb\xbf)?\s*<\?xml[^>]*\?>")

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
    """CMP facade base as it is published: `NAME.jpg` with its objects in `NAME.xml`.

    Where there is `NAME.windows.csv`, the windows' rectangles (x0, y0, x1, y1 in pixels) are taken from that. Pictures
    with labels, `NAME.png`, are not needed: in them windows that touch are one.

    Raises
    ------
    InputError
        The folder holds none, or a file is not as described.
    """
    tables = {path.name.removesuffix(CMP_TABLE): path for path in folder.glob(f"*{CMP_TABLE}")}
    found = {path.stem: path for path in folder.glob("*.xml")} | tables
    if not found:
        raise InputError(say("expected annotated photos ({}) in this folder, found none", "*.xml", place=folder))
    for name, path in sorted(found.items()):
        image = read_picture(path.with_name(f"{name}.jpg"))
        height, width = image.shape[:2]
        rectangles = _rectangles(path) if name in tables else _cmp_windows(path, width, height)
        boxes = [np.array([[a, b], [c, b], [c, d], [a, d]]) for a, b, c, d in rectangles]
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
            raise InputError(say("expected windows painted red (255, 0, 0), found none", place=path))
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
        raise InputError(say("expected annotations in COCO's form, found {}", repr(error), place=path)) from error
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
        raise InputError(say("expected annotated photos ({}) in this folder, found none", pattern, place=folder))
    return found


def _rectangles(path: Path) -> list[tuple[float, float, float, float]]:
    try:
        rows = list(csv.DictReader(read_input_file(path, TABLE_FILE).decode("utf-8").splitlines()))
        return [(float(row["x0"]), float(row["y0"]), float(row["x1"]), float(row["y1"])) for row in rows]
    except (csv.Error, ValueError, KeyError, TypeError) as error:
        raise InputError(
            say("expected columns x0, y0, x1, y1 of numbers, found {}", repr(error), place=path)
        ) from error


def _cmp_windows(path: Path, width: int, height: int) -> list[tuple[float, float, float, float]]:
    """Rectangles x0, y0, x1, y1, in whole pixels, of the windows in a published XML file.

    The file is a row of `object` elements without a root. In `points`, two `x` are shares of the photo's height and two
    `y` of its width, rounded to five digits: rows come first there.
    """
    content = read_input_file(path, CMP_FILE)
    try:
        root = parse_xml(b"<objects>" + XML_DECLARATION.sub(b"", content) + b"</objects>", path)
        objects = list(root.iter("object"))
        windows = [each for each in objects if each.findtext("labelname", "").strip() == CMP_WINDOW]
        if not objects:
            raise ValueError("no object")
        return [_cmp_rectangle(each, width, height) for each in windows]
    except ValueError as error:
        raise InputError(
            say(
                "expected objects with labelname and two x and y each, shares from 0 to 1, found: {}", error, place=path
            )
        ) from error


def _cmp_rectangle(element: Element, width: int, height: int) -> tuple[float, float, float, float]:
    rows, columns = ([float(each.text or "") for each in element.iterfind(f"points/{name}")] for name in ("x", "y"))
    if not len(rows) == len(columns) == 2 or not all(0.0 <= share <= 1.0 for share in (*rows, *columns)):
        raise ValueError(f"x {rows}, y {columns}")
    x, y = sorted(round(share * width) for share in columns), sorted(round(share * height) for share in rows)
    return float(x[0]), float(y[0]), float(x[1]), float(y[1])


def _coco_polygons(annotation: Any) -> list[NDArray[np.float64]]:
    """Polygons of one annotation; a window in several parts becomes several."""
    return [np.array(part, float).reshape(-1, 2) for part in annotation["segmentation"]]


def _short(stem: str) -> str:
    """A name without the marks that the annotation tool added."""
    return stem.split("_png_jpg.rf.", maxsplit=1)[0]


def _checked(index: NDArray[np.uint16], image: NDArray[np.uint8], path: Path) -> NDArray[np.uint16]:
    if index.shape != image.shape[:2]:
        (h, w), (ih, iw) = index.shape, image.shape[:2]
        raise InputError(say("the annotation has {} x {} pixels, its photo {} x {}", w, h, iw, ih, place=path))
    return index


Mask = NDArray[np.bool_]

SYNTHETIC_SETS: dict[str, Shape] = {"made-planar": "planar", "made-curved": "curved", "made-irregular": "irregular"}
EXTENT_MARGIN_M = 2.0
"""What a coarse model of a glass building may be wrong by at its edges."""

BESIDE_DEG = ((12.0, 3.0), (-12.0, 6.0), (20.0, -3.0), (-20.0, 9.0), (6.0, 12.0))
"""Directions that more photos of a facade are taken from: to the right of its normal, and from below."""

STATED_POSE = np.diag([0.03**2] * 3 + [np.radians(0.3) ** 2] * 3)
"""Covariance of the errors of their stated poses, position (m) and turn (rad)."""

SET_NAMES = (*SYNTHETIC_SETS, *READERS, "folder")


@dataclass(frozen=True, slots=True, eq=False)
class ScoredPhoto:
    """A photo with its truth.

    Parameters
    ----------
    image
        Shape (height, width, 3), uint8, blue, green, red.
    index
        Shape (height, width): number of the true panel, 0 for none.
    region
        Shape (height, width): everything that counts as glass; None: the panels.
    views
        Rectified views of its facades: from its pose and the surface it shows, or the photo itself where it is
        fronto-parallel; None where nothing is known.
    may_be_shown
        Whether the photo's licence lets it appear in pictures of results.
    beside
        More photos of the same facade, each with its view of what the photo itself shows.
    """

    name: str
    image: NDArray[np.uint8]
    index: NDArray[np.uint16]
    region: Mask | None = None
    views: tuple[Rectification, ...] | None = None
    may_be_shown: bool = True
    beside: tuple[tuple[NDArray[np.uint8], SurfaceView], ...] = ()


@dataclass(frozen=True, slots=True)
class PhotoSet:
    """Photos by name, made or read one after the other, each when it is asked for."""

    name: str
    photo_names: tuple[str, ...]
    photos: Callable[[], Iterator[ScoredPhoto]]

    @property
    def n_photos(self) -> int:
        """How many there are."""
        return len(self.photo_names)


def synthetic_set(
    name: str,
    n_seeds: int,
    intrinsics: Intrinsics | None = None,
    extent_margin_m: float | None = EXTENT_MARGIN_M,
    n_beside: int = 0,
    first_seed: int = 0,
) -> PhotoSet:
    """Synthetic facades with strong reflections, one of `SYNTHETIC_SETS`; see `scored`.

    There are `n_seeds` of them, from `first_seed` on.

    Parameters
    ----------
    n_beside
        More photos of each facade, from other places, with poses as good as RTK and a gimbal's angles are.
    """
    shape = SYNTHETIC_SETS[name]
    seeds = range(first_seed, first_seed + n_seeds)

    def photos() -> Iterator[ScoredPhoto]:
        for seed in seeds:
            case = random_case(shape, seed, intrinsics)
            photo = scored(render_facade(case), extent_margin_m)
            (view,) = photo.views or ()
            yield replace(photo, beside=tuple(_beside(case, view, number) for number in range(n_beside)))

    return PhotoSet(name, tuple(case_name(shape, seed) for seed in seeds), photos)


def scored(facade_photo: SyntheticFacade, extent_margin_m: float | None = EXTENT_MARGIN_M) -> ScoredPhoto:
    """A synthetic facade as a photo to score, with what its stated pose shows of the wall's surface as its view.

    Parameters
    ----------
    extent_margin_m
        The view ends so far beyond the wall with its masonry, which is what a coarse model tells; where in it the glass
        begins is not told. None: the extent is not known, and the view holds everything that the photo shows.
    """
    low = high = None
    if extent_margin_m is not None:
        beside, below = BORDER_M + extent_margin_m, BASE_ABOVE_GROUND_M + extent_margin_m
        low = np.array([facade_photo.columns_m[0] - beside, facade_photo.rows_m[0] - below])
        high = np.array([facade_photo.columns_m[-1] + beside, facade_photo.rows_m[-1] + beside])
    view = surface_view(facade_photo.photo, surface_of(facade_photo.case), low, high)
    return ScoredPhoto(facade_photo.photo.name, facade_photo.image, facade_photo.index, facade_photo.facade, (view,))


def _beside(case: Case, view: Rectification, number: int) -> tuple[NDArray[np.uint8], SurfaceView]:
    """Another photo of a synthetic facade and its view of the window that `view` shows."""
    if not isinstance(view, SurfaceView):
        raise TypeError(f"expected a view of a surface, got {type(view).__name__}")
    aside, above = BESIDE_DEG[number % len(BESIDE_DEG)]
    lens = case.truth.intrinsics
    camera = photo_of(case.wall, case.layout, lens, seed=case.seed, oblique_deg=aside, from_below_deg=above)
    neighbour = render_facade(replace(case, truth=camera))
    off = np.random.default_rng([case.seed, number]).multivariate_normal(np.zeros(6), STATED_POSE)
    stated = replace(moved_pose(camera.pose, off), covariance=STATED_POSE)
    return neighbour.image, replace(view, photo=replace(neighbour.photo, pose=stated))


def surface_of(case: Case) -> FacadeSurface:
    """The made wall as the rest of the program knows surfaces."""
    right, _, up = case.wall.wall_from_enu
    return FacadeSurface(np.array(case.wall.base_enu_m), right, up, case.wall.curvature_per_m)


def annotated_set(name: str, folder: Path) -> PhotoSet:
    """Annotated photos of real facades: `cmp`, `ecp` or `offices`.

    Parameters
    ----------
    folder
        That holds the set's own folder, or that folder itself.

    Raises
    ------
    InputError
        There are no such photos.
    """
    subfolder, reader = READERS[name]
    inner = folder / subfolder
    folder = inner if inner.is_dir() else folder
    names = tuple(photo.name for photo in reader(folder))

    def photos() -> Iterator[ScoredPhoto]:
        for photo in reader(folder):
            yield _as_scored(photo, name)

    return PhotoSet(name, names, photos)


def _as_scored(photo: AnnotatedPhoto, set_name: str) -> ScoredPhoto:
    views = whole_view(photo.image) if set_name in RECTIFIED_SETS else None
    return ScoredPhoto(photo.name, photo.image, photo.index, views=views, may_be_shown=set_name in SHOWABLE_SETS)


def whole_view(image: NDArray[np.uint8]) -> tuple[Rectification, ...]:
    """The one view of a photo that is fronto-parallel already."""
    height, width = image.shape[:2]
    return (WholePicture(width, height),)


def folder_set(images: Path, truth: Path, is_rectified: bool = False) -> PhotoSet:
    """The user's own photos, with index images of the same names: PNG, 8 or 16 bit, 0 for no panel.

    Parameters
    ----------
    is_rectified
        Whether the photos are fronto-parallel.

    Raises
    ------
    InputError
        A folder holds no pictures, or photos and index images do not belong together.
    """
    image_paths, truth_paths = pictures_in(images), pictures_in(truth)
    missing = [name for name in image_paths if name not in truth_paths]
    if missing:
        raise InputError(say("expected an index image for each photo; '{}' has none", missing[0], place=truth))

    def photos() -> Iterator[ScoredPhoto]:
        for name, path in image_paths.items():
            image, index = read_picture(path), read_labels(truth_paths[name])
            if index.ndim != 2:
                raise InputError(
                    say("expected one channel with panel numbers, found a colour image", place=truth_paths[name])
                )
            if index.shape != image.shape[:2]:
                (h, w), (ih, iw) = index.shape, image.shape[:2]
                raise InputError(
                    say("{} x {} pixels, but its photo has {} x {}", w, h, iw, ih, place=truth_paths[name])
                )
            if index.max(initial=0) > MOST_PANELS:
                raise InputError(
                    say("expected panel numbers up to {}, got {}", MOST_PANELS, index.max(), place=truth_paths[name])
                )
            views = whole_view(image) if is_rectified else None
            yield ScoredPhoto(name, image, np.asarray(index, np.uint16), views=views)

    return PhotoSet("folder", tuple(image_paths), photos)
