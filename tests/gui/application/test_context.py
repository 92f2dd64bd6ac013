"""Jobs, messages and selection as the window sees them: nothing is lost, nothing comes twice, nothing blocks."""

import threading
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.services.jobs.runner import JobRunner, JobState
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.project.session import Session
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.site.bundled import single_panel
from tests.gui.driving import click_on, press_in, turn_until


@pytest.fixture
def runner():
    runner = JobRunner()
    yield runner
    runner.shutdown()


@pytest.fixture
def workspace(application, runner):
    from groundstation.gui.application.context import ApplicationContext

    workspace = ApplicationContext(Session(Document(site=single_panel())), runner)
    yield workspace
    workspace.close()


@pytest.fixture
def messages(workspace):
    from groundstation.gui.window.message_area import MessageArea

    return MessageArea(workspace)


def wait(application, condition):
    turn_until(application, condition)


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
    from groundstation.gui.application.context import ApplicationContext

    workspace, gate, heard = ApplicationContext(Session(), runner), Gate(), []
    jobs = [workspace.start("first", gate, heard.append), workspace.start("second", gate, heard.append)]
    wait(application, gate.begun.is_set)
    assert workspace.close(120.0)
    application.processEvents()
    assert [job.state for job in jobs] == [JobState.CANCELLED] * 2
    assert not heard


def test_the_job_bar_shows_progress_queue_and_time_and_cancels(application, workspace):
    from groundstation.gui.widgets.job_bar import JobBar

    bar, gate = JobBar(workspace), Gate()
    workspace.start("first", gate)
    workspace.start("second", lambda _context: None)
    wait(application, lambda: not bar.isHidden() and bar._bar.maximum() == 1000)
    assert "first: waiting" in bar._label.text()
    assert bar._bar.value() == 250
    assert bar._queue.text() == "1 waiting"
    wait(application, lambda: "this step: " in bar._left.text() and "left" in bar._left.text())
    bar._list_queue()
    assert [action.text() for action in bar._queue.menu().actions()] == ["Cancel: second"]
    bar.cancel_running()
    wait(application, lambda: not workspace.jobs())
    assert bar.isHidden()


def test_a_short_job_does_not_make_the_bar_flash(application, workspace):
    from groundstation.gui.widgets.job_bar import JobBar

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
    messages._jump.click()
    assert heard == [item]
    assert messages.line() == "Warning: home stands close"
    for number in range(600):
        workspace.say(Severity.NOTE, str(number))
    assert len(messages.messages()) == 500
    assert messages.texts().endswith("Note: 599")


class Clock:
    now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.fixture
def centre(application, workspace):
    from groundstation.gui.window.message_area import MessageArea

    clock = Clock()
    area = MessageArea(workspace, clock=clock)
    area.clock = clock
    return area


def passes(area, seconds):
    area.clock.now_s += seconds
    area.look()


def test_a_warning_stays_until_it_is_no_longer_true_whatever_else_is_told(workspace, centre):
    workspace.say(Severity.WARNING, "the copy could not be written", about="project.copy")
    workspace.say(Severity.OK, "Saved a file")
    assert centre.line() == "Done: Saved a file"
    passes(centre, 20.0)
    assert centre.line() == "Warning: the copy could not be written"
    passes(centre, 3600.0)
    assert centre.line() == "Warning: the copy could not be written"
    assert "\u26a0 1" in centre._all.text()
    workspace.settle("project.copy")
    assert centre.line() == ""
    assert centre._all.text() == "Messages"
    assert "the copy could not be written" in centre.texts(), "the list keeps it"


def test_the_gravest_of_what_holds_is_shown_and_the_next_when_it_goes(workspace, centre):
    workspace.say(Severity.ERROR, "the link is lost", about="link")
    workspace.say(Severity.WARNING, "wind above the limit", about="flight.warning.wind")
    workspace.say(Severity.WARNING, "the battery is low", about="flight.warning.battery")
    assert centre.line() == "Error: the link is lost"
    assert centre.standing()[0].text == "the link is lost"
    workspace.settle("link")
    assert centre.line().startswith("Warning: ")
    workspace.settle("flight.warning.")
    assert centre.line() == ""


def test_a_message_about_the_same_takes_the_place_of_the_one_before(workspace, centre):
    workspace.say(Severity.WARNING, "wind 9 m/s", about="flight.warning.wind")
    workspace.say(Severity.ERROR, "wind 14 m/s", about="flight.warning.wind")
    assert [message.text for message in centre.standing()] == ["wind 14 m/s"]
    workspace.say(Severity.OK, "wind 3 m/s", about="flight.warning.wind")
    assert centre.standing() == ()


def test_what_just_happened_goes_after_a_while(workspace, centre):
    workspace.say(Severity.OK, "Written: a.kmz")
    passes(centre, 5.0)
    assert centre.line() == "Done: Written: a.kmz"
    passes(centre, 30.0)
    assert centre.line() == ""
    workspace.say(Severity.ERROR, "a.kmz cannot be written")
    passes(centre, 30.0)
    assert centre.line() == "Error: a.kmz cannot be written", "trouble is longer there to be read"
    passes(centre, 60.0)
    assert centre.line() == ""
    assert len(centre.messages()) == 2


def test_what_just_happened_goes_when_the_site_is_no_longer_as_it_was_told(workspace, centre):
    """“panels 46” beside a site that has 50 by now."""
    workspace.change("Site", replace(workspace.document, site=single_panel()))
    workspace.say(Severity.OK, "panels 46")
    workspace.amend(replace(workspace.document, request=replace(workspace.document.request, seed=7)))
    assert centre.line() == "Done: panels 46", "the form of the next plan changes nothing that was told"
    workspace.say(Severity.WARNING, "the copy could not be written", about="project.copy")
    workspace.say(Severity.OK, "panels 46")
    workspace.change("Panels", replace(workspace.document, site=single_panel()))
    assert centre.line() == "Warning: the copy could not be written", "what holds goes by itself only"
    assert "panels 46" in centre.texts(), "the list keeps what was told, with its time"


def test_an_error_of_a_job_holds_until_it_is_tried_again(application, workspace, centre):
    def fails(_context):
        raise InputError("no room")

    workspace.start("Save", fails)
    wait(application, centre.standing)
    workspace.start("Open", lambda _context: None)
    wait(application, lambda: not workspace.jobs())
    assert [message.text for message in centre.standing()] == ["Save: no room"]
    workspace.start("Save", lambda _context: None)
    assert centre.standing() == ()
    wait(application, lambda: not workspace.jobs())


def test_the_list_opens_over_the_window_and_moves_nothing(application, workspace):
    from PySide6.QtWidgets import QMainWindow, QPushButton, QVBoxLayout, QWidget

    from groundstation.gui.window.message_area import MessageArea

    window, page, area = QMainWindow(), QWidget(), MessageArea(workspace)
    above, layout = QPushButton("above"), QVBoxLayout(page)
    layout.addWidget(above, 1)
    layout.addWidget(area)
    window.setCentralWidget(page)
    window.resize(900, 500)
    window.show()
    wait(application, window.isVisible)
    before = above.geometry(), area.geometry(), window.size()
    item, heard = Item(ItemKind.HOME), []
    workspace.lookAtRequested.connect(heard.append)
    workspace.say(Severity.WARNING, "home stands close " * 40, item, "plan.home")
    workspace.say(Severity.OK, "Saved")
    click_on(window, area._all)
    assert area.sheet.isVisible()
    assert (above.geometry(), area.geometry(), window.size()) == before
    rows = area.sheet.texts()
    assert rows[0] == "Now"
    assert rows[1].startswith("Warning: home stands close")
    assert rows[2] == "Told so far"
    assert rows[3].endswith("Done: Saved"), "the latest first"
    area.sheet.rows().setCurrentRow(1)
    press_in(window, "Show place")
    assert heard == [item]
    press_in(window, "Dismiss")
    assert area.standing() == ()
    assert area.sheet.texts()[1] == "nothing to heed"
    window.activateWindow()
    wait(application, window.isActiveWindow)
    area.sheet.rows().setFocus()
    QTest.keyClick(area.sheet.rows(), Qt.Key.Key_Escape)
    assert not area.sheet.isVisible()
    assert not area._all.isChecked()
    window.close()


def test_a_long_message_is_cut_in_the_line_and_whole_in_the_list(application, workspace, centre):
    workspace.say(Severity.WARNING, "word " * 200, about="plan.long")
    centre.resize(500, centre.sizeHint().height())
    assert centre.sizeHint().height() <= 2 * centre.fontMetrics().lineSpacing() + 30
    assert centre.minimumSizeHint().width() < 500
    lines = centre._text._lines()
    assert len(lines) == 2
    assert lines[1].endswith("\u2026")
    assert centre._text.toolTip().count("word") == 200


def test_a_job_that_the_window_itself_throws_away_is_not_spoken_of(application, workspace, messages):
    gate = Gate()
    job = workspace.start("looking", gate)
    wait(application, gate.begun.is_set)
    workspace.cancel(job, quietly=True)
    wait(application, lambda: not workspace.jobs())
    assert messages.texts() == ""
