"""Use case of the first flight: its photos alone become a coarse model, and a site to plan the second flight on."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.dataset import PreparedFiles, prepare_files
from groundstation.services.photos.poses import masks_of, poses_within
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.files import check_folder_name
from planning.base.findings import Finding, Severity
from planning.base.json_file import plain_values, read_json, write_atomically, write_together
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh, join, ply_bytes
from planning.photos.folder import SUFFIXES, read_photos
from planning.site.file import site_bytes
from planning.site.importing.importer import site_of_facades
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import LocalFrame, Placement
from planning.site.importing.source import SourceModel
from planning.site.records import NoFlyZone, Obstacle, Site, SiteModel
from reconstruction.coarse.build import SETTINGS, CoarseModel, CoarseParameters, build_coarse, write_sparse
from reconstruction.coarse.control_and_camera import read_control_points, read_lens
from reconstruction.coarse.inputs import Stated
from reconstruction.coarse.parameters import CoarseRequest
from reconstruction.coarse.placing import GUESSED, SizeUnknownError
from reconstruction.dataset.prepare import DATA_SET as FINISHED
from reconstruction.dataset.prepare import UNFINISHED
from reconstruction.light.photo_set import SCENE_FILE
from reconstruction.photos.lens import CameraKind

Array = NDArray[np.float64]

SITE_FILE, MESH_FILE, OBSTACLES_FILE, REPORT_FILE = "site.json", "coarse.ply", "obstacles.ply", "coarse.json"
SPARSE, KEPT, PHOTOS_FILE, DATA_SET = Path("sparse", "0"), ".coarse", "photos.json", "dataset"

REPORT_FORMAT = "reflight-coarse/1"

PLACE_UNKNOWN = "unknown"
"""Of a site that nobody has said the place of."""

REACH_M = 40.0
"""What stands further from the building than the airspace reaches is no obstacle."""

BESIDE_FLOWN_M = 2.0
"""That the airspace reaches beyond the places of the photos: positions and propellers."""

NOT_FLOWN_M = 10.0
"""From the places of the photos to a zone that nobody has seen: plans keep as much from zones by default."""

LEAST_ZONE_M2, ROUNDED_M = 4.0, 0.5
"""Of zones that nobody has seen: smaller ones are left out, and by how much their sides may be simpler."""


@dataclass(frozen=True, slots=True)
class UnsizedCoarse:
    """A coarse model whose size is a guess, or not known at all, of a folder of photos; and where it lies."""

    photos: Path
    out: Path


@dataclass(frozen=True, slots=True)
class CoarseFiles:
    """What was made, in numbers.

    Parameters
    ----------
    site
        The site file.
    report
        Content of the report.
    decision
        Whether walls without points were looked for in the photos.
    """

    site: Path
    report: dict[str, Any]
    decision: Decision
    findings: tuple[Finding, ...]

    @property
    def is_guessed(self) -> bool:
        """Whether its size is."""
        return self.report["scale_guessed_within_factor"] is not None


def coarse_files(request: CoarseRequest, monitor: Monitor = QUIET) -> CoarseFiles:
    """Make a coarse model of a folder of photos: `coarse.ply`, `site.json`, `sparse/0` and a report.

    What is finished is not done again: features, matches and the free model stay in a folder of the result.

    Raises
    ------
    InputError
        The photos, the camera or the control points cannot be used, or the result cannot be written.
    ReconstructionError
        The photos do not fit together.
    """
    check_folder_name(request.out)
    parameters = CoarseParameters(max_image_size_px=request.size_px, seed=request.seed, find_lens=request.find_lens)
    read = read_photos(request.photos, monitor)
    names = {photo.path.relative_to(request.photos).as_posix(): photo for photo in read.photos}
    sizes = {name: (photo.width_px, photo.height_px) for name, photo in names.items()}
    masks, about_masks = masks_of(tuple(names), request.photos)
    stated = Stated(
        None if request.camera is None else read_lens(request.camera, sizes),
        () if request.control is None else read_control_points(request.control, sizes),
        request.distances,
        request.origin,
        request.heights,
        None if request.lens is None else CameraKind(request.lens),
        request.dense,
        masks,
    )
    coarse = build_coarse(request.photos, read.photos, request.out / KEPT, stated, parameters, monitor)
    monitor.report(say("writing the coarse model"), 0, 0)
    findings = _write(request.out, coarse)
    taken_from = {"photos": str(request.photos.resolve())}
    write_atomically(request.out / KEPT / PHOTOS_FILE, json.dumps(taken_from).encode())
    report = coarse_report(coarse)
    findings = (*read.findings, *about_masks, *coarse.findings, *findings)
    write_atomically(request.out / REPORT_FILE, json.dumps(report, indent=1).encode())
    return CoarseFiles(request.out / SITE_FILE, report, coarse.decision, findings)


def coarse_files_in_process(
    request: CoarseRequest, *, stop: Stop = never, trace: Trace | None = None, monitor: Monitor = QUIET
) -> CoarseFiles:
    """As `coarse_files`, for a process of its own: COLMAP ends the process that it runs in when it fails badly."""
    del stop, trace
    return coarse_files(request, monitor)


def lacks_size(error: BaseException) -> bool:
    """Whether a coarse model was not made because nothing says how large it is."""
    return isinstance(error, SizeUnknownError)


def begun_coarse(photos: Path, beside: Path) -> Path | None:
    """The folder of a coarse model of these photos that was not finished, the newest beside another; None for none."""
    begun = list(beside.parent.glob(f"*/{KEPT}/{SETTINGS}"))
    for path in sorted(begun, key=lambda each: -each.stat().st_mtime):
        folder = path.parent.parent
        with suppress(InputError):
            written = read_json(path, names_files=True)
            is_of_these = isinstance(written, dict) and written.get("photos") == str(photos.resolve())
            if is_of_these and not (folder / REPORT_FILE).exists():
                return folder
    return None


def photo_names(photos: Path) -> tuple[str, ...]:
    """Of the photos of a folder, as distances between them name them."""
    paths = (path for path in photos.rglob("*") if path.suffix.lower() in SUFFIXES)
    return tuple(sorted(path.relative_to(photos).as_posix() for path in paths))


def _write(out: Path, coarse: CoarseModel) -> tuple[Finding, ...]:
    """Write site, meshes and the sparse model; findings about the airspace."""
    sparse = out / SPARSE
    for name in ("cameras", "images", "points3D"):
        (sparse / f"{name}.txt").unlink(missing_ok=True)
        (sparse / f"{name}.bin").unlink(missing_ok=True)
    write_sparse(sparse, coarse)
    model, meshes = site_of_coarse(coarse, out.resolve().name)
    centres = np.array([image.centre_world for image in coarse.model.images.values()])
    site, findings = where_flown(model.site, centres, model.building)
    write_together(
        {out / SITE_FILE: site_bytes(site), **{out / name: ply_bytes(mesh) for name, mesh in meshes.items()}}
    )
    return findings


def site_of_coarse(coarse: CoarseModel, name: str) -> tuple[SiteModel, dict[str, TriangleMesh]]:
    """The site of a coarse model, without panels, and its meshes by the names of their files."""
    buildings = coarse.buildings
    low, high = _bounds(buildings.mesh)
    near = [
        box_mesh(one, other)
        for one, other in buildings.others
        if (one[:2] < high + REACH_M).all() and (other[:2] > low - REACH_M).all() and (other > one).all()
    ]
    others = join(near) if near else empty_mesh()
    has_mesh = len(buildings.mesh.triangles) > 0
    mesh = buildings.mesh if has_mesh else _box_of_points(coarse)
    placement = Placement(coarse.origin, LocalFrame(coarse.origin), 0.0)
    source = SourceModel(name, (), mesh, others, placement)
    imported = site_of_facades(Path(name), source, (), ImportOptions(name=name)).model
    site = replace(imported.site, building_mesh=MESH_FILE if has_mesh else None, is_bare=not has_mesh)
    meshes = {MESH_FILE: buildings.mesh}
    if near:
        site = replace(site, obstacles=(Obstacle("standing-beside", mesh=OBSTACLES_FILE),))
        meshes[OBSTACLES_FILE] = others
    if not coarse.is_origin_known or coarse.placed.scale_from in GUESSED:
        site = replace(site, place_from=PLACE_UNKNOWN)
    return SiteModel(site, buildings.mesh, (others,) if near else ()), meshes


def where_flown(site: Site, centres_enu_m: Array, mesh: TriangleMesh) -> tuple[Site, tuple[Finding, ...]]:
    """A site whose airspace ends where the first flight did: what stood behind its cameras is in no photo.

    Parameters
    ----------
    centres_enu_m
        Of the photos, shape (n, 3).
    mesh
        Of the building.
    """
    import shapely

    air = site.airspace
    if np.median(centres_enu_m[:, 2]) < air.lowest_height_m():
        text = say("the photos were taken from the ground: what stands behind their cameras is not known, look around")
        return site, (Finding(Severity.WARNING, "airspace-not-seen", text, "", 0.0, None, ""),)
    hull = shapely.MultiPoint(np.vstack([centres_enu_m[:, :2], mesh.vertices_enu_m[:, :2]])).convex_hull
    whole = shapely.box(*air.min_enu_m[:2], *air.max_enu_m[:2])
    west, south, east, north = np.round(whole.intersection(hull.buffer(BESIDE_FLOWN_M)).bounds, 1).tolist()
    beyond = shapely.box(west, south, east, north).difference(hull.buffer(NOT_FLOWN_M, quad_segs=2))
    parts = [part.simplify(ROUNDED_M) for part in shapely.get_parts(beyond) if part.area > LEAST_ZONE_M2]
    zones = tuple(
        NoFlyZone(f"not-seen-{number}", _corners(part), air.ground_z_m - REACH_M, air.max_enu_m[2] + REACH_M)
        for number, part in enumerate(parts, start=1)
    )
    low, high = (west, south, air.min_enu_m[2]), (east, north, air.max_enu_m[2])
    home = site.home_enu_m
    if not shapely.covers(hull, shapely.Point(home[:2])):
        away = shapely.distance(shapely.MultiPoint(mesh.vertices_enu_m[:, :2]), shapely.points(centres_enu_m[:, :2]))
        place = centres_enu_m[int(np.argmax(away))]
        home = (round(float(place[0]), 1), round(float(place[1]), 1), home[2])
    text = say(
        "the airspace is {:.0f} m by {:.0f} m, as far as the photos were taken: what stands behind their cameras is "
        "not known; widen it where you have looked",
        east - west,
        north - south,
    )
    found = Finding(Severity.NOTE, "airspace-as-flown", text, "", float(len(zones)), None, "")
    air = replace(air, min_enu_m=low, max_enu_m=high, no_fly=(*air.no_fly, *zones))
    return replace(site, airspace=air, home_enu_m=home), (found,)


def _corners(polygon: Any) -> tuple[tuple[float, float], ...]:
    import shapely

    return tuple((round(x, 2), round(y, 2)) for x, y in shapely.get_coordinates(polygon.exterior)[:-1].tolist())


def _bounds(mesh: TriangleMesh) -> tuple[Array, Array]:
    if not len(mesh.vertices_enu_m):
        return np.zeros(2), np.zeros(2)
    flat = mesh.vertices_enu_m[:, :2]
    return flat.min(axis=0), flat.max(axis=0)


def _box_of_points(coarse: CoarseModel) -> TriangleMesh:
    """What an airspace is put around where no wall was found."""
    low, high = np.percentile(coarse.cloud.points, (5.0, 95.0), axis=0)
    return box_mesh(low, np.maximum(high, low + 1.0))


def coarse_report(coarse: CoarseModel) -> dict[str, Any]:
    """What was registered, residuals, holes and guesses; for `--json` and for the file beside the model."""
    placed, buildings = coarse.placed, coarse.buildings
    used = placed.residuals_m[placed.is_used]
    lengths = np.linalg.norm(used, axis=1)
    control = np.linalg.norm(placed.control_residuals_m, axis=1)
    faces = buildings.faces
    area = sum(face.area_m2 for face in faces)
    return {
        "format": REPORT_FORMAT,
        "photos": len(coarse.photos) + len(coarse.left_out),
        "registered": len(coarse.photos),
        "left_out": list(coarse.left_out),
        "points": len(coarse.model.points),
        "seconds": round(sum(coarse.seconds.values()), 3),
        "steps_s": {name: round(value, 3) for name, value in coarse.seconds.items()},
        "dense_depth": {
            "is_on": coarse.decision.on,
            "decided_by": coarse.decision.decided_by,
            "walls_without_points_percent": round(coarse.decision.size, 2),
        },
        "effects": plain_values((coarse.decision, coarse.lens_decision)),
        "pairs": coarse.pairs[0],
        "of_pairs": coarse.pairs[1],
        "reprojection_px": round(coarse.reprojection_px, 4),
        "scale_from": placed.scale_from,
        "scale_sigma": _finite(placed.sigma_scale),
        "scale_guessed_within_factor": placed.guessed_factor,
        "tilt_sigma_deg": _finite(placed.sigma_tilt_deg),
        "north_sigma_deg": _finite(placed.sigma_north_deg),
        "position_residual_m": {"median": _finite(np.median(lengths)), "largest": _finite(lengths.max())}
        if len(lengths)
        else None,
        "control_residual_m": {"median": _finite(np.median(control)), "largest": _finite(control.max())}
        if len(control)
        else None,
        "origin": {
            "lat_deg": coarse.origin.lat_deg,
            "lon_deg": coarse.origin.lon_deg,
            "ellipsoid_height_m": coarse.origin.ellipsoid_height_m,
            "is_known": coarse.is_origin_known,
        },
        "ground": {
            "is_seen": buildings.ground.is_seen,
            "slope_deg": round(buildings.ground.slope_deg, 3),
        },
        "walls": [
            {
                "length_m": round(wall.length_m, 3),
                "bottom_m": round(wall.bottom_m, 3),
                "top_m": round(wall.top_m, 3),
                "rms_m": round(wall.rms_m, 4),
                "seen_share": round(wall.seen_share, 4),
                "points": wall.n_points,
            }
            for wall in buildings.walls
        ],
        "roofs": len(buildings.roofs),
        "sides": [
            {
                "ends_enu_m": [[round(value, 3) for value in end] for end in face.ends_m],
                "top_m": round(face.top_m, 3),
                "seen_share": round(face.seen_share, 4),
                "is_guessed": face.wall is None,
            }
            for face in faces
        ],
        "walls_m2": round(area, 2),
        "holes_m2": round(sum(face.area_m2 * (1.0 - face.seen_share) for face in faces if face.wall is not None), 2),
        "guessed_m2": round(sum(face.area_m2 for face in faces if face.wall is None), 2),
    }


def _finite(value: float) -> float | None:
    return round(float(value), 4) if np.isfinite(value) else None


def data_set_of(folder: Path, monitor: Monitor = QUIET, found: list[Finding] | None = None) -> Path:
    """The data set folder that stands for a folder: itself, or what is prepared for plain splats.

    That is of a coarse model in its folder, and of photos with a model of another program beside theirs.

    Parameters
    ----------
    found
        Findings about photos that were prepared are put there.

    Raises
    ------
    InputError
        It is a coarse model, or one of another program, whose photos cannot be found or prepared.
    """
    if (folder / REPORT_FILE).is_file():
        out = folder / DATA_SET
        if not (out / FINISHED).is_file():
            _tell(prepare_coarse(folder, out, monitor), found)
        return out
    is_ours = any((folder / name).exists() for name in (FINISHED, UNFINISHED, SCENE_FILE))
    if is_ours or poses_within(folder) is None:
        return folder
    whole = folder.absolute()
    out = whole.with_name(f"{whole.name}.dataset")
    if not (out / FINISHED).is_file():
        _tell(prepare_files(folder, None, out, monitor=monitor), found)
    return out


def _tell(prepared: PreparedFiles, found: list[Finding] | None) -> None:
    if found is not None:
        found.extend(prepared.findings)


def prepare_coarse(folder: Path, out: Path, monitor: Monitor = QUIET) -> PreparedFiles:
    """Write the data set of a coarse model, of the photos that it was made of."""
    return prepare_files(photos_of(folder), folder / SITE_FILE, out, colmap=folder / SPARSE, monitor=monitor)


def photos_of(folder: Path) -> Path:
    """The folder of photos that a coarse model was made of.

    Raises
    ------
    InputError
        It is not there any more.
    """
    named = Path(str(read_json(folder / KEPT / PHOTOS_FILE).get("photos", "")))
    if not named.is_dir():
        raise InputError(say("the photos of this coarse model were in {}, which is not there", named, place=folder))
    return named
