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
def context(application, runner):
    from groundstation.gui.application.context import ApplicationContext

    context = ApplicationContext(Session(Document(site=single_panel())), runner)
    yield context
    context.close()


@pytest.fixture
def messages(context):
    from groundstation.gui.window.message_area import MessageArea

    return MessageArea(context)


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


def test_a_result_arrives_in_the_windows_thread(application, context):
    heard = []
    context.start("job", lambda _context: 42, lambda result: heard.append((result, threading.get_ident())))
    wait(application, lambda: heard)
    assert heard == [(42, threading.get_ident())]
    assert context.jobs() == ()


def test_it_is_busy_while_a_job_runs_and_while_other_work_says_so(application, context):
    gate, trains = Gate(), [False]
    context.count_as_busy(lambda: trains[0])
    assert not context.is_busy
    context.start("job", gate)
    assert context.is_busy
    gate.open.set()
    wait(application, lambda: not context.jobs())
    assert not context.is_busy
    trains[0] = True
    assert context.is_busy


def test_an_error_is_shown_with_what_to_do_and_passed_on(application, context, messages):
    heard = []

    def work(_context):
        raise InputError("a.json: not valid JSON; write it again")

    context.start("Open", work, lambda _result: heard.append("done"), heard.append)
    wait(application, lambda: heard)
    assert isinstance(heard[0], InputError)
    assert messages.texts() == "Error: Open: a.json: not valid JSON; write it again"


def test_a_fault_of_the_program_says_so(application, context, messages):
    context.start("Open", lambda _context: 1 // 0)
    wait(application, messages.texts)
    assert "please report it" in messages.texts()
    assert "ZeroDivisionError" in messages.texts()


def test_a_queued_job_is_cancelled_at_once_and_calls_nobody(application, context, messages):
    gate, heard = Gate(), []
    first = context.start("first", gate, heard.append)
    second = context.start("second", lambda _context: "second", heard.append, heard.append)
    wait(application, gate.begun.is_set)
    context.cancel(second)
    wait(application, lambda: second not in context.jobs())
    assert second.state is JobState.CANCELLED
    assert context.jobs() == (first,)
    gate.open.set()
    wait(application, lambda: not context.jobs())
    assert heard == ["through"]
    assert "second: cancelled" in messages.texts()


def test_closing_cancels_what_runs_and_what_waits(application, runner):
    from groundstation.gui.application.context import ApplicationContext

    context, gate, heard = ApplicationContext(Session(), runner), Gate(), []
    jobs = [context.start("first", gate, heard.append), context.start("second", gate, heard.append)]
    wait(application, gate.begun.is_set)
    assert context.close(120.0)
    application.processEvents()
    assert [job.state for job in jobs] == [JobState.CANCELLED] * 2
    assert not heard


def test_the_job_bar_shows_progress_queue_and_time_and_cancels(application, context):
    from groundstation.gui.widgets.job_bar import JobBar

    bar, gate = JobBar(context), Gate()
    context.start("first", gate)
    context.start("second", lambda _context: None)
    wait(application, lambda: not bar.isHidden() and bar._bar.maximum() == 1000)
    assert "first: waiting" in bar._label.text()
    assert bar._bar.value() == 250
    assert bar._queue.text() == "1 waiting"
    wait(application, lambda: "this step: " in bar._left.text() and "left" in bar._left.text())
    bar._list_queue()
    assert [action.text() for action in bar._queue.menu().actions()] == ["Cancel: second"]
    bar.cancel_running()
    wait(application, lambda: not context.jobs())
    assert bar.isHidden()


def test_the_keyboard_goes_to_no_other_button_when_a_job_was_cancelled(application, context):
    from PySide6.QtWidgets import QPushButton, QVBoxLayout, QWidget

    from groundstation.gui.widgets.job_bar import JobBar

    window, gate, undone = QWidget(), Gate(), []
    undo, bar = QPushButton("Undo"), JobBar(context)
    undo.clicked.connect(undone.append)
    layout = QVBoxLayout(window)
    layout.addWidget(undo)
    layout.addWidget(bar)
    window.show()
    context.start("first", gate)
    wait(application, bar._cancel.isVisible)
    window.activateWindow()
    bar._cancel.setFocus()
    wait(application, bar._cancel.hasFocus)
    QTest.mouseClick(bar._cancel, Qt.MouseButton.LeftButton)
    wait(application, lambda: not context.jobs() and not bar.isVisible())
    assert not undo.hasFocus()
    QTest.keyClick(application.focusWidget() or window, Qt.Key.Key_Space)
    assert not undone
    window.close()


def test_work_that_is_no_job_has_the_bar_while_no_job_runs(application, context):
    from groundstation.gui.application.context import Ongoing
    from groundstation.gui.widgets.job_bar import JobBar

    bar, gate = JobBar(context), Gate()
    context.ongoingChanged.emit(Ongoing("Training: 40 steps", 0.25, 60.0, 180.0))
    assert not bar.isHidden()
    assert bar._cancel.isHidden()
    assert (bar._label.text(), bar._left.text(), bar._bar.value()) == ("Training: 40 steps", "3:00 left", 250)
    context.start("first", gate)
    wait(application, lambda: bar._label.text().startswith("first"))
    assert not bar._cancel.isHidden()
    context.ongoingChanged.emit(Ongoing("Training: 50 steps", None, 75.0, None))
    assert bar._label.text().startswith("first")
    gate.open.set()
    wait(application, lambda: not context.jobs())
    assert (bar._label.text(), bar._left.text()) == ("Training: 50 steps", "1:15 so far")
    assert not bar.isHidden()
    context.ongoingChanged.emit(None)
    assert bar.isHidden()


def test_a_short_job_does_not_make_the_bar_flash(application, context):
    from groundstation.gui.widgets.job_bar import JobBar

    bar, seen = JobBar(context), []
    done = []
    context.start("short", lambda _context: "x", done.append)
    while not done:
        application.processEvents()
        seen.append(not bar.isHidden())
    assert not any(seen)


def test_a_selection_is_announced_once_and_goes_with_its_thing(application, context):
    heard = []
    context.selectionChanged.connect(heard.append)
    item = Item(ItemKind.PANEL, "A-0000")
    context.select(item)
    context.select(item)
    context.change("Close site", Document())
    assert heard == [item, None]


def test_messages_keep_their_place_and_lead_to_it(application, context, messages):
    heard = []
    context.lookAtRequested.connect(heard.append)
    item = Item(ItemKind.HOME)
    context.say(Severity.WARNING, "home stands close", item)
    messages._jump.click()
    assert heard == [item]
    assert messages.line() == "Warning: home stands close"
    for number in range(600):
        context.say(Severity.NOTE, str(number))
    assert len(messages.messages()) == 500
    assert messages.texts().endswith("Note: 599")


class Clock:
    now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.fixture
def centre(application, context):
    from groundstation.gui.window.message_area import MessageArea

    clock = Clock()
    area = MessageArea(context, clock=clock)
    area.clock = clock
    return area


def passes(area, seconds):
    area.clock.now_s += seconds
    area.look()


def test_a_warning_stays_until_it_is_no_longer_true_whatever_else_is_told(context, centre):
    context.say(Severity.WARNING, "the copy could not be written", about="project.copy")
    context.say(Severity.OK, "Saved a file")
    assert centre.line() == "Done: Saved a file"
    passes(centre, 20.0)
    assert centre.line() == "Warning: the copy could not be written"
    passes(centre, 3600.0)
    assert centre.line() == "Warning: the copy could not be written"
    assert "\u26a0 1" in centre._all.text()
    context.withdraw("project.copy")
    assert centre.line() == ""
    assert centre._all.text() == "Messages"
    assert "the copy could not be written" in centre.texts(), "the list keeps it"


def test_the_gravest_of_what_holds_is_shown_and_the_next_when_it_goes(context, centre):
    context.say(Severity.ERROR, "the link is lost", about="link")
    context.say(Severity.WARNING, "wind above the limit", about="flight.warning.wind")
    context.say(Severity.WARNING, "the battery is low", about="flight.warning.battery")
    assert centre.line() == "Error: the link is lost"
    assert centre.standing()[0].text == "the link is lost"
    context.withdraw("link")
    assert centre.line().startswith("Warning: ")
    context.withdraw("flight.warning.")
    assert centre.line() == ""


def test_a_message_about_the_same_takes_the_place_of_the_one_before(context, centre):
    context.say(Severity.WARNING, "wind 9 m/s", about="flight.warning.wind")
    context.say(Severity.ERROR, "wind 14 m/s", about="flight.warning.wind")
    assert [message.text for message in centre.standing()] == ["wind 14 m/s"]
    context.say(Severity.OK, "wind 3 m/s", about="flight.warning.wind")
    assert centre.standing() == ()


def test_what_just_happened_goes_after_a_while(context, centre):
    context.say(Severity.OK, "Written: a.kmz")
    passes(centre, 5.0)
    assert centre.line() == "Done: Written: a.kmz"
    passes(centre, 30.0)
    assert centre.line() == ""
    context.say(Severity.ERROR, "a.kmz cannot be written")
    passes(centre, 30.0)
    assert centre.line() == "Error: a.kmz cannot be written", "trouble is longer there to be read"
    passes(centre, 60.0)
    assert centre.line() == ""
    assert len(centre.messages()) == 2


def test_what_just_happened_goes_when_the_site_is_no_longer_as_it_was_told(context, centre):
    """“panels 46” beside a site that has 50 by now."""
    context.change("Site", replace(context.document, site=single_panel()))
    context.say(Severity.OK, "panels 46")
    context.amend(replace(context.document, request=replace(context.document.request, seed=7)))
    assert centre.line() == "Done: panels 46", "the form of the next plan changes nothing that was told"
    context.say(Severity.WARNING, "the copy could not be written", about="project.copy")
    context.say(Severity.OK, "panels 46")
    context.change("Panels", replace(context.document, site=single_panel()))
    assert centre.line() == "Warning: the copy could not be written", "what holds goes by itself only"
    assert "panels 46" in centre.texts(), "the list keeps what was told, with its time"


def test_an_error_of_a_job_holds_until_it_is_tried_again(application, context, centre):
    def fails(_context):
        raise InputError("no room")

    context.start("Save", fails)
    wait(application, centre.standing)
    context.start("Open", lambda _context: None)
    wait(application, lambda: not context.jobs())
    assert [message.text for message in centre.standing()] == ["Save: no room"]
    context.start("Save", lambda _context: None)
    assert centre.standing() == ()
    wait(application, lambda: not context.jobs())


def test_the_list_opens_over_the_window_and_moves_nothing(application, context):
    from PySide6.QtWidgets import QMainWindow, QPushButton, QVBoxLayout, QWidget

    from groundstation.gui.window.message_area import MessageArea

    window, page, area = QMainWindow(), QWidget(), MessageArea(context)
    above, layout = QPushButton("above"), QVBoxLayout(page)
    layout.addWidget(above, 1)
    layout.addWidget(area)
    window.setCentralWidget(page)
    window.resize(900, 500)
    window.show()
    wait(application, window.isVisible)
    before = above.geometry(), area.geometry(), window.size()
    item, heard = Item(ItemKind.HOME), []
    context.lookAtRequested.connect(heard.append)
    context.say(Severity.WARNING, "home stands close " * 40, item, "plan.home")
    context.say(Severity.OK, "Saved")
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


def test_a_long_message_is_cut_in_the_line_and_whole_in_the_list(application, context, centre):
    context.say(Severity.WARNING, "word " * 200, about="plan.long")
    centre.resize(500, centre.sizeHint().height())
    assert centre.sizeHint().height() <= 2 * centre.fontMetrics().lineSpacing() + 30
    assert centre.minimumSizeHint().width() < 500
    lines = centre._text._lines()
    assert len(lines) == 2
    assert lines[1].endswith("\u2026")
    assert centre._text.toolTip().count("word") == 200


def test_a_job_that_the_window_itself_throws_away_is_not_spoken_of(application, context, messages):
    gate = Gate()
    job = context.start("looking", gate)
    wait(application, gate.begun.is_set)
    context.cancel(job, quietly=True)
    wait(application, lambda: not context.jobs())
    assert messages.texts() == ""
