"""A data set folder to learn reflections from: its cameras, panels as planes, exposure, and the split of its views."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import expect_format, read_json, to_record
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.folder import model_within, read_model
from reconstruction.colmap.georeference import Similarity, posed_photos
from reconstruction.dataset.layers import unit_normals
from reconstruction.dataset.prepare import layer_path, mask_of
from reconstruction.dataset.records import DATASET_FORMAT, VALID
from reconstruction.photos.decode import PICTURE_FILE, decoded

Array = NDArray[np.float64]

SCENE_FILE = "scene.json"
"""Of rendered photos; says how they were exposed."""

LEAST_AREA_M2 = 1e-4
"""Of a panel; a site's are larger than that."""


@dataclass(frozen=True, slots=True, eq=False)
class PanelPlanes:
    """Panels as planes, and the box that places on them are rescaled by.

    The box is a cube, so that waves of the Fourier features are equally long along all axes: its middle is that of the
    smallest box around all corners, and its half side the largest half side of that one.

    Parameters
    ----------
    corners_enu_m
        Shape (m, 4, 3), counter-clockwise from outside, the lower left one first; m is 0 for plain splats, and the box
        one metre around zero then.
    """

    corners_enu_m: Array

    def __post_init__(self) -> None:
        shape = self.corners_enu_m.shape
        if len(shape) != 3 or shape[1:] != (4, 3):
            raise ValueError(f"corners_enu_m: expected shape (m, 4, 3), got {shape}")

    @property
    def normals_enu(self) -> Array:
        """Outward unit normals, shape (m, 3)."""
        return unit_normals(self.corners_enu_m)

    @property
    def middle_enu_m(self) -> Array:
        """Of the box, shape (3,)."""
        if not len(self.corners_enu_m):
            return np.zeros(3)
        places = self.corners_enu_m.reshape(-1, 3)
        return np.asarray(0.5 * (places.min(axis=0) + places.max(axis=0)))

    @property
    def half_side_m(self) -> float:
        """Of the box."""
        if not len(self.corners_enu_m):
            return 1.0
        return float(0.5 * np.ptp(self.corners_enu_m.reshape(-1, 3), axis=0).max())

    def rescaled(self, points_enu_m: Array) -> Array:
        """Places in the box as -1 to 1, shape kept."""
        return np.asarray((points_enu_m - self.middle_enu_m) / self.half_side_m)


@dataclass(frozen=True, slots=True, eq=False)
class PhotoSet:
    """A data set folder that was read, pictures and layers left on the disk.

    Parameters
    ----------
    photos
        In the order of their names.
    exposure
        Factor from the scene's light to the pictures' linear values; 1 where the folder does not say.
    own_exposures
        By name, further factors of photos that were exposed one by one.
    """

    folder: Path
    photos: tuple[PosedPhoto, ...]
    panels: PanelPlanes
    exposure: float
    own_exposures: Mapping[str, float]

    @property
    def has_panels(self) -> bool:
        """Whether it is of panels; one for plain splats is of none."""
        return len(self.panels.corners_enu_m) > 0

    def named(self, names: Collection[str]) -> tuple[PosedPhoto, ...]:
        """Those of its photos that are named."""
        return tuple(photo for photo in self.photos if photo.name in names)

    def picture(self, photo: PosedPhoto) -> NDArray[np.uint8]:
        """Red, green and blue, shape (h, w, 3); black where the photo's mask is.

        Raises
        ------
        InputError
            The file, or its mask, is missing, damaged, or of another size than its camera.
        """
        return rgb_picture(photo)

    def panel_numbers(self, photo: PosedPhoto) -> NDArray[np.int64]:
        """Shape (h, w): which panel each pixel shows, from 0; -1 for none.

        Raises
        ------
        InputError
            As for `picture`, or a number is that of no panel.
        """
        path = layer_path(self.folder, "panels", photo.name)
        numbers = _image(path, cv2.IMREAD_UNCHANGED, photo)
        if numbers.ndim != 2:
            raise InputError(say("expected one channel with panel numbers, found {}", numbers.shape[2], place=path))
        found = numbers.astype(np.int64) - 1
        n_panels = len(self.panels.corners_enu_m)
        if found.max(initial=-1) >= n_panels:
            raise InputError(
                say("has panel {}, and dataset.json {}; is it of another run?", found.max() + 1, n_panels, place=path)
            )
        return found


def check_finished(folder: Path) -> Path:
    """The description of a data set in its folder, which is written last.

    Raises
    ------
    InputError
        There is none: the folder is none of these, was not finished, or is a COLMAP model alone.
    """
    path = folder / "dataset.json"
    if not path.is_file():
        within = model_within(folder)
        if within is not None:
            raise InputError.say(
                "has no dataset.json, but a COLMAP model in {}; 'prepare PHOTOS --colmap MODEL' makes one of it, "
                "with a site and its panels or without",
                within,
                place=folder,
            )
        raise InputError(
            say("has no dataset.json; name a folder that `prepare` or `scene render` has finished", place=folder)
        )
    return path


def read_photo_set(folder: Path) -> PhotoSet:
    """Read the cameras, panels and exposure of a folder that `prepare` or `scene render` wrote.

    Cameras are those of the COLMAP model, distorted ones too; its world is the site's frame.

    Raises
    ------
    InputError
        The folder is none of these, or a file in it is damaged; the message names it.
    """
    path = check_finished(folder)
    content = read_json(path, names_files=True)
    expect_format(content, DATASET_FORMAT, path)
    description = to_record(content, _Description, path)
    if [panel.index for panel in description.panels] != list(range(1, len(description.panels) + 1)):
        raise InputError(say("panels: expected indices 1, 2, 3 and so on; was the file edited?", place=path))
    corners = np.array([panel.corners_enu_m for panel in description.panels], float).reshape(-1, 4, 3)
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)
    if areas.min(initial=np.inf) < LEAST_AREA_M2:
        raise InputError(
            say("panel {} has next to no area; correct the site and prepare again", areas.argmin() + 1, place=path)
        )
    model = read_model(folder / "sparse" / "0")
    photos = posed_photos(model, Similarity.identity(), folder / "images")
    if not photos:
        raise InputError(say("holds no images; name a folder with photos", place=folder / "sparse" / "0"))
    if any(photo.intrinsics.fisheye is not None for photo in photos):
        raise InputError(say("has photos of a fisheye; prepare it again, which makes them straight", place=folder))
    masks = [layer_path(folder, VALID, photo.name) for photo in photos]
    photos = tuple(
        replace(photo, mask=mask) if mask.is_file() else photo for photo, mask in zip(photos, masks, strict=True)
    )
    run = _run(folder)
    own = {name: capture.exposure for name, capture in run.captures.items()}
    return PhotoSet(folder, photos, PanelPlanes(corners), run.exposure, own)


@dataclass(frozen=True, slots=True)
class _Panel:
    index: int
    corners_enu_m: tuple[tuple[float, float, float], ...]

    def __post_init__(self) -> None:
        if len(self.corners_enu_m) != 4:
            raise ValueError(f"corners_enu_m: expected four corners, got {len(self.corners_enu_m)}")


@dataclass(frozen=True, slots=True)
class _Description:
    panels: tuple[_Panel, ...]


@dataclass(frozen=True, slots=True)
class _Capture:
    exposure: float = 1.0

    def __post_init__(self) -> None:
        if not self.exposure > 0.0:
            raise ValueError(f"exposure: expected more than 0, got {self.exposure}")


@dataclass(frozen=True, slots=True)
class _Run(_Capture):
    captures: dict[str, _Capture] = field(default_factory=dict)


def _run(folder: Path) -> _Run:
    path = folder / SCENE_FILE
    return to_record(read_json(path, names_files=True), _Run, path) if path.is_file() else _Run()


def held_out_names(names: Sequence[str], share: float, seed: int) -> tuple[str, ...]:
    """Names of the views that are kept for scoring, in order: those whose checksum with the seed is lowest.

    So the same names are held out of every folder of the same views.

    Parameters
    ----------
    share
        Of all views, above 0 and below 1; at least one is held out, and at least one is not.

    Raises
    ------
    InputError
        There are fewer than two views.
    """
    if not 0.0 < share < 1.0:
        raise ValueError(f"share: expected above 0 and below 1, got {share}")
    if len(names) < 2:
        raise InputError(say("expected at least two photos, one to learn from and one to score, got {}", len(names)))
    n_held = min(max(1, round(share * len(names))), len(names) - 1)
    ranked = sorted(names, key=lambda name: hashlib.sha256(f"{seed} {name}".encode()).digest())
    return tuple(sorted(ranked[:n_held]))


def rgb_picture(photo: PosedPhoto, flags: int = cv2.IMREAD_COLOR) -> NDArray[np.uint8]:
    """Red, green and blue of a photo as large as its camera, shape (h, w, 3); as `PhotoSet.picture`.

    Parameters
    ----------
    flags
        Of OpenCV, of a picture decoded at a part of its size, too; as it lies in the file.
    """
    bgr = _image(photo.path, flags | cv2.IMREAD_IGNORE_ORIENTATION, photo)
    rgb = np.ascontiguousarray(bgr[..., ::-1], np.uint8)
    if photo.mask is not None:  # nothing that is made of pictures depends on what lies there
        rgb[~mask_of(photo)] = 0
    return rgb


def _image(path: Path, flags: int, photo: PosedPhoto) -> NDArray[np.uint8] | NDArray[np.uint16]:
    lens = photo.intrinsics
    image = decoded(read_input_file(path, PICTURE_FILE), flags, str(path))
    if image.shape[:2] != (lens.height_px, lens.width_px):
        raise InputError(
            say(
                "expected {} x {} pixels as its camera has, got {} x {}",
                lens.width_px,
                lens.height_px,
                image.shape[1],
                image.shape[0],
                place=path,
            )
        )
    return image
