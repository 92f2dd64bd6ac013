"""The complete data set of paper 3.3.1 from photos, panels and a coarse model, in a folder that others read, too.

images/, sparse/0 and points.ply are what COLMAP, gsplat and 2DGS start from; transforms.json is nerfstudio's; panels/,
masks/ and normals/ are ours (docs/reference/file-formats.md).
"""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InputError
from planning.base.files import is_empty, read_input_file
from planning.base.findings import Finding, Severity
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import join, write_mesh
from planning.geo.ray_casting import RayCaster
from planning.site.records import SiteModel, panel_corners
from reconstruction.base.cameras import STRAIGHT_HALF_DEG, Intrinsics, PosedPhoto
from reconstruction.colmap.georeference import Similarity
from reconstruction.dataset.layers import IN_FRONT_M, Scene, draw_layers, facing, normals_to_16_bit, straightened
from reconstruction.dataset.records import VALID, ColouredPoints, start_points, write_records
from reconstruction.dataset.refined_mesh import RefineParameters, grown_corners, refine_mesh
from reconstruction.photos.decode import (
    PICTURE_FILE,
    check_whole,
    decoded,
    is_named_rightly,
    mask_of_size,
)

Array = NDArray[np.float64]


RAY_S = 2.5e-7
"""Time per ray on two cores with a building of some ten thousand triangles."""

UNDISTORT_S_PER_MEGAPIXEL = 0.03
SAMPLED_PHOTOS = 60
GRID = 21


@dataclass(frozen=True, slots=True)
class LensDistortion:
    """Take the lens's distortion out of the photos; off, they are used as they are."""

    name: str = say("lens distortion")
    unit: str = "px"
    tolerance: float = 0.3

    def assess(self, scene: Sequence[PosedPhoto]) -> Assessment:
        """How far the distortion moves a pixel at most, of those that stay in the picture."""
        lenses = {photo.intrinsics for photo in scene}
        size = max((most_moved_px(lens) for lens in lenses), default=0.0)
        megapixels = sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in scene) / 1e6
        reason = say("the lens moves pixels by up to {:.1f} px", size) if size else say("the photos are straight")
        return Assessment(size, reason, UNDISTORT_S_PER_MEGAPIXEL * megapixels)


def most_moved_px(lens: Intrinsics) -> float:
    """Largest distance, in the picture, between where a direction is seen and where a straight lens would show it."""
    if lens.is_straight:
        return 0.0
    x, y = np.meshgrid(np.linspace(0.0, lens.width_px, GRID), np.linspace(0.0, lens.height_px, GRID))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    straight = lens.straight()
    off = straight.pixels(lens.rays(pixels)) - pixels
    if lens.fisheye is not None:
        stays = straight.is_seen(lens.rays(pixels))
        off = off[stays] - (straight.cx_px - lens.cx_px, straight.cy_px - lens.cy_px)
    return float(np.linalg.norm(off, axis=1).max(initial=0.0))


@dataclass(frozen=True, slots=True, eq=False)
class PanelsInPhotos:
    """What `HiddenPanels` looks at; `corners_enu_m` has shape (n, 4, 3)."""

    photos: Sequence[PosedPhoto]
    corners_enu_m: Array
    surroundings: RayCaster


@dataclass(frozen=True, slots=True)
class HiddenPanels:
    """Take panels, or parts of them, out of the index images where something stands in front of them."""

    name: str = "hidden panels"
    unit: str = "share of what is seen"
    tolerance: float = 0.001

    def assess(self, scene: PanelsInPhotos) -> Assessment:
        """Share of points on panels, in some of the photos, that are hidden by the model."""
        if not len(scene.corners_enu_m):
            return Assessment(0.0, say("the site has no panels"), 0.0)
        step = max(1, len(scene.photos) // SAMPLED_PHOTOS)
        hidden, seen, photos = 0, 0, 0
        for photo in scene.photos[::step]:
            points = _points(scene.corners_enu_m[facing(photo, scene.corners_enu_m)])
            points = points[photo.sees(points)]
            towards = points - photo.pose.position_enu_m
            distance = np.linalg.norm(towards, axis=1)
            hits = scene.surroundings.cast(
                np.broadcast_to(photo.pose.position_enu_m, points.shape), towards / np.maximum(distance, 1e-9)[:, None]
            )
            behind = int((hits.distance_m < distance - IN_FRONT_M).sum())
            hidden, seen, photos = hidden + behind, seen + len(points), photos + (behind > 0)
        size = hidden / seen if seen else 0.0
        pixels = sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in scene.photos)
        reason = (
            say("something stands in front of panels in {} of {} photos looked at", photos, len(scene.photos[::step]))
            if hidden
            else say("nothing stands between the photos and the panels")
        )
        return Assessment(size, reason, RAY_S * pixels)


def _points(corners: Array) -> Array:
    """Nine points on each panel, corners left out, shape (9 n, 3)."""
    places = np.stack(np.meshgrid([0.1, 0.5, 0.9], [0.1, 0.5, 0.9]), axis=-1).reshape(-1, 2)
    u, v = places[:, 0, None], places[:, 1, None]
    weights = np.concatenate([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    return np.asarray(np.einsum("pk,nkc->npc", weights, corners).reshape(-1, 3), float)


DATA_SET, UNFINISHED = "dataset.json", ".unfinished"
"""The file that is written last; and one that is there as long as others are missing."""

FOLDERS = ("images", "panels", "masks", "normals", "sparse/0")


@dataclass(frozen=True, slots=True)
class PrepareParameters:
    """How a data set is made.

    Parameters
    ----------
    normal_step
        Pixels per pixel of the normal maps, along each side; they take most of the time.
    n_points
        Points that reconstruction starts from, drawn evenly from the refined mesh.
    hidden_panels, lens_distortion
        As the scene calls for, always, or never.
    """

    normal_step: int = 2
    n_points: int = 100_000
    hidden_panels: EffectSetting = "auto"
    lens_distortion: EffectSetting = "auto"
    refine: RefineParameters = field(default_factory=RefineParameters)
    seed: int = 0

    def __post_init__(self) -> None:
        if self.normal_step < 1:
            raise ValueError(f"normal_step: expected at least 1, got {self.normal_step}")
        if self.n_points < 0:
            raise ValueError(f"n_points: expected 0 or more, got {self.n_points}")


@dataclass(frozen=True, slots=True)
class PreparedData:
    """What was written.

    Parameters
    ----------
    photos
        That are in the data set, with their straight cameras.
    findings
        Photos that were skipped, and why.
    """

    folder: Path
    photos: tuple[PosedPhoto, ...]
    decisions: tuple[Decision, ...]
    findings: tuple[Finding, ...]


def prepare(
    photos: Sequence[PosedPhoto],
    model: SiteModel,
    folder: Path,
    parameters: PrepareParameters | None = None,
    monitor: Monitor = QUIET,
    cloud: Array | None = None,
    enu_from_model: Similarity | None = None,
) -> PreparedData:
    """Write the data set of a site's photos.

    On a site without panels it is one for plain splats: masks have all of each photo.

    Parameters
    ----------
    model
        The site with its panels; its building mesh is the coarse model.
    cloud
        Points that are known beside the mesh, such as a COLMAP model's: splats start from them, too.
    enu_from_model
        What the photos' model was moved by, where nothing but it says what the frame is; the data set tells it.
    folder
        That does not exist yet, or is empty. What was written is taken away again if this fails or is cancelled.

    Raises
    ------
    InputError
        There are no photos, the folder is not empty or cannot be written, or none of the photos can be read.
    """
    parameters = parameters or PrepareParameters()
    if not photos:
        raise InputError(say("there are no photos with a pose to prepare"))
    if parameters.lens_distortion == "off" and any(photo.intrinsics.fisheye is not None for photo in photos):
        raise InputError(
            say("lens distortion is off, but there are photos of a fisheye, which can be learned from straight only")
        )
    is_new_folder = _empty(folder)
    try:
        prepared = _prepare(
            photos, model, panel_corners(model.site), folder, parameters, monitor, cloud, enu_from_model
        )
    except BaseException:
        _clear(folder)
        if is_new_folder:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    (folder / UNFINISHED).unlink(missing_ok=True)
    return prepared


def _prepare(
    photos: Sequence[PosedPhoto],
    model: SiteModel,
    corners: Array,
    folder: Path,
    parameters: PrepareParameters,
    monitor: Monitor,
    cloud: Array | None,
    enu_from_model: Similarity | None,
) -> PreparedData:
    refined = refine_mesh(model.building, corners, parameters.refine, monitor)
    surroundings = RayCaster(join([refined.mesh, *model.obstacles]))
    bent = decide(LensDistortion(), photos, parameters.lens_distortion)
    hidden = decide(HiddenPanels(), PanelsInPhotos(photos, corners, surroundings), parameters.hidden_panels)
    refined_caster = RayCaster(refined.mesh)
    scene = Scene(corners, grown_corners(model.site.facades), refined_caster, surroundings if hidden.on else None)
    points = start_points(refined.mesh, parameters.n_points, parameters.seed, cloud)
    if len(refined.mesh.triangles):
        write_mesh(folder / "refined.ply", refined.mesh)
    kept: list[PosedPhoto] = []
    findings: list[Finding] = []
    workers = max(1, n_threads())
    with ThreadPoolExecutor(workers) as pool:
        for start in range(0, len(photos), workers):
            monitor.report(say("preparing photos"), start, len(photos))
            part = photos[start : start + workers]
            for done in pool.map(
                lambda photo: _photo(photo, scene, points, refined_caster, folder, bent.on, parameters), part
            ):
                if isinstance(done, Finding):
                    findings.append(done)
                else:
                    kept.append(done)
    if not kept:
        raise InputError(say("none of the {} photos can be used; the first: {}", len(photos), findings[0].message))
    monitor.report(say("writing cameras and points"), 0, 1)
    write_records(folder, kept, model.site, points, (bent, hidden), parameters.normal_step, enu_from_model)
    return PreparedData(folder, tuple(kept), (bent, hidden), (*_cut_off(photos), *findings))


def _cut_off(photos: Sequence[PosedPhoto]) -> tuple[Finding, ...]:
    """That fisheyes show more than straight pictures are made of."""
    wide = [photo for photo in photos if is_cut_off(photo.intrinsics)]
    if not wide:
        return ()
    text = say(
        "{} of {} photos are of a fisheye that shows more than can be told straight: what lies farther than {:.0f} "
        "degrees from the optical axis along their rows or columns is left out",
        *(len(wide), len(photos), STRAIGHT_HALF_DEG),
    )
    return (Finding(Severity.NOTE, "fisheye-cut-off", text, "", float(len(wide)), 0.0, "photos"),)


def is_cut_off(lens: Intrinsics) -> bool:
    """Whether the middle of a side of a fisheye's picture is not in the straight one."""
    if lens.fisheye is None:
        return False
    width, height = lens.width_px, lens.height_px
    sides = np.array([(0.0, lens.cy_px), (width, lens.cy_px), (lens.cx_px, 0.0), (lens.cx_px, height)])
    return bool((lens.rays(sides)[:, 2] < math.cos(math.radians(STRAIGHT_HALF_DEG))).any())


def _photo(
    photo: PosedPhoto,
    scene: Scene,
    points: ColouredPoints,
    mesh: RayCaster,
    folder: Path,
    straighten: bool,
    parameters: PrepareParameters,
) -> PosedPhoto | Finding:
    """Write one photo's layers; a photo that cannot be read is a finding."""
    lens = photo.intrinsics
    try:
        stored = read_input_file(photo.path, PICTURE_FILE)
        check_whole(stored, str(photo.path))
        content = decoded(stored, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION, str(photo.path))
        is_turned = content.shape[:2] == (lens.width_px, lens.height_px) != (lens.height_px, lens.width_px)
        if is_turned:  # the camera is of the picture as programs show it, such as those that rotate before they match
            content = decoded(stored, cv2.IMREAD_COLOR, str(photo.path))
    except InputError:
        text = say("the picture is damaged, or cannot be decoded; it was left out")
        return Finding(Severity.WARNING, "photo-unreadable", text, photo.name)
    if content.shape[:2] != (lens.height_px, lens.width_px):
        found = f"{content.shape[1]} x {content.shape[0]}"
        text = say(
            "the picture has {} pixels, its camera {} x {}; it was left out", found, lens.width_px, lens.height_px
        )
        return Finding(Severity.WARNING, "photo-size", text, photo.name)
    try:
        valid = None if photo.mask is None else mask_of(photo)
    except InputError as error:
        text = say("its mask cannot be used ({}); it was left out", error)
        return Finding(Severity.WARNING, "photo-mask", text, photo.name)
    straight = replace(photo, intrinsics=lens.straight(), mask=None)
    is_changed = is_turned or not is_named_rightly(stored, photo.path)
    target = folder / "images" / photo.name
    target.parent.mkdir(parents=True, exist_ok=True)
    if straighten and not lens.is_straight:
        straight, content, valid = straightened(replace(photo, mask=None), content, valid)
        is_changed = True
    if is_changed:
        _write(target, content)
    else:
        _same_file(photo.path, target)
    layers = draw_layers(straight, scene, parameters.normal_step)
    panels, facade = layers.panels, layers.facade
    mask: Path | None = None
    if valid is not None and not valid.all():
        panels, facade = panels * valid, facade & valid
        mask = layer_path(folder, VALID, photo.name)
        _write(mask, valid.astype(np.uint8) * 255)
    _write(layer_path(folder, "panels", photo.name), panels)
    _write(layer_path(folder, "masks", photo.name), facade.astype(np.uint8) * 255)
    normals = normals_to_16_bit(layers.normals_enu)
    _write(layer_path(folder, "normals", photo.name), np.ascontiguousarray(normals[..., ::-1]))
    points.add(straight, content, mesh, valid)
    return replace(straight, path=target, mask=mask)


def mask_of(photo: PosedPhoto) -> NDArray[np.bool_]:
    """Which pixels of a photo count by its mask, of the size of its camera, shape (h, w): `mask_of_size`."""
    assert photo.mask is not None
    return mask_of_size(photo.mask, photo.intrinsics.width_px, photo.intrinsics.height_px)


def layer_path(folder: Path, layer: str, name: str) -> Path:
    """Of a photo's layer: its name with `.png` after it, so that a.jpg and a.png do not meet."""
    return folder / layer / f"{name}.png"


def _write(path: Path, image: NDArray[np.uint8] | NDArray[np.uint16]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    quality = (
        [cv2.IMWRITE_JPEG_QUALITY, 97] if path.suffix.lower() in (".jpg", ".jpeg") else [cv2.IMWRITE_PNG_COMPRESSION, 3]
    )
    coded, content = cv2.imencode(path.suffix, image, quality)
    if not coded:
        raise InputError(say("cannot be coded as {}", path.suffix, place=path))
    try:
        path.write_bytes(content.tobytes())
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error


def _same_file(source: Path, target: Path) -> None:
    """A hard link where the file system can, else a copy."""
    try:
        os.link(source, target)
    except OSError:
        try:
            shutil.copyfile(source, target)
        except OSError as error:
            raise InputError(say("cannot be written ({})", error.strerror or error, place=target)) from error


def _empty(folder: Path) -> bool:
    """Make the folder; whether it was not there before."""
    if (folder / UNFINISHED).is_file():
        if (folder / DATA_SET).exists():
            (folder / UNFINISHED).unlink()
        else:
            _clear(folder)
    if folder.exists() and (not folder.is_dir() or not is_empty(folder)):
        raise InputError(say("is not empty; name a new folder for the data set", place=folder))
    was_there = folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / UNFINISHED).touch()
        for name in FOLDERS:
            (folder / name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(say("cannot be made ({})", error.strerror or error, place=folder)) from error
    return not was_there


def _clear(folder: Path) -> None:
    """Remove what was written of a data set that did not come to its end."""
    names = {part.split("/")[0] for part in FOLDERS} | {VALID, "transforms.json", "refined.ply", "points.ply", DATA_SET}
    for path in [*(folder / name for name in sorted(names)), *folder.glob(".*.????????.part*"), folder / UNFINISHED]:
        _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
