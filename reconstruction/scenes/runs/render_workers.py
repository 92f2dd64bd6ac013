"""Who renders the photos of a scene: this process, several side by side, or the workers of a cluster."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from planning.base.errors import ReconstructionError
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.scenes.runs.photo_job import PATIENCE_S, PhotoJob, RenderWorker, checksums_of

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
