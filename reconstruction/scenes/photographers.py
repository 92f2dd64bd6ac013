"""Who renders the photos of a scene: this process, or several side by side."""

from __future__ import annotations

import hashlib
import multiprocessing
import signal
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from planning.errors import ReconstructionError
from planning.jit import n_threads
from planning.json_file import write_atomically
from planning.progress import Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.grow import grown_corners
from reconstruction.photos.write import photo_jpeg
from reconstruction.scenes.lens_effects import developed
from reconstruction.scenes.photo_layers import facade_mask, layer_contents, layer_file
from reconstruction.scenes.record import Scene
from reconstruction.scenes.renderer import Renderer, RenderSettings

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


class Photographer:
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


_IN_THIS_PROCESS: list[Photographer] = []
"""The photographer of a process that does nothing else."""


def _begin_process(job: PhotoJob, folder: Path, exposure: float) -> None:
    # Ctrl-C goes to all processes of a terminal; the first one decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _IN_THIS_PROCESS.append(Photographer(job, folder, exposure))


def _take(number: int) -> dict[str, str]:
    return _IN_THIS_PROCESS[-1].take(number)


def photographed(
    job: PhotoJob, folder: Path, exposure: float, numbers: Sequence[int], n_processes: int | None, monitor: Monitor
) -> Generator[tuple[int, dict[str, str]], None, None]:
    """Numbers of photos as they are done, with their files."""
    if not numbers:
        return
    n_processes = min(max(1, n_threads() // CORES_EACH) if n_processes is None else n_processes, len(numbers))
    if n_processes <= 1:
        photographer = Photographer(job, folder, exposure)
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
