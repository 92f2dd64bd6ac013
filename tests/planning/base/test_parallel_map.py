"""Sweeps give the same results here, on several processes and on a cluster."""

import gc
import math

import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.base.parallel_map import sweep

ARGUMENTS = [(float(x),) for x in (9, 1, 4, 16)]


@pytest.mark.parametrize("n_processes", [1, 2])
def test_results_come_in_the_order_of_the_arguments(n_processes):
    assert sweep(math.sqrt, ARGUMENTS, n_processes=n_processes) == [3.0, 1.0, 2.0, 4.0]


def test_nothing_to_run_gives_nothing():
    assert sweep(math.sqrt, []) == []


def test_errors_of_a_run_reach_the_caller():
    with pytest.raises(ValueError, match=r"domain|nonnegative"):
        sweep(math.sqrt, [(1.0,), (-1.0,)], n_processes=2)


def test_cancelling_ends_the_sweep():
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    for n_processes in (1, 2):
        with pytest.raises(OperationCancelled):
            sweep(math.sqrt, ARGUMENTS, n_processes=n_processes, monitor=Cancelling())


def test_cluster_gives_the_same_results():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0"
    ) as cluster:
        assert sweep(math.sqrt, ARGUMENTS, address=cluster.scheduler_address) == [3.0, 1.0, 2.0, 4.0]


@pytest.mark.slow
def test_address_where_no_scheduler_answers_is_a_clear_error():
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        sweep(math.sqrt, ARGUMENTS, address="tcp://127.0.0.1:1")


@pytest.mark.slow
def test_nothing_of_a_client_that_found_no_scheduler_is_left_to_be_collected_later():
    distributed = pytest.importorskip("distributed")
    gc.disable()
    try:
        with pytest.raises(InputError, match="no Dask scheduler answers at nowhere"):
            sweep(math.sqrt, ARGUMENTS, address="nowhere")
        # By type: isinstance asks an object for its class, and some objects of other tests warn when asked anything.
        left = [each for each in gc.get_objects() if issubclass(type(each), distributed.Client)]
    finally:
        gc.enable()
    assert all(each.status in ("closed", "newly-created") for each in left)
