"""Who renders the photos of a scene: this process, several side by side, or the workers of a cluster."""

from __future__ import annotations

import hashlib
import multiprocessing
import signal
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from planning.errors import ReconstructionError
from planning.jit import n_threads
from planning.json_file import write_atomically
from planning.progress import Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.grow import grown_corners
from reconstruction.photos.write import Circumstances, photo_jpeg
from reconstruction.scenes.lens_effects import developed
from reconstruction.scenes.mitsuba_renderer import renderer_of
from reconstruction.scenes.photo_layers import facade_mask, layer_contents, layer_file
from reconstruction.scenes.record import Scene
from reconstruction.scenes.renderer import RenderSettings
from reconstruction.scenes.taking import USUAL_TAKING, Capture, Moment, Taking

DEFAULT_POINTS = 100_000
"""As many as `prepare` writes."""

CORES_EACH = 4
"""The threads of a renderer share each photo: on 2 cores a second process took 27 % longer (12 photos of 1024 px)."""

PATIENCE_S = 0.5
"""How often it is asked whether the user cancelled."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoJob:
    """Photos of a scene that are to be taken.

    Parameters
    ----------
    photos
        Where the cameras really are; each `path` is in the folder's `images`.
    made_from
        What else to tell about where scene and views are from, as plain JSON values; a run that is gone on with must
        be made from the same.
    companions
        Content of other files that belong into the folder, by their names.
    n_points
        On the building and what is near, that reconstruction starts from.
    taking, moments
        How photos are taken, and how each came about; without moments, all are taken hovering, in one sortie.
    captures
        Of each photo, once effects are decided; without, it is taken hovering and tells its true pose.
    """

    scene: Scene
    photos: tuple[PosedPhoto, ...]
    settings: RenderSettings
    made_from: Mapping[str, Any]
    companions: Mapping[str, bytes] = field(default_factory=dict)
    n_points: int = DEFAULT_POINTS
    taking: Taking = USUAL_TAKING
    moments: tuple[Moment, ...] = ()
    captures: tuple[Capture, ...] = ()

    def __post_init__(self) -> None:
        for name in ("moments", "captures"):
            n = len(getattr(self, name))
            if n not in (0, len(self.photos)):
                raise ValueError(f"{name}: expected one for each of {len(self.photos)} photos, or none, got {n}")


class Photographer:
    """Takes photos of a scene; made once in each process."""

    def __init__(self, job: PhotoJob, folder: Path, exposure: float) -> None:
        self._job, self._folder, self._exposure = job, folder, exposure
        self._renderer = renderer_of(job.scene, job.settings)
        self._grown = grown_corners(job.scene.site.site.facades)
        self._moments = job.moments or (Moment(),) * len(job.photos)
        self._captures = job.captures or tuple(map(Capture.still, job.photos))

    def take(self, number: int) -> dict[str, bytes]:
        """Render a photo; returns the content of its files by path in the folder."""
        job, photo, capture = self._job, self._job.photos[number], self._captures[number]
        seed = int(np.random.SeedSequence([job.scene.seed, number]).generate_state(1)[0])
        taken = self._renderer.render(photo, seed, capture.moved_enu_m)
        site = job.scene.site.site
        assert photo.taken_at is not None
        picture = developed(taken, self._exposure * capture.exposure, job.taking.sensor)
        told, position = replace(photo, pose=capture.told), job.taking.position
        how = Circumstances(
            position.fix == "rtk", position.total_m, capture.exposure_s, self._moments[number].velocity_enu_m_s
        )
        home_up_m = site.home_enu_m[2] + capture.told_higher_m
        jpeg = photo_jpeg(picture, told, site.origin, photo.taken_at, home_up_m, how)
        contents = {photo.path: jpeg}
        mask = facade_mask(photo, self._grown, taken.depth_m)
        for layer, content in layer_contents(taken, mask).items():
            contents[layer_file(self._folder, layer, photo.name)] = content
        return {path.relative_to(self._folder).as_posix(): content for path, content in contents.items()}


def written(folder: Path, contents: Mapping[str, bytes]) -> dict[str, str]:
    """Checksums of a photo's files by path in the folder, where they are now."""
    for path, content in contents.items():
        write_atomically(folder / path, content)
    return {path: hashlib.sha256(content).hexdigest() for path, content in contents.items()}


_IN_THIS_PROCESS: list[Photographer] = []
"""The photographer of a process that does nothing else."""


def _begin_process(photographer: Callable[[], Photographer]) -> None:
    # Ctrl-C goes to all processes of a terminal; the first one decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _IN_THIS_PROCESS.append(photographer())


def _take(number: int, folder: Path) -> dict[str, str]:
    return written(folder, _IN_THIS_PROCESS[-1].take(number))


def photographed(
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
    photographer = partial(Photographer, job, folder, exposure)
    n_processes = min(max(1, n_threads() // CORES_EACH) if n_processes is None else n_processes, len(numbers))
    if cluster is not None:
        # It needs Dask, which nobody else does.
        from reconstruction.scenes.cluster_photographers import photographed_by

        yield from photographed_by(cluster, photographer, job, folder, numbers, monitor)
    elif n_processes <= 1:
        alone = photographer()
        for done, number in enumerate(numbers, len(job.photos) - len(numbers)):
            monitor.report("rendering photos", done, len(job.photos))
            yield number, written(folder, alone.take(number))
    else:
        yield from _side_by_side(photographer, job, folder, numbers, n_processes, monitor)


def _side_by_side(
    photographer: Callable[[], Photographer],
    job: PhotoJob,
    folder: Path,
    numbers: Sequence[int],
    n_processes: int,
    monitor: Monitor,
) -> Iterator[tuple[int, dict[str, str]]]:
    with _pool(photographer, folder, n_processes) as pool:
        # No more are handed out than are rendered, so that a cancelled run has little to wait for.
        begun, left = list(numbers[:n_processes]), list(numbers[n_processes:])
        waiting: dict[Future[dict[str, str]], int] = {pool.submit(_take, number, folder): number for number in begun}
        while waiting:
            monitor.report("rendering photos", len(job.photos) - len(waiting) - len(left), len(job.photos))
            for future in wait(waiting, PATIENCE_S, FIRST_COMPLETED).done:
                if left:
                    following = left.pop(0)
                    waiting[pool.submit(_take, following, folder)] = following
                yield waiting.pop(future), future.result()


@contextmanager
def _pool(photographer: Callable[[], Photographer], folder: Path, n_processes: int) -> Iterator[ProcessPoolExecutor]:
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(n_processes, context, _begin_process, (photographer,))
    try:
        yield pool
    except BrokenProcessPool as error:
        raise ReconstructionError(
            f"a process that rendered ended by itself, perhaps for want of memory; complete photos stay in {folder}: "
            "run it again with fewer processes (--jobs 1) or smaller pictures (--width)"
        ) from error
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
