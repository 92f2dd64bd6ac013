"""A folder of rendered photos with their truth: begun, gone on with after an interruption, and finished.

It is a data set as `reconstruction.dataset` writes it, with more layers (docs/file-formats.md). `scene.json` says which
photos are complete; a photo counts only from then on, when all of its files are there.
"""

from __future__ import annotations

import json
import shutil
import statistics
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from planning.effects import Decision
from planning.errors import InputError
from planning.json_file import write_atomically
from planning.mesh import TriangleMesh, from_corners, join
from planning.progress import QUIET, Monitor
from planning.site import panel_triangles
from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.points import start_points
from reconstruction.dataset.records import transforms, write_records
from reconstruction.ray_casting import RayCaster
from reconstruction.scenes.effects import decide_effects
from reconstruction.scenes.lens_effects import metered_exposure
from reconstruction.scenes.photo_layers import (
    ARRAYS,
    BYTES_PER_PIXEL,
    PICTURES,
    layer_file,
)
from reconstruction.scenes.photographers import PhotoJob, photographed
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.renderer import Renderer
from reconstruction.scenes.run_record import kept_photos, run_record, write_run

N_METERED, METERED_PX = 8, 64
"""Photos that the exposure is measured on, and how wide they are rendered for it."""


@dataclass(frozen=True, slots=True)
class ScenePhotos:
    """What was written; `n_kept` photos were complete before."""

    folder: Path
    photos: tuple[PosedPhoto, ...]
    decisions: tuple[Decision, ...]
    n_kept: int


def photograph(job: PhotoJob, folder: Path, n_processes: int | None = None, monitor: Monitor = QUIET) -> ScenePhotos:
    """Render the photos that the folder lacks, and write what belongs to all of them.

    Parameters
    ----------
    n_processes
        That render side by side; one for every four cores by default.

    Raises
    ------
    InputError
        There are no photos, the folder holds something else or photos of another run, or it has no room.
    ReconstructionError
        A process ended before its photo was done.
    OperationCancelled
        From `monitor`; photos that are complete stay, and the same call goes on with the others.
    """
    if not job.photos:
        raise InputError("there are no views to photograph; name a plan or flight that has some")
    monitor.report("deciding on effects", 0, 1)
    decisions = tuple(decide_effects(job.scene, job.photos, job.settings).values())
    decided = replace(job, settings=job.settings.decided(decisions))
    run = run_record(job.scene, job.photos, job.settings, decisions, job.made_from)
    files = kept_photos(folder, run)
    missing = [number for number, photo in enumerate(job.photos) if photo.name not in files]
    _check_room(folder, job.photos, len(missing))
    _make_folders(folder)
    run["exposure"] = exposure = _exposure(decided)
    write_run(folder, run, files)
    for name, content in job.companions.items():
        write_atomically(folder / name, content)
    n_kept = len(files)
    # Closed at once where the user cancels, so that no process goes on.
    with closing(photographed(decided, folder, exposure, missing, n_processes, monitor)) as rendered:
        for number, written in rendered:
            files[job.photos[number].name] = written
            write_run(folder, run, files)
    _write_records(job, folder, decisions, monitor)
    write_run(folder, run, files, is_complete=True)
    return ScenePhotos(folder, job.photos, decisions, n_kept)


def _exposure(job: PhotoJob) -> float:
    """One for all photos, as pilots lock it: middle grey on average over some of them, rendered small."""
    renderer = Renderer(job.scene, job.settings)
    factors = []
    for photo in job.photos[:: -(-len(job.photos) // N_METERED)]:
        lens = photo.intrinsics
        small = lens.scaled(METERED_PX, max(1, round(METERED_PX * lens.height_px / lens.width_px)))
        factors.append(metered_exposure(renderer.render(replace(photo, intrinsics=small))))
    return statistics.harmonic_mean(factors)


def _mesh(scene: Scene, layers: Sequence[Layer]) -> TriangleMesh:
    """Bodies of some layers, and all panes."""
    panes = from_corners(panel_triangles(scene.panes.corners_enu_m))
    return join([*(body.mesh for body in scene.bodies if body.layer in layers), panes])


def _make_folders(folder: Path) -> None:
    try:
        for name in ("images", *ARRAYS, *PICTURES):
            (folder / name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror or error}); name another folder") from error


def _check_room(folder: Path, photos: Sequence[PosedPhoto], n_missing: int) -> None:
    """Say before hours of work that the disk is too small for them."""
    lens = photos[0].intrinsics
    needed = BYTES_PER_PIXEL * lens.width_px * lens.height_px * n_missing
    there = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    free = shutil.disk_usage(there).free
    if needed > free:
        raise InputError(
            f"{folder}: {n_missing} photos with their truth take about {needed / 1e9:.1f} GB, and {free / 1e9:.1f} GB "
            "are free there; make room, name a folder on another disk, or ask for smaller pictures (--width)"
        )


def _write_records(job: PhotoJob, folder: Path, decisions: Sequence[Decision], monitor: Monitor) -> None:
    """Cameras and points for those who train on the photos."""
    points = start_points(_mesh(job.scene, (Layer.BUILDING, Layer.NEAR)), job.n_points, job.scene.seed)
    everything = RayCaster(_mesh(job.scene, tuple(Layer)))
    for done, photo in enumerate(job.photos):
        monitor.report("colouring points", done, len(job.photos))
        points.add(photo, np.asarray(cv2.imread(str(photo.path), cv2.IMREAD_COLOR), np.uint8), everything)
    monitor.report("writing cameras and points", 0, 1)
    # What an earlier end of this run left; models are written into empty folders only.
    shutil.rmtree(folder / "sparse" / "0", ignore_errors=True)
    write_records(folder, job.photos, job.scene.site.site, points, decisions, 1)
    content = transforms(job.photos)
    for photo, frame in zip(job.photos, content["frames"], strict=True):
        for layer in (*ARRAYS, "glass"):
            frame[f"{layer}_path"] = layer_file(Path(), layer, photo.name).as_posix()
    write_atomically(folder / "transforms.json", json.dumps(content, indent=1).encode())
