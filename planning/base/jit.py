"""Compiled kernels: Numba with the options that every kernel here shares, and threads to run them on.

Kernels release the interpreter lock and are run on ordinary threads in chunks, because Numba's own parallel loops are
not safe to enter from two threads on every platform; jobs can then be cancelled between chunks, too. Compiled code is
kept on disk; `python -m planning.warm_up` compiles everything once, at set-up. Numba itself, 0.1 GB of memory, is
imported for the first call: a window on its start page does without.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, update_wrapper
from pathlib import Path
from threading import RLock
from types import CodeType
from typing import TYPE_CHECKING, Any, TypeVar, cast

from planning.base.progress import COMPILING, COMPILING_LOG

if TYPE_CHECKING:
    from numba.core.types import Type

F = TypeVar("F", bound=Callable[..., Any])
Result = TypeVar("Result")

LAYOUT = 3
"""Part of the version of compiled code on disk: raised where none of it may be read any more."""

OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
"""Of all kernels. None is called from C, and what would let it be takes its share of the compiling."""


def kernel(function: F) -> F:
    """Compile a numeric function; NaN and signed zeros behave as IEEE 754 says.

    A kernel that others call with constants is compiled once; Numba by itself would compile it once for each constant.
    """
    return cast("F", _Kernel(function, _njit))


def inline(function: F) -> F:
    """Compile a small helper into whatever kernel calls it."""
    return cast("F", _Kernel(function, _njit_inline))


class _Kernel:
    """A numeric function until it is wanted: then Numba's dispatcher of it, which this stands for.

    Numba looks up what a kernel calls in the kernel's own module, and knows dispatchers only. So those take the places
    of what stands for them there, before a kernel that calls them can be compiled.
    """

    _lock = RLock()

    def __init__(self, function: Callable[..., Any], dispatcher_of: Callable[[Callable[..., Any]], Any]) -> None:
        update_wrapper(self, function)
        self._function, self._dispatcher_of = function, dispatcher_of
        self._begun: Any = None
        self._dispatcher: Any = None

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return (self._dispatcher or self.dispatcher())(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.dispatcher(), name)

    def dispatcher(self) -> Any:
        """Numba's own, as are those of all kernels that it calls."""
        with self._lock:
            if self._begun is None:
                self._begun = self._dispatcher_of(self._function)
                known = self._function.__globals__
                for name in _names_in(self._function.__code__):
                    if isinstance(known.get(name), _Kernel):
                        known[name] = known[name].dispatcher()
                for cell in self._function.__closure__ or ():
                    if isinstance(cell.cell_contents, _Kernel):
                        cell.cell_contents = cell.cell_contents.dispatcher()
                self._dispatcher = self._begun
            return self._begun


def _names_in(code: CodeType) -> set[str]:
    """Names of what a function may look up in its module, also in the functions inside it."""
    inner = (_names_in(constant) for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*inner)


def _njit(function: Callable[..., Any]) -> Any:
    import numba  # not at the top: see above
    from numba.core.types.misc import unliteral

    compiled = _kept_on_disk(numba.njit(**OPTIONS)(function))
    template_of = compiled.get_call_template

    def get_call_template(arguments: Sequence[Type], named: Mapping[str, Type]) -> Any:
        return template_of(tuple(map(unliteral, arguments)), {name: unliteral(each) for name, each in named.items()})

    compiled.get_call_template = get_call_template
    return compiled


def _njit_inline(function: Callable[..., Any]) -> Any:
    import numba  # not at the top: see above

    return _kept_on_disk(numba.njit(**OPTIONS, inline="always")(function))


def _kept_on_disk(compiled: Any) -> Any:
    """Have compiled code on disk read where it can be, and compiled again where it cannot, which is told.

    It names the modules of its types: where one has moved since, Numba by itself raises an error.
    """
    load_overload, file = compiled._cache.load_overload, compiled._cache._cache_file
    file._version += f"-{LAYOUT}"
    load_index = file._load_index

    def load_what_can_be_read() -> Any:
        try:
            return load_index()
        except (ImportError, AttributeError):
            return {}

    def load_or_tell(*signature: Any) -> Any:
        found = load_overload(*signature)
        if found is None:
            _tell_compiling()
        return found

    file._load_index, compiled._cache.load_overload = load_what_can_be_read, load_or_tell
    return compiled


@cache
def _tell_compiling() -> None:
    """Once in a process."""
    COMPILING_LOG.info(COMPILING)


def is_compiled(compiled: Callable[..., Any]) -> bool:
    """Whether a kernel was compiled on this computer before, and is kept on disk."""
    place, name = Path(cast("Any", compiled).stats.cache_path), cast("Any", compiled).py_func.__qualname__
    return any(place.glob(f"*.{name}-*.nbi"))


def n_threads() -> int:
    """Number of cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        return os.cpu_count() or 1


def chunks(n: int, size: int) -> list[tuple[int, int]]:
    """Half-open ranges of at most `size` that make up `range(n)`."""
    return [(start, min(start + size, n)) for start in range(0, n, size)]


def run_parallel(work: Callable[..., Result], arguments: Iterable[tuple[Any, ...]]) -> list[Result]:
    """Results of `work(*a)` for all `a` in `arguments`, in order, on all cores.

    The result does not depend on the number of threads, as long as `work` does not.
    """
    arguments = list(arguments)
    if len(arguments) <= 1 or n_threads() == 1:
        return [work(*a) for a in arguments]
    with ThreadPoolExecutor(n_threads()) as pool:
        return list(pool.map(lambda a: work(*a), arguments))


def run_chunks(work: Callable[[int, int], Result], ranges: Iterable[tuple[int, int]]) -> list[Result]:
    """Results of `work(start, stop)` for all ranges; see `run_parallel`."""
    return run_parallel(work, ranges)
