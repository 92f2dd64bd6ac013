"""A folder of rendered photos with their truth: begun, gone on with after an interruption, and finished.

It is a data set as `reconstruction.dataset` writes it, with more layers (docs/file-formats.md). `scene.json` says which
photos are complete; a photo counts only from then on, when all of its files are there.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import shutil
import signal
import statistics
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from planning.effects import Decision
from planning.errors import InputError, ReconstructionError
from planning.jit import n_threads
from planning.json_file import write_atomically
from planning.mesh import TriangleMesh, from_corners, join
from planning.progress import QUIET, Monitor
from planning.site import panel_triangles
from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.grow import grown_corners
from reconstruction.dataset.points import start_points
from reconstruction.dataset.records import transforms, write_records
from reconstruction.photos.write import photo_jpeg
from reconstruction.ray_casting import RayCaster
from reconstruction.scenes.effects import decide_effects
from reconstruction.scenes.lens_effects import developed, metered_exposure
from reconstruction.scenes.photo_layers import (
    ARRAYS,
    BYTES_PER_PIXEL,
    PICTURES,
    facade_mask,
    layer_contents,
    layer_file,
)
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.renderer import Renderer, RenderSettings
from reconstruction.scenes.run_record import kept_photos, run_record, write_run

DEFAULT_POINTS = 100_000
"""As many as `prepare` writes."""

CORES_EACH = 4
"""The threads of a renderer share each photo: on 2 cores a second process took 27 % longer (12 photos of 1024 px)."""

N_METERED, METERED_PX = 8, 64
"""Photos that the exposure is measured on, and how wide they are rendered for it."""

PATIENCE_S = 0.5
"""How often it is asked whether the user cancelled."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoJob:
    """Photos of a scene that are to be taken.

    Parameters
    ----------
    photos
        Of straight cameras; each `path` is in the folder's `images`.
    made_from
        What else to tell about where scene and views are from, as plain JSON values; a run that is gone on with must
        be made from the same.
    companions
        Content of other files that belong into the folder, by their names.
    n_points
        On the building and what is near, that reconstruction starts from.
    """

    scene: Scene
    photos: tuple[PosedPhoto, ...]
    settings: RenderSettings
    made_from: Mapping[str, Any]
    companions: Mapping[str, bytes] = field(default_factory=dict)
    n_points: int = DEFAULT_POINTS


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
    with closing(_rendered(decided, folder, exposure, missing, n_processes, monitor)) as rendered:
        for number, written in rendered:
            files[job.photos[number].name] = written
            write_run(folder, run, files)
    _write_records(job, folder, decisions, monitor)
    write_run(folder, run, files, is_complete=True)
    return ScenePhotos(folder, job.photos, decisions, n_kept)


class _Photographer:
    """Takes photos of a scene; made once in each process."""

    def __init__(self, job: PhotoJob, folder: Path, exposure: float) -> None:
        self._job, self._folder, self._exposure = job, folder, exposure
        self._renderer = Renderer(job.scene, job.settings)
        self._grown = grown_corners(job.scene.site.site.facades)

    def take(self, number: int) -> dict[str, str]:
        """Render a photo and write its files; returns their checksums by path in the folder."""
        job, photo = self._job, self._job.photos[number]
        seed = int(np.random.SeedSequence([job.scene.seed, number]).generate_state(1)[0])
        taken = self._renderer.render(photo, seed)
        site = job.scene.site.site
        assert photo.taken_at is not None
        jpeg = photo_jpeg(developed(taken, self._exposure), photo, site.origin, photo.taken_at, site.home_enu_m[2])
        contents = {photo.path: jpeg}
        mask = facade_mask(photo, self._grown, taken.depth_m)
        for layer, content in layer_contents(taken, mask).items():
            contents[layer_file(self._folder, layer, photo.name)] = content
        for path, content in contents.items():
            write_atomically(path, content)
        return {
            path.relative_to(self._folder).as_posix(): hashlib.sha256(content).hexdigest()
            for path, content in contents.items()
        }


_IN_THIS_PROCESS: list[_Photographer] = []
"""The photographer of a process that does nothing else."""


def _begin_process(job: PhotoJob, folder: Path, exposure: float) -> None:
    # Ctrl-C goes to all processes of a terminal; the first one decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _IN_THIS_PROCESS.append(_Photographer(job, folder, exposure))


def _take(number: int) -> dict[str, str]:
    return _IN_THIS_PROCESS[-1].take(number)


def _rendered(
    job: PhotoJob, folder: Path, exposure: float, numbers: Sequence[int], n_processes: int | None, monitor: Monitor
) -> Generator[tuple[int, dict[str, str]], None, None]:
    """Numbers of photos as they are done, with their files."""
    if not numbers:
        return
    n_processes = min(max(1, n_threads() // CORES_EACH) if n_processes is None else n_processes, len(numbers))
    if n_processes <= 1:
        photographer = _Photographer(job, folder, exposure)
        for done, number in enumerate(numbers, len(job.photos) - len(numbers)):
            monitor.report("rendering photos", done, len(job.photos))
            yield number, photographer.take(number)
        return
    with _pool(job, folder, exposure, n_processes) as pool:
        # No more are handed out than are rendered, so that a cancelled run has little to wait for.
        begun, left = list(numbers[:n_processes]), list(numbers[n_processes:])
        waiting: dict[Future[dict[str, str]], int] = {pool.submit(_take, number): number for number in begun}
        while waiting:
            monitor.report("rendering photos", len(job.photos) - len(waiting) - len(left), len(job.photos))
            for future in wait(waiting, PATIENCE_S, FIRST_COMPLETED).done:
                if left:
                    following = left.pop(0)
                    waiting[pool.submit(_take, following)] = following
                yield waiting.pop(future), future.result()


@contextmanager
def _pool(job: PhotoJob, folder: Path, exposure: float, n_processes: int) -> Iterator[ProcessPoolExecutor]:
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(n_processes, context, _begin_process, (job, folder, exposure))
    try:
        yield pool
    except BrokenProcessPool as error:
        raise ReconstructionError(
            f"a process that rendered ended by itself, perhaps for want of memory; complete photos stay in {folder}: "
            "run it again with fewer processes (--jobs 1) or smaller pictures (--width)"
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


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
