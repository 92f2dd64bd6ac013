"""Kernels on threads: everything once, in order, errors passed on, several callers at a time."""

from __future__ import annotations

import importlib
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base import jit
from planning.base.jit import chunks, inline, is_compiled, kernel, n_threads, run_chunks, run_parallel
from planning.base.progress import COMPILING, hear_compiling


@given(n=st.integers(0, 200), size=st.integers(1, 50))
def test_chunks_make_up_the_range_in_order_and_none_is_larger_than_asked(n: int, size: int) -> None:
    ranges = chunks(n, size)
    assert [i for start, stop in ranges for i in range(start, stop)] == list(range(n))
    assert all(0 < stop - start <= size for start, stop in ranges)


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_results_come_in_order_whatever_the_number_of_threads(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planning.base.jit.n_threads", lambda: threads)
    assert run_chunks(lambda start, stop: (start, stop), chunks(23, 5)) == chunks(23, 5)
    assert run_parallel(pow, [(2, 3), (3, 2)]) == [8, 9]
    assert run_parallel(pow, []) == []


def test_work_is_done_on_several_threads_where_there_are_several_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planning.base.jit.n_threads", lambda: 2)
    both = threading.Barrier(2, timeout=240.0)
    assert run_parallel(lambda _: both.wait() >= 0, [(0,), (1,)]) == [True, True]


def test_one_piece_of_work_stays_on_the_caller_s_thread() -> None:
    assert run_parallel(lambda _: threading.get_ident(), [(0,)]) == [threading.get_ident()]


def test_errors_reach_the_caller() -> None:
    with pytest.raises(ZeroDivisionError):
        run_chunks(lambda start, stop: 1 / start, [(0, 1), (1, 2), (2, 3)])


def test_cores_are_counted_as_far_as_this_process_may_use_them(monkeypatch: pytest.MonkeyPatch) -> None:
    assert n_threads() >= 1
    monkeypatch.delattr("os.sched_getaffinity", raising=False)
    monkeypatch.setattr("os.cpu_count", lambda: None)
    assert n_threads() == 1


@inline
def _half(x: float) -> float:
    return x / 2.0


@kernel
def _halves_summed(values: np.ndarray) -> float:
    total = 0.0
    for value in values:
        total += _half(value)
    return total


@kernel
def _ratio(a: float, b: float) -> float:
    return a / b


def test_kernels_divide_by_zero_and_treat_nan_as_ieee_754_says() -> None:
    assert _ratio(1.0, 0.0) == np.inf
    assert _ratio(1.0, -0.0) == -np.inf
    assert np.isnan(_ratio(0.0, 0.0))
    assert np.isnan(_halves_summed(np.array([1.0, np.nan])))


def test_kernels_run_from_several_threads_at_once() -> None:
    arrays = [np.full(10_000, float(i)) for i in range(16)]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(_halves_summed, arrays)) == [5000.0 * i for i in range(16)]


def test_kernels_agree_with_their_python_source() -> None:
    values = np.random.default_rng(0).normal(size=100)
    assert _halves_summed(values) == pytest.approx(_halves_summed.py_func(values))  # type: ignore[attr-defined]


@kernel
def _one(x: float) -> float:
    return _half(x + x) / x


@kernel
def _counted(n: int) -> float:
    def last(x: float) -> float:
        return _half(x)

    return last(2.0) if n <= 1 else _one(3.0) + _counted(n - 1)


def test_kernels_call_each_other_and_themselves_though_none_of_them_was_called_before() -> None:
    assert _counted(4) == 4.0
    assert _one(5.0) == 1.0


@kernel
def _power(x: float, n: int) -> float:
    return x**n


@kernel
def _powers_summed(x: float) -> float:
    return _power(x, 2) + _power(x, n=3) + _power(x, 2 + int(x))


def test_a_kernel_is_compiled_once_whatever_constants_others_call_it_with() -> None:
    assert _powers_summed(2.0) == 28.0
    _powers_summed.recompile()  # type: ignore[attr-defined]  # what came from the disk called nothing here
    assert len(_power.signatures) == 1  # type: ignore[attr-defined]


def test_it_is_known_which_kernels_are_kept_on_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "doubling.py").write_text("def doubled(x):\n    return 2 * x\n\n\ndef tripled(x):\n    return 3 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    import doubling  # type: ignore[import-not-found]

    doubled, tripled = kernel(doubling.doubled), kernel(doubling.tripled)
    assert not is_compiled(doubled)
    assert doubled(4) == 8
    assert is_compiled(doubled)
    assert not is_compiled(tripled)


def test_compiling_is_told_once_in_a_process_and_to_those_only_who_still_listen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "adding.py").write_text("".join(f"def add_{n}(x):\n    return x + {n}\n\n\n" for n in range(4)))
    monkeypatch.syspath_prepend(tmp_path)
    import adding  # type: ignore[import-not-found]

    told: list[str] = []
    end = hear_compiling(told.append)
    jit._tell_compiling.cache_clear()
    assert kernel(adding.add_1)(1) == 2
    assert told == [COMPILING]
    assert kernel(adding.add_2)(1) == 3
    assert told == [COMPILING]
    jit._tell_compiling.cache_clear()
    assert kernel(adding.add_1)(1) == 2
    assert told == [COMPILING], "it is kept on disk"
    end()
    assert kernel(adding.add_3)(1) == 4
    assert told == [COMPILING]


@pytest.mark.parametrize("moved", ["its module is gone", "its name is gone"])
def test_what_was_compiled_with_a_type_that_has_moved_is_compiled_again(tmp_path, monkeypatch, moved):
    # Compiled code names the modules of its types: where one has moved, its list cannot even be opened.
    monkeypatch.syspath_prepend(tmp_path)
    pair = "from typing import NamedTuple\nclass Pair(NamedTuple):\n    a: float\n    b: float\n"
    (tmp_path / "pair_here.py").write_text(pair)
    (tmp_path / "pair_there.py").write_text(pair)
    (tmp_path / "summing_pairs.py").write_text("def total(pair):\n    return pair.a + pair.b\n")
    for name in ("pair_here", "pair_there", "summing_pairs"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    importlib.invalidate_caches()
    pair_here, pair_there, summing_pairs = map(importlib.import_module, ("pair_here", "pair_there", "summing_pairs"))
    assert kernel(summing_pairs.total)(pair_here.Pair(1.0, 2.0)) == 3.0
    read = kernel(summing_pairs.total)
    assert read(pair_here.Pair(1.0, 2.0)) == 3.0
    assert sum(read.stats.cache_hits.values()) == 1
    if moved == "its module is gone":
        (tmp_path / "pair_here.py").unlink()
        importlib.invalidate_caches()
        monkeypatch.delitem(sys.modules, "pair_here")
    else:
        monkeypatch.delattr(pair_here, "Pair")
    again = kernel(summing_pairs.total)
    assert again(pair_there.Pair(1.0, 2.0)) == 3.0
    assert sum(again.stats.cache_hits.values()) == 0
    kept = kernel(summing_pairs.total)
    assert kept(pair_there.Pair(2.0, 2.0)) == 4.0
    assert sum(kept.stats.cache_hits.values()) == 1
