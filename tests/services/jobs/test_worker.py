"""Work in a process of its own: the same results, progress, stopping, cancelling, and every way it can end."""

import os
import pickle
import signal
import sys
import threading

import pytest

from groundstation.services.jobs.runner import JobProgress, JobRunner, JobState
from groundstation.services.jobs.worker import Worker
from groundstation.services.plan.planning import plan_document_site, with_local_site
from planning.base.errors import GroundStationError, InfeasibleError, OperationCancelled
from planning.base.progress import COMPILING_LOG, QUIET, StopRequest, Trace, never
from planning.parameters import GreedyParameters
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.planning.plan_cases import kiosk
from tests.slow import slow

MAIN_FILE = """
import sys
from groundstation.services.jobs.worker import Worker
from tests.services.jobs.test_worker import double
worker = Worker()
print(worker.run(double, 21))
worker.close()
"""


def double(number, *, stop, trace, monitor):
    monitor.report("doubling", 1, 1)
    trace.record(number)
    trace.record_bound(3 * number)
    sys.stdout.write("this line must not get into the pipe\n")
    return 2 * number


def count_until_stopped(*, stop, trace, monitor):
    n = 0
    while not stop():
        n += 1
        monitor.report("counting", n, 0)
    return n


def where(*, stop, trace, monitor):
    return os.getpid()


def fail(error, *, stop, trace, monitor):
    raise error


def prepare():
    COMPILING_LOG.info("preparing what is called")


def die(*, stop, trace, monitor):
    monitor.report("dying", 0, 1)
    os._exit(7)


def die_of_memory(*, stop, trace, monitor):
    os.kill(os.getpid(), signal.SIGKILL)


def hang(*, stop, trace, monitor):
    monitor.report("hanging", 0, 1)
    threading.Event().wait()


class UnsendableError(Exception):
    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


class Reports:
    """Remembers stages; cancels once it has heard of one of them."""

    def __init__(self, cancel_at=None):
        self.stages, self.cancel_at = [], cancel_at

    def report(self, stage, done, total):
        self.stages.append(stage)
        if stage == self.cancel_at:
            raise OperationCancelled("no longer wanted")


@pytest.fixture(scope="module")
def worker():
    worker = Worker()
    yield worker
    worker.close()


@pytest.mark.long
def test_the_result_progress_quality_and_bound_come_back(worker):
    reports, trace = Reports(), Trace()
    assert worker.run(double, 21, trace=trace, monitor=reports) == 42
    assert "doubling" in reports.stages
    assert [point.value for point in trace.points] == [21]
    assert trace.bound == 63


@pytest.mark.long
def test_every_call_reports_however_soon_it_follows_the_one_before(worker):
    for _ in range(20):
        reports = Reports()
        worker.run(double, 1, monitor=reports)
        assert "doubling" in reports.stages


@pytest.mark.long
def test_the_work_is_done_in_one_other_process(worker):
    assert worker.run(where) == worker.run(where) != os.getpid()


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene", [SCENES["single-panel"], slow(kiosk)], ids=["a single panel", "kiosk, whose walls hide one another"]
)
def test_a_plan_is_the_one_that_is_made_here(worker, scene):
    model, request = scene(), PlanRequest(n_views=2, greedy=GreedyParameters(n_candidates=400), time_budget_s=600.0)
    here = plan_document_site(model, request)
    there = with_local_site(worker.run(plan_document_site, model, request), model, None)
    assert there.plan.viewpoints == here.plan.viewpoints
    assert there.plan.sorties == here.plan.sorties
    assert there.prepared.site_model is model
    again = with_local_site(worker.run(plan_document_site, model, request, there.prepared), model, there.prepared)
    assert again.prepared is there.prepared
    assert again.plan.viewpoints == here.plan.viewpoints


def test_stopping_brings_the_best_so_far(worker):
    stop = StopRequest()

    class StopSoon:
        def report(self, stage, done, total):
            if stage == "counting":
                stop.request()

    assert worker.run(count_until_stopped, stop=stop, monitor=StopSoon()) >= 1
    # The next call does not hear of the wish of this one.
    assert worker.run(double, 2) == 4


def test_cancelling_ends_the_work_and_the_next_call_finds_the_same_process(worker):
    process = worker.run(where)
    with pytest.raises(OperationCancelled, match="no longer wanted"):
        worker.run(count_until_stopped, monitor=Reports(cancel_at="counting"))
    assert worker.run(where) == process


@pytest.mark.slow
def test_a_process_that_does_not_notice_the_cancel_is_ended(worker, monkeypatch):
    monkeypatch.setattr("groundstation.services.jobs.worker.GRACE_S", 0.1)
    process = worker.run(where)
    with pytest.raises(OperationCancelled):
        worker.run(hang, monitor=Reports(cancel_at="hanging"))
    assert worker.run(where) != process


def test_errors_come_back_as_they_were_raised(worker):
    with pytest.raises(InfeasibleError, match="nothing to see here"):
        worker.run(fail, InfeasibleError("nothing to see here"))


def test_an_error_that_cannot_be_sent_is_told_in_words(worker):
    with pytest.raises(RuntimeError, match="UnsendableError: a and b"):
        worker.run(raise_unsendable)


def raise_unsendable(*, stop, trace, monitor):
    raise UnsendableError("a", "b")


def return_unsendable(*, stop, trace, monitor):
    return lambda: None


def test_a_result_that_cannot_be_sent_is_an_error_and_not_the_end_of_the_process(worker):
    process = worker.run(where)
    with pytest.raises((AttributeError, TypeError, pickle.PicklingError), match="pickle"):
        worker.run(return_unsendable)
    assert worker.run(where) == process


@pytest.mark.long
@pytest.mark.parametrize(("end", "words"), [slow(die, "exit status 7"), (die_of_memory, "memory")])
def test_a_lost_process_is_an_error_and_the_next_call_has_a_new_one(worker, end, words):
    if end is die_of_memory and sys.platform == "win32":
        pytest.skip("Windows has no such signal")
    with pytest.raises(GroundStationError, match=words):
        worker.run(end)
    assert worker.run(double, 4) == 8


@pytest.mark.slow
def test_a_process_that_was_started_early_works_as_any_other():
    early, stages = Worker(), []
    early.start(prepare)
    early.start(prepare)

    class Heard:
        def report(self, stage, done, total):
            stages.append(stage)

    assert early.run(double, 5, monitor=Heard()) == 10
    heard = [stage for stage in dict.fromkeys(stages) if stage != "starting"]
    assert heard == ["preparing what is called", "doubling"], "it is said what is waited for"
    early.close()


@pytest.mark.slow
def test_closing_ends_work_at_once_as_if_it_were_cancelled():
    worker, began, ended = Worker(), threading.Event(), []

    class Began:
        def report(self, stage, done, total):
            if stage == "hanging":
                began.set()

    def work():
        try:
            worker.run(hang, monitor=Began())
        except BaseException as error:
            ended.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    assert began.wait(60.0)
    worker.close()
    thread.join(120.0)
    assert not thread.is_alive(), "what hangs is not waited for"
    assert isinstance(ended[0], OperationCancelled)
    worker.start(prepare)
    with pytest.raises(OperationCancelled):
        worker.run(double, 1)


def test_a_job_works_apart_with_a_worker_and_here_without_one(worker):
    for helper, is_here in ((worker, False), (None, True)):
        events, runner = [], JobRunner(worker=helper)
        runner.subscribe(events.append)
        job = runner.submit("where", lambda context: (context.run_in_process(where), context.run_in_process(double, 1)))
        process, doubled = job.result()
        runner.shutdown()
        assert (process == os.getpid()) == is_here
        assert doubled == 2
        assert job.state is JobState.SUCCEEDED
        assert "doubling" in [event.stage for event in events if isinstance(event, JobProgress)]


@pytest.mark.slow
def test_the_program_s_main_file_is_not_run_again(tmp_path):
    import subprocess

    script = tmp_path / "main.py"
    script.write_text(MAIN_FILE, "utf-8")
    run = subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["42"]


@pytest.mark.slow
def test_nothing_is_reported_and_nothing_stops_without_the_arguments(worker):
    assert worker.run(double, 3, stop=never, monitor=QUIET) == 6
