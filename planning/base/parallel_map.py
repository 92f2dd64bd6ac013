"""Many independent runs: on all cores of this machine, or on a Dask cluster when an address is given."""

from __future__ import annotations

import gc
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from typing import Any, TypeVar

from planning.base.errors import InputError
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

# Dask clusters: how the program gets in touch with one.


@contextmanager
def cluster_client(address: str) -> Iterator[Any]:
    """A client of the Dask scheduler at `address`, such as `tcp://10.0.0.5:8786`; needs the extra `cluster`.

    Raises
    ------
    InputError
        The cluster does not answer, or the extra is not installed.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError.say(
            "a cluster ({}) needs Dask: pip install 'reflight-groundstation[cluster]'", address
        ) from error
    client = None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error)
    if client is None:
        # What is left of the client closes itself when it is collected, for which it takes a lock of Dask's: now, and
        # not at any time, when another client may hold that lock and both would wait forever.
        gc.collect()
        raise InputError.say("no Dask scheduler answers at {} ({})", address, reason)
    with client:
        yield client


Result = TypeVar("Result")


def sweep(
    function: Callable[..., Result],
    arguments: Sequence[tuple[Any, ...]],
    *,
    n_processes: int | None = None,
    address: str | None = None,
    monitor: Monitor = QUIET,
) -> list[Result]:
    """Results of `function(*a)` for each `a` in `arguments`, in that order.

    Parameters
    ----------
    function
        Importable from a module: processes are started afresh, never forked.
    n_processes
        Processes on this machine; one per core by default. 1 runs here, one after the other: for runs that measure
        time.
    address
        Scheduler of a Dask cluster, such as `tcp://10.0.0.5:8786`; needs the extra `cluster`.

    Raises
    ------
    InputError
        The cluster does not answer, or the extra is not installed.
    OperationCancelled
        From `monitor`; runs that have not begun are dropped.
    """
    if address is not None:
        return _on_cluster(function, arguments, address, monitor)
    n_processes = min(n_threads() if n_processes is None else n_processes, len(arguments))
    if n_processes <= 1:
        results = []
        for done, a in enumerate(arguments):
            monitor.report(say("running"), done, len(arguments))
            results.append(function(*a))
        return results
    with ProcessPoolExecutor(n_processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        futures: list[Future[Result]] = [pool.submit(function, *a) for a in arguments]
        try:
            for done, _ in enumerate(as_completed(futures)):
                monitor.report(say("running"), done + 1, len(arguments))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [future.result() for future in futures]


def _on_cluster(
    function: Callable[..., Result], arguments: Sequence[tuple[Any, ...]], address: str, monitor: Monitor
) -> list[Result]:
    with cluster_client(address) as client:
        # Only now is it known that Dask is there.
        from distributed import as_completed as completed

        futures = [client.submit(function, *a, pure=False) for a in arguments]
        for done, _ in enumerate(completed(futures)):
            monitor.report(say("running on the cluster"), done + 1, len(arguments))
        return [future.result() for future in futures]
