"""Jobs, messages and selection as the window sees them: nothing is lost, nothing comes twice, nothing blocks."""

import threading

import pytest

from groundstation.services.document import Document, Item, ItemKind
from groundstation.services.jobs import JobRunner, JobState
from groundstation.services.session import Session
from planning.errors import InputError
from planning.findings import Severity
from planning.scenes import single_panel
from tests.gui.driving import turn_until


@pytest.fixture
def runner():
    runner = JobRunner()
    yield runner
    runner.shutdown()


@pytest.fixture
def workspace(application, runner):
    from groundstation.gui.workspace import Workspace

    workspace = Workspace(Session(Document(site=single_panel())), runner)
    yield workspace
    workspace.close()


@pytest.fixture
def messages(workspace):
    from groundstation.gui.message_area import MessageArea

    return MessageArea(workspace)


def wait(application, condition, timeout_s=10.0):
    turn_until(application, condition, timeout_s)


class Gate:
    """Work that waits until it is let through, and notices a cancel."""

    def __init__(self):
        self.open, self.begun = threading.Event(), threading.Event()

    def __call__(self, context):
        self.begun.set()
        while not self.open.wait(0.005):
            context.report("waiting", 1, 4)
        return "through"


def test_a_result_arrives_in_the_windows_thread(application, workspace):
    heard = []
    workspace.start("job", lambda _context: 42, lambda result: heard.append((result, threading.get_ident())))
    wait(application, lambda: heard)
    assert heard == [(42, threading.get_ident())]
    assert workspace.jobs() == ()


def test_it_is_busy_while_a_job_runs_and_while_other_work_says_so(application, workspace):
    gate, trains = Gate(), [False]
    workspace.count_as_busy(lambda: trains[0])
    assert not workspace.is_busy
    workspace.start("job", gate)
    assert workspace.is_busy
    gate.open.set()
    wait(application, lambda: not workspace.jobs())
    assert not workspace.is_busy
    trains[0] = True
    assert workspace.is_busy


def test_an_error_is_shown_with_what_to_do_and_passed_on(application, workspace, messages):
    heard = []

    def work(_context):
        raise InputError("a.json: not valid JSON; write it again")

    workspace.start("Open", work, lambda _result: heard.append("done"), heard.append)
    wait(application, lambda: heard)
    assert isinstance(heard[0], InputError)
    assert messages.texts() == "Error: Open: a.json: not valid JSON; write it again"


def test_a_fault_of_the_program_says_so(application, workspace, messages):
    workspace.start("Open", lambda _context: 1 // 0)
    wait(application, messages.texts)
    assert "please report it" in messages.texts()
    assert "ZeroDivisionError" in messages.texts()


def test_a_queued_job_is_cancelled_at_once_and_calls_nobody(application, workspace, messages):
    gate, heard = Gate(), []
    first = workspace.start("first", gate, heard.append)
    second = workspace.start("second", lambda _context: "second", heard.append, heard.append)
    wait(application, gate.begun.is_set)
    workspace.cancel(second)
    wait(application, lambda: second not in workspace.jobs())
    assert second.state is JobState.CANCELLED
    assert workspace.jobs() == (first,)
    gate.open.set()
    wait(application, lambda: not workspace.jobs())
    assert heard == ["through"]
    assert "second: cancelled" in messages.texts()


def test_closing_cancels_what_runs_and_what_waits(application, runner):
    from groundstation.gui.workspace import Workspace

    workspace, gate, heard = Workspace(Session(), runner), Gate(), []
    jobs = [workspace.start("first", gate, heard.append), workspace.start("second", gate, heard.append)]
    wait(application, gate.begun.is_set)
    assert workspace.close(5.0)
    application.processEvents()
    assert [job.state for job in jobs] == [JobState.CANCELLED] * 2
    assert not heard


def test_the_job_bar_shows_progress_queue_and_time_and_cancels(application, workspace):
    from groundstation.gui.job_bar import JobBar

    bar, gate = JobBar(workspace), Gate()
    workspace.start("first", gate)
    workspace.start("second", lambda _context: None)
    wait(application, lambda: not bar.isHidden() and bar._bar.maximum() == 1000)
    assert "first: waiting" in bar._label.text()
    assert bar._bar.value() == 250
    assert bar._queue.text() == "1 waiting"
    wait(application, lambda: "left" in bar._left.text())
    bar._list_queue()
    assert [action.text() for action in bar._queue.menu().actions()] == ["Cancel: second"]
    bar.cancel_running()
    wait(application, lambda: not workspace.jobs())
    assert bar.isHidden()


def test_a_short_job_does_not_make_the_bar_flash(application, workspace):
    from groundstation.gui.job_bar import JobBar

    bar, seen = JobBar(workspace), []
    done = []
    workspace.start("short", lambda _context: "x", done.append)
    while not done:
        application.processEvents()
        seen.append(not bar.isHidden())
    assert not any(seen)


def test_a_selection_is_announced_once_and_goes_with_its_thing(application, workspace):
    heard = []
    workspace.selectionChanged.connect(heard.append)
    item = Item(ItemKind.PANEL, "A-0000")
    workspace.select(item)
    workspace.select(item)
    workspace.change("Close site", Document())
    assert heard == [item, None]


def test_messages_keep_their_place_and_lead_to_it(application, workspace, messages):
    heard = []
    workspace.lookAtRequested.connect(heard.append)
    item = Item(ItemKind.HOME)
    workspace.say(Severity.WARNING, "home stands close", item)
    messages._jump_to_last()
    assert heard == [item]
    assert messages._severity.text() == "Warning"
    for number in range(600):
        workspace.say(Severity.NOTE, str(number))
    assert messages._list.count() == 500
    assert messages.texts().endswith("Note: 599")


def test_a_job_that_the_window_itself_throws_away_is_not_spoken_of(application, workspace, messages):
    gate = Gate()
    job = workspace.start("looking", gate)
    wait(application, gate.begun.is_set)
    workspace.cancel(job, quietly=True)
    wait(application, lambda: not workspace.jobs())
    assert messages.texts() == ""
