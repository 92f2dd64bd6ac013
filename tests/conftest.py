"""Fixtures for all tests."""

from __future__ import annotations

import gc
import itertools
import math
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Generator
from pathlib import Path

import hypothesis
import numpy as np
import pytest

# Threads of BLAS and OpenMP wait for one another in busy loops: beside other processes, which tests always have, small
# products of matrices and steps of a training took thirty times as long with two threads as with one.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

THOROUGH = hypothesis.settings(
    max_examples=100, deadline=None, derandomize=True, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.register_profile("thorough", THOROUGH)
# Most failures that a hundred examples find, the first twenty find; `make test-all` tries all.
MOST_EXAMPLES = 20
hypothesis.settings.register_profile("reflight", THOROUGH, max_examples=MOST_EXAMPLES)
hypothesis.settings.load_profile("reflight")

_STATUS = pytest.StashKey[int]()

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

MEMORY = Path("/dev/shm")
NEEDED_BYTES = 2**30
"""Free memory from which on the files of tests are kept there; 30 MB were the most seen at a time."""


def pytest_configure() -> None:
    """Keep the files of tests in memory where there is room: disks wait for each file that is written anew."""
    has_room = os.access(MEMORY, os.W_OK) and shutil.disk_usage(MEMORY).free >= NEEDED_BYTES
    if has_room and "TMPDIR" not in os.environ:
        os.environ["TMPDIR"] = tempfile.tempdir = str(MEMORY)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of our own."""
    parser.addoption("--shuffle", type=int, metavar="SEED", help="files, and tests in each, in random order")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Read the tests without looking for garbage meanwhile or later in what was read: a third of the time.

    Later, too, it is looked for less often than in programs that run for days.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 20, 10)
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Generator[None, None, None]:
    """Another order, the same in all processes: what a test leaves behind must be of no consequence for the next.

    Properties that ask for more examples than usual get them from `make test-all`, which alone tries all cases of tests
    that are marked with `few`.
    """
    for function in {getattr(item, "function", None) for item in items}:
        own = getattr(function, "_hypothesis_internal_use_settings", None)
        most = MOST_EXAMPLES if hypothesis.settings.default.max_examples == MOST_EXAMPLES else math.inf
        if own is not None and own.max_examples > most:
            function._hypothesis_internal_use_settings = hypothesis.settings(own, max_examples=MOST_EXAMPLES)
    for _, cases in itertools.groupby(items, lambda item: item.nodeid.partition("[")[0]):
        of_one = list(cases)
        marker = of_one[0].get_closest_marker("few")
        n = len(of_one) if marker is None else marker.args[0]
        for number in {*range(len(of_one))} - {round(each) for each in np.linspace(0, len(of_one) - 1, n)}:
            of_one[number].add_marker(pytest.mark.slow)
    yield
    seed = config.getoption("--shuffle")
    if seed is None:
        return
    chance = random.Random(seed)
    files = [list(group) for _, group in itertools.groupby(items, lambda item: item.path)]
    for file in files:
        chance.shuffle(file)
    chance.shuffle(files)
    items[:] = itertools.chain.from_iterable(files)


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Remember how it ended."""
    session.config.stash[_STATUS] = int(exitstatus)


def pytest_unconfigure(config: pytest.Config) -> None:
    """End at once after window tests: Qt's and VTK's objects that are left die in no order that suits them."""
    if "PySide6.QtWidgets" in sys.modules and _STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[_STATUS])


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of real input files beside the repository; tests that need it skip where it is absent."""
    if not SHARED_DATA.is_dir():
        pytest.skip("the folder of real input data (../shared/data) is not on this machine")
    return SHARED_DATA
