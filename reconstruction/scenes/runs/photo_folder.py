"""A folder of rendered photos with their truth: begun, gone on with after an interruption, and finished.

It is a data set as `reconstruction.dataset` writes it, with more layers (docs/reference). `scene.json` says which
photos are complete; a photo counts only from then on, when all of its files are there.

Photos are rendered by this process, by several side by side, or by the workers of a cluster.
"""

from __future__ import annotations

import json
import multiprocessing
import shutil
import signal
import statistics
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.base.errors import InputError, ReconstructionError
from planning.base.files import make_folder, read_input_file
from planning.base.jit import n_threads
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh, from_corners, join
from planning.geo.ray_casting import RayCaster
from planning.site.records import panel_triangles
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.records import start_points, transforms, write_records
from reconstruction.photos.decode import PICTURE_FILE, decoded
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import DISTORTION, EXPOSURE, GIMBAL_ERROR, MOTION_BLUR, POSITION_ERROR
from reconstruction.scenes.photos.camera_model import SHUTTERS_S, Capture, Moment, in_stops
from reconstruction.scenes.photos.lens_effects import metered_exposure
from reconstruction.scenes.photos.photo_layers import ARRAYS, BYTES_PER_PIXEL, PICTURES, layer_file
from reconstruction.scenes.photos.pose_errors import reported_poses
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.runs.photo_job import PATIENCE_S, PhotoJob, RenderWorker, checksums_of
from reconstruction.scenes.runs.run_record import captures_record, finished_photos, run_record, write_run

CORES_EACH = 4
"""The threads of a renderer share each photo: on 2 cores a second process took 27 % longer (12 photos of 1024 px)."""


_IN_THIS_PROCESS: list[RenderWorker] = []
"""The photographer of a process that does nothing else."""


def _begin_process(photographer: Callable[[], RenderWorker]) -> None:
    # Ctrl-C goes to all processes of a terminal; the first one decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _IN_THIS_PROCESS.append(photographer())


def _take(number: int, folder: Path) -> dict[str, str]:
    return checksums_of(folder, _IN_THIS_PROCESS[-1].render(number))


def render_on_cores(
    job: PhotoJob,
    folder: Path,
    exposure: float,
    numbers: Sequence[int],
    n_processes: int | None,
    monitor: Monitor,
    cluster: Any = None,
) -> Generator[tuple[int, dict[str, str]], None, None]:
    """Numbers of photos as they are done, with their files.

    Parameters
    ----------
    cluster
        Client of a Dask cluster whose workers take the photos, in place of processes.
    """
    if not numbers:
        return
    photographer = partial(RenderWorker, job, folder, exposure)
    n_processes = min(max(1, n_threads() // CORES_EACH) if n_processes is None else n_processes, len(numbers))
    if cluster is not None:
        # It needs Dask, which nobody else does.
        from reconstruction.scenes.runs.cluster_workers import render_on_cluster

        yield from render_on_cluster(cluster, photographer, job, folder, numbers, monitor)
    elif n_processes <= 1:
        alone = photographer()
        for done, number in enumerate(numbers, len(job.photos) - len(numbers)):
            monitor.report(say("rendering photos"), done, len(job.photos))
            yield number, checksums_of(folder, alone.render(number))
    else:
        yield from _side_by_side(photographer, job, folder, numbers, n_processes, monitor)


def _side_by_side(
    photographer: Callable[[], RenderWorker],
    job: PhotoJob,
    folder: Path,
    numbers: Sequence[int],
    n_processes: int,
    monitor: Monitor,
) -> Iterator[tuple[int, dict[str, str]]]:
    with _pool(photographer, folder, n_processes) as pool:
        # No more are handed out than are rendered, so that a cancelled run has little to wait for.
        running, left = list(numbers[:n_processes]), list(numbers[n_processes:])
        waiting: dict[Future[dict[str, str]], int] = {pool.submit(_take, number, folder): number for number in running}
        while waiting:
            monitor.report(say("rendering photos"), len(job.photos) - len(waiting) - len(left), len(job.photos))
            for future in wait(waiting, PATIENCE_S, FIRST_COMPLETED).done:
                if left:
                    following = left.pop(0)
                    waiting[pool.submit(_take, following, folder)] = following
                yield waiting.pop(future), future.result()


@contextmanager
def _pool(photographer: Callable[[], RenderWorker], folder: Path, n_processes: int) -> Iterator[ProcessPoolExecutor]:
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(n_processes, context, _begin_process, (photographer,))
    try:
        yield pool
    except BrokenProcessPool as error:
        raise ReconstructionError(
            say(
                "a process that rendered ended by itself, perhaps for want of memory; complete photos stay in "
                "{}: run it again with fewer processes (--jobs 1) or smaller pictures (--width)",
                folder,
            )
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


# How each photo of a flight is exposed, how its camera moves meanwhile, and what is told of its pose.

Array = NDArray[np.float64]

N_METERED, METERED_PX = 8, 64
"""Photos that the exposure of all is measured on, and how wide photos are rendered for measuring."""


def common_exposure(job: PhotoJob) -> float:
    """One for all photos, as pilots lock it: middle grey on average over some of them, rendered small."""
    renderer = Renderer(job.scene, job.settings)
    chosen = job.photos[:: -(-len(job.photos) // N_METERED)]
    return statistics.harmonic_mean([_metered(renderer, photo) for photo in chosen])


def captures_of(job: PhotoJob, common: float, monitor: Monitor = QUIET) -> tuple[Capture, ...]:
    """Photos of a job as they are taken, its effects decided and its moments given.

    Parameters
    ----------
    common
        As `common_exposure` gives it.
    """
    is_on, seed = job.settings.is_on, job.scene.seed
    reported = reported_poses(
        job.photos, job.moments, job.camera_model, seed, positions=is_on(POSITION_ERROR), angles=is_on(GIMBAL_ERROR)
    )
    factors = _own_exposures(job, common, monitor)
    captures = []
    for moment, one, factor in zip(job.moments, reported, factors.tolist(), strict=True):
        exposure_s = moment.exposure_s * factor
        way_m = np.array(moment.velocity_enu_m_s) * exposure_s * is_on(MOTION_BLUR)
        captures.append(Capture(one.pose, one.higher_m, way_m, factor, exposure_s))
    return tuple(captures)


def _own_exposures(job: PhotoJob, common: float, monitor: Monitor) -> Array:
    """Each photo's exposure against the common one, shape (n,): what the camera's shutters can do of it."""
    n = len(job.photos)
    if job.camera_model.exposure == "locked" or not job.settings.is_on(EXPOSURE):
        return np.ones(n)
    renderer, factors = Renderer(job.scene, job.settings), np.ones(n)
    for number, photo in enumerate(job.photos):
        monitor.report(say("metering"), number, n)
        factors[number] = _metered(renderer, photo) / common
    shutters_s = np.array([moment.exposure_s for moment in job.moments])
    low, high = SHUTTERS_S
    # What is longer or shorter already, as the user says, is not brought back into the range.
    shortest, longest = np.minimum(shutters_s, low), np.maximum(shutters_s, high)
    is_open = shutters_s > 0.0
    base = np.where(is_open, shutters_s, 1.0)
    clipped = np.clip(base * in_stops(factors), shortest, longest) / base
    return np.asarray(np.where(is_open, clipped, in_stops(factors)))


def _metered(renderer: Renderer, photo: PosedPhoto) -> float:
    lens = photo.intrinsics
    small = lens.scaled(METERED_PX, max(1, round(METERED_PX * lens.height_px / lens.width_px)))
    return metered_exposure(renderer.render(replace(photo, intrinsics=small)))


@dataclass(frozen=True, slots=True)
class ScenePhotos:
    """What was written; `n_kept` photos were complete before."""

    folder: Path
    photos: tuple[PosedPhoto, ...]
    decisions: tuple[Decision, ...]
    n_kept: int


def render_photo_folder(
    job: PhotoJob, folder: Path, n_processes: int | None = None, monitor: Monitor = QUIET, *, cluster: Any = None
) -> ScenePhotos:
    """Render the photos that the folder lacks, and write what belongs to all of them.

    Parameters
    ----------
    n_processes
        That render side by side; one for every four cores by default.
    cluster
        Client of a Dask cluster (`planning.base.parallel_map`) whose workers render instead.

    Raises
    ------
    InputError
        There are no photos, the folder holds something else or photos of another run, or it has no room.
    ReconstructionError
        A process ended before its photo was done; a cluster is gone, or cannot render one.
    OperationCancelled
        From `monitor`; photos that are complete stay, and the same call goes on with the others.
    """
    if not job.photos:
        raise InputError(say("there are no views to photograph; name a plan or flight that has some"))
    monitor.report(say("deciding on effects"), 0, 1)
    job = replace(job, moments=job.moments or (Moment(),) * len(job.photos))
    found = decide_effects(job.scene, job.photos, job.settings, job.camera_model, job.moments)
    decisions = tuple(found.values())
    if not found[DISTORTION].on:
        straight = tuple(replace(photo, intrinsics=photo.intrinsics.straight()) for photo in job.photos)
        job = replace(job, photos=straight)
    decided = replace(job, settings=job.settings.decided(decisions))
    run = run_record(job, decisions)
    files = finished_photos(folder, run)
    missing = [number for number, photo in enumerate(job.photos) if photo.name not in files]
    _check_room(folder, job.photos, len(missing))
    for name in ("images", *ARRAYS, *PICTURES):
        make_folder(folder / name)
    exposure = common_exposure(decided)
    decided = replace(decided, captures=captures_of(decided, exposure, monitor))
    run |= {"exposure": exposure, "captures": captures_record(decided)}
    write_run(folder, run, files)
    for name, content in job.companions.items():
        write_atomically(folder / name, content)
    n_kept = len(files)
    # Closed at once where the user cancels, so that no process goes on.
    with closing(render_on_cores(decided, folder, exposure, missing, n_processes, monitor, cluster)) as rendered:
        for number, written in rendered:
            files[job.photos[number].name] = written
            write_run(folder, run, files)
    _write_records(job, folder, decisions, monitor)
    write_run(folder, run, files, is_complete=True)
    return ScenePhotos(folder, job.photos, decisions, n_kept)


def _mesh(scene: Scene, layers: Sequence[Layer]) -> TriangleMesh:
    """Bodies of some layers, and all panes."""
    panes = from_corners(panel_triangles(scene.panes.corners_enu_m))
    return join([*(body.mesh for body in scene.bodies if body.layer in layers), panes])


def _check_room(folder: Path, photos: Sequence[PosedPhoto], n_missing: int) -> None:
    """Say before hours of work that the disk is too small for them."""
    lens = photos[0].intrinsics
    needed = BYTES_PER_PIXEL * lens.width_px * lens.height_px * n_missing
    there = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    free = shutil.disk_usage(there).free
    if needed > free:
        raise InputError(
            say(
                "{} photos with their truth take about {}, and {} are free there; make room, name a folder on "
                "another disk, or ask for smaller pictures (--width)",
                n_missing,
                _size_text(needed),
                _size_text(free),
                place=folder,
            )
        )


def _size_text(n_bytes: int) -> str:
    size, unit = next(((size, unit) for size, unit in ((1e9, "GB"), (1e6, "MB")) if n_bytes >= size), (1e3, "kB"))
    return f"{n_bytes / size:.1f} {unit}"


def _write_records(job: PhotoJob, folder: Path, decisions: Sequence[Decision], monitor: Monitor) -> None:
    """Cameras and points for those who train on the photos."""
    points = start_points(_mesh(job.scene, (Layer.BUILDING, Layer.NEAR)), job.n_points, job.scene.seed)
    everything = RayCaster(_mesh(job.scene, tuple(Layer)))
    for done, photo in enumerate(job.photos):
        monitor.report(say("colouring points"), done, len(job.photos))
        picture = decoded(read_input_file(photo.path, PICTURE_FILE), cv2.IMREAD_COLOR, str(photo.path))
        points.add(photo, np.asarray(picture, np.uint8), everything)
    monitor.report(say("writing cameras and points"), 0, 1)
    # What an earlier end of this run left; models are written into empty folders only.
    shutil.rmtree(folder / "sparse" / "0", ignore_errors=True)
    write_records(folder, job.photos, job.scene.site.site, points, decisions, 1)
    content = transforms(job.photos)
    for photo, frame in zip(job.photos, content["frames"], strict=True):
        for layer in (*ARRAYS, "glass"):
            frame[f"{layer}_path"] = layer_file(Path(), layer, photo.name).as_posix()
    write_atomically(folder / "transforms.json", json.dumps(content, indent=1).encode())
