"""Photos of a first flight to a coarse model: features, pairs, matches, a free model, its place, and what stands there.

The work with photos is COLMAP's (`reconstruction.colmap.pycolmap_run`). Features, matches and the free model are kept
in a folder, so that an interrupted run goes on, and another size of the walls takes seconds.
"""

from __future__ import annotations

import hashlib
import json
import math
import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision, EffectSetting, decide
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.findings import Finding, Severity
from planning.base.json_file import read_json, write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import PosedPhoto
from reconstruction.coarse.buildings import Buildings, about_ground, about_walls, make_buildings, moved
from reconstruction.coarse.cloud import (
    Cloud,
    Up,
    believed,
    cloud_of,
    extent_of,
    find_planes,
    in_ring,
    thinned,
    turn_upright,
    up_of_cameras,
    up_of_planes,
    upright_axes,
)
from reconstruction.coarse.ground_level import PICTURE_PX, level_of_ground
from reconstruction.coarse.inputs import CoarseInputs, Stated, read_inputs, says_height, start_of
from reconstruction.coarse.marks import agreeing_marks, factor_of_marks, is_in, meeting_place, scaled_marks
from reconstruction.coarse.pairs import PairHint, PairParameters, choose_pairs, likeness_of
from reconstruction.coarse.placing import (
    NO_CONTROL,
    Above,
    Control,
    Measured,
    Placed,
    about_height,
    about_positions,
    place_model,
)
from reconstruction.coarse.plane_sweep import PICTURE_PX as SWEPT_PX
from reconstruction.coarse.plane_sweep import DenseDepth, joined, swept
from reconstruction.coarse.walls import BuildingParameters, Ground, find_ground
from reconstruction.colmap.folder import Frame, write_frame, write_model
from reconstruction.colmap.georeference import Similarity, in_enu, posed_photos
from reconstruction.colmap.pycolmap_run import (
    LEAST_PHOTOS,
    ColmapRun,
    FoundLens,
    Pair,
    RefineParameters,
    StartPhoto,
    about_lens,
    as_model,
    do_not_fit,
    load_colmap,
    transform,
)
from reconstruction.colmap.receivers import Receiver, placed_by_receivers
from reconstruction.colmap.record import ColmapModel
from reconstruction.photos.decode import Scale, grey_picture
from reconstruction.photos.poses import DEFAULT_ACCURACY

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CoarseParameters:
    """How much work goes into a coarse model.

    Parameters
    ----------
    max_image_size_px
        Photos are reduced to this for features.
    max_features
        Of each photo.
    least_contrast
        Of a feature: less than is usual, since walls are what is looked for, and many are plain.
    find_lens
        Whether lenses are found against what is stated of them: `reconstruction.colmap.pycolmap_run.FoundLens`.
    """

    max_image_size_px: int = 1600
    max_features: int = 6000
    least_contrast: float = 0.003
    pairs: PairParameters = field(default_factory=PairParameters)
    seed: int = 0
    find_lens: EffectSetting = "auto"

    def __post_init__(self) -> None:
        for name in ("max_image_size_px", "max_features"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected at least 1, got {getattr(self, name)}")


@dataclass(frozen=True, slots=True, eq=False)
class CoarseModel:
    """What a folder of photos gave, in the site's frame: ENU, the ground at the building's foot at z = 0.

    Parameters
    ----------
    photos
        That found their place, with covariance.
    left_out
        Names of the others.
    is_origin_known
        Whether anything says where on earth this is.
    pairs
        Number of pairs that were matched, of how many there are.
    seconds
        Of each step, by its name.
    decision, lens_decision
        Whether walls without points were looked for in the photos; and calibrated lenses found anew.
    """

    photos: tuple[PosedPhoto, ...]
    left_out: tuple[str, ...]
    model: ColmapModel
    cloud: Cloud
    buildings: Buildings
    placed: Placed
    origin: Origin
    is_origin_known: bool
    reprojection_px: float
    pairs: tuple[int, int]
    seconds: dict[str, float]
    decision: Decision
    lens_decision: Decision
    findings: tuple[Finding, ...]


def build_coarse(
    folder: Path,
    photos: Sequence[PhotoMetadata],
    kept: Path,
    stated: Stated | None = None,
    parameters: CoarseParameters | None = None,
    monitor: Monitor = QUIET,
) -> CoarseModel:
    """Make a coarse model.

    Parameters
    ----------
    folder
        What the photos' names are paths below.
    kept
        Folder for what an interrupted run goes on with; made where it is not there.

    Raises
    ------
    InputError
        There are too few photos, pycolmap is not installed, or what is known of the photos does not fit.
    ReconstructionError
        The photos do not fit together.
    """
    stated, parameters = stated or Stated(), parameters or CoarseParameters()
    clock = _Clock()
    taken = read_inputs(folder, photos, stated, monitor)
    colmap = load_colmap()
    _prepare_folder(kept, folder, taken, parameters)
    run = _run(colmap, kept, folder, taken, parameters, monitor)
    fixed = run.find_features()
    clock.lap("features")
    pairs = _pairs(run, taken, parameters, monitor)
    run.match_pairs(pairs)
    clock.lap("matches")
    free = _mapped(run, fixed, pairs, colmap)
    clock.lap("model")
    scratch = kept / "scratch"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    placed, model, error_px, lens_decision, lately = _in_place(run, free, fixed, taken, stated, scratch, parameters)
    shutil.rmtree(scratch, ignore_errors=True)
    clock.lap("place")
    cloud = believed(cloud_of(model))
    forwards = np.array([image.cam_from_world[2] for image in model.images.values()])
    looked_at = cloud.of(in_ring(cloud.points, cloud.centres, forwards))
    if not len(looked_at):
        raise do_not_fit(len(taken.names))
    cell = float(np.clip(extent_of(looked_at.points) / 150.0, 0.05, 0.4))
    sizes = BuildingParameters(cell_m=cell, tolerance_m=max(0.04, 0.25 * cell), seed=parameters.seed)
    ground = _ground(model, taken, looked_at.points, cloud.points, cell, cell, monitor)
    buildings = make_buildings(looked_at, sizes, ground, monitor, cloud)
    clock.lap("buildings")
    decision = decide(DenseDepth(), buildings, stated.dense)
    if decision.on:
        buildings = _with_dense(model, taken, buildings, looked_at, cloud, sizes, monitor)
    clock.lap("dense depth")
    origin, shift = _origin(taken, stated, buildings, cloud)
    model = in_enu(model, Similarity(1.0, np.eye(3), shift))
    cloud = replace(cloud, points=cloud.points + shift, centres=cloud.centres + shift)
    buildings = moved(buildings, shift)
    posed = _posed(model, placed, folder, taken)
    left_out = tuple(name for name in taken.names if name not in {photo.name for photo in posed})
    known = taken.origin is not None or stated.origin is not None or bool(stated.control)
    findings = (*taken.findings, *lately, *placed.findings, *_left_out(left_out, len(taken.names)))
    findings += (*about_ground(buildings), *about_walls(buildings, forwards), *_about_place(known))
    findings += about_height(origin) if says_height(taken.metadata) else ()
    n = len(taken.names)
    return CoarseModel(
        posed,
        left_out,
        model,
        cloud,
        buildings,
        placed,
        origin,
        known,
        error_px,
        (len(pairs), n * (n - 1) // 2),
        clock.laps,
        decision,
        lens_decision,
        findings,
    )


class _Clock:
    """Seconds of steps, one after the other."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        """End a step."""
        now = time.perf_counter()
        self.laps[name] = now - self._last
        self._last = now


# Features, pairs, matches, and the free model.

SETTINGS, MAPPED = "settings.json", "mapped.json"


def _prepare_folder(kept: Path, folder: Path, taken: CoarseInputs, parameters: CoarseParameters) -> None:
    """Take away what is of other photos or other settings, and note which folder of photos it is of."""
    files = [
        (name, photo.path.stat().st_size, start_of(photo.path), repr(lens), *([start_of(mask)] if mask else []))
        for name, photo, lens, mask in zip(taken.names, taken.metadata, taken.lenses, taken.masks, strict=True)
    ]
    work = [parameters.max_image_size_px, parameters.max_features, parameters.least_contrast]
    settings = [*work, sorted(files)]
    digest = hashlib.sha256(json.dumps(settings).encode()).hexdigest()
    path = kept / SETTINGS
    written = read_json(path) if path.is_file() else None
    if not isinstance(written, dict) or written.get("sha256") != digest:
        shutil.rmtree(kept, ignore_errors=True)
    make_folder(kept)
    write_atomically(path, json.dumps({"sha256": digest, "photos": str(folder.resolve())}).encode())


def _run(
    colmap: Any, kept: Path, folder: Path, taken: CoarseInputs, parameters: CoarseParameters, monitor: Monitor
) -> ColmapRun:
    started = [
        StartPhoto(name, group, lens, one.position_enu_m, one.covariance, mask)
        for name, group, lens, one, mask in zip(
            taken.names, taken.groups, taken.lenses, taken.measured, taken.masks, strict=True
        )
    ]
    settings = RefineParameters(
        max_image_size_px=parameters.max_image_size_px,
        max_features=parameters.max_features,
        least_contrast=parameters.least_contrast,
        seed=parameters.seed,
        find_lens=parameters.find_lens,
    )
    return ColmapRun(colmap, kept, folder, started, settings, monitor)


def _pairs(run: ColmapRun, taken: CoarseInputs, parameters: CoarseParameters, monitor: Monitor) -> list[Pair]:
    hints = [
        PairHint(
            name,
            one.position_enu_m,
            None if one.cam_from_enu is None else np.array(one.cam_from_enu[2]),
            photo.taken_at,
        )
        for name, one, photo in zip(taken.names, taken.measured, taken.metadata, strict=True)
    ]
    likeness = None
    if len(hints) > parameters.pairs.all_up_to:
        monitor.report(say("comparing photos"), 0, 0)
        likeness = likeness_of(run.descriptors(), taken.names, parameters.seed)
    return choose_pairs(hints, likeness, parameters.pairs)


def _mapped(run: ColmapRun, fixed: set[int], pairs: Sequence[Pair], colmap: Any) -> Any | None:
    """The free model: made, or as it was kept of the same pairs; None where matches give none."""
    digest = hashlib.sha256(json.dumps([sorted(pairs), sorted(fixed)]).encode()).hexdigest()
    path, folder = run.own / MAPPED, run.own / "mapped"
    if path.is_file() and read_json(path) == {"sha256": digest}:
        return colmap.Reconstruction(folder)
    free = run.map(fixed)
    if free is None:
        return None
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    free.write_binary(folder)
    write_atomically(path, json.dumps({"sha256": digest}).encode())
    return free


# Where the model lies.


def _in_place(
    run: ColmapRun,
    free: Any | None,
    fixed: set[int],
    taken: CoarseInputs,
    stated: Stated,
    scratch: Path,
    parameters: CoarseParameters,
) -> tuple[Placed, ColmapModel, float, Decision, tuple[Finding, ...]]:
    """The model in the provisional frame, adjusted with the positions where they say enough; and its lens, or why."""
    if free is None:
        free = placed_by_receivers(run, ColmapModel(run.cameras(), {}), _receivers(taken), (), fixed, scratch)
        if free is None:
            raise do_not_fit(len(taken.names))
    model = as_model(free, scratch / "free")
    placed, findings = _place(model, taken, stated, parameters)
    transform(run.colmap, free, placed.enu_from_model)
    n_used = int(placed.is_used.sum())
    if placed.scale_from == "positions" and n_used >= LEAST_PHOTOS:
        run.adjust(free, fixed)
    model = as_model(free, scratch / "placed")
    placed, findings = _place(model, taken, stated, parameters)
    lately: tuple[Finding, ...] = ()
    decision = decide(FoundLens(), None)
    if placed.scale_from == "positions" and n_used >= LEAST_PHOTOS:
        if fixed:
            free, decision = run.choose_lenses(free, fixed, scratch / "lenses")
            lately = (about_lens(decision),)
            if decision.on:
                fixed, model = set(), as_model(free, scratch / "relensed")
                placed, findings = _place(model, taken, stated, parameters)
        lately += about_positions(placed, _measured_of(model, taken))
    model = in_enu(model, placed.enu_from_model)
    if placed.scale_from == "positions":
        used = {image.name for image, is_used in zip(model.images.values(), placed.is_used, strict=True) if is_used}
        added = placed_by_receivers(run, model, _receivers(taken), used, fixed, scratch / "receivers")
        if added is not None:
            free = added
            model = as_model(free, scratch / "added")
            placed, findings = _place(model, taken, stated, parameters)
            model = in_enu(model, placed.enu_from_model)
    return placed, model, float(free.compute_mean_reprojection_error()), decision, (*findings, *lately)


def _measured_of(model: ColmapModel, taken: CoarseInputs) -> list[Measured]:
    row_of = {name: row for row, name in enumerate(taken.names)}
    return [taken.measured[row_of[image.name]] for image in model.images.values()]


def _receivers(taken: CoarseInputs) -> dict[str, Receiver]:
    return {
        name: Receiver(one.position_enu_m, one.cam_from_enu, one.covariance)
        for name, one in zip(taken.names, taken.measured, strict=True)
        if one.position_enu_m is not None
    }


def _place(
    model: ColmapModel, taken: CoarseInputs, stated: Stated, parameters: CoarseParameters
) -> tuple[Placed, tuple[Finding, ...]]:
    images = list(model.images.values())
    row_of = {name: row for row, name in enumerate(taken.names)}
    rows = [row_of[image.name] for image in images]
    centres = np.array([image.centre_world for image in images])
    rotations = np.array([image.cam_from_world for image in images])
    measured = [taken.measured[row] for row in rows]
    cloud = believed(cloud_of(model))
    up = _up(rotations, [taken.metadata[row] for row in rows], measured, cloud, parameters)
    control, named, findings = _control(model, taken, stated, [image.name for image in images])
    n_known = max(len(control.points), sum(one.position_enu_m is not None for one in measured))
    looked = None if control.distances or n_known > 1 else taken
    above = _above_ground(model, looked, cloud, centres, rotations, up)
    placed = place_model(centres, rotations, measured, up, control, above, parameters.seed)
    off_m = np.linalg.norm(placed.control_residuals_m, axis=1)
    for number in np.flatnonzero(~placed.is_control_used).tolist():
        text = say(
            "control point '{}' is {:.2f} m from where the others put it; it is not used", named[number], off_m[number]
        )
        findings += (Finding(Severity.WARNING, "control-point-contradicts", text, "", float(off_m[number]), None, "m"),)
    if not math.isfinite(placed.sigma_north_deg) or placed.sigma_north_deg > 90.0:
        placed = replace(placed, enu_from_model=_first_ahead(placed.enu_from_model, rotations, images))
    return placed, findings


def _first_ahead(similarity: Similarity, rotations: Array, images: Sequence[Any]) -> Similarity:
    """Turned about the vertical so that the first photo looks north."""
    first = min(range(len(images)), key=lambda row: images[row].name)
    ahead = similarity.rotation @ rotations[first][2]
    angle = math.atan2(float(ahead[0]), float(ahead[1]))
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Similarity(similarity.scale, turn @ similarity.rotation, turn @ similarity.translation)


def _up(
    rotations: Array,
    photos: Sequence[PhotoMetadata],
    measured: Sequence[Measured],
    cloud: Cloud,
    parameters: CoarseParameters,
) -> Up:
    """By gimbals where they tell, else by cameras held level; then by walls and floors."""
    told = [
        rotation.T @ np.asarray(one.cam_from_enu)[:, 2]
        for rotation, one in zip(rotations, measured, strict=True)
        if one.cam_from_enu is not None
    ]
    if len(told) >= LEAST_PHOTOS:
        mean = np.median(told, axis=0)
        start = Up(mean / np.linalg.norm(mean), math.radians(DEFAULT_ACCURACY.tilt_deg))
    else:
        axes = [upright_axes(photo) for photo in photos]
        rights = np.array([rotation.T @ right for rotation, (right, _) in zip(rotations, axes, strict=True)])
        downs = np.array([rotation.T @ down for rotation, (_, down) in zip(rotations, axes, strict=True)])
        start = up_of_cameras(rights, downs)
    if len(cloud) < 30:
        return start
    size = extent_of(cloud.points)
    rows = thinned(cloud.points, size / 150.0)
    tolerance = max(size / 600.0, 2.0 * float(np.median(cloud.sigmas)))
    planes = find_planes(
        cloud.points[rows], cloud.towards[rows], tolerance, 12, max(20, len(rows) // 50), parameters.seed
    )
    return up_of_planes(start, planes)


LOOKS_DOWN_RAD = math.radians(20.0)
"""Below the horizon, from which on the usual camera is a drone's: people look ahead, or up."""


def _above_ground(
    model: ColmapModel, looked: CoarseInputs | None, cloud: Cloud, centres: Array, rotations: Array, up: Up
) -> Above | None:
    """The usual camera above the ground, or else above the lowest points; None where no point is below it.

    Only what is below the usual camera counts: a terrace, or a floor of a building, may be the widest level. Photos are
    looked at where they are given: where the size hangs on it.
    """
    if len(cloud) < 30:
        return None
    turn = turn_upright(up.direction)
    points = cloud.points @ turn.T
    cell = extent_of(points) / 100.0
    upright = in_enu(model, Similarity(1.0, turn, np.zeros(3)))
    usual_z = float(np.median((centres @ turn.T)[:, 2]))
    below = points[points[:, 2] < usual_z]
    if not len(below):
        return None
    ground = find_ground(below, cell) if looked is None else _ground(upright, looked, below, points, cell, 0.0)
    lowest = ground.z_m if ground.is_seen else float(np.percentile(below[:, 2], LOWEST_PERCENT))
    height, is_flown = usual_z - lowest, float(np.median(-rotations[:, 2] @ up.direction)) > math.sin(LOOKS_DOWN_RAD)
    return Above(height, is_flown, ground.is_seen) if height > 0.0 else None


LOWEST_PERCENT = 2.0
"""Of points below the cameras that may lie below the ground where it was not seen: mismatches."""


def _with_dense(
    model: ColmapModel,
    taken: CoarseInputs,
    buildings: Buildings,
    looked_at: Cloud,
    cloud: Cloud,
    sizes: BuildingParameters,
    monitor: Monitor,
) -> Buildings:
    """Buildings with what photos show of walls that have too few points; as they were where that says no more."""
    metadata = dict(zip(taken.names, taken.metadata, strict=True))
    by_name = {photo.name: photo for photo in posed_photos(model, Similarity.identity(), Path())}
    photos = [by_name[image.name] for image in model.images.values()]
    more = swept(
        photos, lambda photo: _small(metadata[photo.name], SWEPT_PX), buildings, cloud, 0.2 * sizes.cell_m, monitor
    )
    if not len(more):
        return buildings
    found = make_buildings(joined(looked_at, more), sizes, buildings.ground, monitor, joined(cloud, more))
    is_closed = not found.notes or bool(buildings.notes)
    return found if is_closed and _seen_share(found) > _seen_share(buildings) else buildings


def _seen_share(buildings: Buildings) -> float:
    area = sum(face.area_m2 for face in buildings.faces)
    return sum(face.area_m2 * face.seen_share for face in buildings.faces) / area if area > 0.0 else 0.0


def _ground(
    model: ColmapModel,
    taken: CoarseInputs,
    points: Array,
    all_points: Array,
    cell: float,
    tolerance: float,
    monitor: Monitor = QUIET,
) -> Ground:
    """The lowest wide level of points; or what photos show to be a level ground, where both differ by more."""
    found = find_ground(points, cell)
    metadata = dict(zip(taken.names, taken.metadata, strict=True))
    photos = posed_photos(model, Similarity.identity(), Path())
    level = level_of_ground(photos, lambda photo: _small(metadata[photo.name]), all_points, found.z_m, monitor=monitor)
    if level is None or abs(level - found.z_m) <= tolerance:
        return found
    return replace(found, z_m=level, slope_deg=0.0, gradient=(0.0, 0.0), is_seen=True)


def _small(photo: PhotoMetadata, least_px: int = PICTURE_PX) -> NDArray[np.uint8]:
    """Grey, of at least so many pixels, or whole."""
    longer = max(photo.width_px, photo.height_px)
    scales: tuple[Scale, ...] = (8, 4, 2, 1)
    return grey_picture(photo, next(scale for scale in scales if longer >= scale * least_px or scale == 1))


def _control(
    model: ColmapModel, taken: CoarseInputs, stated: Stated, names: Sequence[str]
) -> tuple[Control, tuple[str, ...], tuple[Finding, ...]]:
    """Control points and distances in the model: points by the rays of the photos that show them; their names."""
    row_of = {name: row for row, name in enumerate(names)}
    distances = []
    for one, other, metres in stated.distances:
        for name in (one, other):
            if name not in taken.names:
                raise InputError(say("distance: there is no photo '{}'; name it as it lies below the folder", name))
        if one in row_of and other in row_of:
            distances.append((row_of[one], row_of[other], metres))
    lenses = {photo.name: photo for photo in posed_photos(model, Similarity.identity(), Path())}
    marks = [
        [(lenses[name], x, y) for name, x, y in point.seen if name in lenses and is_in(lenses[name], x, y)]
        for point in stated.control
    ]
    points, places, used, findings = [], [], [], []
    factor = factor_of_marks(marks)
    if factor is not None:
        text = say(
            "the control points were marked in photos of another size: their pixels fit when multiplied by {:.3f}",
            factor,
        )
        findings.append(Finding(Severity.WARNING, "control-scaled", text, "", factor, None, ""))
    for point, own in zip(stated.control, marks, strict=True):
        seen = own if factor is None else scaled_marks(own, factor)
        if len(seen) < 2:
            text = say("control point '{}' is seen by fewer than two photos of the model; it is not used", point.name)
            findings.append(Finding(Severity.WARNING, "control-unseen", text))
            continue
        agreeing = agreeing_marks(seen)
        if len(agreeing) < len(seen):
            others = {photo.name for photo, _, _ in agreeing}
            wrong = ", ".join(photo.name for photo, _, _ in seen if photo.name not in others)
            text = (
                say(
                    "control point '{}' is elsewhere in {} than other photos show it; it is not used there",
                    point.name,
                    wrong,
                )
                if agreeing
                else say("control point '{}' is in different places in {}; it is not used", point.name, wrong)
            )
            findings.append(Finding(Severity.WARNING, "control-marks", text))
        if agreeing:
            points.append(meeting_place(agreeing))
            places.append((point.lat_deg, point.lon_deg, point.ellipsoid_height_m))
            used.append(point.name)
    if not points or taken.origin is None:
        return Control(NO_CONTROL.points, NO_CONTROL.points_enu_m, tuple(distances)), (), tuple(findings)
    enu = enu_from_geodetic(taken.origin, *np.array(places).T)
    return Control(np.array(points), enu, tuple(distances)), tuple(used), tuple(findings)


def _origin(taken: CoarseInputs, stated: Stated, buildings: Buildings, cloud: Cloud) -> tuple[Origin, Array]:
    """The site's origin, on the ground below the building's middle, and the shift from the provisional frame."""
    corners = buildings.mesh.vertices_enu_m
    flat = corners[:, :2] if len(corners) else cloud.points[:, :2]
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0)) if len(corners) else np.median(flat, axis=0)
    foot = np.array([middle[0], middle[1], buildings.ground.z_m])
    if taken.origin is not None:
        place = geodetic_from_enu(taken.origin, foot[None])
        lat, lon, height = (float(part[0]) for part in place)
        return Origin(round(lat, 9), round(lon, 9), round(height, 4)), -foot
    return stated.origin or Origin(0.0, 0.0, 0.0), -foot


def _posed(model: ColmapModel, placed: Placed, folder: Path, taken: CoarseInputs) -> tuple[PosedPhoto, ...]:
    """Photos with the covariance that all have in common."""
    times = {name: photo.taken_at for name, photo in zip(taken.names, taken.metadata, strict=True)}
    residuals = placed.residuals_m[placed.is_used]
    spread_m = float(np.sqrt((residuals**2).mean())) if len(residuals) else 0.0
    position_m = max(0.02, spread_m / math.sqrt(max(1, len(residuals))))
    covariance = np.diag([position_m**2] * 3 + [math.radians(0.1) ** 2] * 3)
    return tuple(
        replace(photo, pose=replace(photo.pose, covariance=covariance))
        for photo in posed_photos(model, Similarity.identity(), folder, times)
    )


# What is said of it.


def _left_out(names: Sequence[str], n_all: int) -> list[Finding]:
    if not names:
        return []
    text = say("{} of {} photos found no place in the model, the first {}", len(names), n_all, names[0])
    return [Finding(Severity.WARNING, "photos-left-out", text, "", float(len(names)), 0.0, "photos")]


def _about_place(is_known: bool) -> list[Finding]:
    if is_known:
        return []
    text = say("nothing says where on earth this is: give --origin before anything is flown")
    return [Finding(Severity.WARNING, "place-unknown", text)]


def write_sparse(folder: Path, coarse: CoarseModel) -> None:
    """Write the sparse model as text, with a file that says of which frame it is."""
    write_model(folder, coarse.model, "txt")
    covariance = coarse.photos[0].pose.covariance
    assert covariance is not None
    position_m, angle_rad = math.sqrt(covariance[0, 0]), math.sqrt(covariance[3, 3])
    write_frame(folder, Frame(position_m, math.degrees(angle_rad), coarse.origin))
