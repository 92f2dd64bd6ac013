"""Dask clusters: how the program gets in touch with one."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from planning.errors import InputError


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
        raise InputError(f"a cluster ({address}) needs Dask: pip install 'reflight[cluster]'") from error
    client = None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error)
    if client is None:
        # What is left of the client closes itself when it is collected, for which it takes a lock of Dask's: now, and
        # not at any time, when another client may hold that lock and both would wait forever.
        gc.collect()
        raise InputError(f"no Dask scheduler answers at {address} ({reason})")
    with client:
        yield client
