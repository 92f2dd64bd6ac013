"""Photos of a scene rendered by the workers of a Dask cluster.

Each worker is given the scene once, also one that joins later, and renders one photo at a time; no more photos are
handed out than there are workers. Workers that see the folder write into it; of the others the content comes back, and
is written here. A photo whose worker dies is handed out again by Dask.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from distributed import KilledWorker, WorkerPlugin, get_worker, wait

import planning
import reconstruction
from planning.base.errors import GroundStationError, InputError, ReconstructionError
from planning.base.json_file import write_atomically
from planning.base.messages import about, say
from planning.base.progress import Monitor
from reconstruction.scenes.runs.photo_job import PATIENCE_S, PhotoJob, RenderWorker, checksums_of

TOKEN_FILE = ".reflight-cluster"
"""In the folder while a cluster works for it: a worker that reads the same content there sees the same folder."""

LIBRARIES = ("numpy", "numba", "open3d", "opencv-contrib-python-headless")
"""Whose version may change a photo's last bit."""

RenderedFiles = tuple[dict[str, str], Mapping[str, bytes]]
"""Checksums of the files that were written, and content of those that are still to be."""


@cache
def program_sha256() -> str:
    """Of all that makes a photo, hexadecimal: two that agree render the same."""
    digest = hashlib.sha256()
    for package in (planning, reconstruction):
        root = Path(package.__path__[0])
        for path in sorted(root.rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    for library in LIBRARIES:
        digest.update(importlib.metadata.version(library).encode())
    return digest.hexdigest()


class RenderPlugin(WorkerPlugin):  # type: ignore[misc]  # Dask is not typed
    """What a worker has of a run: how its photographer is made, and, from the first photo on, the photographer."""

    def __init__(self, make_worker: Callable[[], RenderWorker], folder: Path, token: bytes, program: str) -> None:
        self._make, self._folder, self._token, self._program = make_worker, folder, token, program

    def setup(self, worker: Any) -> None:
        """Begin; called by Dask in the worker."""
        self._place = worker.address
        self._worker: RenderWorker | None = None
        self._one_at_a_time, self._is_over = threading.Lock(), threading.Event()

    def teardown(self, worker: Any) -> None:
        """End: what is rendered from now on is for nobody."""
        self._is_over.set()

    def render(self, number: int) -> RenderedFiles:
        """Render a photo, and write its files where the folder is seen."""
        if program_sha256() != self._program:
            raise _another_program(self._place, None)
        # Threads of a renderer share each photo already; several photos at once would only take their memory.
        with self._one_at_a_time:
            if self._is_over.is_set():
                return {}, {}
            self._worker = self._worker or self._make()
            contents = self._worker.render(number)
            if self._is_over.is_set() or not self._has_folder():
                return {}, contents
            return checksums_of(self._folder, contents), {}

    def _has_folder(self) -> bool:
        """Whether it is the same folder here, and may be written into."""
        try:
            is_same = (self._folder / TOKEN_FILE).read_bytes() == self._token
            return is_same and os.access(self._folder / "images", os.W_OK)
        except OSError:
            return False


def _take(run: str, number: int) -> RenderedFiles:
    """In a worker."""
    worker = get_worker()
    plugin = worker.plugins.get(run)
    if not isinstance(plugin, RenderPlugin):
        raise ReconstructionError(say("the worker {} could not take the scene; see its own log", worker.address))
    return plugin.render(number)


def render_on_cluster(
    client: Any,
    make_worker: Callable[[], RenderWorker],
    job: PhotoJob,
    folder: Path,
    numbers: Sequence[int],
    monitor: Monitor,
) -> Iterator[tuple[int, dict[str, str]]]:
    """Numbers of photos as they are done, with their files; arguments as `render_on_cores` has them.

    Raises
    ------
    InputError
        A worker has another version of the program.
    ReconstructionError
        A photo cannot be rendered, or the cluster is gone.
    """
    n_all, left, waiting = len(job.photos), list(numbers), dict[Any, int]()
    with _in_words(folder), _installed_plugin(client, make_worker, folder.absolute(), monitor) as run:
        try:
            while left or waiting:
                rendered = [(future, waiting.pop(future)) for future in list(waiting) if future.done()]
                n_workers = len(client.nthreads())
                # Before any file is written here: workers need not wait for that.
                for number in left[: max(0, n_workers - len(waiting))]:
                    left.remove(number)
                    waiting[client.submit(_take, run, number, pure=False)] = number
                for future, number in rendered:
                    yield number, _files(future, job.photos[number].name, folder)
                stage = "rendering photos" if n_workers else "waiting for workers of the cluster"
                monitor.report(stage, n_all - len(left) - len(waiting), n_all)
                if not waiting:
                    time.sleep(0.0 if left and n_workers else PATIENCE_S)
                elif not rendered:
                    with suppress(TimeoutError):
                        wait(list(waiting), PATIENCE_S, "FIRST_COMPLETED")
        finally:
            client.cancel(list(waiting))


def _files(future: Any, name: str, folder: Path) -> dict[str, str]:
    """Checksums of a photo's files, which are written now where they are not yet."""
    if future.status != "error":
        sums, contents = future.result()
        return sums or checksums_of(folder, contents)
    error = future.exception()
    text: str = say("a worker could not render it: {}", repr(error))
    if isinstance(error, KilledWorker):
        text = say("{} workers ended while they rendered it, perhaps for want of memory", error.allowed_failures + 1)
    elif isinstance(error, GroundStationError):
        text = str(error)
    raise ReconstructionError(about(name, text)) from error


@contextmanager
def _installed_plugin(
    client: Any, make_worker: Callable[[], RenderWorker], folder: Path, monitor: Monitor
) -> Iterator[str]:
    """Name of a run that all workers know of."""
    for place, program in client.run(program_sha256, on_error="return").items():
        if program != program_sha256():
            raise _another_program(place, program)
    run, token = f"reflight-{secrets.token_hex(8)}", secrets.token_bytes(16)
    write_atomically(folder / TOKEN_FILE, token)
    try:
        monitor.report(say("giving the scene to the cluster"), 0, 1)
        client.register_plugin(RenderPlugin(make_worker, folder, token, program_sha256()), run)
        yield run
    finally:
        (folder / TOKEN_FILE).unlink(missing_ok=True)
        with suppress(ValueError):  # it was not there yet
            client.unregister_worker_plugin(run)


def _another_program(place: str, program: object) -> InputError:
    found = say("cannot run it ({})", program) if isinstance(program, Exception) else say("runs another version of it")
    return InputError.say(
        "scheduler and workers need the same program and libraries as here; {} {}: install it there", place, found
    )


@contextmanager
def _in_words(folder: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, CancelledError) as error:
        raise ReconstructionError(
            say(
                "the cluster does not answer any more ({}); complete photos stay in {}: run it again to go on",
                error,
                folder,
            )
        ) from error
