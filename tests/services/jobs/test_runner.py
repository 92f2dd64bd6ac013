"""Jobs end exactly once, tell about it in order, and can be cancelled and stopped."""

import threading

import pytest

from groundstation.services.jobs.runner import ENDED, JobImproved, JobProgress, JobRunner, JobState, JobStateChanged
from planning.base.errors import InputError, OperationCancelled


@pytest.fixture
def runner():
    runner = JobRunner()
    yield runner
    runner.shutdown()


def states(events, job):
    return [e.state for e in events if isinstance(e, JobStateChanged) and e.job_id == job.id]


def test_job_that_returns_goes_through_queued_running_succeeded_and_gives_its_result(runner):
    events = []
    runner.subscribe(events.append)
    job = runner.submit("add", lambda _context: 1 + 1)
    assert job.result() == 2
    assert states(events, job) == [JobState.QUEUED, JobState.RUNNING, JobState.SUCCEEDED]
    assert events[-1].result == 2


def test_job_that_raises_fails_with_the_very_exception(runner):
    error = InputError("no such file")

    def work(_context):
        raise error

    job = runner.submit("read", work)
    with pytest.raises(InputError) as caught:
        job.result()
    assert caught.value is error
    assert job.state is JobState.FAILED


def test_running_job_is_cancelled_at_its_next_report(runner):
    begun = threading.Event()

    def work(context):
        begun.set()
        while True:
            context.report("working", 0, 0)

    events = []
    runner.subscribe(events.append)
    job = runner.submit("endless", work)
    begun.wait()
    runner.cancel(job)
    with pytest.raises(OperationCancelled):
        job.result()
    assert states(events, job) == [JobState.QUEUED, JobState.RUNNING, JobState.CANCELLED]


def test_queued_job_that_is_cancelled_never_begins_and_ends_once(runner):
    release, ran, events = threading.Event(), [], []
    runner.subscribe(events.append)
    first = runner.submit("first", lambda _context: release.wait())
    second = runner.submit("second", lambda _context: ran.append(1))
    runner.cancel(second)
    runner.cancel(second)
    assert second.wait(0)
    release.set()
    first.wait()
    runner.shutdown()
    assert ran == []
    assert states(events, second) == [JobState.QUEUED, JobState.CANCELLED]


def test_cancel_after_the_end_changes_nothing(runner):
    events = []
    runner.subscribe(events.append)
    job = runner.submit("quick", lambda _context: 7)
    job.wait()
    runner.cancel(job)
    assert job.result() == 7
    assert sum(state in ENDED for state in states(events, job)) == 1


def test_stop_keeps_the_best_so_far(runner):
    begun = threading.Event()

    def work(context):
        best = 0
        while not context.stop():
            best += 1
            context.trace.record(best)
            begun.set()
        return best

    events = []
    runner.subscribe(events.append)
    job = runner.submit("anytime", work)
    begun.wait()
    job.stop()
    best = job.result()
    improvements = [e.point.value for e in events if isinstance(e, JobImproved)]
    assert improvements == list(range(1, best + 1))


def test_progress_is_thinned_within_a_stage_and_estimates_the_time_left():
    now = [0.0]
    runner = JobRunner(clock=lambda: now[0])
    events = []
    runner.subscribe(events.append)

    def work(context):
        for done in range(100):
            now[0] += 0.01
            context.report("counting", done, 100)
        context.report("next", 0, 0)

    runner.submit("count", work).wait()
    runner.shutdown()
    progress = [e for e in events if isinstance(e, JobProgress)]
    assert 15 <= len(progress) <= 25
    late = [e for e in progress if e.remaining_s is not None][-1]
    assert late.remaining_s == pytest.approx(0.01 * (100 - late.done), rel=0.1)
    assert progress[-1].stage == "next"
    assert progress[-1].remaining_s is None


def test_listener_that_left_hears_nothing_more(runner):
    events = []
    leave = runner.subscribe(events.append)
    runner.submit("one", lambda _context: 1).wait()
    heard = len(events)
    leave()
    runner.submit("two", lambda _context: 2).wait()
    assert len(events) == heard == 3
