"""What a benchmark is, what it measures, and running it so that a failure is told and never hides the others."""

from __future__ import annotations

import os
import platform
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from planning.base.jit import n_threads

SHARED_DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

DATA_VARIABLE = "REFLIGHT_DATA"
"""Of the environment: further folders with real input data, as in a search path."""


class Skipped(Exception):  # noqa: N818  (the name says what happened)
    """The benchmark cannot run here; the message says what is missing."""


@dataclass(frozen=True, slots=True)
class Row:
    """One measured value.

    Parameters
    ----------
    scene
        What it was measured on.
    what
        What was measured.
    ratio, against
        Value as a multiple of another one, and which.
    target, met
        The target in words, and whether it was reached.
    seeds
        Number of seeds behind the value.
    """

    scene: str
    what: str
    value: float | str
    unit: str = ""
    ratio: float | None = None
    against: str = ""
    target: str = ""
    met: bool | None = None
    seeds: int = 1


@dataclass(frozen=True, slots=True)
class Context:
    """How to run: quickly or fully, where pictures go, and what is recorded already and need not be measured again."""

    is_quick: bool
    folder: Path
    recorded: tuple[Row, ...] = ()

    def data(self, path: str) -> Path:
        """A file or folder of the real input data.

        Raises
        ------
        Skipped
            It is not on this machine.
        """
        more = [Path(each) for each in os.environ.get(DATA_VARIABLE, "").split(os.pathsep) if each]
        for folder in (SHARED_DATA, *more):
            if (folder / path).exists():
                return folder / path
        raise Skipped(f"the real input data ({path}) is not on this machine")


@dataclass(frozen=True, slots=True)
class Benchmark:
    """One benchmark; `measure` yields rows as they come, so that those before a failure are kept."""

    name: str
    title: str
    about: str
    measure: Callable[[Context], Iterable[Row]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a benchmark."""

    name: str
    status: Literal["done", "failed", "skipped"]
    message: str
    rows: tuple[Row, ...]
    seconds: float
    is_quick: bool
    machine: str
    load: float


def run_benchmark(benchmark: Benchmark, context: Context) -> Outcome:
    """Run one benchmark; whatever it raises becomes part of the outcome."""
    rows: list[Row] = []
    started, load = time.perf_counter(), load_average()
    status: Literal["done", "failed", "skipped"] = "done"
    message = ""
    try:
        for row in benchmark.measure(context):
            rows.append(row)
            print(f"  {time.perf_counter() - started:6.1f} s  {_in_a_line(row)}", flush=True)  # noqa: T201
    except Skipped as reason:
        status, message = "skipped", str(reason)
    except Exception as error:
        status, message = "failed", f"{type(error).__name__}: {error}"
        traceback.print_exc()
    seconds = time.perf_counter() - started
    return Outcome(benchmark.name, status, message, tuple(rows), seconds, context.is_quick, machine(), load)


def _in_a_line(row: Row) -> str:
    value = row.value if isinstance(row.value, str) else f"{row.value:.6g}"
    target = "" if row.met is None else f"  (target {row.target}: {'met' if row.met else 'MISSED'})"
    return f"{row.scene}: {row.what} {value} {row.unit}{target}"


def machine() -> str:
    """Cores, processor, memory and Python; nothing that names the machine."""
    memory = f"{_memory_gib():.0f} GiB" if hasattr(os, "sysconf") else "memory not known"
    return f"{n_threads()} cores, {_processor()}, {memory}, {platform.system()}, Python {platform.python_version()}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "processor ?")


def _memory_gib() -> float:
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30


def load_average() -> float:
    """Processes that wanted to run in the last minute: how much the machine was shared; NaN where it is not known."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")


@contextmanager
def timer() -> Iterator[Callable[[], float]]:
    """Seconds since the start, as a function; after the block it keeps its last value."""
    started = time.perf_counter()
    ended: list[float] = []
    yield lambda: (ended[0] if ended else time.perf_counter()) - started
    ended.append(time.perf_counter())
